//! One joint on a test bench: the truth behind challenges and the blind test
//! of the model lab.
//!
//! A [`Bench`] is drawn from a seed: friction around Table 1, a contour with
//! two springs, gear ratio 160, and the effects that are to be hidden. Its
//! [`record`](Bench::record) runs sessions on different dates and at different
//! temperatures in a closed position loop, integrated at 10 kHz, and logs
//! every 12 ms as the paper did: position, motor torque (from the current),
//! joint torque, temperature. Parameters differ a little between sessions.
//!
//! The experimenter believes in equation (4) without what is hidden
//! ([`Believed`]). What that leaves unexplained, and what the true model would
//! leave, is known here and nowhere else: [`BenchRecording::believed_residual`],
//! [`BenchRecording::reference_rms`].
//!
//! Nothing is shared with the models that the lab fits. Pure: same
//! configuration, same bytes.
//!
//! # Strength
//!
//! [`BenchConfig::strength`] scales the parameter that makes the effect (or,
//! for a saturation, lowers its limit), not the residual itself.
//! [`BenchRecording::visibility`] gives the rms of the effect's own part over
//! the rms of the filtered noise, for the recording at hand.

mod config;
mod effect;
mod hidden;
mod motion;
mod parameters;
mod plant;
mod recording;
mod residual;
mod sensors;
mod servo;
#[cfg(test)]
mod tests;

pub use crate::bench::{BenchError, Hideable, LOG_PERIOD};
pub use config::BenchConfig;
pub use hidden::HiddenEffect;
pub use motion::Motion;
pub use recording::{BenchRecording, BenchSession, TrueParameter, TrueSignals};
pub use residual::Residual;

use effect::{Effect, Reading};
use parameters::JointParameters;
use plant::{Plant, friction};
use sensors::Sensors;
use servo::Servo;

use crate::bench::{Conditions, MILLISECONDS_A_LOG, SECONDS_A_DAY, Stream, random};

/// Nothing on the bench turns further \[rad\].
const FARTHEST: f64 = 10.0;

/// What the experimenter believes: the truth without what is hidden.
#[derive(Clone, Debug, PartialEq)]
pub struct Believed {
    /// J \[kg m²\].
    pub inertia: f64,
    /// N \[-\].
    pub gear_ratio: f64,
    /// Ids of the effects in the model.
    pub effects: Vec<&'static str>,
}

/// A joint on its bench, with what it hides.
pub struct Bench {
    config: BenchConfig,
    /// With what hidden effects change in it.
    joint: JointParameters,
    effects: Vec<Box<dyn Effect>>,
    believed: Believed,
}

impl Bench {
    /// Draws joint and hidden effects.
    ///
    /// # Errors
    ///
    /// A value is out of bounds, or the hidden effects do not go together.
    pub fn new(config: &BenchConfig) -> Result<Self, BenchError> {
        config.validate()?;
        let plain = JointParameters::draw(&mut random(config.seed, Stream::Subject, 0));
        let effects: Vec<Box<dyn Effect>> = config
            .hidden
            .iter()
            .map(|&hidden| {
                let mut random = random(config.seed, Stream::Effect, hidden as usize);
                effect::draw(hidden, &plain, config.strength, &mut random)
            })
            .collect();
        let mut joint = plain.clone();
        for effect in &effects {
            effect.prepare(&mut joint);
        }
        Ok(Bench {
            config: config.clone(),
            believed: Believed {
                inertia: plain.inertia,
                gear_ratio: plain.gear_ratio,
                effects: hidden::believed_effects(&config.hidden),
            },
            joint,
            effects,
        })
    }

    /// Runs every session.
    ///
    /// # Errors
    ///
    /// The joint ran away; with Table 1's friction it does not.
    pub fn record(&self) -> Result<BenchRecording, BenchError> {
        let config = &self.config;
        let all = |motion| config.motions.iter().all(|&other| other == motion);
        let conditions = Conditions::draw(
            config.sessions,
            all(Motion::TemperatureSweep),
            all(Motion::DateSweep),
            &mut random(config.seed, Stream::Conditions, 0),
        );
        let sessions = conditions
            .iter()
            .enumerate()
            .map(|(index, conditions)| {
                let motion = config.motions[index % config.motions.len()];
                self.session(index, motion, conditions)
            })
            .collect::<Result<_, _>>()?;
        Ok(BenchRecording {
            hidden: config.hidden.clone(),
            strength: config.strength,
            believed: self.believed.clone(),
            truth: self.parameters(),
            sessions,
        })
    }

    /// True parameters before they scatter: the joint's, then each hidden effect's.
    fn parameters(&self) -> Vec<TrueParameter> {
        let joint = &self.joint;
        let own = [
            ("inertia", joint.inertia, "kg m²"),
            ("gear_ratio", joint.gear_ratio, "-"),
            ("bristle", joint.bristle, "rad"),
            ("link_inertia", joint.link_inertia, "kg m²"),
            ("spring", joint.spring, "Nm/rad"),
            ("spring_start", joint.spring_start, "rad"),
        ];
        let hidden = self
            .config
            .hidden
            .iter()
            .zip(&self.effects)
            .flat_map(|(&hidden, effect)| {
                let named = effect.parameters().into_iter();
                named.map(move |parameter| (Some(hidden), parameter))
            });
        joint
            .named()
            .into_iter()
            .chain(own)
            .map(|parameter| (None, parameter))
            .chain(hidden)
            .map(|(effect, (name, value, unit))| TrueParameter {
                effect,
                name,
                value,
                unit,
            })
            .collect()
    }

    /// Runs `sessions` more with the same joint, a month after `recorded`: what
    /// is hidden stays, dates, temperatures, scatter and noise are new.
    ///
    /// # Errors
    ///
    /// As [`record`](Self::record).
    pub fn follow_up(
        &self,
        recorded: &BenchRecording,
        motion: Motion,
        sessions: usize,
    ) -> Result<Vec<BenchSession>, BenchError> {
        let before = recorded.sessions.len();
        let last = recorded.sessions.last().map_or(0.0, |last| last.start);
        let conditions = Conditions::draw(
            sessions,
            motion == Motion::TemperatureSweep,
            motion == Motion::DateSweep,
            &mut random(self.config.seed, Stream::Conditions, before),
        );
        conditions
            .into_iter()
            .enumerate()
            .map(|(index, mut conditions)| {
                conditions.start += last + 30.0 * SECONDS_A_DAY;
                self.session(before + index, motion, &conditions)
            })
            .collect()
    }

    fn session(
        &self,
        index: usize,
        motion: Motion,
        conditions: &Conditions,
    ) -> Result<BenchSession, BenchError> {
        let config = &self.config;
        let programme = motion.programme(&mut random(config.seed, Stream::Motion, index));
        let mut scatter = random(config.seed, Stream::Session, index);
        let joint = self.joint.scattered(config.scatter, &mut scatter);
        let factor = 1.0 + 0.01 * config.scatter * scatter.normal().clamp(-3.0, 3.0);
        let mut effects: Vec<Box<dyn Effect>> = self.effects.iter().map(|e| e.boxed()).collect();
        effects.iter_mut().for_each(|effect| effect.reset());

        let servo = Servo::new(self.believed.inertia);
        let mut sensors = Sensors::new(config.noise, random(config.seed, Stream::Noise, index));
        let mut plant = Plant::new(joint, motion.has_springs(), factor);
        let milliseconds = (programme.duration() * 1000.0) as usize;
        let mut session = BenchSession::with_capacity(milliseconds / MILLISECONDS_A_LOG + 1);
        session.start = conditions.start;
        session.motion = Some(motion);

        let mut cursor = 0;
        // Command and motor torque of the millisecond before.
        let mut before = (0.0, 0.0);
        for millisecond in 0..=milliseconds {
            let time = millisecond as f64 * 1e-3;
            let share = time / programme.duration();
            plant.set_conditions(
                time,
                (conditions.start + time) / SECONDS_A_DAY,
                conditions.temperature + conditions.warming * share,
            );

            let (position, velocity) = plant.motor();
            if !(position.abs() < FARTHEST && velocity.is_finite()) {
                return Err(BenchError::RanAway {
                    session: index,
                    time,
                });
            }
            let command = servo.torque(programme.at(time, &mut cursor), position, velocity);
            let motor_torque = effects
                .iter()
                .fold(command, |torque, effect| effect.motor_torque(torque));
            // A torque is held for a millisecond. The state that a log entry shows
            // lies between what was held before and what is held from there on.
            let middle = |before: f64, now: f64| 0.5 * (before + now);
            let command_there = middle(before.0, command);
            let (position, velocity) = plant.measured();
            let state = *plant.state();
            let work = plant.millisecond(motor_torque, &effects);
            let mut reading = Reading {
                position,
                motor_torque: middle(before.1, motor_torque),
                joint_torque: state.load,
            };
            for effect in &mut effects {
                effect.tick(work);
                effect.read(command_there, &mut reading);
            }
            before = (command, motor_torque);
            if millisecond % MILLISECONDS_A_LOG == 0 {
                let (logged, temperature) = sensors.log(&reading, state.temperature);
                session.push(time, &logged, temperature);
                session.truth.push(&reading, velocity, state.temperature);
                let hidden = plant::hidden(&effects, &state);
                let nominal = friction(&self.joint, &hidden, 1.0, &state);
                let actual = friction(plant.joint(), &hidden, factor, &state);
                session.truth.friction.push(actual);
                session.truth.scatter.push(actual - nominal);
            }
        }
        Ok(session)
    }
}
