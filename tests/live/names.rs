//! What matches nothing is told in one line, a wrong value is refused before SUMO starts, and odd bodies are told.

use crate::support::{CAR, NEW, number, refusal, run, straight_road};
use std::fs;
use std::path::{Path, PathBuf};

const ROUTE: &str = r#"<route edges="ab bc"/>"#;

/// A scenario of a straight road with these vehicles beside a car called `ego`.
fn scenario(folder: &Path, more: &str, toml: &str) -> PathBuf {
    straight_road(
        folder,
        &format!(r#"{CAR}<vehicle id="ego" type="car" depart="0" departSpeed="0">{ROUTE}</vehicle>{more}"#),
    );
    let path = folder.join("s.toml");
    fs::write(&path, format!("sumo.config = \"made.sumocfg\"\nsumo.end_s = 60\n{toml}")).unwrap();
    path
}

#[test]
fn what_matches_nothing_is_told_once_with_the_nearest_name() {
    let folder = tempfile::tempdir().unwrap();
    let odd = format!(r#"<vehicle id="odd" type="car" depart="1">{ROUTE}<param key="mfc.mas" value="1"/></vehicle>"#);
    let groups =
        "[[group]]\nselect = \"type:cra\"\n[[group]]\nselect = \"id:nobody\"\n[[group]]\nselect = \"id:ego\"\n";
    let result = run(NEW, &scenario(folder.path(), &odd, groups), &["--trace", "eog,odd"]);
    let said = &result.ended.stderr;
    for told in [
        "made.rou.xml:1: the parameter mfc.mas is not known and changes nothing; did you mean mfc.mass?",
        "group.0.select: found \"type:cra\", wanted a vType of the demand; did you mean type:car?",
        "group.1.select = \"id:nobody\" matched no vehicle",
        "output.trace: eog matched no vehicle; did you mean ego?",
    ] {
        assert!(said.contains(told), "{told}\n{said}");
    }
    assert_eq!(said.matches("note: group.").count(), 2, "{said}");
    assert_eq!(said.matches("note: output.trace").count(), 1, "{said}");
}

#[test]
fn values_are_checked_before_their_vehicle_departs() {
    let folder = tempfile::tempdir().unwrap();
    for (key, value) in [("mfc.mass", "heavy"), ("mfc.mass_factor", "normal(1)"), ("device.mfc.probability", "2")] {
        let late = format!(
            "\n<vehicle id=\"late\" type=\"car\" depart=\"1000\">{ROUTE}\n<param key=\"{key}\" value=\"{value}\"/></vehicle>"
        );
        let said = refusal(NEW, &scenario(folder.path(), &late, ""), &[]);
        assert!(said.contains(&format!("made.rou.xml:3: {key}: found \"{value}\", wanted a number")), "{said}");
    }
}

#[test]
fn a_run_that_asks_for_egos_and_has_none_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenario(folder.path(), "", "");
    let said = refusal(NEW, &scenario, &["--egos", "type:cra"]);
    assert!(
        said.contains("egos.select: found \"type:cra\", wanted a vType of the demand; did you mean type:car?"),
        "{said}"
    );
    let said = refusal(NEW, &scenario, &["--egos", "id:nobody"]);
    let told = "no vehicle has become an ego: 1 vehicles departed; egos.select = \"id:nobody\"";
    assert!(said.contains(told), "{said}");
    assert!(run(NEW, &scenario, &["--egos", "share:0"]).vehicles().is_empty(), "nobody asked for any");
}

#[test]
fn a_car_with_the_mass_of_another_kind_is_told_and_a_factor_fits_all() {
    let folder = tempfile::tempdir().unwrap();
    let truck = format!(
        r#"<vType id="truck" vClass="truck"/><vehicle id="truck" type="truck" depart="10" departSpeed="0">{ROUTE}</vehicle>
        <vType id="light" vClass="truck"><param key="mfc.mass_factor" value="uniform(0.2, 0.3)"/></vType>
        <vehicle id="light" type="light" depart="20" departSpeed="0">{ROUTE}</vehicle>"#
    );
    let scenario = scenario(folder.path(), &truck, "");
    let absolute = run(NEW, &scenario, &["--set", "vehicle.mass_kg={distribution=\"uniform\",min=1499,max=1500}"]);
    let said = &absolute.ended.stderr;
    assert!(said.contains("note: 2 egos have less than half or more than twice the mass of their kind"), "{said}");
    assert!(said.contains("the first, \"truck\": 1500 kg instead of"), "{said}");
    let relative = run(NEW, &scenario, &["--set", "vehicle.mass_factor={distribution=\"uniform\",min=0.7,max=1.5}"]);
    let said = &relative.ended.stderr;
    assert!(said.contains("note: 1 egos") && said.contains("the first, \"light\": "), "{said}");
}

#[test]
fn a_dead_time_of_one_vehicle_acts() {
    let folder = tempfile::tempdir().unwrap();
    let late = format!(
        r#"<vehicle id="late" type="car" depart="20" departSpeed="0">{ROUTE}<param key="mfc.delay" value="0.5"/></vehicle>"#
    );
    let result = run(NEW, &scenario(folder.path(), &late, ""), &[]);
    let error = |id: &str| number(&result.vehicle(id), "error_rms");
    assert!(error("late") > 5.0 * error("ego"), "{} {}", error("late"), error("ego"));
}
