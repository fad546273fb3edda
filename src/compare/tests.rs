use super::*;
use crate::run::{Spread, Summary, SumoTotals};
use crate::table::Cell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// A run whose error RMS is `rms` everywhere.
fn summary(rms: f64, collisions: u64) -> Summary {
    let spread = |x: f64| Spread { mean: x, p05: x, p50: x, p95: 2.0 * x, max: 3.0 * x };
    let columns = ["error_rms", "speed_gap_rms", "lead_limited", "overshoot_max", "jerk_rms"];
    Summary {
        schema: 1,
        counts: BTreeMap::from([("vehicles".to_owned(), 10), ("arrived".to_owned(), 9)]),
        sumo: SumoTotals { inserted: 10, arrived: 9, time_loss_mean_s: Some(31.5), collisions, teleports: 0 },
        fleet: columns.map(|c| (c.to_owned(), spread(rms))).into(),
        wall_s: 1.0,
        real_time_factor: Some(600.0),
    }
}

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|n| (*n).to_owned()).collect()
}

/// The first controller's error grows with the seed; the second's is larger by 0.1, 0.2, 0.3, ...
fn paired(controller: &str, seed: u64) -> Result<Summary, std::io::Error> {
    let base = seed as f64;
    Ok(if controller == "ideal" { summary(base, 0) } else { summary(base + 0.1 * base, seed) })
}

#[test]
fn differences_are_paired_seed_by_seed() {
    let rows = run_all(&names(&["ideal", "classic"]), &[1, 2, 3], 1, paired).unwrap();
    assert_eq!(rows[0].metrics[2], Measured { mean: Some(2.0), difference: None });
    let error = rows[1].metrics[2];
    let difference = error.difference.unwrap();
    let near = |got: f64, wanted: f64| assert!((got - wanted).abs() < 1e-9, "{got} instead of {wanted}");
    near(error.mean.unwrap(), 2.2);
    near(difference.mean, 0.2);
    // The errors themselves spread by 1.1 over the seeds, the differences only by 0.1.
    near(difference.sd.unwrap(), 0.1);
    near(difference.half_width.unwrap(), 4.302_652_73 * 0.1 / 3f64.sqrt());
    near(rows[1].metrics[3].difference.unwrap().mean, 0.4);
    near(rows[1].metrics[9].mean.unwrap(), 2.0);
}

#[test]
fn one_seed_has_a_difference_but_no_spread() {
    let rows = run_all(&names(&["ideal", "classic"]), &[2], 4, paired).unwrap();
    let difference = rows[1].metrics[2].difference.unwrap();
    assert_eq!((difference.sd, difference.half_width), (None, None));
    assert!(terminal_table(&rows).contains("+0.200"), "{}", terminal_table(&rows));
}

#[test]
fn law_the_number_of_jobs_changes_nothing() {
    let controllers = names(&["ideal", "classic", "adaptive", "pid"]);
    let seeds: Vec<u64> = (1..=7).collect();
    let one = run_all(&controllers, &seeds, 1, paired).unwrap();
    let many = run_all(&controllers, &seeds, 5, |c, s| {
        // Late seeds finish first.
        std::thread::sleep(std::time::Duration::from_millis(8 - s));
        paired(c, s)
    });
    assert_eq!(one, many.unwrap());
}

#[test]
fn jobs_run_at_the_same_time() {
    // Two runs that wait for each other end only if both are under way.
    let barrier = std::sync::Barrier::new(2);
    let meet = |c: &str, s: u64| {
        barrier.wait();
        paired(c, s)
    };
    assert_eq!(run_all(&names(&["ideal", "classic"]), &[1, 2], 2, meet).unwrap().len(), 2);
}

#[test]
fn after_a_failure_nothing_more_is_started() {
    let started = AtomicU64::new(0);
    let run = |c: &str, s: u64| {
        started.fetch_add(1, Ordering::Relaxed);
        if s == 2 { Err(std::io::Error::other("SUMO died")) } else { paired(c, s) }
    };
    let error = run_all(&names(&["ideal", "classic"]), &[1, 2, 3], 1, run).unwrap_err();
    assert_eq!(error.to_string(), "the run of ideal with seed 2 failed");
    assert_eq!(error.source.to_string(), "SUMO died");
    assert_eq!(started.into_inner(), 3);
}

#[test]
fn comparison_csv_has_the_metrics_in_their_places() {
    let mut rows = run_all(&names(&["ideal", "classic"]), &[1, 2, 3], 1, paired).unwrap();
    let columns = &COMPARISON.shape.columns;
    assert_eq!(columns.len(), 2 + 4 * METRIC_COUNT);
    for (k, metric) in METRICS.iter().enumerate() {
        rows[1].metrics[k].mean = Some(k as f64);
        let own = &columns[2 + 4 * k..6 + 4 * k];
        assert_eq!(own[0].name, metric.name);
        assert_eq!(own[1].name, format!("{}_diff", metric.name));
        let cells: Vec<_> = COMPARISON.cells(&rows[1]).skip(2 + 4 * k).map(Cell::number).collect();
        assert_eq!(cells[0], Some(k as f64));
        assert_eq!(cells[2], rows[1].metrics[k].difference.and_then(|d| d.sd));
    }
    let folder = tempfile::tempdir().unwrap();
    write_comparison(folder.path(), &rows).unwrap();
    assert!(folder.path().join("schema.json").is_file());
    let text = std::fs::read_to_string(folder.path().join("comparison.csv")).unwrap();
    assert!(text.starts_with("controller,seeds,vehicles,vehicles_diff,vehicles_diff_sd,vehicles_diff_ci95,"));
    assert_eq!(text.lines().nth(1).unwrap().split(',').nth(3), Some(""), "the first controller has no difference");
}

#[test]
fn the_terminal_shows_one_table() {
    let rows = run_all(&names(&["ideal", "classic"]), &[1, 2, 3], 1, paired).unwrap();
    insta::assert_snapshot!(terminal_table(&rows), @r"
        ┌───────────────────────────┬────────┬──────────────────┐
        │                           ┆  ideal ┆          classic │
        ╞═══════════════════════════╪════════╪══════════════════╡
        │ vehicles                  ┆     10 ┆               10 │
        │                           ┆        ┆            0 ± 0 │
        │ arrived                   ┆      9 ┆                9 │
        │                           ┆        ┆            0 ± 0 │
        │ error RMS, mean [m/s]     ┆  2.000 ┆            2.200 │
        │                           ┆        ┆   +0.200 ± 0.248 │
        │ error RMS, p95 [m/s]      ┆  4.000 ┆            4.400 │
        │                           ┆        ┆   +0.400 ± 0.497 │
        │ speed gap RMS, mean [m/s] ┆  2.000 ┆            2.200 │
        │                           ┆        ┆   +0.200 ± 0.248 │
        │ lead limited, mean        ┆ 2.0000 ┆           2.2000 │
        │                           ┆        ┆ +0.2000 ± 0.2484 │
        │ overshoot, mean [m/s]     ┆  2.000 ┆            2.200 │
        │                           ┆        ┆   +0.200 ± 0.248 │
        │ jerk RMS, mean [m/s³]     ┆  2.000 ┆            2.200 │
        │                           ┆        ┆   +0.200 ± 0.248 │
        │ time loss, mean [s]       ┆  31.50 ┆            31.50 │
        │                           ┆        ┆      0.00 ± 0.00 │
        │ collisions                ┆      0 ┆                2 │
        │                           ┆        ┆         +2 ± 2.5 │
        └───────────────────────────┴────────┴──────────────────┘
        3 seeds. Second lines: paired difference to ideal, mean over the seeds ± half width of its 95 % t interval.
    ");
}

#[test]
fn a_run_without_samples_shows_a_dash() {
    let empty = |_: &str, _: u64| Ok::<_, std::io::Error>(Summary::new(&[], [0; 4], SumoTotals::default(), [0.0; 2]));
    let rows = run_all(&names(&["ideal", "pid"]), &[1, 2], 1, empty).unwrap();
    assert_eq!(rows[1].metrics[2], Measured::default());
    assert!(terminal_table(&rows).contains(" - "));
}
