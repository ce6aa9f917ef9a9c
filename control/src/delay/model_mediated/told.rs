//! What the follower says of what it touches, and how that goes into a packet.

use super::compliance::SOFTEST;
use super::surface::SurfaceModel;
use crate::delay::{Energy, Packet, vector};

/// Stiffer than what is rendered, and within what a packet holds [N/m].
const STIFFEST_SENT: f64 = 9900.0;

/// The force goes in units of this, as a position in a packet is within 10 [N].
const FORCE_UNIT: f64 = 100.0;

/// What the follower says of what it touches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Told {
    pub surface: SurfaceModel,
    /// Force of the contact along the normal, where that is to be felt \[N\].
    pub force: Option<f64>,
}

impl Told {
    /// As in a packet: place, friction and, below zero, the force in the position, the normal times
    /// the stiffness in the vector.
    pub fn packed(&self, energy: Energy) -> Packet {
        let surface = &self.surface;
        let force = self.force.map_or(0.0, |force| {
            -(force / FORCE_UNIT).max(f64::from(f32::MIN_POSITIVE))
        });
        Packet::new(
            [surface.place, surface.friction, force],
            (surface.stiffness.min(STIFFEST_SENT) * surface.normal).into(),
            energy,
        )
    }

    /// Back from a packet, if that says anything of a surface. How well its stiffness is known is
    /// not told: it is that stiff for sure.
    pub fn unpacked(packet: &Packet) -> Option<Told> {
        let direction = vector(packet.vector);
        let stiffness = direction.norm();
        let [place, friction, force] = packet.position.map(f64::from);
        (stiffness >= 0.5 * SOFTEST).then(|| Told {
            surface: SurfaceModel {
                normal: direction / stiffness,
                place,
                stiffness,
                stiffness_error: 0.0,
                friction: friction.clamp(0.0, 2.0),
            },
            force: (force < 0.0).then_some(-FORCE_UNIT * force),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn a_model_goes_into_a_packet_and_back() {
        let model = SurfaceModel {
            normal: Vector3::new(-0.6, 0.8, 0.0),
            place: 0.0123,
            stiffness: 1234.0,
            stiffness_error: 0.0,
            friction: 0.25,
        };
        let told = Told {
            surface: model,
            force: None,
        };
        let back = Told::unpacked(&told.packed(Energy::default())).unwrap();
        assert_eq!(back.force, None);
        let back = back.surface;
        assert!((back.normal - model.normal).norm() < 1e-6);
        assert!((back.place - model.place).abs() < 1e-8);
        assert!((back.stiffness - model.stiffness).abs() < 1e-3);
        assert!((back.friction - model.friction).abs() < 1e-7);
        let nothing = Told::default().packed(Energy::default());
        assert_eq!(Told::unpacked(&nothing), None);
        // With the force, also where that is zero.
        for force in [0.0, 0.5, 12.0, 900.0] {
            let told = Told {
                force: Some(force),
                ..told
            };
            let back = Told::unpacked(&told.packed(Energy::default())).unwrap();
            let told = back.force.expect("a force");
            assert!((told - force).abs() <= 1e-6 * force.max(1.0), "{told} N");
        }
    }
}
