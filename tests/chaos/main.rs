//! Faults at random times against real SUMO: no row of a vehicle that had left is lost, nobody hangs, nothing stays behind.
//!
//! `make chaos` strikes some 300 times and prints a table; a short form is a test. The seed decides what strikes, in which
//! phase and how late in it; the machine decides where that is exactly.

#[path = "../slurm/cluster.rs"]
#[allow(dead_code, reason = "the tests of Slurm use the rest")]
mod cluster;
mod end;
mod judge;
mod plan;
#[path = "../self_check/proxy.rs"]
#[allow(dead_code, reason = "the tests of the self-check use the rest")]
mod proxy;
mod scene;
mod strike;
mod study;
#[path = "../live/support.rs"]
#[allow(dead_code, reason = "the other tests against SUMO use the rest")]
mod support;

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use cluster::Cluster;
use judge::Verdict;
use plan::{Kind, Phase, Plan};
use scene::Scene;
use study::{Studies, struck_slurm};
use sumo_mfc::random::Stream;

/// The study of the strikes at Slurm.
const STUDY: [&str; 11] = [
    "sweep",
    "scenarios/motorway.toml",
    "--vary",
    "controller.name=ideal,pid",
    "--reference",
    "controller.name=ideal",
    "--seeds",
    "1,2",
    "--end",
    "60",
    "-q",
];

/// At most so many runs are under way at a time.
const AT_ONCE: usize = 2;

/// A line of the table.
#[derive(Default)]
struct Line {
    tried: usize,
    phases: BTreeMap<Phase, usize>,
    rows_known: usize,
    rows_lost: usize,
    hung: usize,
    left: usize,
    wrong: usize,
}

impl Line {
    fn add(&mut self, verdict: &Verdict) {
        self.tried += 1;
        *self.phases.entry(verdict.phase).or_default() += 1;
        self.rows_known += verdict.rows_known;
        self.rows_lost += verdict.rows_lost;
        self.hung += usize::from(verdict.hung);
        self.left += verdict.left;
        self.wrong += usize::from(verdict.wrong);
    }

    fn failures(&self) -> usize {
        self.rows_lost + self.hung + self.left + self.wrong
    }

    fn print(&self, name: &str) {
        let Self { tried, rows_known, rows_lost, hung, left, wrong, .. } = self;
        let phases: Vec<String> =
            Phase::ALL.iter().map(|p| format!("{:>9}", self.phases.get(p).unwrap_or(&0))).collect();
        println!("{name:<26}{tried:>6}{}{rows_known:>8}{rows_lost:>6}{hung:>6}{left:>6}{wrong:>7}", phases.concat());
    }
}

/// Strikes so many times with this seed, and fails if anything is lost, hangs, or stays behind.
fn chaos(seed: u64, count: usize) {
    let begun = Instant::now();
    let (scene, studies) = (Scene::new(), Studies::new());
    let plans = plan::plans(seed, count);
    println!("chaos_seed={seed} chaos_n={count}, undisturbed: {}", scene.told());
    let (next, lines) = (AtomicUsize::new(0), Mutex::new(BTreeMap::<usize, Line>::new()));
    let note = |kind: Kind, number: usize, verdict: Option<Verdict>| {
        let Some(verdict) = verdict else { return };
        let said = verdict.said.iter().take(3).chain(verdict.said.iter().skip(3).last());
        said.for_each(|said| println!("fault {number}, {}, {:?}: {said}", kind.name(), verdict.phase));
        lines.lock().unwrap().entry(kind.place()).or_default().add(&verdict);
    };
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some((number, plan)) = {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    plans.get(number).map(|plan| (number, plan))
                } {
                    note(plan.kind, number, struck(plan, &scene, &studies));
                }
            });
        }
    });
    for number in 0..plan::at_slurm(count) {
        // One at a time: a node has two processors.
        let Some(cluster) = Cluster::start(1001) else { break };
        let draw = Stream::new(seed, "slurm", &number.to_string()).uniform();
        note(Kind::Slurm, count + number, Some(struck_slurm(&cluster, &studies, draw)));
    }
    let lines = lines.into_inner().unwrap();
    let phases: Vec<String> =
        Phase::ALL.iter().map(|phase| format!("{:>9}", format!("{phase:?}").to_lowercase())).collect();
    println!(
        "{:<26}{:>6}{}{:>8}{:>6}{:>6}{:>6}{:>7}",
        "kind of fault",
        "tried",
        phases.concat(),
        "rows",
        "lost",
        "hung",
        "left",
        "wrong"
    );
    let mut sum = Line::default();
    for (place, line) in &lines {
        line.print(Kind::ALL[*place].0.name());
        sum.tried += line.tried;
        line.phases.iter().for_each(|(phase, count)| *sum.phases.entry(*phase).or_default() += count);
        sum.rows_known += line.rows_known;
        sum.rows_lost += line.rows_lost;
        sum.hung += line.hung;
        sum.left += line.left;
        sum.wrong += line.wrong;
    }
    sum.print("all");
    println!("{:.0} s", begun.elapsed().as_secs_f64());
    let skipped: Vec<_> = Kind::ALL.iter().enumerate().filter(|(place, _)| !lines.contains_key(place)).collect();
    skipped.iter().for_each(|(_, (kind, _))| println!("not tried here: {}", kind.name()));
    assert!(sum.rows_known > sum.tried, "the faults come too early to lose anything: {} rows", sum.rows_known);
    assert_eq!(sum.failures(), 0, "rows lost, hung, left behind, or ended wrongly; chaos_seed={seed} chaos_n={count}");
}

/// `None` where this machine cannot do it.
fn struck(plan: &Plan, scene: &Scene, studies: &Studies) -> Option<Verdict> {
    match plan.kind {
        Kind::Sweep => Some(studies.struck(plan)),
        _ => strike::struck(plan, scene),
    }
}

fn of_environment(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().unwrap_or_else(|_| panic!("{name}={text} is no number")))
}

#[test]
fn law_faults_cost_no_row_and_leave_nothing_behind() {
    chaos(7, 26);
}

/// For `make chaos`.
#[test]
#[ignore = "a quarter of an hour; make chaos"]
fn the_whole_chaos() {
    chaos(of_environment("CHAOS_SEED", 1), of_environment("CHAOS_N", 320) as usize);
}
