//! The table of variables. Adding one is adding a row.
//!
//! A row reads: name = identifier, `get` what a get brings, `with` the parameter of the get, `set` what a set takes,
//! `as` another identifier for the set, `newer true` if SUMO 1.15 lacks it, one line of doc.

use super::compound::{
    AddVehicle, BestLane, Collision, ControlledLinks, JunctionFoe, Leader, Link, Logic, Neighbour, NextStop,
    NextTrafficLight, Stage, StopData,
};
use super::error::Error;
use super::typed::{Distance, Domain, FromValue, Nothing, OnRoad, Var};
use super::value::{Color, Layout, Value};

/// A row of the table as data.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// What it is a variable of.
    pub domain: Domain,
    /// Name of the constant.
    pub name: &'static str,
    /// Identifier in gets and subscriptions.
    pub id: u8,
    /// Decodes the answer to a get into its type and prints it; `None` if the variable cannot be read.
    pub probe: Option<fn(Value<'_>) -> Result<String, Error>>,
    /// How the compound that a get brings lies in the reply.
    pub(super) layout: Layout,
    /// The parameter of the get, as a type.
    pub parameter: Option<&'static str>,
    /// What a set takes, as a type; `None` if the variable cannot be set.
    pub set: Option<&'static str>,
    /// True if 1.15, the oldest supported SUMO, lacks it; an old SUMO declines it.
    pub newer: bool,
    /// One line about it, with the unit.
    pub doc: &'static str,
}

fn probe<T: FromValue + std::fmt::Debug>(value: Value<'_>) -> Result<String, Error> {
    T::from_value(value).map(|value| format!("{value:?}"))
}

macro_rules! or {
    ($default:ty) => {
        $default
    };
    ($default:ty, $given:ty) => {
        $given
    };
}

macro_rules! option {
    () => {
        None
    };
    ($value:expr) => {
        Some($value)
    };
}

macro_rules! layout {
    () => {
        Layout::Counted
    };
    ($get:ty) => {
        <$get as FromValue>::LAYOUT
    };
}

macro_rules! number {
    ($default:literal) => {
        $default
    };
    ($default:literal $given:literal) => {
        $given
    };
}

macro_rules! table {
    ($($(#[$about:meta])* $module:ident: $domain:ident {
        $($name:ident = $id:literal $(, get $get:ty)? $(, with $with:ty)? $(, set $set:ty)? $(, as $set_id:literal)?
        $(, newer $newer:literal)?; $doc:literal)*
    })*) => {
        $($(#[$about])* pub mod $module {
            use super::*;
            use crate::traci::typed::Never;
            $(
                #[doc = $doc]
                pub const $name: Var<or!(Never $(, $get)?), or!(Never $(, $set)?), or!(() $(, $with)?)> =
                    Var::row(Domain::$domain, $id, number!($id $($set_id)?));
            )*
        })*

        /// Every variable, in the order of the table.
        pub static TABLE: &[Row] = &[$($(Row {
            domain: Domain::$domain,
            name: stringify!($name),
            id: $id,
            probe: option!($(probe::<$get>)?),
            layout: layout!($($get)?),
            parameter: option!($(stringify!($with))?),
            set: option!($(stringify!($set))?),
            newer: number!(false $($newer)?),
            doc: $doc,
        },)*)*];
    };
}

/// By the low four bits of a domain and by variable, how a compound lies in a reply.
static LAYOUTS: [[Layout; 256]; 16] = {
    let mut layouts = [[Layout::Counted; 256]; 16];
    let mut at = 0;
    while at < TABLE.len() {
        let row = &TABLE[at];
        if row.probe.is_some() {
            layouts[row.domain as usize][row.id as usize] = row.layout;
        }
        at += 1;
    }
    layouts
};

/// How a compound of this variable lies. Of `domain`, which may be a command or an answer, the low four bits count.
pub(super) fn layout(domain: u8, variable: u8) -> Layout {
    LAYOUTS[usize::from(domain & 0x0f)][usize::from(variable)]
}

type Texts = Vec<String>;
type Shape = Vec<[f64; 2]>;

table! {
    /// The simulation; the object id is "".
    simulation: Simulation {
        TIME = 0x66, get f64; "Time at the end of the last step [s]."
        STEP_LENGTH = 0x7b, get f64; "Step length [s]; SUMO rounds it to whole milliseconds."
        END = 0x1d, get f64; "Configured end [s], -1 if none; a TraCI server does not stop there."
        LOADED_COUNT = 0x71, get i32; "Vehicles loaded in the last step."
        LOADED = 0x72, get Texts; "Ids of the vehicles loaded in the last step."
        DEPARTED_COUNT = 0x73, get i32; "Vehicles that departed in the last step."
        DEPARTED = 0x74, get Texts; "Ids of the vehicles that departed in the last step; they have not moved yet."
        TELEPORT_START_COUNT = 0x75, get i32; "Vehicles that began to teleport in the last step."
        TELEPORT_START = 0x76, get Texts; "Ids of the vehicles that began to teleport in the last step."
        TELEPORT_END_COUNT = 0x77, get i32; "Vehicles that ended teleporting in the last step."
        TELEPORT_END = 0x78, get Texts; "Ids of the vehicles that ended teleporting in the last step."
        ARRIVED_COUNT = 0x79, get i32; "Vehicles that arrived in the last step."
        ARRIVED = 0x7a, get Texts; "Ids of the vehicles that arrived in the last step."
        EXPECTED = 0x7d, get i32; "Vehicles and persons on the road or still to come; 0 means the demand is served."
        COLLIDING_COUNT = 0x80, get i32; "Vehicles in a collision in the last step."
        COLLIDING = 0x81, get Texts; "Ids of the vehicles in a collision in the last step."
        COLLISIONS = 0x23, get Vec<Collision>; "Details of the collisions of the last step."
        EMERGENCY_STOP_COUNT = 0x89, get i32; "Vehicles that stopped harder than their emergency deceleration."
        EMERGENCY_STOP = 0x8a, get Texts; "Ids of the vehicles that stopped harder than their emergency deceleration."
        STOP_START_COUNT = 0x68, get i32; "Vehicles that began to stop in the last step."
        STOP_START = 0x69, get Texts; "Ids of the vehicles that began to stop in the last step."
        STOP_END_COUNT = 0x6a, get i32; "Vehicles that ended a stop in the last step."
        STOP_END = 0x6b, get Texts; "Ids of the vehicles that ended a stop in the last step."
        PARKING_START_COUNT = 0x6c, get i32; "Vehicles that began to park in the last step."
        PARKING_START = 0x6d, get Texts; "Ids of the vehicles that began to park in the last step."
        PARKING_END_COUNT = 0x6e, get i32; "Vehicles that ended parking in the last step."
        PARKING_END = 0x6f, get Texts; "Ids of the vehicles that ended parking in the last step."
        BUS_STOP_WAITING = 0x67, get i32; "Persons waiting at the bus stop given as object id."
        BOUNDING_BOX = 0x7c, get Shape; "Lower left and upper right corner of the network [m]."
        SCALE = 0x8e, get f64, set f64; "Factor on the demand."
        PENDING = 0x94, get Texts; "Ids of the vehicles waiting to be inserted."
        OPTION = 0x32, get String; "The value of the SUMO option given as object id."
        PARAMETER = 0x7e, get String, with String, set (String, String); "A generic parameter by its key."
        DISTANCE = 0x83, get f64, with (OnRoad, OnRoad, Distance); "Distance of two places [m]."
        TO_PLANE = 0x82, get [f64; 2], with (OnRoad, u8); "A place on a road as x, y [m]; the last item is 1."
        FIND_ROUTE = 0x86, get Stage, with (String, String, String, f64, i32); "Fastest route: from edge, to edge, type, departure [s], routing mode."
        CLEAR_PENDING = 0x94, set String; "Discards vehicles not yet inserted, of one route or (\"\") of all."
        MESSAGE = 0x65, set String, newer true; "Writes a message into SUMO's log."
    }
    /// Vehicles.
    vehicle: Vehicle {
        IDS = 0x00, get Texts; "Ids of all vehicles on the road (object id \"\")."
        COUNT = 0x01, get i32; "Number of vehicles on the road (object id \"\")."
        LOADED = 0x24, get Texts, newer true; "Ids of all vehicles loaded, also those not departed (object id \"\")."
        TELEPORTING = 0x25, get Texts, newer true; "Ids of the vehicles teleporting (object id \"\")."
        SPEED = 0x40, get f64, set f64; "Speed of the last step [m/s]; set: drive so from now on, negative releases."
        PREVIOUS_SPEED = 0x3c, set (f64, f64); "Speed [m/s] and acceleration [m/s²] from which SUMO plans the next step."
        SPEED_WITHOUT_TRACI = 0xb1, get f64; "Speed without the last override [m/s]; bounded by a `setSpeed`, so no target."
        ACCELERATION = 0x72, get f64, set (f64, f64); "Acceleration [m/s²]; set: acceleration and duration [s]."
        SLOW_DOWN = 0x14, set (f64, f64); "Goes to a speed [m/s] within a duration [s]."
        SPEED_MODE = 0xb3, get i32, set i32; "Which checks `setSpeed` respects, bit by bit; 31 is the default."
        ALLOWED_SPEED = 0xb7, get f64; "Limit for this vehicle [m/s]: lane limit times speed factor, at most its top speed."
        MAX_SPEED = 0x41, get f64, set f64; "Top speed [m/s]."
        SPEED_FACTOR = 0x5e, get f64, set f64; "Factor on lane limits; setting accel or decel afterwards may undo it."
        SPEED_DEVIATION = 0x5f, get f64; "Standard deviation of the speed factor of its type."
        LATERAL_SPEED = 0x32, get f64; "Lateral speed [m/s]; 0 unless lane changes take time."
        POSITION = 0x42, get [f64; 2]; "Middle of the front bumper x, y [m]."
        POSITION_3D = 0x39, get [f64; 3]; "Middle of the front bumper x, y, z [m]."
        ANGLE = 0x43, get f64; "Heading [°], 0 = north, clockwise; a chord from front to rear."
        SLOPE = 0x36, get f64; "Slope [°], uphill positive."
        ROAD = 0x50, get String; "Edge; empty while parking or teleporting, internal ones begin with a colon."
        LANE = 0x51, get String; "Lane."
        LANE_INDEX = 0x52, get i32; "Lane index, 0 is the outermost."
        LANE_POSITION = 0x56, get f64; "Front on the lane [m], along its length in space."
        LATERAL_POSITION = 0xb8, get f64; "Offset from the middle of the lane [m], left positive."
        SHIFT = 0xb8, set f64, newer true; "Puts the vehicle at this offset from the middle of the lane [m], left positive."
        DISTANCE = 0x84, get f64; "Distance driven since departure [m]."
        DRIVING_DISTANCE = 0x83, get f64, with (OnRoad, Distance); "Distance along the route to a place [m]."
        TYPE = 0x4f, get String, set String; "Vehicle type."
        CLASS = 0x49, get String, set String; "Vehicle class, such as passenger or bus."
        SHAPE_CLASS = 0x4b, get String, set String; "Shape for drawing."
        EMISSION_CLASS = 0x4a, get String, set String; "Emission class."
        COLOR = 0x45, get Color, set Color; "Colour."
        LENGTH = 0x44, get f64, set f64; "Length [m]."
        WIDTH = 0x4d, get f64, set f64; "Width [m]."
        HEIGHT = 0xbc, get f64, set f64; "Height [m]."
        MASS = 0xc8, get f64, set f64, newer true; "Mass [kg]."
        MIN_GAP = 0x4c, get f64, set f64; "Gap to the leader at standstill [m]."
        LATERAL_MIN_GAP = 0xbb, get f64, set f64; "Lateral gap at 50 km/h [m] (sublane model)."
        MAX_LATERAL_SPEED = 0xba, get f64, set f64; "Top lateral speed [m/s] (sublane model)."
        LATERAL_ALIGNMENT = 0xb9, get String, set String; "Preferred place across the lane (sublane model)."
        ACCEL = 0x46, get f64, set f64; "Largest acceleration of the car-following model [m/s²]."
        DECEL = 0x47, get f64, set f64; "Comfortable deceleration [m/s²], positive."
        EMERGENCY_DECEL = 0x7b, get f64, set f64; "Hardest deceleration [m/s²], positive."
        APPARENT_DECEL = 0x7c, get f64, set f64; "Deceleration that others expect [m/s²], positive."
        IMPERFECTION = 0x5d, get f64, set f64; "Driver imperfection sigma, 0 to 1."
        TAU = 0x48, get f64, set f64; "Desired time headway [s]."
        ACTION_STEP_LENGTH = 0x7d, get f64, set f64; "Time between decisions [s]."
        LAST_ACTION_TIME = 0x7f, get f64; "Time of the last decision [s]."
        DEPARTURE = 0x3a, get f64, newer true; "Time of departure [s]."
        DEPART_DELAY = 0x3b, get f64, newer true; "Time waited for insertion [s]."
        ROUTE_ID = 0x53, get String, set String; "Route."
        ROUTE_INDEX = 0x69, get i32; "Place of the present edge in the route."
        ROUTE = 0x54, get Texts, set Texts, as 0x57; "Edges of the route; set: begins with the present edge."
        ROUTE_VALID = 0x92, get bool; "The route is connected."
        CHANGE_TARGET = 0x31, set String; "Goes to another edge on the fastest way."
        REROUTE = 0x90, set Nothing; "Looks for the fastest route again."
        ROUTING_MODE = 0x89, get i32, set i32; "Which travel times rerouting uses."
        VIA = 0xbe, get Texts, set Texts; "Edges that rerouting must pass."
        LINE = 0xbd, get String, set String; "Line name of public transport."
        SIGNALS = 0x5b, get i32, set i32; "Lights: indicators, brake, and so on, bit by bit."
        LANE_CHANGE_MODE = 0xb6, get i32, set i32; "Which lane changes SUMO may make, bit by bit."
        CHANGE_LANE = 0x13, set (i8, f64); "Changes to a lane index for a duration [s]."
        CHANGE_SUBLANE = 0x15, set f64; "Shifts sideways by a distance [m], left positive (sublane model)."
        MOVE_TO = 0x5c, set (String, f64); "Puts the front on a lane at a position [m]."
        STOP = 0x12, set (String, f64, i8, f64, i8, f64, f64); "Stops: edge, end [m], lane, duration [s], flags, start [m], until [s]."
        RESUME = 0x19, set Nothing; "Ends a stop."
        STOP_STATE = 0xb5, get i32; "Bits: 1 stopped, 2 parking, 4 triggered, and so on."
        NEXT_STOPS = 0x73, get Vec<NextStop>; "Stops ahead, short form."
        STOPS = 0x74, get Vec<StopData>, with i32; "So many stops in full (0 = all); negative counts past ones."
        LEADER = 0x68, get Option<Leader>, with f64; "Vehicle ahead within a distance [m], 0 = own brake gap."
        FOLLOWER = 0x78, get Option<Leader>, with f64; "Vehicle behind within a distance [m], 0 = its brake gap."
        NEIGHBORS = 0xbf, get Vec<Neighbour>, with u8; "Vehicles on the neighbouring lanes; bits: 1 right, 2 ahead, 4 only blocking."
        NEXT_LIGHTS = 0x70, get Vec<NextTrafficLight>; "Traffic lights ahead."
        NEXT_LINKS = 0x33, get Vec<Link>, newer true; "Connections ahead on the route."
        FOES = 0x37, get Vec<JunctionFoe>, with f64, newer true; "Vehicles in the way at junctions within a distance [m]."
        BEST_LANES = 0xb2, get Vec<BestLane>; "How good the lanes of the present edge are for the route."
        FOLLOW_SPEED = 0x1c, get f64, with (f64, f64, f64, f64, String); "Safe speed [m/s]: speed, gap, leader's speed, decel, id."
        STOP_SPEED = 0x1d, get f64, with (f64, f64); "Speed to stop within a gap [m/s]: speed, gap."
        SECURE_GAP = 0x1e, get f64, with (f64, f64, f64, String); "Gap needed [m]: speed, leader's speed, decel, id."
        WAITING_TIME = 0x7a, get f64; "Time since it last moved [s]."
        ACCUMULATED_WAITING_TIME = 0x87, get f64; "Time stood still in the last while [s]."
        TIME_LOSS = 0x8c, get f64; "Time lost against driving at the allowed speed [s]."
        CO2 = 0x60, get f64; "CO2 of the last step [mg/s]."
        CO = 0x61, get f64; "CO of the last step [mg/s]."
        HC = 0x62, get f64; "Hydrocarbons of the last step [mg/s]."
        PMX = 0x63, get f64; "Particles of the last step [mg/s]."
        NOX = 0x64, get f64; "NOx of the last step [mg/s]."
        FUEL = 0x65, get f64; "Fuel of the last step [mg/s]."
        NOISE = 0x66, get f64; "Noise of the last step [dB]."
        ELECTRICITY = 0x71, get f64; "Electric energy of the last step [Wh/s]."
        PERSONS = 0x67, get i32; "Persons inside."
        PERSON_CAPACITY = 0x38, get i32; "Persons it can carry."
        ADD = 0x85, set AddVehicle; "Adds a vehicle under this id."
        REMOVE = 0x81, set i8; "Takes it out: 2 = as if arrived, 3 = vaporised; it is not listed as arrived."
        PARAMETER = 0x7e, get String, with String, set (String, String); "Generic parameter by its key, such as has.mfc.device."
    }
    /// Vehicle types.
    vehicletype: VehicleType {
        IDS = 0x00, get Texts; "Ids of all types (object id \"\")."
        COUNT = 0x01, get i32; "Number of types (object id \"\")."
        LENGTH = 0x44, get f64, set f64; "Length [m]."
        WIDTH = 0x4d, get f64, set f64; "Width [m]."
        HEIGHT = 0xbc, get f64, set f64; "Height [m]."
        MASS = 0xc8, get f64, set f64, newer true; "Mass [kg]."
        MAX_SPEED = 0x41, get f64, set f64; "Top speed [m/s]."
        SPEED_FACTOR = 0x5e, get f64, set f64; "Mean factor on lane limits."
        SPEED_DEVIATION = 0x5f, get f64, set f64; "Standard deviation of the speed factor."
        ACCEL = 0x46, get f64, set f64; "Largest acceleration of the car-following model [m/s²]."
        DECEL = 0x47, get f64, set f64; "Comfortable deceleration [m/s²], positive."
        EMERGENCY_DECEL = 0x7b, get f64, set f64; "Hardest deceleration [m/s²], positive."
        APPARENT_DECEL = 0x7c, get f64, set f64; "Deceleration that others expect [m/s²], positive."
        IMPERFECTION = 0x5d, get f64, set f64; "Driver imperfection sigma, 0 to 1."
        IMPATIENCE = 0x26, get f64, set f64, newer true; "Impatience, 0 to 1."
        TAU = 0x48, get f64, set f64; "Desired time headway [s]."
        MIN_GAP = 0x4c, get f64, set f64; "Gap to the leader at standstill [m]."
        LATERAL_MIN_GAP = 0xbb, get f64, set f64; "Lateral gap at 50 km/h [m]."
        MAX_LATERAL_SPEED = 0xba, get f64, set f64; "Top lateral speed [m/s]."
        LATERAL_ALIGNMENT = 0xb9, get String, set String; "Preferred place across the lane."
        ACTION_STEP_LENGTH = 0x7d, get f64, set f64; "Time between decisions [s]."
        CLASS = 0x49, get String, set String; "Vehicle class, such as passenger or bus."
        EMISSION_CLASS = 0x4a, get String, set String; "Emission class."
        SHAPE_CLASS = 0x4b, get String, set String; "Shape for drawing."
        COLOR = 0x45, get Color, set Color; "Colour."
        PERSON_CAPACITY = 0x38, get i32; "Persons it can carry."
        SCALE = 0x8e, get f64, set f64; "Factor on the demand of this type."
        COPY = 0x88, set String; "Makes a copy under another id."
        PARAMETER = 0x7e, get String, with String, set (String, String); "Generic parameter by its key."
    }
    /// Routes.
    route: Route {
        IDS = 0x00, get Texts; "Ids of all routes (object id \"\")."
        COUNT = 0x01, get i32; "Number of routes (object id \"\")."
        EDGES = 0x54, get Texts; "Edges."
        ADD = 0x80, set Texts; "Adds a route of these edges under this id."
        REMOVE = 0x81, set (), newer true; "Removes an unused route."
        PARAMETER = 0x7e, get String, with String, set (String, String); "Generic parameter by its key."
    }
    /// Edges.
    edge: Edge {
        IDS = 0x00, get Texts; "Ids of all edges, internal ones included (object id \"\")."
        COUNT = 0x01, get i32; "Number of edges (object id \"\")."
        LANE_COUNT = 0x52, get i32; "Number of lanes."
        NAME = 0x1b, get String; "Street name."
        MEAN_SPEED = 0x11, get f64; "Mean speed of the vehicles of the last step [m/s]; the limit if there are none."
        OCCUPANCY = 0x13, get f64; "Share covered by vehicles."
        MEAN_LENGTH = 0x15, get f64; "Mean length of the vehicles [m]."
        VEHICLE_COUNT = 0x10, get i32; "Vehicles on it."
        HALTING_COUNT = 0x14, get i32; "Vehicles slower than 0.1 m/s."
        VEHICLES = 0x12, get Texts; "Ids of the vehicles on it."
        PERSONS = 0x1a, get Texts; "Ids of the persons on it."
        PENDING = 0x94, get Texts; "Ids of the vehicles waiting to be inserted on it."
        WAITING_TIME = 0x7a, get f64; "Sum of the waiting times of its vehicles [s]."
        CURRENT_TRAVEL_TIME = 0x5a, get f64; "Travel time at the present mean speed [s]."
        TRAVEL_TIME = 0x58, get f64, with f64; "Travel time that rerouting assumes at a time [s], negative if none is set [s]."
        EFFORT = 0x59, get f64, with f64; "Effort that rerouting assumes at a time [s], negative if none is set."
        ADAPT_TRAVEL_TIME = 0x58, set (f64,); "Travel time for rerouting [s]."
        ADAPT_EFFORT = 0x59, set (f64,); "Effort for rerouting."
        ANGLE = 0x43, get f64, with f64, newer true; "Heading at a place [°]; place from the start [m], or the sentinel for the whole."
        FROM_JUNCTION = 0x7b, get String, newer true; "Junction at its start."
        TO_JUNCTION = 0x7c, get String, newer true; "Junction at its end."
        CO2 = 0x60, get f64; "CO2 of the last step [mg/s]."
        CO = 0x61, get f64; "CO of the last step [mg/s]."
        HC = 0x62, get f64; "Hydrocarbons of the last step [mg/s]."
        PMX = 0x63, get f64; "Particles of the last step [mg/s]."
        NOX = 0x64, get f64; "NOx of the last step [mg/s]."
        FUEL = 0x65, get f64; "Fuel of the last step [mg/s]."
        NOISE = 0x66, get f64; "Noise of the last step [dB]."
        ELECTRICITY = 0x71, get f64; "Electric energy of the last step [Wh/s]."
        MAX_SPEED = 0x41, set f64; "Limit on all its lanes [m/s]."
        ALLOWED = 0x34, set Texts, newer true; "Vehicle classes that may drive on all its lanes."
        DISALLOWED = 0x35, set Texts, newer true; "Vehicle classes that may not."
        PARAMETER = 0x7e, get String, with String, set (String, String); "Generic parameter by its key."
    }
    /// Lanes.
    lane: Lane {
        IDS = 0x00, get Texts; "Ids of all lanes, internal ones included (object id \"\")."
        COUNT = 0x01, get i32; "Number of lanes (object id \"\")."
        LENGTH = 0x44, get f64, set f64; "Length [m]; that of the shape may differ."
        WIDTH = 0x4d, get f64; "Width [m]."
        FRICTION = 0x3d, get f64; "Friction [-]; SUMO takes none (1.15 to 1.28)."
        MAX_SPEED = 0x41, get f64, set f64; "Limit [m/s]."
        SHAPE = 0x4e, get Shape; "Middle line x, y [m]."
        EDGE = 0x31, get String; "Its edge."
        LINK_COUNT = 0x30, get i32; "Connections to the next lanes."
        LINKS = 0x33, get Vec<Link>; "Connections to the next lanes."
        ALLOWED = 0x34, get Texts, set Texts; "Vehicle classes that may drive here; empty means all."
        DISALLOWED = 0x35, get Texts, set Texts; "Vehicle classes that may not."
        FOES = 0x37, get Texts, with String; "Lanes whose traffic conflicts with that to the lane given."
        MEAN_SPEED = 0x11, get f64; "Mean speed of the vehicles of the last step [m/s]; the limit if there are none."
        OCCUPANCY = 0x13, get f64; "Share covered by vehicles."
        MEAN_LENGTH = 0x15, get f64; "Mean length of the vehicles [m]."
        VEHICLE_COUNT = 0x10, get i32; "Vehicles on it."
        HALTING_COUNT = 0x14, get i32; "Vehicles slower than 0.1 m/s."
        VEHICLES = 0x12, get Texts; "Ids of the vehicles on it."
        PENDING = 0x94, get Texts; "Ids of the vehicles waiting to be inserted on it."
        WAITING_TIME = 0x7a, get f64; "Sum of the waiting times of its vehicles [s]."
        CURRENT_TRAVEL_TIME = 0x5a, get f64; "Travel time at the present mean speed [s]."
        ANGLE = 0x43, get f64, with f64, newer true; "Heading at a place [°]; place from the start [m]."
        CO2 = 0x60, get f64; "CO2 of the last step [mg/s]."
        CO = 0x61, get f64; "CO of the last step [mg/s]."
        HC = 0x62, get f64; "Hydrocarbons of the last step [mg/s]."
        PMX = 0x63, get f64; "Particles of the last step [mg/s]."
        NOX = 0x64, get f64; "NOx of the last step [mg/s]."
        FUEL = 0x65, get f64; "Fuel of the last step [mg/s]."
        NOISE = 0x66, get f64; "Noise of the last step [dB]."
        ELECTRICITY = 0x71, get f64; "Electric energy of the last step [Wh/s]."
        PARAMETER = 0x7e, get String, with String, set (String, String); "Generic parameter by its key."
    }
    /// Junctions.
    junction: Junction {
        IDS = 0x00, get Texts; "Ids of all junctions (object id \"\")."
        COUNT = 0x01, get i32; "Number of junctions (object id \"\")."
        POSITION = 0x42, get [f64; 2]; "Place x, y [m]."
        POSITION_3D = 0x39, get [f64; 3]; "Place x, y, z [m]."
        SHAPE = 0x4e, get Shape; "Outline x, y [m]."
        INCOMING = 0x7b, get Texts, newer true; "Edges that lead to it."
        OUTGOING = 0x7c, get Texts, newer true; "Edges that leave it."
        PARAMETER = 0x7e, get String, with String, set (String, String); "Generic parameter by its key."
    }
    /// Traffic lights.
    trafficlight: TrafficLight {
        IDS = 0x00, get Texts; "Ids of all traffic lights (object id \"\")."
        COUNT = 0x01, get i32; "Number of traffic lights (object id \"\")."
        STATE = 0x20, get String, set String; "One character per signal: r, y, g, G, and so on."
        PROGRAM = 0x29, get String, set String, as 0x23; "Program."
        PHASE = 0x28, get i32, set i32, as 0x22; "Phase."
        PHASE_NAME = 0x1b, get String, set String; "Name of the phase."
        PHASE_DURATION = 0x24, get f64, set f64; "Length of the phase [s]; set: what is left of it."
        NEXT_SWITCH = 0x2d, get f64; "Time of the next change of phase [s]."
        SPENT_DURATION = 0x38, get f64, newer true; "Time already spent in the phase [s]."
        CONTROLLED_LANES = 0x26, get Texts; "Incoming lane of each signal."
        CONTROLLED_LINKS = 0x27, get ControlledLinks; "Links of each signal."
        PROGRAMS = 0x2b, get Vec<Logic>; "All its programs."
        BLOCKING = 0x25, get Texts, with i32; "Vehicles that block the next section of a signal (rail)."
        RIVALS = 0x30, get Texts, with i32; "Vehicles that compete for the next section of a signal (rail)."
        PRIORITY = 0x31, get Texts, with i32; "Vehicles with priority over a signal (rail)."
        PARAMETER = 0x7e, get String, with String, set (String, String); "Generic parameter by its key."
    }
}
