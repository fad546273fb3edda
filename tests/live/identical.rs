//! The ideal controller gives SUMO its own speeds back, and that changes nothing at all.

use crate::support::{NEW, OLD, elements, foreign, own, plain_sumo, run};
use std::path::Path;

/// Every `<tripinfo>` of our run against that of SUMO alone with the same options.
fn changes_nothing(version: &str, config: &Path, step: &str, end: &str) {
    let what = format!("SUMO {version}, {}, step {step}", config.display());
    let folder = tempfile::tempdir().unwrap();
    let plain = folder.path().join("tripinfo.xml");
    plain_sumo(
        version,
        &[
            "-c",
            config.to_str().unwrap(),
            "--step-length",
            step,
            "--step-method.ballistic",
            "true",
            "--seed",
            "23423",
            "--end",
            end,
            "--precision",
            "6",
            "--tripinfo-output",
            plain.to_str().unwrap(),
            "--tripinfo-output.write-unfinished",
            "true",
        ],
    );
    let args = ["--controller", "ideal", "--step-length", step, "--end", end, "--", "--precision", "6"];
    let ours = run(version, config, &args);
    let [ours, plain] = [ours.dir.join("sumo/tripinfo.xml"), plain].map(|path| elements(&path, "tripinfo"));
    assert!(plain.len() > 100, "{what}: only {} trips", plain.len());
    assert_eq!(ours.len(), plain.len(), "{what}");
    for (ours, plain) in ours.iter().zip(&plain) {
        assert_eq!(ours, plain, "{what}");
    }
}

#[test]
fn law_ideal_changes_nothing_in_the_city() {
    changes_nothing(NEW, &own("city"), "0.1", "300");
    changes_nothing(NEW, &own("city"), "1", "600");
    changes_nothing(OLD, &own("city"), "0.1", "300");
    changes_nothing(OLD, &own("city"), "1", "600");
}

#[test]
fn law_ideal_changes_nothing_on_a_foreign_network() {
    changes_nothing(NEW, &foreign("cologne8"), "0.1", "25700");
    changes_nothing(NEW, &foreign("cologne8"), "1", "28800");
    changes_nothing(OLD, &foreign("cologne8"), "1", "28800");
    changes_nothing(OLD, &foreign("cologne1"), "0.1", "25700");
}
