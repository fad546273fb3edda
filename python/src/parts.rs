//! Parts of the model on their own: the body, a tyre, the estimator.

use crate::controller::catalog;
use crate::error::{plain, raised};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use sumo_mfc::control;
use sumo_mfc::lanes::LANES;
use sumo_mfc::offline::{End, Road};
use sumo_mfc::plant::tyre::{Tyre, identify};
use sumo_mfc::plant::{Inputs, Plant as Model, PlantBlock, State};
use sumo_mfc::reference::{Axis, Profile};
use sumo_mfc::scenario::{Override, Request, Scenario};

/// The body of one vehicle and its plant.
#[pyclass(module = "sumo_mfc._core")]
pub struct Plant {
    model: Box<dyn Model>,
    /// In a box because its columns begin where vectors do, which Python's memory does not heed.
    vehicle: Box<Vehicle>,
    period_s: f64,
}

/// What the plant moves, in slot 0, and what acts on it.
struct Vehicle {
    block: PlantBlock,
    inputs: Inputs,
}

#[pymethods]
impl Plant {
    /// `keys` are keys of the scenario with their values as TOML.
    #[new]
    fn new(keys: Vec<(String, String)>, speed_mps: f64, period_s: f64) -> PyResult<Self> {
        if !(period_s > 0.0 && period_s <= 1.0) {
            return Err(plain(format!("period: found {period_s}, wanted seconds above 0, up to 1")));
        }
        if !(speed_mps.is_finite() && speed_mps >= 0.0) {
            return Err(plain(format!("speed: found {speed_mps}, wanted m/s from 0 on")));
        }
        let overrides = keys.iter().map(|(key, value)| Override::literal(&format!("{key} ="), key, value)).collect();
        let scenario = Scenario::load_offline(&Request { scenario: None, overrides }, &catalog()).map_err(raised)?;
        let level = Profile::step(Axis::Time, &[0.0], &[speed_mps]).map_err(plain)?;
        let road = Road::with_profile(&scenario, level.into()).map_err(raised)?;
        let body = road.trip(0, speed_mps, End::Time(0.0)).map_err(raised)?.vehicle.body;
        let mut block = PlantBlock::default();
        block.set_body(0, &body);
        block.set_state(0, &State::rolling(&body, speed_mps));
        let vehicle = Box::new(Vehicle { block, inputs: Inputs::default() });
        Ok(Self { model: scenario.loop_config().plant, vehicle, period_s })
    }

    /// One period.
    fn step(
        &mut self,
        torque_nm: f64,
        steer_rad: f64,
        grade_rad: f64,
        bank_rad: f64,
        headwind_mps: f64,
    ) -> PyResult<()> {
        let angles = [("steer", steer_rad), ("grade", grade_rad), ("bank", bank_rad)];
        if let Some((name, angle)) = angles.iter().find(|(_, angle)| angle.is_nan() || angle.abs() > 1.5) {
            return Err(plain(format!("{name}: found {angle}, wanted radians from -1.5 to 1.5")));
        }
        if !(torque_nm.is_finite() && headwind_mps.is_finite()) {
            return Err(plain("torque, headwind: wanted finite numbers"));
        }
        let Vehicle { block, inputs } = &mut *self.vehicle;
        inputs.torque_nm[0] = torque_nm;
        inputs.steer_rad[0] = steer_rad;
        inputs.grade_rad[0] = grade_rad;
        inputs.bank_rad[0] = bank_rad;
        inputs.headwind_mps[0] = headwind_mps;
        let mut moving = [0.0; LANES];
        moving[0] = 1.0;
        self.model.advance(block, inputs, &moving, self.period_s);
        if block.is_sensible(0) { Ok(()) } else { Err(plain("the body has diverged")) }
    }

    /// V_x, V_y (m/s), yaw rate (rad/s), and the four wheel speeds (rad/s).
    fn state(&self) -> [f64; 7] {
        let State { vx_mps, vy_mps, yaw_rate_radps, wheel_speed_radps: [a, b, c, d] } = self.vehicle.block.state(0);
        [vx_mps, vy_mps, yaw_rate_radps, a, b, c, d]
    }

    /// Driven distance (m).
    fn distance(&self) -> f64 {
        self.vehicle.block.distance_m[0]
    }

    /// Slip ratios of front and rear axle.
    fn slip(&self) -> [f64; 2] {
        self.vehicle.block.slip(0, self.vehicle.inputs.steer_rad[0])
    }

    /// Mass (kg), torque per acceleration (N·m per m/s²), largest driving and braking torque (N·m).
    fn constants(&self) -> [f64; 4] {
        let body = self.vehicle.block.body(0);
        [body.mass_kg, body.nominal_nm_per_mps2(), body.drive_torque_max_nm, body.brake_torque_max_nm]
    }
}

/// Force over peak force of the Magic Formula with these constants, for slips of any number.
#[pyfunction]
pub fn tyre_force<'py>(
    py: Python<'py>,
    slip: PyReadonlyArray1<'py, f64>,
    b: f64,
    c: f64,
    e: f64,
) -> Bound<'py, PyArray1<f64>> {
    let tyre = Tyre { b, c, e };
    PyArray1::from_iter(py, slip.as_array().iter().map(|slip| tyre.force_per_peak(*slip)))
}

/// B, C, E and the peak force (N) of a measured curve.
#[pyfunction]
pub fn identify_tyre(slip: PyReadonlyArray1<'_, f64>, force_n: PyReadonlyArray1<'_, f64>) -> PyResult<[f64; 4]> {
    let curve: Vec<(f64, f64)> = slip.as_array().iter().copied().zip(force_n.as_array().iter().copied()).collect();
    let found = identify(&curve).map_err(plain)?;
    Ok([found.tyre.b, found.tyre.c, found.tyre.e, found.peak_n])
}

/// F̂ of the ultra-local model at every sample.
#[pyfunction]
pub fn ultra_local_f<'py>(
    py: Python<'py>,
    speed_mps: PyReadonlyArray1<'py, f64>,
    input_mps2: PyReadonlyArray1<'py, f64>,
    window_s: f64,
    period_s: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (speed_mps, input_mps2) = (speed_mps.as_array().to_vec(), input_mps2.as_array().to_vec());
    if speed_mps.len() != input_mps2.len() {
        return Err(plain(format!("found {} speeds and {} inputs, wanted as many", speed_mps.len(), input_mps2.len())));
    }
    if !(period_s > 0.0 && window_s >= period_s && window_s / period_s < 1e5) {
        return Err(plain(format!(
            "found a window of {window_s} s and a period of {period_s} s, wanted 1 to 100000 periods"
        )));
    }
    Ok(PyArray1::from_vec(py, control::f_hat(&speed_mps, &input_mps2, window_s, period_s)))
}
