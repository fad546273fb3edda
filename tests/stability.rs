//! `stability`: margins that are computed are found again by raising gain and delay; strings grow where theory says.

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

type Row = BTreeMap<String, String>;

fn stability(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::cargo_bin("sumo-mfc").unwrap();
    command.current_dir(folder).arg("stability").args(args);
    command
}

fn rows(path: &Path) -> Vec<Row> {
    csv::Reader::from_path(path).unwrap().deserialize().map(Result::unwrap).collect()
}

/// The tables of all laws behind two sets of actuators, made once.
static FOUND: LazyLock<[Vec<Row>; 3]> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    stability(folder.path(), &["-q", "--lag", "0", "--delay", "0,0.25", "-o", "out"]).assert().success();
    ["margins.csv", "strings.csv", "sweep.csv"].map(|name| rows(&folder.path().join("out").join(name)))
});

fn number(row: &Row, column: &str) -> Option<f64> {
    row[column].parse().ok()
}

#[test]
fn val_computed_margins_are_found_again_in_the_full_model() {
    let [margins, ..] = &*FOUND;
    let mut compared = 0;
    // In the full model `calibrating` learns the delay, and is another loop.
    for row in margins.iter().filter(|row| row["controller"] != "calibrating") {
        assert_eq!(row["stable"], "true", "{row:?}");
        for (computed, found) in [("gain_margin", "gain_margin_simulated"), ("delay_margin", "delay_margin_simulated")]
        {
            let Some(computed) = number(row, computed) else { continue };
            let found = number(row, found).unwrap_or_else(|| panic!("{row:?}"));
            // Variants are 4 % apart, or one period of 10 ms.
            assert!((found - computed).abs() < (0.06 * computed).max(0.011), "{row:?}");
            compared += 1;
        }
    }
    assert!(compared >= 18, "{compared}");
}

#[test]
fn law_a_model_of_the_dead_time_buys_margin() {
    let [margins, ..] = &*FOUND;
    let delay_margin = |controller: &str| {
        let row = margins.iter().find(|row| row["controller"] == controller && row["delay"] == "0.25").unwrap();
        number(row, "delay_margin").unwrap()
    };
    assert!(delay_margin("smith_pi") > delay_margin("pid") && delay_margin("lqi") > delay_margin("pid"));
}

#[test]
fn law_the_tail_of_a_string_has_the_gain_of_its_pairs() {
    let [_, strings, sweep] = &*FOUND;
    for row in strings.iter().filter(|row| row["delay"] == "0") {
        assert_eq!(row["settles"], "true", "{row:?}");
        // Production ACC is string unstable at its shortest time gap (Milanés and Shladover 2014).
        if row["upper"] == "ctg_acc" {
            assert!(number(row, "pair_gain").unwrap() > 1.2 && number(row, "tail_gain").unwrap() > 5.0, "{row:?}");
        }
    }
    let mut compared = 0;
    for row in sweep.iter().filter(|row| row["delay"] == "0" && number(row, "pair_gain").unwrap() > 0.8) {
        let (pair, tail) = (number(row, "pair_gain").unwrap(), number(row, "tail_gain").unwrap());
        assert!((tail.ln() - 10.0 * pair.ln()).abs() < 0.7, "ten pairs: {row:?}");
        compared += 1;
    }
    assert!(compared > 40, "{compared}");
}

#[test]
fn the_same_bytes_whatever_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |threads: &str| {
        let args =
            ["-q", "--controllers", "pid,mpc", "--uppers", "ctg_acc", "--lag", "0.1", "--delay", "0.1", "-o", threads];
        stability(folder.path(), &args).env("RAYON_NUM_THREADS", threads).assert().success();
        ["margins.csv", "strings.csv", "sweep.csv"]
            .map(|name| std::fs::read(folder.path().join(threads).join(name)).unwrap())
    };
    assert_eq!(bytes("1"), bytes("3"));
}

#[test]
fn what_has_no_loop_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for (args, told) in [
        (
            &["--controllers", "ideal", "--delay", "0", "--lag", "0"][..],
            "--controllers: found ideal, which drives no body",
        ),
        (&["--controllers", "pdi"], "pid"),
        (&["--uppers", "traffic", "--controllers", "pid"], "--uppers: found traffic, which keeps no gap"),
        (&["--delay", "9"], "wanted seconds from 0 to 5"),
    ] {
        let output = stability(folder.path(), args).assert().code(1).get_output().stderr.clone();
        let text = String::from_utf8(output).unwrap();
        assert!(text.contains(told), "{args:?}: {text}");
    }
}
