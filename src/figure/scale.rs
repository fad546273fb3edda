//! One axis.

/// From values to places in the drawing.
pub struct Scale {
    /// The lowest value.
    pub low: f64,
    /// The highest value.
    pub high: f64,
    /// Where the lowest is drawn.
    pub from: f64,
    /// Where the highest is drawn.
    pub to: f64,
    /// Equal ratios take equal room; the ends are above 0 then.
    pub logarithmic: bool,
}

impl Scale {
    /// An axis for these values, with a margin as a share of their range.
    pub fn new(values: impl Iterator<Item = f64>, from: f64, to: f64, margin: f64) -> Self {
        let (low, high) = values
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let room = if high > low { (high - low) * margin } else { 0.5 };
        Self { low: low - room, high: high + room, from, to, logarithmic: false }
    }

    /// The same for values above 0 on a logarithmic axis; others are left out.
    pub fn logarithmic(values: impl Iterator<Item = f64>, from: f64, to: f64, margin: f64) -> Self {
        let exponents = Self::new(values.filter(|x| *x > 0.0).map(libm::log10), from, to, margin);
        let [low, high] = [exponents.low, exponents.high].map(|exponent| libm::pow(10.0, exponent));
        Self { low, high, logarithmic: true, ..exponents }
    }

    /// Where a value is drawn.
    pub fn at(&self, value: f64) -> f64 {
        if self.logarithmic {
            let share = libm::log10(value / self.low) / libm::log10(self.high / self.low);
            return self.from + share * (self.to - self.from);
        }
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Round values within the axis, about `count` of them, and their decimals.
    pub fn ticks(&self, count: f64) -> (Vec<f64>, usize) {
        if self.logarithmic {
            return self.decades();
        }
        let rough = (self.high - self.low) / count;
        let decade = libm::floor(libm::log10(rough));
        let power = libm::pow(10.0, decade);
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= rough).unwrap_or(10.0 * power);
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        let digits = (-libm::floor(libm::log10(step) + 1e-9)).max(0.0) as usize;
        ((first..=last).map(|k| k as f64 * step).collect(), digits)
    }

    /// 1, 2 and 5 of every decade within the axis; the powers of ten alone where these are many.
    fn decades(&self) -> (Vec<f64>, usize) {
        let decades = [self.low, self.high].map(|end| libm::floor(libm::log10(end)) as i32);
        let steps: &[f64] = if decades[1] - decades[0] > 3 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let all = (decades[0]..=decades[1]).flat_map(|decade| {
            // 10^−2 as a quotient of whole numbers: what it is printed as.
            let power = libm::pow(10.0, f64::from(decade.abs()));
            steps.iter().map(move |step| if decade < 0 { step / power } else { step * power })
        });
        let ticks: Vec<f64> = all.filter(|tick| (self.low..=self.high).contains(tick)).collect();
        let least = ticks.first().copied().unwrap_or(1.0);
        let digits = (-libm::floor(libm::log10(least) + 1e-9)).max(0.0) as usize;
        (ticks, digits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_has_equal_room_for_equal_ratios() {
        let scale = Scale::logarithmic([1.0, 0.0, 100.0].into_iter(), 0.0, 200.0, 0.0);
        for (value, place) in [(1.0, 0.0), (10.0, 100.0), (100.0, 200.0)] {
            assert!((scale.at(value) - place).abs() < 1e-9, "{value} at {}", scale.at(value));
        }
        let wider = Scale::logarithmic([0.5, 300.0].into_iter(), 0.0, 200.0, 0.0);
        assert_eq!(wider.ticks(6.0), (vec![0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0], 1));
        let widest = Scale::logarithmic([1.0, 1e6].into_iter(), 0.0, 200.0, 0.0);
        assert_eq!(widest.ticks(6.0).0.len(), 7);
    }
}
