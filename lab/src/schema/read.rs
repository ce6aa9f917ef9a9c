//! Reads the numbers that a selection names out of a message.

use std::cmp::Ordering;

use ferntast_msgs::cdr::MAX_PADDING;
use ferntast_msgs::interface::Count;

use super::{
    cursor::{Cursor, Scalar, WideCharacter},
    error::DecodeError,
    layout::{Element, Layout, Member},
    select::{Move, Selection, Test},
};
use crate::message_path::Literal;

/// What a message has where a path points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// Nothing: no such element, or a filter that does not hold. Holds the
    /// length of the array that was looked into last, if any.
    Nothing(Option<u64>),
    /// The number.
    One(f64),
    /// More than one number: so many.
    Several(u64),
}

/// Reads messages of one layout.
#[derive(Clone, Debug)]
pub struct Reader {
    layout: Layout,
    /// Found out with the first message of a layout with wide texts.
    wide: Option<WideCharacter>,
}

/// Where one stands: in front of an element, or of a field's elements.
#[derive(Clone, Copy)]
struct Place<'a, 'l> {
    cursor: Cursor<'a>,
    /// In front of the message that the field belongs to, and its type.
    parent: (Cursor<'a>, usize),
    field: Field<'l>,
}

#[derive(Clone, Copy)]
enum Field<'l> {
    Element(Element),
    Member(&'l Member),
}

#[derive(Default)]
struct Numbers {
    first: f64,
    count: u64,
    length: Option<u64>,
}

impl Reader {
    /// For messages of `layout`.
    pub fn new(layout: Layout) -> Reader {
        let wide = (!layout.has_wide_text()).then_some(WideCharacter::Two);
        Reader { layout, wide }
    }

    /// The layout.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// What the message in `bytes` (CDR, header included) has at `selection`.
    ///
    /// # Errors
    ///
    /// [`DecodeError`]: the bytes do not fit the layout up to there.
    pub fn read(&mut self, bytes: &[u8], selection: &Selection) -> Result<Found, DecodeError> {
        let cursor = Cursor::new(bytes, self.wide_character(bytes))?;
        let mut numbers = Numbers::default();
        let root = Element::Struct(0);
        let place = Place {
            cursor,
            parent: (cursor, 0),
            field: Field::Element(root),
        };
        walk(&self.layout, place, &selection.moves, &mut numbers)?;
        Ok(match numbers.count {
            0 => Found::Nothing(numbers.length),
            1 => Found::One(numbers.first),
            count => Found::Several(count),
        })
    }

    /// How many elements the message has in the field at `fields`, numbers of
    /// fields from one type into the next, through first elements.
    pub(super) fn length_at(&mut self, bytes: &[u8], fields: &[usize]) -> Option<u64> {
        let mut cursor = Cursor::new(bytes, self.wide_character(bytes)).ok()?;
        let mut number = 0;
        for (depth, &field) in fields.iter().enumerate() {
            let inner = self.layout.structs.get(number)?;
            for before in inner.fields.get(..field)? {
                cursor.skip_member(&self.layout, before).ok()?;
            }
            let member = inner.fields.get(field)?;
            let count = cursor.count(member.count).ok()?;
            if depth + 1 == fields.len() {
                return Some(count);
            }
            match (member.element, count) {
                (_, 0) => return None,
                (Element::Struct(inner), _) => number = inner,
                _ => return None,
            }
        }
        None
    }

    /// Writers differ in how wide a wide character is: it is what makes the
    /// message end where its bytes do.
    fn wide_character(&mut self, bytes: &[u8]) -> WideCharacter {
        if let Some(known) = self.wide {
            return known;
        }
        let fits = |wide: WideCharacter| {
            Cursor::new(bytes, wide).is_ok_and(|mut cursor| {
                cursor.skip(&self.layout, Element::Struct(0)).is_ok()
                    && cursor.left() <= MAX_PADDING
            })
        };
        match (fits(WideCharacter::Two), fits(WideCharacter::Four)) {
            (false, true) => {
                self.wide = Some(WideCharacter::Four);
                WideCharacter::Four
            }
            (true, false) => {
                self.wide = Some(WideCharacter::Two);
                WideCharacter::Two
            }
            // Only empty texts, or broken: the next message may tell.
            _ => WideCharacter::Two,
        }
    }
}

fn walk(
    layout: &Layout,
    mut place: Place<'_, '_>,
    moves: &[Move],
    numbers: &mut Numbers,
) -> Result<(), DecodeError> {
    let Some((next, rest)) = moves.split_first() else {
        if let Field::Element(element) = place.field
            && let Some(Scalar::Number(number)) = place.cursor.scalar(element)?
        {
            if numbers.count == 0 {
                numbers.first = number;
            }
            numbers.count += 1;
        }
        return Ok(());
    };
    match (next, place.field) {
        (Move::Field(field), Field::Element(Element::Struct(number))) => {
            let parent = (place.cursor, number);
            let Some(member) = enter(layout, &mut place.cursor, number, *field)? else {
                return Ok(());
            };
            let field = match member.count {
                Count::One => Field::Element(member.element),
                _ => Field::Member(member),
            };
            let place = Place {
                cursor: place.cursor,
                parent,
                field,
            };
            walk(layout, place, rest, numbers)
        }
        (Move::If(test), Field::Element(element)) => {
            match holds(layout, place.cursor, element, test)? {
                true => walk(layout, place, rest, numbers),
                false => Ok(()),
            }
        }
        (
            Move::Elements {
                first,
                last,
                tests,
                beside,
            },
            Field::Member(member),
        ) => {
            let length = place.cursor.count(member.count)?;
            numbers.length = Some(length);
            let Some((first, last)) = range(*first, *last, length) else {
                return Ok(());
            };
            let mut cursor = place.cursor;
            cursor.skip_many(layout, member.element, first)?;
            for index in first..=last {
                let mut wanted = true;
                for test in tests {
                    wanted = wanted && holds(layout, cursor, member.element, test)?;
                }
                for test in beside {
                    wanted = wanted && holds_beside(layout, place.parent, index, test)?;
                }
                if wanted {
                    let element = Place {
                        cursor,
                        parent: place.parent,
                        field: Field::Element(member.element),
                    };
                    walk(layout, element, rest, numbers)?;
                }
                if index < last {
                    cursor.skip(layout, member.element)?;
                }
            }
            Ok(())
        }
        // A selection is made for its layout, so this does not come.
        _ => Ok(()),
    }
}

/// Moves from in front of a message to in front of one of its fields.
fn enter<'l>(
    layout: &'l Layout,
    cursor: &mut Cursor<'_>,
    number: usize,
    field: usize,
) -> Result<Option<&'l Member>, DecodeError> {
    let fields = layout.structs.get(number).map_or(&[][..], |s| &s.fields);
    for before in fields.iter().take(field) {
        cursor.skip_member(layout, before)?;
    }
    Ok(fields.get(field))
}

/// The elements from `first` to `last` of `length`, counted from the front;
/// `None` where there is none.
fn range(first: i64, last: i64, length: u64) -> Option<(u64, u64)> {
    let length = i64::try_from(length).ok()?;
    let from_front = |index: i64| {
        if index < 0 {
            index.saturating_add(length)
        } else {
            index
        }
    };
    let (first, last) = match first == last {
        // One element that is not there is none; a slice is cut to what is.
        true => (from_front(first), from_front(last)),
        false => (from_front(first).max(0), from_front(last).min(length - 1)),
    };
    let inside = first >= 0 && last < length && first <= last;
    inside.then_some((u64::try_from(first).ok()?, u64::try_from(last).ok()?))
}

fn holds(
    layout: &Layout,
    mut cursor: Cursor<'_>,
    mut element: Element,
    test: &Test,
) -> Result<bool, DecodeError> {
    for &field in &test.path {
        let Element::Struct(number) = element else {
            return Ok(false);
        };
        let Some(member) = enter(layout, &mut cursor, number, field)? else {
            return Ok(false);
        };
        element = member.element;
    }
    Ok(compare(cursor.scalar(element)?, test))
}

/// Whether it holds for the element `index` of another array of the parent.
fn holds_beside(
    layout: &Layout,
    (mut cursor, number): (Cursor<'_>, usize),
    index: u64,
    test: &Test,
) -> Result<bool, DecodeError> {
    let Some(&field) = test.path.first() else {
        return Ok(false);
    };
    let Some(member) = enter(layout, &mut cursor, number, field)? else {
        return Ok(false);
    };
    if index >= cursor.count(member.count)? {
        return Ok(false);
    }
    cursor.skip_many(layout, member.element, index)?;
    Ok(compare(cursor.scalar(member.element)?, test))
}

fn compare(found: Option<Scalar<'_>>, test: &Test) -> bool {
    let order: Option<Ordering> = match (&found, &test.value) {
        (Some(Scalar::Number(found)), Literal::Number(value)) => found.partial_cmp(value),
        (Some(Scalar::Number(found)), Literal::Bool(value)) => (*found != 0.0).partial_cmp(value),
        (Some(Scalar::Text(found)), Literal::Text(value)) => {
            found.as_ref().partial_cmp(value.as_str())
        }
        _ => None,
    };
    test.comparison.holds(order)
}
