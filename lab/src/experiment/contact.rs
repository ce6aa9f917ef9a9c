//! What an experiment on a contact has that one on a joint has not.

use ferntast_identification::JointType;

use super::ExperimentError;

pub(super) const TANGENTIAL: &str = "name the force along the contour [N], positive where it opposes a motion towards larger places, \
     as in \"/follower/contact_cf.wrench.force.x.@negative\"";
pub(super) const NORMAL: &str = "name the force along the normal [N], positive when it pushes the tip out, as in \
     \"/follower/contact_cf.wrench.force.z\"";
pub(super) const MOTOR: &str =
    "name the motor torque [Nm], joint side, as in \"/follower/motor_js.effort[0]\"";

/// What `position` should be.
pub(super) const fn position(joint: JointType) -> &'static str {
    match joint {
        JointType::Contact => {
            "name the place along the contour [m], or the tip: tip = [x, y] with [contact] contour"
        }
        _ => "name the joint's position [rad or m], as in \"/follower/measured_js.position[0]\"",
    }
}

/// What a tip slides along: straight pieces from corner to corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// Where each piece begins, its direction, its length, and the length of
    /// all before it \[m\].
    pieces: Vec<Piece>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    from: [f64; 2],
    direction: [f64; 2],
    length: f64,
    before: f64,
}

impl Contour {
    /// Through these corners \[m\], in order; `None` where fewer than two, two
    /// in a row at one place, or one that is no number.
    #[must_use]
    pub fn new(corners: &[[f64; 2]]) -> Option<Contour> {
        let mut before = 0.0;
        let mut pieces = Vec::new();
        for pair in corners.windows(2) {
            let [x, y] = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
            let length = x.hypot(y);
            if !(length.is_finite() && length > 0.0) {
                return None;
            }
            pieces.push(Piece {
                from: pair[0],
                direction: [x / length, y / length],
                length,
                before,
            });
            before += length;
        }
        (!pieces.is_empty()).then_some(Contour { pieces })
    }

    /// Place \[m\] from the first corner, along the contour, of the point on it
    /// that is nearest to the tip at `x`, `y` \[m\]. Its ends go on straight.
    #[must_use]
    pub fn place(&self, x: f64, y: f64) -> f64 {
        let last = self.pieces.len().saturating_sub(1);
        let of_piece = |(index, piece): (usize, &Piece)| {
            let off = [x - piece.from[0], y - piece.from[1]];
            let along = off[0] * piece.direction[0] + off[1] * piece.direction[1];
            let low = if index == 0 { f64::NEG_INFINITY } else { 0.0 };
            let high = if index == last {
                f64::INFINITY
            } else {
                piece.length
            };
            let along = along.max(low).min(high);
            let [dx, dy] = [0, 1].map(|axis| off[axis] - along * piece.direction[axis]);
            (dx.hypot(dy), piece.before + along)
        };
        let places = self.pieces.iter().enumerate().map(of_piece);
        places
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or(0.0, |(_, place)| place)
    }
}

/// The contour that a file gives.
pub(super) fn contour(
    corners: Option<Vec<[f64; 2]>>,
    has_tip: bool,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Option<Contour>, ExperimentError> {
    let reason = match (corners, has_tip) {
        (None, false) => return Ok(None),
        (None, true) => {
            "it is missing: give the corners that signals.tip slides along, as in [[0.2, -0.03], [0.4, -0.03]]"
        }
        (Some(_), false) => {
            "it is for signals.tip, which is not there; a position is a place along the contour already"
        }
        (Some(corners), true) => match Contour::new(&corners) {
            Some(contour) => return Ok(Some(contour)),
            None => "give two corners or more [m], each at another place than the one before",
        },
    };
    Err(refuse("contact.contour", reason.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tip_is_laid_on_the_nearest_piece() {
        let contour = Contour::new(&[[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]]).unwrap();
        for ((x, y), place) in [
            ((0.3, 0.01), 0.3),
            ((-0.2, 0.0), -0.2),
            ((1.1, 0.5), 1.5),
            ((0.9, 1.0), 2.0),
            ((1.0, 2.5), 3.5),
            ((1.2, -0.1), 1.0),
        ] {
            assert!((contour.place(x, y) - place).abs() < 1e-12, "{x} {y}");
        }
    }

    #[test]
    fn what_has_no_length_is_no_contour() {
        assert_eq!(Contour::new(&[[0.0, 0.0]]), None);
        assert_eq!(Contour::new(&[[0.0, 1.0], [0.0, 1.0]]), None);
        assert_eq!(Contour::new(&[[0.0, f64::NAN], [0.0, 1.0]]), None);
    }
}
