//! Outputs that SUMO writes in every step. Where the step is made shorter than the configuration's, they keep their
//! sampling, as far as SUMO has an option for it: their files would grow as the number of steps does.

use super::settings::Settings;

/// Outputs of every step, with the option that sets their period (SUMO 1.15 to 1.28), if there is one.
const EVERY_STEP: &[(&str, Option<&str>)] = &[
    ("fcd-output", Some("device.fcd.period")),
    ("person-fcd-output", Some("person-device.fcd.period")),
    ("emission-output", Some("device.emissions.period")),
    ("summary-output", Some("summary-output.period")),
    ("queue-output", Some("queue-output.period")),
    ("netstate-dump", None),
    ("full-output", None),
    ("vtk-output", None),
    ("amitran-output", None),
    ("battery-output", None),
    ("elechybrid-output", None),
    ("link-output", None),
];

/// What becomes of the outputs of a configuration under a shorter step.
#[derive(Debug, Default)]
pub(super) struct Sampling {
    /// Options that keep the configuration's step as the period, with that period.
    pub periods: Vec<(&'static str, String)>,
    /// The outputs that keep their period by them.
    kept: Vec<&'static str>,
    /// The outputs that cannot.
    grown: Vec<&'static str>,
}

impl Sampling {
    /// For steps of `step_s` \[s\].
    pub fn of(settings: &Settings, step_s: f64) -> Self {
        let mut sampling = Self::default();
        let theirs_s = settings.step_s().unwrap_or(step_s);
        if settings.configuration.is_none() || theirs_s < step_s + 1e-9 {
            return sampling;
        }
        let whole = ((theirs_s / step_s).round() * step_s - theirs_s).abs() < 1e-9;
        for (output, period) in EVERY_STEP.iter().filter(|(output, _)| settings.value(output).is_some()) {
            match period {
                Some(period) if settings.value(period).is_some() => {}
                Some(period) if whole => {
                    sampling.periods.push((period, theirs_s.to_string()));
                    sampling.kept.push(output);
                }
                _ => sampling.grown.push(output),
            }
        }
        sampling
    }

    /// What the user should know.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        let line =
            |outputs: &[&str], what: &str| (!outputs.is_empty()).then(|| format!("{} {what}", outputs.join(", ")));
        let kept = line(&self.kept, "sampled as before");
        kept.into_iter().chain(line(&self.grown, "larger, with a sample in each of the shorter steps"))
    }
}
