//! Which surface is touched, and what the force is along and across it.

use super::systematic::{SensorErrors, split_errors};
use super::touch::{REACH, Slide, Touch, threshold};
use super::zeroing::CLEARANCE;
use super::{CoefficientEstimator, ContactEstimate, EstimatorParameters, SelfCalibration};
use ferntast_model::Vector2;
use ferntast_model::contour::{Feature, Surface, nearest};

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
    touch: Touch,
    slide: Slide,
    /// Direction of the last motion along the tangent: ±1.
    direction: f64,
}

impl Split {
    pub(super) fn new(features: Vec<Feature>) -> Self {
        Self {
            features,
            coefficients: Default::default(),
            touch: Touch::default(),
            slide: Slide::default(),
            direction: 1.0,
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
        let threshold = threshold(parameters, last.state.in_contact);
        let near = |pressed: bool| {
            let counts = |index, feature: &Feature| {
                !pressed || force.dot(&motion.turned(index, feature).normal) > threshold
            };
            nearest(&self.features, tip, REACH, counts)
                .filter(|near| near.distance <= parameters.contact_distance)
        };
        // Behind the corner of a block the deepest front is the one that the tip did not come through.
        let touched = near(true).and_then(|near| {
            let feature = self.features.get(near.index)?;
            Some((near.index, motion.turned(near.index, feature)))
        });
        let known = match touched {
            Some(_) => Some(true),
            None => near(false).map(|_| false),
        };
        let size = force.norm();
        estimate.state.touches =
            (self.touch).step(parameters.contact_on, dt, size, known, last.state.touches);
        let Some((index, feature)) = touched else {
            self.slide.end();
            return;
        };
        let sliding = motion.velocity.dot(&feature.tangent());
        let (normal, tangential) = (force.dot(&feature.normal), force.dot(&feature.tangent()));
        let turned = sliding * self.direction < 0.0;
        if sliding.abs() < parameters.rest_speed || turned || last.feature != Some(index) {
            self.slide.end();
        } else {
            self.slide.go_on(sliding.abs(), dt);
        }
        if sliding.abs() >= parameters.rest_speed {
            self.direction = sliding.signum();
        }
        let present = motion.present_velocity.dot(&feature.tangent());
        let stopping = present * self.direction < parameters.rest_speed;
        estimate.state.in_contact = true;
        estimate.surface = Some(feature.surface);
        estimate.feature = Some(index);
        estimate.contact_force = [tangential, normal];
        estimate.state.normal_force = normal;
        estimate.state.tangential_force = -tangential * self.direction;
        estimate.state.corner = self.features.iter().enumerate().any(|(other, f)| {
            other != index && f.faces(tip) && (-REACH..=0.0).contains(&f.distance(tip))
        });
        // Two normals, two tangents: the split is no more defined than at rest.
        let turned_lately = self.slide.turned_lately(parameters, motion.delay);
        estimate.state.near_rest =
            stopping || turned_lately || estimate.state.corner || motion.undetermined;
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
        if estimate.state.valid && !estimate.state.near_rest {
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
                estimate.state.normal_force,
                estimate.state.tangential_force,
                &errors,
                dt,
                parameters.friction_memory,
                parameters.cut_off,
            );
        }
        estimate.state.friction = coefficient.coefficient();
    }
}
