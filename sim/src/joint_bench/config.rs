//! What a recording is to be like.

use thiserror::Error;

use super::{HiddenEffect, Motion};

/// What a recording is to be like. The same configuration gives the same bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchConfig {
    /// Decides parameters, dates, temperatures, random motion and noise.
    pub seed: u64,
    /// Effects in the truth that the believed model lacks; empty: nothing is
    /// hidden. None twice, at most four.
    pub hidden: Vec<HiddenEffect>,
    /// Size of the hidden effects, 0.05 … 2; at 1 the smallest (inertia, load,
    /// delays) stand out from the filtered noise by about 4 in the standard
    /// motion, most by 5 to 12, the terms of equation (4) by far more.
    pub strength: f64,
    /// Sessions on different dates and at different temperatures, 1 … 32.
    pub sessions: usize,
    /// Motion of the sessions; session n moves by `motions[n % motions.len()]`.
    pub motions: Vec<Motion>,
    /// Sensor noise, as a factor on its usual size, 0 … 10. At 0 nothing is quantised either.
    pub noise: f64,
    /// How much parameters differ between sessions, as a factor on the usual
    /// 2 % of Coulomb friction and 0.7 % of the rest, 0 … 10.
    pub scatter: f64,
}

impl Default for BenchConfig {
    fn default() -> Self {
        BenchConfig {
            seed: 1,
            hidden: Vec::new(),
            strength: 1.0,
            sessions: 6,
            motions: vec![Motion::Standard],
            noise: 1.0,
            scatter: 1.0,
        }
    }
}

/// Why there is no recording.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BenchError {
    /// No effect has this id.
    #[error("effect \"{id}\" cannot be hidden: choose one of {known}")]
    UnknownEffect {
        /// What was asked for.
        id: String,
        /// What there is, separated by commas.
        known: String,
    },
    /// No motion has this id.
    #[error("there is no motion \"{id}\": choose one of {known}")]
    UnknownMotion {
        /// What was asked for.
        id: String,
        /// What there is, separated by commas.
        known: String,
    },
    /// A value is out of bounds.
    #[error("{key} = {value} is out of bounds: choose {low} to {high}")]
    OutOfBounds {
        /// Field of [`BenchConfig`].
        key: &'static str,
        /// What was given.
        value: f64,
        /// Least allowed.
        low: f64,
        /// Most allowed.
        high: f64,
    },
    /// An effect is hidden twice.
    #[error("\"{effect}\" is hidden twice: name each effect once")]
    Twice {
        /// Which.
        effect: HiddenEffect,
    },
    /// No motion is given.
    #[error("motions is empty: name at least one motion, such as \"standard\"")]
    NoMotion,
    /// These effects cannot act together.
    #[error("\"{first}\" and \"{second}\" overlap: both change {shared}; hide one of them")]
    Overlap {
        /// One of the two.
        first: HiddenEffect,
        /// The other.
        second: HiddenEffect,
        /// What both change.
        shared: &'static str,
    },
    /// The joint ran away.
    #[error(
        "the joint ran away in session {session} at {time:.3} s: lower the strength or take another seed"
    )]
    RanAway {
        /// Which session, from 0.
        session: usize,
        /// When \[s\].
        time: f64,
    },
}

impl BenchConfig {
    /// Checks every value.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, or what of the hidden effects does not go together.
    pub fn validate(&self) -> Result<(), BenchError> {
        let within = |key, value: f64, low, high| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(BenchError::OutOfBounds {
                    key,
                    value,
                    low,
                    high,
                })
            }
        };
        within("strength", self.strength, 0.05, 2.0)?;
        within("sessions", self.sessions as f64, 1.0, 32.0)?;
        within("hidden.len()", self.hidden.len() as f64, 0.0, 4.0)?;
        within("noise", self.noise, 0.0, 10.0)?;
        within("scatter", self.scatter, 0.0, 10.0)?;
        if self.motions.is_empty() {
            return Err(BenchError::NoMotion);
        }
        for (index, &first) in self.hidden.iter().enumerate() {
            for &second in &self.hidden[..index] {
                if first == second {
                    return Err(BenchError::Twice { effect: first });
                }
                if let Some(shared) = overlap(first, second) {
                    return Err(BenchError::Overlap {
                        first: second,
                        second: first,
                        shared,
                    });
                }
            }
        }
        Ok(())
    }
}

/// What both effects change, where they cannot act side by side.
fn overlap(first: HiddenEffect, second: HiddenEffect) -> Option<&'static str> {
    use HiddenEffect::{
        Backlash, CubicViscous, Elasticity, NonlinearViscous, QuadraticViscous, Viscous,
    };
    let both = |group: &[HiddenEffect]| group.contains(&first) && group.contains(&second);
    if both(&[Viscous, QuadraticViscous, CubicViscous, NonlinearViscous]) {
        Some("the viscous terms, whose share of each other is their answer")
    } else if both(&[Elasticity, Backlash]) {
        Some("the transmission")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(change: impl FnOnce(&mut BenchConfig)) -> String {
        let mut config = BenchConfig::default();
        config.validate().unwrap();
        change(&mut config);
        config.validate().unwrap_err().to_string()
    }

    #[test]
    fn what_is_out_of_bounds_is_refused_by_name() {
        assert!(refused(|c| c.strength = f64::NAN).contains("strength"));
        assert!(refused(|c| c.strength = 2.5).contains("2.5"));
        assert!(refused(|c| c.sessions = 0).contains("sessions"));
        assert!(refused(|c| c.noise = -1.0).contains("noise"));
        assert!(refused(|c| c.scatter = 11.0).contains("scatter"));
        assert!(refused(|c| c.motions.clear()).contains("motion"));
    }

    #[test]
    fn effects_that_do_not_go_together_are_refused() {
        use HiddenEffect::{Backlash, Elasticity, Ripple, Viscous};
        assert!(refused(|c| c.hidden = vec![Ripple, Ripple]).contains("twice"));
        assert!(refused(|c| c.hidden = vec![Elasticity, Backlash]).contains("transmission"));
        let viscous = vec![Viscous, HiddenEffect::CubicViscous];
        assert!(refused(|c| c.hidden = viscous).contains("viscous"));
        assert!(refused(|c| c.hidden = HiddenEffect::ALL.to_vec()).contains("hidden"));
    }
}
