//! The gear's true friction, with real stiction.
//!
//! Equation (4) once more, written for integration and not for
//! identification. It shares no code with the friction that servo, estimator
//! and model lab believe in, so that a fault there cannot hide here.

use super::temperature::{TemperatureDependence, TemperatureShare};
use super::wear::GearWear;
use ferntast_model::friction::FrictionParameters;
use ferntast_model::{ParameterError, parameters};

parameters! {
    /// True friction of one joint, equation (4), joint side.
    #[derive(Copy)]
    pub struct TrueFriction {
        /// Coulomb friction b_0 \[Nm\].
        pub b_0: f64 [0.0..=200.0, "Nm"],
        /// Load-dependent Coulomb friction b_0T \[-\].
        #[serde(rename = "b_0T")]
        pub b_0t: f64 [-1.0..=1.0, "-", "b_0T"],
        /// Viscous b_1 \[Nm·s/rad\].
        pub b_1: f64 [0.0..=5000.0, "Nm·s/rad"],
        /// Quadratic viscous b_2 \[Nm·s²/rad²\].
        pub b_2: f64 [-1e4..=1e4, "Nm·s²/rad²"],
        /// Cubic viscous b_3 \[Nm·s³/rad³\].
        pub b_3: f64 [-1e4..=1e4, "Nm·s³/rad³"],
        /// Speed from which on the viscous part goes on straight, with the slope
        /// it has there \[rad/s\].
        pub linear_from: f64 [0.01..=100.0, "rad/s"],
        /// What temperature does to it; nothing when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub temperature: Option<TemperatureDependence> [section],
        /// What the days do to it; nothing when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub wear: Option<GearWear> [section],
    }
    check TrueFriction::no_speed_gains_energy;
}

impl TrueFriction {
    fn no_speed_gains_energy(&self) -> Result<(), ParameterError> {
        let edge = self.linear_from;
        let slope = self.b_1 + 2.0 * self.b_2 * edge + 3.0 * self.b_3 * edge * edge;
        let gains = (0..=1000)
            .map(|step| f64::from(step) * 1e-3 * edge)
            .find(|&speed| self.viscosity(speed) < 0.0);
        let (speed, what) = match gains {
            Some(speed) => (speed, "viscous friction drives the joint"),
            None if slope < 0.0 => (edge, "viscous friction falls without end"),
            None => return Ok(()),
        };
        Err(ParameterError::Inconsistent {
            key: "b_2".into(),
            reason: format!(
                "{what} at {speed:.3} rad/s with b_1 = {}, b_2 = {}, b_3 = {}; raise b_1 or b_3",
                self.b_1, self.b_2, self.b_3
            ),
        })
    }

    /// Takes the five parameters of equation (4) from a file's `parameters`;
    /// what is not in there is zero.
    pub(super) fn set(&mut self, parameters: &FrictionParameters) {
        let value = |effect: &str, name: &str| {
            let effect = parameters.effects.get(effect);
            effect
                .and_then(|values| values.get(name))
                .copied()
                .unwrap_or(0.0)
        };
        self.b_0 = value("coulomb", "b_0");
        self.b_0t = value("load_coulomb", "b_0T");
        self.b_1 = value("viscous", "b_1");
        self.b_2 = value("quadratic_viscous", "b_2");
        self.b_3 = value("cubic_viscous", "b_3");
    }

    /// The gear as it is on `day` of the mission.
    pub(crate) fn on_day(&self, day: f64) -> Gear {
        let share = self.wear.map_or(1.0, |wear| wear.share(day));
        Gear {
            friction: TrueFriction {
                b_0: self.b_0 * share,
                b_0t: self.b_0t * share,
                b_1: self.b_1 * share,
                b_2: self.b_2 * share,
                b_3: self.b_3 * share,
                ..*self
            },
            temperature: self.temperature.as_ref().map(TemperatureShare::new),
        }
    }

    /// Viscous torque divided by velocity, at `speed` = |θ̇| \[rad/s\]: \[Nm·s/rad\].
    fn viscosity(&self, speed: f64) -> f64 {
        let inside = speed.min(self.linear_from);
        let polynomial = self.b_1 + (self.b_2 + self.b_3 * inside) * inside;
        if speed <= self.linear_from {
            return polynomial;
        }
        let slope = self.b_1 + (2.0 * self.b_2 + 3.0 * self.b_3 * inside) * inside;
        (polynomial * inside + slope * (speed - inside)) / speed
    }

    /// Largest torque \[Nm\] that holds the motor at rest under joint torque `load` \[Nm\].
    fn stiction(&self, load: f64) -> f64 {
        (self.b_0 + self.b_0t * load.abs()).max(0.0)
    }
}

/// Rounds in which friction and the speed that it leaves are made to agree.
const ROUNDS: usize = 3;

/// The friction of one gear on one day.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gear {
    friction: TrueFriction,
    temperature: Option<TemperatureShare>,
}

impl Gear {
    /// A brake that slips at that torque \[Nm\].
    pub(crate) fn brake_of(torque: f64) -> Gear {
        Gear {
            friction: TrueFriction {
                b_0: torque,
                b_0t: 0.0,
                b_1: 0.0,
                b_2: 0.0,
                b_3: 0.0,
                linear_from: 1.0,
                temperature: None,
                wear: None,
            },
            temperature: None,
        }
    }

    /// Velocity \[rad/s\] after friction has acted for `dt` \[s\] on the motor of
    /// `inertia` \[kg m²\], which would have `velocity` without it; joint torque
    /// `load` \[Nm\], `temperature` \[degC\].
    ///
    /// Friction can stop the motor but never turn it round: where the impulse
    /// of Coulomb friction suffices the velocity becomes exactly zero. All of it
    /// is implicit, of the velocity that it leaves: it takes energy at any step size,
    /// and is equation (4) at that velocity.
    pub(crate) fn brake(
        &self,
        velocity: f64,
        inertia: f64,
        dt: f64,
        load: f64,
        temperature: f64,
    ) -> f64 {
        let [braked] = brake(
            [Braking {
                gear: self,
                velocity,
                inertia,
                load,
                temperature,
            }],
            dt,
        );
        braked
    }

    /// What friction is multiplied by at `speed` = |θ̇| \[rad/s\] and `temperature` \[degC\].
    fn share(&self, speed: f64, temperature: f64) -> f64 {
        self.temperature
            .map_or(1.0, |dependence| dependence.at(speed, temperature))
    }
}

/// A motor that friction is to act on; see [`Gear::brake`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Braking<'a> {
    pub(super) gear: &'a Gear,
    /// Without friction \[rad/s\].
    pub(super) velocity: f64,
    /// Of the motor \[kg m²\].
    pub(super) inertia: f64,
    /// Joint torque \[Nm\].
    pub(super) load: f64,
    /// \[degC\]
    pub(super) temperature: f64,
}

/// [`Gear::brake`] of several motors, round by round: each round of one is a chain of
/// divisions and exponentials, in which the processor does the others'.
pub(super) fn brake<const N: usize>(motors: [Braking<'_>; N], dt: f64) -> [f64; N] {
    let mut sliding = motors.each_ref().map(|motor| Sliding::begin(motor, dt));
    for _ in 0..ROUNDS {
        for own in sliding.iter_mut().flatten() {
            own.settle(dt);
        }
    }
    let velocity = |own: Sliding| own.speed.copysign(own.motor.velocity);
    sliding.map(|own| own.map_or(0.0, velocity))
}

/// A motor that friction does not stop.
struct Sliding<'a> {
    motor: &'a Braking<'a>,
    /// Without friction \[rad/s\].
    free: f64,
    /// What Coulomb friction at the reference temperature takes away \[rad/s\].
    impulse: f64,
    /// With friction, as far as it is known \[rad/s\].
    speed: f64,
}

impl<'a> Sliding<'a> {
    /// `None` where the stiction at rest holds it, as it does most motors most of the time.
    fn begin(motor: &'a Braking<'a>, dt: f64) -> Option<Sliding<'a>> {
        let gear = motor.gear;
        let impulse = gear.friction.stiction(motor.load) * dt / motor.inertia;
        let free = motor.velocity.abs();
        let stands = free <= impulse * gear.share(0.0, motor.temperature);
        (!stands).then_some(Sliding {
            motor,
            free,
            impulse,
            speed: free,
        })
    }

    /// v + (τ_F(v)/|v| v + τ_C) dt/J = v_free. The change from round to round falls by the
    /// viscosity times dt/J, 0.03 of the shipped arm: to 3e-5 after all of them.
    fn settle(&mut self, dt: f64) {
        let gear = self.motor.gear;
        let share = gear.share(self.speed, self.motor.temperature);
        let sliding = (self.free - self.impulse * share).max(0.0);
        let viscosity = gear.friction.viscosity(self.speed) * share;
        self.speed = sliding / (1.0 + viscosity * dt / self.motor.inertia);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 1, spring 2005-03-24.
    pub(crate) const SPACE: TrueFriction = TrueFriction {
        b_0: 12.372,
        b_0t: 0.146,
        b_1: 163.301,
        b_2: -578.954,
        b_3: 547.449,
        linear_from: 0.698,
        temperature: None,
        wear: None,
    };

    /// Torque that `brake` takes away at `velocity`.
    fn torque(friction: &TrueFriction, velocity: f64, load: f64, temperature: f64) -> f64 {
        torque_on(57.0, friction, velocity, load, temperature)
    }

    fn torque_on(
        day: f64,
        friction: &TrueFriction,
        velocity: f64,
        load: f64,
        temperature: f64,
    ) -> f64 {
        let (inertia, dt) = (0.5, 1e-9);
        let braked = friction
            .on_day(day)
            .brake(velocity, inertia, dt, load, temperature);
        inertia * (velocity - braked) / dt
    }

    #[test]
    fn it_is_equation_4_with_table_1() {
        let at = |degrees: f64, load| torque(&SPACE, degrees.to_radians(), load, 20.0);
        assert!((at(1.0, 0.0) - 15.05).abs() < 0.005);
        assert!((at(40.0, 0.0) - 30.5).abs() < 0.1, "{}", at(40.0, 0.0));
        assert!((at(-1.0, 13.0) + 15.05 + 0.146 * 13.0).abs() < 0.005);
    }

    #[test]
    fn beyond_the_identified_speeds_it_goes_on_straight() {
        let at = |speed| torque(&SPACE, speed, 0.0, 20.0);
        let slope = (at(1.6) - at(1.5)) / 0.1;
        assert!(((at(0.75) - at(0.70)) / 0.05 - slope).abs() < 1e-3 * slope);
        assert!(slope > 100.0);
    }

    /// At the arm's own steps, not only in the limit of short ones: what is taken away
    /// is the friction at the speed that is left.
    #[test]
    fn it_is_equation_4_at_the_steps_in_use() {
        let warm = TrueFriction {
            temperature: Some(TemperatureDependence {
                reference: 10.0,
                slow: -0.031,
                fast: 0.0111,
                neutral_speed: 0.0873,
            }),
            ..SPACE
        };
        let inertia = 0.5;
        for (friction, temperature) in [(&SPACE, 10.0), (&warm, 10.0), (&warm, 25.0)] {
            for dt in [1e-6, 4e-5, 1e-4] {
                for degrees in [1.0_f64, 5.0, 10.0, 20.0, 40.0] {
                    let wanted = degrees.to_radians();
                    let expected = torque(friction, wanted, 5.0, temperature);
                    let free = wanted + expected * dt / inertia;
                    let gear = friction.on_day(57.0);
                    let left = gear.brake(free, inertia, dt, 5.0, temperature);
                    let taken = inertia * (free - left) / dt;
                    assert!(
                        (taken / expected - 1.0).abs() < 2e-4,
                        "{taken} for {expected} Nm at {degrees} deg/s, steps of {dt} s"
                    );
                }
            }
        }
    }

    #[test]
    fn below_its_stiction_it_stands_exactly_still() {
        let (inertia, dt) = (0.5, 1e-4);
        let kick = |torque: f64| {
            SPACE
                .on_day(0.0)
                .brake(torque * dt / inertia, inertia, dt, 0.0, 20.0)
        };
        assert_eq!(kick(12.37), 0.0);
        assert_eq!(kick(-12.37), 0.0);
        assert!(kick(12.38) > 0.0);
    }

    #[test]
    fn friction_that_drives_is_refused() {
        let mut wrong = SPACE;
        wrong.b_2 = -800.0;
        assert_eq!(wrong.validate().unwrap_err().key(), "b_2");
        SPACE.validate().unwrap();
    }

    /// Figs. 12, 13, 14: −40 % near rest, nothing around 5 °/s, +40 % when fast.
    #[test]
    fn temperature_acts_as_in_the_paper() {
        let joint = TrueFriction {
            temperature: Some(TemperatureDependence {
                reference: 10.0,
                slow: -0.031,
                fast: 0.0111,
                neutral_speed: 0.0873,
            }),
            ..SPACE
        };
        let ratio = |degrees: f64, warm, cold| {
            let speed = degrees.to_radians();
            torque(&joint, speed, 3.0, warm) / torque(&joint, speed, 3.0, cold)
        };
        assert!((ratio(1.0, 20.0, -5.0) - 0.6).abs() < 0.02);
        assert!((ratio(5.0, 20.0, -5.0) - 1.0).abs() < 0.02);
        assert!((ratio(31.0, 25.0, -5.0) - 1.4).abs() < 0.02);
        assert_eq!(
            torque(&SPACE, 0.1, 0.0, 25.0),
            torque(&SPACE, 0.1, 0.0, -5.0)
        );
    }

    #[test]
    fn friction_grows_with_the_days() {
        let joint = TrueFriction {
            wear: Some(GearWear {
                per_year: 0.1,
                reference_day: 57.0,
            }),
            ..SPACE
        };
        let unworn = torque(&SPACE, 0.1, 5.0, 0.0);
        assert_eq!(torque_on(57.0, &joint, 0.1, 5.0, 0.0), unworn);
        let later = torque_on(57.0 + 730.5, &joint, 0.1, 5.0, 0.0);
        assert!((later / unworn - 1.2).abs() < 1e-4);
        assert_eq!(torque_on(1e4, &SPACE, 0.1, 5.0, 0.0), unworn);
    }
}
