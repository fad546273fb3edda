//! Beside other TraCI clients, and at a SUMO that somebody else has started.

use crate::support::{
    CAR, NEW, OLD, Running, attribute, elements, json, number, run_command, straight_road, sumo_home, table,
};
use std::net::TcpListener;
use std::path::Path;
use std::process::Command;
use std::time::Duration;
use sumo_mfc::traci::{Client, simulation, vehicle};

const LIMIT: Duration = Duration::from_secs(60);

fn demand() -> String {
    let vehicles = (0..6).map(|i| {
        format!(r#"<vehicle id="v{i}" type="car" depart="{}" departSpeed="0"><route edges="ab bc"/></vehicle>"#, 8 * i)
    });
    CAR.to_owned() + &vehicles.collect::<String>()
}

pub fn free_port() -> u16 {
    TcpListener::bind(("127.0.0.1", 0)).unwrap().local_addr().unwrap().port()
}

/// Starts SUMO as somebody else would: 1 s steps, ballistic, with its own outputs.
pub fn somebodys_sumo(version: &str, config: &Path, trips: &Path, port: u16, clients: &str) -> Running {
    let home = sumo_home(version);
    let mut command = Command::new(home.join("bin/sumo"));
    command.env("SUMO_HOME", &home).arg("-c").arg(config).args([
        "--num-clients",
        clients,
        "--no-step-log",
        "--seed",
        "23423",
    ]);
    command.args(["--step-length", "0.5", "--step-method.ballistic", "true", "--remote-port", &port.to_string()]);
    command.arg("--tripinfo-output").arg(trips);
    Running::start(command)
}

#[test]
fn a_sumo_that_runs_already_can_be_joined() {
    for version in [NEW, OLD] {
        let folder = tempfile::tempdir().unwrap();
        let config = straight_road(folder.path(), &demand());
        let port = free_port();
        let sumo = somebodys_sumo(version, &config, &config.with_file_name("theirs.xml"), port, "1");
        let dir = folder.path().join("result");
        let address = format!("127.0.0.1:{port}");
        let ended = Running::start(run_command(version, &config, &dir, &["--connect", &address])).wait();
        assert_eq!(ended.code, Some(0), "SUMO {version}: {}", ended.stderr);
        // This one is ballistic, and counts gaps below minGap. What a configuration says is not what it runs with.
        assert!(!ended.stderr.contains("instead of"), "{}", ended.stderr);
        assert!(
            !ended.stderr.contains("Euler") && ended.stderr.contains("counts gaps below minGap"),
            "{}",
            ended.stderr
        );
        assert_eq!(sumo.wait().code, Some(0), "SUMO {version} ends in order");
        let rows = table(&dir.join("vehicles.csv"));
        assert_eq!(rows.len(), 6, "SUMO {version}");
        let trips = elements(&config.with_file_name("theirs.xml"), "tripinfo");
        for row in &rows {
            assert_eq!(
                (row["reason"].as_str(), row["complete"].as_str()),
                ("arrived", "true"),
                "SUMO {version}: {row:?}"
            );
            assert!(number(row, "odometer_gap").abs() < 0.2, "SUMO {version}: {row:?}");
            // What SUMO wrote for its owner agrees with what we could only read off the replies.
            let trip = trips.iter().find(|trip| attribute(trip, "id") == row["id"]).unwrap();
            for column in ["depart", "arrival"] {
                let theirs: f64 = attribute(trip, column).parse().unwrap();
                assert!(
                    (number(row, column) - theirs).abs() < 0.5 + 1e-9,
                    "SUMO {version}: {column} {theirs}, {row:?}"
                );
            }
        }
    }
}

/// Another client subscribes to everything in its own way, and takes a vehicle out.
#[tokio::test]
async fn another_client_may_look_on_and_remove_vehicles() {
    for version in [NEW, OLD] {
        let folder = tempfile::tempdir().unwrap();
        let config = straight_road(folder.path(), &demand());
        let port = free_port();
        let dir = folder.path().join("result");
        let args = ["--num-clients", "2", "--port", &port.to_string(), "--step-length", "0.5"];
        let ours = Running::start(run_command(version, &config, &dir, &args));
        let mut other = Client::connect(format!("127.0.0.1:{port}"), LIMIT).await.unwrap();
        other.set_order(2).await.unwrap();
        other.subscribe((simulation::TIME, simulation::DEPARTED), "", 0.0).await.unwrap();
        let mut removed = false;
        // It leaves in the middle; the run goes on without it.
        for step in 0..120 {
            other.step().await.unwrap();
            let present = other.get(vehicle::IDS, "").await.unwrap();
            for id in &present {
                if step % 2 == 0 {
                    // Road and place, as SUMO's own Python client asks for by default; then the speed as well.
                    other.subscribe((vehicle::ROAD, vehicle::LANE_POSITION), id, 0.0).await.unwrap();
                    other.subscribe(vehicle::SPEED, id, f64::from(step) * 0.5).await.unwrap();
                }
            }
            if step == 60 {
                other.set(vehicle::REMOVE, "v1", 2).await.unwrap();
                removed = true;
            }
        }
        assert!(removed);
        other.close().await.unwrap();
        let ended = ours.wait();
        assert_eq!(ended.code, Some(0), "SUMO {version}: {}", ended.stderr);
        let rows = table(&dir.join("vehicles.csv"));
        assert_eq!(rows.len(), 6, "SUMO {version}: {rows:?}");
        for row in &rows {
            let reason = if row["id"] == "v1" { "removed" } else { "arrived" };
            assert_eq!(row["reason"], reason, "SUMO {version}: {row:?}");
            assert!(number(row, "error_max_abs") < 0.3, "SUMO {version}: {row:?}");
        }
        assert_eq!(json(&dir.join("run.json"))["status"], "complete");
    }
}

/// A leading body changes four things on its vehicle, and gives all of them back.
#[tokio::test]
async fn a_leading_body_hands_its_vehicle_back_as_it_was() {
    for version in [NEW, OLD] {
        let folder = tempfile::tempdir().unwrap();
        let config = straight_road(folder.path(), &demand());
        let port = free_port();
        let sumo = somebodys_sumo(version, &config, &config.with_file_name("theirs.xml"), port, "2");
        let dir = folder.path().join("result");
        let address = format!("127.0.0.1:{port}");
        let args = ["--connect", &address, "--target", "limit", "--end", "20"];
        let ours = Running::start(run_command(version, &config, &dir, &args));
        let mut other = Client::connect(address.clone(), LIMIT).await.unwrap();
        other.set_order(2).await.unwrap();
        for _ in 0..40 {
            other.step().await.unwrap();
        }
        let ended = ours.wait();
        assert_eq!(ended.code, Some(0), "SUMO {version}: {}", ended.stderr);
        // v2 has departed, but the step in which its body would have taken over never came.
        for id in ["v0", "v1"] {
            assert_eq!(other.get(vehicle::ACCEL, id).await.unwrap(), 2.6, "SUMO {version}, {id}");
            assert_eq!(other.get(vehicle::DECEL, id).await.unwrap(), 4.5, "SUMO {version}, {id}");
            assert_eq!(other.get(vehicle::SPEED_FACTOR, id).await.unwrap(), 1.0, "SUMO {version}, {id}");
            assert_eq!(other.get(vehicle::SPEED_MODE, id).await.unwrap(), 31, "SUMO {version}, {id}");
        }
        // SUMO drives them again: none keeps the speed that it was given last.
        for _ in 0..20 {
            other.step().await.unwrap();
        }
        assert!(other.get(vehicle::SPEED, "v0").await.unwrap() <= 20.0 + 1e-9, "SUMO {version}");
        other.close().await.unwrap();
        assert_eq!(sumo.wait().code, Some(0), "SUMO {version}");
    }
}

/// A SUMO that somebody else started with Euler's steps is told apart.
#[test]
fn eulers_steps_of_a_joined_sumo_are_told() {
    for version in [NEW, OLD] {
        let folder = tempfile::tempdir().unwrap();
        let config = straight_road(folder.path(), &demand());
        let (home, port) = (sumo_home(version), free_port());
        let mut command = Command::new(home.join("bin/sumo"));
        command.env("SUMO_HOME", &home).arg("-c").arg(&config).args(["--step-length", "0.1", "--no-step-log"]);
        command.args(["--remote-port", &port.to_string(), "--collision.mingap-factor", "0"]);
        let sumo = Running::start(command);
        let (dir, address) = (folder.path().join("result"), format!("127.0.0.1:{port}"));
        let ended = Running::start(run_command(version, &config, &dir, &["--connect", &address, "--end", "20"])).wait();
        assert_eq!(ended.code, Some(0), "SUMO {version}: {}", ended.stderr);
        let line = format!("the SUMO at {address} makes Euler's steps");
        assert!(ended.stderr.contains(&line) && !ended.stderr.contains("below minGap"), "{}", ended.stderr);
        assert_eq!(sumo.wait().code, Some(0), "SUMO {version} ends in order");
    }
}
