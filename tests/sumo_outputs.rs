//! Whatever a foreign configuration writes lands in the run's own folder, tried on real SUMO.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use sumo_mfc::{
    scenario::{Catalog, Override, Request, Scenario},
    sumo_files::{SumoCommand, sumo_arguments},
};

const VERSIONS: [&str; 2] = ["1.28.0", "1.15.0"];

/// A folder below `.sumo/`; `make` installs it.
fn installed(name: &str, below: &str) -> PathBuf {
    let lib = Path::new(env!("CARGO_MANIFEST_DIR")).join(".sumo").join(name).join("lib");
    let pythons = fs::read_dir(&lib).unwrap_or_else(|_| panic!("no {name} below .sumo/: type make setup-test"));
    let paths = pythons.flatten().map(|python| python.path().join("site-packages").join(below));
    paths.into_iter().find(|path| path.exists()).unwrap_or_else(|| panic!("no {below} in .sumo/{name}"))
}

fn load(path: &Path, overrides: &[&str]) -> Scenario {
    let overrides = overrides.iter().map(|o| Override::set(o).unwrap()).collect();
    Scenario::load(&Request { scenario: Some(path.to_owned()), overrides }, &Catalog::installed()).unwrap()
}

/// Runs SUMO without TraCI to `end_s` and returns its messages.
fn run(version: &str, command: &SumoCommand, end_s: u32) -> String {
    let home = installed(version, "sumo");
    let mut sumo = Command::new(home.join("bin/sumo"));
    sumo.env("SUMO_HOME", &home).args(&command.arguments).args(["--end", &end_s.to_string()]);
    let output = sumo.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{version}: {text}\n{:?}", command.arguments);
    text
}

/// All files below a folder, relative.
fn files(folder: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(next).unwrap().flatten() {
            match entry.path() {
                path if path.is_dir() => open.push(path),
                path => drop(found.insert(path.strip_prefix(folder).unwrap().to_string_lossy().into_owned())),
            }
        }
    }
    found
}

/// Copies `from` into `to`, flat folders only.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().flatten().filter(|e| e.path().is_file()) {
        fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

const CONFIGURATION: &str = r#"<configuration>
    <input>
        <net-file value="light.net.xml"/>
        <route-files value="demand/types.xml,light.rou.xml"/>
        <additional-files value="more/detectors.add.xml,plain.add.xml"/>
    </input>
    <output>
        <tripinfo value="../escaped/trips.xml"/>
        <fcd-output value="fcd.xml"/>
        <netstate value="deep/raw.xml"/>
        <summary-output value="deeper/raw.xml"/>
        <save-state.times value="5"/>
        <save-state.suffix value=".xml"/>
        <queue-output value="console.log"/>
        <output-prefix value="../run_TIME_"/>
    </output>
    <time><end value="100"/></time>
    <report><l value="log.txt"/></report>
    <ssm_device><device.ssm.probability value="1"/></ssm_device>
</configuration>"#;

const DETECTORS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<additional>
    <!-- every element that writes -->
    <edgeData id="e" file="../edges.xml"/>
    <laneData id="l" file="lanes.xml"/>
    <inductionLoop id="a" lane="LANE" pos="5" period="10" file="e1.xml"/>
    <instantInductionLoop id="b" lane="LANE" pos="6" file="instant.xml"/>
    <laneAreaDetector id="c" lane="LANE" pos="5" endPos="20" period="10" file="e2.xml"/>
    <entryExitDetector id="d" period="10" file="e3.xml">
        <detEntry lane="LANE" pos="5"/>
        <detExit lane="LANE" pos="20"/>
    </entryExitDetector>
    <routeProbe id="p" edge="EDGE" period="10" file="probe.xml"/>
    <vTypeProbe id="t" period="5" file="e1.xml"/>
    <calibrator id="k" edge="EDGE" pos="0" period="10" output="calibrator.xml"/>
    <inductionLoop id="n" lane="LANE" pos="7" period="10" file="NUL"/>
    <include href="inner/inner.add.xml"/>
</additional>"#;

const INNER: &str = "<additional><variableSpeedSign id=\"v\" lanes=\"LANE\" file=\"speeds.xml\"/>\
    <edgeData id=\"inner\" file=\"inner.xml\"/></additional>";

/// A type of vehicle whose device writes.
const TYPES: &str = "<routes><include href=\"more.xml\"/></routes>";
const MORE: &str = "<routes><vType id=\"watched\"><param key=\"has.ssm.device\" value=\"true\"/>\
    <param key=\"device.ssm.file\" value=\"conflicts.xml\"/></vType>\
    <trip id=\"watched\" type=\"watched\" depart=\"0\" from=\"EDGE\" to=\"EDGE\"/></routes>";

/// A configuration that writes whatever it can, wherever it can, around our own small network. Its demand and additional
/// files may be compressed under names that do not say so.
fn greedy(folder: &Path, compressed: bool) -> PathBuf {
    let home = folder.join("home");
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/light"), &home);
    let net = fs::read_to_string(home.join("light.net.xml")).unwrap();
    let edge = net.split("<edge id=\"").skip(1).find(|e| !e.starts_with(':')).unwrap();
    let edge = edge.split('"').next().unwrap();
    let fill = |text: &str| text.replace("LANE", &format!("{edge}_0")).replace("EDGE", edge);
    for (name, text) in [
        ("greedy.sumocfg", CONFIGURATION),
        ("demand/types.xml", TYPES),
        ("demand/more.xml", MORE),
        ("more/detectors.add.xml", DETECTORS),
        ("more/inner/inner.add.xml", INNER),
        ("more/inner/speeds.xml", "<vss><step time=\"0\" speed=\"10\"/></vss>"),
        ("plain.add.xml", "<additional/>"),
    ] {
        let path = home.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let text = fill(text).into_bytes();
        fs::write(path, if compressed && name.ends_with(".xml") { gzipped(&text) } else { text }).unwrap();
    }
    home.join("greedy.sumocfg")
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn law_nothing_is_written_outside_the_results() {
    for (version, compressed) in VERSIONS.into_iter().flat_map(|v| [(v, false), (v, true)]) {
        let folder = tempfile::tempdir().unwrap();
        let path = greedy(folder.path(), compressed);
        let before = files(folder.path());
        let out = tempfile::tempdir().unwrap();
        fs::create_dir(out.path().join("sumo")).unwrap();

        let scenario = load(&path, &[]);
        assert_eq!(
            scenario.inputs.len(),
            9,
            "configuration, net, 2 routes, 2 additional, 3 included: {:?}",
            scenario.inputs
        );
        let command = sumo_arguments(&scenario.sumo, out.path()).unwrap();
        let messages = run(version, &command, 20);

        assert_eq!(files(folder.path()), before, "{version} wrote beside the configuration\n{messages}");
        let written = files(out.path());
        for name in [
            "run__trips.xml",
            "run__fcd.xml",
            "run__raw.xml",
            "2_run__raw.xml",
            "run__log.txt",
            "run__edges.xml",
            "run__lanes.xml",
            "run__e1.xml",
            "run__instant.xml",
            "run__e2.xml",
            "run__e3.xml",
            "run__probe.xml",
            "run__calibrator.xml",
            "run__inner.xml",
            "run__conflicts.xml",
            "statistics.xml",
        ] {
            assert!(written.contains(&format!("sumo/{name}")), "{version}: no {name} among {written:?}");
        }
        assert!(written.iter().any(|f| f.contains("state_5")), "{version}: no saved state among {written:?}");
        assert!(written.iter().all(|f| f.starts_with("sumo/")), "{written:?}");
        for path in [&command.statistics, &command.tripinfo, &command.log] {
            assert!(path.is_file(), "{version}: {} is not where it is said to be", path.display());
        }
    }
}

#[test]
fn foreign_configurations_start_unchanged() {
    let racing = installed("1.28.0", "sumo/tools/game/racing");
    let resco = installed("sumo-rl", "sumo_rl/nets/RESCO");
    let foreign = [
        racing.join("racing.sumocfg"),
        resco.join("cologne1/cologne1.sumocfg"),
        resco.join("ingolstadt1/ingolstadt1.sumocfg"),
    ];
    for path in foreign {
        let home = path.parent().unwrap();
        let before = files(home);
        let out = tempfile::tempdir().unwrap();
        fs::create_dir(out.path().join("sumo")).unwrap();
        let scenario = load(&path, &[]);
        let command = sumo_arguments(&scenario.sumo, out.path()).unwrap();
        let begin = fs::read_to_string(&path).unwrap();
        let begin =
            begin.split("<begin value=\"").nth(1).map_or(0, |b| b.split('"').next().unwrap().parse::<u32>().unwrap());
        run("1.28.0", &command, begin + 5);
        assert_eq!(files(home), before, "{}", path.display());
        assert!(command.statistics.is_file() && command.tripinfo.is_file());
    }
}

#[test]
fn the_users_options_replace_ours() {
    let folder = tempfile::tempdir().unwrap();
    let path = greedy(folder.path(), false);
    let out = tempfile::tempdir().unwrap();
    fs::create_dir(out.path().join("sumo")).unwrap();
    let trips = out.path().join("mine.xml");
    let options = format!(
        "sumo.options=[\"--tripinfo\", \"{}\", \"--output-prefix=my_\", \"--no-step-log\", \"--time-to-teleport\", \"-1\"]",
        trips.display()
    );
    let scenario = load(&path, &[&options]);
    let command = sumo_arguments(&scenario.sumo, out.path()).unwrap();
    run("1.28.0", &command, 20);
    assert_eq!(command.tripinfo, out.path().join("my_mine.xml"));
    for path in [&command.statistics, &command.tripinfo, &command.log] {
        assert!(path.is_file(), "{} is not where it is said to be", path.display());
    }
}

#[test]
fn a_network_with_routes_runs() {
    let nets = Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/light");
    let file = |name: &str| nets.join(name).to_string_lossy().into_owned();
    let overrides = vec![
        Override::text("--net", "sumo.net", &file("light.net.xml")),
        Override::texts("--routes", "sumo.routes", &[file("light.rou.xml")]),
    ];
    let scenario = Scenario::load(&Request { scenario: None, overrides }, &Catalog::installed()).unwrap();
    assert_eq!(scenario.name, "light");
    let out = tempfile::tempdir().unwrap();
    fs::create_dir(out.path().join("sumo")).unwrap();
    for version in VERSIONS {
        let command = sumo_arguments(&scenario.sumo, out.path()).unwrap();
        run(version, &command, 20);
        let statistics = fs::read_to_string(&command.statistics).unwrap();
        assert!(statistics.contains("<vehicles loaded="), "{statistics}");
    }
}

#[test]
fn law_a_checked_scenario_runs_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let home = installed("1.28.0", "sumo");
    let mfc = |arguments: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("sumo-mfc").unwrap();
        let output = command.current_dir(folder.path()).env("SUMO_HOME", &home).args(arguments).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/light/light.sumocfg");
    let changed = [
        scenario.to_str().unwrap(),
        "--end=30",
        "--trace=all",
        "--set=noise.power_db=-6",
        "--set=vehicle.mass_kg={ distribution = \"normal\", mean = 1500, std = 100 }",
    ];
    fs::write(folder.path().join("checked.toml"), mfc(&[&["check"], &changed[..]].concat())).unwrap();
    mfc(&[&["run", "-o", "first"], &changed[..]].concat());
    mfc(&["run", "-o", "second", "checked.toml"]);
    for file in ["vehicles.csv", "trace.csv", "sample.csv", "edges.csv"] {
        let [first, second] = ["first", "second"].map(|dir| fs::read(folder.path().join(dir).join(file)).unwrap());
        assert!(first.len() > 10 && first == second, "{file} differs");
    }
}
