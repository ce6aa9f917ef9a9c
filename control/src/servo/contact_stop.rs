//! Stops the setpoint where the arm runs into something.
//!
//! Contact force and command go round through estimator, law and tracker, which takes some
//! 30 ms; a surface that is stiff has pushed the motors back by then, with what their inertia
//! and the friction fed forward bring along. The servo has the joint torques at once. What they
//! do not explain of the links' motion, after equation (5), Jᵀ F = M(q) q̈ + C(q, q̇) q̇ + g(q) − τ,
//! is a contact's; where it comes suddenly and against the motion, the setpoint stands for a
//! moment, in which the motors are braked (collision detection and reaction:
//! Haddadin, De Luca, Albu-Schäffer 2017, "Robot collisions: a survey on detection, isolation,
//! and identification", IEEE T-RO 33, sections IV and VI; theirs by the momentum observer).
//!
//! How much is a contact's is not told but found: what comes up suddenly in free motion has a
//! covariance ([`noise`]), and a contact is some standard deviations beyond it, of all joints
//! together. A joint alone has most of its noise by the inertia of links that it turns as
//! well, which the others' torques tell of.
//!
//! What is slow stops nothing: errors of the torque sensors' zeros and of weights, and surfaces
//! that are soft. In a contact only what comes across it does, as of the second wall of a
//! corner; what changes along it is its own. An arm without torque sensors, which tells
//! zeros, has none of this. Of a gear that is soft the damping has to be known, else what shakes
//! it looks like a contact.

mod noise;

use super::Measurement;
use crate::contact_torque::{Form, Links, MeasuredContact};
use crate::{low_pass_share, seconds};
use ferntast_model::joint::JointParameters;
use ferntast_model::{JointCount, Joints, parameters};
use noise::Noise;

parameters! {
    /// How the setpoint stops where the arm runs into something. Every key may be left out:
    /// it does not stop then, as the errors of an arm's sensors are not known.
    #[derive(Copy)]
    pub struct ContactStopConfig {
        /// Torque that no error of a sensor's zero or of a weight comes up to \[Nm\]: a joint
        /// that is pressed on with more is in contact already, and only what comes across that
        /// stops it (ROKVISS: 0.55 Nm); 0: it never stops.
        pub torque: f64 [0.0..=1e4, "Nm"] = 0.0,
        /// How far beyond what comes up in free motion a contact is \[standard deviations\].
        pub deviations: f64 [3.0..=100.0, "-"] = 9.0,
        /// For how long the setpoint stands \[s\].
        pub time: f64 [0.001..=0.1, "s"] = 0.01,
        /// Cut-off of the filters of motion and torque \[Hz\]: a contact is seen 2/(2π f) late.
        pub cut_off: f64 [10.0..=400.0, "Hz"] = 80.0,
    }
}

/// What grows with a larger time constant is not sudden [s].
const SUDDEN: f64 = 0.003;
/// Standard deviation that every joint has in free motion, as a share of the torque that is a
/// contact's [-]: the noise of sensors that have none.
const LEAST_NOISE: f64 = 0.02;
/// A setpoint slower than this, all joints together, need not be stopped [rad/s].
const SLOW: f64 = 0.02;
/// An arm that is pressed shakes less than in free motion, and loses less by a stop: so many of the
/// standard deviations tell what comes across [-].
const ACROSS: f64 = 2.0 / 3.0;
/// From one stop to the next, from the end of a contact and from the first measurement on: filters
/// settle [s].
const APART: f64 = 0.1;
/// So many measurements of no torque at all are of no sensor: of one in steps of its noise some may be.
const MOST_ZEROS: u32 = 20;
/// Longer without a measurement, and the filters begin anew [s].
const LONGEST_GAP: f64 = 0.005;

/// Sees the arm run into something.
#[derive(Clone, Debug)]
pub(super) struct ContactStop {
    config: ContactStopConfig,
    contact: MeasuredContact,
    /// When it was measured last [ns].
    stamp_ns: Option<i64>,
    /// Mean of the contact's torque over the time that is sudden [Nm].
    lately: Joints<f64>,
    /// What comes up suddenly in free motion.
    noise: Noise,
    /// Measurements of no torque, one after the other.
    zeros: u32,
    /// For how long the setpoint stands still [s], and for how long no stop may follow.
    stands: f64,
    rests: f64,
    /// For how long none may after the end of a contact [s].
    let_go: f64,
}

impl ContactStop {
    /// For `joints` as they are believed to be, checked before.
    pub(super) fn new(
        joints: &[JointParameters],
        count: JointCount,
        config: &ContactStopConfig,
    ) -> ContactStop {
        ContactStop {
            config: *config,
            contact: MeasuredContact::new(joints, count, Form::Direct, config.cut_off, LONGEST_GAP),
            stamp_ns: None,
            lately: Joints::filled(count, 0.0),
            noise: Noise::new(LEAST_NOISE * config.torque),
            zeros: 0,
            stands: 0.0,
            rests: 0.0,
            let_go: 0.0,
        }
    }

    /// Does not stop for a moment from now on.
    pub(super) fn rest(&mut self) {
        self.stands = 0.0;
        self.rests = APART;
    }

    /// Whether the setpoint, which has that `velocity` \[rad/s\], stands in this step of
    /// `period` \[s\].
    pub(super) fn step(
        &mut self,
        links: &impl Links,
        period: f64,
        measured: &Measurement,
        velocity: &Joints<f64>,
    ) -> bool {
        self.stands -= period;
        self.rests -= period;
        self.let_go -= period;
        if self.stamp_ns.is_none_or(|last| measured.stamp_ns > last) {
            let runs_into = self.runs_into(links, measured, velocity);
            if runs_into && self.rests < 0.0 {
                self.stands = self.config.time;
                self.rests = APART;
            }
        }
        self.stands > 0.0
    }

    /// Whether something has suddenly come up against the motion.
    fn runs_into(
        &mut self,
        links: &impl Links,
        measured: &Measurement,
        velocity: &Joints<f64>,
    ) -> bool {
        let passed = self
            .stamp_ns
            .replace(measured.stamp_ns)
            .map_or(0.0, |last| seconds(measured.stamp_ns - last));
        let torque = &measured.torque;
        self.zeros = match torque.iter().all(|own| *own == 0.0) {
            true => self.zeros.saturating_add(1),
            false => 0,
        };
        if self.zeros > MOST_ZEROS {
            self.contact.forget();
            return false;
        }
        let seen = self.contact.step(links, passed, &measured.position, torque);
        let contact = seen.motion.contact_torque;
        if seen.anew {
            self.rest();
            self.lately = contact;
            return false;
        }
        let share = low_pass_share(passed, SUDDEN);
        let sudden = Joints::from_fn(contact.count(), |joint| contact[joint] - self.lately[joint]);
        let before = self.lately;
        let (mut power, mut speed_squared) = (0.0, 0.0);
        for joint in 0..contact.len() {
            self.lately[joint] += share * sudden[joint];
            power += sudden[joint] * velocity[joint];
            speed_squared += velocity[joint] * velocity[joint];
        }
        let (deviations, moving) = (self.config.deviations, speed_squared > SLOW * SLOW);
        let pressed = before.iter().any(|own| own.abs() > self.config.torque);
        let beyond = if pressed {
            // Letting go of it shakes the arm, and is sudden, too.
            self.let_go = APART;
            let deviations = ACROSS * deviations;
            moving && self.noise.is_beyond_across(deviations, &sudden, &before)
        } else {
            self.noise.is_beyond(deviations, &sudden, passed, moving) && self.let_go < 0.0
        };
        beyond && power < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::tests::{arm, joint};
    use ferntast_model::Vector2;
    use ferntast_model::arm::{Arm, solve_symmetric};

    const MS: i64 = 1_000_000;
    /// Noise of the torque sensors, standard deviation \[Nm\].
    const NOISE: f64 = 0.02;

    /// Where a joint touches, and how stiff that is there \[rad, Nm/rad\].
    type Wall = Option<(f64, f64)>;

    /// Links behind the gears of motors that turn as they should.
    struct Plant {
        links: Arm,
        joints: [JointParameters; 2],
        q: Vector2<f64>,
        qd: Vector2<f64>,
        walls: [Wall; 2],
        /// Of the torque sensors \[Nm\].
        noise: f64,
        random: u64,
    }

    /// Where the motors begin \[rad\].
    const BEGIN: [f64; 2] = [0.0, 1.2];

    impl Plant {
        fn new(walls: [Wall; 2], noise: f64) -> Plant {
            Plant {
                links: Arm::new(&arm()),
                joints: [joint(), joint()],
                q: BEGIN.into(),
                qd: Vector2::zeros(),
                walls,
                noise,
                random: 1,
            }
        }

        /// Normal after the sum of twelve uniform numbers (Knuth's 64-bit congruence).
        fn normal(&mut self) -> f64 {
            let mut uniform = || {
                self.random = self.random.wrapping_mul(6364136223846793005);
                self.random = self.random.wrapping_add(1442695040888963407);
                (self.random >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        }

        fn touches(&self, joint: usize) -> bool {
            self.walls[joint].is_some_and(|(place, _)| self.q[joint] > place)
        }

        /// A millisecond later, the motors at `motors` with `speed`.
        fn measure(
            &mut self,
            stamp_ns: i64,
            motors: Vector2<f64>,
            speed: Vector2<f64>,
        ) -> Measurement {
            const PARTS: usize = 20;
            let dt = 1e-3 / PARTS as f64;
            let mut torque = Vector2::zeros();
            for part in 1..=PARTS {
                let before = speed * (1e-3 - dt * part as f64);
                let wound = motors - before - self.q;
                torque = 4400.0 * wound + 5.0 * (speed - self.qd);
                let contact = Vector2::from_fn(|joint, _| {
                    self.walls[joint].map_or(0.0, |(place, stiffness)| {
                        (stiffness * (place - self.q[joint])).min(0.0)
                    })
                });
                let links = self.links.posture(&self.q);
                let pulls = torque + contact - links.bias(&self.qd);
                self.qd += solve_symmetric(&links.inertia, &pulls) * dt;
                self.q += self.qd * dt;
            }
            Measurement {
                stamp_ns,
                position: <[f64; 2]>::from(motors).into(),
                velocity: <[f64; 2]>::from(speed).into(),
                torque: [torque.x, torque.y]
                    .map(|own| own + self.noise * self.normal())
                    .into(),
            }
        }
    }

    /// Before the motors turn, and until they turn as they should [s].
    const REST: f64 = 0.3;
    const STARTS: f64 = 0.05;
    /// What a motor that turns on pushes with is not measured beyond this \[Nm\].
    const SENSOR_RANGE: f64 = 110.0;

    /// From joint `touching` touching on until the setpoint stands, and for how long from the start
    /// on \[ms\]; the motors rest, and turn with `speed(t)` \[rad/s\] for three seconds. `noise`: of
    /// the torque sensors \[Nm\], if there are any.
    fn stands_at(
        touching: usize,
        walls: [Wall; 2],
        noise: Option<f64>,
        speed: impl Fn(f64) -> [f64; 2],
    ) -> (Option<usize>, usize) {
        let mut plant = Plant::new(walls, noise.unwrap_or(0.0));
        let config = ContactStopConfig {
            torque: 0.55,
            ..ContactStopConfig::default()
        };
        let count = JointCount::new(2).unwrap();
        let mut own = ContactStop::new(&plant.joints, count, &config);
        let mut motors = Vector2::from(BEGIN);
        let (mut touched, mut first, mut long) = (None, None, 0);
        for k in 0..3300 {
            let t = 1e-3 * k as f64 - REST;
            let now = Vector2::from(speed(t.max(0.0))) * (t / STARTS).clamp(0.0, 1.0);
            motors += now * 1e-3;
            let mut measured = plant.measure((k as i64 + 1) * MS, motors, now);
            if measured.torque[0] > SENSOR_RANGE {
                break;
            }
            if noise.is_none() {
                measured.torque = [0.0; 2].into();
            }
            if plant.touches(touching) {
                touched = touched.or(Some(k));
            }
            let setpoint = <[f64; 2]>::from(now).into();
            if own.step(&plant.links, 1e-3, &measured, &setpoint) {
                long += 1;
                first = first.or(touched.map(|touched| k - touched));
            }
        }
        (first, long)
    }

    /// The same of joint 1, the other stands.
    fn stands(
        wall: Wall,
        noise: Option<f64>,
        speed: impl Fn(f64) -> f64,
    ) -> (Option<usize>, usize) {
        stands_at(0, [wall, None], noise, |t| [speed(t), 0.0])
    }

    /// 20 kN/m at 0.35 m from the axis, met at 60 mm/s.
    const STIFF: (f64, f64) = (0.2, 2450.0);
    const SPEED: f64 = 0.17;
    /// To and fro with up to 12 rad/s².
    const TO_AND_FRO: fn(f64) -> f64 = |t| 0.6 * (20.0 * t).sin();

    /// The torque sensors alone see 1 Nm, 3 N at the tip, after some 6 ms.
    #[test]
    fn it_stands_a_few_milliseconds_after_a_stiff_contact_began_and_once() {
        let (first, long) = stands(Some(STIFF), Some(NOISE), |_| SPEED);
        assert!((2..=5).contains(&first.unwrap()), "{first:?} ms");
        assert_eq!(long, 10);
    }

    #[test]
    fn what_is_soft_or_nothing_at_all_stops_nothing() {
        let soft = (STIFF.0, 0.05 * STIFF.1);
        assert_eq!(stands(Some(soft), Some(NOISE), |_| SPEED), (None, 0));
        assert_eq!(stands(None, Some(NOISE), |_| SPEED), (None, 0));
        assert_eq!(stands(None, Some(NOISE), TO_AND_FRO), (None, 0));
    }

    /// Nobody tells it how noisy they are.
    #[test]
    fn a_contact_is_seen_as_soon_as_the_noise_of_the_sensors_allows() {
        let mut last = 2;
        for noise in [0.0, 0.2, 1.0, 5.0].map(|times| times * NOISE) {
            assert_eq!(
                stands(None, Some(noise), |_| SPEED),
                (None, 0),
                "{noise} Nm"
            );
            assert_eq!(
                stands(None, Some(noise), TO_AND_FRO),
                (None, 0),
                "{noise} Nm"
            );
            let (first, long) = stands(Some(STIFF), Some(noise), |_| SPEED);
            let first = first.unwrap();
            assert!((last..=9).contains(&first), "{first} ms, {noise} Nm");
            assert_eq!(long, 10);
            last = first;
        }
        assert!(last > 5, "{last} ms");
    }

    /// Joint 1 is pressed on with 2 Nm, which gives way; then joint 2 meets something.
    #[test]
    fn in_a_contact_it_stands_where_another_one_comes_across() {
        let pressed = Some((0.05, 6.0));
        let turning = |t: f64| [SPEED, if t > 1.0 { SPEED } else { 0.0 }];
        let at = |other: Wall| stands_at(1, [pressed, other], Some(NOISE), turning);
        assert_eq!(at(None), (None, 0));
        let (first, long) = at(Some((BEGIN[1] + 0.1, STIFF.1)));
        assert!((2..=6).contains(&first.unwrap()), "{first:?} ms");
        assert_eq!(long, 10);
    }

    #[test]
    fn an_arm_that_measures_no_torque_is_not_stopped() {
        assert_eq!(stands(Some(STIFF), None, |_| SPEED), (None, 0));
        // Nor would it see anything where it speeds up.
        assert_eq!(stands(None, None, TO_AND_FRO), (None, 0));
    }
}
