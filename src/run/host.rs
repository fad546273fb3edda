//! Who runs SUMO: a process that is started for it, this process, or somebody else. Reaching it, and leaving it.

use super::backend::Backend;
#[cfg(not(feature = "libsumo"))]
use super::backend::NOT_BUILT;
use super::error::RunError;
use super::options::SessionOptions;
use super::result::ResultWriter;
use crate::cosim::{CosimError, Link};
use crate::sumo_files::SumoSetup;
use crate::traci::{Client, SumoBinary, SumoProcess, SumoVersion, find_named};
use std::time::Duration;

/// How long SUMO may take to complete its outputs.
const LAST_OUTPUTS: Duration = Duration::from_secs(120);
/// How long a SUMO with other clients may take to end, if they have left it too.
const OTHERS: Duration = Duration::from_secs(2);
/// How long to look for a SUMO that is said to run already.
const REACH: Duration = Duration::from_secs(10);

/// Who runs SUMO.
#[derive(Default)]
pub(super) enum Host {
    /// Somebody else.
    #[default]
    Elsewhere,
    /// A process that we have started.
    Process(Box<SumoProcess>),
    /// This process.
    #[cfg(feature = "libsumo")]
    Here(super::here::Here),
}

/// A SUMO that is reached, with its version.
pub(super) type Reached = (Link, SumoVersion);

impl Host {
    /// Starts SUMO, or joins one that runs.
    pub async fn reach(&mut self, options: &SessionOptions, result: &mut ResultWriter) -> Result<Reached, RunError> {
        let sumo = result.scenario.sumo.clone();
        let sumo_is_shared = sumo.is_shared();
        if let Some(why) = needs_traci(&sumo).filter(|_| options.backend == Backend::Libsumo) {
            return Err(RunError::Backend(why.to_owned()));
        }
        let patience = Duration::from_secs_f64(sumo.timeout_s);
        if let Some(address) = sumo.connect {
            let mut client = Client::join(address, REACH.min(patience), patience).await?;
            client.set_order(1).await?;
            return Ok(over_traci(client, sumo_is_shared));
        }
        let binary = find_named(options.sumo.as_deref(), if sumo.gui { "sumo-gui" } else { "sumo" })?;
        if let Some(reached) = self.here(&binary, options, result).await? {
            return Ok(reached);
        }
        let arguments = result.sumo_command(&binary.path)?;
        *self = Self::Process(Box::new(SumoProcess::spawn(&binary, &arguments, sumo.port, &result.dir.sumo()?)?));
        let Self::Process(process) = self else { unreachable!("it was started") };
        let mut client = process.connect(patience).await?;
        if sumo_is_shared {
            client.set_order(1).await?;
        }
        Ok(over_traci(client, sumo_is_shared))
    }

    /// Loads SUMO into this process, if that is wanted and can be.
    #[cfg(feature = "libsumo")]
    async fn here(
        &mut self,
        binary: &SumoBinary,
        options: &SessionOptions,
        result: &mut ResultWriter,
    ) -> Result<Option<Reached>, RunError> {
        let needs = needs_traci(&result.scenario.sumo);
        if options.backend == Backend::Traci || options.backend == Backend::Auto && needs.is_some() {
            return Ok(None);
        }
        match super::here::library(binary) {
            Ok(library) => {
                let here = super::here::Here::new(result.dir.sumo()?)?;
                let arguments = result.sumo_command(&binary.path)?;
                let link = here.load(library, arguments, binary.home.clone()).await;
                *self = Self::Here(here);
                let link = link?;
                let version = link.version();
                Ok(Some((link.into(), version)))
            }
            Err(why) if options.backend == Backend::Auto => {
                options.tell(&format!("SUMO runs in a process of its own: {why}"));
                Ok(None)
            }
            Err(why) => Err(RunError::Backend(why.to_string())),
        }
    }

    /// This program has no SUMO inside.
    #[cfg(not(feature = "libsumo"))]
    #[expect(clippy::unused_async, reason = "as with the feature")]
    async fn here(
        &mut self,
        _: &SumoBinary,
        options: &SessionOptions,
        _: &mut ResultWriter,
    ) -> Result<Option<Reached>, RunError> {
        match options.backend {
            Backend::Traci => Ok(None),
            Backend::Auto => {
                options.tell(&format!("SUMO runs in a process of its own: {NOT_BUILT}"));
                Ok(None)
            }
            Backend::Libsumo => Err(RunError::Backend(NOT_BUILT.to_owned())),
        }
    }

    /// Waits until SUMO has completed its outputs, if it is ours. It has been left before.
    pub async fn leave(self, result: &mut ResultWriter) -> Result<(), RunError> {
        let sumo = &result.scenario.sumo;
        match self {
            Self::Process(process) if sumo.num_clients > 1 => {
                let others = process.leave(OTHERS).await;
                if others.is_none() {
                    let note = "SUMO goes on for its other clients; its own outputs are not there yet";
                    result.notes.push(note.to_owned());
                }
                others.map_or(Ok(()), |status| result.sumo_ended(status))
            }
            Self::Process(process) => {
                let status = process.shut_down(LAST_OUTPUTS.min(Duration::from_secs_f64(sumo.timeout_s))).await?;
                result.sumo_ended(status)
            }
            #[cfg(feature = "libsumo")]
            Self::Here(_) => {
                result.sumo_has_ended = true;
                Ok(())
            }
            Self::Elsewhere => Ok(()),
        }
    }

    /// Leaves SUMO as it is: a process that is ours is killed. True if what it has written is there to be read.
    pub fn abandon(&mut self) -> bool {
        !matches!(std::mem::take(self), Self::Elsewhere)
    }

    /// More of an error of SUMO: what it said last, if it is ours and has ended.
    pub async fn explain(&mut self, error: RunError) -> RunError {
        match (error, self) {
            (RunError::Cosim(CosimError::Traci(error)), Self::Process(process)) => process.explain(error).await.into(),
            #[cfg(feature = "libsumo")]
            (RunError::Cosim(CosimError::Libsumo(error)), Self::Here(here)) => here.explain(error),
            (error, _) => error,
        }
    }
}

fn over_traci(client: Client, shared: bool) -> Reached {
    let version = client.version().clone();
    (Link::traci(client, shared), version)
}

/// Why this SUMO can be reached over TraCI alone.
fn needs_traci(sumo: &SumoSetup) -> Option<&'static str> {
    let why = [
        (sumo.connect.is_some(), "--connect joins a SUMO that runs elsewhere"),
        (sumo.gui, "sumo-gui runs in a process of its own"),
        (sumo.num_clients > 1, "other clients reach SUMO over TraCI alone"),
        (sumo.port.is_some(), "a port is one of TraCI"),
    ];
    why.into_iter().find_map(|(needed, why)| needed.then_some(why))
}
