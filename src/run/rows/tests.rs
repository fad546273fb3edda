//! The columns that were promised, and every format read back by a reader of its own.

use super::*;
use crate::output::{FORMATS, append, write_table};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::fs;
use std::path::{Path, PathBuf};

/// A row with a value in every column.
pub(crate) fn vehicle(id: &str, depart: f64) -> VehicleRow {
    VehicleRow {
        id: id.into(),
        vehicle_type: "pkw".into(),
        controller: "adaptive",
        target: "traffic",
        depart,
        arrival: Some(depart + 60.0),
        duration: Some(60.0),
        timeloss: Some(12.5),
        distance: Some(512.25),
        stats: VehicleStats {
            samples: 6000,
            error_mean: Some(-0.01),
            error_std: Some(0.1),
            error_rms: Some(0.125),
            error_max_abs: Some(0.5),
            overshoot_max: Some(0.25),
            speed_gap_rms: Some(0.2),
            jerk_rms: Some(0.75),
            accel_max: Some(2.5),
            decel_max: Some(3.5),
            torque_rms: Some(250.0),
            share_traffic: Some(1.0),
            share_limit: Some(0.0),
            share_profile: Some(0.0),
            share_clamp: Some(0.0),
            clamped_steps: 0,
            lead_limited: Some(0.0),
            curvature_limited: Some(0.005),
        },
        odometer_gap: Some(-0.03),
        collisions: 0,
        reason: Reason::Arrived,
    }
}

#[test]
fn vehicles_have_the_columns_that_were_promised() {
    let names: Vec<_> = VEHICLES.shape.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(
        names.join(","),
        "id,type,controller,target,depart,arrival,duration,timeloss,distance,samples,error_mean,error_std,\
         error_rms,error_max_abs,overshoot_max,speed_gap_rms,jerk_rms,accel_max,decel_max,torque_rms,\
         share_traffic,share_limit,share_profile,share_clamp,clamped_steps,lead_limited,curvature_limited,\
         odometer_gap,collisions,reason,complete"
    );
}

#[test]
fn other_tables_have_the_columns_that_were_promised() {
    let trace: Vec<_> = TRACE.shape.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(
        trace.join(","),
        "time,id,target,reference,speed,measured_speed,lateral_speed,yaw_rate,slip_front,slip_rear,torque,\
         alpha_hat,f_hat,distance,x,y,angle,lane"
    );
    let edges: Vec<_> = EDGES.shape.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(edges.join(","), "edge,samples,error_mean,error_rms,speed_mean");
}

/// Three vehicles: a plain one, one with an awkward id, one with hardly any values.
fn fleet() -> Vec<VehicleRow> {
    let mut awkward = vehicle("a,\"b\" <&'c>\u{e9}", 1.0);
    awkward.stats.error_mean = Some(-0.0);
    awkward.stats.error_std = Some(f64::NAN);
    awkward.stats.error_rms = Some(1e-9);
    let mut short = vehicle("short", 2.0);
    for value in
        [&mut short.arrival, &mut short.stats.jerk_rms, &mut short.stats.share_traffic, &mut short.odometer_gap]
    {
        *value = None;
    }
    short.stats.samples = 0;
    short.reason = Reason::TeleportedOut;
    vec![vehicle("veh0", 0.1), awkward, short]
}

fn written(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = write_table(&folder.path().join(name), &VEHICLES, &fleet()).unwrap();
    (folder, path)
}

/// What every format must give back: the text of each value, empty if there is none.
fn expected() -> Vec<Vec<String>> {
    let text = |cell: Cell<'_>| {
        let mut text = String::new();
        append(&mut text, cell);
        text
    };
    fleet().iter().map(|row| VEHICLES.cells(row).map(text).collect()).collect()
}

#[test]
fn csv_reads_back() {
    let (_folder, path) = written("vehicles.csv");
    let bytes = fs::read_to_string(&path).unwrap();
    let mut lines = bytes.split('\n');
    assert!(lines.next().unwrap().starts_with("id,type,controller,target,depart,"));
    assert_eq!(
        lines.next().unwrap(),
        "veh0,pkw,adaptive,traffic,0.1,60.1,60,12.5,512.25,6000,-0.01,0.1,0.125,0.5,0.25,0.2,0.75,2.5,3.5,250,\
         1,0,0,0,0,0,0.005,-0.03,0,arrived,true"
    );
    assert!(bytes.ends_with("teleported_out,false\n") && !bytes.contains('\r'));
    let mut reader = csv::Reader::from_path(&path).unwrap();
    let rows: Vec<Vec<String>> = reader.records().map(|r| r.unwrap().iter().map(str::to_owned).collect()).collect();
    assert_eq!(rows, expected());
    assert_eq!((rows[1][10].as_str(), rows[1][11].as_str()), ("0", ""), "-0 is 0 and NaN is no value");
}

#[test]
fn parquet_reads_back() {
    let (_folder, path) = written("vehicles.parquet");
    let reader = SerializedFileReader::new(fs::File::open(&path).unwrap()).unwrap();
    assert_eq!(reader.metadata().file_metadata().num_rows(), 3);
    let names: Vec<_> = VEHICLES.shape.columns.iter().map(|c| c.name.clone()).collect();
    let mut rows = Vec::new();
    for row in reader.get_row_iter(None).unwrap() {
        let row = row.unwrap();
        assert_eq!(row.get_column_iter().map(|(name, _)| name.clone()).collect::<Vec<_>>(), names);
        let text = |field: &Field| match field {
            Field::Null => String::new(),
            Field::Str(value) => value.clone(),
            Field::Long(value) => value.to_string(),
            Field::Bool(value) => value.to_string(),
            Field::Double(value) => {
                let mut text = String::new();
                append(&mut text, Cell::Number(Some(*value)));
                text
            }
            other => panic!("{other:?}"),
        };
        rows.push(row.get_column_iter().map(|(_, field)| text(field)).collect::<Vec<_>>());
    }
    assert_eq!(rows, expected());
}

/// All elements of an XML file with their attributes.
fn elements(path: &Path) -> Vec<(String, Vec<(String, String)>)> {
    let mut reader = quick_xml::Reader::from_file(path).unwrap();
    let (mut buffer, mut found) = (Vec::new(), Vec::new());
    loop {
        use quick_xml::events::Event;
        let (Event::Start(e) | Event::Empty(e)) = (match reader.read_event_into(&mut buffer).unwrap() {
            Event::Eof => return found,
            Event::Start(e) => Event::Start(e),
            Event::Empty(e) => Event::Empty(e),
            _ => continue,
        }) else {
            continue;
        };
        let attributes = e.attributes().map(|a| {
            let a = a.unwrap();
            let value = a.normalized_value(quick_xml::XmlVersion::Implicit1_0).unwrap();
            (a.key.as_ref().to_owned(), value.into_owned())
        });
        found.push((e.name().as_ref().to_owned(), attributes.collect()));
    }
}

#[test]
fn xml_reads_back() {
    let (_folder, path) = written("vehicles.xml");
    let found = elements(&path);
    assert_eq!(found[0].0, "vehicles");
    let wanted: Vec<Vec<(String, String)>> = expected()
        .into_iter()
        .map(|row| {
            VEHICLES.shape.columns.iter().map(|c| c.name.clone()).zip(row).filter(|(_, v)| !v.is_empty()).collect()
        })
        .collect();
    let rows = found.into_iter().skip(1).map(|(name, attributes)| {
        assert_eq!(name, "vehicle");
        attributes
    });
    assert_eq!(rows.collect::<Vec<_>>(), wanted);
}

fn point(time: f64, id: &str) -> TraceRow {
    TraceRow {
        time,
        id: id.into(),
        target: 13.9,
        reference: 13.8,
        speed: 13.75,
        measured_speed: 13.5,
        lateral_speed: 0.0,
        yaw_rate: 0.0,
        slip_front: 0.01,
        slip_rear: 0.0,
        torque: 120.0,
        alpha_hat: 1.0,
        f_hat: -0.2,
        distance: 100.0,
        place: PlaceColumns {
            x: Some(1.5),
            y: Some(-2.0),
            angle: Some(90.0),
            lane: (id != "b").then(|| "e_0".to_owned()),
        },
    }
}

#[test]
fn a_trace_in_xml_has_one_timestep_per_time() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [point(0.1, "a"), point(0.1, "b"), point(0.2, "a")];
    let path = write_table(&folder.path().join("trace.xml"), &TRACE, &rows).unwrap();
    let names: Vec<String> = elements(&path)
        .into_iter()
        .map(|(name, attributes)| format!("{name} {}", attributes.first().map(|a| a.1.as_str()).unwrap_or("")))
        .collect();
    assert_eq!(names, ["trace ", "timestep 0.1", "vehicle a", "vehicle b", "timestep 0.2", "vehicle a"]);
    let text = fs::read_to_string(path).unwrap();
    // SUMO's tools read these attributes in this order, with others between them.
    let row = "<vehicle id=\"a\" x=\"1.5\" y=\"-2\" angle=\"90\" speed=\"13.75\" lane=\"e_0\" target=\"13.9\"";
    assert_eq!(text.matches(row).count(), 2, "{text}");
    assert_eq!(text.matches("</timestep>").count(), 2);
    assert!(text.ends_with("    </timestep>\n</trace>\n"), "{text}");
}

#[test]
fn a_long_trace_in_parquet_has_several_row_groups() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<_> = (0..70_000).map(|k| point(f64::from(k) * 0.1, "a")).collect();
    let path = write_table(&folder.path().join("trace.parquet"), &TRACE, &rows).unwrap();
    let reader = SerializedFileReader::new(fs::File::open(path).unwrap()).unwrap();
    assert_eq!((reader.num_row_groups(), reader.metadata().file_metadata().num_rows()), (2, 70_000));
    let last = reader.get_row_iter(None).unwrap().last().unwrap().unwrap();
    assert_eq!(last.get_column_iter().next().unwrap().1, &Field::Double(rows[69_999].time));
}

#[test]
fn every_format_writes_an_empty_table() {
    let folder = tempfile::tempdir().unwrap();
    for format in FORMATS {
        let path = folder.path().join(format!("vehicles.{}", format.name));
        write_table(&path, &VEHICLES, []).unwrap();
        assert!(fs::metadata(&path).unwrap().len() > 0, "{}", format.name);
    }
}

#[test]
fn law_the_same_rows_give_the_same_bytes() {
    for format in FORMATS {
        let name = format!("vehicles.{}", format.name);
        let ((_a, first), (_b, second)) = (written(&name), written(&name));
        assert_eq!(fs::read(first).unwrap(), fs::read(second).unwrap(), "{name}");
    }
}

#[test]
fn an_unknown_suffix_is_refused_with_the_known_ones() {
    let folder = tempfile::tempdir().unwrap();
    let error = |name: &str| write_table(&folder.path().join(name), &VEHICLES, []).unwrap_err().to_string();
    assert!(error("v.parket").contains("did you mean \"parquet\"?"), "{}", error("v.parket"));
    assert!(error("v").contains("known: csv, parquet, xml"), "{}", error("v"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_in_every_format() {
    let rows: Vec<_> = (0..70_000).map(|k| point(f64::from(k) * 0.1, "a")).collect();
    for format in FORMATS {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("trace.{}", format.name));
        std::os::unix::fs::symlink("/dev/full", format!("{}.part", path.display())).unwrap();
        let error = write_table(&path, &TRACE, &rows).unwrap_err().to_string();
        assert!(error.contains(&*path.to_string_lossy()) && error.contains("No space left"), "{error}");
        assert!(!path.exists());
    }
}
