//! What a configuration says counts: its seed, its trains, its missing files; and what cannot be followed is said.

use crate::support::{CAR, NEW, OLD, configuration, network, own, refusal, run, straight_road};
use std::fs;

const EGO: &str = r#"<vehicle id="ego" type="car" depart="0"><route edges="ab bc"/></vehicle>"#;

/// A configuration of a straight road with these further elements.
fn with(folder: &std::path::Path, more: &str) -> std::path::PathBuf {
    let config = straight_road(folder, &format!("{CAR}{EGO}"));
    configuration(folder, &folder.join("made.net.xml"), &format!("{CAR}{EGO}"), more);
    config
}

#[test]
fn the_seed_of_the_configuration_counts_until_another_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let config =
        with(folder.path(), r#"<random_number><seed value="7"/></random_number><time><end value="5"/></time>"#);
    let theirs = run(NEW, &config, &[]);
    assert_eq!(theirs.json("run.json")["seed"], 7);
    assert!(!theirs.ended.stderr.contains("seed"), "{}", theirs.ended.stderr);
    let ours = run(NEW, &config, &["--seed", "3"]);
    assert_eq!(ours.json("run.json")["seed"], 3);
    assert!(ours.ended.stderr.contains("seed 3 instead of 7 (--seed decides)"), "{}", ours.ended.stderr);
    // The same goes for a seed behind `--`, which is refused with what to use.
    assert!(refusal(NEW, &config, &["--", "--seed", "3"]).contains("--seed or sumo.seed"));
}

#[test]
fn trains_keep_eulers_steps() {
    let folder = tempfile::tempdir().unwrap();
    let nodes = r#"<node id="a" x="0" y="0"/><node id="b" x="1000" y="0"/><node id="c" x="2000" y="0"/>"#;
    let edges = r#"<edge id="ab" from="a" to="b" numLanes="1" speed="20"/><edge id="bc" from="b" to="c" numLanes="1" speed="20"/>"#;
    let net = network(folder.path(), nodes, edges);
    let train = r#"<vType id="train" vClass="rail" carFollowModel="Rail" trainType="REDosto7" length="100"/>"#;
    let by_rail = r#"<vehicle id="t" type="train" depart="1"><route edges="ab bc"/></vehicle>"#;
    for version in [NEW, OLD] {
        let config = configuration(folder.path(), &net, &format!("{CAR}{train}{EGO}{by_rail}"), "");
        let result = run(version, &config, &["--end", "60"]);
        assert!(result.ended.stderr.contains(r#"Euler steps: the vType "train""#), "{}", result.ended.stderr);
        assert_eq!(result.sumo("inserted"), 2.0, "SUMO {version}");
        assert_eq!(result.vehicle("ego")["reason"], "running");
    }
    let config = configuration(folder.path(), &net, &format!("{CAR}{EGO}"), "");
    let options = ["--end", "20", "--", "--default.carfollowmodel", "Rail"];
    let result = run(NEW, &config, &options);
    assert!(result.ended.stderr.contains("default.carfollowmodel is Rail"), "{}", result.ended.stderr);
}

#[test]
fn a_mesoscopic_simulation_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let config = with(folder.path(), r#"<processing><mesosim value="true"/></processing>"#);
    let said = refusal(NEW, &config, &[]);
    assert!(said.contains("made.sumocfg:1: mesosim: found true"), "{said}");
    let config = with(folder.path(), "");
    assert!(refusal(NEW, &config, &["--", "--mesosim"]).contains("-- --mesosim: mesosim: found true"));
}

#[test]
fn an_end_before_the_begin_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let config = with(folder.path(), r#"<time><begin value="0:01:00"/></time>"#);
    let said = refusal(NEW, &config, &["--end", "30"]);
    assert!(said.contains("--end 30: sumo.end_s: found 30, wanted more than 60"), "{said}");
    let said = refusal(NEW, &with(folder.path(), ""), &["--end", "30", "--", "-b", "40"]);
    assert!(said.contains("wanted more than 40"), "{said}");
}

/// What is named behind `--` replaces the configuration's, also in our checks, and is searched for outputs as well.
#[test]
fn files_behind_the_dashes_replace_the_configurations() {
    let folder = tempfile::tempdir().unwrap();
    let config = with(folder.path(), r#"<input><additional-files value="gone.xml"/></input>"#);
    let said = refusal(NEW, &config, &[]);
    assert!(said.contains("additional-files") && said.contains("gone.xml does not exist"), "{said}");
    let other = folder.path().join("other.add.xml");
    fs::write(&other, r#"<additional><edgeData id="e" file="edges.xml"/></additional>"#).unwrap();
    let result = run(NEW, &config, &["--end", "20", "--", "--additional-files", other.to_str().unwrap()]);
    assert!(result.dir.join("sumo/edges.xml").is_file() && !folder.path().join("edges.xml").exists());
    assert_eq!(result.vehicles().len(), 1);
    let said = refusal(NEW, &config, &["--", "-a", "nowhere.xml"]);
    assert!(said.contains("-- --additional-files: additional-files") && said.contains("nowhere.xml"), "{said}");
}

#[test]
fn clients_that_the_configuration_waits_for_are_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let config = with(folder.path(), r#"<traci_server><num-clients value="2"/></traci_server>"#);
    let result = run(NEW, &config, &["--end", "20"]);
    assert!(
        result.ended.stderr.contains("1 TraCI clients instead of 2 (--num-clients decides)"),
        "{}",
        result.ended.stderr
    );
}

/// SUMO under TraCI does not end after too many teleports, as it does alone.
#[test]
fn an_end_by_teleports_that_sumo_does_not_heed_is_told() {
    let result = run(NEW, &own("city"), &["--end", "60", "--", "--time-to-teleport", "5", "--max-num-teleports", "1"]);
    assert!(result.sumo("teleports") > 2.0, "{}", result.sumo("teleports"));
    let line = "no end after 1 teleports (SUMO heeds max-num-teleports only without a client)";
    assert!(result.ended.stderr.contains(line), "{}", result.ended.stderr);
}

/// A car with dead time halts nearer than its minGap behind another one: that is no collision unless the user says so.
#[test]
fn collisions_are_contacts_unless_the_user_says_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let demand = format!(
        r#"{CAR}<vehicle id="first" type="car" depart="0" departPos="400"><route edges="ab bc"/><stop lane="ab_0" endPos="700" duration="60"/></vehicle>
        <vehicle id="ego" type="car" depart="0" departPos="0" departSpeed="20"><route edges="ab bc"/></vehicle>"#
    );
    let config = straight_road(folder.path(), &demand);
    let late = ["--controller", "pid", "--set", "actuator.delay_s=0.4", "--end", "120"];
    let contacts = run(NEW, &config, &late);
    assert!(contacts.ended.stderr.contains("collisions are contacts instead of gaps below minGap"));
    assert_eq!((contacts.sumo("collisions"), contacts.sumo("teleports")), (0.0, 0.0));
    assert_eq!(contacts.vehicle("ego")["collisions"], "0");
    let gaps = run(NEW, &config, &[&late[..], &["--", "--collision.mingap-factor", "1"]].concat());
    assert_eq!(gaps.sumo("collisions"), 1.0, "the car should have come nearer than minGap");
    assert!(gaps.ended.stderr.contains("gaps below 1 minGap, as it says"), "{}", gaps.ended.stderr);
    let ideal = run(NEW, &config, &["--controller", "ideal", "--end", "120"]);
    assert!(!ideal.ended.stderr.contains("contacts"), "{}", ideal.ended.stderr);
}
