//! Fits a message path to a layout, once; messages are then read without
//! looking for names.

use ferntast_msgs::interface::Count;

use super::{
    error::SelectError,
    layout::{Element, Layout, Member},
};
use crate::message_path::{Comparison, Filter, Literal, MessagePath, Step};

/// Where a number stands in messages of one layout.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    pub(super) moves: Vec<Move>,
}

/// One step towards the number.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Move {
    /// Into that field of the message that one stands in front of.
    Field(usize),
    /// Only if it holds for the message that one stands in front of.
    If(Test),
    /// To each of these elements for which all tests hold.
    Elements {
        first: i64,
        last: i64,
        /// Asked of the element itself.
        tests: Vec<Test>,
        /// Asked of the array beside it, at the same place.
        beside: Vec<Test>,
    },
}

/// A condition on the field at `path`, numbers of fields from one message
/// into the next.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Test {
    pub(super) path: Vec<usize>,
    pub(super) comparison: Comparison,
    pub(super) value: Literal,
}

impl Selection {
    /// Fits the steps of `path` to the messages of `layout`.
    ///
    /// # Errors
    ///
    /// [`SelectError`]: a field that is not there, or that is not what the
    /// path takes it for.
    pub fn new(layout: &Layout, path: &MessagePath) -> Result<Selection, SelectError> {
        let mut walk = Walk {
            layout,
            place: path.topic.clone(),
            at: At::One(Element::Struct(0)),
            parent: 0,
            moves: Vec::new(),
        };
        path.steps.iter().try_for_each(|step| walk.step(step))?;
        walk.finish()
    }
}

/// What the path has led to.
#[derive(Clone, Copy)]
enum At<'a> {
    /// One element, or several by turns.
    One(Element),
    /// A field with several elements, none chosen yet.
    Many(&'a Member),
    /// Elements that filters may still thin out; the member is that of a
    /// field that was just indexed.
    Chosen(&'a Member),
}

struct Walk<'a> {
    layout: &'a Layout,
    place: String,
    at: At<'a>,
    /// The type that the last field belongs to.
    parent: usize,
    moves: Vec<Move>,
}

impl<'a> Walk<'a> {
    fn step(&mut self, step: &Step) -> Result<(), SelectError> {
        match step {
            Step::Field(name) => self.field(name)?,
            Step::Index(index) => self.elements(*index, *index, step)?,
            Step::Slice(first, last) => self.elements(*first, *last, step)?,
            Step::Filter(filter) => self.filter(filter)?,
        }
        self.place.push_str(&step.to_string());
        Ok(())
    }

    fn kind(&self) -> String {
        match self.at {
            At::Many(member) => self.layout.kind_name(member),
            At::One(element) => self.layout.element_name(element),
            At::Chosen(member) => self.layout.element_name(member.element),
        }
    }

    fn field(&mut self, name: &str) -> Result<(), SelectError> {
        let element = match self.at {
            At::Many(member) if self.is_open() => member.element,
            At::Many(member) => {
                return Err(SelectError::NotAMessage {
                    place: self.place.clone(),
                    kind: format!(
                        "{} (choose an element, such as [0])",
                        self.layout.kind_name(member)
                    ),
                    field: name.to_owned(),
                });
            }
            At::One(element) => element,
            At::Chosen(member) => member.element,
        };
        let Element::Struct(number) = element else {
            return Err(SelectError::NotAMessage {
                place: self.place.clone(),
                kind: self.kind(),
                field: name.to_owned(),
            });
        };
        let (field, member) = find(self.layout, number, name)?;
        self.parent = number;
        self.moves.push(Move::Field(field));
        self.at = match member.count {
            Count::One => At::One(member.element),
            _ => At::Many(member),
        };
        Ok(())
    }

    fn elements(&mut self, first: i64, last: i64, step: &Step) -> Result<(), SelectError> {
        let At::Many(member) = self.at else {
            return Err(SelectError::NotAnArray {
                place: self.place.clone(),
                kind: self.kind(),
                brackets: step.to_string(),
            });
        };
        let never = |index: i64| match member.count {
            Count::Array(size) | Count::AtMost(size) => {
                let size = i64::try_from(size).unwrap_or(i64::MAX);
                index >= size || index < -size
            }
            _ => false,
        };
        if first == last && never(first) {
            return Err(SelectError::NoElement {
                place: self.place.clone(),
                kind: self.kind(),
                index: first,
            });
        }
        // A filter in front of the brackets has opened the array already.
        if let Some(Move::Elements {
            first: open,
            last: end,
            ..
        }) = self.moves.last_mut()
        {
            (*open, *end) = (first, last);
        } else {
            self.open(first, last);
        }
        self.at = At::Chosen(member);
        Ok(())
    }

    /// Whether a filter stands behind the array already.
    fn is_open(&self) -> bool {
        matches!(self.moves.last(), Some(Move::Elements { .. }))
    }

    fn open(&mut self, first: i64, last: i64) {
        self.moves.push(Move::Elements {
            first,
            last,
            tests: Vec::new(),
            beside: Vec::new(),
        });
    }

    fn filter(&mut self, filter: &Filter) -> Result<(), SelectError> {
        let member = match self.at {
            At::One(element) => {
                let test = self.test_of(element, filter)?;
                self.moves.push(Move::If(test));
                return Ok(());
            }
            At::Many(member) => {
                if !self.is_open() {
                    self.open(0, -1);
                }
                member
            }
            At::Chosen(member) => member,
        };
        let (test, is_beside) = match member.element {
            Element::Struct(_) => (self.test_of(member.element, filter)?, false),
            _ => (self.test_beside(filter)?, true),
        };
        if let Some(Move::Elements { tests, beside, .. }) = self.moves.last_mut() {
            if is_beside { beside } else { tests }.push(test);
        }
        Ok(())
    }

    /// The test on fields of a message.
    fn test_of(&self, element: Element, filter: &Filter) -> Result<Test, SelectError> {
        let mut path = Vec::new();
        let mut element = element;
        for name in &filter.path {
            let Element::Struct(number) = element else {
                return Err(self.refuse(filter, "it looks for fields in what has none"));
            };
            let (field, member) = find(self.layout, number, name)?;
            if member.count != Count::One {
                return Err(self.refuse(filter, "it looks at an array; only single values compare"));
            }
            path.push(field);
            element = member.element;
        }
        self.finish_test(path, element, filter)
    }

    /// The test on the array beside the one that is filtered.
    fn test_beside(&self, filter: &Filter) -> Result<Test, SelectError> {
        let [name] = filter.path.as_slice() else {
            return Err(self.refuse(filter, "beside an array of numbers only one name can stand"));
        };
        let (field, member) = find(self.layout, self.parent, name)?;
        if member.count == Count::One {
            return Err(self.refuse(
                filter,
                "beside an array of numbers only another array can be asked",
            ));
        }
        self.finish_test(vec![field], member.element, filter)
    }

    fn finish_test(
        &self,
        path: Vec<usize>,
        element: Element,
        filter: &Filter,
    ) -> Result<Test, SelectError> {
        let fits = match (element, &filter.value) {
            (Element::Struct(_), _) => false,
            (Element::Primitive(_), Literal::Number(_) | Literal::Bool(_)) => true,
            (Element::Text(_) | Element::WideText(_), Literal::Text(_)) => true,
            _ => false,
        };
        if !fits {
            let kind = self.layout.element_name(element);
            return Err(self.refuse(
                filter,
                &format!("the field is {kind}, which does not compare with that"),
            ));
        }
        Ok(Test {
            path,
            comparison: filter.comparison,
            value: filter.value.clone(),
        })
    }

    fn refuse(&self, filter: &Filter, reason: &str) -> SelectError {
        SelectError::Filter {
            filter: format!("{}{filter}", self.place),
            reason: reason.to_owned(),
        }
    }

    fn finish(self) -> Result<Selection, SelectError> {
        let kind = self.kind();
        let element = match self.at {
            At::One(element) => Some(element),
            At::Chosen(member) => Some(member.element),
            // A filter that picks one element needs no brackets.
            At::Many(member) if self.is_open() => Some(member.element),
            At::Many(_) => None,
        };
        match element {
            Some(Element::Primitive(_)) => Ok(Selection { moves: self.moves }),
            _ => Err(SelectError::NotANumber {
                place: self.place,
                kind,
            }),
        }
    }
}

fn find<'a>(
    layout: &'a Layout,
    number: usize,
    name: &str,
) -> Result<(usize, &'a Member), SelectError> {
    let inner = layout.structs.get(number);
    let fields = inner.map_or(&[][..], |inner| &inner.fields);
    fields
        .iter()
        .enumerate()
        .find(|(_, member)| member.name == name)
        .ok_or_else(|| SelectError::NoField {
            interface: inner.map(|inner| inner.name.clone()).unwrap_or_default(),
            field: name.to_owned(),
        })
}
