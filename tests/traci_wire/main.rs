//! The TraCI codec without SUMO: exact bytes, recorded replies whole, cut, with bytes left over and flipped, and noise.
//!
//! The recordings in `tests/data/traci/replies/` are replies of real SUMO to the batches below; they are made anew with
//! `cargo test --test traci_wire record -- --ignored`.

mod harness;
mod replies;
mod requests;
mod sumo_reader;

use std::path::{Path, PathBuf};
use std::time::Duration;

use harness::{MOTION, decode, events, gets, walk, with_length};
use proptest::prelude::*;
use sumo_mfc::traci::wire::frame_length;
use sumo_mfc::traci::{
    Batch, BatchError, Domain, Error, Index, MAX_ID_BYTES, Prefix, Subscribed, SumoProcess, Value, Var, find_sumo,
    simulation, vehicle,
};

const VERSIONS: [&str; 2] = ["1.28.0", "1.15.0"];

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/traci").join(name)
}

fn recorded(name: &str) -> PathBuf {
    data("replies").join(name)
}

fn recordings() -> Vec<(String, Vec<u8>, Batch)> {
    let all = VERSIONS.iter().flat_map(|version| [(version, "events", events()), (version, "gets", gets())]);
    let read = |(version, kind, batch)| {
        let name = format!("{version}-{kind}.bin");
        let bytes = std::fs::read(recorded(&name)).unwrap();
        (name, bytes, batch)
    };
    all.map(read).collect()
}

#[tokio::test]
#[ignore = "writes the recordings; needs SUMO below .sumo/"]
async fn record() {
    for version in VERSIONS {
        let prefix = Path::new(env!("CARGO_MANIFEST_DIR")).join(".sumo").join(version);
        let sumo = find_sumo(Some(&prefix.join("bin/sumo"))).unwrap();
        let log = tempfile::tempdir().unwrap();
        let args = ["-n", "grid.net.xml", "-r", "grid.rou.xml", "--step-length", "0.5", "--no-step-log"];
        let file = |arg: &str| if arg.ends_with(".xml") { data(arg).display().to_string() } else { arg.to_owned() };
        let args: Vec<String> = args.into_iter().map(file).collect();
        let mut process = SumoProcess::spawn(&sumo, &args, None, log.path()).unwrap();
        let mut client = process.connect(Duration::from_secs(10)).await.unwrap();
        client.step_until(20.0).await.unwrap();
        for (kind, batch) in [("events", events()), ("gets", gets())] {
            let reply = client.exchange(&batch).await.unwrap_or_else(|error| {
                panic!("{version} {kind}: {error}: {}", std::fs::read_to_string(process.log()).unwrap())
            });
            std::fs::write(recorded(&format!("{version}-{kind}.bin")), reply.frame()).unwrap();
        }
        client.close().await.unwrap();
        process.shut_down(Duration::from_secs(10)).await.unwrap();
    }
}

#[test]
fn recorded_replies_decode_whole() {
    for (name, frame, batch) in recordings() {
        let count = walk(&frame, &batch).unwrap();
        assert!(count >= 12, "{name}: {count} values");
    }
}

#[test]
fn recorded_events_say_what_happened() {
    for version in VERSIONS {
        let frame = std::fs::read(recorded(&format!("{version}-events.bin"))).unwrap();
        let mut index = Index::default();
        let reply = index.read(&frame, &events()).unwrap();
        let refused: Vec<_> = reply.refusals().map(|(command, refusal)| (command, refusal.text)).collect();
        assert_eq!(refused.iter().map(|(command, _)| *command).collect::<Vec<_>>(), [2, 6]);
        assert!(refused.iter().all(|(_, text)| text.contains("'nobody' is not known")));
        assert_eq!(reply.f64(1), Some(6.5));
        let blocks: Vec<_> = reply.blocks().map(Result::unwrap).collect();
        assert_eq!(blocks.iter().map(|block| block.id).collect::<Vec<_>>(), ["", "v0", "v1", "late"]);
        assert_eq!(blocks[0].get(simulation::TIME).unwrap(), Some(20.5));
        let late = blocks[3].read(MOTION).unwrap();
        assert_eq!(late, Subscribed::Own((None, None)), "not departed: no value, not a number");
        assert_eq!(blocks[1].values().count(), 3, "a third variable was appended");
        let Subscribed::Own((Some(speed_mps), Some(angle_deg))) = blocks[1].read(MOTION).unwrap() else {
            panic!("{version}: v0 is there")
        };
        assert!((0.0..13.89).contains(&speed_mps) && (0.0..=360.0).contains(&angle_deg));
        let backwards = (vehicle::ANGLE, vehicle::SPEED);
        let swapped = Subscribed::Own((Some(angle_deg), Some(speed_mps)));
        assert_eq!(blocks[1].read(backwards).unwrap(), swapped, "found by variable, not by place");
        assert_eq!(blocks[1].read(&[vehicle::SPEED, vehicle::TAU][..]).unwrap(), Subscribed::Foreign);
        assert_eq!(blocks[1].read(simulation::SCALE).unwrap(), Subscribed::Foreign, "another domain");
        let other_type: Var<String> = Var::new(Domain::Vehicle, vehicle::SPEED.id);
        assert!(matches!(blocks[1].read(other_type), Err(Error::Type { got: "double", .. })));
        assert!(blocks[2].get(vehicle::NEXT_LIGHTS).unwrap().is_some_and(|lights| !lights.is_empty()));
    }
}

#[test]
fn every_cut_is_an_error() {
    for (name, frame, batch) in recordings() {
        for cut in 0..frame.len() {
            let part = &frame[..cut];
            assert_eq!(frame_length(part).unwrap(), (cut >= 4).then_some(frame.len()), "need more, or the length");
            assert!(walk(part, &batch).is_err(), "{name} cut at {cut}");
            if cut >= 4 {
                let error = walk(&with_length(part), &batch).expect_err(&name);
                assert!(error.offset <= cut);
            }
        }
    }
}

#[test]
fn leftover_bytes_are_an_error() {
    for (name, mut frame, batch) in recordings() {
        frame.push(0);
        assert!(walk(&frame, &batch).is_err(), "{name}");
        let error = walk(&with_length(&frame), &batch).unwrap_err();
        assert_eq!((error.what, error.offset), ("leftover bytes", frame.len() - 1));
    }
}

#[test]
fn the_harness_of_the_fuzzer_takes_every_recording() {
    for (_, frame, _) in recordings() {
        decode(&frame);
    }
}

#[test]
fn flipped_bytes_never_panic() {
    for (_, frame, batch) in recordings() {
        for at in 0..frame.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut frame = frame.clone();
                frame[at] ^= flip;
                let _ = walk(&frame, &batch);
            }
        }
    }
}

#[test]
fn a_reply_to_another_batch_is_an_error() {
    let frame = std::fs::read(recorded("1.28.0-gets.bin")).unwrap();
    assert!(walk(&frame, &events()).is_err());
    let mut shifted = Batch::new();
    shifted.get(vehicle::SPEED, "v0").unwrap();
    assert!(walk(&frame, &shifted).is_err());
}

proptest! {
    #[test]
    fn noise_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        decode(&bytes);
    }

    /// As a fuzzer does it: parts of recorded replies one behind the other, with some bytes changed.
    #[test]
    fn mutated_replies_never_panic(
        parts in proptest::collection::vec((0..4_usize, any::<prop::sample::Index>(), any::<prop::sample::Index>()), 1..4),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
    ) {
        let recordings = recordings();
        let mut bytes = Vec::new();
        for (which, from, to) in parts {
            let frame = &recordings[which].1;
            let (from, to) = (from.index(frame.len()), to.index(frame.len()));
            bytes.extend(&frame[from.min(to)..=from.max(to)]);
        }
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        decode(&bytes);
    }

    /// Bytes that look like an accepted get followed by a block of noise get past the outer checks.
    #[test]
    fn noise_inside_a_value_never_panics(variable in any::<u8>(), noise in proptest::collection::vec(any::<u8>(), 0..120)) {
        for domain in Domain::ALL {
            let mut batch = Batch::new();
            batch.get(Var::<f64>::new(domain, variable), "").unwrap();
            let get = batch.bytes()[5];
            let mut frame = vec![0, 0, 0, 0, 7, get, 0, 0, 0, 0, 0];
            frame.extend([u8::try_from(noise.len() + 7).unwrap(), get + 0x10, variable, 0, 0, 0, 0]);
            frame.extend(&noise);
            let _ = walk(&with_length(&frame), &batch);
        }
    }

    /// An independent reading of SUMO's length rules finds every command that was put in.
    #[test]
    fn lengths_of_commands_add_up(ids in proptest::collection::vec("[a-zA-Zäö0-9_.#]{0,80}", 1..20), texts in proptest::collection::vec("[a-z]{0,40}", 0..20)) {
        let mut batch = Batch::new();
        let edges: Vec<&str> = texts.iter().map(String::as_str).collect();
        for id in &ids {
            batch.set(vehicle::ROUTE, id, &edges).unwrap();
            batch.get(vehicle::SPEED, id).unwrap();
        }
        batch.step().unwrap();
        let bytes = batch.bytes();
        prop_assert_eq!(i32::from_be_bytes(bytes[..4].try_into().unwrap()), i32::try_from(bytes.len()).unwrap());
        let mut at = 4;
        let mut commands = Vec::new();
        while at < bytes.len() {
            let short = usize::from(bytes[at]);
            let (length, head) = match short {
                0 => (usize::try_from(i32::from_be_bytes(bytes[at + 1..at + 5].try_into().unwrap())).unwrap(), 5),
                _ => (short, 1),
            };
            prop_assert!(short > 0 || length > 255, "the long form only when needed");
            commands.push(bytes[at + head..at + length].to_vec());
            at += length;
        }
        prop_assert_eq!(at, bytes.len());
        prop_assert_eq!(commands.len(), 2 * ids.len() + 1);
        for (pair, id) in commands.chunks(2).zip(&ids) {
            prop_assert_eq!(&pair[0][..2], &[0xc4, 0x57]);
            prop_assert_eq!(&pair[0][6..6 + id.len()], id.as_bytes());
            prop_assert_eq!(pair[0].len(), 6 + id.len() + 5 + edges.iter().map(|edge| 4 + edge.len()).sum::<usize>());
            prop_assert_eq!(&pair[1][..2], &[0xa4, 0x40]);
            prop_assert_eq!(&pair[1][6..], id.as_bytes());
        }
    }
}

#[test]
fn commands_have_the_documented_bytes() {
    let v0 = Prefix::new("v0").unwrap();
    let id = [0, 0, 0, 2, b'v', b'0'];
    let check = |build: &dyn Fn(&mut Batch), expected: &[&[u8]]| {
        let mut batch = Batch::new();
        build(&mut batch);
        assert_eq!(batch.bytes()[4..], expected.concat());
    };
    let three = 3f64.to_be_bytes();
    let none = (-1_073_741_824f64).to_be_bytes();
    check(&|b| drop(b.set_speed(&v0, 3.0)), &[&[0x12, 0xc4, 0x40], &id, &[0x0b], &three]);
    check(&|b| drop(b.set(vehicle::SPEED, "v0", 3.0)), &[&[0x12, 0xc4, 0x40], &id, &[0x0b], &three]);
    check(
        &|b| drop(b.set_previous_speed(&v0, 3.0, 3.0)),
        &[&[32, 0xc4, 0x3c], &id, &[0x0f, 0, 0, 0, 2, 0x0b], &three, &[0x0b], &three],
    );
    check(&|b| drop(b.get(vehicle::SPEED, "v0")), &[&[0x09, 0xa4, 0x40], &id]);
    check(&|b| drop(b.get_by_prefix(vehicle::SPEED, &v0)), &[&[0x09, 0xa4, 0x40], &id]);
    check(&|b| drop(b.step()), &[&[0x0a, 0x02, 0, 0, 0, 0, 0, 0, 0, 0]]);
    check(&|b| drop(b.subscribe(MOTION, "v0", 3.0)), &[&[27, 0xd4], &three, &none, &id, &[2, 0x40, 0x43]]);
    check(&|b| drop(b.unsubscribe(Domain::Vehicle, "v0")), &[&[25, 0xd4], &none, &none, &id, &[0]]);
}

#[test]
fn a_batch_refuses_what_would_harm_sumo() {
    let v0 = Prefix::new("v0").unwrap();
    let mut batch = Batch::new();
    for speed in [f64::NAN, f64::INFINITY, -0.1, -1.0] {
        assert!(matches!(batch.set_speed(&v0, speed), Err(BatchError::BadNumber { .. })), "{speed}");
        assert!(matches!(batch.set_previous_speed(&v0, speed, 0.0), Err(BatchError::BadNumber { .. })), "{speed}");
    }
    assert!(batch.set_previous_speed(&v0, 1.0, f64::NAN).is_err());
    assert!(batch.set(vehicle::SPEED, "v0", f64::NAN).is_err());
    assert!(batch.step_until(f64::NAN).is_err());
    assert!(batch.subscribe(vehicle::SPEED, "v0", f64::INFINITY).is_err());
    let long = "ä".repeat(MAX_ID_BYTES / 2 + 1);
    assert!(matches!(Prefix::new(&long), Err(BatchError::IdTooLong { length, .. }) if length == MAX_ID_BYTES + 2));
    assert!(batch.get(vehicle::SPEED, &long).is_err());
    for variable in [0x73, 0x68, 0x7e, 0x3e] {
        let naive = batch.subscribe_ids(Domain::Vehicle, "v0", &[0x40, variable], 0.0);
        assert!(matches!(naive, Err(BatchError::NeedsParameter { id, .. }) if id == variable));
    }
    let mixed = batch.subscribe((vehicle::SPEED, simulation::TIME), "v0", 0.0);
    assert_eq!(mixed, Err(BatchError::SeveralDomains));
    assert_eq!((batch.bytes(), batch.len()), (&[0, 0, 0, 4][..], 0), "nothing of a refused command remains");
    assert_eq!(batch.set_speed(&v0, -0.0), Ok(0));
    assert_eq!(batch.bytes()[batch.bytes().len() - 8..], [0; 8]);

    batch.step().unwrap();
    let length = batch.bytes().len();
    assert_eq!(batch.step(), Err(BatchError::AfterStep));
    assert_eq!(batch.set_speed(&v0, 1.0), Err(BatchError::AfterStep));
    assert!(batch.get(vehicle::SPEED, "v0").is_err());
    assert!(batch.subscribe(vehicle::SPEED, "v0", 0.0).is_err());
    assert_eq!(batch.bytes().len(), length);
    batch.clear();
    batch.execute_move().unwrap();
    assert_eq!(batch.step(), Err(BatchError::AfterStep));
}

#[test]
fn vehicles_are_never_subscribed_with_texts_that_overflow() {
    for (length, per_command) in [(2, 3), (30, 3), (60, 2), (180, 1)] {
        let mut batch = Batch::new();
        let commands = batch.subscribe(&[vehicle::SPEED; 12][..], &"x".repeat(length), 0.0).unwrap();
        assert_eq!(commands.len(), 12 / per_command, "{length}");
    }
}

#[test]
fn a_batch_is_reused_without_new_memory() {
    let v0 = Prefix::new("v0").unwrap();
    let mut batch = Batch::new();
    let fill = |batch: &mut Batch| {
        batch.clear();
        for _ in 0..1000 {
            batch.set_previous_speed(&v0, 1.0, 0.0).unwrap();
        }
        batch.step().unwrap();
        batch.bytes().as_ptr()
    };
    assert_eq!(fill(&mut batch), fill(&mut batch));
}

#[test]
fn no_value_is_not_a_number() {
    let mut batch = Batch::new();
    let handle = batch.get(vehicle::SPEED, "v0").unwrap();
    let mut frame = vec![0, 0, 0, 0, 7, 0xa4, 0, 0, 0, 0, 0, 18, 0xb4, 0x40, 0, 0, 0, 2, b'v', b'0', 0x0b];
    frame.extend((-1_073_741_824f64).to_be_bytes());
    let frame = with_length(&frame);
    let mut index = Index::default();
    let reply = index.read(&frame, &batch).unwrap();
    assert!(matches!(reply.value(0).unwrap(), Some(Value::Missing)));
    assert_eq!(reply.f64(0), None);
    assert!(reply.get(handle).is_err());
}
