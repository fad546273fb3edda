//! Replies made by hand, byte by byte as TraCI's description says: what every status and every type is read as.

use super::harness::with_length;
use sumo_mfc::traci::wire::{DecodeError, frame_length};
use sumo_mfc::traci::{
    Batch, Color, Domain, Error, FromValue, Index, Never, Prefix, Var, lane, simulation, trafficlight, vehicle,
};

/// A short status: result and reason.
fn status(command: u8, result: u8, text: &str) -> Vec<u8> {
    let length = u8::try_from(7 + text.len()).unwrap();
    [&[length, command, result, 0, 0, 0, length - 7], text.as_bytes()].concat()
}

/// A command with its long header.
fn long(command: u8, body: &[u8]) -> Vec<u8> {
    let length = i32::try_from(6 + body.len()).unwrap().to_be_bytes();
    [&[0], &length[..], &[command], body].concat()
}

fn frame(parts: &[&[u8]]) -> Vec<u8> {
    with_length(&[&[0; 4], &*parts.concat()].concat())
}

/// A string with its length.
fn text(text: &str) -> Vec<u8> {
    [&u32::try_from(text.len()).unwrap().to_be_bytes(), text.as_bytes()].concat()
}

/// The answer to a get of a vehicle's variable.
fn got(variable: u8, value: &[u8]) -> Vec<u8> {
    [status(0xa4, 0, ""), long(0xb4, &[&[variable], &*text("v0"), value].concat())].concat()
}

/// Reads one value as a type.
fn read<T: FromValue>(value: &[u8]) -> Result<T, Error> {
    const ANY: u8 = 0xee;
    let mut batch = Batch::new();
    let handle = batch.get(Var::<T, Never>::new(Domain::Vehicle, ANY), "v0").unwrap();
    let frame = frame(&[&got(ANY, value)]);
    Index::default().read(&frame, &batch)?.get(handle)
}

/// The raw value.
fn with_value<R>(value: &[u8], see: impl FnOnce(sumo_mfc::traci::Value<'_>) -> R) -> Result<R, DecodeError> {
    let mut batch = Batch::new();
    batch.get(vehicle::SPEED, "v0").unwrap();
    let (frame, mut index) = (frame(&[&got(vehicle::SPEED.id, value)]), Index::default());
    Ok(see(index.read(&frame, &batch)?.value(0)?.unwrap()))
}

fn doubles(tag: u8, values: &[f64]) -> Vec<u8> {
    [&[tag], &*values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>()].concat()
}

const NO_VALUE: f64 = -1_073_741_824.0;

#[test]
fn every_type_is_read_as_it_was_sent() {
    assert_eq!(read::<f64>(&doubles(0x0b, &[3.25])).unwrap(), 3.25);
    assert_eq!(read::<i32>(&[0x09, 0xff, 0xff, 0xff, 0xfe]).unwrap(), -2);
    assert_eq!(read::<i32>(&[0x07, 200]).unwrap(), 200, "unsigned");
    assert_eq!(read::<i32>(&[0x08, 200]).unwrap(), -56, "signed");
    for (byte, truth) in [(0, false), (1, true), (255, true)] {
        assert_eq!(read::<bool>(&[0x07, byte]).unwrap(), truth);
        assert_eq!(read::<bool>(&[0x08, byte]).unwrap(), truth);
        assert_eq!(read::<bool>(&[0x09, 0, 0, 0, byte]).unwrap(), truth);
    }
    assert_eq!(read::<String>(&[&[0x0c], &*text("grün")].concat()).unwrap(), "grün");
    let list = [&[0x0e, 0, 0, 0, 3], &*text("a"), &text(""), &text("bc")].concat();
    assert_eq!(read::<Vec<String>>(&list).unwrap(), ["a", "", "bc"]);
    let numbers = [&[0x10, 0, 0, 0, 2], &doubles(0, &[0.5, -2.0])[1..]].concat();
    assert_eq!(read::<Vec<f64>>(&numbers).unwrap(), [0.5, -2.0]);
    assert_eq!(read::<[f64; 2]>(&doubles(0x01, &[1.0, 2.0])).unwrap(), [1.0, 2.0]);
    assert_eq!(read::<[f64; 3]>(&doubles(0x03, &[1.0, 2.0, 3.0])).unwrap(), [1.0, 2.0, 3.0]);
    let points = doubles(2, &[1.0, 2.0, 3.0, 4.0]);
    for head in [&[0x06][..], &[0x06, 0, 0, 0, 0]] {
        let polygon = [head, &points].concat();
        assert_eq!(read::<Vec<[f64; 2]>>(&polygon).unwrap(), [[1.0, 2.0], [3.0, 4.0]], "short and long count");
    }
    let colour = Color { red: 1, green: 2, blue: 3, alpha: 4 };
    assert_eq!(read::<Color>(&[0x11, 1, 2, 3, 4]).unwrap(), colour);
}

#[test]
fn no_value_and_another_type_are_told_apart() {
    let missing = doubles(0x0b, &[NO_VALUE]);
    assert!(matches!(read::<f64>(&missing), Err(Error::NoValue)));
    assert_eq!(read::<Option<f64>>(&missing).unwrap(), None);
    assert_eq!(read::<Option<f64>>(&doubles(0x0b, &[7.0])).unwrap(), Some(7.0));
    assert!(matches!(read::<i32>(&[0x09, 0xc0, 0, 0, 0]), Err(Error::NoValue)));
    assert!(matches!(read::<[f64; 2]>(&doubles(0x01, &[NO_VALUE; 2])), Err(Error::NoValue)));
    assert_eq!(read::<[f64; 2]>(&doubles(0x01, &[NO_VALUE, 1.0])).unwrap(), [NO_VALUE, 1.0], "only both");
    let other = read::<String>(&[0x07, 1]);
    assert!(matches!(other, Err(Error::Type { expected: "string", got: "unsigned byte" })), "{other:?}");
}

#[test]
fn raw_values_know_what_they_are() {
    assert_eq!(
        with_value(&[0x07, 200], |value| (value.as_i32(), value.as_f64(), value.as_str().is_none())).unwrap(),
        (Some(200), None, true)
    );
    assert_eq!(with_value(&[0x08, 200], |value| value.as_i32()).unwrap(), Some(-56));
    assert_eq!(with_value(&[0x09, 0, 0, 1, 0], |value| value.as_i32()).unwrap(), Some(256));
    let list = [&[0x0e, 0, 0, 0, 2], &*text("a"), &text("bc")].concat();
    let lengths = with_value(&list, |value| {
        let mut texts = value.as_texts().unwrap();
        let before = texts.len();
        (before, texts.next().map(str::to_owned), texts.len())
    });
    assert_eq!(lengths.unwrap(), (2, Some("a".to_owned()), 1));
    let bad = with_value(&[0x55, 0], |_| ()).unwrap_err();
    assert_eq!((bad.what, bad.offset), ("unknown type tag", 4 + 7 + 6 + 7));
}

/// SUMO's deepest compound has three levels; what nests for ever must end, and in an error.
#[test]
fn compounds_are_read_down_to_a_depth_and_no_further() {
    let nested = |levels: usize| [&[0x0f, 0, 0, 0, 1].repeat(levels), &[0x07, 1][..]].concat();
    assert!(with_value(&nested(6), |_| ()).is_ok());
    assert_eq!(with_value(&nested(7), |_| ()).unwrap_err().what, "compounds nested too deep");
}

#[test]
fn compounds_are_read_field_by_field() {
    let string = |value: &str| [&[0x0c], &*text(value)].concat();
    let truth = |value: bool| [0x07, u8::from(value)];
    let head = [0x0f, 0, 0, 0, 9, 0x09, 0, 0, 0, 2];
    let link = |lane: &str, [priority, open, foe]: [bool; 3], length_m: f64| {
        let truths = [truth(priority), truth(open), truth(foe)].concat();
        [string(lane), string(":via"), truths, string("M"), string("s"), doubles(0x0b, &[length_m])].concat()
    };
    let links = [&head[..], &link("a_0", [true, false, true], 1.5), &link("b_0", [false, true, false], 2.5)].concat();
    let mut batch = Batch::new();
    let handle = batch.get(lane::LINKS, "v0").unwrap();
    let answer = long(0xb3, &[&[lane::LINKS.id], &*text("v0"), &links].concat());
    let (whole, mut index) = (frame(&[&status(0xa3, 0, ""), &answer]), Index::default());
    let links = index.read(&whole, &batch).unwrap().get(handle).unwrap();
    let seen: Vec<_> = links.iter().map(|l| (&*l.lane, l.priority, l.open, l.foe, l.length_m)).collect();
    assert_eq!(seen, [("a_0", true, false, true, 1.5), ("b_0", false, true, false, 2.5)]);

    // Neighbours alone come without types.
    let near = |id: &str, gap_m: f64| [&*text(id), &gap_m.to_be_bytes()].concat();
    let neighbours = [&[0x0f, 0, 0, 0, 2][..], &near("v1", 12.5), &near("v2", -0.5)].concat();
    let mut batch = Batch::new();
    let handle = batch.get_with(vehicle::NEIGHBORS, "v0", 2).unwrap();
    let whole = frame(&[&got(vehicle::NEIGHBORS.id, &neighbours)]);
    let neighbours = index.read(&whole, &batch).unwrap().get(handle).unwrap();
    let seen: Vec<_> = neighbours.iter().map(|neighbour| (&*neighbour.id, neighbour.gap_m)).collect();
    assert_eq!(seen, [("v1", 12.5), ("v2", -0.5)]);
}

#[test]
fn text_that_is_no_utf_8_is_an_error_at_its_byte() {
    let bad = with_value(&[0x0c, 0, 0, 0, 4, b'a', b'b', 0xff, b'c'], |_| ()).unwrap_err();
    let begin = 4 + 7 + 6 + 7;
    assert_eq!((bad.what, bad.offset), ("not UTF-8", begin + 1 + 4 + 2));
}

/// A batch of three: a set, a get, a subscription.
fn three() -> Batch {
    let mut batch = Batch::new();
    batch.set_speed(&Prefix::new("v0").unwrap(), 1.0).unwrap();
    batch.get(vehicle::ROAD, "v0").unwrap();
    batch.subscribe(vehicle::SPEED, "v0", 0.0).unwrap();
    batch
}

fn block(variable: u8, value: &[u8]) -> Vec<u8> {
    long(0xe4, &[&text("v0")[..], &[1, variable, 0], value].concat())
}

#[test]
fn statuses_accept_or_refuse_in_both_lengths() {
    let batch = three();
    let road = got(vehicle::ROAD.id, &[&[0x0c], &*text("ab")].concat());
    let subscribed = [status(0xd4, 0, ""), block(vehicle::SPEED.id, &doubles(0x0b, &[5.0]))].concat();
    let long_status = long(0xc4, &[&[0], &*text("fine")].concat());
    for accepted in [status(0xc4, 0, ""), status(0xc4, 0, "fine"), long_status] {
        let (frame, mut index) = (frame(&[&accepted, &road, &subscribed]), Index::default());
        let reply = index.read(&frame, &batch).unwrap();
        assert_eq!((reply.len(), reply.is_empty(), reply.refusals().count()), (3, false, 0));
        assert_eq!((reply.text(1), reply.text(0), reply.f64(1)), (Some("ab"), None, None));
        let block = reply.subscription(2).unwrap().unwrap();
        assert_eq!(block.get(vehicle::SPEED).unwrap(), Some(5.0));
        assert!(reply.subscription(1).unwrap().is_none());
    }
    for (result, not_implemented) in [(0x01, true), (0xff, false)] {
        let refused = status(0xc4, result, "no");
        let (frame, mut index) = (frame(&[&refused, &road, &subscribed]), Index::default());
        let reply = index.read(&frame, &batch).unwrap();
        let refusal = reply.refusal(0).unwrap();
        assert_eq!((refusal.text, refusal.not_implemented), ("no", not_implemented));
        assert_eq!((reply.refusals().count(), reply.text(1)), (1, Some("ab")));
    }
    assert!(Index::default().read(&frame(&[]), &Batch::new()).unwrap().is_empty());
}

/// Of a refused get there is no answer; of a refused subscription there may be one.
#[test]
fn what_follows_a_refusal_is_found() {
    let batch = three();
    let (done, no_get) = (status(0xc4, 0, ""), status(0xa4, 0xff, "who?"));
    let reasons = long(0xe4, &[&text("v0")[..], &[1, vehicle::SPEED.id, 0xff, 0x0c], &text("gone")].concat());
    for more in [&[][..], &reasons] {
        let refused = [&status(0xd4, 0xff, "nobody"), more].concat();
        let (frame, mut index) = (frame(&[&done, &no_get, &refused]), Index::default());
        let reply = index.read(&frame, &batch).unwrap();
        assert_eq!(
            reply.refusals().map(|(command, refusal)| (command, refusal.text)).collect::<Vec<_>>(),
            [(1, "who?"), (2, "nobody")]
        );
        assert!(reply.value(1).unwrap().is_none());
        let block = reply.subscription(2).unwrap();
        assert_eq!(block.is_some(), !more.is_empty());
        if let Some(block) = block {
            let told = block.get(vehicle::SPEED);
            assert!(matches!(&told, Err(Error::Refused { text, .. }) if text == "gone"), "{told:?}");
        }
    }
    // Two in a row: behind a refused subscription the next status is no block.
    let mut two = Batch::new();
    two.subscribe(vehicle::SPEED, "v0", 0.0).unwrap();
    two.subscribe(vehicle::SPEED, "v1", 0.0).unwrap();
    let frame = frame(&[&status(0xd4, 0xff, "a"), &status(0xd4, 0xff, "b")]);
    let mut index = Index::default();
    let reply = index.read(&frame, &two).unwrap();
    assert_eq!(reply.refusals().map(|(_, refusal)| refusal.text).collect::<Vec<_>>(), ["a", "b"]);
}

#[test]
fn a_step_that_sumo_refuses_has_no_blocks() {
    let mut batch = Batch::new();
    batch.step().unwrap();
    let refused = frame(&[&status(0x02, 0xff, "over")]);
    let mut index = Index::default();
    let reply = index.read(&refused, &batch).unwrap();
    assert_eq!((reply.block_count(), reply.blocks().count(), reply.refusals().count()), (0, 0, 1));

    let block = block(vehicle::SPEED.id, &doubles(0x0b, &[5.0]));
    let stepped = frame(&[&status(0x02, 0, ""), &[0, 0, 0, 2], &block, &block]);
    let reply = index.read(&stepped, &batch).unwrap();
    let mut blocks = reply.blocks();
    assert_eq!((reply.block_count(), blocks.size_hint()), (2, (0, Some(2))), "a bad block ends them early");
    blocks.next().unwrap().unwrap();
    assert_eq!(blocks.size_hint(), (0, Some(1)));
    assert_eq!(blocks.next().unwrap().unwrap().domain, Some(Domain::Vehicle));
    assert!(blocks.next().is_none());
}

#[test]
fn answers_to_something_else_are_errors() {
    let what = |parts: &[&[u8]]| Index::default().read(&frame(parts), &three()).unwrap_err().what;
    let (done, road) = (status(0xc4, 0, ""), got(vehicle::ROAD.id, &[&[0x0c], &*text("ab")].concat()));
    assert_eq!(what(&[&status(0xa4, 0, "")]), "status of another command than sent");
    assert_eq!(what(&[&status(0xc4, 0x02, "?")]), "unknown status");
    // Of the two that say which get is answered, each alone must be enough.
    let another_variable = got(vehicle::LANE.id, &[&[0x0c], &*text("ab")].concat());
    assert_eq!(what(&[&done, &another_variable]), "answer to another get than asked");
    let mut another_domain = road.clone();
    another_domain[7 + 5] = 0xb3;
    assert_eq!(what(&[&done, &another_domain]), "answer to another get than asked");
    let foreign = long(0xe3, &text("v0"));
    assert_eq!(what(&[&done, &road, &status(0xd4, 0, ""), &foreign]), "block of another domain than subscribed");
    let leftover = block(vehicle::SPEED.id, &doubles(0x0b, &[5.0]));
    assert_eq!(what(&[&done, &road, &status(0xd4, 0, ""), &leftover, &[1]]), "leftover bytes");
}

/// A frame has at least its own length, and at most 256 MiB: a longer one is no TraCI.
#[test]
fn a_frame_has_a_length_that_can_be_true() {
    let length = |value: i32| frame_length(&value.to_be_bytes()).map_err(|error| error.what);
    assert_eq!(frame_length(&[0, 0, 0]), Ok(None), "need more");
    assert_eq!([length(4), length(5), length(1 << 28)], [Ok(Some(4)), Ok(Some(5)), Ok(Some(1 << 28))]);
    assert_eq!([length(0), length(3), length(-1)], [Err("frame length below 4"); 3]);
    assert_eq!(length((1 << 28) + 1), Err("frame length above 256 MiB"));
}

/// The numbers of the commands, from TraCI's description.
#[test]
fn every_domain_has_its_commands() {
    let get = |build: &dyn Fn(&mut Batch)| {
        let mut batch = Batch::new();
        build(&mut batch);
        batch.bytes()[5]
    };
    assert_eq!(get(&|batch| drop(batch.get(vehicle::SPEED, "v0"))), 0xa4);
    assert_eq!(get(&|batch| drop(batch.get(simulation::TIME, ""))), 0xab);
    assert_eq!(get(&|batch| drop(batch.get(trafficlight::PROGRAMS, "A0"))), 0xa2);
    assert_eq!(get(&|batch| drop(batch.get(lane::LINKS, "a_0"))), 0xa3);
    assert_eq!(get(&|batch| drop(batch.subscribe(simulation::TIME, "", 0.0))), 0xdb);
    assert_eq!(get(&|batch| drop(batch.unsubscribe(Domain::Simulation, ""))), 0xdb);
}
