//! The loops that are compared, each with a SUMO of its own.

use super::bare::Bare;
use std::future::{Future, poll_fn};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::pin::pin;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use sumo_mfc::cosim::World;
use sumo_mfc::lanes::InstructionSet;
use sumo_mfc::run;
use sumo_mfc::scenario::{Catalog, Override, Request, Scenario};
use sumo_mfc::traci::{Batch, Client, SumoBinary, SumoProcess};

const PATIENCE: Duration = Duration::from_secs(600);

/// Which loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Steps and nothing else.
    Plain,
    /// Ours without bodies.
    Ideal,
    /// Ours with bodies and the adaptive controller.
    Adaptive,
    /// The same without AVX-512.
    AdaptiveAvx2,
    /// The bare exchange: speeds sent back, speed and angle read by subscription.
    BareSubscriptions,
    /// The bare exchange with gets in a second message, written together with the first.
    BareGets,
    /// SUMO's Python library with subscriptions, no bodies.
    PythonSubscriptions,
    /// SUMO's Python library with one command per value, no bodies.
    PythonValues,
}

impl Kind {
    /// As it is printed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "SUMO alone",
            Self::Ideal => "ideal",
            Self::Adaptive => "adaptive",
            Self::AdaptiveAvx2 => "adaptive AVX2",
            Self::BareSubscriptions => "bare subscriptions",
            Self::BareGets => "bare gets",
            Self::PythonSubscriptions => "Python subscriptions",
            Self::PythonValues => "Python one by one",
        }
    }
}

enum Driver {
    Plain(Box<Client>, Batch),
    Ours(Box<World>),
    Bare(Box<Bare>),
    Python(Child, BufReader<std::process::ChildStdout>),
}

/// A loop under way.
pub struct Loop {
    /// Which one.
    pub kind: Kind,
    driver: Driver,
    sumo: SumoProcess,
}

/// SUMO on a configuration, quiet.
pub fn sumo_command(sumo: &SumoBinary, config: &Path) -> Command {
    let mut command = Command::new(&sumo.path);
    command.arg("-c").arg(config).args(["--no-step-log", "--no-warnings"]);
    if let Some(home) = &sumo.home {
        command.env("SUMO_HOME", home);
    }
    command
}

impl Loop {
    /// Starts SUMO and connects the loop to it.
    pub async fn start(
        kind: Kind,
        sumo: &SumoBinary,
        config: &Path,
        state: Option<&Path>,
        step_s: f64,
        log: &Path,
    ) -> Self {
        let step = step_s.to_string();
        let mut line = ["-c", &config.to_string_lossy(), "--no-step-log", "--no-warnings", "--step-length", &step]
            .map(str::to_owned)
            .to_vec();
        line.extend(["--step-method.ballistic", "true"].map(str::to_owned));
        if let Some(state) = state {
            line.extend(["--load-state".to_owned(), state.to_string_lossy().into_owned()]);
        }
        let mut process = SumoProcess::spawn(sumo, &line, None, log).expect("SUMO starts");
        let driver = match kind {
            Kind::PythonSubscriptions => python("subscriptions", sumo, process.port()),
            Kind::PythonValues => python("values", sumo, process.port()),
            Kind::Plain => {
                let mut batch = Batch::new();
                batch.step().expect("a batch with one step");
                Driver::Plain(Box::new(process.connect(PATIENCE).await.expect("SUMO answers")), batch)
            }
            Kind::BareSubscriptions | Kind::BareGets => {
                let client = process.connect(PATIENCE).await.expect("SUMO answers");
                Driver::Bare(Box::new(Bare::new(client, kind == Kind::BareSubscriptions).await))
            }
            Kind::Ideal | Kind::Adaptive | Kind::AdaptiveAvx2 => {
                let client = process.connect(PATIENCE).await.expect("SUMO answers");
                Driver::Ours(Box::new(ours(kind, client, config, step_s).await))
            }
        };
        Self { kind, driver, sumo: process }
    }

    /// Makes steps; the seconds that passed, and the processor's of SUMO and its client together.
    pub async fn turn(&mut self, count: u32) -> [f64; 2] {
        let before_s = self.processor_s();
        let passed_s = self.steps(count).await;
        [passed_s, self.processor_s() - before_s]
    }

    /// Processor time so far of SUMO and of its client [s]. Ours is this process.
    fn processor_s(&self) -> f64 {
        let client = match &self.driver {
            Driver::Python(child, _) => child.id(),
            _ => std::process::id(),
        };
        [Some(client), self.sumo.id()].into_iter().flatten().map(processor_s).sum()
    }

    /// Makes steps; the seconds that passed.
    async fn steps(&mut self, count: u32) -> f64 {
        let begin = Instant::now();
        match &mut self.driver {
            Driver::Plain(client, batch) => {
                for _ in 0..count {
                    client.exchange(batch).await.expect("SUMO steps");
                }
            }
            Driver::Ours(world) => {
                let avx2 = self.kind == Kind::AdaptiveAvx2;
                let set = if avx2 { InstructionSet::Avx2 } else { InstructionSet::in_use() };
                for _ in 0..count {
                    with(set, world.step()).await.expect("a step");
                    // Whoever runs a world takes these in every step.
                    world.take_finished();
                    world.take_admitted();
                }
            }
            Driver::Bare(bare) => {
                for _ in 0..count {
                    bare.step().await;
                }
            }
            Driver::Python(child, answers) => {
                writeln!(child.stdin.as_mut().expect("a pipe"), "{count}").expect("Python listens");
                return answer(answers).parse().expect("seconds");
            }
        }
        begin.elapsed().as_secs_f64()
    }

    /// Cars in the loop.
    pub fn cars(&self) -> Option<usize> {
        match &self.driver {
            Driver::Ours(world) => Some(world.egos().len()),
            _ => None,
        }
    }

    /// Leaves SUMO.
    pub async fn end(self) {
        match self.driver {
            Driver::Bare(bare) => bare.client.close().await.expect("SUMO closes"),
            Driver::Plain(client, _) => client.close().await.expect("SUMO closes"),
            Driver::Ours(world) => world.close().await.1.expect("SUMO closes"),
            Driver::Python(mut child, _) => {
                drop(child.stdin.take());
                child.wait().expect("Python ends");
            }
        }
        self.sumo.shut_down(Duration::from_secs(60)).await.expect("SUMO ends");
    }
}

/// Work that computes with one instruction set.
async fn with<T>(set: InstructionSet, work: impl Future<Output = T>) -> T {
    let mut work = pin!(work);
    poll_fn(|context| set.during(|| work.as_mut().poll(context))).await
}

/// Our loop with every car equipped.
async fn ours(kind: Kind, client: Client, config: &Path, step_s: f64) -> World {
    let controller = if kind == Kind::Ideal { "ideal" } else { "adaptive" };
    let request = Request::file(config)
        .with(Override::text("--controller", "controller.name", controller))
        .with(Override::literal("--step-length", "sumo.step_length_s", step_s));
    let scenario = Scenario::load(&request, &Catalog::installed()).expect("a scenario");
    let setup = run::world(&scenario).expect("a world");
    World::join(client, setup).await.expect("a world that joins")
}

fn python(how: &str, sumo: &SumoBinary, port: u16) -> Driver {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bench/peer.py");
    let tools = sumo.home.as_ref().expect("SUMO_HOME, for its Python library").join("tools");
    let mut command = Command::new("python3");
    command.arg(script).arg(port.to_string()).arg(how).env("PYTHONPATH", tools);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("python3");
    let mut answers = BufReader::new(child.stdout.take().expect("a pipe"));
    while answer(&mut answers) != "ready" {}
    Driver::Python(child, answers)
}

fn answer(answers: &mut BufReader<std::process::ChildStdout>) -> String {
    let mut line = String::new();
    let length = answers.read_line(&mut line).expect("an answer of Python's");
    assert!(length > 0, "the Python loop broke off");
    line.trim().to_owned()
}

/// Processor time of all threads of a process [s], as Linux counts it; 0 elsewhere.
fn processor_s(process: u32) -> f64 {
    let tasks = std::fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten();
    let spent = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("schedstat")).ok());
    let nanoseconds = spent.filter_map(|line| line.split(' ').next()?.parse::<f64>().ok());
    1e-9 * nanoseconds.sum::<f64>()
}
