//! What a SUMO step says about the traffic as a whole.

/// Events of one SUMO step. Ids are SUMO's.
#[derive(Debug, Clone, Default)]
pub struct Events {
    /// Simulation time at the end of the step \[s\].
    pub time_s: f64,
    /// Number of vehicles that are on the road or still to come.
    pub expected: i32,
    /// Vehicles that departed; they have not moved yet.
    pub departed: Vec<String>,
    /// Vehicles that arrived.
    pub arrived: Vec<String>,
    /// Vehicles of which a teleport began.
    pub teleported: Vec<String>,
    /// True if vehicles touch, or are nearer than their smallest gap.
    pub colliding: bool,
    /// The pairs of these vehicles: collider, victim.
    pub collisions: Vec<[String; 2]>,
}

impl Events {
    /// Forgets the events of the last step; time and number of vehicles stay.
    pub fn clear(&mut self) {
        for list in [&mut self.departed, &mut self.arrived, &mut self.teleported] {
            list.clear();
        }
        self.colliding = false;
        self.collisions.clear();
    }

    /// True if nobody collided or teleported. Then what SUMO shows of one vehicle says nothing about another.
    pub fn is_quiet(&self) -> bool {
        !self.colliding && self.teleported.is_empty()
    }
}
