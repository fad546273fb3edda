//! What a caller orders for single vehicles between the steps of a session, on real SUMO.

use crate::support::{NEW, json, repository, sumo_home};
use std::path::Path;
use sumo_mfc::run::{Session, SessionOptions};
use sumo_mfc::scenario::{Catalog, Override, Request, Scenario};

/// One car on a straight road, with SUMO's own choice of speeds.
async fn session(dir: &Path, target: &str) -> Session {
    let request = Request::file(repository("scenarios/straight.toml"))
        .with(Override::text("--target", "target.name", target))
        .with(Override::text("--controller", "controller.name", "pid"));
    let scenario = Scenario::load(&request, &Catalog::installed()).unwrap();
    let sumo = sumo_home(NEW).join("bin/sumo");
    let options = SessionOptions { out_dir: dir.to_owned(), sumo: Some(sumo), ..SessionOptions::default() };
    Session::open(&scenario, &options).await.unwrap()
}

/// Steps to a time, and tells reference and speed of the car then.
async fn until(session: &mut Session, time_s: f64) -> [f64; 2] {
    while session.time_s() < time_s - 1e-6 {
        session.step().await.unwrap();
    }
    session.egos().next().map(|ego| [ego.reference, ego.speed]).unwrap()
}

#[tokio::test]
async fn val_a_vehicle_drives_the_ordered_speed_and_then_sumos_again() {
    for target in ["traffic", "limit"] {
        let folder = tempfile::tempdir().unwrap();
        let mut session = session(folder.path(), target).await;
        let [_, own_mps] = until(&mut session, 25.0).await;
        let id = session.egos().next().unwrap().id;
        session.set_reference(&id, Some(6.0)).unwrap();
        let [reference_mps, speed_mps] = until(&mut session, 40.0).await;
        assert!((reference_mps - 6.0).abs() < 0.02 && (speed_mps - 6.0).abs() < 0.05, "{target}: {speed_mps} m/s");
        session.set_reference(&id, None).unwrap();
        let [_, speed_mps] = until(&mut session, 60.0).await;
        assert!(own_mps > 10.0 && (speed_mps - own_mps).abs() < 0.1, "{target}: {own_mps} and {speed_mps} m/s");
        assert!(session.set_reference("nobody", None).unwrap_err().to_string().contains("no ego of this id"));
        let result = session.finish().await.unwrap();
        let note = format!("references of 1 vehicle were set by the caller between steps (\"{id}\")");
        assert!(result.notes.contains(&note), "{:?}", result.notes);
        let notes = json(&folder.path().join("run.json"))["notes"].to_string();
        assert!(notes.contains("references of 1 vehicle were set by the caller"), "{notes}");
        // What SUMO and the body drive is one way, also where the caller sets the speed.
        let row = crate::support::table(&folder.path().join("vehicles.csv")).remove(0);
        assert!(crate::support::number(&row, "odometer_gap").abs() < 2.0, "{target}: {}", row["odometer_gap"]);
    }
}

#[tokio::test]
async fn torques_and_parameters_act_from_the_next_step_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = session(folder.path(), "traffic").await;
    until(&mut session, 30.0).await;
    let id = session.egos().next().unwrap().id;
    session.set_torque_disturbance(&id, -800.0).unwrap();
    let [reference_mps, speed_mps] = until(&mut session, 30.4).await;
    assert!(speed_mps < reference_mps - 0.05, "{speed_mps} of {reference_mps} m/s");
    session.set_torque_disturbance(&id, 0.0).unwrap();
    until(&mut session, 40.0).await;
    session.set_parameter(&id, "mfc.torque_factor", Some("0")).unwrap();
    session.set_reference(&id, Some(0.0)).unwrap();
    let [_, speed_mps] = until(&mut session, 50.0).await;
    assert!(speed_mps > 10.0, "without brakes: {speed_mps} m/s");
    session.set_parameter(&id, "mfc.torque_factor", None).unwrap();
    let [_, speed_mps] = until(&mut session, 70.0).await;
    assert_eq!(speed_mps, 0.0, "with its own again");
    let result = session.finish().await.unwrap();
    for what in ["references", "torque disturbances", "mfc.* parameters"] {
        assert!(
            result.notes.iter().any(|note| note.starts_with(&format!("{what} of 1 vehicle"))),
            "{:?}",
            result.notes
        );
    }
}
