//! A proxy between client and SUMO that makes the coupling wrong on the wire.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::thread;
use std::time::{Duration, Instant};

/// What the proxy does to the messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Nothing.
    None,
    /// `setPreviousSpeed` becomes a command that does nothing.
    NotSentBack,
    /// `setPreviousSpeed` becomes `setSpeed`, and "speed without TraCI" is read in place of the speed.
    SpeedWithoutTraci,
}

const SET: u8 = 0xc4;
const GET: u8 = 0xa4;
const GOT: u8 = 0xb4;
const STEP: u8 = 0x02;
const SPEED: u8 = 0x40;
const SPEED_WITHOUT_TRACI: u8 = 0xb1;
const PREVIOUS_SPEED: u8 = 0x3c;
const DOUBLE: u8 = 0x0b;
const LIMIT: Duration = Duration::from_secs(30);

/// Starts a proxy for one connection to the SUMO at `sumo`, which may still be starting. Returns the proxy's port.
pub fn start(sumo: u16, fault: Fault) -> u16 {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let port = listener.local_addr().unwrap().port();
    thread::spawn(move || {
        let (client, _) = listener.accept().unwrap();
        let sumo = reach(sumo);
        for stream in [&client, &sumo] {
            stream.set_nodelay(true).unwrap();
        }
        let (from_client, to_sumo) = (client.try_clone().unwrap(), sumo.try_clone().unwrap());
        thread::spawn(move || pump(from_client, to_sumo, |command| alter_request(command, fault)));
        pump(sumo, client, |command| alter_answer(command, fault));
    });
    port
}

fn reach(port: u16) -> TcpStream {
    let deadline = Instant::now() + LIMIT;
    loop {
        match TcpStream::connect((Ipv4Addr::LOCALHOST, port)) {
            Ok(stream) => return stream,
            Err(error) => assert!(Instant::now() < deadline, "SUMO does not listen: {error}"),
        }
        thread::sleep(Duration::from_millis(10));
    }
}

/// Passes messages on, each command altered, until one side hangs up.
fn pump(mut from: TcpStream, mut to: TcpStream, alter: impl Fn(&[u8]) -> Vec<u8>) {
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
        if to.write_all(&message).is_err() {
            break;
        }
    }
    let _ = to.shutdown(Shutdown::Both);
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
