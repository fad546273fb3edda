//! What SUMO's log says about dangerous moments: collisions, teleports, emergency braking. SUMO 1.15 to 1.28.

use super::error::{SumoFileError, unreadable};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// One warning of the log.
#[derive(Debug, Clone, PartialEq)]
pub struct Incident {
    /// What it is about: `collision`, `teleport` or `emergency braking`.
    pub kind: &'static str,
    /// The lane that it names; empty if it names none.
    pub lane: String,
    /// The warning itself.
    pub text: String,
}

/// Which words of a warning make it one of a kind; the first that fits holds.
const KINDS: [(&str, &str); 4] = [
    ("collision with", "collision"),
    ("Teleporting vehicle", "teleport"),
    ("emergency braking", "emergency braking"),
    ("emergency stop", "emergency braking"),
];

/// The incidents of a log, in its order.
///
/// # Errors
/// [`SumoFileError::Unreadable`] if the log cannot be read.
pub fn incidents(log: &Path) -> Result<Vec<Incident>, SumoFileError> {
    let mut lines = BufReader::new(File::open(log).map_err(unreadable(log))?);
    let (mut found, mut bytes) = (Vec::new(), Vec::new());
    while lines.read_until(b'\n', &mut bytes).map_err(unreadable(log))? > 0 {
        found.extend(incident(&String::from_utf8_lossy(&bytes)));
        bytes.clear();
    }
    Ok(found)
}

fn incident(line: &str) -> Option<Incident> {
    let text = line.strip_prefix("Warning:")?.trim();
    let (_, kind) = KINDS.iter().find(|(words, _)| text.contains(words))?;
    let after = ["lane='", "lane '"].iter().find_map(|start| text.split_once(start))?;
    let lane = after.1.split('\'').next().unwrap_or_default();
    Some(Incident { kind, lane: lane.to_owned(), text: text.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_warnings_of_sumo_have_a_kind_and_a_lane() {
        let of = |line: &str| incident(line).map(|i| (i.kind, i.lane));
        for (line, wanted) in [
            (
                "Warning: Vehicle 'a'; collision with vehicle 'b', lane='E0_0', gap=-0.50, time=35.00, stage=move.",
                Some(("collision", "E0_0")),
            ),
            (
                "Warning: Teleporting vehicle 'a'; waited too long (jam), lane='E1_1', time=301.00.",
                Some(("teleport", "E1_1")),
            ),
            (
                "Warning: Vehicle 'a' performs emergency braking on lane ':J_3_0' with decel=9.00, wished=4.50, severity=1.00, time=12.00.",
                Some(("emergency braking", ":J_3_0")),
            ),
            ("Warning: Vehicle 'a' ends teleporting on edge 'E0', time=302.00.", None),
            ("Loading done.", None),
        ] {
            assert_eq!(of(line), wanted.map(|(kind, lane)| (kind, lane.to_owned())), "{line}");
        }
    }
}
