//! Names the numbers that a message has.

use ferntast_msgs::interface::Count;

use super::{
    layout::{Element, Layout, Struct},
    read::Reader,
};
use crate::message_path::{MessagePath, Step};

/// So many paths of one topic are named at most; types within types may have
/// more than anybody reads.
const MOST: usize = 2000;

/// So many fields and elements are looked into at most: types within types may have many
/// that lead to no number.
const MOST_VISITS: usize = 10 * MOST;

/// So many elements of an array are named.
const ELEMENTS: u64 = 8;

/// The paths of the numbers in messages of a topic. Arrays are as long as in
/// `message` where one is given (CDR, header included), else their first
/// element is named.
pub fn numeric_paths(reader: &mut Reader, topic: &str, message: Option<&[u8]>) -> Vec<String> {
    let layout = reader.layout().clone();
    let mut lister = Lister {
        layout: &layout,
        reader,
        message,
        path: MessagePath {
            topic: topic.to_owned(),
            steps: Vec::new(),
            functions: Vec::new(),
        },
        fields: Vec::new(),
        known: true,
        visits: 0,
        found: Vec::new(),
    };
    if let Some(root) = layout.structs.first() {
        lister.visit(root);
    }
    lister.found
}

struct Lister<'a> {
    layout: &'a Layout,
    reader: &'a mut Reader,
    message: Option<&'a [u8]>,
    path: MessagePath,
    fields: Vec<usize>,
    /// Whether the message has what the path leads to.
    known: bool,
    visits: usize,
    found: Vec<String>,
}

impl Lister<'_> {
    fn visit(&mut self, inner: &Struct) {
        for (number, member) in inner.fields.iter().enumerate() {
            if self.found.len() >= MOST || self.visits >= MOST_VISITS {
                return;
            }
            self.path.steps.push(Step::Field(member.name.clone()));
            self.fields.push(number);
            if member.count == Count::One {
                self.element(member.element);
            } else {
                self.elements(member.element, member.count);
            }
            self.fields.pop();
            self.path.steps.pop();
        }
    }

    fn elements(&mut self, element: Element, count: Count) {
        self.visits += 1;
        let there = match (count, self.message) {
            (Count::Array(size), _) => Some(size),
            (_, Some(bytes)) if self.known => self.reader.length_at(bytes, &self.fields),
            _ => None,
        };
        if there == Some(0) {
            return;
        }
        let was_known = self.known;
        for index in 0..there.unwrap_or(1).min(ELEMENTS) {
            // Lengths inside are looked up in the first element only.
            self.known = was_known && index == 0;
            self.path
                .steps
                .push(Step::Index(i64::try_from(index).unwrap_or(0)));
            self.element(element);
            self.path.steps.pop();
        }
        self.known = was_known;
    }

    fn element(&mut self, element: Element) {
        self.visits += 1;
        match element {
            Element::Primitive(_) => self.found.push(self.path.to_string()),
            Element::Struct(number) => {
                if let Some(inner) = self.layout.structs.get(number) {
                    self.visit(inner);
                }
            }
            Element::Text(_) | Element::WideText(_) => {}
        }
    }
}
