//! A leader's step on the way through ten followers, in SUMO: targets that keep a time gap, beside SUMO's own car-following.

use super::support::*;
use std::collections::BTreeMap;
use std::fs;

/// Everybody has settled by then; the leader's step comes at 300 s \[s\].
const SETTLED_S: f64 = 290.0;
const FOLLOWERS: usize = 10;

/// How a run goes: half the range of every speed after [`SETTLED_S`], over the leader's, by id.
fn swings(args: &[&str]) -> BTreeMap<String, f64> {
    let result = run(NEW, &repository("scenarios/platoon.toml"), &[&["--trace", "all"], args].concat());
    let mut ranges: BTreeMap<String, [f64; 2]> = BTreeMap::new();
    for row in result.table("trace.csv") {
        if number(&row, "time") >= SETTLED_S {
            let speed_mps = number(&row, "speed");
            let range = ranges.entry(row["id"].clone()).or_insert([speed_mps; 2]);
            *range = [range[0].min(speed_mps), range[1].max(speed_mps)];
        }
    }
    assert_eq!(ranges.len(), 1 + FOLLOWERS, "{args:?}");
    let size = |[least, most]: [f64; 2]| most - least;
    let leader_mps = size(ranges["leader"]);
    assert!((leader_mps - 1.0).abs() < 1e-6, "the leader's speed is given");
    ranges.into_iter().map(|(id, range)| (id, size(range) / leader_mps)).collect()
}

/// The swings of the first and of the last follower. With a car-following model SUMO keeps the gap, with the time headway of its default.
fn gains(args: &[&str], model: Option<&str>) -> [f64; 2] {
    let drivers = format!("sumo.config={}", repository("sumo_nets/platoon/drivers.sumocfg").display());
    let option = format!("--default.carfollowmodel={}", model.unwrap_or("Krauss"));
    let sumos = ["--target", "traffic", "--set", &drivers, "--", &option];
    let found = swings(&[args, if model.is_some() { &sumos } else { &[] }].concat());
    ["f1", "f10"].map(|id| found[id])
}

/// `--nocapture` prints the table of `docs/stability.md`.
#[test]
fn law_a_step_grows_behind_acc_and_hardly_behind_sumos_own_drivers() {
    let acc = ["--target", "ctg_acc"];
    let long = ["--target", "ctg_acc", "--set", "target.time_gap_s=2.2"];
    let cacc = ["--target", "path_cacc"];
    let upper: [(&str, &[&str], Option<&str>); 7] = [
        ("`ctg_acc`, 1.1 s", &acc, None),
        ("`ctg_acc`, 2.2 s", &long, None),
        ("`path_cacc`, 0.6 s", &cacc, None),
        ("SUMO's Krauss, 1 s", &[], Some("Krauss")),
        ("SUMO's IDM, 1 s", &[], Some("IDM")),
        ("SUMO's ACC, 1 s", &[], Some("ACC")),
        ("SUMO's CACC, 1 s", &[], Some("CACC")),
    ];
    let below: [&[&str]; 4] = [
        &["--controller", "ideal"],
        &["--controller", "classic"],
        &["--controller", "classic", "--set", "actuator.delay_s=0.25"],
        &["--controller", "lqi", "--set", "actuator.delay_s=0.25"],
    ];
    let found = upper.map(|(name, args, model)| {
        let row = below.map(|lower| gains(&[args, lower].concat(), model));
        let cells = row.map(|[first, last]| format!("{first:.2}, {last:.2}"));
        println!("| {name} | {} |", cells.join(" | "));
        let grows = row.iter().all(|[first, last]| *first > 1.0 && last > first);
        assert!(grows || model.is_some(), "{name}: no target damps the step: {row:?}");
        let [ideal, prompt, ..] = row;
        assert!(
            (prompt[1] / ideal[1] - 1.0).abs() < 0.02,
            "{name}: a body whose torque is prompt adds nothing: {row:?}"
        );
        row.map(|[_, last]| last)
    });
    let [acc, long, cacc, krauss, idm, sumo_acc, sumo_cacc] = found;
    assert!(acc[0] > 10.0 && long[0] < 2.5, "a longer time gap mends it: {acc:?}, {long:?}");
    assert!(cacc[0] < 0.1 * acc[0] && cacc[2] > 5.0 * cacc[0], "CACC hangs on prompt torque: {cacc:?}, {acc:?}");
    assert!(cacc[3] < cacc[2], "and bears a late one better with a law that knows of it: {cacc:?}");
    assert!(krauss[0] < 1.1 && idm[0] < 1.1 && sumo_cacc[0] < 1.01, "{krauss:?}, {idm:?}, {sumo_cacc:?}");
    assert!(sumo_acc[0] < 2.0, "{sumo_acc:?}");
}

/// The oracle is SUMO's ACC, whose gains outside of its gap mode are set to those inside.
#[test]
fn val_ctg_acc_is_sumos_acc_where_the_gains_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["platoon.net.xml", "drivers.rou.xml", "drivers.sumocfg"] {
        let text = fs::read_to_string(repository("sumo_nets/platoon").join(file)).unwrap();
        let same = [("gapClosingControl", "0.23", "0.07"), ("collisionAvoidance", "0.23", "0.07")]
            .map(|(mode, gap, speed)| format!(r#"{mode}GainSpace="{gap}" {mode}GainSpeed="{speed}""#));
        let text = text.replace(r#"tau="1""#, &format!(r#"tau="1.1" {}"#, same.join(" ")));
        fs::write(folder.path().join(file), text).unwrap();
    }
    let config = format!("sumo.config={}", folder.path().join("drivers.sumocfg").display());
    let sumos = ["--controller", "ideal", "--target", "traffic", "--set", &config, "--"];
    let sumos = swings(&[&sumos[..], &["--default.carfollowmodel=ACC"]].concat());
    let ours = swings(&["--controller", "ideal", "--target", "ctg_acc"]);
    // Further behind SUMO's own safety acts, in each in its own way.
    for id in ["f1", "f2", "f3", "f4"] {
        assert!((ours[id] / sumos[id] - 1.0).abs() < 0.01, "{id}: {} and {}", ours[id], sumos[id]);
    }
}
