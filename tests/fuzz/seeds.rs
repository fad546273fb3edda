//! Real files, of which the cases are made, and the words that fit into them.

use std::fs;
use std::path::Path;

use sumo_mfc::keys::{Key, Kind};
use sumo_mfc::run::Manifest;
use sumo_mfc::scenario::{Catalog, Form, Request, Scenario, sections, template};

/// No seed is longer \[bytes\]: a long one takes long to read, and few of its changes hit anything.
const LENGTH_MAX: usize = 12_000;

/// What the cases of a target are made of.
pub struct Seeds {
    pub files: Vec<Vec<u8>>,
    pub words: Vec<&'static str>,
}

/// The seeds of a target.
pub fn of(target: &str) -> Seeds {
    let (paths, texts, words): (&[&str], Vec<String>, &[&str]) = match target {
        "decoder" => (
            &[
                "tests/data/traci/replies/1.28.0-events.bin",
                "tests/data/traci/replies/1.28.0-gets.bin",
                "tests/data/traci/replies/1.15.0-events.bin",
                "tests/data/traci/replies/1.15.0-gets.bin",
            ],
            vec![],
            &["\0\0\0\u{7f}"],
        ),
        "scenario" => (
            &[
                "scenarios/city.toml",
                "scenarios/demo.toml",
                "scenarios/sine.toml",
                "scenarios/paper/disturb.toml",
                "scenarios/paper/presets/best.toml",
            ],
            scenarios(),
            XML,
        ),
        "set" => (&[], sets(), &["group.0.controller.k_p", "vehicle.mass_kg.std", "normal(1,0.2)", "uniform(0,1)"]),
        "study" => (
            &["scenarios/studies/city.toml", "scenarios/studies/mass.toml", "scenarios/studies/noise.toml"],
            vec![STUDY.to_owned()],
            &["1..10", "1..1000000000", "3,8,12", "reference", "slurm", "vary", "seeds"],
        ),
        "manifest" => {
            (&[], vec![manifest()], &["version", "scenario", "inputs", "null", "true", "[]", "{}", "\\u0000"])
        }
        "configuration" => (
            &["sumo_nets/light/light.sumocfg", "sumo_nets/city/city.sumocfg"],
            vec![CONFIGURATION.to_owned(), "<c><n v='a.net.xml'/><r v='a.rou.xml'/><a v=''/></c>".to_owned()],
            &[
                "a.net.xml",
                "a.rou.xml",
                "true",
                "mesosim",
                "v",
                "value",
                "save-state.times",
                "tripinfo-output",
                "additional-files",
                "random",
                "begin",
                "end",
                "seed",
                "step-length",
                "num-clients",
            ],
        ),
        "demand" => (
            &["sumo_nets/light/light.rou.xml", "sumo_nets/motorway/motorway.rou.xml", "tests/data/traci/grid.rou.xml"],
            vec![DEMAND.to_owned()],
            XML,
        ),
        "additional" => (&["tests/data/traci/grid.add.xml"], vec![ADDITIONAL.to_owned()], XML),
        "state" => (&["tests/data/fuzz/state.xml.gz"], vec![STATE.to_owned()], XML),
        "network" => (
            &["sumo_nets/light/light.net.xml", "sumo_nets/sine/sine.net.xml"],
            vec![
                "<net><edge id=\"a\" function=\"crossing\"/><edge id=\"b\"><lane shape=\"0,0 1,1,2\"/></edge></net>"
                    .to_owned(),
            ],
            &["walkingarea", "function", "shape", "edge", "lane", "0,0 1e308,1", "net"],
        ),
        "tripinfo" => (
            &[
                "tests/data/sumo_outputs/tripinfo_1.28.0.xml",
                "tests/data/sumo_outputs/tripinfo_1.15.0.xml",
                "tests/data/fuzz/tripinfo.parquet",
                "tests/data/fuzz/tripinfo.csv",
            ],
            vec![],
            &["tripinfo", "emissions", "vaporized", "collision", "id", "arrival", "-1", "PAR1"],
        ),
        "statistics" => (
            &[
                "tests/data/sumo_outputs/statistics_1.28.0.xml",
                "tests/data/sumo_outputs/statistics_1.15.0.xml",
                "tests/data/fuzz/statistics.parquet",
            ],
            vec![],
            &["vehicles", "teleports", "safety", "total", "collisions", "PAR1"],
        ),
        "conflicts" => (&[], vec![CONFLICTS.to_owned()], &["conflict", "minTTC", "maxDRAC", "PET", "NA", "ego"]),
        "log" => (&[], vec![LOG.to_owned()], &["Warning:", "lane='", "lane '", "collision with", "Removing vehicle"]),
        "recording" => (
            &["scenarios/paper/data/hwfet.csv", "scenarios/paper/data/racing_lap.csv", "scenarios/paper/data/udds.csv"],
            RECORDINGS.iter().map(|text| (*text).to_owned()).collect(),
            &[
                "t_s",
                "s_m",
                "v_mps",
                "v_kmh",
                "vx",
                "vy",
                "yaw_rate",
                "yaw_rate_degps",
                "speed",
                "time",
                "t",
                "v",
                "x_km",
            ],
        ),
        "tyre_curve" => (&[], curves(), &["slip,force_n", "0.1,3000", "0,0"]),
        "parameter" => (
            &[],
            [
                "normal(1,0.2)",
                "normc(1,0.2,0.7,1.5)",
                "uniform(0.7,1.5)",
                "1500",
                "true",
                "type:bus*",
                "id:^a.*[0-9]$",
                "share:0.25",
                "class:truck",
                "all",
                "type:{a,b}[c-d]?",
            ]
            .map(str::to_owned)
            .to_vec(),
            &["normal", "uniform", "normc", "(", ")", "share:", "id:(a|b)*", "type:**", "class:bus"],
        ),
        other => panic!("no seeds of {other}"),
    };
    let mut words = words.to_vec();
    if ["scenario", "set", "study"].contains(&target) {
        words.extend(keys());
    }
    let files = paths.iter().map(|path| fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap());
    let files = files.chain(texts.into_iter().map(String::into_bytes)).map(short).collect();
    Seeds { files, words }
}

/// The beginning of a file, up to the end of a line if it is text.
fn short(mut file: Vec<u8>) -> Vec<u8> {
    if file.len() > LENGTH_MAX && file.is_ascii() {
        let end = file[..LENGTH_MAX].iter().rposition(|b| *b == b'\n').map_or(LENGTH_MAX, |at| at + 1);
        file.truncate(end);
    }
    file
}

/// Sections, keys, choices and entries of scenario files.
fn keys() -> Vec<&'static str> {
    let mut words = vec!["name", "group", "select", "distribution", "normal", "mean", "std", "min", "max"];
    for section in sections(&Catalog::installed()) {
        words.push(section.name);
        match section.form {
            Form::Keys(keys) | Form::Drawn(keys) => words.extend(keys.iter().map(|key| key.name)),
            Form::Choice(entries) => {
                words.extend(entries.iter().flat_map(|e| [e.name].into_iter().chain(e.keys.iter().map(|k| k.name))));
            }
        }
    }
    words
}

/// A scenario that uses what the shipped ones do not, every key commented in, and a resolved one.
fn scenarios() -> Vec<String> {
    let catalog = Catalog::installed();
    let resolved = Scenario::load_offline(&Request::default(), &catalog).unwrap().to_toml();
    vec![SCENARIO.to_owned(), template(&catalog), resolved]
}

/// Every key with a value that it takes, some of them a case.
fn sets() -> Vec<String> {
    let mut lines = Vec::new();
    for section in sections(&Catalog::installed()) {
        let name = section.name;
        let mut add = |choice: &str, keys: &[Key]| {
            for key in keys.iter().filter(|key| !["config", "net", "connect"].contains(&key.name)) {
                let value = match key.kind {
                    Kind::Number { min, max, .. } | Kind::NumberOr { min, max, .. } => {
                        format!("{:?}", min.max(1.0).min(max))
                    }
                    Kind::Integer { min, .. } => min.max(1).to_string(),
                    Kind::Flag => "true".to_owned(),
                    Kind::Choice(words) => words[0].to_owned(),
                    _ => continue,
                };
                lines.push(format!("{choice}{name}.{}={value}", key.name));
            }
        };
        match section.form {
            Form::Keys(keys) | Form::Drawn(keys) => add("", &keys),
            Form::Choice(entries) => {
                entries.iter().for_each(|entry| add(&format!("{name}.name={}\n", entry.name), entry.keys));
            }
        }
    }
    let more = [
        "controller.name=pid",
        "group.0.controller.name=classic",
        "vehicle.mass_factor={distribution=\"normal\",mean=1,std=0.1}",
    ];
    lines.extend(more.map(str::to_owned));
    lines.chunks(2).map(|lines| lines.join("\n")).collect()
}

fn manifest() -> String {
    let scenario = Scenario::load_offline(&Request::default(), &Catalog::installed()).unwrap().to_toml();
    serde_json::to_string_pretty(&Manifest::new(1, scenario, Vec::new())).unwrap()
}

fn curves() -> Vec<String> {
    let tyre = sumo_mfc::plant::tyre::Tyre { b: 10.0, c: 1.65, e: 0.5 };
    let row = |k: i32| format!("{},{}\n", f64::from(k) * 0.01, 4200.0 * tyre.force_per_peak(f64::from(k) * 0.01));
    vec![
        format!("slip,force_n\n{}", (0..60).map(row).collect::<String>()),
        "slip,force_n\n0,0\n0.05,3000\n0.1,4000\n0.2,3500\n0.5,3000\n".to_owned(),
    ]
}

const XML: &[&str] = &[
    "id",
    "type",
    "vType",
    "vehicle",
    "trip",
    "flow",
    "param",
    "key",
    "value",
    "mfc.mass",
    "mfc.delay_s",
    "has.mfc.device",
    "device.mfc.probability",
    "include",
    "href",
    "file",
    "routes",
    "additional",
    "edgeData",
    "carFollowModel",
    "Rail",
    "normal(1,0.2)",
    "true",
    "snapshot",
    "time",
    "e1Detector",
    "a.rou.xml",
    "b.rou.xml",
    "../x.xml",
];

const SCENARIO: &str = r#"name = "a"
[sumo]
config = "plain.sumocfg"
step_length_s = 0.1
end_s = 100
seed = 1
options = ["--time-to-teleport", "-1"]
[egos]
select = "share:0.5"
[controller]
name = "pid"
[target]
name = "profile"
shape = "step"
by = "time"
step_at = "0, 10"
step_speeds_mps = "10, 20"
[vehicle]
preset = "bus"
mass_factor = { distribution = "normal", mean = 1, std = 0.1, min = 0.7, max = 1.5 }
[actuator]
delay_s = { distribution = "uniform", min = 0.1, max = 0.3 }
[noise]
power_db = -12.0
[output]
trace = "a, b"
trace_period_s = 0.1
[[group]]
select = "type:bus*"
controller.name = "classic"
target = { name = "profile", file = "p.csv" }
vehicle = { friction = 0.5, tyre.curve = "p.csv" }
[[group]]
select = "id:x.*"
controller = { name = "adaptive", k_p = 0.5 }
"#;

const STUDY: &str = r#"scenario = "plain.toml"
seeds = "1..3"
warm_up_s = 30
reference = { "controller.name" = "ideal" }
[[vary]]
"controller.name" = ["ideal", "adaptive"]
"controller.k_p" = [1, 2]
[[vary]]
"egos.select" = ["share:0.25", "all"]
[slurm]
partition = "a"
"#;

const CONFIGURATION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<configuration><input><net-file value="a.net.xml"/><route-files value="a.rou.xml,b.rou.xml"/>
<additional-files value=""/></input><output><tripinfo-output value="t.xml"/><fcd-output value="../f.xml.gz"/></output>
<time><begin value="0:00:10"/><end value="100"/><step-length value="0.5"/></time>
<processing><step-method.ballistic value="true"/><collision.mingap-factor value="0"/></processing>
<random_number><random value="x"/><seed>7</seed></random_number></configuration>
"#;

const DEMAND: &str = r#"<?xml version="1.0" encoding="ISO-8859-1"?>
<routes><include href="b.rou.xml"/>
<vType id="car" accel="2.6" carFollowModel="Krauss"><param key="mfc.mass_factor" value="normal(1, 0.1, 0.7, 1.5)"/>
<param key="has.mfc.device" value="true"/></vType>
<flow id="f" type="car" begin="0" end="10"><param key="has.mfc.device" value="no"/></flow>
<vehicle id="a" type="car" depart="0"><route edges="before after"/><param key="mfc.delay_s" value="0.2"/></vehicle>
</routes>
"#;

const ADDITIONAL: &str = r#"<additional><edgeData id="a" file="edges.xml" freq="60"/><include href="b.rou.xml"/>
<e1Detector id="d" lane="before_0" pos="1" freq="10" file="../d.xml"/><calibrator id="c" output="c.xml"/>
<routeProbe id="p" file="/p.xml"/><vTypeProbe id="q" file="NUL"/><timedEvent type="SaveTLSStates" dest="t.xml"/></additional>
"#;

const STATE: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<snapshot version="v1_28_0" time="30.00" type="micro"><rngState default="0"/><vehicle id="a" type="car"/></snapshot>
"#;

const CONFLICTS: &str = r#"<SSMLog><conflict begin="1.0" end="2.0" ego="a" foe="b"><minTTC time="1.2" value="2.0"/>
<maxDRAC time="1.2" value="3.1"/><PET time="NA" value="NA"/></conflict></SSMLog>
"#;

const LOG: &str = "Loading done.\nWarning: Vehicle 'a'; collision with vehicle 'b', lane='E0_0', gap=-0.50, time=35.00.\n\
Warning: Teleporting vehicle 'a'; waited too long (jam), lane='E1_1', time=301.00.\n\
Warning: Vehicle 'a' performs emergency braking on lane ':J_3_0' with decel=9.00, time=12.00.\n\
Warning: No route for vehicle 'c' found.\nWarning: Removing vehicle 'd' after teleporting.\n";

const RECORDINGS: &[&str] = &[
    "s_m,v_mps\n0,10\n50,12.5\n50,20\n100,0\n",
    "t_s,v_kmh\n0,0\n1,10\n2,20\n3.5,50\n",
    "0;0\n1;5\n2;10\n3;0\n",
    "t,vx,vy,yaw_rate\n0,10,0,0\n0.01,10.1,0.1,0.02\n0.02,10.2,0.1,0.03\n0.03,10.2,0.1,0.03\n0.04,10.2,0,0.03\n0.05,9,0,0\n",
    "# a comment\ntime_s,speed_mps,yaw_rate_degps\n0,0.1,0\n0.1,0.2,5\n0.2,0.3,5\n0.3,0.3,400\n0.4,3,0\n0.5,0,0\n",
];
