//! A session, driven from code.

use crate::support::{NEW, json, number, own, run, sumo_home, table};
use std::fs;
use std::path::Path;
use sumo_mfc::run::{RunError, Session, SessionOptions};
use sumo_mfc::scenario::{Catalog, Override, Request, Scenario};

const END_S: f64 = 60.0;

fn scenario() -> Scenario {
    let request = Request::file(own("city"))
        .with(Override::text("--trace", "output.trace", "all"))
        .with(Override::literal("--end", "sumo.end_s", END_S))
        .with(Override::literal("--step-length", "sumo.step_length_s", 0.5));
    Scenario::load(&request, &Catalog::installed()).unwrap()
}

fn options(dir: &Path) -> SessionOptions {
    let sumo = sumo_home(NEW).join("bin/sumo");
    SessionOptions { out_dir: dir.to_owned(), sumo: Some(sumo), ..SessionOptions::default() }
}

#[tokio::test]
async fn law_a_session_gives_the_bytes_of_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = Session::open(&scenario(), &options(folder.path())).await.unwrap();
    assert_eq!((session.time_s(), session.end_s()), (0.0, Some(END_S)));
    let mut egos = 0;
    while !session.is_over() {
        session.step().await.unwrap();
        for ego in session.egos() {
            assert_eq!(ego.time, session.time_s());
            egos += 1;
        }
    }
    assert!((session.time_s() - END_S).abs() < 1e-9);
    let result = session.finish().await.unwrap();
    assert_eq!(json(&folder.path().join("run.json"))["status"], "complete");
    assert_eq!(table(&folder.path().join("trace.csv")).len(), egos, "the egos that are shown are those of the trace");
    let rows = result.summary.count("vehicles");
    assert!(rows > 10 && egos > 1000, "{rows} rows, {egos} egos");
    let end = END_S.to_string();
    let program = run(NEW, &own("city"), &["--trace", "all", "--end", &end, "--step-length", "0.5"]);
    for file in ["vehicles.csv", "trace.csv", "sample.csv", "edges.csv", "schema.json"] {
        assert!(fs::read(folder.path().join(file)).unwrap() == program.bytes(file), "{file}");
    }
}

#[tokio::test]
async fn a_session_that_stops_early_is_incomplete_and_keeps_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = Session::open(&scenario(), &options(folder.path())).await.unwrap();
    let busy = Session::open(&scenario(), &options(folder.path())).await;
    assert!(matches!(busy, Err(RunError::Busy { .. })), "two sessions in one folder");
    while session.time_s() < 20.0 {
        session.step().await.unwrap();
    }
    let first = session.egos().next().unwrap();
    let statistics = session.statistics(&first.id).unwrap();
    assert!(session.statistics("nobody").is_none());
    let result = session.finish().await.unwrap();
    let rows = table(&folder.path().join("vehicles.csv"));
    let row = rows.iter().find(|row| *row["id"] == *first.id).unwrap();
    assert_eq!(number(row, "distance"), first.distance);
    assert_eq!(
        (number(row, "samples"), number(row, "error_rms")),
        (statistics.samples as f64, statistics.error_rms.unwrap())
    );
    let manifest = json(&folder.path().join("run.json"));
    assert_eq!(manifest["status"], "incomplete");
    assert_eq!(manifest["reason"], "stopped at 20 s, before its end");
    assert_eq!(rows.len() as u64, result.summary.count("vehicles"));
}

#[test]
fn every_file_of_a_result_is_in_its_schema_with_its_columns() {
    let result = run(NEW, &own("light"), &["--trace", "all", "--vehicles-output", "cars.parquet"]);
    let schema = result.json("schema.json");
    let described = schema["files"].as_object().unwrap();
    for file in result.json("run.json")["files"].as_array().unwrap() {
        let file = file.as_str().unwrap();
        let name = if file.starts_with("sumo/") { "sumo/" } else { file };
        let Some(schema) = described.get(name) else { panic!("{name} is not in schema.json") };
        assert!(schema["meaning"].as_str().is_some_and(|meaning| !meaning.is_empty()), "{name}");
        if let Some(path) = Some(result.dir.join(file)).filter(|path| path.extension().is_some_and(|e| e == "csv")) {
            let text = fs::read_to_string(path).unwrap();
            let columns = schema["columns"].as_array().unwrap().iter().map(|column| column["name"].as_str().unwrap());
            assert_eq!(text.lines().next().unwrap(), columns.collect::<Vec<_>>().join(","), "{name}");
        }
    }
    let summary = result.json("summary.json");
    let fields = described["summary.json"]["fields"].as_array().unwrap();
    let names: Vec<&str> = fields.iter().map(|field| field["name"].as_str().unwrap()).collect();
    for object in ["counts", "sumo", "fleet"] {
        for key in summary[object].as_object().unwrap().keys() {
            assert!(names.contains(&format!("{object}.{key}").as_str()), "{object}.{key}");
        }
    }
}
