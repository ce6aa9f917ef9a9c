//! Which experiment: its motion laid out on the arm's contour.

use ferntast_control::servo::{self, ServoConfig};
use ferntast_model::{
    ParameterError, Vector2,
    arm::Arm,
    contour::{Feature, Surface},
    kinematics::{Elbow, Kinematics},
};
use ferntast_sim::arm::{ArmConfig, JOINTS};
use serde::{Deserialize, Serialize};

use super::{
    ExperimentError,
    program::{ContactMotion, Press, Program, SineMotion, SpringMotion, StiffnessMotion, Stroke},
};

/// Torque at the pulled joint where the spring is pushed most \[Nm\] (Fig. 8).
const SPRING_TORQUE: f64 = 13.0;
/// Free way before a spring \[m\], for joint 1 and joint 2.
const SPRING_FREE: [f64; JOINTS] = [0.055, 0.060];
/// The sinusoid: middle of joint 2 and amplitude \[rad\].
const SINE_CENTER: f64 = 1.606;
const SINE_AMPLITUDE: f64 = 0.1745;
/// How far joint 2's command goes behind the fixed point \[rad\].
const STIFFNESS_DEPTH: f64 = 0.0115;
/// Stiffness of the point that the tip is placed on \[N/m\], and the
/// integration's step that resolves it \[s\].
const FIXED_STIFFNESS: f64 = 1e6;
const FIXED_SUBSTEP: f64 = 4e-5;
/// Amplitude along an edge \[m\].
const CONTACT_AMPLITUDE: f64 = 0.020;

/// An experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Plan {
    /// A spring of the contour pulled at constant velocities (Fig. 3).
    Spring {
        /// Joint 1 or 2.
        joint: usize,
        /// Speeds \[deg/s\].
        speeds: Vec<f64>,
        /// Time for each of them \[s\].
        time_per_speed: f64,
    },
    /// Joint 2 swings freely (Fig. 9).
    Sine {
        /// Frequencies \[Hz\].
        frequencies: Vec<f64>,
        /// Time for each of them \[s\].
        time_per_frequency: f64,
    },
    /// A saw-tooth of joint 2's torque against the fixed tip (Fig. 15).
    Stiffness {
        /// Teeth.
        teeth: u32,
    },
    /// A sinusoid along an edge at constant normal force (Figs. 16, 17).
    Contact {
        /// Which edge.
        surface: Surface,
        /// Normal forces \[N\].
        forces: Vec<f64>,
        /// Frequencies \[Hz\].
        frequencies: Vec<f64>,
        /// Time for each force at each frequency \[s\].
        time_per_press: f64,
    },
}

/// The share of the way between two postures at which `feature` is touched.
fn touched(
    kinematics: &Kinematics,
    feature: &Feature,
    free: &Vector2<f64>,
    loaded: &Vector2<f64>,
) -> f64 {
    root(|share| feature.distance(&kinematics.forward(&(free + (loaded - free) * share))))
}

/// Where between 0 and 1 the falling function `f` is zero, by bisection.
fn root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

impl Plan {
    /// Its name.
    pub fn kind(&self) -> &'static str {
        match self {
            Plan::Spring { .. } => "spring",
            Plan::Sine { .. } => "sine",
            Plan::Stiffness { .. } => "stiffness",
            Plan::Contact { .. } => "contact",
        }
    }

    /// Name of its recording in a folder of several.
    pub fn folder(&self) -> String {
        match self {
            Plan::Spring { joint, .. } => format!("spring_joint_{joint}"),
            Plan::Sine { .. } => "sine_joint_2".to_owned(),
            Plan::Stiffness { .. } => "stiffness_joint_2".to_owned(),
            Plan::Contact { surface, .. } => match surface {
                Surface::Lubricated => "contact_lubricated".to_owned(),
                Surface::Unlubricated => "contact_unlubricated".to_owned(),
                Surface::Spring => "contact_spring".to_owned(),
            },
        }
    }

    /// The servo's tuning: it may press harder than in a session.
    pub fn servo(&self) -> ServoConfig {
        let limit = match self {
            Plan::Stiffness { .. } => 70.0,
            _ => 38.0,
        };
        ServoConfig {
            pressing_limit: vec![limit; JOINTS],
            ..ServoConfig::default()
        }
    }

    /// Whether the contact's forces are estimated.
    pub fn is_contact(&self) -> bool {
        matches!(self, Plan::Contact { .. })
    }

    /// Changes what has to be otherwise on the arm: the stiffness experiment
    /// needs a point that holds the tip.
    pub fn prepare(&self, arm: &mut ArmConfig) {
        if !matches!(self, Plan::Stiffness { .. }) {
            return;
        }
        arm.truth.surface.unlubricated.stiffness = FIXED_STIFFNESS;
        arm.truth.substep = arm.truth.substep.min(FIXED_SUBSTEP);
        for edge in &mut arm.contour.edge {
            if edge.surface == Surface::Unlubricated {
                edge.contact.stiffness = FIXED_STIFFNESS;
            }
        }
    }

    /// The motion on this arm.
    ///
    /// # Errors
    ///
    /// A contour without the feature that is needed, a number out of bounds.
    pub fn program(&self, arm: &ArmConfig) -> Result<Box<dyn Program>, ExperimentError> {
        let layout = Layout::new(arm)?;
        Ok(match self {
            Plan::Spring {
                joint,
                speeds,
                time_per_speed,
            } => {
                let stroke = layout.stroke(joint.saturating_sub(1).min(JOINTS - 1))?;
                Box::new(SpringMotion::new(stroke, speeds, *time_per_speed)?)
            }
            Plan::Sine {
                frequencies,
                time_per_frequency,
            } => Box::new(SineMotion::new(
                // Joint 1 half as far the other way: the tip stays on its ray.
                [-0.5 * SINE_CENTER, SINE_CENTER],
                [-0.5 * SINE_AMPLITUDE, SINE_AMPLITUDE],
                frequencies,
                *time_per_frequency,
            )?),
            Plan::Stiffness { teeth } => layout.stiffness(*teeth)?,
            Plan::Contact {
                surface,
                forces,
                frequencies,
                time_per_press,
            } => {
                let presses: Vec<Press> = frequencies
                    .iter()
                    .flat_map(|&frequency| {
                        forces.iter().map(move |&force| Press { force, frequency })
                    })
                    .collect();
                layout.contact(arm, *surface, &presses, *time_per_press)?
            }
        })
    }
}

/// The contour as the motions need it.
struct Layout {
    kinematics: Kinematics,
    features: Vec<Feature>,
    elbow: Elbow,
    nominal_tip: Vector2<f64>,
    nominal: Vector2<f64>,
}

impl Layout {
    fn new(arm: &ArmConfig) -> Result<Self, ExperimentError> {
        let kinematics = *Arm::new(&arm.arm).kinematics();
        let nominal_tip = Vector2::from(arm.contour.nominal_tip);
        let elbow = arm.contour.nominal_elbow;
        Ok(Layout {
            nominal: kinematics.inverse(&nominal_tip, elbow)?,
            kinematics,
            features: arm.contour.features(),
            elbow,
            nominal_tip,
        })
    }

    /// The first feature of which `fits` is told surface and cosine between
    /// normal and the ray from joint 1.
    fn find(
        &self,
        what: &'static str,
        fits: impl Fn(Surface, f64) -> bool,
    ) -> Result<Feature, ExperimentError> {
        let ray = self.nominal_tip.normalize();
        self.features
            .iter()
            .find(|feature| fits(feature.surface, feature.normal.dot(&ray)))
            .copied()
            .ok_or(ExperimentError::NoFeature { what })
    }

    fn stroke(&self, joint: usize) -> Result<Stroke, ExperimentError> {
        let (free, loaded, spring) = match joint {
            0 => self.around_joint_1()?,
            _ => self.along_the_ray()?,
        };
        Ok(Stroke {
            joint,
            free: free.into(),
            loaded: loaded.into(),
            touch: touched(&self.kinematics, &spring, &free, &loaded),
        })
    }

    /// Joint 1 alone turns the arm against the spring across the ray.
    fn around_joint_1(&self) -> Result<(Vector2<f64>, Vector2<f64>, Feature), ExperimentError> {
        let spring = self.find("spring across the ray from joint 1", |surface, cosine| {
            surface == Surface::Spring && cosine.abs() < 0.1
        })?;
        let radius = self.nominal_tip.norm();
        let turn = |joint: f64| Vector2::new(joint, self.nominal.y);
        let depth = SPRING_TORQUE / (spring.contact.stiffness * radius);
        // Against the normal, seen from the side that the tip is on.
        let ray = self.nominal_tip.normalize();
        let side = -(spring.normal.y * ray.x - spring.normal.x * ray.y).signum();
        let at = |distance: f64| {
            let share = root(|share| {
                let q = turn(self.nominal.x + side * (2.0 * share - 1.0) * 0.5);
                spring.distance(&self.kinematics.forward(&q)) - distance
            });
            turn(self.nominal.x + side * (2.0 * share - 1.0) * 0.5)
        };
        Ok((at(SPRING_FREE[0]), at(-depth), spring))
    }

    /// Both joints draw the tip along its ray against the spring on it.
    fn along_the_ray(&self) -> Result<(Vector2<f64>, Vector2<f64>, Feature), ExperimentError> {
        let spring = self.find("spring on the ray from joint 1", |surface, cosine| {
            surface == Surface::Spring && cosine > 0.9
        })?;
        let at = |distance: f64| {
            let tip = spring.center + spring.normal * distance;
            self.kinematics.inverse(&tip, self.elbow)
        };
        let torque = |depth: f64| {
            let Ok(q) = at(-depth) else {
                return f64::INFINITY;
            };
            let lever = spring.normal.dot(&self.kinematics.jacobian(&q).column(1));
            spring.contact.stiffness * depth * lever.abs()
        };
        let deepest = 0.1;
        let depth = deepest * root(|share| SPRING_TORQUE - torque(share * deepest));
        Ok((at(SPRING_FREE[1])?, at(-depth)?, spring))
    }

    fn stiffness(&self, teeth: u32) -> Result<Box<dyn Program>, ExperimentError> {
        let edge = self.find("edge across the ray from joint 1", |surface, cosine| {
            surface == Surface::Unlubricated && cosine.abs() > 0.9
        })?;
        let ray = self.nominal_tip.normalize();
        let to_edge = edge.distance(&self.nominal_tip) / -edge.normal.dot(&ray);
        let touch = self.nominal_tip + ray * to_edge;
        let free = touch + edge.normal * 0.002;
        let touch = self.kinematics.inverse(&touch, self.elbow)?;
        let inwards = -edge
            .normal
            .dot(&self.kinematics.jacobian(&touch).column(1))
            .signum();
        Ok(Box::new(StiffnessMotion::new(
            self.kinematics.inverse(&free, self.elbow)?.into(),
            touch.into(),
            inwards * STIFFNESS_DEPTH,
            teeth,
        )?))
    }

    fn contact(
        &self,
        arm: &ArmConfig,
        surface: Surface,
        presses: &[Press],
        time: f64,
    ) -> Result<Box<dyn Program>, ExperimentError> {
        let edge = self.find("edge of that surface", |other, _| other == surface)?;
        let along = edge.along(&self.nominal_tip);
        let tip = edge.center + edge.tangent() * along;
        let q = self.kinematics.inverse(&tip, self.elbow)?;
        let servo = servo_stiffness(arm, &q, &edge)?;
        // Servo, joints and surface one behind the other.
        let stiffness = 1.0 / (1.0 / servo + 1.0 / edge.contact.stiffness);
        let motion = ContactMotion::new(edge, along, CONTACT_AMPLITUDE, stiffness, presses, time)?;
        Ok(Box::new(motion))
    }
}

/// Stiffness of servo and joints along the normal of `edge` at the tip \[N/m\].
fn servo_stiffness(
    arm: &ArmConfig,
    q: &Vector2<f64>,
    edge: &Feature,
) -> Result<f64, ParameterError> {
    let compliance = servo::tip_compliance(&arm.model(), &ServoConfig::default(), q)?;
    let along = edge.normal.dot(&(compliance * edge.normal));
    Ok(1.0 / along.max(1e-9))
}
