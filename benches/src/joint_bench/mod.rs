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
//! [`BenchRecording::reference_rms`]. So is what would have been logged on the same
//! motion with nothing hidden: [`BenchRecording::without_hidden`].
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
mod law;
mod motion;
mod parameters;
mod plant;
mod real_like;
mod recording;
mod residual;
mod sensors;
mod servo;
mod session;
#[cfg(test)]
mod tests;
mod without_hidden;

pub use crate::bench::{BenchError, Hideable, LOG_PERIOD};
pub use config::BenchConfig;
pub use effect::HiddenEffect;
pub use motion::Motion;
pub use real_like::{RealLike, RealLikeBench};
pub use recording::{BenchRecording, BenchSession, TrueParameter, TrueSignals};
pub use residual::Residual;

use effect::Effect;
use parameters::JointParameters;
use real_like::Surroundings;

use crate::bench::{Conditions, SECONDS_A_DAY, Stream, random};

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
    /// The same with nothing hidden beyond equation (4).
    plain: JointParameters,
    effects: Vec<Box<dyn Effect>>,
    believed: Believed,
    surroundings: Surroundings,
}

impl Bench {
    /// Draws joint and hidden effects.
    ///
    /// # Errors
    ///
    /// A value is out of bounds, or the hidden effects do not go together.
    pub fn new(config: &BenchConfig) -> Result<Self, BenchError> {
        config.validate()?;
        let drawn = JointParameters::draw(&mut random(config.seed, Stream::Subject, 0));
        let effects = config
            .draw_hidden(|hidden, random| effect::draw(hidden, &drawn, config.strength, random));
        let mut joint = drawn.clone();
        for effect in &effects {
            effect.prepare(&mut joint);
        }
        Ok(Bench {
            config: config.clone(),
            believed: Believed {
                inertia: drawn.inertia,
                gear_ratio: drawn.gear_ratio,
                effects: hidden::believed_effects(&config.hidden),
            },
            plain: joint.as_equation_4(&drawn),
            joint,
            effects,
            surroundings: Surroundings::default(),
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
        let hidden = self.config.hidden.iter().zip(&self.effects);
        let hidden = hidden.map(|(&hidden, effect)| (hidden, effect.parameters()));
        TrueParameter::list(joint.named().into_iter().chain(own), hidden)
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
}
