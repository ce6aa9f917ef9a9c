//! An arm's fitted model taken apart, as it goes on to other programs.

use std::collections::BTreeMap;

use ferntast_model::rigid_body::{LinkInertia, Vector3};

use super::comparison::{name_partner, of_arm};
use super::data::ArmDataset;
use super::effects::ArmEffect;
use super::error::ArmError;
use super::prepared::PreparedArm;
use super::spec::ArmSpec;
use crate::comparison::parts::{Parts, Refitted, Says};
use crate::fit::Parameter;

/// An arm's fitted model taken apart.
#[derive(Clone, Debug)]
pub struct ArmParts {
    /// Every joint, from the base on.
    pub joints: Vec<(String, Parts)>,
    /// Links and gravity.
    pub body: Body,
    /// The same with only what can be said of the joints; `None` where that is all.
    pub refitted: Option<Body>,
}

/// Links and gravity as fitted.
#[derive(Clone, Debug)]
pub struct Body {
    /// What each joint carries, in the frame of its link.
    pub links: Vec<LinkInertia>,
    /// In the base frame \[m/s²\].
    pub gravity: Vector3<f64>,
    /// Parameters of the effects of the arm, by `effect` or `effect@joint`.
    pub effects: BTreeMap<String, BTreeMap<String, Parameter>>,
    /// Those whose free fit is no body that can exist: they are at the nearest that can.
    pub held_possible: Vec<String>,
}

/// Fits the model `spec` to all joints, takes it apart, and fits it again with what
/// can be said of joints; effects of the arm are in links and gravity, and stay.
///
/// # Errors
///
/// See [`ArmError`].
pub fn take_apart(
    dataset: &ArmDataset,
    spec: &ArmSpec,
    says: Says<'_>,
) -> Result<ArmParts, ArmError> {
    let whole = PreparedArm::new(dataset, spec)?;
    let mut parts = ArmParts {
        joints: (whole.joints.iter())
            .map(|joint| {
                let mut own = Parts::new(&joint.prepared, &joint.design, says);
                name_partner(&mut own.parameters, joint);
                (joint.name.clone(), own)
            })
            .collect(),
        body: Body::of(&whole),
        refitted: None,
    };
    let mut fewer = spec.clone();
    fewer.effects.retain(|term| {
        let name = term.effect.name();
        ArmEffect::ids().contains(&name) || says(name)
    });
    if fewer.effects.len() < spec.effects.len() {
        let fewer = PreparedArm::new(dataset, &fewer)?.on_rows_of(&whole);
        parts.refitted = Some(Body::of(&fewer));
        for ((_, own), joint) in parts.joints.iter_mut().zip(&fewer.joints) {
            own.refitted = Some(Refitted::new(&joint.prepared, &joint.design));
        }
    }
    Ok(parts)
}

impl Body {
    fn of(arm: &PreparedArm<'_>) -> Self {
        let body = arm.body();
        Self {
            links: (0..body.joints()).map(|at| body.link(at)).collect(),
            gravity: body.gravity,
            effects: of_arm(arm),
            held_possible: arm.held_possible(),
        }
    }
}
