//! Fits a session to a serial arm: what a scenario leaves open, or says of another arm.

use ferntast_control::{delay::Mapping, servo::ServoConfig};
use ferntast_emulation::hand::{Motion, Phase, Point, Script};
use ferntast_model::{rigid_body::Vector3, serial_arm::Plane};

use super::{Serial, SerialError, file::merged, written};
use crate::Scenario;

/// Tip positions are in the middle of the hand's where this stands: nobody gave another one.
const NOT_GIVEN: [f64; 3] = [0.35355, 0.0, 0.0];
/// The section of the servo's tuning.
const SERVO: &str = "servo";
/// An arm that reaches less than this \[m\] moves less than the hand does.
const SMALL: f64 = 0.3;
/// How far the hand goes beyond a surface \[m\] at the tip, and along it.
const DEEP: f64 = 0.003;
const ALONG: f64 = 0.02;

/// Takes the servo's tuning, key by key, and the tip's place from the arm, where the scenario
/// gives none; with `hand`, or where the script is empty, also what the scripted hand does.
///
/// # Errors
///
/// [`SerialError::Section`]: a value of `[servo]` that is no number.
pub(crate) fn fit(scenario: &mut Scenario, serial: &Serial, hand: bool) -> Result<(), SerialError> {
    scenario.servo = tuned(&serial.servo, &scenario.servo)?;
    let mapping = scenario.law.mapping();
    if hand || mapping.workspace_offset == NOT_GIVEN {
        let tip = serial.arm.home_tip().translation.map(written);
        let reach = tip.norm();
        scenario.law = scenario.law.between(&Mapping {
            workspace_offset: tip.into(),
            position_scale: match reach < SMALL {
                true => written((reach / SMALL).max(0.05)),
                false => mapping.position_scale,
            },
            ..mapping
        });
    }
    let scripted = scenario.hand.scripted.as_mut();
    if let Some(own) = scripted.filter(|own| hand || own.script.phase.is_empty()) {
        own.script = script(serial, scenario.law.mapping().position_scale);
    }
    Ok(())
}

/// The arm's tuning with the `scenario`'s in its place, key by key, a section
/// as a whole: what is by default was not given.
fn tuned(arm: &ServoConfig, scenario: &ServoConfig) -> Result<ServoConfig, SerialError> {
    let keys = |own: &ServoConfig| {
        toml::Table::try_from(own).map_err(|error| SerialError::Section {
            section: SERVO.to_owned(),
            message: error.to_string(),
        })
    };
    let default = keys(&ServoConfig::default())?;
    let mut given = keys(scenario)?;
    given.retain(|key, value| default.get(key) != Some(value));
    merged(arm, given, SERVO)
}

/// The scripted hand touches one surface after the other, presses and slides, again and again.
fn script(serial: &Serial, scale: f64) -> Script {
    let home = serial.arm.home_tip().translation;
    let surfaces = serial.arm.surfaces();
    if surfaces.is_empty() {
        return wander(scale);
    }
    let touch = |plane: &Plane| touch(plane, &home, scale);
    Script {
        start: Point::default(),
        repeat: true,
        phase: [wait()]
            .into_iter()
            .chain(surfaces.iter().flat_map(touch))
            .collect(),
    }
}

/// From `home` \[m\] to `plane` and back.
fn touch(plane: &Plane, home: &Vector3<f64>, scale: f64) -> [Phase; 5] {
    let normal = plane.direction();
    let apart = plane.distance(home);
    // Along the surface, away from and towards the base as far as that goes.
    let out = home - normal * normal.dot(home);
    let along = out.try_normalize(1e-3).unwrap_or_else(|| {
        let axis = match normal.x.abs() < 0.9 {
            true => Vector3::x(),
            false => Vector3::y(),
        };
        (axis - normal * normal.dot(&axis)).normalize()
    });
    let at = |depth: f64, way: f64| {
        let tip = along * way - normal * (apart + depth);
        Point((tip / scale).map(written).into())
    };
    let reach = |label: &str, to: Point, duration: f64| Phase {
        label: label.to_owned(),
        duration,
        motion: Motion::Reach { to },
    };
    let name = &plane.name;
    [
        reach(&format!("reach the {name}"), at(-DEEP, 0.0), 1.2),
        reach("press", at(DEEP, 0.0), 0.8),
        reach("slide", at(DEEP, ALONG), 2.0),
        reach("slide back", at(DEEP, -ALONG), 3.0),
        reach("retreat", Point::default(), 1.5),
    ]
}

fn wait() -> Phase {
    Phase {
        label: "wait".to_owned(),
        duration: 1.0,
        motion: Motion::Hold {},
    }
}

/// With nothing to touch the hand goes to and fro.
fn wander(scale: f64) -> Script {
    let sine = |label: &str, amplitude: [f64; 3]| Phase {
        label: label.to_owned(),
        duration: 4.0,
        motion: Motion::Sine {
            amplitude: Point(amplitude.map(|own| written(own / scale))),
            frequency: 0.5,
        },
    };
    Script {
        start: Point::default(),
        repeat: true,
        phase: vec![
            wait(),
            sine("to and fro", [0.03, 0.0, 0.0]),
            sine("left and right", [0.0, 0.03, 0.0]),
            sine("up and down", [0.0, 0.0, 0.03]),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serial::load_serial;
    use ferntast_control::servo::ContactStopConfig;

    #[test]
    fn what_a_scenario_says_of_the_servo_stands_in_the_place_of_the_arms() {
        let arm = load_serial("panda").unwrap().unwrap();
        let serial = arm.model.serial().unwrap();
        let contact_stop = ContactStopConfig {
            torque: 1.5,
            ..ContactStopConfig::default()
        };
        let mut scenario = Scenario::without_operator(
            ServoConfig {
                contact_stop,
                ..ServoConfig::default()
            },
            1,
        );
        let tuned = ServoConfig {
            contact_stop,
            ..serial.servo.clone()
        };
        for _ in 0..2 {
            fit(&mut scenario, serial, false).unwrap();
            assert_eq!(scenario.servo, tuned);
        }
    }
}
