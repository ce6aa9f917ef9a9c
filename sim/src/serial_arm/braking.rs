//! Friction of all joints at once.
//!
//! A motor's friction acts on what the other joints do, through the links, and theirs on
//! it. Each joint in turn is braked as if the others' friction were known, again and again
//! until nothing changes (Gauss-Seidel; the matrix is positive definite, so that it
//! converges). One joint's law is `Gear::brake` of the arm of two joints, which stops a
//! motor but never turns it round.

use ferntast_model::Joints;

use super::{
    cholesky::Factor,
    drive::{Drive, Share},
};

/// Rounds at most; three do where gears are soft against the links.
const ROUNDS: usize = 30;
/// The change of friction from which on there is another round, in parts of itself.
const ACCURACY: f64 = 1e-7;
/// Friction that does not count \[Nm\] or \[N\].
const NOTHING: f64 = 1e-10;

/// What the friction of a substep is found from.
pub(super) struct Braking<'a> {
    pub factor: &'a Factor,
    pub shares: &'a Joints<Share>,
    pub drives: &'a Joints<Drive>,
    /// Joint torques that load the gears.
    pub load: &'a Joints<f64>,
    /// Of the gears \[degC\].
    pub temperature: &'a Joints<f64>,
    /// Length of the step \[s\].
    pub dt: f64,
    /// Motor velocities at its beginning.
    pub before: &'a Joints<f64>,
}

impl Braking<'_> {
    /// Finds the `friction`, from that of the last step on, with which the velocities
    /// `motor` and `link` in the middle of the step were found; corrects them.
    pub fn brake(
        &self,
        friction: &mut Joints<f64>,
        motor: &mut Joints<f64>,
        link: &mut Joints<f64>,
    ) {
        let count = friction.count();
        // How link velocities in the middle give way to torques on the links.
        let inverse = self.factor.inverse();
        let follows = self.shares.map(|share| share.follows);
        let mut stands = Joints::filled(count, false);
        for _ in 0..ROUNDS {
            let mut settled = true;
            for joint in 0..count.get() {
                let Some(gear) = &self.drives[joint].friction else {
                    continue;
                };
                let share = &self.shares[joint];
                let gives = share.own + share.follows * share.follows * inverse[joint][joint];
                let had = friction[joint];
                // At the end of the step, without friction.
                let free = 2.0 * (motor[joint] + gives * had) - self.before[joint];
                let inertia = self.dt / (2.0 * gives);
                let braked = gear.brake(
                    free,
                    inertia,
                    self.dt,
                    self.load[joint],
                    self.temperature[joint],
                );
                let found = (free - braked) / (2.0 * gives);
                let more = found - had;
                settled &= more.abs() <= ACCURACY * found.abs() + NOTHING;
                stands[joint] = braked == 0.0;
                friction[joint] = found;
                let torque = share.follows * more;
                for other in 0..count.get() {
                    let slower = inverse[joint][other] * torque;
                    link[other] -= slower;
                    motor[other] -= follows[other] * slower;
                }
                motor[joint] -= share.own * more;
            }
            if settled {
                break;
            }
        }
        // To the bit, so that a motor that is held does not creep.
        for joint in (0..count.get()).filter(|joint| stands[*joint]) {
            motor[joint] = 0.5 * self.before[joint];
            if self.drives[joint].stiffness.is_none() {
                link[joint] = motor[joint];
            }
        }
    }
}
