//! The leader's end: renders the surfaces that it was told of.

use super::ModelMediated;
use super::account::UpdateAccount;
use super::hand_damping::HandDamping;
use super::rendered::Rendered;
use super::surface::{SURFACES, SurfaceModel};
use super::told::Told;
use crate::delay::mapping::{ForceRamp, Mapping, shortened};
use crate::delay::{Energy, Leader, LeaderInput, LeaderOutput, Packet};
use nalgebra::Vector3;

/// A surface that is not told while others are is forgotten after this [s]: some turns of each.
const UNTOLD: f64 = 0.3;
/// What the tip is asked to press with, by the force that the hand gets, at most [-].
const ASKED: f64 = 1.1;

/// The leader's end: sends position of the hand and the force that it gives into
/// the surface \[N\].
#[derive(Clone, Debug)]
pub struct ModelMediatedLeader {
    parameters: ModelMediated,
    mapping: Mapping,
    fade: ForceRamp,
    /// What is rendered.
    surfaces: [Option<Rendered>; SURFACES],
    /// Time since the other end was heard, once it was [s].
    unheard: Option<f64>,
    account: UpdateAccount,
    damping: HandDamping,
    /// Of the last step: what the hand should have felt, and what of it was not given [N].
    wanted: Vector3<f64>,
    lacking: Vector3<f64>,
}

impl ModelMediatedLeader {
    pub(super) fn new(law: &ModelMediated) -> Self {
        ModelMediatedLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            fade: ForceRamp::default(),
            surfaces: [None; SURFACES],
            unheard: None,
            account: UpdateAccount::new(law.update_reserve),
            damping: HandDamping::new(law.free_damping, law.damping),
            wanted: Vector3::zeros(),
            lacking: Vector3::zeros(),
        }
    }

    /// What is rendered now of the surfaces at the follower's end.
    pub fn surfaces(&self) -> impl Iterator<Item = &SurfaceModel> {
        self.surfaces.iter().flatten().filter_map(Rendered::surface)
    }

    /// Takes what was told `dt` \[s\] after the last step: of one that is known, or of another, in
    /// place of the one that was not told for longest.
    fn hear(&mut self, dt: f64, told: Told) {
        for own in self.surfaces.iter_mut().flatten() {
            own.untold += dt;
        }
        let alone = self.surfaces.iter().all(Option::is_none);
        let known = self.surfaces.iter_mut().flatten();
        match known.into_iter().find(|own| own.is(&told)) {
            Some(own) => own.tell(told),
            None => {
                let untold = |own: &Option<Rendered>| own.map_or(f64::INFINITY, |own| own.untold);
                let slots = self.surfaces.iter_mut();
                if let Some(slot) = slots.max_by(|a, b| untold(a).total_cmp(&untold(b))) {
                    *slot = Some(Rendered::of(told, alone));
                }
            }
        }
        for slot in &mut self.surfaces {
            *slot = slot.filter(|own| own.untold < UNTOLD);
        }
    }

    /// What of the model's force the tip is asked for [-]: a hand that is deep in a surface, but does
    /// not get all of its force as nobody pays for that, does not press with it either.
    fn asked_share(&self) -> f64 {
        let square = self.wanted.norm_squared();
        let got = self.wanted - self.lacking;
        match square > 0.0 {
            true => (ASKED * got.dot(&self.wanted) / square).clamp(0.0, 1.0),
            false => 1.0,
        }
    }
}

impl Leader for ModelMediatedLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let live = self.mapping.live(input.connected, input.received);
        if let Some(received) = live {
            if let Some(told) = Told::unpacked(&received.packet) {
                self.hear(dt, told);
            }
            let entered = f64::from(received.packet.energy[0]);
            self.account.came_in(self.mapping.power_scale() * entered);
        }
        if let Some(hand) = input.hand {
            let position = hand.position.into();
            let surfaces = self.surfaces.iter().flatten();
            self.damping
                .step(dt, surfaces.filter_map(Rendered::surface), &position);
            let square = Vector3::from(hand.velocity).norm_squared();
            self.account.add(self.damping.value() * square * dt);
            for own in self.surfaces.iter_mut().flatten() {
                own.blend(
                    dt,
                    &self.parameters,
                    &mut self.account,
                    &position,
                    &self.lacking,
                );
            }
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
        let position = hand.position.into();
        let [mut model, mut felt] = [Vector3::zeros(); 2];
        for own in self.surfaces.iter_mut().flatten() {
            let [its_model, its_felt] = own.forces(dt, &position, &velocity);
            model += its_model;
            felt += its_felt;
        }
        let limit = self.parameters.largest_force;
        let [model, felt] = [model, felt].map(|force| shortened(force, limit));
        let felt = share * felt - self.damping.value() * velocity;
        // Whether that is felt or the contact's own force: the tip goes as deep as the hand.
        let asked = self.asked_share() * share * model;
        self.wanted = felt;
        self.lacking = Vector3::zeros();
        LeaderOutput {
            force: felt.into(),
            packet: Packet::new(hand.position, (-asked).into(), energy),
        }
    }

    fn given(&mut self, force: Vector3<f64>) {
        self.lacking = self.wanted - force;
    }

    fn nearness(&self) -> f64 {
        self.damping.nearness()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::model_mediated::tests::WALL;

    /// The hand at rest at `x` \[m\]; `surface` comes from the arm.
    fn at_the_wall(x: f64, surface: SurfaceModel) -> LeaderInput {
        let told = Told {
            surface,
            force: None,
        };
        LeaderInput {
            hand: Some(crate::delay::Motion {
                position: [x, 0.0, 0.0],
                velocity: [0.0; 3],
            }),
            received: Some(crate::delay::Received {
                packet: told.packed(Energy::default()),
                fresh: true,
                silence: 0.0,
                age: 0.1,
                round_trip: 0.2,
            }),
            connected: true,
        }
    }

    /// One whose updates nobody has to pay for.
    fn unpaid() -> ModelMediatedLeader {
        ModelMediatedLeader::new(&ModelMediated {
            emerge_speed: 0.02,
            paid_updates: false,
            ..ModelMediated::default()
        })
    }

    /// The leader with the hand at rest at `x` \[m\], after each step; `surface` comes from the arm.
    fn rendering(x: f64, surface: SurfaceModel) -> impl Iterator<Item = SurfaceModel> {
        let mut leader = unpaid();
        std::iter::repeat_with(move || {
            let input = at_the_wall(x, surface);
            leader.step(1e-3, &input, Energy::default());
            *leader.surfaces().next().unwrap()
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
            let mut input = at_the_wall(0.002, WALL);
            input.received = input.received.filter(|_| heard);
            input.connected = heard;
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

    /// 2 kN/m, 2 mm deep: 4 N, of which somebody keeps some.
    #[test]
    fn a_hand_presses_with_hardly_more_than_it_gets() {
        let pressed = |gets: f64| {
            let mut leader = unpaid();
            let mut asked = |x: f64| {
                let output = leader.step(1e-3, &at_the_wall(x, WALL), Energy::default());
                leader.given(Vector3::x() * -gets);
                f64::from(output.packet.vector[0])
            };
            // It comes from where it feels nothing.
            let before = asked(-0.001);
            (0..1000).map(|_| asked(0.002)).last().unwrap() - before
        };
        assert!((pressed(4.0) - 4.0).abs() < 0.01, "{} N", pressed(4.0));
        assert!((pressed(2.0) - 2.2).abs() < 0.01, "{} N", pressed(2.0));
        assert_eq!(pressed(-1.0), 0.0);
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
