//! `edges.csv`: the tracking error by road.

use std::collections::BTreeMap;

/// One edge.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeRow {
    /// SUMO's id of the edge.
    pub edge: String,
    /// Control periods of all egos on it.
    pub samples: u64,
    /// Mean of e = V_x − y_ref [m/s].
    pub error_mean: Option<f64>,
    /// Root mean square of e [m/s].
    pub error_rms: Option<f64>,
    /// Mean of V_x [m/s].
    pub speed_mean: Option<f64>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    samples: u64,
    error_mps: f64,
    error_squared: f64,
    speed_mps: f64,
}

/// Sums by edge; memory grows with the network, not with time. The road of a vehicle is read once a second, and all its
/// control periods since the last reading count for it: around a junction up to a second goes to the wrong side.
#[derive(Debug, Clone, Default)]
pub struct EdgeTable(BTreeMap<String, Sums>);

impl EdgeTable {
    /// Adds the sums over `samples` control periods on `edge`: Σe, Σe², ΣV_x. For equal bytes whatever the number of
    /// threads, call it in an order that does not depend on them.
    pub fn add(&mut self, edge: &str, samples: u64, error_mps: f64, error_squared: f64, speed_mps: f64) {
        if samples == 0 {
            return;
        }
        if !self.0.contains_key(edge) {
            self.0.insert(edge.to_owned(), Sums::default());
        }
        if let Some(sums) = self.0.get_mut(edge) {
            sums.samples += samples;
            sums.error_mps += error_mps;
            sums.error_squared += error_squared;
            sums.speed_mps += speed_mps;
        }
    }

    /// The rows, ordered by edge.
    pub fn rows(&self) -> Vec<EdgeRow> {
        let row = |(edge, sums): (&String, &Sums)| {
            let n = sums.samples as f64;
            EdgeRow {
                edge: edge.clone(),
                samples: sums.samples,
                error_mean: Some(sums.error_mps / n),
                error_rms: Some((sums.error_squared / n).sqrt()),
                speed_mean: Some(sums.speed_mps / n),
            }
        };
        self.0.iter().map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_several_vehicles_meet_on_their_edge() {
        let mut table = EdgeTable::default();
        table.add("b", 100, 10.0, 4.0, 1000.0);
        table.add("a", 50, 0.0, 0.0, 250.0);
        table.add("b", 300, -30.0, 12.0, 5000.0);
        table.add("empty", 0, 0.0, 0.0, 0.0);
        let rows = table.rows();
        assert_eq!(rows.iter().map(|r| r.edge.as_str()).collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(rows[1].samples, 400);
        assert_eq!(rows[1].error_mean, Some(-0.05));
        assert_eq!(rows[1].error_rms, Some(0.2));
        assert_eq!(rows[1].speed_mean, Some(15.0));
    }
}
