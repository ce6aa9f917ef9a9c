//! What is known of recordings before an effect is sought in them.

use serde::{Deserialize, Serialize};

use crate::rigid_body::JointKind;

/// What was recorded: it decides the catalogue of effects, and the names and
/// units in which results are reported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointType {
    /// rad, Nm, kg m².
    #[default]
    Revolute,
    /// m, N, kg.
    Prismatic,
    /// No joint, but the same to a fit: a tip that slides along a contour. m and
    /// N, no inertia; F_T stands in the place of τ_F, F_N in that of the load:
    /// F_T = Σ effects (equation 6).
    Contact,
}

impl From<JointKind> for JointType {
    fn from(kind: JointKind) -> JointType {
        match kind {
            JointKind::Revolute => JointType::Revolute,
            JointKind::Prismatic => JointType::Prismatic,
        }
    }
}

impl JointType {
    /// The catalogue that applies.
    #[must_use]
    pub const fn subject(self) -> Subject {
        match self {
            Self::Revolute | Self::Prismatic => Subject::Joint,
            Self::Contact => Subject::Contact,
        }
    }

    /// Whether a contact was recorded.
    #[must_use]
    pub const fn is_contact(self) -> bool {
        matches!(self, Self::Contact)
    }

    /// What a signal of a joint is called here, in files and results.
    #[must_use]
    pub fn signal(self, of_joint: &str) -> &str {
        if !self.is_contact() {
            return of_joint;
        }
        match of_joint {
            "position" => "place",
            "velocity" => "tip_velocity",
            "acceleration" => "tip_acceleration",
            "load" => "normal_force",
            "load_rate" => "normal_force_rate",
            "motor_torque" => "tangential_force",
            other => other,
        }
    }

    /// Unit of forces or torques.
    #[must_use]
    pub const fn force_unit(self) -> &'static str {
        match self {
            Self::Revolute => "Nm",
            Self::Prismatic | Self::Contact => "N",
        }
    }
}

/// What a catalogue of effects is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    /// τ_F of a joint.
    Joint,
    /// F_T of a tip in contact.
    Contact,
}

impl Subject {
    /// With an article, for messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Joint => "a joint",
            Self::Contact => "a contact",
        }
    }
}

/// What is known of the recordings as a whole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// Kind of joint.
    pub joint: JointType,
    /// J \[kg m²\], where it is given.
    pub inertia: Option<f64>,
    /// Motor turns in one turn of the joint.
    pub gear_ratio: Option<f64>,
    /// Whether τ is recorded.
    pub joint_torque: bool,
    /// Whether that is the torque of a model, not that of a sensor.
    pub torque_is_modelled: bool,
    /// Whether that model is of an arm's links, whose errors are effects of the arm.
    pub torque_is_of_links: bool,
    /// Whether the temperature is measured.
    pub temperature: bool,
    /// T₀ \[degC\], the mean.
    pub reference_temperature: f64,
    /// Range of T \[K\].
    pub temperature_range: f64,
    /// Number of sessions.
    pub sessions: usize,
    /// Days from the first session to the last.
    pub days: f64,
    /// The longest recording \[s\], over the gaps within it.
    pub recording_length: f64,
    /// Range of q \[rad\] (second to 98th percentile).
    pub position: [f64; 2],
    /// Second and 98th percentile of |q̇| while moving \[rad/s\].
    pub speed: [f64; 2],
    /// Top of |τ_m| \[Nm\].
    pub motor_torque: f64,
    /// Mean power \[W\] that the motor gives and the load does not take, while moving.
    pub friction_power: f64,
    /// |τ_m| \[Nm\] that one sample in four exceeds, of those away from rest.
    pub common_torque: f64,
    /// Travel \[rad\] that is seen for certain, for the position's noise.
    pub resolved: f64,
    /// Whether there is a load: a torque sensor, gravity, a spring or an inertia.
    pub loaded: bool,
    /// Working period \[s\].
    pub period: f64,
    /// Whether the model has Coulomb friction that grows with the load.
    pub load_coulomb: bool,
}

impl Facts {
    /// Why nothing can be said of temperature, if nothing can.
    #[must_use]
    pub fn no_temperature(&self) -> Option<String> {
        (!self.temperature || self.temperature_range < 2.0)
            .then(|| "the temperature is not measured or varies by less than 2 K".to_owned())
    }

    /// Why nothing can be said of a curve over temperature, if nothing can.
    #[must_use]
    pub fn too_few_temperatures(&self) -> Option<String> {
        let few = (3..5).contains(&self.sessions);
        let too_few = few.then(|| {
            "through so few sessions a curve over temperature always fits: five are needed"
                .to_owned()
        });
        self.no_temperature().or(too_few)
    }

    /// Why nothing can be said of a joint torque sensor, if nothing can.
    #[must_use]
    pub fn no_torque_sensor(&self) -> Option<String> {
        (!self.joint_torque || self.torque_is_modelled).then(|| "no joint torque sensor".to_owned())
    }

    /// Why nothing can be said of gain and zero of τ, by a sensor or by a model in its place, if
    /// nothing can.
    #[must_use]
    pub fn no_torque_channel(&self) -> Option<String> {
        match (self.joint_torque, self.torque_is_of_links) {
            (false, _) => Some("no joint torque, of a sensor or by a model".to_owned()),
            (true, true) => Some(
                "the joint torque is that of the arm's links, which have effects of their own"
                    .to_owned(),
            ),
            (true, false) => None,
        }
    }

    /// Length \[rad\] of the range of positions.
    #[must_use]
    pub fn travel(&self) -> f64 {
        self.position[1] - self.position[0]
    }

    /// Why nothing can be said of load, if nothing can.
    #[must_use]
    pub fn no_load(&self) -> Option<String> {
        (!self.loaded).then(|| {
            "no load: neither a joint torque sensor nor gravity, spring, inertia or a formula of such in the model"
                .to_owned()
        })
    }

    /// Why nothing can be said of how friction changes within a recording, if nothing can.
    #[must_use]
    pub fn no_warm_up(&self) -> Option<String> {
        (self.recording_length < 60.0)
            .then(|| "recordings of less than a minute: a joint takes longer to warm up".to_owned())
    }

    /// Why nothing can be said of dates, if nothing can.
    #[must_use]
    pub fn no_dates(&self) -> Option<String> {
        (self.sessions < 4 || self.days < 0.5)
            .then(|| "fewer than four sessions or all on one day".to_owned())
    }
}
