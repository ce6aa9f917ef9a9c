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
//! An update is blended in: the model rendered follows the one received by a first
//! order lag, `blend_time`; a surface that appears around the hand begins soft.
//!
//! Forward go the hand's position and the force that it gives into the rendered
//! surface; the follower goes to that position, but presses no harder than that
//! force, and than `search_force` where nothing is rendered yet.
//!
//! **What it guarantees.** Nothing about energy: what leaves at the tip is not bound to
//! what entered at the hand, and an update that moves the surface towards the hand
//! makes energy. Assumed for stability: a surface that holds still for longer than
//! a round trip; then both ends are local loops and any delay is stable. What
//! is felt of something that moves is old.
//!
//! **On loss.** No command; the leader goes on rendering the last surface, fading out.

mod estimate;

pub use estimate::SurfaceModel;

use super::contact::{CommandForce, TouchingTip};
use super::mapping::{ForceRamp, Mapping, law_ends, law_parameters, shortened};
use super::{
    Energy, Follower, FollowerInput, FollowerOutput, Leader, LeaderInput, LeaderOutput, Packet,
    vector,
};
use estimate::{SOFTEST, SurfaceEstimator};
use nalgebra::Vector3;

law_parameters! {
    /// Parameters of the law. Every key may be left out.
    pub struct ModelMediated {
        /// b: damping at the hand \[N·s/m\].
        pub damping: f64 [0.0..=1000.0, "N·s/m"] = 2.0,
        /// Time constant with which an update is blended in \[s\].
        pub blend_time: f64 [0.001..=10.0, "s"] = 0.1,
        /// Largest stiffness that is rendered \[N/m\].
        pub largest_stiffness: f64 [10.0..=10000.0, "N/m"] = 3000.0,
        /// Largest force of the rendered surface on the hand \[N\].
        pub largest_force: f64 [0.1..=1000.0, "N"] = 30.0,
        /// Smallest contact force at the hand's scale that counts as contact \[N\].
        pub contact_threshold: f64 [0.0001..=100.0, "N"] = 0.1,
        /// How hard the tip presses, at the hand's scale, where the hand feels
        /// nothing yet \[N\].
        pub search_force: f64 [0.001..=100.0, "N"] = 2.0,
        /// Time constant with which the tip goes to the hand's position \[s\].
        pub position_time: f64 [0.002..=1.0, "s"] = 0.01,
        /// Largest speed of the tip's command, at the hand's scale \[m/s\].
        pub largest_speed: f64 [0.01..=10.0, "m/s"] = 0.5,
        /// Damping with which the tip gives way to what is too hard, at the hand's scale
        /// \[N·s/m\].
        pub yield_damping: f64 [1.0..=10000.0, "N·s/m"] = 50.0,
        /// Stiffness of the arm's servo at the tip; a session takes the arm's own
        /// where that is larger \[N/m\].
        pub servo_stiffness: f64 [1.0..=1000000.0, "N/m"] = 7000.0,
    }
}
law_ends!(
    ModelMediated,
    "model_mediated",
    Nothing,
    ModelMediatedLeader,
    ModelMediatedFollower
);

/// v_0: below this speed friction is viscous [m/s].
const FRICTION_SPEED: f64 = 0.01;

/// The model as in a packet: place and friction in the position, the normal
/// times the stiffness in the vector.
fn packed(model: Option<SurfaceModel>, energy: Energy) -> Packet {
    let model = model.unwrap_or_default();
    let sideways = [model.place, model.friction, 0.0];
    Packet::new(sideways, (model.stiffness * model.normal).into(), energy)
}

/// Back from a packet.
fn unpacked(packet: &Packet) -> Option<SurfaceModel> {
    let direction = vector(packet.vector);
    let stiffness = direction.norm();
    (stiffness >= 0.5 * SOFTEST).then(|| SurfaceModel {
        normal: direction / stiffness,
        place: f64::from(packet.position[0]),
        stiffness,
        friction: f64::from(packet.position[1]).clamp(0.0, 2.0),
    })
}

/// The leader's end: sends position of the hand and the force that it gives into
/// the surface \[N\].
#[derive(Clone, Debug)]
pub struct ModelMediatedLeader {
    parameters: ModelMediated,
    mapping: Mapping,
    fade: ForceRamp,
    /// What is rendered.
    surface: Option<SurfaceModel>,
    received: Option<SurfaceModel>,
}

impl ModelMediatedLeader {
    fn new(law: &ModelMediated) -> Self {
        ModelMediatedLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            fade: ForceRamp::default(),
            surface: None,
            received: None,
        }
    }

    /// What is rendered of the follower's surface now.
    pub fn surface(&self) -> Option<SurfaceModel> {
        self.surface
    }

    /// Blends the received model in.
    fn blend(&mut self, dt: f64) {
        let Some(target) = self.received else {
            return;
        };
        let share = dt / (dt + self.parameters.blend_time);
        let surface = self.surface.get_or_insert(SurfaceModel {
            stiffness: 0.0,
            ..target
        });
        let normal = surface.normal + share * (target.normal - surface.normal);
        surface.normal = normal.try_normalize(1e-6).unwrap_or(target.normal);
        surface.place += share * (target.place - surface.place);
        let stiffness = target.stiffness.min(self.parameters.largest_stiffness);
        surface.stiffness += share * (stiffness - surface.stiffness);
        surface.friction += share * (target.friction - surface.friction);
    }
}

/// Force of `surface` on a hand at `position` \[m\] with `velocity` \[m/s\].
fn rendered(
    surface: &SurfaceModel,
    position: &Vector3<f64>,
    velocity: &Vector3<f64>,
) -> Vector3<f64> {
    let depth = -surface.normal.dot(position) - surface.place;
    if depth <= 0.0 {
        return Vector3::zeros();
    }
    let pressed = surface.stiffness * depth;
    let slide = velocity - surface.normal * surface.normal.dot(velocity);
    let grip = surface.friction * pressed / slide.norm().max(FRICTION_SPEED);
    surface.normal * pressed - slide * grip
}

impl Leader for ModelMediatedLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let live = self.mapping.live(input.connected, input.received);
        if let Some(received) = live {
            self.received = unpacked(&received.packet);
        }
        self.blend(dt);
        let share = self.fade.step(dt, self.mapping.force_ramp, live.is_some());
        let Some(hand) = input.hand else {
            return LeaderOutput {
                force: [0.0; 3],
                packet: Packet::empty(energy),
            };
        };
        let velocity = Vector3::from(hand.velocity);
        let force = self.surface.map_or(Vector3::zeros(), |surface| {
            let force = rendered(&surface, &hand.position.into(), &velocity);
            shortened(force, self.parameters.largest_force)
        });
        let felt = share * force - self.parameters.damping * velocity;
        LeaderOutput {
            force: felt.into(),
            packet: Packet::new(hand.position, (-share * force).into(), energy),
        }
    }
}

/// The follower's end: sends the surface (place \[m\] and friction \[-\] in the
/// position, normal times stiffness \[N/m\] in the vector), in hand units.
#[derive(Clone, Debug)]
pub struct ModelMediatedFollower {
    parameters: ModelMediated,
    mapping: Mapping,
    estimator: SurfaceEstimator,
    force: CommandForce,
    model: Option<SurfaceModel>,
    /// Hand units [m].
    command: Option<Vector3<f64>>,
}

impl ModelMediatedFollower {
    fn new(law: &ModelMediated) -> Self {
        let mapping = law.mapping();
        ModelMediatedFollower {
            parameters: law.clone(),
            mapping,
            estimator: SurfaceEstimator::new(law.contact_threshold, law.largest_stiffness),
            force: CommandForce::new(mapping.stiffness_at_hand(law.servo_stiffness)),
            model: None,
            command: None,
        }
    }
}

impl Follower for ModelMediatedFollower {
    fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
        let own = &self.parameters;
        let live = self.mapping.live(input.connected, input.received);
        let TouchingTip {
            contact,
            tip,
            here,
            lead,
        } = TouchingTip::new(&self.mapping, input, self.command);
        if let (Some(tip), Some(_)) = (tip, input.contact_force) {
            self.model = self.estimator.step(dt, tip, contact);
        }
        let pushed = self.force.step(dt, contact, lead);
        let give = own.yield_damping + self.force.stiffness() * dt;
        let command = live.zip(here).map(|(received, here)| {
            let away = vector(received.packet.position) - here;
            let mut velocity = shortened(away / own.position_time, own.largest_speed);
            let allowed = vector(received.packet.vector).norm().max(own.search_force);
            let size = pushed.norm();
            if size > 1e-9 {
                // No faster than reaches the force that is allowed.
                let along = pushed / size;
                let most = (allowed - size) / give;
                velocity += (most - velocity.dot(&along)).min(0.0) * along;
            }
            (here + velocity * dt, velocity)
        });
        self.command = command.map(|(position, _)| position);
        FollowerOutput {
            command: command.map(|(position, velocity)| self.mapping.command(position, velocity)),
            packet: match (input.tip, input.contact_force) {
                (Some(_), Some(_)) => packed(self.model, energy),
                _ => Packet::empty(energy),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_goes_into_a_packet_and_back() {
        let model = SurfaceModel {
            normal: Vector3::new(-0.6, 0.8, 0.0),
            place: 0.0123,
            stiffness: 1234.0,
            friction: 0.25,
        };
        let back = unpacked(&packed(Some(model), Energy::default())).unwrap();
        assert!((back.normal - model.normal).norm() < 1e-6);
        assert!((back.place - model.place).abs() < 1e-8);
        assert!((back.stiffness - model.stiffness).abs() < 1e-3);
        assert!((back.friction - model.friction).abs() < 1e-7);
        assert_eq!(unpacked(&packed(None, Energy::default())), None);
    }

    #[test]
    fn the_rendered_surface_pushes_out_and_brakes() {
        let surface = SurfaceModel {
            normal: Vector3::new(-1.0, 0.0, 0.0),
            place: 0.01,
            stiffness: 500.0,
            friction: 0.3,
        };
        let force = rendered(
            &surface,
            &Vector3::new(0.012, 0.0, 0.0),
            &Vector3::new(0.0, 0.05, 0.0),
        );
        assert!(
            (force - Vector3::new(-1.0, -0.3, 0.0)).norm() < 1e-12,
            "{force}"
        );
        let free = rendered(&surface, &Vector3::new(0.009, 0.0, 0.0), &Vector3::zeros());
        assert_eq!(free, Vector3::zeros());
    }
}
