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
