//! The estimator of a planar or of a serial arm, and what either tells.

use ferntast_config::{Believed, serial::Serial};
use ferntast_control::estimator::{
    ContactEstimate, ContactEstimator, ContactState, EstimatorParameters, JointMeasurement,
    SpatialEstimate, SpatialEstimator, TorqueFromMotor,
};
use ferntast_model::{JointCount, Joints, ParameterError, contour::Surface, kinematics::LINKS};
use ferntast_msgs::{
    Time,
    sample::{Edge, TransformsSample},
};

/// The estimator of either kind of arm.
pub(super) enum Estimator {
    Planar {
        estimator: Box<ContactEstimator>,
        lengths: [f64; LINKS],
    },
    Serial {
        estimator: Box<SpatialEstimator>,
        arm: Box<Serial>,
    },
}

/// What is told of tip and contact, in space; see
/// [`ContactEstimate`] and [`SpatialEstimate`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Told {
    pub(super) position: Joints<f64>,
    pub(super) tip: [f64; 3],
    /// Quaternion x, y, z, w.
    pub(super) orientation: [f64; 4],
    pub(super) force: [f64; 3],
    /// About the tip.
    pub(super) torque: [f64; 3],
    pub(super) contact_force: [f64; 3],
    pub(super) state: ContactState,
    pub(super) edge: Edge,
    /// Of an arm in a plane.
    pub(super) planar: bool,
}

impl Estimator {
    pub(super) fn new(
        model: &Believed,
        parameters: &EstimatorParameters,
    ) -> Result<Estimator, ParameterError> {
        Ok(match model {
            Believed::Planar(model) => Estimator::Planar {
                estimator: Box::new(ContactEstimator::new(model, parameters)?),
                lengths: model.arm.link.map(|link| link.length),
            },
            Believed::Serial(serial) => Estimator::Serial {
                estimator: Box::new(SpatialEstimator::new(&serial.arm, parameters)?),
                arm: serial.clone(),
            },
        })
    }

    pub(super) fn joints(&self) -> JointCount {
        match self {
            Estimator::Planar { estimator, .. } => estimator.joints(),
            Estimator::Serial { estimator, .. } => estimator.joints(),
        }
    }

    pub(super) fn step(&mut self, dt: f64, measurement: &JointMeasurement) -> Told {
        match self {
            Estimator::Planar { estimator, .. } => estimator.step(dt, measurement).into(),
            Estimator::Serial { estimator, .. } => estimator.step(dt, measurement).into(),
        }
    }

    pub(super) fn step_by_motors(&mut self, dt: f64, torque: &TorqueFromMotor) -> Told {
        match self {
            Estimator::Planar { estimator, .. } => estimator.step_by_motors(dt, torque).into(),
            Estimator::Serial { estimator, .. } => estimator.step_by_motors(dt, torque).into(),
        }
    }

    /// The arm's frames where `told` has its joints.
    pub(super) fn transforms(&self, stamp: Time, told: &Told) -> TransformsSample {
        match self {
            Estimator::Planar { lengths, .. } => planar(stamp, &told.position, *lengths),
            Estimator::Serial { arm, .. } => {
                let frames = arm.frames(&told.position);
                frames.fold(
                    TransformsSample::empty(stamp),
                    |sample, (parent, child, place)| {
                        sample.with(parent, child, place.translation.into(), place.quaternion())
                    },
                )
            }
        }
    }
}

impl From<ContactEstimate> for Told {
    fn from(own: ContactEstimate) -> Told {
        let ([x, y], [fx, fy]) = (own.tip, own.force);
        let [tangential, normal] = own.contact_force;
        Told {
            position: own.position,
            tip: [x, y, 0.0],
            orientation: about_z(own.position.iter().sum()),
            force: [fx, fy, 0.0],
            torque: [0.0; 3],
            contact_force: [tangential, 0.0, normal],
            state: own.state,
            edge: match own.surface {
                None => Edge::NONE,
                Some(Surface::Lubricated) => Edge::LUBRICATED,
                Some(Surface::Unlubricated) => Edge::UNLUBRICATED,
                Some(Surface::Spring) => Edge::SPRING,
            },
            planar: true,
        }
    }
}

impl From<SpatialEstimate> for Told {
    fn from(own: SpatialEstimate) -> Told {
        let [force, torque] = own.wrench;
        Told {
            position: own.position,
            tip: own.tip,
            orientation: own.orientation,
            force,
            torque,
            contact_force: own.contact_force,
            state: own.state,
            edge: match own.surface {
                None => Edge::NONE,
                Some(_) => Edge::SURFACE,
            },
            planar: false,
        }
    }
}

/// A turn about z by `angle` \[rad\] as quaternion x, y, z, w.
fn about_z(angle: f64) -> [f64; 4] {
    [0.0, 0.0, (0.5 * angle).sin(), (0.5 * angle).cos()]
}

/// The planar arm's frames at the link-side joint positions \[rad\], for links of
/// those lengths \[m\].
fn planar(stamp: Time, position: &[f64], lengths: [f64; LINKS]) -> TransformsSample {
    // The tip does not turn against its link.
    let angle = |frame: usize| position.get(frame).copied().unwrap_or(0.0);
    TransformsSample::planar(
        stamp,
        [[0.0; 3], [lengths[0], 0.0, 0.0], [lengths[1], 0.0, 0.0]],
        std::array::from_fn(|frame| about_z(angle(frame))),
    )
}
