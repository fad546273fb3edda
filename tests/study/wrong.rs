//! A wrong study is one clear error, before anything runs.

use std::fs;

use super::support::{Running, repository};
use super::{command, ended};

/// What `sweep` says to arguments that it must refuse.
fn refusal(args: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("study");
    let ended = ended("sweep", &dir, args);
    assert_eq!(ended.code, Some(1), "{args:?} should have failed:\n{}{}", ended.stdout, ended.stderr);
    assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
    assert!(!dir.exists(), "{args:?}: something was run");
    ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn wrong_arguments_are_refused() {
    for (args, wanted) in [
        (
            &["--vary", "controler.name=pid"][..],
            "--vary controler.name=pid: unknown key controler; did you mean controller?",
        ),
        (&["--vary", "controller.name=pid,idea"], "unknown controller \"idea\" (did you mean \"ideal\"?)"),
        (&["--vary", "controller.k_p=1,fast"], "controller.k_p: found \"fast\", wanted a number"),
        (&["--vary", "controller.k_p="], "found an empty list, wanted at least one value"),
        (&["--vary", "controller.k_p=3..1"], "or a range \"FIRST..LAST\" or \"FIRST..LAST..STEP\" that ascends"),
        (&["--vary", "controller.k_p"], "wanted KEY=VALUE"),
        (
            &["--vary", "controller.k_p=1,1.0"],
            "duplicate case: controller.k_p=1.0 is the same scenario as controller.k_p=1",
        ),
        (&["--vary", "controller.k_p=1,2", "--vary", "controller.k_p=3"], "varied in one place"),
        (&["--vary", "sumo.seed=1,2"], "a key that the study does not set itself"),
        (&["--seeds", "1,2,1"], "1 comes twice"),
        (&["--seeds", "5..1"], "5 comes after 1"),
        (
            &["--vary", "controller.k_p=1,2", "--reference", "controller.k_p=3"],
            "found 3, wanted one of the values of controller.k_p: 1, 2",
        ),
        (&["--reference", "controller.k_p=3"], "found 3, wanted a key that is varied"),
        (&["--executor", "slrm"], "unknown executor \"slrm\" (did you mean \"slurm\"?); known: local, slurm"),
        (
            &["--executor", "slurm", "--slurm", "partiton=night"],
            "--slurm partiton=night: unknown key slurm.partiton; did you mean slurm.partition?",
        ),
        (&["--executor", "slurm", "--slurm", "throttle=2G"], "slurm.throttle: found \"2G\", wanted a whole number"),
        (&["--executor", "slurm", "--shard", "1/2"], "--shard: found the executor slurm"),
        (&["--slurm", "time=30"], "--slurm: found the executor local"),
        (&["--shard", "4/3"], "--shard: found 4/3, wanted I/N with I from 1 to N"),
        (&["--gui"], "sumo.gui: found true, wanted false"),
        (&["--port", "4711"], "sumo.port: found 4711, wanted nothing"),
        (&["--vehicles-output", "v.parquet"], "output.vehicles: found v.parquet"),
        (&["--plan", "--collect"], "cannot be used with"),
        (
            &["--", "--tripinfo", "/tmp/all.xml"],
            "sumo.options: found --tripinfo-output, wanted no option that names files",
        ),
        (&["--", "--output-suffix", "x"], "sumo.options: found --output-suffix, wanted no option that names files"),
    ] {
        let said = refusal(&[&["scenarios/straight.toml"], args].concat());
        assert!(said.contains(wanted), "{args:?}: {said}");
    }
}

#[test]
fn wrong_files_are_refused_with_their_lines() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wrong.toml");
    let scenario = format!("scenario = {:?}\n", repository("scenarios/straight.toml"));
    let vary = "[[vary]]\n\"controller.k_p\" = [1, 2]\n";
    for (text, wanted) in [
        (format!("{scenario}sedes = \"1..3\"\n{vary}"), "wrong.toml:2: unknown key sedes; did you mean seeds?"),
        (format!("{scenario}seeds = \"1..\"\n{vary}"), "wrong.toml:2: seeds: found \"1..\", wanted 1..5 (five seeds)"),
        (vary.to_owned(), "scenario: found nothing, wanted the scenario that is varied"),
        (format!("scenario = \"no.toml\"\n{vary}"), "no.toml does not exist"),
        (
            format!("{scenario}[slurm]\ntime_s = 30\n{vary}"),
            "wrong.toml:3: unknown key slurm.time_s; did you mean slurm.time?",
        ),
        (format!("{scenario}[slurm]\ntime = 30\n{vary}"), "wrong.toml:3: slurm.time: found 30, wanted a text"),
        (format!("{scenario}vary = 3\n"), "wrong.toml:2: vary: found 3, wanted tables, each headed [[vary]]"),
        (format!("{scenario}[[vary]]\n"), "vary.0: found nothing, wanted a key"),
        (format!("{scenario}[[vary]]\ncontroller.k_p = []\n"), "wrong.toml:3: controller.k_p: found an empty list"),
        (format!("{scenario}[[vary]]\ncontroller.k_p = 3\n"), "wrong.toml:3: controller.k_p: found 3, wanted a list"),
        (
            format!("{scenario}{vary}\"noise.power_db\" = [1, 2, 3]\n"),
            "wrong.toml:2: vary.0: found 2 values of controller.k_p, 3 values of noise.power_db",
        ),
        (
            format!("{scenario}[[vary]]\n\"contoller.k_p\" = [1, 2]\n"),
            "wrong.toml:3: contoller.k_p = 1: unknown key contoller",
        ),
        (format!("{scenario}reference = {{ \"controller.k_p\" = 4 }}\n{vary}"), "reference.controller.k_p: found 4"),
        (format!("{scenario}reference = 4\n{vary}"), "wrong.toml:2: reference: found 4, wanted a table"),
    ] {
        fs::write(&file, &text).unwrap();
        let said = refusal(&[file.to_str().unwrap()]);
        assert!(said.contains(wanted), "{text}: {said}");
    }
}

#[test]
fn a_machine_without_slurm_is_told_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("study");
    let mut command = command("sweep", &dir, &["scenarios/straight.toml", "--executor", "slurm"]);
    command.env("PATH", folder.path());
    let ended = Running::start(command).wait();
    assert_eq!((ended.code, dir.exists()), (Some(1), false), "{}", ended.stderr);
    assert!(ended.stderr.contains("executor slurm: cannot start scontrol"), "{}", ended.stderr);
}
