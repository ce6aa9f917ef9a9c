//! One session of a joint on its bench.

use super::effect::{Effect, Reading};
use super::plant::{self, Plant, friction};
use super::sensors::Sensors;
use super::servo::Servo;
use super::without_hidden::{self, WithoutHidden};
use super::{Bench, BenchError, BenchSession, Motion, motion};
use crate::bench::{Conditions, SECONDS_A_DAY, Stream, random};

/// Nothing on the bench turns further \[rad\].
const FARTHEST: f64 = 10.0;

impl Bench {
    /// Runs session `index`.
    pub(super) fn session(
        &self,
        index: usize,
        motion: Motion,
        conditions: &Conditions,
    ) -> Result<BenchSession, BenchError> {
        let config = &self.config;
        let here = &self.surroundings;
        let mut moves = random(config.seed, Stream::Motion, index);
        let programme = match here.is_routine {
            true => motion::routine(&mut moves),
            false => motion.programme(here.rounds, &mut moves),
        };
        let mut scatter = random(config.seed, Stream::Session, index);
        let joint = self.joint.scattered(config.scatter, &mut scatter);
        let factor = 1.0 + 0.01 * config.scatter * scatter.normal().clamp(-3.0, 3.0);
        let mut effects: Vec<Box<dyn Effect>> = self.effects.iter().map(|e| e.boxed()).collect();
        effects.iter_mut().for_each(|effect| effect.reset());

        let servo = Servo::new(self.believed.inertia);
        let mut sensors = Sensors::new(
            config.noise,
            here.position_quantum,
            random(config.seed, Stream::Noise, index),
        );
        let mut plant = Plant::new(joint, motion.has_springs(), factor);
        let milliseconds = (programme.duration() * 1000.0) as usize;
        let entries = milliseconds / here.log_milliseconds + 1;
        let mut session = BenchSession::with_capacity(entries);
        session.start = conditions.start;
        session.period = here.log_milliseconds as f64 / 1000.0;
        session.motion = Some(motion);
        let mut without = WithoutHidden::new(&self.joint, &self.plain, &effects);
        let mut excesses = Vec::with_capacity(entries);

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
            let asked = servo.torque(programme.at(time, &mut cursor), position, velocity);
            let given = here
                .drive
                .map_or(asked, |drive| asked.clamp(-drive.limit, drive.limit));
            let logs_command = here.drive.is_some_and(|drive| drive.logs_command);
            let command = if logs_command { asked } else { given };
            let motor_torque = effects
                .iter()
                .fold(given, |torque, effect| effect.motor_torque(torque));
            // A torque is held for a millisecond. The state that a log entry shows
            // lies between what was held before and what is held from there on.
            let middle = |before: f64, now: f64| 0.5 * (before + now);
            let logged_command = middle(before.0, command);
            let logged_torque = match logs_command {
                true => logged_command,
                false => middle(before.1, motor_torque),
            };
            before = (command, motor_torque);
            let (position, velocity) = plant.measured();
            let state = *plant.state();
            let excess = plant.inertia_times_angle() - self.plain.inertia * state.position;
            let work = plant.millisecond(motor_torque, &effects);
            let mut reading = Reading {
                position,
                motor_torque: logged_torque,
                joint_torque: state.load,
            };
            for effect in &mut effects {
                effect.tick(work);
                effect.read(logged_command, &mut reading);
            }
            let hidden = plant::hidden(&effects, &state);
            let nominal = friction(&self.joint, &hidden, 1.0, &state);
            let actual = friction(plant.joint(), &hidden, factor, &state);
            let scatter = actual - nominal;
            let misread = without.misread(logged_command - scatter, logged_torque - scatter);
            let plain = without.friction(&state);
            if millisecond % here.log_milliseconds == 0 {
                let (mut logged, temperature) = sensors.log(&reading, state.temperature);
                if let Some([gain, offset]) = here.modelled_load {
                    logged.joint_torque = gain * reading.joint_torque + offset;
                }
                session.push(time, &logged, temperature);
                session.truth.push(&reading, velocity, state.temperature);
                session.truth.push_friction(actual, scatter);
                // In a rigid joint position is measured where friction acts.
                let reading = Reading {
                    position: state.position,
                    motor_torque: reading.motor_torque - misread - (nominal - plain),
                    joint_torque: state.load,
                };
                let other = &mut session.without_hidden;
                other.push(&reading, state.velocity, state.temperature);
                other.push_friction(plain + scatter, scatter);
                excesses.push(excess);
            }
        }
        let torques = &mut session.without_hidden.motor_torque;
        without_hidden::take_inertia(&excesses, session.period, torques);
        Ok(session)
    }
}
