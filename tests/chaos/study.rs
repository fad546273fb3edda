//! Studies whose processes are killed: the same command comes to the same bytes.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::STUDY;
use super::cluster::Cluster;
use super::end::{left, send};
use super::judge::Verdict;
use super::plan::{Phase, Plan};
use super::strike::end;
use super::support::{NEW, Running, naming, program, repository};

/// The tables of a study.
type Tables = BTreeMap<&'static str, Option<Vec<u8>>>;

/// A study, undisturbed.
pub struct Studies {
    wanted: Tables,
    took: Duration,
}

fn command(dir: &Path) -> Command {
    let mut command = program(NEW);
    command.current_dir(repository("")).args(STUDY).args(["-j", "2", "-o"]).arg(dir);
    command
}

fn tables(dir: &Path) -> Tables {
    let names = ["cases.csv", "comparison.csv", "vehicles.parquet", "study.json", "schema.json"];
    names.map(|name| (name, fs::read(dir.join(name)).ok())).into()
}

impl Studies {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let begun = Instant::now();
        let ended = Running::start(command(folder.path())).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let wanted = tables(folder.path());
        assert!(wanted.values().all(Option::is_some));
        Self { wanted, took: begun.elapsed() }
    }

    /// Kills the parent of a study, and types the same command again.
    pub fn struck(&self, plan: &Plan) -> Verdict {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("study");
        let mut verdict = Verdict { phase: Phase::Stepping, ..Verdict::default() };
        let mut run = Running::start(command(&dir));
        let until = Instant::now() + self.took.mul_f64(plan.at);
        while Instant::now() < until && run.child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        if run.child.try_wait().unwrap().is_some() {
            verdict.phase = Phase::Ended;
        }
        let signal = ["KILL", "KILL", "TERM", "INT"][(plan.more[0] * 4.0) as usize];
        send(signal, run.child.id());
        end(run, &mut verdict, |_| {});
        let stay = left(&dir, None);
        verdict.left = stay.len();
        verdict.said.extend(stay);
        self.finish(command(&dir), &dir, verdict)
    }

    /// The same command once more.
    fn finish(&self, command: Command, dir: &Path, mut verdict: Verdict) -> Verdict {
        let ended = end(Running::start(command), &mut verdict, |_| {});
        if ended.code != Some(0) {
            verdict.wrong(format!("the second call ends with {:?}: {}", ended.code, ended.stderr));
        }
        let found = tables(dir);
        let differ: Vec<&str> = self.wanted.keys().filter(|name| found[*name] != self.wanted[*name]).copied().collect();
        verdict.rows_known = 1;
        verdict.rows_lost = differ.len();
        verdict.said.extend(differ.iter().map(|name| format!("{name} has other bytes")));
        verdict
    }
}

/// Kills a case that Slurm runs, and types the same command again.
pub fn struck_slurm(cluster: &Cluster, studies: &Studies, draw: f64) -> Verdict {
    let dir = cluster.folder().join("study");
    let mut verdict = Verdict { phase: Phase::Stepping, ..Verdict::default() };
    let study = || cluster.command(&dir, &["--wait"]);
    let run = Running::start(study());
    let parent = run.child.id();
    let deadline = Instant::now() + Duration::from_secs(60);
    let runs = |pid: &u32| {
        let line = fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        *pid != parent && String::from_utf8_lossy(&line).contains("--from")
    };
    loop {
        let tasks: Vec<u32> = naming(&dir.join("cases")).into_iter().filter(runs).collect();
        if let Some(task) = tasks.first() {
            std::thread::sleep(Duration::from_secs_f64(draw));
            send("KILL", *task);
            break;
        }
        if Instant::now() > deadline {
            verdict.hung = true;
            verdict.said.push("no task begins within a minute".to_owned());
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    end(run, &mut verdict, |_| {});
    let stay = left(&dir.join("cases"), None);
    verdict.left = stay.len();
    verdict.said.extend(stay);
    studies.finish(study(), &dir, verdict)
}
