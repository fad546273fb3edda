//! The result of a run, written into its folder: when it begins, and when it ends or breaks off.

use super::error::RunError;
use super::manifest::{Input, Manifest};
use super::outcome::{Ended, Outcome};
use super::profile::Profile;
use super::recorder::Recorder;
use super::result_dir::{ResultDir, SUMMARY, Standing};
use super::signals::Signal;
use super::summary::Summary;
use super::tally::Remarkable;
use crate::cosim::Records;
use crate::output::{OutputError, part_of};
use crate::scenario::Scenario;
use crate::sumo_files::{SumoCommand, sumo_arguments};
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::time::Instant;

/// A result, also on disk.
#[derive(Debug)]
pub struct RunResult {
    /// Its folder.
    pub dir: PathBuf,
    /// Summary of the fleet. The rows are in the tables of the folder: memory does not grow with their number.
    pub summary: Summary,
    /// Egos that are worth a word.
    pub remarkable: Remarkable,
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

/// Writes a result.
pub(super) struct ResultWriter {
    /// What is run.
    pub scenario: Scenario,
    /// The folder.
    pub dir: ResultDir,
    /// Its `run.json`.
    pub manifest: Manifest,
    /// The files that are written while the run goes on; none before SUMO was joined, and after the result was written.
    pub recorder: Option<Recorder>,
    /// What the user should be told.
    pub notes: Vec<String>,
    /// True once the SUMO that was started here has ended, and its outputs are there to be read.
    pub sumo_has_ended: bool,
    command: SumoCommand,
    started: Instant,
    /// The folders of the result.
    folders: [Standing; 2],
}

impl ResultWriter {
    /// Notes in its folder what is run.
    pub fn create(scenario: &Scenario, dir: ResultDir) -> Result<Self, RunError> {
        let folders = [Standing::of(dir.path())?, Standing::of(&dir.sumo()?)?];
        let command = sumo_arguments(&scenario.sumo, dir.path())?;
        let inputs = scenario.inputs.iter().map(|path| Input::of(path)).collect::<Result<_, _>>()?;
        let mut manifest = Manifest::new(scenario.sumo.seed, scenario.to_toml(), inputs);
        manifest.notes = scenario.notes.clone();
        dir.write_manifest(&manifest)?;
        let (scenario, started) = (scenario.clone(), Instant::now());
        let (recorder, notes) = (None, Vec::new());
        Ok(Self { scenario, dir, manifest, command, recorder, notes, sumo_has_ended: false, started, folders })
    }

    /// The arguments for SUMO, noted in the manifest with its path.
    pub fn sumo_command(&mut self, binary: &Path) -> Result<Vec<String>, OutputError> {
        let words = [binary.display().to_string()].into_iter().chain(self.command.arguments.iter().cloned());
        self.manifest.sumo_command = words.collect();
        self.dir.write_manifest(&self.manifest)?;
        Ok(self.command.arguments.clone())
    }

    /// SUMO has ended: what it has written can be read.
    ///
    /// # Errors
    /// [`RunError::SumoFailed`] if it has not ended well.
    pub fn sumo_ended(&mut self, status: ExitStatus) -> Result<(), RunError> {
        self.sumo_has_ended = true;
        if status.success() { Ok(()) } else { Err(RunError::SumoFailed(status)) }
    }

    /// Nothing was computed: the manifest says why.
    pub fn give_up(mut self, error: RunError) -> RunError {
        // The error itself matters more than one in writing it down.
        let _ = self.dir.finish(&mut self.manifest, Some(error.to_string()));
        error
    }

    /// Writes what was computed until `source` happened, and says so.
    pub fn break_off(&mut self, records: Records, times_s: [f64; 2], source: RunError) -> RunError {
        let written = self.write(records, times_s, Some(source.to_string()));
        if let (RunError::Interrupted(_), Ok(_)) = (&source, &written) {
            return source;
        }
        let (time_s, dir) = (times_s[1], self.dir.path().to_owned());
        // A disk that is full for one file may be full for others.
        let kept = match written {
            Ok(_) => format!("what was computed until then is in {}, marked incomplete", dir.display()),
            Err(error) => self.left(&error),
        };
        RunError::Broken { time_s, kept, source: Box::new(source) }
    }

    /// What there is after an error in writing the tables.
    fn left(&self, error: &RunError) -> String {
        let (dir, vehicles) = (self.dir.path(), self.dir.file(&self.scenario.output.vehicles));
        let tables = match (vehicles.is_file(), part_of(&vehicles).is_file()) {
            (true, _) => format!("{} has all its rows", vehicles.display()),
            (false, true) => format!(
                "the vehicles that had left by then are in {}; when there is room, sumo-mfc recover {} makes a table of them",
                part_of(&vehicles).display(),
                dir.display()
            ),
            (false, false) => "no row could be kept".to_owned(),
        };
        format!("then {error}: {tables}")
    }

    /// Writes tables, summary and manifest of a run from one time to another. If that fails, the manifest says so as
    /// long as it can be written.
    pub fn write(
        &mut self,
        records: Records,
        times_s: [f64; 2],
        incomplete: Option<String>,
    ) -> Result<RunResult, RunError> {
        let written = self.write_files(records, times_s, incomplete.clone());
        // A folder that is not there explains all else.
        let deleted = || self.deleted().filter(|_| incomplete.is_none());
        let written = match written {
            Ok(written) => deleted().map_or(Ok(written), Err),
            Err(error) => Err(deleted().unwrap_or(error)),
        };
        written.inspect_err(|error| {
            let _ = self.dir.finish(&mut self.manifest, Some(incomplete.unwrap_or_else(|| error.to_string())));
        })
    }

    /// Set if a folder of the result has been deleted. What SUMO has open goes with it.
    fn deleted(&self) -> Option<RunError> {
        self.folders.iter().find_map(Standing::deleted).map(|path| RunError::Deleted(path.to_owned()))
    }

    fn write_files(
        &mut self,
        mut records: Records,
        [begin_s, time_s]: [f64; 2],
        incomplete: Option<String>,
    ) -> Result<RunResult, RunError> {
        let mut recorder = self.recorder.take().ok_or(RunError::Ended)?;
        recorder.noted.note_rest(std::mem::take(&mut records.finished));
        let ended = Ended {
            scenario: &self.scenario,
            time_s,
            own_sumo: self.sumo_has_ended.then_some(&self.command),
            broke_off: incomplete.is_some(),
            folder: self.dir.path(),
        };
        let mut outcome = Outcome::new(&ended, &recorder.noted, records)?;
        self.notes.append(&mut outcome.notes);
        self.manifest.notes.extend(self.notes.iter().cloned());
        let times_s = [time_s - begin_s, self.started.elapsed().as_secs_f64()];
        let remarkable = outcome.tallied.remarkable.clone();
        let summary = Summary::new(std::mem::take(&mut outcome.tallied), outcome.counts, outcome.totals, times_s);
        let tables = recorder.finish(&self.dir, &outcome);
        self.dir.write(SUMMARY, &summary)?;
        tables?;
        let failed = self.deleted().or(outcome.failed);
        if let (None, Some(failed)) = (&incomplete, failed) {
            self.dir.finish(&mut self.manifest, Some(failed.to_string()))?;
            return Err(failed);
        }
        self.dir.finish(&mut self.manifest, incomplete)?;
        Ok(RunResult {
            dir: self.dir.path().to_owned(),
            summary,
            remarkable,
            files: self.manifest.files.clone(),
            notes: self.notes.clone(),
            interrupted: None,
            profile: None,
        })
    }
}
