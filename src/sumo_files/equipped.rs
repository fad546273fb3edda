//! Which vehicles of the demand carry `<param key="has.mfc.device" value="true"/>`.
//!
//! SUMO tells the parameters of a vehicle over TraCI, but not this one: for a device that is not its own it answers "false"
//! whatever the file says. So the demand is read here. (Of vTypes SUMO tells it.)

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::PathBuf;

use super::{error::SumoFileError, include::Files, options::is_true, xml::is_xml};

/// The parameter.
const KEY: &str = "has.mfc.device";

/// What the demand says of each vehicle and flow that it mentions.
#[derive(Debug, Clone, Default)]
pub struct Equipped {
    vehicles: HashMap<String, bool>,
    flows: HashMap<String, bool>,
}

impl Equipped {
    /// Reads files of demand and what they include. Files that are not XML are passed over.
    ///
    /// # Errors
    /// A file that cannot be read, or is not XML as SUMO writes it.
    pub fn read(files: &[PathBuf]) -> Result<Self, SumoFileError> {
        let mut found = Self::default();
        let mut reader = Files::default();
        for file in files {
            if !is_xml(file)? {
                continue;
            }
            let mut carrier: Option<(bool, String)> = None;
            reader.each(file, &mut |_, element| {
                match element.name() {
                    name @ ("vehicle" | "trip" | "flow") => {
                        carrier = element.attribute("id").map(|id| (name == "flow", id));
                    }
                    "param" if ["vehicle", "trip", "flow"].contains(&element.parent) && element.is_param(KEY) => {
                        let yes = element.attribute("value").is_some_and(|v| is_true(&v));
                        if let Some((is_flow, id)) = &carrier {
                            let list = if *is_flow { &mut found.flows } else { &mut found.vehicles };
                            list.insert(id.clone(), yes);
                        }
                    }
                    _ => {}
                }
                ControlFlow::Continue(())
            })?;
        }
        Ok(found)
    }

    /// What the demand says of a vehicle; those of a flow are called `flow.0`, `flow.1` and so on.
    pub fn of(&self, id: &str) -> Option<bool> {
        let of_flow = || {
            let (flow, number) = id.rsplit_once('.')?;
            let counted = !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
            self.flows.get(flow).filter(|_| counted)
        };
        self.vehicles.get(id).or_else(of_flow).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn parameters_are_found_in_compressed_and_in_included_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let outer = "<routes><include href=\"inner.xml\"/>\
             <vehicle id=\"a\"><param key=\"has.mfc.device\" value=\"true\"/></vehicle>\
             <vehicle id=\"b\"><stop><param key=\"has.mfc.device\" value=\"true\"/></stop></vehicle></routes>";
        let mut gz =
            flate2::write::GzEncoder::new(std::fs::File::create(path("a.rou.xml")).unwrap(), Default::default());
        gz.write_all(outer.as_bytes()).unwrap();
        gz.finish().unwrap();
        let inner = "<routes><flow id=\"f\"><param key=\"has.mfc.device\" value=\"no\"/></flow></routes>";
        std::fs::write(path("inner.xml"), inner).unwrap();
        std::fs::write(path("scenario.toml"), "a = \"<&\"").unwrap();

        let found = Equipped::read(&[path("scenario.toml"), path("a.rou.xml")]).unwrap();
        assert_eq!((found.of("a"), found.of("b")), (Some(true), None));
        assert_eq!((found.of("f.12"), found.of("f.x"), found.of("f")), (Some(false), None, None));
    }
}
