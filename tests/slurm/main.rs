//! Studies on a real Slurm of one node, which `.ci/slurm` sets up: the same tables as on this machine alone, whatever is
//! killed, and one clear error for what Slurm refuses. Where `SUMO_MFC_SLURM` is set, as `.ci/run` does, a missing Slurm is a
//! failure; elsewhere the tests say that they are skipped.

mod cluster;
#[path = "../live/support.rs"]
#[allow(dead_code)]
mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant, SystemTime};

use cluster::Cluster;
use support::{Ended, NEW, Running, json, program, repository, table};

/// Two settings of traffic that differs from seed to seed.
const STUDY: [&str; 9] = [
    "sweep",
    "scenarios/motorway.toml",
    "--set",
    "traffic.sigma=0.5",
    "--vary",
    "controller.name=ideal,pid",
    "--reference",
    "controller.name=ideal",
    "-q",
];

/// `sumo-mfc sweep`, here and alone.
fn local(dir: &Path, args: &[&str]) -> Ended {
    let mut command = program(NEW);
    command.current_dir(repository("")).args(STUDY).args(args).arg("-o").arg(dir);
    Running::start(command).wait()
}

/// The bytes of all that a study ends with.
fn tables(dir: &Path) -> [Vec<u8>; 5] {
    ["cases.csv", "comparison.csv", "vehicles.parquet", "study.json", "schema.json"]
        .map(|name| fs::read(dir.join(name)).unwrap())
}

/// What a user with all the time in the world gets.
fn wanted(folder: &Path, args: &[&str], cases: usize) -> [Vec<u8>; 5] {
    let dir = folder.join("local");
    let ended = local(&dir, args);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let rows = table(&dir.join("cases.csv"));
    assert_eq!((rows.len(), rows.iter().filter(|row| row["status"] == "done").count()), (cases, cases));
    tables(&dir)
}

/// Waits until something holds.
#[track_caller]
fn wait_for(what: &str, mut holds: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(60);
    while !holds() {
        assert!(Instant::now() < deadline, "{what}: not within a minute");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// When the files of the cases were written.
fn written(dir: &Path) -> BTreeMap<PathBuf, SystemTime> {
    let cases = fs::read_dir(dir.join("cases")).into_iter().flatten().flatten();
    let files = cases.flat_map(|case| fs::read_dir(case.path()).unwrap().flatten()).filter(|f| f.path().is_file());
    files.map(|file| (file.path(), file.metadata().unwrap().modified().unwrap())).collect()
}

/// The process that runs a case, once its SUMO runs.
fn process_of(dir: &Path, case: &str) -> Option<u32> {
    let case = dir.join("cases").join(case);
    let manifest = Some(case.join("run.json")).filter(|_| case.join("sumo/tripinfo.xml").exists())?;
    let ids = fs::read_dir("/proc").unwrap().flatten();
    let mut ids = ids.filter_map(|entry| entry.file_name().to_string_lossy().parse::<u32>().ok());
    ids.find(|id| {
        let line = fs::read(format!("/proc/{id}/cmdline")).unwrap_or_default();
        line.split(|byte| *byte == 0).any(|word| word == manifest.as_os_str().as_encoded_bytes())
    })
}

#[test]
fn a_cluster_gives_the_tables_of_one_machine_in_arrays_that_fit() {
    // Indices below 4: eight cases are three arrays, and the throttle holds for all of them together.
    let Some(cluster) = Cluster::start(4) else { return };
    let args = ["--seeds", "1..4", "--end", "300"];
    let wanted = wanted(cluster.folder(), &args, 8);
    let dir = cluster.folder().join("study %a");
    let submitted = cluster.sweep(&dir, &[&args[..], &["--slurm", "throttle=2"]].concat());
    assert_eq!(submitted.code, Some(0), "{}", submitted.stderr);
    let jobs: Vec<&str> = submitted.stdout.split_whitespace().collect();
    assert_eq!(jobs.len(), 4, "three arrays and the tables: {}", submitted.stdout);
    let second = cluster.slurm("scontrol", &["show", "job", jobs[1]]);
    assert!(second.contains(&format!("Dependency=afterany:{}", jobs[0])), "{second}");
    assert!(second.contains("ArrayTaskThrottle=2"), "{second}");
    let status = cluster.sweep(&dir, &[&args[..], &["--status"]].concat()).stdout;
    assert!(status.contains("\tpending\n") && status.contains("8 cases in "), "{status}");
    // The same command submits nothing that is in the queue, where all jobs still are: cases take a second or more.
    let again = cluster.sweep(&dir, &args);
    assert_eq!(again.stdout, submitted.stdout, "{}", again.stderr);
    // Nobody waits for it: the last job writes the tables.
    wait_for("the tables", || dir.join("schema.json").exists() && cluster.queue().is_empty());
    assert_eq!(tables(&dir), wanted);
    let tickets = fs::read_dir(dir.join("slurm/0001")).unwrap().flatten();
    assert!(tickets.into_iter().all(|file| file.path().extension().unwrap() == "log"), "no ticket is left");
    // A finished study needs no job.
    let before = written(&dir);
    let last = cluster.sweep(&dir, &[&args[..], &["--export", "csv"]].concat());
    assert_eq!((last.code, written(&dir), cluster.queue()), (Some(0), before, String::new()));
    assert_eq!(last.stdout, fs::read_to_string(dir.join("comparison.csv")).unwrap(), "the table is printed");
}

/// Slurm is asked after the study was looked at, and a case may end in between: here all of them do.
#[test]
fn regress_a_case_that_ends_while_slurm_is_asked_is_not_submitted_again() {
    let Some(cluster) = Cluster::start(1001) else { return };
    let args = ["--seeds", "1..2", "--end", "300"];
    let dir = cluster.folder().join("study");
    assert_eq!(cluster.sweep(&dir, &args).code, Some(0));
    let slurms = cluster.slurm("sh", &["-c", "command -v squeue"]);
    let late = format!("while [ \"$({0} --noheader)\" ]; do sleep 0.1; done\nexec {0} \"$@\"", slurms.trim());
    let again = cluster.sweep_with(["squeue", &late], &dir, &args);
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    assert!(dir.join("slurm/0002.json").exists() && !dir.join("slurm/0003.json").exists(), "{}", again.stdout);
    assert!(table(&dir.join("cases.csv")).iter().all(|row| row["status"] == "done"));
}

#[test]
fn what_is_killed_is_listed_and_run_again_and_nothing_else() {
    let Some(cluster) = Cluster::start(1001) else { return };
    // Long enough to strike a case while it runs, however fast the machine.
    let args = ["--seeds", "1..3", "--end", "600"];
    let wanted = wanted(cluster.folder(), &args, 6);
    let dir = cluster.folder().join("study");
    let submitted = cluster.sweep(&dir, &args);
    let [array, _] = submitted.stdout.split_whitespace().collect::<Vec<_>>()[..] else {
        panic!("{}", submitted.stderr)
    };
    // One case loses its process, another one its task.
    let mut process = None;
    wait_for("the second case", || {
        process = process_of(&dir, "0002");
        process.is_some()
    });
    assert!(Command::new("kill").args(["-KILL", &process.unwrap().to_string()]).status().unwrap().success());
    wait_for("the fourth case", || process_of(&dir, "0004").is_some());
    cluster.slurm("scancel", &[&format!("{array}_3")]);
    wait_for("the end", || cluster.queue().is_empty());
    let rows = table(&dir.join("cases.csv"));
    let done: Vec<bool> = rows.iter().map(|row| row["status"] == "done").collect();
    assert_eq!(done, [true, false, true, false, true, true]);
    let status = cluster.sweep(&dir, &[&args[..], &["--status"]].concat()).stdout;
    assert!(status.contains("0002\tcontroller.name=pid\tseed 1\tfailed: signal: 9 (SIGKILL)"), "{status}");
    assert!(status.contains(&format!("seed 2\tfailed: task {array}_3: CANCELLED, see slurm/0001/3.log")), "{status}");
    assert!(status.contains("6 cases in ") && status.contains(": 4 done, 2 failed, 0 missing\n"), "{status}");
    let before = written(&dir);
    // It stays, and is killed itself: the jobs go on.
    let mut waiting = Running::start(cluster.command(&dir, &[&args[..], &["--wait"]].concat()));
    wait_for("the second submission", || json_of(&dir, "0004").is_some_and(|job| job["job"].is_string()));
    waiting.child.kill().unwrap();
    assert_eq!(waiting.wait().code, None);
    assert_eq!(json_of(&dir, "0003").unwrap()["tasks"], serde_json::json!([[2], [4]]));
    let ended = cluster.sweep(&dir, &[&args[..], &["--wait", "--export", "csv"]].concat());
    let comparison = fs::read_to_string(dir.join("comparison.csv")).unwrap();
    assert_eq!((ended.code, ended.stdout), (Some(0), comparison), "{}", ended.stderr);
    assert_eq!(tables(&dir), wanted);
    let after = written(&dir);
    let again = |path: &Path| ["0002", "0004"].iter().any(|case| path.starts_with(dir.join("cases").join(case)));
    assert!(before.keys().filter(|path| !again(path)).count() >= 4 * 4);
    for (path, time) in before.iter().filter(|(path, _)| !again(path)) {
        assert_eq!(after.get(path), Some(time), "{} was written again", path.display());
    }
}

/// What was written of a submission.
fn json_of(dir: &Path, number: &str) -> Option<serde_json::Value> {
    let path = dir.join("slurm").join(number).with_extension("json");
    path.exists().then(|| json(&path))
}

#[test]
fn a_call_that_is_killed_while_it_submits_leaves_nothing_that_runs_twice() {
    let Some(cluster) = Cluster::start(1001) else { return };
    let args = ["--seeds", "1..2", "--end", "20"];
    let wanted = wanted(cluster.folder(), &args, 4);
    let status = |dir: &Path| cluster.sweep(dir, &[&args[..], &["--status"]].concat()).stdout;
    // The tasks run three cases and one.
    let per_task = [&args[..], &["--slurm", "cases_per_task=3"]].concat();
    for (taken, script) in
        [(false, "kill -KILL $PPID"), (true, "/usr/bin/sbatch --begin=now+2 \"$@\" >/dev/null; kill -KILL $PPID")]
    {
        let dir = cluster.folder().join(format!("taken {taken}"));
        let killed = cluster.sweep_with(["sbatch", script], &dir, &per_task);
        assert_eq!(killed.code, None, "{}", killed.stderr);
        let intent = json_of(&dir, "0001").unwrap();
        assert!(intent["job"].is_null() && intent["tasks"] == serde_json::json!([[1, 2, 3], [4]]), "{intent}");
        let told = status(&dir);
        let word = if taken { "4 pending" } else { "4 uncertain" };
        assert!(told.contains(&format!("0 done, 0 failed, 0 missing, {word}\n")), "{told}");
        let ended = cluster.sweep(&dir, &[&per_task[..], &["--wait"]].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(tables(&dir), wanted);
        // The job that Slurm has taken is found by its name, and the other one is replaced.
        let first = json_of(&dir, "0001").unwrap();
        assert_eq!(first["name"] == intent["name"], taken, "{first}");
        assert!(first["job"].is_string() && json_of(&dir, "0003").is_none(), "{first}");
    }
}

#[test]
fn warm_ups_come_before_the_jobs_that_load_them() {
    let Some(cluster) = Cluster::start(1001) else { return };
    let args = ["--seeds", "1..2", "--end", "40", "--warm-up", "20"];
    let wanted = wanted(cluster.folder(), &args, 4);
    let dir = cluster.folder().join("study");
    let ended = cluster.sweep(&dir, &[&args[..], &["--wait"]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let states = |dir: &Path| fs::read_dir(dir.join("warm_up")).unwrap().flatten().count();
    assert_eq!((states(&dir), states(&cluster.folder().join("local"))), (2, 2), "a state per seed and nothing else");
    // study.json has the hashes of scenarios that name the state in their own folder.
    assert_eq!(tables(&dir)[..3], wanted[..3]);
}

#[test]
fn what_slurm_refuses_is_one_error_and_nothing_is_left() {
    let Some(cluster) = Cluster::start(3) else { return };
    let args = ["--seeds", "1..2", "--end", "20"];
    let dir = cluster.folder().join("refused");
    let file = cluster.folder().join("study.toml");
    let text = format!(
        "scenario = {:?}\n[[vary]]\n\"controller.name\" = [\"ideal\", \"pid\"]\n[slurm]\npartition = \"night\"\n",
        repository("scenarios/motorway.toml")
    );
    fs::write(&file, text).unwrap();
    let from_file =
        cluster.call(&["sweep", file.to_str().unwrap(), "--executor", "slurm", "-o", dir.to_str().unwrap()]);
    for refused in [from_file, cluster.sweep(&dir, &[&args[..], &["--slurm", "partition=night"]].concat())] {
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(1), ""));
        let said =
            "executor slurm: sbatch says: invalid partition specified: night; Batch job submission failed: Invalid";
        assert!(
            refused.stderr.contains(said) && refused.stderr.contains("Nothing was submitted"),
            "{}",
            refused.stderr
        );
        assert!(!dir.exists(), "something was run");
    }
    // Before it simulates a warm-up it asks.
    let warm = [&args[..], &["--warm-up", "10", "--slurm", "partition=night"]].concat();
    let refused = cluster.sweep(&dir, &warm);
    let said = "executor slurm: sbatch says: invalid partition specified: night; ";
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(1), ""));
    assert!(refused.stderr.contains(said) && refused.stderr.contains("Nothing was submitted"), "{}", refused.stderr);
    assert!(!dir.exists(), "something was simulated");
    // The second of two arrays is refused, the first waits for its turn.
    let counter = cluster.folder().join("calls");
    let script = format!(
        "echo >>{0}; if [ $(wc -l <{0}) = 2 ]; then echo 'sbatch: error: over the limit' >&2; exit 1; fi\n\
         exec /usr/bin/sbatch --hold \"$@\"",
        counter.display()
    );
    let refused = cluster.sweep_with(["sbatch", &script], &dir, &args);
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(1), ""));
    let said = "executor slurm: sbatch says: over the limit. What it had taken of this call was cancelled: ";
    assert!(refused.stderr.contains(said), "{}", refused.stderr);
    assert!(!dir.exists());
    wait_for("an empty queue", || cluster.queue().is_empty());
}
