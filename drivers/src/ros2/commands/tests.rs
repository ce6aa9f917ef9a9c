use ferntast_model::JointCount;

use super::*;
use crate::simulated::load_arm;

const DT: f64 = 1e-3;

fn count() -> JointCount {
    JointCount::new(7).unwrap()
}

fn weight() -> Weight {
    Weight::new(&load_arm("panda").unwrap().model, count())
}

fn commands(settings: &Settings) -> Commands {
    let joint = Joint {
        range: [-2.8, 2.8],
        speed: 2.0,
        damping: 50.0,
        hold_damping: 20.0,
    };
    Commands::new(settings, Joints::filled(count(), joint), weight())
}

fn of(interface: Interface) -> Commands {
    commands(&Settings {
        interface,
        ..Settings::default()
    })
}

fn posture() -> Joints<f64> {
    Joints::from([0.1, -0.7, 0.2, -2.0, 0.0, 1.5, 0.5])
}

fn all(value: f64) -> Joints<f64> {
    Joints::filled(count(), value)
}

fn driven<'a>(
    torque: &'a Joints<f64>,
    position: &'a Joints<f64>,
    velocity: &'a Joints<f64>,
) -> Situation<'a> {
    Situation {
        torque: Some(torque),
        elapsed: DT,
        position,
        velocity: Some(velocity),
        joint_torque: None,
    }
}

#[test]
fn an_effort_controller_gets_the_torque_less_what_the_robot_carries_itself() {
    let (position, rest, torque) = (posture(), all(0.0), all(3.0));
    let now = driven(&torque, &position, &rest);
    assert_eq!(of(Interface::Effort).next(&now), torque);
    let own = commands(&Settings {
        interface: Interface::Effort,
        carries_itself: true,
        ..Settings::default()
    })
    .next(&now);
    let weight = weight().at(&position);
    assert!(weight[3].abs() > 10.0);
    for (joint, own) in own.iter().enumerate() {
        assert!((own - (3.0 - weight[joint])).abs() < 1e-12);
    }
}

#[test]
fn where_nothing_is_believed_the_arm_is_told_to_stay() {
    let (position, moving, torque) = (posture(), all(0.5), all(80.0));
    let weight = weight().at(&position);
    let off = Situation {
        torque: None,
        ..driven(&torque, &position, &moving)
    };
    let blind = Situation {
        velocity: None,
        ..driven(&torque, &position, &moving)
    };
    let carried = of(Interface::Effort).next(&blind);
    assert_eq!(carried, weight);
    let damped = of(Interface::Effort).next(&off);
    assert!((damped[1] - (weight[1] - 10.0)).abs() < 1e-12);
    for now in [off, blind] {
        let mut velocity = of(Interface::Velocity);
        velocity.next(&driven(&torque, &position, &moving));
        assert_eq!(velocity.next(&now), all(0.0));
        let mut to = of(Interface::Position);
        for _ in 0..50 {
            to.next(&driven(&torque, &position, &moving));
        }
        // Where it was when it ended, and then on.
        assert_eq!(to.next(&now), position);
        let elsewhere = all(0.0);
        let now = Situation {
            position: &elsewhere,
            ..now
        };
        assert_eq!(to.next(&now), position);
    }
}

/// The law of the servo, k_P (q_d − q) + k_D (q̇_d − q̇) with the weight, becomes
/// q̇_c = q̇_d + k_P / k_D (q_d − q).
#[test]
fn in_free_motion_a_velocity_controller_is_told_the_servos_law() {
    let (position, velocity) = (posture(), all(0.3));
    let weight = weight().at(&position);
    let torque = weight.map(|own| own + 2000.0 * 0.01 + 50.0 * (0.4 - 0.3));
    let command = of(Interface::Velocity).next(&driven(&torque, &position, &velocity));
    for own in command.iter() {
        assert!((own - (0.4 + 2000.0 / 50.0 * 0.01)).abs() < 1e-9, "{own}");
    }
    let command = of(Interface::Velocity).next(&driven(&all(1e6), &position, &velocity));
    assert_eq!(command, all(2.0));
    let command = of(Interface::Velocity).next(&driven(&all(f64::NAN), &position, &velocity));
    assert_eq!(command, all(0.0));
}

/// A robot whose joints follow what they are told within some milliseconds, whatever is in their
/// way, against a spring: with a torque sensor it presses as much as the servo wants.
#[test]
fn a_stiff_robot_presses_as_the_servo_wants_and_no_more() {
    for interface in [Interface::Velocity, Interface::Position] {
        for stiffness in [50.0, 500.0, 2e3] {
            let mut commands = commands(&Settings {
                interface,
                lead: 0.5,
                ..Settings::default()
            });
            let (wanted, lag) = (20.0, 0.01);
            let (mut q, mut v, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
            for _ in 0..6000 {
                let spring = stiffness * q.max(0.0);
                let (position, velocity, borne) = (all(q), all(v), all(spring));
                // The servo damps as it does with its own gain.
                let torque = all(wanted - 50.0 * v);
                let command = commands.next(&Situation {
                    joint_torque: Some(&borne),
                    ..driven(&torque, &position, &velocity)
                })[0];
                let before = q;
                match interface {
                    Interface::Velocity => {
                        v += (command - v) * DT / lag;
                        q += v * DT;
                    }
                    _ => {
                        q += (command - q) * DT / lag;
                        v = (q - before) / DT;
                    }
                }
                most = most.max(stiffness * q);
            }
            let pressed = stiffness * q;
            println!("{interface:?}, {stiffness} Nm/rad: {pressed:.2} Nm, {most:.2} Nm at most");
            assert!(
                (pressed - wanted).abs() < 0.5,
                "{interface:?} {stiffness}: {pressed} Nm"
            );
            assert!(most < 2.0 * wanted, "{interface:?} {stiffness}: {most} Nm");
        }
    }
}

#[test]
fn a_position_command_stays_near_the_joint_and_within_its_range() {
    let mut commands = of(Interface::Position);
    let (rest, torque) = (all(0.0), all(1e3));
    let position = posture();
    let mut last = position;
    for _ in 0..500 {
        last = commands.next(&driven(&torque, &position, &rest));
    }
    for (joint, own) in last.iter().enumerate() {
        assert!((own - (position[joint] + 0.05)).abs() < 1e-9);
    }
    let end = all(2.79);
    let mut commands = of(Interface::Position);
    for _ in 0..500 {
        last = commands.next(&driven(&torque, &end, &rest));
    }
    assert_eq!(last, all(2.8));
}
