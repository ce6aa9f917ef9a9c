//! What the scenario says: limits, and how hand and tip correspond.

use ferntast_control::delay::{Guarantee, Mapping};
use ferntast_model::{Vector2, kinematics::Kinematics};
use ferntast_nodes::config::Loaded;

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
    pub torque: [f64; 2],
    /// Largest joint speeds that are no fault \[rad/s\].
    pub overspeed: [f64; 2],
    /// Largest speeds of the setpoint \[rad/s\].
    pub setpoint_speed: [f64; 2],
    /// Largest speed on the way to the first command \[rad/s\].
    pub approach_speed: f64,
    /// Largest force on the hand \[N\].
    pub hand_force: f64,
    /// Largest change of the force on the hand in a step \[N\].
    pub hand_force_change: f64,
    /// Limits of the joints with their margin \[rad\].
    pub joint_limits: [[f64; 2]; 2],
    /// Workspace of tip commands, lower and upper \[m\].
    pub workspace: [[f64; 2]; 2],
    /// Silence of measurements after which the arm is faulty \[steps\].
    pub measurement_watchdog: i64,
    /// How long frames wait to be played out evenly \[steps\].
    pub buffer: i64,
    /// The arm's geometry.
    pub kinematics: Kinematics,
}

impl Facts {
    /// What `loaded` says; `None` for an arm that has not two joints.
    pub fn new(loaded: &Loaded) -> Option<Facts> {
        let scenario = &loaded.scenario;
        let model = loaded.arm.model.planar()?;
        let [first, second] = &model.joint[..] else {
            return None;
        };
        let joints = [first, second];
        let servo = &scenario.servo;
        Some(Facts {
            mapping: scenario.law.mapping(),
            guarantee: scenario.law.guarantee(),
            law: scenario.law.name().to_owned(),
            torque: joints.map(|joint| joint.motor_torque_limit),
            overspeed: joints.map(|joint| joint.velocity_limit * servo.overspeed_share),
            setpoint_speed: joints.map(|joint| joint.velocity_limit * servo.velocity_share),
            approach_speed: servo.approach_speed,
            hand_force: scenario.master.force_limit,
            hand_force_change: scenario.master.force_rate_limit * servo.period,
            joint_limits: joints.map(|joint| {
                let margin = servo.limit_margin;
                [joint.position_lower - margin, joint.position_upper + margin]
            }),
            workspace: [servo.workspace_lower, servo.workspace_upper],
            measurement_watchdog: steps(servo.measurement_watchdog),
            buffer: steps(scenario.link.buffer),
            kinematics: model.arm.kinematics(),
        })
    }

    /// The tip at these joint positions \[m\].
    pub fn tip(&self, joints: [f64; 2]) -> [f64; 2] {
        self.kinematics.forward(&Vector2::from(joints)).into()
    }

    /// Where the tip belongs when the hand is there \[m\].
    pub fn tip_of_hand(&self, hand: [f64; 3]) -> [f64; 2] {
        let (offset, scale) = (self.mapping.workspace_offset, self.mapping.position_scale);
        [0, 1].map(|axis: usize| offset[axis] + scale * hand[axis])
    }
}

/// Steps that fit into `seconds` \[s\], rounded up.
fn steps(seconds: f64) -> i64 {
    (seconds * 1e3).ceil() as i64
}
