//! Targets that keep a gap to the vehicle ahead, in SUMO's traffic.

use super::support::*;

/// A slow car, and four faster ones behind it. SUMO's own drivers would keep a shorter gap.
const PLATOON: &str = r#"
    <vType id="slow" maxSpeed="12" length="5" minGap="2" tau="0.3" sigma="0" speedFactor="1" speedDev="0"/>
    <vType id="fast" maxSpeed="25" length="5" minGap="2" tau="0.3" sigma="0" speedFactor="1" speedDev="0"/>
    <route id="r" edges="ab bc"/>
    <vehicle id="v0" type="slow" route="r" depart="0" departPos="200" departSpeed="10"/>
    <vehicle id="v1" type="fast" route="r" depart="0" departPos="160" departSpeed="10"/>
    <vehicle id="v2" type="fast" route="r" depart="0" departPos="120" departSpeed="10"/>
    <vehicle id="v3" type="fast" route="r" depart="0" departPos="80" departSpeed="10"/>
    <vehicle id="v4" type="fast" route="r" depart="0" departPos="40" departSpeed="10"/>"#;
const DEPARTED_M: [f64; 5] = [200.0, 160.0, 120.0, 80.0, 40.0];
const LENGTH_AND_MIN_GAP_M: f64 = 7.0;

#[test]
fn law_the_time_gap_is_kept_behind_a_slow_car() {
    for (target, time_gap_s) in [("ctg_acc", 1.1), ("path_cacc", 0.6)] {
        for (version, controller) in [(NEW, "classic"), (NEW, "lqi"), (OLD, "classic")] {
            let folder = tempfile::tempdir().unwrap();
            let config = straight_road(folder.path(), PLATOON);
            let args = ["--target", target, "--controller", controller, "--trace", "all", "--end", "140"];
            let result = run(version, &config, &args);
            let trace = result.table("trace.csv");
            let last: Vec<_> = (0..5)
                .map(|k| trace.iter().rfind(|row| row["id"] == format!("v{k}")).expect("it is on the road"))
                .collect();
            let place_m = |k: usize| DEPARTED_M[k] + number(last[k], "distance");
            let what = format!("SUMO {version}, {target}, {controller}");
            for k in 1..5 {
                let (gap_m, speed_mps) = (place_m(k - 1) - place_m(k) - LENGTH_AND_MIN_GAP_M, number(last[k], "speed"));
                assert!((speed_mps - 12.0).abs() < 0.3, "{what}, v{k}: {speed_mps} m/s");
                assert!((gap_m - time_gap_s * speed_mps).abs() < 0.7, "{what}, v{k}: a gap of {gap_m} m");
                let row = result.vehicle(&format!("v{k}"));
                assert!(number(&row, "share_profile") > 0.9, "{what}, v{k}: somebody is ahead: {row:?}");
                assert_eq!(row["collisions"], "0", "{what}, v{k}");
            }
            assert_eq!(number(&result.vehicle("v0"), "share_limit"), 1.0, "{what}: nobody is ahead");
        }
    }
}
