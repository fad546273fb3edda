//! Speed profiles: linear between the points of a file, steps, a sine, each over position or over time.

use super::error::ReferenceError;
use super::index::Index;
use super::point::{Axis, Point};
use super::recording::{self, Read, RecordingOptions, Track};
use crate::trig::{Polynomial, Trig};
use crate::{choice, keys};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::{Path, PathBuf};

choice! {
    /// Where a profile comes from.
    pub enum Source {
        /// A file.
        File = "file",
        /// Steps.
        Step = "step",
        /// A sine.
        Sine = "sine",
    }
}

choice! {
    /// What a profile is to be a function of.
    pub enum By {
        /// As the file says.
        Auto = "auto",
        /// Driven distance.
        Position = "position",
        /// Time since the vehicle's start.
        Time = "time",
    }
}

choice! {
    /// Unit of speeds whose column does not name one.
    pub enum SpeedUnit {
        /// m/s
        MetresPerSecond = "m/s",
        /// km/h
        KilometresPerHour = "km/h",
    }
}

keys! {
    /// Keys of the target `profile`.
    pub struct ProfileKeys {
        /// where the profile comes from
        shape: Source = Source::File;
        /// over position or time; auto: as the file says, recordings with stops by time, others by position
        by: By = By::Auto;
        /// CSV s_m,v_mps or t_s,v_mps, a recording t,vx,vy,yaw_rate, or a SUMO driving cycle t;v
        file: Option<PathBuf>;
        /// moving average over the speeds of a recording of 10 Hz or more; 0 = off
        smooth_s: f64 = 1.0, "s", 0.0..=600.0;
        /// unit of speeds whose column does not name one
        speed_unit: SpeedUnit = SpeedUnit::MetresPerSecond;
        /// where the steps are: positions [m], or times [s] if by = "time"
        step_at: String = "0, 100";
        /// the speed from each step on [m/s]
        step_speeds_mps: String = "10, 20";
        /// mean of the sine
        sine_mean_mps: f64 = 15.0, "m/s", 0.0..=100.0;
        /// amplitude of the sine
        sine_amplitude_mps: f64 = 5.0, "m/s", 0.0..=100.0;
        /// wavelength of the sine over position
        sine_wavelength_m: f64 = 200.0, "m", 0.1..=1e6;
        /// period of the sine over time
        sine_period_s: f64 = 20.0, "s", 0.1..=1e6;
    }
}

/// Builds the profile that the keys describe.
pub(super) fn build(keys: &ProfileKeys, folder: &Path) -> Result<Profile, ReferenceError> {
    let by = match keys.by {
        By::Auto => None,
        By::Position => Some(Axis::Position),
        By::Time => Some(Axis::Time),
    };
    match keys.shape {
        Source::Step => {
            let at = numbers("step_at", &keys.step_at)?;
            let speeds_mps = numbers("step_speeds_mps", &keys.step_speeds_mps)?;
            Profile::step(by.unwrap_or(Axis::Position), &at, &speeds_mps)
        }
        Source::Sine => {
            let by = by.unwrap_or(Axis::Position);
            let length = if by == Axis::Time { keys.sine_period_s } else { keys.sine_wavelength_m };
            Profile::sine(by, keys.sine_mean_mps, keys.sine_amplitude_mps, length)
        }
        Source::File => {
            let file = keys.file.as_ref().ok_or_else(|| ReferenceError::Value {
                key: "file",
                found: "nothing".to_owned(),
                wanted: "a profile's file, or shape = \"step\" or \"sine\"",
            })?;
            let speed_unit_mps = match keys.speed_unit {
                SpeedUnit::MetresPerSecond => 1.0,
                SpeedUnit::KilometresPerHour => 1.0 / 3.6,
            };
            Profile::from_file(&folder.join(file), &RecordingOptions { by, smooth_s: keys.smooth_s, speed_unit_mps })
        }
    }
}

/// Numbers for a message, a few of many.
fn shortened(numbers: &[f64]) -> String {
    const SHOWN: usize = 8;
    match numbers.get(..SHOWN) {
        Some(first) if numbers.len() > SHOWN => format!("{} numbers, first {first:?}", numbers.len()),
        _ => format!("{numbers:?}"),
    }
}

fn numbers(key: &'static str, text: &str) -> Result<Vec<f64>, ReferenceError> {
    let parsed: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    parsed.map_err(|_| ReferenceError::Value { key, found: format!("\"{text}\""), wanted: "numbers like \"0, 100\"" })
}

/// A reference speed over position or time.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    by: Axis,
    shape: Shape,
    track: Option<Track>,
    note: Option<String>,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// Straight lines between points, each with the slope to the next. Two points at the same place make a jump.
    Lines(Vec<(Point, f64)>, Index),
    /// Each speed holds from its place on.
    Steps(Vec<Point>),
    Sine {
        mean_mps: f64,
        amplitude_mps: f64,
        length: f64,
    },
}

impl Profile {
    /// Reads a profile, a driver's recording or a SUMO driving cycle.
    ///
    /// - Header `s_m,v_mps` or `t_s,v_mps`: taken as it is, linear between the rows.
    /// - Header with `vx` or `speed` (and `vy`, `yaw_rate`): a recording, smoothed and reconstructed, see [`Track`].
    /// - Rows `t;v` without a header: the form that SUMO's `emissionsDrivingCycle` reads; further columns are ignored.
    ///
    /// Units may be part of the names (`v_kmh`, `vx_mps`, `yaw_rate_degps`), other columns are ignored, as are lines that
    /// start with `#`.
    ///
    /// # Errors
    /// [`ReferenceError::Read`] or [`ReferenceError::Content`] with file, line, column, what was found and what is wanted.
    pub fn from_file(path: &Path, options: &RecordingOptions) -> Result<Self, ReferenceError> {
        let Read { by, points, track, note } = recording::read(path, options)?;
        Ok(Self { by, shape: lines(&points), track, note })
    }

    /// Steps: `speeds_mps[i]` holds from `at[i]` (m or s) on, the first one before it as well.
    ///
    /// # Errors
    /// [`ReferenceError::Value`] unless there are as many places as speeds, places increase and speeds are positive (over
    /// position a vehicle would never leave a place where it stands).
    pub fn step(by: Axis, at: &[f64], speeds_mps: &[f64]) -> Result<Self, ReferenceError> {
        if at.is_empty() || !at.iter().all(|x| x.is_finite()) || !at.is_sorted_by(|a, b| a < b) {
            let wanted = "at least one place, in increasing order";
            return Err(ReferenceError::Value { key: "step_at", found: format!("{at:?}"), wanted });
        }
        let drives = |v: &f64| v.is_finite() && (*v > 0.0 || (*v == 0.0 && by == Axis::Time));
        if speeds_mps.len() != at.len() || !speeds_mps.iter().all(drives) {
            let wanted = "one speed for every place, above 0 if over position";
            return Err(ReferenceError::Value { key: "step_speeds_mps", found: format!("{speeds_mps:?}"), wanted });
        }
        let points = at.iter().zip(speeds_mps).map(|(&at, &speed_mps)| Point { at, speed_mps }).collect();
        Ok(Self { by, shape: Shape::Steps(points), track: None, note: None })
    }

    /// Straight lines between points: `speeds_mps[i]` at the place or time `at[i]` (m or s). Two points at the same place
    /// make a jump.
    ///
    /// # Errors
    /// [`ReferenceError::Value`] unless there are as many places as speeds, places do not decrease, and speeds are at least 0
    /// (over position above 0: a vehicle would never leave a place where it stands).
    pub fn lines(by: Axis, at: &[f64], speeds_mps: &[f64]) -> Result<Self, ReferenceError> {
        if at.len() < 2 || !at.iter().all(|x| x.is_finite()) || !at.is_sorted() {
            let wanted = "at least two places, none before the one ahead of it";
            return Err(ReferenceError::Value { key: "at", found: shortened(at), wanted });
        }
        let drives = |v: &f64| v.is_finite() && (*v > 0.0 || (*v == 0.0 && by == Axis::Time));
        if speeds_mps.len() != at.len() || !speeds_mps.iter().all(drives) {
            let wanted = "one speed for every place, not negative, and above 0 if over position";
            return Err(ReferenceError::Value { key: "speeds_mps", found: shortened(speeds_mps), wanted });
        }
        let points: Vec<Point> = at.iter().zip(speeds_mps).map(|(&at, &speed_mps)| Point { at, speed_mps }).collect();
        Ok(Self { by, shape: lines(&points), track: None, note: None })
    }

    /// A sine around `mean_mps` that starts at the mean, with a wavelength (m) or period (s) of `length`.
    ///
    /// # Errors
    /// [`ReferenceError::Value`] if the speed would turn negative or, over position, 0, or if `length` is not positive.
    pub fn sine(by: Axis, mean_mps: f64, amplitude_mps: f64, length: f64) -> Result<Self, ReferenceError> {
        let lowest = mean_mps - amplitude_mps.abs();
        let drives = lowest.is_finite() && (lowest > 0.0 || (lowest == 0.0 && by == Axis::Time));
        if !drives {
            let wanted = "an amplitude below the mean";
            return Err(ReferenceError::Value { key: "sine_amplitude_mps", found: amplitude_mps.to_string(), wanted });
        }
        if !(length.is_finite() && length > 0.0) {
            let key = if by == Axis::Time { "sine_period_s" } else { "sine_wavelength_m" };
            return Err(ReferenceError::Value { key, found: length.to_string(), wanted: "a length above 0" });
        }
        Ok(Self { by, shape: Shape::Sine { mean_mps, amplitude_mps, length }, track: None, note: None })
    }

    /// The reference speed [m/s] and its rate [m/s²] for a vehicle that has driven `position_m` in `time_s` and moves at
    /// `speed_mps`. Over position the rate is dy_r/dt = v·dy_r/ds with the vehicle's own v. Outside the profile its first
    /// and last speeds hold. At a jump the rate is 0.
    #[inline]
    pub fn at(&self, position_m: f64, time_s: f64, speed_mps: f64) -> (f64, f64) {
        let (x, x_rate) = match self.by {
            Axis::Position => (position_m, speed_mps),
            Axis::Time => (time_s, 1.0),
        };
        let (speed, slope) = match &self.shape {
            Shape::Lines(points, index) => on_lines(points, index, x),
            other => other.at(x),
        };
        (speed, slope * x_rate)
    }

    /// True if the speed is a function of time, false if of position.
    pub fn is_by_time(&self) -> bool {
        self.by == Axis::Time
    }

    /// Where the profile ends: driven distance (m), or time (s) if [`Profile::is_by_time`]. None for a sine, which goes on,
    /// and for steps, the last of which holds.
    pub fn length(&self) -> Option<f64> {
        match &self.shape {
            Shape::Lines(points, _) => points.last().map(|(p, _)| p.at),
            Shape::Steps(_) | Shape::Sine { .. } => None,
        }
    }

    /// Curvature of the recorded track at a driven distance [1/m], left positive; 0 without a track and outside it.
    pub fn curvature_at(&self, position_m: f64) -> f64 {
        self.track.as_ref().map_or(0.0, |t| t.curvature_at(position_m))
    }

    /// How a recording was smoothed, in a line to tell the user.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// The track of a recording with a yaw rate.
    pub fn track(&self) -> Option<&Track> {
        self.track.as_ref()
    }
}

impl Shape {
    /// Speed [m/s] and slope [m/s per unit of the axis] at `x`.
    fn at(&self, x: f64) -> (f64, f64) {
        match self {
            Self::Lines(points, index) => on_lines(points, index, x),
            Self::Steps(points) => {
                let next = points.partition_point(|p| p.at <= x);
                (points[next.saturating_sub(1)].speed_mps, 0.0)
            }
            Self::Sine { mean_mps, amplitude_mps, length } => {
                let (sin, cos) = turn(x / length);
                (mean_mps + amplitude_mps * sin, amplitude_mps * TAU / length * cos)
            }
        }
    }
}

/// Sine and cosine of so many turns, by the polynomials of the kernels: a reference is asked for in every period. Rounding
/// must not take them beyond 1, lest a speed that should touch 0 turned negative.
fn turn(turns: f64) -> (f64, f64) {
    let angle = TAU * (turns - (turns + 0.5).floor());
    [angle, FRAC_PI_2 - angle].map(|x| Polynomial::sin(x).clamp(-1.0, 1.0)).into()
}

fn lines(points: &[Point]) -> Shape {
    let index = Index::new(points.iter().map(|p| p.at));
    let slope = |i: usize| match points.get(i + 1) {
        Some(next) => (next.speed_mps - points[i].speed_mps) / (next.at - points[i].at),
        None => 0.0,
    };
    Shape::Lines(points.iter().enumerate().map(|(i, point)| (*point, slope(i))).collect(), index)
}

/// Speed [m/s] and slope [m/s per unit of the axis] at `x`.
#[inline]
fn on_lines(points: &[(Point, f64)], index: &Index, x: f64) -> (f64, f64) {
    match index.count_up_to(x, |i| points[i].0.at) {
        0 => (points.first().map_or(0.0, |(p, _)| p.speed_mps), 0.0),
        after if after == points.len() => (points[after - 1].0.speed_mps, 0.0),
        after => {
            let (from, slope) = points[after - 1];
            (from.speed_mps + slope * (x - from.at), slope)
        }
    }
}
