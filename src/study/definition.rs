//! What a study varies, as it was written: a file, arguments of the command line, or a file refined by arguments. All of it
//! becomes one table of entries with their places, read in one way.

use super::seeds::parse_seeds;
use super::slurm::SlurmKeys;
use super::values::{argument, values};
use crate::keys;
use crate::keys::{Key, Keys, Kind};
use crate::place::Place;
use crate::scenario::{Entry, Mistake, Node, Reader, Request, ScenarioError, Table, Wrong, names, read};
use std::path::{Path, PathBuf};

/// Seeds where nothing is said.
const SEEDS: &str = "1..5";
/// What the study itself sets.
const OURS: &[&str] =
    &["sumo.seed", "sumo.connect", "sumo.port", "sumo.num_clients", "sumo.gui", "sumo.load_state", "output.vehicles"];

keys! {
    /// The plain keys of a study file.
    struct StudyKeys {
        /// the scenario (.toml), or a SUMO configuration
        scenario: Option<PathBuf>;
        /// seeds: 1..10 (both included), or a list separated by commas
        seeds: String = SEEDS, form seeds;
        /// simulated once per seed by SUMO alone, and loaded by every case
        warm_up_s: Option<f64>, "s", 0.001..=1e6;
        /// resamples of the studentised bootstrap of every difference; 0 = none
        bootstrap: u32 = 0, "-", 0..=1000000;
    }
}

/// The keys of a study file beside `[[vary]]` and `reference`, by section; "" = outside of all.
pub fn file_keys() -> [(&'static str, &'static [Key]); 2] {
    [("", StudyKeys::keys()), ("slurm", SlurmKeys::keys())]
}

fn seeds(text: &str) -> Result<(), String> {
    parse_seeds(text).map(drop).map_err(|error| format!("1..5 (five seeds) or 3,8,12 ({error})"))
}

/// What the command line says of a study.
#[derive(Debug, Clone, Default)]
pub struct Arguments {
    /// A study or a scenario, and what is different from its file.
    pub request: Request,
    /// `KEY=V1,V2,...`, each a table of its own.
    pub vary: Vec<String>,
    /// The seeds.
    pub seeds: Option<String>,
    /// Warm-up \[s\].
    pub warm_up: Option<String>,
    /// Resamples of the bootstrap.
    pub bootstrap: Option<String>,
    /// `KEY=V`.
    pub reference: Vec<String>,
    /// Controllers that are compared with the first.
    pub controllers: Vec<String>,
    /// `KEY=V` of the table `[slurm]`.
    pub slurm: Vec<String>,
}

/// Keys that vary together: row by row, a literal per key.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The keys.
    pub keys: Vec<String>,
    /// Their values.
    pub rows: Vec<Vec<String>>,
    /// Where each key stands, for messages.
    pub shown: Vec<String>,
    /// The row with which the others are compared, if there is one.
    pub reference: Option<usize>,
}

/// A study: the product of its axes, under every seed.
#[derive(Debug, Clone)]
pub struct Definition {
    /// Names the folder.
    pub name: String,
    /// The scenario, and what is different from its file in every case.
    pub request: Request,
    /// The seeds.
    pub seeds: Vec<u64>,
    /// What SUMO simulates before the cases begin \[s\].
    pub warm_up_s: Option<f64>,
    /// Resamples of the bootstrap; 0 = none.
    pub bootstrap: u32,
    /// What varies.
    pub axes: Vec<Axis>,
    /// Whether two settings may be the same: a controller is compared with itself to see that nothing else differs.
    pub twins: bool,
    /// What Slurm is asked for, should it run the cases.
    pub slurm: SlurmKeys,
}

impl Definition {
    /// Reads a study.
    ///
    /// # Errors
    /// All mistakes, each with its place, what was found and what was wanted.
    pub fn read(arguments: &Arguments) -> Result<Self, ScenarioError> {
        let (mut root, mut request) = (Table::new(), arguments.request.clone());
        let mut name = None;
        if let Some(path) = request.scenario.clone().filter(|p| p.extension().is_some_and(|e| e == "toml")) {
            let file = read(&path)?;
            if ["scenario", "seeds", "vary", "reference", "warm_up_s", "bootstrap"]
                .iter()
                .any(|key| file.contains_key(*key))
            {
                (root, request.scenario) = (file, None);
                name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
            }
        }
        let from_file = name.is_some();
        add_arguments(&mut root, arguments);
        let mut reader = Reader::default();
        reader.known("", &root, &names(&["vary", "reference", "slurm"], StudyKeys::keys()));
        let keys = StudyKeys::from_values(&reader.values("", &root, StudyKeys::keys(), false).values);
        let mut axes = read_axes(&mut reader, &root);
        read_reference(&mut reader, &root, &mut axes);
        let slurm = reader.section(&root, "slurm", "slurm");
        let slurm = reader.keys("slurm", &slurm);
        if from_file && !root.contains_key("scenario") {
            let place = root.values().next().map_or_else(|| Place::argument("study"), |entry| entry.place.clone());
            let what = Wrong::Value { found: "nothing".to_owned(), wanted: "the scenario that is varied".to_owned() };
            reader.note(Mistake { place, key: "scenario".to_owned(), what });
        }
        reader.whole(())?;
        request.scenario = request.scenario.or(keys.scenario);
        Ok(Self {
            name: name.unwrap_or_default(),
            request,
            seeds: parse_seeds(&keys.seeds).unwrap_or_default(),
            warm_up_s: keys.warm_up_s,
            bootstrap: keys.bootstrap,
            axes,
            twins: !arguments.controllers.is_empty(),
            slurm,
        })
    }

    /// The folder of the results if the user does not say: that of the study, or of the scenario that is varied.
    pub fn default_folder(&self, scenario: &str) -> PathBuf {
        let face = if self.twins { "compare" } else { "sweep" };
        let name = if self.name.is_empty() { format!("{scenario}-{face}") } else { self.name.clone() };
        Path::new("out").join(name)
    }
}

/// Puts the arguments into the table of the file: further tables that vary, other seeds, another reference.
fn add_arguments(root: &mut Table, arguments: &Arguments) {
    let entry = |shown: &str, node: &dyn Fn(&Place) -> Node| {
        let place = Place::argument(shown);
        Entry { node: node(&place), place }
    };
    if let Some(seeds) = &arguments.seeds {
        root.insert("seeds".to_owned(), entry(&format!("--seeds {seeds}"), &|_| Node::Text(seeds.clone())));
    }
    let plain = [("warm_up_s", "--warm-up", &arguments.warm_up), ("bootstrap", "--bootstrap", &arguments.bootstrap)];
    for (key, flag, given) in plain {
        if let Some(given) = given {
            let node = |place: &Place| Node::of_argument(given, place);
            root.insert(key.to_owned(), entry(&format!("{flag} {given}"), &node));
        }
    }
    let pair = |flag: &str, given: &str, node: &dyn Fn(&str, &Place) -> Node| {
        let (key, value) = given.split_once('=').unwrap_or((given, ""));
        let value = entry(&format!("{flag} {given}"), &|place| node(value.trim(), place));
        (key.trim().to_owned(), value)
    };
    for given in &arguments.slurm {
        let (key, value) = pair("--slurm", given, &|text, place| match Node::of_argument(text, place) {
            list @ Node::List(_) => list,
            number @ Node::Integer(_) if numeric(given) => number,
            _ => Node::Text(text.to_owned()),
        });
        let place = value.place.clone();
        let all = root.entry("slurm".to_owned()).or_insert_with(|| Entry { node: Node::Table(Table::new()), place });
        if let Node::Table(table) = &mut all.node {
            table.insert(key, value);
        }
    }
    let mut vary: Vec<(String, Entry)> = arguments.vary.iter().map(|v| pair("--vary", v, &argument)).collect();
    let mut reference: Vec<(String, Entry)> =
        arguments.reference.iter().map(|r| pair("--reference", r, &Node::of_argument)).collect();
    if let Some(first) = arguments.controllers.first() {
        let list = format!("controller.name={}", arguments.controllers.join(","));
        let (key, mut all) = pair("--controllers", &list, &argument);
        all.place = Place::argument(&format!("--controllers {}", arguments.controllers.join(",")));
        let node = Node::Text(first.clone());
        reference.push((key.clone(), Entry { node, place: all.place.clone() }));
        vary.push((key, all));
    }
    for (key, value) in vary {
        let place = value.place.clone();
        let axis = Entry { node: Node::Table(Table::from([(key, value)])), place: place.clone() };
        let all = root.entry("vary".to_owned()).or_insert_with(|| Entry { node: Node::List(Vec::new()), place });
        if let Node::List(list) = &mut all.node {
            list.push(axis);
        }
    }
    if let Some((_, first)) = reference.first() {
        let place = first.place.clone();
        root.insert("reference".to_owned(), Entry { node: Node::Table(reference.into_iter().collect()), place });
    }
}

/// Whether an argument `KEY=V` is of a key of Slurm's that takes a number. Other keys take what looks like one as a text.
fn numeric(given: &str) -> bool {
    let is_key = |key: &Key| given.split('=').next() == Some(key.name);
    SlurmKeys::keys().iter().any(|key| is_key(key) && matches!(key.kind, Kind::Integer { .. }))
}

/// The tables `[[vary]]`.
fn read_axes(reader: &mut Reader, root: &Table) -> Vec<Axis> {
    let list = match root.get("vary") {
        None => return Vec::new(),
        Some(Entry { node: Node::List(list), .. }) => list,
        Some(entry) => {
            reader.note(entry.wrong("vary", "tables, each headed [[vary]]"));
            return Vec::new();
        }
    };
    let mut axes: Vec<Axis> = Vec::new();
    for (index, entry) in list.iter().enumerate() {
        let path = format!("vary.{index}");
        let Node::Table(table) = &entry.node else {
            reader.note(entry.wrong(&path, "a table of keys, each with the values that it takes"));
            continue;
        };
        let columns = flat("", table);
        if columns.is_empty() {
            reader.note(nothing(entry, &path, "a key with the values that it takes"));
        }
        let (mut keys, mut shown, mut lists) = (Vec::new(), Vec::new(), Vec::new());
        for (key, entry) in columns {
            if OURS.contains(&key.as_str()) || axes.iter().any(|axis| axis.keys.contains(&key)) {
                let wanted = "a key that the study does not set itself, varied in one place";
                reader.note(entry.wrong(&key, wanted));
                continue;
            }
            if let Some(values) = reader.noted(values(&key, entry)) {
                keys.push(key);
                shown.push(entry.place.to_string());
                lists.push(values);
            }
        }
        let lengths: Vec<usize> = lists.iter().map(Vec::len).collect();
        if lengths.iter().any(|length| *length != lengths[0]) {
            let found = keys.iter().zip(&lengths).map(|(key, n)| format!("{n} values of {key}")).collect::<Vec<_>>();
            let wanted = "lists of one length, because the keys of one table vary together".to_owned();
            let what = Wrong::Value { found: found.join(", "), wanted };
            reader.note(Mistake { place: entry.place.clone(), key: path, what });
            continue;
        }
        let row = |i: usize| lists.iter().map(|list| list[i].clone()).collect();
        let rows = (0..lengths.first().copied().unwrap_or(0)).map(row).collect();
        axes.push(Axis { keys, rows, shown, reference: None });
    }
    axes
}

/// Notes in the axes which of their rows the reference means.
fn read_reference(reader: &mut Reader, root: &Table, axes: &mut [Axis]) {
    let Some(entry) = root.get("reference") else { return };
    let Node::Table(table) = &entry.node else {
        return reader.note(entry.wrong("reference", "a table: reference = { \"controller.name\" = \"ideal\" }"));
    };
    for (key, entry) in flat("", table) {
        let wanted_value = entry.node.literal();
        let path = format!("reference.{key}");
        let Some((axis, column)) =
            axes.iter_mut().find_map(|axis| axis.keys.iter().position(|k| *k == key).map(|column| (axis, column)))
        else {
            reader.note(entry.wrong(&path, "a key that is varied"));
            continue;
        };
        let matches = |row: usize| same(&axis.rows[row][column], &wanted_value);
        let before = axis.reference;
        match (0..axis.rows.len()).find(|row| matches(*row)) {
            Some(row) if before.is_none_or(|other| other == row) => axis.reference = Some(row),
            Some(_) => reader.note(entry.wrong(&path, "the value that belongs to the other keys of the reference")),
            None => {
                let all: Vec<&str> = axis.rows.iter().map(|row| row[column].as_str()).collect();
                reader.note(entry.wrong(&path, format!("one of the values of {key}: {}", all.join(", "))));
            }
        }
    }
}

/// Whether two literals are the same value: 1 and 1.0 are.
fn same(a: &str, b: &str) -> bool {
    a == b || matches!((a.parse::<f64>(), b.parse::<f64>()), (Ok(a), Ok(b)) if a == b)
}

/// The entries of a table by their whole paths, whether the file writes `"a.b" = ..`, `a.b = ..` or a table in a table.
fn flat<'a>(path: &str, table: &'a Table) -> Vec<(String, &'a Entry)> {
    let full = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    let entries = table.iter().flat_map(|(key, entry)| match &entry.node {
        Node::Table(inner) if !inner.is_empty() => flat(&full(key), inner),
        _ => vec![(full(key), entry)],
    });
    entries.collect()
}

fn nothing(entry: &Entry, key: &str, wanted: &str) -> Mistake {
    let what = Wrong::Value { found: "nothing".to_owned(), wanted: wanted.to_owned() };
    Mistake { place: entry.place.clone(), key: key.to_owned(), what }
}
