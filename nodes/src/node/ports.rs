//! How a node's input and output meet the topics of a bus.

use ferntast_bus::SubscriberCounts;
use ferntast_msgs::{
    Time,
    sample::JointNames,
    topics::{JointNameError, TopicName},
};

use super::Node;

/// The ports of a node: reads its input from a bus, writes its output to it.
pub trait Ports {
    /// The node that they belong to.
    type Node: Node;

    /// Topics that it takes of an arm of those joints.
    ///
    /// # Errors
    ///
    /// A joint's name that cannot be part of a topic's.
    fn inputs(joints: &JointNames) -> Result<Vec<TopicName>, JointNameError>;

    /// Topics that it publishes, beside `/diagnostics`.
    ///
    /// # Errors
    ///
    /// As [`Ports::inputs`].
    fn outputs(joints: &JointNames) -> Result<Vec<TopicName>, JointNameError>;

    /// Fills `input` with what is visible at `now`.
    fn read(&mut self, now: Time, input: &mut <Self::Node as Node>::Input);

    /// Publishes `output`; gives the number of messages that could not be sent.
    fn write(&mut self, now: Time, output: &<Self::Node as Node>::Output) -> u64;

    /// Tells `each` the topic of every input and what became of its messages.
    fn counts(&self, each: &mut dyn FnMut(&TopicName, &SubscriberCounts));
}

/// Declares a node's port table: the structs of its input and output, and
/// [`Ports`] that connect them to the topics of a bus.
///
/// An input is `Newest<Sample>` (the newest message, kept) or `Batch<Sample>`
/// (every message since the last step), an output a sample. Where there is a
/// topic of each joint it is `PerJoint<Newest<Sample>>` and `PerJoint<Sample>`.
/// `extra` fields are no topics; ports of the node's own fill them.
#[macro_export]
macro_rules! ports {
    (
        $(#[$doc:meta])*
        $ports:ident for $node:ty;
        $(#[$input_doc:meta])*
        input $input:ident { $($in_field:ident: $kind:ident<$in_sample:ty> = $in_topic:ident,)* }
        $(extra { $($in_extra:ident: $in_extra_type:ty,)* })?
        $(#[$output_doc:meta])*
        output $output:ident { $($out_field:ident: $out_sample:ty = $out_topic:ident,)* }
        $(extra { $($out_extra:ident: $out_extra_type:ty,)* })?
    ) => {
        $(#[$input_doc])*
        #[derive(Debug, Default)]
        pub struct $input {
            $(#[doc = concat!("Input, topic `", stringify!($in_topic), "`.")]
            pub $in_field: $crate::node::$kind<$in_sample>,)*
            $($(
                #[doc = "Input that is no topic."]
                pub $in_extra: $in_extra_type,
            )*)?
        }

        $(#[$output_doc])*
        #[derive(Debug, Default)]
        pub struct $output {
            $(#[doc = concat!("Output, topic `", stringify!($out_topic), "`.")]
            pub $out_field: <$out_sample as $crate::node::Outgoing>::Field,)*
            $($(
                #[doc = "Output that is no topic."]
                pub $out_extra: $out_extra_type,
            )*)?
            /// How the node is doing.
            pub health: $crate::node::NodeHealth,
        }

        impl $crate::node::Output for $output {
            fn health(&mut self) -> &mut $crate::node::NodeHealth {
                &mut self.health
            }

            fn clear(&mut self) {
                $(<$out_sample as $crate::node::Outgoing>::clear(&mut self.$out_field);)*
                $($(self.$out_extra = Default::default();)*)?
                self.health = $crate::node::NodeHealth::default();
            }
        }

        $(#[$doc])*
        pub struct $ports {
            $($in_field: <$crate::node::$kind<$in_sample> as $crate::node::Incoming>::Port,)*
            $($out_field: <$out_sample as $crate::node::Outgoing>::Port,)*
        }

        impl $ports {
            /// Connects the ports to the topics of `bus`, for an arm of those joints.
            ///
            /// # Errors
            ///
            /// A topic that cannot be opened.
            pub fn connect(
                bus: &ferntast_bus::Bus,
                joints: &ferntast_msgs::sample::JointNames,
            ) -> Result<Self, ferntast_bus::CreateError> {
                Ok($ports {
                    $($in_field: <$crate::node::$kind<$in_sample> as $crate::node::Incoming>::open(
                        bus, joints, ferntast_msgs::topics::$in_topic)?,)*
                    $($out_field: <$out_sample as $crate::node::Outgoing>::open(
                        bus, joints, ferntast_msgs::topics::$out_topic)?,)*
                })
            }
        }

        impl $crate::node::Ports for $ports {
            type Node = $node;

            fn inputs(
                joints: &ferntast_msgs::sample::JointNames,
            ) -> Result<Vec<ferntast_msgs::topics::TopicName>, ferntast_msgs::topics::JointNameError> {
                $crate::node::topic_names!(joints; $($in_topic)*)
            }

            fn outputs(
                joints: &ferntast_msgs::sample::JointNames,
            ) -> Result<Vec<ferntast_msgs::topics::TopicName>, ferntast_msgs::topics::JointNameError> {
                $crate::node::topic_names!(joints; $($out_topic)*)
            }

            fn read(&mut self, now: ferntast_msgs::Time, input: &mut $input) {
                $($crate::node::Incoming::fill(&mut input.$in_field, now, &mut self.$in_field);)*
                let _ = (now, input);
            }

            fn write(&mut self, now: ferntast_msgs::Time, output: &$output) -> u64 {
                let _ = (now, output);
                0 $(+ <$out_sample as $crate::node::Outgoing>::send(
                    &mut self.$out_field, now, &output.$out_field))*
            }

            fn counts(&self, each: &mut dyn FnMut(&ferntast_msgs::topics::TopicName, &ferntast_bus::SubscriberCounts)) {
                $(<$crate::node::$kind<$in_sample> as $crate::node::Incoming>::counts(
                    &self.$in_field, each);)*
                let _ = each;
            }
        }
    };
}

/// Names of the topics of these rows of the table, for an arm of those joints.
#[doc(hidden)]
#[macro_export]
macro_rules! topic_names {
    ($joints:ident; $($topic:ident)*) => {{
        let _ = $joints;
        let rows: Vec<Vec<ferntast_msgs::topics::TopicName>> = vec![$(
            ferntast_msgs::topics::$topic
                .of_joints($joints)?
                .iter()
                .map(|topic| topic.name)
                .collect(),
        )*];
        Ok(rows.concat())
    }};
}
