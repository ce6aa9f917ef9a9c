//! What a link looks like: the shapes of `<visual>` and `<collision>` that a file tells without meshes.

use ferntast_model::rigid_body::Placement;

use crate::document::Element;

/// A shape about the origin of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// Lengths of its edges along x, y and z \[m\].
    Box([f64; 3]),
    /// Along z.
    Cylinder {
        /// \[m\]
        radius: f64,
        /// \[m\]
        length: f64,
    },
    /// Of that radius \[m\].
    Sphere(f64),
}

/// A shape in the frame of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Its frame, in the link's.
    pub placement: Placement,
    /// What is there.
    pub solid: Solid,
}

/// The shapes of a `<link>`: those that are seen, or, where these are meshes only, those that it
/// collides with. What cannot be read is left out, since no arm is refused for its looks.
pub(crate) fn shapes(link: &Element<'_>) -> Vec<Placed> {
    let of = |name: &'static str| -> Vec<Placed> {
        let those = link.children().filter(|child| child.name() == name);
        those.filter_map(|child| placed(&child)).collect()
    };
    let seen = of("visual");
    match seen.is_empty() {
        true => of("collision"),
        false => seen,
    }
}

fn placed(element: &Element<'_>) -> Option<Placed> {
    let geometry = element.child("geometry")?;
    let length = |element: &Element<'_>, name: &'static str| {
        let value = element.number(name).ok()??;
        (value > 0.0).then_some(value)
    };
    let solid = if let Some(own) = geometry.child("box") {
        let size: [f64; 3] = own.numbers("size").ok()??;
        size.iter().all(|edge| *edge > 0.0).then_some(())?;
        Solid::Box(size)
    } else if let Some(own) = geometry.child("cylinder") {
        Solid::Cylinder {
            radius: length(&own, "radius")?,
            length: length(&own, "length")?,
        }
    } else {
        Solid::Sphere(length(&geometry.child("sphere")?, "radius")?)
    };
    Some(Placed {
        placement: element.origin().ok()?,
        solid,
    })
}
