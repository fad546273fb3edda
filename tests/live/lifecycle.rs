//! Vehicles come and go in all the ways that SUMO knows, and every departure has exactly one row.

use crate::support::{
    CAR, NEW, OLD, Outcome, Row, Running, attribute, configuration, elements, json, network, number, own, plain_sumo,
    repository, run, run_command, straight_road, table,
};
use std::fs;

/// A run on the straight road.
fn on_the_road(version: &str, demand: &str, args: &[&str]) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &format!("{CAR}{demand}"));
    run(version, &config, args)
}

fn arrived(row: &Row) -> bool {
    row["complete"] == "true" && row["reason"] == "arrived"
}

#[test]
fn teleports_keep_the_vehicle_and_its_record() {
    for version in [NEW, OLD] {
        let result = run(version, &own("light"), &["--", "--time-to-teleport", "10"]);
        assert_eq!(result.sumo("teleports"), 1.0, "SUMO {version}");
        let row = result.vehicle("ego");
        assert!(arrived(&row), "SUMO {version}: {row:?}");
        assert!(number(&row, "arrival") < 120.0, "SUMO {version}: it did not wait for green");
        assert!(number(&row, "error_max_abs") < 0.3, "SUMO {version}: being carried is no error: {row:?}");
        // SUMO counts the metres over which it carried the car, the body did not drive them.
        assert!(number(&row, "odometer_gap").abs() < 0.1, "SUMO {version}: {row:?}");
    }
}

/// In a step with a teleport all is heard before anything drives; those that arrive in it are no less arrived.
#[test]
fn arrivals_beside_teleports_are_arrivals() {
    for version in [NEW, OLD] {
        let result = run(version, &own("city"), &["--end", "300", "--", "--time-to-teleport", "5"]);
        assert!(result.sumo("teleports") > 100.0, "SUMO {version}: {} teleports", result.sumo("teleports"));
        let rows = result.vehicles();
        let reached = rows.iter().filter(|row| arrived(row)).count();
        assert!(reached > 50, "SUMO {version}: {reached} arrived");
        assert_eq!(result.sumo("arrived"), reached as f64, "SUMO {version}");
        assert_eq!(rows.iter().filter(|row| row["reason"] == "removed").count(), 0, "SUMO {version}");
    }
}

#[test]
fn stops_and_parking_are_kept_to() {
    let ways = ["", r#" parking="true""#];
    for version in [NEW, OLD] {
        for parking in ways {
            let demand = format!(
                r#"<vehicle id="ego" type="car" depart="0"><route edges="ab bc"/><stop lane="ab_0" startPos="490" endPos="500" duration="100"{parking}/></vehicle>"#
            );
            let result = on_the_road(version, &demand, &["--trace", "all"]);
            let row = result.vehicle("ego");
            assert!(arrived(&row), "SUMO {version}{parking}: {row:?}");
            assert!(number(&row, "duration") > 200.0, "SUMO {version}{parking}: {row:?}");
            assert!(number(&row, "odometer_gap").abs() < 0.1, "SUMO {version}{parking}: {row:?}");
            let trace = result.table("trace.csv");
            let standing = trace.iter().filter(|r| (60.0..120.0).contains(&number(r, "time")));
            assert!(standing.clone().count() > 500);
            for row in standing {
                assert_eq!(number(row, "speed"), 0.0, "SUMO {version}{parking} at {} s", row["time"]);
            }
        }
    }
}

#[test]
fn routes_of_one_step_have_a_row() {
    let mut demand = String::new();
    for index in 0..5 {
        let place = 990 + 2 * index;
        demand += &format!(
            r#"<vehicle id="short{index}" type="car" depart="{}" departPos="{place}" departSpeed="max" arrivalPos="{}"><route edges="ab"/></vehicle>"#,
            20 * index,
            place + 1,
        );
    }
    for version in [NEW, OLD] {
        for step in ["0.1", "1"] {
            let result = on_the_road(version, &demand, &["--step-length", step]);
            let rows = result.vehicles();
            assert_eq!(rows.len() as f64, result.sumo("inserted"), "SUMO {version}, step {step}");
            assert_eq!(
                rows.iter().filter(|r| arrived(r)).count() as f64,
                result.sumo("arrived"),
                "SUMO {version}, {step}"
            );
            assert_eq!(rows.len(), 5);
        }
    }
}

#[test]
fn ids_of_any_alphabet_and_length() {
    let too_long = ["x".repeat(175), "x".repeat(230)];
    let names = ["Größe-Ω-車", "a.b-c_d#1(e)", &"y".repeat(160)];
    let mut demand = String::new();
    for (index, name) in names.iter().copied().chain(too_long.iter().map(String::as_str)).enumerate() {
        demand +=
            &format!(r#"<vehicle id="{name}" type="car" depart="{}"><route edges="ab bc"/></vehicle>"#, 5 * index);
    }
    for version in [NEW, OLD] {
        let result = on_the_road(version, &demand, &["--step-length", "1"]);
        let rows = result.vehicles();
        let found: Vec<&str> = rows.iter().map(|row| row["id"].as_str()).collect();
        assert_eq!(found, names, "SUMO {version}");
        assert!(rows.iter().all(arrived), "SUMO {version}: {rows:?}");
        // Longer ones could end SUMO: they stay its own, and the user is told.
        assert_eq!(result.json("summary.json")["counts"]["refused"], 2);
        assert!(result.ended.stderr.contains("2 vehicles cannot be egos"), "{}", result.ended.stderr);
        assert_eq!(result.sumo("arrived"), 5.0, "SUMO {version}");
    }
}

#[test]
fn vehicles_that_were_there_before_are_taken_over() {
    let folder = tempfile::tempdir().unwrap();
    let demand = r#"<vehicle id="early" type="car" depart="0"><route edges="ab bc"/></vehicle>
        <vehicle id="late" type="car" depart="40"><route edges="ab bc"/></vehicle>"#;
    let config = straight_road(folder.path(), &format!("{CAR}{demand}"));
    for version in [NEW, OLD] {
        let state = folder.path().join(format!("state-{version}.xml"));
        let text = |path: &std::path::Path| path.to_str().unwrap().to_owned();
        let mut args = vec!["-c".to_owned(), text(&config), "--save-state.times".into(), "30".into()];
        args.extend(["--save-state.files".into(), text(&state), "--end".into(), "31".into()]);
        args.extend(["--step-length", "0.1", "--step-method.ballistic", "true"].map(String::from));
        plain_sumo(version, &args);
        let result = run(version, &config, &["--", "--load-state", &text(&state), "--begin", "30"]);
        let rows = result.vehicles();
        assert_eq!(rows.len(), 2, "SUMO {version}: {rows:?}");
        assert!(rows.iter().all(arrived), "SUMO {version}: {rows:?}");
        let early = result.vehicle("early");
        assert!(number(&early, "distance") < 1600.0, "SUMO {version}: our part of its way is {} m", early["distance"]);
        assert!(number(&early, "odometer_gap").abs() < 0.1, "SUMO {version}: {early:?}");
        assert!(number(&early, "error_max_abs") < 0.3, "SUMO {version}: {early:?}");
    }
}

#[test]
fn vehicles_that_a_calibrator_removes_are_not_complete() {
    let folder = tempfile::tempdir().unwrap();
    let nodes = r#"<node id="a" x="0" y="0"/><node id="b" x="1000" y="0"/><node id="c" x="2000" y="0"/>"#;
    let edges = r#"<edge id="ab" from="a" to="b" speed="20"/><edge id="bc" from="b" to="c" speed="20"/>"#;
    let net = network(folder.path(), nodes, edges);
    let vehicles: String = (0..10)
        .map(|i| format!(r#"<vehicle id="v{i}" type="car" depart="{}"><route edges="ab bc"/></vehicle>"#, 5 * i))
        .collect();
    let config = configuration(folder.path(), &net, &format!("{CAR}{vehicles}"), "");
    let additional = folder.path().join("made.add.xml");
    let calibrator = r#"<calibrator id="cal" edge="bc" pos="0" period="10"><flow begin="0" end="1000" route="r" vehsPerHour="0" type="car"/></calibrator>"#;
    let text = format!(r#"<additional>{CAR}<route id="r" edges="ab bc"/>{calibrator}</additional>"#)
        .replace("\"car\"", "\"kind\"");
    fs::write(&additional, text).unwrap();
    for version in [NEW, OLD] {
        let result = run(version, &config, &["--", "--additional-files", additional.to_str().unwrap()]);
        let rows = result.vehicles();
        assert_eq!(rows.len(), 10, "SUMO {version}");
        for row in &rows {
            assert_eq!(
                (row["reason"].as_str(), row["complete"].as_str()),
                ("removed", "false"),
                "SUMO {version}: {row:?}"
            );
        }
    }
}

#[test]
fn parameters_of_type_and_vehicle_reach_the_body() {
    let heavy =
        CAR.replace("id=\"car\"", "id=\"heavy\"").replace("/>", r#"><param key="mfc.mass" value="2400"/></vType>"#);
    let route = r#"<route edges="ab bc"/>"#;
    let demand = format!(
        r#"{heavy}<vehicle id="plain" type="car" depart="0" departSpeed="0">{route}</vehicle>
        <vehicle id="type" type="heavy" depart="40" departSpeed="0">{route}</vehicle>
        <vehicle id="own" type="car" depart="80" departSpeed="0">{route}<param key="mfc.mass_kg" value="2400"/></vehicle>"#
    );
    for version in [NEW, OLD] {
        let result = on_the_road(version, &demand, &["--step-length", "0.5"]);
        let torque = |id: &str| number(&result.vehicle(id), "torque_rms");
        assert!(torque("type") > 1.15 * torque("plain"), "{} {}", torque("type"), torque("plain"));
        assert!((torque("type") / torque("own") - 1.0).abs() < 0.02, "{} {}", torque("type"), torque("own"));
    }
}

#[test]
fn egos_are_chosen_as_sumo_chooses_devices() {
    let yes = r#"<param key="has.mfc.device" value="true"/>"#;
    let no = yes.replace("true", "false");
    let route = r#"<route edges="ab bc"/>"#;
    let equipped = CAR.replace("id=\"car\"", "id=\"equipped\"").replace("/>", &format!(">{yes}</vType>"));
    let demand = format!(
        r#"{equipped}<vehicle id="none" type="car" depart="0">{route}</vehicle>
        <vehicle id="own" type="car" depart="5">{route}{yes}</vehicle>
        <vehicle id="type" type="equipped" depart="10">{route}</vehicle>
        <vehicle id="not" type="equipped" depart="15">{route}{no}</vehicle>
        <trip id="trip" type="car" depart="20" from="ab" to="bc">{yes}</trip>
        <flow id="flow" type="car" begin="30" end="40" number="2" from="ab" to="bc">{yes}</flow>"#
    );
    for version in [NEW, OLD] {
        let result = on_the_road(version, &demand, &["--egos", "param", "--step-length", "1"]);
        let ids: Vec<String> = result.vehicles().into_iter().map(|row| row["id"].clone()).collect();
        assert_eq!(ids, ["own", "type", "trip", "flow.0", "flow.1"], "SUMO {version}");
        assert_eq!(result.json("summary.json")["counts"]["unequipped"], 2);
    }
}

#[test]
fn noise_is_on_the_measurement_not_on_the_error() {
    let args = ["--set", "noise.power_db=-6", "--trace", "all", "--trace-period", "0.1"];
    let result = run(NEW, &own("light"), &args);
    let trace = result.table("trace.csv");
    let moving: Vec<&Row> = trace.iter().filter(|row| number(row, "speed") > 15.0).collect();
    let noise: f64 = moving.iter().map(|row| (number(row, "measured_speed") - number(row, "speed")).powi(2)).sum();
    let sigma_mps = (noise / moving.len() as f64).sqrt();
    assert!((sigma_mps - 0.5).abs() < 0.1, "-6 dB is 0.5 m/s, not {sigma_mps}");
    let row = result.vehicle("ego");
    assert!(number(&row, "error_rms") < 0.4, "the error is of the true speed: {}", row["error_rms"]);
    // Standing is exact all the same.
    assert!(trace.iter().any(|row| number(row, "time") > 60.0 && number(row, "speed") == 0.0));
}

#[test]
fn every_class_gets_its_body_and_two_wheels_none() {
    let route = r#"<route edges="ab bc"/>"#;
    let mut demand = String::new();
    for (index, class) in ["passenger", "delivery", "bus", "truck", "motorcycle"].iter().enumerate() {
        demand += &format!(
            r#"<vType id="t-{class}" vClass="{class}" accel="1" sigma="0" speedFactor="1" speedDev="0"/>
            <vehicle id="{class}" type="t-{class}" depart="{}" departSpeed="0">{route}</vehicle>"#,
            60 * index
        );
    }
    for version in [NEW, OLD] {
        let result = on_the_road(version, &demand, &["--step-length", "0.5"]);
        let torque = |class: &str| number(&result.vehicle(class), "torque_rms");
        assert!(torque("passenger") < torque("delivery"), "SUMO {version}");
        assert!(torque("delivery") < torque("bus") && torque("delivery") < torque("truck"), "SUMO {version}");
        let rows = result.vehicles();
        assert_eq!(rows.len(), 4, "SUMO {version}");
        for row in rows {
            assert!(number(&row, "error_rms") < 0.1, "SUMO {version}: {row:?}");
        }
        assert_eq!(result.json("summary.json")["counts"]["other_classes"], 1);
        assert!(result.ended.stderr.contains("1 motorcycle"), "{}", result.ended.stderr);
    }
}

/// Trace and sample tell one story.
#[test]
fn trace_and_sample_agree() {
    let result = run(NEW, &repository("scenarios/straight.toml"), &["--trace", "all"]);
    let trace = result.table("trace.csv");
    let sample = result.table("sample.csv");
    assert!(sample.len() > 30);
    for row in &sample {
        let same = trace.iter().find(|t| t["time"] == row["time"] && t["id"] == row["id"]).expect("the step is traced");
        for column in ["speed", "target", "distance", "torque"] {
            assert_eq!(same[column], row[column], "{column} at {} s", row["time"]);
        }
    }
    for pair in trace.windows(2) {
        let (before, after) = (&pair[0], &pair[1]);
        let step_s = number(after, "time") - number(before, "time");
        assert!((step_s - 0.1).abs() < 1e-9);
        let driven_m = number(after, "distance") - number(before, "distance");
        let mean_m = 0.5 * (number(after, "speed") + number(before, "speed")) * step_s;
        assert!((driven_m - mean_m).abs() < 0.02, "distance is the integral of speed at {} s", after["time"]);
    }
}

/// Rows and totals are the same whatever a user lets SUMO write, and in which format.
#[test]
fn the_format_of_sumos_outputs_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let trips =
        (0..8).map(|i| format!(r#"<vehicle id="v{i}" type="car" depart="{}"><route edges="ab bc"/></vehicle>"#, 5 * i));
    let config = straight_road(folder.path(), &format!("{CAR}{}", trips.collect::<String>()));
    let plain = run(NEW, &config, &["--end", "120"]);
    assert!(plain.sumo("arrived") >= 1.0 && plain.sumo("arrived") < 8.0, "some are still under way");
    let ways: [&[&str]; 5] = [
        &["--tripinfo-output", "t.xml.gz", "--output-prefix", "p_", "--output-suffix", "_s"],
        &["--tripinfo-output", "t.csv", "--statistic-output", "s.csv"],
        &["--tripinfo-output", "t.parquet", "--statistic-output", "s.parquet"],
        &["--human-readable-time", "true"],
        &["--output.format", "csv"],
    ];
    for way in ways {
        let mut command = run_command(NEW, &config, &folder.path().join("r"), &["--force", "--end", "120", "--"]);
        command.args(way).current_dir(folder.path());
        let ended = Running::start(command).wait();
        assert_eq!(ended.code, Some(0), "{way:?}: {}", ended.stderr);
        assert!(!ended.stderr.contains("is missing"), "{way:?}: {}", ended.stderr);
        let [ours, theirs] = [&folder.path().join("r"), &plain.dir].map(|dir| table(&dir.join("vehicles.csv")));
        assert_eq!(ours, theirs, "{way:?}");
        let [ours, theirs] = [&folder.path().join("r"), &plain.dir].map(|dir| json(&dir.join("summary.json")));
        assert_eq!(ours["sumo"], theirs["sumo"], "{way:?}");
    }
    let thinned = run(NEW, &config, &["--end", "120", "--", "--device.tripinfo.probability", "0"]);
    assert_eq!(thinned.sumo("arrived"), plain.sumo("arrived"));
    assert!(thinned.ended.stderr.contains("tripinfo holds 0 of 8 vehicles"), "{}", thinned.ended.stderr);
}

/// TraCI reports whoever leaves as arrived; the rows say what SUMO's own file says.
#[test]
fn vehicles_that_sumo_takes_out_have_not_arrived() {
    for version in [NEW, OLD] {
        let options = ["--end", "200", "--", "--time-to-teleport", "5", "--time-to-teleport.remove", "true"];
        let result = run(version, &own("city"), &options);
        let trips = elements(&result.dir.join("sumo/tripinfo.xml"), "tripinfo");
        let ended = |trip: &&String| attribute(trip, "arrival") != "-1.00";
        let count = |by: &str| trips.iter().filter(ended).filter(|trip| attribute(trip, "vaporized") == by).count();
        let rows = |reason: &str| result.vehicles().iter().filter(|row| row["reason"] == reason).count();
        assert!(count("teleport") > 50, "SUMO {version}: {} taken out", count("teleport"));
        assert_eq!(rows("teleported_out"), count("teleport"), "SUMO {version}");
        assert_eq!((rows("arrived"), result.sumo("arrived")), (count(""), count("") as f64), "SUMO {version}");
    }
}

/// An id may be used again once its vehicle has left; each use has its row.
#[test]
fn an_id_that_is_used_twice_has_two_rows() {
    let used = |id: &str, depart: u32| {
        format!(r#"<vehicle id="{id}" type="car" depart="{depart}"><route edges="bc"/></vehicle>"#)
    };
    let demand = [used("x", 0), used("y", 90), used("x", 170)].concat();
    for version in [NEW, OLD] {
        let result = on_the_road(version, &demand, &["--", "--route-steps", "50"]);
        let rows = result.vehicles();
        let departs: Vec<(&str, f64)> = rows.iter().map(|row| (row["id"].as_str(), number(row, "depart"))).collect();
        assert_eq!(departs, [("x", 0.0), ("y", 90.0), ("x", 170.0)], "SUMO {version}");
        assert!(rows.iter().all(|row| arrived(row) && number(row, "duration") < 80.0), "SUMO {version}: {rows:?}");
        assert_eq!(result.sumo("arrived"), 3.0, "SUMO {version}");
    }
}

/// Behind a slow car the driver keeps what it allows for on top of its own headway.
#[test]
fn drivers_keep_the_headway_that_they_are_given() {
    let pair = r#"<vType id="slow" accel="2.6" decel="4.5" sigma="0" speedFactor="1" speedDev="0" maxSpeed="10"/>
        <vehicle id="a" type="slow" depart="0"><route edges="ab bc"/></vehicle>
        <vehicle id="b" type="car" depart="5"><route edges="ab bc"/></vehicle>"#;
    for version in [NEW, OLD] {
        let behind_s = |args: &[&str]| {
            let result = on_the_road(version, pair, &[&["--end", "150", "--trace", "all"], args].concat());
            let trace = result.table("trace.csv");
            let last = |id| trace.iter().rfind(|row| row["id"] == id).unwrap();
            (number(last("a"), "distance") - number(last("b"), "distance")) / number(last("b"), "speed")
        };
        let plain_s = behind_s(&[]);
        let wide_s = behind_s(&["--set", "traffic.headway_margin_s=2"]);
        let auto_s = behind_s(&["--set", "traffic.headway_margin_s=auto", "--set", "controller.k_p=1"]);
        assert!((wide_s - plain_s - 2.0).abs() < 0.15, "SUMO {version}: {plain_s} s, {wide_s} s");
        assert!((auto_s - plain_s - 1.0).abs() < 0.15, "SUMO {version}: {plain_s} s, {auto_s} s");
        // A law without K_P answers within T_e.
        let lqi_s = behind_s(&["--controller", "lqi", "--set", "traffic.headway_margin_s=auto"]);
        assert!((lqi_s - plain_s - 1.0).abs() < 0.15, "SUMO {version}: {plain_s} s, {lqi_s} s");
    }
}

#[test]
fn who_crept_is_told() {
    let demand = r#"<vType id="snail" accel="2.6" decel="4.5" sigma="0" speedFactor="1" speedDev="0" maxSpeed="0.5"/>
        <vehicle id="a" type="car" depart="0"><route edges="ab bc"/></vehicle>
        <vehicle id="b" type="snail" depart="5"><route edges="ab bc"/></vehicle>"#;
    let said = |end| on_the_road(NEW, demand, &["--end", end]).ended.stderr;
    let line = "1 of 2 equipped vehicles crept: they moved for more than 60 s without exceeding 1 m/s";
    assert!(said("90").contains(line), "{}", said("90"));
    assert!(!said("60").contains("crept"), "{}", said("60"));
}

/// With an end set a run goes on to it, and without one to the last vehicle, also where calibrators bring all of them.
#[test]
fn a_moment_without_vehicles_ends_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), "");
    let calibrator = r#"<additional>CAR<route id="r" edges="ab bc"/><calibrator id="c" edge="ab" pos="10" period="30"><flow begin="40" end="100" vehsPerHour="300" type="car" route="r"/></calibrator></additional>"#;
    fs::write(folder.path().join("c.add.xml"), calibrator.replace("CAR", CAR)).unwrap();
    let add = folder.path().join("c.add.xml");
    for end in [&["--end", "300"][..], &[]] {
        let result = run(NEW, &config, &[end, &["--", "-a", add.to_str().unwrap()]].concat());
        let rows = result.vehicles();
        assert!(rows.len() >= 4 && rows.iter().all(arrived), "{end:?}: {rows:?}");
    }
}

/// What a vehicle is carried by a stop with `jump` is no difference between body and odometer.
#[test]
fn what_a_vehicle_is_carried_is_not_in_its_odometer_gap() {
    let jumps = r#"<vehicle id="a" type="car" depart="0"><route edges="ab bc"/><stop lane="ab_0" endPos="200" duration="5" jump="0"/><stop lane="bc_0" endPos="600" duration="5"/></vehicle>"#;
    let jump = on_the_road(NEW, jumps, &["--end", "80"]).vehicle("a");
    assert_eq!(jump["reason"], "arrived", "{jump:?}");
    assert!(number(&jump, "distance") < 1500.0 && number(&jump, "odometer_gap").abs() < 1.0, "{jump:?}");
}

/// Where the body leads, SUMO's own time loss is against the speed factor of 100 that the vehicle has meanwhile.
#[test]
fn time_is_lost_against_the_vehicles_own_speed_factor() {
    let alone = r#"<vehicle id="a" type="car" depart="0" departSpeed="0"><route edges="ab bc"/></vehicle>"#;
    let slow = r#"<vType id="slow" accel="2.6" decel="4.5" sigma="0" speedFactor="1" speedDev="0" maxSpeed="10"/>
        <vehicle id="slow" type="slow" depart="0" departSpeed="0"><route edges="ab bc"/></vehicle>"#;
    let behind = format!("{slow}{}", alone.replace(r#"depart="0""#, r#"depart="2""#));
    // From rest to 20 m/s at 2.6 m/s² costs 3.8 s; 2 km at 10 in place of 20 m/s cost 100 s.
    for (version, demand, lost_s) in
        [(NEW, alone, 3.8), (OLD, alone, 3.8), (NEW, behind.as_str(), 100.0), (OLD, behind.as_str(), 100.0)]
    {
        for target in ["traffic", "limit"] {
            let what = format!("SUMO {version}, {target}, {demand}");
            let result = on_the_road(version, demand, &["--target", target, "--egos", "id:a"]);
            let row = result.vehicle("a");
            assert_eq!(row["reason"], "arrived", "{what}");
            let loss_s = number(&row, "timeloss");
            // A body that leads starts as hard as it can.
            assert!(loss_s < lost_s + 2.0 && loss_s > lost_s - 3.5, "{what}: {loss_s} s");
            if demand == alone {
                assert!((loss_s - result.sumo("time_loss_mean_s")).abs() < 0.01, "{what}: the only vehicle");
            }
        }
    }
}

/// vTypes may have ids of any length, and their parameters count; SUMO dies only of long ids that it does not know.
#[test]
fn a_vtype_may_have_a_long_id() {
    let id = "t".repeat(215);
    let car = CAR.replace(r#"id="car""#, &format!(r#"id="{id}""#));
    let heavy = car.replace("/>", r#"><param key="mfc.mass" value="3438"/></vType>"#);
    let vehicle = format!(r#"<vehicle id="a" type="{id}" depart="0" departSpeed="0"><route edges="ab bc"/></vehicle>"#);
    for version in [NEW, OLD] {
        let torque_nm = |car: &str| {
            let result = on_the_road(version, &format!("{car}{vehicle}"), &["--end", "30"]);
            let row = result.vehicle("a");
            assert_eq!(row["type"], id, "SUMO {version}: {}", result.ended.stderr);
            assert!(!result.ended.stderr.contains("cannot be egos"), "{}", result.ended.stderr);
            number(&row, "torque_rms")
        };
        // Twice the mass of the preset; the air does not care.
        let ratio = torque_nm(&heavy) / torque_nm(&car);
        assert!(ratio > 1.6 && ratio < 2.0, "SUMO {version}: {ratio}");
    }
}

/// A vType that asks for more than tyres can hold: the run says so.
#[test]
fn what_a_body_cannot_give_is_told() {
    let demand = r#"<vType id="rocket" accel="12" decel="4.5" sigma="0"/>
        <vehicle id="a" type="rocket" depart="0"><route edges="ab bc"/></vehicle>"#;
    let said = on_the_road(NEW, demand, &["--end", "20"]).ended.stderr;
    let line = r#"1 vTypes allow more than their bodies can do; the first, "rocket": accel 12.0 and emergencyDecel 9.0 m/s², the body"#;
    assert!(said.contains(line), "{said}");
    let plain = on_the_road(NEW, &demand.replace("12", "2.6"), &["--end", "20"]).ended.stderr;
    assert!(!plain.contains("allow more"), "{plain}");
    let ideal = on_the_road(NEW, demand, &["--end", "20", "--controller", "ideal"]).ended.stderr;
    assert!(!ideal.contains("allow more"), "no body: {ideal}");
}
