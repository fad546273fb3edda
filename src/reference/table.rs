//! CSV files with columns found by name, units in the name or not.

use super::error::ReferenceError;
use std::path::{Path, PathBuf};

/// A quantity that a column can hold and its names, without units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Position,
    Time,
    /// A speed to follow as it is.
    Speed,
    /// The longitudinal speed of a recording.
    SpeedX,
    SpeedY,
    YawRate,
}

const NAMES: &[(&str, Quantity)] = &[
    ("s", Quantity::Position),
    ("position", Quantity::Position),
    ("distance", Quantity::Position),
    ("t", Quantity::Time),
    ("time", Quantity::Time),
    ("v", Quantity::Speed),
    ("vx", Quantity::SpeedX),
    ("speed", Quantity::SpeedX),
    ("vy", Quantity::SpeedY),
    ("yaw_rate", Quantity::YawRate),
];

/// The units of a quantity: how each ends a name, how loggers write it in brackets, and what one of it is in SI.
type Units = &'static [(&'static str, &'static str, f64)];

const SPEEDS: Units =
    &[("_mps", "m/s", 1.0), ("_kmh", "km/h", 1.0 / 3.6), ("_kph", "kph", 1.0 / 3.6), ("_mph", "mph", 0.44704)];
const YAW_RATES: Units = &[("_radps", "rad/s", 1.0), ("_degps", "deg/s", std::f64::consts::PI / 180.0)];

impl Quantity {
    fn units(self) -> Units {
        match self {
            Self::Position => &[("_m", "m", 1.0)],
            Self::Time => &[("_s", "s", 1.0), ("_ms", "ms", 0.001)],
            Self::Speed | Self::SpeedX | Self::SpeedY => SPEEDS,
            Self::YawRate => YAW_RATES,
        }
    }
}

/// Lines in front of the header that a logger may write.
const PREAMBLE_LINES: usize = 50;

/// What a file must have.
const WANTED: &str = "columns s_m,v_mps or t_s,v_mps, a recording's t,vx,vy,yaw_rate, or rows t;v";

/// What the name of a column says of its unit.
enum Unit {
    None,
    /// One of it in SI.
    Si(f64),
    /// None of the quantity's.
    Unknown(String),
}

/// The quantity and unit of a column that is called `name`: `speed_kmh`, `Speed (km/h)`, `speed [km/h]`.
fn known(name: &str) -> Option<(Quantity, Unit)> {
    let lower = name.trim().to_lowercase();
    NAMES.iter().find_map(|&(known, quantity)| {
        let rest = lower.strip_prefix(known)?.trim_start();
        let bracketed = rest.strip_prefix(['(', '[']).and_then(|unit| unit.strip_suffix([')', ']'])).map(str::trim);
        let is_meant = |(suffix, written, _): &&(&str, &str, f64)| bracketed.map_or(*suffix == rest, |b| b == *written);
        let unit = match (quantity.units().iter().find(is_meant), bracketed) {
            (Some((.., si)), _) => Unit::Si(*si),
            (None, Some(unit)) => Unit::Unknown(unit.to_owned()),
            (None, None) => rest.is_empty().then_some(Unit::None)?,
        };
        Some((quantity, unit))
    })
}

/// The text from its header on, with the other lines in front of it left empty, so that lines keep their numbers. The
/// header is the last line before the numbers in which two columns are known; a logger may have made it a comment. Without
/// one the text stays as it is; `None` if so many lines hold neither header nor numbers that there will be none.
fn without_preamble(text: &str) -> Option<String> {
    let fields = |line: &str| line.split([',', ';']).map(|field| field.trim().to_owned()).collect::<Vec<_>>();
    let is_data = |line: &&str| fields(line).iter().all(|field| field.parse::<f64>().is_ok());
    let (mut header, mut scanned) = (None, 0);
    for (number, line) in text.lines().take(PREAMBLE_LINES).enumerate().take_while(|(_, line)| !is_data(line)) {
        let names = fields(line.trim_start_matches(['#', ' ']));
        if names.iter().filter(|name| known(name).is_some()).count() >= 2 {
            header = Some(number);
        }
        scanned += 1;
    }
    let Some(header) = header else { return (scanned < PREAMBLE_LINES).then(|| text.to_owned()) };
    let lines = text.lines().enumerate().map(|(number, line)| match number {
        _ if number < header => "\n".to_owned(),
        _ if number == header => line.trim_start_matches(['#', ' ']).to_owned() + "\n",
        _ => line.to_owned() + "\n",
    });
    Some(lines.collect())
}

/// A column in SI units.
#[derive(Debug)]
pub(super) struct Column {
    quantity: Quantity,
    /// As in the file.
    pub name: String,
    pub values: Vec<f64>,
}

/// The known columns of a file, all of the same length, at least one row.
#[derive(Debug)]
pub(super) struct Table {
    pub file: PathBuf,
    /// The names in the first row and its line.
    header: Option<(String, u64)>,
    columns: Vec<Column>,
    /// Line of each row.
    lines: Vec<u64>,
}

impl Table {
    /// Reads `file`. Speeds whose column names no unit are multiplied by `speed_unit_mps`. Without a header, `;` separates
    /// time and speed.
    pub fn read(file: &Path, speed_unit_mps: f64) -> Result<Self, ReferenceError> {
        let text =
            std::fs::read_to_string(file).map_err(|source| ReferenceError::Read { file: file.into(), source })?;
        let mut table = Self { file: file.into(), header: None, columns: vec![], lines: vec![] };
        let Some(text) = without_preamble(text.trim_start_matches('\u{feff}')) else {
            return Err(table.content(
                PREAMBLE_LINES as u64,
                "header",
                &format!("none within {PREAMBLE_LINES} lines"),
                WANTED,
            ));
        };
        let first = text.lines().find(|l| !l.trim().is_empty() && !l.starts_with('#')).unwrap_or_default();
        let cycle = first.contains(';');
        let mut rows = csv::ReaderBuilder::new()
            .delimiter(if cycle { b';' } else { b',' })
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .has_headers(false)
            .flexible(true)
            .from_reader(text.as_bytes());
        let mut sources: Vec<(usize, f64)> = vec![];
        for row in rows.records() {
            let row = row.map_err(|e| table.broken(&e))?;
            let line = row.position().map_or(0, csv::Position::line);
            if table.header.is_none() {
                let headless = cycle && row.iter().all(|field| field.parse::<f64>().is_ok());
                let header = if headless { csv::StringRecord::from(vec!["t", "v"]) } else { row.clone() };
                sources = table.take_header(&header, line, speed_unit_mps)?;
                if !headless {
                    continue;
                }
            }
            table.take_row(&row, line, &sources)?;
        }
        if table.header.is_some() && table.columns.is_empty() {
            return Err(table.missing());
        }
        if table.lines.is_empty() {
            return Err(table.content(text.lines().count() as u64, "header", "no rows", "at least one row of numbers"));
        }
        Ok(table)
    }

    /// Finds the known columns; returns their index in a row and their unit.
    fn take_header(
        &mut self,
        header: &csv::StringRecord,
        line: u64,
        speed_unit_mps: f64,
    ) -> Result<Vec<(usize, f64)>, ReferenceError> {
        self.header = Some((header.iter().collect::<Vec<_>>().join(","), line));
        let mut sources = vec![];
        for (index, name) in header.iter().enumerate() {
            let Some((quantity, unit)) = known(name) else { continue };
            if self.column(quantity).is_some() {
                continue;
            }
            let is_speed = matches!(quantity, Quantity::Speed | Quantity::SpeedX | Quantity::SpeedY);
            let scale = match unit {
                Unit::Si(scale) => scale,
                Unit::None => {
                    if is_speed {
                        speed_unit_mps
                    } else {
                        1.0
                    }
                }
                Unit::Unknown(unit) => {
                    let wanted = quantity.units().iter().map(|(_, written, _)| *written).collect::<Vec<_>>().join(", ");
                    return Err(self.content(line, name, &format!("the unit \"{unit}\""), &format!("one of {wanted}")));
                }
            };
            self.columns.push(Column { quantity, name: name.to_owned(), values: vec![] });
            sources.push((index, scale));
        }
        Ok(sources)
    }

    fn take_row(&mut self, row: &csv::StringRecord, line: u64, sources: &[(usize, f64)]) -> Result<(), ReferenceError> {
        for (i, (index, scale)) in sources.iter().enumerate() {
            let field = row.get(*index).unwrap_or_default();
            match field.parse::<f64>() {
                Ok(value) if value.is_finite() => self.columns[i].values.push(value * scale),
                _ => return Err(self.content(line, &self.columns[i].name, &format!("\"{field}\""), "a number")),
            }
        }
        self.lines.push(line);
        Ok(())
    }

    pub fn column(&self, quantity: Quantity) -> Option<&Column> {
        self.columns.iter().find(|c| c.quantity == quantity)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.lines.len()
    }

    /// An error about a value of a row.
    pub fn error(&self, row: usize, column: &Column, wanted: &str) -> ReferenceError {
        let value = column.values[row];
        // Without an exponent some have hundreds of digits.
        let is_plain = value == 0.0 || (1e-6..1e15).contains(&value.abs());
        let found = if is_plain { value.to_string() } else { format!("{value:e}") };
        self.content(self.lines[row], &column.name, &found, wanted)
    }

    /// The error about a column that is missing.
    pub fn missing(&self) -> ReferenceError {
        let (names, line) = self.header.clone().unwrap_or_default();
        self.content(line, "header", &format!("\"{names}\""), WANTED)
    }

    fn content(&self, line: u64, column: &str, found: &str, wanted: &str) -> ReferenceError {
        ReferenceError::Content {
            file: self.file.clone(),
            line,
            column: column.to_owned(),
            found: found.to_owned(),
            wanted: wanted.to_owned(),
        }
    }

    fn broken(&self, error: &csv::Error) -> ReferenceError {
        let line = error.position().map_or(0, csv::Position::line);
        self.content(line, "row", &error.to_string(), "comma-separated values")
    }
}
