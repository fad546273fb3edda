//! The page: one HTML file with everything in it, no network, light and dark. It tells what the paper says, what came out,
//! and how far apart the two are; all verdicts are those of `results.csv`.

use super::claims;
use super::lab::{Finding, Lab};
use super::library::Preset;
use super::published::Published;
use super::results::Results;
use super::row::{Row, family};
use super::verdict::{Count, Verdict};
use crate::figure::{Figure, escape, style};
use std::fmt::Write;

const PAGE_STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1c2430;--soft:#5b6675;--paper:#fff;--line:#dfe4ea;--card:#f6f8fa;--yes:#d9f0dd;--part:#fdf0cd;--no:#f9dcd9}\
@media(prefers-color-scheme:dark){:root{--ink:#e4e9f0;--soft:#9aa7b8;--paper:#151a21;--line:#2e3743;--card:#1b212a;--yes:#1d4428;--part:#4d4013;--no:#55231f}}\
*{box-sizing:border-box}body{margin:0;background:var(--paper);color:var(--ink);font:15px/1.55 system-ui,'Segoe UI',Roboto,sans-serif}\
main{max-width:1180px;margin:0 auto;padding:28px 20px 80px}h1{font-size:26px;line-height:1.25;margin:0 0 8px}\
h2{font-size:21px;margin:44px 0 8px;padding-top:10px;border-top:1px solid var(--line)}h3{font-size:16px;margin:24px 0 6px}\
p{max-width:76ch}.soft{color:var(--soft)}nav a{margin-right:14px}a{color:inherit}\
.scroll{overflow-x:auto}table{border-collapse:collapse;margin:10px 0;font-variant-numeric:tabular-nums;font-size:12.5px}\
th,td{padding:3px 7px;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}th{font-weight:600}\
th:first-child,td:first-child,td.text,th.text{text-align:left}thead th{border-bottom:2px solid var(--line);vertical-align:bottom}\
td.why{white-space:normal;min-width:20em}td.words{white-space:normal;min-width:9em}table.wide{font-size:12px}table.wide td,table.wide th{padding:3px 5px}table.wide td.words{min-width:12em}\
.yes{background:var(--yes)}.part{background:var(--part)}.no{background:var(--no)}.key span{padding:2px 8px;margin-right:8px;border-radius:3px}\
.figs{display:grid;grid-template-columns:repeat(auto-fit,minmax(460px,1fr));gap:14px}svg.fig{width:100%;height:auto;display:block}.figs svg.fig{font-size:14.5px}.figs .fig .title{font-size:16px}\
details{margin:8px 0;border:1px solid var(--line);border-radius:6px;padding:6px 12px}summary{cursor:pointer}\
blockquote{margin:8px 0;padding:4px 14px;border-left:3px solid var(--line);color:var(--soft);max-width:80ch}\
@media(max-width:520px){.figs{grid-template-columns:1fr}}";

/// What each test is about: title, what the paper says, how it is done here.
const ABOUT: &[(&str, &str, &str, &str)] = &[
    (
        "step",
        "Steps of position",
        "Section 5.1: classic overshoots by about 19.5 % and 9.5 % and oscillates; adaptive by about 8 % and 3.9 %, \
         and stabilises between 50 m and 100 m. alpha is nominal most of the time.",
        "From rest, 10 m/s from s = 0 and 20 m/s from s = 100 m. Overshoot and undershoot are relative to the target; \
         settled means within 2 % of it until the next step or the end at 600 m, and of the torque within 5 % of its largest value.",
    ),
    (
        "sine",
        "Sinusoid of position",
        "Section 5.2: about the same results for both; the adaptive law converges sooner on the first oscillation and \
         has almost no overshoot. The paper prints no numbers.",
        "From rest onto 15 m/s + 5 m/s sin(2 pi s/600 m), three wavelengths. Overshoot is taken in the first of them after the \
         reference was first reached; settled means within 5 % of the reference for the rest of it. The paper gives neither range nor \
         wavelength. Its words speak for a slow sinusoid: both laws do about the same, so neither is at its torque limit, and \
         they differ on the first oscillation, so that the approach from rest is over within it. The wavelength decides: \
         sine_200m asks for 2.5 m/s2 in place of 0.8 m/s2, and there the adaptive law is the worse one under the default preset.",
    ),
    (
        "driver",
        "A driver's recording",
        "Section 5.3, Table 2: error mean -0.01, std 0.77, RMS 0.78 m/s for classic; -0.02, 0.35, 0.35 m/s for adaptive.",
        "The paper's recording is not public. driver is a lap of SUMO's racing circuit, straight, driver_path the same along the \
         reconstructed path; driver_udds and driver_hwfet are the EPA driving cycles. All are held against the \
         paper's numbers. Errors grow with what a recording asks for: the lap's acceleration has an RMS of 1.8 m/s2 (at most 2.4, at least \
         -3.2), that of UDDS 0.6 and that of HWFET 0.3. The published errors lie between those of the lap and of UDDS under the presets whose \
         classic loop is lightly damped. Under the preset default pid and calibrating drive too, with their own default gains.",
    ),
    (
        "delay",
        "250 ms between command and torque",
        "Section 5.4: error RMS 2.27 m/s for classic, 0.68 m/s for adaptive.",
        "The recordings of the driver test again, by the same laws.",
    ),
    (
        "disturb",
        "Disturbances",
        "Section 2: no vehicle data is needed; external disturbances are part of F and rejected with it. The paper shows no test.",
        "The sinusoid again. From s = 200 m on one thing is other than before. Numbers are RMS errors from there to the end at 600 m; \
         pid is the baseline with its own default tuning. On friction 0.2 the front tyres carry about 1 m/s2, and the sinusoid asks for 2.5.",
    ),
    (
        "map",
        "Where adaptation helps",
        "Not in the paper: nobody has published where in the space of its open values the adaptive law is better.",
        "RMS error on the noisy lap and overshoot of the first step over torque scale, K_P, control period, torque limit and delay. Blue: the \
         first law is better. The ring is the preset default. The table and the lower maps compare the laws with equal tuning: for all four the same \
         exhaustive search over 9 x 9 values (K_P and b, K_P and T, or k_p and k_i) for the least RMS error, then the torque scale is wrong \
         by a factor that no controller knows.",
    ),
    (
        "law",
        "A law behind the step test",
        "Not in the paper: where the torque scale is much weaker than alpha says, the overshoots of the two laws are in the ratio \
         2 sqrt(dt/T), whatever mass, K_P, alpha and torque limit. The published ratios are 0.41.",
        "Every point is a pair of step tests. docs/overshoot-ratio.md derives the law.",
    ),
];

/// One HTML file with everything in it.
pub fn page(lab: &Lab, presets: &[&Preset], results: &Results, found: &Finding) -> String {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Polack et al. 2017, reproduced</title>\
         <style>{PAGE_STYLE}{}</style></head><body><main>",
        style()
    );
    let is_there = |test: &str| {
        results.rows.iter().any(|r| family(&r.test) == test) || found.figures.iter().any(|f| family(&f.name) == test)
    };
    let about: Vec<_> = ABOUT.iter().filter(|(test, ..)| is_there(test)).collect();
    let links: String = about.iter().map(|(test, title, ..)| format!("<a href=\"#{test}\">{title}</a>")).collect();
    html += &opening(lab, presets, &links);
    html += &ranking(presets, results);
    html += &glance("Published numbers against presets", presets, results, &|r| r.published().is_some());
    html += &glance("Claims in words against presets", presets, results, &|r| claims::about(r).is_some());
    for (test, title, paper, here) in about {
        let _ = write!(
            html,
            "<h2 id=\"{test}\">{title}</h2><blockquote>{}</blockquote><p>{}</p>",
            escape(paper),
            escape(here)
        );
        // A preset may be called like a test.
        let of_preset = |f: &Figure| presets.iter().any(|p| f.name.starts_with(&format!("{}_", p.name)));
        let once = found.figures.iter().filter(|f| f.name.starts_with(&format!("{test}_")) && !of_preset(f));
        found.tables.iter().filter(|(of, _)| of == test).for_each(|(_, table)| html += table);
        html += &once.map(Figure::inline).collect::<String>();
        for (i, preset) in presets.iter().enumerate() {
            html += &section(test, preset, i == 0, results, &found.figures);
        }
    }
    html += "</main></body></html>\n";
    html
}

fn opening(lab: &Lab, presets: &[&Preset], links: &str) -> String {
    let mut html = format!(
        "<h1>Model-free speed control: the tests of Polack et al. 2017, reproduced</h1>\
         <p class=\"soft\">P. Polack, B. d'Andr&eacute;a-Novel, M. Fliess, A. de La Fortelle, L. Menhour: Finite-Time \
         Stabilization of Longitudinal Control for Autonomous Vehicles via a Model-Free Approach, IFAC World Congress 2017.</p>\
         <nav>{links}</nav>\
         <p>The paper leaves open the vehicle, the control period, K<sub>P</sub>, the torque's scale and limits, where the steps \
         are and what the driver drove. A <em>preset</em> is one choice of all that, and every test runs under every preset: nothing \
         is picked test by test. A preset was fitted to some of the published numbers, so that it meets these is no evidence that \
         it is what the authors used; what it says about the others is.</p>\
         <p class=\"key\"><span class=\"yes\">reproduced</span> within the tolerance (overshoot 1 and 0.7 points for classic, 0.7 and \
         0.5 for adaptive; std and RMS 15 %; mean 0.05 m/s) &ensp; <span class=\"part\">partly</span> not the number, but adaptive \
         gains at least half of what it gains in the paper &ensp; <span class=\"no\">not reproduced</span> neither. A claim in words \
         is judged by a criterion that is told with it.</p>"
    );
    if let Some(driver) = &lab.driver {
        let _ = write!(html, "<p>The recording is {}.</p>", escape(&driver.display().to_string()));
    }
    html += "<div class=\"scroll\"><table><thead><tr><th>preset</th><th class=\"text\">what it is</th></tr></thead>";
    for p in presets {
        let (name, title, why) = (escape(&p.name), escape(&p.title), escape(&p.why));
        let _ = write!(
            html,
            "<tr><td>{name}</td><td class=\"text\" style=\"white-space:normal\"><b>{title}.</b> {why}</td></tr>"
        );
    }
    html + "</table></div>"
}

/// How much each preset matches, the most first.
fn ranking(presets: &[&Preset], results: &Results) -> String {
    let mut ranked: Vec<(&Preset, [Count; 2])> = presets.iter().map(|p| (*p, results.counts(&p.name))).collect();
    let total = |counts: &[Count; 2]| {
        let [numbers, words] = counts;
        (numbers.reproduced + words.reproduced, numbers.partly + words.partly)
    };
    ranked.sort_by_key(|(_, counts)| std::cmp::Reverse(total(counts)));
    let Some((first, counts)) = ranked.first().filter(|(_, [a, b])| a.all() + b.all() > 0) else {
        return String::new();
    };
    let mut html = format!(
        "<h2 id=\"ranking\">Which preset matches the most</h2><p>Each published number and each claim in words counts once for each \
         recording that it is held against: steps and sinusoid without noise, recordings with noise, mean over the seeds. The disturbances, of \
         which the paper shows no test, do not count. The most matches <b>{}</b>: {} of {} reproduced, {} partly.</p><div class=\"scroll\"><table><thead><tr><th>preset</th>\
         <th>numbers: reproduced</th><th>partly</th><th>not</th><th>words: reproduced</th><th>partly</th><th>not</th><th>all: reproduced</th>\
         <th>partly</th><th>not</th></tr></thead>",
        escape(&first.name),
        total(counts).0,
        counts[0].all() + counts[1].all(),
        total(counts).1
    );
    for (preset, [numbers, words]) in &ranked {
        let _ = write!(html, "<tr><td>{}</td>", escape(&preset.name));
        let all = Count {
            reproduced: numbers.reproduced + words.reproduced,
            partly: numbers.partly + words.partly,
            not: numbers.not + words.not,
        };
        for count in [*numbers, *words, all] {
            let Count { reproduced, partly, not } = count;
            let _ = write!(
                html,
                "<td class=\"yes\">{reproduced}</td><td class=\"part\">{partly}</td><td class=\"no\">{not}</td>"
            );
        }
        html += "</tr>";
    }
    html + "</table></div>"
}

/// What the paper says of quantities that `wanted` picks, against presets.
fn glance(title: &str, presets: &[&Preset], results: &Results, wanted: &dyn Fn(&Row) -> bool) -> String {
    let mut shown: Vec<&Row> = Vec::new();
    for row in results.rows.iter().filter(|r| wanted(r) && r.is_shown()) {
        if !shown.iter().any(|w| (&w.test, w.controller, w.quantity) == (&row.test, row.controller, row.quantity)) {
            shown.push(row);
        }
    }
    if shown.is_empty() {
        return String::new();
    }
    let names: String = presets.iter().map(|p| format!("<th>{}</th>", escape(&p.name))).collect();
    let mut html = format!(
        "<h2>{title}</h2><div class=\"scroll\"><table class=\"wide\"><thead><tr><th>test</th><th class=\"text\">quantity</th>\
         <th class=\"text\">published</th>{names}</tr></thead>"
    );
    for w in &shown {
        let _ = write!(
            html,
            "<tr><td>{}, {}</td><td class=\"text\">{}{}</td><td class=\"text words\">{}</td>",
            w.test,
            w.controller,
            w.quantity,
            unit(w),
            published(w)
        );
        for p in presets {
            html += &results
                .get(&w.test, &p.name, w.noise, w.controller, w.quantity)
                .map_or("<td></td>".to_owned(), |row| cell(&Row { spread: None, ..row.clone() }, results));
        }
        html += "</tr>";
    }
    html + "</table></div>"
}

fn published(row: &Row) -> String {
    match row.published() {
        Some(Published::AtMost(bound)) => format!("at most {bound}"),
        Some(Published::Number { value, .. }) => value.to_string(),
        None => claims::about(row).map(|claim| format!("&ldquo;{}&rdquo;", escape(claim.words))).unwrap_or_default(),
    }
}

fn cell(row: &Row, results: &Results) -> String {
    let class = match results.verdict(row) {
        Some(Verdict::Reproduced) => " class=\"yes\"",
        Some(Verdict::Partly) => " class=\"part\"",
        Some(Verdict::NotReproduced) => " class=\"no\"",
        None => "",
    };
    format!("<td{class}>{}</td>", value(row))
}

fn unit(row: &Row) -> String {
    if row.unit == "1" { String::new() } else { format!(" [{}]", row.unit) }
}

fn value(row: &Row) -> String {
    let digits = if row.unit == "m" || row.value.is_some_and(|v| v.abs() >= 100.0) { 0 } else { 2 };
    let spread = row.spread.map(|s| format!(" &plusmn; {s:.digits$}")).unwrap_or_default();
    let rounded = |v: f64| {
        let text = format!("{v:.digits$}");
        // No "-0.00".
        if text.bytes().all(|b| b"-0.".contains(&b)) { text.trim_start_matches('-').to_owned() } else { text }
    };
    row.value.map_or("none".to_owned(), |v| format!("{}{spread}", rounded(v)))
}

/// One test under one preset; the first preset is open.
fn section(test: &str, preset: &Preset, open: bool, results: &Results, figures: &[Figure]) -> String {
    let rows: Vec<&Row> = results.rows.iter().filter(|r| family(&r.test) == test && r.preset == preset.name).collect();
    if rows.is_empty() {
        return String::new();
    }
    let prefix = format!("{}_{test}_", preset.name);
    // Of the presets but the first, the page has the errors; all figures are files as well.
    let wanted = |f: &&Figure| f.name.starts_with(&prefix) && (open || test == "step" || f.name.ends_with("error"));
    let drawn: String = figures.iter().filter(wanted).map(Figure::inline).collect();
    let open = if open { " open" } else { "" };
    format!(
        "<details{open}><summary>preset <b>{}</b>: {}</summary><div class=\"figs\">{drawn}</div>{}</details>",
        escape(&preset.name),
        escape(&preset.title),
        table(&rows, results)
    )
}

fn table(rows: &[&Row], results: &Results) -> String {
    let mut html = String::from(
        "<div class=\"scroll\"><table><thead><tr><th>test</th><th class=\"text\">controller</th><th class=\"text\">quantity</th>\
         <th>without noise</th><th>with noise, mean &plusmn; std</th><th class=\"text\">published</th><th class=\"text\">verdict, and why</th></tr></thead>",
    );
    for row in rows.iter().filter(|r| !r.noise) {
        let noisy = results.get(&row.test, &row.preset, true, row.controller, row.quantity);
        let judged = if row.is_shown() || noisy.is_none_or(|n| !n.is_shown()) { Some(*row) } else { noisy };
        let why = judged.and_then(|r| Some(format!("{}: {}", results.verdict(r)?, why(r, results))));
        let _ = write!(
            html,
            "<tr><td>{}</td><td class=\"text\">{}</td><td class=\"text\">{}{}</td>{}{}<td class=\"text words\">{}</td><td class=\"text why\">{}</td></tr>",
            row.test,
            row.controller,
            row.quantity,
            unit(row),
            cell(row, results),
            noisy.map_or("<td></td>".to_owned(), |n| cell(n, results)),
            published(row),
            why.unwrap_or_default()
        );
    }
    html + "</table></div>"
}

/// The verdict's reason, in numbers.
fn why(row: &Row, results: &Results) -> String {
    if let (None, Some(claim)) = (row.published(), claims::about(row)) {
        return escape(&claim.why(row, &results.rows));
    }
    let (Some(ours), Some(published)) = (row.value, row.published()) else {
        return "it never got there".to_owned();
    };
    let apart = match published {
        Published::AtMost(bound) => return format!("{ours:.0} m, published at most {bound} m"),
        Published::Number { value, .. } => format!("{:+.2} {}", ours - value, row.unit),
    };
    let other = if row.controller == "classic" { "adaptive" } else { "classic" };
    let partner = results.get(&row.test, &row.preset, row.noise, other, row.quantity);
    let ratio = |a: Option<f64>, b: Option<f64>| {
        let (a, b) = if row.controller == "adaptive" { (a?, b?) } else { (b?, a?) };
        (b > 0.0).then(|| format!("{:.2}", a / b))
    };
    let here = ratio(row.value, partner.and_then(|p| p.value));
    let there = ratio(Some(published.number()), partner.and_then(|p| p.published()).map(Published::number));
    match (here, there) {
        (Some(here), Some(there)) => format!("{apart}; adaptive/classic {here}, published {there}"),
        _ => apart,
    }
}
