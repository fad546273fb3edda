//! The page of `paper` in Chromium: the paper's figures under their numbers, its table, the rest folded, a reason for every verdict.

use std::fs;
use std::process::Command;

use serde_json::{Value, json};

use crate::browser::Browser;
use crate::in_browser::{DESK, PHONE, assert_fits_a_phone, assert_quiet};
use crate::results::paper;
use crate::support::{Row, Running, table};

/// The titles of what can be seen without unfolding anything.
const OPEN_TITLES: &str = "[...document.querySelectorAll('h2, h3')].filter((title) => title.checkVisibility()).map((title) => title.textContent)";

#[test]
fn the_papers_figures_stand_first_under_their_numbers() {
    let Some(mut browser) = Browser::start() else { return };
    let dir = paper();
    browser.emulate(DESK, false);
    browser.open(&dir.join("index.html"), "");
    let titles: Vec<String> = serde_json::from_value(browser.js(OPEN_TITLES)).unwrap();
    let numbered: Vec<&str> = titles
        .iter()
        .filter(|title| title.starts_with("Figure ") || title.starts_with("Table "))
        .map(|title| title.split(':').next().unwrap())
        .collect();
    let wanted = ["2", "3", "4", "5", "6", "7", "8", "9"].map(|number| format!("Figure {number}"));
    assert_eq!(numbered, [wanted.as_slice(), &["Table 2".to_owned()]].concat());
    // A drawing and the paper's words in each, and they are the only drawings that can be seen.
    for number in 2..=9 {
        let figure = format!("document.querySelector('#figure-{number}')");
        assert_eq!(browser.js(&format!("{figure}.querySelectorAll('svg').length")), json!(1), "figure {number}");
        let caption = browser.js(&format!("{figure}.querySelector('figcaption').textContent"));
        assert!(caption.as_str().unwrap().contains("In the paper: “"), "{caption}");
    }
    let drawings = "[...document.querySelectorAll('svg.fig')].filter((figure) => figure.checkVisibility()).length";
    assert_eq!(browser.js(drawings), json!(8));
    assert!(browser.js("document.querySelectorAll('svg.fig').length").as_u64() > Some(8), "more are folded");
    let folded = browser.js("[...document.querySelectorAll('#rest > section > details')].map((part) => part.open)");
    assert!(folded.as_array().unwrap().len() >= 5 && folded.as_array().unwrap().iter().all(|open| open == false));
    // The first figure can be seen at once.
    let top = browser.js("document.querySelector('#figure-2 svg').getBoundingClientRect().top").as_f64().unwrap();
    assert!(top < f64::from(DESK[1]), "Figure 2 begins at {top}");
    // Figure 5 has a strip where alpha is nominal, and 1, 10 and 100 are equally far apart.
    let ticks = "Object.fromEntries([...document.querySelectorAll('#figure-5 svg text[text-anchor=end]')].map((tick) => [tick.textContent, Number(tick.getAttribute('y'))]))";
    let ticks = browser.js(ticks);
    let place = |tick: &str| ticks[tick].as_f64().unwrap_or_else(|| panic!("no tick {tick}: {ticks}"));
    assert!((place("1") - place("10") - (place("10") - place("100"))).abs() < 0.3, "{ticks}");
    let strips = browser.js("document.querySelectorAll('#figure-5 svg .strip').length");
    assert!(strips.as_u64() > Some(1), "the first is in the legend");
    let shares = browser.js("document.querySelector('#figure-5 svg').textContent");
    let rows = table(&dir.join("results.csv"));
    let of_step = |r: &&Row| r["test"] == "step" && r["controller"] == "adaptive" && r["noise"] == "off";
    let share = rows.iter().filter(of_step).find(|r| r["quantity"] == "alpha_nominal_share").unwrap();
    let share = 100.0 * share["value"].parse::<f64>().unwrap();
    assert!(shares.as_str().unwrap().contains(&format!("nominal {share:.0} % of the time")), "{share}: {shares}");
    assert_quiet(&mut browser);
}

/// Every verdict in `results.csv` that stands for something in the paper is on the page, with a reason in its row.
#[test]
fn every_verdict_has_its_reason_beside_it() {
    let Some(mut browser) = Browser::start() else { return };
    let dir = paper();
    browser.open(&dir.join("index.html"), "");
    let rows = "[...document.querySelectorAll('table')].filter((table) => table.querySelector('th:last-child')?.textContent.includes('why'))
        .flatMap((table) => [...table.querySelectorAll('tbody tr')]).filter((row) => row.querySelector('.yes, .part, .no'))
        .map((row) => row.cells[row.cells.length - 1].textContent)";
    let reasons: Vec<String> = serde_json::from_value(browser.js(rows)).unwrap();
    assert!(reasons.len() > 40, "{}", reasons.len());
    for reason in &reasons {
        assert!(
            reason.len() > 12 && reason.chars().any(|c| c.is_ascii_digit()) || reason.contains("never got there"),
            "{reason:?}"
        );
    }
    // Table 2 as it is printed: adaptive first, published beside ours.
    let table_2: Value = browser.js("[...document.querySelectorAll('#table2 tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))");
    for (place, row) in [["adaptive", "-0.02", "0.35", "0.35"], ["classic", "-0.01", "0.77", "0.78"]].iter().enumerate()
    {
        let shown = [0, 1, 3, 5].map(|column| table_2[place][column].as_str().unwrap());
        assert_eq!(shown, *row);
    }
    let csv = table(&dir.join("results.csv"));
    let wanted = csv.iter().find(|r| {
        r["test"] == "driver" && r["noise"] == "on" && r["controller"] == "classic" && r["quantity"] == "error_rms"
    });
    let wanted = wanted.unwrap()["value"].parse::<f64>().unwrap();
    assert!(table_2[1][6].as_str().unwrap().starts_with(&format!("{wanted:.2} ± ")), "{table_2}");
    assert_quiet(&mut browser);
}

#[test]
fn the_papers_page_is_read_in_the_dark_on_a_phone_and_on_paper() {
    let Some(mut browser) = Browser::start() else { return };
    browser.emulate(DESK, false);
    browser.open(&paper().join("index.html"), "");
    let colours = "['body', '.fig text', '.fig .plot', 'td.yes'].map((s) => getComputedStyle(document.querySelector(s))).map((c) => [c.backgroundColor, c.fill])";
    let light = browser.js(colours);
    browser.emulate(DESK, true);
    let dark = browser.js(colours);
    assert!((0..4).all(|i| light[i] != dark[i]), "{light} {dark}");
    browser.emulate(DESK, false);
    let beside = "(() => { const [a, b] = ['.figures', '.tables'].map((s) => document.querySelector('#figure-2 > ' + s).getBoundingClientRect()); return b.left >= a.right && b.top < a.bottom; })()";
    assert_eq!(browser.js(beside), json!(true), "numbers stand beside their figure");
    let printed = browser.printed();
    assert!(printed.starts_with("JVBERi") && printed.len() > 100_000, "a PDF of {} characters", printed.len());
    assert_fits_a_phone(&mut browser);
    // Unfolded as well.
    browser.js("document.querySelectorAll('details').forEach((part) => { part.open = true; })");
    assert_eq!(browser.js("document.documentElement.scrollWidth"), json!(PHONE[0]));
    assert_eq!(browser.js("document.querySelectorAll('script').length"), json!(0), "it needs no JavaScript");
    assert_quiet(&mut browser);
}

/// A test that was not asked for leaves its figures' places, with the command that fills them.
#[test]
fn figures_that_were_not_asked_for_say_so() {
    let dir = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_sumo-mfc"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(["paper", "sine", "--preset", "best", "-o"]).arg(dir.path());
    let ended = Running::start(command).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let page = fs::read_to_string(dir.path().join("index.html")).unwrap();
    let part = |number: u8| {
        let start = page.find(&format!("id=\"figure-{number}\"")).unwrap_or_else(|| panic!("no figure {number}"));
        &page[start..start + page[start..].find("</section>").unwrap()]
    };
    for (number, test) in [(2, "step"), (5, "step"), (8, "driver"), (9, "driver")] {
        assert!(part(number).contains(&format!("sumo-mfc paper {test} drives it")), "{}", part(number));
        assert!(!part(number).contains("<svg"));
    }
    assert!(part(6).contains("<svg") && part(7).contains("<svg"));
}
