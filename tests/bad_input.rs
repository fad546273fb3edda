//! Wrong input ends with exit code 1, a message that says where and what, and no file left behind.

use std::{collections::BTreeSet, fs, path::Path};

use assert_cmd::Command;
use tempfile::TempDir;

/// A folder with a small scenario.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let nets = Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/light");
    for entry in fs::read_dir(nets).unwrap().flatten().filter(|e| e.path().is_file()) {
        fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    write(
        &folder,
        "scenario.toml",
        "[sumo]\nconfig = \"light.sumocfg\"\n\n[controller]\nname = \"classic\"\nk_p = 1.0\n",
    );
    folder
}

fn write(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).unwrap();
}

fn command(folder: &TempDir, arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("sumo-mfc").unwrap();
    command.current_dir(folder.path()).args(arguments);
    command
}

fn files(folder: &TempDir) -> BTreeSet<String> {
    fs::read_dir(folder.path()).unwrap().flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect()
}

/// Runs `sumo-mfc ARGUMENTS`, expects it to refuse, and its message to contain all of `parts`.
fn refused(folder: &TempDir, arguments: &[&str], parts: &[&str]) {
    let before = files(folder);
    let output = command(folder, arguments).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?} wrote to stdout");
    for part in parts {
        assert!(message.contains(part), "{arguments:?}: no \"{part}\" in\n{message}");
    }
    assert!(!message.contains("panicked"), "{message}");
    assert_eq!(files(folder), before, "{arguments:?} left a file behind");
}

/// Runs `sumo-mfc run` on a scenario of this text.
fn refused_scenario(text: &str, parts: &[&str]) {
    let folder = folder();
    write(&folder, "bad.toml", text);
    refused(&folder, &["run", "bad.toml"], parts);
}

#[test]
fn missing_files() {
    refused(&folder(), &["run", "nowhere.toml"], &["nowhere.toml: cannot be read"]);
    refused(&folder(), &["run", "nowhere.sumocfg"], &["nowhere.sumocfg: cannot be read"]);
    refused_scenario("[sumo]\n\nconfig = \"no.sumocfg\"", &["bad.toml:3: sumo.config: ", "no.sumocfg does not exist"]);
    refused_scenario(
        "[sumo]\nnet = \"light.net.xml\"\nroutes = [\"light.rou.xml\",\n  \"no.rou.xml\"]",
        &["bad.toml:3: sumo.routes: ", "no.rou.xml does not exist"],
    );
    refused_scenario(
        "[sumo]\nconfig = \"light.sumocfg\"\n[target]\nname = \"profile\"\nfile = \"no.csv\"",
        &["bad.toml:5: target.file: ", "no.csv does not exist"],
    );
    refused_scenario(
        "[sumo]\nconfig = \"${NO_SUCH_VARIABLE}/a.sumocfg\"",
        &["bad.toml:2", "environment variable is not set"],
    );
}

#[test]
fn misspelt_files_and_folders_are_told_with_the_nearest() {
    let folder = folder();
    write(&folder, "lap.csv", "t_s,v_mps\n0,1\n1,1\n");
    std::fs::create_dir(folder.path().join("results")).unwrap();
    write(&folder, "results/run.json", "{}");
    for (arguments, meant) in [
        (&["run", "scenaro.toml"][..], "scenario.toml"),
        (&["run", "scenario"], "scenario.toml"),
        (&["run", "ligth.sumocfg"], "light.sumocfg"),
        (&["run", "--net", "light.nt.xml", "--routes", "light.rou.xml"], "light.net.xml"),
        (&["run", "--net", "light.net.xml", "--routes", "light.rout.xml"], "light.rou.xml"),
        (&["check", "scenari.toml"], "scenario.toml"),
        (&["sweep", "scenarioo.toml", "--seeds", "1"], "scenario.toml"),
        (&["report", "result"], "results"),
        (&["run", "--from", "results/rum.json"], "results/run.json"),
        (&["run", "--from", "reslts/run.json"], "results/run.json"),
        (&["run", "scenario.toml", "--target", "profile", "--set", "target.file=lab.csv"], "lap.csv"),
        (&["paper", "driver", "--driver", "lab.csv"], "lap.csv"),
    ] {
        refused(&folder, arguments, &["did you mean ", &format!("{meant}?")]);
    }
    let output = command(&folder, &["run", "quite_another.toml"]).output().unwrap();
    assert!(!String::from_utf8_lossy(&output.stderr).contains("did you mean"), "nothing is near");
}

#[test]
fn misspelt_subcommands_and_names_are_told_with_the_nearest() {
    for (arguments, meant) in [
        (&["rum", "scenario.toml"][..], "'run'"),
        (&["compair", "scenario.toml"], "'compare'"),
        (&["run", "scenario.toml", "--controler", "pid"], "'--controller'"),
        (&["completions", "bach"], "'bash'"),
        (&["paper", "--preset", "defualt"], "\"default\""),
        (&["paper", "sime"], "\"sine\""),
        (&["paper", "mapp"], "\"map\""),
        (&["paper", "step", "--seed", "2"], "--seed: found the test step, wanted record"),
        (&["paper", "record", "--preset", "best"], "record: found options of the tests"),
        (&["paper", "record", "--set", "controller.k_p=1"], "record: found options of the tests"),
        (&["sweep", "scenario.toml", "--executor", "slrum"], "\"slurm\""),
        (&["list", "--export", "cvs"], "csv]"),
    ] {
        let folder = folder();
        let output = command(&folder, arguments).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        assert!(message.contains(meant), "{arguments:?}: no {meant} in\n{message}");
    }
}

#[test]
fn files_that_a_configuration_names_are_missed_with_its_line() {
    let folder = folder();
    let configuration = fs::read_to_string(folder.path().join("light.sumocfg")).unwrap();
    write(&folder, "bad.sumocfg", &configuration.replace("light.rou.xml", "no.rou.xml"));
    let line = 1 + configuration.lines().position(|l| l.contains("light.rou.xml")).unwrap();
    refused(
        &folder,
        &["run", "bad.sumocfg"],
        &[&format!("bad.sumocfg:{line}: route-files: "), "no.rou.xml does not exist"],
    );
}

#[test]
fn misspelt_keys_and_sections() {
    let scenario = "[sumo]\nconfig = \"light.sumocfg\"\n";
    refused_scenario(
        &format!("{scenario}\n[controler]\nname = \"classic\""),
        &["bad.toml:4: unknown key controler; did you mean controller?"],
    );
    refused_scenario(
        &format!("{scenario}[controller]\nname = \"classic\"\nkp = 1.0"),
        &["bad.toml:5: unknown key controller.kp; did you mean controller.k_p?", "known here: name, k_p"],
    );
    refused_scenario(
        &format!("{scenario}[[group]]\nselect = \"all\"\n[group.vehicle]\nmas_kg = 1000"),
        &["bad.toml:6: unknown key group.0.vehicle.mas_kg; did you mean group.0.vehicle.mass_kg?"],
    );
    refused_scenario(
        &format!("{scenario}[vehicle]\nmass_kg = {{ distribution = \"normal\", mean = 1000, sdt = 10 }}"),
        &["bad.toml:4: unknown key vehicle.mass_kg.sdt; did you mean vehicle.mass_kg.std?"],
    );
}

#[test]
fn wrong_units_types_and_ranges() {
    for (section, line, parts) in [
        ("actuator", "delay_ms = 250", ["actuator.delay_ms", "did you mean actuator.delay_s?"]),
        ("actuator", "delay_s = \"250 ms\"", ["found \"250 ms\"", "wanted a number in s from 0 to 5"]),
        ("actuator", "delay_s = 250", ["found 250", "wanted a number in s from 0 to 5"]),
        ("actuator", "delay_s = nan", ["found NaN", "wanted a number in s"]),
        ("noise", "power_db = true", ["found true", "wanted a number in dB"]),
        ("coupling", "control_period_s = 0.03", ["a whole number of control periods", "control_period_s = 0.03"]),
        ("controller", "estimator = \"algebra\"", ["found \"algebra\"", "did you mean \"algebraic\"?"]),
        ("plant", "name = 7", ["plant.name: found 7", "wanted a text"]),
        ("egos", "select = \"share:2\"", ["found \"share:2\"", "wanted share:X with X from 0 to 1"]),
        ("output", "trace_file = \"../trace.csv\"", ["output.trace_file", "a file name without folder"]),
        ("output", "vehicles = \"vehicles.txt\"", ["output.vehicles", ".csv, .parquet or .xml"]),
    ] {
        let text = format!("[sumo]\nconfig = \"light.sumocfg\"\n[{section}]\n{line}\n");
        refused_scenario(&text, &[&["bad.toml:4: "], parts.as_slice()].concat());
    }
    refused_scenario(
        "[sumo]\nconfig = \"light.sumocfg\"\nseed = -1",
        &["bad.toml:3: sumo.seed: found -1", "from 0 to 2147483647"],
    );
    refused_scenario(
        "[sumo]\nconfig = \"light.sumocfg\"\nstep_length_s = 0.0155",
        &["bad.toml:3", "whole number of milliseconds"],
    );
    refused_scenario(
        "sumo = \"light.sumocfg\"",
        &["bad.toml:1: sumo: found \"light.sumocfg\", wanted a section [sumo]"],
    );
    refused_scenario(
        "name = \"../elsewhere\"\n[sumo]\nconfig = \"light.sumocfg\"",
        &["bad.toml:1: name", "without slashes"],
    );
}

/// What the system says stands once in a message, not again as its cause.
#[test]
fn a_cause_is_told_once() {
    let folder = folder();
    for (arguments, said) in [
        (&["run", "nowhere.toml"][..], "No such file or directory (os error 2)"),
        (&["run", "scenario.toml", "-o", "scenario.toml/below"], "Not a directory (os error 20)"),
        (&["run", "scenario.toml", "--connect", "127.0.0.1:1"], "Connection refused (os error 111)"),
    ] {
        let output = command(&folder, arguments).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), message.matches(said).count()), (Some(1), 1), "{arguments:?}: {message}");
    }
}

#[test]
fn unknown_names() {
    let folder = folder();
    refused(
        &folder,
        &["run", "scenario.toml", "--controller", "adaptve"],
        &[
            "--controller adaptve: controller.name: unknown controller \"adaptve\" (did you mean \"adaptive\"?)",
            "known: ",
        ],
    );
    refused(
        &folder,
        &["run", "scenario.toml", "--target", "limits"],
        &["unknown target \"limits\" (did you mean \"limit\"?)"],
    );
    refused_scenario(
        "[sumo]\nconfig = \"light.sumocfg\"\n[controller]\nname = \"clasic\"",
        &["bad.toml:4: controller.name: unknown controller \"clasic\" (did you mean \"classic\"?)"],
    );
    refused(
        &folder,
        &["run", "scenario.toml", "--set", "vehicle.preset=lorry"],
        &["vehicle.preset: unknown body \"lorry\""],
    );
}

#[test]
fn arguments_are_named_in_their_errors() {
    let folder = folder();
    let set = |argument: &str, parts: &[&str]| refused(&folder, &["run", "scenario.toml", "--set", argument], parts);
    set("controller.kp=1.2", &["--set controller.kp=1.2: unknown key controller.kp; did you mean controller.k_p?"]);
    set("controller.k_p=fast", &["--set controller.k_p=fast: controller.k_p: found \"fast\", wanted a number in 1/s"]);
    set("controller.k_p", &["wanted KEY=VALUE"]);
    set("=1", &["wanted KEY=VALUE"]);
    set("controller.k_p.x=1", &["controller.k_p.x: found k_p = 1.0, wanted k_p to be a table"]);
    set("group.0.select=all", &["--set group.0.select=all: group: found a table, wanted groups"]);
    set("traffic.sigma=2", &["--set traffic.sigma=2: traffic.sigma: found 2, wanted a number from 0 to 1"]);
    refused(&folder, &["run", "scenario.toml", "--egos", "clas:bus"], &["--egos clas:bus: egos.select", "class:NAME"]);
    refused(&folder, &["run", "scenario.toml", "--egos", "class:buss"], &["did you mean class:bus?"]);
    refused(
        &folder,
        &["run", "scenario.toml", "--seed", "x"],
        &["--seed x: sumo.seed: found \"x\", wanted a whole number"],
    );
    refused(
        &folder,
        &["run", "scenario.toml", "--step-length", "0"],
        &["--step-length 0: sumo.step_length_s: found 0"],
    );
    refused(
        &folder,
        &["run", "scenario.toml", "--", "--seed", "3"],
        &["sumo.options: found --seed", "--seed or sumo.seed"],
    );
}

#[test]
fn usage_errors_exit_with_1_and_help_with_0() {
    let folder = folder();
    refused(&folder, &["fly"], &["fly"]);
    refused(&folder, &[], &["Usage"]);
    refused(&folder, &["run", "scenario.toml", "--spede", "3"], &["--spede"]);
    refused(&folder, &["run", "scenario.toml", "--net", "light.net.xml"], &["cannot be used with"]);
    refused(&folder, &["run"], &["nothing to run", "sumo.config"]);
    for arguments in [&["--help"][..], &["--version"], &["run", "--help"], &["list"], &["check", "--template"]] {
        let output = command(&folder, arguments).output().unwrap();
        assert!(output.status.success() && !output.stdout.is_empty() && output.stderr.is_empty(), "{arguments:?}");
    }
}

#[test]
fn networks_without_routes() {
    let folder = folder();
    let command = "randomTrips.py\" -n light.net.xml -o light.trips.xml";
    refused(&folder, &["run", "light.net.xml"], &["light.net.xml: a network without routes", command]);
    refused(
        &folder,
        &["run", "--net", "light.net.xml"],
        &["a network without routes", "randomTrips.py\" -n ", "light.trips.xml -e"],
    );
    write(&folder, "bare.sumocfg", "<configuration><net-file value=\"light.net.xml\"/></configuration>");
    refused(&folder, &["run", "bare.sumocfg"], &["a network without routes", "randomTrips.py"]);
    write(&folder, "empty.sumocfg", "<configuration></configuration>");
    refused(&folder, &["run", "empty.sumocfg"], &["empty.sumocfg: neither", "network"]);
}

#[test]
fn empty_demand() {
    let folder = folder();
    write(&folder, "none.rou.xml", "<routes>\n<vType id=\"a\"/>\n<!-- <trip id=\"x\"/> -->\n</routes>");
    refused(
        &folder,
        &["run", "--net", "light.net.xml", "--routes", "none.rou.xml"],
        &["--routes none.rou.xml: sumo.routes: no vehicle, trip or flow in", "none.rou.xml"],
    );
    write(
        &folder,
        "none.sumocfg",
        "<configuration>\n<net-file value=\"light.net.xml\"/>\n<r value=\"none.rou.xml\"/>\n</configuration>",
    );
    refused(&folder, &["run", "none.sumocfg"], &["none.sumocfg:3: r: no vehicle, trip or flow in"]);
}

#[test]
fn broken_files() {
    refused_scenario("[sumo]\nconfig = light.sumocfg", &["bad.toml:2: "]);
    refused_scenario("[sumo]\nseed = 1\nseed = 2", &["bad.toml:3: ", "duplicate key"]);
    let folder = folder();
    write(&folder, "bad.sumocfg", "<configuration>\n<input>\n<net-file value=\"light.net.xml\">\n</configuration>");
    refused(&folder, &["run", "bad.sumocfg"], &["bad.sumocfg:4: not XML"]);
    fs::write(folder.path().join("binary.toml"), [0xff, 0xfe, 0x00]).unwrap();
    refused(&folder, &["run", "binary.toml"], &["binary.toml: cannot be read"]);
}

#[test]
fn results_are_not_overwritten() {
    let folder = folder();
    write(&folder, "file", "");
    refused(&folder, &["run", "scenario.toml", "-o", "file/results"], &["file/results"]);
    assert_eq!(fs::read(folder.path().join("file")).unwrap(), b"");

    let out = folder.path().join("out/scenario-classic-23423");
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("vehicles.csv"), "id\n").unwrap();
    fs::write(out.join("summary.json"), "{}").unwrap();
    refused(&folder, &["run", "scenario.toml"], &["scenario-classic-23423", "--force"]);
    assert_eq!(fs::read(out.join("vehicles.csv")).unwrap(), b"id\n");
}

#[test]
fn all_mistakes_of_a_scenario_are_reported_at_once() {
    let text = "[sumo]\nconfig = \"light.sumocfg\"\nsed = 1\n[actuator]\ndelay_s = \"250 ms\"\n[noise]\npower_db = 100\n\
                [controller]\nname = \"clasic\"\nk_p = 1\n[trafic]\nsigma = 0\n[[group]]\nselect = \"type:bus*\"\n\
                vehicle.mass_kg = { distribution = \"normal\", mean = 9000 }\n";
    let mistakes = [
        "bad.toml:3: unknown key sumo.sed; did you mean sumo.seed? (and 5 more)",
        "bad.toml:5: actuator.delay_s: found \"250 ms\", wanted a number in s from 0 to 5 or a distribution",
        "bad.toml:7: noise.power_db: found 100, wanted a number in dB from -200 to 60",
        "bad.toml:9: controller.name: unknown controller \"clasic\" (did you mean \"classic\"?)",
        "bad.toml:11: unknown key trafic; did you mean traffic?",
        "bad.toml:15: group.0.vehicle.mass_kg.std: found nothing, wanted a number from 0",
    ];
    refused_scenario(text, &mistakes);

    let folder = folder();
    write(&folder, "bad.toml", text);
    let arguments = ["check", "bad.toml", "--seed", "x", "--controller", "classic", "--set", "controller.kp=2"];
    let of_arguments = ["--seed x: sumo.seed: found \"x\"", "--set controller.kp=2: unknown key controller.kp"];
    refused(&folder, &arguments, &[&of_arguments[..], &mistakes[1..3]].concat());
    let output = command(&folder, &arguments).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(message.matches('×').count(), 7, "each once, those that a group inherits too:\n{message}");
    assert!(!message.contains("clasic"), "the command line names another one:\n{message}");
}

/// Tables that would overwrite each other, and names that no file can have: `check` says so, before any simulation.
#[test]
fn names_of_tables_and_results() {
    let folder = folder();
    let long = "a".repeat(300);
    for (output, parts) in [
        ("vehicles = \"edges.csv\"".to_owned(), ["bad.toml:4: output.vehicles", "have one edges.csv already"]),
        ("vehicles = \"quality.csv\"".to_owned(), ["bad.toml:4: output.vehicles", "have one quality.csv already"]),
        (
            "trace = \"all\"\ntrace_file = \"vehicles.csv\"".to_owned(),
            ["bad.toml:5: output.trace_file", "one vehicles.csv"],
        ),
        ("trace = \"all\"\nvehicles = \"trace.csv\"".to_owned(), ["bad.toml:5: output.vehicles", "one trace.csv"]),
        ("vehicles = \".csv\"".to_owned(), ["bad.toml:4: output.vehicles", "a file name"]),
        ("vehicles = \"a\\u0000.csv\"".to_owned(), ["bad.toml:4: output.vehicles", "without control characters"]),
        ("vehicles = \"a\\n.csv\"".to_owned(), ["bad.toml:4: output.vehicles", "without control characters"]),
        (format!("vehicles = \"{long}.csv\""), ["bad.toml:4: output.vehicles", "of at most 200 bytes"]),
    ] {
        write(&folder, "bad.toml", &format!("[sumo]\nconfig = \"light.sumocfg\"\n[output]\n{output}\n"));
        refused(&folder, &["check", "bad.toml"], &parts);
        refused(&folder, &["run", "bad.toml"], &parts);
    }
    write(&folder, "bad.toml", &format!("name = \"{long}\"\n[sumo]\nconfig = \"light.sumocfg\"\n"));
    refused(&folder, &["check", "bad.toml"], &["bad.toml:1: name", "of at most 200 bytes"]);
    // Names that nobody else takes.
    let free = "quality = false\nvehicles = \"quality.csv\"\ntrace_file = \"quality.csv\"";
    write(&folder, "good.toml", &format!("[sumo]\nconfig = \"light.sumocfg\"\n[output]\n{free}\n"));
    assert!(command(&folder, &["check", "good.toml"]).output().unwrap().status.success());
}

/// Files without end, and such as grow when they are read, are refused in a moment and in little memory.
#[test]
fn files_without_measure() {
    let folder = folder();
    refused(&folder, &["run", "/dev/zero"], &["/dev/zero: cannot be read: "]);
    let including = |files: usize, times: usize, more: &str| {
        for i in 0..=files {
            let next = format!("<include href=\"f{}.xml\"/>", i + 1).repeat(if i < files { times } else { 0 });
            write(&folder, &format!("f{i}.xml"), &format!("<additional>{more}{next}</additional>"));
        }
    };
    let configuration = |more: &str| {
        let input = "<net-file value=\"light.net.xml\"/><route-files value=\"light.rou.xml\"/>";
        write(&folder, "bad.sumocfg", &format!("<configuration>\n{input}\n{more}\n</configuration>"));
    };
    configuration("<additional-files value=\"f0.xml\"/>");
    including(3000, 1, "<edgeData id=\"e\" file=\"v.xml\"/>");
    refused(&folder, &["run", "bad.sumocfg"], &["files include each other more than 16 deep"]);
    including(24, 2, "");
    refused(&folder, &["run", "bad.sumocfg"], &["files include each other more than 16 deep"]);
    including(14, 2, "");
    refused(&folder, &["run", "bad.sumocfg"], &["it makes SUMO read more than 10000 files"]);
    write(&folder, "f0.xml", &["<a>".repeat(200_000), "</a>".repeat(200_000)].concat());
    refused(&folder, &["run", "bad.sumocfg"], &["f0.xml:1: elements nested more than 256 deep"]);
    configuration(&["<a>".repeat(200_000), "</a>".repeat(200_000)].concat());
    refused(&folder, &["run", "bad.sumocfg"], &["bad.sumocfg:3: elements nested more than 256 deep"]);
    let laughs: String =
        (1..10).map(|i| format!("<!ENTITY a{i} \"{}\">", format!("&a{};", i - 1).repeat(10))).collect();
    let laughs = format!("<!DOCTYPE a [<!ENTITY a0 \"ha\">{laughs}]>");
    write(&folder, "f0.xml", &format!("{laughs}<additional><poi id=\"&a9;\" x=\"1\" y=\"1\"/></additional>"));
    configuration("<additional-files value=\"f0.xml\"/>");
    refused(&folder, &["run", "bad.sumocfg"], &["f0.xml:1: a document type definition"]);
    write(
        &folder,
        "laughs.sumocfg",
        &format!("{laughs}<configuration><output-prefix value=\"&a9;\"/></configuration>"),
    );
    refused(&folder, &["run", "laughs.sumocfg"], &["laughs.sumocfg:1: a document type definition"]);
}

/// The nearest known name is looked for among names of about the same length only: comparing this one letter by letter
/// with all of them takes more than half a minute.
#[test]
fn regress_the_nearest_name_of_a_long_one_is_told_at_once() {
    let folder = folder();
    let routes = fs::read_to_string(folder.path().join("light.rou.xml")).unwrap();
    let parameter = format!("<param key=\"mfc.{}\" value=\"1\"/>", "k".repeat(16 << 20));
    write(&folder, "light.rou.xml", &routes.replacen("</vehicle>", &format!("{parameter}</vehicle>"), 1));
    let mut command = command(&folder, &["check", "scenario.toml"]);
    let output = command.timeout(std::time::Duration::from_secs(20)).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{told:.500}");
    assert!(told.contains("mfc.kkk") && !told.contains("did you mean"), "{told:.500}");
}

/// A configuration may name `${SUMO_HOME}` as often as it likes: SUMO is looked for once, which may start a Python.
#[cfg(unix)]
#[test]
fn regress_sumo_is_looked_for_once() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    write(&folder, "python3", "#!/bin/sh\necho asked >> \"$ASKED\"\n");
    fs::set_permissions(folder.path().join("python3"), fs::Permissions::from_mode(0o755)).unwrap();
    let routes = vec!["${SUMO_HOME}/none.rou.xml"; 50].join(",");
    write(
        &folder,
        "homes.sumocfg",
        &format!("<configuration><net-file value=\"light.net.xml\"/><route-files value=\"{routes}\"/></configuration>"),
    );
    let asked = folder.path().join("asked");
    let mut command = command(&folder, &["check", "homes.sumocfg"]);
    command.env_remove("SUMO_HOME").env_remove("SUMO_BINARY").env("PATH", folder.path()).env("ASKED", &asked);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read_to_string(asked).unwrap().lines().count(), 1);
}
