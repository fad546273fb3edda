//! The page of a study, or of two side by side.

use super::groups::NAMES;
use super::head::{folder_name, quoted};
use super::number::{self, counted, or_dash, sensible};
use super::study_data::{Compared, StudyData};
use super::study_figures::{MetricRows, curves, divides, intervals, matrices};
use crate::page::{Cell, Head, Page, Section, TableView};

/// Metrics whose tables and figures are open.
const OPEN: [&str; 5] = ["error_rms_mean", "speed_gap_rms_mean", "timeloss_mean", "energy_per_km_mean", "collisions"];
/// Metrics that say how large a study is, rather than what differs in it.
const COUNTS: [&str; 2] = ["egos", "inserted"];

/// The page.
pub fn page(studies: &[StudyData]) -> Page {
    let folders: Vec<String> = studies.iter().map(|study| folder_name(&study.dir)).collect();
    let mut page = Page { title: folders.join(" and "), ..Page::default() };
    let names: Vec<Option<&str>> = NAMES.into_iter().map(|name| (studies.len() > 1).then_some(name)).collect();
    for (study, name) in studies.iter().zip(&names) {
        head(&mut page, study, *name);
    }
    if let [a, b] = studies {
        page.about = "Two studies side by side, setting by setting.".into();
        page.sections.push(side_by_side(a, b));
    }
    for (study, name) in studies.iter().zip(&names) {
        let settings = counted(study.plan.settings.len(), "setting", "settings");
        if studies.len() == 1 {
            page.about = format!("A study of {settings} and {}.", counted(study.plan.seeds.len(), "seed", "seeds"));
            page.sections.extend(figures(study));
        }
        page.sections.push(comparison(study, *name));
        page.sections.push(cases(study, *name));
    }
    page
}

fn head(page: &mut Page, study: &StudyData, label: Option<&str>) {
    let named = |text: &str| label.map_or_else(|| text.to_owned(), |label| format!("{label}: {text}"));
    let plan = &study.plan;
    let mut fact = |name: &str, value: String| page.facts.push([named(name), value]);
    fact("result folder", study.dir.display().to_string());
    fact("varied", if plan.keys.is_empty() { "nothing".to_owned() } else { plan.keys.join(", ") });
    let reference = plan.settings.iter().find_map(|setting| setting.reference.as_ref());
    fact("reference", reference.map_or_else(|| "none".to_owned(), |_| references(study)));
    fact("seeds", plan.seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(", "));
    fact("cases", plan.cases.len().to_string());
    fact("versions", format!("sumo-mfc {}, {}", plan.version, plan.sumo_version));
    if !study.wall_s.is_empty() {
        let (sum, count) = (study.wall_s.iter().sum::<f64>(), study.wall_s.len());
        let each = sensible(sum / count as f64);
        fact("runtime", format!("{} s for {}, {each} s each", sensible(sum), counted(count, "case", "cases")));
    }
    let case = quoted(&study.dir.join("cases/0001/run.json").display().to_string());
    page.commands.push([named("one case again, bit for bit"), format!("sumo-mfc run --from {case} -o NEW-FOLDER")]);
    let folder = quoted(&study.dir.join("cases/0001").display().to_string());
    page.commands.push([named("the page of one case"), format!("sumo-mfc report {folder}")]);
    page.inputs.extend(plan.inputs.iter().map(|input| [input.path.clone(), input.sha256.clone()]));
    page.inputs.sort();
    page.inputs.dedup();
    page.warnings.extend(plan.advice.as_deref().map(named));
    let states = study.cases.as_ref().and_then(|cases| cases.texts("status")).unwrap_or_default();
    for state in ["failed", "missing"] {
        let count = states.iter().filter(|found| *found == state).count();
        if count > 0 {
            page.warnings.push(named(&format!(
                "{} {state}; the table of cases has the reasons.",
                counted(count, "case", "cases")
            )));
        }
    }
    page.warnings.extend(study.missing.iter().map(|text| named(text)));
    page.notes.extend(study.notes.iter().map(|text| named(text)));
}

/// What the references have in common: the values of keys that all of them share.
fn references(study: &StudyData) -> String {
    let all: Vec<&Vec<String>> = study.plan.settings.iter().filter_map(|setting| setting.reference.as_ref()).collect();
    let shared = |key: &usize| all.iter().all(|values| values[*key] == all[0][*key]);
    let keys = (0..study.plan.keys.len()).filter(shared);
    keys.map(|key| format!("{}={}", study.plan.keys[key], all[0][key])).collect::<Vec<_>>().join(", ")
}

/// A section for the figures of every metric that differs between the settings.
fn figures(study: &StudyData) -> Vec<Section> {
    let title = "What differs".to_owned();
    let text = vec!["Metrics that are the same in all settings are left out.".to_owned()];
    let mut sections = vec![Section { id: "figures".into(), title, text, ..Section::default() }];
    let metrics = MetricRows::all(study);
    let keys = study.plan.keys.len();
    let dividing: Vec<usize> = (0..keys).filter(|key| divides(study, *key)).collect();
    for metric in metrics.iter().filter(|metric| metric.varies() && !COUNTS.contains(&metric.name)) {
        let mut figures: Vec<_> = (0..keys).filter_map(|key| curves(study, metric, key)).collect();
        figures.extend(intervals(study, metric));
        for (i, first) in dividing.iter().enumerate() {
            for second in &dividing[i + 1..] {
                figures.extend(matrices(study, metric, [*first, *second]));
            }
        }
        let (id, title) = (format!("figures-{}", metric.name), metric.titled.clone());
        let folded = !OPEN.contains(&metric.name);
        sections.push(Section { id, title, figures, nested: true, folded, ..Section::default() });
    }
    if sections.len() > 1 { sections } else { Vec::new() }
}

/// A value and the half width of its interval, both to the second digit of the latter.
fn with_half(value: Option<f64>, half: Option<f64>, signed: bool) -> String {
    let Some(value) = value else { return "–".to_owned() };
    let Some(half) = half.filter(|half| *half > 0.0) else {
        return if signed { number::signed(value) } else { sensible(value) };
    };
    let digits = (1.0 - libm::floor(libm::log10(half))).clamp(0.0, 9.0) as usize;
    if signed {
        format!("{value:+.digits$} ± {half:.digits$}")
    } else {
        format!("{value:.digits$} ± {half:.digits$}")
    }
}

/// A table per metric, the settings below each other.
fn comparison(study: &StudyData, label: Option<&str>) -> Section {
    let of = label.map(|label| format!(", {label}")).unwrap_or_default();
    let mut section = Section { id: "comparison".into(), title: format!("Comparison{of}"), ..Section::default() };
    section.text.push(
        "Mean: over the seeds, ± half width of its 95 % t interval. Difference: paired by seed to the reference, marked \
         where p < 0.05 after Holm over all settings and metrics. Same vehicles: those that arrived in both runs."
            .to_owned(),
    );
    for metric in MetricRows::all(study).into_iter().filter(MetricRows::is_known) {
        let mut head: Vec<Head> = study.plan.keys.iter().map(|key| Head::text(key, "varied key")).collect();
        head.extend([
            Head::number("mean", "mean over the seeds ± half width of its 95 % interval"),
            Head::number("difference", "paired difference to the reference ± half width of its 95 % interval"),
            Head::number("p (Holm)", "two-sided p of the paired t test, after Holm"),
            Head::number("seeds", "seeds whose case is done and has the metric"),
            Head::number("same vehicles", "mean difference of the vehicles that arrived in both runs ± half width"),
            Head::number("share better", "share of these vehicles with less of the metric than in the reference"),
            Head::number("seeds for 5 %", "seeds that find a difference of 5 % with a probability of 80 %"),
        ]);
        let row = |row: &Compared| -> Vec<Cell> {
            let sure = row.number("p_holm").is_some_and(|p| p < 0.05);
            let mut difference = with_half(row.number("diff"), row.number("diff_ci95"), true);
            if sure {
                difference += " *";
            }
            let same = with_half(row.number("completed_diff"), row.number("completed_diff_ci95"), true);
            let keys = row.values(&study.plan.keys).into_iter().map(Cell::text);
            let numbers = [
                Cell::number(with_half(row.number("mean"), row.number("ci95"), false)),
                Cell { text: difference, class: if sure { "sure" } else { "" } },
                Cell::number(or_dash(row.number("p_holm"))),
                Cell::number(or_dash(row.number("seeds"))),
                Cell::number(same),
                Cell::number(or_dash(row.number("share_better"))),
                Cell::number(or_dash(row.number("seeds_for_5pct"))),
            ];
            keys.chain(numbers).collect()
        };
        section.tables.push(TableView {
            id: format!("comparison-{}{}", metric.name, label.unwrap_or_default()),
            fold: metric.titled.clone(),
            open: OPEN.contains(&metric.name),
            head,
            rows: metric.rows.iter().map(row).collect(),
            ..TableView::default()
        });
    }
    section
}

/// Which cases are done, and why others are not.
fn cases(study: &StudyData, label: Option<&str>) -> Section {
    let of = label.map(|label| format!(", {label}")).unwrap_or_default();
    let mut section = Section { id: "cases".into(), title: format!("Cases{of}"), ..Section::default() };
    let Some(table) = &study.cases else { return section };
    let columns: Vec<_> = table.columns.iter().collect();
    let head = columns.iter().map(|column| {
        let class = if column.info.is_number() { "" } else { "text" };
        Head { text: column.info.titled(), meaning: column.info.meaning.clone(), class }
    });
    let head: Vec<Head> = head.collect();
    let row = |row: usize| -> Vec<Cell> {
        let cell = |column: &&super::table::Column| match &column.values {
            super::table::Values::Numbers(numbers) => Cell::number(sensible(numbers[row])),
            super::table::Values::Texts(texts) => {
                let bad = column.info.name == "status" && texts[row] != "done";
                Cell { text: texts[row].clone(), class: if bad { "text bad" } else { "text" } }
            }
        };
        columns.iter().map(cell).collect()
    };
    let states = table.texts("status").unwrap_or_default();
    let open = |row: &usize| states.get(*row).is_none_or(|state| state != "done");
    let failures: Vec<Vec<Cell>> = (0..table.rows).filter(open).map(row).collect();
    if !failures.is_empty() {
        section.tables.push(TableView {
            id: format!("failures{}", label.unwrap_or_default()),
            caption: "Cases that failed or are missing: not run yet, or stopped on the way.".into(),
            head: head.clone(),
            rows: failures,
            ..TableView::default()
        });
    }
    section.tables.push(TableView {
        id: format!("cases{}", label.unwrap_or_default()),
        fold: format!("All {}", counted(table.rows, "case", "cases")),
        head,
        rows: (0..table.rows).map(row).collect(),
        ..TableView::default()
    });
    section
}

/// The settings and metrics that two studies have in common.
fn side_by_side(a: &StudyData, b: &StudyData) -> Section {
    let mut section = Section { id: "side-by-side".into(), title: "Side by side".into(), ..Section::default() };
    let (left, right) = (MetricRows::all(a), MetricRows::all(b));
    for metric in &left {
        let Some(other) = right.iter().find(|other| other.name == metric.name) else { continue };
        let mut rows = Vec::new();
        for row in &metric.rows {
            let values = row.values(&a.plan.keys);
            let same = |row: &&Compared| a.plan.keys.iter().zip(&values).all(|(key, value)| row.text(key) == value);
            let Some(twin) = other.rows.iter().find(same).filter(|_| a.plan.keys == b.plan.keys) else { continue };
            let difference = row.number("mean").zip(twin.number("mean")).map(|(one, two)| two - one);
            let mean = |row: &Compared| Cell::number(with_half(row.number("mean"), row.number("ci95"), false));
            let change = Cell::number(difference.map_or_else(|| "–".to_owned(), number::signed));
            rows.push(values.iter().map(Cell::text).chain([mean(row), mean(twin), change]).collect());
        }
        let keys = a.plan.keys.iter().map(|key| Head::text(key, "varied key"));
        let numbers = [
            Head::number("mean A", "mean over the seeds ± half width of its 95 % interval"),
            Head::number("mean B", "mean over the seeds ± half width of its 95 % interval"),
            Head::number("B − A", "difference of the means"),
        ];
        if !rows.is_empty() {
            section.tables.push(TableView {
                id: format!("side-{}", metric.name),
                fold: metric.titled.clone(),
                open: OPEN.contains(&metric.name),
                head: keys.chain(numbers).collect(),
                rows,
                ..TableView::default()
            });
        }
    }
    if section.tables.is_empty() {
        section.text.push("The two studies have no setting in common.".to_owned());
    }
    section
}
