//! Every sample there is.

use super::{
    AuthoritySample, CommandStatusSample, ContactStateSample, ControllerCommandSample,
    FrictionCommandSample, FrictionStatusSample, HealthSample, JointSample, LawCommandSample,
    LinkCommandSample, LinkPeerSample, LinkStatusSample, OperatingStateSample, PoseSample,
    RecorderCommandSample, RecorderStatusSample, RobotDescriptionSample, RobotJointsSample,
    StateCommandSample, TemperatureSample, TransformsSample, TwinParametersSample, WrenchSample,
};
use crate::Message;

/// Something to be done with every sample, on whatever topic it stands.
pub trait SampleVisitor {
    /// Called once a sample.
    fn sample<M: Message>(&mut self);
}

macro_rules! visit {
    ($visitor:ident: $($sample:ty),* $(,)?) => { $($visitor.sample::<$sample>();)* };
}

/// Calls `visitor` for every sample that a topic can carry: those of the table of topics, and
/// those that other people's robots speak.
pub fn visit(visitor: &mut impl SampleVisitor) {
    visit!(visitor:
        AuthoritySample,
        CommandStatusSample,
        ContactStateSample,
        ControllerCommandSample,
        FrictionCommandSample,
        FrictionStatusSample,
        HealthSample,
        JointSample,
        LawCommandSample,
        LinkCommandSample,
        LinkPeerSample,
        LinkStatusSample,
        OperatingStateSample,
        PoseSample,
        RecorderCommandSample,
        RecorderStatusSample,
        RobotDescriptionSample,
        RobotJointsSample,
        StateCommandSample,
        TemperatureSample,
        TransformsSample,
        TwinParametersSample,
        WrenchSample,
    );
}
