//! Whether the standard errors that are stated of what recordings say are true: experiments with
//! torque sensors and a contour that are off, drawn from what is stated of them.

use std::path::Path;

use ferntast_drivers::simulated;
use ferntast_emulation::random::Random;
use ferntast_model::{Vector2, contour::Surface};
use ferntast_sim::arm::{ArmConfig, TorqueSensorErrors};
use ferntast_studies::{
    experiment::{
        Conditions, Plan,
        identify::{self, CUBIC, Contact, JointData},
        run,
    },
    parallel,
};

/// Arms that are drawn.
const DRAWS: u64 = 24;
/// Mission day, and temperature at which friction is as configured \[degC\].
const DAY: f64 = 57.0;
const TEMPERATURE: f64 = 10.0;

/// The shipped arm, what is stated of its sensors made larger, and sensors and contour drawn from
/// that by `seed`; without one they are ideal.
fn arm(seed: Option<u64>) -> ArmConfig {
    let mut arm = simulated::load_config("rokviss").expect("shipped");
    let uncertainty = &mut arm.estimator.uncertainty;
    uncertainty.torque_zero = 0.3;
    uncertainty.torque_gain = 0.03;
    uncertainty.torque_hysteresis = 0.05;
    uncertainty.contour_turn = 0.01;
    let stated = *uncertainty;
    let Some(seed) = seed else {
        return arm;
    };
    let mut random = Random::new(9_000 + seed);
    for joint in &mut arm.truth.joint {
        joint.sensor.torque_errors = Some(TorqueSensorErrors {
            zero: stated.torque_zero * random.normal(),
            gain: 1.0 + stated.torque_gain * random.normal(),
            hysteresis: (stated.torque_hysteresis * random.normal()).abs(),
            lag: 0.002,
        });
    }
    let turn = stated.contour_turn * random.normal();
    let middle = Vector2::from(arm.contour.nominal_tip);
    let turned = |place: [f64; 2]| -> [f64; 2] {
        let from = Vector2::from(place) - middle;
        let (sine, cosine) = turn.sin_cos();
        let turned = Vector2::new(
            cosine * from.x - sine * from.y,
            sine * from.x + cosine * from.y,
        );
        (middle + turned).into()
    };
    let mut contour = arm.contour.clone();
    for edge in &mut contour.edge {
        edge.from = turned(edge.from);
        edge.to = turned(edge.to);
    }
    arm.truth.contour = Some(contour);
    arm
}

fn record(plan: &Plan, arm: &ArmConfig, seed: u64, folder: &Path) {
    let conditions = Conditions {
        day: Some(DAY),
        temperature: Some(TEMPERATURE),
        ..Conditions::default()
    };
    run(plan, arm, &conditions, seed, folder, &|_| {}).expect("an experiment");
}

/// What was identified, in stated errors from the truth.
#[derive(Clone, Copy, Debug, Default)]
struct Off {
    lubricated: f64,
    unlubricated: f64,
    stiffness: f64,
    b_0: f64,
    b_1: f64,
    /// Of the same without what is wrong all the time in the stated errors.
    by_noise_alone: [f64; 2],
}

fn judge(seed: u64, arm: &ArmConfig) -> Off {
    let folder = tempfile::tempdir().expect("a folder");
    let mut off = Off::default();
    for surface in [Surface::Lubricated, Surface::Unlubricated] {
        let plan = Plan::Contact {
            surface,
            forces: vec![20.0],
            frequencies: vec![0.2, 0.4],
            time_per_press: 5.0,
        };
        let path = folder.path().join(plan.folder());
        record(&plan, arm, seed, &path);
        let contact = Contact::read(&path, surface).expect("a contact");
        let found = contact.friction().expect("sliding");
        let (truth, place) = match surface {
            Surface::Lubricated => (0.45 - 0.35 * (-DAY / 300.0).exp(), &mut off.lubricated),
            _ => (0.45 - 0.10 * (-DAY / 5.0).exp(), &mut off.unlubricated),
        };
        *place = (found.coefficient - truth) / found.std_error;
        let by_noise = (found.coefficient - truth) / found.random_error;
        off.by_noise_alone[0] = off.by_noise_alone[0].max(by_noise.abs());
        println!(
            "{seed} {surface:?}: {:.4} ± {:.4} (noise {:.4}) for {truth:.4}; {:?}",
            found.coefficient, found.std_error, found.random_error, contact.calibration
        );
    }
    let plan = Plan::Stiffness { teeth: 3 };
    let path = folder.path().join(plan.folder());
    record(&plan, arm, seed, &path);
    let found = identify::stiffness(&path).expect("saw-teeth");
    let truth = arm.truth.joint[1].stiffness;
    off.stiffness = (found.stiffness - truth) / found.std_error;
    off.by_noise_alone[1] = ((found.stiffness - truth) / found.random_error).abs();
    println!(
        "{seed} K: {:.1} ± {:.1} (noise {:.2}) for {truth}",
        found.stiffness, found.std_error, found.random_error
    );
    let plan = Plan::Spring {
        joint: 2,
        speeds: vec![1.0, 5.0, 10.0, 20.0, 40.0],
        time_per_speed: 12.0,
    };
    let path = folder.path().join(plan.folder());
    record(&plan, arm, seed, &path);
    let data = JointData::read(&path, 2).expect("a joint");
    let found = data.friction(&path, CUBIC).expect("friction");
    let friction = &arm.truth.joint[1].friction;
    for (name, truth) in [
        ("b0", friction.b_0),
        ("b0T", friction.b_0t),
        ("b1", friction.b_1),
        ("b2", friction.b_2),
        ("b3", friction.b_3),
    ] {
        let (value, error) = (found.value(name), found.error(name).unwrap_or(f64::NAN));
        let distance = (value - truth) / error;
        println!("{seed} {name}: {value:.4} ± {error:.4} for {truth}: {distance:+.2}");
        match name {
            "b0" => off.b_0 = distance,
            "b1" => off.b_1 = distance,
            _ => {}
        }
    }
    off
}

/// With ideal sensors everything is within three stated errors, too: what was off was no sensor.
#[test]
fn with_ideal_sensors_nothing_is_off() {
    let off = judge(1, &arm(None));
    println!("{off:?}");
    for each in [
        off.lubricated,
        off.unlubricated,
        off.stiffness,
        off.b_0,
        off.b_1,
    ] {
        assert!(each.abs() < 3.0, "{off:?}");
    }
}

/// Nearly all draws are within three stated errors, and these are no larger than they need be.
#[test]
fn stated_errors_cover_the_truth() {
    let seeds: Vec<u64> = (0..DRAWS).collect();
    let all = parallel::map(&seeds, |_, seed| -> Result<Off, ()> {
        Ok(judge(*seed, &arm(Some(*seed))))
    });
    let all = all.expect("experiments");
    // Of a joint's friction they are up to three times too large: blocks of time are left out in
    // turn, each has one speed, and what a gain leaves in it counts as if it were noise.
    type Of = fn(&Off) -> f64;
    let each: [(&str, Of, f64); 5] = [
        ("b_0T lubricated", |off| off.lubricated, 0.5),
        ("b_0T unlubricated", |off| off.unlubricated, 0.5),
        ("K", |off| off.stiffness, 0.5),
        ("b_0", |off| off.b_0, 0.25),
        ("b_1", |off| off.b_1, 0.25),
    ];
    let mut wrong = Vec::new();
    for (name, of, least) in each {
        let offs: Vec<f64> = all.iter().map(of).collect();
        let within = offs.iter().filter(|off| off.abs() < 3.0).count();
        let rms = (offs.iter().map(|off| off * off).sum::<f64>() / offs.len() as f64).sqrt();
        println!("{name}: {within} of {} within 3; RMS {rms:.2}", offs.len());
        if 20 * within < 19 * offs.len() || !(least..1.5).contains(&rms) {
            wrong.push(name);
        }
    }
    let by_noise = |place: usize| {
        let sum: f64 = all
            .iter()
            .map(|off| off.by_noise_alone[place].powi(2))
            .sum();
        (sum / all.len() as f64).sqrt()
    };
    // That there was something to state.
    println!("by noise alone: RMS {:.1}, {:.1}", by_noise(0), by_noise(1));
    assert!(wrong.is_empty(), "{wrong:?}");
    assert!(by_noise(0) > 3.0 && by_noise(1) > 15.0);
}
