//! What the tip meets: a surface across x, free on the side of negative x, and in a corner a block
//! on it, whose side is a second one across y.

use serde::{Deserialize, Serialize};

/// Stiffness of the bristle of friction [N/m].
pub(super) const BRISTLE: f64 = 3000.0;
/// Where along y the second wall of a corner is [m].
pub(super) const SIDE: f64 = 0.005;
/// How far that comes out of the first one [m]: a hand that roams passes it. Beyond it the block
/// has its front.
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
    /// The hard wall and a block on it, as hard: who slides along the one runs into the side of the
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

    /// What it pushes a tip with that is `depth` \[m\] in it and goes deeper with `speed` \[m/s\]
    /// \[N\]: it never pulls.
    fn push(self, depth: f64, speed: f64) -> f64 {
        let (stiffness, damping) = self.surface();
        match depth > 0.0 {
            true => (stiffness * depth + damping * speed).max(0.0),
            false => 0.0,
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

    /// Whether there is a block with a second wall, across y.
    pub const fn has_block(self) -> bool {
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
    /// Of the block, where there is one.
    side: Face,
    front: Face,
}

/// A face that ends somewhere: who comes round its end is behind it and feels nothing.
#[derive(Clone, Copy, Debug)]
struct Face {
    /// The tip came to it from the free side and has not left since.
    touches: bool,
    /// How deep the tip was a step ago, along the whole plane [m].
    depth: f64,
}

impl Face {
    const NEW: Face = Face {
        touches: false,
        depth: f64::NEG_INFINITY,
    };

    /// How deep the tip is in it \[m\], zero where it is not, at `depth` \[m\] of the whole plane;
    /// whether the face is `there`.
    fn step(&mut self, depth: f64, there: bool) -> f64 {
        let came_from_outside = self.depth <= 0.0;
        self.depth = depth;
        self.touches = there && depth > 0.0 && (self.touches || came_from_outside);
        match self.touches {
            true => depth,
            false => 0.0,
        }
    }
}

impl Surface {
    pub(super) fn new(environment: Environment) -> Self {
        Surface {
            environment,
            bend: 0.0,
            side: Face::NEW,
            front: Face::NEW,
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
        let (place, speed) = self.environment.place(time);
        let block = self.block(tip, velocity);
        let normal = self.environment.push(tip[0] - place, velocity[0] - speed);
        let limit = self.environment.friction() * normal / BRISTLE;
        self.bend = (self.bend + velocity[1] * dt).clamp(-limit, limit);
        [block[0] - normal, block[1] - BRISTLE * self.bend]
    }

    /// Force of the block on the tip \[N\].
    fn block(&mut self, tip: [f64; 2], velocity: [f64; 2]) -> [f64; 2] {
        if !self.environment.has_block() {
            return [0.0; 2];
        }
        let [out, aside] = [tip[0] + SIDE_LENGTH, tip[1] - SIDE];
        let depths = [
            self.front.step(out, aside > 0.0),
            self.side.step(aside, out > 0.0),
        ];
        std::array::from_fn(|axis| -self.environment.push(depths[axis], velocity[axis]))
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
    fn a_corner_pushes_back_along_both_axes_and_is_a_block_from_outside() {
        let mut surface = Surface::new(Environment::Corner);
        let mut at = |x: f64, y: f64, force: [f64; 2]| {
            let own = surface.step(1e-3, -1.0, [x, SIDE + y], [0.0; 2]);
            let near = (0..2).all(|axis| (own[axis] - force[axis]).abs() < 1e-9);
            assert!(near, "{x}, {y}: {own:?}");
        };
        at(1e-3, -1e-4, [-20.0, 0.0]);
        at(1e-3, 1e-4, [-20.0, -2.0]);
        at(-1e-3, 1e-4, [0.0, -2.0]);
        // Round the end of the side, and into the front.
        at(-SIDE_LENGTH - 1e-4, 1e-4, [0.0, 0.0]);
        at(-SIDE_LENGTH + 1e-4, 1e-4, [-2.0, 0.0]);
        // Along the front back before the side.
        at(-SIDE_LENGTH + 1e-4, -1e-4, [0.0, 0.0]);
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
