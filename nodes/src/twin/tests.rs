//! The node's step, on a joint whose torque is written down here.

mod changes;
mod faults;
mod take_over;
mod two_joints;

use ferntast_identification::twin::Twin;
use ferntast_identification::{Dataset, Inertia, ModelSpec, RecordedSession, Term};
use ferntast_msgs::sample::Faults;

use super::*;
use crate::node::Output;

const PERIOD: f64 = 0.01;

/// Position, velocity, acceleration at `t` \[s\].
fn motion(t: f64) -> [f64; 3] {
    let mut motion = [0.0; 3];
    for (amplitude, rate) in [(0.25, 0.5), (0.08, 1.7), (0.02, 5.3)] {
        let (sine, cosine) = (rate * t).sin_cos();
        motion[0] += amplitude * sine;
        motion[1] += amplitude * rate * cosine;
        motion[2] -= amplitude * rate * rate * sine;
    }
    motion
}

/// Motor torque in that motion with that much viscous friction.
fn torque([_, qd, qdd]: [f64; 3], viscous: f64) -> f64 {
    1.2 * qdd + 6.0 * qd.signum() + viscous * qd
}

/// Position, and motor torque with that much viscous friction, at `t` \[s\].
fn joint(t: f64, viscous: f64, noise: f64) -> (f64, f64) {
    let motion = motion(t);
    (
        motion[0] + 1e-6 * noise,
        torque(motion, viscous) + 0.1 * noise,
    )
}

/// Near ±1, without a pattern.
fn noise(k: u64) -> f64 {
    let mut x = k.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(7);
    x ^= x >> 31;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 29;
    2.0 * (x >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
}

fn model() -> TwinModel {
    let coulomb_viscous = ["coulomb", "viscous"];
    model_of(&coulomb_viscous, Inertia::Given(1.2), true, |_, own| {
        torque(own, 13.0)
    })
}

/// A twin with those effects, fitted to a joint with that motor torque at the
/// time \[s\] and in the motion that it is given.
fn model_of(
    effects: &[&str],
    inertia: Inertia,
    joint_torque: bool,
    torque: impl Fn(f64, [f64; 3]) -> f64,
) -> TwinModel {
    let sessions = (0..3).map(|k| {
        let rows = (0..6000).map(|i| {
            let t = f64::from(i) * PERIOD + 500.0 * f64::from(k);
            let noise = noise(u64::from(i as u32) + 100_000 * k as u64);
            let motion = motion(t);
            (motion[0] + 1e-6 * noise, torque(t, motion) + 0.1 * noise)
        });
        let (position, motor_torque): (Vec<f64>, Vec<f64>) = rows.unzip();
        RecordedSession {
            name: format!("session {k}"),
            start: 500.0 * f64::from(k),
            period: PERIOD,
            joint_torque: joint_torque.then(|| vec![0.0; position.len()]),
            position,
            motor_torque,
            ..RecordedSession::default()
        }
    });
    let dataset = Dataset {
        sessions: sessions.collect(),
        ..Dataset::default()
    };
    let spec = ModelSpec {
        inertia,
        gear_ratio: None,
        effects: effects
            .iter()
            .map(|id| Term::Catalogue((*id).to_owned()))
            .collect(),
    };
    TwinModel {
        twin: Twin::new(&dataset, &spec, 20.0).unwrap(),
        joints: JointNames::numbered(2),
        joint: 1,
        joint_torque,
        temperature: false,
    }
}

/// The twin of one joint.
fn one(model: TwinModel, assessing: Assessing) -> TwinNode {
    TwinNode::new(JointNames::numbered(2), vec![model], assessing)
}

const START: Time = Time::from_nanos(1_700_000_000_000_000_000);

/// The samples of a moment: position of the joint, its torque free of load,
/// motor torque.
fn samples(stamp: Time, position: f64, torque: f64, k: u64) -> (JointSample, JointSample) {
    let sample = |effort: f64| {
        JointSample::empty(JointNames::numbered(2), stamp)
            .with_position([9.0, position])
            .with_effort([9.0, effort])
    };
    // A torque sensor that is free of load still makes noise.
    (sample(1e-6 * noise(k)), sample(torque))
}

/// Feeds the samples that `each` gives for every hundredth of a second `times`
/// after the start, one step each; whatever is published has to be valid.
fn feed(
    node: &mut TwinNode,
    times: std::ops::Range<f64>,
    each: impl Fn(f64, u64, Time) -> (JointSample, JointSample),
) -> Published {
    use ferntast_msgs::Message;
    let mut published = Published::default();
    let mut output = TwinNodeOutput::default();
    for k in (times.start / PERIOD).round() as u64..(times.end / PERIOD).round() as u64 {
        let now = START.plus_nanos(k as i64 * 10_000_000);
        let (measured, motor) = each(k as f64 * PERIOD, k, now);
        let mut input = TwinInput::default();
        input.measured_js.push(measured);
        input.motor_js.push(motor);
        output.clear();
        node.step(now, &input, &mut output);
        assert!(output.predicted.is_none_or(|own| own.check().is_ok()));
        assert!(output.residual.is_none_or(|own| own.check().is_ok()));
        assert!(output.parameters.is_none_or(|own| own.check().is_ok()));
        published.take(&output);
    }
    published
}

/// The joint as it should be, with that much viscous friction.
fn moving(viscous: f64) -> impl Fn(f64, u64, Time) -> (JointSample, JointSample) {
    move |t, k, stamp| {
        let (q, torque) = joint(t, viscous, noise(k + 17));
        samples(stamp, q, torque, k)
    }
}

/// Everything that the node published.
#[derive(Default)]
struct Published {
    predicted: Vec<JointSample>,
    residual: Vec<JointSample>,
    parameters: Vec<TwinParametersSample>,
    faults: Faults,
    words: Vec<Text<96>>,
}

impl Published {
    fn take(&mut self, output: &TwinNodeOutput) {
        self.predicted.extend(output.predicted);
        self.residual.extend(output.residual);
        self.parameters.extend(output.parameters);
        self.faults.0 |= output.health.faults.0;
        let words = output.health.message;
        if !words.is_empty() && self.words.last() != Some(&words) {
            self.words.push(words);
        }
    }

    fn last(&self) -> &TwinParametersSample {
        self.parameters.last().expect("parameters")
    }

    fn said(&self, words: &str) -> bool {
        self.words.iter().any(|own| own.as_str().contains(words))
    }
}

/// Steps at 1 kHz; every tenth has samples. `viscous` is that of the joint.
fn run(node: &mut TwinNode, seconds: f64, viscous: impl Fn(f64) -> f64) -> Published {
    let mut published = Published::default();
    let mut output = TwinNodeOutput::default();
    for step in 0..(seconds * 1000.0) as i64 {
        let now = START.plus_nanos(step * 1_000_000);
        let mut input = TwinInput::default();
        if step % 10 == 0 {
            let t = step as f64 * 1e-3;
            let (q, torque) = joint(t, viscous(t), noise(step as u64 + 17));
            let (measured, motor) = samples(now, q, torque, step as u64);
            input.measured_js.push(measured);
            input.motor_js.push(motor);
        }
        output.clear();
        node.step(now, &input, &mut output);
        published.take(&output);
    }
    published
}

#[test]
fn a_right_model_is_silent() {
    let mut node = one(model(), Assessing::Inline);
    let published = run(&mut node, 130.0, |_| 13.0);
    let last = published.parameters.last().unwrap();
    let own = node.twins[0]
        .twin
        .assess()
        .map(|diagnosis| diagnosis.verdict);
    assert_eq!(last.verdict, TwinVerdict::COMPLETE, "{own:?}");
    assert!(published.faults.is_empty(), "{:?}", published.words);
    // A message with the first row after a tenth of a second; lists with the model's two parameters,
    // and the fastest speed that they rest on.
    assert!((1000..=1300).contains(&published.parameters.len()));
    let names: Vec<&str> = last
        .names
        .iter()
        .take(last.len())
        .map(Text::as_str)
        .collect();
    assert_eq!(names, ["b0", "b1", "v_seen"]);
    assert!((0.1..1.0).contains(&last.values[2]), "{}", last.values[2]);
    assert!((last.values[0] - 6.0).abs() < 0.1 && (last.values[1] - 13.0).abs() < 0.3);
    // Stamps are those of the samples, in order; the other joint is zero.
    let predicted = &published.predicted;
    assert!(predicted.windows(2).all(|two| two[0].stamp < two[1].stamp));
    let delay = START
        .plus_nanos(130_000_000_000)
        .seconds_since(predicted.last().unwrap().stamp);
    assert!(delay > 0.0 && delay < 0.5, "{delay}");
    assert!(
        predicted
            .iter()
            .all(|own| own.effort[0] == 0.0 && own.position[0] == 0.0)
    );
    // The residual is there where the joint slides, and is what noise leaves.
    let squares = published.residual.iter().map(|own| own.effort[1].powi(2));
    let rms = (squares.sum::<f64>() / published.residual.len() as f64).sqrt();
    assert!(published.residual.len() < predicted.len());
    assert!(rms < 0.1 && rms > 1e-4, "{rms}");
}

#[test]
fn a_step_raises_the_alarm_and_is_told_in_words() {
    let mut node = one(model(), Assessing::Inline);
    let published = run(&mut node, 130.0, |t| if t > 50.0 { 25.0 } else { 13.0 });
    assert!(published.faults.has(Fault::ResidualOutOfBand));
    let last = published.parameters.last().unwrap();
    assert_eq!(last.out_of_band, 1);
    assert_eq!(
        (last.changed.as_str(), last.change_kind.as_str()),
        ("b1", "step")
    );
    assert!((last.change_before - 13.0).abs() < 0.3 && (last.change_after - 25.0).abs() < 1.5);
    assert!(
        (45.0..75.0).contains(&last.change_time),
        "{}",
        last.change_time
    );
    let said = published.words.last().unwrap().as_str();
    assert!(said.contains("b1 stepped from 13"), "{said}");
    assert!(said.contains("velocity") || said.contains("time"), "{said}");
}

#[test]
fn the_same_samples_give_the_same_messages() {
    let mut runs = [0, 1].map(|_| run(&mut one(model(), Assessing::Inline), 30.0, |_| 14.0));
    let [first, second] = &mut runs;
    assert_eq!(first.predicted, second.predicted);
    assert_eq!(first.residual, second.residual);
    assert_eq!(first.parameters, second.parameters);
}

#[test]
fn on_a_thread_the_lab_s_answer_comes_too() {
    let mut node = one(model(), Assessing::OnThread);
    run(&mut node, 130.0, |_| 13.0);
    let end = std::time::Instant::now() + std::time::Duration::from_secs(60);
    while node.twins[0].assessor.newest().verdict.is_none() && std::time::Instant::now() < end {
        std::thread::sleep(std::time::Duration::from_millis(10));
        let twin = node.twins[0].twin.clone();
        node.twins[0].assessor.step(&twin, 130.0);
    }
    assert_eq!(
        node.twins[0].assessor.newest().code(),
        TwinVerdict::COMPLETE
    );
}

#[test]
fn nothing_heard_is_a_fault() {
    let mut node = one(model(), Assessing::Inline);
    let mut output = TwinNodeOutput::default();
    let input = TwinInput::default();
    node.step(START, &input, &mut output);
    assert!(output.health.faults.has(Fault::MeasurementSilent));
    assert!(output.parameters.is_none());
}
