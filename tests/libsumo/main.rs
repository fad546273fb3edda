//! SUMO in the process of the program: the same results as over TraCI, to the byte, and what happens when it cannot be.

#[allow(dead_code, reason = "the other tests against SUMO use the rest")]
#[path = "../live/support.rs"]
mod support;

mod ends;
mod same;

use std::process::Command;

use support::{Ended, NEW, OLD, Running, foreign, own, program, refusal, repository, run, run_command, sumo_home};

/// The further arguments of a run in this process, behind those.
fn here<'a>(args: &[&'a str]) -> Vec<&'a str> {
    [args, &["--backend", "libsumo"]].concat()
}

/// What a process said, on one line: long messages are wrapped and indented.
fn words(said: &str) -> String {
    said.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

/// SUMO prints nothing on our stdout or stderr, however talkative it is.
#[test]
fn what_sumo_prints_is_in_its_log_only() {
    let loud = ["--", "--verbose", "true", "--no-step-log", "false", "--step-log.period", "1", "--print-options"];
    let quiet = run(NEW, &own("light"), &[&here(&["--quiet", "--no-report"])[..], &loud].concat());
    assert_eq!((quiet.ended.stdout.as_str(), quiet.ended.stderr.as_str()), ("", ""));
    let log = String::from_utf8(quiet.bytes("sumo/console.log")).unwrap();
    for word in ["Options set:", "Loading net-file", "Simulation ended at time"] {
        assert!(log.contains(word), "{word} is not in\n{log}");
    }
    // PROJ, which SUMO links, is a library in C with a stderr of its own.
    let geographic = run(NEW, &foreign("cologne1"), &here(&["--quiet", "--no-report", "--end", "25201"]));
    assert_eq!((geographic.ended.stdout.as_str(), geographic.ended.stderr.as_str()), ("", ""));
    let spoken = run(NEW, &own("light"), &[&here(&["--export", "csv", "--no-report"])[..], &loud].concat());
    let over_traci = run(NEW, &own("light"), &[&["--export", "csv", "--no-report"][..], &loud].concat());
    let without_times = |text: &str| text.lines().filter(|l| !l.contains("wall") && !l.contains("real_time")).count();
    assert!(spoken.ended.stdout.len() > 20, "{}", spoken.ended.stdout);
    assert_eq!(without_times(&spoken.ended.stdout), without_times(&over_traci.ended.stdout));
    assert!(!spoken.ended.stdout.contains("Step #"), "{}", spoken.ended.stdout);
}

/// What only TraCI can do is refused where it is asked for in this process, and done over TraCI where that is left open.
#[test]
fn what_needs_traci_is_refused() {
    for (args, said) in [
        (&["--num-clients", "2"][..], "other clients reach SUMO over TraCI alone"),
        (&["--connect", "127.0.0.1:1"], "--connect joins a SUMO that runs elsewhere"),
        (&["--gui"], "sumo-gui runs in a process of its own"),
        (&["--port", "40123"], "a port is one of TraCI"),
    ] {
        let refused = refusal(NEW, &own("light"), &here(args));
        assert!(refused.contains(said) && refused.contains("--backend traci"), "{args:?}: {refused}");
    }
    let open = run(NEW, &own("light"), &["--backend", "auto", "--port", "40124", "-v"]);
    assert!(!open.ended.stderr.contains("loading SUMO in this process"), "{}", open.ended.stderr);
    assert!(open.ended.stderr.contains("started SUMO"), "{}", open.ended.stderr);
    let free = run(NEW, &own("light"), &["--backend", "auto", "-v"]);
    assert!(free.ended.stderr.contains("loading SUMO in this process"), "{}", free.ended.stderr);
}

/// A SUMO without the library beside it, and one of another version: one clear error, or TraCI where that is left open.
#[test]
fn a_library_that_is_missing_or_another_one_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("bin")).unwrap();
    let alone = folder.path().join("bin/sumo");
    std::os::unix::fs::symlink(sumo_home(NEW).join("bin/sumo"), &alone).unwrap();
    let run_with = |version: &str, binary: Option<&std::path::Path>, backend: &str| {
        let dir = folder.path().join("result");
        let mut command = run_command(version, &own("light"), &dir, &["--backend", backend, "--force", "--no-report"]);
        binary.map(|binary| command.env("SUMO_BINARY", binary));
        Running::start(command).wait()
    };
    for (version, binary, told) in [
        (NEW, Some(alone.as_path()), "no libsumocpp.so beside"),
        (OLD, None, "libsumocpp.so is of another version or compiler, and this program was built for SUMO 1.28.0"),
    ] {
        let refused = run_with(version, binary, "libsumo");
        assert_eq!(refused.code, Some(1), "{}", refused.stdout);
        let said = words(&refused.stderr);
        assert!(said.contains(told) && said.contains("--backend traci"), "{said}");
        let left_open = run_with(version, binary, "auto");
        assert_eq!(left_open.code, Some(0), "{}", left_open.stderr);
        let notes: Vec<&str> = left_open.stderr.lines().filter(|line| line.contains("process of its own")).collect();
        assert!(notes.len() == 1 && notes[0].contains(told), "{}", left_open.stderr);
    }
}

/// `doctor` says whether the library is there.
#[test]
fn doctor_knows_the_library() {
    let doctor = |version: &str| {
        let mut command = program(version);
        command.arg("doctor");
        let ended = Running::start(command).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stdout);
        ended.stdout
    };
    let line = |text: &str| text.lines().find(|line| line.contains("SUMO in this process")).unwrap().to_owned();
    let (new, old) = (line(&doctor(NEW)), line(&doctor(OLD)));
    assert!(new.starts_with("ok") && new.contains("SUMO 1.28.0, for --backend libsumo"), "{new}");
    assert!(old.starts_with("ok") && old.contains("no: ") && old.contains("another version"), "{old}");
}

/// Cases of studies are processes, so each has a SUMO of its own, and the tables do not show which way it was reached.
#[test]
fn studies_have_the_same_tables() {
    let folder = tempfile::tempdir().unwrap();
    let study = |backend: &str, dir: &str| -> Ended {
        let mut command: Command = program(NEW);
        command.args(["compare", "--controllers", "plain,ideal,adaptive", "--seeds", "1..2", "--end", "100", "-q"]);
        command.args(["--backend", backend, "-o"]).arg(folder.path().join(dir)).arg(repository("scenarios/city.toml"));
        Running::start(command).wait()
    };
    for (backend, dir) in [("traci", "a"), ("libsumo", "b")] {
        let ended = study(backend, dir);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(0), ""), "{}", ended.stderr);
    }
    let bytes = |dir: &str, name: &str| std::fs::read(folder.path().join(dir).join(name)).unwrap();
    for name in ["comparison.csv", "vehicles.parquet"] {
        assert!(bytes("a", name) == bytes("b", name), "{name} differs");
    }
    // Who is asked again has nothing to do: a case is the same whichever way SUMO is reached.
    let mut command: Command = program(NEW);
    command.args(["compare", "--controllers", "plain,ideal,adaptive", "--seeds", "1..2", "--end", "100", "--status"]);
    command.arg("-o").arg(folder.path().join("b")).arg(repository("scenarios/city.toml"));
    let status = Running::start(command).wait();
    assert!(status.stdout.contains("6 done, 0 failed, 0 missing"), "{}", status.stdout);
    let refused = {
        let mut command = program(OLD);
        command.args([
            "compare",
            "--controllers",
            "ideal",
            "--seeds",
            "1",
            "--end",
            "10",
            "--backend",
            "libsumo",
            "-q",
        ]);
        command.arg("-o").arg(folder.path().join("c")).arg(repository("scenarios/city.toml"));
        Running::start(command).wait()
    };
    assert_eq!(refused.code, Some(1), "{}", refused.stdout);
}
