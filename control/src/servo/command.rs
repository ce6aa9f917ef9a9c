//! Which commands are acted on.

use std::sync::Arc;

use super::ServoConfig;
use super::planar_tip::PlanarTip;
use super::serial_tip::SerialTip;
use super::tip::{Led, TipKinematics};
use super::turning::{self, Turning};
use crate::orientation::Orientation;
use crate::{nanoseconds, seconds};
use ferntast_model::kinematics::{Kinematics, LINKS};
use ferntast_model::serial_arm::SerialArm;
use ferntast_model::{JointCount, Joints, ParameterError};
use nalgebra::Vector3;

/// Where to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Tip position x, y, z, base frame \[m\] (`servo_cp`). An arm that works in
    /// the plane z = 0 does not look at z any further, but it must be finite.
    Tip([f64; 3]),
    /// The same, with how the hand is turned that leads it: the tool of an arm of six joints or
    /// more turns as that does, from where it was when the arm was armed.
    Pose([f64; 3], Orientation),
    /// Joint positions \[rad\] (`servo_jp`).
    Joints(Joints<f64>),
}

impl Target {
    /// How the hand is turned that leads it.
    fn orientation(&self) -> Option<&Orientation> {
        match self {
            Target::Pose(_, orientation) => Some(orientation),
            Target::Tip(_) | Target::Joints(_) => None,
        }
    }
}

/// A command with its stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// When it was made \[ns since the UNIX epoch\]; zero is invalid.
    pub stamp_ns: i64,
    /// Where to go.
    pub target: Target,
}

impl Command {
    fn same_bits(&self, other: &Command) -> bool {
        let bits = |a: &[f64], b: &[f64]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
        };
        self.stamp_ns == other.stamp_ns
            && match (&self.target, &other.target) {
                (Target::Tip(a), Target::Tip(b)) => bits(a, b),
                (Target::Pose(a, turn), Target::Pose(b, other)) => bits(a, b) && turn == other,
                (Target::Joints(a), Target::Joints(b)) => bits(a, b),
                _ => false,
            }
    }
}

/// Why a command was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CommandRefusal {
    /// The stamp is zero or negative.
    #[error("the command's stamp is zero; stamp commands with the time they were made")]
    StampZero,
    /// Not newer than the command acted on last.
    #[error("the command's stamp is {back:.6} s behind the one before; send stamps that increase")]
    StampBackwards {
        /// How far back \[s\].
        back: f64,
    },
    /// Made too long ago.
    #[error("the command is {age:.4} s old, {limit} s at most; check clocks and delays")]
    TooOld {
        /// Its age \[s\].
        age: f64,
        /// Largest age \[s\].
        limit: f64,
    },
    /// Made in the future.
    #[error("the command is stamped {ahead:.4} s in the future; check the clocks")]
    FromFuture {
        /// How far ahead \[s\].
        ahead: f64,
    },
    /// NaN or infinite.
    #[error("the command is not finite; send numbers")]
    NotFinite,
    /// For another number of joints.
    #[error("the command is for {found} joints, this arm has {needed}; send one position each")]
    OtherJoints {
        /// Joints of the command.
        found: usize,
        /// Joints of the servo.
        needed: usize,
    },
    /// A tip, where the servo knows the joints only.
    #[error("the servo has no Cartesian model of this arm; send joint positions")]
    NoTipModel,
    /// Outside workspace, reach or joint limits.
    #[error("the command is outside the {limit}; stay inside")]
    OutOfRange {
        /// Which limit.
        limit: Range,
    },
    /// Further from the last command than a hand can move.
    #[error(
        "the command jumps {distance:.4} m, {speed:.2} m/s; come back to where it was, or pause and resume"
    )]
    Jump {
        /// Distance of the tip from the last command acted on \[m\].
        distance: f64,
        /// Speed that it implies \[m/s\].
        speed: f64,
    },
}

/// The limit that a command is outside of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// The box that tip commands must be in.
    Workspace,
    /// What the links reach.
    Reach,
    /// Limits of a joint, counted from 1.
    Joint(u8),
}

impl std::fmt::Display for Range {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Range::Workspace => write!(formatter, "workspace"),
            Range::Reach => write!(formatter, "arm's reach"),
            Range::Joint(joint) => write!(formatter, "limits of joint {joint}"),
        }
    }
}

/// Clocks on one host may disagree by this much \[s\].
pub const CLOCK_TOLERANCE: f64 = 0.005;

#[derive(Clone, Copy, Debug)]
pub(super) struct Accepted {
    stamp_ns: i64,
    /// Where there is a Cartesian model.
    tip: Option<Vector3<f64>>,
    led: Led,
    turning: Turning,
}

/// What the servo knows of where its tip is.
#[derive(Clone, Copy, Debug, Default)]
pub enum CartesianModel<'a> {
    /// Nothing: it takes joint positions only.
    #[default]
    None,
    /// Two links in a plane.
    Planar(Kinematics),
    /// A serial arm in space.
    Serial(&'a SerialArm),
}

impl CartesianModel<'_> {
    /// For an arm of so many joints.
    fn tip(self, joints: JointCount) -> Result<Option<Arc<dyn TipKinematics>>, ParameterError> {
        let (tip, each): (Arc<dyn TipKinematics>, _) = match self {
            CartesianModel::None => return Ok(None),
            CartesianModel::Planar(kinematics) => {
                let count = JointCount::new(LINKS)?;
                let tip = PlanarTip { kinematics, count };
                (Arc::new(tip), "link of the arm's kinematics")
            }
            CartesianModel::Serial(arm) => (Arc::new(SerialTip::new(arm)), "joint of the arm"),
        };
        match tip.count() == joints {
            true => Ok(Some(tip)),
            false => Err(ParameterError::WrongCount {
                key: "joint".into(),
                found: joints.get(),
                wanted: tip.count().get(),
                each,
            }),
        }
    }
}

/// Decides which commands are acted on, one at a time.
///
/// Without a Cartesian model tips are refused, and workspace and jumps, which
/// are about the tip, are not looked at: what a jump of the joints does is
/// bounded by the setpoint's limits alone.
#[derive(Clone, Debug)]
pub struct CommandCheck {
    tip: Option<Arc<dyn TipKinematics>>,
    /// Lower and upper joint limits [rad].
    limits: Joints<[f64; 2]>,
    workspace: [[f64; 2]; 2],
    age: f64,
    jump_speed: f64,
    jump_slack: f64,
    /// Longest time that counts towards a jump [ns]: longer silences pause.
    horizon_ns: i64,
    seen: Option<Command>,
    /// Stamp of the newest command acted on, kept when re-armed.
    newest_ns: i64,
    last: Option<Accepted>,
    /// How the tool turned with the hand before it was re-armed, and by a command of when \[ns\].
    turned: (Turning, i64),
}

impl CommandCheck {
    /// Checks against `limits`, lower and upper, of each joint \[rad\], and `config`.
    ///
    /// # Errors
    ///
    /// [`ParameterError::WrongCount`]: kinematics of another number of joints.
    pub fn new(
        kinematics: CartesianModel<'_>,
        limits: Joints<[f64; 2]>,
        config: &ServoConfig,
    ) -> Result<Self, ParameterError> {
        Ok(CommandCheck {
            tip: kinematics.tip(limits.count())?,
            limits,
            workspace: [config.workspace_lower, config.workspace_upper],
            age: config.command_age,
            jump_speed: config.jump_speed,
            jump_slack: config.jump_slack,
            horizon_ns: nanoseconds(config.command_watchdog),
            seen: None,
            newest_ns: 0,
            last: None,
            turned: Default::default(),
        })
    }

    /// Forgets where the last command was: the next one may be anywhere in
    /// the workspace (the servo approaches it on a ramp). How hand and tool belong together
    /// stays, as where hand and tip do.
    pub fn rearm(&mut self) {
        if let Some(last) = self.last.take() {
            self.turned = (last.turning, last.stamp_ns);
        }
    }

    /// The same, and from now on hand and tool belong together as they are then.
    pub fn begin(&mut self) {
        self.last = None;
        self.turned = Default::default();
    }

    /// Whether `command` is another one than at the last call; it counts as
    /// seen from now on. The newest sample of a stream is read many times.
    pub fn is_new(&mut self, command: &Command) -> bool {
        let new = !self
            .seen
            .as_ref()
            .is_some_and(|seen| seen.same_bits(command));
        self.seen = Some(*command);
        new
    }

    /// Joint positions \[rad\] for a new `command` at `now_ns`, bent as in
    /// `posture` \[rad\] where a tip leaves that open.
    ///
    /// # Errors
    ///
    /// [`CommandRefusal`]; nothing is remembered of a refused command.
    pub fn check(
        &mut self,
        command: &Command,
        now_ns: i64,
        posture: &Joints<f64>,
    ) -> Result<Joints<f64>, CommandRefusal> {
        let accepted = self.judge(command, now_ns, posture)?;
        self.newest_ns = accepted.stamp_ns;
        self.last = Some(accepted);
        Ok(accepted.led.joints)
    }

    /// What would be remembered of the command, were it acted on.
    ///
    /// # Errors
    ///
    /// As [`check`](Self::check).
    pub(super) fn judge(
        &self,
        command: &Command,
        now_ns: i64,
        posture: &Joints<f64>,
    ) -> Result<Accepted, CommandRefusal> {
        let stamp_ns = command.stamp_ns;
        if stamp_ns <= 0 {
            return Err(CommandRefusal::StampZero);
        }
        let finite = match &command.target {
            Target::Tip(tip) | Target::Pose(tip, _) => tip.iter().all(|value| value.is_finite()),
            Target::Joints(joints) => joints.iter().all(|value| value.is_finite()),
        };
        if !finite {
            return Err(CommandRefusal::NotFinite);
        }
        if stamp_ns <= self.newest_ns {
            let back = seconds(self.newest_ns - stamp_ns);
            return Err(CommandRefusal::StampBackwards { back });
        }
        let age = seconds(now_ns.saturating_sub(stamp_ns));
        if age > self.age {
            let limit = self.age;
            return Err(CommandRefusal::TooOld { age, limit });
        }
        if age < -CLOCK_TOLERANCE {
            return Err(CommandRefusal::FromFuture { ahead: -age });
        }
        let (led, tip, turning) = self.joints(command, posture)?;
        if let Some(last) = self.last
            && let (Some(tip), Some(before)) = (tip, last.tip)
        {
            let passed_ns = (stamp_ns - last.stamp_ns).clamp(0, self.horizon_ns);
            let distance = (tip - before).norm();
            if distance > self.jump_speed * seconds(passed_ns) + self.jump_slack {
                let speed = distance / seconds(passed_ns).max(1e-9);
                return Err(CommandRefusal::Jump { distance, speed });
            }
        }
        Ok(Accepted {
            stamp_ns,
            tip,
            led,
            turning,
        })
    }

    /// Joint positions \[rad\] and, where that is known, the tip \[m\], and what becomes of the
    /// tool's orientation.
    fn joints(
        &self,
        command: &Command,
        posture: &Joints<f64>,
    ) -> Result<(Led, Option<Vector3<f64>>, Turning), CommandRefusal> {
        let mut turning = Turning::default();
        let (led, tip) = match &command.target {
            Target::Tip(tip) | Target::Pose(tip, _) => {
                let model = self.tip.as_ref().ok_or(CommandRefusal::NoTipModel)?;
                let tip = model.followed(&Vector3::from(*tip));
                let last = self.last.as_ref();
                let from = last.map_or(posture, |own| &own.led.joints);
                let passed = turning::passed(last.map(|own| own.stamp_ns), command.stamp_ns);
                let hand = command.target.orientation();
                let before = match last {
                    Some(own) => own.turning,
                    None => {
                        let (turned, at_ns) = self.turned;
                        turned.resumed(seconds(command.stamp_ns.saturating_sub(at_ns)), hand)
                    }
                };
                turning = before.next(passed, hand, || model.orientation(from));
                let turn = turning.turn(passed);
                let last = last.map(|own| &own.led);
                let led = model.joints(&tip, turn.as_ref(), posture, last)?;
                (led, Some(tip))
            }
            Target::Joints(joints) => {
                self.check_count(joints)?;
                let tip = self.tip.as_ref().map(|model| model.tip(joints));
                let led = Led {
                    joints: *joints,
                    clear: 0.0,
                };
                (led, tip.transpose()?)
            }
        };
        let [lower, upper] = &self.workspace;
        let outside = |tip: Vector3<f64>| {
            (0..2).any(|axis| tip[axis] < lower[axis] || tip[axis] > upper[axis])
        };
        if tip.is_some_and(outside) {
            let limit = Range::Workspace;
            return Err(CommandRefusal::OutOfRange { limit });
        }
        for (joint, (position, [lower, upper])) in
            led.joints.iter().zip(self.limits.iter()).enumerate()
        {
            if position < lower || position > upper {
                let limit = Range::Joint(joint as u8 + 1);
                return Err(CommandRefusal::OutOfRange { limit });
            }
        }
        Ok((led, tip, turning))
    }

    fn check_count(&self, joints: &Joints<f64>) -> Result<(), CommandRefusal> {
        let (found, needed) = (joints.len(), self.limits.len());
        match found == needed {
            true => Ok(()),
            false => Err(CommandRefusal::OtherJoints { found, needed }),
        }
    }
}

/// Commands refused since the start, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefusalCounts {
    /// Stamp of zero, or going backwards.
    pub stamp: u64,
    /// Too old or from the future.
    pub time: u64,
    /// Not finite, or nothing that the servo can take: of other joints, or a tip
    /// where it knows the joints only.
    pub value: u64,
    /// Outside workspace, reach or joint limits.
    pub out_of_range: u64,
    /// Jumps.
    pub jump: u64,
}

impl RefusalCounts {
    /// Counts `refusal`.
    pub fn count(&mut self, refusal: &CommandRefusal) {
        let counter = match refusal {
            CommandRefusal::StampZero | CommandRefusal::StampBackwards { .. } => &mut self.stamp,
            CommandRefusal::TooOld { .. } | CommandRefusal::FromFuture { .. } => &mut self.time,
            CommandRefusal::NotFinite
            | CommandRefusal::OtherJoints { .. }
            | CommandRefusal::NoTipModel => &mut self.value,
            CommandRefusal::OutOfRange { .. } => &mut self.out_of_range,
            CommandRefusal::Jump { .. } => &mut self.jump,
        };
        *counter += 1;
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.stamp + self.time + self.value + self.out_of_range + self.jump
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MS: i64 = 1_000_000;
    const NOW: i64 = 1_700_000_000_000_000_000;

    fn check() -> CommandCheck {
        let kinematics = CartesianModel::Planar(Kinematics::new([0.25, 0.25]));
        let limits = [[-1.5, 1.5], [0.2, 2.5]].into();
        CommandCheck::new(kinematics, limits, &ServoConfig::default()).unwrap()
    }

    /// The elbow bent to the positive side.
    fn posture() -> Joints<f64> {
        [0.0, 1.0].into()
    }

    fn tip(stamp_ns: i64, x: f64, y: f64) -> Command {
        let target = Target::Tip([x, y, 0.0]);
        Command { stamp_ns, target }
    }

    fn at(check: &mut CommandCheck, command: Command) -> Result<Joints<f64>, CommandRefusal> {
        check.check(&command, NOW, &posture())
    }

    #[test]
    fn each_fault_has_its_own_reason() {
        let mut check = check();
        at(&mut check, tip(NOW - 4 * MS, 0.35, 0.0)).unwrap();
        let refusals = [
            (tip(0, 0.35, 0.0), "StampZero"),
            (tip(-5, 0.35, 0.0), "StampZero"),
            (tip(NOW, f64::NAN, 0.0), "NotFinite"),
            (tip(NOW, 0.3, f64::INFINITY), "NotFinite"),
            (tip(NOW - 4 * MS, 0.35, 0.0), "StampBackwards"),
            (tip(NOW - 5 * MS, 0.35, 0.0), "StampBackwards"),
            (tip(NOW + 6 * MS, 0.35, 0.0), "FromFuture"),
            (tip(NOW, 0.6, 0.0), "OutOfRange { limit: Reach }"),
            (tip(NOW, 0.4999, 0.0), "OutOfRange { limit: Joint(2) }"),
            (tip(NOW, 0.40, 0.0), "Jump"),
        ];
        for (command, expected) in refusals {
            let refusal = at(&mut check, command).unwrap_err();
            assert!(format!("{refusal:?}").starts_with(expected), "{refusal:?}");
        }
        // Nothing of all that moved the reference.
        at(&mut check, tip(NOW - 3 * MS, 0.351, 0.0)).unwrap();
        let old = check.check(&tip(NOW - 2 * MS, 0.351, 0.0), NOW + 19 * MS, &posture());
        assert!(matches!(old, Err(CommandRefusal::TooOld { .. })), "{old:?}");
    }

    #[test]
    fn a_jump_stays_refused_until_it_comes_back_or_is_rearmed() {
        let mut check = check();
        let mut now = NOW;
        let mut send = |check: &mut CommandCheck, x: f64| {
            now += 2 * MS;
            check.check(&tip(now, x, 0.0), now, &posture())
        };
        send(&mut check, 0.30).unwrap();
        for _ in 0..100 {
            assert!(send(&mut check, 0.42).is_err());
        }
        send(&mut check, 0.301).unwrap();
        assert!(send(&mut check, 0.42).is_err());
        check.rearm();
        send(&mut check, 0.42).unwrap();
    }

    #[test]
    fn the_fastest_recorded_bursts_pass() {
        // 3 m/s, sampled every millisecond.
        let mut check = check();
        for k in 0..30 {
            let now = NOW + k * MS;
            check
                .check(&tip(now, 0.3 + 0.003 * k as f64, 0.0), now, &posture())
                .unwrap();
        }
    }

    #[test]
    fn the_same_sample_is_new_once_even_when_it_is_garbage() {
        let mut check = check();
        let garbage = tip(0, f64::NAN, 0.0);
        assert!(check.is_new(&garbage));
        assert!(!check.is_new(&garbage));
        assert!(check.is_new(&tip(0, 1.0, 0.0)));
    }

    #[test]
    fn without_a_cartesian_model_joints_are_taken_and_tips_refused() {
        let limits = [[-1.0, 1.0]; 3].into();
        let mut check =
            CommandCheck::new(CartesianModel::None, limits, &ServoConfig::default()).unwrap();
        let mut stamp_ns = NOW;
        let mut send = |joints: Joints<f64>| {
            stamp_ns += MS;
            let target = Target::Joints(joints);
            check.check(&Command { stamp_ns, target }, stamp_ns, &[0.0; 3].into())
        };
        assert_eq!(send([0.1, -0.2, 0.3].into()).unwrap(), [0.1, -0.2, 0.3]);
        assert_eq!(send([0.9, 0.9, 0.9].into()).unwrap(), [0.9; 3]);
        let limit = Range::Joint(3);
        assert_eq!(
            send([0.0, 0.0, 1.1].into()),
            Err(CommandRefusal::OutOfRange { limit })
        );
        let (found, needed) = (2, 3);
        assert_eq!(
            send([0.0, 0.0].into()),
            Err(CommandRefusal::OtherJoints { found, needed })
        );
        stamp_ns += MS;
        let refused = check.check(&tip(stamp_ns, 0.35, 0.0), stamp_ns, &[0.0; 3].into());
        assert_eq!(refused, Err(CommandRefusal::NoTipModel));
    }

    #[test]
    fn kinematics_of_another_number_of_joints_are_refused() {
        let kinematics = CartesianModel::Planar(Kinematics::new([0.25, 0.25]));
        let limits = [[-1.0, 1.0]; 3].into();
        let error = CommandCheck::new(kinematics, limits, &ServoConfig::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "joint has 3 entries where 2 are needed: one for each link of the arm's kinematics"
        );
    }

    proptest! {
        /// Whatever comes in, what comes out is within the joint limits.
        #[test]
        fn accepted_commands_are_within_limits(
            commands in proptest::collection::vec((any::<i64>(), any::<f64>(), any::<f64>(), any::<bool>()), 1..20),
            near in proptest::collection::vec((0..30i64, -0.6..0.6f64, -0.6..0.6f64), 1..20),
        ) {
            let mut check = check();
            let near = near.into_iter().map(|(age, x, y)| (NOW - age * MS, x, y, false));
            for (stamp_ns, x, y, joints) in commands.into_iter().chain(near) {
                let target = if joints { Target::Joints([x, y].into()) } else { Target::Tip([x, y, 0.0]) };
                if let Ok(q) = check.check(&Command { stamp_ns, target }, NOW, &posture()) {
                    prop_assert!((-1.5..=1.5).contains(&q[0]) && (0.2..=2.5).contains(&q[1]));
                }
            }
        }
    }
}
