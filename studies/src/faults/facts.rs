//! What the scenario says: limits, and how hand and tip correspond.

use ferntast_config::{Believed, Loaded};
use ferntast_control::delay::{Guarantee, Mapping};
use ferntast_model::{JointCount, Joints, ParameterError, joint::JointParameters};

use super::body::{Body, SerialBody};

/// Noise of the motors' currents of ROKVISS, as torque \[Nm\], and of other arms, as a share of
/// the joint's torque \[-\].
const NOISE: f64 = 3.0;
const NOISE_SHARE: f64 = 0.01;
/// Of what presses, so much may come or go in a step: the spring that held a paused arm against
/// a surface is let go of at once, which is up to 7 Nm of 20 \[-\].
const JUMP_SHARE: f64 = 0.4;

/// What the scenario says.
#[derive(Clone, Debug)]
pub struct Facts {
    /// How hand and tip correspond.
    pub mapping: Mapping,
    /// What the law claims.
    pub guarantee: Guarantee,
    /// Name of the law that the schedule begins with.
    pub law: String,
    /// Largest motor torques \[Nm\].
    pub torque: Joints<f64>,
    /// Largest joint speeds that are no fault \[rad/s\].
    pub overspeed: Joints<f64>,
    /// Largest speeds of the setpoint \[rad/s\].
    pub setpoint_speed: Joints<f64>,
    /// Largest speed on the way to the first command \[rad/s\].
    pub approach_speed: f64,
    /// Largest force on the hand \[N\].
    pub hand_force: f64,
    /// Largest change of the force on the hand in a step \[N\].
    pub hand_force_change: f64,
    /// Limits of the joints with their margin \[rad\].
    pub joint_limits: Joints<[f64; 2]>,
    /// Workspace of tip commands, lower and upper, x and y \[m\].
    pub workspace: [[f64; 2]; 2],
    /// Silence of measurements after which the arm is faulty \[steps\].
    pub measurement_watchdog: i64,
    /// How long frames wait to be played out evenly \[steps\].
    pub buffer: i64,
    /// Noise of the motors' currents, as torque \[Nm\].
    pub noise: Joints<f64>,
    /// Largest change of a motor's torque in a step after the arm was enabled \[Nm\].
    pub jump: Joints<f64>,
    /// The arm's geometry and drives.
    pub body: Body,
}

impl Facts {
    /// What `loaded` says of an arm among things of up to that stiffness \[N/m\].
    ///
    /// # Errors
    ///
    /// An arm or a tuning of the servo that no servo takes.
    pub fn new(loaded: &Loaded, stiffest: f64) -> Result<Facts, ParameterError> {
        let scenario = &loaded.scenario;
        let servo = &scenario.servo;
        let joints = loaded.arm.model.joints();
        let count = JointCount::new(joints.len())?;
        let tuning = servo.joints(count)?;
        let each = |value: &dyn Fn(&JointParameters) -> f64| {
            Joints::from_fn(count, |joint| value(&joints[joint]))
        };
        let (body, noise) = match &loaded.arm.model {
            Believed::Planar(model) => (
                Body::Planar(model.arm.kinematics()),
                Joints::filled(count, NOISE),
            ),
            Believed::Serial(serial) => (
                Body::Serial(Box::new(SerialBody::new(&serial.arm, servo, stiffest)?)),
                each(&|own| NOISE_SHARE * own.motor_torque_limit),
            ),
        };
        Ok(Facts {
            mapping: scenario.law.mapping(),
            guarantee: scenario.law.guarantee(),
            law: scenario.law.name().to_owned(),
            torque: each(&|own| own.motor_torque_limit),
            overspeed: each(&|own| own.velocity_limit * servo.overspeed_share),
            setpoint_speed: each(&|own| own.velocity_limit * servo.velocity_share),
            approach_speed: servo.approach_speed,
            hand_force: scenario.master.force_limit,
            hand_force_change: scenario.master.force_rate_limit * servo.period,
            joint_limits: Joints::from_fn(count, |joint| {
                let (own, margin) = (&joints[joint], servo.limit_margin);
                [own.position_lower - margin, own.position_upper + margin]
            }),
            workspace: [servo.workspace_lower, servo.workspace_upper],
            measurement_watchdog: steps(servo.measurement_watchdog),
            buffer: steps(scenario.link.buffer),
            noise,
            jump: tuning.map(|own| JUMP_SHARE * own.pressing_limit),
            body,
        })
    }

    /// Where the tip belongs when the hand is there \[m\].
    pub fn tip_of_hand(&self, hand: [f64; 3]) -> [f64; 3] {
        let (offset, scale) = (self.mapping.workspace_offset, self.mapping.position_scale);
        [0, 1, 2].map(|axis: usize| offset[axis] + scale * hand[axis])
    }
}

/// Steps that fit into `seconds` \[s\], rounded up.
fn steps(seconds: f64) -> i64 {
    (seconds * 1e3).ceil() as i64
}
