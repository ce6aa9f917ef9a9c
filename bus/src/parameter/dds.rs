//! The parameter over DDS.
//!
//! The services are our own: those of ros2-client 0.12.1 come with a task that also subscribes to
//! `/clock`, as a type that it is not, and to the discovery of nodes, by endpoints that belong to
//! no node, and they describe nothing.

use std::fmt;

use ros2_client::{
    Message, Name, Node, NodeName, NodeOptions, ParameterValue, Server, ServiceMapping,
    ServiceTypeName,
    parameters::raw,
    rcl_interfaces::{
        DescribeParametersRequest, DescribeParametersResponse, GetParameterTypesRequest,
        GetParameterTypesResponse, GetParametersRequest, GetParametersResponse,
        ListParametersRequest, ListParametersResponse, ListParametersResult,
        SetParametersAtomicallyResponse, SetParametersRequest, SetParametersResponse,
    },
};

use super::Choice;
use crate::{
    dds::{DdsBus, service_qos},
    error::OpenError,
};

/// The services of a node's parameters.
pub(crate) struct ParameterServices {
    /// The parameter that is a choice, beside those that every node has.
    choice: Option<Choice>,
    list: Server<ListParametersRequest, ListParametersResponse>,
    describe: Server<DescribeParametersRequest, DescribeParametersResponse>,
    get: Server<GetParametersRequest, GetParametersResponse>,
    types: Server<GetParameterTypesRequest, GetParameterTypesResponse>,
    set: Server<SetParametersRequest, SetParametersResponse>,
    set_all: Server<SetParametersRequest, SetParametersAtomicallyResponse>,
}

impl ParameterServices {
    /// Offers them for `node`.
    pub(crate) fn open(
        node: &mut Node,
        choice: Option<Choice>,
    ) -> Result<ParameterServices, OpenError> {
        Ok(ParameterServices {
            choice,
            list: serve(node, "list_parameters", "ListParameters")?,
            describe: serve(node, "describe_parameters", "DescribeParameters")?,
            get: serve(node, "get_parameters", "GetParameters")?,
            types: serve(node, "get_parameter_types", "GetParameterTypes")?,
            set: serve(node, "set_parameters", "SetParameters")?,
            set_all: serve(node, "set_parameters_atomically", "SetParametersAtomically")?,
        })
    }

    /// Answers who asked, and gives the last choice that was made.
    pub(crate) fn answer(&self, node: &Node) -> Option<String> {
        answer(&self.list, |asked| ListParametersResponse {
            result: list(node, &asked),
        });
        answer(&self.describe, |asked| DescribeParametersResponse {
            values: each(&asked.names, |name| self.descriptor(node, name)),
        });
        answer(&self.get, |asked| GetParametersResponse {
            values: each(&asked.names, |name| value(node, name)),
        });
        answer(&self.types, |asked| GetParameterTypesResponse {
            values: each(&asked.names, |name| value(node, name).ptype),
        });
        let mut wish = None;
        answer(&self.set, |asked| SetParametersResponse {
            results: each(&asked.parameter, |own| {
                result(self.set(node, std::slice::from_ref(own), &mut wish))
            }),
        });
        answer(&self.set_all, |asked| SetParametersAtomicallyResponse {
            result: result(self.set(node, &asked.parameter, &mut wish)),
        });
        wish
    }

    /// The choice, if that is its name.
    fn choice(&self, name: &str) -> Option<&Choice> {
        self.choice.as_ref().filter(|own| own.name == name)
    }

    fn descriptor(&self, node: &Node, name: &str) -> raw::ParameterDescriptor {
        let choice = self.choice(name);
        raw::ParameterDescriptor {
            name: name.to_owned(),
            r#type: value(node, name).ptype,
            description: choice.map_or_else(String::new, |own| own.description.clone()),
            additional_constraints: choice.map_or_else(String::new, Choice::constraint),
            read_only: false,
            dynamic_typing: false,
            floating_point_range: Vec::new(),
            integer_range: Vec::new(),
        }
    }

    /// Sets all of `parameters` or none; a choice that is made is a wish.
    fn set(
        &self,
        node: &Node,
        parameters: &[raw::Parameter],
        wish: &mut Option<String>,
    ) -> Result<(), String> {
        for own in parameters {
            if let Some(choice) = self.choice(&own.name) {
                choice.check(text(&own.value))?;
                choice.check_open()?;
            } else if node.get_parameter(&own.name).is_none() {
                let has = node.list_parameters().join(", ");
                return Err(format!("no parameter {}; there are {has}", own.name));
            }
        }
        for own in parameters {
            if self.choice(&own.name).is_some() {
                *wish = text(&own.value).map(str::to_owned);
            }
            node.set_parameter(&own.name, ParameterValue::from(own.value.clone()))?;
        }
        Ok(())
    }
}

fn serve<Q, A>(node: &mut Node, name: &str, kind: &str) -> Result<Server<Q, A>, OpenError>
where
    Q: Message + Clone + 'static,
    A: Message + 'static,
{
    let of_node = node.fully_qualified_name();
    let failed = |reason: String| OpenError::Middleware {
        transport: "DDS",
        reason: format!("service {of_node}/{name}: {reason}"),
    };
    let service = Name::new(&of_node, name).map_err(|error| failed(format!("{error:?}")))?;
    let qos = service_qos();
    node.create_server(
        ServiceMapping::Enhanced,
        &service,
        &ServiceTypeName::new("rcl_interfaces", kind),
        qos.clone(),
        qos,
    )
    .map_err(|error| failed(error.to_string()))
}

/// Answers all calls that wait; an answer that cannot be sent is lost, as on a network.
fn answer<Q, A>(server: &Server<Q, A>, mut of: impl FnMut(Q) -> A)
where
    Q: Message + Clone + 'static,
    A: Message + 'static,
{
    while let Ok(Some((call, request))) = server.receive_request() {
        let _ = server.send_response(call, of(request));
    }
}

fn each<T, A>(all: &[T], of: impl FnMut(&T) -> A) -> Vec<A> {
    all.iter().map(of).collect()
}

fn list(node: &Node, asked: &ListParametersRequest) -> ListParametersResult {
    let mut names = node.list_parameters();
    names.retain(|name| asked.prefixes.is_empty() || asked.prefixes.contains(name));
    ListParametersResult {
        names,
        prefixes: Vec::new(),
    }
}

fn value(node: &Node, name: &str) -> raw::ParameterValue {
    let value = node.get_parameter(name).unwrap_or(ParameterValue::NotSet);
    raw::ParameterValue::from(value)
}

fn text(value: &raw::ParameterValue) -> Option<&str> {
    (value.ptype == raw::ParameterType::STRING).then_some(value.string_value.as_str())
}

fn result(set: Result<(), String>) -> raw::SetParametersResult {
    raw::SetParametersResult {
        successful: set.is_ok(),
        reason: set.err().unwrap_or_default(),
    }
}

/// A node with one parameter that is a choice.
pub(super) struct DdsParameter {
    name: String,
    node: Node,
    services: ParameterServices,
}

pub(super) fn open(bus: &DdsBus, choice: &Choice) -> Result<DdsParameter, OpenError> {
    let name = NodeName::new(bus.node().namespace(), &choice.node).map_err(|error| {
        OpenError::BadName {
            what: "node",
            name: choice.node.clone(),
            reason: format!("{error:?}"),
        }
    })?;
    let options = NodeOptions::new()
        .enable_rosout(false)
        .declare_parameter(&choice.name, ParameterValue::String(choice.value.clone()));
    let node = bus.context().new_node(name, options);
    let mut node = node.map_err(|error| OpenError::Middleware {
        transport: "DDS",
        reason: format!("parameters of node {}: {error}", choice.node),
    })?;
    Ok(DdsParameter {
        name: choice.name.clone(),
        services: ParameterServices::open(&mut node, Some(choice.clone()))?,
        node,
    })
}

impl DdsParameter {
    pub(super) fn tell(&mut self, value: &str) -> Result<(), String> {
        let value = ParameterValue::String(value.to_owned());
        self.node.set_parameter(&self.name, value)
    }

    /// Answers who asked, and gives the last choice that was made.
    pub(super) fn wish(&mut self) -> Option<String> {
        self.services.answer(&self.node)
    }
}

impl fmt::Debug for DdsParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DdsParameter")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}
