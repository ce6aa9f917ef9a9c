//! The closed position loop of the bench, at 1 kHz.

/// Position loop: stiffness and damping about the desired motion, with the
/// torque of a plain friction and spring ahead. It knows nothing of the joint's truth.
#[derive(Clone, Debug)]
pub(super) struct Servo {
    stiffness: f64,
    damping: f64,
    inertia: f64,
}

/// Drives end somewhere \[Nm\].
const LARGEST_TORQUE: f64 = 70.0;

impl Servo {
    /// For a joint of about `inertia` \[kg m²\].
    pub(super) fn new(inertia: f64) -> Self {
        // 10 Hz, well damped; friction's falling slope has to be outweighed.
        let rate = 63.0;
        Servo {
            stiffness: inertia * rate * rate,
            damping: 1.6 * inertia * rate,
            inertia,
        }
    }

    /// Motor torque \[Nm\] for `desired` position, velocity and acceleration,
    /// at `position` \[rad\] and `velocity` \[rad/s\].
    pub(super) fn torque(&self, desired: [f64; 3], position: f64, velocity: f64) -> f64 {
        let friction = 12.0 * (desired[1] / 0.01).tanh() + 30.0 * desired[1];
        let torque = self.stiffness * (desired[0] - position)
            + self.damping * (desired[1] - velocity)
            + self.inertia * desired[2]
            + friction;
        torque.clamp(-LARGEST_TORQUE, LARGEST_TORQUE)
    }
}
