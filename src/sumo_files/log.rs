//! What SUMO's log says about vehicles that SUMO left out of its traffic.

use super::error::{SumoFileError, unreadable};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// What warnings about such vehicles say (SUMO 1.15 to 1.28): no route, out of order in the file, taken out.
const LEFT_OUT: &[&str] = &[
    "No route for vehicle",
    "has no valid route",
    "has no route",
    "sorted by departure time, ignoring",
    "Removing vehicle",
    "will be removed",
    "vehicles while loading state",
];

/// The warnings about vehicles that SUMO left out: how many there are, and the first.
///
/// # Errors
/// [`SumoFileError::Unreadable`] if the log cannot be read.
pub fn left_out(log: &Path) -> Result<Option<(usize, String)>, SumoFileError> {
    let mut lines = BufReader::new(File::open(log).map_err(unreadable(log))?);
    let (mut count, mut first, mut bytes) = (0, None, Vec::new());
    while lines.read_until(b'\n', &mut bytes).map_err(unreadable(log))? > 0 {
        let line = String::from_utf8_lossy(&bytes);
        if line.starts_with("Warning:") && LEFT_OUT.iter().any(|words| line.contains(words)) {
            count += 1;
            first.get_or_insert_with(|| line.trim_start_matches("Warning:").trim().to_owned());
        }
        bytes.clear();
    }
    Ok(first.map(|first| (count, first)))
}
