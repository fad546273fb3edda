//! What came out: a table by room, and the survivors beside those whose reason is written down.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::list::Mutant;
use crate::trial::Fate;

/// The survivors that are known, each with its reason: how many there are of each short name.
#[derive(Debug, Default)]
pub struct Known {
    reasons: BTreeMap<String, (usize, String)>,
}

impl Known {
    /// Reads a list: a reason on a line of its own, below it the changes that it explains, which begin with `src/`.
    /// A name stands there as often as a function has such a change. Lines that begin with # are comments.
    pub fn read(text: &str) -> Self {
        let mut known = Self::default();
        let mut reason = "";
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
            if line.starts_with("src/") {
                known.reasons.entry(line.to_string()).or_insert((0, reason.to_string())).0 += 1;
            } else {
                reason = line.trim_end_matches(':');
            }
        }
        known
    }

    /// Takes one of that name off the list.
    fn take(&mut self, name: &str) -> Option<&str> {
        let (left, reason) = self.reasons.get_mut(name)?;
        *left = left.checked_sub(1)?;
        Some(reason)
    }
}

/// One change and what became of it; `None` where it was not tried, because it does not compile so, or has no site.
pub type Tried<'a> = (&'a Mutant, Option<Fate>);

/// The table by room, in Markdown: how many changes there are, and what became of them.
pub fn table(tried: &[Tried]) -> String {
    let mut rooms: BTreeMap<&str, [usize; 4]> = BTreeMap::new();
    for (mutant, fate) in tried {
        let counts = rooms.entry(mutant.room()).or_default();
        let column = match fate {
            Some(Fate::Caught(_)) => 0,
            Some(Fate::Survived) => 1,
            Some(Fate::Unreached) => 2,
            None => 3,
        };
        counts[column] += 1;
    }
    let mut text =
        String::from("| room | tried | caught | survived | reached by no test | not tried | caught of those tried |\n");
    text.push_str("|---|---|---|---|---|---|---|\n");
    let all = rooms.values().fold([0; 4], |sum, counts| std::array::from_fn(|i| sum[i] + counts[i]));
    for (room, [caught, survived, unreached, not_tried]) in rooms.into_iter().chain([("all", all)]) {
        let tried = caught + survived + unreached;
        let share = 100.0 * caught as f64 / tried.max(1) as f64;
        writeln!(text, "| {room} | {tried} | {caught} | {survived} | {unreached} | {not_tried} | {share:.1} % |")
            .unwrap();
    }
    text
}

/// The survivors with their reasons, then those without one and those that are listed and do not survive any more. Also
/// how many have no reason.
pub fn survivors(tried: &[Tried], known: &mut Known) -> (String, usize) {
    let (mut explained, mut new) = (String::new(), Vec::new());
    for (mutant, fate) in tried {
        let Some(survives @ (Fate::Survived | Fate::Unreached)) = fate else { continue };
        match known.take(&mutant.short_name()) {
            Some(reason) => writeln!(explained, "{}\n    {survives}; {reason}", mutant.name).unwrap(),
            None => new.push(format!("{}\n    {survives}", mutant.name)),
        }
    }
    let mut text = format!("Survivors whose reason is known:\n{explained}");
    let tried_rooms: Vec<String> = tried.iter().map(|(mutant, _)| mutant.file.clone()).collect();
    for (name, (left, _)) in &known.reasons {
        if *left > 0 && tried_rooms.iter().any(|file| name.starts_with(&format!("{file}:"))) {
            writeln!(text, "listed as a survivor, but is none ({left}): {name}").unwrap();
        }
    }
    writeln!(text, "Survivors without a reason: {}\n{}", new.len(), new.join("\n")).unwrap();
    (text, new.len())
}
