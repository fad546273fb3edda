//! Tests, run with a change in force or with none.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// A test that passes without changes.
pub struct Test {
    /// The name of its program, and its own.
    pub name: String,
    program: PathBuf,
    filter: String,
    /// How long it took.
    time: Duration,
    /// The numbers of the changes that it comes across.
    reached: HashSet<u32>,
}

/// What became of a change.
#[derive(Clone, Debug, PartialEq)]
pub enum Fate {
    /// A test has failed, or has not ended: its name.
    Caught(String),
    Survived,
    /// No test comes across it.
    Unreached,
}

impl std::fmt::Display for Fate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Caught(test) => write!(f, "caught by {test}"),
            Self::Survived => f.write_str("survived"),
            Self::Unreached => f.write_str("reached by no test"),
        }
    }
}

/// How much is tried.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Tests that take longer are left out.
    pub test: Duration,
    /// No further test is begun for a change behind this time.
    pub mutant: Duration,
    /// Tests at a time.
    pub jobs: usize,
}

/// Tests below this time run several in one process.
const QUICK: Duration = Duration::from_millis(250);
const TOGETHER: usize = 12;

/// Runs every test of the programs once in `tree`, and asks which changes it comes across. Tests that fail or take too
/// long are named and left out.
pub fn record(tree: &Path, programs: &[(String, PathBuf)], limits: Limits) -> Vec<Test> {
    let listed: Vec<(String, PathBuf, String)> = programs
        .iter()
        .flat_map(|(name, program)| {
            let listed = Command::new(program).arg("--list").current_dir(tree).output();
            let text = listed.map(|ended| String::from_utf8_lossy(&ended.stdout).into_owned()).unwrap_or_default();
            let tests = text.lines().filter_map(|line| line.strip_suffix(": test")).map(String::from);
            tests.map(|test| (name.clone(), program.clone(), test)).collect::<Vec<_>>()
        })
        .collect();
    let done = at_a_time(limits.jobs, listed.len(), |index| {
        let (name, program, filter) = &listed[index];
        let log = tree.join(format!("target/reached-{index}"));
        let _ = fs::remove_file(&log);
        let begun = Instant::now();
        let filters = [filter.as_str()];
        let mut passed = run(tree, program, &filters, ("MUTANTS_RECORD", &log.to_string_lossy()), limits.test);
        let time = begun.elapsed();
        if !passed && time < limits.test {
            // What counts bytes or calls is disturbed by the recording.
            passed = run(tree, program, &filters, ("MUTANTS_ACTIVE", "0"), limits.test);
        }
        let text = fs::read_to_string(&log).unwrap_or_default();
        let reached = text.lines().filter_map(|line| line.parse().ok()).collect();
        let name = format!("{name} {filter}");
        passed.then(|| Test { name, program: program.clone(), filter: filter.clone(), time, reached })
    });
    let left_out =
        listed.iter().zip(&done).filter(|(_, test)| test.is_none()).map(|((program, _, test), _)| (program, test));
    left_out.for_each(|(program, test)| eprintln!("left out, because it fails or takes too long: {program} {test}"));
    let mut tests: Vec<Test> = done.into_iter().flatten().collect();
    tests.sort_by_key(|test| test.time);
    tests
}

/// Tries the changes `numbers`, each with the tests that come across it, the quickest first.
/// `note` hears of each as soon as it is known.
pub fn try_all(
    tree: &Path,
    tests: &[Test],
    numbers: &[u32],
    limits: Limits,
    note: impl Fn(u32, &Fate) + Sync,
) -> HashMap<u32, Fate> {
    let told = Mutex::new(Instant::now());
    let done = AtomicUsize::new(0);
    let fates = at_a_time(limits.jobs, numbers.len(), |index| {
        let fate = try_one(tree, tests, numbers[index], limits);
        note(numbers[index], &fate);
        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
        let mut told = told.lock().unwrap();
        if told.elapsed() > Duration::from_secs(60) {
            *told = Instant::now();
            eprintln!("{count} of {} changes tried", numbers.len());
        }
        fate
    });
    numbers.iter().copied().zip(fates).collect()
}

fn try_one(tree: &Path, tests: &[Test], number: u32, limits: Limits) -> Fate {
    let reaching: Vec<&Test> = tests.iter().filter(|test| test.reached.contains(&number)).collect();
    if reaching.is_empty() {
        return Fate::Unreached;
    }
    let active = number.to_string();
    let fails = |batch: &[&Test]| {
        let filters: Vec<&str> = batch.iter().map(|test| test.filter.as_str()).collect();
        let time = batch.iter().map(|test| test.time).sum::<Duration>() * 8 + Duration::from_secs(5);
        !run(tree, &batch[0].program, &filters, ("MUTANTS_ACTIVE", &active), time)
    };
    let begun = Instant::now();
    for batch in batches(&reaching) {
        if begun.elapsed() > limits.mutant {
            break;
        }
        // What takes long depends on how busy the machine is, too: it must fail twice.
        if fails(&batch) && (batch[0].time < QUICK || fails(&batch)) {
            return Fate::Caught(batch[0].name.clone());
        }
    }
    Fate::Survived
}

/// Quick tests of one program together, the others alone; what takes least comes first.
fn batches<'a>(tests: &[&'a Test]) -> Vec<Vec<&'a Test>> {
    let mut batches: Vec<Vec<&Test>> = Vec::new();
    for test in tests {
        let open = batches.iter_mut().find(|batch| batch[0].program == test.program && batch.len() < TOGETHER);
        match open {
            Some(batch) if test.time < QUICK => batch.push(test),
            _ => batches.push(vec![test]),
        }
    }
    batches.sort_by_key(|batch| batch.iter().map(|test| test.time).sum::<Duration>());
    batches
}

/// Whether the tests of these names pass within `time`. What they have started is ended with them.
fn run(tree: &Path, program: &Path, filters: &[&str], setting: (&str, &str), time: Duration) -> bool {
    let mut command = Command::new(program);
    command.arg("--exact").args(filters).current_dir(tree).env(setting.0, setting.1);
    // What cargo would tell the tests.
    command.env("CARGO_MANIFEST_DIR", tree).env("RUST_BACKTRACE", "0").env("INSTA_WORKSPACE_ROOT", tree);
    command.env("INSTA_UPDATE", "no").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).process_group(0);
    let mut child = command.spawn().unwrap_or_else(|error| panic!("{} cannot be started: {error}", program.display()));
    let begun = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) if begun.elapsed() < time => {
                thread::sleep((begun.elapsed() / 10).clamp(Duration::from_millis(1), Duration::from_millis(50)))
            }
            _ => break,
        }
    }
    let _ = Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).stderr(Stdio::null()).status();
    let _ = child.wait();
    false
}

/// Calls `work` for 0 .. `count` on so many threads; answers in order.
fn at_a_time<T: Send>(jobs: usize, count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return done;
            }
            done.push((index, work(index)));
        }
    };
    let mut all: Vec<(usize, T)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..jobs.max(1)).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a worker has panicked")).collect()
    });
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, answer)| answer).collect()
}
