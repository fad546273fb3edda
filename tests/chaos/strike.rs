//! One fault that befalls one run.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::end::{left, port_of, send};
use super::judge::{Known, Verdict, ids_on_disk, status};
use super::plan::{Kind, Phase, Plan};
use super::proxy::Fault;
use super::scene::{STEP_S, Scene, Sumo, phase};
use super::support::{Ended, Running, SmallDisk, children};

/// A run that has not ended so long after the fault hangs.
const BOUND: Duration = Duration::from_secs(30);
/// How long SUMO may take to answer where it is stopped, or nothing passes: `--timeout`.
const TIMEOUT: &str = "3";
/// Steps of an undisturbed run.
const STEPS: f64 = 3000.0;

/// Strikes, and says what it has cost; `None` where this machine cannot do it.
pub fn struck(plan: &Plan, scene: &Scene) -> Option<Verdict> {
    let folder = tempfile::tempdir().unwrap();
    let disk = match plan.kind {
        Kind::Disk => {
            let most = f64::from(scene.alone.size_kb);
            Some(SmallDisk::new(8 + ((most + 200.0) * plan.at) as u32)?)
        }
        _ => None,
    };
    let dir = disk.as_ref().map_or(folder.path(), SmallDisk::folder).join("result");
    let fault = on_the_wire(plan);
    let sumo = plan.joined.then(|| scene.sumo(fault));
    let args: &[&str] = match plan.kind {
        Kind::Sumos("STOP") | Kind::Silent | Kind::Garbled => &["--timeout", TIMEOUT],
        _ => &[],
    };
    let run = Running::start(scene.command(&dir, sumo.as_ref(), args));
    Some(observed(run, plan, scene, (&dir, sumo.as_ref(), fault)))
}

/// What the proxy does.
fn on_the_wire(plan: &Plan) -> Fault {
    let step = 1 + (plan.at * (STEPS - 1.0)) as u64;
    match plan.kind {
        Kind::Cut => Fault::Cut(step),
        Kind::Slow => Fault::Slow(step),
        Kind::Silent => Fault::Silent(step),
        Kind::Garbled => Fault::Garbled { step, at: plan.more[0], bits: 1 << (plan.more[1] * 8.0) as u8 },
        _ => Fault::None,
    }
}

fn observed(mut run: Running, plan: &Plan, scene: &Scene, struck: (&Path, Option<&Sumo>, Fault)) -> Verdict {
    let (dir, sumo, fault) = struck;
    let pid = run.child.id();
    let undisturbed = scene.of(plan.joined);
    let (mut known, mut verdict) = (Known { true_until_s: f64::INFINITY, ..Known::default() }, Verdict::default());
    let mut port = None;
    match fault {
        Fault::None if plan.kind != Kind::Disk => {
            wait_for(plan.phase, &mut run, dir, plan.joined);
            let until = Instant::now() + undisturbed.length(plan.phase).mul_f64(plan.at);
            while Instant::now() < until && run.child.try_wait().unwrap().is_none() {
                port = port.or_else(|| port_of(pid));
                std::thread::sleep(Duration::from_millis(1));
            }
            port = port.or_else(|| port_of(pid));
            verdict.phase =
                if run.child.try_wait().unwrap().is_some() { Phase::Ended } else { phase(pid, dir, plan.joined) };
            known.ids = ids_on_disk(dir);
            if plan.kind == Kind::Folder && !dir.join("vehicles.csv.part").exists() {
                // A table that was whole is gone with its folder.
                known.ids.clear();
            }
            // A step is asked for once the rows of all steps before are written.
            let asked = sumo.map_or(0, |sumo| sumo.proxy.steps.load(Ordering::SeqCst));
            known.until_s = asked.saturating_sub(1) as f64 * STEP_S;
            strike(plan.kind, pid, dir);
        }
        Fault::Cut(step) | Fault::Silent(step) => {
            verdict.phase = Phase::Stepping;
            known.until_s = (step - 1) as f64 * STEP_S;
        }
        Fault::Garbled { step, .. } => {
            verdict.phase = Phase::Stepping;
            known.until_s = (step - 1) as f64 * STEP_S;
            // Nobody can tell a wrong speed from another one.
            known.true_until_s = known.until_s;
        }
        _ => verdict.phase = Phase::Stepping,
    }
    let ended = end(run, &mut verdict, |run| port = port.or_else(|| port_of(run.child.id())));
    // What broke off says when; the step in which a row cannot be written is the last.
    let broke_off_s = between(&ended.stderr, "broke off at ", " s,").and_then(|text| text.parse::<f64>().ok());
    let gone = plan.kind == Kind::Folder && known.ids.is_empty();
    known.until_s = known.until_s.max(broke_off_s.filter(|_| !gone).map_or(0.0, |time_s| time_s - STEP_S));
    known.ids.extend(undisturbed.arrived_before(known.until_s.min(known.true_until_s)));
    let stay = left(dir, port);
    verdict.left = stay.len();
    verdict.said.extend(stay);
    told(&ended, plan, dir, &mut verdict);
    verdict.take_rows(dir, undisturbed, &known);
    if matches!(plan.kind, Kind::Slow) && ended.code != Some(0) {
        verdict.wrong(format!("a slow connection is none that is broken: {}", ended.stderr));
    }
    if !verdict.said.is_empty() {
        verdict.said.push(format!("it ended with {:?}: {}", ended.code, ended.stderr));
    }
    verdict
}

/// The words between two others; long messages are wrapped.
fn between(text: &str, begin: &str, end: &str) -> Option<String> {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    Some(text.split_once(begin)?.1.split_once(end)?.0.to_owned())
}

fn strike(kind: Kind, pid: u32, dir: &Path) {
    match kind {
        Kind::Ours(signal) => send(signal, pid),
        Kind::Sumos(signal) => children(pid).into_iter().for_each(|sumo| send(signal, sumo)),
        Kind::Folder => {
            // Files may be made while it is emptied.
            let mut trials = 0;
            while fs::remove_dir_all(dir).is_err() && dir.exists() && trials < 50 {
                trials += 1;
            }
        }
        _ => unreachable!("it strikes by itself"),
    }
}

/// Waits until the run is in this phase, or beyond it.
fn wait_for(wanted: Phase, run: &mut Running, dir: &Path, joined: bool) {
    let deadline = Instant::now() + BOUND;
    while run.child.try_wait().unwrap().is_none() && phase(run.child.id(), dir, joined) < wanted {
        if Instant::now() > deadline {
            // It is struck where it is, and judged as any other.
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Waits for the end of a run, which hangs if that takes too long.
pub fn end(mut run: Running, verdict: &mut Verdict, mut meanwhile: impl FnMut(&mut Running)) -> Ended {
    let deadline = Instant::now() + BOUND;
    while run.child.try_wait().unwrap().is_none() {
        meanwhile(&mut run);
        if Instant::now() > deadline {
            verdict.hung = true;
            verdict.said.push(format!("it has not ended after {BOUND:?}"));
            run.child.kill().unwrap();
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    run.wait()
}

/// Whether the exit code says what `run.json` says.
fn told(ended: &Ended, plan: &Plan, dir: &Path, verdict: &mut Verdict) {
    let status = status(dir);
    let complete = status.as_deref() == Some("complete");
    let codes: &[Option<i32>] = match plan.kind {
        _ if verdict.hung => return,
        // A signal that comes before it is listened to, or is none that can be.
        Kind::Ours("KILL") => &[None, Some(0)],
        Kind::Ours("TERM") => &[None, Some(143), Some(0)],
        Kind::Ours("INT") => &[None, Some(130), Some(0)],
        Kind::Ours("HUP") => &[None, Some(129), Some(0)],
        Kind::Ours("QUIT") => &[None, Some(131), Some(0)],
        _ => &[Some(1), Some(0)],
    };
    if ended.stderr.contains("panicked") || !codes.contains(&ended.code) {
        verdict.wrong(format!("ended with {:?}", ended.code));
    }
    // What is written last is there until somebody deletes it.
    let deleted = plan.kind == Kind::Folder && status.is_none();
    if ended.code == Some(0) && !complete && !deleted {
        verdict.wrong(format!("ended with 0, and run.json says {status:?}"));
    }
    if ended.code == Some(1) && complete && !ended.stderr.contains("the result is whole, but its report") {
        verdict.wrong("ended with 1, and run.json says complete".to_owned());
    }
    let missing: Vec<PathBuf> = ["vehicles.csv", "schema.json", "summary.json", "edges.csv", "sample.csv", "sumo"]
        .map(|name| dir.join(name))
        .into_iter()
        .filter(|path| complete && !path.exists())
        .collect();
    if !missing.is_empty() {
        verdict.wrong(format!("complete without {missing:?}"));
    }
}
