//! Lines whose colour says a third value along them.

use super::drawing::{Figure, WIDTH};
use super::frame::{BOTTOM, HEIGHT, LEFT, RIGHT, frame};
use super::ramp::Ramp;
use super::scale::Scale;
use super::style::STEPS;
use std::fmt::Write;

/// Lines of (x, y, value).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tracks<'a> {
    /// Title.
    pub title: String,
    /// Label of the horizontal axis.
    pub x: &'a str,
    /// Label of the vertical axis.
    pub y: &'a str,
    /// What the colour says.
    pub unit: &'a str,
    /// The lines.
    pub lines: Vec<Vec<(f64, f64, f64)>>,
}

impl Figure {
    /// Draws lines; all pieces of one colour are one path.
    pub fn tracks(name: &str, tracks: &Tracks) -> Self {
        const TOP: f64 = 70.0;
        const TALL: f64 = 1.4 * HEIGHT;
        let all = || tracks.lines.iter().flatten();
        let x = Scale::new(all().map(|p| p.0), LEFT, WIDTH - RIGHT, 0.0);
        let y = Scale::new(all().map(|p| p.1), TOP + TALL - BOTTOM, TOP, 0.03);
        let ramp = Ramp::of(all().map(|p| p.2));
        let mut paths = vec![String::new(); STEPS];
        for line in &tracks.lines {
            let mut last = None;
            for pair in line.windows(2) {
                let [from, to] = [pair[0], pair[1]];
                let step = ramp.step(0.5 * (from.2 + to.2));
                if last != Some(step) {
                    let _ = write!(paths[step], "M{:.0} {:.0}", x.at(from.0), y.at(from.1));
                }
                let _ = write!(paths[step], "L{:.0} {:.0}", x.at(to.0), y.at(to.1));
                last = Some(step);
            }
        }
        let mut body = frame(&tracks.title, [tracks.x, tracks.y], &x, &y);
        for (step, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_empty()) {
            let _ = write!(body, "<g class=\"v{step}\"><path class=\"thin\" d=\"{path}\"/></g>");
        }
        ramp.draw(&mut body, LEFT, 32.0, tracks.unit);
        Self::drawn(name, &tracks.title, body, TOP + TALL)
    }
}
