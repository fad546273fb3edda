//! From a file to a profile: plain speed profiles as they are, a driver's recording by way of smoothing and reconstruction
//! (Polack et al. 2017, Section 5.3).

use super::error::ReferenceError;
use super::index::Index;
use super::point::{Axis, Point};
use super::table::{Column, Quantity, Table};
use std::path::Path;

/// Below this speed a recording is taken to stand [m/s].
const STANDING_MPS: f64 = 0.5;
/// Recordings with longer sampling intervals (their median) are not smoothed (s).
const COARSE_S: f64 = 0.1;
/// Faster than any road vehicle: such a sample is none [m/s].
const IMPLAUSIBLE_MPS: f64 = 200.0;
/// Quicker than any road vehicle spins [rad/s].
const IMPLAUSIBLE_RADPS: f64 = 10.0;
/// A recording with a longer gap is two (s).
const GAP_S: f64 = 10.0;
/// Intervals that differ by less from the mean one are those of a regular recording whose times were rounded.
const REGULAR: f64 = 0.25;
/// Intervals below this share of the median are those of one sample that was written twice.
const DUPLICATE: f64 = 0.1;
/// No vehicle gains or loses speed like this and back within one sample: a change of speed and an acceleration [m/s, m/s²].
const SPIKE: (f64, f64) = (5.0, 50.0);
/// Length over which a track's curvature is taken (m).
const CURVATURE_BASE_M: f64 = 3.0;

/// How to treat a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordingOptions {
    /// Over position or time; None: files with a position by position, plain speeds over time by time, recordings with stops
    /// (below 0.5 m/s) by time and others by position.
    pub by: Option<Axis>,
    /// Length of the moving average over V_x and V_y of a recording (s); 0 = off. Never used on samples whose median
    /// interval is coarser than 10 Hz.
    pub smooth_s: f64,
    /// What a speed of 1 is in m/s where the column does not name its unit.
    pub speed_unit_mps: f64,
}

impl Default for RecordingOptions {
    /// The paper's 100 points at an assumed 100 Hz.
    fn default() -> Self {
        Self { by: None, smooth_s: 1.0, speed_unit_mps: 1.0 }
    }
}

/// Where a recorded vehicle went, reconstructed as in the paper:
/// ```text
/// x += V_x Δt cos ψ − V_y Δt sin ψ      y += V_x Δt sin ψ + V_y Δt cos ψ      ψ += ψ̇ Δt      s += √(Δx² + Δy²)
/// ```
/// One entry per sample in each column; it starts at the origin, heading along x.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    /// Driven distance (m).
    pub s_m: Vec<f64>,
    /// Position (m).
    pub x_m: Vec<f64>,
    /// Position, left positive (m).
    pub y_m: Vec<f64>,
    /// Heading ψ, left positive (rad).
    pub heading_rad: Vec<f64>,
    /// Change of heading per driven metre, over 3 m [1/m].
    pub curvature_per_m: Vec<f64>,
    /// Of the driven distance.
    index: Index,
}

impl Track {
    /// Curvature at a driven distance [1/m], linear between samples, 0 outside the track.
    pub fn curvature_at(&self, s_m: f64) -> f64 {
        if self.s_m.first().is_none_or(|&s| s_m < s) || self.s_m.last().is_none_or(|&s| s_m > s) {
            return 0.0;
        }
        interpolate(&self.s_m, &self.index, &self.curvature_per_m, s_m)
    }

    fn reconstruct(t_s: &[f64], vx_mps: &[f64], vy_mps: &[f64], yaw_rate_radps: &[f64]) -> Self {
        let mut track = Self::default();
        let (mut s, mut x, mut y, mut psi) = (0.0, 0.0, 0.0, 0.0);
        // Heading gained while driving: a gyro's offset at a red light is no curve.
        let (mut turned, mut turned_rad) = (0.0, vec![]);
        for i in 0..t_s.len() {
            track.s_m.push(s);
            track.x_m.push(x);
            track.y_m.push(y);
            track.heading_rad.push(psi);
            turned_rad.push(turned);
            let dt = t_s.get(i + 1).map_or(0.0, |next| next - t_s[i]);
            let (sin, cos) = libm::sincos(psi);
            let dx = (vx_mps[i] * cos - vy_mps[i] * sin) * dt;
            let dy = (vx_mps[i] * sin + vy_mps[i] * cos) * dt;
            (x, y, s) = (x + dx, y + dy, s + (dx * dx + dy * dy).sqrt());
            psi += yaw_rate_radps[i] * dt;
            turned += if vx_mps[i] < STANDING_MPS { 0.0 } else { yaw_rate_radps[i] * dt };
        }
        track.index = Index::new(track.s_m.iter().copied());
        let end = s;
        let curvature = |&s: &f64| {
            let (from, to) = ((s - 0.5 * CURVATURE_BASE_M).max(0.0), (s + 0.5 * CURVATURE_BASE_M).min(end));
            let turned = |s: f64| interpolate(&track.s_m, &track.index, &turned_rad, s);
            let turn = turned(to) - turned(from);
            if to > from { turn / (to - from) } else { 0.0 }
        };
        track.curvature_per_m = track.s_m.iter().map(curvature).collect();
        track
    }
}

/// `y` at `x`, linear between samples, the ends hold.
fn interpolate(xs: &[f64], index: &Index, ys: &[f64], x: f64) -> f64 {
    match index.count_up_to(x, |i| xs[i]) {
        0 => ys.first().copied().unwrap_or_default(),
        n if n == xs.len() => ys[n - 1],
        n => ys[n - 1] + (ys[n] - ys[n - 1]) * (x - xs[n - 1]) / (xs[n] - xs[n - 1]),
    }
}

/// What a file holds.
pub(super) struct Read {
    pub by: Axis,
    pub points: Vec<Point>,
    /// Where a recorded vehicle went, if its yaw rate is known.
    pub track: Option<Track>,
    /// How a recording was treated, in a line.
    pub note: Option<String>,
}

/// Reads whatever profile is in `file`.
pub(super) fn read(file: &Path, options: &RecordingOptions) -> Result<Read, ReferenceError> {
    let table = Table::read(file, options.speed_unit_mps)?;
    let recorded = [Quantity::SpeedX, Quantity::SpeedY, Quantity::YawRate].iter().any(|&q| table.column(q).is_some());
    match (table.column(Quantity::Position), table.column(Quantity::Time)) {
        (Some(_), None) if options.by == Some(Axis::Time) => Err(table.missing()),
        (Some(position), None) => plain(&table, position, Axis::Position),
        (Some(position), _) if options.by != Some(Axis::Time) => plain(&table, position, Axis::Position),
        (_, Some(time)) if !recorded && options.by != Some(Axis::Position) => plain(&table, time, Axis::Time),
        (_, Some(time)) => recording(&table, time, options),
        (None, None) => Err(table.missing()),
    }
}

/// The speed column, whichever name it has.
fn speed(table: &Table) -> Result<&Column, ReferenceError> {
    let speed = table.column(Quantity::Speed).or_else(|| table.column(Quantity::SpeedX));
    let speed = speed.ok_or_else(|| table.missing())?;
    match speed.values.iter().position(|v| *v > IMPLAUSIBLE_MPS) {
        Some(row) => Err(table.error(row, speed, &format!("a speed of at most {IMPLAUSIBLE_MPS} m/s"))),
        None => Ok(speed),
    }
}

/// A profile as it stands in the file.
fn plain(table: &Table, at: &Column, by: Axis) -> Result<Read, ReferenceError> {
    let speed = speed(table)?;
    for row in 0..table.rows() {
        if row > 0 && at.values[row] < at.values[row - 1] {
            return Err(table.error(row, at, "no less than the row before"));
        }
        if row > 0 && at.values[row] > at.values[row - 1] {
            let change = speed.values[row] - speed.values[row - 1];
            if !(change / (at.values[row] - at.values[row - 1])).is_finite() {
                return Err(table.error(
                    row,
                    at,
                    "the same as in the row before, or so much more that the slope is finite",
                ));
            }
        }
        if speed.values[row] < 0.0 {
            return Err(table.error(row, speed, "a speed of at least 0"));
        }
        if by == Axis::Position && speed.values[row] == 0.0 && row + 1 < table.rows() {
            return Err(table.error(
                row,
                speed,
                "a speed above 0 before the end: the vehicle would never leave this position (use t_s,v_mps)",
            ));
        }
    }
    Ok(Read { by, points: points(&at.values, &speed.values), track: None, note: None })
}

fn points(at: &[f64], speeds_mps: &[f64]) -> Vec<Point> {
    at.iter().zip(speeds_mps).map(|(&at, &speed_mps)| Point { at, speed_mps }).collect()
}

/// A driver's recording: smoothed, reconstructed and referenced by time or position.
fn recording(table: &Table, time: &Column, options: &RecordingOptions) -> Result<Read, ReferenceError> {
    let speed = speed(table)?;
    let rows = table.rows();
    if rows < 2 {
        return Err(table.error(0, time, "at least two samples"));
    }
    if let Some(row) = (1..rows).find(|&i| time.values[i] <= time.values[i - 1]) {
        return Err(table.error(row, time, "more than the row before"));
    }
    if let Some(row) = (1..rows).find(|&i| time.values[i] - time.values[i - 1] > GAP_S) {
        return Err(table.error(
            row,
            time,
            &format!("at most {GAP_S} s after the row before: leave out one of the parts"),
        ));
    }
    // A sensor may say a little less than nothing while the vehicle stands.
    if let Some(row) = speed.values.iter().position(|v| *v < -STANDING_MPS) {
        return Err(table.error(row, speed, "a speed of at least 0"));
    }
    for (quantity, bound, what, unit) in [
        (Quantity::SpeedY, IMPLAUSIBLE_MPS, "speed", "m/s"),
        (Quantity::YawRate, IMPLAUSIBLE_RADPS, "yaw rate", "rad/s"),
    ] {
        let Some(column) = table.column(quantity) else { continue };
        if let Some(row) = column.values.iter().position(|value| value.abs() > bound) {
            return Err(table.error(row, column, &format!("a {what} between -{bound} and {bound} {unit}")));
        }
    }
    let samples = Samples::of(table, time, speed);
    let Samples { t_s, vx_mps, vy_mps, yaw_rate_radps, .. } = &samples;
    if let Some(row) = samples.spike() {
        let (change_mps, accel_mps2) = SPIKE;
        let wanted = format!("a speed within {change_mps} m/s or {accel_mps2} m/s2 of the samples before and after");
        return Err(table.error(row, speed, &wanted));
    }
    let average = Average::of(t_s, options.smooth_s);
    let vx_mps: Vec<f64> = average.over(t_s, vx_mps).iter().map(|v| v.max(0.0)).collect();
    let track = Track::reconstruct(t_s, &vx_mps, &average.over(t_s, vy_mps), yaw_rate_radps);

    let standing = vx_mps.iter().position(|&v| v < STANDING_MPS);
    let by = options.by.unwrap_or(if standing.is_some() { Axis::Time } else { Axis::Position });
    if let (Axis::Position, Some(sample)) = (by, standing) {
        let wanted = "no stops (below 0.5 m/s) in a recording taken by position";
        return Err(table.error(samples.rows[sample], speed, wanted));
    }
    let points = points(if by == Axis::Time { t_s } else { &track.s_m }, &vx_mps);
    let note = Some(samples.note(table, average, options.smooth_s));
    Ok(Read { by, points, track: table.column(Quantity::YawRate).map(|_| track), note })
}

/// The samples of a recording. Those that follow each other in far less than the median interval are one, their mean: lines
/// between them would have any slope.
struct Samples {
    t_s: Vec<f64>,
    vx_mps: Vec<f64>,
    vy_mps: Vec<f64>,
    yaw_rate_radps: Vec<f64>,
    /// The first row of each.
    rows: Vec<usize>,
    median_s: f64,
}

impl Samples {
    fn of(table: &Table, time: &Column, speed: &Column) -> Self {
        let times = &time.values;
        let median_s = sorted_intervals(times)[(times.len() - 1) / 2];
        let is_new = |i: &usize| *i == 0 || times[*i] - times[*i - 1] >= DUPLICATE * median_s;
        let rows: Vec<usize> = (0..times.len()).filter(is_new).collect();
        let merged = |values: &[f64]| -> Vec<f64> {
            let ends = rows.iter().skip(1).copied().chain([values.len()]);
            let mean = |(from, to): (&usize, usize)| values[*from..to].iter().sum::<f64>() / (to - from) as f64;
            rows.iter().zip(ends).map(mean).collect()
        };
        let column = |quantity| table.column(quantity).map_or(vec![0.0; rows.len()], |column| merged(&column.values));
        Self {
            t_s: merged(&times.iter().map(|t| t - times[0]).collect::<Vec<_>>()),
            vx_mps: merged(&speed.values),
            vy_mps: column(Quantity::SpeedY),
            yaw_rate_radps: column(Quantity::YawRate),
            rows,
            median_s,
        }
    }

    /// The row of a lone sample that no vehicle can have driven.
    fn spike(&self) -> Option<usize> {
        let (v, t) = (&self.vx_mps, &self.t_s);
        let leaps = |i: usize, j: usize| {
            let change = v[i] - v[j];
            let is_leap = change.abs() > SPIKE.0 && change.abs() > SPIKE.1 * (t[i] - t[j]).abs();
            if is_leap { change.signum() } else { 0.0 }
        };
        let inner = 1..v.len().saturating_sub(1);
        inner.into_iter().find(|&i| leaps(i, i - 1) * leaps(i, i + 1) > 0.0).map(|i| self.rows[i])
    }

    /// How the samples were treated.
    fn note(&self, table: &Table, average: Average, smooth_s: f64) -> String {
        let rate = format!("{} samples, {:.4} s apart (median)", table.rows(), self.median_s);
        let merged = match table.rows() - self.rows.len() {
            0 => String::new(),
            count => format!(", {count} merged with the one before"),
        };
        let smoothed = match average {
            Average::Samples(samples) if samples > 1 => format!("averaged over {samples} samples"),
            Average::Time(window_s) => format!("averaged over {window_s} s, for they are not regular"),
            Average::Samples(_) if smooth_s <= 0.0 => "not averaged: smooth_s is 0".to_owned(),
            Average::Samples(_) if self.median_s > COARSE_S => "not averaged: coarser than 10 Hz".to_owned(),
            Average::Samples(_) => format!("not averaged: {smooth_s} s are no two samples"),
        };
        format!("{}: {rate}{merged}, {smoothed}", table.file.display())
    }
}

/// The intervals between times, the shortest first (s).
fn sorted_intervals(t_s: &[f64]) -> Vec<f64> {
    let mut intervals_s: Vec<f64> = t_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    intervals_s.sort_unstable_by(f64::total_cmp);
    intervals_s
}

/// The moving average of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Average {
    /// Over this many samples of a regular recording.
    Samples(usize),
    /// Over this time of a recording whose intervals differ (s).
    Time(f64),
}

impl Average {
    /// How a recording with these times is averaged over `smooth_s`: not at all if its median interval is coarser than
    /// 10 Hz. The median, so that a few gaps do not make a fine recording a coarse one.
    fn of(t_s: &[f64], smooth_s: f64) -> Self {
        let intervals_s = sorted_intervals(t_s);
        let [shortest_s, median_s] = [intervals_s[0], intervals_s[intervals_s.len() / 2]];
        let longest_s = intervals_s[intervals_s.len() - 1];
        let mean_s = t_s[t_s.len() - 1] / intervals_s.len() as f64;
        // Small tolerance: 10 Hz written with rounded times is still 10 Hz.
        if median_s > 1.001 * COARSE_S || smooth_s <= 0.0 {
            Self::Samples(1)
        } else if shortest_s < (1.0 - REGULAR) * mean_s || longest_s > (1.0 + REGULAR) * mean_s {
            Self::Time(smooth_s)
        } else {
            Self::Samples((smooth_s / mean_s).round() as usize)
        }
    }

    /// The averaged values: centred, so that nothing is delayed.
    fn over(self, t_s: &[f64], values: &[f64]) -> Vec<f64> {
        match self {
            Self::Samples(samples) => average_of_samples(values, samples),
            Self::Time(window_s) => average_over_time(t_s, values, window_s),
        }
    }
}

/// Mean over `samples` samples around each one, over fewer at the ends.
fn average_of_samples(values: &[f64], samples: usize) -> Vec<f64> {
    let (before, after) = (samples / 2, samples.max(1).div_ceil(2));
    (0..values.len())
        .map(|i| {
            let window = &values[i.saturating_sub(before)..(i + after).min(values.len())];
            window.iter().sum::<f64>() / window.len() as f64
        })
        .collect()
}

/// Mean over `window_s` around each sample of the values joined by lines, over less at the ends.
fn average_over_time(t_s: &[f64], values: &[f64], window_s: f64) -> Vec<f64> {
    let mut integral = vec![0.0];
    for i in 1..t_s.len() {
        integral.push(integral[i - 1] + 0.5 * (values[i - 1] + values[i]) * (t_s[i] - t_s[i - 1]));
    }
    let end_s = t_s[t_s.len() - 1];
    let up_to = |t: f64| {
        let i = t_s.partition_point(|&at| at <= t).clamp(1, t_s.len() - 1) - 1;
        let share = (t - t_s[i]) / (t_s[i + 1] - t_s[i]);
        integral[i] + (t - t_s[i]) * (values[i] + 0.5 * share * (values[i + 1] - values[i]))
    };
    t_s.iter()
        .map(|t| {
            let (from, to) = ((t - 0.5 * window_s).max(0.0), (t + 0.5 * window_s).min(end_s));
            (up_to(to) - up_to(from)) / (to - from)
        })
        .collect()
}
