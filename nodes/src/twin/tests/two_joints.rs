//! Two joints, a twin for each.

use super::*;

/// Joint 1 with that much viscous friction, joint 2 as it should be.
fn both(viscous: f64) -> impl Fn(f64, u64, Time) -> (JointSample, JointSample) {
    move |t, k, stamp| {
        let (q, torque) = joint(t, viscous, noise(k + 17));
        let (_, other) = joint(t, 13.0, noise(k + 17));
        let sample = JointSample::empty(JointNames::numbered(2), stamp);
        let load = 1e-6 * noise(k);
        (
            sample.with_position([q, q]).with_effort([load, load]),
            sample.with_position([q, q]).with_effort([torque, other]),
        )
    }
}

#[test]
fn they_share_a_message_speak_in_turn_and_are_told_apart() {
    let first = TwinModel {
        joint: 0,
        ..model()
    };
    let joints = JointNames::numbered(2);
    let mut node = TwinNode::new(joints, vec![first, model()], Assessing::Inline);
    let published = feed(&mut node, 0.0..60.0, both(25.0));
    let predicted = &published.predicted;
    assert!(predicted.windows(2).all(|two| two[0].stamp < two[1].stamp));
    // The same motion and the same model off line: the same torque, in one message.
    let apart = predicted.iter().map(|own| own.effort[0] - own.effort[1]);
    assert!(apart.fold(0.0, |most: f64, own| most.max(own.abs())) < 1e-9);
    let rms = |joint: usize| {
        let squares = published
            .residual
            .iter()
            .map(|own| own.effort[joint].powi(2));
        (squares.sum::<f64>() / published.residual.len() as f64).sqrt()
    };
    assert!(rms(0) > 10.0 * rms(1), "{} {}", rms(0), rms(1));
    let of = |name: &str| {
        let own = published.parameters.iter();
        let own: Vec<_> = own.filter(|own| own.joint.as_str() == name).collect();
        assert!((450..=610).contains(&own.len()), "{name}: {}", own.len());
        (own[own.len() - 1].values[1], own[own.len() - 1].out_of_band)
    };
    let ((worn, out), (good, within)) = (of("joint_1"), of("joint_2"));
    assert!((worn - 25.0).abs() < 1.5 && out == 1, "{worn} {out}");
    assert!((good - 13.0).abs() < 0.3 && within == 0, "{good} {within}");
    assert!(published.said("joint_1: ") && !published.said("joint_2: "));
}
