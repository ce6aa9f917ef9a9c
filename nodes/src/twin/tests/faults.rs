//! What sensors and clocks may do to it: finite, flagged, and on it goes.

use super::*;

/// It has recovered: silent, and its parameters are those of the joint.
fn recovers(node: &mut TwinNode, from: f64) {
    feed(node, from..from + 60.0, moving(13.0));
    let after = feed(node, from + 60.0..from + 120.0, moving(13.0));
    // The lab may go on to ask what came in meanwhile.
    for fault in after.faults.iter() {
        assert_eq!(fault, Fault::ModelIncomplete, "{:?}", after.words);
    }
    let last = after.last();
    assert_eq!(last.out_of_band, 0);
    assert!((last.values[0] - 6.0).abs() < 0.3, "{last:?}");
    assert!((last.values[1] - 13.0).abs() < 0.6, "{last:?}");
    assert!(after.residual.len() > 500);
}

fn started() -> TwinNode {
    let mut node = one(model(), Assessing::Inline);
    feed(&mut node, 0.0..40.0, moving(13.0));
    node
}

#[test]
fn numbers_that_are_none_are_flagged() {
    let mut node = started();
    let nan = |t, k, stamp| {
        let (mut measured, mut motor) = moving(13.0)(t, k, stamp);
        match k % 3 {
            0 => measured.position[1] = f64::NAN,
            1 => measured.effort[1] = f64::INFINITY,
            _ => motor.effort[1] = f64::NEG_INFINITY,
        }
        (measured, motor)
    };
    let published = feed(&mut node, 40.0..45.0, nan);
    assert!(published.faults.has(Fault::MeasurementInvalid));
    assert!(published.said("no numbers"), "{:?}", published.words);
    recovers(&mut node, 45.0);
}

#[test]
fn a_sensor_that_hangs_is_flagged_by_name() {
    let mut node = started();
    let encoder = |t, k, stamp| {
        let (_, motor) = moving(13.0)(t, k, stamp);
        let (measured, _) = samples(stamp, 0.123, 0.0, k);
        (measured, motor)
    };
    let published = feed(&mut node, 40.0..60.0, encoder);
    assert!(published.faults.has(Fault::MeasurementInvalid));
    assert!(published.said("encoder"), "{:?}", published.words);
    recovers(&mut node, 60.0);

    let torque_sensor = |t, k, stamp| {
        let (mut measured, motor) = moving(13.0)(t, k, stamp);
        measured.effort[1] = 0.25;
        (measured, motor)
    };
    let published = feed(&mut node, 180.0..200.0, torque_sensor);
    assert!(published.faults.has(Fault::TorqueStuck));
    assert!(published.said("torque sensor"), "{:?}", published.words);
    recovers(&mut node, 200.0);
}

#[test]
fn half_an_hour_at_rest_teaches_nothing_and_breaks_nothing() {
    let mut node = started();
    let before = feed(&mut node, 40.0..41.0, moving(13.0));
    let before = before.last();
    let place = motion(41.0)[0];
    let rest = move |_, k, stamp| {
        let wobble = 1e-6 * noise(k + 5);
        samples(stamp, place + wobble, 2.0 + 0.1 * noise(k), k)
    };
    let published = feed(&mut node, 41.0..1841.0, rest);
    assert!(published.faults.is_empty(), "{:?}", published.words);
    let after = published.last();
    for i in 0..after.len() {
        // What was moving a moment before still comes through.
        let moved = (after.values[i] - before.values[i]).abs();
        if after.names[i].as_str() == "v_seen" {
            // The fastest speed is seen, not estimated.
            assert_eq!(moved, 0.0, "{after:?}");
            continue;
        }
        assert!(moved < 3.0 * before.std_errors[i], "{after:?}");
        assert!(after.std_errors[i] < 1.5 * before.std_errors[i]);
    }
    recovers(&mut node, 1841.0);
}

#[test]
fn time_may_jump_to_and_fro() {
    let mut node = started();
    let shifted = |by: f64| move |t, k, stamp: Time| moving(13.0)(t, k, stamp.plus_seconds(by));
    for (from, by) in [(40.0, 3600.0), (70.0, -7200.0), (100.0, 0.0)] {
        let published = feed(&mut node, from..from + 30.0, shifted(by));
        assert!(published.said("time jumped"), "{by}: {:?}", published.words);
        assert!(!published.faults.has(Fault::ResidualOutOfBand));
        assert!(published.predicted.len() > 300, "{by}");
    }
    // Stamps that go to and fro by a little are left out, each of them.
    let jitter = |t, k: u64, stamp: Time| {
        let back = if k.is_multiple_of(2) { 0.0 } else { -0.015 };
        moving(13.0)(t, k, stamp.plus_seconds(back))
    };
    let published = feed(&mut node, 130.0..135.0, jitter);
    assert!(published.faults.has(Fault::MeasurementInvalid));
    assert!(published.said("do not advance"), "{:?}", published.words);
    recovers(&mut node, 135.0);
}

#[test]
fn a_parameter_at_its_bound_is_said_and_comes_back() {
    let mut node = started();
    let published = feed(&mut node, 40.0..70.0, moving(1e5));
    assert!(published.faults.has(Fault::ResidualOutOfBand));
    assert!(published.said("is held at"), "{:?}", published.words);
    // So large a residual is forgotten within some memories.
    feed(&mut node, 70.0..400.0, moving(13.0));
    recovers(&mut node, 400.0);
}
