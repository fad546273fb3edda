//! `vehicles.parquet`: our tables and SUMO's own outputs, vehicle by vehicle.

use super::support::{attribute, elements};
use super::*;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};

fn rows(path: &Path) -> Vec<Row> {
    let reader = SerializedFileReader::new(fs::File::open(path).unwrap()).unwrap();
    reader.get_row_iter(None).unwrap().map(Result::unwrap).collect()
}

fn field<'r>(row: &'r Row, column: &str) -> &'r Field {
    row.get_column_iter().find(|(name, _)| *name == column).unwrap_or_else(|| panic!("no {column}")).1
}

/// A value as our CSV and SUMO's XML have it, empty for none.
fn value(row: &Row, column: &str) -> String {
    match field(row, column) {
        Field::Null => String::new(),
        Field::Str(text) => text.clone(),
        Field::Double(number) => number.to_string(),
        Field::Long(count) => count.to_string(),
        other => other.to_string(),
    }
}

#[test]
fn every_vehicle_has_what_we_and_what_sumo_know_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let args = ["--end", "90", "--seeds", "1..2", "--safety", "--vary", "controller.name=plain,pid"];
    let emissions = ["--set", r#"sumo.options=["--device.emissions.probability", "1"]"#];
    study("sweep", dir, &[&["scenarios/city.toml", "-q"], &args[..], &emissions].concat());
    let all = rows(&dir.join("vehicles.parquet"));
    for (case, controller) in [(1, "plain"), (2, "pid"), (3, "plain"), (4, "pid")] {
        let own: Vec<&Row> = all.iter().filter(|row| value(row, "case") == case.to_string()).collect();
        let results = dir.join("cases").join(format!("{case:04}"));
        let trips = elements(&results.join("sumo/tripinfo.xml"), "tripinfo");
        let emitted = elements(&results.join("sumo/tripinfo.xml"), "emissions");
        let conflicts = elements(&results.join("sumo/ssm.xml"), "conflict");
        assert!(own.len() == trips.len() && own.len() == emitted.len() && own.len() > 100 && conflicts.len() > 20);
        for (trip, emitted) in trips.iter().zip(&emitted) {
            let id = attribute(trip, "id");
            let row = own.iter().find(|row| value(row, "id") == id).unwrap();
            assert_eq!(value(row, "controller.name"), controller);
            for name in ["timeLoss", "waitingTime", "routeLength", "duration"] {
                let wanted: f64 = attribute(trip, name).parse().unwrap();
                assert_eq!(*field(row, &format!("sumo_{name}")), Field::Double(wanted), "{id} {name}");
            }
            let wanted: f64 = attribute(emitted, "CO2_abs").parse().unwrap();
            assert!(wanted > 0.0 && *field(row, "sumo_CO2_abs") == Field::Double(wanted));
            let wanted = conflicts.iter().filter(|conflict| attribute(conflict, "ego") == id).count();
            assert_eq!(*field(row, "sumo_conflicts"), Field::Double(wanted as f64), "{id}");
            assert_eq!(*field(row, "ego"), Field::Bool(controller != "plain"));
        }
        for name in ["vehicles.csv", "quality.csv"] {
            for ours in table(&results.join(name)) {
                let row = own.iter().find(|row| value(row, "id") == ours["id"]).unwrap();
                for (column, wanted) in &ours {
                    let (got, number) = (value(row, column), |text: &str| text.parse::<f64>().ok());
                    let same = got == *wanted || (number(&got).is_some() && number(&got) == number(wanted));
                    assert!(same, "{column} of {}: {got} instead of {wanted}", ours["id"]);
                }
            }
        }
    }
    // The metrics are means over these rows.
    for case in table(&dir.join("cases.csv")) {
        let own: Vec<&Row> = all.iter().filter(|row| value(row, "case") == case["case"]).collect();
        let numbers =
            |column: &str| own.iter().filter_map(|row| value(row, column).parse::<f64>().ok()).collect::<Vec<_>>();
        let mean = |column: &str| numbers(column).iter().sum::<f64>() / numbers(column).len() as f64;
        for (metric, column) in [("stops_mean", "sumo_waitingCount"), ("conflicts_mean", "sumo_conflicts")] {
            assert!((number(&case, metric) - mean(column)).abs() < 1e-9, "{metric}");
        }
        let critical = numbers("sumo_minTTC").iter().filter(|ttc_s| **ttc_s < 1.5).count();
        assert!(critical > 0 && number(&case, "critical_ttc") == critical as f64);
        if case["controller.name"] == "pid" {
            assert!((number(&case, "comfort_accel_mean") - mean("comfort_accel")).abs() < 1e-9);
            assert!((number(&case, "energy_per_km_mean") - mean("energy_per_km")).abs() < 1e-9);
        } else {
            assert_eq!((&*case["comfort_accel_mean"], &*case["error_rms_mean"]), ("", ""));
        }
    }
}

/// A configuration that gives the device to some vehicles: only those have conflicts, and the others have none that are known.
#[test]
fn conflicts_of_devices_that_the_user_asked_for_are_read_too() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let options = r#"sumo.options=["--device.ssm.probability", "0.5", "--device.ssm.measures", "TTC"]"#;
    study("sweep", dir, &["scenarios/city.toml", "-q", "--end", "90", "--seeds", "1", "--set", options]);
    let logged = elements(&dir.join("cases/0001/sumo/ssm.xml"), "conflict");
    let all = rows(&dir.join("vehicles.parquet"));
    let known: Vec<&Row> = all.iter().filter(|row| *field(row, "sumo_conflicts") != Field::Null).collect();
    assert!(known.len() > 5 && known.len() < all.len() && !logged.is_empty());
    for row in known {
        let id = value(row, "id");
        let wanted = logged.iter().filter(|conflict| attribute(conflict, "ego") == id).count();
        assert!(wanted > 0 && *field(row, "sumo_conflicts") == Field::Double(wanted as f64), "{id}");
    }
}
