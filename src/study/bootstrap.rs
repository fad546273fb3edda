//! The studentised bootstrap (Efron and Tibshirani 1993, §12.5): an interval that follows the skew of the differences, where
//! Student's t takes them as normal.

use super::statistics::Estimate;
use crate::random::Stream;

/// The 95 % interval of the mean of these values from so many resamples, drawn from a stream that `name` alone decides:
/// the same table has the same interval. `None` if fewer than two values, or all the same.
pub fn interval(values: &[f64], resamples: u32, name: &str) -> Option<[f64; 2]> {
    let estimate = Estimate::of(values)?;
    let n = values.len();
    let error = |sd: f64| sd / (n as f64).sqrt();
    let sd = estimate.sd.filter(|sd| *sd > 0.0)?;
    let mut stream = Stream::new(0, "bootstrap", name);
    let mut drawn = vec![0.0; n];
    let mut deviations: Vec<f64> = (0..resamples)
        .filter_map(|_| {
            drawn.fill_with(|| values[((stream.uniform() * n as f64) as usize).min(n - 1)]);
            let again = Estimate::of(&drawn)?;
            // A resample of one value drawn n times has no spread to be measured by.
            again.sd.filter(|sd| *sd > 0.0).map(|sd| (again.mean - estimate.mean) / error(sd))
        })
        .collect();
    deviations.sort_by(f64::total_cmp);
    let last = deviations.len().checked_sub(1)?;
    let quantile = |p: f64| deviations[(p * last as f64).round() as usize];
    Some([0.975, 0.025].map(|p| estimate.mean - quantile(p) * error(sd)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Student's hours of sleep, resampled 200 000 times by another program (Python's `random`, seed 1): the quantiles are
    /// −3.931 and 1.631 standard errors of 0.388 96.
    #[test]
    fn val_an_interval_that_another_program_found() {
        let hours = [1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4];
        let [low, high] = interval(&hours, 200_000, "sleep").unwrap();
        assert!((low - 0.945).abs() < 0.02 && (high - 3.109).abs() < 0.05, "{low} to {high}");
        // To the right it reaches farther than t, because the values do.
        assert!(high - 1.58 > 0.88 && 1.58 - low < 0.88);
    }

    /// How often the interval holds the true mean of log-normal values, beside that of t.
    #[test]
    fn law_skewed_values_are_held_more_often_than_by_t() {
        const STUDIES: usize = 2_000;
        for n in [10, 20] {
            let mut stream = Stream::new(2, "coverage", &n.to_string());
            let (mean, mut by_t, mut by_bootstrap) = (0.5_f64.exp(), 0, 0);
            for study in 0..STUDIES {
                let values: Vec<f64> = (0..n).map(|_| stream.normal().exp()).collect();
                let estimate = Estimate::of(&values).unwrap();
                by_t += usize::from((estimate.mean - mean).abs() <= estimate.half_width().unwrap());
                let [low, high] = interval(&values, 1000, &study.to_string()).unwrap();
                by_bootstrap += usize::from((low..=high).contains(&mean));
            }
            let share = |held: usize| 100.0 * held as f64 / STUDIES as f64;
            println!(
                "n = {n}: {:.1} % by t, {:.1} % by bootstrap for log-normal data",
                share(by_t),
                share(by_bootstrap)
            );
            assert!(by_bootstrap > by_t && share(by_bootstrap) < 97.0);
        }
    }

    #[test]
    fn values_without_spread_have_no_interval() {
        assert_eq!(interval(&[], 1000, "x"), None);
        assert_eq!(interval(&[1.0], 1000, "x"), None);
        assert_eq!(interval(&[1.0, 1.0, 1.0], 1000, "x"), None);
    }

    #[test]
    fn the_same_values_have_the_same_interval_and_other_names_another() {
        let values = [0.3, 0.1, 0.9, 0.4, 0.2];
        assert_eq!(interval(&values, 500, "a"), interval(&values, 500, "a"));
        assert_ne!(interval(&values, 500, "a"), interval(&values, 500, "b"));
    }
}
