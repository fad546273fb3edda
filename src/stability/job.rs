//! What is examined at a time.

/// One law behind one set of actuators.
pub struct Job {
    pub controller: String,
    pub lag_s: f64,
    pub delay_s: f64,
}
