//! A comparison on the terminal.

use super::comparison::{Compared, ComparisonRow, comparison_layout, key_columns};
use super::metrics::{METRIC_COUNT, METRICS, Metric};
use crate::output::Form;
use crate::table::Layout;
use comfy_table::{CellAlignment, Table, presets};

/// Settings side by side in one table.
const ABREAST: usize = 5;
/// A difference is marked below this p.
const LEVEL: f64 = 0.05;

/// A number with the metric's decimals; whole numbers of metrics without a unit (counts) have none.
fn number(metric: &Metric, value: f64, sign: bool) -> String {
    let count = metric.unit.is_empty() && value == value.floor() && metric.decimals == 1;
    let decimals = if count { 0 } else { metric.decimals };
    let text = if sign { format!("{value:+.decimals$}") } else { format!("{value:.decimals$}") };
    // What rounds to nothing has no sign.
    if text.chars().any(|c| ('1'..='9').contains(&c)) { text } else { text.replace(['-', '+'], "") }
}

fn cell(metric: &Metric, compared: &Compared) -> String {
    let Some(mean) = compared.mean else { return "-".to_owned() };
    let width = |half: Option<f64>| half.map(|half| format!(" ± {}", number(metric, half, false))).unwrap_or_default();
    let mut text = number(metric, mean, false) + &width(compared.ci95);
    if let Some(difference) = compared.diff {
        let mark = if compared.p_holm.is_some_and(|p| p < LEVEL) { "*" } else { "" };
        text += &format!("\n{}{}{mark}", number(metric, difference, true), width(compared.diff_ci95));
    }
    text
}

/// A row for each of these metrics, a column for each of these settings, the title in front.
fn side_by_side(metrics: &[usize], settings: &[&[ComparisonRow]]) -> Vec<Vec<String>> {
    let row = |&k: &usize| {
        let metric = &METRICS[k];
        let unit = if metric.unit.is_empty() { String::new() } else { format!(" [{}]", metric.unit) };
        let cells = settings.iter().map(|rows| cell(metric, &rows[k].compared));
        [format!("{}{unit}", metric.title)].into_iter().chain(cells).collect()
    };
    metrics.iter().map(row).collect()
}

/// The names of the keys, then the values of each setting.
fn head(keys: &[String], settings: &[&[ComparisonRow]]) -> Vec<String> {
    [keys.join("\n")].into_iter().chain(settings.iter().map(|rows| rows[0].values.join("\n"))).collect()
}

/// Whether any setting has this metric, and it is one that the terminal shows.
fn is_shown(k: usize, settings: &[&[ComparisonRow]]) -> bool {
    !METRICS[k].title.is_empty() && settings.iter().any(|rows| rows[k].compared.mean.is_some())
}

/// The comparison in a form for `--export`: people get the settings side by side, programs the rows of `comparison.csv`.
pub fn exported_table(keys: &[String], rows: &[ComparisonRow], form: Form) -> String {
    if !form.for_people {
        return form.text(&comparison_layout(keys), rows);
    }
    let settings: Vec<&[ComparisonRow]> = rows.chunks(METRIC_COUNT).collect();
    let shown: Vec<usize> = (0..METRIC_COUNT).filter(|k| is_shown(*k, &settings)).collect();
    let columns = key_columns(&head(keys, &settings), |row: &Vec<String>| row);
    form.text(
        &Layout::new(["comparison", "metric"], "Settings side by side", columns),
        &side_by_side(&shown, &settings),
    )
}

/// The tables for the terminal: a column per setting, a row per metric that differs anywhere, and what the second line of a
/// cell means.
pub fn terminal_table(keys: &[String], seeds: usize, rows: &[ComparisonRow]) -> String {
    let mut text = String::new();
    let settings: Vec<&[ComparisonRow]> = rows.chunks(METRIC_COUNT).collect();
    let compared = |k: usize| settings.iter().map(move |rows| &rows[k].compared);
    let shown = |k: &usize| is_shown(*k, &settings);
    let is_same = |k: &usize| {
        let steady = compared(*k).all(|metric| metric.ci95.unwrap_or(0.0) == 0.0);
        settings.len() > 1 && steady && compared(*k).all(|metric| metric.mean == settings[0][*k].compared.mean)
    };
    let (same, different): (Vec<usize>, Vec<usize>) = (0..METRIC_COUNT).filter(shown).partition(is_same);
    for settings in settings.chunks(ABREAST) {
        let mut table = Table::new();
        table.load_style(presets::UTF8_FULL_CONDENSED);
        table.set_header(head(keys, settings));
        table.add_rows(side_by_side(&different, settings));
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        text += &format!("{table}\n");
    }
    if !same.is_empty() {
        let value =
            |k: usize| settings[0][k].compared.mean.map_or("-".to_owned(), |mean| number(&METRICS[k], mean, false));
        let list: Vec<String> = same.iter().map(|k| format!("{} {}", METRICS[*k].title, value(*k))).collect();
        text += &format!("The same everywhere: {}.\n", list.join(", "));
    }
    let plural = if seeds == 1 { "seed" } else { "seeds" };
    text += &format!("{seeds} {plural}. Means over the seeds ± half width of the 95 % t interval.");
    if rows.iter().any(|row| row.compared.diff.is_some()) {
        text += " Second lines: paired difference to the reference; * p < 0.05 after Holm over all of them.";
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::super::comparison::tests::rows;
    use super::*;
    use crate::output::FORMS;
    use crate::registry::find;

    #[test]
    fn the_terminal_shows_means_differences_and_what_they_are() {
        let text = terminal_table(&["controller.name".to_owned()], 3, &rows(&[1.0, 2.0, 3.0], &[1.1, 2.2, 3.3]));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1], "│ controller.name                   ┆           ideal ┆          classic │");
        assert!(text.contains("│ error RMS, mean [m/s]             ┆   2.000 ± 2.484 ┆    2.200 ± 2.733 │"), "{text}");
        assert!(text.contains("│                                   ┆                 ┆   +0.200 ± 0.248 │"), "{text}");
        assert!(lines.last().unwrap().starts_with("3 seeds."), "{text}");
    }

    #[test]
    fn people_get_the_settings_side_by_side_and_programs_a_row_per_setting_and_metric() {
        let (keys, rows) = (["controller.name".to_owned()], rows(&[1.0, 2.0, 3.0], &[1.1, 2.2, 3.3]));
        let text = |form: &str| exported_table(&keys, &rows, find("form", FORMS, form).unwrap().build);
        let markdown = text("md");
        assert!(markdown.starts_with("| controller.name | ideal | classic |\n| :-- | :-- | :-- |\n"), "{markdown}");
        let cells = "| error RMS, mean [m/s] | 2.000 ± 2.484 | 2.200 ± 2.733<br>+0.200 ± 0.248 |\n";
        assert!(markdown.contains(cells), "{markdown}");
        let objects: Vec<serde_json::Value> = serde_json::from_str(&text("json")).unwrap();
        assert_eq!(objects.len(), 2 * METRIC_COUNT);
        let rms = objects.iter().rfind(|object| object["metric"] == "error_rms_mean").unwrap();
        assert_eq!((rms["controller.name"].as_str(), rms["seeds"].as_u64()), (Some("classic"), Some(3)), "{rms}");
        assert!((rms["mean"].as_f64().unwrap() - 2.2).abs() < 1e-12 && rms["diff_boot_low"].is_null(), "{rms}");
        assert_eq!(text("csv").lines().count(), 1 + 2 * METRIC_COUNT);
    }

    #[test]
    fn what_is_the_same_everywhere_takes_one_line() {
        let text = terminal_table(&["controller.name".to_owned()], 2, &rows(&[2.0, 2.0], &[2.0, 2.0]));
        assert!(text.contains("\nThe same everywhere: egos 2, vehicles inserted 2,"), "{text}");
        assert!(!text.contains("│ egos"), "{text}");
        let text = terminal_table(&["controller.name".to_owned()], 2, &rows(&[2.0, 3.0], &[2.0, 3.0]));
        assert!(text.contains("│ egos") && !text.contains("The same"), "seeds differ: {text}");
    }

    #[test]
    fn without_a_spread_there_is_no_interval() {
        let text = terminal_table(&["controller.name".to_owned()], 1, &rows(&[2.0], &[2.5]));
        assert!(text.contains("+0.500 ") && !text.contains("0.500 ±") && text.contains("\n1 seed. "), "{text}");
    }
}
