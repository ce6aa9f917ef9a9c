//! What changes while it watches: which parameter, and whether at once.

use super::*;

/// Feeds a joint with that motor torque for `seconds`; its last word.
fn watched(
    mut node: TwinNode,
    seconds: f64,
    torque: impl Fn(f64, [f64; 3]) -> f64,
) -> (TwinParametersSample, Published) {
    let published = feed(&mut node, 0.0..seconds, |t, k, stamp| {
        let (motion, noise) = (motion(t), noise(k + 17));
        let position = motion[0] + 1e-6 * noise;
        samples(stamp, position, torque(t, motion) + 0.1 * noise, k)
    });
    (*published.last(), published)
}

/// Coulomb friction falls while the joint warms up.
#[test]
fn a_temperature_that_rises_is_a_drift_of_coulomb_friction() {
    let node = one(model(), Assessing::Inline);
    let (last, published) = watched(node, 300.0, |t, own| {
        torque(own, 13.0) - 2.0 * (1.0 - (-t / 100.0).exp()) * own[1].signum()
    });
    assert_eq!(
        (last.changed.as_str(), last.change_kind.as_str()),
        ("b0", "drift")
    );
    assert!((last.change_before - 6.0).abs() < 0.1, "{last:?}");
    assert!((last.change_after - 4.1).abs() < 0.2, "{last:?}");
    assert!(published.said("b0 drifted from"));
}

/// Friction at a spot of the gear: exp(−((q − 0.05)/0.06)²) sign q̇.
fn at_the_spot([q, qd, _]: [f64; 3]) -> f64 {
    (-((q - 0.05) / 0.06).powi(2)).exp() * qd.signum()
}

/// The spot is known, and wears further: its own parameter steps.
#[test]
fn a_spot_that_wears_is_a_step_of_its_parameter() {
    let known = ["coulomb", "viscous", "local_friction"];
    let model = model_of(&known, Inertia::Given(1.2), true, |_, own| {
        torque(own, 13.0) + 2.0 * at_the_spot(own)
    });
    let node = one(model, Assessing::Inline);
    let (last, _) = watched(node, 180.0, |t, own| {
        let worn = if t > 60.0 { 6.0 } else { 2.0 };
        torque(own, 13.0) + worn * at_the_spot(own)
    });
    assert_eq!(
        (last.changed.as_str(), last.change_kind.as_str()),
        ("bl", "step")
    );
    assert!((last.change_after - 6.0).abs() < 0.5, "{last:?}");
}

/// The spot was not there when the model was made: the residual goes with the position, and the lab names it.
#[test]
fn a_new_spot_raises_the_alarm_and_is_named() {
    let node = one(model(), Assessing::Inline);
    let (last, published) = watched(node, 240.0, |_, own| {
        torque(own, 13.0) + 4.0 * at_the_spot(own)
    });
    assert!(published.faults.has(Fault::ResidualOutOfBand));
    assert!(last.goes_with.as_str().contains("position"), "{last:?}");
    assert_eq!(last.verdict, TwinVerdict::MISSING, "{last:?}");
    assert_eq!(last.candidate.as_str(), "local_friction");
}

/// A payload is taken up: without a torque sensor the inertia steps. (With one
/// the joint's own model does not see it, as it should not.)
#[test]
fn a_payload_is_a_step_of_the_inertia() {
    let with_load = |inertia: f64, own: [f64; 3]| torque(own, 13.0) + (inertia - 1.2) * own[2];
    let model = model_of(&["coulomb", "viscous"], Inertia::Fit, false, |_, own| {
        with_load(3.0, own)
    });
    let node = one(model, Assessing::Inline);
    let (last, published) = watched(node, 160.0, |t, own| {
        with_load(if t > 60.0 { 5.0 } else { 3.0 }, own)
    });
    assert_eq!(
        (last.changed.as_str(), last.change_kind.as_str()),
        ("inertia", "step"),
        "{:?}",
        published.words
    );
    assert!((last.change_before - 3.0).abs() < 0.1, "{last:?}");
    assert!((last.change_after - 5.0).abs() < 0.3, "{last:?}");
}
