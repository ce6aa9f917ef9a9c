//! The servo's friction feed-forward: what it is told, and what it says of it.

use std::fmt;

use ferntast_control::servo::{FeedForward, FoundParameter, Servo, TakeOverRefusal};
use ferntast_msgs::{
    Text, Time,
    sample::{
        FrictionCommand, FrictionCommandSample, FrictionSource, FrictionStatusSample, JOINT_NAMES,
        MOST_PARAMETERS, TwinParametersSample,
    },
};

/// What the twin said longer ago than this \[s\] is not taken over.
const OLDEST: f64 = 2.0;
/// How often the friction is told though it did not change \[ns\], and while it changes.
const PERIOD_NANOS: i64 = 1_000_000_000;
const PERIOD_ON_THE_WAY_NANOS: i64 = 100_000_000;

/// Why a command was not followed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(super) enum Refusal {
    #[error("no twin is heard: run the session with --twin EXPERIMENT.toml")]
    NoTwin,
    #[error("the twin's last word is {0:.1} s old")]
    Old(f64),
    #[error("the twin follows a joint that this servo has not")]
    NoJoint,
    #[error(transparent)]
    Law(#[from] TakeOverRefusal),
}

/// Follows commands to the feed-forward, and tells of it.
#[derive(Debug, Default)]
pub(super) struct FrictionKeeper {
    commands: u64,
    refused: Option<Refusal>,
    due: Time,
}

impl FrictionKeeper {
    /// Follows `command`; gives what there is to say of it on `/diagnostics`.
    pub(super) fn follow(
        &mut self,
        now: Time,
        command: &FrictionCommandSample,
        twin: Option<&TwinParametersSample>,
        servo: &mut Servo,
    ) -> Result<Text<96>, Refusal> {
        self.commands += 1;
        self.due = now;
        let done = match command.command {
            FrictionCommand::TAKE_OVER => take_over(now, twin, servo),
            _ => {
                for joint in 0..JOINT_NAMES.len() {
                    if let Some(own) = servo.feed_forward_mut(joint) {
                        own.give_back();
                    }
                }
                Ok(Text::new("friction is fed forward as configured"))
            }
        };
        self.refused = done.as_ref().err().copied();
        done
    }

    /// What is fed forward at each joint, when it is time to tell.
    pub(super) fn tell(
        &mut self,
        now: Time,
        servo: &Servo,
    ) -> Option<[FrictionStatusSample; JOINT_NAMES.len()]> {
        if now < self.due {
            return None;
        }
        let all = servo.feed_forward();
        self.due = now.plus_nanos(match all.iter().any(|own| own.is_on_the_way()) {
            true => PERIOD_ON_THE_WAY_NANOS,
            false => PERIOD_NANOS,
        });
        let mut names = JOINT_NAMES.into_iter();
        Some(all.map(|own| self.status(now, names.next().unwrap_or_default(), own)))
    }

    fn status(&self, now: Time, joint: &str, own: &FeedForward) -> FrictionStatusSample {
        let mut sample = FrictionStatusSample {
            source: match own.is_taken_over() {
                true => FrictionSource::TWIN,
                false => FrictionSource::CONFIGURED,
            },
            commands: self.commands,
            refused: self.refused.map_or(Text::EMPTY, Text::display),
            joint: Text::new(joint),
            ..FrictionStatusSample::initial(now)
        };
        for (i, parameter) in own.parameters().take(MOST_PARAMETERS).enumerate() {
            sample.names[i] = Text::new(parameter.name);
            sample.configured[i] = parameter.configured;
            sample.values[i] = parameter.value;
            sample.targets[i] = parameter.target;
            sample.count += 1;
        }
        sample
    }
}

fn take_over(
    now: Time,
    twin: Option<&TwinParametersSample>,
    servo: &mut Servo,
) -> Result<Text<96>, Refusal> {
    let twin = twin.ok_or(Refusal::NoTwin)?;
    let age = now.seconds_since(twin.stamp);
    if !(0.0..=OLDEST).contains(&age) {
        return Err(Refusal::Old(age));
    }
    let nothing = FoundParameter {
        name: "",
        value: f64::NAN,
        std_error: f64::NAN,
        excitation: 0.0,
    };
    let mut found = [nothing; MOST_PARAMETERS];
    for (i, place) in found.iter_mut().enumerate().take(twin.len()) {
        *place = FoundParameter {
            name: twin.names[i].as_str(),
            value: twin.values[i],
            std_error: twin.std_errors[i],
            excitation: twin.excitation[i],
        };
    }
    let name = twin.joint.as_str();
    let joint = JOINT_NAMES.iter().position(|known| *known == name);
    let own = joint.and_then(|joint| servo.feed_forward_mut(joint));
    let own = own.ok_or(Refusal::NoJoint)?;
    let taken = own.take_over(found.get(..twin.len()).unwrap_or_default())?;
    Ok(Text::display(Words { name, taken, own }))
}

/// A take-over in words.
struct Words<'a> {
    name: &'a str,
    taken: usize,
    own: &'a FeedForward,
}

impl fmt::Display for Words<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} takes {} of the twin's", self.name, self.taken)?;
        for own in self.own.parameters() {
            if own.target != own.configured {
                write!(f, ", {} {:.4}", own.name, own.target)?;
            }
        }
        Ok(())
    }
}
