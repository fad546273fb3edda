//! Which vehicles: `all | param | type:GLOB | id:REGEX | class:NAME | share:0.25`.

use std::{collections::BTreeSet, fmt};

use globset::{Glob, GlobMatcher};
use regex::Regex;

use crate::{random::Stream, registry::nearest};

/// SUMO's vehicle classes.
const CLASSES: &[&str] = &[
    "private",
    "emergency",
    "authority",
    "army",
    "vip",
    "pedestrian",
    "passenger",
    "hov",
    "taxi",
    "bus",
    "coach",
    "delivery",
    "truck",
    "trailer",
    "motorcycle",
    "moped",
    "bicycle",
    "evehicle",
    "tram",
    "rail_urban",
    "rail",
    "rail_electric",
    "rail_fast",
    "ship",
    "container",
    "cable_car",
    "subway",
    "aircraft",
    "wheelchair",
    "scooter",
    "drone",
    "custom1",
    "custom2",
    "ignoring",
];

/// What a selector may look at.
#[derive(Debug, Clone, Copy)]
pub struct EgoInfo<'a> {
    /// The vehicle's id.
    pub id: &'a str,
    /// Its vType's id.
    pub type_id: &'a str,
    /// Its vClass.
    pub class: &'a str,
    /// True if the parameter `has.mfc.device` of the vehicle or its type says so.
    pub param: bool,
}

/// A choice of vehicles.
#[derive(Debug, Clone)]
pub enum Selector {
    /// Every vehicle.
    All,
    /// Vehicles with the parameter `has.mfc.device`.
    Param,
    /// Vehicles whose vType id matches; the `@distribution` suffix that SUMO may add counts too.
    Type(Box<GlobMatcher>),
    /// Vehicles whose id matches in full.
    Id(Regex),
    /// Vehicles of a vClass.
    Class(String),
    /// This share of the vehicles, drawn per vehicle from the seed.
    Share(f64),
}

impl Selector {
    /// Reads a selector.
    ///
    /// # Errors
    /// What would be right instead.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        match kind {
            "all" if rest.is_empty() => Ok(Self::All),
            "param" if rest.is_empty() => Ok(Self::Param),
            "type" if !rest.is_empty() => Glob::new(rest)
                .map(|g| Self::Type(Box::new(g.compile_matcher())))
                .map_err(|e| format!("type:GLOB with a valid glob ({e})")),
            // Anchored, or `id:1` would choose every id with a 1 in it.
            "id" if !rest.is_empty() => Regex::new(&format!("^(?:{rest})$"))
                .map(Self::Id)
                .map_err(|_| format!("id:REGEX with a valid regular expression (\"{rest}\" is none)")),
            "class" if CLASSES.contains(&rest) => Ok(Self::Class(rest.to_owned())),
            "class" => {
                let near = nearest(rest, CLASSES.iter().copied());
                let meant = near.map(|n| format!("; did you mean class:{n}?")).unwrap_or_default();
                Err(format!("class:NAME with a vehicle class of SUMO{meant}"))
            }
            "share" => match rest.parse::<f64>() {
                Ok(share) if (0.0..=1.0).contains(&share) => Ok(Self::Share(share)),
                _ => Err("share:X with X from 0 to 1".to_owned()),
            },
            _ => Err("all, param, type:GLOB, id:REGEX, class:NAME or share:X".to_owned()),
        }
    }

    /// What to say if it names a vType and no vehicle of these can be meant.
    pub(super) fn misses(&self, types: &BTreeSet<String>) -> Option<String> {
        /// What SUMO gives those who name no vType.
        const DEFAULTS: [&str; 4] = ["DEFAULT_VEHTYPE", "DEFAULT_TAXITYPE", "DEFAULT_BIKETYPE", "DEFAULT_RAILTYPE"];
        let Self::Type(glob) = self else { return None };
        let names = || types.iter().map(String::as_str).chain(DEFAULTS);
        // SUMO makes vTypes called `type@vehicle` itself.
        if glob.glob().glob().contains('@') || names().any(|name| glob.is_match(name)) {
            return None;
        }
        let near = nearest(glob.glob().glob(), names()).map(|near| format!("; did you mean type:{near}?"));
        Some(format!("a vType of the demand{}", near.unwrap_or_default()))
    }

    /// Whether the vehicle is chosen in a run with `seed`.
    pub fn matches(&self, ego: &EgoInfo<'_>, seed: u64) -> bool {
        match self {
            Self::All => true,
            Self::Param => ego.param,
            Self::Type(glob) => glob.is_match(ego.type_id),
            Self::Id(regex) => regex.is_match(ego.id),
            Self::Class(class) => ego.class == class,
            Self::Share(share) => Stream::new(seed, "share", ego.id).uniform() < *share,
        }
    }
}

impl PartialEq for Selector {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => write!(f, "all"),
            Self::Param => write!(f, "param"),
            Self::Type(glob) => write!(f, "type:{}", glob.glob()),
            Self::Id(regex) => {
                let anchored = regex.as_str();
                write!(f, "id:{}", anchored.strip_prefix("^(?:").and_then(|r| r.strip_suffix(")$")).unwrap_or(anchored))
            }
            Self::Class(class) => write!(f, "class:{class}"),
            Self::Share(share) => write!(f, "share:{share}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ego<'a>(id: &'a str, type_id: &'a str, class: &'a str, param: bool) -> EgoInfo<'a> {
        EgoInfo { id, type_id, class, param }
    }

    #[test]
    fn selectors_choose_what_they_say() {
        let bus = ego("bus.12", "city_bus", "bus", false);
        for (text, chosen) in [
            ("all", true),
            ("param", false),
            ("type:city_*", true),
            ("type:car", false),
            ("id:bus\\..*", true),
            ("id:1", false),
            ("class:bus", true),
            ("class:truck", false),
            ("share:0", false),
            ("share:1", true),
        ] {
            let selector = Selector::parse(text).unwrap();
            assert_eq!(selector.matches(&bus, 1), chosen, "{text}");
            assert_eq!(selector.to_string(), text);
        }
        assert!(Selector::Param.matches(&ego("a", "t", "passenger", true), 1));
    }

    #[test]
    fn law_a_share_is_kept_and_belongs_to_the_vehicle() {
        let quarter = Selector::parse("share:0.25").unwrap();
        let ids: Vec<String> = (0..4000).map(|i| format!("veh{i}")).collect();
        let chosen = |seed| ids.iter().map(|i| quarter.matches(&ego(i, "t", "passenger", false), seed)).collect();
        let first: Vec<bool> = chosen(7);
        let count = first.iter().filter(|c| **c).count();
        assert!((900..1100).contains(&count), "{count} of 4000");
        assert_eq!(first, chosen(7));
        assert_ne!(first, chosen(8));
        let half = Selector::parse("share:0.5").unwrap();
        for (id, in_quarter) in ids.iter().zip(&first) {
            assert!(!in_quarter || half.matches(&ego(id, "t", "passenger", false), 7), "a larger share keeps {id}");
        }
    }

    #[test]
    fn a_selector_of_types_that_no_vehicle_has_is_told_with_the_nearest() {
        let types = ["car", "truck_long"].map(str::to_owned).into();
        let misses = |text: &str| Selector::parse(text).unwrap().misses(&types);
        for text in ["type:car", "type:truck*", "type:DEFAULT_*", "type:car@*", "id:nobody", "class:bus", "all"] {
            assert_eq!(misses(text), None, "{text}");
        }
        assert_eq!(misses("type:trukc_long").unwrap(), "a vType of the demand; did you mean type:truck_long?");
        assert_eq!(misses("type:bicycle").unwrap(), "a vType of the demand");
    }

    #[test]
    fn wrong_selectors_say_what_would_be_right() {
        for (text, part) in [
            ("everyone", "all, param"),
            ("share:1.5", "from 0 to 1"),
            ("share:nan", "from 0 to 1"),
            ("id:(", "regular expression"),
            ("type:[", "glob"),
            ("class:pasenger", "class:passenger"),
            ("all:x", "all, param"),
        ] {
            let wrong = Selector::parse(text).unwrap_err();
            assert!(wrong.contains(part), "{text}: {wrong}");
        }
    }
}
