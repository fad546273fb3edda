//! SUMO ends with this program, however that ends. Until a client is connected SUMO would otherwise wait for one for ever.

use std::io::{PipeReader, PipeWriter, Write};
use std::path::Path;
use tokio::process::Command;

/// Becomes SUMO, and leaves a watcher behind that kills it once the pipe on its standard input is closed, which the system
/// does when this program is gone. A line in the pipe sends the watcher away. (The parent-death signal of Linux would need
/// unsafe code, and comes when a thread ends.)
const SCRIPT: &str = r#"exec 3<&0 </dev/null; { read -r _ <&3 || kill -9 $$; } >/dev/null 2>&1 & exec 3<&-; exec "$@""#;

/// This program's end of the pipe. Dropping it kills SUMO.
#[derive(Debug)]
pub struct Tie(PipeWriter);

impl Tie {
    /// A tie, and its other end.
    pub fn new() -> std::io::Result<(Self, PipeReader)> {
        std::io::pipe().map(|(theirs, ours)| (Self(ours), theirs))
    }

    /// SUMO has ended, or may go on without this program.
    pub fn release(mut self) {
        // A watcher that is gone needs no word.
        let _ = self.0.write_all(b"\n");
    }
}

/// A command for the program at `path` that ends with the other end of a tie.
pub fn tied(path: &Path, theirs: PipeReader) -> Command {
    if cfg!(not(unix)) {
        return Command::new(path);
    }
    let mut command = Command::new("/bin/sh");
    command.args(["-c", SCRIPT, "sh"]).arg(path).stdin(theirs);
    command
}
