//! What reads something that somebody else wrote, one function each, as a fuzzer calls it: any bytes in, and what is wrong
//! with how they were read out. Shared with `fuzz/`, where a coverage-guided fuzzer calls the same functions.

use std::fmt::{Debug, Display};
use std::fs;
use std::path::{Path, PathBuf};

use sumo_mfc::plant::tyre::{identify, read_curve};
use sumo_mfc::reference::{Axis, Profile, RecordingOptions};
use sumo_mfc::run::repeated;
use sumo_mfc::scenario::{Catalog, Override, Parameter, Request, Scenario, Selector, parameter_keys};
use sumo_mfc::study::{Arguments, Definition};
use sumo_mfc::sumo_files::{
    Conflicts, Equipped, SumoStatistics, Trips, as_configured, each_trip, incidents, is_network, left_out,
    network_roads, span_s, sumo_arguments,
};
use tempfile::TempDir;

#[path = "../traci_wire/harness.rs"]
mod decoder;

/// True if the bytes were taken for what they should be, false if they were refused as they should be.
type Judged = Result<bool, String>;

/// Something that reads.
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// Reads the bytes.
    pub read: fn(&Room, &[u8]) -> Judged,
}

/// Everything that reads.
pub const TARGETS: &[Target] = &[
    Target { name: "decoder", read: decoder },
    Target { name: "scenario", read: scenario },
    Target { name: "set", read: set },
    Target { name: "study", read: study },
    Target { name: "manifest", read: manifest },
    Target { name: "configuration", read: configuration },
    Target { name: "demand", read: demand },
    Target { name: "additional", read: additional },
    Target { name: "state", read: state },
    Target { name: "network", read: network },
    Target { name: "tripinfo", read: tripinfo },
    Target { name: "statistics", read: statistics },
    Target { name: "conflicts", read: conflicts },
    Target { name: "log", read: log },
    Target { name: "recording", read: recording },
    Target { name: "tyre_curve", read: tyre_curve },
    Target { name: "parameter", read: parameter },
];

/// A folder with the files that the bytes may name, and the entries that they may choose.
pub struct Room {
    folder: TempDir,
    catalog: Catalog,
}

impl Room {
    /// A folder of its own.
    pub fn new() -> Self {
        // In memory where there is such a folder: each case is written and read.
        let memory = Path::new("/dev/shm");
        let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }.unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("a.net.xml", include_str!("../../sumo_nets/light/light.net.xml"));
        write("a.rou.xml", include_str!("../../sumo_nets/light/light.rou.xml"));
        write("b.rou.xml", "<routes><include href=\"c.rou.xml\"/><trip id=\"b\"/></routes>");
        write("c.rou.xml", "<routes><vType id=\"c\"/></routes>");
        write("p.csv", "s_m,v_mps\n0,10\n100,20\n");
        write("demand.sumocfg", "<c><net-file value=\"a.net.xml\"/><route-files value=\"case.rou.xml\"/></c>");
        let additional = "<additional-files value=\"case.add.xml\"/>";
        let more = format!("<c><net-file value=\"a.net.xml\"/><route-files value=\"a.rou.xml\"/>{additional}</c>");
        write("additional.sumocfg", &more);
        write("plain.sumocfg", "<c><net-file value=\"a.net.xml\"/><route-files value=\"a.rou.xml\"/></c>");
        write("plain.toml", "[sumo]\nconfig = \"plain.sumocfg\"\n[[group]]\nselect = \"type:bus*\"\n");
        Self { folder, catalog: Catalog::installed() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn put(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, bytes).unwrap();
        path
    }

    fn load(&self, request: &Request, shows: &[&str], bytes: &[u8]) -> Result<Option<Scenario>, String> {
        match Scenario::load_offline(request, &self.catalog) {
            Ok(scenario) => Ok(Some(scenario)),
            Err(error) => reported(error, shows, bytes).map(|()| None),
        }
    }
}

/// How the text of a value looks that was printed for programmers.
const DEBUG: &[&str] = &["Some(", "None)", "Ok(", "Err(", "Error(", "ErrorKind"];

/// What of a text is of a value that was printed for programmers. A table in TOML has braces, too, but no name before them.
fn dumped<'t>(text: &'t str, input: &str) -> Option<&'t str> {
    let structs = text.match_indices(" {").map(|(end, _)| {
        let name = text[..end].rsplit(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
        &text[end - name.len()..end + 2]
    });
    let structs = structs.filter(|name| name.starts_with(char::is_uppercase));
    // What is wrong may be told in the words of the input.
    DEBUG.iter().copied().filter(|part| text.contains(part)).chain(structs).find(|part| !input.contains(part))
}

#[test]
fn values_for_programmers_are_known_from_tables() {
    assert_eq!(dumped("it is Os { code: 2 }", ""), Some("Os {"));
    assert_eq!(dumped("it is Some(2)", ""), Some("Some("));
    assert_eq!(dumped("it is Some(2)", "a = Some(2)"), None);
    assert_eq!(dumped("wanted a table: reference = { \"controller.name\" = \"ideal\" }", ""), None);
}

/// A message says something, says where (one of `shows` is in it), and is no dump of a value.
fn told(error: &dyn Display, shows: &[&str], bytes: &[u8]) -> Result<(), String> {
    let text = error.to_string();
    let input = String::from_utf8_lossy(bytes);
    match dumped(&text, &input) {
        _ if text.trim().is_empty() => Err("an error without a word".to_owned()),
        Some(part) => Err(format!("a message for programmers, with {part:?}: {text}")),
        None if !shows.is_empty() && !shows.iter().any(|name| text.contains(name)) => {
            Err(format!("a message without any of {shows:?}: {text}"))
        }
        None => Ok(()),
    }
}

/// The same of an error that is shown with the lines of the file, and the whole text is made.
fn reported(
    error: impl miette::Diagnostic + Send + Sync + 'static,
    shows: &[&str],
    bytes: &[u8],
) -> Result<(), String> {
    told(&error, shows, bytes)?;
    let whole = format!("{:?}", miette::Report::new(error));
    if whole.trim().is_empty() { Err("a report without a word".to_owned()) } else { Ok(()) }
}

/// The value, unless the reader has refused it; then its message must show one of `shows`.
fn or_refused<T, E: Display + Debug>(read: Result<T, E>, shows: &[&str], bytes: &[u8]) -> Result<Option<T>, String> {
    match read {
        Ok(value) => Ok(Some(value)),
        Err(error) => told(&error, shows, bytes).map(|()| None),
    }
}

fn finite(what: &str, values: impl IntoIterator<Item = f64>) -> Result<(), String> {
    let wrong = values.into_iter().find(|value| !value.is_finite());
    wrong.map_or(Ok(()), |value| Err(format!("{what} is {value}")))
}

/// SUMO's replies.
fn decoder(_: &Room, bytes: &[u8]) -> Judged {
    decoder::decode(bytes);
    Ok([decoder::events(), decoder::gets()].iter().any(|batch| decoder::walk(bytes, batch).is_ok()))
}

/// A scenario file: what is taken is printed, read back and printed again.
fn scenario(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.toml", bytes);
    let Some(scenario) = room.load(&Request::file(path), &["case.toml", "sumocfg", "xml", "nothing to run"], bytes)?
    else {
        return Ok(false);
    };
    read_back(room, &scenario)?;
    for group in &scenario.groups {
        or_refused(group.load_target(), &[], bytes)?;
        or_refused(group.load_tyre_curve(), &["tyre_curve"], bytes)?;
    }
    scenario.default_folder();
    Ok(true)
}

fn read_back(room: &Room, scenario: &Scenario) -> Result<(), String> {
    let text = scenario.to_toml();
    let again = Scenario::from_toml("resolved.toml", &text, &room.catalog);
    let again = again.map_err(|error| format!("the resolved scenario is refused: {error}\n{text}"))?;
    if again.to_toml() == text { Ok(()) } else { Err(format!("read back it is another:\n{text}\n{}", again.to_toml())) }
}

/// Arguments of `--set`, one a line.
fn set(room: &Room, bytes: &[u8]) -> Judged {
    let text = String::from_utf8_lossy(bytes);
    let overrides: Vec<_> = text.lines().filter_map(Override::set).collect();
    let request = Request { overrides, ..Request::file(room.path("plain.toml")) };
    let shows = ["--set", "plain.toml", "xml", "sumocfg", "nothing to run"];
    let Some(scenario) = room.load(&request, &shows, bytes)? else { return Ok(false) };
    read_back(room, &scenario).map(|()| true)
}

/// A study file.
fn study(room: &Room, bytes: &[u8]) -> Judged {
    let request = Request::file(room.put("case.toml", bytes));
    match Definition::read(&Arguments { request, ..Arguments::default() }) {
        Ok(_) => Ok(true),
        Err(error) => reported(error, &["case.toml", "scenario"], bytes).map(|()| false),
    }
}

/// `run.json`, from which a run is repeated.
fn manifest(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("run.json", bytes);
    Ok(or_refused(repeated(&path, &room.catalog), &["run.json", "xml", "sumocfg"], bytes)?.is_some())
}

/// What is done with a scenario before SUMO is started.
fn prepared(room: &Room, scenario: &Scenario, bytes: &[u8]) -> Result<(), String> {
    let out = room.path("out");
    fs::create_dir_all(out.join("sumo")).unwrap();
    let shows = ["case.", "xml", "sumocfg"];
    let command = or_refused(sumo_arguments(&scenario.sumo, &out), &shows, bytes)?;
    if let Some(argument) = command.iter().flat_map(|c| &c.arguments).find(|argument| argument.contains('\0')) {
        return Err(format!("an argument that no program can be given: {argument:?}"));
    }
    or_refused(span_s(&scenario.sumo), &shows, bytes)?;
    or_refused(as_configured(&scenario.sumo), &shows, bytes)?;
    fs::remove_dir_all(out).unwrap();
    Ok(())
}

/// A SUMO configuration.
fn configuration(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.sumocfg", bytes);
    let Some(scenario) = room.load(&Request::file(path), &["case.sumocfg", "xml", "nothing to run"], bytes)? else {
        return Ok(false);
    };
    prepared(room, &scenario, bytes).map(|()| true)
}

/// A file of demand.
fn demand(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.rou.xml", bytes);
    let equipped = or_refused(Equipped::read(&[path]), &[".rou.xml", ".xml"], bytes)?;
    for id in ["a", "a.0", "a.-1", "\u{e9}", ""] {
        equipped.as_ref().map(|found| found.of(id));
    }
    let request = Request::file(room.path("demand.sumocfg"));
    let Some(scenario) = room.load(&request, &["demand.sumocfg", ".xml"], bytes)? else { return Ok(false) };
    prepared(room, &scenario, bytes).map(|()| true)
}

/// An additional file, whose outputs are sent elsewhere.
fn additional(room: &Room, bytes: &[u8]) -> Judged {
    room.put("case.add.xml", bytes);
    let request = Request::file(room.path("additional.sumocfg"));
    let Some(scenario) = room.load(&request, &["additional.sumocfg", ".xml"], bytes)? else { return Ok(false) };
    prepared(room, &scenario, bytes).map(|()| true)
}

/// A state that SUMO has saved.
fn state(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.state.xml", bytes);
    let load = Override::text("--set", "sumo.load_state", &path.to_string_lossy());
    let request = Request::file(room.path("plain.sumocfg")).with(load);
    let Some(scenario) = room.load(&request, &["case.state.xml"], bytes)? else { return Ok(false) };
    let out = room.path("out");
    fs::create_dir_all(out.join("sumo")).unwrap();
    Ok(or_refused(sumo_arguments(&scenario.sumo, &out), &["case.state.xml"], bytes)?.is_some())
}

/// A network's roads.
fn network(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.net.xml", bytes);
    is_network(&path);
    let roads = or_refused(network_roads(&path), &["case.net.xml"], bytes)?;
    finite("a corner", roads.iter().flatten().flat_map(|road| road.shape.iter().flatten().copied()))?;
    Ok(roads.is_some())
}

/// SUMO's tripinfo, in any format.
fn tripinfo(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.tripinfo", bytes);
    let Some(trips) = or_refused(Trips::read(&path), &["case.tripinfo"], bytes)? else { return Ok(false) };
    for trip in trips.all() {
        finite("a time", [trip.depart_s, trip.duration_s, trip.time_loss_s, trip.route_length_m])?;
        finite("an arrival", trip.arrival_s)?;
        let optional = [trip.waiting_time_s, trip.waiting_count, trip.stop_time_s, trip.speed_factor];
        finite("a number", optional.into_iter().chain(trip.emissions).flatten())?;
    }
    // The same trips, one by one.
    let mut count = 0;
    let whole = each_trip(&path, |_, _| {
        count += 1;
        Ok(())
    });
    if whole.is_err() || count != trips.all().count() {
        return Err(format!("each_trip has {count} trips, {whole:?}"));
    }
    Ok(true)
}

/// SUMO's statistics, in any format.
fn statistics(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.statistics", bytes);
    Ok(or_refused(SumoStatistics::read(&path), &["case.statistics"], bytes)?.is_some())
}

/// The log of SUMO's SSM devices.
fn conflicts(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.ssm.xml", bytes);
    let Some(found) = or_refused(Conflicts::read(&path), &["case.ssm.xml"], bytes)? else { return Ok(false) };
    for conflicts in found.values() {
        finite("a measure", [conflicts.ttc_min_s, conflicts.drac_max_mps2, conflicts.pet_min_s].into_iter().flatten())?;
    }
    Ok(true)
}

/// SUMO's log.
fn log(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.log", bytes);
    let incidents = or_refused(incidents(&path), &["case.log"], bytes)?;
    or_refused(left_out(&path), &["case.log"], bytes)?;
    Ok(incidents.is_some_and(|found| !found.is_empty()))
}

/// A profile, a recording or a driving cycle.
fn recording(room: &Room, bytes: &[u8]) -> Judged {
    let path = room.put("case.csv", bytes);
    let mut taken = false;
    for (by, smooth_s) in [(None, 1.0), (Some(Axis::Position), 0.0), (Some(Axis::Time), 600.0)] {
        let options = RecordingOptions { by, smooth_s, speed_unit_mps: 1.0 / 3.6 };
        let Some(profile) = or_refused(Profile::from_file(&path, &options), &["case.csv"], bytes)? else { continue };
        taken = true;
        let length = profile.length().unwrap_or(0.0);
        finite("the length", [length])?;
        for share in 0..=20 {
            let at = length * f64::from(share) / 20.0;
            let (speed_mps, rate_mps2) = profile.at(at, at, 10.0);
            finite("the speed", [speed_mps])?;
            finite("the rate", [rate_mps2])?;
            finite("the curvature", [profile.curvature_at(at)])?;
            if speed_mps < 0.0 {
                return Err(format!("the speed at {at} is {speed_mps} m/s"));
            }
        }
    }
    Ok(taken)
}

/// A measured tyre curve.
fn tyre_curve(_: &Room, bytes: &[u8]) -> Judged {
    let Ok(text) = std::str::from_utf8(bytes) else { return Ok(false) };
    let Some(curve) = or_refused(read_curve(text), &["tyre curve"], bytes)? else { return Ok(false) };
    let Some(found) = or_refused(identify(&curve), &["tyre curve"], bytes)? else { return Ok(false) };
    finite("the peak", [found.peak_n])?;
    for share in -20..=20 {
        finite("the force", [found.tyre.force_per_peak(f64::from(share) / 20.0)])?;
    }
    Ok(true)
}

/// The text of a vehicle's parameter, or of a selector.
fn parameter(_: &Room, bytes: &[u8]) -> Judged {
    let text = String::from_utf8_lossy(bytes);
    let mut taken = or_refused(Selector::parse(&text), &[], bytes)?.is_some();
    for key in parameter_keys() {
        let Some(parameter) = or_refused(Parameter::read(key, &text), &[], bytes)? else { continue };
        taken = true;
        for id in ["a", "b"] {
            if let sumo_mfc::keys::Value::Number(value) = parameter.value(key, 1, id) {
                finite(key.name, [value])?;
                if let sumo_mfc::keys::Kind::Number { min, max, .. } = key.kind
                    && !(min..=max).contains(&value)
                {
                    return Err(format!("{} is {value}, beyond {min} to {max}", key.name));
                }
            }
        }
    }
    Ok(taken)
}

/// The target of this name.
pub fn target(name: &str) -> &'static Target {
    TARGETS.iter().find(|target| target.name == name).unwrap_or_else(|| panic!("no target {name}"))
}
