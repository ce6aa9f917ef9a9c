//! Which surface is touched, and what the force is along and across it.

use super::systematic::{SensorErrors, split_errors};
use super::zeroing::CLEARANCE;
use super::{CoefficientEstimator, ContactEstimate, EstimatorParameters, SelfCalibration};
use ferntast_model::Vector2;
use ferntast_model::contour::{Feature, Surface, nearest};

/// How far behind the front of a feature the tip is still taken to push it \[m\].
const REACH: f64 = 0.1;

/// Where no surface is known, a force of so many times that of a contact is one [-],
const UNKNOWN_SURFACE: f64 = 3.0;
/// when it lasts so long [s]: of an arm that is jerked the estimate is off for as long as its
/// filters take.
const UNKNOWN_TIME: f64 = 0.05;
/// A contact there ends when less than a contact's force lasts so long [s]: what the tip goes
/// along with may push less for a while.
const FAINT_TIME: f64 = 0.2;

/// How many times the filter's delay a turn of the tip is seen in the forces.
const TURN_DELAYS: f64 = 5.0;

/// How the tip moves, base frame.
pub(super) struct Motion<'a> {
    /// Newest position \[m\].
    pub(super) tip: Vector2<f64>,
    /// Filtered velocity \[m/s\], as late as the forces.
    pub(super) velocity: Vector2<f64>,
    /// Velocity \[m/s\] predicted over the filter's delay.
    pub(super) present_velocity: Vector2<f64>,
    /// How late forces and filtered velocity are \[s\].
    pub(super) delay: f64,
    /// What the torque sensors may have wrong of the force \[N\].
    pub(super) errors: &'a dyn Fn() -> SensorErrors<Vector2<f64>>,
    /// What is known of how edges are turned.
    pub(super) calibration: Option<&'a SelfCalibration>,
    /// A joint's friction, and so the force, is not determined.
    pub(super) undetermined: bool,
}

impl Motion<'_> {
    /// Feature number `index`, turned as far as is known.
    fn turned(&self, index: usize, feature: &Feature) -> Feature {
        match self.calibration {
            Some(own) => feature.turned(own.turn_in_use(index)),
            None => *feature,
        }
    }
}

/// Splits forces, and remembers how the tip slid.
#[derive(Clone, Debug)]
pub(super) struct Split {
    features: Vec<Feature>,
    /// One a surface: lubricated, unlubricated.
    coefficients: [CoefficientEstimator; 2],
    /// Way slid since the last turn or rest \[m\].
    travel: f64,
    /// Time since then \[s\].
    sliding_for: f64,
    /// Direction of the last motion along the tangent: ±1.
    direction: f64,
    /// For how long something that is not in the contour has pushed \[s\].
    unknown_for: f64,
    /// For how long that has pushed less than a contact does [s].
    faint_for: f64,
}

impl Split {
    pub(super) fn new(features: Vec<Feature>) -> Self {
        Self {
            features,
            coefficients: Default::default(),
            travel: 0.0,
            sliding_for: 0.0,
            direction: 1.0,
            unknown_for: 0.0,
            faint_for: 0.0,
        }
    }

    /// What can be touched.
    pub(super) fn features(&self) -> &[Feature] {
        &self.features
    }

    /// Whether `tip` \[m\] is surely free: in front of, or beside, all that it can touch.
    pub(super) fn is_free(&self, parameters: &EstimatorParameters, tip: &Vector2<f64>) -> bool {
        let clearance = CLEARANCE * parameters.contact_distance;
        self.features.iter().all(|feature| {
            feature.distance(tip) > clearance
                || feature.along(tip).abs() > feature.half_length + clearance
        })
    }

    /// Direction of the last motion along the tangent: ±1.
    pub(super) fn direction(&self) -> f64 {
        self.direction
    }

    /// Finds the surface touched, and splits the force along it.
    pub(super) fn step(
        &mut self,
        parameters: &EstimatorParameters,
        last: &ContactEstimate,
        dt: f64,
        motion: &Motion<'_>,
        force: &Vector2<f64>,
        estimate: &mut ContactEstimate,
    ) {
        let tip = &motion.tip;
        let near = nearest(&self.features, tip, REACH)
            .filter(|near| near.distance <= parameters.contact_distance);
        let threshold = if last.in_contact {
            parameters.contact_off
        } else {
            parameters.contact_on
        };
        let touched = near.and_then(|near| {
            let feature = motion.turned(near.index, self.features.get(near.index)?);
            (force.dot(&feature.normal) > threshold).then_some((near.index, feature))
        });
        let unknown = near.is_none() && force.norm() > UNKNOWN_SURFACE * parameters.contact_on;
        self.unknown_for = if unknown { self.unknown_for + dt } else { 0.0 };
        let faint = force.norm() <= parameters.contact_on;
        self.faint_for = if faint { self.faint_for + dt } else { 0.0 };
        estimate.touches = match near {
            Some(_) => touched.is_some(),
            None if last.touches => self.faint_for < FAINT_TIME,
            None => self.unknown_for >= UNKNOWN_TIME,
        };
        let Some((index, feature)) = touched else {
            self.travel = 0.0;
            self.sliding_for = 0.0;
            return;
        };
        let sliding = motion.velocity.dot(&feature.tangent());
        let (normal, tangential) = (force.dot(&feature.normal), force.dot(&feature.tangent()));
        let turned = sliding * self.direction < 0.0;
        if sliding.abs() < parameters.rest_speed || turned || last.feature != Some(index) {
            self.travel = 0.0;
            self.sliding_for = 0.0;
        } else {
            self.travel += sliding.abs() * dt;
            self.sliding_for += dt;
        }
        if sliding.abs() >= parameters.rest_speed {
            self.direction = sliding.signum();
        }
        let present = motion.present_velocity.dot(&feature.tangent());
        let stopping = present * self.direction < parameters.rest_speed;
        estimate.in_contact = true;
        estimate.surface = Some(feature.surface);
        estimate.feature = Some(index);
        estimate.contact_force = [tangential, normal];
        estimate.normal_force = normal;
        estimate.tangential_force = -tangential * self.direction;
        estimate.corner = self.features.iter().enumerate().any(|(other, f)| {
            other != index && f.faces(tip) && (-REACH..=0.0).contains(&f.distance(tip))
        });
        // Two normals, two tangents: the split is no more defined than at rest.
        // At a turn first arm and surface wind up the other way, then the filters follow.
        let turned_lately =
            self.travel <= parameters.rest_travel || self.sliding_for <= TURN_DELAYS * motion.delay;
        estimate.near_rest = stopping || turned_lately || estimate.corner || motion.undetermined;
        self.identify(parameters, dt, &feature, motion, estimate);
    }

    /// Equation (6), where the tip slides.
    fn identify(
        &mut self,
        parameters: &EstimatorParameters,
        dt: f64,
        feature: &Feature,
        motion: &Motion<'_>,
        estimate: &mut ContactEstimate,
    ) {
        let slot = match feature.surface {
            Surface::Lubricated => 0,
            Surface::Unlubricated => 1,
            // The head of a spring gives way: equation (6) is not about it.
            Surface::Spring => return,
        };
        let coefficient = &mut self.coefficients[slot];
        if estimate.valid && !estimate.near_rest {
            let index = estimate.feature.unwrap_or(usize::MAX);
            let turn = motion.calibration.and_then(|own| own.turn(index));
            let errors = split_errors(
                &(motion.errors)(),
                &feature.normal,
                &feature.tangent(),
                estimate.contact_force,
                self.direction,
                turn.map_or(parameters.uncertainty.contour_turn, |turn| turn.error),
            );
            coefficient.step(
                estimate.normal_force,
                estimate.tangential_force,
                &errors,
                dt,
                parameters.friction_memory,
                parameters.cut_off,
            );
        }
        estimate.friction = coefficient.coefficient();
    }
}
