//! A proxy between client and SUMO that makes the coupling wrong on the wire.

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// What the proxy does to the messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// Nothing.
    None,
    /// `setPreviousSpeed` becomes a command that does nothing.
    NotSentBack,
    /// `setPreviousSpeed` becomes `setSpeed`, and "speed without TraCI" is read in place of the speed.
    SpeedWithoutTraci,
    /// The connections end when this step is asked for, counted from 1.
    Cut(u64),
    /// From this step on nothing passes.
    Silent(u64),
    /// The answers of [`SLOW_STEPS`] steps from this one on come in small pieces.
    Slow(u64),
    /// The answer of this step has another byte, at this share of its length, the length in front included.
    Garbled {
        /// The step.
        step: u64,
        /// Where.
        at: f64,
        /// The bits that are turned over.
        bits: u8,
    },
}

/// A proxy under way.
pub struct Proxy {
    /// Where it listens.
    pub port: u16,
    /// How many steps the client has asked for.
    pub steps: Arc<AtomicU64>,
}

/// How long answers stay slow.
const SLOW_STEPS: u64 = 10;
const SET: u8 = 0xc4;
const GET: u8 = 0xa4;
const GOT: u8 = 0xb4;
const STEP: u8 = 0x02;
const SPEED: u8 = 0x40;
const SPEED_WITHOUT_TRACI: u8 = 0xb1;
const PREVIOUS_SPEED: u8 = 0x3c;
const DOUBLE: u8 = 0x0b;
const LIMIT: Duration = Duration::from_secs(30);

/// Starts a proxy for one connection to the SUMO at `sumo`, which may still be starting.
pub fn start(sumo: u16, fault: Fault) -> Proxy {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let (port, steps) = (listener.local_addr().unwrap().port(), Arc::new(AtomicU64::new(0)));
    let (asked, answered) = (steps.clone(), steps.clone());
    thread::spawn(move || {
        let (client, _) = listener.accept().unwrap();
        let Some(sumo) = reach(sumo) else { return };
        for stream in [&client, &sumo] {
            stream.set_nodelay(true).unwrap();
        }
        let (from_client, to_sumo) = (client.try_clone().unwrap(), sumo.try_clone().unwrap());
        thread::spawn(move || {
            let alter = |command: &[u8]| {
                // A step has a time behind it; the status of one has not.
                if command.len() == 10 && command[1] == STEP {
                    asked.fetch_add(1, Ordering::SeqCst);
                }
                alter_request(command, fault)
            };
            pump(from_client, to_sumo, alter, |message, to| ask(message, to, asked.load(Ordering::SeqCst), fault));
        });
        let step = || answered.load(Ordering::SeqCst);
        pump(sumo, client, |command| alter_answer(command, fault), |message, to| answer(message, to, step(), fault));
    });
    Proxy { port, steps }
}

/// None if SUMO never listens.
fn reach(port: u16) -> Option<TcpStream> {
    let deadline = Instant::now() + LIMIT;
    while Instant::now() < deadline {
        if let Ok(stream) = TcpStream::connect((Ipv4Addr::LOCALHOST, port)) {
            return Some(stream);
        }
        thread::sleep(Duration::from_millis(10));
    }
    None
}

/// Passes on what the client asks when it has asked for so many steps.
fn ask(message: &[u8], to: &mut TcpStream, step: u64, fault: Fault) -> io::Result<()> {
    match fault {
        Fault::Cut(from) if step >= from => Err(io::ErrorKind::ConnectionAborted.into()),
        Fault::Silent(from) if step >= from => Ok(()),
        _ => to.write_all(message),
    }
}

/// Passes on what SUMO answers.
fn answer(message: &[u8], to: &mut TcpStream, step: u64, fault: Fault) -> io::Result<()> {
    match fault {
        Fault::Slow(from) if (from..from + SLOW_STEPS).contains(&step) => {
            for piece in message.chunks(message.len().div_ceil(5)) {
                to.write_all(piece)?;
                thread::sleep(Duration::from_millis(4));
            }
            Ok(())
        }
        Fault::Garbled { step: at_step, at, bits } if step == at_step => {
            let mut message = message.to_vec();
            let place = (at * message.len() as f64) as usize;
            message[place] ^= bits;
            to.write_all(&message)
        }
        _ => to.write_all(message),
    }
}

/// Passes messages on, each command altered, until one side hangs up.
fn pump(
    mut from: TcpStream,
    mut to: TcpStream,
    alter: impl Fn(&[u8]) -> Vec<u8>,
    pass: impl Fn(&[u8], &mut TcpStream) -> io::Result<()>,
) {
    let mut length = [0; 4];
    while from.read_exact(&mut length).is_ok() {
        let mut body = vec![0; u32::from_be_bytes(length) as usize - 4];
        if from.read_exact(&mut body).is_err() {
            break;
        }
        let mut message = vec![0; 4];
        let mut rest = &body[..];
        while !rest.is_empty() {
            let command;
            (command, rest) = rest.split_at(command_length(rest));
            message.extend(alter(command));
            if is_step_status(command) {
                // The number of blocks, which is no command.
                let count;
                (count, rest) = rest.split_at(4);
                message.extend(count);
            }
        }
        let length = u32::try_from(message.len()).unwrap();
        message[..4].copy_from_slice(&length.to_be_bytes());
        if pass(&message, &mut to).is_err() {
            break;
        }
    }
    // A client that was cut off has to notice it, too.
    let _ = (to.shutdown(Shutdown::Both), from.shutdown(Shutdown::Both));
}

fn command_length(bytes: &[u8]) -> usize {
    match bytes[0] {
        0 => u32::from_be_bytes(bytes[1..5].try_into().unwrap()) as usize,
        short => usize::from(short),
    }
}

/// The status of a step that went well; the request of a step has a time in place of an empty text.
fn is_step_status(command: &[u8]) -> bool {
    command == [7, STEP, 0, 0, 0, 0, 0]
}

/// The parts of a short command about a vehicle: identifier, variable, id with its length, and the rest.
fn parts(command: &[u8]) -> Option<(u8, u8, &[u8], &[u8])> {
    if command[0] == 0 || command.len() < 7 {
        return None;
    }
    let id = u32::from_be_bytes(command[3..7].try_into().unwrap()) as usize;
    (command.len() >= 7 + id).then(|| (command[1], command[2], &command[3..7 + id], &command[7 + id..]))
}

fn short_command(identifier: u8, variable: u8, id: &[u8], rest: &[u8]) -> Vec<u8> {
    let length = u8::try_from(3 + id.len() + rest.len()).unwrap();
    [&[length, identifier, variable], id, rest].concat()
}

fn alter_request(command: &[u8], fault: Fault) -> Vec<u8> {
    let set_speed = |id: &[u8], speed: [u8; 8]| short_command(SET, SPEED, id, &[&[DOUBLE], &speed[..]].concat());
    match (fault, parts(command)) {
        // A negative speed ends a `setSpeed` that was never given.
        (Fault::NotSentBack, Some((SET, PREVIOUS_SPEED, id, _))) => set_speed(id, (-1f64).to_be_bytes()),
        // A compound of two doubles: tag, number of items, tag, speed, ...
        (Fault::SpeedWithoutTraci, Some((SET, PREVIOUS_SPEED, id, value))) => {
            set_speed(id, value[6..14].try_into().unwrap())
        }
        (Fault::SpeedWithoutTraci, Some((GET, SPEED, id, rest))) => short_command(GET, SPEED_WITHOUT_TRACI, id, rest),
        _ => command.to_vec(),
    }
}

fn alter_answer(command: &[u8], fault: Fault) -> Vec<u8> {
    match (fault, parts(command)) {
        (Fault::SpeedWithoutTraci, Some((GOT, SPEED_WITHOUT_TRACI, id, rest))) => short_command(GOT, SPEED, id, rest),
        _ => command.to_vec(),
    }
}
