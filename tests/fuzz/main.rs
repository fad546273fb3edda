//! Mutated files against everything that reads: no panic, no hang, no flood of memory, and an error that says where it is.
//!
//! `make fuzz fuzz_cases=10000000` is the long form. A case is made from seed, target and number alone. What is found is
//! printed as `target:seed:case`; `SUMO_MFC_FUZZ_CASE=target:seed:case cargo test --release --test fuzz repeat` runs that
//! case again, and leaves its bytes as a file. If the process was aborted, `target/tmp/fuzz-target-seed` has the case.

mod mutate;
mod seeds;
mod targets;

use std::alloc::System;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Once;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rustix::time::{ClockId, clock_gettime};
use seeds::Seeds;
use sha2::{Digest, Sha256};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use targets::{Room, TARGETS, Target, target};

#[global_allocator]
static COUNTING: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Cases of all targets together, if nothing else is said.
const CASES: u64 = 100_000;

/// A case that takes more processor time is a find, and one that waits for something longer than the second, on however busy
/// a machine; one that takes as long as the third ends the process.
const SLOW: Duration = Duration::from_secs(1);
const WAITS: Duration = Duration::from_secs(20);
const HANGS: Duration = Duration::from_secs(300);

/// How often a long run says how far it has come.
const TELLS: Duration = Duration::from_secs(60);

/// A case that allocates more in all is a find \[bytes\].
const ALLOCATED_MAX: usize = 256 << 20;

/// Finds of one target that are printed.
const SHOWN: usize = 8;

thread_local! {
    /// While a case is read: what its panic says and where it is.
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Keeps the panics of cases; those of tests are printed.
static HOOK: Once = Once::new();

fn keep_panics() {
    HOOK.call_once(|| {
        let print = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            let of_case = PANIC.with_borrow_mut(|said| said.as_mut().map(|said| *said = info.to_string()));
            if of_case.is_none() {
                print(info);
            }
        }));
    });
}

fn from_environment(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().unwrap_or_else(|_| panic!("{name}: found {text}")))
}

/// The bytes of a case.
fn case(target: &Target, seeds: &Seeds, seed: u64, number: u64) -> Vec<u8> {
    let hash = Sha256::new().chain_update(target.name).chain_update(seed.to_le_bytes());
    let key = hash.chain_update(number.to_le_bytes()).finalize();
    mutate::mutated(&mut ChaCha8Rng::from_seed(key.into()), &seeds.files, &seeds.words)
}

/// Processor time of this thread.
fn processor_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

/// Whether the bytes were taken, or what was wrong.
fn judge(target: &Target, room: &Room, bytes: &[u8]) -> Result<bool, String> {
    let (region, begun, worked) = (Region::new(COUNTING), Instant::now(), processor_time());
    PANIC.set(Some(String::new()));
    let judged = catch_unwind(AssertUnwindSafe(|| (target.read)(room, bytes)));
    let said = PANIC.take();
    let (took, worked, allocated) = (begun.elapsed(), processor_time() - worked, region.change().bytes_allocated);
    let judged = judged.unwrap_or_else(|_| Err(format!("panic: {}", said.unwrap_or_default())))?;
    match () {
        () if worked > SLOW => Err(format!("it takes more than {SLOW:?}")),
        () if took > WAITS => Err(format!("it waits for more than {WAITS:?}")),
        () if allocated > ALLOCATED_MAX => Err(format!("it allocates more than {ALLOCATED_MAX} bytes")),
        () => Ok(judged),
    }
}

/// Runs a share of the cases against a target.
fn fuzz(name: &str) {
    keep_panics();
    let (target, seeds, room) = (target(name), seeds::of(name), Room::new());
    for (i, bytes) in seeds.files.iter().enumerate() {
        if let Err(found) = judge(target, &room, bytes) {
            eprintln!("{name}, seed file {i}: {found}");
        }
    }
    let seed = from_environment("SUMO_MFC_FUZZ_SEED", 1);
    let cases = from_environment("SUMO_MFC_FUZZ_CASES", CASES).div_ceil(TARGETS.len() as u64);
    let (at, begun) = (AtomicU64::new(0), Instant::now());
    let under_way = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{name}-{seed}"));
    let mut finds: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    let mut taken = 0;
    std::thread::scope(|scope| {
        scope.spawn(|| watch(name, seed, cases, &at));
        for number in 0..cases {
            at.store(number, Ordering::Relaxed);
            // What aborts the process, such as the end of the stack, is found here.
            std::fs::write(&under_way, number.to_string()).unwrap();
            let bytes = case(target, &seeds, seed, number);
            // What is too slow or too large only now and then is the machine's doing: other tests run beside this one.
            let mut judged = judge(target, &room, &bytes);
            for _ in 0..3 {
                if judged.as_ref().is_err_and(|found| found.starts_with("it ")) {
                    judged = judge(target, &room, &bytes);
                }
            }
            match judged {
                Ok(accepted) => taken += u64::from(accepted),
                Err(found) => finds.entry(kind(&found)).or_insert((number, 0)).1 += 1,
            }
        }
        at.store(u64::MAX, Ordering::Relaxed);
    });
    std::fs::remove_file(&under_way).unwrap();
    eprintln!("{name}: {cases} cases, {taken} taken, {} kinds of finds, {:.1?}", finds.len(), begun.elapsed());
    let shown = finds
        .iter()
        .take(SHOWN)
        .map(|(kind, (number, times))| format!("\n{name}:{seed}:{number} ({times} times): {kind}"));
    assert!(finds.is_empty(), "{}", shown.collect::<String>());
}

/// What finds of one kind have in common: their message without the numbers and the input in it.
fn kind(found: &str) -> String {
    let line = found.lines().take(2).collect::<Vec<_>>().join(" ");
    line.chars().map(|c| if c.is_ascii_digit() { '#' } else { c }).take(160).collect::<String>().replace("##", "#")
}

/// Ends the process if a case hangs, and says which. A run of more than a minute tells how far it has come.
fn watch(name: &str, seed: u64, cases: u64, at: &AtomicU64) {
    let (mut last, mut since, mut told) = (0, Instant::now(), Instant::now());
    loop {
        std::thread::sleep(Duration::from_millis(20));
        let now = at.load(Ordering::Relaxed);
        if now == u64::MAX {
            return;
        }
        if now != last {
            (last, since) = (now, Instant::now());
        }
        if since.elapsed() > HANGS {
            eprintln!("{name}:{seed}:{now} hangs");
            std::process::exit(101);
        }
        if told.elapsed() > TELLS {
            told = Instant::now();
            eprintln!("{name}: {now} of {cases}");
        }
    }
}

macro_rules! fuzzed {
    ($($target:ident)+) => {
        $(
            #[test]
            fn $target() {
                fuzz(stringify!($target));
            }
        )+

        #[test]
        fn every_target_has_its_test() {
            let names: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
            assert_eq!(names, [$(stringify!($target)),+]);
        }
    };
}

fuzzed! {
    decoder scenario set study manifest configuration demand additional state network tripinfo statistics conflicts log
    recording tyre_curve parameter
}

/// The seeds are what they seem: most of them are taken as they are.
#[test]
fn seeds_are_taken() {
    for target in TARGETS {
        let (seeds, room) = (seeds::of(target.name), Room::new());
        let taken = seeds.files.iter().filter(|bytes| (target.read)(&room, bytes) == Ok(true)).count();
        assert!(2 * taken >= seeds.files.len(), "{}: {taken} of {}", target.name, seeds.files.len());
    }
}

#[test]
#[ignore = "repeats the case that SUMO_MFC_FUZZ_CASE=target:seed:case names"]
fn repeat() {
    let Ok(wanted) = std::env::var("SUMO_MFC_FUZZ_CASE") else { return };
    let parts: Vec<&str> = wanted.split(':').collect();
    let [name, seed, number] = parts[..] else { panic!("found {wanted}, wanted target:seed:case") };
    let target = target(name);
    let bytes = case(target, &seeds::of(name), seed.parse().unwrap(), number.parse().unwrap());
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(wanted.replace(':', "-"));
    std::fs::write(&file, &bytes).unwrap();
    eprintln!("{} bytes in {}", bytes.len(), file.display());
    assert_eq!((target.read)(&Room::new(), &bytes).map(drop), Ok(()));
}
