//! `summary.json` and the words that a run ends with.

use super::rows::{QUALITY, VEHICLES};
use super::spread::Spread;
use super::tally::{Remarkable, Tallied};
use crate::cosim::Reason;
use crate::table::{Column, Kind, Layout, record};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

record! {
    /// What SUMO itself counted, vehicles that are not egos included.
    #[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
    pub struct SumoTotals {
        inserted: u64 = "Vehicles that entered the road";
        arrived: u64 = "Vehicles that reached the end of their route";
        time_loss_mean_s: Option<f64> = "Mean time loss of those that arrived" ["s"];
        collisions: u64 = "Collisions";
        teleports: u64 = "Teleports";
    }
}

/// Further counts of vehicles, and what they say.
pub(super) const COUNTS: [(&str, &str); 4] = [
    ("unequipped", "Departed vehicles that the selectors left to SUMO"),
    ("other_classes", "Departed vehicles without four wheels"),
    ("refused", "Departed vehicles that were to be egos but cannot be"),
    ("crept", "Egos that crept; the note of the run says what that is"),
];

/// The contents of `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version of this file's form.
    pub schema: u32,
    /// `vehicles` (egos that departed), one count per reason, and whatever else the run counted.
    pub counts: BTreeMap<String, u64>,
    /// What SUMO counted.
    pub sumo: SumoTotals,
    /// Every numeric column over the egos that have a value in it.
    pub fleet: BTreeMap<String, Spread>,
    /// How long the run took \[s\].
    pub wall_s: f64,
    /// Simulated over real time; none if no time passed.
    pub real_time_factor: Option<f64>,
}

impl Summary {
    /// Sums up a run; `counted` is in the order of `COUNTS`; times are the simulated and the real one.
    pub(super) fn new(
        rows: Tallied,
        counted: [u64; COUNTS.len()],
        sumo: SumoTotals,
        [simulated_s, wall_s]: [f64; 2],
    ) -> Self {
        let mut counts = BTreeMap::from([("vehicles".to_owned(), rows.vehicles)]);
        let of_reason = |reason: Reason| rows.reasons.get(reason.as_str()).copied().unwrap_or(0);
        counts.extend(Reason::ALL.map(|reason| (reason.as_str().to_owned(), of_reason(reason))));
        counts.extend(COUNTS.iter().zip(counted).map(|((name, _), count)| ((*name).to_owned(), count)));
        let real_time_factor = (wall_s > 0.0).then(|| simulated_s / wall_s);
        Self { schema: 1, counts, sumo, fleet: rows.fleet, wall_s, real_time_factor }
    }

    /// A count, 0 if it was not made.
    pub fn count(&self, name: &str) -> u64 {
        self.counts.get(name).copied().unwrap_or(0)
    }
}

/// The fields of `summary.json`, as `schema.json` shows them.
pub(super) fn summary_fields() -> Vec<Column> {
    let within = |object: &str, column: Column| Column { name: format!("{object}.{}", column.name), ..column };
    let count = |name: &str, meaning: &str| within("counts", Column::new(name, Kind::Count, None, meaning));
    let reasons =
        Reason::ALL.map(|r| count(r.as_str(), &format!("Egos whose row ended with the reason {}", r.as_str())));
    let sumo: Layout<SumoTotals> = Layout::of_record(["sumo", "run"], "SUMO's totals");
    let columns = VEHICLES.shape.columns.iter().chain(&QUALITY.shape.columns);
    let fleet = columns.filter(|column| column.in_summary).map(|column| {
        let meaning = format!("mean, p05, p50, p95 and max over the egos: {}", column.meaning);
        within("fleet", Column { kind: Kind::Number, meaning, ..column.clone() })
    });
    [count("vehicles", "Egos that departed")]
        .into_iter()
        .chain(reasons)
        .chain(COUNTS.map(|(name, meaning)| count(name, meaning)))
        .chain(sumo.shape.columns.into_iter().map(|column| within("sumo", column)))
        .chain(fleet.collect::<Vec<_>>())
        .chain([
            Column::new("wall_s", Kind::Number, Some("s"), "How long the run took"),
            Column::new("real_time_factor", Kind::Number, None, "Simulated over real time"),
        ])
        .collect()
}

/// What `run` says at its end, what matters first: at most ten lines, a line break after each.
pub fn terminal_text(summary: &Summary, remarkable: &Remarkable, dir: &Path, files: &[String]) -> String {
    let mut lines = Vec::new();
    let reasons = Reason::ALL.map(|r| (summary.count(r.as_str()), r.as_str().replace('_', " ")));
    let reasons: Vec<_> = reasons.iter().filter(|(n, _)| *n > 0).map(|(n, reason)| format!("{n} {reason}")).collect();
    let vehicles = summary.count("vehicles");
    lines.push(("vehicles", [vec![vehicles.to_string()], reasons].concat().join(", ")));
    let spread = |column: &str, unit: &str| match summary.fleet.get(column) {
        Some(s) => format!("p50 {:.3}, p95 {:.3} {unit}", s.p50, s.p95),
        None => "no samples".to_owned(),
    };
    lines.push(("error RMS", spread("error_rms", "m/s")));
    lines.push(("speed gap RMS", spread("speed_gap_rms", "m/s")));
    if let Some(s) = summary.fleet.get("lead_limited") {
        lines.push(("lead limited", format!("{:.2} % of the steps", 100.0 * s.mean)));
    }
    let sumo = &summary.sumo;
    let loss = sumo.time_loss_mean_s.map(|s| format!(", mean time loss {s:.1} s")).unwrap_or_default();
    lines.push(("SUMO", format!("{} inserted, {} arrived{loss}", sumo.inserted, sumo.arrived)));
    let Remarkable { clamped, clamped_steps: clamps, worst } = remarkable;
    lines.push(("clamps", format!("{clamps} steps in {clamped} of {vehicles} vehicles")));
    lines.push(("collisions", format!("{}, teleports {}", sumo.collisions, sumo.teleports)));
    let factor = summary.real_time_factor.map(|f| format!("{f:.1} x real time, ")).unwrap_or_default();
    lines.push(("speed", format!("{factor}{:.1} s", summary.wall_s)));
    if !worst.is_empty() {
        let named: Vec<String> = worst.iter().map(|(id, rms)| format!("{id} {rms:.3}")).collect();
        lines.push(("worst", format!("{} m/s error RMS", named.join(", "))));
    }
    let (sumo_files, own): (Vec<_>, Vec<_>) = files.iter().partition(|f| f.starts_with("sumo/"));
    let mut written: Vec<&str> = own.into_iter().map(String::as_str).collect();
    if !sumo_files.is_empty() {
        written.push("sumo/");
    }
    lines.push(("written", format!("{}: {}", dir.display(), written.join(" "))));
    lines.iter().map(|(name, text)| format!("{name:<14} {text}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::super::rows::tests::vehicle;
    use super::super::tally::Tally;
    use super::*;
    use crate::output::texts;

    fn summary() -> (Remarkable, Summary) {
        let mut rows: Vec<_> = (0..5).map(|i| vehicle(&i.to_string(), f64::from(i))).collect();
        for (i, row) in rows.iter_mut().enumerate() {
            row.stats.error_rms = (i > 0).then_some(i as f64 / 10.0);
        }
        rows[4].reason = Reason::Running;
        rows[4].stats.clamped_steps = 7;
        let totals = SumoTotals { inserted: 6, arrived: 4, time_loss_mean_s: Some(12.5), collisions: 1, teleports: 2 };
        let mut tally = Tally::new(Path::new("/nowhere"));
        let quality = vec![String::new(); QUALITY.shape.columns.len()];
        rows.iter().for_each(|row| tally.add(&[texts(&VEHICLES, row), quality.clone()]).unwrap());
        let rows = tally.finish().unwrap();
        (rows.remarkable.clone(), Summary::new(rows, [0; 4], totals, [600.0, 20.0]))
    }

    #[test]
    fn counts_and_fleet_come_from_the_rows() {
        let (_, summary) = summary();
        assert_eq!((summary.count("vehicles"), summary.count("arrived"), summary.count("running")), (5, 4, 1));
        let rms = summary.fleet["error_rms"];
        assert!((rms.mean - 0.25).abs() < 1e-15 && (rms.max - 0.4).abs() < 1e-15, "{rms:?}");
        assert_eq!(summary.fleet["clamped_steps"].max, 7.0);
        assert!(!summary.fleet.contains_key("depart") && !summary.fleet.contains_key("id"));
        assert_eq!(summary.real_time_factor, Some(30.0));
    }

    #[test]
    fn json_has_the_form_that_was_promised() {
        let (_, summary) = summary();
        let value = serde_json::to_value(&summary).unwrap();
        assert_eq!(value["schema"], 1);
        assert_eq!(
            value["sumo"],
            serde_json::json!({"inserted": 6, "arrived": 4, "time_loss_mean_s": 12.5, "collisions": 1, "teleports": 2})
        );
        let keys: Vec<_> = value["fleet"]["timeloss"].as_object().unwrap().keys().cloned().collect();
        assert_eq!(keys, ["max", "mean", "p05", "p50", "p95"]);
        assert_eq!(serde_json::from_value::<Summary>(value).unwrap(), summary);
    }

    #[test]
    fn the_terminal_text_names_what_was_promised() {
        let (remarkable, summary) = summary();
        let files = ["run.json", "sumo/log.txt", "vehicles.csv"].map(str::to_owned);
        let text = terminal_text(&summary, &remarkable, Path::new("out/city-adaptive-42"), &files);
        insta::assert_snapshot!(text, @r"
        vehicles       5, 4 arrived, 1 running
        error RMS      p50 0.250, p95 0.385 m/s
        speed gap RMS  p50 0.200, p95 0.200 m/s
        lead limited   0.00 % of the steps
        SUMO           6 inserted, 4 arrived, mean time loss 12.5 s
        clamps         7 steps in 1 of 5 vehicles
        collisions     1, teleports 2
        speed          30.0 x real time, 20.0 s
        worst          4 0.400, 3 0.300, 2 0.200 m/s error RMS
        written        out/city-adaptive-42: run.json vehicles.csv sumo/
        ");
    }

    #[test]
    fn a_run_without_egos_still_has_an_end() {
        let summary = Summary::new(Tallied::default(), [0; 4], SumoTotals::default(), [0.0; 2]);
        let text = terminal_text(&summary, &Remarkable::default(), Path::new("out"), &[]);
        assert!(text.starts_with("vehicles       0\n") && text.contains("no samples"), "{text}");
    }
}
