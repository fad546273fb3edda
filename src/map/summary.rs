//! The map in one table: each law against each other one at equal tuning, by the factor by which the torque scale is wrong, and
//! where each is worst.

use super::cell::Cell;
use super::grid::LAWS;
use super::tuned::{Map, Tuned};
use crate::page::{Cell as Field, Head, TableView};
use std::fmt::Write;

/// The laws whose lines the command prints; file and page have all.
const PRINTED: [&str; 2] = ["adaptive", "calibrating"];

/// RMS errors of two laws in the same condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encounter {
    /// The first law's cell.
    pub law: Cell,
    /// RMS error of the first law [m/s].
    pub error_rms: f64,
    /// That of the other [m/s].
    pub error_rms_over: f64,
}

impl Encounter {
    /// The first law's error over the other's.
    pub fn ratio(&self) -> f64 {
        self.error_rms / self.error_rms_over
    }
}

/// A law against another one under all conditions with one factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The law.
    pub law: &'static str,
    /// What it is compared with.
    pub over: &'static str,
    /// Factor by which the torque scale is wrong.
    pub factor: f64,
    /// Conditions in which the first law did not come to the end and the other did.
    pub unfinished: usize,
    /// The others that the table has for both, the least ratio first.
    encounters: Vec<Encounter>,
}

impl Comparison {
    fn new(tuned: &[(String, Vec<Tuned>)], [law, over]: [&'static str; 2], (row, factor): (usize, f64)) -> Self {
        let (mut encounters, mut unfinished) = (Vec::new(), 0);
        for (_, laws) in tuned {
            let cell = |name: &str| laws.iter().find(|t| t.law == name)?.wrong[row];
            let (Some(mine), Some(other)) = (cell(law), cell(over)) else { continue };
            match (mine.error_rms, other.error_rms) {
                (Some(error_rms), Some(error_rms_over)) => {
                    encounters.push(Encounter { law: mine, error_rms, error_rms_over });
                }
                (None, Some(_)) => unfinished += 1,
                _ => {}
            }
        }
        encounters.sort_by(|a, b| a.ratio().total_cmp(&b.ratio()));
        Self { law, over, factor, unfinished, encounters }
    }

    /// In how many conditions the two can be compared.
    pub fn conditions(&self) -> usize {
        self.encounters.len()
    }

    /// Median, least and largest ratio of the RMS errors.
    pub fn ratios(&self) -> Option<[f64; 3]> {
        let ratio = |i: usize| self.encounters[i].ratio();
        let last = self.conditions().checked_sub(1)?;
        Some([0.5 * (ratio(last / 2) + ratio(last.div_ceil(2))), ratio(0), ratio(last)])
    }

    /// Where the law is worst against this one.
    pub fn worst(&self) -> Option<&Encounter> {
        self.encounters.last()
    }

    fn cell(&self) -> String {
        let Some([median, least, largest]) = self.ratios() else { return "-".to_owned() };
        format!("{median:.2} ({least:.2} … {largest:.2}), {}", self.conditions())
    }

    fn csv(&self) -> String {
        let Self { law, over, factor, unfinished, .. } = self;
        let mut line = format!("{law},{over},{factor},{},{unfinished}", self.conditions());
        let worst = self.worst().map(|w| {
            let Cell { period_s, limit_mps2, delay_s, .. } = w.law;
            [period_s, limit_mps2, delay_s, w.error_rms, w.error_rms_over]
        });
        for number in
            self.ratios().map_or([None; 3], |r| r.map(Some)).into_iter().chain(worst.map_or([None; 5], |w| w.map(Some)))
        {
            line += &number.map_or(",".to_owned(), |x| format!(",{x}"));
        }
        line + "\n"
    }
}

/// All comparisons.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Law by law, and for each law factor by factor.
    pub comparisons: Vec<Comparison>,
}

impl Summary {
    /// The summary of a map.
    pub fn of(map: &Map) -> Self {
        let tuned = map.tuned();
        let mut comparisons = Vec::new();
        for law in LAWS {
            for (row, factor) in map.grid.factors.iter().copied().enumerate() {
                let others = LAWS.into_iter().filter(|over| *over != law);
                comparisons.extend(others.map(|over| Comparison::new(&tuned, [law, over], (row, factor))));
            }
        }
        Self { comparisons }
    }

    /// As `map_summary.csv`.
    pub fn to_csv(&self) -> String {
        let header = "law,over,scale_wrong_by,conditions,unfinished,ratio_median,ratio_least,ratio_largest,\
                      worst_period_s,worst_limit_mps2,worst_delay_s,worst_error_rms,worst_error_rms_over\n";
        header.to_owned() + &self.comparisons.iter().map(Comparison::csv).collect::<String>()
    }

    /// A line for each law and factor: the law, the factor, a cell for each law of [`LAWS`].
    fn lines(&self) -> Vec<(&'static str, f64, [String; LAWS.len()])> {
        let mut lines: Vec<(&'static str, f64, [String; LAWS.len()])> = Vec::new();
        for c in &self.comparisons {
            if lines.last().is_none_or(|(law, factor, _)| (*law, *factor) != (c.law, c.factor)) {
                lines.push((c.law, c.factor, Default::default()));
            }
            let column = LAWS.iter().position(|law| *law == c.over);
            if let (Some((.., cells)), Some(column)) = (lines.last_mut(), column) {
                cells[column] = c.cell();
            }
        }
        lines
    }

    /// For each law, where its error is the largest multiple of another law's.
    fn worst(&self) -> Vec<String> {
        let of = |law: &&str| {
            let mine = self.comparisons.iter().filter(|c| c.law == *law).filter_map(|c| Some((c, c.worst()?)));
            let (c, worst) = mine.max_by(|a, b| a.1.ratio().total_cmp(&b.1.ratio()))?;
            let Cell { period_s, limit_mps2, delay_s, .. } = worst.law;
            Some(format!(
                "{law}: {:.2} times the error of {} ({:.3} against {:.3} m/s), scale x {}, dt {} ms, limit {limit_mps2} m/s2, delay {delay_s} s",
                worst.ratio(),
                c.over,
                worst.error_rms,
                worst.error_rms_over,
                c.factor,
                1000.0 * period_s,
            ))
        };
        LAWS.iter().filter_map(of).collect()
    }

    /// As tables of the page.
    pub fn tables(&self) -> [TableView; 2] {
        let over = LAWS.iter().map(|law| Head::number(format!("over {law}"), "RMS error over that of this law"));
        let heads =
            [Head::text("law", ""), Head::number("scale wrong by", "factor on the torque scale, unknown to the law")];
        let row = |(law, factor, cells): (&str, f64, [String; LAWS.len()])| {
            let first = [Field::text(law), Field::number(factor.to_string())];
            first.into_iter().chain(cells.into_iter().map(Field::number)).collect()
        };
        let compared = TableView {
            id: "map-laws".into(),
            caption: "Each law against each other one, at equal tuning: RMS error over that of the law in the column's head, each with the gains \
                      of its least error at the right torque scale: median (least … largest), number of conditions. A condition is a \
                      control period, a torque limit and a delay; it counts where both came to the end."
                .into(),
            head: heads.into_iter().chain(over).collect(),
            rows: self.lines().into_iter().map(row).collect(),
            ..TableView::default()
        };
        let worst = TableView {
            id: "map-worst".into(),
            head: vec![Head::text("where each law is worst", "")],
            rows: self.worst().into_iter().map(|line| vec![Field::words(line)]).collect(),
            ..TableView::default()
        };
        [compared, worst]
    }

    /// As the end of what the command prints: the laws that adapt, and where each law is worst.
    pub fn text(&self) -> String {
        let mut text = String::from(
            "RMS error over that of another law, each with its best gains: median (least … largest), conditions\n",
        );
        for law in PRINTED {
            let others = || LAWS.iter().enumerate().filter(|(_, over)| **over != law);
            let _ = write!(text, "{law:<12}{:<15}", "scale wrong by");
            others().for_each(|(_, over)| text += &format!("  {:<23}", format!("over {over}")));
            text += "\n";
            for (_, factor, cells) in self.lines().into_iter().filter(|line| line.0 == law) {
                let _ = write!(text, "{:<12}x {factor:<13}", "");
                others().for_each(|(column, _)| text += &format!("  {:<23}", cells[column]));
                text += "\n";
            }
        }
        text += "Where each law is worst\n";
        self.worst().iter().for_each(|line| text += &format!("{line}\n"));
        text.lines().map(|line| format!("{}\n", line.trim_end())).collect()
    }
}
