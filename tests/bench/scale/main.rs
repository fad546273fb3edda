//! End to end against real SUMO: how much longer a step takes with a body and a controller for every car.
//!
//! ```text
//! .ci/with-sumo cargo bench --bench scale [-- CARS...] [-- foreign]
//! ```
//! Per number of cars all loops run side by side, each with its own SUMO, loaded from the same saved state with all cars
//! on the road. They take turns, a few steps each; a ratio is that of two loops within one round, and the figure is the
//! median over the rounds, so that what else the machine does meets both sides. "SUMO alone" is the same binary stepped
//! over TraCI by the same client with no other command. Loading is not in it.
//!
//! Networks and states are made when needed, below `target/bench`, where `scale.csv` and `scale.svg` are left too.

mod bare;
mod loops;
mod plot;

use loops::{Kind, Loop};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use sumo_mfc::traci::{SumoBinary, find_sumo};

/// Time at which all cars have departed, and at which the loops begin [s].
const BEGIN_S: &str = "70";

/// A figure: a loop at a number of cars.
pub struct Figure {
    /// Where.
    pub scene: String,
    /// Which loop.
    pub name: String,
    /// Cars on the road, mean over the rounds.
    pub cars: f64,
    /// Median time of a step [ms].
    pub step_ms: f64,
    /// Median of the ratios to SUMO alone.
    pub ratio: f64,
    /// Smallest and largest ratio.
    pub range: [f64; 2],
    /// The same of the processor time that SUMO and its client spend together; what others do on the machine hardly
    /// changes it, but a second thread does not lower it.
    pub processor_ratio: f64,
}

/// What is measured, and how long.
struct Scene {
    name: String,
    config: PathBuf,
    state: Option<PathBuf>,
    step_s: f64,
    rounds: usize,
    /// Steps of a turn, and of a turn of the Python loop with one command per value.
    steps: [u32; 2],
    kinds: Vec<Kind>,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let sumo = find_sumo(None).expect("a SUMO: .ci/with-sumo cargo bench --bench scale");
    let wanted = |name: &str| arguments.is_empty() || arguments.iter().any(|a| a == name);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/bench");
    std::fs::create_dir_all(&folder).expect("a folder for the figures");
    let mut scenes: Vec<Scene> = Vec::new();
    for cars in [100, 1_000, 5_000, 20_000] {
        if wanted(&cars.to_string()) {
            scenes.push(grid(&folder, &sumo, cars));
        }
    }
    if wanted("foreign") {
        scenes.extend(foreign("1").into_iter().chain(foreign("0.1")));
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let table = folder.join("scale.csv");
    for scene in &scenes {
        let new = runtime.block_on(measure(scene, &sumo));
        // Scenes that are not measured now keep their figures.
        let mut figures = read_csv(&table);
        figures.retain(|f| f.scene != scene.name);
        figures.extend(new);
        figures.sort_by(|a, b| a.scene.len().cmp(&b.scene.len()).then(a.scene.cmp(&b.scene)));
        write_csv(&table, &figures).expect("writing target/bench/scale.csv");
        plot::draw(&folder.join("scale.svg"), &figures).expect("drawing target/bench/scale.svg");
    }
}

/// The grid with this number of cars.
fn grid(folder: &Path, sumo: &SumoBinary, cars: u32) -> Scene {
    let folder = folder.join(cars.to_string());
    let state = folder.join("state.xml.gz");
    let config = folder.join("large.sumocfg");
    if !state.exists() {
        eprintln!("making a network with {cars} cars in {}", folder.display());
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/large/make.sh");
        let mut make = Command::new(script);
        make.arg(&folder).arg(cars.to_string());
        if let Some(home) = &sumo.home {
            make.env("MAKE_SUMO_HOME", std::path::absolute(home).expect("an absolute path"));
        }
        succeed(&mut make);
        let part = folder.join("part.xml.gz");
        let mut run = loops::sumo_command(sumo, &config);
        run.args(["--end", "71", "--save-state.times", BEGIN_S, "--save-state.files"]).arg(&part);
        succeed(&mut run);
        std::fs::rename(part, &state).expect("the saved state");
    }
    let mut kinds = vec![Kind::Plain, Kind::Ideal, Kind::Adaptive, Kind::AdaptiveAvx2];
    kinds.extend([Kind::BareSubscriptions, Kind::BareGets, Kind::PythonSubscriptions, Kind::PythonValues]);
    let steps = match cars {
        0..=1_000 => [10, 3],
        1_001..=5_000 => [10, 1],
        _ => [10, 1],
    };
    Scene {
        name: format!("grid {cars}"),
        config,
        state: Some(state),
        step_s: 0.1,
        rounds: if cars > 5_000 { 5 } else { 15 },
        steps,
        kinds,
    }
}

/// A network that is not ours, from its beginning: five minutes of it.
fn foreign(step: &str) -> Option<Scene> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(".sumo");
    let libs = ["sumo-rl", "rl"].iter().flat_map(|name| std::fs::read_dir(root.join(name).join("lib"))).flatten();
    let mut configs = libs
        .flatten()
        .map(|python| python.path().join("site-packages/sumo_rl/nets/RESCO/ingolstadt21/ingolstadt21.sumocfg"));
    let config = configs.find(|c| c.is_file())?;
    let step_s: f64 = step.parse().expect("a number");
    let steps = (60.0 / step_s).round() as u32;
    Some(Scene {
        name: format!("ingolstadt21, step {step} s"),
        config,
        state: None,
        step_s,
        rounds: 5,
        steps: [steps, steps],
        kinds: vec![Kind::Plain, Kind::Ideal, Kind::Adaptive, Kind::AdaptiveAvx2],
    })
}

fn succeed(command: &mut Command) {
    let status = command.stdout(std::process::Stdio::null()).status();
    assert!(status.as_ref().is_ok_and(|s| s.success()), "{command:?}: {status:?}");
}

/// Starts all loops of a scene and lets them take turns.
async fn measure(scene: &Scene, sumo: &SumoBinary) -> Vec<Figure> {
    let logs = tempfile::tempdir().expect("a temporary folder");
    let mut loops = Vec::new();
    for kind in &scene.kinds {
        let log = logs.path().join(kind.name().replace(' ', "_"));
        std::fs::create_dir(&log).expect("a folder for the log");
        loops.push(Loop::start(*kind, sumo, &scene.config, scene.state.as_deref(), scene.step_s, &log).await);
    }
    let mut turns = vec![Vec::new(); loops.len()];
    let mut cars = Vec::new();
    // With a state to begin from, the first turn only lets buffers grow.
    for round in 0..scene.rounds + usize::from(scene.state.is_some()) {
        for (one, turns) in loops.iter_mut().zip(&mut turns) {
            let steps = scene.steps[usize::from(one.kind == Kind::PythonValues)];
            let turn = one.turn(steps).await.map(|time_s| 1e3 * time_s / f64::from(steps));
            if round > 0 || scene.state.is_none() {
                turns.push(turn);
            }
        }
        cars.extend(loops.iter().filter_map(Loop::cars).max());
    }
    for one in loops {
        one.end().await;
    }
    let cars = cars.iter().map(|n| *n as f64).sum::<f64>() / cars.len() as f64;
    figures(scene, cars, &turns)
}

/// Turns times (passed, and the processor's) into figures, and prints them.
fn figures(scene: &Scene, cars: f64, turns: &[Vec<[f64; 2]>]) -> Vec<Figure> {
    let one = |(kind, mine): (&Kind, &Vec<[f64; 2]>)| {
        let ratios = |which: usize| {
            let mut ratios: Vec<f64> = mine.iter().zip(&turns[0]).map(|(a, b)| a[which] / b[which]).collect();
            (median(&mut ratios), [ratios[0], ratios[ratios.len() - 1]])
        };
        let step_ms = median(&mut mine.iter().map(|turn| turn[0]).collect::<Vec<_>>());
        let ((ratio, range), (processor_ratio, _)) = (ratios(0), ratios(1));
        let (scene, name, [low, high]) = (scene.name.clone(), kind.name().to_owned(), range);
        println!(
            "{scene:24} {name:20} {cars:6.0} cars {step_ms:9.3} ms/step {ratio:6.2} x SUMO alone \
             ({low:.2} to {high:.2}), processor {processor_ratio:6.2} x"
        );
        Figure { scene, name, cars, step_ms, ratio, range, processor_ratio }
    };
    scene.kinds.iter().zip(turns).map(one).collect()
}

/// Sorts, too.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn write_csv(path: &Path, figures: &[Figure]) -> std::io::Result<()> {
    let mut out = std::fs::File::create(path)?;
    writeln!(out, "scene,loop,cars,step_ms,ratio,ratio_min,ratio_max,processor_ratio")?;
    for f in figures {
        let [low, high] = f.range;
        writeln!(
            out,
            "{:?},{},{:.0},{:.4},{:.3},{low:.3},{high:.3},{:.3}",
            f.scene, f.name, f.cars, f.step_ms, f.ratio, f.processor_ratio
        )?;
    }
    Ok(())
}

/// What earlier runs have left; nothing if there is no table yet.
fn read_csv(path: &Path) -> Vec<Figure> {
    let Ok(mut table) = csv::Reader::from_path(path) else { return Vec::new() };
    let figure = |row: csv::StringRecord| {
        let number = |column: usize| row.get(column)?.parse::<f64>().ok();
        Some(Figure {
            scene: row.get(0)?.to_owned(),
            name: row.get(1)?.to_owned(),
            cars: number(2)?,
            step_ms: number(3)?,
            ratio: number(4)?,
            range: [number(5)?, number(6)?],
            processor_ratio: number(7)?,
        })
    };
    table.records().flatten().filter_map(figure).collect()
}
