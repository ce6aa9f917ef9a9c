//! A tip on an edge: the truth behind challenges and the blind test of the
//! model lab, for contacts.
//!
//! A [`ContactBench`] is drawn from a seed: an edge with Coulomb friction by the
//! normal force (equation 6), a film that is viscous, and the effects that are
//! to be hidden. Its [`record`](ContactBench::record) slides the tip along the
//! edge under several normal forces, in sessions on different dates and at
//! different temperatures, and logs every 12 ms as the paper did: place along
//! the edge, F_T, F_N, temperature. The place is that of the motors: a tip that
//! sticks while they move on is seen in F_T alone (the paper's Fig. 16).
//! Parameters differ a little between sessions.
//!
//! The experimenter believes in Coulomb and viscous friction without what is
//! hidden ([`ContactRecording::believed`]). What that leaves unexplained is
//! known here ([`ContactRecording::visibility`]), as is what would have been logged
//! on the same way with nothing hidden ([`ContactRecording::without_hidden`]).
//!
//! Nothing is shared with the models that the lab fits, nor with the simulated
//! arm. Pure: same configuration, same bytes.

mod edge;
mod effect;
mod hidden;
mod motion;
mod normal_force;
mod parameters;
mod recording;
mod residual;
mod sensors;
#[cfg(test)]
mod tests;

pub use hidden::HiddenEffect;
pub use motion::Motion;
pub use recording::{ContactRecording, ContactSession, TrueForces, TrueParameter};

use edge::Edge;
use effect::Effect;
use normal_force::NormalForce;
use parameters::EdgeParameters;
use sensors::{Reading, Sensors};

use crate::bench::{BenchError, Conditions, MILLISECONDS_A_LOG, SECONDS_A_DAY, Stream, random};

/// What a recording of a contact is to be like.
///
/// At strength 1 effects stand out from the filtered noise by 4 to 40
/// ([`ContactRecording::visibility`]). Between sessions friction differs by 2 %.
pub type ContactConfig = crate::bench::BenchConfig<HiddenEffect, Motion>;

/// An edge under a tip, with what it hides.
pub struct ContactBench {
    config: ContactConfig,
    /// With what hidden effects change in it.
    edge: EdgeParameters,
    /// The same with nothing hidden beyond Coulomb and viscous friction.
    plain: EdgeParameters,
    effects: Vec<Box<dyn Effect>>,
}

impl ContactBench {
    /// Draws edge and hidden effects.
    ///
    /// # Errors
    ///
    /// A value is out of bounds, or the hidden effects do not go together.
    pub fn new(config: &ContactConfig) -> Result<Self, BenchError> {
        config.validate()?;
        let drawn = EdgeParameters::draw(&mut random(config.seed, Stream::Subject, 0));
        let effects = config
            .draw_hidden(|hidden, random| effect::draw(hidden, &drawn, config.strength, random));
        let mut edge = drawn;
        for effect in &effects {
            effect.prepare(&mut edge);
        }
        Ok(ContactBench {
            config: config.clone(),
            plain: EdgeParameters {
                b0t: edge.b0t,
                film: edge.film,
                ..drawn
            },
            edge,
            effects,
        })
    }

    /// Runs every session.
    pub fn record(&self) -> ContactRecording {
        let config = &self.config;
        let conditions = Conditions::draw(
            config.sessions,
            false,
            config
                .motions
                .iter()
                .all(|motion| motion.same_temperature()),
            &mut random(config.seed, Stream::Conditions, 0),
        );
        let sessions = conditions
            .iter()
            .enumerate()
            .map(|(index, conditions)| {
                let motion = config.motions[index % config.motions.len()];
                self.session(index, motion, conditions)
            })
            .collect();
        ContactRecording {
            hidden: config.hidden.clone(),
            strength: config.strength,
            believed: hidden::believed_effects(&config.hidden),
            truth: self.parameters(),
            sessions,
        }
    }

    /// Runs `sessions` more on the same edge, a month after `recorded`: what is
    /// hidden stays, dates, temperatures, scatter and noise are new.
    pub fn follow_up(
        &self,
        recorded: &ContactRecording,
        motion: Motion,
        sessions: usize,
    ) -> Vec<ContactSession> {
        let before = recorded.sessions.len();
        let last = recorded.sessions.last().map_or(0.0, |last| last.start);
        let conditions = Conditions::draw(
            sessions,
            false,
            motion.same_temperature(),
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

    /// True parameters before they scatter: the edge's, then each hidden effect's.
    fn parameters(&self) -> Vec<TrueParameter> {
        let hidden = self.config.hidden.iter().zip(&self.effects);
        let hidden = hidden.map(|(&hidden, effect)| (hidden, effect.parameters()));
        TrueParameter::list(self.edge.named(), hidden)
    }

    fn session(&self, index: usize, motion: Motion, conditions: &Conditions) -> ContactSession {
        let config = &self.config;
        let course = motion.course(&mut random(config.seed, Stream::Motion, index));
        let mut scatter = random(config.seed, Stream::Session, index);
        let factor = 1.0 + 0.02 * config.scatter * scatter.normal().clamp(-3.0, 3.0);
        let mut normal = NormalForce::new(scatter);
        let mut sensors = Sensors::new(config.noise, random(config.seed, Stream::Noise, index));
        // The same tip three times: as it is, without this session's scatter, and
        // without that and what is hidden.
        let start = course.path.at(0.0, &mut 0)[0];
        let mut edge = Edge::new(self.edge, start);
        let mut nominal = Edge::new(self.edge, start);
        let mut plain = Edge::new(self.plain, start);
        let milliseconds = (course.path.duration() * 1000.0) as usize;
        let mut session = ContactSession::with_capacity(milliseconds / MILLISECONDS_A_LOG + 1);
        session.start = conditions.start;
        session.motion = Some(motion);

        let mut cursor = 0;
        for millisecond in 0..=milliseconds {
            let time = millisecond as f64 * 1e-3;
            let [place, ..] = course.path.at(time, &mut cursor);
            let normal_force = normal.step(course.force(time));
            let share = time / course.path.duration();
            let at = edge::Moment {
                place,
                normal_force,
                date: (conditions.start + time) / SECONDS_A_DAY,
                temperature: conditions.temperature + conditions.warming * share,
            };
            let tangential = edge.millisecond(&at, &self.effects, factor);
            let unscattered = nominal.millisecond(&at, &self.effects, 1.0);
            let scatter = tangential - unscattered;
            let without = plain.millisecond(&at, &[], 1.0) + scatter;
            if millisecond % MILLISECONDS_A_LOG == 0 {
                let exact = Reading {
                    place,
                    tangential,
                    normal: normal_force,
                };
                session.push(
                    time,
                    &sensors.log(&exact),
                    sensors.temperature(at.temperature),
                );
                session.truth.push(&exact, scatter);
                let exact = Reading {
                    tangential: without,
                    ..exact
                };
                session.without_hidden.push(&exact, scatter);
            }
        }
        session
    }
}
