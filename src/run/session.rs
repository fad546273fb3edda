//! A run, step by step: SUMO is started or joined, stepped, and left; the files of the result are written meanwhile.
//!
//! Nothing here waits for signals, prints, or makes threads. The fleet uses the pool of rayon that the caller is in.

use super::error::RunError;
use super::host::{Host, Reached};
use super::options::SessionOptions;
use super::profile::Profiler;
use super::recorder::{Recorder, trace_row};
use super::remote::Times;
use super::result::{ResultWriter, RunResult};
use super::result_dir::ResultDir;
use super::rows::TraceRow;
use super::setup;
use super::signals::Signal;
use crate::cosim::{FULL_COLOUR_MPS, OrderError, Sumo, World};
use crate::reference::Target;
use crate::scenario::{Group, Scenario};
use crate::stats::VehicleStats;
use crate::sumo_files::SIGNALS;
use std::collections::BTreeSet;

/// A configuration without an end runs this long if nobody ever arrives \[s\].
const ENDLESS_S: f64 = 3600.0;

/// Why a run is over.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    /// Its end has come.
    Time,
    /// There is no end, and no vehicle is on the road or still to come after those that were.
    Empty,
    /// There is no end, and nobody has arrived in [`ENDLESS_S`].
    Endless,
}

/// A run under way. After an error of [`Session::step`] or [`Session::finish`] the folder holds what was computed until
/// then, marked incomplete. A session that is dropped without [`Session::finish`] leaves a folder like that of a killed
/// program: its tables have the suffix `.part`.
pub struct Session {
    world: World,
    host: Host,
    result: ResultWriter,
    profiler: Profiler,
    begin_s: f64,
    end_s: Option<f64>,
}

impl Session {
    /// Starts or joins SUMO, and opens the files of the result. Must be called inside a tokio runtime.
    ///
    /// # Errors
    /// [`RunError`] if the folder holds a finished result, a file cannot be read or made, or SUMO cannot be started.
    pub async fn open(scenario: &Scenario, options: &SessionOptions) -> Result<Self, RunError> {
        let dir = ResultDir::create(&options.out_dir, options.force)?;
        Self::open_unless(scenario, dir, options, std::future::pending()).await
    }

    /// The same in a folder that is ready, but gives up at a signal that comes before SUMO has loaded.
    pub(super) async fn open_unless(
        scenario: &Scenario,
        dir: ResultDir,
        options: &SessionOptions,
        stopped: impl Future<Output = Signal>,
    ) -> Result<Self, RunError> {
        let mut result = ResultWriter::create(scenario, dir)?;
        let mut host = Host::default();
        let prepared = async {
            let reached = host.reach(options, &mut result).await?;
            prepare(reached, &mut result).await
        };
        let prepared = tokio::select! {
            prepared = prepared => prepared,
            signal = stopped => Err(RunError::Interrupted(signal)),
        };
        match prepared {
            Ok((world, end_s)) => {
                let begin_s = world.time_s();
                let mut session =
                    Self { world, host, result, profiler: Profiler::new(options.profile), begin_s, end_s };
                session.profiler.begin(&mut session.world);
                Ok(session)
            }
            Err(error) => Err(result.give_up(host.explain(error).await)),
        }
    }

    /// Makes one SUMO step, and writes it down.
    ///
    /// # Errors
    /// [`RunError::Broken`] if SUMO or the disk fails; [`RunError::Ended`] after that.
    pub async fn step(&mut self) -> Result<(), RunError> {
        let Some(recorder) = &mut self.result.recorder else { return Err(RunError::Ended) };
        match step(&mut self.world, (recorder, &self.result.scenario), &mut self.profiler).await {
            Ok(()) => Ok(()),
            Err(error) => {
                let error = self.host.explain(error).await;
                Err(self.break_off(error))
            }
        }
    }

    /// True once the end of the scenario or of SUMO's configuration has come, or nothing is left to wait for.
    pub fn is_over(&self) -> bool {
        self.end().is_some()
    }

    fn end(&self) -> Option<End> {
        let (time_s, driven_s) = (self.time_s(), self.time_s() - self.begin_s);
        if self.end_s.is_some_and(|end_s| time_s > end_s - 0.5 * self.world.step_s()) {
            return Some(End::Time);
        }
        // SUMO counts vehicles that are on the road or still to come. Calibrators and other clients bring more of them.
        let departed = self.world.records().counters.departed > 0;
        if self.end_s.is_none() && self.world.expected() == 0 && departed {
            return Some(End::Empty);
        }
        let endless = self.end_s.is_none() && self.world.records().counters.arrived == 0 && driven_s >= ENDLESS_S;
        endless.then_some(End::Endless)
    }

    /// Hands all vehicles back, leaves SUMO, and writes the result. Before the end of the run it is marked incomplete.
    ///
    /// # Errors
    /// [`RunError::Broken`] if SUMO or the disk fails; [`RunError::Ended`] if that has happened before.
    pub async fn finish(self) -> Result<RunResult, RunError> {
        match self.end() {
            Some(_) => self.close(None, std::future::pending()).await,
            None => {
                let reason = format!("stopped at {} s, before its end", self.time_s());
                self.close(Some(reason), std::future::pending()).await
            }
        }
    }

    /// As [`Session::finish`], with the reason if the result is incomplete. Gives up on a SUMO that does not answer at a
    /// signal.
    pub(super) async fn close(
        mut self,
        incomplete: Option<String>,
        stopped: impl Future<Output = Signal>,
    ) -> Result<RunResult, RunError> {
        if self.result.recorder.is_none() {
            return Err(RunError::Ended);
        }
        if incomplete.is_none() && self.end() == Some(End::Endless) {
            self.result.notes.push(format!(
                "the configuration has no end and no vehicle has arrived in {ENDLESS_S} s: stopped here; --end sets another end"
            ));
        }
        let profile = self.profiler.profile(&self.world);
        self.result.notes.extend(self.world.orders().notes());
        let mut stopped = std::pin::pin!(stopped);
        let handed_back = tokio::select! {
            done = self.world.hand_back() => done.map_err(RunError::from),
            signal = &mut stopped => return Err(self.break_off(RunError::Interrupted(signal))),
        };
        if let Err(error) = handed_back {
            let error = self.host.explain(error).await;
            return Err(self.break_off(error));
        }
        let Self { world, host, mut result, begin_s, .. } = self;
        let time_s = world.time_s();
        let (records, left) = world.close().await;
        let ended = tokio::select! {
            ended = host.leave(&mut result) => ended,
            // Whoever has asked for the end before gets SUMO's outputs with it.
            signal = stopped, if incomplete.is_none() => Err(RunError::Interrupted(signal)),
        };
        match left.map_err(RunError::from).and(ended) {
            Ok(()) => Ok(RunResult { profile, ..result.write(records, [begin_s, time_s], incomplete)? }),
            Err(source) => Err(result.break_off(records, [begin_s, time_s], source)),
        }
    }

    /// Leaves SUMO as it is, and writes what was computed until `error` happened.
    pub(super) fn break_off(&mut self, error: RunError) -> RunError {
        self.result.sumo_has_ended = self.host.abandon();
        let new = self.world.orders().notes().into_iter().filter(|note| !self.result.notes.contains(note));
        self.result.notes.extend(new.collect::<Vec<_>>());
        let times_s = [self.begin_s, self.world.time_s()];
        self.result.break_off(self.world.abandon(), times_s, error)
    }

    /// Simulation time at the end of the last step \[s\].
    pub fn time_s(&self) -> f64 {
        self.world.time_s()
    }

    /// When the run ends \[s\]; `None` if only the traffic decides.
    pub fn end_s(&self) -> Option<f64> {
        self.end_s
    }

    /// How far the run is.
    pub fn times(&self) -> Times {
        Times { begin_s: self.begin_s, now_s: self.time_s(), end_s: self.end_s }
    }

    /// The egos on the road at the end of the last step: id, target, reference, speed, torque, distance, ... Their places
    /// are empty: SUMO has to be asked for them.
    pub fn egos(&self) -> impl Iterator<Item = TraceRow> {
        let time_s = self.world.time_s();
        self.world.driving().map(move |(ego, block)| trace_row(ego, &block.snapshot(ego.slot.lane()), time_s, None))
    }

    /// From the next step on the ego is to drive at this speed [m/s] in place of its target; `None` = at its target again. Where
    /// SUMO leads (the target `traffic`), it drives there as it drives to any speed: with the vType's accelerations, and never too
    /// fast for who is ahead, a light or the lane. Where the body leads, the speed is the reference at once, and SUMO clamps it as it
    /// clamps all targets. The result notes whose references were set.
    ///
    /// # Errors
    /// [`OrderError`] if the vehicle is no ego on the road, or the speed is none. Nothing has changed then.
    pub fn set_reference(&mut self, id: &str, speed_mps: Option<f64>) -> Result<(), OrderError> {
        self.world.hand().reference(id, speed_mps)
    }

    /// From the next step on this torque acts on the wheels of the ego beside that of the actuators, until another is set; sum over
    /// the wheels, positive drives, 0 = none [N·m]. The law does not learn of it, and columns of torques do not have it. An ego that
    /// is held at rest stays there. The result notes whose torques were disturbed.
    ///
    /// # Errors
    /// [`OrderError`] if the vehicle is no ego on the road or has no body, or the torque is none. Nothing has changed then.
    pub fn set_torque_disturbance(&mut self, id: &str, torque_nm: f64) -> Result<(), OrderError> {
        self.world.hand().disturbance(id, torque_nm)
    }

    /// From the next step on the ego is as it would be if it had departed with `<param key="{name}" value="{value}"/>`, a `mfc.*`
    /// parameter of its body or its actuators; `None` takes that back. Its law does not learn of it. The result notes whose
    /// parameters were set.
    ///
    /// # Errors
    /// [`OrderError`] if the vehicle is no ego on the road or has no body, the parameter is unknown or one that cannot change on the
    /// way (what wheels and axles are), or the value is not what it takes. Nothing has changed then.
    pub fn set_parameter(&mut self, id: &str, name: &str, value: Option<&str>) -> Result<(), OrderError> {
        self.world.hand().parameter(id, name, value)
    }

    /// The statistics of an ego on the road so far.
    pub fn statistics(&self, id: &str) -> Option<VehicleStats> {
        self.world.driving().find(|(ego, _)| **ego.id() == *id).map(|(ego, block)| block.stats(ego.slot.lane()))
    }

    /// The process of the SUMO that was started for the session.
    #[cfg(target_os = "linux")]
    pub(super) fn sumo_id(&self) -> Option<u32> {
        if let Host::Process(process) = &self.host { process.id() } else { None }
    }

    /// Fleet and SUMO behind the session.
    pub fn world(&self) -> &World {
        &self.world
    }
}

/// One SUMO step, written down.
async fn step(
    world: &mut World,
    (recorder, scenario): (&mut Recorder, &Scenario),
    profiler: &mut Profiler,
) -> Result<(), RunError> {
    profiler.start();
    world.step().await?;
    profiler.stepped(world);
    recorder.step(world, scenario).await?;
    profiler.written();
    Ok(())
}

/// Joins SUMO with the fleet, asks for the end, and opens the files.
async fn prepare((link, version): Reached, result: &mut ResultWriter) -> Result<(World, Option<f64>), RunError> {
    (result.manifest.sumo_version, result.manifest.sumo_api) = (Some(version.text), Some(version.api));
    let setup = setup::world(&result.scenario)?;
    let noted: BTreeSet<&str> = setup.targets.iter().filter_map(Target::note).collect();
    result.notes.extend(noted.into_iter().map(str::to_owned));
    if setup.display.colours {
        result.notes.push(format!(
            "egos are coloured by |true speed − reference|: from blue at 0 to yellow at {FULL_COLOUR_MPS} m/s and more"
        ));
    }
    let mut world = World::over(link, setup).await?;
    let end_s = match result.scenario.sumo.end_s {
        Some(end_s) => Some(end_s),
        None => Some(world.sumo_mut().end_s().await?).filter(|end_s| *end_s >= 0.0),
    };
    if let Some(address) = &result.scenario.sumo.connect {
        let bodies = result.scenario.groups.iter().any(Group::has_body);
        result.notes.extend(of_joined(&mut world, address, [bodies, result.scenario.sumo.fcd]).await?);
    }
    result.recorder = Some(Recorder::open(&result.scenario, &result.dir, &world)?);
    Ok((world, end_s))
}

/// What a SUMO that somebody else has started does in another way than one of ours.
async fn of_joined(world: &mut World, address: &str, [bodies, fcd]: [bool; 2]) -> Result<Vec<String>, RunError> {
    let mut notes = Vec::new();
    if world.sumo_mut().option("step-method.ballistic").await?.as_deref() == Some("false") {
        notes.push(format!(
            "the SUMO at {address} makes Euler's steps: its vehicles cover v·dt, bodies the mean of old and new speed (start it \
             with --step-method.ballistic)"
        ));
    }
    let factor =
        world.sumo_mut().option("collision.mingap-factor").await?.and_then(|factor| factor.parse::<f64>().ok());
    if bodies && factor.is_some_and(|factor| factor != 0.0) {
        notes.push(format!(
            "the SUMO at {address} counts gaps below minGap as collisions (start it with --collision.mingap-factor 0)"
        ));
    }
    if world.sumo_mut().option("fcd-output.params").await?.is_none_or(|params| !params.contains(SIGNALS[0])) && fcd {
        notes.push(format!(
            "the SUMO at {address} writes none of our signals (start it with --fcd-output FILE --fcd-output.params {})",
            SIGNALS.join(",")
        ));
    }
    Ok(notes)
}
