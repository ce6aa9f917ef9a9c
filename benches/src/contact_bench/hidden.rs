//! Names of what a recording can hide, and what the experimenter still believes.

use crate::bench::{Hideable, named};

named! {
    /// An effect that is in the truth of a contact's recording and not in the
    /// model that the experimenter believes in.
    ///
    /// The first six are the contact effects of the catalogue; those whose id
    /// begins with `unknown_` are in no catalogue.
    pub enum HiddenEffect or UnknownEffect {
        /// b_0T |F_N| sign(ṙ).
        ContactCoulomb = "contact_coulomb",
        /// c ṙ.
        ContactViscous = "contact_viscous",
        /// More friction near rest.
        ContactStribeck = "contact_stribeck",
        /// The tip rests until what carries it has wound up.
        ContactCompliance = "contact_compliance",
        /// Other friction over a stretch of the edge.
        ContactSpot = "contact_spot",
        /// Friction that changes with the days.
        ContactWear = "contact_wear",
        /// Outside the catalogue: friction that grows as F_N^(2/3), as the area of a sphere's contact.
        UnknownHertz = "unknown_hertz",
        /// Outside the catalogue: friction without any normal force, as of something sticky.
        UnknownAdhesion = "unknown_adhesion",
        /// Outside the catalogue: friction that differs by direction.
        UnknownDirection = "unknown_direction",
        /// Outside the catalogue: friction that changes with temperature.
        UnknownTemperature = "unknown_temperature",
        /// Outside the catalogue: an edge that is not straight.
        UnknownWaviness = "unknown_waviness",
        /// Outside the catalogue: viscous friction that grows with F_N.
        UnknownSpeedForce = "unknown_speed_force",
    }
}

/// What every believed model starts from.
const BASE: [HiddenEffect; 2] = [HiddenEffect::ContactCoulomb, HiddenEffect::ContactViscous];

impl Hideable for HiddenEffect {
    const ALL: &'static [Self] = HiddenEffect::ALL;
    const IDS: &'static [&'static str] = HiddenEffect::IDS;

    fn id(self) -> &'static str {
        self.id()
    }

    fn overlap(self, other: Self) -> Option<&'static str> {
        use HiddenEffect::{ContactCompliance, ContactCoulomb, UnknownHertz};
        let are = |one, two| [self, other] == [one, two] || [other, self] == [one, two];
        if are(ContactCoulomb, ContactCompliance) {
            Some("the friction that winds up, which an experimenter knows first")
        } else if are(ContactCoulomb, UnknownHertz) {
            Some("the friction by normal force")
        } else {
            None
        }
    }
}

/// Ids of the effects in the believed model: Coulomb and viscous friction
/// without what is hidden.
pub(super) fn believed_effects(hidden: &[HiddenEffect]) -> Vec<&'static str> {
    BASE.into_iter()
        .filter(|base| !hidden.contains(base))
        .map(HiddenEffect::id)
        .collect()
}
