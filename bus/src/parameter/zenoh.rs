//! The parameter over Zenoh.

use std::fmt;

use hiroz::{
    Builder,
    node::ZNode,
    parameter::{
        Parameter, ParameterDescriptor, ParameterType, ParameterValue, SetParametersResult,
    },
};

use super::{Choice, Judge};
use crate::{error::OpenError, zenoh_ros::ZenohBus};

/// A node that answers the parameter services.
pub(super) struct ZenohParameter {
    name: String,
    node: ZNode,
}

pub(super) fn open(
    bus: &ZenohBus,
    choice: &Choice,
    judge: Judge,
) -> Result<ZenohParameter, OpenError> {
    let middleware = |reason: String| OpenError::Middleware {
        transport: "Zenoh",
        reason: format!("parameters of node {}: {reason}", choice.node),
    };
    let node = bus
        .context()
        .create_node(&choice.node)
        .build()
        .map_err(|error| middleware(error.to_string()))?;
    let descriptor = ParameterDescriptor {
        description: choice.description.clone(),
        additional_constraints: format!("one of: {}", choice.choices.join(", ")),
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
    })
}

fn text(value: &ParameterValue) -> Option<&str> {
    match value {
        ParameterValue::String(text) => Some(text),
        _ => None,
    }
}

impl ZenohParameter {
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
