//! A thing that the tip can touch, and what it does to the tip.
//!
//! Along the normal a spring and a damper that never pull. In the tangent plane a
//! bristle: it bends elastically while the tip sticks, and slips when Coulomb's limit is
//! reached, so a tip can rest on the surface under load.

use ferntast_model::{ParameterError, parameters, rigid_body::Vector3, shape::Shape};

use super::surface::{Near, Surface};
use crate::arm::TrueSurface;

parameters! {
    /// A thing to touch.
    pub struct ObjectParameters {
        /// What it is called.
        pub name: String,
        /// Its shape and place.
        pub shape: Shape [section],
        /// Its surface. What days do to a surface does not happen here.
        pub surface: TrueSurface [section],
        /// How it moves; it stands still when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub motion: Option<Motion> [section],
    }
    check ObjectParameters::does_not_wear;
}

impl ObjectParameters {
    fn does_not_wear(&self) -> Result<(), ParameterError> {
        if self.surface.wear.is_none() {
            return Ok(());
        }
        Err(ParameterError::Inconsistent {
            key: "surface.wear".into(),
            reason: "things beside a serial arm do not wear; leave it out".into(),
        })
    }
}

parameters! {
    /// A thing goes to and fro: shift = amplitude · sin(2π · frequency · t + phase).
    #[derive(Copy)]
    pub struct Motion {
        /// Farthest shift from its place \[m\], base frame.
        pub amplitude: [f64; 3] [-10.0..=10.0, "m"],
        /// Times a second \[Hz\].
        pub frequency: f64 [0.0..=1e3, "Hz"],
        /// Phase at the start \[rad\].
        #[serde(default)]
        pub phase: f64 [-100.0..=100.0, "rad"],
    }
}

impl Motion {
    /// Shift \[m\] and its velocity \[m/s\] at `time` \[s\] after the start.
    fn at(&self, time: f64) -> (Vector3<f64>, Vector3<f64>) {
        let rate = std::f64::consts::TAU * self.frequency;
        let (sine, cosine) = (rate * time + self.phase).sin_cos();
        let amplitude = Vector3::from(self.amplitude);
        (amplitude * sine, amplitude * (rate * cosine))
    }
}

/// What a thing does to the tip at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::serial_arm) struct Touch {
    /// F_N ≥ 0 \[N\].
    pub normal_force: f64,
    /// Out of the surface, where the tip is.
    pub normal: Vector3<f64>,
    /// All of the force on the tip \[N\].
    pub force: Vector3<f64>,
    /// Velocity of the tip along the surface \[m/s\].
    pub sliding: Vector3<f64>,
}

/// A thing with what the tip does to it.
#[derive(Clone, Debug)]
pub(in crate::serial_arm) struct Object {
    surface: Surface,
    law: TrueSurface,
    motion: Option<Motion>,
    /// The tip came in from the free side and has not left since.
    touched: bool,
    /// The tip was free at the last step.
    was_free: bool,
    /// How far the bristle is bent \[m\].
    bend: Vector3<f64>,
    /// Where the thing is from its place \[m\], and how fast it moves \[m/s\].
    shift: Vector3<f64>,
    velocity: Vector3<f64>,
    pub touch: Touch,
}

impl Object {
    /// The thing at the start, the middle of the tip's ball of `radius` \[m\] at `tip` \[m\];
    /// whether the tip is within it.
    pub fn new(parameters: &ObjectParameters, tip: &Vector3<f64>, radius: f64) -> (Object, bool) {
        let mut object = Object {
            surface: Surface::from(&parameters.shape),
            law: parameters.surface,
            motion: parameters.motion,
            touched: false,
            was_free: true,
            bend: Vector3::zeros(),
            shift: Vector3::zeros(),
            velocity: Vector3::zeros(),
            touch: Touch::default(),
        };
        object.move_to(0.0);
        let near = object.near(tip, radius);
        let within = near.is_some_and(|near| near.distance <= 0.0);
        (object, within)
    }

    /// Largest stiffness of its surface \[N/m\].
    pub fn stiffness(&self) -> f64 {
        self.law.stiffness.max(self.law.tangential_stiffness)
    }

    fn move_to(&mut self, time: f64) {
        if let Some(motion) = &self.motion {
            (self.shift, self.velocity) = motion.at(time);
        }
    }

    fn near(&self, tip: &Vector3<f64>, radius: f64) -> Option<Near> {
        let near = self.surface.near(&(tip - self.shift))?;
        Some(Near {
            distance: near.distance - radius,
            ..near
        })
    }

    /// Elastic energy in surface and bristle \[J\] at `time` \[s\], the tip at `tip` \[m\].
    pub fn energy(&self, time: f64, tip: &Vector3<f64>, radius: f64) -> f64 {
        if !self.touched {
            return 0.0;
        }
        let mut there = self.clone();
        there.move_to(time);
        let near = there.near(tip, radius);
        let depth = near.map_or(0.0, |near| (-near.distance).max(0.0));
        0.5 * (self.law.stiffness * depth * depth
            + self.law.tangential_stiffness * self.bend.norm_squared())
    }

    /// Force on the tip's ball \[N\], base frame, after `dt` \[s\], at `time` \[s\] after the
    /// start: its middle is at `tip` \[m\], the point that touches moves at
    /// `velocity_at(lever)` \[m/s\], `lever` \[m\] from the middle.
    pub fn step(
        &mut self,
        time: f64,
        dt: f64,
        tip: &Vector3<f64>,
        radius: f64,
        velocity_at: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    ) -> Touch {
        self.move_to(time);
        let near = self.near(tip, radius);
        let Some(near) = near.filter(|near| near.distance <= 0.0) else {
            // Beside the head of a spring, where nothing faces the tip, it is not before it.
            self.was_free = near.is_some();
            self.release();
            return self.touch;
        };
        // A tip that came round the end is behind the thing and feels nothing.
        self.touched |= self.was_free;
        self.was_free = false;
        if !self.touched {
            return self.touch;
        }
        let (law, normal) = (&self.law, near.normal);
        let velocity = velocity_at(&(normal * -radius)) - self.velocity;
        let rate = normal.dot(&velocity);
        let normal_force = (-law.stiffness * near.distance - law.damping * rate).max(0.0);
        let limit = law.friction * normal_force;
        let sliding = velocity - normal * rate;
        // The bristle turns with the surface.
        let bend = self.bend - normal * normal.dot(&self.bend) + sliding * dt;
        self.bend = shortened(bend, limit / law.tangential_stiffness);
        let bristle = self.bend * law.tangential_stiffness + sliding * law.tangential_damping;
        self.touch = Touch {
            normal_force,
            normal,
            force: normal * normal_force - shortened(bristle, limit),
            sliding,
        };
        self.touch
    }

    fn release(&mut self) {
        self.touched = false;
        self.bend = Vector3::zeros();
        self.touch = Touch::default();
    }
}

/// `vector`, no longer than `longest`.
fn shortened(vector: Vector3<f64>, longest: f64) -> Vector3<f64> {
    let length = vector.norm();
    if length > longest {
        vector * (longest / length)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-4;

    fn table(motion: Option<Motion>) -> Object {
        let parameters = ObjectParameters {
            name: "table".into(),
            shape: Shape::Plane {
                point: [0.0; 3],
                normal: [0.0, 0.0, 1.0],
            },
            surface: TrueSurface {
                stiffness: 4e4,
                damping: 100.0,
                friction: 0.4,
                tangential_stiffness: 3e4,
                tangential_damping: 50.0,
                wear: None,
            },
            motion,
        };
        parameters.validate().unwrap();
        let (object, within) = Object::new(&parameters, &Vector3::new(0.0, 0.0, 0.1), 0.0);
        assert!(!within);
        object
    }

    fn free(object: &mut Object) {
        let tip = Vector3::new(0.0, 0.0, 0.1);
        assert_eq!(
            object.step(0.0, DT, &tip, 0.0, |_| Vector3::zeros()).force,
            Vector3::zeros()
        );
    }

    #[test]
    fn a_sliding_tip_feels_coulomb_friction_against_its_motion() {
        let mut table = table(None);
        free(&mut table);
        let velocity = Vector3::new(0.06, -0.08, 0.0);
        let mut touch = Touch::default();
        for _ in 0..1000 {
            touch = table.step(0.0, DT, &Vector3::new(0.0, 0.0, -1e-3), 0.0, |_| velocity);
        }
        let expected = Vector3::new(-9.6, 12.8, 40.0);
        assert!((touch.force - expected).norm() < 1e-9, "{}", touch.force);
        assert_eq!(touch.sliding, velocity);
    }

    #[test]
    fn a_resting_tip_bears_a_load_up_to_the_limit() {
        let mut table = table(None);
        free(&mut table);
        let tip = Vector3::new(0.0, 0.0, -1e-3);
        // Pressed in, then pushed 0.2 mm sideways: the bristle holds 6 N of the 16 N there may be.
        for _ in 0..20 {
            table.step(0.0, DT, &tip, 0.0, |_| Vector3::new(0.1, 0.0, 0.0));
        }
        let touch = table.step(0.0, DT, &tip, 0.0, |_| Vector3::zeros());
        assert!((touch.force - Vector3::new(-6.0, 0.0, 40.0)).norm() < 1e-9);
    }

    #[test]
    fn a_surface_does_not_pull_and_a_ball_touches_with_its_lowest_point() {
        let mut table = table(None);
        free(&mut table);
        let away = |_: &Vector3<f64>| Vector3::new(0.3, 0.0, 1.0);
        let touch = table.step(0.0, DT, &Vector3::new(0.0, 0.0, -1e-4), 0.0, away);
        assert_eq!(touch.force, Vector3::zeros());
        // A ball of 1 cm, 0.5 mm deep, that rolls: its lowest point rests.
        let rolls = |lever: &Vector3<f64>| {
            Vector3::new(0.2, 0.0, 0.0) + Vector3::new(0.0, 20.0, 0.0).cross(lever)
        };
        let touch = table.step(0.0, DT, &Vector3::new(0.0, 0.0, 9.5e-3), 0.01, rolls);
        assert!((touch.force - Vector3::new(0.0, 0.0, 20.0)).norm() < 1e-9);
    }

    #[test]
    fn what_moves_carries_its_surface_along() {
        let motion = Motion {
            amplitude: [0.0, 0.0, 0.02],
            frequency: 0.5,
            phase: 0.0,
        };
        let mut table = table(Some(motion));
        free(&mut table);
        // At 0.5 s it is 20 mm up and at rest, at 0 s it comes with 62.8 mm/s.
        let tip = Vector3::new(0.0, 0.0, 0.019);
        let at =
            |table: &mut Object, time, tip| table.step(time, DT, tip, 0.0, |_| Vector3::zeros());
        assert!((at(&mut table, 0.5, &tip).normal_force - 40.0).abs() < 1e-9);
        let comes = at(&mut table, 0.0, &Vector3::new(0.0, 0.0, -1e-9)).normal_force;
        assert!(
            (comes - 100.0 * 0.02 * std::f64::consts::PI).abs() < 1e-3,
            "{comes}"
        );
    }
}
