//! The table of topics: name, sample, how it is sent, who in the session
//! publishes it, and whether peers on ROS 2 may. Gateway, recorder, player and
//! replay take theirs from here.

use std::marker::PhantomData;

use crate::{
    Message,
    sample::{
        AuthoritySample, ContactStateSample, FrictionCommandSample, FrictionStatusSample,
        HealthSample, JointSample, LawCommandSample, LinkCommandSample, LinkStatusSample,
        OperatingStateSample, PoseSample, RecorderCommandSample, RecorderStatusSample,
        RobotDescriptionSample, StateCommandSample, TemperatureSample, TransformsSample,
        TwinParametersSample, WrenchSample,
    },
};

/// How a topic is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// A servo stream: best effort, the newest wins, nothing for late joiners.
    Stream,
    /// A state: reliable, the newest wins, a late joiner gets the last one.
    State,
    /// An event or one of several publishers: reliable, none is skipped up to a queue of [`EVENT_QUEUE`].
    Event,
}

/// How many events may wait for a reader.
pub const EVENT_QUEUE: usize = 64;

/// Who on ROS 2 may publish a topic into a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Authority {
    /// Nobody: what peers publish there is not subscribed to. The topic goes out.
    Never,
    /// Every peer. The topic comes in and does not go out.
    Always,
    /// Every peer where the scenario says so; else as with [`Authority::Never`].
    ByScenario(Switch),
}

/// What in a scenario lets peers publish a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Switch {
    /// Joint positions may be commanded past the master and the link.
    ServoJp,
    /// The hand is a client on ROS 2.
    CrtkHand,
}

impl Switch {
    /// The setting in the scenario that turns it on.
    pub const fn setting(self) -> &'static str {
        match self {
            Switch::ServoJp => "[gateway] servo_jp = true",
            Switch::CrtkHand => "[hand] source = \"crtk\"",
        }
    }
}

/// A topic: name, sample type, delivery, who publishes it.
#[derive(Debug)]
pub struct Topic<M: Message> {
    /// Full ROS 2 name.
    pub name: &'static str,
    /// How it is sent.
    pub delivery: Delivery,
    /// Nodes of the session that publish it; `every` stands for all.
    pub publishers: &'static [&'static str],
    /// Whether peers on ROS 2 may publish it into the session.
    pub authority: Authority,
    sample: PhantomData<fn() -> M>,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// See [`Topic::name`].
    pub name: &'static str,
    /// See [`Topic::delivery`].
    pub delivery: Delivery,
    /// See [`Topic::publishers`].
    pub publishers: &'static [&'static str],
    /// See [`Topic::authority`].
    pub authority: Authority,
}

impl<M: Message> Clone for Topic<M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: Message> Copy for Topic<M> {}

impl<M: Message> Topic<M> {
    /// A topic of that name that nodes of the session publish. Names are
    /// absolute (`/follower/measured_js`).
    pub const fn new(name: &'static str, delivery: Delivery) -> Topic<M> {
        Topic::of(name, delivery, &[], Authority::Never)
    }

    const fn of(
        name: &'static str,
        delivery: Delivery,
        publishers: &'static [&'static str],
        authority: Authority,
    ) -> Topic<M> {
        Topic {
            name,
            delivery,
            publishers,
            authority,
            sample: PhantomData,
        }
    }

    /// Its row of the table, without the type of its sample.
    pub const fn row(&self) -> Row {
        Row {
            name: self.name,
            delivery: self.delivery,
            publishers: self.publishers,
            authority: self.authority,
        }
    }
}

macro_rules! topics {
    ($(
        $(#[$doc:meta])*
        $constant:ident: $sample:ty = $name:literal, $delivery:ident, from($($publisher:ident)*), $authority:ident $(($switch:ident))?;
    )*) => {
        $($(#[$doc])* pub const $constant: Topic<$sample> = Topic::of(
            $name,
            Delivery::$delivery,
            &[$(stringify!($publisher)),*],
            Authority::$authority $((Switch::$switch))?,
        );)*

        /// Something to be done with every topic, whatever its type: to list,
        /// record, play or bridge them all.
        pub trait Visitor {
            /// Called once a topic, in the order of the table.
            fn topic<M: Message>(&mut self, topic: Topic<M>);
        }

        /// Calls `visitor` for every topic of the table.
        pub fn visit(visitor: &mut impl Visitor) {
            $(visitor.topic($constant);)*
        }
    };
}

topics! {
    /// Motor position on the joint side \[rad\], velocity \[rad/s\], joint torque sensor \[Nm\].
    FOLLOWER_MEASURED_JS: JointSample = "/follower/measured_js", Stream, from(arm), Never;
    /// Motor position \[rad\]; effort is the motor torque from the current, joint side \[Nm\],
    /// at the middle of the time that it was held for.
    FOLLOWER_MOTOR_JS: JointSample = "/follower/motor_js", Stream, from(arm), Never;
    /// Mean of joint 1's sensors \[degC\].
    FOLLOWER_JOINT_1_TEMPERATURE: TemperatureSample = "/follower/joint_1/temperature", Stream, from(arm), Never;
    /// Mean of joint 2's sensors \[degC\].
    FOLLOWER_JOINT_2_TEMPERATURE: TemperatureSample = "/follower/joint_2/temperature", Stream, from(arm), Never;
    /// Where the servo wants the joints at this moment.
    FOLLOWER_SETPOINT_JS: JointSample = "/follower/setpoint_js", Stream, from(servo), Never;
    /// Command to the servo: pose of the tip.
    FOLLOWER_SERVO_CP: PoseSample = "/follower/servo_cp", Stream, from(link_follower), Never;
    /// Command to the servo: joint positions.
    FOLLOWER_SERVO_JP: JointSample = "/follower/servo_jp", Stream, from(), ByScenario(ServoJp);
    /// Command to the drives: motor torques, joint side \[Nm\].
    FOLLOWER_SERVO_JF: JointSample = "/follower/servo_jf", Stream, from(servo), Never;
    /// Pose of the tip, from the link-side joint positions.
    FOLLOWER_MEASURED_CP: PoseSample = "/follower/measured_cp", Stream, from(estimator), Never;
    /// Estimated contact force on the tip, base frame \[N\].
    FOLLOWER_MEASURED_CF: WrenchSample = "/follower/measured_cf", Stream, from(estimator), Never;
    /// The same in the contact frame: x tangential, z normal \[N\].
    FOLLOWER_CONTACT_CF: WrenchSample = "/follower/contact_cf", Stream, from(estimator), Never;
    /// Contact on or off, which edge, friction coefficient.
    FOLLOWER_CONTACT_STATE: ContactStateSample = "/follower/contact_state", Stream, from(estimator), Never;
    /// CRTK state of the arm's servo.
    FOLLOWER_OPERATING_STATE: OperatingStateSample = "/follower/operating_state", State, from(servo), Never;
    /// CRTK command to the arm's servo.
    FOLLOWER_STATE_COMMAND: StateCommandSample = "/follower/state_command", Event, from(console link_follower command_line), Always;
    /// Command to the servo's friction feed-forward: take over what the twin found, or give it back.
    FOLLOWER_FRICTION_COMMAND: FrictionCommandSample = "/follower/friction_command", Event, from(gateway command_line), Always;
    /// The friction that the servo feeds forward at joint 1.
    FOLLOWER_JOINT_1_FRICTION: FrictionStatusSample = "/follower/joint_1/friction", State, from(servo), Never;
    /// The same at joint 2.
    FOLLOWER_JOINT_2_FRICTION: FrictionStatusSample = "/follower/joint_2/friction", State, from(servo), Never;
    /// The hand as the device measures it.
    LEADER_MEASURED_CP: PoseSample = "/leader/measured_cp", Stream, from(master console), ByScenario(CrtkHand);
    /// The hand as accepted: valid, in range, from the source that holds the authority.
    LEADER_SETPOINT_CP: PoseSample = "/leader/setpoint_cp", Stream, from(master), Never;
    /// The force that the delay law wants in the hand \[N\], before any limit.
    LEADER_REFLECTED_CF: WrenchSample = "/leader/reflected_cf", Stream, from(link_leader), Never;
    /// The force rendered to the hand \[N\].
    LEADER_SERVO_CF: WrenchSample = "/leader/servo_cf", Stream, from(master), Never;
    /// Who holds the authority over the arm.
    LEADER_AUTHORITY: AuthoritySample = "/leader/authority", State, from(master), Never;
    /// CRTK state of the master.
    LEADER_OPERATING_STATE: OperatingStateSample = "/leader/operating_state", State, from(master), Never;
    /// CRTK command to the master.
    LEADER_STATE_COMMAND: StateCommandSample = "/leader/state_command", Event, from(console command_line), Always;
    /// The link as the operator's end measures it.
    LINK_STATUS: LinkStatusSample = "/link/status", Stream, from(link_leader), Never;
    /// The link as the arm's end measures it.
    LINK_FOLLOWER_STATUS: LinkStatusSample = "/link/follower_status", Stream, from(link_follower), Never;
    /// Command to the link: another delay law.
    LINK_LAW_COMMAND: LawCommandSample = "/link/law_command", Event, from(console gateway command_line), Always;
    /// What the emulated channel is to do.
    LINK_COMMAND: LinkCommandSample = "/link/command", State, from(console), Always;
    /// What the recorder is to do; marks.
    RECORDER_COMMAND: RecorderCommandSample = "/recorder/command", Event, from(console), Always;
    /// What the recorder does.
    RECORDER_STATUS: RecorderStatusSample = "/recorder/status", State, from(recorder), Never;
    /// The motor torque that the twin's model predicts, at the stamp of the samples that it is about;
    /// of the joint that it follows, the other is zero \[Nm\].
    TWIN_MOTOR_JS: JointSample = "/twin/motor_js", Stream, from(twin), Never;
    /// Measured less predicted motor torque, where the joint slides \[Nm\].
    TWIN_RESIDUAL_JS: JointSample = "/twin/residual_js", Stream, from(twin), Never;
    /// The twin's parameters as they are now, and whether its model holds.
    TWIN_PARAMETERS: TwinParametersSample = "/twin/parameters", State, from(twin), Never;
    /// Where the arm's frames are, from the link-side joint positions.
    TF: TransformsSample = "/tf", Stream, from(estimator), Never;
    /// The arm as URDF.
    ROBOT_DESCRIPTION: RobotDescriptionSample = "/robot_description", State, from(arm), Never;
    /// Rate, age and faults of every node.
    DIAGNOSTICS: HealthSample = "/diagnostics", Event, from(every), Never;
}
