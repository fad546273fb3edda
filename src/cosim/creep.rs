//! Whether a vehicle creeps: whether it moves on and on without getting anywhere, as it does under a law that swings
//! between standing and starting.

/// Slower than people walk [m/s].
pub const SLOW_MPS: f64 = 1.0;
/// Longer than most queues take to close up \[s\]; in jammed traffic (`docs/matrix.md`) some take longer.
pub const LONG_S: f64 = 60.0;
/// A body that is slower stands [m/s].
const STANDS_MPS: f64 = 0.01;

/// How long a vehicle has moved without exceeding [`SLOW_MPS`]. The time that it stands does not count.
#[derive(Debug, Clone, Copy, Default)]
pub struct Creep {
    slow_s: f64,
    /// True once that was longer than [`LONG_S`].
    pub crept: bool,
}

impl Creep {
    /// The vehicle had this speed at the end of a step.
    pub fn note(&mut self, speed_mps: f64, step_s: f64) {
        if speed_mps > SLOW_MPS {
            self.slow_s = 0.0;
        } else if speed_mps > STANDS_MPS {
            self.slow_s += step_s;
            self.crept |= self.slow_s > LONG_S;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drives `seconds` in steps of 0.1 s at the speeds that `speed_mps` gives by the number of the step.
    fn crept(seconds: u32, speed_mps: impl Fn(u32) -> f64) -> bool {
        let mut creep = Creep::default();
        (0..seconds * 10).for_each(|step| creep.note(speed_mps(step), 0.1));
        creep.crept
    }

    #[test]
    fn who_starts_and_stops_for_ever_creeps() {
        assert!(crept(200, |step| if step % 5 < 3 { 0.2 } else { 0.0 }));
        assert!(!crept(59, |_| 0.2));
    }

    #[test]
    fn the_bounds_themselves_are_slow_and_not_long() {
        assert!(crept(61, |_| SLOW_MPS), "it never exceeds that");
        let mut creep = Creep::default();
        (0..240).for_each(|_| creep.note(0.5, 0.25));
        assert!(!creep.crept, "60 s are not longer than that");
        creep.note(0.5, 0.25);
        assert!(creep.crept);
    }

    #[test]
    fn who_stands_or_gets_on_does_not() {
        assert!(!crept(3600, |_| 0.0) && !crept(3600, |_| STANDS_MPS));
        assert!(!crept(3600, |step| if step % 400 < 395 { 0.5 } else { 3.0 }), "a queue that moves up");
    }
}
