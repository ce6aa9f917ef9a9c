//! Table 1: friction parameters identified for joint 2.

use super::{Friction, FrictionParameters};
use crate::ParameterError;
use std::collections::BTreeMap;

/// A published set of parameters of equation (4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Name, after the row of Table 1.
    pub name: &'static str,
    /// b_0 \[Nm\].
    pub b_0: f64,
    /// b_0T \[-\]; `None` where it was not excited and so not identified.
    pub b_0t: Option<f64>,
    /// b_1 \[Nm·s/rad\].
    pub b_1: f64,
    /// b_2 \[Nm·s²/rad²\].
    pub b_2: f64,
    /// b_3 \[Nm·s³/rad³\].
    pub b_3: f64,
    /// Smallest and largest speed |q̇| of the trajectory it was identified on \[rad/s\].
    pub speed_range: [f64; 2],
}

/// The "spring" trajectory pulls at 1, 5, 10, 20 and 40 °/s.
const SPRING_SPEEDS: [f64; 2] = [1.0_f64.to_radians(), 40.0_f64.to_radians()];

/// The sinusoidal trajectory reaches no further than about 20 °/s. The paper
/// shows it as a figure only: the bound is assumed. At 40 °/s the set would
/// give 199 Nm, several times what was measured there.
const SINUSOIDAL_SPEEDS: [f64; 2] = [0.0, 20.0_f64.to_radians()];

/// The rows of Table 1.
pub static PRESETS: &[Preset] = &[
    Preset {
        name: "on_ground",
        b_0: 7.573,
        b_0t: Some(0.127),
        b_1: 168.388,
        b_2: -544.193,
        b_3: 516.421,
        speed_range: SPRING_SPEEDS,
    },
    Preset {
        name: "spring_2005_03_24",
        b_0: 12.372,
        b_0t: Some(0.146),
        b_1: 163.301,
        b_2: -578.954,
        b_3: 547.449,
        speed_range: SPRING_SPEEDS,
    },
    Preset {
        name: "spring_2005_05_12",
        b_0: 10.850,
        b_0t: Some(-0.178),
        b_1: 194.957,
        b_2: -608.227,
        b_3: 570.378,
        speed_range: SPRING_SPEEDS,
    },
    Preset {
        name: "sinusoidal_2005_12_22",
        b_0: 11.635,
        b_0t: None,
        b_1: 258.253,
        b_2: -1246.582,
        b_3: 1805.827,
        speed_range: SINUSOIDAL_SPEEDS,
    },
];

impl Preset {
    /// The preset called `name`.
    ///
    /// # Errors
    ///
    /// [`ParameterError::Unknown`] with the names there are.
    pub fn named(name: &str) -> Result<&'static Preset, ParameterError> {
        PRESETS
            .iter()
            .find(|preset| preset.name == name)
            .ok_or_else(|| ParameterError::Unknown {
                key: name.to_owned(),
                known: PRESETS
                    .iter()
                    .map(|preset| preset.name)
                    .collect::<Vec<_>>()
                    .join(", "),
            })
    }

    /// The preset as it would stand in a configuration file.
    pub fn parameters(&self) -> FrictionParameters {
        let mut effects = BTreeMap::new();
        let mut add = |id: &str, key: &str, value: f64| {
            effects.insert(id.to_owned(), BTreeMap::from([(key.to_owned(), value)]));
        };
        add("coulomb", "b_0", self.b_0);
        if let Some(b_0t) = self.b_0t {
            add("load_coulomb", "b_0T", b_0t);
        }
        add("viscous", "b_1", self.b_1);
        add("quadratic_viscous", "b_2", self.b_2);
        add("cubic_viscous", "b_3", self.b_3);
        FrictionParameters {
            speed_range: self.speed_range,
            effects,
        }
    }

    /// The preset as a friction model.
    ///
    /// # Errors
    ///
    /// Never with the presets of Table 1, which are within all bounds.
    pub fn friction(&self) -> Result<Friction, ParameterError> {
        Friction::new(&self.parameters())
    }
}
