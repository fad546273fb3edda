//! Laws that command all vehicles of a group in one call.

use std::sync::{Arc, Mutex};

use sumo_mfc::control::{CONTROLLERS, GroupController, GroupPeriod, Law, group_law};
use sumo_mfc::fleet::follow::{Bound, Follow};
use sumo_mfc::fleet::{Fleet, GroupSetup, LoopConfig, Slot};
use sumo_mfc::keys::{NoKeys, Values};
use sumo_mfc::offline::Drive;
use sumo_mfc::plant::SevenDof;
use sumo_mfc::reference::{Axis, Profile};
use sumo_mfc::registry::find;
use sumo_mfc::scenario::Catalog;
use vehicle::vehicle;

#[path = "same_bits/vehicle.rs"]
mod vehicle;

const PERIOD_S: f64 = 0.01;

/// The law `pid` with its default gains, on columns.
#[derive(Default)]
struct ColumnPi {
    integral_mps2: Vec<f64>,
    /// The number of slots in every call.
    slots: Arc<Mutex<Vec<usize>>>,
}

impl GroupController for ColumnPi {
    fn command(&mut self, group: &mut GroupPeriod) -> Result<(), String> {
        self.slots.lock().unwrap().push(group.len());
        self.integral_mps2.resize(group.len(), 0.0);
        for i in 0..group.len() {
            let error_mps = group.measured_mps[i] - group.reference_mps[i];
            let excess_mps2 = group.commanded_mps2[i] - group.saturated_mps2[i];
            let integral = &mut self.integral_mps2[i];
            if group.starts[i] {
                *integral = 0.0;
            }
            if !group.drives[i] {
                continue;
            }
            let step = -group.period_s * error_mps;
            *integral += if step * excess_mps2 > 0.0 { 0.0 } else { step };
            let accel_mps2 = *integral - error_mps - 0.0 * error_mps + group.reference_rate_mps2[i];
            group.torque_nm[i] = accel_mps2 * group.nominal_nm_per_mps2[i];
        }
        Ok(())
    }
}

fn fleet(laws: Vec<Box<dyn Fn() -> Law + Send + Sync>>) -> Fleet {
    let groups = laws.into_iter().map(|law| GroupSetup { law, dead_time_max_s: 0.1 }).collect();
    Fleet::new(
        LoopConfig { plant: Box::new(SevenDof::new(PERIOD_S)), period_s: PERIOD_S, reference_bound_mps: 1.0 },
        groups,
    )
}

/// Bits of the speeds after every step of a drive in which vehicles come and go, and stop and start.
fn drive(mut fleet: Fleet, group: usize) -> Vec<Vec<u64>> {
    let mut egos: Vec<(usize, Slot)> = Vec::new();
    let mut seen = Vec::new();
    for step in 0..400 {
        if step % 5 == 0 && step < 200 {
            egos.push((step / 5, fleet.admit(group, vehicle(step / 5))));
        }
        if step % 30 == 29 && egos.len() > 3 {
            let (_, slot) = egos.remove(step % 3);
            fleet.release(slot);
        }
        for (number, slot) in &egos {
            let target_mps = if (number + step) % 140 < 80 { 13.9 } else { 0.0 };
            let block = fleet.block_mut(*slot);
            block.see_speed(slot.lane(), target_mps);
            block.set_target(slot.lane(), target_mps, Bound::Traffic);
        }
        fleet.advance(10, |_| true, Follow::Traffic);
        fleet.soundness().unwrap();
        fleet.close_step();
        seen.push(egos.iter().map(|(_, slot)| fleet.block(*slot).speed_mps(slot.lane()).to_bits()).collect());
    }
    seen
}

fn pid() -> Box<dyn Fn() -> Law + Send + Sync> {
    let law = find("controller", &CONTROLLERS, "pid").unwrap();
    let values = Values::defaults(law.keys);
    Box::new(move || (law.build)(&values, PERIOD_S))
}

#[test]
fn the_same_law_for_a_group_gives_the_bits_of_a_law_for_blocks() {
    let slots = Arc::<Mutex<Vec<usize>>>::default();
    let seen = slots.clone();
    let columns = move || Law::Group(Box::new(ColumnPi { slots: seen.clone(), ..ColumnPi::default() }));
    let expected = drive(fleet(vec![pid()]), 0);
    // Beside a group without vehicles, whose blocks must not count.
    assert_eq!(drive(fleet(vec![pid(), Box::new(columns)]), 1), expected);
    let slots = slots.lock().unwrap();
    assert_eq!(slots.len(), 400 * 10, "one call per control period");
    assert_eq!((slots[0], slots[slots.len() - 1]), (16, 48), "the columns grow by blocks");
}

/// A law that gives up at its third call.
struct Failing(u32);

impl GroupController for Failing {
    fn command(&mut self, _: &mut GroupPeriod) -> Result<(), String> {
        self.0 += 1;
        if self.0 < 3 { Ok(()) } else { Err("no torque for you".into()) }
    }
}

#[test]
fn a_law_that_gives_up_ends_a_drive_with_its_words() {
    let catalog =
        Catalog::installed().with_controller(group_law("failing", "gives up", |_: NoKeys, _| Failing(0))).unwrap();
    let profile = Profile::step(Axis::Time, &[0.0, 5.0], &[10.0, 10.0]).unwrap();
    let drive = Drive::new(&catalog).set("controller.name", "failing").follow(profile).for_s(1.0);
    assert_eq!(drive.run().unwrap_err().to_string(), "the controller: no torque for you");
}
