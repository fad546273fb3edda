//! A small traffic world in memory: cars that follow each other on straight lanes, behind the same seam as SUMO.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use sumo_mfc::cosim::{CosimError, Events, Gets, Joined, NoAnswer, Object, Question, Sumo, Tell, With};
use sumo_mfc::traci::{Color, Domain, Error, Leader, Value, lane, vehicle, vehicletype};

/// Length of a step [s].
pub const STEP_S: f64 = 0.1;
/// The limit of every lane [m/s].
pub const LIMIT_MPS: f64 = 20.0;
/// The friction of every lane.
pub const FRICTION: f64 = 0.2;
const LENGTH_M: f64 = 5.0;
const MIN_GAP_M: f64 = 2.5;
/// The decision interval of a car of the type `ponderer` [s].
const PONDERED_S: f64 = 1.0;
const ACCEL_MPS2: f64 = 2.6;
const DECEL_MPS2: f64 = 4.5;
const SPEED_MODE: i32 = 31;
const IMPERFECTION: f64 = 0.5;
/// The lanes of [`Fake::ahead`].
const AHEAD: &str = "ahead_0";
/// All others.
const BEHIND: &str = "road_0";
/// The colour of a car that nobody has coloured.
pub const YELLOW: Color = Color { red: 255, green: 255, blue: 0, alpha: 255 };

/// A car, with what is going to happen to it.
#[derive(Debug, Clone)]
pub struct Car {
    pub id: String,
    pub type_id: String,
    /// Cars of other lanes do not matter.
    pub lane: usize,
    /// The step at whose end it departs; 0 = it is there at the beginning.
    pub departs: u64,
    pub speed_mps: f64,
    pub position_m: f64,
    /// Where it arrives [m].
    pub arrives_at_m: f64,
    /// The steps at whose ends a teleport begins and ends.
    pub teleport: Option<(u64, u64)>,
    /// The step in which it arrives, wherever it is.
    pub arrives_carried: Option<u64>,
    /// The step in which somebody takes it out.
    pub removed: Option<u64>,
    /// Its fastest speed [m/s]: a car that is not an ego can be slow.
    pub speed_max_mps: f64,
    pub speed_factor: f64,
    /// Nobody says that its teleport begins: somebody has taken it off the road.
    pub silently: bool,
    /// The steps at whose ends a planned stop begins and ends.
    pub stop: Option<(u64, u64)>,
    /// By how much its road bends to the left [degrees/m].
    pub bend_deg_per_m: f64,
    /// `<param key=".." value=".."/>`
    pub parameters: Vec<(&'static str, &'static str)>,
}

impl Car {
    /// A car of the type `car` on a lane of its own, which departs at rest in a step.
    pub fn new(id: &str, lane: usize, departs: u64) -> Self {
        Self {
            id: id.to_owned(),
            type_id: "car".to_owned(),
            lane,
            departs,
            speed_mps: 0.0,
            position_m: 0.0,
            arrives_at_m: 1e9,
            teleport: None,
            arrives_carried: None,
            removed: None,
            speed_max_mps: 60.0,
            speed_factor: 1.0,
            silently: false,
            stop: None,
            bend_deg_per_m: 0.0,
            parameters: Vec::new(),
        }
    }
}

/// A car on the road.
struct Driver {
    car: Car,
    odometer_m: f64,
    carried: bool,
    command_mps: Option<f64>,
    accel_mps2: f64,
    decel_mps2: f64,
    speed_factor: f64,
    speed_mode: i32,
    imperfection: f64,
    headway_s: f64,
    colour: Color,
}

/// The world.
#[derive(Default)]
pub struct Fake {
    /// Cars that have not departed.
    pub demand: Vec<Car>,
    /// Pairs that collide, by step.
    pub collisions: BTreeMap<u64, Vec<[&'static str; 2]>>,
    /// Tells act with the next step, not at once: as a shared SUMO is told.
    pub shared: bool,
    /// All that it was told.
    pub told: Vec<(Arc<str>, Tell)>,
    /// Vehicles watched now.
    pub watched: Vec<Arc<str>>,
    /// The step in which the connection is lost.
    pub lost_in: Option<u64>,
    /// From here on every lane is called `ahead_0`, and has another limit [m, m/s].
    pub ahead: Option<(f64, f64)>,
    /// The time at which we come [s].
    pub begins_s: f64,
    /// Between these places a car is on no lane [m].
    pub nowhere: Option<(f64, f64)>,
    /// Cars drive the whole step at the speed of its end.
    pub euler: bool,
    /// Questions that were asked, and those that were answered, one by one.
    pub asked: usize,
    pub answered: usize,
    /// Questions about lanes among them.
    pub lanes_asked: usize,
    /// How often what was told was handed over before the next step.
    pub handed_over: usize,
    waiting: Vec<(Arc<str>, Tell)>,
    road: BTreeMap<String, Driver>,
    step: u64,
}

impl Fake {
    /// A world with this demand.
    pub fn new(demand: impl IntoIterator<Item = Car>) -> Self {
        Self { demand: demand.into_iter().collect(), ..Self::default() }
    }

    /// The last speed, or anything else, that a vehicle was told.
    pub fn told_to(&self, id: &str) -> Vec<Tell> {
        self.told.iter().filter(|(who, _)| **who == *id).map(|(_, what)| *what).collect()
    }

    /// The gap of a vehicle to the one ahead, beyond minGap [m].
    pub fn gap_m(&self, id: &str) -> f64 {
        self.leader_of(&self.road[id].car, f64::INFINITY).map_or(f64::INFINITY, |leader| leader.gap_m)
    }

    fn act(&mut self, id: &str, what: Tell) {
        let Some(driver) = self.road.get_mut(id) else { return };
        match what {
            Tell::PreviousSpeed(speed_mps, _) => driver.car.speed_mps = speed_mps,
            Tell::Speed(speed_mps) => driver.command_mps = Some(speed_mps),
            Tell::ReleaseSpeed => driver.command_mps = None,
            Tell::Headway(headway_s) => driver.headway_s = headway_s,
            Tell::Imperfection(sigma) => driver.imperfection = sigma,
            Tell::Accel(accel_mps2) => driver.accel_mps2 = accel_mps2,
            Tell::Decel(decel_mps2) => driver.decel_mps2 = decel_mps2,
            Tell::SpeedFactor(factor) => driver.speed_factor = factor,
            Tell::SpeedMode(mode) => driver.speed_mode = mode,
            Tell::Colour(colour) => driver.colour = colour,
            Tell::Parameter(..) => {}
        }
    }

    /// The speed that a driver chooses: as fast as accel, limit and command allow, and slow enough to stop behind the
    /// car ahead if that brakes.
    fn choice_mps(&self, driver: &Driver) -> f64 {
        let Driver { car, accel_mps2, speed_factor, command_mps, .. } = driver;
        let ahead =
            self.road.values().filter(|d| d.car.lane == car.lane && d.car.position_m > car.position_m && !d.carried);
        let ahead = ahead.min_by(|a, b| a.car.position_m.total_cmp(&b.car.position_m));
        let safe_mps = ahead.map_or(f64::INFINITY, |leader| {
            let gap_m = (leader.car.position_m - LENGTH_M - car.position_m - MIN_GAP_M).max(0.0);
            let brake_mps = DECEL_MPS2 * STEP_S;
            (brake_mps * brake_mps + leader.car.speed_mps.powi(2) + 2.0 * DECEL_MPS2 * gap_m).sqrt() - brake_mps
        });
        if car.stop.is_some_and(|(begins, ends)| (begins..ends).contains(&self.step)) {
            return 0.0;
        }
        let fastest_mps =
            (self.limit_mps(car) * speed_factor).min(car.speed_max_mps).min(car.speed_mps + accel_mps2 * STEP_S);
        command_mps.unwrap_or(f64::INFINITY).min(fastest_mps).min(safe_mps).max(0.0)
    }

    fn is_ahead(&self, car: &Car) -> bool {
        self.ahead.is_some_and(|(from_m, _)| car.position_m >= from_m)
    }

    fn limit_mps(&self, car: &Car) -> f64 {
        self.ahead.filter(|_| self.is_ahead(car)).map_or(LIMIT_MPS, |(_, limit_mps)| limit_mps)
    }

    /// Who is ahead, and the gap beyond minGap [m].
    fn leader_of(&self, car: &Car, within_m: f64) -> Option<Leader> {
        let ahead = self.road.values().map(|d| &d.car).filter(|d| d.lane == car.lane && d.position_m > car.position_m);
        let ahead = ahead.min_by(|a, b| a.position_m.total_cmp(&b.position_m))?;
        let gap_m = ahead.position_m - LENGTH_M - car.position_m - MIN_GAP_M;
        (gap_m < within_m).then(|| Leader { id: ahead.id.clone(), gap_m })
    }

    fn drive(&mut self) {
        let choices_mps: Vec<f64> = self.road.values().map(|driver| self.choice_mps(driver)).collect();
        for (driver, next_mps) in self.road.values_mut().zip(choices_mps).filter(|(driver, _)| !driver.carried) {
            let mean_mps = if self.euler { next_mps } else { 0.5 * (driver.car.speed_mps + next_mps) };
            let way_m = mean_mps * STEP_S;
            driver.car.position_m += way_m;
            driver.odometer_m += way_m;
            driver.car.speed_mps = next_mps;
        }
    }

    /// Cars that depart in this step, in the order of the demand.
    fn depart(&mut self) -> Vec<String> {
        let step = self.step;
        let (now, later) = std::mem::take(&mut self.demand).into_iter().partition(|car| car.departs == step);
        self.demand = later;
        let now: Vec<Car> = now;
        let ids = now.iter().map(|car| car.id.clone()).collect();
        for car in now {
            let driver = Driver {
                odometer_m: 0.0,
                carried: car.teleport.is_some_and(|(begins, _)| begins == step),
                command_mps: None,
                accel_mps2: ACCEL_MPS2,
                decel_mps2: DECEL_MPS2,
                speed_factor: car.speed_factor,
                speed_mode: SPEED_MODE,
                imperfection: IMPERFECTION,
                headway_s: 1.0,
                colour: YELLOW,
                car,
            };
            self.road.insert(driver.car.id.clone(), driver);
        }
        ids
    }
}

impl Sumo for Fake {
    type Step = Events;
    type Asked<Q: Question> = Vec<(Arc<str>, Q)>;

    async fn join(&mut self) -> Result<Joined, CosimError> {
        let mut present = self.depart();
        present.retain(|id| !self.road[id].carried);
        Ok(Joined { step_s: STEP_S, time_s: self.begins_s, expected: 1, present, tells_mass: true })
    }

    async fn option(&mut self, _: &str) -> Result<Option<String>, CosimError> {
        Ok(None)
    }

    async fn end_s(&mut self) -> Result<f64, CosimError> {
        Ok(-1.0)
    }

    fn tell(&mut self, vehicle: &Object, what: Tell) -> Result<(), CosimError> {
        self.told.push((vehicle.id.clone(), what));
        if self.shared {
            self.waiting.push((vehicle.id.clone(), what));
        } else {
            self.act(&vehicle.id, what);
        }
        Ok(())
    }

    fn watch<Q: Question>(&mut self, vehicle: &Object, _: &Q) -> Result<(), CosimError> {
        self.watched.push(vehicle.id.clone());
        Ok(())
    }

    fn unwatch(&mut self, vehicle: &Object) -> Result<(), CosimError> {
        self.watched.retain(|id| *id != vehicle.id);
        Ok(())
    }

    async fn hand_over(&mut self) -> Result<(), CosimError> {
        self.handed_over += 1;
        Ok(())
    }

    async fn step(&mut self) -> Result<Events, CosimError> {
        for (id, what) in std::mem::take(&mut self.waiting) {
            self.act(&id, what);
        }
        self.step += 1;
        let step = self.step;
        self.drive();
        self.road.retain(|_, driver| driver.car.removed != Some(step));
        let departed = self.depart();
        let mut events =
            Events { time_s: self.begins_s + step as f64 * STEP_S, expected: 1, departed, ..Events::default() };
        for (id, driver) in &mut self.road {
            if let Some((begins, ends)) = driver.car.teleport {
                if begins == step && !driver.car.silently {
                    events.teleported.push(id.clone());
                }
                driver.carried = (begins..ends).contains(&step);
                if ends == step {
                    driver.car.position_m += 100.0;
                    driver.odometer_m += 100.0;
                    driver.car.speed_mps = 3.0;
                    if begins == 0 {
                        events.found.push(id.clone());
                    }
                }
            }
            if driver.car.position_m >= driver.car.arrives_at_m || driver.car.arrives_carried == Some(step) {
                events.arrived.push(id.clone());
            }
        }
        self.road.retain(|id, _| !events.arrived.contains(id));
        let pairs = self.collisions.get(&step).into_iter().flatten();
        events.collisions = pairs.map(|pair| pair.map(str::to_owned)).collect();
        events.colliding = !events.collisions.is_empty();
        Ok(events)
    }

    async fn events(&mut self, step: Events, events: &mut Events) -> Result<(), CosimError> {
        if self.lost_in == Some(self.step) {
            return Err(Error::Disconnected(std::io::ErrorKind::ConnectionReset.into()).into());
        }
        *events = step;
        Ok(())
    }

    fn ask_in<'o, Q: Question>(
        &mut self,
        mut asked: Vec<(Arc<str>, Q)>,
        questions: impl Iterator<Item = (&'o Object, Q)>,
    ) -> Result<Vec<(Arc<str>, Q)>, CosimError> {
        asked.extend(questions.map(|(object, question)| (object.id.clone(), question)));
        self.asked += asked.len();
        Ok(asked)
    }

    async fn answers<Q: Question>(
        &mut self,
        mut asked: Vec<(Arc<str>, Q)>,
        mut each: impl for<'a> FnMut(Q, Result<Q::Answer<'a>, NoAnswer>),
    ) -> Result<Vec<(Arc<str>, Q)>, CosimError> {
        let count = asked.len();
        for (id, question) in asked.drain(..) {
            // A vehicle has not the name of a lane here.
            self.lanes_asked += usize::from([AHEAD, BEHIND, ""].contains(&&*id));
            let driver = self.road.get(&*id);
            let mut values = Values { id: &id, driver, world: self, gone: false };
            let answer = question.answer(&mut values);
            let answer = if values.gone { Err(NoAnswer::Gone) } else { Ok(answer) };
            each(question, answer);
        }
        self.answered += count;
        Ok(asked)
    }

    async fn leave(&mut self) -> Result<(), CosimError> {
        for (id, what) in std::mem::take(&mut self.waiting) {
            self.act(&id, what);
        }
        Ok(())
    }

    async fn close(self) -> Result<(), CosimError> {
        Ok(())
    }

    fn waited(&self) -> Duration {
        Duration::from_millis(self.step)
    }
}

/// The values of one object.
struct Values<'a> {
    id: &'a str,
    driver: Option<&'a Driver>,
    world: &'a Fake,
    gone: bool,
}

impl<'a> Gets<'a> for Values<'a> {
    fn value(&mut self, domain: Domain, variable: u8, with: Option<With<'_>>) -> Option<Value<'a>> {
        if let Some(With::Key(key)) = with {
            return Some(Value::Text(self.parameter_of(domain, key)));
        }
        match domain {
            Domain::VehicleType => Some(type_value(self.id, variable)),
            Domain::Lane if variable == lane::MAX_SPEED.id => {
                let ahead = self.world.ahead.filter(|_| self.id == AHEAD);
                Some(Value::Double(ahead.map_or(LIMIT_MPS, |(_, limit_mps)| limit_mps)))
            }
            Domain::Lane if variable == lane::FRICTION.id => {
                Some(Value::Double(if self.id == AHEAD { 2.0 * FRICTION } else { FRICTION }))
            }
            Domain::Vehicle if variable == vehicle::LANE.id && self.is_nowhere() => Some(Value::Text("")),
            Domain::Vehicle if variable == vehicle::LANE.id && self.is_ahead() => Some(Value::Text(AHEAD)),
            Domain::Vehicle if variable == vehicle::ROAD.id && self.is_ahead() => Some(Value::Text("ahead")),
            Domain::Vehicle if variable == vehicle::STOP_STATE.id => {
                let stop = self.driver?.car.stop;
                let stands = stop.is_some_and(|(begins, ends)| (begins..ends).contains(&self.world.step));
                // Bits beside that of the stop: it will be one at a bus stop.
                Some(Value::Int(16 * i32::from(stop.is_some()) + i32::from(stands)))
            }
            Domain::Vehicle => {
                self.gone = self.driver.is_none();
                vehicle_value(self.driver?, variable)
            }
            _ => panic!("nobody asks for 0x{variable:02x} of {domain:?}"),
        }
    }

    fn leader(&mut self, ahead_m: f64) -> Option<Leader> {
        self.world.leader_of(&self.driver?.car, ahead_m)
    }
}

impl<'a> Values<'a> {
    fn is_nowhere(&self) -> bool {
        let (driver, nowhere) = (self.driver, self.world.nowhere);
        driver.zip(nowhere).is_some_and(|(driver, (from_m, to_m))| (from_m..to_m).contains(&driver.car.position_m))
    }

    fn is_ahead(&self) -> bool {
        self.driver.is_some_and(|driver| !driver.carried && self.world.is_ahead(&driver.car))
    }

    /// A type may say how many of its vehicles are equipped; a vehicle has what the demand gives it.
    fn parameter_of(&self, domain: Domain, key: &str) -> &'a str {
        match domain {
            Domain::VehicleType if self.id == "sampled" && key == "device.mfc.probability" => "0.3",
            Domain::VehicleType => "",
            _ => {
                let mut given = self.driver.into_iter().flat_map(|driver| &driver.car.parameters);
                given.find(|(name, _)| *name == key).map_or("", |(_, text)| text)
            }
        }
    }
}

/// A type's id is its class; `car` is a passenger car.
fn type_value(id: &str, variable: u8) -> Value<'_> {
    match variable {
        v if v == vehicletype::CLASS.id => {
            Value::Text(if ["car", "ponderer", "sampled"].contains(&id) { "passenger" } else { id })
        }
        v if v == vehicletype::LENGTH.id => Value::Double(LENGTH_M),
        v if v == vehicletype::ACCEL.id => Value::Double(ACCEL_MPS2),
        v if v == vehicletype::EMERGENCY_DECEL.id => Value::Double(9.0),
        v if v == vehicletype::ACTION_STEP_LENGTH.id => {
            Value::Double(if id == "ponderer" { PONDERED_S } else { STEP_S })
        }
        v if v == vehicletype::MASS.id => Value::Double(1500.0),
        _ => panic!("nobody asks for 0x{variable:02x} of a vType"),
    }
}

fn vehicle_value(driver: &Driver, variable: u8) -> Option<Value<'_>> {
    let on_road = |value| if driver.carried { None } else { Some(value) };
    match variable {
        v if v == vehicle::SPEED.id => on_road(Value::Double(driver.car.speed_mps)),
        v if v == vehicle::POSITION.id => on_road(Value::Position2([driver.car.position_m, 1.5])),
        v if v == vehicle::COLOR.id => Some(Value::Color(driver.colour)),
        v if v == vehicle::ANGLE.id => on_road(Value::Double(90.0 - driver.car.bend_deg_per_m * driver.car.position_m)),
        v if v == vehicle::SLOPE.id => on_road(Value::Double(0.0)),
        v if v == vehicle::LANE.id => Some(Value::Text(if driver.carried { "" } else { BEHIND })),
        v if v == vehicle::ROAD.id => Some(Value::Text(if driver.carried { "" } else { "road" })),
        v if v == vehicle::DISTANCE.id => Some(Value::Double(driver.odometer_m)),
        v if v == vehicle::TYPE.id => Some(Value::Text(&driver.car.type_id)),
        v if v == vehicle::ACCEL.id => Some(Value::Double(driver.accel_mps2)),
        v if v == vehicle::DECEL.id => Some(Value::Double(driver.decel_mps2)),
        v if v == vehicle::SPEED_FACTOR.id => Some(Value::Double(driver.speed_factor)),
        v if v == vehicle::SPEED_MODE.id => Some(Value::Int(driver.speed_mode)),
        v if v == vehicle::MAX_SPEED.id => Some(Value::Double(driver.car.speed_max_mps)),
        v if v == vehicle::IMPERFECTION.id => Some(Value::Double(driver.imperfection)),
        v if v == vehicle::TAU.id => Some(Value::Double(driver.headway_s)),
        _ => panic!("nobody asks for 0x{variable:02x} of a vehicle"),
    }
}
