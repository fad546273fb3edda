//! `results.csv`: every number that came out, beside the published one where there is one, with a verdict that is computed.

use super::claims;
use super::published::{Published, published};
use super::row::{self, Row};
use super::verdict::{Count, Verdict};
use std::fmt::Write;

/// All numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Results {
    /// In the order in which they are written.
    pub rows: Vec<Row>,
    /// The end of what the command prints.
    pub text: String,
}

impl Results {
    /// The row of a quantity.
    pub fn get(&self, test: &str, preset: &str, noise: bool, controller: &str, quantity: &str) -> Option<&Row> {
        row::find(&self.rows, test, preset, noise, controller, quantity)
    }

    /// The verdict on a row that the paper has a number for, or a claim in words.
    pub fn verdict(&self, row: &Row) -> Option<Verdict> {
        let Some(ours) = row.published() else { return claims::about(row).map(|claim| claim.judge(row, &self.rows)) };
        if row.value.is_some_and(|v| ours.agrees(v)) {
            return Some(Verdict::Reproduced);
        }
        let both = |controller| {
            let here = self.get(&row.test, &row.preset, row.noise, controller, row.quantity)?.value?;
            let there = published(row.family(), controller, row.quantity)?.number();
            Some((here, there))
        };
        Some(match (both("classic"), both("adaptive")) {
            // The published gain is 1 − adaptive/classic; half of it or more is the effect, though not its size.
            (Some((classic, classic_there)), Some((adaptive, adaptive_there)))
                if classic_there > 0.0 && 1.0 - adaptive / classic >= 0.5 * (1.0 - adaptive_there / classic_there) =>
            {
                Verdict::Partly
            }
            _ => Verdict::NotReproduced,
        })
    }

    /// What stands for a published number, as a table for the terminal, and what the map says.
    pub fn table(&self) -> String {
        let mut text = String::new();
        for row in self.rows.iter().filter(|r| r.is_shown()) {
            let Some((published, verdict)) = row.published().zip(self.verdict(row)) else { continue };
            let value = row.value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}"));
            let _ = writeln!(
                text,
                "{:<14}{:<10}{:<10}{:<13}{value:>8} {:<4}published {:>6}  {verdict}",
                row.test,
                row.preset,
                row.controller,
                row.quantity,
                row.unit,
                published.number(),
            );
        }
        text + &self.text
    }

    /// How many of what a preset's rows stand for came out: reproduced, partly, not; of numbers and of claims in words. The paper
    /// shows no disturbances, so these do not count.
    pub fn counts(&self, preset: &str) -> [Count; 2] {
        let mut counts = [Count::default(); 2];
        for row in self.rows.iter().filter(|r| r.preset == preset && r.is_shown() && r.family() != "disturb") {
            let Some(verdict) = self.verdict(row) else { continue };
            let count = &mut counts[usize::from(row.published().is_none())];
            match verdict {
                Verdict::Reproduced => count.reproduced += 1,
                Verdict::Partly => count.partly += 1,
                Verdict::NotReproduced => count.not += 1,
            }
        }
        counts
    }

    /// As `results.csv`.
    pub fn to_csv(&self) -> String {
        let mut csv = String::from("test,preset,noise,controller,quantity,value,spread,unit,published,verdict\n");
        let number = |x: Option<f64>| x.map(|x| x.to_string()).unwrap_or_default();
        for row in &self.rows {
            let verdict = self.verdict(row).map(|v| v.to_string()).unwrap_or_default();
            let published = number(row.published().map(Published::number));
            let noise = if row.noise { "on" } else { "off" };
            let _ = writeln!(
                csv,
                "{},{},{noise},{},{},{},{},{},{published},{verdict}",
                row.test,
                row.preset,
                row.controller,
                row.quantity,
                number(row.value),
                number(row.spread),
                row.unit,
            );
        }
        csv
    }
}
