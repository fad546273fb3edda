//! Where a value stands among sorted ones, in a time that does not depend on how many there are: an index of equal
//! buckets, and a search within one.

/// Buckets per value: in most buckets nothing is left to search, so that nothing is guessed wrongly either.
const FINENESS: usize = 4;

/// The index of sorted, finite values.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Index {
    first: f64,
    buckets_per_unit: f64,
    last_bucket: f64,
    buckets: Vec<Bucket>,
}

/// How many values are before a bucket, and how many up to its end.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Bucket {
    before: u32,
    after: u32,
}

impl Index {
    /// Indexes values in ascending order, fewer than 2³⁰.
    pub fn new(sorted: impl ExactSizeIterator<Item = f64> + Clone) -> Self {
        let last_bucket = FINENESS * sorted.len();
        let (Some(first), Some(last)) = (sorted.clone().next(), sorted.clone().last()) else { return Self::default() };
        let buckets_per_unit = if last > first { last_bucket as f64 / (last - first) } else { 0.0 };
        let buckets = vec![Bucket::default(); last_bucket + 1];
        let mut index = Self { first, buckets_per_unit, last_bucket: last_bucket as f64, buckets };
        for value in sorted {
            let bucket = index.bucket(value);
            index.buckets[bucket].after += 1;
        }
        let mut count = 0;
        for bucket in &mut index.buckets {
            *bucket = Bucket { before: count, after: count + bucket.after };
            count = bucket.after;
        }
        index
    }

    /// How many of the values are at most `x`; `at` is the i-th value. Rounding does no harm: whatever falls into an earlier
    /// bucket than `x` is less than `x`, because the bucket never falls as the value grows.
    #[inline]
    pub fn count_up_to(&self, x: f64, at: impl Fn(usize) -> f64) -> usize {
        let known = x >= self.first;
        let Some(bucket) = self.buckets.get(self.bucket(x)).filter(|_| known) else { return 0 };
        let (mut low, mut high) = (bucket.before as usize, bucket.after as usize);
        while low < high {
            let middle = low.midpoint(high);
            if at(middle) <= x {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    #[inline]
    fn bucket(&self, value: f64) -> usize {
        ((value - self.first) * self.buckets_per_unit).min(self.last_bucket) as u32 as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn law_the_index_counts_like_a_search_over_everything() {
        let mut random = Stream::new(1, "values", "index");
        let clustered: Vec<f64> = (0..300).map(|_| random.normal() * random.normal() * 50.0).collect();
        let even: Vec<f64> = (0..100).map(|k| 0.1 * f64::from(k)).collect();
        let tight = vec![1.0, 1.0, 1.0 + f64::EPSILON, 1.0 + f64::EPSILON];
        let far = vec![0.0, 1e-300, 5.0, 5.0, 1e300];
        for mut values in [clustered, even, tight, far, vec![3.0], vec![3.0; 5], vec![]] {
            values.sort_by(f64::total_cmp);
            let index = Index::new(values.iter().copied());
            let near = |v: &f64| [v.next_down(), *v, v.next_up(), 0.5 * v];
            let asked = values.iter().flat_map(near).chain([f64::NEG_INFINITY, -1e9, 0.0, 1e9, f64::INFINITY]);
            for x in asked {
                let expected = values.partition_point(|v| *v <= x);
                assert_eq!(index.count_up_to(x, |i| values[i]), expected, "{x} among {values:?}");
            }
        }
    }
}
