//! The map in one table: each law against each other one at equal tuning, by the factor by which the torque scale is wrong, and
//! where each is worst.

use super::cell::Cell;
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
    laws: Vec<&'static str>,
    factors: Vec<f64>,
    /// Law by law, and for each law factor by factor.
    pub comparisons: Vec<Comparison>,
}

impl Summary {
    /// The summary of a map.
    pub fn of(map: &Map) -> Self {
        let tuned = map.tuned();
        let (laws, factors) = (map.grid.laws(), map.grid.factors.clone());
        let mut comparisons = Vec::new();
        for &law in &laws {
            for row in factors.iter().copied().enumerate() {
                let others = laws.iter().filter(|over| **over != law);
                comparisons.extend(others.map(|over| Comparison::new(&tuned, [law, over], row)));
            }
        }
        Self { laws, factors, comparisons }
    }

    /// As `map_summary.csv`.
    pub fn to_csv(&self) -> String {
        let header = "law,over,scale_wrong_by,conditions,unfinished,ratio_median,ratio_least,ratio_largest,\
                      worst_period_s,worst_limit_mps2,worst_delay_s,worst_error_rms,worst_error_rms_over\n";
        header.to_owned() + &self.comparisons.iter().map(Comparison::csv).collect::<String>()
    }

    /// What is shown of a law over another one; nothing of a law over itself.
    fn cell(&self, law: &str, over: &str, factor: f64) -> String {
        let found = self.comparisons.iter().find(|c| (c.law, c.over, c.factor) == (law, over, factor));
        found.map(Comparison::cell).unwrap_or_default()
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
        self.laws.iter().filter_map(of).collect()
    }

    /// As tables of the page.
    pub fn tables(&self) -> [TableView; 2] {
        let over = self.laws.iter().map(|law| Head::number(format!("over {law}"), "RMS error over that of this law"));
        let heads =
            [Head::text("law", ""), Head::number("scale wrong by", "factor on the torque scale, unknown to the law")];
        let row = |law: &str, factor: f64| {
            let cells = self.laws.iter().map(|over| Field::number(self.cell(law, over, factor)));
            [Field::text(law), Field::number(factor.to_string())].into_iter().chain(cells).collect()
        };
        let rows = self.laws.iter().flat_map(|law| self.factors.iter().map(|factor| row(law, *factor)));
        let compared = TableView {
            id: "map-laws".into(),
            caption: "Each law against each other one, at equal tuning: RMS error over that of the law in the column's head, each with the gains \
                      of its least error at the right torque scale: median (least … largest), number of conditions. A condition is a \
                      control period, a torque limit and a delay; it counts where both came to the end."
                .into(),
            head: heads.into_iter().chain(over).collect(),
            rows: rows.collect(),
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
            let _ = write!(text, "{law:<12}{:<17}", "scale wrong by");
            self.factors.iter().for_each(|factor| text += &format!("  {:<23}", format!("x {factor}")));
            text += "\n";
            for over in self.laws.iter().filter(|over| **over != law) {
                let _ = write!(text, "{:<12}over {over:<12}", "");
                self.factors.iter().for_each(|factor| text += &format!("  {:<23}", self.cell(law, over, *factor)));
                text += "\n";
            }
        }
        text += "Where each law is worst\n";
        self.worst().iter().for_each(|line| text += &format!("{line}\n"));
        text.lines().map(|line| format!("{}\n", line.trim_end())).collect()
    }
}
