//! What strikes, and when: drawn from a seed.

use sumo_mfc::random::Stream;

/// Where a run is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// There is no SUMO yet.
    Starting,
    /// SUMO loads, and is connected to.
    Loading,
    /// Steps are made.
    Stepping,
    /// SUMO has ended; tables and the page are written.
    Writing,
    /// The fault came too late.
    #[default]
    Ended,
}

impl Phase {
    pub const ALL: [Self; 5] = [Self::Starting, Self::Loading, Self::Stepping, Self::Writing, Self::Ended];
}

/// What strikes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Our process gets this signal.
    Ours(&'static str),
    /// SUMO gets it.
    Sumos(&'static str),
    /// The connection ends.
    Cut,
    /// Answers come late and in pieces.
    Slow,
    /// Nothing comes any more.
    Silent,
    /// An answer has a wrong byte.
    Garbled,
    /// The disk is full.
    Disk,
    /// The folder of the result is deleted.
    Folder,
    /// The parent of a study gets a signal.
    Sweep,
    /// A task of Slurm is killed.
    Slurm,
}

impl Kind {
    /// All of them, with how often they come.
    pub const ALL: [(Self, usize); 15] = [
        (Self::Ours("KILL"), 60),
        (Self::Ours("TERM"), 24),
        (Self::Ours("INT"), 24),
        (Self::Ours("HUP"), 24),
        (Self::Ours("QUIT"), 24),
        (Self::Sumos("KILL"), 40),
        (Self::Sumos("STOP"), 16),
        (Self::Cut, 20),
        (Self::Slow, 10),
        (Self::Silent, 6),
        (Self::Garbled, 24),
        (Self::Disk, 16),
        (Self::Folder, 16),
        (Self::Sweep, 16),
        (Self::Slurm, 0),
    ];

    pub fn place(self) -> usize {
        Self::ALL.iter().position(|(kind, _)| *kind == self).expect("it is one of all")
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Ours("KILL") => "our process: KILL",
            Self::Ours("TERM") => "our process: TERM",
            Self::Ours("INT") => "our process: INT",
            Self::Ours("HUP") => "our process: HUP",
            Self::Ours(_) => "our process: QUIT",
            Self::Sumos("KILL") => "SUMO: KILL",
            Self::Sumos(_) => "SUMO: STOP",
            Self::Cut => "socket cut",
            Self::Slow => "socket slow",
            Self::Silent => "socket silent",
            Self::Garbled => "socket garbled",
            Self::Disk => "disk full",
            Self::Folder => "folder deleted",
            Self::Sweep => "a study's parent: any",
            Self::Slurm => "a task of Slurm: KILL",
        }
    }

    /// Whether it needs a SUMO of our own, with which the program is joined through a proxy.
    pub fn on_the_wire(self) -> bool {
        matches!(self, Self::Cut | Self::Slow | Self::Silent | Self::Garbled)
    }
}

/// One fault.
#[derive(Debug, Clone)]
pub struct Plan {
    pub kind: Kind,
    /// The phase in which it strikes.
    pub phase: Phase,
    /// How late in the phase, as a share of its length.
    pub at: f64,
    /// Whether the program joins a SUMO that it has not started.
    pub joined: bool,
    /// For whatever else is to be drawn, in [0, 1).
    pub more: [f64; 2],
}

/// All faults of a seed: every kind once, the rest as often as [`Kind::ALL`] says, in a random order.
pub fn plans(seed: u64, count: usize) -> Vec<Plan> {
    let mut stream = Stream::new(seed, "chaos", "plans");
    let mut draw = move || stream.uniform();
    let kinds: Vec<_> = Kind::ALL.iter().filter(|(_, often)| *often > 0).collect();
    let all: usize = kinds.iter().map(|(_, often)| often).sum();
    let mut times: Vec<usize> =
        kinds.iter().map(|(_, often)| (count.saturating_sub(kinds.len()) * often / all) + 1).collect();
    let missing = count.saturating_sub(times.iter().sum());
    times[0] += missing;
    let mut faults: Vec<Kind> =
        kinds.iter().zip(times).flat_map(|((kind, _), times)| std::iter::repeat_n(*kind, times)).collect();
    for last in (1..faults.len()).rev() {
        faults.swap(last, (draw() * (last + 1) as f64) as usize);
    }
    let plan = |kind: Kind| {
        let phase = match draw() {
            p if p < 0.1 => Phase::Starting,
            p if p < 0.25 => Phase::Loading,
            p if p < 0.75 => Phase::Stepping,
            _ => Phase::Writing,
        };
        let joined = kind.on_the_wire() || matches!(kind, Kind::Ours(_)) && draw() < 0.3;
        Plan { kind, phase, at: draw(), joined, more: [draw(), draw()] }
    };
    faults.into_iter().map(plan).collect()
}

/// How many tasks of Slurm are killed.
pub fn at_slurm(count: usize) -> usize {
    count / 80
}
