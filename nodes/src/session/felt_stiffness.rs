//! What the hand feels of the first thing that the arm touches.
//!
//! F / d: the force on the hand by how far the hand is beyond the surface, where it rests, long
//! enough for the force to be of that place. Where the surface is, the tip tells: it is pressed in
//! as far as the contact force says, and stays in a plane where it goes to the side. Everything at
//! the tip's scale, base frame.

use ferntast_identification::numerics::regression::least_squares;
use ferntast_model::rigid_body::Vector3;

/// A force on the hand below this is nothing that is pressed against \[N\].
const FELT: f64 = 2.0;
/// Forces further apart than that are of another surface: cosine of 30°. Where it slides, friction
/// tilts them.
const ALIKE: f64 = 0.866;
/// Further to the side than this is another place \[m\],
const ASIDE: f64 = 1e-3;
/// as is a tip that is further in or out than this \[m\].
const APART: f64 = 0.01;
/// A contact force that changes by less than this does not tell how far the tip is pressed in \[N\].
const CHANGE: f64 = 1.0;
/// Share of the hand's depth that the surface's place may be wrong by, standard error \[-\].
const ERROR: f64 = 0.1;
/// Looks that are kept.
const MOST: usize = 20_000;

/// Hand and tip in a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// The hand \[m\].
    pub(super) hand: Vector3<f64>,
    /// The force on it \[N\].
    pub(super) hand_force: Vector3<f64>,
    /// The hand rests, for longer than what it feels is late.
    pub(super) hand_rests: bool,
    /// The tip \[m\].
    pub(super) tip: Vector3<f64>,
    /// The normal force on it \[N\].
    pub(super) contact_force: f64,
    /// The tip moves so slowly that its force is of where it is.
    pub(super) tip_is_slow: bool,
}

/// Keeps what was seen of contacts.
#[derive(Debug, Default)]
pub(super) struct FeltStiffness {
    looks: Vec<Look>,
}

impl FeltStiffness {
    /// Keeps a look at a contact.
    pub(super) fn add(&mut self, look: Look) {
        if self.looks.len() < MOST {
            self.looks.push(look);
        }
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.looks.clear();
    }

    /// The stiffness \[N/m\]; `None` where the hand did not press and rest, or where the
    /// surface is cannot be told.
    pub(super) fn stiffness(&self) -> Option<f64> {
        let presses = |own: &&Look| own.hand_force.norm() > FELT;
        let first = self.looks.iter().find(presses)?;
        let along = first.hand_force.normalize();
        let same_place = |own: &&Look| {
            let aside = |way: Vector3<f64>| (way - along * along.dot(&way)).norm();
            let near = along.dot(&(own.tip - first.tip)).abs() < APART;
            near && aside(own.tip - first.tip) < ASIDE && aside(own.hand - first.hand) < ASIDE
        };
        let there = || self.looks.iter().filter(same_place);
        let rests = |own: &&Look| {
            let alike = own.hand_force.dot(&along) > ALIKE * own.hand_force.norm();
            presses(own) && own.hand_rests && alike
        };
        let resting = || there().filter(rests);
        let out = resting().map(|own| own.hand_force).sum::<Vector3<f64>>();
        let out = out.try_normalize(0.0)?;
        let hand = resting().map(|own| own.hand).sum::<Vector3<f64>>() / resting().count() as f64;
        let slow: Vec<&Look> = there().filter(|own| own.tip_is_slow).collect();
        let surface = Surface::fit(&out, &hand, &slow)?;
        let (mut moment, mut square) = (0.0, 0.0);
        for own in resting() {
            let depth = surface.depth(&own.hand);
            moment += depth * own.hand_force.dot(&surface.normal);
            square += depth * depth;
        }
        let known = surface.error < ERROR * surface.depth(&hand);
        (known && moment > 0.0).then(|| moment / square)
    }
}

/// The plane in which the tip would be without a contact force.
struct Surface {
    /// Out of it.
    normal: Vector3<f64>,
    /// Where it is before or behind the hand \[m\], and the standard error of that along the
    /// normal \[m\].
    place: Vector3<f64>,
    error: f64,
}

impl Surface {
    /// Through the tips of `looks`, about the `hand` \[m\]; `out` is roughly out of it.
    fn fit(out: &Vector3<f64>, hand: &Vector3<f64>, looks: &[&Look]) -> Option<Surface> {
        let column =
            |of: &dyn Fn(&Look) -> f64| looks.iter().map(|own| of(own)).collect::<Vec<_>>();
        let along = |axis: Vector3<f64>| column(&|own| axis.dot(&(own.tip - hand)));
        let force = column(&|own| own.contact_force);
        let least = force.iter().copied().fold(f64::INFINITY, f64::min);
        let most = force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if most - least < CHANGE {
            return None;
        }
        let aside = match out.x.abs() < 0.9 {
            true => out.cross(&Vector3::x()).normalize(),
            false => out.cross(&Vector3::y()).normalize(),
        };
        let axes = [aside, out.cross(&aside)];
        let [u, v] = axes.map(along);
        let columns = [&column(&|_| 1.0)[..], &force, &u, &v];
        let fit = least_squares(&columns, &along(*out))?;
        let tilts = axes[0] * fit.values[2] + axes[1] * fit.values[3];
        Some(Surface {
            normal: (out - tilts).normalize(),
            place: hand + out * fit.values[0],
            error: fit.errors[0],
        })
    }

    /// How deep `hand` is in it \[m\].
    fn depth(&self, hand: &Vector3<f64>) -> f64 {
        self.normal.dot(&(self.place - hand))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SURFACE: f64 = 20e3;
    const SERVO: f64 = 8e3;

    /// A hand that goes 3 mm into a surface that is tilted by `tilt` \[rad\], rests there for `rest`
    /// looks and slides away to the side; what it feels is `late` looks late, and was none before
    /// the first one.
    fn press(rest: usize, late: usize, tilt: f64) -> FeltStiffness {
        let (out, aside) = (
            Vector3::new(-tilt.cos(), tilt.sin(), 0.0),
            Vector3::new(tilt.sin(), tilt.cos(), 0.0),
        );
        let depths = (1..=15).map(|look| 0.2e-3 * f64::from(look));
        let depths = depths.chain(std::iter::repeat_n(3e-3, rest + 30));
        let both = 1.0 / (1.0 / SURFACE + 1.0 / SERVO);
        let forces: Vec<f64> = depths.clone().map(|depth| both * depth).collect();
        let mut felt = FeltStiffness::default();
        for (number, (depth, force)) in depths.zip(&forces).enumerate() {
            let way = 0.1e-3 * number.saturating_sub(15 + rest) as f64;
            let told = number
                .checked_sub(late)
                .map_or(0.0, |number| forces[number]);
            // The finest that the tip is measured.
            let noise = 2e-6 * [1.0, -1.0][number % 2];
            felt.add(Look {
                hand: way * aside - depth * out,
                hand_force: told * out,
                hand_rests: way == 0.0 && number > 15 + late,
                tip: way * aside - (force / SURFACE + noise) * out,
                contact_force: *force,
                tip_is_slow: true,
            });
        }
        felt
    }

    #[test]
    fn it_is_that_of_surface_and_servo_one_behind_the_other() {
        let both = 1.0 / (1.0 / SURFACE + 1.0 / SERVO);
        for late in [0, 5, 15] {
            for tilt in [0.0, 0.3, 1.5] {
                let felt = press(20, late, tilt).stiffness().unwrap();
                assert!(
                    (felt / both - 1.0).abs() < 2e-3,
                    "{felt}, {late} looks late"
                );
            }
        }
    }

    /// Friction turns the force on the hand, not the plane in which the tip is.
    #[test]
    fn a_force_that_friction_tilts_is_taken_along_the_normal() {
        let mut felt = press(20, 0, 0.2);
        for own in &mut felt.looks {
            let friction = 0.2 * own.hand_force.norm();
            own.hand_force += friction * Vector3::new(0.2_f64.sin(), 0.2_f64.cos(), 0.0);
        }
        let both = 1.0 / (1.0 / SURFACE + 1.0 / SERVO);
        let felt = felt.stiffness().unwrap();
        assert!((felt / both - 1.0).abs() < 1e-2, "{felt}");
    }

    /// On the way from one to the other the tip is on the same line.
    #[test]
    fn what_is_touched_later_does_not_count() {
        let mut felt = press(20, 0, 0.0);
        let alone = felt.stiffness();
        for mut own in press(20, 0, 0.0).looks {
            own.hand.x += 0.05;
            own.tip.x += 0.05;
            own.hand_force *= 0.3;
            felt.add(own);
        }
        assert_eq!(felt.stiffness(), alone);
    }

    #[test]
    fn a_hand_that_does_not_rest_tells_nothing() {
        assert_eq!(press(3, 5, 0.0).stiffness(), None);
        assert_eq!(FeltStiffness::default().stiffness(), None);
    }

    #[test]
    fn a_force_that_does_not_change_does_not_tell_where_the_surface_is() {
        let mut felt = press(20, 0, 0.0);
        felt.looks.retain(|own| own.hand_rests);
        assert_eq!(felt.stiffness(), None);
        felt.clear();
        assert!(felt.looks.is_empty());
    }
}
