//! Results to make pages of, and how to read their tables.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use regex::Regex;
use tempfile::TempDir;

use crate::support::{Ended, NEW, Running, program, repository, run_command};

/// Ids that would be more than text in a careless page.
pub const HOSTILE: [&str; 5] = [
    "</script><script>hacked = 1</script>",
    "\"><img src=x onerror=\"hacked = 2\">",
    "<!--<script>",
    "'; hacked = 3; //\u{2028}{{ 7 * 7 }}",
    "long-long-long-long-long-long-long-long-long-long-long-long-long-long-long-long-long-long-long-long-long-long-long",
];

/// A folder that lives as long as the process, made once.
struct Kept(OnceLock<PathBuf>);

impl Kept {
    fn get(&self, name: &str, make: impl FnOnce(&Path)) -> &Path {
        self.0.get_or_init(|| {
            // Beside the other files of the tests: a static is never dropped, and `cargo clean` takes it away.
            let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report").join(name);
            let _ = fs::remove_dir_all(&dir);
            make(&dir);
            dir
        })
    }
}

/// A run of the city for a minute and a half, with some vehicles traced, and its page.
pub fn city() -> &'static Path {
    static CITY: Kept = Kept(OnceLock::new());
    CITY.get("city", |dir| {
        let args = ["--end", "90", "--trace", "0,5,9", "--safety", "--force"];
        let ended = Running::start(run_command(NEW, &repository("scenarios/city.toml"), dir, &args)).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    })
}

/// A study of two controllers, three gains and two seeds.
pub fn study() -> &'static Path {
    static STUDY: Kept = Kept(OnceLock::new());
    STUDY.get("study", |dir| {
        let mut command = program(NEW);
        command.arg("sweep").arg(repository("scenarios/motorway.toml")).arg("-o").arg(dir);
        command.args(["--vary", "controller.name=classic,adaptive", "--vary", "controller.k_p=0.5,1,2"]);
        command.args(["--reference", "controller.name=classic", "--seeds", "1,2", "--end", "40", "-q"]);
        command.args(["--set", "traffic.sigma=0.5"]);
        let ended = Running::start(command).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    })
}

/// All of the paper's tests under the preset that meets the most, on a short recording: ours take long.
pub fn paper() -> &'static Path {
    static PAPER: Kept = Kept(OnceLock::new());
    PAPER.get("paper", |dir| {
        fs::create_dir_all(dir).unwrap();
        let recording = dir.join("short.csv");
        let speed = |t: f64| 12.0 + 4.0 * (0.5 * t).sin();
        let rows = (0..=300).map(|k| 0.1 * f64::from(k)).map(|t| format!("{t},{},0,0.01\n", speed(t)));
        fs::write(&recording, format!("t_s,vx_mps,vy_mps,yaw_rate_radps\n{}", rows.collect::<String>())).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_sumo-mfc"));
        command.current_dir(env!("CARGO_MANIFEST_DIR")).args(["paper", "all", "--preset", "best", "--driver"]);
        command.arg(&recording).arg("-o").arg(dir);
        let ended = Running::start(command).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    })
}

/// A copy of a result, to be changed.
pub fn copied(dir: &Path) -> TempDir {
    fn copy(from: &Path, to: &Path) {
        fs::create_dir_all(to).unwrap();
        for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
            let target = to.join(entry.file_name());
            if entry.path().is_dir() {
                copy(&entry.path(), &target)
            } else {
                let _ = fs::copy(entry.path(), target).unwrap();
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    copy(dir, folder.path());
    folder
}

fn command(dirs: &[&Path], args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sumo-mfc"));
    command.arg("report").args(dirs).args(args);
    command
}

/// `sumo-mfc report DIRS ARGS`, which must succeed.
pub fn report(dirs: &[&Path], args: &[&str]) -> Ended {
    let ended = Running::start(command(dirs, args)).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended
}

/// The same, which must fail; what it says, in one line.
pub fn failed_report(dirs: &[&Path], args: &[&str]) -> String {
    let ended = Running::start(command(dirs, args)).wait();
    assert_eq!(ended.code, Some(1), "{args:?} should have failed");
    assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
    ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The page of results, not kept.
pub fn report_of(dirs: &[&Path]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    report(dirs, &["-o", page.to_str().unwrap()]);
    fs::read_to_string(page).unwrap()
}

/// Replaces a text in a file; it must be there.
pub fn replaced(path: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{}: no {from}", path.display());
    fs::write(path, text.replace(from, to)).unwrap();
}

/// Changes the rows of `vehicles.csv`.
pub fn with_vehicles(dir: &Path, change: impl FnOnce(&mut Vec<Vec<String>>)) {
    with_rows(&dir.join("vehicles.csv"), |header, rows| {
        assert_eq!(&header[12], "error_rms");
        change(rows);
    });
}

/// Changes the rows of a table.
fn with_rows(path: &Path, change: impl FnOnce(&csv::StringRecord, &mut Vec<Vec<String>>)) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header = reader.headers().unwrap().clone();
    let mut rows: Vec<Vec<String>> = reader.deserialize().map(Result::unwrap).collect();
    change(&header, &mut rows);
    let mut writer = csv::Writer::from_path(path).unwrap();
    writer.write_record(&header).unwrap();
    rows.iter().for_each(|row| writer.write_record(row).unwrap());
    writer.flush().unwrap();
}

/// A result of so many vehicles: the rows of a real run again and again, with ids and values of their own.
pub fn multiplied(dir: &Path, vehicles: usize) -> TempDir {
    let folder = copied(dir);
    for table in ["vehicles.csv", "quality.csv"] {
        with_rows(&folder.path().join(table), |header, rows| {
            let first = std::mem::take(rows);
            let after_depart = header.iter().position(|column| column == "depart").unwrap() + 1;
            for number in 0..vehicles {
                let mut row = first[number % first.len()].clone();
                let round = number / first.len();
                if round > 0 {
                    row[0] = format!("{}.{round}", row[0]);
                    // Other digits in every number that has some.
                    for cell in row.iter_mut().skip(after_depart).filter(|cell| cell.contains('.')) {
                        let value: f64 = cell.parse().unwrap();
                        *cell = (value * (1.0 + 0.001 * (number % 997) as f64 / 997.0)).to_string();
                    }
                }
                rows.push(row);
            }
        });
    }
    folder
}

/// Whether a number is shown as it is but for rounding, with digits enough.
pub fn shown(text: &str, value: f64) -> bool {
    let digits = text.split('e').next().unwrap().chars().filter(char::is_ascii_digit).collect::<String>();
    // Whole numbers are whole.
    rounded(text, value) && (value == value.round() || digits.trim_start_matches('0').len() >= 4)
}

/// Whether a number is shown as it is but for rounding.
pub fn rounded(text: &str, value: f64) -> bool {
    let number = text.split('e').next().unwrap();
    let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len()) as i32;
    let exponent: i32 = text.split_once('e').map_or(0, |(_, exponent)| exponent.parse().unwrap());
    let last = 10_f64.powi(exponent - decimals);
    text.parse().is_ok_and(|text: f64| (text - value).abs() <= 0.500_001 * last)
}

/// A table of a page.
pub struct Cells {
    /// Its headers.
    pub head: Vec<String>,
    /// The texts of its cells.
    pub rows: Vec<Vec<String>>,
}

impl Cells {
    /// The table of this id.
    pub fn of(page: &str, id: &str) -> Self {
        let start = page.find(&format!("<table id=\"{id}\">")).unwrap_or_else(|| panic!("no table {id}"));
        let table = &page[start..start + page[start..].find("</table>").unwrap()];
        let texts = |text: &str, tag: &str| -> Vec<String> {
            let cell = Regex::new(&format!("(?s)<{tag}(?: [^>]*)?>(.*?)</{tag}>")).unwrap();
            cell.captures_iter(text).map(|found| plain(&found[1])).collect()
        };
        let rows = table.split("<tr>").skip(2).map(|row| texts(row, "td")).collect();
        Self { head: texts(table, "th"), rows }
    }

    /// The row that begins with this text.
    pub fn row(&self, first: &str) -> &[String] {
        self.rows.iter().find(|row| row[0] == first).unwrap_or_else(|| panic!("no row {first}"))
    }
}

/// The text that HTML shows.
pub fn plain(html: &str) -> String {
    let entities = BTreeMap::from([("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#x27;", "'"), ("&#x2f;", "/")]);
    entities.iter().fold(html.to_owned(), |text, (entity, c)| text.replace(entity, c)).replace("&amp;", "&")
}
