//! An arm begins by what it is, not by what it was.

use super::*;

/// Enabled and at rest at (0.38, 0.05) m.
fn at_rest() -> Bench {
    let mut bench = Bench::new([-0.6, 1.2]);
    bench.approach(0.38, 0.05);
    bench
}

#[test]
fn resumed_by_an_old_measurement_it_begins_by_the_next() {
    let mut bench = at_rest();
    bench.step(None, Some(StateCommand::Pause));
    let old = bench.measure();
    // Its driver stands still, and the arm is moved meanwhile.
    for _ in 0..8 {
        bench.step_with(Some(old), None, None);
    }
    bench.step_with(Some(old), None, Some(StateCommand::Resume));
    let moved = &mut bench.joints[1];
    moved.motor[0] += 0.02;
    moved.link[0] += 0.02;
    bench.measured = [bench.measure()].into();
    let measured = bench.joints[1].motor[0];
    let output = bench.step(None, None);
    assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
    assert_eq!(output.setpoint[1].position, measured);
}

#[test]
fn not_measured_for_more_than_10_ms_it_stands_and_begins_by_the_next() {
    let mut bench = at_rest();
    let old = bench.measure();
    for step in 0..12 {
        // Told to go on at 0.1 m/s.
        let command = bench.tip_command(0.38, 0.05 + 1e-4 * f64::from(step));
        let output = bench.step_with(Some(old), Some(command), None);
        assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
        // The measurement is a millisecond older than the step.
        let stands = output.setpoint[1].position == old.position[1];
        assert_eq!(stands, step >= 10, "step {step}");
    }
    bench.joints[1].motor[0] += 0.02;
    bench.joints[1].link[0] += 0.02;
    bench.measured = [bench.measure()].into();
    let measured = bench.joints[1].motor[0];
    let output = bench.step(None, None);
    assert_eq!(output.setpoint[1].position, measured);
}

#[test]
fn after_a_fault_it_begins_without_the_torque_of_before() {
    let mut bench = at_rest();
    bench.external = [20.0, 20.0];
    let mut pressing = 0.0_f64;
    for _ in 0..200 {
        let command = bench.tip_command(0.38, 0.05);
        pressing = bench.step(Some(command), None).torque[1];
    }
    assert!(pressing.abs() > 8.0, "{pressing} Nm");
    for _ in 0..30 {
        bench.step_with(None, None, None);
    }
    bench.external = [0.0; 2];
    let back = bench.measure();
    bench.step_with(Some(back), None, Some(StateCommand::Disable));
    for _ in 0..30 {
        bench.step_with(None, None, None);
    }
    let back = bench.measure();
    let output = bench.step_with(Some(back), None, Some(StateCommand::Enable));
    assert_eq!(output.state, OperatingState::Enabled, "{}", output.reason);
    assert!(output.torque[1].abs() < 2.0, "{:?}", output.torque);
}

#[test]
fn a_torque_beyond_the_range_of_the_sensor_is_no_load() {
    let torque = |measured: f64| {
        let mut bench = at_rest();
        let mut output = None;
        for step in 0..200 {
            let command = bench.tip_command(0.38, 0.05 + 1e-4 * f64::from(step));
            let mut seen = bench.measure();
            seen.torque[1] = measured;
            output = Some(bench.step_with(Some(seen), Some(command), None));
        }
        output.map(|own| own.torque[1])
    };
    // The range is 120 Nm.
    assert_eq!(torque(500.0), torque(120.0));
    assert_eq!(torque(-1e9), torque(-120.0));
}
