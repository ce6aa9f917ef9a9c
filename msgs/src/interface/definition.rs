//! What a `.msg` text says.

use super::{
    kind::{Base, Type},
    value::Value,
};

/// The definition of an interface: its fields and constants, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Definition {
    /// Full name, `package/msg/Type`.
    pub name: String,
    /// The fields.
    pub fields: Vec<Field>,
    /// The constants.
    pub constants: Vec<Constant>,
}

impl Definition {
    /// Full names of the interfaces that the fields are of, in the order of
    /// the fields, each once.
    pub fn dependencies(&self) -> Vec<&str> {
        let mut names = Vec::new();
        for field in &self.fields {
            if let Base::Interface(name) = &field.kind.base
                && !names.contains(&name.as_str())
            {
                names.push(name.as_str());
            }
        }
        names
    }
}

/// A field.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: Type,
    /// Its default value, where the definition gives one.
    pub default: Option<Value>,
}

/// A constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// Its name.
    pub name: String,
    /// Its type; never an interface.
    pub kind: Base,
    /// Its value.
    pub value: Value,
}
