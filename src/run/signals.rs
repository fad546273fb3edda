//! Signals that end a run.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};

/// How long a step that is under way may take after a signal; SUMO may be waiting for another client.
const LAST_STEP: Duration = Duration::from_secs(3);

/// SIGXFSZ.
const FILE_TOO_LARGE: i32 = 25;

/// A signal that ended a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Ctrl-C.
    Interrupt,
    /// SIGTERM.
    Terminate,
    /// SIGHUP: the terminal is gone.
    Hangup,
    /// SIGQUIT.
    Quit,
}

impl Signal {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Interrupt, Self::Terminate, Self::Hangup, Self::Quit];

    /// The exit code of the program: 128 + the signal's number.
    pub fn exit_code(self) -> u8 {
        128 + self.number()
    }

    fn number(self) -> u8 {
        match self {
            Self::Hangup => 1,
            Self::Interrupt => 2,
            Self::Quit => 3,
            Self::Terminate => 15,
        }
    }

    /// Whether whoever started us wants SIGHUP ignored, as `nohup` does: listening would undo that. (Scripts start all that
    /// is in the background with SIGINT ignored; who sends that to us nevertheless means it.)
    fn is_ignored(self) -> bool {
        if self != Self::Hangup {
            return false;
        }
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let ignored =
            status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
        ignored.is_some_and(|ignored| ignored >> (self.number() - 1) & 1 == 1)
    }
}

/// The first signal that comes.
pub(crate) struct Signals(Arc<AtomicU8>);

impl Signals {
    /// Listens from now on. If `tied`, the end of standard input counts as SIGTERM: whoever holds its other end has ended,
    /// or wants this run to.
    pub fn watch(tied: bool) -> std::io::Result<Self> {
        let raised = Arc::new(AtomicU8::new(0));
        for awaited in Signal::ALL.into_iter().filter(|awaited| !awaited.is_ignored()) {
            let mut signals = signal(SignalKind::from_raw(awaited.number().into()))?;
            let note = raised.clone();
            tokio::spawn(async move {
                if signals.recv().await.is_some() {
                    // The first that comes is the one that counts.
                    let _ = note.compare_exchange(0, awaited.exit_code(), Ordering::Relaxed, Ordering::Relaxed);
                }
            });
        }
        // A file that grows beyond its limit is an error in writing it, not the end of this program.
        let _ = signal(SignalKind::from_raw(FILE_TOO_LARGE))?;
        if tied {
            let note = raised.clone();
            // A thread, because tokio's runtime waits for its own reader of standard input when it ends.
            std::thread::spawn(move || {
                let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
                note.store(Signal::Terminate.exit_code(), Ordering::Relaxed);
            });
        }
        Ok(Self(raised))
    }

    /// Those that somebody else notes, as exit codes.
    pub fn of(raised: Arc<AtomicU8>) -> Self {
        Self(raised)
    }

    /// The signal that has come.
    pub fn raised(&self) -> Option<Signal> {
        let code = self.0.load(Ordering::Relaxed);
        Signal::ALL.into_iter().find(|signal| signal.exit_code() == code)
    }

    /// Waits for a signal.
    pub async fn wait(&self) -> Signal {
        loop {
            match self.raised() {
                Some(signal) => return signal,
                None => tokio::time::sleep(Duration::from_millis(50)).await,
            }
        }
    }

    /// Waits for a signal, and then for as long as a step may take to end in order.
    pub async fn overdue(&self) -> Signal {
        let signal = self.wait().await;
        tokio::time::sleep(LAST_STEP).await;
        signal
    }
}
