//! How many of the paper's numbers, facts and claims came out under one preset with one recording.

use super::verdict::Count;
use crate::table::{Layout, record};

/// The counts. A test that was not driven is missing in them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Of the numbers that the paper prints.
    pub numbers: Count,
    /// Of those that are facts of their own.
    pub facts: Count,
    /// Of the claims in words.
    pub claims: Count,
}

impl Tally {
    /// What presets are ranked by: facts and claims that came out, then those that did partly.
    pub fn rank(&self) -> (usize, usize) {
        (self.facts.reproduced + self.claims.reproduced, self.facts.partly + self.claims.partly)
    }

    /// Whether nothing was judged.
    pub fn is_empty(&self) -> bool {
        self.numbers.all() + self.claims.all() == 0
    }
}

record! {
    /// A preset with a recording.
    #[derive(Debug, Clone, PartialEq)]
    pub struct TallyRow {
        preset: String = "The preset";
        recording: String = "What the tests driver and delay were driven on; steps and sinusoid are the same for all";
        numbers: u64 = "Published numbers that were reproduced";
        numbers_partly: u64 = "Those that were partly";
        numbers_driven: u64 = "Published numbers that were driven; the paper has fourteen";
        facts: u64 = "Facts that were reproduced: numbers without the mean of the error, and the standard deviation beside the RMS";
        facts_partly: u64 = "Those that were partly";
        facts_driven: u64 = "Facts that were driven; the paper has ten";
        claims: u64 = "Claims in words that were reproduced, each in all quantities that it is judged by";
        claims_partly: u64 = "Those that were partly";
        claims_driven: u64 = "Claims in words that were driven; the paper has ten";
    }
}

/// The columns of `counts.csv`.
pub fn layout() -> Layout<TallyRow> {
    Layout::of_record(["counts", "count"], "One row per preset and recording")
}

/// The row of a preset with a recording; none if nothing was driven.
pub fn row(preset: &str, recording: &str, tally: &Tally) -> Option<TallyRow> {
    let of = |count: Count| [count.reproduced, count.partly, count.all()].map(|n| n as u64);
    let ([numbers, numbers_partly, numbers_driven], [facts, facts_partly, facts_driven]) =
        (of(tally.numbers), of(tally.facts));
    let [claims, claims_partly, claims_driven] = of(tally.claims);
    (!tally.is_empty()).then(|| TallyRow {
        preset: preset.to_owned(),
        recording: recording_name(recording).to_owned(),
        numbers,
        numbers_partly,
        numbers_driven,
        facts,
        facts_partly,
        facts_driven,
        claims,
        claims_partly,
        claims_driven,
    })
}

/// A recording by what stands behind a test's name.
pub fn recording_name(suffix: &str) -> &str {
    if suffix.is_empty() { "driver" } else { suffix.trim_start_matches('_') }
}

/// The counts as lines of the terminal.
pub fn lines(rows: &[TallyRow]) -> String {
    let line = |row: &TallyRow| {
        format!(
            "{:<10}{:<14}{:>2} of {} numbers, {:>2} of {} facts, {:>2} of {} claims in words\n",
            row.preset,
            row.recording,
            row.numbers,
            row.numbers_driven,
            row.facts,
            row.facts_driven,
            row.claims,
            row.claims_driven
        )
    };
    let lines: String = rows.iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("\nreproduced, by preset and recording:\n{lines}") }
}
