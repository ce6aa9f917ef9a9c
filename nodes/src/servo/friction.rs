//! The servo's friction feed-forward: what is asked of it, and what it reports.

use std::fmt;

use ferntast_control::servo::{FeedForward, FoundParameter, Servo, TakeOverRefusal, TakenOver};
use ferntast_msgs::{
    Text, Time,
    sample::{
        FrictionCommand, FrictionCommandSample, FrictionSource, FrictionStatusSample, JointNames,
        MAX_JOINTS, MAX_TWIN_PARAMETERS, TwinParametersSample,
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
#[derive(Debug)]
pub(super) struct FrictionCommands {
    joints: JointNames,
    /// The newest word of each joint's twin.
    twins: [Option<TwinParametersSample>; MAX_JOINTS],
    /// A twin of a joint that the arm has not was heard.
    stranger: bool,
    commands: u64,
    refused: [Option<Refusal>; MAX_JOINTS],
    due: Time,
}

impl FrictionCommands {
    /// Of an arm of those joints.
    pub(super) fn new(joints: JointNames) -> FrictionCommands {
        FrictionCommands {
            joints,
            twins: [None; MAX_JOINTS],
            stranger: false,
            commands: 0,
            refused: [None; MAX_JOINTS],
            due: Time::default(),
        }
    }

    /// Takes what a twin says.
    pub(super) fn hear(&mut self, twin: &TwinParametersSample) {
        let joint = self.joints.index(twin.joint.as_str());
        match joint.and_then(|joint| self.twins.get_mut(joint)) {
            Some(place) => *place = Some(*twin),
            None => self.stranger = true,
        }
    }

    /// Follows `command`; gives what there is to say of it on `/diagnostics`.
    pub(super) fn follow(
        &mut self,
        now: Time,
        command: &FrictionCommandSample,
        servo: &mut Servo,
    ) -> Result<Text<96>, Refusal> {
        self.commands += 1;
        self.due = now;
        self.refused = [None; MAX_JOINTS];
        match command.command {
            FrictionCommand::TAKE_OVER => self.take_over(now, servo),
            _ => {
                for joint in 0..self.joints.len() {
                    if let Some(own) = servo.feed_forward_mut(joint) {
                        own.give_back();
                    }
                }
                Ok(Text::new("friction is fed forward as configured"))
            }
        }
    }

    /// Takes over what each joint's twin found; the first refusal, where there are some.
    fn take_over(&mut self, now: Time, servo: &mut Servo) -> Result<Text<96>, Refusal> {
        let mut done: Option<Text<96>> = None;
        let twins = self.twins.iter().zip(&mut self.refused).enumerate();
        for (joint, (twin, refused)) in twins {
            let Some(twin) = twin else {
                continue;
            };
            let own = servo.feed_forward_mut(joint).ok_or(Refusal::NoJoint);
            match own.and_then(|own| take_over(now, twin, own)) {
                Ok(words) => {
                    done = Some(done.map_or(words, |before| {
                        Text::display(format_args!("{before}; {words}"))
                    }));
                }
                Err(refusal) => *refused = Some(refusal),
            }
        }
        if let Some(refusal) = self.refused.iter().flatten().next() {
            return Err(*refusal);
        }
        done.ok_or_else(|| {
            let refusal = match self.stranger {
                true => Refusal::NoJoint,
                false => Refusal::NoTwin,
            };
            self.refused = [Some(refusal); MAX_JOINTS];
            refusal
        })
    }

    /// What is fed forward at each joint, when it is time to tell.
    pub(super) fn tell<'a>(
        &'a mut self,
        now: Time,
        servo: &'a Servo,
    ) -> Option<impl Iterator<Item = FrictionStatusSample> + 'a> {
        if now < self.due {
            return None;
        }
        let mut all = servo.feed_forward();
        self.due = now.plus_nanos(match all.any(|own| own.is_on_the_way()) {
            true => PERIOD_ON_THE_WAY_NANOS,
            false => PERIOD_NANOS,
        });
        let own = &*self;
        let each = own
            .joints
            .iter()
            .zip(servo.feed_forward())
            .zip(&own.refused);
        Some(each.map(move |((joint, friction), refused)| {
            own.status(now, joint, friction, refused.as_ref())
        }))
    }

    fn status(
        &self,
        now: Time,
        joint: &str,
        own: &FeedForward,
        refused: Option<&Refusal>,
    ) -> FrictionStatusSample {
        let mut sample = FrictionStatusSample {
            source: match own.is_taken_over() {
                true => FrictionSource::TWIN,
                false => FrictionSource::CONFIGURED,
            },
            commands: self.commands,
            refused: refused.map_or(Text::EMPTY, Text::display),
            joint: Text::new(joint),
            ..FrictionStatusSample::initial(now)
        };
        for (i, parameter) in own.parameters().take(MAX_TWIN_PARAMETERS).enumerate() {
            sample.names[i] = Text::new(parameter.name);
            sample.configured[i] = parameter.configured;
            sample.values[i] = parameter.value;
            sample.targets[i] = parameter.target;
            sample.count += 1;
        }
        sample
    }
}

/// Takes over what one joint's twin found.
fn take_over(
    now: Time,
    twin: &TwinParametersSample,
    own: &mut FeedForward,
) -> Result<Text<96>, Refusal> {
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
    let mut found = [nothing; MAX_TWIN_PARAMETERS];
    for (i, place) in found.iter_mut().enumerate().take(twin.len()) {
        *place = FoundParameter {
            name: twin.names[i].as_str(),
            value: twin.values[i],
            std_error: twin.std_errors[i],
            excitation: twin.excitation[i],
        };
    }
    let taken = own.take_over(found.get(..twin.len()).unwrap_or_default())?;
    let name = twin.joint.as_str();
    Ok(Text::display(Description { name, taken, own }))
}

/// A take-over in words.
struct Description<'a> {
    name: &'a str,
    taken: TakenOver<'a>,
    own: &'a FeedForward,
}

impl fmt::Display for Description<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} takes {} of the twin's", self.name, self.taken.count)?;
        if let Some((name, why)) = self.taken.left_out {
            write!(f, ", not {name}: {why}")?;
        }
        for own in self.own.parameters() {
            if own.target != own.configured {
                write!(f, ", {} {:.4}", own.name, own.target)?;
            }
        }
        Ok(())
    }
}
