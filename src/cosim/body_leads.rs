//! Body-leads mode, for all targets but `traffic`: the bodies run the coming step first, and SUMO is told
//! `setSpeed` with the speeds that they will have at its end, in every step.

use super::egos::EgoTable;
use crate::fleet::Fleet;
use crate::fleet::follow::Follow;
use crate::reference::Target;

/// The groups' targets.
pub struct BodyLeads {
    targets: Vec<Target>,
}

impl BodyLeads {
    /// The target of each group.
    pub fn new(targets: Vec<Target>) -> Self {
        Self { targets }
    }

    /// The target of a group.
    pub fn target(&self, group: usize) -> &Target {
        &self.targets[group]
    }

    /// True if the bodies of a group lead.
    pub fn in_group(&self, group: usize) -> bool {
        !matches!(self.targets[group], Target::Traffic)
    }

    /// True if the bodies of any group lead.
    pub fn anywhere(&self) -> bool {
        (0..self.targets.len()).any(|group| self.in_group(group))
    }

    /// Leading bodies drive the coming step.
    pub fn advance(&self, fleet: &mut Fleet, egos: &mut EgoTable, periods: u32) {
        if !self.anywhere() {
            return;
        }
        let step_s = f64::from(periods) * fleet.period_s();
        egos.for_each_mut(|ego| {
            if let Some(leader) = &ego.leader {
                leader.set_target(&self.targets[ego.group], fleet.block_mut(ego.slot), ego.slot.lane(), step_s);
            }
        });
        for (group, target) in self.targets.iter().enumerate() {
            let follow = match target {
                Target::Traffic => continue,
                Target::Limit => Follow::Target,
                Target::Profile(profile) => Follow::Profile(profile),
                // As SUMO's car-following does, it chooses a speed for the end of the step.
                Target::Spacing(_) => Follow::Traffic,
            };
            fleet.advance(periods, |block| block.group() == group, follow);
        }
        egos.for_each_mut(|ego| {
            if let Some(leader) = &mut ego.leader {
                leader.set_command(fleet.block(ego.slot).speed_mps(ego.slot.lane()));
            }
        });
    }
}
