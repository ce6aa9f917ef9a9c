//! The leader's end: renders the surface that it was told of.

use super::account::UpdateAccount;
use super::estimate::SurfaceModel;
use super::hand_damping::HandDamping;
use super::told::Told;
use super::{ModelMediated, PLACE_SPEED};
use crate::delay::mapping::{ForceRamp, Mapping, shortened};
use crate::delay::{Energy, Leader, LeaderInput, LeaderOutput, Packet};
use nalgebra::Vector3;

/// v_0: below this speed friction is viscous [m/s].
const FRICTION_SPEED: f64 = 0.01;

/// Within this the contact's own force takes the place of the rendered one, and back [s].
const CHANGE_OVER: f64 = 0.3;

/// The leader's end: sends position of the hand and the force that it gives into
/// the surface \[N\].
#[derive(Clone, Debug)]
pub struct ModelMediatedLeader {
    parameters: ModelMediated,
    mapping: Mapping,
    fade: ForceRamp,
    /// What is rendered.
    surface: Option<SurfaceModel>,
    /// It appeared behind the hand and is not yet where it was told to be.
    emerges: bool,
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
    pub(super) fn new(law: &ModelMediated) -> Self {
        ModelMediatedLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            fade: ForceRamp::default(),
            surface: None,
            emerges: false,
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
        let stiffness = target.stiffness.min(self.parameters.largest_stiffness);
        let anew = SurfaceModel {
            place: target.place.max(-target.normal.dot(hand)),
            stiffness,
            ..target
        };
        let before = self.surface.unwrap_or(anew);
        // Another surface has its place along another normal.
        let known = (self.surface).filter(|own| own.pushes_along(&target.normal));
        self.emerges |= known.is_none();
        let mut surface = known.unwrap_or(anew);
        let normal = surface.normal + share * (target.normal - surface.normal);
        surface.normal = normal.try_normalize(1e-6).unwrap_or(target.normal);
        let speed = match self.emerges {
            true => self.parameters.emerge_speed,
            false => PLACE_SPEED,
        };
        surface.place += (target.place - surface.place).max(-speed * dt);
        surface.stiffness += share * (stiffness - surface.stiffness);
        surface.friction += share * (target.friction - surface.friction);
        if self.parameters.paid_updates {
            surface = self.account.paid(&before, &surface, hand);
        }
        self.emerges &= surface.place > target.place;
        self.surface = Some(surface);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::model_mediated::tests::WALL;

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

    /// The leader with the hand at rest at `x` \[m\], after each step; `surface` comes from the arm.
    fn rendering(x: f64, surface: SurfaceModel) -> impl Iterator<Item = SurfaceModel> {
        let law = ModelMediated {
            emerge_speed: 0.02,
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
        assert!((first.place - (0.02 - 0.02e-3)).abs() < 1e-9);
        let later = seen.nth(499).unwrap();
        assert!((later.place - (0.02 - 0.02 * 0.501)).abs() < 1e-9);
        assert!(seen.nth(599).unwrap().place.abs() < 1e-6);
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
}
