//! Model-mediated: the follower sends what it touches, the leader renders it.
//!
//! The follower's end estimates the surface, its place, normal, stiffness and
//! friction (`estimate.rs`); the leader's end renders that surface locally, so
//! no force goes round through the delay (Hannaford 1989, "A design framework for
//! teleoperators with kinesthetic feedback", IEEE T-RA 5, section V; Mitra and
//! Niemeyer 2008, "Model-mediated telemanipulation", IJRR 27; survey: Xu, Cizmeci,
//! Schuwerk, Steinbach 2016, "Model-mediated teleoperation: toward stable and
//! transparent teleoperation systems", IEEE Access 4):
//!
//! F = K p n − μ K p v_t/max(|v_t|, v_0) − b v, p = max(s − s₀, 0), s = −n·x_h.
//!
//! b is what a hand at a stiff surface needs (`damping`), less at a soft one, and `free_damping`
//! where nothing is near (`hand_damping.rs`).
//!
//! An update is blended in: the model rendered follows the one received by a first
//! order lag, `blend_time`. Its place comes towards the hand no faster than 50 mm/s; a surface
//! that appears around the hand begins at the hand, so that it winds nothing up at once.
//!
//! **Updates are passive** (what the survey of Xu et al. asks of them): one that would wind up the
//! spring under the hand goes on only as far as an energy account pays (`account.rs`, ours). The
//! two layers keep books of their own around the law and leave that out.
//!
//! The follower tells with the stiffness how sure it is of it, as a relative standard error. A
//! soft surface counts as a stiff one at first; it would keep a hand and, with that, the tip from
//! going deep enough to learn better if it were rendered as stiff as one that is known.
//!
//! Where `contact_force` is set (as in `auto.rs`), the follower tells the contact's own force in
//! place of that error where surface and delay allow to feel it, and the leader's end leads F_N over
//! to it.
//!
//! Forward go the hand's position and the force f that it gives into the rendered
//! surface. The tip goes to that position, but no deeper behind the surface as the follower
//! estimates it than s₀ + f/K, with f at least `search_force`: no loop of force is closed
//! around the servo and its lag, only one of the place s₀, which is slow
//! (`place_frequency`; its gain is K_true/K − 1, so a K that is too small would make
//! it unstable).
//!
//! Under less than 0.8 f the tip goes on, evenly and with 30 mm/s at most, also where the surface
//! is believed to be too stiff for that: so it goes after a surface that it lost, and shows
//! what K a soft one has, which counts as a stiff one at first. This never takes the tip back, so
//! it is no loop of force either.
//!
//! **What it guarantees.** Nothing about energy: what leaves at the tip is not bound to
//! what entered at the hand. Assumed for stability: a surface that
//! holds still for longer than a round trip; then both ends are local loops and any delay is
//! stable. What is felt of something that moves is old.
//!
//! **On loss.** No command. The leader goes on rendering the last surface, which costs nobody
//! energy, for `outlives`, and fades it out then: a hand that were let sink into the surface as
//! soon as the other end falls silent would have to be pushed out of it again, with energy that nobody has.

mod account;
mod chord;
mod compliance;
mod estimate;
mod even;
mod hand_damping;
mod noise;
mod place;
mod told;

pub use estimate::SurfaceModel;

use super::contact::{LastCommand, Late, TouchingTip};
use super::mapping::{ForceRamp, Mapping, law_ends, law_parameters, shortened};
use super::{
    Energy, Follower, FollowerInput, FollowerOutput, Leader, LeaderInput, LeaderOutput, Packet,
    Samples, vector,
};
use account::UpdateAccount;
use estimate::{SAME, Scale, SurfaceEstimator};
use hand_damping::HandDamping;
use nalgebra::Vector3;
use place::Place;
use told::Told;

law_parameters! {
    /// Parameters of the law. Every key may be left out.
    pub struct ModelMediated {
        /// b: damping at the hand, at something stiff \[N·s/m\].
        pub damping: f64 [0.0..=1000.0, "N·s/m"] = 14.0,
        /// The same far from all that is known to touch \[N·s/m\].
        pub free_damping: f64 [0.0..=1000.0, "N·s/m"] = 14.0,
        /// Time constant with which an update is blended in \[s\].
        pub blend_time: f64 [0.001..=10.0, "s"] = 0.1,
        /// Whether updates have to be paid for.
        pub paid_updates: bool = true,
        /// What the account that pays for updates holds at most \[J\].
        pub update_reserve: f64 [0.0..=1000.0, "J"] = 0.1,
        /// For how long the surface is rendered after the other end was heard last \[s\].
        pub outlives: f64 [0.0..=60.0, "s"] = 2.0,
        /// Largest stiffness that is rendered \[N/m\].
        pub largest_stiffness: f64 [10.0..=10000.0, "N/m"] = 3300.0,
        /// The same while that of the surface is not known well \[N/m\].
        pub largest_doubtful_stiffness: f64 [10.0..=10000.0, "N/m"] = 3300.0,
        /// Whether the contact's own force is felt where surface and delay allow that.
        pub contact_force: bool = false,
        /// Largest force of the rendered surface on the hand \[N\].
        pub largest_force: f64 [0.1..=1000.0, "N"] = 30.0,
        /// Smallest contact force at the tip that counts as contact \[N\].
        pub contact_threshold: f64 [0.0001..=100.0, "N"] = 0.1,
        /// How hard the tip presses where the hand feels nothing yet \[N\].
        pub search_force: f64 [0.001..=100.0, "N"] = 3.0,
        /// Time constant with which the tip goes to the hand's position \[s\].
        pub position_time: f64 [0.002..=1.0, "s"] = 0.01,
        /// Largest speed of the tip's command, at the hand's scale \[m/s\].
        pub largest_speed: f64 [0.01..=10.0, "m/s"] = 0.5,
        /// How late the contact's force is beside the tip, by the filters of its estimate \[s\].
        pub force_lag: f64 [0.0..=0.1, "s"] = 0.008,
        /// Natural frequency with which the place of the surface is followed \[rad/s\].
        pub place_frequency: f64 [1.0..=100.0, "rad/s"] = 12.0,
    }
}
law_ends!(
    ModelMediated,
    "model_mediated",
    Nothing,
    ModelMediatedLeader,
    ModelMediatedFollower
);

impl ModelMediated {
    fn samples(&self) -> [Samples; 2] {
        [Samples::position_and_force(1.0), Samples::SURFACE]
    }

    /// Stiffness with which `model` is rendered \[N/m\].
    fn rendered_stiffness(&self, model: &SurfaceModel) -> f64 {
        let known = self.largest_stiffness;
        let doubtful = self.largest_doubtful_stiffness.min(known);
        model
            .stiffness
            .min(known + model.doubt() * (doubtful - known))
    }
}

/// A surface comes towards the hand no faster [m/s].
const PLACE_SPEED: f64 = 0.05;
/// v_0: below this speed friction is viscous [m/s].
const FRICTION_SPEED: f64 = 0.01;

/// Within this the contact's own force takes the place of the rendered one, and back [s].
const CHANGE_OVER: f64 = 0.3;
/// Damping that a hand in a soft contact has, with what the law adds, at least [N·s/m].
const HAND_DAMPING: f64 = 10.0;
/// Stiffness of a contact of which nothing is known [N/m].
const MAYBE: f64 = 100.0;
/// How late the contact's force is by servo, estimate and frames, without the link's delay [s].
const LOOP_LAG: f64 = 0.03;

/// The leader's end: sends position of the hand and the force that it gives into
/// the surface \[N\].
#[derive(Clone, Debug)]
pub struct ModelMediatedLeader {
    parameters: ModelMediated,
    mapping: Mapping,
    fade: ForceRamp,
    /// What is rendered.
    surface: Option<SurfaceModel>,
    received: Option<Told>,
    /// The contact's own force as it was told last \[N\], and its share in what is felt.
    contact: f64,
    felt: ForceRamp,
    /// Time since the other end was heard, once it was [s].
    unheard: Option<f64>,
    account: UpdateAccount,
    damping: HandDamping,
}

impl ModelMediatedLeader {
    fn new(law: &ModelMediated) -> Self {
        ModelMediatedLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            fade: ForceRamp::default(),
            surface: None,
            received: None,
            contact: 0.0,
            felt: ForceRamp::default(),
            unheard: None,
            account: UpdateAccount::new(law.update_reserve),
            damping: HandDamping::new(law.free_damping, law.damping),
        }
    }

    /// What is rendered of the follower's surface now.
    pub fn surface(&self) -> Option<SurfaceModel> {
        self.surface
    }

    /// Blends the received model in, with the hand at `hand` \[m\]. A surface that comes towards
    /// the hand winds its spring up, so it comes slowly, and begins at the hand where it appears
    /// behind it; one that gives way does so at once.
    fn blend(&mut self, dt: f64, hand: &Vector3<f64>) {
        let Some(Told {
            surface: target, ..
        }) = self.received
        else {
            return;
        };
        let share = dt / (dt + self.parameters.blend_time);
        let stiffness = self.parameters.rendered_stiffness(&target);
        let anew = SurfaceModel {
            place: target.place.max(-target.normal.dot(hand)),
            stiffness,
            ..target
        };
        let surface = self.surface.get_or_insert(anew);
        let before = *surface;
        if surface.normal.dot(&target.normal) < SAME {
            // Another surface, whose place is along another normal.
            *surface = anew;
        }
        let normal = surface.normal + share * (target.normal - surface.normal);
        surface.normal = normal.try_normalize(1e-6).unwrap_or(target.normal);
        surface.place += (target.place - surface.place).max(-PLACE_SPEED * dt);
        surface.stiffness += share * (stiffness - surface.stiffness);
        surface.stiffness_error = target.stiffness_error;
        surface.friction += share * (target.friction - surface.friction);
        if self.parameters.paid_updates {
            *surface = self.account.paid(&before, surface, hand);
        }
    }
}

/// Force with which `surface` is pressed by a hand at `position` \[m\] \[N\].
fn pressed(surface: &SurfaceModel, position: &Vector3<f64>) -> f64 {
    surface.stiffness * surface.depth(position).max(0.0)
}

/// Force of `surface`, which is `pressed` \[N\], on a hand with `velocity` \[m/s\].
fn rendered(surface: &SurfaceModel, pressed: f64, velocity: &Vector3<f64>) -> Vector3<f64> {
    if pressed <= 0.0 {
        return Vector3::zeros();
    }
    let slide = velocity - surface.normal * surface.normal.dot(velocity);
    let grip = surface.friction * pressed / slide.norm().max(FRICTION_SPEED);
    surface.normal * pressed - slide * grip
}

impl Leader for ModelMediatedLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let live = self.mapping.live(input.connected, input.received);
        if let Some(received) = live {
            self.received = Told::unpacked(&received.packet);
            let entered = f64::from(received.packet.energy[0]);
            self.account.came_in(self.mapping.power_scale() * entered);
        }
        let appears = self.surface.is_none();
        if let Some(hand) = input.hand {
            let position = hand.position.into();
            self.damping.step(dt, self.surface.as_ref(), &position);
            let square = Vector3::from(hand.velocity).norm_squared();
            self.account.add(self.damping.value() * square * dt);
            self.blend(dt, &position);
        }
        self.unheard = match live {
            Some(_) => Some(0.0),
            None => self.unheard.map(|own| own + dt),
        };
        let known = self
            .unheard
            .is_some_and(|own| own <= self.parameters.outlives);
        let share = self.fade.step(dt, self.mapping.force_ramp, known);
        let Some(hand) = input.hand else {
            return LeaderOutput {
                force: [0.0; 3],
                packet: Packet::empty(energy),
            };
        };
        let velocity = Vector3::from(hand.velocity);
        let told = self.received.and_then(|own| own.force);
        self.contact = told.unwrap_or(self.contact);
        if appears {
            // Nothing was felt before: nothing is led over.
            self.felt = ForceRamp::at(if told.is_some() { 1.0 } else { 0.0 });
        }
        let own = self.felt.step(dt, CHANGE_OVER, told.is_some());
        let limit = self.parameters.largest_force;
        let [model, felt] = self.surface.map_or(Default::default(), |surface| {
            let model = pressed(&surface, &hand.position.into());
            [model, model + own * (self.contact - model)]
                .map(|force| shortened(rendered(&surface, force, &velocity), limit))
        });
        let felt = share * felt - self.damping.value() * velocity;
        LeaderOutput {
            force: felt.into(),
            // Whatever is felt, the tip goes as deep as the hand.
            packet: Packet::new(hand.position, (-share * model).into(), energy),
        }
    }

    fn nearness(&self) -> f64 {
        self.damping.nearness()
    }
}

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

/// The follower's end: sends the surface (place \[m\], friction \[-\] and relative error of the
/// stiffness \[-\] in the position, normal times stiffness \[N/m\] in the vector), in hand units.
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
    /// The contact's own force is to be felt.
    told: bool,
}

impl ModelMediatedFollower {
    fn new(law: &ModelMediated) -> Self {
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
        let command = live.zip(here).map(|(received, here)| {
            let target = vector(received.packet.position);
            let allowed = vector(received.packet.vector).norm();
            let allowed = allowed.max(own.force_scale * own.search_force);
            let towards = |target: Vector3<f64>| {
                shortened((target - here) / own.position_time, own.largest_speed)
            };
            let free = towards(target);
            let velocity = self.model.zip(self.place).map_or(free, |(model, place)| {
                let into = |own: &Vector3<f64>| -model.normal.dot(own);
                let most = place.deepest(allowed, model.stiffness);
                let over = (into(&target) - most).max(0.0);
                let bound = towards(target + over * model.normal);
                let mut speed = into(&bound);
                if place.touches {
                    speed = speed.min(DEEPER);
                }
                let near = into(&here) + SEARCH_BEFORE > place.even.value;
                let little = contact.is_some_and(|own| own.norm() < SEARCHED * allowed);
                if near && little {
                    let lead = tip.map_or(0.0, |tip| into(&(here - tip)));
                    let most = search_speed(dt, self.speed, lead, own.position_time);
                    speed = speed.max(into(&free).min(most));
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
    fn the_rendered_surface_pushes_out_and_brakes() {
        let surface = SurfaceModel {
            normal: Vector3::new(-1.0, 0.0, 0.0),
            place: 0.01,
            stiffness: 500.0,
            stiffness_error: 0.0,
            friction: 0.3,
        };
        let at = |x| pressed(&surface, &Vector3::new(x, 0.0, 0.0));
        let force = rendered(&surface, at(0.012), &Vector3::new(0.0, 0.05, 0.0));
        assert!(
            (force - Vector3::new(-1.0, -0.3, 0.0)).norm() < 1e-12,
            "{force}"
        );
        let free = rendered(&surface, at(0.009), &Vector3::zeros());
        assert_eq!(free, Vector3::zeros());
    }

    /// Of 2 kN/m, across x.
    pub(super) const WALL: SurfaceModel = SurfaceModel {
        normal: Vector3::new(-1.0, 0.0, 0.0),
        place: 0.0,
        stiffness: 2000.0,
        stiffness_error: 0.0,
        friction: 0.0,
    };

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

    /// The leader with the hand at rest at `x` \[m\], after each step; `surface` comes from the arm.
    fn rendering(x: f64, surface: SurfaceModel) -> impl Iterator<Item = SurfaceModel> {
        let law = ModelMediated {
            paid_updates: false,
            ..ModelMediated::default()
        };
        let mut leader = ModelMediatedLeader::new(&law);
        std::iter::repeat_with(move || {
            let packet = Told {
                surface,
                force: None,
            }
            .packed(Energy::default());
            let input = LeaderInput {
                hand: Some(crate::delay::Motion {
                    position: [x, 0.0, 0.0],
                    velocity: [0.0; 3],
                }),
                received: Some(crate::delay::Received {
                    packet,
                    fresh: true,
                    silence: 0.0,
                    age: 0.1,
                    round_trip: 0.2,
                }),
                connected: true,
            };
            leader.step(1e-3, &input, Energy::default());
            leader.surface().unwrap()
        })
    }

    #[test]
    fn a_surface_outlives_the_other_end_and_fades_then() {
        let law = ModelMediated {
            paid_updates: false,
            ..ModelMediated::default()
        };
        let mut leader = ModelMediatedLeader::new(&law);
        let mut force = |heard: bool| {
            let input = LeaderInput {
                hand: Some(crate::delay::Motion {
                    position: [0.002, 0.0, 0.0],
                    velocity: [0.0; 3],
                }),
                received: heard.then_some(crate::delay::Received {
                    packet: Told {
                        surface: WALL,
                        force: None,
                    }
                    .packed(Energy::default()),
                    fresh: true,
                    silence: 0.0,
                    age: 0.1,
                    round_trip: 0.2,
                }),
                connected: heard,
            };
            leader.step(1e-3, &input, Energy::default()).force[0]
        };
        // Nobody knows of it before the other end was heard.
        assert_eq!(force(false), 0.0);
        // 2 kN/m, 2 mm deep.
        let whole = (0..2000).map(|_| force(true)).last().unwrap();
        assert!((-4.01..-3.99).contains(&whole), "{whole} N");
        let lasts = (1e3 * law.outlives) as usize;
        for _ in 0..lasts {
            assert_eq!(force(false), whole);
        }
        let fades = (1e3 * law.force_ramp) as usize;
        let half = (0..fades / 2).map(|_| force(false)).last().unwrap();
        assert!((0.45..0.55).contains(&(half / whole)), "{half} N");
        let gone = (0..fades).map(|_| force(false)).last().unwrap();
        assert_eq!(gone, 0.0);
    }

    #[test]
    fn a_surface_that_appears_around_the_hand_comes_out_from_under_it() {
        let mut seen = rendering(0.02, WALL);
        let first = seen.next().unwrap();
        assert!((first.place - (0.02 - PLACE_SPEED * 1e-3)).abs() < 1e-9);
        let later = seen.nth(199).unwrap();
        assert!((later.place - (0.02 - PLACE_SPEED * 0.201)).abs() < 1e-9);
        assert!(seen.nth(299).unwrap().place.abs() < 1e-6);
        // One before the hand is where it is at once, and as stiff as may be rendered.
        let stiff = SurfaceModel {
            stiffness: 9000.0,
            ..WALL
        };
        let first = rendering(-0.02, stiff).next().unwrap();
        assert!(first.place.abs() < 1e-6, "{first:?}");
        let largest = ModelMediated::default().largest_stiffness;
        assert!((first.stiffness - largest).abs() < 1e-6, "{first:?}");
    }

    /// A soft surface counts as a stiff one before more is known of it.
    #[test]
    fn what_may_be_soft_is_not_rendered_as_stiff_as_what_is_known() {
        let law = ModelMediated {
            largest_stiffness: 9000.0,
            ..ModelMediated::default()
        };
        let stiffness = |law: &ModelMediated, stiffness, stiffness_error| {
            law.rendered_stiffness(&SurfaceModel {
                stiffness,
                stiffness_error,
                ..WALL
            })
        };
        assert_eq!(stiffness(&law, 20_000.0, 0.05), 9000.0);
        assert_eq!(stiffness(&law, 20_000.0, 1.0), 3300.0);
        let between = stiffness(&law, 20_000.0, 0.2);
        assert!((between - 6150.0).abs() < 1e-6, "{between} N/m");
        assert_eq!(stiffness(&law, 100.0, 1.0), 100.0);
        // Doubt makes nothing stiffer.
        let soft = ModelMediated {
            largest_stiffness: 1000.0,
            ..law
        };
        assert_eq!(stiffness(&soft, 20_000.0, 1.0), 1000.0);
    }
}
