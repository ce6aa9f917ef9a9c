//! What the twin follows, the servo feeds forward.

use ferntast_control::servo::ServoConfig;
use ferntast_msgs::sample::{FrictionCommand, FrictionCommandSample, FrictionSource};

use super::*;
use crate::servo::{ServoInput, ServoNode, ServoOutput};

/// Joint 2 as the arm's file has it, free of load, and a bump near rest.
fn bumpy([_, qd, qdd]: [f64; 3]) -> f64 {
    let bump = 4.0 * (-(qd / 0.08).powi(2)).exp() * qd.signum();
    let viscous = qd * (163.301 - 578.954 * qd.abs() + 547.449 * qd * qd);
    1.2 * qdd + 12.372 * qd.signum() + viscous + bump
}

#[test]
fn a_stribeck_effect_that_the_twin_follows_is_fed_forward() {
    let known = [
        "coulomb",
        "viscous",
        "quadratic_viscous",
        "cubic_viscous",
        "stribeck",
    ];
    let model = model_of(&known, Inertia::Given(1.2), true, |_, own| bumpy(own));
    let mut twin = one(model, Assessing::Inline);
    let published = feed(&mut twin, 0.0..55.0, |t, k, stamp| {
        let (motion, noise) = (motion(t), noise(k + 17));
        let torque = bumpy(motion) + 0.1 * noise;
        samples(stamp, motion[0] + 1e-6 * noise, torque, k)
    });
    let mut word = *published.last();

    let arm = ferntast_config::load_model_only("rokviss").unwrap();
    let mut servo = ServoNode::new(&arm.model, &ServoConfig::default()).unwrap();
    let mut status = None;
    for k in 1..3_000 {
        let now = START.plus_nanos(k * 1_000_000);
        word.stamp = now;
        let mut input = ServoInput::default();
        input.twin.push(word);
        if k == 1 {
            let command = FrictionCommandSample::new(now, FrictionCommand::TAKE_OVER);
            input.friction_command.push(command);
        }
        let mut output = ServoOutput::default();
        servo.step(now, &input, &mut output);
        status = output.friction[1].or(status);
    }
    let status = status.unwrap();
    assert_eq!(status.source, FrictionSource::TWIN, "{status:?}");
    let value = |name: &str| {
        let mut own = (0..status.len()).filter(|i| status.names[*i].as_str() == name);
        own.next().map(|i| status.values[i]).unwrap()
    };
    assert!((value("bs") - 4.0).abs() < 0.3, "{}", value("bs"));
    assert!((value("vs") - 0.08).abs() < 0.01, "{}", value("vs"));
    assert!((value("b_0") - 12.372).abs() < 0.3, "{}", value("b_0"));
    assert_eq!(status.configured[status.len() - 1], 0.0);
}
