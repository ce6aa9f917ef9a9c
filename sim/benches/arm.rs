//! What one tick of 1 ms costs in the simulated arm and in the estimator.

use ferntast_control::estimator::{ContactEstimator, Form, JointMeasurement};
use ferntast_sim::arm::{ArmConfig, SimulatedArm};
use std::{hint::black_box, time::Instant};

const CONFIG: &str = include_str!("../../config/arms/rokviss.toml");
const RUNS: usize = 9;
/// Ticks of a run.
const TICKS: usize = 20_000;

fn main() {
    let config: ArmConfig = toml::from_str(CONFIG).expect("the shipped arm parses");
    let mut arm = SimulatedArm::new(&config, 1).expect("the shipped arm is valid");
    println!(
        "{:<40} {:>8} {:>8} {:>8}   µs a tick, {RUNS} runs of {TICKS}",
        "", "min", "median", "max"
    );
    let mut time = 0.0_f64;
    report("arm: advance 1 ms and measure", || {
        time += 1e-3;
        let torque = [20.0 * (3.0 * time).sin(), 20.0 * (5.0 * time).cos()];
        arm.advance(black_box(torque), 1e-3);
        black_box(arm.measure());
    });
    // A measurement that changes from step to step, as one does.
    let measurements: Vec<_> = (0..1000)
        .map(|step| {
            let torque = [20.0 * (0.003 * f64::from(step)).sin(), 10.0];
            arm.advance(torque, 1e-3);
            let measured = arm.measure();
            JointMeasurement {
                motor_position: measured.motor_position.into(),
                joint_torque: measured.joint_torque.into(),
            }
        })
        .collect();
    for (form, name) in [
        (Form::Direct, "estimator, direct form: step"),
        (Form::MomentumObserver, "estimator, momentum observer: step"),
    ] {
        let mut parameters = config.estimator;
        parameters.form = form;
        let mut estimator = ContactEstimator::new(&config.model(), &parameters)
            .expect("the shipped estimator is valid");
        let mut next = measurements.iter().cycle();
        report(name, || {
            if let Some(measurement) = next.next() {
                black_box(estimator.step(1e-3, black_box(measurement)));
            }
        });
    }
}

fn report(name: &str, mut tick: impl FnMut()) {
    let mut costs: Vec<f64> = (0..RUNS)
        .map(|_| {
            let begun = Instant::now();
            (0..TICKS).for_each(|_| tick());
            begun.elapsed().as_secs_f64() * 1e6 / TICKS as f64
        })
        .collect();
    costs.sort_by(f64::total_cmp);
    let (min, median, max) = (costs[0], costs[RUNS / 2], costs[RUNS - 1]);
    println!("{name:<40} {min:>8.3} {median:>8.3} {max:>8.3}");
}
