//! The laws there are, behind one type.

use super::{
    Energy, Follower, FollowerEnd, FollowerInput, FollowerOutput, FourChannel, Guarantee, Leader,
    LeaderEnd, LeaderInput, LeaderOutput, Mapping, ModelMediated, Parameters, PositionForce,
    PositionPosition, Tdpa, Wave,
};
use ferntast_model::{ParameterError, Section};
use serde::{Deserialize, Serialize};

/// Makes [`Law`] and its ends from one line a law.
macro_rules! laws {
    ($($(#[$doc:meta])* $law:ident,)*) => {
        /// Which law, with its parameters: the section `[law]` of a configuration.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "snake_case")]
        pub enum Law {
            $($(#[$doc])* $law($law),)*
        }

        /// The leader's end of any law.
        #[derive(Clone, Debug)]
        pub enum LeaderLaw {
            $($(#[$doc])* $law(<$law as Parameters>::Leader),)*
        }

        /// The follower's end of any law.
        #[derive(Clone, Debug)]
        pub enum FollowerLaw {
            $($(#[$doc])* $law(<$law as Parameters>::Follower),)*
        }

        impl Law {
            /// Names of all laws, as in configurations.
            pub const NAMES: &[&str] = &[$(<$law as Parameters>::NAME,)*];

            /// Every law, with the parameters that it has by default.
            pub fn all() -> Vec<Law> {
                vec![$(Law::$law($law::default()),)*]
            }

            /// Its name, as in configurations.
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Law::$law(_) => <$law as Parameters>::NAME,)*
                }
            }

            /// What it guarantees. Under which assumptions, the law's file says.
            pub const fn guarantee(&self) -> Guarantee {
                match self {
                    $(Law::$law(_) => <$law as Parameters>::GUARANTEE,)*
                }
            }

            /// Scales between hand and tip.
            pub fn mapping(&self) -> Mapping {
                match self {
                    $(Law::$law(law) => law.mapping(),)*
                }
            }

            /// Checks every value against its bounds.
            ///
            /// # Errors
            ///
            /// The first value that is out of bounds.
            pub fn validate(&self) -> Result<(), ParameterError> {
                match self {
                    $(Law::$law(law) => law.validate(),)*
                }
            }

            /// The leader's end.
            pub fn leader(&self) -> LeaderEnd {
                LeaderEnd::new(match self {
                    $(Law::$law(law) => LeaderLaw::$law(law.leader()),)*
                })
            }

            /// The follower's end.
            pub fn follower(&self) -> FollowerEnd {
                FollowerEnd::new(match self {
                    $(Law::$law(law) => FollowerLaw::$law(law.follower()),)*
                })
            }
        }

        impl Leader for LeaderLaw {
            fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
                match self {
                    $(LeaderLaw::$law(law) => law.step(dt, input, energy),)*
                }
            }

            fn dissipated(&self) -> f64 {
                match self {
                    $(LeaderLaw::$law(law) => law.dissipated(),)*
                }
            }
        }

        impl Follower for FollowerLaw {
            fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
                match self {
                    $(FollowerLaw::$law(law) => law.step(dt, input, energy),)*
                }
            }

            fn dissipated(&self) -> f64 {
                match self {
                    $(FollowerLaw::$law(law) => law.dissipated(),)*
                }
            }
        }
    };
}

laws! {
    /// Position forward, force back.
    PositionForce,
    /// Position forward, position back.
    PositionPosition,
    /// Position and force both ways.
    FourChannel,
    /// Wave variables with impedance matching and drift correction.
    Wave,
    /// Two-port time-domain passivity with drift compensation.
    Tdpa,
    /// The surface as the follower estimates it, rendered at the leader.
    ModelMediated,
}

impl Default for Law {
    fn default() -> Self {
        Law::PositionForce(PositionForce::default())
    }
}

impl Law {
    /// The law of that name, with the parameters that it has by default.
    pub fn by_name(name: &str) -> Option<Law> {
        Law::all().into_iter().find(|law| law.name() == name)
    }

    /// Whether it claims that no more energy leaves at hand and tip than entered, whatever the
    /// channel does, with the arm, the servo and the estimator that ship.
    pub const fn claims_passivity(&self) -> bool {
        matches!(self.guarantee(), Guarantee::Passive)
    }

    /// Power at the hand by power at the tip that corresponds to it, s_F/s_x
    /// \[-\]: energy at the follower's port times this compares with the leader's.
    pub fn power_scale(&self) -> f64 {
        self.mapping().power_scale()
    }
}

impl Section for Law {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        let within = |error: ParameterError| error.within(&format!("{key} ({})", self.name()));
        self.validate().map_err(within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_is_read_by_its_name_and_valid_as_it_stands() {
        for law in Law::all() {
            assert_eq!(law.validate(), Ok(()), "{}", law.name());
            let read: Law = toml::from_str(&format!("kind = \"{}\"", law.name())).unwrap();
            assert_eq!(read, law);
            assert_eq!(Law::by_name(law.name()), Some(law));
        }
        assert_eq!(Law::NAMES.len(), Law::all().len());
        assert_eq!(Law::by_name("none"), None);
    }
}
