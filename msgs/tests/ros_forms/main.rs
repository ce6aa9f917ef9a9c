//! The Rust structs of [`ferntast_msgs::ros`] against the `.msg` files: same
//! fields, same order, same types. CDR carries no names, so a swapped pair
//! would go unnoticed otherwise.

mod tracer;

use ferntast_msgs::{
    Message, RosMessage,
    interface::{self, Base, Count, Library, Primitive, Type},
    ros::{
        builtin_interfaces, crtk_msgs, diagnostic_msgs, geometry_msgs, sensor_msgs, std_msgs,
        tf2_msgs,
    },
    sample::JointNames,
    topics::{self, Topic, Visitor},
};

use tracer::{Shape, shape};

/// The shape that a definition asks for.
fn asked(library: &Library, name: &str) -> Shape {
    let definition = library.definition(name).expect("built in");
    Shape::Struct(
        definition
            .fields
            .iter()
            .map(|field| (field.name.clone(), asked_field(library, &field.kind)))
            .collect(),
    )
}

fn asked_field(library: &Library, kind: &Type) -> Shape {
    let element = match &kind.base {
        Base::Interface(name) => asked(library, name),
        Base::String(None) => Shape::Leaf("string"),
        // One byte each on the wire.
        Base::Primitive(Primitive::Byte | Primitive::Char) => Shape::Leaf("uint8"),
        Base::Primitive(primitive) => Shape::Leaf(primitive.name()),
        other => panic!("no interface of ours has a {other}"),
    };
    match kind.count {
        Count::One => element,
        Count::Any => Shape::Sequence(Box::new(element)),
        other => panic!("no interface of ours has a {other:?}"),
    }
}

fn compare<M: RosMessage>(library: &Library, seen: &mut Vec<&'static str>) {
    let name = M::INTERFACE;
    assert_eq!(shape::<M>(), asked(library, name), "{name}");
    seen.push(name);
}

/// Compares the messages of the table, among them all of ferntast's own.
struct Own<'a>(&'a Library, Vec<&'static str>);

impl Visitor for Own<'_> {
    fn topic<M: Message>(&mut self, _: Topic<M>) {
        compare::<M::Ros>(self.0, &mut self.1);
    }
}

#[test]
fn every_struct_has_the_fields_of_its_definition() {
    let library = interface::library().unwrap();
    let mut seen = Vec::new();
    macro_rules! compare {
        ($($message:ty),* $(,)?) => {
            $(compare::<$message>(&library, &mut seen);)*
        };
    }
    compare!(
        builtin_interfaces::Time,
        std_msgs::Header,
        std_msgs::String,
        std_msgs::MultiArrayDimension,
        std_msgs::MultiArrayLayout,
        std_msgs::Float64MultiArray,
        sensor_msgs::JointState,
        sensor_msgs::Temperature,
        geometry_msgs::Point,
        geometry_msgs::Quaternion,
        geometry_msgs::Vector3,
        geometry_msgs::Pose,
        geometry_msgs::PoseStamped,
        geometry_msgs::Wrench,
        geometry_msgs::WrenchStamped,
        geometry_msgs::Transform,
        geometry_msgs::TransformStamped,
        tf2_msgs::TFMessage,
        diagnostic_msgs::KeyValue,
        diagnostic_msgs::DiagnosticStatus,
        diagnostic_msgs::DiagnosticArray,
        crtk_msgs::OperatingState,
        crtk_msgs::StringStamped,
    );
    let mut own = Own(&library, Vec::new());
    topics::visit(&JointNames::numbered(1), &mut own).unwrap();
    seen.append(&mut own.1);
    seen.sort_unstable();
    seen.dedup();
    let mut names: Vec<_> = interface::names().collect();
    names.sort_unstable();
    assert_eq!(seen, names);
}

#[test]
fn a_swapped_pair_is_noticed() {
    let mut library = interface::library().unwrap();
    let name = "geometry_msgs/msg/Wrench";
    library
        .insert(name, "Vector3 torque\nVector3 force")
        .unwrap();
    assert_ne!(shape::<geometry_msgs::Wrench>(), asked(&library, name));
}

#[test]
fn the_defaults_are_those_of_the_definition() {
    let orientation = geometry_msgs::PoseStamped::default().pose.orientation;
    assert_eq!(<[f64; 4]>::from(&orientation), [0.0, 0.0, 0.0, 1.0]);
}
