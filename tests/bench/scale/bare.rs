//! The bare exchange, to compare two ways of reading: the same speeds and angles, nothing done with them.

use sumo_mfc::traci::{Batch, Client, Prefix, Subscribed, Var, vehicle};

const READ: (Var<f64, f64>, Var<f64>) = (vehicle::SPEED, vehicle::ANGLE);

/// The exchange of one SUMO.
pub struct Bare {
    pub client: Client,
    cars: Vec<(Prefix, f64)>,
    act: Batch,
    read: Option<Batch>,
}

impl Bare {
    /// All cars that are on the road.
    pub async fn new(mut client: Client, subscribe: bool) -> Self {
        let now_s = client.get(sumo_mfc::traci::simulation::TIME, "").await.expect("the time");
        let ids: Vec<String> = client.get(vehicle::IDS, "").await.expect("cars");
        let (mut act, mut read) = (Batch::new(), Batch::new());
        let mut cars = Vec::new();
        for id in &ids {
            let prefix = Prefix::new(id).expect("a short id");
            if subscribe {
                act.subscribe(READ, id, now_s).expect("a subscription");
            } else {
                read.get_by_prefix(vehicle::SPEED, &prefix).expect("a get");
                read.get_by_prefix(vehicle::ANGLE, &prefix).expect("a get");
            }
            cars.push((prefix, 0.0));
        }
        let mut bare = Self { client, cars, act, read: Some(read).filter(|_| !subscribe) };
        // The present speeds, so that the first step sends them back.
        bare.exchange().await;
        bare
    }

    /// One step.
    pub async fn step(&mut self) {
        self.act.clear();
        for (prefix, speed_mps) in &self.cars {
            self.act.set_previous_speed(prefix, *speed_mps, 0.0).expect("a speed");
        }
        self.exchange().await;
    }

    async fn exchange(&mut self) {
        self.act.step().expect("a step");
        let Some(read) = &self.read else {
            let reply = self.client.exchange(&self.act).await.expect("SUMO steps");
            for ((_, speed_mps), block) in self.cars.iter_mut().zip(reply.blocks()) {
                let read = block.expect("a block").read(READ).expect("doubles");
                *speed_mps = if let Subscribed::Own((Some(speed), _angle)) = read { speed } else { 0.0 };
            }
            return;
        };
        let stepped = self.client.queue(&self.act).expect("a batch");
        let read = self.client.queue(read).expect("a batch");
        self.client.receive(stepped).await.expect("SUMO steps");
        let reply = self.client.receive(read).await.expect("SUMO answers");
        for (i, (_, speed_mps)) in self.cars.iter_mut().enumerate() {
            let (speed, _angle) = (reply.f64(2 * i), reply.f64(2 * i + 1));
            *speed_mps = speed.unwrap_or_default();
        }
    }
}
