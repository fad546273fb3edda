//! One scenario -> one result: starts SUMO, lets the world step to its end, and writes all files of the result.
//!
//! Whatever ends a run early (SUMO died, the disk is full, Ctrl-C) leaves what was computed so far, marked incomplete.

mod error;
mod manifest;
mod outcome;
mod profile;
mod progress;
mod recorder;
mod result_dir;
mod rows;
mod sampler;
mod schema;
pub mod setup;
mod signals;
mod spread;
mod summary;

use crate::cosim::{CosimError, Records, World};
use crate::scenario::Scenario;
use crate::sumo_files::{SumoCommand, sumo_arguments};
use crate::traci::{Client, SumoProcess, find_named};
use profile::Profiler;
use progress::Progress;
use recorder::Recorder;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::{Duration, Instant};

pub use error::RunError;
pub use manifest::{Input, Manifest, Status, sha256_of};
pub use profile::Profile;
pub use result_dir::ResultDir;
pub use rows::{EDGES, EdgeRow, SAMPLE, SampleRow, TRACE, TraceRow, VEHICLES, VehicleRow};
pub use schema::{FileSchema, Schema};
pub use setup::world;
pub use signals::Signal;
pub use spread::Spread;
pub use summary::{Summary, SumoTotals, terminal_text};

/// How long SUMO may take to load, and to answer one message.
const PATIENCE: Duration = Duration::from_secs(600);
/// How long SUMO may take to complete its outputs.
const LAST_OUTPUTS: Duration = Duration::from_secs(120);
/// How long to look for a SUMO that is said to run already.
const REACH: Duration = Duration::from_secs(10);
/// How long a step that is under way may take after a signal; SUMO may be waiting for another client.
const LAST_STEP: Duration = Duration::from_secs(3);
/// A configuration without an end runs this long if nobody ever arrives \[s\].
const ENDLESS_S: f64 = 3600.0;

/// How a run is carried out; nothing here changes its result.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Folder of the result.
    pub out_dir: PathBuf,
    /// Replace a finished result.
    pub force: bool,
    /// Threads for the fleet; `None` = all cores.
    pub threads: Option<usize>,
    /// Show a progress bar.
    pub progress: bool,
    /// Measure where the time of a step goes.
    pub profile: bool,
}

/// A result, also on disk.
#[derive(Debug)]
pub struct RunResult {
    /// Its folder.
    pub dir: PathBuf,
    /// One row per ego that departed.
    pub rows: Vec<VehicleRow>,
    /// Summary of the fleet.
    pub summary: Summary,
    /// Files written, relative to the folder.
    pub files: Vec<String>,
    /// What the user should be told.
    pub notes: Vec<String>,
    /// Set if a signal ended the run early.
    pub interrupted: Option<Signal>,
    /// Where the time of a step went, if that was asked for.
    pub profile: Option<Profile>,
}

impl RunResult {
    /// The summary of a run that reached its end.
    ///
    /// # Errors
    /// [`RunError::Interrupted`] if a signal ended it early.
    pub fn whole(self) -> Result<Summary, RunError> {
        match self.interrupted {
            Some(signal) => Err(RunError::Interrupted(signal)),
            None => Ok(self.summary),
        }
    }
}

/// Runs a scenario to its end.
///
/// # Errors
/// [`RunError`]; if SUMO or the disk fails on the way, [`RunError::Broken`] with what was computed left in the folder.
pub fn run(scenario: &Scenario, options: &RunOptions) -> Result<RunResult, RunError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.unwrap_or(0))
        .build()
        .map_err(|e| RunError::System(e.to_string()))?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|e| RunError::System(e.to_string()))?;
    let dir = ResultDir::create(&options.out_dir, options.force)?;
    pool.install(|| runtime.block_on(Run::new(scenario, options, dir)?.carry_out()))
}

/// A run under way.
struct Run<'a> {
    scenario: &'a Scenario,
    options: &'a RunOptions,
    dir: ResultDir,
    manifest: Manifest,
    command: SumoCommand,
    notes: Vec<String>,
    signal: Arc<AtomicU8>,
    begin_s: f64,
    started: Instant,
    profiler: Profiler,
    profile: Option<Profile>,
}

impl<'a> Run<'a> {
    fn new(scenario: &'a Scenario, options: &'a RunOptions, dir: ResultDir) -> Result<Self, RunError> {
        dir.sumo()?;
        let command = sumo_arguments(&scenario.sumo, dir.path())?;
        let inputs = scenario.inputs.iter().map(|path| Input::of(path)).collect::<Result<_, _>>()?;
        let mut manifest = Manifest::new(scenario.sumo.seed, scenario.to_toml(), inputs);
        manifest.notes = scenario.notes.clone();
        dir.write_manifest(&manifest)?;
        let notes = Vec::new();
        let signal = Arc::new(AtomicU8::new(0));
        Ok(Self {
            scenario,
            options,
            dir,
            manifest,
            command,
            notes,
            signal,
            begin_s: 0.0,
            started: Instant::now(),
            profiler: Profiler::new(options.profile),
            profile: None,
        })
    }

    async fn carry_out(mut self) -> Result<RunResult, RunError> {
        watch_signals(self.signal.clone()).map_err(|e| RunError::System(e.to_string()))?;
        let (mut process, client) = match self.reach_sumo().await {
            Ok(reached) => reached,
            Err(error) => return Err(self.give_up(error)),
        };
        match self.prepare(client).await {
            Ok((world, writers)) => self.drive(world, writers, process).await,
            Err(error) => {
                let error = explain(error, &mut process).await;
                Err(self.give_up(error))
            }
        }
    }

    /// Starts SUMO, or joins one that runs.
    async fn reach_sumo(&mut self) -> Result<(Option<SumoProcess>, Client), RunError> {
        let sumo = &self.scenario.sumo;
        if let Some(address) = &sumo.connect {
            let mut client = Client::join(address.clone(), REACH, PATIENCE).await?;
            client.set_order(1).await?;
            return Ok((None, client));
        }
        let binary = find_named(None, if sumo.gui { "sumo-gui" } else { "sumo" })?;
        let mut line = vec![binary.path.display().to_string()];
        line.extend(self.command.arguments.iter().cloned());
        self.manifest.sumo_command = line;
        self.dir.write_manifest(&self.manifest)?;
        let mut process = SumoProcess::spawn(&binary, &self.command.arguments, sumo.port, &self.dir.sumo()?)?;
        let signal = self.signal.clone();
        let mut client = tokio::select! {
            client = process.connect(PATIENCE) => client?,
            () = raised(&signal) => return Err(RunError::Interrupted(self.signal().unwrap_or(Signal::Interrupt))),
        };
        if sumo.num_clients > 1 {
            client.set_order(1).await?;
        }
        Ok((Some(process), client))
    }

    /// Joins SUMO and opens the files.
    async fn prepare(&mut self, client: Client) -> Result<(World, Recorder), RunError> {
        self.manifest.sumo_version = Some(client.version().text.clone());
        self.manifest.sumo_api = Some(client.version().api);
        let world = World::join(client, setup::world(self.scenario)?).await?;
        self.begin_s = world.time_s();
        let writers = Recorder::open(self.scenario, &self.dir, &world)?;
        Ok((world, writers))
    }

    /// Steps to the end, hands the vehicles back and writes the result; on an error as it is, marked incomplete.
    async fn drive(
        &mut self,
        mut world: World,
        mut writers: Recorder,
        mut process: Option<SumoProcess>,
    ) -> Result<RunResult, RunError> {
        let stepped = self.step_to_end(&mut world, &mut writers).await;
        self.profile = self.profiler.profile(&world);
        let closed = match stepped {
            Ok(()) => world.hand_back().await.map_err(RunError::from),
            Err(error) => Err(error),
        };
        match closed {
            Ok(()) => {
                let time_s = world.time_s();
                let (records, left) = world.close().await;
                let ended = match process {
                    Some(process) => process.shut_down(LAST_OUTPUTS).await.map(drop),
                    None => Ok(()),
                };
                match left.map_err(RunError::from).and(ended.map_err(RunError::from)) {
                    Ok(()) => self.write(records, time_s, writers, None),
                    Err(source) => self.break_off(records, time_s, writers, source),
                }
            }
            Err(error) => {
                let source = explain(error, &mut process).await;
                let time_s = world.time_s();
                self.break_off(world.into_records(), time_s, writers, source)
            }
        }
    }

    /// Writes what was computed until `source` happened.
    fn break_off(
        &mut self,
        records: Records,
        time_s: f64,
        writers: Recorder,
        source: RunError,
    ) -> Result<RunResult, RunError> {
        let dir = self.dir.path().to_owned();
        // A disk that is full for one file may be full for others; the first error is the one to tell.
        let _ = self.write(records, time_s, writers, Some(source.to_string()));
        if let RunError::Interrupted(_) = source {
            return Err(source);
        }
        Err(RunError::Broken { time_s, dir, source: Box::new(source) })
    }

    async fn step_to_end(&mut self, world: &mut World, writers: &mut Recorder) -> Result<(), RunError> {
        let end_s = match self.scenario.sumo.end_s {
            Some(end_s) => Some(end_s),
            None => Some(world.end_s().await?).filter(|end_s| *end_s >= 0.0),
        };
        let progress = Progress::new(self.options.progress, self.begin_s, end_s);
        self.profiler.begin(world);
        let stepped = self.step_to(world, writers, end_s, &progress).await;
        progress.close();
        stepped
    }

    async fn step_to(
        &mut self,
        world: &mut World,
        writers: &mut Recorder,
        end_s: Option<f64>,
        progress: &Progress,
    ) -> Result<(), RunError> {
        let half_step_s = 0.5 * world.step_s();
        let signal = self.signal.clone();
        loop {
            let time_s = world.time_s();
            if self.signal.load(Ordering::Relaxed) != 0 || end_s.is_some_and(|end_s| time_s > end_s - half_step_s) {
                return Ok(());
            }
            // SUMO counts vehicles that are on the road or still to come; with none left there is nothing to wait for.
            if world.expected() == 0 && (end_s.is_none() || time_s > self.begin_s) {
                return Ok(());
            }
            if end_s.is_none() && world.records().counters.arrived == 0 && time_s - self.begin_s >= ENDLESS_S {
                self.notes.push(format!(
                    "the configuration has no end and no vehicle has arrived in {ENDLESS_S} s: stopped here; --end sets another end"
                ));
                return Ok(());
            }
            tokio::select! {
                stepped = world.step() => stepped?,
                () = overdue(&signal) => return Err(RunError::Interrupted(self.signal().unwrap_or(Signal::Interrupt))),
            }
            self.profiler.stepped(world);
            writers.step(world)?;
            progress.show(world);
            self.profiler.written();
        }
    }

    fn signal(&self) -> Option<Signal> {
        match self.signal.load(Ordering::Relaxed) {
            0 => None,
            2 => Some(Signal::Interrupt),
            _ => Some(Signal::Terminate),
        }
    }

    /// Writes the result: tables, summary, manifest. If that fails, the manifest says so as long as it can be written.
    fn write(
        &mut self,
        records: Records,
        time_s: f64,
        writers: Recorder,
        broken: Option<String>,
    ) -> Result<RunResult, RunError> {
        self.write_files(records, time_s, writers, broken.clone()).inspect_err(|error| {
            let _ = self.dir.finish(&mut self.manifest, Some(broken.unwrap_or_else(|| error.to_string())));
        })
    }

    fn write_files(
        &mut self,
        records: Records,
        time_s: f64,
        writers: Recorder,
        broken: Option<String>,
    ) -> Result<RunResult, RunError> {
        let interrupted = self.signal();
        let reason = broken.or(interrupted.map(|s| format!("ended by a signal ({s:?})")));
        self.notes.extend(outcome::notes(&records.counters));
        self.manifest.notes.extend(self.notes.iter().cloned());
        let simulated_s = time_s - self.begin_s;
        let own_sumo = self.scenario.sumo.connect.is_none().then_some(&self.command);
        let mut outcome = outcome::Outcome::new(self.scenario, records, time_s, own_sumo, reason.is_some())?;
        let wall_s = self.started.elapsed().as_secs_f64();
        let summary = outcome.summary(simulated_s, wall_s);
        let tables = writers.finish(&self.dir, self.scenario, &mut outcome);
        self.dir.write_summary(&summary)?;
        tables?;
        self.dir.finish(&mut self.manifest, reason)?;
        Ok(RunResult {
            dir: self.dir.path().to_owned(),
            rows: outcome.rows,
            summary,
            files: self.manifest.files.clone(),
            notes: self.notes.clone(),
            interrupted,
            profile: self.profile,
        })
    }

    /// Nothing was computed: the manifest says why.
    fn give_up(&mut self, error: RunError) -> RunError {
        // The error itself matters more than one in writing it down.
        let _ = self.dir.finish(&mut self.manifest, Some(error.to_string()));
        error
    }
}

/// Notes the first SIGINT or SIGTERM by its number.
fn watch_signals(raised: Arc<AtomicU8>) -> std::io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    tokio::spawn(async move {
        let number = tokio::select! {
            _ = interrupt.recv() => 2,
            _ = terminate.recv() => 15,
        };
        raised.store(number, Ordering::Relaxed);
    });
    Ok(())
}

/// More of an error of the connection: what SUMO said last, if it is ours and has ended.
async fn explain(error: RunError, process: &mut Option<SumoProcess>) -> RunError {
    match (error, process) {
        (RunError::Cosim(CosimError::Traci(error)), Some(process)) => process.explain(error).await.into(),
        (error, _) => error,
    }
}

/// Waits for a signal and then for as long as a step may take to end in order.
async fn overdue(signal: &AtomicU8) {
    raised(signal).await;
    tokio::time::sleep(LAST_STEP).await;
}

/// Waits for a signal.
async fn raised(signal: &AtomicU8) {
    while signal.load(Ordering::Relaxed) == 0 {
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}
