//! Errors and speeds by road.

use crate::stats::Sums;
use std::collections::HashMap;

/// What happens on each road, summed between readings.
#[derive(Default)]
pub struct Roads {
    index: HashMap<String, u32>,
    sums: Vec<Sums>,
}

impl Roads {
    pub(super) fn index(&mut self, name: &str) -> u32 {
        if let Some(index) = self.index.get(name) {
            return *index;
        }
        let index = u32::try_from(self.sums.len()).expect("fewer than 2^32 roads");
        self.sums.push(Sums::default());
        self.index.insert(name.to_owned(), index);
        index
    }

    pub(super) fn add(&mut self, road: u32, more: &Sums) {
        let sums = &mut self.sums[road as usize];
        sums.samples += more.samples;
        sums.error_mps += more.error_mps;
        sums.error_squared += more.error_squared;
        sums.speed_mps += more.speed_mps;
    }

    /// Roads and their sums, in no particular order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Sums)> {
        self.index.iter().map(|(name, index)| (name.as_str(), &self.sums[*index as usize]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_a_road_has_the_sum_of_all_that_was_driven_on_it() {
        let parts = [(10, -2.0, 4.5, 90.0), (20, 0.5, 1.25, 200.0), (5, -0.25, 0.5, 10.0)];
        let parts = parts.map(|(samples, error_mps, error_squared, speed_mps)| Sums {
            samples,
            error_mps,
            error_squared,
            speed_mps,
        });
        let mut roads = Roads::default();
        for (name, part) in ["a", "b", "a"].into_iter().zip(&parts) {
            let road = roads.index(name);
            roads.add(road, part);
        }
        let found: HashMap<_, _> =
            roads.iter().map(|(name, s)| (name, (s.samples, s.error_mps, s.error_squared, s.speed_mps))).collect();
        assert_eq!(found, HashMap::from([("a", (15, -2.25, 5.0, 100.0)), ("b", (20, 0.5, 1.25, 200.0))]));
    }
}
