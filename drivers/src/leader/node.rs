//! The leader arm's node: topics of the master on one side, a driver on the other.

use ferntast_config::Axes;
use ferntast_control::{
    LONGEST_STEP,
    haptics::{FORCE_LIFE, LeaderArm},
};
use ferntast_model::{Joints, serial_arm::SerialArm};
use ferntast_msgs::{
    Text, Time,
    sample::{
        AuthoritySample, Fault, Frame, Level, OperatingState, OperatingStateSample, PoseSample,
        WrenchSample,
    },
};
use ferntast_nodes::node::{Node, NodeHealth, ports};

use super::device::Device;
use crate::driver::{DriverCommand, Reading};

/// How this hand is told from others.
pub const SOURCE: u64 = 0x6c65_6164_6572_0000;
/// What the joints said counts for so long [s].
const READING_LIFE: f64 = 0.025;

ports! {
    /// The leader arm's topics.
    LeaderPorts for LeaderNode;
    /// What it takes.
    input LeaderInput {
        force: Newest<WrenchSample> = LEADER_SERVO_CF,
        authority: Newest<AuthoritySample> = LEADER_AUTHORITY,
        state: Newest<OperatingStateSample> = LEADER_OPERATING_STATE,
    }
    /// What it gives.
    output LeaderOutput { measured_cp: PoseSample = LEADER_MEASURED_CP, }
}

/// The leader arm's node.
pub struct LeaderNode {
    device: Device,
    law: LeaderArm,
    /// No torque.
    none: Joints<f64>,
    axes: Axes,
    /// Whether the tool turns with its tip.
    turns: bool,
    renders_force: bool,
    enabled: bool,
    /// What the joints said last, and when.
    reading: Option<(Time, Reading)>,
    last: Option<Time>,
}

impl LeaderNode {
    /// The node of the arm `arm` behind `device`, whose base has those `axes`; `turns` says whether
    /// the hand has an orientation.
    pub fn new(device: Device, arm: SerialArm, axes: Axes, turns: bool) -> LeaderNode {
        LeaderNode {
            renders_force: device.gives_torque(),
            device,
            none: Joints::filled(arm.count(), 0.0),
            law: LeaderArm::new(arm),
            axes,
            turns,
            enabled: false,
            reading: None,
            last: None,
        }
    }

    /// Whether there is a force in the hand at all.
    pub fn renders_force(&self) -> bool {
        self.renders_force
    }

    /// What is behind it, for those who look at what is true.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// What the hand is to feel, axes of the arm's base \[N\].
    fn wanted(&self, now: Time, input: &LeaderInput) -> Option<[f64; 3]> {
        let enabled = |own: &OperatingStateSample| own.state == OperatingState::ENABLED;
        let holds = |own: &AuthoritySample| own.holder == SOURCE;
        let counts = input.state.message.as_ref().is_some_and(enabled)
            && input.authority.message.as_ref().is_some_and(holds)
            && input.force.silence(now) <= FORCE_LIFE;
        let force = input.force.message.filter(|_| counts)?;
        Some(self.axes.to_device(force.force))
    }

    /// The joints' torques by what they said last, where that counts still.
    fn torques(
        &mut self,
        now: Time,
        dt: f64,
        wanted: Option<[f64; 3]>,
        health: &mut NodeHealth,
    ) -> Option<Joints<f64>> {
        let (heard, reading) = self.reading.as_ref()?;
        if now.seconds_since(*heard) > READING_LIFE {
            self.law.release();
            health.raise(Fault::MeasurementSilent, Level::WARN);
            return None;
        }
        let step = self
            .law
            .torques(dt, &reading.position, &reading.velocity, wanted);
        if step.let_go {
            health.raise(Fault::ForceLimited, Level::WARN);
            health.message = Text::new("the leader arm runs away: hold it; no force until then");
        } else if step.limited {
            health.raise(Fault::ForceLimited, Level::OK);
        }
        Some(step.torque)
    }

    fn pose(&self, now: Time, reading: &Reading) -> PoseSample {
        let hand = self.law.hand(&reading.position);
        let position = self.axes.to_leader(hand.position);
        let mut pose = PoseSample {
            source: SOURCE,
            ..PoseSample::at(now, Frame::LEADER_BASE, position)
        };
        if self.turns {
            let [x, y, z, w] = hand.orientation;
            let [x, y, z] = self.axes.to_leader([x, y, z]);
            pose.orientation = [x, y, z, w];
        }
        pose
    }
}

impl Node for LeaderNode {
    type Input = LeaderInput;
    type Output = LeaderOutput;

    fn failure(&self) -> Option<String> {
        self.device.failure()
    }

    fn step(&mut self, now: Time, input: &LeaderInput, output: &mut LeaderOutput) {
        let since = |last| now.seconds_since(last).clamp(0.0, LONGEST_STEP);
        let elapsed = self.last.map(since);
        self.last = Some(now);
        let health = &mut output.health;
        let silence = input.force.silence(now);
        health.input_age = if silence.is_finite() {
            silence
        } else {
            f64::NAN
        };
        let state = input.state.message.map(|own| own.state);
        self.device
            .set_running(state.is_some_and(|own| own != OperatingState::DISABLED));

        let wanted = self.wanted(now, input);
        let torques = self.torques(now, elapsed.unwrap_or(0.0), wanted, health);
        let torques = torques.filter(|_| self.renders_force);
        let driver = self.device.driver();
        if self.enabled != torques.is_some() {
            self.enabled = torques.is_some();
            driver.enable(self.enabled);
        }
        let command = DriverCommand {
            torque: torques.unwrap_or(self.none),
            elapsed,
        };
        driver.write(&command, health);
        let homed = driver.is_homed();
        let reading = driver.read(health).filter(|_| homed);
        let finite = |own: &Reading| {
            let mut values = own.position.iter().chain(own.velocity.iter());
            values.all(|value| value.is_finite())
        };
        if let Some(reading) = reading.filter(finite) {
            output.measured_cp = Some(self.pose(now, &reading));
            self.reading = Some((now, reading));
        }
        if !self.renders_force && health.message.is_empty() {
            health.message = Text::new("the leader arm is limp: its drives cannot be told torques");
        }
    }
}
