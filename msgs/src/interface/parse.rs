//! Reads `.msg` texts.
//!
//! The format is that of the ROS 2 interface definition: a line is empty, a
//! comment (`#`), a field (`type name` or `type name default`) or a constant
//! (`type NAME=value`). Read more widely than ROS 2 writes it: names may have
//! capitals, a bare `Header` is `std_msgs/msg/Header` as in ROS 1, and a
//! package name may stand as `package/Type` or `package/msg/Type`.

use super::{
    definition::{Constant, Definition, Field},
    error::{InterfaceError, ParseError, Problem},
    kind::{Base, Count, Primitive, Type},
    value::{self, Quotes},
};

/// Reads the definition `text` of the interface `name` (`package/msg/Type`).
///
/// # Errors
///
/// A name that is none, or a line that cannot be read.
pub fn parse(name: &str, text: &str) -> Result<Definition, InterfaceError> {
    let name = full_name(name).ok_or_else(|| InterfaceError::BadName {
        name: name.to_owned(),
    })?;
    let package = name.split('/').next().unwrap_or_default();
    let mut definition = Definition {
        name: name.clone(),
        fields: Vec::new(),
        constants: Vec::new(),
    };
    for (index, content) in text.lines().enumerate() {
        read_line(&mut definition, package, content).map_err(|problem| {
            InterfaceError::Definition {
                name: name.clone(),
                error: ParseError {
                    line: index + 1,
                    problem,
                },
            }
        })?;
    }
    Ok(definition)
}

/// The name `package/msg/Type`, also of an interface given as `package/Type`;
/// `None` when it is none.
pub(super) fn full_name(name: &str) -> Option<String> {
    let parts: Vec<&str> = name.split('/').collect();
    let (package, kind) = match parts.as_slice() {
        [package, "msg", kind] | [package, kind] => (package, kind),
        _ => return None,
    };
    let is_name = is_identifier(package) && is_identifier(kind) && starts_upper(kind);
    is_name.then(|| format!("{package}/msg/{kind}"))
}

fn read_line(definition: &mut Definition, package: &str, content: &str) -> Result<(), Problem> {
    let line = without_comment(content).trim();
    if line.is_empty() {
        return Ok(());
    }
    let Some((kind, rest)) = line.split_once(char::is_whitespace) else {
        return Err(Problem::NoName {
            kind: line.to_owned(),
        });
    };
    let kind = read_type(kind, package)?;
    let rest = rest.trim_start();
    let end = rest
        .find(|c: char| c.is_whitespace() || c == '=')
        .unwrap_or(rest.len());
    let (name, rest) = rest.split_at(end);
    let rest = rest.trim_start();
    if !is_identifier(name) {
        return Err(Problem::BadName {
            name: name.to_owned(),
        });
    }
    let taken = definition.fields.iter().any(|field| field.name == name)
        || definition.constants.iter().any(|known| known.name == name);
    if taken {
        return Err(Problem::Twice {
            name: name.to_owned(),
        });
    }
    match rest.strip_prefix('=') {
        Some(value) => {
            let constant = read_constant(kind, name, value.trim_start())?;
            definition.constants.push(constant);
        }
        None => definition.fields.push(read_field(kind, name, rest)?),
    }
    Ok(())
}

/// The line up to its comment. A sharp inside a quoted value starts none,
/// unless the quote is never closed.
fn without_comment(line: &str) -> &str {
    let mut quotes = Quotes::default();
    let mut sharps = line.char_indices().filter(|&(_, c)| c == '#');
    let outside = line
        .char_indices()
        .find(|&(_, c)| !quotes.inside(c) && c == '#');
    let end = outside.or_else(|| sharps.next().filter(|_| quotes.are_open()));
    end.map_or(line, |(end, _)| line.get(..end).unwrap_or(line))
}

fn read_constant(kind: Type, name: &str, text: &str) -> Result<Constant, Problem> {
    if kind.count != Count::One || matches!(kind.base, Base::Interface(_)) {
        return Err(Problem::BadConstant {
            kind: kind.to_string(),
        });
    }
    let value = value::constant(&kind.base, text).ok_or_else(|| Problem::BadValue {
        value: text.to_owned(),
        kind: kind.to_string(),
    })?;
    Ok(Constant {
        name: name.to_owned(),
        kind: kind.base,
        value,
    })
}

fn read_field(kind: Type, name: &str, text: &str) -> Result<Field, Problem> {
    let default = match (text, &kind.base) {
        ("", _) => None,
        (_, Base::Interface(_)) => {
            return Err(Problem::NoDefault {
                kind: kind.to_string(),
            });
        }
        _ => {
            let value = value::default(&kind, text);
            Some(value.ok_or_else(|| Problem::BadValue {
                value: text.to_owned(),
                kind: kind.to_string(),
            })?)
        }
    };
    Ok(Field {
        name: name.to_owned(),
        kind,
        default,
    })
}

fn read_type(text: &str, package: &str) -> Result<Type, Problem> {
    let (base, count) = match text
        .strip_suffix(']')
        .and_then(|text| text.rsplit_once('['))
    {
        None => (text, Count::One),
        Some((base, "")) => (base, Count::Any),
        Some((base, size)) => match size.strip_prefix("<=") {
            Some(limit) => (base, Count::AtMost(bound(limit)?)),
            None => (base, Count::Array(bound(size)?)),
        },
    };
    Ok(Type {
        base: read_base(base, package)?,
        count,
    })
}

fn read_base(text: &str, package: &str) -> Result<Base, Problem> {
    if let Some(primitive) = Primitive::from_name(text) {
        return Ok(Base::Primitive(primitive));
    }
    let interface = match text.split_once("<=") {
        Some(("string", limit)) => return Ok(Base::String(Some(bound(limit)?))),
        Some(("wstring", limit)) => return Ok(Base::WideString(Some(bound(limit)?))),
        Some(_) => None,
        None if text == "string" => return Ok(Base::String(None)),
        None if text == "wstring" => return Ok(Base::WideString(None)),
        None if text == "Header" => full_name("std_msgs/msg/Header"),
        None if text.contains('/') => full_name(text),
        None => full_name(&format!("{package}/{text}")),
    };
    interface
        .map(Base::Interface)
        .ok_or_else(|| Problem::BadType {
            kind: text.to_owned(),
        })
}

/// A bound or size: digits only, above zero.
fn bound(text: &str) -> Result<u64, Problem> {
    let refuse = || Problem::BadBound {
        bound: text.to_owned(),
    };
    if !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(refuse());
    }
    text.parse()
        .ok()
        .filter(|&bound| bound > 0)
        .ok_or_else(refuse)
}

fn is_identifier(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic())
        && text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

fn starts_upper(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_uppercase())
}
