//! What the joints carry of the arm's own weight.

use ferntast_config::Believed;
use ferntast_model::{JointCount, Joints, Vector2, arm::Arm};

/// The arm as it is believed to weigh.
pub struct Weight {
    believed: Believed,
    count: JointCount,
}

impl Weight {
    /// Of that arm of `count` joints.
    pub fn new(believed: &Believed, count: JointCount) -> Weight {
        Weight {
            believed: believed.clone(),
            count,
        }
    }

    /// Joint torques that hold it at `position` \[rad\]: \[Nm\].
    pub fn at(&self, position: &Joints<f64>) -> Joints<f64> {
        match &self.believed {
            Believed::Serial(serial) => serial.arm.weight(position),
            Believed::Planar(model) => {
                let places = position.into_places(0.0);
                let own = Arm::new(&model.arm).gravity(&Vector2::new(places[0], places[1]));
                Joints::from_fn(self.count, |joint| own.get(joint).copied().unwrap_or(0.0))
            }
        }
    }
}
