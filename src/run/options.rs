//! What a session is told beside its scenario.

use super::backend::Backend;
use std::path::PathBuf;

/// Where a session writes; nothing here changes its result.
#[derive(Debug, Clone, Default)]
pub struct SessionOptions {
    /// Folder of the result.
    pub out_dir: PathBuf,
    /// Replace a finished result.
    pub force: bool,
    /// SUMO's binary; searched for if it is not given.
    pub sumo: Option<PathBuf>,
    /// How SUMO is reached.
    pub backend: Backend,
    /// Measure where the time of a step goes.
    pub profile: bool,
    /// Is told what the user should know while the session goes on.
    pub tell: Option<fn(&str)>,
}

impl SessionOptions {
    /// Tells the user something.
    pub(super) fn tell(&self, line: &str) {
        if let Some(tell) = self.tell {
            tell(line);
        }
    }
}
