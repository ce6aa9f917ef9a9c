//! How far a point is from a thing.

use ferntast_model::{
    rigid_body::{Placement, Vector3},
    shape::Shape,
};

/// How a point is to a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Distance to the surface \[m\], negative within.
    pub distance: f64,
    /// Unit vector out of the surface.
    pub normal: Vector3<f64>,
}

/// A shape with what need not be computed in every step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Surface {
    Plane {
        point: Vector3<f64>,
        normal: Vector3<f64>,
    },
    Box {
        place: Placement,
        half: Vector3<f64>,
    },
    Sphere {
        center: Vector3<f64>,
        radius: f64,
    },
    Disc {
        center: Vector3<f64>,
        normal: Vector3<f64>,
        radius: f64,
        travel: f64,
    },
}

impl From<&Shape> for Surface {
    fn from(shape: &Shape) -> Surface {
        let direction = |normal: [f64; 3]| Vector3::from(normal).normalize();
        match *shape {
            Shape::Plane { point, normal } => Surface::Plane {
                point: point.into(),
                normal: direction(normal),
            },
            Shape::Box {
                center,
                size,
                roll_pitch_yaw,
            } => Surface::Box {
                place: Placement::from_roll_pitch_yaw(center.into(), roll_pitch_yaw),
                half: Vector3::from(size) * 0.5,
            },
            Shape::Sphere { center, radius } => Surface::Sphere {
                center: center.into(),
                radius,
            },
            Shape::Disc {
                center,
                normal,
                radius,
                travel,
            } => Surface::Disc {
                center: center.into(),
                normal: direction(normal),
                radius,
                travel,
            },
        }
    }
}

impl Surface {
    /// How `point` \[m\] is to the shape; `None` where nothing of it faces the point.
    pub(super) fn near(&self, point: &Vector3<f64>) -> Option<Near> {
        match self {
            Surface::Plane { point: on, normal } => Some(Near {
                distance: normal.dot(&(point - on)),
                normal: *normal,
            }),
            Surface::Box { place, half } => Some(near_box(place, half, point)),
            Surface::Sphere { center, radius } => {
                let away = point - center;
                let length = away.norm();
                let normal = if length > 1e-12 {
                    away / length
                } else {
                    Vector3::z()
                };
                let distance = length - radius;
                Some(Near { distance, normal })
            }
            Surface::Disc {
                center,
                normal,
                radius,
                travel,
            } => {
                let away = point - center;
                let distance = normal.dot(&away);
                let beside = (away - normal * distance).norm_squared();
                let faces = beside <= radius * radius && distance >= -travel;
                faces.then_some(Near {
                    distance,
                    normal: *normal,
                })
            }
        }
    }
}

/// Outside a box its nearest point counts; within it the nearest face.
fn near_box(place: &Placement, half: &Vector3<f64>, point: &Vector3<f64>) -> Near {
    let local = place.rotation.tr_mul(&(point - place.translation));
    let beyond = local.abs() - half;
    let outside = local.zip_map(&beyond, |at, beyond| beyond.max(0.0).copysign(at));
    let distance = outside.norm();
    if distance > 0.0 {
        return Near {
            distance,
            normal: place.rotation * (outside / distance),
        };
    }
    let face = beyond.imax();
    let mut normal = Vector3::zeros();
    normal[face] = 1.0_f64.copysign(local[face]);
    Near {
        distance: beyond[face],
        normal: place.rotation * normal,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn any_shape() -> impl Strategy<Value = Shape> {
        let three = proptest::array::uniform3(-1.0..1.0f64);
        let direction = three
            .clone()
            .prop_filter("a direction", |normal| Vector3::from(*normal).norm() > 0.1);
        prop_oneof![
            (three.clone(), direction).prop_map(|(point, normal)| Shape::Plane { point, normal }),
            (
                three.clone(),
                proptest::array::uniform3(0.1..1.0f64),
                three.clone()
            )
                .prop_map(|(center, size, roll_pitch_yaw)| Shape::Box {
                    center,
                    size,
                    roll_pitch_yaw
                }),
            (three, 0.1..1.0f64).prop_map(|(center, radius)| Shape::Sphere { center, radius }),
        ]
    }

    proptest! {
        /// The normal is the gradient of the distance, so that a force along it that
        /// depends on the distance keeps energy.
        #[test]
        fn the_surface_is_the_distance_away_along_the_normal(
            shape in any_shape(), at in proptest::array::uniform3(-2.0..2.0f64),
        ) {
            prop_assert!(shape.validate().is_ok());
            let surface = Surface::from(&shape);
            let at = Vector3::from(at);
            let near = surface.near(&at).unwrap();
            prop_assert!((near.normal.norm() - 1.0).abs() < 1e-12);
            let on = surface.near(&(at - near.normal * near.distance)).unwrap();
            prop_assert!(on.distance.abs() < 1e-12, "{shape:?}: {near:?} {on:?}");
            let farther = surface.near(&(at + near.normal * 1e-6)).unwrap();
            prop_assert!((farther.distance - near.distance - 1e-6).abs() < 1e-12);
        }
    }

    #[test]
    fn a_corner_pushes_outwards_and_a_face_along_itself() {
        let surface = Surface::from(&Shape::Box {
            center: [1.0, 0.0, 0.0],
            size: [2.0, 2.0, 2.0],
            roll_pitch_yaw: [0.0; 3],
        });
        let corner = surface.near(&Vector3::new(2.3, 1.0, 1.4)).unwrap();
        assert!((corner.distance - 0.5).abs() < 1e-12);
        assert!((corner.normal - Vector3::new(0.6, 0.0, 0.8)).norm() < 1e-12);
        let within = surface.near(&Vector3::new(1.5, -0.9, 0.2)).unwrap();
        assert!((within.distance + 0.1).abs() < 1e-12);
        assert_eq!(within.normal, -Vector3::y());
    }

    #[test]
    fn beside_and_behind_the_head_of_a_spring_there_is_nothing() {
        let surface = Surface::from(&Shape::Disc {
            center: [0.0; 3],
            normal: [0.0, 0.0, 2.0],
            radius: 0.1,
            travel: 0.05,
        });
        let at = |x, z| surface.near(&Vector3::new(x, 0.0, z));
        assert!((at(0.09, -0.04).unwrap().distance + 0.04).abs() < 1e-12);
        assert_eq!(at(0.11, -0.04), None);
        assert_eq!(at(0.0, -0.06), None);
    }
}
