//! How sure a mean is: Student's t over the seeds, and Holm's correction for many questions at once.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Seeds beyond which asking for more says nothing.
const MOST_SEEDS: u64 = 1_000_000;

/// Fewer seeds than this are too few for an interval to be believed, and as many as that are recommended.
const FEW: usize = 5;
const ENOUGH: usize = 10;

/// The mean of independent values, and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// How many values.
    pub n: usize,
    /// Their mean.
    pub mean: f64,
    /// Their standard deviation, divided by n − 1; needs two values.
    pub sd: Option<f64>,
}

impl Estimate {
    /// Of these values; `None` if there are none.
    pub fn of(values: &[f64]) -> Option<Self> {
        let n = values.len();
        let mean = (n > 0).then(|| values.iter().sum::<f64>() / n as f64)?;
        let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
        Some(Self { n, mean, sd: (n > 1).then(|| (squares / (n - 1) as f64).sqrt()) })
    }

    /// Half the width of the 95 % interval of the mean, t₀.₉₇₅,ₙ₋₁·sd/√n.
    pub fn half_width(&self) -> Option<f64> {
        Some(student(self.n)?.inverse_cdf(0.975) * self.sd? / (self.n as f64).sqrt())
    }

    /// The two-sided p of the mean being zero. Values that are all the same have none: their spread is unknown.
    pub fn p(&self) -> Option<f64> {
        let sd = self.sd.filter(|sd| *sd > 0.0)?;
        let t = self.mean / (sd / (self.n as f64).sqrt());
        Some(2.0 * student(self.n)?.sf(t.abs()))
    }
}

/// Student's t of n values.
fn student(n: usize) -> Option<StudentsT> {
    StudentsT::new(0.0, 1.0, n.checked_sub(1)? as f64).ok()
}

/// Holm's step-down correction (Holm 1979) over all that have a p.
pub fn holm(p: &mut [Option<f64>]) {
    let mut order: Vec<usize> = (0..p.len()).filter(|i| p[*i].is_some()).collect();
    order.sort_by(|a, b| p[*a].partial_cmp(&p[*b]).expect("a p is a number"));
    let (count, mut largest) = (order.len(), 0.0_f64);
    for (rank, i) in order.into_iter().enumerate() {
        largest = largest.max(p[i].map_or(0.0, |p| p * (count - rank) as f64)).min(1.0);
        p[i] = Some(largest);
    }
}

/// The seeds with which a difference of `delta` is found with a probability of 80 % at a level of 5 %, if the paired
/// differences spread by `sd`: the smallest n ≥ 2 with (t₀.₉₇₅ + t₀.₈)·sd/√n ≤ delta. `None` if no reasonable number does.
pub fn seeds_for(delta: f64, sd: f64) -> Option<u64> {
    let enough = |n: u64| {
        let t = student(n as usize).map(|t| t.inverse_cdf(0.975) + t.inverse_cdf(0.8));
        t.is_some_and(|t| t * sd / (n as f64).sqrt() <= delta)
    };
    if delta.is_nan() || delta <= 0.0 || !enough(MOST_SEEDS) {
        return None;
    }
    let (mut few, mut many) = (1, MOST_SEEDS);
    while many - few > 1 {
        let middle = few + (many - few) / 2;
        if enough(middle) { many = middle } else { few = middle }
    }
    Some(many)
}

/// What to think of the number of seeds; nothing if they are enough.
pub fn advice(seeds: usize) -> Option<String> {
    let counted = if seeds == 1 { "1 seed".to_owned() } else { format!("{seeds} seeds") };
    let few =
        format!("{counted}: intervals from fewer than {FEW} seeds are not to be believed; {ENOUGH} are recommended");
    let some = format!("{counted}: {ENOUGH} are recommended");
    (seeds < FEW).then_some(few).or((seeds < ENOUGH).then_some(some))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn near(got: f64, wanted: f64) {
        assert!((got - wanted).abs() < 1e-5 * wanted.abs().max(1.0), "{got} instead of {wanted}");
    }

    #[test]
    fn val_published_quantiles() {
        // Abramowitz and Stegun 1964, table 26.10.
        for (n, wanted) in [(2, 12.706_205), (5, 2.776_445), (11, 2.228_139), (31, 2.042_272), (121, 1.979_930)] {
            let unit = Estimate { n, mean: 0.0, sd: Some((n as f64).sqrt()) };
            near(unit.half_width().unwrap(), wanted);
        }
    }

    #[test]
    fn val_a_paired_test_by_hand() {
        // Student 1908, the sleep of ten patients under two drugs: t = 4.0621, p = 0.002833 on 9 degrees of freedom.
        let hours = [1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4];
        let estimate = Estimate::of(&hours).unwrap();
        near(estimate.mean, 1.58);
        near(estimate.sd.unwrap(), 1.229_995);
        assert!((estimate.p().unwrap() - 0.002_833).abs() < 1e-6, "{:?}", estimate.p());
        near(estimate.half_width().unwrap(), 0.879_884);
    }

    #[test]
    fn val_holm_by_hand() {
        // p·(4, 3, 2, 1) in ascending order, never falling, at most 1; what has no p is no question.
        let mut p = [Some(0.04), Some(0.01), None, Some(0.03), Some(0.5)];
        holm(&mut p);
        for (got, wanted) in p.iter().flatten().zip([0.09, 0.04, 0.09, 0.5]) {
            near(*got, wanted);
        }
        assert_eq!(p[2], None);
    }

    #[test]
    fn equal_values_have_a_mean_and_no_test() {
        let zeros = Estimate::of(&[0.0; 4]).unwrap();
        assert_eq!((zeros.mean, zeros.half_width(), zeros.p()), (0.0, Some(0.0), None));
        let one = Estimate::of(&[2.0]).unwrap();
        assert_eq!((one.mean, one.sd, one.half_width(), one.p()), (2.0, None, None, None));
        assert_eq!(Estimate::of(&[]), None);
    }

    #[test]
    fn law_seeds_are_the_fewest_that_are_enough() {
        // By the normal quantiles (1.960 + 0.842)² · (sd/delta)² = 7.85 · 16 ≈ 126; Student's adds two.
        assert_eq!(seeds_for(0.25, 1.0), Some(128));
        assert_eq!(seeds_for(1.0, 0.0), Some(2));
        assert_eq!(seeds_for(0.0, 1.0), None);
        assert_eq!(seeds_for(1e-6, 1.0), None);
        let few = seeds_for(1.0, 1.0).unwrap();
        assert!((10..=11).contains(&few), "{few}");
    }

    /// How often the 95 % interval holds the true mean.
    fn coverage(n: usize, mean: f64, draw: impl Fn(&mut Stream) -> f64) -> f64 {
        const STUDIES: usize = 20_000;
        let mut stream = Stream::new(1, "coverage", &n.to_string());
        let held = (0..STUDIES).filter(|_| {
            let values: Vec<f64> = (0..n).map(|_| draw(&mut stream)).collect();
            let estimate = Estimate::of(&values).unwrap();
            (estimate.mean - mean).abs() <= estimate.half_width().unwrap()
        });
        held.count() as f64 / STUDIES as f64
    }

    #[test]
    fn law_the_interval_holds_the_truth_as_often_as_it_says() {
        for n in [10, 20] {
            let normal = coverage(n, 3.0, |stream| 3.0 + 2.0 * stream.normal());
            // The mean of a log-normal draw is the root of e.
            let skewed = coverage(n, 0.5_f64.exp(), |stream| stream.normal().exp());
            println!("n = {n}: {:.1} % for normal data, {:.1} % for log-normal data", 100.0 * normal, 100.0 * skewed);
            assert!((0.93..=0.97).contains(&normal), "{n}: {normal}");
        }
    }

    #[test]
    fn few_seeds_are_said_to_be_few() {
        assert!(advice(1).unwrap().starts_with("1 seed: "));
        assert!(advice(4).unwrap().contains("not to be believed"));
        assert_eq!(advice(5).unwrap(), "5 seeds: 10 are recommended");
        assert_eq!(advice(10), None);
    }
}
