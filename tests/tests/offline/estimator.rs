//! The estimator in a session with contact, against the truth of the simulated arm.
//!
//! The truth is on no topic. It is found again: an arm with the session's
//! configuration and seed, given the torques that were recorded, measures
//! what was recorded, byte for byte; so it is where the session's arm was.

use std::fs;

use ferntast_model::contour::Surface;
use ferntast_msgs::{
    sample::{ContactStateSample, Edge},
    topics,
};
use ferntast_sim::arm::{ArmConfig, SimulatedArm, Truth};
use ferntast_tests::{Session, messages, number, run};

const ARM: &str = include_str!("../../../config/arms/rokviss.toml");
const SCENARIO: &str = include_str!("sliding.toml");
/// The scenario's.
const SEED: u64 = 1;
/// A torque older than this [s] does not move the arm.
const COMMAND_LIFE: f64 = 0.010;

/// The truth at every measurement of the recording, with the contact as it was estimated then.
fn recorded(session: &Session, arm: &str, scenario: &str) -> Vec<(Truth, ContactStateSample)> {
    let config: ArmConfig = toml::from_str(arm).expect("config/arms");
    let folder = session.folder();
    fs::write(folder.join("arm.toml"), arm).expect("scratch");
    let scenario = scenario.replace(
        "arm = \"rokviss\"",
        &format!("arm = {:?}", folder.join("arm.toml")),
    );
    fs::write(folder.join("sliding.toml"), scenario).expect("scratch");
    let path = folder.join("run");
    let scenario = folder.join("sliding.toml");
    let text = |path: &std::path::Path| path.to_str().expect("a path in UTF-8").to_owned();
    let (scenario, record) = (&text(&scenario), &text(&path));
    let summary = run(
        session,
        &[
            "lockstep",
            "--scenario",
            scenario,
            "--record",
            record,
            "--json",
        ],
    )
    .success()
    .json();
    assert_eq!(summary["states"]["follower"]["final"], "ENABLED");
    assert!(number(&summary, "contact.peak_normal_force_N") > 10.0);

    let torques = messages(&path, topics::FOLLOWER_SERVO_JF);
    let measured = messages(&path, topics::FOLLOWER_MEASURED_JS);
    let contacts = messages(&path, topics::FOLLOWER_CONTACT_STATE);
    let mut arm = SimulatedArm::new(&config, SEED).expect("valid");
    let mut torques = torques.iter().map(|received| received.message).peekable();
    let mut contacts = contacts.iter().map(|received| received.message).peekable();
    let (mut torque, mut last) = (None, None);
    let mut pairs = Vec::new();
    for sample in measured.iter().map(|received| received.message) {
        let now = sample.stamp;
        while let Some(next) = torques.next_if(|next| next.stamp < now) {
            torque = Some(next);
        }
        if let Some(last) = last {
            let effort = torque
                .filter(|torque| now.seconds_since(torque.stamp) <= COMMAND_LIFE)
                .map_or([0.0; 2], |torque| torque.effort);
            arm.advance(effort, now.seconds_since(last));
        }
        last = Some(now);
        let again = arm.measure();
        assert_eq!(again.motor_position, sample.position, "at {now:?}");
        assert_eq!(again.joint_torque, sample.effort, "at {now:?}");
        // The estimate is stamped with the measurement it was made from.
        while contacts.next_if(|next| next.stamp < now).is_some() {}
        if let Some(contact) = contacts.next_if(|next| next.stamp == now) {
            pairs.push((arm.truth(), contact));
        }
    }
    assert!(pairs.len() > 20_000, "{}", pairs.len());
    pairs
}

fn rms(errors: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for error in errors {
        sum += error * error;
        count += 1.0;
    }
    f64::sqrt(sum / count)
}

/// Speed of the faster joint \[deg/s\].
fn speed(truth: &Truth) -> f64 {
    let [one, two] = truth.velocity;
    one.abs().max(two.abs()).to_degrees()
}

#[test]
fn forces_in_a_session_are_within_five_percent_of_their_peak() {
    for form in ["direct", "momentum_observer"] {
        let session = Session::new();
        let text = ARM.replace("form = \"direct\"", &format!("form = {form:?}"));
        let config: ArmConfig = toml::from_str(&text).expect("config/arms");
        let ticks = recorded(&session, &text, SCENARIO);
        for (surface, edge) in [
            (Surface::Lubricated, Edge::LUBRICATED),
            (Surface::Unlubricated, Edge::UNLUBRICATED),
        ] {
            let sliding: Vec<_> = ticks
                .iter()
                .filter(|(truth, contact)| {
                    truth.surface == Some(surface)
                        && contact.edge == edge
                        && contact.valid == 1
                        && contact.near_rest == 0
                        && (1.0..=40.0).contains(&speed(truth))
                })
                .collect();
            let against = |truth: &Truth| -truth.tangential_force * truth.sliding_velocity.signum();
            let fastest = sliding.iter().map(|(t, _)| speed(t)).fold(0.0, f64::max);
            let slowest = sliding.iter().map(|(t, _)| speed(t)).fold(90.0, f64::min);
            let normal_peak = sliding
                .iter()
                .map(|(t, _)| t.normal_force)
                .fold(0.0, f64::max);
            let tangential_peak = sliding
                .iter()
                .map(|(t, _)| against(t).abs())
                .fold(0.0, f64::max);
            let normal = rms(sliding.iter().map(|(t, c)| c.normal_force - t.normal_force));
            let tangential = rms(sliding.iter().map(|(t, c)| c.tangential_force - against(t)));
            println!(
                "{form} {surface:?}: {} ticks at {slowest:.1} to {fastest:.1} deg/s, F_N {normal:.3} of {normal_peak:.1} N ({:.1} %), \
                 F_T {tangential:.3} of {tangential_peak:.1} N ({:.1} %)",
                sliding.len(),
                100.0 * normal / normal_peak,
                100.0 * tangential / tangential_peak,
            );
            assert!(sliding.len() > 1000 && fastest > 35.0 && slowest < 1.1);
            assert!(normal > 0.0 && normal < 0.05 * normal_peak);
            assert!(tangential > 0.0 && tangential < 0.05 * tangential_peak);
            let found = ticks.iter().rev().find(|(_, contact)| contact.edge == edge);
            let (_, found) = found.expect("contact");
            let truth = &config.truth.surface;
            let (surface, day) = (
                if edge == Edge::LUBRICATED {
                    truth.lubricated
                } else {
                    truth.unlubricated
                },
                config.truth.environment.day,
            );
            let wear = surface.wear.expect("it wears");
            let expected = wear.worn_friction
                + (surface.friction - wear.worn_friction) * (-day / wear.days).exp();
            println!(
                "  b_0T {:.4} ± {:.4} of {expected:.4}",
                found.friction_coefficient, found.friction_coefficient_error
            );
            assert!((found.friction_coefficient - expected).abs() < 0.02);
            assert!(found.friction_coefficient_error < 0.01);
        }
        // From the newtons that make a contact to its being told.
        let on = config.estimator.contact_on;
        let mut slowest = 0;
        for (index, pair) in ticks.windows(2).enumerate() {
            let [(before, told), (after, _)] = pair else {
                continue;
            };
            if before.normal_force <= on && after.normal_force > on && told.in_contact == 0 {
                let rest = ticks[index + 1..].iter();
                let lasts = rest
                    .clone()
                    .take(20)
                    .all(|(truth, _)| truth.normal_force > on);
                let late = rest
                    .take_while(|(_, contact)| contact.in_contact == 0)
                    .count();
                if lasts {
                    println!(
                        "  contact at {:.1} deg/s told after {late} ms",
                        speed(after)
                    );
                    slowest = slowest.max(late);
                }
            }
        }
        assert!(slowest > 0 && slowest <= 10, "{slowest} ms");
    }
}
