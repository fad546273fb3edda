//! A run that was started for somebody else, who holds the other end of its standard input.

use super::error::RunError;
use super::result_dir::ResultDir;
use super::signals::Signal;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::path::Path;
use std::time::{Duration, Instant};

/// How long the rest of a study that was killed may hold the folder of a case.
pub const LINGER: Duration = Duration::from_secs(20);

/// The folder that was made ready for this run, cleared. Whoever runs a study after one that was killed may come upon runs of
/// that one which have barely started. They must leave the folder to it as it is, and it must wait until they have looked.
///
/// # Errors
/// [`RunError::Interrupted`] if whoever started this run has ended; [`RunError::Busy`] if another run goes on in the folder
/// for [`LINGER`]; the errors of [`ResultDir::create`].
pub async fn handed_over(path: &Path) -> Result<ResultDir, RunError> {
    let deadline = Instant::now() + LINGER;
    loop {
        let opened = ResultDir::open(path);
        if other_end_is_closed() {
            return Err(RunError::Interrupted(Signal::Terminate));
        }
        match opened {
            Err(RunError::Busy { .. }) if Instant::now() < deadline => {
                tokio::time::sleep(Duration::from_millis(50)).await
            }
            opened => return opened?.cleared(true),
        }
    }
}

/// True if nobody can write to standard input any more.
fn other_end_is_closed() -> bool {
    let stdin = std::io::stdin();
    let mut polled = [PollFd::new(&stdin, PollFlags::IN)];
    let now = Timespec { tv_sec: 0, tv_nsec: 0 };
    poll(&mut polled, Some(&now)).is_ok_and(|ready| ready > 0) && polled[0].revents().contains(PollFlags::HUP)
}
