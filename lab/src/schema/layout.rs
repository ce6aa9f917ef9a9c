//! A schema made ready for reading: types by number instead of by name.

use std::collections::BTreeMap;

use ferntast_msgs::interface::{Base, Count, Definition, Library, Primitive};

use super::error::SchemaError;

/// So deep may types stand within each other.
const DEEPEST: usize = 64;

/// All types of a schema; the first is the message itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    pub(super) structs: Vec<Struct>,
}

/// A type that is made of fields.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Struct {
    pub(super) name: String,
    pub(super) fields: Vec<Member>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Member {
    pub(super) name: String,
    pub(super) element: Element,
    pub(super) count: Count,
}

/// What one element of a field is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Element {
    Primitive(Primitive),
    /// UTF-8, at most that many bytes where bounded.
    Text(Option<u64>),
    /// UTF-16, at most that many code units where bounded.
    WideText(Option<u64>),
    /// The type of that number.
    Struct(usize),
}

impl Layout {
    /// The layout of the messages called `name` by a schema in the language
    /// `encoding`.
    ///
    /// # Errors
    ///
    /// [`SchemaError`]: another language than `ros2msg`, or definitions that
    /// are wrong, missing or circular.
    pub fn of_schema(name: &str, encoding: &str, schema: &str) -> Result<Layout, SchemaError> {
        if encoding != "ros2msg" {
            return Err(SchemaError::Encoding {
                encoding: encoding.to_owned(),
            });
        }
        let library = Library::from_schema(name, schema)?;
        Layout::of_library(&library, name)
    }

    fn of_library(library: &Library, name: &str) -> Result<Layout, SchemaError> {
        // Tells what is missing, and of which type.
        library.schema(name)?;
        let names: Vec<&str> = library.names().collect();
        let root = library.definition(name).map(|found| found.name.as_str());
        let ordered = root
            .into_iter()
            .chain(names.into_iter().filter(|&name| Some(name) != root));
        let definitions: Vec<&Definition> = ordered
            .filter_map(|name| library.definition(name))
            .collect();
        let numbers: BTreeMap<&str, usize> = definitions
            .iter()
            .enumerate()
            .map(|(number, definition)| (definition.name.as_str(), number))
            .collect();
        let structs = definitions
            .iter()
            .map(|definition| Struct {
                name: definition.name.clone(),
                fields: members(definition, &numbers),
            })
            .collect();
        let layout = Layout { structs };
        layout.check_depth()?;
        Ok(layout)
    }

    /// Full name of the message's type.
    pub fn name(&self) -> &str {
        self.structs.first().map_or("", |root| root.name.as_str())
    }

    /// Full name of the type of the message's field `name`, if that is one
    /// message.
    pub fn field_type(&self, name: &str) -> Option<&str> {
        let fields = &self.structs.first()?.fields;
        let field = fields.iter().find(|field| field.name == name)?;
        match (field.element, field.count) {
            (Element::Struct(number), Count::One) => {
                self.structs.get(number).map(|inner| inner.name.as_str())
            }
            _ => None,
        }
    }

    /// No circles, and no deeper than can be walked by recursion.
    fn check_depth(&self) -> Result<(), SchemaError> {
        // How many levels each type has; by as many rounds as levels are allowed.
        let mut depths = vec![1usize; self.structs.len()];
        for _ in 0..=DEEPEST {
            let mut changed = None;
            for (number, each) in self.structs.iter().enumerate() {
                let below = each.fields.iter().filter_map(|field| match field.element {
                    Element::Struct(inner) => depths.get(inner).copied(),
                    _ => None,
                });
                let depth = 1 + below.max().unwrap_or(0);
                if let Some(known) = depths.get_mut(number)
                    && *known < depth
                {
                    *known = depth;
                    changed = Some(number);
                }
            }
            if changed.is_none() {
                return Ok(());
            }
        }
        Err(match self.in_a_circle() {
            Some(name) => SchemaError::Circle {
                interface: name.to_owned(),
            },
            None => SchemaError::TooDeep { limit: DEEPEST },
        })
    }

    /// A type that contains itself.
    fn in_a_circle(&self) -> Option<&str> {
        (0..self.structs.len()).find_map(|start| {
            let mut seen = vec![false; self.structs.len()];
            let mut open = vec![start];
            while let Some(number) = open.pop() {
                let fields = self.structs.get(number).map_or(&[][..], |s| &s.fields);
                for field in fields {
                    let Element::Struct(inner) = field.element else {
                        continue;
                    };
                    if inner == start {
                        return self.structs.get(start).map(|s| s.name.as_str());
                    }
                    if let Some(seen) = seen.get_mut(inner)
                        && !std::mem::replace(seen, true)
                    {
                        open.push(inner);
                    }
                }
            }
            None
        })
    }

    /// Whether a text of wide characters stands anywhere in the message.
    pub(super) fn has_wide_text(&self) -> bool {
        let mut fields = self.structs.iter().flat_map(|each| &each.fields);
        fields.any(|field| matches!(field.element, Element::WideText(_)))
    }

    /// What an element is, as the schema writes it.
    pub(super) fn element_name(&self, element: Element) -> String {
        let base = match element {
            Element::Primitive(primitive) => Base::Primitive(primitive),
            Element::Text(bound) => Base::String(bound),
            Element::WideText(bound) => Base::WideString(bound),
            Element::Struct(number) => Base::Interface(
                self.structs
                    .get(number)
                    .map(|inner| inner.name.clone())
                    .unwrap_or_default(),
            ),
        };
        base.to_string()
    }

    /// What a field is, as the schema writes it.
    pub(super) fn kind_name(&self, member: &Member) -> String {
        let element = self.element_name(member.element);
        match member.count {
            Count::One => element,
            Count::Array(size) => format!("{element}[{size}]"),
            Count::AtMost(bound) => format!("{element}[<={bound}]"),
            Count::Any => format!("{element}[]"),
        }
    }
}

fn members(definition: &Definition, numbers: &BTreeMap<&str, usize>) -> Vec<Member> {
    let fields = definition.fields.iter().filter_map(|field| {
        let element = match &field.kind.base {
            Base::Primitive(primitive) => Element::Primitive(*primitive),
            Base::String(bound) => Element::Text(*bound),
            Base::WideString(bound) => Element::WideText(*bound),
            Base::Interface(name) => Element::Struct(*numbers.get(name.as_str())?),
        };
        Some(Member {
            name: field.name.clone(),
            element,
            count: field.kind.count,
        })
    });
    let mut members: Vec<Member> = fields.collect();
    if members.is_empty() {
        // What ROS 2 puts into a type without fields.
        members.push(Member {
            name: "structure_needs_at_least_one_member".to_owned(),
            element: Element::Primitive(Primitive::Uint8),
            count: Count::One,
        });
    }
    members
}
