//! What the tip meets: a surface across x, free on the side of negative x, and in a corner a
//! second one across y.

use serde::{Deserialize, Serialize};

/// Stiffness of the bristle of friction [N/m].
pub(super) const BRISTLE: f64 = 3000.0;
/// Where along y the second wall of a corner is [m].
pub(super) const SIDE: f64 = 0.005;
/// How far the second wall comes out of the first one [m]: a hand that roams passes it.
pub(super) const SIDE_LENGTH: f64 = 0.01;

/// What the tip meets beyond x = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Environment {
    /// Nothing.
    Free,
    /// 100 N/m.
    SoftSpring,
    /// 200 N/m, 5 N·s/m.
    SoftWall,
    /// 2 kN/m, 10 N·s/m.
    FirmWall,
    /// 20 kN/m, 50 N·s/m.
    HardWall,
    /// The hard wall with Coulomb friction, μ = 0.3.
    WallWithFriction,
    /// 2 kN/m, 10 N·s/m, that comes up by 10 mm and goes back, twice.
    MovingWall,
    /// The hard wall and another one like it across y: who slides along the one runs into the
    /// other.
    Corner,
}

impl Environment {
    /// Those that trials are drawn from.
    pub const ALL: [Environment; 6] = [
        Environment::Free,
        Environment::SoftSpring,
        Environment::HardWall,
        Environment::WallWithFriction,
        Environment::MovingWall,
        Environment::Corner,
    ];

    /// Walls that stand still, the softest first.
    pub const WALLS: [Environment; 3] = [
        Environment::SoftWall,
        Environment::FirmWall,
        Environment::HardWall,
    ];

    /// As in configurations.
    pub const fn name(self) -> &'static str {
        match self {
            Environment::Free => "free",
            Environment::SoftSpring => "soft_spring",
            Environment::SoftWall => "soft_wall",
            Environment::FirmWall => "firm_wall",
            Environment::HardWall => "hard_wall",
            Environment::WallWithFriction => "wall_with_friction",
            Environment::MovingWall => "moving_wall",
            Environment::Corner => "corner",
        }
    }

    /// Stiffness \[N/m\] and damping \[N·s/m\] along the normal.
    pub const fn surface(self) -> (f64, f64) {
        match self {
            Environment::Free => (0.0, 0.0),
            Environment::SoftSpring => (100.0, 0.0),
            Environment::SoftWall => (200.0, 5.0),
            Environment::FirmWall => (2000.0, 10.0),
            Environment::HardWall | Environment::WallWithFriction | Environment::Corner => {
                (20_000.0, 50.0)
            }
            Environment::MovingWall => (2000.0, 10.0),
        }
    }

    /// Coulomb coefficient \[-\].
    pub const fn friction(self) -> f64 {
        match self {
            Environment::WallWithFriction => 0.3,
            _ => 0.0,
        }
    }

    /// Whether its place changes.
    pub const fn moves(self) -> bool {
        matches!(self, Environment::MovingWall)
    }

    /// Whether there is a second wall, across y.
    pub const fn has_side(self) -> bool {
        matches!(self, Environment::Corner)
    }

    /// Place \[m\] and velocity \[m/s\] of the surface, `time` \[s\] after it
    /// began to move; negative before.
    pub fn place(self, time: f64) -> (f64, f64) {
        const PERIOD: f64 = 2.0;
        if !self.moves() || !(0.0..2.0 * PERIOD).contains(&time) {
            return (0.0, 0.0);
        }
        let rate = std::f64::consts::TAU / PERIOD;
        let (sine, cosine) = (rate * time).sin_cos();
        // Towards the tip, which comes from negative x.
        (-0.005 * (1.0 - cosine), -0.005 * rate * sine)
    }
}

/// The surface while it is touched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    environment: Environment,
    /// How far the bristle of friction is bent along y [m].
    bend: f64,
    /// The tip came to the second wall from the free side and has not left since.
    touches_side: bool,
    /// Place of the tip along y a step ago [m].
    along: f64,
}

impl Surface {
    pub(super) fn new(environment: Environment) -> Self {
        Surface {
            environment,
            bend: 0.0,
            touches_side: false,
            along: f64::NEG_INFINITY,
        }
    }

    /// Force on the tip \[N\] after `dt` \[s\] at `tip` \[m\] with `velocity`
    /// \[m/s\]; the surface began to move `time` \[s\] ago.
    pub(super) fn step(
        &mut self,
        dt: f64,
        time: f64,
        tip: [f64; 2],
        velocity: [f64; 2],
    ) -> [f64; 2] {
        let (stiffness, damping) = self.environment.surface();
        let (place, speed) = self.environment.place(time);
        let side = self.side(tip, velocity[1]);
        let depth = tip[0] - place;
        if depth <= 0.0 || stiffness == 0.0 {
            self.bend = 0.0;
            return [0.0, -side];
        }
        // It never pulls.
        let normal = (stiffness * depth + damping * (velocity[0] - speed)).max(0.0);
        let limit = self.environment.friction() * normal / BRISTLE;
        self.bend = (self.bend + velocity[1] * dt).clamp(-limit, limit);
        [-normal, -BRISTLE * self.bend - side]
    }

    /// What the second wall pushes the tip with, along negative y \[N\]. Who comes round its
    /// end is behind it and feels nothing.
    fn side(&mut self, tip: [f64; 2], speed: f64) -> f64 {
        let came_from_outside = self.along < SIDE;
        self.along = tip[1];
        let depth = tip[1] - SIDE;
        let is_before = self.environment.has_side() && tip[0] > -SIDE_LENGTH;
        if depth <= 0.0 || !is_before {
            self.touches_side = false;
            return 0.0;
        }
        self.touches_side |= came_from_outside;
        if !self.touches_side {
            return 0.0;
        }
        let (stiffness, damping) = self.environment.surface();
        (stiffness * depth + damping * speed).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sliding_tip_feels_normal_force_and_coulomb_friction() {
        let mut surface = Surface::new(Environment::WallWithFriction);
        let mut force = [0.0; 2];
        for _ in 0..1000 {
            force = surface.step(1e-3, -1.0, [1e-3, 0.0], [0.0, 0.05]);
        }
        assert!((force[0] + 20.0).abs() < 1e-9, "{force:?}");
        assert!((force[1] + 6.0).abs() < 1e-9, "{force:?}");
        assert_eq!(surface.step(1e-3, -1.0, [-1e-6, 0.0], [0.0; 2]), [0.0; 2]);
    }

    #[test]
    fn a_corner_pushes_back_along_both_axes_who_did_not_come_round_its_end() {
        let mut surface = Surface::new(Environment::Corner);
        let mut at = |x: f64, y: f64| surface.step(1e-3, -1.0, [x, SIDE + y], [0.0; 2]);
        assert_eq!(at(1e-3, -1e-4), [-20.0, 0.0]);
        let [normal, side] = at(1e-3, 1e-4);
        assert!((normal + 20.0).abs() < 1e-9 && (side + 2.0).abs() < 1e-9);
        let [normal, side] = at(-1e-3, 1e-4);
        assert!(normal == 0.0 && (side + 2.0).abs() < 1e-9);
        assert_eq!(at(-2.0 * SIDE_LENGTH, 1e-4), [0.0; 2]);
        assert_eq!(at(-1e-3, 1e-4), [0.0; 2]);
    }

    #[test]
    fn the_moving_wall_moves_as_fast_as_it_says_and_ends_where_it_began() {
        let wall = Environment::MovingWall;
        let step = 1e-6;
        for k in 0..50 {
            let time = 0.1 * f64::from(k) + 0.033;
            let rate = (wall.place(time + step).0 - wall.place(time - step).0) / (2.0 * step);
            assert!((rate - wall.place(time).1).abs() < 1e-6, "{time}");
        }
        assert!((wall.place(1.0).0 + 0.01).abs() < 1e-12);
        assert_eq!(wall.place(4.1), (0.0, 0.0));
        assert_eq!(wall.place(-0.1), (0.0, 0.0));
    }

    #[test]
    fn names_are_those_of_configurations() {
        for environment in Environment::ALL.into_iter().chain(Environment::WALLS) {
            let value = toml::Value::try_from(environment).unwrap();
            assert_eq!(value.as_str(), Some(environment.name()));
        }
    }
}
