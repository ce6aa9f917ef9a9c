//! What an arm's geometry and drives come to: where its tip is, where its joints belong, how
//! hard it may press.

use ferntast_control::servo::{
    CartesianModel, Command, CommandCheck, FeedForward, ServoConfig, Target,
};
use ferntast_model::{
    Joints, ParameterError, Vector2,
    joint::JointParameters,
    kinematics::{Elbow, Kinematics},
    rigid_body::Vector3,
    serial_arm::SerialArm,
};

/// What presses at ROKVISS's joints may be 20 Nm, and the friction that is fed forward as much
/// \[Nm\].
const ROKVISS_PRESSES: f64 = 40.0;
/// Its shorter lever \[m\].
const ROKVISS_LEVER: f64 = 0.35;
/// Of ROKVISS a motor that stops at a surface adds its speed times this \[N s/rad\]: the wave
/// impedance √(J k) at the lever, of J = 0.5 kg m² behind gear (4900 Nm/rad) and surface
/// (4·10⁴ N/m at 0.35 m) in series.
const ROKVISS_IMPACT: f64 = 100.0;
/// A joint that stands, and so does its setpoint, is slower than this \[rad/s\].
pub const STANDS: f64 = 0.02;
/// Speeds at which the friction that is fed forward is looked at.
const SPEEDS: u32 = 32;

/// The arm as it is believed.
#[derive(Clone, Debug)]
pub enum Body {
    /// Two links in a plane.
    Planar(Kinematics),
    /// Any joints in space.
    Serial(Box<SerialBody>),
}

/// A serial arm with its drives.
#[derive(Clone, Debug)]
pub struct SerialBody {
    arm: SerialArm,
    limits: Joints<[f64; 2]>,
    servo: ServoConfig,
    /// What each joint presses with at most \[Nm\], friction that is fed forward included.
    pressing: Joints<f64>,
    damping: Joints<f64>,
    /// Of the stiffest thing that there is to touch \[N/m\].
    stiffest: f64,
}

/// How fast things went lately, while the tip may have met something.
#[derive(Clone, Copy, Debug)]
pub struct Speeds {
    /// The motors, both of them or all together \[rad/s\].
    pub motors: f64,
    /// The tip \[m/s\].
    pub tip: f64,
    /// The fastest setpoint \[rad/s\].
    pub setpoint: f64,
}

impl SerialBody {
    /// Of `arm`, whose servo is tuned so, among things of up to that stiffness \[N/m\].
    ///
    /// # Errors
    ///
    /// Friction that the model does not know, a list of another length.
    pub fn new(
        arm: &SerialArm,
        servo: &ServoConfig,
        stiffest: f64,
    ) -> Result<SerialBody, ParameterError> {
        let (count, joints) = (arm.count(), arm.joints());
        let tuning = servo.joints(count)?;
        let mut pressing = tuning.map(|own| own.pressing_limit);
        for (joint, own) in pressing.iter_mut().enumerate() {
            *own += friction(&joints[joint], servo, *own)?;
        }
        Ok(SerialBody {
            arm: arm.clone(),
            limits: Joints::from_fn(count, |joint| {
                [joints[joint].position_lower, joints[joint].position_upper]
            }),
            servo: servo.clone(),
            pressing,
            damping: tuning.map(|own| own.damping),
            stiffest,
        })
    }

    /// What presses at the tip at most \[N\], along `force`, with the links at `position`: at no
    /// joint i may |J_i F| be more than what it presses with.
    fn pressing_force(&self, position: &Joints<f64>, force: &Vector3<f64>, setpoint: f64) -> f64 {
        let direction = force.normalize();
        let jacobian = self.arm.chain().jacobian(position);
        let each = (0..position.len()).map(|joint| {
            let lever = jacobian.column(joint).fixed_rows::<3>(0).dot(&direction);
            let torque = self.pressing[joint] + self.damping[joint] * setpoint;
            torque / lever.abs().max(1e-9)
        });
        each.fold(f64::INFINITY, f64::min)
    }

    /// What an impact at 1 m/s comes to, √(m k) with the mass that the tip has along `force`
    /// \[N s/m\].
    fn impact(&self, position: &Joints<f64>, force: &Vector3<f64>) -> f64 {
        let direction = force.normalize();
        let jacobian = self.arm.chain().jacobian(position);
        let along = jacobian.fixed_rows::<3>(0).tr_mul(&direction);
        // Of the joints that there are; the others move nothing.
        let mut mass = self.arm.mass_with_motors(position);
        for joint in position.len()..mass.nrows() {
            mass[(joint, joint)] = 1.0;
        }
        let mobility = mass
            .cholesky()
            .map_or(f64::INFINITY, |own| along.dot(&own.solve(&along)));
        (self.stiffest / mobility.max(1e-9)).sqrt()
    }
}

/// The most friction that is fed forward at a joint, under a load \[Nm\].
fn friction(
    joint: &JointParameters,
    servo: &ServoConfig,
    load: f64,
) -> Result<f64, ParameterError> {
    let fed = FeedForward::new(joint, servo.take_over)?;
    let [slowest, fastest] = joint.friction.speed_range;
    let at = |step: u32| {
        let speed = slowest + (fastest - slowest) * f64::from(step) / f64::from(SPEEDS);
        let torque = fed.torque(0.0, speed, load);
        torque.sliding.abs() + torque.standing.abs()
    };
    Ok(servo.friction_compensation * (0..=SPEEDS).map(at).fold(0.0, f64::max))
}

impl Body {
    /// The tip at these joint positions \[m\].
    pub fn tip(&self, joints: &Joints<f64>) -> [f64; 3] {
        match self {
            Body::Planar(kinematics) => {
                let tip = kinematics.forward(&Vector2::new(joints[0], joints[1]));
                [tip.x, tip.y, 0.0]
            }
            Body::Serial(own) => own.arm.chain().forward(joints).translation.into(),
        }
    }

    /// What the joints carry of the arm's own weight there \[Nm\]; none of a planar arm, in orbit.
    pub fn weight(&self, joints: &Joints<f64>) -> Joints<f64> {
        match self {
            Body::Planar(_) => joints.map(|_| 0.0),
            Body::Serial(own) => own.arm.weight(joints),
        }
    }

    /// What a joint that stands presses with at most \[Nm\].
    pub fn pressing(&self, joint: usize) -> f64 {
        match self {
            Body::Planar(_) => ROKVISS_PRESSES,
            Body::Serial(own) => own.pressing[joint] + STANDS * own.damping[joint],
        }
    }

    /// Force on the tip \[N\] that presses at most, and with what comes from an impact at those
    /// speeds; the links at `position`, the force along `force`.
    pub fn contact(&self, position: &Joints<f64>, force: [f64; 3], speeds: &Speeds) -> [f64; 2] {
        match self {
            Body::Planar(_) => {
                let pressing = ROKVISS_PRESSES / ROKVISS_LEVER;
                [pressing, pressing + ROKVISS_IMPACT * speeds.motors]
            }
            Body::Serial(own) => {
                let force = Vector3::from(force);
                if force.norm() < 1e-9 {
                    return [f64::INFINITY; 2];
                }
                let pressing = own.pressing_force(position, &force, speeds.setpoint);
                [
                    pressing,
                    pressing + own.impact(position, &force) * speeds.tip,
                ]
            }
        }
    }

    /// What leads its joints.
    ///
    /// # Errors
    ///
    /// As [`CommandCheck::new`].
    pub fn leading(&self) -> Result<Leading, ParameterError> {
        Ok(match self {
            Body::Planar(kinematics) => Leading::Planar(*kinematics),
            Body::Serial(own) => {
                let model = CartesianModel::Serial(&own.arm);
                let commands = CommandCheck::new(model, own.limits, &own.servo)?;
                Leading::Serial {
                    commands: Box::new(commands),
                    arm: Box::new(own.arm.clone()),
                }
            }
        })
    }
}

/// Where joints belong that a tip leads.
pub enum Leading {
    /// Of two links in a plane.
    Planar(Kinematics),
    /// Of any joints in space: one command after the other, as the servo takes them.
    Serial {
        /// The servo's own reading of tips, apart.
        commands: Box<CommandCheck>,
        /// The links.
        arm: Box<SerialArm>,
    },
}

impl Leading {
    /// The next command may be anywhere. Gives whether commands before do not count for those
    /// that come.
    pub fn begin(&mut self) -> bool {
        match self {
            Leading::Planar(_) => false,
            Leading::Serial { commands, .. } => {
                commands.rearm();
                true
            }
        }
    }

    /// The motors' positions with the tip commanded there in step `tick`, from `position` on
    /// \[rad\].
    pub fn joints(
        &mut self,
        tick: i64,
        tip: [f64; 3],
        position: &Joints<f64>,
    ) -> Option<Joints<f64>> {
        match self {
            Leading::Planar(kinematics) => {
                let elbow = Elbow::of(&Vector2::new(position[0], position[1]));
                let joints = kinematics.inverse(&Vector2::new(tip[0], tip[1]), elbow);
                joints.ok().map(|own| [own.x, own.y].into())
            }
            Leading::Serial { commands, arm } => {
                let stamp_ns = (tick + 1) * 1_000_000;
                let target = Target::Tip(tip);
                let command = Command { stamp_ns, target };
                let links = commands.check(&command, stamp_ns, position).ok()?;
                let weight = arm.weight(&links);
                Some(Joints::from_fn(links.count(), |joint| {
                    arm.joints()[joint].motor_position(links[joint], weight[joint])
                }))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use ferntast_drivers::simulated::load_arm;

    use super::*;

    fn panda() -> (SerialArm, SerialBody) {
        let arm = load_arm("panda").unwrap();
        let serial = arm.model.serial().unwrap();
        let body = SerialBody::new(&serial.arm, &serial.servo, 2e4).unwrap();
        (serial.arm.clone(), body)
    }

    /// By virtual work: a force that one joint alone has to hold at most.
    #[test]
    fn no_joint_holds_more_than_it_presses_with() {
        let (arm, body) = panda();
        let force = Vector3::new(3.0, -2.0, 7.0);
        let most = body.pressing_force(arm.home(), &force, 0.0);
        let jacobian = arm.chain().jacobian(arm.home());
        let torque = jacobian
            .fixed_rows::<3>(0)
            .tr_mul(&(force.normalize() * most));
        let shares: Vec<f64> = (0..7)
            .map(|joint| torque[joint].abs() / body.pressing[joint])
            .collect();
        let largest = shares.iter().copied().fold(0.0, f64::max);
        assert!((largest - 1.0).abs() < 1e-9, "{shares:?}");
        assert!((20.0..500.0).contains(&most), "{most} N");
    }

    /// √(m k) of some kilograms at 20 kN/m.
    #[test]
    fn an_impact_is_that_of_the_mass_at_the_tip() {
        let (arm, body) = panda();
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let mass = body.impact(arm.home(), &axis).powi(2) / 2e4;
            assert!((0.5..20.0).contains(&mass), "{mass} kg along {axis:?}");
        }
    }

    /// The joints that a tip leads to put the tip there.
    #[test]
    fn joints_belong_where_the_tip_is_commanded() {
        let (arm, body) = panda();
        let body = Body::Serial(Box::new(body));
        let mut leading = body.leading().unwrap();
        let mut joints = *arm.home();
        let home = arm.home_tip().translation;
        for tick in 0..50 {
            let tip = home + Vector3::new(2e-4, -1e-4, 3e-4) * tick as f64;
            joints = leading.joints(tick, tip.into(), &joints).unwrap();
            let there = Vector3::from(body.tip(&joints));
            // The gears, of 1e6 Nm/rad, give way under the weight.
            assert!((there - tip).norm() < 1e-4, "{}", (there - tip).norm());
        }
    }
}
