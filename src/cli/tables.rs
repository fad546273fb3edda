//! The tables that `--export` prints and no other part of the program has.

use crate::{
    output::Form,
    paper::results::Results,
    run::RunResult,
    scenario::Catalog,
    study::key_columns,
    table::{Column, Field, Kind, Layout, record},
    tune::TunedRow,
};

record! {
    /// An entry of a registry.
    pub struct Listed {
        kind: String = "controller, target, plant or body";
        name: String = "Its name";
        summary: String = "What it is";
    }
}

/// What `list` shows.
pub fn listed(catalog: &Catalog, form: Form) -> String {
    let lines = catalog.lines();
    let entries = lines.lines().map(|line| {
        let mut parts = line.splitn(3, '\t').map(str::to_owned);
        let mut part = || parts.next().unwrap_or_default();
        Listed { kind: part(), name: part(), summary: part() }
    });
    form.text(&Layout::of_record(["entries", "entry"], "One row per entry"), &entries.collect::<Vec<_>>())
}

record! {
    /// What a run ends with.
    pub struct RunLine {
        vehicles: u64 = "Egos that departed";
        complete: u64 = "Egos that arrived";
        error_rms_p50: Option<f64> = "Median of the error RMS" ["m/s"];
        error_rms_p95: Option<f64> = "Its 95 % quantile" ["m/s"];
        speed_gap_rms_p50: Option<f64> = "Median of the RMS of V_x − v*" ["m/s"];
        lead_limited: Option<f64> = "Mean share of the steps in which the reference was held";
        inserted: u64 = "Vehicles that SUMO inserted";
        arrived: u64 = "Vehicles that arrived";
        time_loss_mean: Option<f64> = "Their mean time loss" ["s"];
        clamped_steps: u64 = "Steps in which the torque was clamped, over all egos";
        collisions: u64 = "Collisions";
        teleports: u64 = "Teleports";
        real_time_factor: Option<f64> = "Simulated over real time";
        wall: f64 = "How long the run took" ["s"];
        folder: String = "Where the results are";
    }
}

/// What `run` ends with, in one row.
pub fn summed_up(result: &RunResult, form: Form) -> String {
    let (summary, fleet) = (&result.summary, &result.summary.fleet);
    let line = RunLine {
        vehicles: summary.count("vehicles"),
        complete: summary.count("arrived"),
        error_rms_p50: fleet.get("error_rms").map(|spread| spread.p50),
        error_rms_p95: fleet.get("error_rms").map(|spread| spread.p95),
        speed_gap_rms_p50: fleet.get("speed_gap_rms").map(|spread| spread.p50),
        lead_limited: fleet.get("lead_limited").map(|spread| spread.mean),
        inserted: summary.sumo.inserted,
        arrived: summary.sumo.arrived,
        time_loss_mean: summary.sumo.time_loss_mean_s,
        clamped_steps: result.remarkable.clamped_steps,
        collisions: summary.sumo.collisions,
        teleports: summary.sumo.teleports,
        real_time_factor: summary.real_time_factor,
        wall: summary.wall_s,
        folder: result.dir.display().to_string(),
    };
    form.text(&Layout::of_record(["runs", "run"], "One row per run"), &[line])
}

record! {
    /// A number of the reproduction beside the published one.
    pub struct Reproduced {
        test: String = "The test";
        preset: String = "The preset";
        controller: &'static str = "The controller";
        quantity: &'static str = "What was measured";
        value: Option<f64> = "Its value; none if it never settled or arrived";
        unit: &'static str = "Its unit";
        published: f64 = "The published value";
        weight: String = "Whether the number is a fact of its own, the same fact as error_rms, or says little";
        verdict: String = "reproduced, partly, or not reproduced";
    }
}

/// What `paper` shows.
pub fn reproduced(results: &Results, form: Form) -> String {
    let shown = results.rows.iter().filter(|row| row.is_shown()).filter_map(|row| {
        let (published, verdict) = row.published().zip(results.verdict(row))?;
        Some(Reproduced {
            test: row.test.clone(),
            preset: row.preset.clone(),
            controller: row.controller,
            quantity: row.quantity,
            value: row.value,
            unit: row.unit,
            published: published.number(),
            weight: row.weight().map(|weight| weight.to_string()).unwrap_or_default(),
            verdict: verdict.to_string(),
        })
    });
    form.text(&Layout::of_record(["numbers", "number"], "One row per number"), &shown.collect::<Vec<_>>())
}

record! {
    /// How far a case is.
    pub struct CaseLine {
        case: u64 = "Number of the case: its folder in cases/";
        seed: u64 = "Seed";
        status: &'static str = "done, failed, missing, running, pending or uncertain";
        reason: String = "Why it failed";
    }
}

/// A case in a list of cases.
pub struct Standing {
    /// The values of its keys.
    pub values: Vec<String>,
    /// How far it is.
    pub line: CaseLine,
}

/// What `--plan` and `--status` list, of a study that varies these keys.
pub fn standings(keys: &[String], cases: &[Standing], form: Form) -> String {
    let mut columns = key_columns(keys, |case: &Standing| &case.values);
    columns.extend(CaseLine::columns(Column::new("", Kind::Number, None, ""), |case: &Standing| &case.line));
    form.text(&Layout::new(["cases", "case"], "One row per case, after a column per varied key", columns), cases)
}

record! {
    /// A law in a condition, for people.
    pub struct TunedLine {
        condition: String = "The condition";
        law: String = "The law";
        test_rms as "test RMS [m/s]": String = "On other recordings than those of the tuning, with its interval";
        ratio as "/ first law": String = "Over the first law, each with the gains of this condition";
        once as "/ first law, tuned once": String = "Over the first law, each with the gains of the first condition";
        gains: String = "What was found";
    }
}

/// What `tune` found, for people.
pub fn tuned(rows: &[TunedRow], form: Form) -> String {
    let number = |mean: Option<f64>, half: Option<f64>, decimals: usize| match (mean, half) {
        (Some(mean), Some(half)) => format!("{mean:.decimals$} ± {half:.decimals$}"),
        (Some(mean), None) => format!("{mean:.decimals$}"),
        _ => "-".to_owned(),
    };
    let line = |row: &TunedRow| {
        let unfinished = if row.unfinished > 0 { format!(" ({} unfinished)", row.unfinished) } else { String::new() };
        let edge = if row.at_edge { " (at the edge of the range)" } else { "" };
        TunedLine {
            condition: row.condition.clone(),
            law: row.controller.clone(),
            test_rms: number(row.test_rms, row.test_ci95, 3) + &unfinished,
            ratio: number(row.test_ratio, row.test_ratio_ci95, 2),
            once: number(row.once_ratio, row.once_ratio_ci95, 2),
            gains: row.gains.replace("controller.", "") + edge,
        }
    };
    let lines: Vec<TunedLine> = rows.iter().map(line).collect();
    form.text(&Layout::of_record(["tuning", "law"], "One row per condition and law"), &lines)
}
