//! Profiles through their public interface, files included.

use super::*;
use crate::keys::Values;
use crate::registry::find;
use std::io::Write;

fn file(content: &str) -> tempfile::NamedTempFile {
    let mut file = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
    file.write_all(content.as_bytes()).unwrap();
    file
}

fn read(content: &str, options: &RecordingOptions) -> Result<Profile, ReferenceError> {
    Profile::from_file(file(content).path(), options)
}

fn profile(content: &str) -> Profile {
    read(content, &RecordingOptions::default()).unwrap()
}

fn close(a: (f64, f64), b: (f64, f64)) -> bool {
    (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9
}

#[test]
fn a_profile_over_position_is_linear_and_its_rate_follows_the_vehicle() {
    let profile = profile("# a comment\ns_m,v_mps\n10,5\n30,9\n\n30,20\n130,10\n");
    assert!(!profile.is_by_time());
    assert_eq!(profile.length(), Some(130.0));
    assert!(close(profile.at(0.0, 99.0, 5.0), (5.0, 0.0)), "before the start");
    assert!(close(profile.at(20.0, 99.0, 6.0), (7.0, 0.2 * 6.0)), "v dv/ds");
    assert!(close(profile.at(30.0, 99.0, 8.0), (20.0, -0.1 * 8.0)), "after the jump");
    assert!(close(profile.at(200.0, 99.0, 8.0), (10.0, 0.0)), "after the end");
    assert_eq!(profile.curvature_at(20.0), 0.0);
}

#[test]
fn a_profile_over_time_may_stand() {
    let profile = profile("t_s,v_mps\n0,0\n5,0\n10,10\n");
    assert!(profile.is_by_time());
    assert!(close(profile.at(1e6, 2.0, 3.0), (0.0, 0.0)));
    assert!(close(profile.at(1e6, 7.0, 3.0), (4.0, 2.0)));
}

#[test]
fn sumo_driving_cycles_are_read_with_and_without_header_and_in_kmh() {
    // The three forms that emissionsDrivingCycle takes: t;v, t;v;a;slope, and km/h with --kmh.
    for content in ["0;0\n1;2\n2;4\n3;4\n", "0;0;2;0\r\n1;2;2;0\r\n2;4;0;0\r\n3;4;0;0\r\n", "t;v\n0;0\n1;2\n2;4\n3;4\n"]
    {
        let profile = profile(content);
        assert!(profile.is_by_time() && profile.length() == Some(3.0), "{content}");
        assert!(close(profile.at(0.0, 1.5, 0.0), (3.0, 2.0)), "{content}");
    }
    let kmh = RecordingOptions { speed_unit_mps: 1.0 / 3.6, ..Default::default() };
    assert!(close(read("0;0\n1;36\n", &kmh).unwrap().at(0.0, 1.0, 0.0), (10.0, 0.0)));
    assert!(close(read("t,v_mps\n0,10\n1,10\n", &kmh).unwrap().at(0.0, 0.5, 0.0), (10.0, 0.0)), "the name wins");
    assert!(close(profile("t_s,v_kmh\n0,36\n1,36\n").at(0.0, 0.5, 0.0), (10.0, 0.0)));
}

#[test]
fn steps_and_sines_are_what_they_are_called() {
    let step = Profile::step(Axis::Position, &[0.0, 100.0], &[10.0, 20.0]).unwrap();
    for (s, v) in [(-1.0, 10.0), (0.0, 10.0), (99.9, 10.0), (100.0, 20.0), (1e4, 20.0)] {
        assert_eq!(step.at(s, 0.0, 7.0), (v, 0.0));
    }
    assert_eq!(step.length(), None);
    let sine = Profile::sine(Axis::Position, 15.0, 5.0, 200.0).unwrap();
    assert!(close(sine.at(50.0, 0.0, 12.0), (20.0, 0.0)));
    let (h, v) = (1e-4, 13.0);
    let slope = (sine.at(30.0 + h, 0.0, v).0 - sine.at(30.0 - h, 0.0, v).0) / (2.0 * h);
    assert!((sine.at(30.0, 0.0, v).1 - v * slope).abs() < 1e-6);
    let over_time = Profile::sine(Axis::Time, 15.0, 5.0, 20.0).unwrap();
    assert!(over_time.is_by_time() && close(over_time.at(0.0, 5.0, 1.0), (20.0, 0.0)));
}

#[test]
fn shapes_that_make_no_sense_are_refused_with_their_key() {
    for (result, key) in [
        (Profile::step(Axis::Position, &[0.0, 100.0], &[10.0]), "step_speeds_mps"),
        (Profile::step(Axis::Position, &[0.0], &[0.0]), "step_speeds_mps"),
        (Profile::step(Axis::Position, &[100.0, 0.0], &[1.0, 2.0]), "step_at"),
        (Profile::step(Axis::Time, &[], &[]), "step_at"),
        (Profile::step(Axis::Time, &[f64::NAN], &[1.0]), "step_at"),
        (Profile::sine(Axis::Position, 5.0, -5.0, 10.0), "sine_amplitude_mps"),
        (Profile::sine(Axis::Position, 5.0, f64::NAN, 10.0), "sine_amplitude_mps"),
        (Profile::sine(Axis::Time, 5.0, 5.0, 0.0), "sine_period_s"),
    ] {
        let message = result.unwrap_err().to_string();
        assert!(message.starts_with(key), "{message}");
    }
    assert!(Profile::step(Axis::Time, &[0.0], &[0.0]).is_ok(), "standing over time is fine");
}

#[test]
fn broken_files_say_where_what_and_what_else() {
    for (content, said) in [
        ("s_m,v_mps\n0,5\n10,fast\n", ":3: v_mps: found \"fast\", wanted a number"),
        ("s_m,v_mps\n0,5\n10\n", ":3: v_mps: found \"\", wanted a number"),
        ("s_m,v_mps\n0,nan\n", ":2: v_mps: found \"nan\", wanted a number"),
        ("s_m,v_mps\n0,5\n1,1e400\n", ":3: v_mps: found \"1e400\", wanted a number"),
        ("s_m,v_mps\n0,5\n1,-inf\n", ":3: v_mps: found \"-inf\", wanted a number"),
        ("t,vx\n0,5\n1,5\nNaN,5\n", ":4: t: found \"NaN\", wanted a number"),
        ("0;0\n1e-320;5\n2;10\n", ":2: t: found 1e-320, wanted the same as in the row before"),
        ("# c\n\ns_m,v_mps\n0,5\n10,-1\n", ":5: v_mps: found -1, wanted a speed of at least 0"),
        ("s_m,v_mps\n0,5\n10,6\n9,6\n", ":4: s_m: found 9, wanted no less than the row before"),
        ("s_m,v_mps\n0,0\n10,6\n", ":2: v_mps: found 0, wanted a speed above 0 before the end"),
        ("x,y\n0,0\n", ":1: header: found \"x,y\", wanted columns s_m,v_mps or t_s,v_mps"),
        ("s_m,grade\n0,0\n", ":1: header: found \"s_m,grade\", wanted columns"),
        ("0,0\n1,1\n", ":1: header: found \"0,0\", wanted columns"),
        ("s_m,v_mps\n", ":1: header: found no rows, wanted at least one row"),
        ("", ":0: header: found no rows"),
        ("t,vx\n0,5\n", ":2: t: found 0, wanted at least two samples"),
        ("t,vx\n0,5\n1,1e6\n", ":3: vx: found 1000000, wanted a speed of at most 200 m/s"),
        ("t,vx\n0,5\n1,-3\n", ":3: vx: found -3, wanted a speed of at least 0"),
        ("t,vx\n0,5\n50,5\n", ":3: t: found 50, wanted at most 10 s after the row before"),
        ("t,vx (knots)\n0,5\n1,5\n", ":1: vx (knots): found the unit \"knots\", wanted one of m/s, km/h, kph, mph"),
        ("t (m/s),vx (s)\n0,5\n1,5\n", ":1: t (m/s): found the unit \"m/s\", wanted one of s, ms"),
        ("t,vx,vy\n0,5,0\n1,5,1e6\n", ":3: vy: found 1000000, wanted a speed between -200 and 200 m/s"),
        (
            "t,vx,yaw_rate\n0,5,0\n1,5,-1e6\n",
            ":3: yaw_rate: found -1000000, wanted a yaw rate between -10 and 10 rad/s",
        ),
        ("t,vx\n0,5\n0,5\n", ":3: t: found 0, wanted more than the row before"),
    ] {
        let file = file(content);
        let message = Profile::from_file(file.path(), &RecordingOptions::default()).unwrap_err().to_string();
        assert!(message.starts_with(&file.path().display().to_string()) && message.contains(said), "{message}");
    }
    let by_time = RecordingOptions { by: Some(Axis::Time), ..Default::default() };
    assert!(read("s_m,v_mps\n0,5\n", &by_time).unwrap_err().to_string().contains("header"));
    let missing = Profile::from_file(Path::new("/nowhere/at/all.csv"), &RecordingOptions::default()).unwrap_err();
    assert!(matches!(&missing, ReferenceError::Read { .. }) && missing.to_string().contains("/nowhere/at/all.csv"));
}

/// A recording at `rate_hz` of a circle to the left with `radius_m`, driven sideways by a constant V_y.
fn circle(rate_hz: f64, speed_mps: f64, radius_m: f64, seconds: f64) -> String {
    let rows = (0..=(seconds * rate_hz) as usize).map(|i| {
        let t = i as f64 / rate_hz;
        format!("{},{speed_mps},0.0,{}\n", 7.0 + t, speed_mps / radius_m)
    });
    "time,vx_mps,vy,yaw_rate_radps\n".to_owned() + &rows.collect::<String>()
}

#[test]
fn law_a_recorded_circle_closes_and_has_its_curvature() {
    let (v, r) = (10.0, 50.0);
    let lap_s = std::f64::consts::TAU * r / v;
    let profile = profile(&circle(100.0, v, r, lap_s));
    assert!(!profile.is_by_time(), "no stops: by position");
    let track = profile.track().unwrap();
    let end = track.s_m.len() - 1;
    assert!((track.s_m[end] - v * lap_s).abs() < 0.1, "{}", track.s_m[end]);
    assert!(track.x_m[end].hypot(track.y_m[end]) < 0.5, "ends where it began");
    assert!((track.y_m[end / 2] - 2.0 * r).abs() < 0.5, "left is positive: {}", track.y_m[end / 2]);
    for s in [0.0, 1.0, 40.0, 313.0] {
        assert!((profile.curvature_at(s) - 1.0 / r).abs() < 1e-6, "{s}: {}", profile.curvature_at(s));
    }
    assert_eq!((profile.curvature_at(-1.0), profile.curvature_at(1e4)), (0.0, 0.0));
    assert!(close(profile.at(20.0, 0.0, 10.0), (10.0, 0.0)));
}

#[test]
fn reconstruction_is_the_paper_s_sum() {
    // Three unequal samples by hand; 2 Hz is too coarse for smoothing.
    let profile = profile("t,speed,vy,yaw_rate\n1.0,10,1,0.2\n1.5,12,0,-0.1\n2.5,8,0,0\n");
    let track = profile.track().unwrap();
    let (sin, cos) = (0.1_f64.sin(), 0.1_f64.cos());
    let expected = [
        (&track.x_m, [0.0, 5.0, 5.0 + 12.0 * cos]),
        (&track.y_m, [0.0, 0.5, 0.5 + 12.0 * sin]),
        (&track.heading_rad, [0.0, 0.1, 0.0]),
        (&track.s_m, [0.0, 5.0_f64.hypot(0.5), 5.0_f64.hypot(0.5) + 12.0]),
    ];
    for (column, values) in expected {
        assert!(column.iter().zip(values).all(|(a, b)| (a - b).abs() < 1e-12), "{column:?} {values:?}");
    }
    assert!(close(profile.at(track.s_m[1], 0.0, 3.0), (12.0, 3.0 * -4.0 / 12.0)));
}

#[test]
fn recordings_are_smoothed_only_where_they_are_fine_enough() {
    let noisy = |rate_hz: f64| {
        let rows = (0..600).map(|i| format!("{},{}\n", f64::from(i) / rate_hz, if i % 2 == 0 { 9.0 } else { 11.0 }));
        "t_s,vx\n".to_owned() + &rows.collect::<String>()
    };
    let spread = |rate_hz: f64, smooth_s: f64| {
        let options = RecordingOptions { by: Some(Axis::Time), smooth_s, ..Default::default() };
        let profile = read(&noisy(rate_hz), &options).unwrap();
        let at = |i: i32| profile.at(0.0, f64::from(i) / rate_hz, 10.0).0;
        (250..260).map(|i| (at(i) - 10.0).abs()).fold(0.0, f64::max)
    };
    assert!(spread(100.0, 1.0) < 1e-9, "100 points");
    assert!(spread(10.0, 1.0) < 1e-9, "10 points");
    assert!(spread(5.0, 1.0) > 0.99, "coarse");
    assert!(spread(100.0, 0.0) > 0.99, "off");
}

/// A smooth drive at 11 Hz with noise; every seventh sample comes twice, 55 µs apart, and `gaps` times 3 s are missing.
fn irregular(gaps: usize) -> String {
    let mut random = crate::random::Stream::new(1, "irregular", "recording");
    let mut rows = String::new();
    for i in 0..900 {
        let t = f64::from(i) / 11.0;
        if (0..gaps).any(|gap| (10.0 * gap as f64 + 5.0..10.0 * gap as f64 + 8.0).contains(&t)) {
            continue;
        }
        for late in if i % 7 == 0 { vec![0.0, 55e-6] } else { vec![0.0] } {
            rows += &format!("{:.6},{:.4}\n", t + late, 20.0 + 5.0 * (0.3 * t).sin() + 0.03 * random.normal());
        }
    }
    "t_s,vx\n".to_owned() + &rows
}

#[test]
fn irregular_recordings_are_smoothed_over_time_whatever_their_gaps() {
    for gaps in [0, 5] {
        let steepest = |smooth_s: f64| {
            let options = RecordingOptions { by: Some(Axis::Time), smooth_s, ..Default::default() };
            let profile = read(&irregular(gaps), &options).unwrap();
            (0..80_000).map(|i| profile.at(0.0, f64::from(i) * 1e-3, 20.0).1.abs()).fold(0.0, f64::max)
        };
        // The drive itself has 1.5 m/s².
        assert!(steepest(1.0) < 1.8, "{gaps} gaps: {} m/s2", steepest(1.0));
        // 0.03 m/s of noise at 11 Hz; between samples of 55 us it would be 1000 m/s2.
        let rough = steepest(0.0);
        assert!((1.8..4.5).contains(&rough), "{gaps} gaps, without smoothing: {rough} m/s2");
        let options = RecordingOptions { by: Some(Axis::Time), ..Default::default() };
        let (v, _) = read(&irregular(gaps), &options).unwrap().at(0.0, 30.0, 20.0);
        assert!((v - (20.0 + 5.0 * (9.0_f64).sin())).abs() < 0.05, "{v}");
    }
}

#[test]
fn a_recording_says_how_it_was_smoothed() {
    let note = |content: &str, smooth_s: f64| {
        let options = RecordingOptions { smooth_s, ..Default::default() };
        let note = read(content, &options).unwrap().note().map(str::to_owned);
        note.map(|note| note.split_once(": ").unwrap().1.to_owned())
    };
    let regular = |rate_hz: f64| {
        let rows = (0..300).map(|i| format!("{},10\n", f64::from(i) / rate_hz));
        "t,vx\n".to_owned() + &rows.collect::<String>()
    };
    let said = |what: &str| Some(format!("300 samples, 0.0100 s apart (median), {what}"));
    assert_eq!(note(&regular(100.0), 1.0), said("averaged over 100 samples"));
    assert_eq!(note(&regular(100.0), 0.0), said("not averaged: smooth_s is 0"));
    assert_eq!(note(&regular(100.0), 0.01), said("not averaged: 0.01 s are no two samples"));
    assert!(note(&regular(5.0), 1.0).unwrap().ends_with("0.2000 s apart (median), not averaged: coarser than 10 Hz"));
    let irregular = note(&irregular(1), 1.0).unwrap();
    assert!(
        irregular.ends_with("merged with the one before, averaged over 1 s, for they are not regular"),
        "{irregular}"
    );
    assert_eq!(note("t_s,v_mps\n0,10\n1,10\n", 1.0), None, "a profile is taken as it is");
}

#[test]
fn a_lone_sample_that_nobody_can_have_driven_is_refused_with_its_line() {
    let recording = |spike_mps: f64| {
        let speed = |i: u32| if i == 50 { spike_mps } else { 20.0 + 0.5 * f64::from(i % 2) };
        "t,vx\n".to_owned() + &(0..100).map(|i| format!("{},{}\n", f64::from(i) * 0.05, speed(i))).collect::<String>()
    };
    for spike_mps in [150.0, 0.0, 27.0] {
        let error = read(&recording(spike_mps), &RecordingOptions::default()).unwrap_err().to_string();
        let said = format!(":52: vx: found {spike_mps}, wanted a speed within 5 m/s or 50 m/s2 of the samples");
        assert!(error.contains(&said), "{error}");
    }
    let fits = read(&recording(22.0), &RecordingOptions::default());
    assert!(fits.is_ok(), "{fits:?}");
    // A jump that stays is a gap in the recording, not a spike.
    let steady = recording(20.0);
    let jump = steady.lines().enumerate().map(|(i, line)| {
        if i > 60 { format!("{},40\n", line.split(',').next().unwrap()) } else { format!("{line}\n") }
    });
    assert!(read(&jump.collect::<String>(), &RecordingOptions::default()).is_ok());
}

#[test]
fn a_header_that_comes_too_late_is_refused_saying_so() {
    let behind = |lines: usize| "logger 4\n".repeat(lines) + "t_s,vx\n0,10\n1,10\n";
    assert!(read(&behind(49), &RecordingOptions::default()).is_ok());
    let error = read(&behind(50), &RecordingOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains(":50: header: found none within 50 lines, wanted columns s_m,v_mps or t_s,v_mps"),
        "{error}"
    );
}

#[test]
fn headers_are_read_as_loggers_write_them() {
    for content in [
        "# time(s),vx(m/s)\n0,10\n1,10\n",
        "Session 4\nDriver,A. Nobody\n\nTime (ms),Speed (km/h)\n0,36\n1000,36\n",
        "t_s,speed [m/s]\n0,10\n1,10\n",
        "time_ms,vx_kph\n0,36\n1000,36\n",
        "Time,Speed (MPH)\n0,22.369363\n1,22.369363\n",
        "# time, speed: of the second run\nt_s,vx_mps\n0,10\n1,10\n",
    ] {
        let options = RecordingOptions { by: Some(Axis::Time), ..Default::default() };
        let profile = read(content, &options).unwrap_or_else(|error| panic!("{content}: {error}"));
        assert!((profile.at(0.0, 0.5, 10.0).0 - 10.0).abs() < 1e-6, "{content}");
        assert_eq!(profile.length(), Some(1.0), "{content}");
    }
}

#[test]
fn smoothing_delays_nothing() {
    let rows: String = (0..1000).map(|i| format!("{},{}\n", f64::from(i) * 0.01, 5.0 + 0.02 * f64::from(i))).collect();
    let options = RecordingOptions { by: Some(Axis::Time), ..Default::default() };
    let profile = read(&("t,vx\n".to_owned() + &rows), &options).unwrap();
    let (v, rate) = profile.at(0.0, 5.0, 0.0);
    assert!((v - 15.0).abs() < 0.011 && (rate - 2.0).abs() < 1e-6, "{v} {rate}");
}

#[test]
fn a_recording_with_a_stop_goes_by_time_and_its_gyro_makes_no_curve_there() {
    let rows: String = (0..600)
        .map(|i| {
            let v = if (200..400).contains(&i) { 0.0 } else { 10.0 };
            format!("{},{v},0,{}\n", f64::from(i) * 0.1, if v == 0.0 { 0.05 } else { 0.0 })
        })
        .collect();
    let content = "t,vx,vy,yaw_rate\n".to_owned() + &rows;
    let plain = RecordingOptions { smooth_s: 0.0, ..Default::default() };
    let profile = read(&content, &plain).unwrap();
    assert!(profile.is_by_time());
    assert_eq!(profile.at(0.0, 30.0, 0.0), (0.0, 0.0));
    assert!(profile.track().unwrap().curvature_per_m.iter().all(|k| k.abs() < 1e-12));
    let by_position = RecordingOptions { by: Some(Axis::Position), ..plain };
    assert!(read(&content, &by_position).unwrap_err().to_string().contains("no stops"));
}

#[test]
fn val_the_shipped_cycles_have_their_published_length_and_top_speed() {
    // US EPA, dynamometer drive schedules: UDDS 7.45 miles, 56.7 mph, 1369 s; HWFET 10.26 miles, 59.9 mph, 765 s.
    for (name, miles, mph, seconds) in [("udds", 7.45, 56.7, 1369.0), ("hwfet", 10.26, 59.9, 765.0)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenarios/paper/data/{name}.csv"));
        let profile = Profile::from_file(&path, &RecordingOptions::default()).unwrap();
        assert!(profile.is_by_time() && profile.length() == Some(seconds));
        let speeds: Vec<f64> = (0..=seconds as usize).map(|t| profile.at(0.0, t as f64, 0.0).0).collect();
        let metres = speeds.windows(2).map(|w| 0.5 * (w[0] + w[1])).sum::<f64>();
        let top = speeds.iter().copied().fold(0.0, f64::max);
        assert!((metres / 1609.344 - miles).abs() < 0.01, "{name}: {metres} m");
        assert!((top / 0.44704 - mph).abs() < 0.05, "{name}: {top} m/s");
    }
}

#[test]
fn the_registry_builds_each_target_from_its_keys() {
    let build = |name, changes: &[(&'static str, &str)]| {
        let entry = find("target", &TARGETS, name).unwrap();
        let defaults = Values::defaults(entry.keys);
        let values = changes.iter().fold(defaults, |v, (k, x)| v.with(k, (*x).to_owned()));
        (entry.build)(&values, Path::new("scenarios"))
    };
    assert_eq!(TARGETS[0].name, "traffic");
    assert!(matches!(build("traffic", &[]), Ok(Target::Traffic)));
    assert!(matches!(build("limit", &[]), Ok(Target::Limit)));
    let Ok(Target::Profile(step)) = build("profile", &[("shape", "step")]) else { panic!("a profile") };
    assert_eq!((step.at(50.0, 0.0, 1.0).0, step.at(150.0, 0.0, 1.0).0), (10.0, 20.0));
    let Ok(Target::Profile(sine)) = build("profile", &[("shape", "sine"), ("by", "time")]) else { panic!("a profile") };
    assert!(sine.is_by_time());
    let Ok(Target::Profile(udds)) = build("profile", &[("file", "paper/data/udds.csv")]) else { panic!("a profile") };
    assert_eq!(udds.length(), Some(1369.0));
    let refused = |changes| build("profile", changes).unwrap_err().to_string();
    assert_eq!(refused(&[]), "file: found nothing, wanted a profile's file, or shape = \"step\" or \"sine\"");
    assert!(refused(&[("shape", "step"), ("step_at", "0; 100")]).starts_with("step_at: found \"0; 100\""));
}
