//! A topic as an iceoryx2 service.

use std::{thread, time::Duration};

use ferntast_msgs::{
    Message,
    topics::{Delivery, Topic},
};
use iceoryx2::{
    prelude::{MessagingPattern, ServiceName},
    service::{
        Service as _,
        builder::publish_subscribe::{
            PublishSubscribeCreateError as Create, PublishSubscribeOpenError as Open,
            PublishSubscribeOpenOrCreateError as OpenOrCreate,
        },
        port_factory::publish_subscribe::PortFactory,
        static_config::messaging_pattern::MessagingPattern as StaticPattern,
    },
};

use super::{
    MAX_PROCESSES, MAX_PUBLISHERS, MAX_SUBSCRIBERS, Service, SharedMemoryBus, payload::Payload,
};
use crate::{error::CreateError, types::type_name};

pub(super) type Factory<M> = PortFactory<Service, Payload<M>, ()>;

/// How often and how long apart opening is tried again while another process
/// creates or removes the same service.
const TRIES: usize = 20;
const PAUSE: Duration = Duration::from_millis(20);

/// Opens the topic's service, or creates it.
pub(super) fn open<M: Message>(
    bus: &SharedMemoryBus,
    topic: Topic<M>,
    what: &'static str,
) -> Result<Factory<M>, CreateError> {
    let middleware = |reason: String| CreateError::Middleware {
        transport: "shared memory",
        topic: topic.name.into(),
        what,
        reason,
    };
    let name = ServiceName::new(&topic.name).map_err(|error| middleware(format!("{error:?}")))?;
    let mut tries = 0;
    loop {
        tries += 1;
        let result = bus
            .node
            .service_builder(&name)
            .publish_subscribe::<Payload<M>>()
            .max_publishers(MAX_PUBLISHERS)
            .max_subscribers(MAX_SUBSCRIBERS)
            .max_nodes(MAX_PROCESSES)
            .subscriber_max_buffer_size(SharedMemoryBus::max_queue(topic.delivery))
            .subscriber_max_borrowed_samples(1)
            .history_size(history(topic.delivery))
            .enable_safe_overflow(true)
            .open_or_create();
        let error = match result {
            Ok(factory) => return Ok(factory),
            Err(error) => error,
        };
        if in_flux(&error) && tries < TRIES {
            thread::sleep(PAUSE);
            continue;
        }
        return Err(match error {
            OpenOrCreate::PublishSubscribeOpenError(Open::IncompatibleTypes) => {
                CreateError::WrongType {
                    topic: topic.name.into(),
                    wanted: type_name::<M>(),
                    found: carried(bus, &name),
                }
            }
            OpenOrCreate::PublishSubscribeOpenError(Open::InsufficientPermissions)
            | OpenOrCreate::PublishSubscribeCreateError(Create::InsufficientPermissions) => {
                CreateError::NoPermission {
                    topic: topic.name.into(),
                    reason: error.to_string(),
                }
            }
            OpenOrCreate::PublishSubscribeOpenError(Open::ExceedsMaxNumberOfNodes) => {
                CreateError::TooMany {
                    topic: topic.name.into(),
                    what: "process",
                    limit: MAX_PROCESSES,
                }
            }
            OpenOrCreate::PublishSubscribeCreateError(Create::ServiceConfigCouldNotBeCreated) => {
                CreateError::NoRoom {
                    topic: topic.name.into(),
                    reason: error.to_string(),
                }
            }
            _ => middleware(format!(
                "{error}; `ferntast doctor` shows and removes what a dead session left"
            )),
        });
    }
}

/// How many messages a late joiner gets.
pub(super) fn history(delivery: Delivery) -> usize {
    match delivery {
        Delivery::State => 1,
        Delivery::Stream | Delivery::Event => 0,
    }
}

/// Whether another process is just creating or removing the service.
fn in_flux(error: &OpenOrCreate) -> bool {
    matches!(
        error,
        OpenOrCreate::SystemInFlux
            | OpenOrCreate::PublishSubscribeOpenError(
                Open::DoesNotExist
                    | Open::IsMarkedForDestruction
                    | Open::HangsInCreation
                    | Open::ServiceInCorruptedState
                    | Open::Interrupt
            )
            | OpenOrCreate::PublishSubscribeCreateError(
                Create::AlreadyExists
                    | Create::IsBeingCreatedByAnotherInstance
                    | Create::HangsInCreation
                    | Create::ServiceInCorruptedState
                    | Create::Interrupt
            )
    )
}

/// The sample type that the service carries, for people.
fn carried(bus: &SharedMemoryBus, name: &ServiceName) -> String {
    let details = Service::details(name, bus.node.config(), MessagingPattern::PublishSubscribe);
    match details.map(|details| details.map(|details| details.static_details)) {
        Ok(Some(details)) => match details.messaging_pattern() {
            StaticPattern::PublishSubscribe(pattern) => {
                let payload = pattern.message_type_details().payload;
                let path = payload.type_name().to_string();
                let sample = path.rsplit("::").next().unwrap_or(&path).to_string();
                format!("{sample} ({} bytes in shared memory)", payload.size())
            }
            other => format!("{other:?}"),
        },
        _ => "another type".into(),
    }
}
