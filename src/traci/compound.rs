//! The compound answers of the table, as structures. Each is decoded by what its variable is known to send.

use super::error::{BatchError, Error};
use super::typed::{FromValue, Shape, mismatch};
use super::value::{Compound, Layout, Value};
use super::wire::{DecodeError, Reader, put_compound, tag};

/// Takes a compound apart with `read`, which must use up all of it.
fn whole<T>(
    value: Value<'_>,
    read: impl FnOnce(&Compound<'_>, &mut Reader<'_>) -> Result<T, DecodeError>,
) -> Result<T, Error> {
    let Value::Compound(compound) = value else { return mismatch("compound", &value) };
    let mut reader = compound.reader();
    let result = read(&compound, &mut reader)?;
    reader.finish()?;
    Ok(result)
}

/// One typed field of a record.
trait Field: Sized {
    /// Number of its typed items on the wire.
    const ITEMS: usize = 1;

    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError>;
}

impl Field for String {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        reader.typed_text().map(str::to_owned)
    }
}

impl Field for f64 {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let before = *reader;
        reader.typed_f64()?.ok_or(before.error("no value where there must be one"))
    }
}

impl Field for Option<f64> {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        reader.typed_f64()
    }
}

impl Field for i32 {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        reader.typed_i32()
    }
}

impl Field for bool {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Ok(reader.typed_u8()? != 0)
    }
}

impl Field for i8 {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Ok(i8::from_be_bytes([reader.typed_u8()?]))
    }
}

/// A traffic light's state, one ASCII character as a byte.
impl Field for char {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        reader.typed_u8().map(char::from)
    }
}

impl Field for Vec<String> {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let before = *reader;
        match Value::read(reader, Layout::Counted)? {
            Value::Texts(texts) => Ok(texts.map(str::to_owned).collect()),
            _ => Err(before.error("another type than expected")),
        }
    }
}

/// A counted compound inside a compound.
fn counted<T>(
    reader: &mut Reader<'_>,
    mut read: impl FnMut(&mut Reader<'_>) -> Result<T, DecodeError>,
) -> Result<Vec<T>, DecodeError> {
    reader.tag(tag::COMPOUND)?;
    (0..reader.count()?).map(|_| read(reader)).collect()
}

impl Field for Vec<i32> {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        counted(reader, i32::field)
    }
}

/// Structures whose fields come in this order. With `list` SUMO sends many behind a typed count.
macro_rules! records {
    ($($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $field:ident: $type:ty,)+ } $($list:ident)?;)+) => {$(
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $name {
            $($(#[$doc])* pub $field: $type,)+
        }

        impl Field for $name {
            const ITEMS: usize = 0 $(+ <$type as Field>::ITEMS)+;

            fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
                Ok(Self { $($field: Field::field(reader)?,)+ })
            }
        }

        $(records!($list $name);)?
    )+};
    (list $name:ident) => {
        impl FromValue for Vec<$name> {
            const LAYOUT: Layout = Layout::Groups($name::ITEMS);

            fn from_value(value: Value<'_>) -> Result<Self, Error> {
                whole(value, |_, reader| {
                    let count = reader.typed_count()?;
                    (0..count).map(|_| $name::field(reader)).collect()
                })
            }
        }
    };
    (single $name:ident) => {
        impl FromValue for $name {
            fn from_value(value: Value<'_>) -> Result<Self, Error> {
                whole(value, |_, reader| $name::field(reader))
            }
        }
    };
}

records! {
    /// The vehicle ahead or behind.
    Leader {
        /// Its id.
        id: String,
        /// Gap to it without the minimum gap \[m\].
        gap_m: f64,
    };

    /// A traffic light ahead of a vehicle.
    NextTrafficLight {
        /// Its id.
        id: String,
        /// The signal that is for this vehicle.
        index: i32,
        /// Distance to the line \[m\].
        distance_m: f64,
        /// Its state as in SUMO's programs (`r`, `y`, `g`, `G`, ...).
        state: char,
    } list;

    /// A stop ahead, the short form.
    NextStop {
        /// Lane.
        lane: String,
        /// End of the stop on the lane \[m\].
        end_m: f64,
        /// Stopping place, if any.
        place: String,
        /// Stop flags.
        flags: i32,
        /// Duration \[s\].
        duration_s: Option<f64>,
        /// Earliest end \[s\].
        until_s: Option<f64>,
    } list;

    /// A stop in full.
    StopData {
        /// Lane.
        lane: String,
        /// End of the stop on the lane \[m\].
        end_m: f64,
        /// Stopping place, if any.
        place: String,
        /// Stop flags.
        flags: i32,
        /// Duration \[s\].
        duration_s: Option<f64>,
        /// Earliest end \[s\].
        until_s: Option<f64>,
        /// Begin of the stop on the lane \[m\].
        start_m: f64,
        /// Arrival by the schedule \[s\].
        intended_arrival_s: Option<f64>,
        /// Arrival \[s\].
        arrival_s: Option<f64>,
        /// Departure \[s\].
        depart_s: Option<f64>,
        /// Train to split off.
        split: String,
        /// Train to join.
        join: String,
        /// Kind of activity.
        activity: String,
        /// Trip from here on.
        trip: String,
        /// Line from here on.
        line: String,
        /// Speed at which it is passed, if it is a waypoint [m/s].
        speed_mps: f64,
    } list;

    /// A connection from a lane to the next.
    Link {
        /// Lane behind the junction.
        lane: String,
        /// Lane inside the junction.
        via: String,
        /// It has right of way.
        priority: bool,
        /// It can be passed now.
        open: bool,
        /// A vehicle with right of way is coming.
        foe: bool,
        /// State as in SUMO's programs.
        state: String,
        /// Direction (`s`, `l`, `r`, `t`, ...).
        direction: String,
        /// Length inside the junction \[m\].
        length_m: f64,
    } list;

    /// A vehicle whose way crosses at a junction ahead.
    JunctionFoe {
        /// Its id.
        id: String,
        /// Own distance to the crossing point \[m\].
        distance_m: f64,
        /// Its distance to the crossing point \[m\].
        foe_distance_m: f64,
        /// Own distance to leaving the crossing \[m\].
        exit_distance_m: f64,
        /// Its distance to leaving the crossing \[m\].
        foe_exit_distance_m: f64,
        /// Own lane there.
        lane: String,
        /// Its lane there.
        foe_lane: String,
        /// We must yield.
        yields: bool,
        /// It must yield.
        foe_yields: bool,
    } list;

    /// How good a lane of the present edge is for the route.
    BestLane {
        /// The lane.
        lane: String,
        /// Length that can be driven without lane change \[m\].
        length_m: f64,
        /// Vehicles in the way, as length \[m\].
        occupation_m: f64,
        /// Lanes to change to the best lane, left positive.
        offset: i8,
        /// The route goes on from this lane.
        continues: bool,
        /// The lanes driven then.
        next: Vec<String>,
    } list;

    /// A collision.
    Collision {
        /// Vehicle that ran into the other.
        collider: String,
        /// The other.
        victim: String,
        /// Its type.
        collider_type: String,
        /// The type of the other.
        victim_type: String,
        /// Speed of the collider [m/s].
        collider_speed_mps: f64,
        /// Speed of the victim [m/s].
        victim_speed_mps: f64,
        /// Kind of collision.
        kind: String,
        /// Lane.
        lane: String,
        /// Place on the lane \[m\].
        position_m: f64,
    } list;

    /// A route from place to place.
    Stage {
        /// Kind of stage, 3 = driving.
        kind: i32,
        /// Vehicle type.
        vehicle_type: String,
        /// Line.
        line: String,
        /// Stop at its end.
        stop: String,
        /// Edges.
        edges: Vec<String>,
        /// Travel time \[s\].
        travel_time_s: Option<f64>,
        /// Cost as the router sees it.
        cost: Option<f64>,
        /// Length \[m\].
        length_m: Option<f64>,
        /// Intended vehicle.
        intended: String,
        /// Departure \[s\].
        depart_s: Option<f64>,
        /// Begin on the first edge \[m\].
        depart_position_m: Option<f64>,
        /// End on the last edge \[m\].
        arrival_position_m: Option<f64>,
        /// Description.
        description: String,
    } single;
}

impl FromValue for Option<Leader> {
    /// `None`: no vehicle within the distance.
    fn from_value(value: Value<'_>) -> Result<Self, Error> {
        whole(value, |_, reader| Ok((String::field(reader)?, f64::field(reader)?)))
            .map(|(id, gap_m)| if id.is_empty() { None } else { Some(Leader { id, gap_m }) })
    }
}

/// A vehicle on a neighbouring lane.
#[derive(Debug, Clone, PartialEq)]
pub struct Neighbour {
    /// Its id.
    pub id: String,
    /// Gap to it \[m\].
    pub gap_m: f64,
}

impl FromValue for Vec<Neighbour> {
    const LAYOUT: Layout = Layout::Neighbours;

    fn from_value(value: Value<'_>) -> Result<Self, Error> {
        whole(value, |compound, reader| {
            (0..compound.count).map(|_| Ok(Neighbour { id: reader.text()?.to_owned(), gap_m: reader.f64()? })).collect()
        })
    }
}

/// The links that each signal of a traffic light controls: incoming lane, outgoing lane, lane inside the junction.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlledLinks(pub Vec<Vec<Vec<String>>>);

impl FromValue for ControlledLinks {
    const LAYOUT: Layout = Layout::Nested;

    fn from_value(value: Value<'_>) -> Result<Self, Error> {
        whole(value, |_, reader| {
            let signals = reader.typed_count()?;
            let signal = |reader: &mut Reader<'_>| {
                let links = reader.typed_count()?;
                (0..links).map(|_| Field::field(reader)).collect()
            };
            (0..signals).map(|_| signal(reader)).collect::<Result<_, _>>().map(Self)
        })
    }
}

/// A phase of a traffic light.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Duration \[s\].
    pub duration_s: Option<f64>,
    /// One character per signal.
    pub state: String,
    /// Shortest duration of actuated programs \[s\].
    pub shortest_s: Option<f64>,
    /// Longest duration of actuated programs \[s\].
    pub longest_s: Option<f64>,
    /// Phases that may follow; empty means the next one.
    pub next: Vec<i32>,
    /// Name.
    pub name: String,
}

/// A program of a traffic light.
#[derive(Debug, Clone, PartialEq)]
pub struct Logic {
    /// Its id.
    pub program: String,
    /// Kind: 0 static, 3 actuated, ...
    pub kind: i32,
    /// Present phase.
    pub phase: i32,
    /// Its phases.
    pub phases: Vec<Phase>,
    /// Parameters: key, value.
    pub parameters: Vec<Vec<String>>,
}

impl Field for Phase {
    fn field(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        reader.tag(tag::COMPOUND)?;
        reader.count()?;
        Ok(Self {
            duration_s: Field::field(reader)?,
            state: Field::field(reader)?,
            shortest_s: Field::field(reader)?,
            longest_s: Field::field(reader)?,
            next: Field::field(reader)?,
            name: Field::field(reader)?,
        })
    }
}

impl FromValue for Vec<Logic> {
    fn from_value(value: Value<'_>) -> Result<Self, Error> {
        let logic = |reader: &mut Reader<'_>| {
            reader.tag(tag::COMPOUND)?;
            reader.count()?;
            Ok(Logic {
                program: Field::field(reader)?,
                kind: Field::field(reader)?,
                phase: Field::field(reader)?,
                phases: counted(reader, Phase::field)?,
                parameters: counted(reader, Field::field)?,
            })
        };
        whole(value, |compound, reader| (0..compound.count).map(|_| logic(reader)).collect())
    }
}

/// What a new vehicle needs, as SUMO's own words in strings: ids, "now" or seconds, "base", "max", "random", ...
#[derive(Debug, Clone, Copy)]
pub struct NewVehicle<'a> {
    /// Route; must exist.
    pub route: &'a str,
    /// Vehicle type.
    pub vehicle_type: &'a str,
    /// Departure: "now", "triggered" or seconds.
    pub depart: &'a str,
    /// Lane, such as "first", "best" or an index.
    pub depart_lane: &'a str,
    /// Place on the lane, such as "base" or metres.
    pub depart_position: &'a str,
    /// Speed, such as "0", "max" or m/s.
    pub depart_speed: &'a str,
}

impl Default for NewVehicle<'_> {
    fn default() -> Self {
        Self {
            route: "",
            vehicle_type: "DEFAULT_VEHTYPE",
            depart: "now",
            depart_lane: "first",
            depart_position: "base",
            depart_speed: "0",
        }
    }
}

/// [`NewVehicle`] as a type of the table.
#[derive(Debug)]
pub enum AddVehicle {}

impl Shape for AddVehicle {
    type Arg<'a> = NewVehicle<'a>;

    fn put(vehicle: NewVehicle<'_>, out: &mut Vec<u8>) -> Result<(), BatchError> {
        let arrival = ["current", "max", "current", "", "", ""];
        let NewVehicle { route, vehicle_type, depart, depart_lane, depart_position, depart_speed } = vehicle;
        put_compound(out, 14);
        for text in [route, vehicle_type, depart, depart_lane, depart_position, depart_speed].iter().chain(&arrival) {
            String::put(text, out)?;
        }
        i32::put(0, out)?;
        i32::put(0, out)
    }
}
