//! The mechanical contour that the stylus tip touches: straight edges and springs.
//!
//! Both are *features* with the same geometry: a straight front of finite
//! length and a normal ∇Φ out of it. The signed distance Φ(r) is positive
//! outside and negative inside.

use crate::contact::ContactParameters;
use crate::{ParameterError, Vector2, check, parameters};
use serde::{Deserialize, Serialize};

/// What an edge is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Surface {
    /// Dry-film lubricant.
    Lubricated,
    /// Bare aluminium.
    Unlubricated,
    /// The head of a spring.
    Spring,
}

parameters! {
    /// A straight edge. Seen from `from` towards `to`, the free side is on the left.
    #[derive(Copy)]
    pub struct EdgeParameters {
        /// What it is made of.
        pub surface: Surface,
        /// One end, base frame \[m\].
        pub from: [f64; 2] [-10.0..=10.0, "m"],
        /// The other end, base frame \[m\].
        pub to: [f64; 2] [-10.0..=10.0, "m"],
        /// How it pushes and rubs.
        pub contact: ContactParameters [section],
    }
    check EdgeParameters::has_length;
}

parameters! {
    /// A spring with a flat head: pushed in, it pushes back along `direction`.
    #[derive(Copy)]
    pub struct SpringParameters {
        /// Where its foot is fixed, base frame \[m\].
        pub anchor: [f64; 2] [-10.0..=10.0, "m"],
        /// From the foot to the head; any length but zero \[-\].
        pub direction: [f64; 2],
        /// From the foot to the head at rest \[m\].
        pub rest_length: f64 [1e-3..=10.0, "m"],
        /// Stiffness \[N/m\].
        pub stiffness: f64 [1.0..=1e6, "N/m"],
        /// Half of the head's width \[m\].
        pub half_width: f64 [1e-4..=10.0, "m"],
    }
    check SpringParameters::has_direction;
}

parameters! {
    /// Edges, springs, and the nominal point in the free space between them.
    pub struct Contour {
        /// Tip point in the middle of the workspace, base frame \[m\].
        pub nominal_tip: [f64; 2] [-10.0..=10.0, "m"],
        /// Side that the elbow is bent to there.
        pub nominal_elbow: crate::kinematics::Elbow,
        /// Straight edges.
        #[serde(default)]
        pub edge: Vec<EdgeParameters> [section],
        /// Springs.
        #[serde(default)]
        pub spring: Vec<SpringParameters> [section],
    }
    check Contour::nominal_tip_is_free;
}

/// One straight front of the contour, ready for use in a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// What it is.
    pub surface: Surface,
    /// Stiffness, damping, friction.
    pub contact: ContactParameters,
    /// Middle of the front, base frame \[m\].
    pub center: Vector2<f64>,
    /// Half of the front's length \[m\].
    pub half_length: f64,
    /// ∇Φ: unit normal out of the surface.
    pub normal: Vector2<f64>,
}

impl Feature {
    /// Unit tangent: the normal turned by −90° about z; x of the contact frame.
    #[inline]
    pub fn tangent(&self) -> Vector2<f64> {
        Vector2::new(self.normal.y, -self.normal.x)
    }

    /// The same front, turned by `angle` \[rad\] about its middle.
    pub fn turned(&self, angle: f64) -> Feature {
        let (sine, cosine) = angle.sin_cos();
        let normal = self.normal;
        Feature {
            normal: Vector2::new(
                cosine * normal.x - sine * normal.y,
                sine * normal.x + cosine * normal.y,
            ),
            ..*self
        }
    }

    /// Φ(r) \[m\]: distance of `tip` from the front's line, negative inside.
    #[inline]
    pub fn distance(&self, tip: &Vector2<f64>) -> f64 {
        (tip - self.center).dot(&self.normal)
    }

    /// Where `tip` is along the front \[m\], from its middle, along the tangent.
    #[inline]
    pub fn along(&self, tip: &Vector2<f64>) -> f64 {
        (tip - self.center).dot(&self.tangent())
    }

    /// Whether `tip` is in front of (or behind) the front, not beside it.
    #[inline]
    pub fn faces(&self, tip: &Vector2<f64>) -> bool {
        self.along(tip).abs() <= self.half_length
    }
}

/// The feature nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Its index in the slice searched.
    pub index: usize,
    /// Φ \[m\], negative inside.
    pub distance: f64,
    /// Penetration \[m\], zero outside.
    pub penetration: f64,
}

/// The feature that `tip` faces and that pushes it hardest, going by
/// stiffness and penetration; outside of all, the one that is nearest.
/// Fronts that lie more than `reach` \[m\] ahead of the tip are left out, and those that do not
/// `count`, by their index; `None` when it faces none.
pub fn nearest(
    features: &[Feature],
    tip: &Vector2<f64>,
    reach: f64,
    count: impl Fn(usize, &Feature) -> bool,
) -> Option<Nearest> {
    let mut best: Option<(f64, Nearest)> = None;
    for (index, feature) in features.iter().enumerate() {
        let distance = feature.distance(tip);
        if !feature.faces(tip) || distance < -reach || !count(index, feature) {
            continue;
        }
        let penetration = (-distance).max(0.0);
        // Pushing outranks any distance: the sign tells them apart.
        let rank = if penetration > 0.0 {
            -feature.contact.stiffness * penetration
        } else {
            distance
        };
        if best.is_none_or(|(least, _)| rank < least) {
            let found = Nearest {
                index,
                distance,
                penetration,
            };
            best = Some((rank, found));
        }
    }
    best.map(|(_, nearest)| nearest)
}

impl EdgeParameters {
    fn has_length(&self) -> Result<(), ParameterError> {
        let length = (Vector2::from(self.to) - Vector2::from(self.from)).norm();
        check("length from `from` to `to`", length, 1e-4, 20.0, "m")
    }

    /// The edge as a feature.
    pub fn feature(&self) -> Feature {
        let (from, to) = (Vector2::from(self.from), Vector2::from(self.to));
        let along = (to - from).normalize();
        Feature {
            surface: self.surface,
            contact: self.contact,
            center: (from + to) * 0.5,
            half_length: (to - from).norm() * 0.5,
            normal: Vector2::new(-along.y, along.x),
        }
    }
}

impl SpringParameters {
    fn has_direction(&self) -> Result<(), ParameterError> {
        let [x, y] = self.direction;
        check("length of direction", x.hypot(y), 1e-6, 1e6, "-")
    }

    /// The spring as a feature: its head.
    pub fn feature(&self) -> Feature {
        let normal = Vector2::from(self.direction).normalize();
        Feature {
            surface: Surface::Spring,
            contact: ContactParameters {
                stiffness: self.stiffness,
                damping: 0.0,
                friction: 0.0,
            },
            center: Vector2::from(self.anchor) + normal * self.rest_length,
            half_length: self.half_width,
            normal,
        }
    }
}

impl Contour {
    fn nominal_tip_is_free(&self) -> Result<(), ParameterError> {
        let tip = Vector2::from(self.nominal_tip);
        for feature in self.features() {
            if feature.faces(&tip) && feature.distance(&tip) <= 0.0 {
                return Err(ParameterError::Inconsistent {
                    key: "nominal_tip".into(),
                    reason: format!(
                        "({}, {}) m lies {:.4} m behind the {:?} surface; move it to the free side, \
                         or swap the ends of the edge",
                        tip.x,
                        tip.y,
                        -feature.distance(&tip),
                        feature.surface
                    ),
                });
            }
        }
        Ok(())
    }

    /// All edges, then all springs.
    pub fn features(&self) -> Vec<Feature> {
        let edges = self.edge.iter().map(EdgeParameters::feature);
        let springs = self.spring.iter().map(SpringParameters::feature);
        edges.chain(springs).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(from: [f64; 2], to: [f64; 2]) -> EdgeParameters {
        EdgeParameters {
            surface: Surface::Lubricated,
            from,
            to,
            contact: ContactParameters {
                stiffness: 2e4,
                damping: 50.0,
                friction: 0.2,
            },
        }
    }

    #[test]
    fn the_free_side_is_left_of_the_edge() {
        let floor = edge([0.0, 0.0], [1.0, 0.0]).feature();
        assert_eq!(floor.normal, Vector2::new(0.0, 1.0));
        assert_eq!(floor.tangent(), Vector2::new(1.0, 0.0));
        assert_eq!(floor.distance(&Vector2::new(0.3, 0.02)), 0.02);
        assert!(floor.faces(&Vector2::new(0.3, -0.02)));
        assert!(!floor.faces(&Vector2::new(1.3, -0.02)));
    }

    #[test]
    fn the_nearest_feature_is_the_deepest_one() {
        let features = [
            edge([0.0, 0.0], [1.0, 0.0]).feature(),
            edge([0.5, 1.0], [0.5, -1.0]).feature(),
        ];
        let all = |_: usize, _: &Feature| true;
        let found = nearest(&features, &Vector2::new(0.495, -0.001), 0.05, all).unwrap();
        assert_eq!(found.index, 1);
        let first = |index: usize, _: &Feature| index == 0;
        let found = nearest(&features, &Vector2::new(0.495, -0.001), 0.05, first).unwrap();
        assert_eq!(found.index, 0);
        // Right of the second edge, so out of its front: it is behind.
        let found = nearest(&features, &Vector2::new(0.7, -0.001), 0.05, all).unwrap();
        assert_eq!((found.index, found.penetration), (0, 0.001));
        assert!(nearest(&features, &Vector2::new(-0.1, 2.0), 0.05, all).is_none());
    }

    #[test]
    fn a_spring_pushes_along_its_direction() {
        let spring = SpringParameters {
            anchor: [0.0, 0.1],
            direction: [0.0, -2.0],
            rest_length: 0.04,
            stiffness: 1500.0,
            half_width: 0.01,
        };
        let head = spring.feature();
        assert_eq!(head.normal, Vector2::new(0.0, -1.0));
        assert!((head.distance(&Vector2::new(0.0, 0.05)) - 0.01).abs() < 1e-15);
        assert!((head.distance(&Vector2::new(0.0, 0.07)) + 0.01).abs() < 1e-15);
    }

    #[test]
    fn a_nominal_tip_inside_the_wall_is_refused() {
        let mut contour = Contour {
            nominal_tip: [0.5, 0.1],
            nominal_elbow: crate::kinematics::Elbow::Positive,
            edge: vec![edge([0.0, 0.0], [1.0, 0.0])],
            spring: vec![],
        };
        contour.validate().unwrap();
        contour.edge[0] = edge([1.0, 0.0], [0.0, 0.0]);
        assert!(matches!(
            contour.validate(),
            Err(ParameterError::OutOfBounds { .. } | ParameterError::Inconsistent { .. })
        ));
        contour.edge[0].contact.friction = -1.0;
        assert_eq!(
            contour.validate().unwrap_err().key(),
            "edge[0].contact.friction"
        );
    }
}
