//! Elements and numbers of an XML document, with the lines that they are in.

use roxmltree::{Document, Node};

use ferntast_model::rigid_body::{Placement, Vector3};

use crate::error::ReadError;

/// The text of a file.
pub fn text(file: &[u8]) -> Result<&str, ReadError> {
    // Some editors begin a file with a byte order mark.
    let file = file.strip_prefix(b"\xef\xbb\xbf").unwrap_or(file);
    std::str::from_utf8(file).map_err(|error| {
        let before = &file[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        ReadError::NotText { line }
    })
}

/// The document of a text.
pub fn parse(text: &str) -> Result<Document<'_>, ReadError> {
    Document::parse(text).map_err(|error| ReadError::Xml {
        what: error.to_string(),
    })
}

/// Where each line of a text ends \[bytes from the beginning\].
pub fn line_ends(text: &str) -> Vec<usize> {
    text.match_indices('\n').map(|(at, _)| at).collect()
}

/// An element, with the lines of its document.
#[derive(Clone, Copy)]
pub struct Element<'a> {
    node: Node<'a, 'a>,
    line_ends: &'a [usize],
}

impl<'a> Element<'a> {
    /// The outermost element.
    pub fn root(document: &'a Document<'a>, line_ends: &'a [usize]) -> Element<'a> {
        Element {
            node: document.root_element(),
            line_ends,
        }
    }

    pub fn name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// Whether it belongs to the macro language.
    pub fn is_xacro(&self) -> bool {
        let space = self.node.tag_name().namespace();
        space.is_some_and(|space| space.contains("xacro"))
    }

    /// Where it is in the text \[bytes\].
    pub fn range(&self) -> std::ops::Range<usize> {
        self.node.range()
    }

    /// All its attributes.
    pub fn attributes(self) -> impl Iterator<Item = (&'a str, &'a str)> {
        self.node.attributes().map(|own| (own.name(), own.value()))
    }

    /// Number from 1.
    pub fn line(&self) -> usize {
        let begin = self.node.range().start;
        1 + self.line_ends.partition_point(|end| *end < begin)
    }

    /// The elements in it.
    pub fn children(&self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        let elements = self.node.children().filter(Node::is_element);
        let line_ends = self.line_ends;
        elements.map(move |node| Element { node, line_ends })
    }

    /// The first element of this name in it.
    pub fn child(&self, name: &str) -> Option<Element<'a>> {
        self.children().find(|child| child.name() == name)
    }

    pub fn attribute(&self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// What has to be there, as `missing` calls it.
    pub fn required<T>(&self, found: Option<T>, missing: &'static str) -> Result<T, ReadError> {
        found.ok_or_else(|| ReadError::Missing {
            line: self.line(),
            element: self.name().to_owned(),
            missing,
        })
    }

    /// `N` finite numbers separated by white space.
    pub fn numbers<const N: usize>(
        &self,
        attribute: &'static str,
    ) -> Result<Option<[f64; N]>, ReadError> {
        let Some(value) = self.attribute(attribute) else {
            return Ok(None);
        };
        let parsed: Option<Vec<f64>> = value
            .split_ascii_whitespace()
            .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        let numbers = parsed.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        let refused = || ReadError::Numbers {
            line: self.line(),
            element: self.name().to_owned(),
            attribute,
            value: value.chars().take(80).collect(),
            wanted: match N {
                1 => "a finite number".to_owned(),
                _ => format!("{N} finite numbers"),
            },
        };
        numbers.ok_or_else(refused).map(Some)
    }

    /// One finite number.
    pub fn number(&self, attribute: &'static str) -> Result<Option<f64>, ReadError> {
        Ok(self.numbers(attribute)?.map(|[number]| number))
    }

    /// Its `<origin>`; where there is none, the same frame.
    pub fn origin(&self) -> Result<Placement, ReadError> {
        let Some(origin) = self.child("origin") else {
            return Ok(Placement::identity());
        };
        if origin.attribute("quat_xyzw").is_some() {
            let line = origin.line();
            return Err(ReadError::Quaternion { line });
        }
        let translation = Vector3::from(origin.numbers("xyz")?.unwrap_or([0.0; 3]));
        let angles = origin.numbers("rpy")?.unwrap_or([0.0; 3]);
        Ok(Placement::from_roll_pitch_yaw(translation, angles))
    }
}
