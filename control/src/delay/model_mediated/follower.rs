//! The follower's end: tells of the surface that the tip touches.

use super::ModelMediated;
use super::chase::Chase;
use super::estimate::Scale;
use super::surface::SurfaceModel;
use super::surfaces::Surfaces;
use super::told::Told;
use crate::delay::contact::{LastCommand, Late, TouchingTip};
use crate::delay::mapping::shortened;
use crate::delay::{Energy, Follower, FollowerInput, FollowerOutput, Packet, vector};
use nalgebra::Vector3;

/// Damping that a hand in a soft contact has, with what the law adds, at least [N·s/m].
const HAND_DAMPING: f64 = 10.0;
/// Stiffness of a contact of which nothing is known [N/m].
const MAYBE: f64 = 100.0;
/// How late the contact's force is by servo, estimate and frames, without the link's delay [s].
const LOOP_LAG: f64 = 0.03;

/// Under less than this share of the force that is allowed the tip goes on [-]:
const SEARCHED: f64 = 0.8;
/// with this speed [m/s], to which it brakes or speeds up so [m/s²], as an arm that is jerked
/// feigns forces;
const SEARCH_SPEED: f64 = 0.03;
const SEARCH_BRAKE: f64 = 0.5;
/// its command ahead of it by so much [m], and by the lag of a servo [s].
const SEARCH_LEAD: f64 = 0.5e-3;
const SEARCH_LAG: f64 = 0.025;
/// In contact it goes no faster, also into a surface that turns out to be soft [m/s].
const DEEPER: f64 = 0.15;
/// From so far before the surface on the tip searches it [m].
const SEARCH_BEFORE: f64 = 0.01;

/// The follower's end: sends a surface in hand units, of several one after the other: place \[m\],
/// friction \[-\] and, where that is to be felt, the contact's force in the position; normal times
/// stiffness \[N/m\] in the vector (`told.rs`).
#[derive(Clone, Debug)]
pub struct ModelMediatedFollower {
    parameters: ModelMediated,
    surfaces: Surfaces,
    /// The tip as late as the force.
    late: Late,
    command: LastCommand,
    chase: Chase,
}

impl ModelMediatedFollower {
    pub(super) fn new(law: &ModelMediated) -> Self {
        ModelMediatedFollower {
            parameters: law.clone(),
            surfaces: Surfaces::new(Scale {
                force: law.force_scale,
                threshold: threshold(law),
                searched: SEARCHED * law.force_scale * law.search_force,
            }),
            late: Late::default(),
            command: LastCommand::default(),
            chase: Chase::default(),
        }
    }

    /// How fast the command at `here` \[m\] may go, `dt` \[s\] after it did before, with the hand at
    /// `target` \[m\], which gives `asked` \[N\] into the surfaces; beyond the hand by `furthest`
    /// \[m\] at most. The tip at `touching` \[m\], where its contact is known, is a tip that
    /// searches \[m/s\].
    fn velocity(
        &mut self,
        dt: f64,
        [here, target]: [Vector3<f64>; 2],
        touching: Option<Vector3<f64>>,
        asked: Vector3<f64>,
        furthest: f64,
    ) -> Vector3<f64> {
        let own = &self.parameters;
        let least = own.force_scale * own.search_force;
        let threshold = threshold(own);
        let towards = |target: Vector3<f64>| {
            shortened((target - here) / own.position_time, own.largest_speed)
        };
        self.surfaces.ask(&asked);
        let mut goal = target;
        let mut after = target;
        for (latest, surface) in self.surfaces.iter_mut() {
            let (model, asked) = (surface.model(), surface.asked);
            // A hand that presses on what was here a while ago means what is here now.
            let pressed = surface.place.deepest(asked, model.stiffness);
            let gone = match latest && asked > threshold {
                true => (pressed - surface.inward(&target)).clamp(0.0, furthest),
                false => 0.0,
            };
            after -= gone * model.normal;
            if surface.place.touches {
                goal -= gone * model.normal;
            }
            let most = surface.place.deepest(asked.max(least), model.stiffness);
            goal += (surface.inward(&goal) - most).max(0.0) * model.normal;
        }
        let (mut velocity, after) = (towards(goal), towards(after));
        for (_, surface) in self.surfaces.iter_mut() {
            let into = surface.inward(&velocity);
            let mut speed = into;
            let ahead = surface.place.even.value - surface.inward(&here);
            if surface.place.touches {
                speed = speed.min(DEEPER);
            } else if ahead > 0.0 {
                // It comes with what it searches with: v² = v_s² + 2 a s.
                speed = speed.min(SEARCH_SPEED.hypot((2.0 * SEARCH_BRAKE * ahead).sqrt()));
            }
            if let Some(tip) = touching
                && ahead < SEARCH_BEFORE
                && surface.force.norm() < SEARCHED * surface.asked.max(least)
            {
                let lead = surface.inward(&(here - tip));
                let most = search_speed(dt, surface.speed, lead, own.position_time);
                speed = speed.max(surface.inward(&after).min(most));
            }
            surface.speed = speed;
            velocity -= (speed - into) * surface.model().normal;
        }
        velocity
    }

    /// What the other end is told, a round trip of `round_trip` \[s\] away while it is heard.
    fn told(&mut self, dt: f64, round_trip: Option<f64>) -> Option<Told> {
        let law = &self.parameters;
        let surface = self.surfaces.whose_turn(dt)?;
        surface.felt =
            round_trip.is_some_and(|own| feels_force(law, surface.model(), own, surface.felt));
        let model = surface.model();
        Some(Told {
            surface: SurfaceModel {
                place: surface.place.even.value,
                stiffness: law.sure_stiffness(model),
                ..*model
            },
            force: (surface.felt).then(|| surface.force.dot(&model.normal).max(0.0)),
        })
    }
}

/// Whether the contact's own force is to be felt of `model`, or still is where it `was`, a round
/// trip of `round_trip` \[s\] away: with a spring K in it, a loop that is late by τ wants a
/// damping of some K τ. What may be soft counts as soft: a model that is too stiff pushes the
/// hand away.
fn feels_force(law: &ModelMediated, model: &SurfaceModel, round_trip: f64, was: bool) -> bool {
    let soft = model.stiffness.min(MAYBE);
    let stiffness = model.stiffness + model.doubt() * (soft - model.stiffness);
    let needed = stiffness * (round_trip + LOOP_LAG);
    let damping = HAND_DAMPING * if was { 1.5 } else { 1.0 };
    law.contact_force && needed <= damping
}

/// How fast the command may go into the surface where the tip is to go on \[m/s\], `dt` \[s\] after
/// it went with `before` \[m/s\], ahead of the tip by `lead` \[m\], to be made up for in `time`
/// \[s\].
fn search_speed(dt: f64, before: f64, lead: f64, time: f64) -> f64 {
    let change = SEARCH_BRAKE * dt;
    let before = before.max(0.0);
    let speed = SEARCH_SPEED.clamp((before - change).max(0.0), before + change);
    let ahead = SEARCH_LEAD + SEARCH_LAG * speed;
    speed.min((ahead - lead) / time)
}

/// Smallest contact force at the hand's scale that counts as contact [N]; above zero, as what is
/// not felt at all is no contact either.
fn threshold(law: &ModelMediated) -> f64 {
    (law.force_scale * law.contact_threshold).max(1e-9)
}

impl Follower for ModelMediatedFollower {
    fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
        let own = &self.parameters;
        let mapping = own.mapping();
        let live = mapping.live(input.connected, input.received);
        let TouchingTip {
            contact, tip, here, ..
        } = TouchingTip::new(&mapping, input, &self.command);
        if let (Some(tip), Some(contact)) = (tip, contact) {
            let tip = self.late.step(dt, own.force_lag, tip);
            (self.surfaces).step(dt, own.place_frequency, tip, contact);
        }
        let touched = self.surfaces.latest().filter(|own| own.place.touches);
        let touched = touched.map(|own| (own.model().normal, own.place.even.rate));
        let round_trip = live.map(|own| own.round_trip);
        let furthest = self
            .chase
            .step(dt, own.largest_chase, tip, touched, round_trip);
        let command = live.zip(here).map(|(received, here)| {
            let [target, asked] = [received.packet.position, received.packet.vector].map(vector);
            let touching = tip.filter(|_| contact.is_some());
            let velocity = self.velocity(dt, [here, target], touching, asked, furthest);
            (here + velocity * dt, velocity)
        });
        let given = command.map(|(position, _)| position);
        self.command
            .step(dt, given, input.connected, self.parameters.deadline);
        let told = self.told(dt, round_trip);
        FollowerOutput {
            command: command.map(|(position, velocity)| mapping.command(position, velocity)),
            packet: match (input.tip, input.contact_force) {
                (Some(_), Some(_)) => told.unwrap_or_default().packed(energy),
                _ => Packet::empty(energy),
            },
        }
    }

    fn commanded(&mut self, position: Vector3<f64>) {
        self.command.replace(position);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tip_that_searches_goes_evenly_and_no_further_than_its_lead() {
        let time = 0.01;
        // From the hand's speed to its own, and from rest.
        let (mut down, mut up) = (0.1, 0.0);
        for _ in 0..200 {
            let (faster, slower) = (down, up);
            down = search_speed(1e-3, down, 0.0, time);
            up = search_speed(1e-3, up, 0.0, time);
            assert!((0.0..=SEARCH_BRAKE * 1e-3 + 1e-12).contains(&(faster - down)));
            assert!((0.0..=SEARCH_BRAKE * 1e-3 + 1e-12).contains(&(up - slower)));
        }
        assert!((down - SEARCH_SPEED).abs() < 1e-12, "{down}");
        assert!((up - SEARCH_SPEED).abs() < 1e-12, "{up}");
        let held = SEARCH_LEAD + SEARCH_LAG * SEARCH_SPEED;
        assert!(search_speed(1e-3, SEARCH_SPEED, held, time).abs() < 1e-12);
    }
}
