//! Interfaces that know each other.

use std::collections::BTreeMap;

use super::{
    definition::Definition,
    error::InterfaceError,
    hash,
    parse::{full_name, parse},
};

/// What stands between the definitions of a schema: 80 equals signs.
const SEPARATOR: &str =
    "================================================================================";

/// Interfaces by name, with what they are made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Library {
    entries: BTreeMap<String, Entry>,
}

#[derive(Clone, Debug, PartialEq)]
struct Entry {
    text: String,
    definition: Definition,
}

impl Library {
    /// Adds the interface `name` (`package/msg/Type`) with its `.msg` text, in
    /// place of one of the same name. What it is made of may be added later.
    ///
    /// # Errors
    ///
    /// A name that is none, a text that cannot be read.
    pub fn insert(&mut self, name: &str, text: &str) -> Result<(), InterfaceError> {
        let definition = parse(name, text)?;
        let text = text.to_owned();
        self.entries
            .insert(definition.name.clone(), Entry { text, definition });
        Ok(())
    }

    /// The interfaces in a `ros2msg` schema of the interface `name`: itself,
    /// and after each line of equals signs and `MSG: package/Type` one more.
    ///
    /// # Errors
    ///
    /// A name that is none, a text that cannot be read (lines count within
    /// the definition).
    pub fn from_schema(name: &str, schema: &str) -> Result<Library, InterfaceError> {
        let mut library = Library::default();
        let (mut name, mut text) = (name.to_owned(), String::new());
        let mut lines = schema.lines();
        while let Some(line) = lines.next() {
            let ruled = line.trim_end();
            if ruled.len() < 3 || !ruled.bytes().all(|byte| byte == b'=') {
                text.push_str(line);
                text.push('\n');
                continue;
            }
            library.insert(&name, &text)?;
            text.clear();
            let next = lines.next().unwrap_or_default().trim();
            let next = next.strip_prefix("MSG:").unwrap_or(next).trim();
            name = next.to_owned();
        }
        library.insert(&name, &text)?;
        Ok(library)
    }

    /// Full names of the interfaces, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }

    /// The definition of an interface.
    pub fn definition(&self, name: &str) -> Option<&Definition> {
        let name = full_name(name)?;
        Some(&self.entries.get(&name)?.definition)
    }

    /// The `ros2msg` schema: the definition, then every interface that it is
    /// made of, each once, each after a line of 80 equals signs and
    /// `MSG: package/Type`.
    ///
    /// # Errors
    ///
    /// The interface or one that it is made of is not in the library.
    pub fn schema(&self, name: &str) -> Result<String, InterfaceError> {
        let mut schema = String::new();
        for entry in self.with_dependencies(name)? {
            if !schema.is_empty() {
                let name = entry.definition.name.replacen("/msg/", "/", 1);
                schema.push_str(&format!("{SEPARATOR}\nMSG: {name}\n"));
            }
            schema.push_str(&entry.text);
            if !schema.ends_with('\n') {
                schema.push('\n');
            }
        }
        Ok(schema)
    }

    /// The RIHS01 hash, `RIHS01_` and 64 hexadecimal digits.
    ///
    /// # Errors
    ///
    /// The interface or one that it is made of is not in the library.
    pub fn type_hash(&self, name: &str) -> Result<String, InterfaceError> {
        let entries = self.with_dependencies(name)?;
        let definitions: Vec<&Definition> = entries.iter().map(|e| &e.definition).collect();
        match definitions.as_slice() {
            [definition, referenced @ ..] => Ok(hash::rihs01(definition, referenced)),
            [] => Err(InterfaceError::Unknown {
                name: name.to_owned(),
            }),
        }
    }

    /// The interface and all that it is made of, depth first in the order of
    /// the fields, each once.
    fn with_dependencies(&self, name: &str) -> Result<Vec<&Entry>, InterfaceError> {
        let name = full_name(name).ok_or_else(|| InterfaceError::BadName {
            name: name.to_owned(),
        })?;
        let first = self
            .entries
            .get(&name)
            .ok_or(InterfaceError::Unknown { name })?;
        let (mut found, mut open) = (Vec::<&Entry>::new(), vec![first]);
        // A stack instead of recursion: definitions from outside may nest as
        // deep as they like, or in a circle.
        while let Some(entry) = open.pop() {
            let known = |known: &&Entry| known.definition.name == entry.definition.name;
            if found.iter().any(known) {
                continue;
            }
            found.push(entry);
            for name in entry.definition.dependencies().into_iter().rev() {
                let dependency = self.entries.get(name);
                open.push(dependency.ok_or_else(|| InterfaceError::MissingDependency {
                    name: name.to_owned(),
                    needed_by: entry.definition.name.clone(),
                })?);
            }
        }
        Ok(found)
    }
}
