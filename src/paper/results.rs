//! `results.csv`: every number that came out, beside the published one where there is one, with a verdict that is computed.

use super::claims;
use super::published::{Published, Weight, published};
use super::row::{self, Row};
use super::tally::{self, Tally, TallyRow};
use super::verdict::Verdict;
use crate::table::{Layout, record};
use std::fmt::Write;

/// A number that is further away than this factor is not even partly the published one.
pub const FACTOR: f64 = 2.0;

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
        let is_near = row.value.is_some_and(|v| ours.is_within_factor(FACTOR, v));
        Some(if is_near && self.gains_half(row) { Verdict::Partly } else { Verdict::NotReproduced })
    }

    /// Whether the adaptive law gains at least half of what it gains in the paper, 1 − adaptive/classic: the effect, though not
    /// its size.
    fn gains_half(&self, row: &Row) -> bool {
        let both = |controller| {
            let here = self.get(&row.test, &row.preset, row.noise, controller, row.quantity)?.value?;
            let there = published(row.family(), controller, row.quantity)?.number();
            Some((here, there))
        };
        let Some(((classic, classic_there), (adaptive, adaptive_there))) = both("classic").zip(both("adaptive")) else {
            return false;
        };
        classic_there > 0.0 && 1.0 - adaptive / classic >= 0.5 * (1.0 - adaptive_there / classic_there)
    }

    /// What stands for a published number, as a table for the terminal, and what the map says.
    pub fn table(&self) -> String {
        let mut text = String::new();
        for row in self.rows.iter().filter(|r| r.is_shown()) {
            let Some((published, verdict)) = row.published().zip(self.verdict(row)) else { continue };
            let value = row.value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}"));
            let _ = writeln!(
                text,
                "{:<20}{:<10}{:<10}{:<13}{value:>8} {:<4}published {:>6}  {verdict}",
                row.test,
                row.preset,
                row.controller,
                row.quantity,
                row.unit,
                published.number(),
            );
        }
        text + &tally::lines(&self.counts()) + &self.text
    }

    /// The recordings that were driven, as they are named behind a test: empty for the first.
    pub fn recordings(&self) -> Vec<&str> {
        let mut recordings = vec![""];
        for row in self.rows.iter().filter(|r| r.is_shown()) {
            if !recordings.contains(&row.recording()) {
                recordings.push(row.recording());
            }
        }
        recordings
    }

    /// How many of the paper's numbers and claims came out under a preset with one recording. The paper shows no disturbances, so
    /// these do not count.
    pub fn tally(&self, preset: &str, recording: &str) -> Tally {
        let mut tally = Tally::default();
        let mut claims: Vec<(&str, Verdict)> = Vec::new();
        for row in self.rows.iter().filter(|r| r.preset == preset && r.is_shown() && r.family() != "disturb") {
            // What is driven on no recording belongs to each of them.
            let is_meant = !row::is_on_road(row.family()) || row.recording() == recording;
            let Some(verdict) = self.verdict(row).filter(|_| is_meant) else { continue };
            if let Some(weight) = row.weight() {
                tally.numbers.add(verdict);
                if weight == Weight::Fact {
                    tally.facts.add(verdict);
                }
            } else if let Some(claim) = claims::about(row) {
                // A claim about several quantities holds if it does for all of them.
                match claims.iter_mut().find(|(words, _)| *words == claim.words) {
                    Some((_, worst)) => *worst = verdict.max(*worst),
                    None => claims.push((claim.words, verdict)),
                }
            }
        }
        claims.iter().for_each(|(_, verdict)| tally.claims.add(*verdict));
        tally
    }

    /// The rows of `counts.csv`: presets and recordings as they are listed.
    pub fn counts(&self) -> Vec<TallyRow> {
        let mut presets: Vec<&str> = Vec::new();
        for row in self.rows.iter().filter(|row| row.is_shown() && row.preset != "none") {
            if !presets.contains(&row.preset.as_str()) {
                presets.push(&row.preset);
            }
        }
        let recordings = self.recordings();
        let all = presets.iter().flat_map(|preset| recordings.iter().map(move |recording| (*preset, *recording)));
        all.filter_map(|(preset, recording)| tally::row(preset, recording, &self.tally(preset, recording))).collect()
    }

    /// The rows of `results.csv`.
    pub fn lines(&self) -> Vec<ResultRow> {
        let line = |row: &Row| ResultRow {
            test: row.test.clone(),
            preset: row.preset.clone(),
            noise: if row.noise { "on" } else { "off" },
            controller: row.controller,
            quantity: row.quantity,
            value: row.value,
            spread: row.spread,
            unit: row.unit,
            published: row.published().map(Published::number),
            verdict: self.verdict(row).map(|verdict| verdict.to_string()),
        };
        self.rows.iter().map(line).collect()
    }

    /// As `results.csv`. Small numbers have all their zeros, as they always had in this table.
    pub fn to_csv(&self) -> String {
        let names: Vec<String> = layout().shape.columns.into_iter().map(|column| column.name).collect();
        let mut csv = names.join(",") + "\n";
        let number = |x: Option<f64>| x.map(|x| x.to_string()).unwrap_or_default();
        for row in self.lines() {
            let ResultRow { test, preset, noise, controller, quantity, unit, .. } = &row;
            let [value, spread, published] = [row.value, row.spread, row.published].map(number);
            let verdict = row.verdict.as_deref().unwrap_or_default();
            let _ = writeln!(
                csv,
                "{test},{preset},{noise},{controller},{quantity},{value},{spread},{unit},{published},{verdict}"
            );
        }
        csv
    }
}

record! {
    /// A number that came out.
    #[derive(Debug, Clone, PartialEq)]
    pub struct ResultRow {
        test: String = "The test, with its recording if that is not the first: step, driver_udds, ...";
        preset: String = "The preset";
        noise: &'static str = "on where the speed is measured with noise, else off";
        controller: &'static str = "The controller";
        quantity: &'static str = "What was measured";
        value: Option<f64> = "Its value, in the unit that the row says; none if it never settled or arrived";
        spread: Option<f64> = "Standard deviation over the seeds of the noise, in the same unit";
        unit: &'static str = "Unit of value, spread and published";
        published: Option<f64> = "The published value, where there is one";
        verdict: Option<String> = "reproduced, partly, or not reproduced, where the paper has a number or a claim in words";
    }
}

/// The columns of `results.csv`.
pub fn layout() -> Layout<ResultRow> {
    Layout::of_record(["results", "result"], "One row per number: ours, the paper's, and the verdict")
}
