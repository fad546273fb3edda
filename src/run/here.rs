//! SUMO in this process, for a run.

use super::error::RunError;
use crate::cosim::{CosimError, LibsumoLink};
use crate::output::file_error;
use crate::traci::{Error, SumoBinary, last_words};
use std::fs::File;
use std::path::PathBuf;
use sumo_mfc_libsumo::{self as libsumo, Library};
use tokio::sync::oneshot;

/// The stack of the thread that loads, as large as that of a program's first thread.
const STACK_BYTES: usize = 8 << 20;

/// A SUMO in this process, and where it prints.
pub(super) struct Here {
    log: PathBuf,
}

/// SUMO's library beside its binary, loaded and of the right version.
pub(super) fn library(binary: &SumoBinary) -> Result<Library, libsumo::Error> {
    Library::load(&libsumo::find(&binary.path)?)
}

/// The version of that library.
///
/// # Errors
/// Why there is none, in words.
pub fn version(binary: &SumoBinary) -> Result<String, String> {
    library(binary).map(|library| library.version().1).map_err(|error| error.to_string())
}

impl Here {
    /// SUMO's printing goes into `folder`, as that of a process does.
    pub fn new(folder: PathBuf) -> Result<Self, RunError> {
        let log = folder.join("console.log");
        File::create(&log).map_err(file_error("create", &log))?;
        Ok(Self { log })
    }

    /// Loads the simulation, in a thread of its own: meanwhile signals are heard.
    pub async fn load(
        &self,
        library: Library,
        arguments: Vec<String>,
        home: Option<PathBuf>,
    ) -> Result<LibsumoLink, RunError> {
        tracing::debug!("loading SUMO in this process");
        let (done, loaded) = oneshot::channel();
        let log = self.log.clone();
        let load = move || {
            // Whoever has been told to stop does not wait for it.
            let _ = done.send(library.start(&arguments, home.as_deref(), &log));
        };
        let thread = std::thread::Builder::new().name("SUMO".to_owned()).stack_size(STACK_BYTES);
        thread.spawn(load).map_err(|error| RunError::System(error.to_string()))?;
        let simulation = loaded.await.map_err(|error| RunError::System(error.to_string()))?;
        Ok(LibsumoLink::new(simulation.map_err(CosimError::from)?))
    }

    /// More of an error: what SUMO said last, as of a process that has ended.
    pub fn explain(&self, error: libsumo::Error) -> RunError {
        if !matches!(error, libsumo::Error::Load(_) | libsumo::Error::Failed(_)) {
            return CosimError::from(error).into();
        }
        let said = last_words(&self.log);
        let report = if said.is_empty() { error.to_string() } else { said };
        Error::Died { status: "in this process".to_owned(), report }.into()
    }
}
