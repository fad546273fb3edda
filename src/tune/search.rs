//! The search: Nelder and Mead's simplex (1965) from several places, on logarithmic axes. It needs no derivative, which the
//! cost of a vehicle with limits and dead time has not, and few trials for few gains. The trials see the same noise, so that
//! the cost is a function of the gains alone.

use super::error::TuneError;
use super::gains::Gain;
use crate::random::Stream;
use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::neldermead::NelderMead;
use std::cell::RefCell;

/// From how many places: the law's own gains, and two that are drawn.
const PLACES: usize = 3;
/// Edge of the first simplex: a factor of 2.
const EDGE: f64 = std::f64::consts::LN_2;
/// A simplex whose costs differ by less is done \[m/s\].
const DONE_MPS: f64 = 1e-6;

/// What was found.
pub struct Found {
    /// The best values of the gains.
    pub best: Vec<f64>,
    /// How many sets were tried.
    pub trials: usize,
}

/// What stands for the cost of gains that are not tried any more [m/s].
const NO_TRIAL: f64 = 1e9;

/// Counts the trials, and remembers the best.
struct Counted<'a, C> {
    gains: &'a [Gain],
    cost: &'a C,
    left: usize,
    best: Option<(f64, Vec<f64>)>,
    failed: Option<TuneError>,
}

/// What the solver sees of it.
struct Problem<'p, 'a, C>(&'p RefCell<Counted<'a, C>>);

impl<C: Fn(&[f64]) -> Result<f64, TuneError>> CostFunction for Problem<'_, '_, C> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, place: &Vec<f64>) -> Result<f64, Error> {
        let mut counted = self.0.borrow_mut();
        // The solver takes no error while its simplex shrinks: where nothing more is to be tried, nothing is better.
        let Some(left) = counted.left.checked_sub(1).filter(|_| counted.failed.is_none()) else { return Ok(NO_TRIAL) };
        counted.left = left;
        let values: Vec<f64> = counted.gains.iter().zip(place).map(|(gain, place)| gain.at(*place)).collect();
        match (counted.cost)(&values) {
            Ok(cost) => {
                if counted.best.as_ref().is_none_or(|(best, _)| cost < *best) {
                    counted.best = Some((cost, values));
                }
                Ok(cost)
            }
            Err(error) => {
                counted.failed = Some(error);
                Ok(NO_TRIAL)
            }
        }
    }
}

/// The gains with the least cost among so many trials.
///
/// # Errors
/// What `cost` fails with.
pub fn search(
    gains: &[Gain],
    trials: usize,
    cost: impl Fn(&[f64]) -> Result<f64, TuneError>,
) -> Result<Found, TuneError> {
    let counted = RefCell::new(Counted { gains, cost: &cost, left: 0, best: None, failed: None });
    let mut draws = Stream::new(0, "tune", "places");
    let mut tried = 0;
    for place in 0..PLACES {
        // All places get the same share; what one leaves the next may use.
        let share = trials * (place + 1) / PLACES - tried;
        counted.borrow_mut().left = share;
        let begin: Vec<f64> = gains.iter().map(|gain| if place == 0 { 0.0 } else { drawn(gain, &mut draws) }).collect();
        let solver = NelderMead::new(simplex(gains, begin)).with_sd_tolerance(DONE_MPS);
        let solver = solver.map_err(|error| TuneError::Search(error.to_string()))?;
        let run = Executor::new(Problem(&counted), solver).configure(|state| state.max_iters(trials as u64)).run();
        run.map_err(|error| TuneError::Search(error.to_string()))?;
        let mut counted = counted.borrow_mut();
        if let Some(error) = counted.failed.take() {
            return Err(error);
        }
        tried += share - counted.left;
    }
    let best = counted.into_inner().best.map(|(_, values)| values);
    best.map(|best| Found { best, trials: tried }).ok_or(TuneError::Search("no trial was made".to_owned()))
}

/// A place somewhere in the middle half of a gain's axis.
fn drawn(gain: &Gain, draws: &mut Stream) -> f64 {
    let [low, high] = gain.ends();
    low + (high - low) * (0.25 + 0.5 * draws.uniform())
}

/// A first simplex: the beginning, and a step from it along every axis, inwards where the range ends.
fn simplex(gains: &[Gain], begin: Vec<f64>) -> Vec<Vec<f64>> {
    let corner = |(axis, gain): (usize, &Gain)| {
        let mut corner = begin.clone();
        let up = begin[axis] + EDGE <= gain.ends()[1];
        corner[axis] += if up { EDGE } else { -EDGE };
        corner
    };
    let corners: Vec<Vec<f64>> = gains.iter().enumerate().map(corner).collect();
    std::iter::once(begin).chain(corners).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(key: &'static str, begin: f64) -> Gain {
        Gain { key, begin, range: [begin / 100.0, begin * 100.0] }
    }

    #[test]
    fn val_the_minimum_of_a_curved_valley_is_found() {
        // Rosenbrock's valley (1960) over the logarithms, its minimum 0 at a = e, b = 2e.
        let gains = [gain("a", 1.0), gain("b", 2.0)];
        let cost = |values: &[f64]| {
            let (x, y) = (values[0].ln(), (values[1] / 2.0).ln());
            Ok((1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2))
        };
        let found = search(&gains, 600, cost).unwrap();
        assert!((found.best[0] / std::f64::consts::E - 1.0).abs() < 0.01, "{:?}", found.best);
        assert!((found.best[1] / (2.0 * std::f64::consts::E) - 1.0).abs() < 0.01, "{:?}", found.best);
    }

    #[test]
    fn law_no_more_trials_are_made_than_were_given_and_values_stay_in_range() {
        let gains = [gain("a", 1.0), gain("b", 2.0)];
        for trials in [3, 10, 61] {
            let count = RefCell::new(0);
            let found = search(&gains, trials, |values| {
                *count.borrow_mut() += 1;
                assert!(gains.iter().zip(values).all(|(gain, x)| (gain.range[0]..=gain.range[1]).contains(x)));
                Ok(-values[0] - values[1])
            });
            assert_eq!((found.unwrap().trials, *count.borrow() <= trials), (*count.borrow(), true));
        }
    }

    #[test]
    fn a_minimum_far_from_the_first_place_is_found_from_another() {
        // A narrow pit at a = 8 beside a wide, higher one around 0.5.
        let pit = |x: f64, middle: f64, width: f64| ((x / middle).ln() / width).powi(2).min(4.0);
        let cost = |values: &[f64]| Ok((0.5 + pit(values[0], 0.5, 1.0)).min(pit(values[0], 8.0, 0.7)));
        let found = search(&[gain("a", 1.0)], 120, cost).unwrap();
        assert!((found.best[0] / 8.0 - 1.0).abs() < 0.05 || (found.best[0] / 0.5 - 1.0).abs() < 0.05);
    }
}
