//! Random batches of everything that can be asked and set, read back by a model of SUMO's reader: nothing that the encoder
//! sends makes SUMO hang or die, and SUMO understands what was meant.

use proptest::prelude::*;
use sumo_mfc::traci::{
    AddVehicle, Batch, Color, Distance, Domain, Never, NewVehicle, Nothing, OnRoad, Prefix, RoadPosition, Row, Shape,
    TABLE, Var, trafficlight, vehicle,
};

use crate::sumo_reader::{Command, Read, read};

/// What the arguments of a command are taken from.
#[derive(Debug, Clone)]
struct Words {
    id: String,
    texts: Vec<String>,
    numbers: Vec<f64>,
    whole: Vec<i32>,
    bytes: Vec<u8>,
}

impl Words {
    fn text(&self, i: usize) -> &str {
        &self.texts[i]
    }

    fn place(&self, i: usize) -> RoadPosition<'_> {
        RoadPosition { edge: self.text(i), position_m: self.numbers[i], lane: self.bytes[i] }
    }

    fn read_text(&self, i: usize) -> Read {
        Read::Text(self.texts[i].clone())
    }

    fn read_number(&self, i: usize) -> Read {
        Read::Double(self.numbers[i])
    }

    fn read_place(&self, i: usize) -> Read {
        Read::OnRoad(self.texts[i].clone(), self.numbers[i], self.bytes[i])
    }
}

/// A command of a batch; the number picks a row of the table.
#[derive(Debug, Clone)]
enum Order {
    Get(usize),
    Set(usize),
    SetSpeed,
    SetPreviousSpeed,
    ReleaseSpeed,
    Subscribe(Vec<usize>),
    SubscribeWith(usize),
    Unsubscribe(usize),
    Step,
    ExecuteMove,
}

fn rows(wanted: impl Fn(&Row) -> bool) -> Vec<&'static Row> {
    TABLE.iter().filter(|row| wanted(row)).collect()
}

fn nibble(domain: Domain) -> u8 {
    domain as u8
}

/// The parameter of a row: what SUMO must read, and what the encoder says to it. `subscribed` at a time, or asked for.
fn put_get(batch: &mut Batch, row: &Row, words: &Words, subscribed: Option<f64>) -> (Option<Read>, bool) {
    macro_rules! put {
        ($shape:ty, $argument:expr, $read:expr) => {{
            let variable = Var::<f64, Never, $shape>::new(row.domain, row.id);
            let taken = match subscribed {
                None => batch.get_with(variable, &words.id, $argument).is_ok(),
                Some(begin_s) => batch.subscribe_with(variable, &words.id, $argument, begin_s).is_ok(),
            };
            ($read, taken)
        }};
    }
    let (text, number, whole) = (|i| words.text(i), |i: usize| words.numbers[i], words.whole[0]);
    let far = if words.bytes[3].is_multiple_of(2) { Distance::Air } else { Distance::Driving };
    let compound = |items: Vec<Read>| Some(Read::Compound(items));
    let (t, n, p) = (|i| words.read_text(i), |i| words.read_number(i), |i| words.read_place(i));
    match row.parameter {
        None => put!((), (), None),
        Some("f64") => put!(f64, number(0), Some(n(0))),
        Some("i32") => put!(i32, whole, Some(Read::Int(whole))),
        Some("u8") => put!(u8, words.bytes[0], Some(Read::UByte(words.bytes[0]))),
        Some("String") => put!(String, text(0), Some(t(0))),
        Some("(OnRoad, u8)") => {
            put!((OnRoad, u8), (words.place(0), words.bytes[1]), compound(vec![p(0), Read::UByte(words.bytes[1])]))
        }
        Some("(OnRoad, Distance)") => {
            put!((OnRoad, Distance), (words.place(0), far), compound(vec![p(0), Read::Bare(far as u8)]))
        }
        Some("(OnRoad, OnRoad, Distance)") => put!(
            (OnRoad, OnRoad, Distance),
            (words.place(0), words.place(1), far),
            compound(vec![p(0), p(1), Read::Bare(far as u8)])
        ),
        Some("(f64, f64)") => put!((f64, f64), (number(0), number(1)), compound(vec![n(0), n(1)])),
        Some("(f64, f64, f64, String)") => put!(
            (f64, f64, f64, String),
            (number(0), number(1), number(2), text(0)),
            compound(vec![n(0), n(1), n(2), t(0)])
        ),
        Some("(f64, f64, f64, f64, String)") => put!(
            (f64, f64, f64, f64, String),
            (number(0), number(1), number(2), number(3), text(0)),
            compound(vec![n(0), n(1), n(2), n(3), t(0)])
        ),
        Some("(String, String, String, f64, i32)") => put!(
            (String, String, String, f64, i32),
            (text(0), text(1), text(2), number(0), whole),
            compound(vec![t(0), t(1), t(2), n(0), Read::Int(whole)])
        ),
        Some(other) => panic!("no parameter {other} for {}", row.name),
    }
}

/// The same for a set, with the variable that SUMO sees.
fn put_set(batch: &mut Batch, row: &Row, words: &Words) -> (u8, Option<Read>, bool) {
    fn put<S: Shape>(batch: &mut Batch, row: &Row, id: &str, value: S::Arg<'_>) -> bool {
        batch.set(Var::<f64, S>::new(row.domain, row.id), id, value).is_ok()
    }
    let (id, w) = (words.id.as_str(), words);
    let (t, n) = (|i| w.read_text(i), |i| w.read_number(i));
    let byte = |i: usize| w.bytes[i] as i8;
    let compound = |items: Vec<Read>| Some(Read::Compound(items));
    let list: Vec<&str> = w.texts.iter().take(usize::from(w.bytes[0] % 12)).map(String::as_str).collect();
    let texts = || Some(Read::Texts(list.iter().map(|text| (*text).to_owned()).collect()));
    // Rows whose set has another identifier than their get.
    match (row.domain, row.name) {
        (Domain::Vehicle, "ROUTE") => return (0x57, texts(), batch.set(vehicle::ROUTE, id, &list).is_ok()),
        (Domain::TrafficLight, "PROGRAM") => {
            return (0x23, Some(t(0)), batch.set(trafficlight::PROGRAM, id, w.text(0)).is_ok());
        }
        (Domain::TrafficLight, "PHASE") => {
            return (0x22, Some(Read::Int(w.whole[0])), batch.set(trafficlight::PHASE, id, w.whole[0]).is_ok());
        }
        _ => {}
    }
    let (value, taken) = match row.set.expect("a row that can be set") {
        "f64" => (Some(n(0)), put::<f64>(batch, row, id, w.numbers[0])),
        "i32" => (Some(Read::Int(w.whole[0])), put::<i32>(batch, row, id, w.whole[0])),
        "i8" => (Some(Read::Byte(byte(0))), put::<i8>(batch, row, id, byte(0))),
        "String" => (Some(t(0)), put::<String>(batch, row, id, w.text(0))),
        "Texts" => (texts(), put::<Vec<String>>(batch, row, id, &list)),
        "Color" => {
            let [red, green, blue, alpha] = [w.bytes[0], w.bytes[1], w.bytes[2], w.bytes[3]];
            (
                Some(Read::Color([red, green, blue, alpha])),
                put::<Color>(batch, row, id, Color { red, green, blue, alpha }),
            )
        }
        "()" => (None, put::<()>(batch, row, id, ())),
        "Nothing" => (compound(vec![]), put::<Nothing>(batch, row, id, ())),
        "(f64,)" => (compound(vec![n(0)]), put::<(f64,)>(batch, row, id, (w.numbers[0],))),
        "(f64, f64)" => (compound(vec![n(0), n(1)]), put::<(f64, f64)>(batch, row, id, (w.numbers[0], w.numbers[1]))),
        "(String, String)" => {
            (compound(vec![t(0), t(1)]), put::<(String, String)>(batch, row, id, (w.text(0), w.text(1))))
        }
        "(String, f64)" => {
            (compound(vec![t(0), n(0)]), put::<(String, f64)>(batch, row, id, (w.text(0), w.numbers[0])))
        }
        "(i8, f64)" => {
            (compound(vec![Read::Byte(byte(0)), n(0)]), put::<(i8, f64)>(batch, row, id, (byte(0), w.numbers[0])))
        }
        "(String, f64, i8, f64, i8, f64, f64)" => {
            let given = (w.text(0), w.numbers[0], byte(0), w.numbers[1], byte(1), w.numbers[2], w.numbers[3]);
            let items = vec![t(0), n(0), Read::Byte(byte(0)), n(1), Read::Byte(byte(1)), n(2), n(3)];
            (compound(items), put::<(String, f64, i8, f64, i8, f64, f64)>(batch, row, id, given))
        }
        "AddVehicle" => {
            let given = NewVehicle {
                route: w.text(0),
                vehicle_type: w.text(1),
                depart: w.text(2),
                depart_lane: w.text(3),
                depart_position: w.text(4),
                depart_speed: w.text(5),
            };
            let fixed = ["current", "max", "current", "", "", ""].map(|text| Read::Text(text.to_owned()));
            let items = (0..6).map(t).chain(fixed).chain([Read::Int(0), Read::Int(0)]).collect();
            (compound(items), put::<AddVehicle>(batch, row, id, given))
        }
        other => panic!("no value {other} for {}", row.name),
    };
    (row.id, value, taken)
}

/// Puts an order into the batch, and what SUMO is to understand into `meant`, unless the batch refuses it.
fn put(batch: &mut Batch, order: &Order, words: &Words, meant: &mut Vec<Command>) {
    let (readable, settable) = (rows(|row| row.probe.is_some()), rows(|row| row.set.is_some()));
    let (id, begin_s) = (words.id.clone(), words.numbers[6]);
    let own = |value: f64| Some(Read::Double(value.abs()));
    let speed = |value: Option<Read>| Command::Set { domain: 4, variable: 0x40, id: id.clone(), value };
    let until_s = words.numbers[5];
    match order {
        Order::Get(row) => {
            let row = readable[row % readable.len()];
            let (parameter, taken) = put_get(batch, row, words, None);
            let get = Command::Get { domain: nibble(row.domain), variable: row.id, id, parameter };
            meant.extend(taken.then_some(get));
        }
        Order::Set(row) => {
            let row = settable[row % settable.len()];
            let (variable, value, taken) = put_set(batch, row, words);
            meant.extend(taken.then_some(Command::Set { domain: nibble(row.domain), variable, id, value }));
        }
        Order::SetSpeed | Order::SetPreviousSpeed | Order::ReleaseSpeed => {
            let Ok(prefix) = Prefix::new(&id) else { return };
            let [a, b] = [words.numbers[0], words.numbers[1]];
            let (command, put) = match order {
                Order::SetSpeed => (speed(own(a)), batch.set_speed(&prefix, a)),
                Order::ReleaseSpeed => (speed(Some(Read::Double(-1.0))), batch.release_speed(&prefix)),
                _ => {
                    let value = Some(Read::Compound(vec![Read::Double(a.abs()), Read::Double(b)]));
                    let set = Command::Set { domain: 4, variable: 0x3c, id: id.clone(), value };
                    (set, batch.set_previous_speed(&prefix, a, b))
                }
            };
            meant.extend(put.is_ok().then_some(command));
        }
        Order::Subscribe(picked) => {
            let domain = readable[picked.first().copied().unwrap_or(0) % readable.len()].domain;
            let of_domain = rows(|row| row.probe.is_some() && row.domain == domain);
            let variables: Vec<u8> = picked.iter().map(|row| of_domain[row % of_domain.len()].id).collect();
            let Ok(commands) = batch.subscribe_ids(domain, &id, &variables, begin_s) else { return };
            let end_s = -1_073_741_824.0;
            for part in variables.chunks(variables.len().div_ceil(commands.len().max(1)).max(1)) {
                let variables = part.iter().map(|variable| (*variable, None)).collect();
                let id = id.clone();
                meant.push(Command::Subscribe { domain: nibble(domain), id, begin_s, end_s, variables });
            }
        }
        Order::SubscribeWith(row) => {
            let rows = rows(|row| row.parameter.is_some() && row.probe.is_some());
            let row = rows[row % rows.len()];
            let (parameter, taken) = put_get(batch, row, words, Some(begin_s));
            let (domain, end_s, variables) = (nibble(row.domain), -1_073_741_824.0, vec![(row.id, parameter)]);
            meant.extend(taken.then_some(Command::Subscribe { domain, id, begin_s, end_s, variables }));
        }
        Order::Unsubscribe(domain) => {
            let domain = Domain::ALL[domain % Domain::ALL.len()];
            let (begin_s, end_s, taken) = (-1_073_741_824.0, -1_073_741_824.0, batch.unsubscribe(domain, &id).is_ok());
            let ends = Command::Subscribe { domain: nibble(domain), id, begin_s, end_s, variables: vec![] };
            meant.extend(taken.then_some(ends));
        }
        Order::Step => meant.extend(batch.step_until(until_s).is_ok().then_some(Command::Step { until_s })),
        Order::ExecuteMove => meant.extend(batch.execute_move().is_ok().then_some(Command::ExecuteMove)),
    }
}

/// What SUMO reads of a batch is what was meant.
fn understood(orders: &[(Order, Words)]) -> Result<usize, TestCaseError> {
    let (mut batch, mut meant) = (Batch::new(), Vec::new());
    for (order, words) in orders {
        put(&mut batch, order, words, &mut meant);
    }
    let commands = read(batch.bytes()).map_err(|what| TestCaseError::fail(format!("{what}\n{orders:?}")))?;
    prop_assert_eq!(merged(&commands), merged(&meant));
    prop_assert_eq!(commands.len(), batch.len());
    Ok(meant.len())
}

/// One command for all subscriptions of an object that follow each other: how they are shared out is the encoder's affair.
fn merged(commands: &[Command]) -> Vec<Command> {
    let mut all: Vec<Command> = Vec::new();
    for command in commands {
        if let (
            Some(Command::Subscribe { domain, id, begin_s, variables, .. }),
            Command::Subscribe { domain: d, id: i, begin_s: b, variables: v, .. },
        ) = (all.last_mut(), command)
            && (*domain, &*id, *begin_s) == (*d, i, *b)
            && !variables.is_empty()
            && !v.is_empty()
        {
            variables.extend(v.iter().cloned());
            continue;
        }
        all.push(command.clone());
    }
    all
}

/// Texts of every alphabet and length, those at the limits above all.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => "[a-zA-Z0-9_.#:]{0,12}",
        2 => any::<String>(),
        1 => "\\PC{0,60}",
        1 => (170..260_usize).prop_map(|length| "x".repeat(length)),
        1 => (80..130_usize).prop_map(|length| "ä".repeat(length)),
        1 => (40..70_usize).prop_map(|length| "😀".repeat(length)),
        1 => Just("'\"<&>\\\0\n\u{202e}e\u{301}".to_owned()),
    ]
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -1e4..1e4,
        2 => any::<f64>(),
        1 => prop::sample::select(vec![0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 5e-324, -1_073_741_824.0]),
    ]
}

fn words() -> impl Strategy<Value = Words> {
    let lists = (
        prop::collection::vec(text(), 12),
        prop::collection::vec(number(), 7),
        prop::collection::vec(any::<i32>(), 2),
        prop::collection::vec(any::<u8>(), 4),
    );
    (text(), lists).prop_map(|(id, (texts, numbers, whole, bytes))| Words { id, texts, numbers, whole, bytes })
}

fn order() -> impl Strategy<Value = Order> {
    let row = 0..100_000_usize;
    prop_oneof![
        5 => row.clone().prop_map(Order::Get),
        5 => row.clone().prop_map(Order::Set),
        1 => Just(Order::SetSpeed),
        1 => Just(Order::SetPreviousSpeed),
        1 => Just(Order::ReleaseSpeed),
        3 => prop::collection::vec(row.clone(), 1..20).prop_map(Order::Subscribe),
        2 => row.clone().prop_map(Order::SubscribeWith),
        1 => row.prop_map(Order::Unsubscribe),
        1 => Just(Order::Step),
        1 => Just(Order::ExecuteMove),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096, ..ProptestConfig::default() })]

    #[test]
    fn law_sumo_reads_every_batch_as_it_was_meant(orders in prop::collection::vec((order(), words()), 1..12)) {
        understood(&orders)?;
    }
}

/// No row of the table is left out by chance.
#[test]
fn law_sumo_reads_every_row_of_the_table() {
    let words = Words {
        id: "ä'1".to_owned(),
        texts: (0..12).map(|i| format!("t{i}")).collect(),
        numbers: (0..7).map(|i| f64::from(i) + 0.5).collect(),
        whole: vec![-7, 7],
        bytes: vec![3, 2, 1, 0],
    };
    let all = TABLE.len();
    for row in 0..all {
        for order in [Order::Get(row), Order::Set(row), Order::SubscribeWith(row)] {
            assert_eq!(understood(&[(order.clone(), words.clone())]).unwrap(), 1, "{order:?} is refused");
        }
    }
    // A step ends a batch, whatever comes behind it.
    let step = || (Order::Step, words.clone());
    assert_eq!(
        understood(&[step(), step(), (Order::Get(0), words.clone()), (Order::ExecuteMove, words.clone())]).unwrap(),
        1
    );
}

/// The model sees what it is there to see.
#[test]
fn law_the_model_notices_what_hangs_or_ends_sumo() {
    let mut batch = Batch::new();
    batch.get(vehicle::SPEED, "v0").unwrap();
    batch.set(vehicle::SPEED, "v0", 3.0).unwrap();
    batch.subscribe_with(vehicle::FOLLOWER, "v0", 100.0, 0.0).unwrap();
    batch.step().unwrap();
    let good = batch.bytes().to_vec();
    assert_eq!(read(&good).unwrap().len(), 4);
    let total = |mut bytes: Vec<u8>| {
        let length = i32::try_from(bytes.len()).unwrap().to_be_bytes();
        bytes[..4].copy_from_slice(&length);
        bytes
    };
    let changed = |at: usize, value: u8| {
        let mut bytes = good.clone();
        bytes[at] = value;
        read(&bytes).unwrap_err()
    };
    assert!(changed(3, 1).contains("SUMO waits for"));
    assert!(changed(4, 8).contains("has 8 bytes, SUMO reads 9"), "a wrong length");
    assert!(changed(10, 200).contains("beyond the end"), "a text that is too long");
    assert!(changed(7, 255).contains("negative length"));
    assert!(
        changed(24 - 2, 0x09).contains("type 0x09, the handler reads 0x0b") || changed(21, 0x09).contains("type 0x09")
    );
    let behind = total([&good[..], &[2, 0]].concat());
    assert!(read(&behind).unwrap_err().contains("a command behind a step"));
    let long = "x".repeat(250);
    let mut bytes = vec![0, 0, 0, 0, 0, 0, 0, 1, 4, 0xa4, 0x40, 0, 0, 0, 250];
    bytes[4..9].copy_from_slice(&[0, 0, 0, 1, 5]);
    bytes.extend(long.as_bytes());
    assert!(read(&total(bytes)).unwrap_err().contains("which ends SUMO"));
}
