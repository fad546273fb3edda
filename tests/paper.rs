//! The paper's experiments: what the default preset must show, and that the command can be trusted with other people's files.

use assert_cmd::Command;
use predicates::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use sumo_mfc::map;
use sumo_mfc::paper::Demand;
use sumo_mfc::paper::library::Library;
use sumo_mfc::paper::results::Results;
use sumo_mfc::paper::row::Row;
use sumo_mfc::paper::{self, Lab, PaperError, Request, Verdict, law};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn request(test: &str, dir: &Path) -> Request {
    let preset = Some("default".to_owned());
    Request { test: test.to_owned(), out_dir: dir.to_owned(), preset, coarse: true, ..Request::default() }
}

fn run(request: &Request) -> Result<Results, PaperError> {
    paper::run(request, map::finding)
}

fn lab(dir: &Path) -> Lab {
    Lab { library: Library::open(dir, &[]).unwrap(), driver: None }
}

fn command() -> Command {
    let mut command = Command::cargo_bin("sumo-mfc").unwrap();
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

fn value(results: &Results, controller: &str, quantity: &str) -> f64 {
    let row: &Row = results.get("step", "default", false, controller, quantity).unwrap();
    row.value.unwrap_or_else(|| panic!("{controller} {quantity} has no value"))
}

/// Section 5.1 of the paper, sentence by sentence.
#[test]
fn val_the_default_preset_shows_the_step_test_of_the_paper() {
    let dir = folder();
    let results = run(&request("step", dir.path())).unwrap();
    for (controller, quantity, published, within) in [
        ("classic", "overshoot_1", 19.5, 1.0),
        ("classic", "overshoot_2", 9.5, 0.7),
        ("adaptive", "overshoot_1", 8.0, 0.7),
        ("adaptive", "overshoot_2", 3.9, 0.5),
    ] {
        let ours = value(&results, controller, quantity);
        assert!((ours - published).abs() <= within, "{controller} {quantity}: {ours}, published {published}");
    }
    for step in ["1", "2"] {
        let settles = |controller| value(&results, controller, &format!("settling_{step}"));
        assert!(settles("adaptive") <= 100.0, "adaptive settles after {} m", settles("adaptive"));
        let classic = results.get("step", "default", false, "classic", &format!("settling_{step}")).unwrap().value;
        assert!(classic.is_none_or(|metres| metres > settles("adaptive")), "classic settles first: {classic:?}");
        let undershoot = value(&results, "classic", &format!("undershoot_{step}"));
        assert!(undershoot > 3.0, "classic does not oscillate: undershoot {undershoot} %");
    }
    let nominal = value(&results, "adaptive", "alpha_nominal_share");
    assert!(nominal > 0.5, "alpha is nominal in {nominal} of the time");
    let judged = results.rows.iter().filter(|r| !r.noise && r.published().is_some());
    assert!(judged.into_iter().all(|r| results.verdict(r) == Some(Verdict::Reproduced)));
}

#[test]
fn results_have_the_columns_and_rows_that_scripts_rely_on() {
    let dir = folder();
    run(&request("step", dir.path())).unwrap();
    let text = fs::read_to_string(dir.path().join("results.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header: Vec<_> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(
        header,
        ["test", "preset", "noise", "controller", "quantity", "value", "spread", "unit", "published", "verdict"]
    );
    let rows: Vec<Vec<String>> = reader.records().map(|r| r.unwrap().iter().map(str::to_owned).collect()).collect();
    let mut keys = BTreeSet::new();
    for row in &rows {
        assert!(keys.insert(row[..5].to_vec()), "twice: {row:?}");
        assert!(["on", "off"].contains(&row[2].as_str()));
        assert!(row[8].is_empty() || !row[9].is_empty(), "a published number needs a verdict: {row:?}");
        // The other verdicts are on claims in words.
        let claimed = ["undershoot_1", "undershoot_2", "torque_settling_1", "torque_settling_2", "alpha_ratio_max"];
        let claimed =
            |quantity: &str| claimed.contains(&quantity) || ["alpha_nominal_share", "jerk_rms"].contains(&quantity);
        assert!(row[9].is_empty() || !row[8].is_empty() || claimed(&row[4]), "{row:?}");
        assert!(row[5].is_empty() || row[5].parse::<f64>().is_ok());
    }
    for quantity in ["overshoot_1", "overshoot_2", "settling_1", "settling_2"] {
        for controller in ["classic", "adaptive"] {
            for noise in ["on", "off"] {
                let key = ["step", "default", noise, controller, quantity].map(str::to_owned).to_vec();
                let row = rows.iter().find(|r| r[..5] == key).unwrap_or_else(|| panic!("no {key:?}"));
                let unit = if quantity.starts_with("overshoot") { "%" } else { "m" };
                assert_eq!(row[7], unit);
                assert_eq!(row[6].is_empty(), noise == "off" || row[5].is_empty(), "spread belongs to noise: {row:?}");
            }
        }
    }
}

/// Every recording, with noise and without, whatever the preset: the cheapest one drives them all here, and every preset a short one.
#[test]
fn every_recording_and_every_preset_is_driven_with_noise_and_without() {
    let dir = folder();
    let complete = |results: &Results, test: &str, preset: &str| {
        for (controller, noise) in [("classic", false), ("classic", true), ("adaptive", false), ("adaptive", true)] {
            let row = results.get(test, preset, noise, controller, "error_rms");
            let row = row.unwrap_or_else(|| panic!("no {test} {preset} {controller}, noise {noise}"));
            assert!(row.value.is_some_and(|rms| rms > 0.0), "{row:?}");
            assert_eq!(row.spread.is_some_and(|spread| spread > 0.0), noise, "{row:?}");
            assert!(results.verdict(row).is_some(), "{row:?}");
        }
    };
    let best = Request { preset: Some("best".to_owned()), ..request("driver", dir.path()) };
    let results = run(&best).unwrap();
    for route in ["driver", "driver_path", "driver_racing", "driver_racing_path", "driver_udds", "driver_hwfet"] {
        complete(&results, route, "best");
    }
    let file = dir.path().join("short.csv");
    let rows: String = (0..=15).map(|t| format!("{t},{}\n", 2 * t.min(15 - t))).collect();
    fs::write(&file, format!("t_s,v_mps\n{rows}")).unwrap();
    let presets = lab(dir.path()).library.presets;
    assert!(presets.len() >= 11);
    for test in ["driver", "delay"] {
        let all = Request { preset: None, driver: Some(file.clone()), ..request(test, dir.path()) };
        let results = run(&all).unwrap();
        for preset in &presets {
            complete(&results, test, &preset.name);
            // The laws that are not the paper's drive with their own gains: once is enough.
            for law in ["calibrating", "pid"] {
                let row = results.get(test, &preset.name, true, law, "error_rms");
                assert_eq!(row.is_some_and(|r| r.value > Some(0.0)), preset.name == "default", "{} {law}", preset.name);
                assert!(row.is_none_or(|r| results.verdict(r).is_none()), "the paper has no number for {law}");
            }
        }
    }
}

/// The preset `delay_a` is called like the test `delay`: its figures belong to their own tests all the same.
#[test]
fn no_figure_is_on_the_page_twice() {
    let dir = folder();
    let request = Request { preset: Some("delay_a".to_owned()), ..request("delay", dir.path()) };
    run(&request).unwrap();
    let page = fs::read_to_string(dir.path().join("index.html")).unwrap();
    let titles: Vec<&str> =
        page.split("role=\"img\"><title>").skip(1).map(|t| t.split("</title>").next().unwrap()).collect();
    assert!(titles.len() >= 4);
    assert_eq!(titles.iter().collect::<BTreeSet<_>>().len(), titles.len(), "{titles:?}");
}

/// The seeds are at least the twenty that the spread stands for.
#[test]
fn noise_has_at_least_twenty_seeds() {
    const { assert!(sumo_mfc::paper::SEEDS >= 20) };
}

/// Section 5.2 has words and no numbers. A slow sinusoid bears them out under the preset that matches the most; a short
/// one does not under the default preset.
#[test]
fn val_the_words_on_the_sinusoid_are_judged_by_its_numbers() {
    let dir = folder();
    let judged = |preset: &str| {
        let request = Request { preset: Some(preset.to_owned()), ..request("sine", dir.path()) };
        let results = run(&request).unwrap();
        let of = |test: &str, quantity: &str| {
            let rows = ["classic", "adaptive"].map(|c| results.get(test, preset, false, c, quantity).unwrap());
            (rows.map(|r| r.value.unwrap_or(f64::INFINITY)), results.verdict(rows[1]).unwrap())
        };
        ["sine", "sine_200m"]
            .map(|test| ["error_rms_converged", "settling_1", "overshoot_1"].map(|quantity| of(test, quantity)))
    };
    let [[rms, settling, overshoot], _] = judged("best");
    assert_eq!((rms.1, settling.1), (Verdict::Partly, Verdict::Reproduced));
    // From where each has converged; the launch from rest would make any two laws alike.
    assert!((1.1..1.25).contains(&(rms.0[0] / rms.0[1])) && rms.0[0] < 0.2, "{rms:?}");
    assert!(settling.0[1] < 0.9 * settling.0[0], "{settling:?}");
    assert_eq!(overshoot.1, Verdict::Partly, "{overshoot:?}");
    assert!(overshoot.0[1] <= 0.5 * overshoot.0[0] && overshoot.0[1] > 2.0, "{overshoot:?}");
    let [_, [rms, settling, overshoot]] = judged("default");
    assert_eq!([rms.1, settling.1, overshoot.1], [Verdict::NotReproduced; 3]);
    assert!(overshoot.0[1] > overshoot.0[0], "the short one is where adaptation harms: {overshoot:?}");
}

/// A verdict follows the criterion, on either side of it.
#[test]
fn claims_in_words_are_judged_by_their_criteria() {
    let row = |test: &str, controller, quantity, value: Option<f64>| Row {
        test: test.to_owned(),
        preset: "p".to_owned(),
        noise: false,
        controller,
        quantity,
        value,
        spread: None,
        unit: "1",
    };
    use Verdict::{NotReproduced, Partly, Reproduced};
    for (test, quantity, classic, adaptive, wanted) in [
        ("step", "undershoot_1", Some(8.0), Some(3.9), Reproduced),
        ("step", "undershoot_1", Some(8.0), Some(4.1), Partly),
        ("step", "undershoot_1", Some(8.0), Some(8.0), NotReproduced),
        ("step", "alpha_nominal_share", Some(1.0), Some(0.51), Reproduced),
        ("step", "alpha_nominal_share", Some(1.0), Some(0.45), Partly),
        ("step", "alpha_nominal_share", Some(1.0), Some(0.3), NotReproduced),
        ("sine", "error_rms_converged", Some(1.0), Some(0.8), Partly),
        ("sine", "error_rms_converged", Some(1.0), Some(1.4), NotReproduced),
        ("sine", "error_rms_converged", Some(1.0), None, NotReproduced),
        ("sine", "settling_1", None, Some(90.0), Reproduced),
        ("sine", "settling_1", Some(90.0), None, NotReproduced),
        ("sine", "overshoot_1", Some(3.0), Some(1.9), Reproduced),
        ("sine", "overshoot_1", Some(6.0), Some(2.9), Partly),
        ("sine", "overshoot_1", Some(6.0), Some(3.1), NotReproduced),
    ] {
        let rows = vec![row(test, "classic", quantity, classic), row(test, "adaptive", quantity, adaptive)];
        let results = Results { rows, ..Results::default() };
        assert_eq!(results.verdict(&results.rows[1]), Some(wanted), "{test} {quantity} {classic:?} {adaptive:?}");
        let tally = results.tally("p", "");
        assert_eq!(tally.numbers.all(), 0, "no number is published");
        assert!(tally.claims.all() >= 1 && (wanted != Reproduced || tally.claims.reproduced >= 1), "{tally:?}");
    }
    // Absolute bounds: a law that follows badly anyhow rejects nothing.
    for (rms, wanted) in [(0.3, Reproduced), (0.4, Partly), (0.8, NotReproduced)] {
        let disturbed = ["disturb", "disturb_grade_plus_5"].map(|test| row(test, "adaptive", "error_rms", Some(rms)));
        let results = Results { rows: disturbed.to_vec(), ..Results::default() };
        assert_eq!(results.verdict(&results.rows[0]), None, "what is undisturbed claims nothing");
        assert_eq!(results.verdict(&results.rows[1]), Some(wanted));
        assert!(results.tally("p", "").is_empty(), "the paper shows no disturbances");
    }
}

/// A number within a factor of 2, with half of the published gain, is partly the published one; further away it is not.
#[test]
fn numbers_are_partly_reproduced_within_a_factor_of_two() {
    let row = |controller, value: f64| Row {
        test: "delay".to_owned(),
        preset: "p".to_owned(),
        noise: true,
        controller,
        quantity: "error_rms",
        value: Some(value),
        spread: None,
        unit: "m/s",
    };
    use Verdict::{NotReproduced, Partly, Reproduced};
    // Published: 2.27 and 0.68, a gain of 0.70.
    for (classic, adaptive, wanted) in [
        (2.3, 0.7, [Reproduced, Reproduced]),
        (1.4, 0.5, [Partly, Partly]),
        (1.0, 0.3, [NotReproduced, NotReproduced]),
        (1.2, 0.3, [Partly, NotReproduced]),
        (4.5, 1.4, [Partly, NotReproduced]),
        (1.4, 1.1, [NotReproduced, NotReproduced]),
    ] {
        let results = Results { rows: vec![row("classic", classic), row("adaptive", adaptive)], ..Results::default() };
        let verdicts = [0, 1].map(|i| results.verdict(&results.rows[i]).unwrap());
        assert_eq!(verdicts, wanted, "{classic} {adaptive}");
    }
}

/// Fourteen numbers, of which ten are facts, and ten claims: for each recording, and not once for each of them.
#[test]
fn the_papers_numbers_are_counted_once_per_recording() {
    let dir = folder();
    let file = dir.path().join("short.csv");
    let rows: String = (0..=40).map(|t| format!("{t},{}\n", 10 + t % 3)).collect();
    fs::write(&file, format!("t_s,v_mps\n{rows}")).unwrap();
    let results = run(&Request { driver: Some(file), ..request("all", dir.path()) }).unwrap();
    let tally = results.tally("default", "");
    assert_eq!([tally.numbers.all(), tally.facts.all(), tally.claims.all()], [14, 10, 10], "{tally:?}");
    assert_eq!(results.tally("default", "_udds").numbers.all(), 6, "of the steps");
    let counts = fs::read_to_string(dir.path().join("counts.csv")).unwrap();
    let mut lines = counts.lines();
    assert!(lines.next().unwrap().starts_with("preset,recording,numbers,numbers_partly,numbers_driven,facts,"));
    let (numbers, facts, claims) = (tally.numbers, tally.facts, tally.claims);
    let counted =
        [numbers, facts, claims].map(|count| format!("{},{},{}", count.reproduced, count.partly, count.all()));
    assert_eq!(lines.collect::<Vec<_>>(), [format!("default,driver,{}", counted.join(","))]);
    let told = format!("{:>2} of 14 numbers, {:>2} of 10 facts", numbers.reproduced, facts.reproduced);
    assert!(results.table().contains(&told), "{}", results.table());
    let page = fs::read_to_string(dir.path().join("index.html")).unwrap();
    let table = page.split("id=\"fourteen-table\"").nth(1).expect("the table of the fourteen numbers");
    let table = table.split("</table>").next().unwrap();
    assert_eq!(table.matches("<tr").count(), 1 + 14 + 3, "a head, the numbers, the counts");
    assert!(table.contains(&format!("{} + {} of 14", numbers.reproduced, numbers.partly)));
}

/// All fourteen numbers hold for two presets on the lap that they were found on; on laps that the search never saw they hold for
/// `printed` (seed 3), or twelve do (seed 4): the two that are left say how far the classic law is off.
#[test]
fn val_the_presets_meet_the_papers_numbers() {
    let dir = folder();
    for (name, seed, elsewhere) in [("best", 4, 6), ("printed", 3, 8)] {
        let driven = |out: &str, test: &str, driver: Option<PathBuf>| {
            let preset = Some(name.to_owned());
            run(&Request { preset, driver, ..request(test, &dir.path().join(name).join(out)) }).unwrap()
        };
        let steps = driven("step", "step", None).tally(name, "").numbers;
        assert_eq!([steps.reproduced, steps.all()], [6, 6], "{name}");
        let on_the_road = |driver: Option<PathBuf>| {
            let tallies = ["driver", "delay"].map(|test| driven(test, test, driver.clone()).tally(name, "").numbers);
            [tallies[0].reproduced + tallies[1].reproduced, tallies[0].all() + tallies[1].all()]
        };
        assert_eq!(on_the_road(None), [8, 8], "{name}");
        let (other, _) = paper::record(&dir.path().join("lap"), seed).unwrap();
        assert_eq!(on_the_road(Some(other)), [elsewhere, 8], "{name}, lap of seed {seed}");
    }
}

/// The lap that is shipped is what the command makes; other seeds make other laps.
#[test]
fn val_the_shipped_lap_is_what_the_command_records() {
    let dir = folder();
    let record = |seed: &str| {
        let out = dir.path().join(seed);
        let printed = command().args(["paper", "record", "--seed", seed, "-o"]).arg(&out).assert().success();
        let printed = String::from_utf8(printed.get_output().stdout.clone()).unwrap();
        assert!(printed.contains(&format!("lap of seed {seed} ")) && printed.contains("racing driver"), "{printed}");
        fs::read_to_string(out.join("lap.csv")).unwrap()
    };
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/paper/data/handling_lap.csv");
    assert!(record("1") == fs::read_to_string(shipped).unwrap());
    assert!(record("1") != record("2"));
    let demands = paper::demand::all();
    assert!((0.5..=0.7).contains(&demands[0].accel_rms), "brisk: {:?}", demands[0]);
    // It asks for what a lap that somebody drove by hand on a handling course asks for.
    type Value = fn(&Demand) -> f64;
    let of = |of: Value, name: &str| of(demands.iter().find(|d| d.recording.contains(name)).unwrap());
    let alike: [(&str, Value); 4] = [
        ("mean speed", |d| d.speed_mean),
        ("acceleration", |d| d.accel_rms),
        ("jerk", |d| d.jerk_rms),
        ("braking", |d| d.braking),
    ];
    for (what, value) in alike {
        let ratio = of(value, "our lap") / of(value, "handling course");
        assert!((0.85..1.15).contains(&ratio), "{what}: {ratio}");
    }
}

#[test]
fn law_the_same_bytes_on_any_number_of_threads() {
    let outputs = [1, 2].map(|threads| {
        let dir = folder();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&request("step", dir.path()))).unwrap();
        ["results.csv", "index.html", "series/default_step_adaptive.csv", "figures/default_step_alpha.svg"]
            .map(|name| fs::read(dir.path().join(name)).unwrap())
    });
    assert!(outputs[0] == outputs[1]);
}

/// Derived in docs/overshoot-ratio.md.
#[test]
fn law_overshoots_are_in_the_ratio_two_roots_of_period_over_window() {
    let dir = folder();
    let lab = lab(dir.path());
    let preset = lab.library.find("default").unwrap();
    // Shorter periods take long in unoptimised builds.
    let quick = |p: &law::Point| !cfg!(debug_assertions) || p.period_s >= 0.005;
    for point in law::points().into_iter().filter(quick) {
        let measured = point.measured(&lab, preset).unwrap();
        let apart = measured - point.predicted();
        assert!(apart.abs() < 0.04, "{point:?}: {measured}, predicted {}", point.predicted());
    }
}

/// ε and lag of a preset shift the ratio: the law is measured under the default preset, whichever is asked for.
#[test]
fn the_law_does_not_depend_on_the_preset_that_is_asked_for() {
    let dir = folder();
    let results = run(&Request { preset: Some("best".to_owned()), ..request("step", dir.path()) }).unwrap();
    let lab = lab(dir.path());
    let point = law::points().into_iter().find(|p| (p.period_s, p.window_s) == (0.01, 0.1)).unwrap();
    let measured = |preset: &str| point.measured(&lab, lab.library.find(preset).unwrap()).unwrap();
    let row = results.get("law_dt0.01_T0.1_kp8_m1719_a4_alpha1", "none", false, "adaptive", "overshoot_ratio").unwrap();
    assert_eq!(row.value, Some(measured("default")));
    assert!((measured("best") - measured("default")).abs() > 0.02, "it would show");
}

#[test]
fn the_page_has_all_figures_and_needs_no_network() {
    let dir = folder();
    run(&request("step", dir.path())).unwrap();
    let page = fs::read_to_string(dir.path().join("index.html")).unwrap();
    for trace in ["http:", "https:", "src=", "@import", "url(", "<script"] {
        assert!(!page.contains(trace), "the page reaches outside: {trace}");
    }
    assert!(page.contains("default-src 'none'") && page.contains("prefers-color-scheme:dark"));
    for link in page.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(page.contains(&format!("id=\"{link}\"")), "a link to {link}, which is not there");
    }
    let figures: Vec<PathBuf> = fs::read_dir(dir.path().join("figures")).unwrap().map(|f| f.unwrap().path()).collect();
    assert!(figures.len() >= 5, "{figures:?}");
    for figure in figures {
        let text = fs::read_to_string(&figure).unwrap();
        assert!(text.starts_with("<svg xmlns="), "{figure:?}");
        let mut reader = quick_xml::Reader::from_str(&text);
        while !matches!(reader.read_event().unwrap(), quick_xml::events::Event::Eof) {}
        let title = text.split("<title>").nth(1).unwrap().split("</title>").next().unwrap();
        assert!(page.contains(title), "{figure:?} is not on the page");
    }
}

#[test]
fn somebodys_own_recording_is_driven() {
    let dir = folder();
    let file = dir.path().join("mine.csv");
    let rows: String = (0..=600).map(|k| format!("{},{},0,0.02\n", 0.1 * f64::from(k), 12.0)).collect();
    fs::write(&file, format!("t_s,vx_mps,vy_mps,yaw_rate_radps\n{rows}")).unwrap();
    let out = dir.path().join("out");
    command()
        .args(["paper", "driver", "--preset", "default", "--driver"])
        .arg(&file)
        .arg("-o")
        .arg(&out)
        .assert()
        .success()
        .stdout(predicate::str::contains("index.html"))
        .stdout(predicate::str::contains("mine.csv: 601 samples, 0.1000 s apart (median), averaged over 10 samples"));
    let text = fs::read_to_string(out.join("results.csv")).unwrap();
    assert!(text.contains("driver,default,on,adaptive,error_rms,"), "{text}");
    assert!(text.contains("driver_path,default,off,classic,error_rms,"), "a yaw rate gives a path: {text}");
    assert!(!text.contains("udds"), "{text}");
    assert!(fs::read_to_string(out.join("index.html")).unwrap().contains("mine.csv"));
}

#[test]
fn what_is_wrong_is_named() {
    let dir = folder();
    let file = dir.path().join("bad.csv");
    fs::write(&file, "t_s,vx_mps\n0,5\n1,fast\n").unwrap();
    let bad_file = file.to_string_lossy().into_owned();
    for (arguments, wanted) in [
        (vec!["paper", "stepp"], "did you mean \"step\""),
        (vec!["paper", "step", "--preset", "defualt"], "did you mean \"default\""),
        (vec!["paper", "step", "--set", "controller.kp=1"], "controller.k_p"),
        (vec!["paper", "step", "--set", "controller.k_p=fast"], "wanted a number"),
        (
            vec!["paper", "driver", "--set", "controller.name=pid"],
            "wanted none: the tests drive adaptive, classic, pid",
        ),
        (
            vec!["paper", "step", "--set", "controller.k_i=1"],
            "other laws than those that are driven: adaptive, classic",
        ),
        (vec!["paper", "delay", "--preset", "best", "--set", "controller.k_i=1"], "that are driven: adaptive, classic"),
        (vec!["paper", "driver", "--driver", "/no/such/file.csv"], "/no/such/file.csv"),
        (vec!["paper", "driver", "--driver", &bad_file], "bad.csv:3"),
    ] {
        command()
            .args(&arguments)
            .arg("-o")
            .arg(dir.path().join("out"))
            .assert()
            .code(1)
            .stdout("")
            .stderr(predicate::str::contains(wanted));
    }
}

#[test]
fn settings_reach_the_laws_that_have_them() {
    let dir = folder();
    let set = |out: &str, setting: &str| {
        let out = dir.path().join(out);
        command().args(["paper", "step", "--preset", "default", "--set", setting, "-o"]).arg(&out).assert().success();
        fs::read_to_string(out.join("results.csv")).unwrap()
    };
    let (plain, epsilon) = (set("plain", "sumo.seed=23423"), set("epsilon", "controller.epsilon=5.0"));
    let of = |text: &str, controller: &str| -> Vec<String> {
        text.lines().filter(|l| l.contains(controller) && l.starts_with("step")).map(str::to_owned).collect()
    };
    assert_eq!(of(&plain, ",classic,"), of(&epsilon, ",classic,"), "classic has no epsilon");
    assert_ne!(of(&plain, ",adaptive,"), of(&epsilon, ",adaptive,"));
}

/// Which laws are driven is up to the test: disturbances are met by every law, under every preset.
#[test]
fn a_setting_of_one_law_is_taken_where_that_law_is_driven() {
    let dir = folder();
    let mut command = command();
    command.args(["paper", "disturb", "--preset", "best", "--set", "controller.k_i=0.5", "-o"]).arg(dir.path());
    command.assert().success().stdout(predicate::str::contains("k_i=0.5: for pid, smith_pi; not a key of adaptive"));
}

/// A gain that several laws have is set on all of them, and the rest is told.
#[test]
fn settings_reach_every_law_of_a_recording() {
    let dir = folder();
    let set = |setting: &str| {
        let out = dir.path().join(setting);
        let mut command = command();
        command.args(["paper", "disturb", "--preset", "default", "--set", setting, "-o"]).arg(&out);
        let said = String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap();
        (said, fs::read_to_string(out.join("results.csv")).unwrap())
    };
    let ((nothing, plain), (said, gain)) = (set("sumo.seed=23423"), set("controller.k_p=0.7"));
    let line = "controller.k_p=0.7: for adaptive, classic, pid, calibrating, smith_pi; not a key of lqi, mpc";
    assert!(said.contains(line) && !nothing.contains("not a key of"), "{said}");
    for law in ["classic", "adaptive", "calibrating", "pid", "smith_pi", "lqi", "mpc"] {
        let of = |text: &str| -> Vec<String> {
            text.lines().filter(|l| l.contains(&format!(",{law},"))).map(str::to_owned).collect()
        };
        assert_eq!(of(&plain) != of(&gain), !["lqi", "mpc"].contains(&law), "{law}");
    }
}

/// The program carries the scenario files, so that it works outside a clone.
#[test]
fn law_the_carried_files_are_those_of_the_repository() {
    let (dir, empty) = (folder(), folder());
    let spare = dir.path().join("spare");
    let ours = Library::open(&spare, &[]).unwrap();
    assert!(!spare.exists(), "inside the repository its own files are read");
    command().current_dir(empty.path()).args(["paper", "step", "--preset", "default", "-o", "out"]).assert().success();
    let carried = empty.path().join("out/scenarios");
    let names = |folder: &Path| -> BTreeSet<PathBuf> {
        fs::read_dir(folder).unwrap().map(|f| f.unwrap().file_name().into()).collect()
    };
    assert_eq!(names(&carried.join("presets")), names(&ours.folder().join("presets")));
    for file in ["vehicle.toml", "step.toml", "presets/default.toml", "data/udds.csv"] {
        assert_eq!(fs::read(carried.join(file)).unwrap(), fs::read(ours.folder().join(file)).unwrap(), "{file}");
    }
}

#[test]
fn law_a_map_that_was_broken_off_goes_on_to_the_same_bytes() {
    let (dir, broken) = (folder(), folder());
    let make = |out: &Path| {
        let lab = lab(out);
        let preset = lab.library.find("default").unwrap().clone();
        let grid = map::Grid { periods_s: vec![0.02], ..map::Grid::coarse() };
        map::run(&lab, &preset, out, &grid, false).unwrap();
        fs::read_to_string(out.join("map.csv")).unwrap()
    };
    let whole = make(dir.path());
    assert!(whole.lines().count() > 10);
    assert!(!dir.path().join("map.csv.part").exists());
    // Half of it is there, the last line only in part; so little is left that a job in its middle is cut.
    for share in [2, 3, 5] {
        let _ = fs::remove_file(broken.path().join("map.csv"));
        fs::write(broken.path().join("map.csv.part"), &whole[..whole.len() / share]).unwrap();
        assert_eq!(make(broken.path()), whole, "1/{share} was there");
    }
    // What belongs to other settings is not taken over.
    let foreign = whole.replacen("# ", "# 0", 1).replace("classic", "pid");
    fs::write(broken.path().join("map.csv"), foreign).unwrap();
    assert_eq!(make(broken.path()), whole);
}

#[test]
fn the_map_is_drawn_for_every_delay() {
    let dir = folder();
    let results = run(&request("map", dir.path())).unwrap();
    for name in ["map_rms_delay0_limit5.3", "map_overshoot_delay0.25_limit5.3"] {
        assert!(dir.path().join("figures").join(format!("{name}.svg")).is_file(), "{name}");
    }
    let share = |quantity: &str| results.get("map", "default", true, "adaptive", quantity).unwrap().value.unwrap();
    assert!((0.0..=1.0).contains(&(share("rms_better_by_5_percent_share") + share("rms_worse_by_5_percent_share"))));
    let lab = lab(dir.path());
    let is_there = |preset: &str, grid: &map::Grid| {
        map::is_there(&lab, lab.library.find(preset).unwrap(), dir.path(), grid).unwrap()
    };
    assert!(is_there("default", &map::Grid::coarse()));
    assert!(!is_there("best", &map::Grid::coarse()) && !is_there("default", &map::Grid::whole()), "not this map");
}

/// The shares of the map, against those that are worked out here from the cells alone.
#[test]
fn law_the_maps_shares_are_what_its_cells_say() {
    let dir = folder();
    let results = run(&request("map", dir.path())).unwrap();
    let text = fs::read_to_string(dir.path().join("map.csv")).unwrap();
    // Where (Δt, K_P, scale, limit, delay), RMS error, overshoot
    let of_law = |law: &str| -> BTreeMap<String, [Option<f64>; 2]> {
        let lines = text.lines().filter_map(|line| line.strip_prefix(&format!("{law},")));
        let cell = |line: &str| {
            let fields: Vec<&str> = line.split(',').collect();
            (fields[..5].join(","), [5, 6].map(|k| fields[k].parse().ok()))
        };
        lines.map(cell).collect()
    };
    let (classic, adaptive) = (of_law("classic"), of_law("adaptive"));
    assert!(classic.len() > 10 && classic.keys().eq(adaptive.keys()));
    // Every axis acts.
    for axis in 0..5 {
        let others = |at: &str| {
            at.split(',').enumerate().filter(|(k, _)| *k != axis).map(|(_, v)| v.to_owned()).collect::<Vec<_>>()
        };
        let differ = |a: (&String, &[Option<f64>; 2]), b: (&String, &[Option<f64>; 2])| {
            others(a.0) == others(b.0) && a.1[0] != b.1[0]
        };
        let acts = classic.iter().any(|a| classic.iter().any(|b| differ(a, b)));
        assert!(acts || axis == 3, "column {axis} does nothing; the coarse map has one limit");
    }
    for (k, name, more) in [(0, "rms", 0.0), (1, "overshoot", 1.0)] {
        let ratio = |(at, cell): (&String, &[Option<f64>; 2])| Some((cell[k]? + more) / (classic[at][k]? + more));
        let ratios: Vec<f64> = adaptive.iter().filter_map(ratio).collect();
        let share = |is_meant: &dyn Fn(f64) -> bool| {
            ratios.iter().filter(|r| is_meant(**r)).count() as f64 / ratios.len() as f64
        };
        for (word, wanted) in [("better", share(&|r| r * 1.05 < 1.0)), ("worse", share(&|r| r / 1.05 >= 1.0))] {
            let quantity = format!("{name}_{word}_by_5_percent_share");
            let found = results.get("map", "default", true, "adaptive", &quantity).unwrap().value.unwrap();
            assert!((found - wanted).abs() < 1e-12, "{quantity}: {found} instead of {wanted}");
            let told = format!("{name} {word} by 5 percent in {:.0} %", 100.0 * wanted);
            assert!(results.table().contains(&told), "{told}");
        }
    }
    // The map is there, so that nothing is computed again; the command tells the same.
    let printed = command().args(["paper", "map", "--coarse", "--preset", "default", "-o"]).arg(dir.path()).assert();
    printed.success().stdout(predicate::str::contains(results.table()));
}

/// A disturbance that is no step for the body cannot be told from none; a mass of one and a half can.
#[test]
fn disturbances_act() {
    let dir = folder();
    let results = run(&request("disturb", dir.path())).unwrap();
    let rms = |suffix: &str, controller: &str| {
        results.get(&format!("disturb{suffix}"), "default", false, controller, "error_rms").unwrap().value.unwrap()
    };
    for controller in ["classic", "adaptive", "calibrating", "pid"] {
        let undisturbed = rms("", controller);
        for suffix in ["_mass_plus_50", "_mass_minus_50", "_grade_plus_5", "_headwind_15", "_stiffness_minus_30"] {
            assert_ne!(rms(suffix, controller), undisturbed, "{controller} {suffix}");
        }
    }
    // What torque or tyres cannot do is left out: under the weakest preset half a load more.
    let weak = run(&Request { preset: Some("step4".to_owned()), ..request("disturb", dir.path()) }).unwrap();
    let is_there = |results: &Results, suffix: &str| results.rows.iter().any(|r| r.test == format!("disturb{suffix}"));
    for suffix in ["_mass_plus_50", "_grade_plus_5"] {
        assert!(is_there(&results, suffix) && !is_there(&weak, suffix), "{suffix}");
    }
    assert!(is_there(&weak, "") && is_there(&weak, "_stiffness_plus_30"));
}
