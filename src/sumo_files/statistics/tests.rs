use super::super::{Trips, each_trip};
use super::*;
use std::path::PathBuf;

/// Real outputs of SUMO: the RESCO network cologne1, 25 200 to 25 260 s, unfinished trips included.
fn recorded(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/sumo_outputs").join(name)
}

#[test]
fn val_sumos_own_counts() {
    for (version, inserted, running, waiting) in [("1.15.0", 18, 15, 5), ("1.28.0", 22, 17, 1)] {
        let statistics = SumoStatistics::read(&recorded(&format!("statistics_{version}.xml"))).unwrap();
        let wanted = SumoStatistics { loaded: 122, inserted, running, waiting, ..Default::default() };
        assert_eq!(statistics, wanted, "{version}");
        let path = recorded(&format!("tripinfo_{version}.xml"));
        let (mut count, mut arrived) = (0, 0);
        let whole = each_trip(&path, |_, trip| {
            (count, arrived) = (count + 1, arrived + u64::from(trip.arrival_s.is_some()));
            Ok(())
        });
        assert!(whole.unwrap());
        assert_eq!((count, arrived), (inserted, inserted - running), "{version}");
        assert_eq!(Trips::read(&path).unwrap().all().count() as u64, inserted, "{version}");
    }
}

#[test]
fn val_one_trip() {
    let trips = Trips::read(&recorded("tripinfo_1.28.0.xml")).unwrap();
    let arrived = &trips.by_id["124779_406_0"][0];
    assert_eq!(arrived.arrival_s, Some(25_258.0));
    assert_eq!((arrived.depart_s, arrived.duration_s, arrived.time_loss_s), (25_205.0, 53.0, 43.22));
    assert_eq!((arrived.route_length_m, arrived.vehicle_type.as_str()), (170.57, "pkw"));
    assert_eq!(trips.by_id["98305_395_0"][0].arrival_s, None, "still under way");
    assert_eq!(trips.by_id["125613_406_0"][0].arrival_s, None, "taken out at the end");
}

fn temporary(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.xml");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

#[test]
fn law_a_file_cut_anywhere_gives_the_trips_before_the_cut() {
    let text = std::fs::read_to_string(recorded("tripinfo_1.28.0.xml")).unwrap();
    for cut in (0..text.len() - 20).step_by(97) {
        let (_folder, path) = temporary(&text[..cut]);
        let trips = Trips::read(&path).unwrap();
        assert!(!each_trip(&path, |_, _| Ok(())).unwrap(), "cut at {cut}");
        let before = text[..cut].split("<tripinfo ").skip(1).filter(|rest| rest.contains("/>")).count();
        assert_eq!(trips.by_id.len(), before, "cut at {cut}");
    }
}

#[test]
fn what_sumo_does_not_write_is_an_error_with_its_place() {
    let (_folder, path) = temporary("<tripinfos>\n<tripinfo id=\"a\" depart=\"soon\" arrival=\"1\"/></tripinfos>");
    let error = Trips::read(&path).unwrap_err().to_string();
    assert!(error.contains("depart=\"soon\" is no number") && error.contains("file.xml:2: "), "{error}");
    let (_folder, path) = temporary("<tripinfos><tripinfo id=\"a\"/></tripinfos>");
    assert!(Trips::read(&path).unwrap_err().to_string().contains("no arrival in tripinfo"));
    let (_folder, path) = temporary("<statistics><vehicles loaded=\"1\"/></statistics>");
    assert!(SumoStatistics::read(&path).unwrap_err().to_string().contains("no inserted in vehicles"));
    let (_folder, path) = temporary("<statistics/>");
    assert!(SumoStatistics::read(&path).unwrap_err().to_string().contains("is missing"));
    assert!(Trips::read(Path::new("/nowhere/t.xml")).unwrap_err().to_string().contains("/nowhere/t.xml"));
}

#[test]
fn a_vehicle_that_was_taken_out_did_not_arrive() {
    // As SUMO 1.28 writes a vehicle that a TraCI client removed: it gives a time of arrival all the same.
    let (_folder, path) = temporary(
        "<tripinfos><tripinfo id=\"a\" depart=\"25244.00\" arrival=\"25261.00\" duration=\"17.00\" \
         routeLength=\"91.17\" timeLoss=\"11.52\" vType=\"pkw\" vaporized=\"traci\"/></tripinfos>",
    );
    let trips = Trips::read(&path).unwrap();
    assert_eq!((trips.by_id["a"][0].arrival_s, trips.by_id["a"][0].duration_s), (None, 17.0));
}
