//! Cases on a Slurm cluster: job arrays run them, and a job that depends on the arrays writes the tables.
//!
//! What is submitted is written down first: `slurm/0001.json` names the job and the cases of its tasks, and `slurm/0001/`
//! holds a *ticket* for each of these cases, the planned `run.json`. A task runs only cases that it finds a ticket for, and
//! takes the ticket away when the case has ended. So a ticket without a job in the queue is a case whose task was lost, a
//! case cannot run twice however late a job turns up, and a task that Slurm starts again does only what is left.
//!
//! A call that is killed between writing and submitting leaves a file without a job number. The next call looks for the job by
//! its name, which no other job has.

mod command;
mod keys;
mod queue;
mod submission;
mod submit;
mod task;

pub use keys::SlurmKeys;
pub use queue::standing;
pub use submit::execute;
pub use task::run_task;
