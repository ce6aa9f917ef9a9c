//! Inverse kinematics of any chain: damped least squares, within the joints' limits.
//!
//! A step Δq for an error e of the tip is Jᵀ (J Jᵀ + λ² 1)⁻¹ e. The damping λ grows as
//! the tip's least mobility σ, the least singular value of J, falls below
//! [`Settings::slow_below`] (Y. Nakamura, H. Hanafusa, Inverse kinematic solutions with
//! singularity robustness for robot manipulator control, J. Dyn. Syst. Meas. Control 108
//! (1986), eq. 24, with σ in place of the manipulability), so that a singularity slows
//! the arm. Nor is it crossed: below [`Settings::stop_below`] a step that makes σ smaller
//! is not taken, but one along the singularity is; and no step is so long that it could
//! jump over it.
//!
//! What the tip leaves free goes towards a home posture: (1 − J⁺ J) (q_home − q)
//! (A. Liégeois, Automatic supervisory control of the configuration and behavior of
//! multibody mechanisms, IEEE Trans. SMC 7 (1977)). A joint at its end stays there and
//! the others take over its part.

use nalgebra::{Matrix6, SVector, Vector6};

use crate::{Joints, MAX_JOINTS, ParameterError, check};

use super::{Chain, Jacobian, Placement, placement::rotation_vector};

/// What of the tip is to be brought somewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// Its point only.
    Position,
    /// Point and orientation; an arm of fewer than six joints comes as near as it can.
    Pose,
}

/// How steps are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What of the tip counts.
    pub task: Task,
    /// So many metres count as much as a radian \[m\]; about the arm's size.
    pub length: f64,
    /// Least singular value of J, its upper rows divided by `length`, from which on the
    /// arm is damped \[-\].
    pub slow_below: f64,
    /// Singular value that no step goes below \[-\].
    pub stop_below: f64,
    /// Damping λ at a singularity \[-\].
    pub damping: f64,
    /// Part of the way to the home posture that a step goes where the tip leaves it free
    /// \[-\]; 0 keeps out of it.
    pub homing: f64,
}

impl Default for Settings {
    /// For an arm of about a metre.
    fn default() -> Settings {
        Settings {
            task: Task::Pose,
            length: 0.5,
            slow_below: 0.05,
            stop_below: 0.01,
            damping: 0.05,
            homing: 0.05,
        }
    }
}

/// By how much the least singular value of the scaled Jacobian changes at most, for each radian
/// (or metre) of all joints together \[1/rad\]: a step no longer than that value by this leads
/// into no singularity.
pub const MOBILITY_CHANGE: f64 = 4.0;

impl Settings {
    /// # Errors
    ///
    /// The first value that is out of its bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("length", self.length, 1e-3, 100.0, "m")?;
        check("slow_below", self.slow_below, 1e-6, 1.0, "-")?;
        check("stop_below", self.stop_below, 1e-6, self.slow_below, "-")?;
        check("damping", self.damping, 1e-6, 1.0, "-")?;
        check("homing", self.homing, 0.0, 1.0, "-")
    }
}

/// One step towards a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Joint positions after it \[rad\] or \[m\].
    pub q: Joints<f64>,
    /// Least singular value before it \[-\], as in [`Settings::slow_below`].
    pub mobility: f64,
    /// It was not taken, since it would have led into a singularity.
    pub held: bool,
}

/// How far the tip is from a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Between the points \[m\].
    pub position: f64,
    /// Between the orientations \[rad\]; 0 where they do not count.
    pub orientation: f64,
}

/// Why no joint positions were found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum InverseKinematicsError {
    /// A target, or a start, that is NaN or infinite.
    #[error("the target or the start is not finite; send numbers")]
    NotFinite,
    /// It came no nearer.
    #[error(
        "the tip stays {:.4} m and {:.3} rad from the target after {steps} steps{}; choose a target \
         within reach, or start nearer to it",
        distance.position, distance.orientation,
        if *held { ", held before a singularity" } else { "" }
    )]
    NotReached {
        /// Where it ended.
        distance: Distance,
        /// Steps made.
        steps: usize,
        /// The last step was held before a singularity.
        held: bool,
    },
}

/// What is done with the direction in which the tip can hardly move any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Weakest {
    Follows,
    Stays,
}

/// Rows of the task: those of position come first.
const POSITION: usize = 3;

/// Joint positions as a column, zero behind the last joint.
type Column = SVector<f64, MAX_JOINTS>;

impl Settings {
    /// One step of `chain` from `q` by `motion`: a change of the tip's point \[m\] and a
    /// turn \[rad\], in the base frame. `home` \[rad\] or \[m\] is where the joints go where
    /// the tip leaves them free. The step is shortened so that no joint moves by more than
    /// a singularity is away; call it again with what is left, or with the next one. What
    /// is not finite moves nothing: the step is held.
    ///
    /// # Panics
    ///
    /// `q` or `home` has not one value for each joint.
    pub fn step(
        &self,
        chain: &Chain,
        q: &Joints<f64>,
        motion: &Vector6<f64>,
        home: &Joints<f64>,
    ) -> Step {
        chain.expect_joints(home);
        let jacobian = self.scaled(chain.jacobian(q));
        let rank = self.rows().min(chain.links.len());
        let mobility = least_singular_value(&jacobian, rank);
        let held = Step {
            q: *q,
            mobility,
            held: true,
        };
        if !mobility.is_finite() {
            return held;
        }
        let wanted = self.scaled_motion(motion);
        // Longer than any step will be; it keeps what follows finite.
        let wanted = wanted / wanted.amax().max(1.0);
        let attempt = |weakest| {
            let mut change = self.within_limits(chain, q, home, &jacobian, &wanted, weakest);
            if weakest == Weakest::Stays {
                change = self.along_singularity(chain, q, &jacobian, change);
            }
            // The least singular value changes by at most the norm of the Jacobian's change,
            // which the bound on each step keeps smaller than its distance from zero.
            let longest = self.stop_below / MOBILITY_CHANGE;
            let length = change.norm();
            let scale = if length > longest {
                longest / length
            } else {
                1.0
            };
            Joints::from_fn(chain.count(), |joint| {
                let limits = chain.limits()[joint];
                let moved = q[joint] + scale * change[joint];
                // A start beyond an end is led back by its own way only.
                moved.clamp(limits.lower.min(q[joint]), limits.upper.max(q[joint]))
            })
        };
        let may_be = |next: &Joints<f64>| {
            if !next.iter().all(|value| value.is_finite()) {
                return false;
            }
            if mobility >= 2.0 * self.stop_below {
                return true;
            }
            let after = least_singular_value(&self.scaled(chain.jacobian(next)), rank);
            after >= self.stop_below || after >= mobility
        };
        for weakest in [Weakest::Follows, Weakest::Stays] {
            let q = attempt(weakest);
            if may_be(&q) {
                return Step {
                    q,
                    mobility,
                    held: false,
                };
            }
        }
        held
    }

    /// Joint positions \[rad\] or \[m\] that bring the tip of `chain` to `target` (in the
    /// base frame) to within `tolerance`, from `start`, in at most `most_steps` steps. They
    /// are on the side of all singularities that `start` is on; a target that is reached on
    /// another side only (elbow bent the other way) needs a start there.
    ///
    /// # Errors
    ///
    /// [`InverseKinematicsError`]: not finite, or not reached from there.
    ///
    /// # Panics
    ///
    /// `start` or `home` has not one value for each joint.
    pub fn solve(
        &self,
        chain: &Chain,
        target: &Placement,
        start: &Joints<f64>,
        home: &Joints<f64>,
        tolerance: Distance,
        most_steps: usize,
    ) -> Result<Joints<f64>, InverseKinematicsError> {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if !(finite(start)
            && finite(home)
            && finite(target.translation.as_slice())
            && finite(target.rotation.as_slice()))
        {
            return Err(InverseKinematicsError::NotFinite);
        }
        let (mut q, mut held) = (*start, false);
        for steps in 0.. {
            let left = motion_to(&chain.forward(&q), target);
            let distance = self.distance(&left);
            if distance.position <= tolerance.position
                && distance.orientation <= tolerance.orientation
            {
                return Ok(q);
            }
            if steps >= most_steps || held {
                return Err(InverseKinematicsError::NotReached {
                    distance,
                    steps,
                    held,
                });
            }
            let step = self.step(chain, &q, &left, home);
            (q, held) = (step.q, step.held);
        }
        unreachable!("the loop ends by its count")
    }

    fn distance(&self, motion: &Vector6<f64>) -> Distance {
        let part = |from| motion.fixed_rows::<POSITION>(from).norm();
        Distance {
            position: part(0),
            orientation: match self.task {
                Task::Position => 0.0,
                Task::Pose => part(POSITION),
            },
        }
    }

    /// How many rows of a Jacobian count.
    fn rows(&self) -> usize {
        match self.task {
            Task::Position => POSITION,
            Task::Pose => 2 * POSITION,
        }
    }

    /// Rows of position in units of `length`, rows that do not count zero.
    fn scaled(&self, mut jacobian: Jacobian) -> Jacobian {
        for (row, mut values) in jacobian.row_iter_mut().enumerate() {
            values *= self.weight(row);
        }
        jacobian
    }

    fn scaled_motion(&self, motion: &Vector6<f64>) -> Vector6<f64> {
        Vector6::from_fn(|row, _| motion[row] * self.weight(row))
    }

    fn weight(&self, row: usize) -> f64 {
        match row {
            row if row < POSITION => 1.0 / self.length,
            row if row < self.rows() => 1.0,
            _ => 0.0,
        }
    }

    /// The damped step; joints that would leave their limits stay at them, one after the
    /// other, and the rest makes up for it.
    fn within_limits(
        &self,
        chain: &Chain,
        q: &Joints<f64>,
        home: &Joints<f64>,
        jacobian: &Jacobian,
        wanted: &Vector6<f64>,
        weakest: Weakest,
    ) -> Column {
        let mut free = *jacobian;
        let mut fixed = Column::zeros();
        let mut is_fixed = [false; MAX_JOINTS];
        let mut change = Column::zeros();
        for _ in 0..=q.len() {
            let left = wanted - jacobian * fixed;
            let homing = Column::from_fn(|joint, _| match q.get(joint) {
                Some(q) if !is_fixed[joint] => self.homing * (home[joint] - q),
                _ => 0.0,
            });
            change = fixed + self.damped(&free, &left, &homing, weakest);
            // How far each joint would go beyond its end.
            let beyond = |joint: usize| {
                let (limits, moved) = (chain.limits()[joint], q[joint] + change[joint]);
                (moved - limits.upper).max(limits.lower - moved)
            };
            let worst = (0..q.len())
                .filter(|joint| !is_fixed[*joint] && beyond(*joint) > 0.0)
                .max_by(|a, b| beyond(*a).total_cmp(&beyond(*b)));
            let Some(joint) = worst else {
                break;
            };
            let limits = chain.limits()[joint];
            fixed[joint] = (q[joint] + change[joint]).clamp(limits.lower, limits.upper) - q[joint];
            is_fixed[joint] = true;
            free.column_mut(joint).fill(0.0);
        }
        change
    }

    /// Of a step what does not make the least singular value σ smaller. With its singular
    /// vectors u and v, ∂σ/∂q_j = uᵀ (∂J/∂q_j) v.
    fn along_singularity(
        &self,
        chain: &Chain,
        q: &Joints<f64>,
        jacobian: &Jacobian,
        step: Column,
    ) -> Column {
        let eigen = (jacobian * jacobian.transpose()).symmetric_eigen();
        let Some((weakest, square)) = weakest_direction(&eigen.eigenvalues) else {
            return step;
        };
        let direction = eigen.eigenvectors.column(weakest);
        let joints = jacobian.tr_mul(&direction) / square.sqrt();
        let apart = 1e-6;
        let mut slope = Column::zeros();
        for joint in 0..q.len() {
            let mut beside = *q;
            beside[joint] += apart;
            let change = self.scaled(chain.jacobian(&beside)) - jacobian;
            slope[joint] = direction.dot(&(change * joints)) / apart;
        }
        // A little away from it, for what the slope does not tell.
        let wanted = 0.05 * slope.norm() * step.norm();
        let missing = wanted - slope.dot(&step);
        if missing <= 0.0 || slope.norm() < NONE {
            return step;
        }
        step + slope * (missing / slope.norm_squared())
    }

    /// Jᵀ (J Jᵀ + λ² 1)⁻¹ e + (1 − J⁺ J) `homing`, by the eigenvectors of J Jᵀ.
    fn damped(
        &self,
        jacobian: &Jacobian,
        error: &Vector6<f64>,
        homing: &Column,
        weakest: Weakest,
    ) -> Column {
        let eigen = (jacobian * jacobian.transpose()).symmetric_eigen();
        let least = weakest_direction(&eigen.eigenvalues);
        let mut change = *homing;
        for (index, square) in eigen.eigenvalues.iter().enumerate() {
            if !can_move(*square) {
                continue;
            }
            let direction = eigen.eigenvectors.column(index);
            let singular = square.sqrt();
            let missing = (1.0 - singular / self.slow_below).max(0.0);
            let damping = self.damping * missing;
            let joints = jacobian.tr_mul(&direction) / singular;
            let stays = weakest == Weakest::Stays && least == Some((index, *square));
            let along = if stays {
                0.0
            } else {
                direction.dot(error) * singular / (square + damping * damping)
            };
            change += joints * (along - joints.dot(homing));
        }
        change
    }
}

/// Singular values below are zero but for rounding \[-\].
const NONE: f64 = 1e-7;

/// Whether the tip can move in a direction with this square of a singular value.
fn can_move(square: f64) -> bool {
    square >= NONE * NONE
}

/// Of the directions in which the tip can move, that of the least singular value: its number
/// and the value's square.
fn weakest_direction(squares: &Vector6<f64>) -> Option<(usize, f64)> {
    let numbered = squares.iter().copied().enumerate();
    numbered
        .filter(|(_, square)| can_move(*square))
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The least of the `rank` greatest singular values; NaN of what is not finite.
fn least_singular_value(jacobian: &Jacobian, rank: usize) -> f64 {
    let product: Matrix6<f64> = jacobian * jacobian.transpose();
    if !product.iter().all(|value| value.is_finite()) {
        return f64::NAN;
    }
    let mut squares: [f64; 6] = product.symmetric_eigenvalues().into();
    squares.sort_by(|a, b| b.total_cmp(a));
    squares[rank - 1].max(0.0).sqrt()
}

/// The motion from one frame to another: change of the point \[m\], then the turn \[rad\] as
/// a rotation vector, both in the frame that the two are given in.
pub fn motion_to(from: &Placement, to: &Placement) -> Vector6<f64> {
    let shift = to.translation - from.translation;
    let turn = rotation_vector(&(to.rotation * from.rotation.transpose()));
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}
