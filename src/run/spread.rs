//! A column of the fleet in five numbers.

use serde::{Deserialize, Serialize};
use std::io;

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
    /// Of `count` values of which the smallest comes first, wherever they come from; none has none.
    pub(super) fn of_sorted(count: usize, sorted: impl Iterator<Item = io::Result<f64>>) -> io::Result<Option<Self>> {
        if count == 0 {
            return Ok(None);
        }
        let places = [0.05, 0.5, 0.95].map(|p| p * (count - 1) as f64);
        // Its neighbours below and above.
        let mut around = [[0.0; 2]; 3];
        let (mut sum, mut max) = (-0.0, 0.0);
        for (index, value) in sorted.enumerate() {
            let value = value?;
            sum += value;
            max = value;
            for (place, around) in places.iter().zip(&mut around) {
                let below = place.floor() as usize;
                if index == below {
                    *around = [value; 2];
                } else if index == below + 1 {
                    around[1] = value;
                }
            }
        }
        let quantile = |(place, [low, high]): (&f64, [f64; 2])| low + (place - place.floor()) * (high - low);
        let quantiles: Vec<f64> = places.iter().zip(around).map(quantile).collect();
        let mean = sum / count as f64;
        Ok(Some(Self { mean, p05: quantiles[0], p50: quantiles[1], p95: quantiles[2], max }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(mut values: Vec<f64>) -> Option<Spread> {
        values.sort_by(f64::total_cmp);
        Spread::of_sorted(values.len(), values.into_iter().map(Ok)).unwrap()
    }

    #[test]
    fn val_numpy() {
        // numpy.percentile([3, 1, 4, 1, 5, 9, 2, 6], [5, 50, 95]) = [1.0, 3.5, 7.95]; mean 3.875.
        let spread = of(vec![3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0]).unwrap();
        assert_eq!((spread.p05, spread.p50, spread.mean, spread.max), (1.0, 3.5, 3.875, 9.0));
        assert!((spread.p95 - 7.95).abs() < 1e-12);
    }

    #[test]
    fn law_one_value_is_all_its_quantiles_and_none_has_none() {
        let spread = of(vec![2.5]).unwrap();
        assert_eq!([spread.mean, spread.p05, spread.p50, spread.p95, spread.max], [2.5; 5]);
        assert_eq!(of(Vec::new()), None);
    }
}
