//! Is everything there that a run needs? Finds SUMO, starts it, makes one real step and checks the coupling.

use crate::cosim::{CosimError, TraciLink, WorldSetup, self_check};
use crate::run::{self, RunError};
use crate::scenario::{Catalog, Request, Scenario};
use crate::sumo_files::sumo_arguments;
use crate::traci::{self, Client, SumoBinary, SumoProcess, find_sumo};
use std::fmt;
use std::path::Path;
use std::time::{Duration, Instant};

pub use crate::cosim::self_check::Check;

/// How long SUMO may take to load three roads, or to answer.
const PATIENCE: Duration = Duration::from_secs(30);
/// What to type if the SUMO that was found is of no use.
const ANOTHER_SUMO: &str = "for another SUMO type one of:
  make setup (in a checkout of sumo-mfc), then: export SUMO_HOME=$(echo $PWD/.sumo/1.28.0/lib/python3*/site-packages/sumo)
  export SUMO_HOME=/path/to/sumo";

/// All that was looked at, in order.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// One line each.
    pub checks: Vec<Check>,
}

impl Report {
    /// True if nothing failed.
    pub fn is_well(&self) -> bool {
        self.checks.iter().all(|c| c.passed)
    }

    fn note(&mut self, name: &str, passed: bool, figures: String) {
        self.checks.push(Check { name: name.to_owned(), passed, figures });
    }
}

/// One line per check: `ok` or `failed`, what, and the figures.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for check in &self.checks {
            let verdict = if check.passed { "ok" } else { "failed" };
            writeln!(f, "{verdict:6}  {:41}  {}", check.name, check.figures)?;
        }
        Ok(())
    }
}

/// Looks at the SUMO `given`, or at the one that a run would use, and at the coupling to it. What goes wrong is in the
/// report.
pub fn examine(given: Option<&Path>) -> Report {
    let mut report = Report::default();
    let binary = match find_sumo(given) {
        Ok(binary) => binary,
        Err(error) => {
            report.note("SUMO found", false, error.to_string());
            return report;
        }
    };
    report.note("SUMO found", true, format!("{} (from {})", binary.path.display(), binary.origin));
    #[cfg(feature = "libsumo")]
    note_library(&binary, &mut report);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let done = match runtime {
        Ok(runtime) => runtime.block_on(start(&binary, &mut report)),
        Err(error) => Err(RunError::System(error.to_string())),
    };
    if let Err(error) = done {
        let help = if is_binarys_fault(&error) { format!("\n{ANOTHER_SUMO}") } else { String::new() };
        report.note("SUMO runs", false, format!("{error}{help}"));
    }
    report
}

/// Whether this SUMO can also be run in this process. It need not.
#[cfg(feature = "libsumo")]
fn note_library(binary: &SumoBinary, report: &mut Report) {
    let own = binary.version_text().unwrap_or_default();
    let figures = match run::version_here(binary) {
        Ok(version) if own.ends_with(version.trim_start_matches("SUMO ")) => {
            format!("{version}, for --backend libsumo")
        }
        Ok(version) => format!("no: the library is {version}, the program {own}"),
        Err(why) => format!("no: {why}"),
    };
    report.note("SUMO in this process", true, figures);
}

fn is_binarys_fault(error: &RunError) -> bool {
    use traci::Error::{Connect, Died, Start, TooOld};
    matches!(error, RunError::Traci(TooOld { .. } | Died { .. } | Start { .. } | Connect { .. }))
}

/// Starts SUMO with the scenario of the self-check in a folder of its own, which is gone afterwards.
async fn start(binary: &SumoBinary, report: &mut Report) -> Result<(), RunError> {
    let system = |error: std::io::Error| RunError::System(error.to_string());
    let folder = tempfile::tempdir().map_err(system)?;
    let mut file = folder.path().to_owned();
    for (name, text) in self_check::FILES {
        file = folder.path().join(name);
        std::fs::write(&file, text).map_err(system)?;
    }
    let out = folder.path().join("out");
    std::fs::create_dir_all(out.join("sumo")).map_err(system)?;
    let scenario = Scenario::load(&Request::file(file), &Catalog::installed())?;
    let command = sumo_arguments(&scenario.sumo, &out)?;
    let started = Instant::now();
    let mut process = SumoProcess::spawn(binary, &command.arguments, None, &out)?;
    let client = process.connect(PATIENCE).await?;
    let loaded_s = started.elapsed().as_secs_f64();
    let version = client.version().clone();
    report.note("SUMO runs", true, format!("{}, TraCI API {}, ready after {loaded_s:.2} s", version.text, version.api));
    match drive(client, run::world(&scenario)?, report).await {
        Ok(()) => process.shut_down(PATIENCE).await.map(|_| ()).map_err(RunError::from),
        Err(CosimError::Traci(error)) => Err(process.explain(error).await.into()),
        Err(error) => Err(error.into()),
    }
}

/// One step, then the coupling.
async fn drive(mut client: Client, setup: WorldSetup, report: &mut Report) -> Result<(), CosimError> {
    let before_s = client.get(traci::simulation::TIME, "").await?;
    let started = Instant::now();
    client.step().await?;
    let took_ms = started.elapsed().as_secs_f64() * 1e3;
    let after_s = client.get(traci::simulation::TIME, "").await?;
    report.note("one step", after_s > before_s, format!("from {before_s} s to {after_s} s in {took_ms:.2} ms"));
    report.checks.extend(self_check::examine(TraciLink::new(client, false), setup).await?);
    Ok(())
}
