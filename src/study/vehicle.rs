//! All that is known of one vehicle of a run: our tables, and SUMO's own outputs in columns `sumo_*`. What SUMO measures is
//! of the car that it shows: of the speed v* within each step, which starts from the body's speed.

use crate::run::{QUALITY, VEHICLES};
use crate::sumo_files::{Conflicts, TripInfo};
use crate::table::{Cell, Column, Columns, Field, Kind, Layout, record};
use std::sync::LazyLock;

record! {
    /// What SUMO tells of a vehicle.
    #[derive(Debug, Clone, Default, PartialEq)]
    pub struct SumoVehicle {
        vehicle_type as "sumo_vType": Option<String> = "SUMO's tripinfo: its vType";
        depart as "sumo_depart": Option<f64> = "SUMO's tripinfo: departure" ["s"];
        arrival as "sumo_arrival": Option<f64> = "SUMO's tripinfo: arrival; empty if it did not reach the end of its route" ["s"];
        duration as "sumo_duration": Option<f64> = "SUMO's tripinfo: from departure to arrival, or to the end of the run" ["s"];
        route_length as "sumo_routeLength": Option<f64> = "SUMO's tripinfo: length driven" ["m"];
        waiting_time as "sumo_waitingTime": Option<f64> = "SUMO's tripinfo: time slower than 0.1 m/s" ["s"];
        waiting_count as "sumo_waitingCount": Option<f64> = "SUMO's tripinfo: how often it became slower than 0.1 m/s";
        stop_time as "sumo_stopTime": Option<f64> = "SUMO's tripinfo: time at planned stops" ["s"];
        time_loss as "sumo_timeLoss": Option<f64> = "SUMO's tripinfo: time lost" ["s"];
        speed_factor as "sumo_speedFactor": Option<f64> = "SUMO's tripinfo: speed factor";
        co as "sumo_CO_abs": Option<f64> = "SUMO's emissions of v*, where its device is on" ["mg"];
        co2 as "sumo_CO2_abs": Option<f64> = "The same" ["mg"];
        hc as "sumo_HC_abs": Option<f64> = "The same" ["mg"];
        pmx as "sumo_PMx_abs": Option<f64> = "The same" ["mg"];
        nox as "sumo_NOx_abs": Option<f64> = "The same" ["mg"];
        fuel as "sumo_fuel_abs": Option<f64> = "The same" ["mg"];
        electricity as "sumo_electricity_abs": Option<f64> = "The same" ["Wh"];
        conflicts as "sumo_conflicts": Option<f64> = "SUMO's SSM device, where it is on: encounters in which TTC, DRAC or PET passed its threshold";
        ttc_min as "sumo_minTTC": Option<f64> = "SUMO's SSM device: smallest time to collision" ["s"];
        drac_max as "sumo_maxDRAC": Option<f64> = "SUMO's SSM device: largest deceleration to avoid a crash" ["m/s²"];
        pet_min as "sumo_PET": Option<f64> = "SUMO's SSM device: smallest post-encroachment time" ["s"];
    }
}

impl SumoVehicle {
    /// Takes a trip.
    pub fn take_trip(&mut self, trip: &TripInfo) {
        let [co, co2, hc, pmx, nox, fuel, electricity] = trip.emissions;
        *self = Self {
            vehicle_type: Some(trip.vehicle_type.clone()),
            depart: Some(trip.depart_s),
            arrival: trip.arrival_s,
            duration: Some(trip.duration_s),
            route_length: Some(trip.route_length_m),
            waiting_time: trip.waiting_time_s,
            waiting_count: trip.waiting_count,
            stop_time: trip.stop_time_s,
            time_loss: Some(trip.time_loss_s),
            speed_factor: trip.speed_factor,
            co,
            co2,
            hc,
            pmx,
            nox,
            fuel,
            electricity,
            ..self.clone()
        };
    }

    /// Takes what its SSM device saw: nothing, perhaps.
    pub fn take_conflicts(&mut self, conflicts: &Conflicts) {
        self.conflicts = Some(conflicts.count as f64);
        self.ttc_min = conflicts.ttc_min_s;
        self.drac_max = conflicts.drac_max_mps2;
        self.pet_min = conflicts.pet_min_s;
    }
}

/// The columns of our tables of vehicles but for the id, as this table has them: counts are numbers and flags are texts,
/// because vehicles that are no egos have neither.
pub static OWN: LazyLock<Vec<Column>> = LazyLock::new(|| {
    let all = VEHICLES.shape.columns.iter().skip(1).chain(QUALITY.shape.columns.iter().skip(2));
    let kind = |kind| if kind == Kind::Count || kind == Kind::Number { Kind::Number } else { Kind::Text };
    all.map(|column| Column { kind: kind(column.kind), ..column.clone() }).collect()
});

/// What our tables tell of an ego, in the order of [`OWN`]: texts are in the one list, numbers in the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Own {
    texts: Box<[Option<Box<str>>]>,
    /// NaN = no value.
    numbers: Box<[f64]>,
}

impl Own {
    /// An ego without any value yet.
    pub fn empty() -> Self {
        Self { texts: vec![None; OWN.len()].into(), numbers: vec![f64::NAN; OWN.len()].into() }
    }

    /// Takes the value of a column.
    pub fn set(&mut self, column: usize, value: &str) {
        match OWN[column].kind {
            Kind::Text => self.texts[column] = (!value.is_empty()).then(|| value.into()),
            _ => self.numbers[column] = value.parse().unwrap_or(f64::NAN),
        }
    }
}

/// A vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Vehicle {
    /// SUMO's id.
    pub id: String,
    /// Earlier vehicles of the run with this id.
    pub again: usize,
    /// Whether it arrived.
    pub arrived: bool,
    /// Our tables, if it was an ego.
    pub own: Option<Own>,
    /// SUMO's.
    pub sumo: SumoVehicle,
}

impl Field for Vehicle {
    fn columns<R: 'static>(_: Column, find: impl Fn(&R) -> &Self + Clone + Send + Sync + 'static) -> Columns<R> {
        let mut columns: Columns<R> = Vec::new();
        let id = find.clone();
        let name = Column::new("id", Kind::Text, None, "SUMO's id of the vehicle");
        columns.push((name, Box::new(move |row| Cell::Text(Some(&id(row).id)))));
        let again = find.clone();
        let name = Column::new("again", Kind::Count, None, "Earlier vehicles of the run with the same id");
        columns.push((name, Box::new(move |row| Cell::Count(again(row).again as u64))));
        let ego = find.clone();
        let name = Column::new("ego", Kind::Flag, None, "True if it was an ego: the columns up to sumo_ are of egos");
        columns.push((name, Box::new(move |row| Cell::Flag(ego(row).own.is_some()))));
        for (k, column) in OWN.iter().enumerate() {
            let find = find.clone();
            let kind = column.kind;
            columns.push((
                column.clone(),
                Box::new(move |row| {
                    let own = find(row).own.as_ref();
                    match kind {
                        Kind::Text => Cell::Text(own.and_then(|own| own.texts[k].as_deref())),
                        _ => Cell::Number(own.map(|own| own.numbers[k]).filter(|value| value.is_finite())),
                    }
                }),
            ));
        }
        columns.extend(SumoVehicle::columns(Column::new("", Kind::Number, None, ""), move |row| &find(row).sumo));
        columns
    }
}

/// The columns of a vehicle.
pub static VEHICLE: LazyLock<Layout<Vehicle>> =
    LazyLock::new(|| Layout::of_record(["vehicles", "vehicle"], "One row per vehicle"));
