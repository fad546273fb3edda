//! Reader of the log of SUMO's SSM device, surrogate safety measures
//! (<https://sumo.dlr.de/docs/Simulation/Output/SSM_Device.html>), SUMO 1.15 to 1.28.

use super::error::SumoFileError;
use super::network::place;
use super::records;
use std::collections::BTreeMap;
use std::path::Path;

/// One encounter in which a measure passed its threshold, as one of its two vehicles saw it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Conflict {
    /// The vehicle that has the device.
    pub ego: String,
    /// The other one.
    pub foe: String,
    /// When it was at its worst \[s\].
    pub time_s: Option<f64>,
    /// Where, x and y of the network \[m\], or longitude and latitude with `device.ssm.geo`.
    pub place: Option<[f64; 2]>,
    /// Smallest time to collision \[s\].
    pub ttc_min_s: Option<f64>,
    /// Largest deceleration to avoid a crash [m/s²].
    pub drac_max_mps2: Option<f64>,
    /// Post-encroachment time \[s\].
    pub pet_s: Option<f64>,
}

/// Calls `visit` with every conflict of a log, in its order.
///
/// # Errors
/// [`SumoFileError`] if the file cannot be read, or is not what SUMO writes.
pub fn each_conflict(path: &Path, mut visit: impl FnMut(Conflict)) -> Result<(), SumoFileError> {
    let mut open: Option<Conflict> = None;
    records::each(path, &["conflict", "minTTC", "maxDRAC", "PET"], |element, record| {
        if element == "conflict" {
            let ego = record.text("ego").ok_or("no ego")?;
            let next = Conflict { ego, foe: record.text("foe").unwrap_or_default(), ..Conflict::default() };
            open.replace(next).into_iter().for_each(&mut visit);
            return Ok(());
        }
        let conflict = open.as_mut().ok_or("no conflict around it")?;
        // "NA" where the encounter has no such value.
        let Ok(value) = record.number("value") else { return Ok(()) };
        *match element {
            "minTTC" => &mut conflict.ttc_min_s,
            "maxDRAC" => &mut conflict.drac_max_mps2,
            _ => &mut conflict.pet_s,
        } = Some(value);
        // The first measure that has a value says when and where: TTC before DRAC before PET.
        if conflict.place.is_none() {
            conflict.time_s = record.number("time").ok();
            conflict.place = record.text("position").and_then(|text| place(&text));
        }
        Ok(())
    })?;
    open.into_iter().for_each(visit);
    Ok(())
}

/// What the device of one vehicle saw.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Conflicts {
    /// Encounters in which a measure passed its threshold.
    pub count: u64,
    /// Smallest time to collision \[s\].
    pub ttc_min_s: Option<f64>,
    /// Largest deceleration to avoid a crash [m/s²].
    pub drac_max_mps2: Option<f64>,
    /// Smallest post-encroachment time \[s\].
    pub pet_min_s: Option<f64>,
}

impl Conflicts {
    /// Reads a log: the conflicts of each vehicle that was in any as the one that has the device.
    ///
    /// # Errors
    /// [`SumoFileError`] if the file cannot be read, or is not what SUMO writes.
    pub fn read(path: &Path) -> Result<BTreeMap<String, Self>, SumoFileError> {
        let mut all = BTreeMap::<String, Self>::new();
        each_conflict(path, |conflict| {
            let seen = all.entry(conflict.ego).or_default();
            seen.count += 1;
            extreme(&mut seen.ttc_min_s, conflict.ttc_min_s, f64::min);
            extreme(&mut seen.drac_max_mps2, conflict.drac_max_mps2, f64::max);
            extreme(&mut seen.pet_min_s, conflict.pet_s, f64::min);
        })?;
        Ok(all)
    }
}

fn extreme(so_far: &mut Option<f64>, value: Option<f64>, choose: fn(f64, f64) -> f64) {
    *so_far = value.map(|value| so_far.map_or(value, |before| choose(before, value))).or(*so_far);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extremes_of_all_conflicts_of_a_vehicle_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ssm.xml");
        let conflict = |ego: &str, values: [&str; 3]| {
            let [ttc, drac, pet] = values;
            format!(
                r#"<conflict begin="1" end="2" ego="{ego}" foe="x"><minTTC value="{ttc}"/><maxDRAC value="{drac}"/><PET value="{pet}"/></conflict>"#
            )
        };
        let text = [
            conflict("a", ["2.5", "3.1", "NA"]),
            conflict("b", ["nan", "-inf", "1.5"]),
            conflict("a", ["0.7", "1.0", "inf"]),
        ];
        std::fs::write(&path, format!("<SSMLog>{}</SSMLog>", text.concat())).unwrap();
        let read = Conflicts::read(&path).unwrap();
        let a = Conflicts { count: 2, ttc_min_s: Some(0.7), drac_max_mps2: Some(3.1), pet_min_s: None };
        assert_eq!(read["a"], a);
        assert_eq!(read["b"], Conflicts { count: 1, pet_min_s: Some(1.5), ..Conflicts::default() });
    }

    #[test]
    fn a_conflict_is_where_its_first_measure_with_a_value_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ssm.xml");
        let text = r#"<SSMLog><conflict begin="1" end="2" ego="a" foe="b">
            <minTTC time="NA" position="NA" type="NA" value="NA" speed="NA"/>
            <maxDRAC time="1.50" position="10.00,-2.50" type="2" value="3.1" speed="15.7"/>
            <PET time="1.90" position="12.00,0.00" type="2" value="1.2" speed="1"/></conflict></SSMLog>"#;
        std::fs::write(&path, text).unwrap();
        let mut all = Vec::new();
        each_conflict(&path, |conflict| all.push(conflict)).unwrap();
        let wanted = Conflict {
            ego: "a".into(),
            foe: "b".into(),
            time_s: Some(1.5),
            place: Some([10.0, -2.5]),
            ttc_min_s: None,
            drac_max_mps2: Some(3.1),
            pet_s: Some(1.2),
        };
        assert_eq!(all, [wanted]);
    }
}
