//! Reader of the log of SUMO's SSM device, surrogate safety measures
//! (<https://sumo.dlr.de/docs/Simulation/Output/SSM_Device.html>), SUMO 1.15 to 1.28.

use super::error::SumoFileError;
use super::records;
use std::collections::BTreeMap;
use std::path::Path;

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
        let mut ego = String::new();
        records::each(path, &["conflict", "minTTC", "maxDRAC", "PET"], |element, record| {
            if element == "conflict" {
                ego = record.text("ego").ok_or("no ego")?;
                all.entry(ego.clone()).or_default().count += 1;
                return Ok(());
            }
            // "NA" where the encounter has no such value.
            let value = record.number("value").ok();
            let conflicts = all.entry(ego.clone()).or_default();
            let (extreme, choose): (_, fn(f64, f64) -> f64) = match element {
                "minTTC" => (&mut conflicts.ttc_min_s, f64::min),
                "maxDRAC" => (&mut conflicts.drac_max_mps2, f64::max),
                _ => (&mut conflicts.pet_min_s, f64::min),
            };
            *extreme = value.map(|value| extreme.map_or(value, |before| choose(before, value))).or(*extreme);
            Ok(())
        })?;
        Ok(all)
    }
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
}
