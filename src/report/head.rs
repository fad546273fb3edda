//! What was run, and how to do it again.

use super::data::RunData;
use super::number::sensible;
use crate::page::Page;
use crate::run::Status;

/// The name of a result: its folder's.
pub fn folder_name(dir: &std::path::Path) -> String {
    let whole = dir.canonicalize().unwrap_or_else(|_| dir.to_owned());
    whole.file_name().map_or_else(|| dir.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Adds what is known of a run to the head of a page. `label` is put in front where there are two.
pub fn add(page: &mut Page, run: &RunData, label: Option<&str>) {
    let named = |text: &str| label.map_or_else(|| text.to_owned(), |label| format!("{label}: {text}"));
    let manifest = &run.manifest;
    let mut fact = |name: &str, value: String| page.facts.push([named(name), value]);
    fact("result folder", run.dir.display().to_string());
    let status = match manifest.status {
        Status::Complete => "complete",
        Status::Incomplete => "incomplete",
        Status::Running => "running, or killed",
        Status::Planned => "planned",
    };
    fact("status", status.to_owned());
    for (key, name) in [("controller", "controller"), ("target", "target"), ("egos", "equipped vehicles")] {
        if let Some(value) = key_of(&manifest.scenario, key) {
            fact(name, value);
        }
    }
    fact("seed", manifest.seed.to_string());
    let sumo = manifest.sumo_version.as_deref().unwrap_or("SUMO of unknown version");
    fact("versions", format!("sumo-mfc {}, {sumo}", manifest.version));
    if let Some(summary) = &run.summary {
        let factor = summary.real_time_factor.map(|f| format!(", {} × real time", sensible(f))).unwrap_or_default();
        fact("runtime", format!("{} s{factor}", sensible(summary.wall_s)));
    }
    let again =
        format!("sumo-mfc run --from {} -o NEW-FOLDER", quoted(&run.dir.join("run.json").display().to_string()));
    page.commands.push([named("the same run again, bit for bit"), again]);
    if !manifest.sumo_command.is_empty() {
        let words: Vec<String> = manifest.sumo_command.iter().map(|word| quoted(word)).collect();
        page.commands.push([named("SUMO's command line"), words.join(" ")]);
    }
    page.inputs.extend(manifest.inputs.iter().map(|input| [input.path.clone(), input.sha256.clone()]));
    page.inputs.sort();
    page.inputs.dedup();
    if manifest.status != Status::Complete {
        let why = manifest.reason.clone().unwrap_or_else(|| "it has not come to its end".to_owned());
        page.warnings.push(named(&format!("The run is not complete: {why}")));
    }
    if manifest.version != env!("CARGO_PKG_VERSION") {
        let note =
            format!("The result is of sumo-mfc {}, the report of {}.", manifest.version, env!("CARGO_PKG_VERSION"));
        page.warnings.push(named(&note));
    }
    page.warnings.extend(run.missing.iter().map(|text| named(text)));
    page.notes.extend(manifest.notes.iter().map(|text| named(text)));
}

/// `name` (or `select`) in a section of the resolved scenario.
fn key_of(scenario: &str, section: &str) -> Option<String> {
    let document: toml_edit::DocumentMut = scenario.parse().ok()?;
    let section = document.get(section)?;
    let value = section.get("name").or_else(|| section.get("select"))?;
    Some(value.as_str()?.to_owned())
}

/// A word for a shell.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}
