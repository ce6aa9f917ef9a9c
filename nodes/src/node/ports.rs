//! How a node's input and output meet the topics of a bus.

use ferntast_bus::{Bus, CreateError, Depth, Publisher, Subscriber, SubscriberCounts};
use ferntast_msgs::{Message, Time, topics::Topic};

use super::{Batch, Newest, Node, input::BATCH};

/// The ports of a node: reads its input from a bus, writes its output to it.
pub trait Ports {
    /// The node that they belong to.
    type Node: Node;

    /// Topics that it takes.
    const INPUTS: &'static [&'static str];
    /// Topics that it publishes, beside `/diagnostics`.
    const OUTPUTS: &'static [&'static str];

    /// Fills `input` with what is visible at `now`.
    fn read(&mut self, now: Time, input: &mut <Self::Node as Node>::Input);

    /// Publishes `output`; gives the number of messages that could not be sent.
    fn write(&mut self, now: Time, output: &<Self::Node as Node>::Output) -> u64;

    /// Tells `each` the topic of every input and what became of its messages.
    fn inputs(&self, each: &mut dyn FnMut(&'static str, SubscriberCounts));
}

/// Something that fills a field of an input.
pub trait Receiver<Field> {
    /// Fills `field` with what is visible at `now`.
    fn fill(&mut self, now: Time, field: &mut Field);
}

impl<M: Message> Receiver<Newest<M>> for Subscriber<M> {
    fn fill(&mut self, now: Time, field: &mut Newest<M>) {
        field.fresh = false;
        if let Some(received) = self.newest(now) {
            *field = Newest {
                message: Some(received.message),
                received: received.received,
                fresh: true,
            };
        }
    }
}

impl<M: Message> Receiver<Batch<M>> for Subscriber<M> {
    fn fill(&mut self, now: Time, field: &mut Batch<M>) {
        field.clear();
        while !field.is_full() {
            match self.next(now) {
                Some(received) => field.push(received.message),
                None => break,
            }
        }
    }
}

/// A field of an input that knows how many messages it wants kept for it.
pub trait Field<M: Message> {
    /// How many.
    const DEPTH: Depth;
}

impl<M: Message> Field<M> for Newest<M> {
    const DEPTH: Depth = Depth::Newest;
}

impl<M: Message> Field<M> for Batch<M> {
    const DEPTH: Depth = Depth::Queue(BATCH * 4);
}

/// Opens the subscriber that fills a field of type `F`.
///
/// # Errors
///
/// As [`Bus::subscriber`].
pub fn receiver<M: Message, F: Field<M>>(
    bus: &Bus,
    topic: Topic<M>,
) -> Result<Subscriber<M>, CreateError> {
    bus.subscriber(topic, F::DEPTH)
}

/// Something that sends a field of an output.
pub trait Sender<M: Message> {
    /// Sends `field` if there is one; gives the number of failures (0 or 1).
    fn send(&mut self, now: Time, field: &Option<M>) -> u64;
}

impl<M: Message> Sender<M> for Publisher<M> {
    fn send(&mut self, now: Time, field: &Option<M>) -> u64 {
        match field {
            Some(message) => u64::from(self.publish(now, message).is_err()),
            None => 0,
        }
    }
}

/// Declares a node's port table: the structs of its input and output, and
/// [`Ports`] that connect them to the topics of a bus.
///
/// An input is `Newest<Sample>` (the newest message, kept) or `Batch<Sample>`
/// (every message since the last step). `extra` fields are no topics; ports of
/// the node's own fill them.
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
            pub $out_field: Option<$out_sample>,)*
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
                $(self.$out_field = None;)*
                $($(self.$out_extra = Default::default();)*)?
                self.health = $crate::node::NodeHealth::default();
            }
        }

        $(#[$doc])*
        pub struct $ports {
            $($in_field: ferntast_bus::Subscriber<$in_sample>,)*
            $($out_field: ferntast_bus::Publisher<$out_sample>,)*
        }

        impl $ports {
            /// Connects the ports to the topics of `bus`.
            ///
            /// # Errors
            ///
            /// A topic that cannot be opened.
            pub fn connect(bus: &ferntast_bus::Bus) -> Result<Self, ferntast_bus::CreateError> {
                Ok($ports {
                    $($in_field: $crate::node::receiver::<$in_sample, $crate::node::$kind<$in_sample>>(
                        bus, ferntast_msgs::topics::$in_topic)?,)*
                    $($out_field: bus.publisher(ferntast_msgs::topics::$out_topic)?,)*
                })
            }
        }

        impl $crate::node::Ports for $ports {
            type Node = $node;

            const INPUTS: &'static [&'static str] =
                &[$(ferntast_msgs::topics::$in_topic.name,)*];
            const OUTPUTS: &'static [&'static str] =
                &[$(ferntast_msgs::topics::$out_topic.name,)*];

            fn read(&mut self, now: ferntast_msgs::Time, input: &mut $input) {
                $($crate::node::Receiver::fill(&mut self.$in_field, now, &mut input.$in_field);)*
                let _ = (now, input);
            }

            fn write(&mut self, now: ferntast_msgs::Time, output: &$output) -> u64 {
                let _ = (now, output);
                0 $(+ $crate::node::Sender::send(&mut self.$out_field, now, &output.$out_field))*
            }

            fn inputs(&self, each: &mut dyn FnMut(&'static str, ferntast_bus::SubscriberCounts)) {
                $(each(ferntast_msgs::topics::$in_topic.name, self.$in_field.counts());)*
                let _ = each;
            }
        }
    };
}
