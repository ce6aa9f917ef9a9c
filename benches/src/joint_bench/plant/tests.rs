use ferntast_emulation::random::Random;

use super::*;

/// One step of the integration, nothing hidden.
fn advance(plant: &mut Plant, torque: f64) {
    let none = Friction::default();
    plant.fixed.step(&mut plant.moving, torque, &none);
}

fn joint() -> JointParameters {
    JointParameters::draw(&mut Random::new(5))
}

/// Work of the motor, and energy stored and dissipated, over 4 s of pushing to and fro.
fn energies(joint: JointParameters) -> (f64, f64, f64) {
    let total = joint.inertia + joint.link_inertia;
    let (spring, start, damping) = (joint.spring, joint.spring_start, joint.link_damping);
    let mut plant = Plant::new(joint, true, 1.0);
    let (mut work, mut lost) = (0.0, 0.0);
    for step in 0..40_000 {
        let torque = 45.0 * (f64::from(step) * STEP * 3.0).sin();
        let velocity = plant.state().velocity;
        advance(&mut plant, torque);
        let mean = 0.5 * (velocity + plant.state().velocity);
        work += torque * mean * STEP;
        lost += (plant.moving.friction + damping * velocity) * mean * STEP;
    }
    let q = plant.state().position;
    let stretch = (q - start).max(0.0) + (q + 2.0 * start).min(0.0);
    let stored = 0.5 * total * plant.state().velocity.powi(2) + 0.5 * spring * stretch * stretch;
    (work, stored, lost)
}

#[test]
fn what_the_motor_puts_in_is_stored_or_dissipated() {
    let (work, stored, lost) = energies(joint());
    assert!(work > 10.0 && lost > 10.0, "{work} {lost}");
    assert!(
        (work - stored - lost).abs() < 5e-3 * work,
        "{work} {stored} {lost}"
    );
}

#[test]
fn below_coulomb_friction_it_stays_within_its_bristles() {
    let joint = joint();
    let (hold, bristle) = (0.7 * joint.b0, joint.bristle);
    let mut plant = Plant::new(joint, true, 1.0);
    for step in 0..50_000 {
        // Slowly, or it would overshoot.
        advance(&mut plant, hold * (f64::from(step) / 30_000.0).min(1.0));
    }
    // Dahl: q = −δ ln(1 − τ/b_0).
    let expected = -bristle * (1.0f64 - 0.7).ln();
    let ratio = plant.state().position / expected;
    assert!((0.95..1.05).contains(&ratio), "{ratio}");
    assert!(plant.state().velocity.abs() < 1e-5);
}

/// Steady speed under constant torque: equation (4) with Table 1's parameters.
#[test]
fn steady_sliding_is_equation_4() {
    let joint = joint();
    let speed = 0.12;
    let torque = joint.b0
        + (joint.b1 + (joint.b2 + joint.b3 * speed) * speed) * speed
        + joint.link_damping * speed * (1.0 + joint.b0t);
    let mut plant = Plant::new(joint, false, 1.0);
    for _ in 0..30_000 {
        advance(&mut plant, torque);
    }
    assert!(
        (plant.state().velocity / speed - 1.0).abs() < 1e-3,
        "{}",
        plant.state().velocity
    );
}

#[test]
fn an_elastic_transmission_twists_by_its_law() {
    let mut joint = joint();
    joint.transmission = Transmission::Elastic {
        stiffness: 300.0,
        cubic_stiffness: 6e4,
        damping: 0.4 * (300.0 * joint.link_inertia).sqrt(),
        link_friction: 0.0,
        measures_motor: false,
    };
    let mut plant = Plant::new(joint, true, 1.0);
    for _ in 0..60_000 {
        advance(&mut plant, 30.0);
    }
    let twist = plant.motor().0 - plant.measured().0;
    let expected = 300.0 * twist + 6e4 * twist.powi(3);
    assert!(twist > 0.005);
    assert!((plant.state().load - expected).abs() < 0.02 * expected);
}

/// A link that is let go swings at its own frequency, √(K/I)/2π, until its friction stops it:
/// each half swing is shorter by twice what friction holds, 2 τ_C/K.
#[test]
fn behind_a_soft_gear_the_link_swings() {
    let mut joint = joint();
    let rate = 30.0_f64;
    // The motor is too heavy to move.
    joint.inertia = 1e6;
    (joint.link_inertia, joint.link_damping) = (1.0, 0.0);
    joint.transmission = Transmission::Elastic {
        stiffness: rate * rate,
        cubic_stiffness: 0.0,
        damping: 0.0,
        link_friction: 0.9,
        measures_motor: true,
    };
    let mut plant = Plant::new(joint, false, 1.0);
    plant.moving.other.0 = 0.01;
    let mut direction = -1.0;
    let mut turns = Vec::new();
    for step in 0..6000 {
        advance(&mut plant, 0.0);
        let (place, speed) = plant.moving.other;
        if direction * speed < 0.0 {
            turns.push((step, place.abs()));
            direction = -direction;
        }
    }
    let half = std::f64::consts::PI / rate / STEP;
    // From 10 mrad on: 8, 6, 4, 2 mrad, and rest.
    assert_eq!(turns.len(), 4, "{turns:?}");
    for (number, (step, size)) in turns.iter().enumerate() {
        let expected = half * (number + 1) as f64;
        assert!(
            (f64::from(*step) - expected).abs() < 0.03 * half,
            "{turns:?}"
        );
        assert!(
            (size - (8e-3 - 2e-3 * number as f64)).abs() < 2e-4,
            "{turns:?}"
        );
    }
    assert!(plant.measured().0.abs() < 1e-3);
}

#[test]
fn backlash_lets_the_motor_run_free_over_its_gap() {
    let mut joint = joint();
    joint.transmission = Transmission::Backlash { gap: 0.02 };
    let mut plant = Plant::new(joint, false, 1.0);
    // Far below friction, either way: only the motor moves, from tooth to tooth.
    for _ in 0..20_000 {
        advance(&mut plant, 2.0);
    }
    let forward = plant.motor().0;
    for _ in 0..20_000 {
        advance(&mut plant, -2.0);
    }
    let way = forward - plant.motor().0;
    assert!((way - 0.02).abs() < 2e-3, "{way}");
}
