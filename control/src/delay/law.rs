//! The laws there are, behind one type.

use super::{FollowerEnd, Guarantee, LeaderEnd, PositionForce};

/// Makes an enum of laws and those of their ends from one line a law.
macro_rules! laws {
    (
        $(#[$of_laws:meta])* $laws:ident, $leaders:ident, $followers:ident:
        $($(#[$doc:meta])* $law:ident,)*
    ) => {
        $(#[$of_laws])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(tag = "kind", rename_all = "snake_case")]
        // In place: a switch of the law must not allocate.
        #[allow(clippy::large_enum_variant)]
        pub enum $laws {
            $($(#[$doc])* $law($crate::delay::$law),)*
        }

        /// The leader's end of any of these laws.
        #[derive(Clone, Debug)]
        #[allow(clippy::large_enum_variant)]
        pub enum $leaders {
            $($(#[$doc])* $law(<$crate::delay::$law as $crate::delay::Parameters>::Leader),)*
        }

        /// The follower's end of any of these laws.
        #[derive(Clone, Debug)]
        #[allow(clippy::large_enum_variant)]
        pub enum $followers {
            $($(#[$doc])* $law(<$crate::delay::$law as $crate::delay::Parameters>::Follower),)*
        }

        impl $laws {
            /// Names of these laws, as in configurations.
            pub const NAMES: &[&str] =
                &[$(<$crate::delay::$law as $crate::delay::Parameters>::NAME,)*];

            /// Each of them, with the parameters that it has by default.
            pub fn all() -> Vec<$laws> {
                vec![$($laws::$law($crate::delay::$law::default()),)*]
            }

            /// Its name, as in configurations.
            pub const fn name(&self) -> &'static str {
                match self {
                    $($laws::$law(_) => <$crate::delay::$law as $crate::delay::Parameters>::NAME,)*
                }
            }

            /// What it guarantees. Under which assumptions, the law's file says.
            pub fn guarantee(&self) -> $crate::delay::Guarantee {
                use $crate::delay::Parameters;
                match self {
                    $($laws::$law(law) => Parameters::guarantee(law),)*
                }
            }

            /// Scales between hand and tip.
            pub fn mapping(&self) -> $crate::delay::Mapping {
                use $crate::delay::Parameters;
                match self {
                    $($laws::$law(law) => Parameters::mapping(law),)*
                }
            }

            /// What its packets say: the leader's, the follower's.
            pub fn samples(&self) -> [$crate::delay::Samples; 2] {
                use $crate::delay::Parameters;
                match self {
                    $($laws::$law(law) => Parameters::samples(law),)*
                }
            }

            /// The same law between the scales of `mapping`.
            #[must_use]
            pub fn between(&self, mapping: &$crate::delay::Mapping) -> $laws {
                use $crate::delay::Parameters;
                match self {
                    $($laws::$law(law) => $laws::$law(Parameters::between(law, mapping)),)*
                }
            }

            /// Checks every value against its bounds.
            ///
            /// # Errors
            ///
            /// The first value that is out of bounds.
            pub fn validate(&self) -> Result<(), ferntast_model::ParameterError> {
                match self {
                    $($laws::$law(law) => law.validate(),)*
                }
            }

            /// The leader's end, without what counts its energy.
            pub(in $crate::delay) fn bare_leader(&self) -> $leaders {
                use $crate::delay::Parameters;
                match self {
                    $($laws::$law(law) => $leaders::$law(Parameters::leader(law)),)*
                }
            }

            /// The follower's end, without what counts its energy.
            pub(in $crate::delay) fn bare_follower(&self) -> $followers {
                use $crate::delay::Parameters;
                match self {
                    $($laws::$law(law) => $followers::$law(Parameters::follower(law)),)*
                }
            }
        }

        impl ferntast_model::Section for $laws {
            fn validate_at(&self, key: &str) -> Result<(), ferntast_model::ParameterError> {
                let within = |error: ferntast_model::ParameterError| {
                    error.within(&format!("{key} ({})", self.name()))
                };
                self.validate().map_err(within)
            }
        }

        impl $crate::delay::Leader for $leaders {
            fn step(
                &mut self,
                dt: f64,
                input: &$crate::delay::LeaderInput,
                energy: $crate::delay::Energy,
            ) -> $crate::delay::LeaderOutput {
                match self {
                    $($leaders::$law(law) => law.step(dt, input, energy),)*
                }
            }

            fn given(&mut self, force: nalgebra::Vector3<f64>) {
                match self {
                    $($leaders::$law(law) => law.given(force),)*
                }
            }

            fn nearness(&self) -> f64 {
                match self {
                    $($leaders::$law(law) => law.nearness(),)*
                }
            }

            fn dissipated(&self) -> f64 {
                match self {
                    $($leaders::$law(law) => law.dissipated(),)*
                }
            }
        }

        impl $crate::delay::Follower for $followers {
            fn step(
                &mut self,
                dt: f64,
                input: &$crate::delay::FollowerInput,
                energy: $crate::delay::Energy,
            ) -> $crate::delay::FollowerOutput {
                match self {
                    $($followers::$law(law) => law.step(dt, input, energy),)*
                }
            }

            fn commanded(&mut self, position: nalgebra::Vector3<f64>) {
                match self {
                    $($followers::$law(law) => law.commanded(position),)*
                }
            }

            fn dissipated(&self) -> f64 {
                match self {
                    $($followers::$law(law) => law.dissipated(),)*
                }
            }
        }
    };
}
pub(super) use laws;

laws! {
    /// Which law, with its parameters: the section `[law]` of a configuration.
    Law, LeaderLaw, FollowerLaw:
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
    /// Another law within limits of energy.
    TwoLayer,
    /// Model of the surface or contact force, by delay and contact, within limits of energy.
    Auto,
}

impl Default for Law {
    fn default() -> Self {
        Law::PositionForce(PositionForce::default())
    }
}

impl Law {
    /// The leader's end.
    pub fn leader(&self) -> LeaderEnd {
        LeaderEnd::new(self.bare_leader())
    }

    /// The follower's end.
    pub fn follower(&self) -> FollowerEnd {
        FollowerEnd::new(self.bare_follower())
    }

    /// The law of that name, with the parameters that it has by default.
    pub fn by_name(name: &str) -> Option<Law> {
        Law::all().into_iter().find(|law| law.name() == name)
    }

    /// Whether it claims that no more energy leaves at hand and tip than entered, whatever the
    /// channel does, with the arm, the servo and the estimator that ship.
    pub fn claims_passivity(&self) -> bool {
        matches!(self.guarantee(), Guarantee::Passive)
    }

    /// Power at the hand by power at the tip that corresponds to it, s_F/s_x
    /// \[-\]: energy at the follower's port times this compares with the leader's.
    pub fn power_scale(&self) -> f64 {
        self.mapping().power_scale()
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
