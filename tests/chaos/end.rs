//! What is left of a run once it has ended.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::support::{children, naming, stays};

/// Sends a signal; whoever it is meant for may have gone.
pub fn send(signal: &str, pid: u32) {
    let _ = Command::new("kill")
        .args([&format!("-{signal}"), &pid.to_string()])
        .stderr(std::process::Stdio::null())
        .status();
}

/// Processes that stay for five seconds after a run into this folder has ended, and its port, if it still listens then.
pub fn left(dir: &Path, port: Option<u16>) -> Vec<String> {
    let stay: Vec<u32> = naming(dir).into_iter().filter(|pid| stays(*pid)).collect();
    let mut left: Vec<String> =
        stay.iter().map(|pid| format!("process {pid}: {}", command_line(*pid).join(" "))).collect();
    left.extend(port.filter(|port| keeps_listening(*port)).map(|port| format!("port {port}")));
    stay.iter().for_each(|pid| send("KILL", *pid));
    left
}

fn command_line(pid: u32) -> Vec<String> {
    let line = fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
    String::from_utf8_lossy(&line).split('\0').map(str::to_owned).collect()
}

/// The port on which the SUMO of a process listens, or will.
pub fn port_of(pid: u32) -> Option<u16> {
    let words = command_line(*children(pid).first()?);
    let option = words.iter().position(|word| word == "--remote-port")?;
    words.get(option + 1)?.parse().ok()
}

fn keeps_listening(port: u16) -> bool {
    let deadline = Instant::now() + Duration::from_secs(5);
    while listens(port) {
        if Instant::now() > deadline {
            return true;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    false
}

/// Whether a socket of this machine is in the state LISTEN (0A) on a port.
pub fn listens(port: u16) -> bool {
    let tables = ["/proc/net/tcp", "/proc/net/tcp6"].map(|path| fs::read_to_string(path).unwrap_or_default());
    let ours = format!(":{port:04X}");
    tables.iter().flat_map(|text| text.lines()).any(|line| {
        let mut words = line.split_whitespace().skip(1);
        words.next().is_some_and(|local| local.ends_with(&ours)) && words.nth(1) == Some("0A")
    })
}
