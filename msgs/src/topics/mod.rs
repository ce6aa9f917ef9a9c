//! The table of topics: name, sample, how it is sent, who in the session
//! publishes it, and whether peers on ROS 2 may. Gateway, recorder, player and
//! replay take theirs from here.
//!
//! A row is a [`Topic`], or a [`JointTopic`]: one topic of each joint, under
//! the joint's name.

mod joint_topic;
mod name;
mod topic;

pub use joint_topic::{JointNameError, JointTopic};
pub use name::{MAX_TOPIC_NAME, TopicName, TopicNameError};
pub use topic::{Authority, COMMANDS_SETTING, Delivery, EVENT_QUEUE, Row, Switch, Topic};

use crate::{
    Message,
    sample::{
        AuthoritySample, CommandStatusSample, ContactStateSample, ControllerCommandSample,
        FrictionCommandSample, FrictionStatusSample, HealthSample, JointNames, JointSample,
        LawCommandSample, LinkCommandSample, LinkPeerSample, LinkStatusSample,
        OperatingStateSample, PoseSample, RecorderCommandSample, RecorderStatusSample,
        RobotDescriptionSample, RobotJointsSample, StateCommandSample, TemperatureSample,
        TransformsSample, TwinParametersSample, WrenchSample,
    },
};

/// Something to be done with every topic, whatever its type: to list,
/// record, play or bridge them all.
pub trait Visitor {
    /// Called once a topic, in the order of the table.
    fn topic<M: Message>(&mut self, topic: Topic<M>);
}

/// Something to be done with every sample that a topic can carry.
pub trait SampleVisitor {
    /// Called once a row of the table, so more than once for most samples.
    fn sample<M: Message>(&mut self);
}

macro_rules! topics {
    (
        elsewhere($($other:ty),*);
        $(
            $(#[$doc:meta])*
            $constant:ident: $kind:ident<$sample:ty> = $name:literal, $delivery:ident, from($($publisher:ident)*), $authority:ident $(($switch:ident))?;
        )*
    ) => {
        $($(#[$doc])* pub const $constant: $kind<$sample> = $kind::of_table(
            $name,
            Delivery::$delivery,
            &[$(stringify!($publisher)),*],
            Authority::$authority $((Switch::$switch))?,
        );)*

        /// Calls `visitor` for every topic of the table: for one of each joint
        /// as often as there are `joints`, in their order.
        ///
        /// # Errors
        ///
        /// A joint's name that cannot be part of a topic's.
        pub fn visit(
            joints: &JointNames,
            visitor: &mut impl Visitor,
        ) -> Result<(), JointNameError> {
            $(for topic in $constant.of_joints(joints)? {
                visitor.topic(topic);
            })*
            Ok(())
        }

        /// Calls `visitor` for the sample of every row, and for those of topics that only
        /// other people's robots have.
        pub fn visit_samples(visitor: &mut impl SampleVisitor) {
            $(visitor.sample::<$sample>();)*
            $(visitor.sample::<$other>();)*
        }
    };
}

topics! {
    elsewhere(RobotJointsSample, ControllerCommandSample);
    /// Motor position on the joint side \[rad\], velocity \[rad/s\], joint torque sensor \[Nm\].
    FOLLOWER_MEASURED_JS: Topic<JointSample> = "/follower/measured_js", Stream, from(arm), Never;
    /// Motor position \[rad\]; effort is the motor torque from the current, joint side \[Nm\],
    /// at the middle of the time that it was held for.
    FOLLOWER_MOTOR_JS: Topic<JointSample> = "/follower/motor_js", Stream, from(arm), Never;
    /// Mean of the joint's sensors \[degC\].
    FOLLOWER_JOINT_TEMPERATURE: JointTopic<TemperatureSample> = "/follower/{joint}/temperature", Stream, from(arm), Never;
    /// Where the servo wants the joints at this moment.
    FOLLOWER_SETPOINT_JS: Topic<JointSample> = "/follower/setpoint_js", Stream, from(servo), Never;
    /// Command to the servo: pose of the tip.
    FOLLOWER_SERVO_CP: Topic<PoseSample> = "/follower/servo_cp", Stream, from(link_follower), Never;
    /// Command to the servo: joint positions.
    FOLLOWER_SERVO_JP: Topic<JointSample> = "/follower/servo_jp", Stream, from(), ByScenario(ServoJp);
    /// Command to the drives: motor torques, joint side \[Nm\].
    FOLLOWER_SERVO_JF: Topic<JointSample> = "/follower/servo_jf", Stream, from(servo), Never;
    /// Pose of the tip, from the link-side joint positions.
    FOLLOWER_MEASURED_CP: Topic<PoseSample> = "/follower/measured_cp", Stream, from(estimator), Never;
    /// Estimated contact force on the tip, base frame \[N\].
    FOLLOWER_MEASURED_CF: Topic<WrenchSample> = "/follower/measured_cf", Stream, from(estimator), Never;
    /// The same in the contact frame: x tangential, z normal \[N\].
    FOLLOWER_CONTACT_CF: Topic<WrenchSample> = "/follower/contact_cf", Stream, from(estimator), Never;
    /// Contact on or off, which edge, friction coefficient.
    FOLLOWER_CONTACT_STATE: Topic<ContactStateSample> = "/follower/contact_state", Stream, from(estimator), Never;
    /// CRTK state of the arm's servo.
    FOLLOWER_OPERATING_STATE: Topic<OperatingStateSample> = "/follower/operating_state", State, from(servo), Never;
    /// What the servo makes of servo_cp and servo_jp.
    FOLLOWER_COMMAND_STATUS: Topic<CommandStatusSample> = "/follower/command_status", State, from(servo), Never;
    /// CRTK command to the arm's servo.
    FOLLOWER_STATE_COMMAND: Topic<StateCommandSample> = "/follower/state_command", Event, from(console link_follower command_line), Commands;
    /// Command to the servo's friction feed-forward: take over what the twin found, or give it back.
    FOLLOWER_FRICTION_COMMAND: Topic<FrictionCommandSample> = "/follower/friction_command", Event, from(gateway command_line), Commands;
    /// The friction that the servo feeds forward at the joint.
    FOLLOWER_JOINT_FRICTION: JointTopic<FrictionStatusSample> = "/follower/{joint}/friction", State, from(servo), Never;
    /// The hand as the device measures it.
    LEADER_MEASURED_CP: Topic<PoseSample> = "/leader/measured_cp", Stream, from(master console haply leader), ByScenario(CrtkHand);
    /// The hand as accepted: valid, in range, from the source that holds the authority.
    LEADER_SETPOINT_CP: Topic<PoseSample> = "/leader/setpoint_cp", Stream, from(master), Never;
    /// The force that the delay law wants in the hand \[N\], before any limit.
    LEADER_REFLECTED_CF: Topic<WrenchSample> = "/leader/reflected_cf", Stream, from(link_leader), Never;
    /// The force rendered to the hand \[N\].
    LEADER_SERVO_CF: Topic<WrenchSample> = "/leader/servo_cf", Stream, from(master), Never;
    /// Who holds the authority over the arm.
    LEADER_AUTHORITY: Topic<AuthoritySample> = "/leader/authority", State, from(master), Never;
    /// CRTK state of the master.
    LEADER_OPERATING_STATE: Topic<OperatingStateSample> = "/leader/operating_state", State, from(master), Never;
    /// CRTK command to the master.
    LEADER_STATE_COMMAND: Topic<StateCommandSample> = "/leader/state_command", Event, from(console command_line), Commands;
    /// The link as the operator's end measures it.
    LINK_STATUS: Topic<LinkStatusSample> = "/link/status", Stream, from(link_leader), Never;
    /// The link as the arm's end measures it.
    LINK_FOLLOWER_STATUS: Topic<LinkStatusSample> = "/link/follower_status", Stream, from(link_follower), Never;
    /// Whom the operator's end talks to, and that one's clock.
    LINK_PEER: Topic<LinkPeerSample> = "/link/peer", State, from(link_leader), Never;
    /// CRTK state of the arm's servo, as the arm's end said it over the link.
    LINK_ARM_STATE: Topic<OperatingStateSample> = "/link/arm_state", State, from(link_leader), Never;
    /// Joint positions of the arm, as the arm's end shows them over the link where the ends are on
    /// two hosts; by this host's clock, as far as it knows the other's \[rad\].
    LINK_ARM_MEASURED_JS: Topic<JointSample> = "/link/arm_measured_js", Stream, from(link_leader), Never;
    /// The same of the tip's position.
    LINK_ARM_MEASURED_CP: Topic<PoseSample> = "/link/arm_measured_cp", Stream, from(link_leader), Never;
    /// The same of the contact force on the tip, base frame \[N\].
    LINK_ARM_MEASURED_CF: Topic<WrenchSample> = "/link/arm_measured_cf", Stream, from(link_leader), Never;
    /// The same of the contact, without the friction coefficient.
    LINK_ARM_CONTACT_STATE: Topic<ContactStateSample> = "/link/arm_contact_state", Stream, from(link_leader), Never;
    /// Whom the arm's end talks to, and that one's clock.
    LINK_FOLLOWER_PEER: Topic<LinkPeerSample> = "/link/follower_peer", State, from(link_follower), Never;
    /// Command to the link: another delay law.
    LINK_LAW_COMMAND: Topic<LawCommandSample> = "/link/law_command", Event, from(console gateway command_line), Commands;
    /// What the emulated channel is to do.
    LINK_COMMAND: Topic<LinkCommandSample> = "/link/command", State, from(console), Commands;
    /// What the recorder is to do; marks.
    RECORDER_COMMAND: Topic<RecorderCommandSample> = "/recorder/command", Event, from(console), Commands;
    /// What the recorder does.
    RECORDER_STATUS: Topic<RecorderStatusSample> = "/recorder/status", State, from(recorder), Never;
    /// The motor torque that the twins' models predict, at the stamp of the samples that it is about;
    /// of the joints that have a twin, the others are zero \[Nm\].
    TWIN_MOTOR_JS: Topic<JointSample> = "/twin/motor_js", Stream, from(twin), Never;
    /// Measured less predicted motor torque, zero where a joint does not slide \[Nm\].
    TWIN_RESIDUAL_JS: Topic<JointSample> = "/twin/residual_js", Stream, from(twin), Never;
    /// A twin's parameters as they are now, and whether its model holds; each joint's in turn.
    TWIN_PARAMETERS: Topic<TwinParametersSample> = "/twin/parameters", State, from(twin), Never;
    /// Where the arm's frames are, from the link-side joint positions.
    TF: Topic<TransformsSample> = "/tf", Stream, from(estimator), Never;
    /// The arm as URDF.
    ROBOT_DESCRIPTION: Topic<RobotDescriptionSample> = "/robot_description", State, from(arm), Never;
    /// Rate, age and faults of every node.
    DIAGNOSTICS: Topic<HealthSample> = "/diagnostics", Event, from(every), Never;
}
