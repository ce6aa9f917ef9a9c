//! The follower's end: tells of the surface that the tip touches.

use super::ModelMediated;
use super::chase::Chase;
use super::estimate::{Scale, SurfaceEstimator, SurfaceModel};
use super::place::Place;
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

/// The follower's end: sends the surface in hand units: place \[m\], friction \[-\] and, where that is to
/// be felt, the contact's force in the position; normal times stiffness \[N/m\] in the vector
/// (`told.rs`).
#[derive(Clone, Debug)]
pub struct ModelMediatedFollower {
    parameters: ModelMediated,
    estimator: SurfaceEstimator,
    /// The tip as late as the force.
    late: Late,
    model: Option<SurfaceModel>,
    place: Option<Place>,
    command: LastCommand,
    /// Of the command into the surface, since one is known [m/s].
    speed: f64,
    chase: Chase,
    /// The contact's own force is to be felt.
    told: bool,
}

impl ModelMediatedFollower {
    pub(super) fn new(law: &ModelMediated) -> Self {
        ModelMediatedFollower {
            parameters: law.clone(),
            estimator: SurfaceEstimator::new(Scale {
                force: law.force_scale,
                threshold: threshold(law),
                searched: SEARCHED * law.force_scale * law.search_force,
            }),
            late: Late::default(),
            model: None,
            place: None,
            command: LastCommand::default(),
            speed: 0.0,
            chase: Chase::default(),
            told: false,
        }
    }

    /// Whether the contact's own force is to be felt of `model`, a round trip of `round_trip` \[s\]
    /// away: with a spring K in it, a loop that is late by τ wants a damping of some K τ. What may
    /// be soft counts as soft: a model that is too stiff pushes the hand away.
    fn tells_force(&self, model: &SurfaceModel, round_trip: f64) -> bool {
        let soft = model.stiffness.min(MAYBE);
        let stiffness = model.stiffness + model.doubt() * (soft - model.stiffness);
        let needed = stiffness * (round_trip + LOOP_LAG);
        let damping = HAND_DAMPING * if self.told { 1.5 } else { 1.0 };
        self.parameters.contact_force && needed <= damping
    }
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
            self.model = self.estimator.step(dt, tip, contact);
            let touches = contact.norm() >= threshold(own);
            self.place = self.model.map(|model| {
                let place = self.place.unwrap_or(Place::of(&model));
                place.step(dt, own.place_frequency, &model, &tip, touches)
            });
        }
        let touched = self.model.zip(self.place.filter(|own| own.touches));
        let touched = touched.map(|(model, own)| (model.normal, own.even.rate));
        let round_trip = live.map(|own| own.round_trip);
        let furthest = self
            .chase
            .step(dt, own.largest_chase, tip, touched, round_trip);
        let command = live.zip(here).map(|(received, here)| {
            let target = vector(received.packet.position);
            let asked = vector(received.packet.vector).norm();
            let allowed = asked.max(own.force_scale * own.search_force);
            let towards = |target: Vector3<f64>| {
                shortened((target - here) / own.position_time, own.largest_speed)
            };
            let free = towards(target);
            let velocity = self.model.zip(self.place).map_or(free, |(model, place)| {
                let into = |own: &Vector3<f64>| -model.normal.dot(own);
                // A hand that presses on what was here a while ago means what is here now.
                let pressed = place.deepest(asked, model.stiffness);
                let gone = match asked > threshold(own) {
                    true => (pressed - into(&target)).clamp(0.0, furthest),
                    false => 0.0,
                };
                let after = target - gone * model.normal;
                let goal = if place.touches { after } else { target };
                let most = place.deepest(allowed, model.stiffness);
                let over = (into(&goal) - most).max(0.0);
                let bound = towards(goal + over * model.normal);
                let mut speed = into(&bound);
                if place.touches {
                    speed = speed.min(DEEPER);
                }
                let near = into(&here) + SEARCH_BEFORE > place.even.value;
                let little = contact.is_some_and(|own| own.norm() < SEARCHED * allowed);
                if near && little {
                    let lead = tip.map_or(0.0, |tip| into(&(here - tip)));
                    let most = search_speed(dt, self.speed, lead, own.position_time);
                    speed = speed.max(into(&towards(after)).min(most));
                }
                self.speed = speed;
                bound - (speed - into(&bound)) * model.normal
            });
            (here + velocity * dt, velocity)
        });
        let given = command.map(|(position, _)| position);
        self.command.step(dt, given, input.connected, own.deadline);
        self.told = self
            .model
            .zip(live)
            .is_some_and(|(model, received)| self.tells_force(&model, received.round_trip));
        FollowerOutput {
            command: command.map(|(position, velocity)| mapping.command(position, velocity)),
            packet: match (input.tip, input.contact_force) {
                (Some(_), Some(_)) => {
                    let told = self.model.zip(self.place).map(|(model, own)| Told {
                        surface: SurfaceModel {
                            place: own.even.value,
                            stiffness: self.parameters.sure_stiffness(&model),
                            ..model
                        },
                        force: self.told.then(|| {
                            let along = contact.map_or(0.0, |force| force.dot(&model.normal));
                            along.max(0.0)
                        }),
                    });
                    told.unwrap_or_default().packed(energy)
                }
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
