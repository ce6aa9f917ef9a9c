//! RIHS01: the hash by which ROS 2 tells whether two ends mean the same type.
//!
//! REP-2016: SHA-256 over the type description as JSON in one line, a space
//! after every comma and colon, without default values, constants and
//! comments; the types that it refers to follow, sorted by name.

use std::fmt::Write;

use sha2::{Digest, Sha256};

use super::{
    definition::Definition,
    kind::{Base, Count, Primitive, Type},
};

/// The field that an interface without fields has in the description, since
/// the languages that ROS 2 generates for know no empty structure.
const EMPTY_FIELD: &str = "structure_needs_at_least_one_member";

/// `RIHS01_` and the hash in hexadecimal, of `definition` with everything
/// that it refers to, directly and not.
pub(super) fn rihs01(definition: &Definition, referenced: &[&Definition]) -> String {
    let mut text = String::from("RIHS01_");
    for byte in Sha256::digest(description(definition, referenced)) {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

/// The JSON text that is hashed. Names are ASCII letters, digits, `_` and `/`
/// (the parser lets no others through), so nothing needs escaping.
fn description(definition: &Definition, referenced: &[&Definition]) -> String {
    let mut referenced = referenced.to_vec();
    referenced.sort_by(|a, b| a.name.cmp(&b.name));
    let referenced: Vec<String> = referenced.into_iter().map(individual).collect();
    format!(
        "{{\"type_description\": {}, \"referenced_type_descriptions\": [{}]}}",
        individual(definition),
        referenced.join(", ")
    )
}

/// The description of one type.
fn individual(definition: &Definition) -> String {
    let mut fields: Vec<String> = definition
        .fields
        .iter()
        .map(|each| field(&each.name, &each.kind))
        .collect();
    if fields.is_empty() {
        let kind = Type {
            base: Base::Primitive(Primitive::Uint8),
            count: Count::One,
        };
        fields.push(field(EMPTY_FIELD, &kind));
    }
    format!(
        "{{\"type_name\": \"{}\", \"fields\": [{}]}}",
        definition.name,
        fields.join(", ")
    )
}

fn field(name: &str, kind: &Type) -> String {
    let (id, string_capacity, nested) = match &kind.base {
        Base::Primitive(primitive) => (primitive_id(*primitive), 0, ""),
        Base::String(None) => (17, 0, ""),
        Base::WideString(None) => (18, 0, ""),
        Base::String(Some(bound)) => (21, *bound, ""),
        Base::WideString(Some(bound)) => (22, *bound, ""),
        Base::Interface(nested) => (1, 0, nested.as_str()),
    };
    let (offset, capacity) = match kind.count {
        Count::One => (0, 0),
        Count::Array(size) => (48, size),
        Count::AtMost(bound) => (96, bound),
        Count::Any => (144, 0),
    };
    format!(
        "{{\"name\": \"{name}\", \"type\": {{\"type_id\": {}, \"capacity\": {capacity}, \
         \"string_capacity\": {string_capacity}, \"nested_type_name\": \"{nested}\"}}}}",
        id + offset
    )
}

/// The constants `FIELD_TYPE_…` of `type_description_interfaces/msg/FieldType`.
fn primitive_id(primitive: Primitive) -> u8 {
    match primitive {
        Primitive::Int8 => 2,
        Primitive::Uint8 | Primitive::Char => 3,
        Primitive::Int16 => 4,
        Primitive::Uint16 => 5,
        Primitive::Int32 => 6,
        Primitive::Uint32 => 7,
        Primitive::Int64 => 8,
        Primitive::Uint64 => 9,
        Primitive::Float32 => 10,
        Primitive::Float64 => 11,
        Primitive::Bool => 15,
        Primitive::Byte => 16,
    }
}
