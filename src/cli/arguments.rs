//! The arguments of the command line, as clap sees them.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Args, Parser, Subcommand, ValueHint};
use clap_complete::Shell;

use super::help::{self, CASES, CONTROLLER, GENERAL, OUTPUT, SCENARIO, STUDY, SUMO};
use super::shared::{ExportArgs, set};
use super::stability::StabilityArgs;
use super::tuning::TuneArgs;
use crate::{
    report,
    run::Backend,
    scenario::{Override, Request},
    study::Arguments,
};

/// What the program is called.
pub const PROGRAM: &str = "sumo-mfc";

/// Gives every equipped car of a SUMO simulation a 7-DoF body and a model-free speed controller
#[derive(Debug, Parser)]
#[command(name = PROGRAM, version, about, max_term_width = 120, after_help = help::MAIN)]
#[command(disable_help_flag = true, disable_version_flag = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Print this help
    #[arg(short, long, global = true, action = ArgAction::Help, help_heading = GENERAL, display_order = 1000)]
    help: Option<bool>,
    /// Print the version
    #[arg(short = 'V', long, action = ArgAction::Version, help_heading = GENERAL)]
    version: Option<bool>,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario in SUMO and write error statistics per vehicle
    #[command(after_help = help::RUN)]
    Run(Box<RunArgs>),
    /// Run a scenario with several controllers on the same traffic and compare them
    #[command(after_help = help::COMPARE)]
    Compare(Box<CompareArgs>),
    /// Run a scenario under many settings and seeds and compare them: a study file, or keys to vary
    #[command(after_help = help::SWEEP)]
    Sweep(Box<SweepArgs>),
    /// Make one HTML page of a result folder of run, compare or sweep, or of two side by side
    #[command(after_help = help::REPORT)]
    Report(ReportArgs),
    /// Make tables of what a run has left that was killed
    #[command(after_help = help::RECOVER)]
    Recover(RecoverArgs),
    /// Check a scenario and print it resolved, in SI units, as TOML
    #[command(after_help = help::CHECK)]
    Check(Box<CheckArgs>),
    /// Reproduce the experiments of the paper, without SUMO: figures, tables and one page
    #[command(after_help = help::PAPER)]
    Paper(PaperArgs),
    /// Find the best gains of each law by the same search, and judge them on other recordings, without SUMO
    #[command(after_help = help::TUNE)]
    Tune(TuneArgs),
    /// How stable is each law, and a string of vehicles under it? Margins and gains, without SUMO
    #[command(after_help = help::STABILITY)]
    Stability(StabilityArgs),
    /// List controllers, targets, plants and bodies: kind, name, summary
    #[command(after_help = help::LIST)]
    List(ListArgs),
    /// Find SUMO, make one real step, and check the coupling
    #[command(after_help = help::DOCTOR)]
    Doctor,
    /// Print the completions of a shell
    #[command(after_help = help::COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Print the manual page, or write it and those of all subcommands into a folder
    #[command(after_help = help::MAN)]
    Man(ManArgs),
    /// Run the cases of one task of a job array, which the executor slurm has submitted
    #[command(hide = true)]
    SlurmTask(SlurmTaskArgs),
}

/// Which scenario, and what is different from its file.
#[derive(Debug, Args)]
pub struct ScenarioArgs {
    /// A scenario (.toml) or any SUMO configuration (.sumocfg)
    #[arg(value_name = "SCENARIO", conflicts_with_all = ["net", "routes"])]
    scenario: Option<PathBuf>,
    /// A SUMO network, in place of a scenario
    #[arg(long, value_name = "FILE", help_heading = SCENARIO, value_hint = ValueHint::FilePath)]
    net: Option<String>,
    /// Route files for --net
    #[arg(long, value_name = "FILE", num_args = 1.., requires = "net", help_heading = SCENARIO, value_hint = ValueHint::FilePath)]
    routes: Vec<String>,
    /// Speed controller (see `sumo-mfc list`) [default: that of the scenario, or adaptive]
    #[arg(long, value_name = "NAME", help_heading = CONTROLLER)]
    controller: Option<String>,
    /// Where the target speed comes from (see `sumo-mfc list`) [default: that of the scenario, or traffic]
    #[arg(long, value_name = "NAME", help_heading = CONTROLLER)]
    target: Option<String>,
    /// Equipped vehicles: all | param | type:GLOB | id:REGEX | class:NAME | share:0.25 [default: that of the scenario, or all]
    #[arg(long, value_name = "SELECTOR", help_heading = CONTROLLER)]
    egos: Option<String>,
    /// Seed of SUMO and of everything drawn here [default: that of the scenario or configuration]
    #[arg(long, value_name = "N", allow_negative_numbers = true, help_heading = SCENARIO)]
    seed: Option<String>,
    /// Simulation time at which the run ends (s) [default: that of the scenario or configuration]
    #[arg(long, value_name = "S", allow_negative_numbers = true, help_heading = SCENARIO)]
    end: Option<String>,
    /// SUMO's step length (s) [default: that of the scenario, or 0.1]
    #[arg(long, value_name = "S", allow_negative_numbers = true, help_heading = SUMO)]
    step_length: Option<String>,
    /// Averaging of a recording that is the target, 10 Hz or more (s); 0 = off [default: 1]
    #[arg(long, value_name = "S", help_heading = SCENARIO)]
    smooth_s: Option<f64>,
    /// Any other key of the scenario, by its TOML path: controller.k_p=1.2
    #[arg(long, value_name = "KEY=VALUE", value_parser = set, help_heading = SCENARIO)]
    set: Vec<Override>,
    /// Trace these vehicles (ids separated by commas) or all [default: none]
    #[arg(long, value_name = "IDS|all", help_heading = OUTPUT)]
    trace: Option<String>,
    /// Time between rows of the trace (s) [default: SUMO's step]
    #[arg(long, value_name = "S", allow_negative_numbers = true, help_heading = OUTPUT)]
    trace_period: Option<String>,
    /// Name of the table of vehicles; .csv, .parquet or .xml chooses the format [default: vehicles.csv]
    #[arg(long, value_name = "NAME", help_heading = OUTPUT)]
    vehicles_output: Option<String>,
    /// Name of the trace; .csv, .parquet or .xml chooses the format [default: trace.csv]
    #[arg(long, value_name = "NAME", help_heading = OUTPUT)]
    trace_output: Option<String>,
    /// SUMO measures the conflicts of all vehicles: TTC, DRAC, PET (sumo/ssm.xml)
    #[arg(long, help_heading = SUMO)]
    safety: bool,
    /// SUMO's FCD output holds our signals: mfc.err, mfc.torque, mfc.alpha (sumo/fcd.xml)
    #[arg(long, help_heading = SUMO)]
    fcd: bool,
    /// Start sumo-gui; its egos are coloured by their error
    #[arg(long, help_heading = SUMO)]
    gui: bool,
    /// TraCI port [default: a free one]
    #[arg(long, value_name = "N", allow_negative_numbers = true, help_heading = SUMO)]
    port: Option<String>,
    /// TraCI clients that SUMO waits for, this one included [default: 1]
    #[arg(long, value_name = "K", allow_negative_numbers = true, help_heading = SUMO)]
    num_clients: Option<String>,
    /// Join a SUMO that already runs
    #[arg(long, value_name = "HOST:PORT", help_heading = SUMO)]
    connect: Option<String>,
    /// Longest time that SUMO may take to load, and to answer (s) [default: 600]
    #[arg(long, value_name = "S", allow_negative_numbers = true, help_heading = SUMO)]
    timeout: Option<String>,
    /// Options passed on to SUMO
    #[arg(last = true, value_name = "SUMO-OPTIONS", help_heading = SUMO)]
    sumo_options: Vec<String>,
}

/// `run`.
#[derive(Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub scenario: ScenarioArgs,
    /// Repeat the run of this run.json bit for bit
    #[arg(long, value_name = "RUN.JSON", conflicts_with = "ScenarioArgs", help_heading = SCENARIO)]
    pub from: Option<PathBuf>,
    /// Folder of the results [default: out/<scenario>-<controller>-<seed>]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT)]
    pub out: Option<PathBuf>,
    /// Replace a finished result
    #[arg(long, help_heading = OUTPUT)]
    pub force: bool,
    /// Threads [default: all cores]
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), help_heading = GENERAL)]
    pub threads: Option<u16>,
    /// How SUMO is reached: traci (a process of its own), libsumo (in this process), or auto
    #[arg(long, value_name = "NAME", default_value = "traci", value_parser = backend(), help_heading = SUMO)]
    pub backend: Backend,
    /// End as after SIGTERM when standard input ends, and tell how far the run is
    #[arg(long, hide = true)]
    pub tied: bool,
    /// Print where the time of a step goes
    #[arg(long, help_heading = OUTPUT)]
    pub profile: bool,
    /// Write no report.html
    #[arg(long, help_heading = OUTPUT)]
    pub no_report: bool,
    #[command(flatten)]
    pub export: ExportArgs,
    /// Only errors
    #[arg(short, long, conflicts_with = "verbose", help_heading = GENERAL)]
    pub quiet: bool,
    /// More about what happens
    #[arg(short, long, help_heading = GENERAL)]
    pub verbose: bool,
}

/// What `sweep` and `compare` have in common.
#[derive(Debug, Args)]
pub struct StudyArgs {
    #[command(flatten)]
    pub scenario: ScenarioArgs,
    /// Seeds: 1..10 (both included) or a list separated by commas [default: 1..5]
    #[arg(long, value_name = "SEEDS", allow_hyphen_values = true, help_heading = STUDY)]
    pub seeds: Option<String>,
    /// Time that SUMO alone simulates once per seed, before the cases begin (s) [default: 0]
    #[arg(long, value_name = "S", help_heading = STUDY)]
    pub warm_up: Option<String>,
    /// Resamples of the studentised bootstrap of every difference, beside the t interval [default: 0]
    #[arg(long, value_name = "N", help_heading = STUDY)]
    pub bootstrap: Option<String>,
    /// Cases at the same time [default: all cores]
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), help_heading = CASES)]
    pub jobs: Option<u16>,
    /// How the cases reach SUMO: traci (a process of its own), libsumo (in the process of the case), or auto
    #[arg(long, value_name = "NAME", default_value = "traci", value_parser = backend(), help_heading = CASES)]
    pub backend: Backend,
    /// Who runs the cases: local, or slurm (job arrays; returns when they are submitted)
    #[arg(long, value_name = "NAME", default_value = "local", help_heading = CASES)]
    pub executor: String,
    /// What Slurm is asked for: partition, account, time, memory, throttle, cases_per_task, sbatch (further arguments)
    #[arg(long, value_name = "KEY=VALUE", value_parser = pair, help_heading = CASES)]
    pub slurm: Vec<String>,
    /// Stay until all cases have ended, also where Slurm runs them
    #[arg(long, help_heading = CASES)]
    pub wait: bool,
    /// Run only every Nth case, from the Ith on; --collect makes the tables when all are there
    #[arg(long, value_name = "I/N", help_heading = CASES)]
    pub shard: Option<String>,
    /// Folder of the results [default: out/<study>, out/<scenario>-sweep or out/<scenario>-compare]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT)]
    pub out: Option<PathBuf>,
    /// List the cases and run nothing
    #[arg(long, group = "instead", help_heading = CASES)]
    pub plan: bool,
    /// Tell how far the cases are and run nothing
    #[arg(long, group = "instead", help_heading = CASES)]
    pub status: bool,
    /// Make the tables from what is there and run nothing
    #[arg(long, group = "instead", help_heading = CASES)]
    pub collect: bool,
    /// Run finished cases again
    #[arg(long, help_heading = CASES)]
    pub force: bool,
    /// Write no report.html
    #[arg(long, help_heading = OUTPUT)]
    pub no_report: bool,
    #[command(flatten)]
    pub export: ExportArgs,
    /// Only errors
    #[arg(short, long, help_heading = GENERAL)]
    pub quiet: bool,
}

/// `slurm-task`.
#[derive(Debug, Args)]
pub struct SlurmTaskArgs {
    /// What was submitted: slurm/NNNN.json in the folder of the study
    pub intent: PathBuf,
    /// The name of the job
    pub name: String,
}

/// `sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    #[command(flatten)]
    pub study: StudyArgs,
    /// Vary a key: KEY=V1,V2,... or KEY=FIRST..LAST..STEP; several make a grid. The controller "plain" is SUMO without us
    #[arg(long, value_name = "KEY=VALUES", value_parser = pair, help_heading = STUDY)]
    vary: Vec<String>,
    /// Compare with the settings in which a key has this value
    #[arg(long, value_name = "KEY=VALUE", value_parser = pair, help_heading = STUDY)]
    reference: Vec<String>,
}

/// `compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    #[command(flatten)]
    pub study: StudyArgs,
    /// Controllers, separated by commas; differences are to the first
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "ideal,classic,adaptive,pid", help_heading = STUDY)]
    controllers: Vec<String>,
}

impl SweepArgs {
    /// The study that they ask for.
    pub fn arguments(&self) -> Arguments {
        let (vary, reference) = (self.vary.clone(), self.reference.clone());
        Arguments { vary, reference, ..self.study.arguments() }
    }
}

impl CompareArgs {
    /// The study that they ask for.
    pub fn arguments(&self) -> Arguments {
        Arguments { controllers: self.controllers.clone(), ..self.study.arguments() }
    }
}

impl StudyArgs {
    fn arguments(&self) -> Arguments {
        Arguments {
            request: self.scenario.request(),
            seeds: self.seeds.clone(),
            warm_up: self.warm_up.clone(),
            bootstrap: self.bootstrap.clone(),
            slurm: self.slurm.clone(),
            ..Arguments::default()
        }
    }
}

fn pair(argument: &str) -> Result<String, String> {
    set(argument).map(|_| argument.to_owned())
}

/// `report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// The result folder; two are shown side by side
    #[arg(required = true, value_name = "DIR", num_args = 1..)]
    dirs: Vec<PathBuf>,
    /// Show this vehicle at once, with its curves as figures
    #[arg(long, value_name = "ID", help_heading = OUTPUT)]
    vehicle: Option<String>,
    /// The page [default: report.html in DIR]; its figures go into the folder of the same name beside it
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT)]
    out: Option<PathBuf>,
    /// Only errors
    #[arg(short, long, help_heading = GENERAL)]
    pub quiet: bool,
}

impl ReportArgs {
    /// The report that they ask for.
    pub fn request(self) -> report::Request {
        report::Request { dirs: self.dirs, out: self.out, vehicle: self.vehicle }
    }
}

/// `recover`.
#[derive(Debug, Args)]
pub struct RecoverArgs {
    /// The folders of the runs
    #[arg(required = true, value_name = "DIR", num_args = 1.., value_hint = ValueHint::DirPath)]
    pub dirs: Vec<PathBuf>,
}

/// `list`.
#[derive(Debug, Args)]
pub struct ListArgs {
    #[command(flatten)]
    pub export: ExportArgs,
}

/// `completions`.
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    pub shell: Shell,
}

/// `man`.
#[derive(Debug, Args)]
pub struct ManArgs {
    /// Folder of the pages; without it the page of the program goes to stdout
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
}

/// `check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    #[command(flatten)]
    pub scenario: ScenarioArgs,
    /// Print every key with its unit, range and default
    #[arg(long, help_heading = OUTPUT)]
    pub template: bool,
    /// Print a JSON schema of the scenario file, for editors
    #[arg(long, conflicts_with = "template", help_heading = OUTPUT)]
    pub schema: bool,
}

/// `paper`.
#[derive(Debug, Args)]
pub struct PaperArgs {
    /// step, sine, driver, delay, disturb, map, or all but the map, which takes longest; record makes a lap
    #[arg(default_value = "all", value_name = "TEST")]
    pub test: String,
    /// Folder of the results
    #[arg(short, long, value_name = "DIR", default_value = "out/paper", help_heading = OUTPUT)]
    pub out: PathBuf,
    /// The map on a coarse grid, to see that it works
    #[arg(long, help_heading = OUTPUT)]
    pub coarse: bool,
    /// Only this preset of scenarios/paper/presets [default: all of them]
    #[arg(long, value_name = "NAME", help_heading = SCENARIO)]
    pub preset: Option<String>,
    /// Seed of the driver that `record` lets drive [default: 1]
    #[arg(long, value_name = "N", help_heading = SCENARIO)]
    pub seed: Option<u64>,
    /// A driver's recording in place of ours: CSV with t,vx or s_m,v_mps (see docs/how-to/recordings.md)
    #[arg(long, value_name = "FILE", help_heading = SCENARIO)]
    pub driver: Option<PathBuf>,
    /// Averaging of a recording of 10 Hz or more (s); 0 = off [default: 1]
    #[arg(long, value_name = "S", help_heading = SCENARIO)]
    smooth_s: Option<f64>,
    /// Any key of the scenarios, by its TOML path: controller.k_p=1.2
    #[arg(long, value_name = "KEY=VALUE", value_parser = set, help_heading = SCENARIO)]
    pub set: Vec<Override>,
    #[command(flatten)]
    pub export: ExportArgs,
    /// Only errors
    #[arg(short, long, help_heading = GENERAL)]
    pub quiet: bool,
}

/// The ways to reach SUMO, by name.
fn backend() -> impl TypedValueParser<Value = Backend> {
    PossibleValuesParser::new(Backend::ALL.map(Backend::name)).try_map(|name| name.parse::<Backend>())
}

fn smoothing(smooth_s: f64) -> Override {
    Override::literal("--smooth-s", "target.smooth_s", smooth_s)
}

impl PaperArgs {
    /// What is different from the files of the tests.
    pub fn overrides(&self) -> Vec<Override> {
        self.smooth_s.map(smoothing).into_iter().chain(self.set.iter().cloned()).collect()
    }
}

impl ScenarioArgs {
    /// What the arguments ask for. `--set` comes last, so that it can refine what the other options choose.
    pub fn request(&self) -> Request {
        let mut overrides = Vec::new();
        let texts = [
            ("--net", "sumo.net", &self.net),
            ("--controller", "controller.name", &self.controller),
            ("--target", "target.name", &self.target),
            ("--egos", "egos.select", &self.egos),
            ("--trace", "output.trace", &self.trace),
            ("--vehicles-output", "output.vehicles", &self.vehicles_output),
            ("--trace-output", "output.trace_file", &self.trace_output),
            ("--connect", "sumo.connect", &self.connect),
        ];
        overrides.extend(texts.iter().filter_map(|(flag, path, v)| Some(Override::text(flag, path, v.as_ref()?))));
        let numbers = [
            ("--seed", "sumo.seed", &self.seed),
            ("--end", "sumo.end_s", &self.end),
            ("--step-length", "sumo.step_length_s", &self.step_length),
            ("--trace-period", "output.trace_period_s", &self.trace_period),
            ("--port", "sumo.port", &self.port),
            ("--num-clients", "sumo.num_clients", &self.num_clients),
            ("--timeout", "sumo.timeout_s", &self.timeout),
        ];
        overrides.extend(numbers.iter().filter_map(|(flag, path, v)| Some(Override::literal(flag, path, v.as_ref()?))));
        if self.safety {
            overrides.push(Override::literal("--safety", "sumo.safety", true));
        }
        if self.fcd {
            overrides.push(Override::literal("--fcd", "sumo.fcd", true));
        }
        if self.gui {
            overrides.push(Override::literal("--gui", "sumo.gui", true));
        }
        if !self.routes.is_empty() {
            overrides.push(Override::texts("--routes", "sumo.routes", &self.routes));
        }
        if !self.sumo_options.is_empty() {
            overrides.push(Override::texts("--", "sumo.options", &self.sumo_options));
        }
        overrides.extend(self.smooth_s.map(smoothing));
        overrides.extend(self.set.iter().cloned());
        Request { scenario: self.scenario.clone(), overrides }
    }
}
