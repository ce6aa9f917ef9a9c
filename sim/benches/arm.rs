//! What one tick of 1 ms costs in the simulated arm and in the estimator.

use criterion::{Criterion, criterion_group, criterion_main};
use ferntast_control::estimator::{ContactEstimator, Form, JointMeasurement};
use ferntast_sim::arm::{ArmConfig, SimulatedArm};
use std::hint::black_box;

const CONFIG: &str = include_str!("../../config/arms/rokviss.toml");

fn tick(criterion: &mut Criterion) {
    let config: ArmConfig = toml::from_str(CONFIG).expect("the shipped arm parses");
    let mut arm = SimulatedArm::new(&config, 1).expect("the shipped arm is valid");
    let mut time = 0.0_f64;
    criterion.bench_function("arm: advance 1 ms and measure", |bencher| {
        bencher.iter(|| {
            time += 1e-3;
            let torque = [20.0 * (3.0 * time).sin(), 20.0 * (5.0 * time).cos()];
            arm.advance(black_box(torque), 1e-3);
            black_box(arm.measure())
        });
    });
    // A measurement that changes from step to step, as one does.
    let measurements: Vec<_> = (0..1000)
        .map(|step| {
            let torque = [20.0 * (0.003 * f64::from(step)).sin(), 10.0];
            arm.advance(torque, 1e-3);
            let measured = arm.measure();
            JointMeasurement {
                motor_position: measured.motor_position,
                joint_torque: measured.joint_torque,
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
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                next.next()
                    .map(|measurement| estimator.step(1e-3, black_box(measurement)))
            });
        });
    }
}

criterion_group!(benches, tick);
criterion_main!(benches);
