//! The same pages in Chromium: without a console error or a request, sorted, filtered, linked to, in the dark and printed.

use std::fs;
use std::path::Path;
use std::time::Instant;

use serde_json::json;

use crate::browser::Browser;
use crate::results::{HOSTILE, city, copied, multiplied, report, study, with_vehicles};
use crate::support::{number, table};

pub const DESK: [u32; 2] = [1280, 900];
pub const PHONE: [u32; 2] = [390, 844];

/// The first column of the rows that the table shows.
const IDS: &str = "[...document.querySelectorAll('#vehicles-table tbody tr')].map((row) => row.cells[0].textContent)";
const COUNT: &str = "document.getElementById('count').textContent";

#[track_caller]
pub fn assert_quiet(browser: &mut Browser) {
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

/// Makes the browser's page as wide as it is on a phone, and checks that nothing but tables and figures in boxes of their
/// own goes beyond it.
#[track_caller]
pub fn assert_fits_a_phone(browser: &mut Browser) {
    browser.emulate(PHONE, false);
    browser.js("new Promise((done) => setTimeout(done, 300))");
    assert_eq!(browser.js("document.documentElement.scrollWidth"), json!(PHONE[0]));
}

#[test]
fn vehicles_can_be_sorted_filtered_and_saved() {
    let Some(mut browser) = Browser::start() else { return };
    let page = city().join("report.html");
    browser.emulate(DESK, false);
    browser.open(&page, "");
    let rows = table(&city().join("vehicles.csv"));
    // The numbers of the rows that are shown, in the order of the table; the page rounds to about four digits.
    let shown = |browser: &mut Browser, column: &str| -> Vec<f64> {
        let ids: Vec<String> = serde_json::from_value(browser.js(IDS)).unwrap();
        assert_eq!(ids.len(), 50);
        let of = |id: &String| number(rows.iter().find(|row| row["id"] == *id).unwrap(), column);
        ids.iter().map(of).collect()
    };
    let best = |column: &str, sign: f64| {
        let mut all: Vec<f64> = rows.iter().map(|row| sign * number(row, column)).collect();
        all.sort_by(f64::total_cmp);
        all.into_iter().take(50).map(|x| sign * x).collect::<Vec<_>>()
    };
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-3 * b.abs().max(a.abs()));
    assert_eq!(browser.js(COUNT), json!(format!("{0} of {0} vehicles", rows.len())));
    assert!(same(&shown(&mut browser, "error_rms"), &best("error_rms", -1.0)), "at first the largest errors");
    browser.click("#vehicles-table th:nth-child(9)");
    assert!(same(&shown(&mut browser, "distance"), &best("distance", -1.0)));
    browser.click("#vehicles-table th:nth-child(9)");
    assert!(same(&shown(&mut browser, "distance"), &best("distance", 1.0)));
    assert_eq!(browser.js("document.querySelector('[aria-sort=ascending]').textContent"), json!("distance [m]"));

    browser.write("#filter", "bus distance>100");
    let buses = rows.iter().filter(|row| row["type"] == "bus" && number(row, "distance") > 100.0).count();
    assert!(buses > 0);
    assert_eq!(browser.js(COUNT), json!(format!("{buses} of {} vehicles", rows.len())));
    let saved = browser.js("report.csv()");
    let mut saved = csv::Reader::from_reader(saved.as_str().unwrap().as_bytes());
    assert!(saved.headers().unwrap().len() > rows[0].len(), "the columns of quality.csv come with them");
    let saved: Vec<crate::support::Row> = saved.deserialize().map(Result::unwrap).collect();
    assert_eq!(saved.len(), buses);
    for row in &saved {
        let own = rows.iter().find(|own| own["id"] == row["id"]).unwrap();
        assert!((number(own, "error_rms") - number(row, "error_rms")).abs() < 1e-4, "{row:?}");
        assert_eq!(own["depart"], row["depart"]);
    }
    assert_quiet(&mut browser);
}

#[test]
fn a_vehicle_can_be_chosen_and_linked_to() {
    let Some(mut browser) = Browser::start() else { return };
    let page = city().join("report.html");
    browser.emulate(DESK, false);
    browser.open(&page, "");
    let panel = "document.getElementById('panel')";
    assert_eq!(browser.js(&format!("{panel}.hidden")), json!(true));
    browser.write("#filter", "id=5");
    browser.click("#vehicles-table tbody tr td:nth-child(2)");
    assert_eq!(browser.js("location.hash"), json!("#veh=5"));
    assert_eq!(browser.js(&format!("{panel}.querySelector('h3').textContent")), json!("Vehicle 5"));
    // Error, speeds, torque, alpha and F of its trace, none beside the panel or over another.
    let charts = format!("[...{panel}.querySelectorAll('canvas')]");
    assert_eq!(browser.js(&format!("{charts}.length")), json!(5));
    let overlap = browser.js(&format!(
        "(() => {{ const all = {charts}.map((c) => c.getBoundingClientRect()); const box = {panel}.getBoundingClientRect();
          return all.some((a, i) => a.right > box.right + 1 || all.some((b, k) => k > i && a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)); }})()"
    ));
    assert_eq!(overlap, json!(false));
    // Something is drawn: pixels that are not empty.
    let drawn = browser.js(&format!(
        "(() => {{ const c = {charts}[0]; return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((x) => x > 0); }})()"
    ));
    assert_eq!(drawn, json!(true));
    browser.open(&page, "#veh=0");
    assert_eq!(browser.js(&format!("{panel}.querySelector('h3').textContent")), json!("Vehicle 0"));
    assert_eq!(browser.js("document.querySelectorAll('tr.selected').length"), json!(1));
    browser.open(&page, "#veh=nobody");
    assert!(browser.js(&format!("{panel}.textContent")).as_str().unwrap().contains("not in the table"));
    assert_quiet(&mut browser);
}

#[test]
fn maps_zoom_colours_follow_the_dark_and_paper_has_no_buttons() {
    let Some(mut browser) = Browser::start() else { return };
    browser.emulate(DESK, false);
    browser.open(&city().join("report.html"), "#veh=0");
    let view = "document.querySelector('svg.map').getAttribute('viewBox').split(' ').map(Number)";
    let before = browser.js(view);
    browser.click(".zoom .buttons button");
    let after = browser.js(view);
    assert!(after[2].as_f64().unwrap() < 0.7 * before[2].as_f64().unwrap(), "{before} {after}");
    assert_quiet(&mut browser);

    let colours = "['body', '.fig text', '.fig .plot'].map((s) => getComputedStyle(document.querySelector(s))).map((c) => [c.backgroundColor, c.fill])";
    let light = browser.js(colours);
    browser.emulate(DESK, true);
    let dark = browser.js(colours);
    assert!((0..3).all(|i| light[i] != dark[i]), "{light} {dark}");
    assert_quiet(&mut browser);

    browser.emulate(DESK, false);
    browser.emulate_print();
    let hidden = "['#tools', 'nav', '.zoom .buttons'].map((s) => getComputedStyle(document.querySelector(s)).display)";
    assert_eq!(browser.js(hidden), json!(["none", "none", "none"]));
    let printed = browser.printed();
    assert!(printed.starts_with("JVBERi") && printed.len() > 100_000, "a PDF of {} characters", printed.len());
    assert_fits_a_phone(&mut browser);
    assert_quiet(&mut browser);
}

#[test]
fn hostile_ids_do_nothing() {
    let Some(mut browser) = Browser::start() else { return };
    let dir = copied(city());
    with_vehicles(dir.path(), |rows| {
        for (row, id) in rows.iter_mut().zip(HOSTILE) {
            (row[0], row[1]) = (id.to_owned(), id.to_owned());
            row[12] = "9.5".to_owned();
        }
    });
    report(&[dir.path()], &["--vehicle", HOSTILE[0]]);
    browser.emulate(PHONE, false);
    browser.open(&dir.path().join("report.html"), "");
    let mut shown: Vec<String> = serde_json::from_value(browser.js(IDS)).unwrap();
    shown.truncate(HOSTILE.len());
    assert_eq!(shown, HOSTILE);
    assert_eq!(browser.js("document.querySelector('#panel h3').textContent"), json!(format!("Vehicle {}", HOSTILE[0])));
    for id in HOSTILE {
        browser.js(&format!("location.hash = '#veh=' + encodeURIComponent({})", json!(id)));
        browser.js("new Promise((done) => setTimeout(done, 30))");
        assert_eq!(browser.js("document.querySelector('#panel h3').textContent"), json!(format!("Vehicle {id}")));
    }
    assert_eq!(browser.js("typeof hacked"), json!("undefined"));
    assert_eq!(browser.js("document.querySelectorAll('img').length"), json!(0));
    assert_fits_a_phone(&mut browser);
    assert_quiet(&mut browser);
}

#[test]
fn a_study_opens() {
    let Some(mut browser) = Browser::start() else { return };
    browser.emulate(DESK, true);
    browser.open(&study().join("report.html"), "#comparison");
    assert!(browser.js("document.querySelectorAll('figure svg').length").as_u64().unwrap() > 5);
    assert_fits_a_phone(&mut browser);
    assert_quiet(&mut browser);
}

/// Size of the page, how long it took to write, and how long it takes Chromium until it can be used.
fn opened(browser: &mut Browser, vehicles: usize) -> (u64, f64, f64) {
    let dir = multiplied(city(), vehicles);
    let start = Instant::now();
    report(&[dir.path()], &[]);
    let written_s = start.elapsed().as_secs_f64();
    let page = dir.path().join("report.html");
    let opened_s = browser.open(&page, "").as_secs_f64();
    assert_quiet(browser);
    assert_of(browser, &page, vehicles);
    (fs::metadata(&page).unwrap().len(), written_s, opened_s)
}

/// All vehicles are there, or the page says how many are.
fn assert_of(browser: &mut Browser, page: &Path, vehicles: usize) {
    let count = browser.js(COUNT).as_str().unwrap().to_owned();
    if !count.contains(&format!(" of {vehicles} vehicles")) {
        assert!(count.contains(&format!("(of {vehicles} in the run)")), "{count}");
        let told = format!(" of {vehicles} vehicles are in this table, every ");
        assert!(fs::read_to_string(page).unwrap().contains(&told));
    }
}

#[test]
fn twenty_thousand_vehicles_are_below_five_megabytes() {
    let Some(mut browser) = Browser::start() else { return };
    browser.emulate(DESK, false);
    let (bytes, written_s, opened_s) = opened(&mut browser, 20_000);
    println!("20 000 vehicles: {bytes} bytes, written in {written_s:.1} s, usable after {opened_s:.1} s");
    assert!(bytes < 5_000_000, "{bytes} bytes");
    browser.write("#filter", "error_rms>0.01");
    let count = browser.js(COUNT);
    assert!(!count.as_str().unwrap().starts_with("20000 "), "{count}");
    assert_quiet(&mut browser);
}

#[test]
#[ignore = "prints sizes and times: cargo test --release --test report -- --ignored --nocapture sizes"]
fn sizes() {
    let mut browser = Browser::start().expect("Chromium");
    browser.emulate(DESK, false);
    println!("vehicles   page [MB]   written in [s]   usable after [s]");
    for vehicles in [200, 4_000, 20_000, 200_000] {
        let (bytes, written_s, opened_s) = opened(&mut browser, vehicles);
        println!("{vehicles:>8}   {:>9.2}   {written_s:>14.2}   {opened_s:>16.2}", bytes as f64 / 1e6);
    }
}
