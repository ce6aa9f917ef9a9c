//! A flexible joint against a brake: the test bench of the second paper.
//!
//! Motor side θ and link side q, joined by a gear that is stiffer the more it
//! is twisted and weaker at some positions; friction on both sides; a magnetic
//! powder brake as the load, whose torque fluctuates about what is commanded.
//! A position loop follows a sum of sines, with rests in between.
//!
//! ```text
//! J_m θ̈ + b_in θ̇ + b_inD sign θ̇ + τ_s = τ_m
//! J_l q̈ + b_out q̇ + b_outC sign q̇ + τ_b sign q̇ = τ_s = k_1 Δ + k_2 Δ³,  Δ = θ − q
//! ```
//!
//! Only the paper's last page is at hand. It names k_1, k_2, b_in, b_inD,
//! b_out, b_outC, the brake and the gear's weakness, and gives no equation.
//! Read here: k_1 and k_2 as the linear and the cubic coefficient of the
//! spring, the index C as Coulomb friction, D as dry friction of the input side.

mod parameters;

pub use parameters::FlexibleJointParameters;

use ferntast_emulation::random::Random;

/// Period of the log \[s\].
pub const LOG_PERIOD: f64 = 0.001;
/// Integration steps in one period of the log.
const STEPS: usize = 20;
/// Speed over which dry friction turns round \[rad/s\].
const TURNING_SPEED: f64 = 0.002;
/// Standard deviation of both encoders \[rad\].
const ENCODER_NOISE: f64 = 3e-6;
/// Standard deviation of both torque signals \[Nm\].
const TORQUE_NOISE: f64 = 0.1;
/// The position loop's own frequency \[rad/s\] and damping \[1\].
const SERVO: (f64, f64) = (25.0, 0.8);

/// What the bench does in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlexibleJointRun {
    /// Seed of noise and fluctuation.
    pub seed: u64,
    /// Length \[s\].
    pub duration: f64,
    /// From when to when the joint rests, brake released \[s\].
    pub rest: Option<[f64; 2]>,
    /// From when on the input side's viscous friction is multiplied by the second number.
    pub change: Option<(f64, f64)>,
}

/// What the bench logs, [`LOG_PERIOD`] apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlexibleJointRecording {
    /// θ, motor encoder on the joint side \[rad\].
    pub motor_position: Vec<f64>,
    /// q, link encoder \[rad\].
    pub position: Vec<f64>,
    /// τ_m \[Nm\].
    pub motor_torque: Vec<f64>,
    /// τ_s, joint torque sensor \[Nm\].
    pub joint_torque: Vec<f64>,
    /// Commanded torque of the brake, without sign \[Nm\].
    pub brake_torque: Vec<f64>,
}

#[derive(Clone, Copy, Default)]
struct State {
    motor: [f64; 2],
    link: [f64; 2],
}

/// Runs the bench. Same arguments, same bytes.
#[must_use]
pub fn record(
    parameters: &FlexibleJointParameters,
    run: &FlexibleJointRun,
) -> FlexibleJointRecording {
    let mut truth = *parameters;
    let mut random = Random::new(run.seed);
    let mut recording = FlexibleJointRecording::default();
    let mut state = State::default();
    let mut fluctuation = 0.0;
    let step = LOG_PERIOD / STEPS as f64;
    let keep = (-LOG_PERIOD / truth.brake_correlation).exp();
    let mut phase = 0.0;
    for sample in 0..(run.duration / LOG_PERIOD).round() as usize {
        let time = sample as f64 * LOG_PERIOD;
        let rests = run
            .rest
            .is_some_and(|[from, to]| (from..to).contains(&time));
        if let Some((from, factor)) = run.change {
            truth.b_in = parameters.b_in * if time >= from { factor } else { 1.0 };
        }
        // At rest the trajectory stands still, and goes on where it stopped.
        phase += if rests { 0.0 } else { LOG_PERIOD };
        let brake = if rests { 0.0 } else { commanded_brake(phase) };
        fluctuation = keep * fluctuation
            + truth.brake_fluctuation * (1.0 - keep * keep).sqrt() * random.normal();
        let motor_torque = servo(&truth, &state, desired(phase), !rests);
        for _ in 0..STEPS {
            integrate(
                &truth,
                &mut state,
                motor_torque,
                brake * (1.0 + fluctuation),
                step,
            );
        }
        let twist = state.motor[0] - state.link[0];
        let joint_torque = truth.spring(twist, state.link[0]);
        let noise = ENCODER_NOISE * random.normal();
        recording.motor_position.push(state.motor[0] + noise);
        let noise = ENCODER_NOISE * random.normal();
        recording.position.push(state.link[0] + noise);
        // The current acts over the whole period; its mean is half a period old.
        let noise = TORQUE_NOISE * random.normal();
        recording.motor_torque.push(motor_torque + noise);
        let noise = TORQUE_NOISE * random.normal();
        recording.joint_torque.push(joint_torque + noise);
        recording.brake_torque.push(brake);
    }
    recording
}

/// Desired position, velocity and acceleration \[rad, rad/s, rad/s²\].
fn desired(time: f64) -> [f64; 3] {
    const SINES: [(f64, f64, f64); 3] = [(0.55, 0.45, 0.0), (0.20, 1.30, 0.9), (0.06, 3.10, 2.1)];
    let mut sum = [0.0; 3];
    for (amplitude, omega, phase) in SINES {
        let angle = omega * time + phase;
        sum[0] += amplitude * (angle.sin() - f64::sin(phase));
        sum[1] += amplitude * omega * angle.cos();
        sum[2] -= amplitude * omega * omega * angle.sin();
    }
    sum
}

/// Commanded brake torque \[Nm\].
fn commanded_brake(time: f64) -> f64 {
    22.0 + 16.0 * (0.37 * time).sin()
}

fn servo(
    truth: &FlexibleJointParameters,
    state: &State,
    [position, velocity, acceleration]: [f64; 3],
    moving: bool,
) -> f64 {
    let (omega, damping) = SERVO;
    let inertia = truth.motor_inertia + truth.load_inertia;
    let (velocity, acceleration) = if moving {
        (velocity, acceleration)
    } else {
        (0.0, 0.0)
    };
    inertia
        * (acceleration
            + omega * omega * (position - state.motor[0])
            + 2.0 * damping * omega * (velocity - state.motor[1]))
}

/// One semi-implicit Euler step of `step` \[s\].
fn integrate(
    truth: &FlexibleJointParameters,
    state: &mut State,
    motor_torque: f64,
    brake: f64,
    step: f64,
) {
    let dry = |velocity: f64| (velocity / TURNING_SPEED).tanh();
    let spring = truth.spring(state.motor[0] - state.link[0], state.link[0]);
    let (motor_speed, link_speed) = (state.motor[1], state.link[1]);
    let input = truth.b_in * motor_speed + truth.b_in_dry * dry(motor_speed);
    let output = truth.b_out * link_speed + (truth.b_out_coulomb + brake) * dry(link_speed);
    state.motor[1] += (motor_torque - spring - input) / truth.motor_inertia * step;
    state.link[1] += (spring - output) / truth.load_inertia * step;
    state.motor[0] += state.motor[1] * step;
    state.link[0] += state.link[1] * step;
}

#[cfg(test)]
mod tests {
    use super::*;

    const RUN: FlexibleJointRun = FlexibleJointRun {
        seed: 1,
        duration: 20.0,
        rest: Some([8.0, 12.0]),
        change: None,
    };

    #[test]
    fn the_same_seed_gives_the_same_bytes() {
        let truth = FlexibleJointParameters::default();
        assert_eq!(record(&truth, &RUN), record(&truth, &RUN));
        let other = FlexibleJointRun { seed: 2, ..RUN };
        assert_ne!(record(&truth, &RUN), record(&truth, &other));
    }

    #[test]
    fn it_follows_and_rests() {
        let log = record(&FlexibleJointParameters::default(), &RUN);
        let position = |time: f64| log.position[(time / LOG_PERIOD) as usize];
        assert!((position(7.0) - desired(7.0)[0]).abs() < 0.02);
        assert!((position(9.5) - position(11.5)).abs() < 1e-3);
        let most = log
            .position
            .iter()
            .fold(0.0, |most: f64, q| most.max(q.abs()));
        assert!((0.3..1.5).contains(&most), "{most}");
    }

    /// The twist at the largest torque is what the cubic spring says, weakness aside.
    #[test]
    fn twist_and_torque_go_together() {
        let truth = FlexibleJointParameters {
            gear_weakness: 0.0,
            ..FlexibleJointParameters::default()
        };
        let log = record(&truth, &RUN);
        let (mut most, mut cubic) = (0.0_f64, 0.0_f64);
        for at in 0..log.position.len() {
            let twist = log.motor_position[at] - log.position[at];
            let torque = truth.k1 * twist + truth.k2 * twist.powi(3);
            assert!((torque - log.joint_torque[at]).abs() < 1.0);
            most = most.max(torque.abs());
            cubic = cubic.max((truth.k2 * twist.powi(3) / torque).abs());
        }
        assert!((30.0..120.0).contains(&most), "{most}");
        assert!((0.05..0.5).contains(&cubic), "{cubic}");
    }
}
