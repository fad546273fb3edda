//! A scenario from a stranger writes below the folder of its result, or is refused with the place that says otherwise.

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;

use crate::support::{NEW, OLD, Running, repository, run_command};

/// What comes of a scenario.
#[derive(Clone, Copy)]
enum Fate {
    /// SUMO writes this file below `sumo/` of the result.
    Written(&'static str),
    /// It runs, and writes nothing of the kind.
    Harmless,
    /// It is refused with these words.
    Refused(&'static [&'static str]),
}
use Fate::{Harmless, Refused, Written};

/// What a scenario consists of beside network, demand and configuration.
#[derive(Default)]
struct Case {
    name: &'static str,
    /// Elements of the configuration.
    options: String,
    /// Further files, or others in place of ours.
    files: Vec<(&'static str, Vec<u8>)>,
    /// A scenario in TOML around the configuration.
    toml: Option<String>,
    fate: Option<Fate>,
}

impl Case {
    fn new(name: &'static str, fate: Fate) -> Self {
        Self { name, fate: Some(fate), ..Self::default() }
    }

    fn options(self, options: &str) -> Self {
        Self { options: options.to_owned(), ..self }
    }

    fn file(mut self, name: &'static str, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.push((name, bytes.into()));
        self
    }

    /// An additional file of these bytes.
    fn additional(self, bytes: impl Into<Vec<u8>>) -> Self {
        self.options("<additional-files value=\"a.xml\"/>").file("a.xml", bytes)
    }

    fn toml(self, options: &str) -> Self {
        Self { toml: Some(format!("[sumo]\nconfig = \"c.sumocfg\"\noptions = {options}\n")), ..self }
    }
}

fn ours(name: &str) -> String {
    fs::read_to_string(repository("sumo_nets/light").join(name)).unwrap()
}

/// The demand with these parameters in its vType, and in its vehicle.
fn demand(of_type: &str, of_vehicle: &str) -> String {
    let text = ours("light.rou.xml");
    let (head, tail) = text.split_once("speedDev=\"0\"/>").unwrap();
    let tail = tail.replace("</vehicle>", &format!("{of_vehicle}</vehicle>"));
    format!("{head}speedDev=\"0\">{of_type}</vType>{tail}")
}

fn param(key: &str, value: &str) -> String {
    format!("<param key=\"{key}\" value=\"{value}\"/>")
}

/// A device with the file that it writes.
fn device(name: &str, file: &str) -> String {
    let types = param("device.toc.manualType", "ego") + &param("device.toc.automatedType", "ego");
    param(&format!("has.{name}.device"), "true") + &param(&format!("device.{name}.file"), file) + &types
}

fn compressed(text: &str, zlib: bool) -> Vec<u8> {
    let fast = flate2::Compression::fast();
    if zlib {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), fast);
        encoder.write_all(text.as_bytes()).unwrap();
        return encoder.finish().unwrap();
    }
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), fast);
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

const EDGES: &str = "<additional><edgeData id=\"e\" file=\"OUTSIDE/v.xml\"/></additional>";

/// Options of configurations.
fn configurations() -> Vec<Case> {
    let option = |name, fate, text: &str| Case::new(name, fate).options(text);
    let no_simulation = Refused(&["c.sumocfg:3: ", "with it SUMO does not simulate"]);
    vec![
        option("save-configuration", no_simulation, "<save-configuration value=\"v.xml\"/>"),
        option("its abbreviation", no_simulation, "<C value=\"OUTSIDE/v.xml\"/>"),
        option("its synonym", no_simulation, "<save-config>v.xml</save-config>"),
        option("save-template", no_simulation, "<output><save-template value=\"v.xml\"/></output>"),
        option("save-schema", no_simulation, "<save-schema v=\"v.xml\"/>"),
        option("help", no_simulation, "<help value=\"true\"/>"),
        option("fcd", Written("v.xml"), "<fcd-output value=\"OUTSIDE/v.xml\"/>"),
        option("one dot dot", Written("v.xml"), "<tripinfo value=\"../v.xml\"/>"),
        option("log", Written("v.txt"), "<l value=\"v.txt\"/>"),
        option("error log", Written("v.txt"), "<error-log value=\"OUTSIDE/v.txt\"/>"),
        option("a stream in other letters", Written("NuL"), "<fcd-output value=\"NuL\"/>"),
        option("a stream", Harmless, "<fcd-output value=\"NUL\"/>"),
        option("a second attribute", Written("v.xml"), "<fcd-output value=\"\" v=\"v.xml\"/>"),
        option("text behind an empty value", Written("v.xml"), "<fcd-output value=\"\">v.xml</fcd-output>"),
        option("text behind the element", Written("v.xml"), "<fcd-output value=\"\"></fcd-output>v.xml"),
        option("text that is not parsed", Written("v.xml"), "<fcd-output><![CDATA[v.xml]]></fcd-output>"),
        option("text with references", Written("v.xml"), "<fcd-output>v&#46;xml</fcd-output>"),
        option("statistics", Written("v.xml"), "<statistic-output value=\"v.xml\"/>"),
        option(
            "an option nobody knows",
            Refused(&["c.sumocfg:3: dump-to", "SUMO 1.15 to 1.28"]),
            "<dump-to value=\"v.xml\"/>",
        ),
        option(
            "states",
            Written("v_2.00.xml"),
            "<save-state.times value=\"2\"/><save-state.suffix value=\".xml\"/><save-state.prefix value=\"OUTSIDE/v\"/>",
        ),
        option(
            "states with names",
            Written("v.xml"),
            "<save-state.times value=\"2\"/><save-state.files value=\"OUTSIDE/v.xml\"/>",
        ),
        option(
            "a suffix with a folder",
            Refused(&["c.sumocfg:3: save-state.suffix: found /../../v.xml", "without folder"]),
            "<save-state.times value=\"2\"/><save-state.suffix value=\"/../../v.xml\"/>",
        ),
        option("a prefix", Written("v_w.xml"), "<output-prefix value=\"OUTSIDE/v_\"/><summary value=\"w.xml\"/>"),
        option("queues", Written("v.xml"), "<queue-output value=\"OUTSIDE/v.xml\"/>"),
        option(
            "a socket",
            Refused(&["c.sumocfg:3: tripinfo-output: found 127.0.0.1:9", "wanted a file name"]),
            "<tripinfo-output value=\"127.0.0.1:9\"/>",
        ),
        option(
            "a socket by a synonym, on a list",
            Refused(&["c.sumocfg:3: l: found v.txt,[::1]:9"]),
            "<l value=\"v.txt,[::1]:9\"/>",
        ),
        option(
            "a prefix that makes a socket",
            Written("localhost_v.xml"),
            "<output-prefix value=\"localhost:\"/><summary value=\"v.xml\"/>",
        ),
        option(
            "ssm",
            Written("v.xml"),
            "<device.ssm.probability value=\"1\"/><device.ssm.file value=\"OUTSIDE/v.xml\"/>",
        ),
    ]
}

/// Outputs named in files that SUMO loads.
fn loaded_files() -> Vec<Case> {
    let utf16: Vec<u8> = format!("\u{feff}{EDGES}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let utf32: Vec<u8> = format!("\u{feff}{EDGES}").chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
    let included = |href: &str| format!("<additional><include href=\"{href}\"/></additional>");
    let element = |text: &str| format!("<additional>{text}</additional>");
    let detector = "<e1Detector id=\"d\" lane=\"before_0\" pos=\"1\" period=\"2\" file=\"v.xml\"/>";
    let event = "<timedEvent type=\"SaveTLSStates\" source=\"tl\" dest=\"v.xml\"/>";
    let plain = |net: &str| net.replace("</net>", &format!("{detector}</net>"));
    let steered = ours("light.net.xml").replacen("type=\"static\"", "type=\"actuated\"", 1);
    let steered = steered.replacen("<phase", "<param key=\"file\" value=\"v.xml\"/><phase", 1);
    let watched = demand(&device("ssm", "v.xml"), "");
    let vtype = &watched[watched.find("<vType").unwrap()..watched.find("<vehicle").unwrap()];
    let calibrated = vtype.replace("id=\"ego\"", "id=\"other\"");
    let socket = |text: &str| text.replace("v.xml", "127.0.0.1:9");
    let dtd = "<!DOCTYPE a [<!ENTITY o \"x\">]>";
    vec![
        Case::new("an additional file", Written("v.xml")).additional(EDGES),
        Case::new("a detector", Written("v.xml")).additional(element(detector)),
        Case::new("a traffic light's states", Written("v.xml")).additional(element(event)),
        Case::new("gzip", Written("v.xml")).additional(compressed(EDGES, false)),
        Case::new("zlib", Refused(&["a.xml", "a character 0"])).additional(compressed(EDGES, true)),
        Case::new("UTF-16", Written("v.xml")).additional(utf16),
        Case::new("UTF-32", Refused(&["a.xml", "a character 0"])).additional(utf32),
        Case::new("a root of a configuration", Written("v.xml")).additional(EDGES.replace("additional", "configuration")),
        Case::new("an included file", Written("v.xml")).additional(included("b.xml")).file("b.xml", EDGES),
        Case::new("an included gzip", Written("v.xml")).additional(included("b.xml")).file("b.xml", compressed(EDGES, false)),
        Case::new("a type definition", Refused(&["a.xml:1: a document type"])).additional(format!("{dtd}{EDGES}")),
        Case::new("a network", Written("v.xml")).file("light.net.xml", plain(&ours("light.net.xml"))),
        Case::new("a network, gzipped", Written("v.xml"))
            .file("light.net.xml", compressed(&plain(&ours("light.net.xml")), false)),
        Case::new("a traffic light of a network", Harmless).file("light.net.xml", steered),
        Case::new("a vType's ssm", Written("v.xml")).file("light.rou.xml", demand(&device("ssm", "OUTSIDE/v.xml"), "")),
        Case::new("a vType's toc", Written("v.xml")).file("light.rou.xml", demand(&device("toc", "v.xml"), "")),
        Case::new("a vehicle's ssm", Written("v.xml")).file("light.rou.xml", demand("", &device("ssm", "OUTSIDE/v.xml"))),
        Case::new("a vehicle's toc", Written("v.xml")).file("light.rou.xml", demand("", &device("toc", "v.xml"))),
        Case::new("a device without a name", Written("ssm.xml"))
            .file("light.rou.xml", demand(&param("has.ssm.device", "true"), "")),
        Case::new("demand, gzipped", Written("v.xml"))
            .file("light.rou.xml", compressed(&demand(&device("ssm", "v.xml"), ""), false)),
        Case::new("vTypes of an additional file", Written("v.xml"))
            .file("light.rou.xml", ours("light.rou.xml").replace("<vType id=\"ego\"", "<vType id=\"other\""))
            .additional(element(vtype)),
        Case::new("vTypes of a calibrator's file", Harmless)
            .additional(element("<calibrator id=\"c\" edge=\"before\" pos=\"0\" file=\"b.xml\"/>"))
            .file("b.xml", format!("<calibrator>{calibrated}<flow id=\"f\" type=\"other\" begin=\"0\" end=\"9\" vehsPerHour=\"3600\" route=\"r\"/></calibrator>")),
        Case::new("a socket of an additional file", Refused(&["a.xml:1: file of edgeData: found 127.0.0.1:9", "a file name"]))
            .additional(element("<edgeData id=\"e\" file=\"127.0.0.1:9\"/>")),
        Case::new("a socket of an included detector", Refused(&["b.xml:1: file of e1Detector: found 127.0.0.1:9"]))
            .additional(included("b.xml")).file("b.xml", element(&socket(detector))),
        Case::new("a socket for a traffic light's states", Refused(&["a.xml:1: dest of timedEvent: found 127.0.0.1:9"]))
            .additional(element(&socket(event))),
        Case::new("a socket of a network", Refused(&["light.net.xml:", "file of e1Detector: found 127.0.0.1:9"]))
            .file("light.net.xml", socket(&plain(&ours("light.net.xml")))),
        Case::new("a socket of a vType's device", Refused(&["light.rou.xml:", "device.ssm.file of vType: found localhost:9"]))
            .file("light.rou.xml", demand(&device("ssm", "localhost:9"), "")),
        Case::new("a socket of a vehicle's device", Refused(&["light.rou.xml:", "device.toc.file of vehicle: found localhost:9"]))
            .file("light.rou.xml", demand("", &device("toc", "localhost:9"))),
        Case::new("a detector among the demand", Harmless)
            .file("light.rou.xml", ours("light.rou.xml").replace("</routes>", &format!("{detector}</routes>"))),
    ]
}

/// Options of scenarios in TOML.
fn tomls() -> Vec<Case> {
    let toml = |name, fate, options: &str| Case::new(name, fate).toml(options);
    let no_simulation = Refused(&["c.toml:3: sumo.options", "with it SUMO does not simulate"]);
    vec![
        toml("fcd of a TOML", Written("v.xml"), r#"["--fcd-output", "OUTSIDE/v.xml"]"#),
        toml("with a sign", Written("v.xml"), r#"["--fcd-output=../v.xml"]"#),
        toml("abbreviated", Written("v.txt"), r#"["-l", "v.txt"]"#),
        toml("a prefix of a TOML", Written("v_sumo.log"), r#"["--output-prefix", "OUTSIDE/v_"]"#),
        toml("letters in one word", Refused(&["c.toml:3: ", "a text of its own"]), r#"["-vl", "v.txt"]"#),
        toml("no value", Refused(&["c.toml:3: ", "a file name"]), r#"["--fcd-output", "--v.xml"]"#),
        toml(
            "a socket of a TOML",
            Refused(&["c.toml:3: sumo.options", "--fcd-output localhost:9", "a file name"]),
            r#"["--fcd-output", "localhost:9"]"#,
        ),
        toml("states of a TOML", Written("state_2.00.xml.gz"), r#"["--save-state.times", "2"]"#),
        toml("save-template of a TOML", no_simulation, r#"["--save-template", "OUTSIDE/v.xml"]"#),
        toml("C of a TOML", no_simulation, r#"["-C", "v.xml"]"#),
        toml("ssm of a TOML", Written("v.xml"), r#"["--device.ssm.probability", "1", "--device.ssm.file", "v.xml"]"#),
    ]
}

/// All files below a folder with their bytes.
fn listing(folder: &Path) -> BTreeSet<(String, Vec<u8>)> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            found.extend(listing(&entry.path()).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else {
            found.insert((name, fs::read(entry.path()).unwrap()));
        }
    }
    found
}

/// Runs a scenario in a fresh folder; says what is wrong with what comes of it.
fn judge(version: &str, case: &Case) -> Result<(), String> {
    let folder = tempfile::tempdir().unwrap();
    let [home, outside, results] = ["home", "outside", "results"].map(|name| folder.path().join(name));
    for path in [&home, &outside, &results] {
        fs::create_dir(path).unwrap();
    }
    let filled = |text: &str| text.replace("OUTSIDE", &outside.to_string_lossy());
    for name in ["light.net.xml", "light.rou.xml"] {
        fs::write(home.join(name), ours(name)).unwrap();
    }
    for (name, bytes) in &case.files {
        let text = std::str::from_utf8(bytes).map(|text| filled(text).into_bytes());
        fs::write(home.join(name), text.unwrap_or_else(|_| bytes.clone())).unwrap();
    }
    let input = "<net-file value=\"light.net.xml\"/><route-files value=\"light.rou.xml\"/><end value=\"3\"/>";
    let options = filled(&case.options);
    fs::write(home.join("c.sumocfg"), format!("<configuration>\n{input}\n{options}\n</configuration>\n")).unwrap();
    let scenario = home.join(if case.toml.is_some() { "c.toml" } else { "c.sumocfg" });
    if let Some(text) = &case.toml {
        fs::write(&scenario, filled(text)).unwrap();
    }
    let before = [&home, &outside].map(|path| listing(path));
    let dir = results.join("r");
    let mut command = run_command(version, &scenario, &dir, &["--no-report", "--controller", "ideal"]);
    command.current_dir(&home);
    let ended = Running::start(command).wait();
    let said = ended.stderr.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    let wrong = |what: String| Err(format!("SUMO {version}, {}: {what}\n{said}", case.name));
    if [&home, &outside].map(|path| listing(path)) != before {
        return wrong("it wrote outside".to_owned());
    }
    let beside: Vec<_> = fs::read_dir(&results).unwrap().flatten().filter(|entry| entry.path() != dir).collect();
    if !beside.is_empty() {
        return wrong(format!("it wrote beside the result: {beside:?}"));
    }
    match (ended.code, case.fate.unwrap()) {
        (Some(0), Written(name)) if !dir.join("sumo").join(name).is_file() => wrong(format!(
            "no {name} among {:?}",
            fs::read_dir(dir.join("sumo")).unwrap().flatten().collect::<Vec<_>>()
        )),
        (Some(0), Written(_) | Harmless) => Ok(()),
        (Some(1), Refused(parts)) if parts.iter().all(|part| said.contains(part)) => Ok(()),
        (code, Refused(parts)) => wrong(format!("ended with {code:?}, wanted 1 and {parts:?}")),
        (code, _) => wrong(format!("ended with {code:?}")),
    }
}

#[test]
fn law_a_scenario_of_a_stranger_writes_below_its_result_only() {
    let cases: Vec<Case> = [configurations(), loaded_files(), tomls()].into_iter().flatten().collect();
    assert!(cases.len() >= 55, "{}", cases.len());
    // Both versions where SUMO itself has a part in it.
    let simulated = |case: &&Case| !matches!(case.fate, Some(Refused(_)));
    let all = cases.iter().map(|case| (NEW, case)).chain(cases.iter().filter(simulated).map(|case| (OLD, case)));
    let (open, wrong) = (Mutex::new(all.collect::<Vec<_>>()), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                while let Some((version, case)) = { open.lock().unwrap().pop() } {
                    wrong.lock().unwrap().extend(judge(version, case).err());
                }
            });
        }
    });
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{} of the scenarios:\n{}", wrong.len(), wrong.join("\n\n"));
}

/// What the user types is the user's own affair.
#[test]
fn options_behind_the_dashes_write_where_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let (elsewhere, dir) = (folder.path().join("v.xml"), folder.path().join("r"));
    let options = ["--no-report", "--end", "3", "--", "--fcd-output", elsewhere.to_str().unwrap()];
    let ended = Running::start(run_command(NEW, &repository("sumo_nets/light/light.sumocfg"), &dir, &options)).wait();
    assert_eq!((ended.code, elsewhere.is_file()), (Some(0), true), "{}", ended.stderr);
}

/// The lists of options in the source are those of SUMO: each version's own list has none that is not known.
#[test]
fn val_every_option_of_sumo_is_known() {
    let known = fs::read_to_string(repository("src/sumo_files/settings.txt")).unwrap();
    let options = fs::read_to_string(repository("src/sumo_files/options.rs")).unwrap();
    for version in [NEW, OLD] {
        let folder = tempfile::tempdir().unwrap();
        let template = folder.path().join("template.xml");
        crate::support::plain_sumo(version, &["--save-template", template.to_str().unwrap()]);
        let text = fs::read_to_string(&template).unwrap();
        let lines = text.lines().map(str::trim).filter(|line| line.contains(" type=\""));
        let mut count = 0;
        for line in lines {
            let name = line[1..].split(' ').next().unwrap();
            let synonyms = line.split(" synonymes=\"").nth(1).map_or("", |rest| rest.split('"').next().unwrap());
            let file = line.contains(" type=\"FILE\"");
            for name in synonyms.split(' ').filter(|synonym| !synonym.is_empty()).chain([name]) {
                let listed = known.split_whitespace().any(|word| word == name);
                let coded = options.contains(&format!("\"{name}\"")) || name.ends_with("-output");
                assert!(listed || coded, "SUMO {version}: {name} is on no list");
                assert!(!(file && listed && name.ends_with("-output")), "{name} is an output");
            }
            count += 1;
        }
        assert!(count > 350, "{count} options of SUMO {version}");
    }
}
