//! A column of the fleet in five numbers.

use serde::{Deserialize, Serialize};

/// Mean, quantiles and maximum of a set of values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Arithmetic mean.
    pub mean: f64,
    /// 5 % quantile.
    pub p05: f64,
    /// Median.
    pub p50: f64,
    /// 95 % quantile.
    pub p95: f64,
    /// Largest value.
    pub max: f64,
}

impl Spread {
    /// The exact numbers of `values`; `None` if there are none. Quantiles interpolate between neighbours (Hyndman and
    /// Fan 1996, type 7; the default of NumPy, pandas and R).
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let max = *values.last()?;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let [p05, p50, p95] = [0.05, 0.5, 0.95].map(|p| quantile(&values, p));
        Some(Self { mean, p05, p50, p95, max })
    }
}

fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() - 1) as f64;
    let below = place.floor();
    let (low, high) = (sorted[below as usize], sorted[(below as usize + 1).min(sorted.len() - 1)]);
    low + (place - below) * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_numpy() {
        // numpy.percentile([3, 1, 4, 1, 5, 9, 2, 6], [5, 50, 95]) = [1.0, 3.5, 7.95]; mean 3.875.
        let spread = Spread::of([3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0]).unwrap();
        assert_eq!((spread.p05, spread.p50, spread.mean, spread.max), (1.0, 3.5, 3.875, 9.0));
        assert!((spread.p95 - 7.95).abs() < 1e-12);
    }

    #[test]
    fn law_one_value_is_all_its_quantiles_and_none_has_none() {
        let spread = Spread::of([2.5]).unwrap();
        assert_eq!([spread.mean, spread.p05, spread.p50, spread.p95, spread.max], [2.5; 5]);
        assert_eq!(Spread::of([]), None);
    }
}
