//! The parameter over Zenoh.

use std::{
    fmt,
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread::{self, ThreadId},
};

use hiroz::{
    Builder,
    node::ZNode,
    parameter::{
        Parameter, ParameterDescriptor, ParameterType, ParameterValue, SetParametersResult,
    },
};

use super::Choice;
use crate::{error::OpenError, zenoh_ros::ZenohBus};

/// Wishes that may wait; past that, further ones are refused.
const WAITING: usize = 16;

/// A node that answers the parameter services, in threads of hiroz.
pub(super) struct ZenohParameter {
    name: String,
    node: ZNode,
    wishes: Receiver<String>,
}

/// Says whether a new value is taken, and passes it on as a wish.
struct Judge {
    choice: Choice,
    /// What this thread sets is the truth, not a wish.
    teller: ThreadId,
    wish: SyncSender<String>,
}

impl Judge {
    /// Whether the choice may be set so; other parameters are the library's own.
    fn check(&self, name: &str, value: Option<&str>) -> Result<(), String> {
        match name == self.choice.name {
            true => self.choice.check(value),
            false => Ok(()),
        }
    }

    /// Takes what [`Judge::check`] found good.
    fn take(&self, name: &str, value: Option<&str>) -> Result<(), String> {
        let Some(value) = value.filter(|_| name == self.choice.name) else {
            return Ok(());
        };
        if thread::current().id() == self.teller {
            return Ok(());
        }
        self.choice.check_open()?;
        self.wish
            .try_send(value.to_owned())
            .map_err(|_| "busy with earlier wishes; try again".to_owned())
    }
}

pub(super) fn open(bus: &ZenohBus, choice: &Choice) -> Result<ZenohParameter, OpenError> {
    let (wish, wishes) = sync_channel(WAITING);
    let judge = Judge {
        choice: choice.clone(),
        teller: thread::current().id(),
        wish,
    };
    let middleware = |reason: String| OpenError::Middleware {
        transport: "Zenoh",
        reason: format!("parameters of node {}: {reason}", choice.node),
    };
    let node = bus
        .context()
        .create_node(&choice.node)
        .with_namespace(bus.namespace())
        .build()
        .map_err(|error| middleware(error.to_string()))?;
    let descriptor = ParameterDescriptor {
        description: choice.description.clone(),
        additional_constraints: choice.constraint(),
        ..ParameterDescriptor::new(&choice.name, ParameterType::String)
    };
    node.declare_parameter(
        &choice.name,
        ParameterValue::String(choice.value.clone()),
        descriptor,
    )
    .map_err(middleware)?;
    node.on_set_parameters(move |parameters| {
        let each = |parameter: &Parameter, act: fn(&Judge, &str, Option<&str>) -> _| {
            act(&judge, &parameter.name, text(&parameter.value))
        };
        // All or nothing.
        let checked = parameters
            .iter()
            .try_for_each(|own| each(own, Judge::check));
        match checked.and_then(|()| parameters.iter().try_for_each(|own| each(own, Judge::take))) {
            Ok(()) => SetParametersResult::success(),
            Err(reason) => SetParametersResult::failure(reason),
        }
    });
    Ok(ZenohParameter {
        name: choice.name.clone(),
        node,
        wishes,
    })
}

fn text(value: &ParameterValue) -> Option<&str> {
    match value {
        ParameterValue::String(text) => Some(text),
        _ => None,
    }
}

impl ZenohParameter {
    /// The last wish since the last call.
    pub(super) fn wish(&mut self) -> Option<String> {
        self.wishes.try_iter().last()
    }

    pub(super) fn tell(&mut self, value: &str) -> Result<(), String> {
        let value = ParameterValue::String(value.to_owned());
        self.node.set_parameter(Parameter::new(&self.name, value))
    }
}

impl fmt::Debug for ZenohParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ZenohParameter")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}
