//! Who a result goes to, and which effects can be said there.

use std::{collections::BTreeMap, path::Path, str::FromStr};

use ferntast_model::friction::{FrictionParameters, effect};
use serde::Serialize;

/// Who a result goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Program {
    /// `<dynamics>` and `<inertial>` of a URDF.
    Urdf,
    /// A model in SDFormat, as Gazebo reads it.
    Sdf,
    /// A model in MuJoCo's XML.
    Mujoco,
    /// The request that sets the friction model of the ROS 2 driver of Universal Robots.
    Ur,
    /// An arm's file of this project, for servo, estimator and twin.
    Ferntast,
}

impl Program {
    /// All of them.
    pub const ALL: [Program; 5] = [
        Program::Urdf,
        Program::Sdf,
        Program::Mujoco,
        Program::Ur,
        Program::Ferntast,
    ];

    /// As it is written after `--to`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Program::Urdf => "urdf",
            Program::Sdf => "sdf",
            Program::Mujoco => "mujoco",
            Program::Ur => "ur",
            Program::Ferntast => "ferntast",
        }
    }

    /// In a sentence.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Program::Urdf => "URDF",
            Program::Sdf => "SDFormat",
            Program::Mujoco => "MuJoCo",
            Program::Ur => "the driver of Universal Robots",
            Program::Ferntast => "an arm's file",
        }
    }

    /// How its files end.
    #[must_use]
    pub const fn ending(self) -> &'static str {
        match self {
            Program::Urdf => "urdf",
            Program::Sdf => "sdf",
            Program::Mujoco => "xml",
            Program::Ur => "yaml",
            Program::Ferntast => "arm.toml",
        }
    }

    /// The file beside an experiment file that is written if no other is named.
    #[must_use]
    pub fn beside(self, experiment: &Path) -> std::path::PathBuf {
        experiment.with_extension(self.ending())
    }

    /// Whether the effect of a joint can be said there, exactly.
    #[must_use]
    pub fn says(self, id: &str) -> bool {
        let of_all = ["coulomb", "viscous"];
        let own: &[&str] = match self {
            Program::Urdf | Program::Ur => &[],
            Program::Sdf => &["cable_spring"],
            // Damping is a polynomial in |q̇| there (MuJoCo 4).
            Program::Mujoco => &[
                "cable_spring",
                "quadratic_viscous",
                "cubic_viscous",
                "nonlinear_viscous",
            ],
            Program::Ferntast => return is_of_the_servo(id),
        };
        of_all.contains(&id) || own.contains(&id)
    }
}

/// Whether the servo's feed-forward has it: the sum of two is written as its parts.
fn is_of_the_servo(id: &str) -> bool {
    let Some(own) = effect(id) else {
        return false;
    };
    let zeros = |id: &str| {
        let row = effect(id).map(|own| own.row);
        let all = row
            .iter()
            .flat_map(|row| row.coefficients.iter().chain(row.shape));
        let values = all.map(|own| (own.key.to_owned(), 0.0_f64.clamp(own.lower, own.upper)));
        (id.to_owned(), values.collect::<BTreeMap<_, _>>())
    };
    let parts: Vec<&str> = match own.row.is_sum {
        true => own.row.parts().collect(),
        false => vec![id],
    };
    let parameters = FrictionParameters {
        speed_range: [0.0, 1.0],
        effects: parts.into_iter().map(zeros).collect(),
    };
    parameters.validate().is_ok()
}

impl FromStr for Program {
    type Err = String;

    fn from_str(text: &str) -> Result<Program, String> {
        let names = Program::ALL.map(Program::name).join(", ");
        let mut all = Program::ALL.into_iter();
        all.find(|own| own.name() == text)
            .ok_or_else(|| format!("one of {names}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_needs_a_date_or_a_temperature_is_said_nowhere() {
        for own in Program::ALL {
            assert!(own.says("coulomb") && own.says("viscous"), "{own:?}");
            assert!(!own.says("temperature_coulomb") && !own.says("wear_drift"));
            assert!(!own.says("joint_coupling") && !own.says("backlash"));
            assert_eq!(own.name().parse(), Ok(own));
        }
        assert!(Program::Ferntast.says("stribeck") && Program::Ferntast.says("load_coulomb"));
        assert!(Program::Ferntast.says("nonlinear_viscous"));
        assert!(Program::Mujoco.says("cubic_viscous") && !Program::Urdf.says("cubic_viscous"));
        assert!(!Program::Mujoco.says("stribeck"));
    }
}
