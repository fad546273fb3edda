//! Which vehicles of the demand carry `<param key="has.mfc.device" value="true"/>`.
//!
//! SUMO tells the parameters of a vehicle over TraCI, but not this one: for a device that is not its own it answers "false"
//! whatever the file says. So the demand is read here. (Of vTypes SUMO tells it.)

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use quick_xml::{Reader, events::Event};

use super::{configuration::attribute, options::is_true};

/// The parameter.
const KEY: &str = "has.mfc.device";

/// What the demand says of each vehicle and flow that it mentions.
#[derive(Debug, Clone, Default)]
pub struct Equipped {
    vehicles: HashMap<String, bool>,
    flows: HashMap<String, bool>,
}

impl Equipped {
    /// Reads files of demand. What cannot be read counts as silent.
    pub fn read(files: &[PathBuf]) -> Self {
        let mut found = Self::default();
        for file in files {
            // As far as it can be read: SUMO says what is wrong with it.
            let _ = found.read_file(file);
        }
        found
    }

    fn read_file(&mut self, file: &Path) -> Result<(), quick_xml::Error> {
        let mut reader = Reader::from_file(file)?;
        let mut buffer = Vec::new();
        let mut carrier: Option<(bool, String)> = None;
        loop {
            buffer.clear();
            match reader.read_event_into(&mut buffer)? {
                Event::Eof => return Ok(()),
                Event::Start(tag) | Event::Empty(tag) => match tag.name().as_ref() {
                    // The large ones, and there is no demand in them.
                    "net" | "configuration" => return Ok(()),
                    name @ ("vehicle" | "trip" | "flow") => {
                        carrier = attribute(&tag, "id").map(|id| (name == "flow", id))
                    }
                    "vType" | "person" | "container" => carrier = None,
                    "param" if attribute(&tag, "key").as_deref() == Some(KEY) => {
                        let yes = attribute(&tag, "value").is_some_and(|v| is_true(&v));
                        if let Some((is_flow, id)) = &carrier {
                            let list = if *is_flow { &mut self.flows } else { &mut self.vehicles };
                            list.insert(id.clone(), yes);
                        }
                    }
                    _ => {}
                },
                _ => {}
            }
        }
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
