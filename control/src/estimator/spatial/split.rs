//! Which surface is touched, and what the force is along and across it.

use super::super::systematic::SensorErrors;
use super::super::touch::{REACH, Slide, Touch, threshold};
use super::super::zeroing::CLEARANCE;
use super::super::{CoefficientEstimator, EstimatorParameters};
use super::SpatialEstimate;
use ferntast_model::serial_arm::Plane;
use nalgebra::Vector3;

/// How the tip moves, base frame.
pub(super) struct Motion<'a> {
    /// Newest position \[m\].
    pub(super) tip: Vector3<f64>,
    /// Filtered velocity \[m/s\], as late as the forces.
    pub(super) velocity: Vector3<f64>,
    /// Velocity \[m/s\] predicted over the filter's delay.
    pub(super) present_velocity: Vector3<f64>,
    /// How late forces and filtered velocity are \[s\].
    pub(super) delay: f64,
    /// What the torque sensors may have wrong of the force \[N\].
    pub(super) errors: &'a dyn Fn() -> SensorErrors<Vector3<f64>>,
    /// A joint's friction, and so the force, is not determined.
    pub(super) undetermined: bool,
}

/// A plane with what was found of its friction.
#[derive(Clone, Debug)]
struct Surface {
    point: Vector3<f64>,
    normal: Vector3<f64>,
    coefficient: CoefficientEstimator,
}

impl Surface {
    fn distance(&self, tip: &Vector3<f64>) -> f64 {
        self.normal.dot(&(tip - self.point))
    }
}

/// Splits forces, and remembers how the tip slid.
#[derive(Clone, Debug)]
pub(super) struct Split {
    surfaces: Vec<Surface>,
    touch: Touch,
    slide: Slide,
    /// Direction of the last motion along the surface, of length 1 or, before any, 0.
    direction: Vector3<f64>,
}

impl Split {
    pub(super) fn new(surfaces: &[Plane]) -> Self {
        let surface = |own: &Plane| Surface {
            point: own.point.into(),
            normal: own.direction(),
            coefficient: CoefficientEstimator::default(),
        };
        Self {
            surfaces: surfaces.iter().map(surface).collect(),
            touch: Touch::default(),
            slide: Slide::default(),
            direction: Vector3::zeros(),
        }
    }

    /// Whether `tip` \[m\] is surely free: in front of all that it can touch.
    pub(super) fn is_free(&self, parameters: &EstimatorParameters, tip: &Vector3<f64>) -> bool {
        let clearance = CLEARANCE * parameters.contact_distance;
        self.surfaces
            .iter()
            .all(|own| own.distance(tip) > clearance)
    }

    /// Finds the surface touched, and splits the force along it.
    pub(super) fn step(
        &mut self,
        parameters: &EstimatorParameters,
        last: &SpatialEstimate,
        dt: f64,
        motion: &Motion<'_>,
        force: &Vector3<f64>,
        estimate: &mut SpatialEstimate,
    ) {
        let threshold = threshold(parameters, last.state.in_contact);
        let is_near = |own: &Surface| {
            let distance = own.distance(&motion.tip);
            (-REACH..=parameters.contact_distance).contains(&distance)
        };
        let pressed = |own: &Surface| force.dot(&own.normal);
        let near = self.surfaces.iter().enumerate();
        let near = near.filter(|(_, own)| is_near(own));
        let near = near.max_by(|(_, a), (_, b)| pressed(a).total_cmp(&pressed(b)));
        let near = near.map(|(index, own)| (index, own.normal));
        let touched = near.filter(|(_, normal)| force.dot(normal) > threshold);

        let known = near.map(|_| touched.is_some());
        let size = force.norm();
        estimate.state.touches =
            (self.touch).step(parameters.contact_on, dt, size, known, last.state.touches);
        if !estimate.state.touches {
            self.slide.end();
            return;
        }
        let surface = touched.map(|(index, _)| index);
        let normal = match touched {
            Some((_, normal)) => normal,
            None => across(force, &motion.velocity, parameters.rest_speed),
        };
        self.follow(parameters, dt, &normal, surface != last.surface, motion);
        let corner = surface.is_some_and(|surface| {
            let others = self.surfaces.iter().enumerate();
            let mut others = others.filter(|(index, _)| *index != surface);
            others.any(|(_, own)| (-REACH..=0.0).contains(&own.distance(&motion.tip)))
        });
        let present = motion.present_velocity.dot(&self.direction);
        let turned_lately = self.slide.turned_lately(parameters, motion.delay);
        let along = tangent(&normal);
        estimate.state.in_contact = true;
        estimate.surface = surface;
        estimate.state.corner = corner;
        estimate.contact_force = [
            force.dot(&along),
            force.dot(&normal.cross(&along)),
            force.dot(&normal),
        ];
        estimate.state.normal_force = force.dot(&normal).max(0.0);
        estimate.state.tangential_force = -force.dot(&self.direction);
        estimate.state.near_rest =
            present < parameters.rest_speed || turned_lately || corner || motion.undetermined;
        if let Some(surface) = surface {
            self.identify(parameters, dt, surface, motion.errors, estimate);
        }
    }

    /// Follows how the tip slides on what has this normal; on another surface it begins anew.
    fn follow(
        &mut self,
        parameters: &EstimatorParameters,
        dt: f64,
        normal: &Vector3<f64>,
        other: bool,
        motion: &Motion<'_>,
    ) {
        let sliding = motion.velocity - normal * normal.dot(&motion.velocity);
        let speed = sliding.norm();
        let rests = speed < parameters.rest_speed;
        if rests || other || sliding.dot(&self.direction) < 0.0 {
            self.slide.end();
        } else {
            self.slide.go_on(speed, dt);
        }
        if !rests {
            self.direction = sliding / speed;
        }
    }

    /// Equation (6), where the tip slides.
    fn identify(
        &mut self,
        parameters: &EstimatorParameters,
        dt: f64,
        surface: usize,
        sensors: &dyn Fn() -> SensorErrors<Vector3<f64>>,
        estimate: &mut SpatialEstimate,
    ) {
        let direction = self.direction;
        let Some(own) = self.surfaces.get_mut(surface) else {
            return;
        };
        if estimate.state.valid && !estimate.state.near_rest {
            let normal = own.normal;
            let (n, t) = (estimate.state.normal_force, estimate.state.tangential_force);
            // A plane turned by δ about the axis across the motion: see the planar split.
            let turn = parameters.uncertainty.contour_turn;
            let of = |error: &Vector3<f64>| [error.dot(&normal), -error.dot(&direction)];
            let errors = sensors().split(of, [turn * t, -turn * n]);
            let (memory, cut_off) = (parameters.friction_memory, parameters.cut_off);
            own.coefficient.step(n, t, &errors, dt, memory, cut_off);
        }
        estimate.state.friction = own.coefficient.coefficient();
    }
}

/// The normal of a surface that nobody knows: the direction of the force, of which what goes
/// along the tip's motion is friction.
fn across(force: &Vector3<f64>, velocity: &Vector3<f64>, rest_speed: f64) -> Vector3<f64> {
    let speed = velocity.norm();
    let along = match speed > rest_speed {
        true => velocity * (force.dot(velocity) / (speed * speed)),
        false => Vector3::zeros(),
    };
    let normal = (force - along).try_normalize(1e-9);
    normal
        .or_else(|| force.try_normalize(1e-9))
        .unwrap_or_else(Vector3::z)
}

/// A direction along a surface: that of x, or, where the normal is near it, of y.
fn tangent(normal: &Vector3<f64>) -> Vector3<f64> {
    let axis = match normal.x.abs() < 0.9 {
        true => Vector3::x(),
        false => Vector3::y(),
    };
    (axis - normal * normal.dot(&axis)).normalize()
}
