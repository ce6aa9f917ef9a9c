//! Shapes of things that a tip can touch: where they are and how large, as files have them, a
//! simulator gives way to them and a page draws them.

use serde::{Deserialize, Serialize};

use crate::{ParameterError, Section, check, rigid_body::Vector3};

/// Where things may be: ± \[m\].
const FARTHEST: f64 = 1e3;

/// The shape of a thing, in the base frame of the arm while the thing is at its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// All that is behind a plane: a table, a wall.
    Plane {
        /// A point of the plane \[m\].
        point: [f64; 3],
        /// Out of the wall; its length does not matter.
        normal: [f64; 3],
    },
    /// A box.
    Box {
        /// Its middle \[m\].
        center: [f64; 3],
        /// Lengths of its edges \[m\].
        size: [f64; 3],
        /// Its orientation \[rad\], as URDF has it.
        #[serde(default)]
        roll_pitch_yaw: [f64; 3],
    },
    /// A ball.
    Sphere {
        /// Its middle \[m\].
        center: [f64; 3],
        /// Its radius \[m\].
        radius: f64,
    },
    /// The head of a spring: a round plate that gives way along its normal only.
    Disc {
        /// The middle of the plate \[m\].
        center: [f64; 3],
        /// Out of the spring; its length does not matter.
        normal: [f64; 3],
        /// Radius of the plate \[m\].
        radius: f64,
        /// How far the spring can be pressed \[m\]; what is deeper is behind it and feels nothing.
        travel: f64,
    },
}

impl Section for Shape {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        let within = |error: ParameterError| error.within(key);
        self.validate().map_err(within)
    }
}

fn check_point(
    key: &str,
    point: &[f64; 3],
    lower: f64,
    unit: &'static str,
) -> Result<(), ParameterError> {
    let mut each = point.iter();
    each.try_for_each(|value| check(key, *value, lower, FARTHEST, unit))
}

fn check_direction(normal: &[f64; 3]) -> Result<(), ParameterError> {
    check_point("normal", normal, -FARTHEST, "-")?;
    if Vector3::from(*normal).norm() > 1e-9 {
        return Ok(());
    }
    Err(ParameterError::Inconsistent {
        key: "normal".into(),
        reason: "it has length 0; give a direction such as [0, 0, 1]".into(),
    })
}

impl Shape {
    /// Checks every number.
    ///
    /// # Errors
    ///
    /// The first one that is out of bounds, a normal without direction.
    pub fn validate(&self) -> Result<(), ParameterError> {
        match self {
            Shape::Plane { point, normal } => {
                check_point("point", point, -FARTHEST, "m")?;
                check_direction(normal)
            }
            Shape::Box {
                center,
                size,
                roll_pitch_yaw,
            } => {
                check_point("center", center, -FARTHEST, "m")?;
                check_point("size", size, 1e-4, "m")?;
                check_point("roll_pitch_yaw", roll_pitch_yaw, -FARTHEST, "rad")
            }
            Shape::Sphere { center, radius } => {
                check_point("center", center, -FARTHEST, "m")?;
                check("radius", *radius, 1e-4, FARTHEST, "m")
            }
            Shape::Disc {
                center,
                normal,
                radius,
                travel,
            } => {
                check_point("center", center, -FARTHEST, "m")?;
                check_direction(normal)?;
                check("radius", *radius, 1e-4, FARTHEST, "m")?;
                check("travel", *travel, 1e-4, FARTHEST, "m")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_shape_is_refused_by_its_key() {
        let plane = |normal| Shape::Plane {
            point: [0.0; 3],
            normal,
        };
        let told = |shape: Shape| {
            shape
                .validate_at("object[1].shape")
                .unwrap_err()
                .to_string()
        };
        assert!(told(plane([0.0; 3])).starts_with("object[1].shape.normal: it has length 0"));
        assert!(told(plane([f64::NAN, 0.0, 1.0])).contains("normal = NaN"));
        let ball = Shape::Sphere {
            center: [0.0; 3],
            radius: -1.0,
        };
        assert!(told(ball).contains("radius = -1 m"));
    }
}
