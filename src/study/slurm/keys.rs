//! What the user asks of Slurm.

use crate::keys;

keys! {
    /// The table `[slurm]` of a study. Texts are passed on to `sbatch` as they are.
    pub struct SlurmKeys {
        /// partition whose nodes run the cases
        partition: Option<String>;
        /// account that is charged
        account: Option<String>;
        /// longest time of one task: minutes, HH:MM:SS or D-HH:MM:SS
        time: Option<String>;
        /// memory of one task: 2G
        memory: Option<String>;
        /// most tasks at the same time
        throttle: Option<u32>, "-", 1..=1_000_000;
        /// cases that one task runs, one after the other
        cases_per_task: u32 = 1, "-", 1..=1_000_000;
        /// further arguments of sbatch
        sbatch: Vec<String>;
    }
}
