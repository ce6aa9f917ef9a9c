//! Joints, friction, armatures and links as fitted, whoever they go to.

use std::collections::BTreeMap;
use std::path::Path;

use ferntast_identification::{
    Inertia, JointType, arm::Body, comparison::parts::Parts, fit::Parameter,
};
use ferntast_lab::{
    experiment::ArmTable,
    work::{self, Opened, OpenedArm},
};
use ferntast_model::rigid_body::{JointKind, LinkInertia, Vector3};

use super::{Errors, IdentifiedError, Program, Request};

/// A value with its standard error.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    pub value: f64,
    /// `None` where it was given, or chosen.
    pub std_error: Option<f64>,
    pub unit: String,
}

impl Measured {
    /// With its unit, as in "2.31 ± 0.02 Nm".
    pub fn text(&self) -> String {
        let own = significant(self.value);
        match self.std_error {
            Some(error) => format!("{own} ± {} {}", significant(error), self.unit),
            None => format!("{own} {} (given)", self.unit),
        }
    }
}

/// One joint.
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    pub kind: JointType,
    /// The model, taken apart.
    pub parts: Parts,
    /// Parameters as they go on.
    parameters: BTreeMap<String, Parameter>,
    /// Inertia of motor and gear \[kg m²\] or \[kg\].
    pub armature: Measured,
    pub gear_ratio: Option<f64>,
}

/// Links and gravity of an arm.
#[derive(Clone, Debug)]
pub struct ArmModel {
    pub table: ArmTable,
    pub body: Body,
}

/// What was identified.
#[derive(Clone, Debug)]
pub struct Model {
    /// The experiment's file.
    pub title: String,
    pub to: Program,
    pub approximate: bool,
    pub joints: Vec<Joint>,
    pub arm: Option<ArmModel>,
    /// What was noticed while reading.
    read: Vec<String>,
}

impl Model {
    /// Fits the experiment that is asked for.
    pub fn of(request: &Request) -> Result<Model, IdentifiedError> {
        for (option, given, with) in [
            ("--into", request.into.is_some(), Program::Urdf),
            ("--servo-hz", request.servo_hz.is_some(), Program::Mujoco),
            ("--compensated", request.compensated.is_some(), Program::Ur),
        ] {
            if given && request.to != with {
                let with = with.name();
                return Err(IdentifiedError::Option { option, with });
            }
        }
        if let Some(hertz) = request.servo_hz
            && !(0.1..=200.0).contains(&hertz)
        {
            return Err(IdentifiedError::Servo(hertz));
        }
        let mut model = Model::fitted(&request.experiment, request.to, request.approximate)?;
        if let Some(name) = &request.joint {
            match (model.joints.as_mut_slice(), &model.arm) {
                ([only], None) => only.name.clone_from(name),
                _ => return Err(IdentifiedError::Named(model.title)),
            }
        }
        Ok(model)
    }

    /// Fits the experiment at `path`.
    pub fn fitted(path: &Path, to: Program, approximate: bool) -> Result<Model, IdentifiedError> {
        if let Some(opened) = work::open_arm(path)? {
            return Model::of_arm(opened, to, approximate);
        }
        let opened = work::open(path)?;
        let title = path.file_name().unwrap_or(path.as_os_str());
        let mut model = Model {
            title: title.to_string_lossy().into_owned(),
            to,
            approximate,
            joints: Vec::new(),
            arm: None,
            read: Vec::new(),
        };
        for opened in opened {
            model.read.extend(opened.notes.iter().cloned());
            model.joints.push(Joint::of(&opened, to, approximate)?);
        }
        Ok(model)
    }

    fn of_arm(opened: OpenedArm, to: Program, approximate: bool) -> Result<Model, IdentifiedError> {
        refuse_drive_unit(&opened.experiment, to)?;
        let parts = opened.take_apart(&|id| to.says(id))?;
        let Some(table) = opened.experiment.arm.clone() else {
            return Err(IdentifiedError::Contact(opened.experiment.title));
        };
        let kinds = table.arm.chain.kinds();
        let joint = |(at, (name, parts)): (usize, (String, Parts))| {
            let kind = match kinds.get(at) {
                Some(JointKind::Prismatic) => JointType::Prismatic,
                _ => JointType::Revolute,
            };
            let given = match opened.spec.armature.get(at) {
                Some(Inertia::Given(own)) => Some(*own),
                _ => None,
            };
            let ratio = opened.spec.gear_ratio.get(at).copied().flatten();
            Joint::new(name, kind, parts, given, ratio, approximate)
        };
        let body = match parts.refitted {
            Some(refitted) if approximate => refitted,
            _ => parts.body,
        };
        Ok(Model {
            title: opened.experiment.title,
            to,
            approximate,
            joints: parts.joints.into_iter().enumerate().map(joint).collect(),
            arm: Some(ArmModel { table, body }),
            read: opened.notes,
        })
    }

    /// What the model errs by, joint by joint.
    pub fn errors(&self) -> BTreeMap<String, Errors> {
        let each = self.joints.iter().map(|joint| {
            let parts = &joint.parts;
            let errors = Errors {
                held_out: parts.rms.held_out,
                train: parts.rms.train,
                said_alone: parts.without,
                said_refitted: parts.refitted.as_ref().map(|own| own.rms.train),
            };
            (joint.name.clone(), errors)
        });
        each.collect()
    }

    /// What is to be known of it, whoever it goes to.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.read.clone();
        let Some(arm) = &self.arm else {
            return notes;
        };
        for name in &arm.body.held_possible {
            notes.push(format!(
                "{name}: least squares alone finds a body that cannot exist; the nearest that can is written"
            ));
        }
        let of_zeros = |effect: &&String| effect.starts_with("joint_zero");
        for effect in arm.body.effects.keys().filter(of_zeros) {
            notes.push(format!(
                "{effect}: positions of what is written are those of the links; calibrate the joints, or add their zeros to what they say"
            ));
        }
        for (link, name) in arm.body.links.iter().zip(&arm.table.arm.links) {
            if !link.is_physical() {
                notes.push(format!(
                    "link {name}: {} says a mass and inertia that no body can have; correct its <inertial>",
                    arm.table.urdf.display()
                ));
            }
        }
        notes
    }

    /// What is told where a form has no place for the inertia of motors and gears.
    pub fn armatures_unsaid(&self) -> String {
        let each = self.joints.iter();
        let each: Vec<String> = each
            .map(|joint| format!("{} {}", joint.name, joint.armature.text()))
            .collect();
        format!(
            "{} has no place for the inertia of motor and gear, which stands in comments: {}",
            self.to.title(),
            each.join(", ")
        )
    }

    /// The experiment's name.
    pub fn name(&self) -> &str {
        self.title.trim_end_matches(".toml")
    }

    /// First lines for people: what it is, and from where.
    pub fn heading(&self) -> String {
        let how = match self.approximate {
            true => "what can be said here, fitted without the rest",
            false => "values of the whole model",
        };
        format!(
            "identified by ferntast lab from {}; {how}; ± is one standard error",
            self.title
        )
    }
}

impl Joint {
    fn of(opened: &Opened, to: Program, approximate: bool) -> Result<Joint, IdentifiedError> {
        let experiment = &opened.experiment;
        if experiment.joint.is_contact() {
            return Err(IdentifiedError::Contact(experiment.title.clone()));
        }
        refuse_drive_unit(experiment, to)?;
        let parts = opened.take_apart(&|id| to.says(id))?;
        let given = match experiment.model.inertia {
            Inertia::Given(own) => Some(own),
            Inertia::Fit => None,
        };
        let name = experiment.title.trim_end_matches(".toml").to_owned();
        Ok(Joint::new(
            name,
            experiment.joint,
            parts,
            given,
            experiment.model.gear_ratio,
            approximate,
        ))
    }

    fn new(
        name: String,
        kind: JointType,
        parts: Parts,
        given: Option<f64>,
        gear_ratio: Option<f64>,
        approximate: bool,
    ) -> Joint {
        let parameters = parts.chosen(approximate).clone();
        let unit = match kind {
            JointType::Revolute => "kg m²",
            _ => "kg",
        };
        let found = ["inertia", "dJ"].map(|name| parameters.get(name));
        let armature = match (found, given) {
            ([Some(own), _], _) => Measured {
                value: own.value,
                std_error: own.std_error,
                unit: unit.to_owned(),
            },
            ([None, correction], given) => Measured {
                value: given.unwrap_or(0.0) + correction.map_or(0.0, |own| own.value),
                std_error: correction.and_then(|own| own.std_error),
                unit: unit.to_owned(),
            },
        };
        Joint {
            name,
            kind,
            parts,
            parameters,
            armature,
            gear_ratio,
        }
    }

    /// The parameter of this name.
    pub fn get(&self, name: &str) -> Option<Measured> {
        let own = self.parameters.get(name)?;
        Some(Measured {
            value: own.value,
            std_error: own.std_error,
            unit: own.unit.clone(),
        })
    }

    /// Coulomb friction, not below zero.
    pub fn coulomb(&self) -> f64 {
        self.get("b0").map_or(0.0, |own| own.value.max(0.0))
    }

    /// Viscous friction, not below zero.
    pub fn viscous(&self) -> f64 {
        self.get("b1").map_or(0.0, |own| own.value.max(0.0))
    }

    /// Coulomb and viscous friction, for people.
    pub fn friction_text(&self) -> String {
        let text = |name| {
            self.get(name)
                .map_or("none".to_owned(), |own: Measured| own.text())
        };
        format!("friction {}, damping {}", text("b0"), text("b1"))
    }

    /// A value below zero that cannot be, and is written as zero.
    pub fn impossible(&self) -> Vec<String> {
        let words = [("b0", "Coulomb friction"), ("b1", "viscous friction")];
        let below = words.into_iter().filter_map(|(name, word)| {
            let own = self.get(name).filter(|own| own.value < 0.0)?;
            Some(format!(
                "{}: {word} of {} cannot be; 0 is written",
                self.name,
                own.text()
            ))
        });
        below.collect()
    }

    /// A straight spring, where there is one that pulls back: stiffness and where it rests.
    pub fn spring(&self) -> Option<(f64, f64)> {
        let (slope, level) = (self.get("kc")?.value, self.get("k0")?.value);
        (slope > 0.0).then(|| (slope, -level / slope))
    }

    /// Whether something cannot be said of it.
    pub fn is_approximated(&self) -> bool {
        self.parts.refitted.is_some()
    }
}

impl ArmModel {
    /// Whether what a joint carries is other than in the URDF.
    pub fn change(&self, at: usize) -> Option<LinkInertia> {
        let (before, after) = (
            self.table.arm.chain.inertias().get(at)?.parameters(),
            self.body.links.get(at)?.parameters(),
        );
        let mut change = [0.0; 10];
        let each = change.iter_mut().zip(after.iter().zip(&before));
        each.for_each(|(own, (after, before))| *own = after - before);
        let moved = change.iter().any(|own| own.abs() > 1e-12);
        moved.then(|| LinkInertia::from_parameters(&change))
    }

    /// Where gravity points, if it is not straight down \[m/s²\].
    pub fn tilted(&self) -> Option<Vector3<f64>> {
        Some(self.body.gravity).filter(is_tilted)
    }

    /// Parameters of the effects of the arm, for people.
    pub fn effects_text(&self) -> Vec<String> {
        let each = self.body.effects.iter().map(|(effect, own)| {
            let own: Vec<String> = (own.iter())
                .map(|(name, own)| {
                    let own = Measured {
                        value: own.value,
                        std_error: own.std_error,
                        unit: own.unit.clone(),
                    };
                    format!("{name} {}", own.text())
                })
                .collect();
            format!("{effect}: {}", own.join(", "))
        });
        each.collect()
    }
}

/// Whether gravity points elsewhere than straight down: aside, or up, as in the base of an arm
/// that hangs from a ceiling.
fn is_tilted(gravity: &Vector3<f64>) -> bool {
    gravity.z > 0.0 || gravity.x.hypot(gravity.y) > 1e-9 * gravity.norm()
}

/// Roll and pitch \[rad\] of the base in a world whose gravity points straight down,
/// R(roll, pitch, 0) g = (0, 0, −|g|).
pub fn upright(gravity: &Vector3<f64>) -> [f64; 2] {
    [
        (-gravity.y).atan2(-gravity.z),
        gravity.x.atan2(gravity.y.hypot(gravity.z)),
    ]
}

fn refuse_drive_unit(
    experiment: &ferntast_lab::experiment::Experiment,
    to: Program,
) -> Result<(), IdentifiedError> {
    match experiment.drive_unit() {
        None => Ok(()),
        Some(unit) => Err(IdentifiedError::DriveUnit {
            title: experiment.title.clone(),
            unit,
            to: to.title(),
        }),
    }
}

/// Four digits.
pub fn significant(value: f64) -> String {
    ferntast_lab::report::significant(value)
}

#[cfg(test)]
mod tests {
    use ferntast_model::rigid_body::Placement;

    use super::*;

    const G: f64 = 9.81;

    #[test]
    fn gravity_that_points_up_or_aside_is_tilted_and_down_is_not() {
        for up_or_aside in [
            [0.0, 0.0, G],
            [0.0, -0.0, 1e-3],
            [G, 0.0, 0.0],
            [0.0, -G, 0.0],
            [1e-6, 0.0, -G],
        ] {
            assert!(is_tilted(&Vector3::from(up_or_aside)), "{up_or_aside:?}");
        }
        for down in [[0.0, 0.0, -G], [1e-12, -1e-12, -G], [0.0; 3]] {
            assert!(!is_tilted(&Vector3::from(down)), "{down:?}");
        }
    }

    #[test]
    fn a_base_stands_so_that_its_gravity_points_straight_down_in_the_world() {
        for gravity in [
            [0.0, 0.0, G],
            [-0.0, -0.0, G],
            [0.0, 0.0, -G],
            [G, 0.0, 0.0],
            [-G, 0.0, 0.0],
            [0.0, G, 0.0],
            [0.0, -G, 0.0],
            [1.0, -2.0, 3.0],
            [-1e-9, 1e-9, G],
        ] {
            let gravity = Vector3::from(gravity);
            let [roll, pitch] = upright(&gravity);
            let base = Placement::from_roll_pitch_yaw(Vector3::zeros(), [roll, pitch, 0.0]);
            let found = base.rotation * gravity;
            let straight_down = Vector3::new(0.0, 0.0, -gravity.norm());
            assert!(
                (found - straight_down).norm() < 1e-12,
                "{gravity:?}: {found:?}"
            );
        }
    }
}
