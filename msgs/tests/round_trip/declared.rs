//! Every message that is declared with its rules (`#[message]`): samples and
//! ROS 2 forms are made from the declaration, so that a new one needs no line
//! here.

use ferntast_msgs::{
    InvalidMessage, Message, Sample,
    sample::{Field, JointNames, Rule},
    topics::{self, Topic, Visitor},
};
use proptest::{prelude::*, test_runner::TestRunner};

use super::{any_bits, bytes, from_bytes, outside, there_and_back};

/// Runs `each` for every sample of the table that is declared with rules.
macro_rules! for_each_message {
    ($($each:ident)*) => {
        $(#[test]
        fn $each() {
            struct Each(usize);
            impl Visitor for Each {
                fn topic<M: Message>(&mut self, _: Topic<M>) {
                    if !M::FIELDS.is_empty() {
                        checks::$each::<M>();
                        self.0 += 1;
                    }
                }
            }
            let mut each = Each(0);
            topics::visit(&JointNames::numbered(2), &mut each).unwrap();
            assert!(each.0 > 13);
        })*
    };
}

for_each_message! {
    the_fields_are_the_whole_sample
    samples_come_back
    whatever_comes_in_is_refused_or_good
    whatever_breaks_a_rule_is_refused
}

mod checks {
    use super::*;

    pub fn the_fields_are_the_whole_sample<M: Message>() {
        let mut fields = M::FIELDS.to_vec();
        fields.sort_by_key(|field| field.offset);
        let mut end = 0;
        for field in fields {
            assert_eq!(field.offset, end, "{}", field.name);
            end += field.size;
        }
        assert_eq!(end, size_of::<M>());
    }

    pub fn samples_come_back<M: Message>() {
        run(&bits::<M>(), |mut bits| {
            any_bits::<M>(&bits)?;
            stamp::<M>(&mut bits);
            any_bits::<M>(&bits)?;
            make_valid::<M>(&mut bits);
            there_and_back::<M>(from_bytes(&bits))
        });
    }

    pub fn whatever_comes_in_is_refused_or_good<M: Message>() {
        let words = std::cell::RefCell::new(["", "joint_1", "ab"].map(String::from).to_vec());
        let good = std::cell::Cell::new(0);
        run(&any::<u64>(), |seed| {
            let ros = outside::message::<M::Ros>(seed, &words.borrow());
            match M::from_ros(&ros) {
                Ok(sample) => {
                    good.set(good.get() + 1);
                    prop_assert_eq!(sample.check(), Ok(()));
                    let again = M::from_ros(&sample.to_ros());
                    prop_assert_eq!(again.as_ref().map(bytes), Ok(bytes(&sample)));
                }
                // What it asks for comes in later.
                Err(InvalidMessage::Unknown { known, .. }) => {
                    let mut words = words.borrow_mut();
                    for word in known.split(", ") {
                        if words.iter().all(|own| own != word) {
                            words.push(word.to_owned());
                        }
                    }
                }
                Err(_) => {}
            }
            Ok(())
        });
        assert!(good.get() > 0, "nothing that came in was good");
    }

    pub fn whatever_breaks_a_rule_is_refused<M: Message>() {
        run(&bits::<M>(), |mut bits| {
            make_valid::<M>(&mut bits);
            prop_assert_eq!(from_bytes::<M>(&bits).check(), Ok(()));
            for field in M::FIELDS {
                refused::<M>(&bits, field)?;
            }
            Ok(())
        });
    }
}

fn run<S: Strategy>(strategy: &S, test: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    if let Err(error) = TestRunner::new(ProptestConfig::with_cases(1000)).run(strategy, test) {
        panic!("{error}");
    }
}

fn bits<M: Sample>() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec(any::<u8>(), size_of::<M>())
}

fn place<'a>(bits: &'a mut [u8], field: &Field) -> &'a mut [u8] {
    &mut bits[field.offset..field.offset + field.size]
}

fn put(bits: &mut [u8], value: &[u8]) {
    bits[..value.len()].copy_from_slice(value);
}

/// A stamp that ROS 2 can hold.
fn stamp<M: Sample>(bits: &mut [u8]) {
    for field in M::FIELDS {
        if let Rule::Stamp = field.rule {
            let place = place(bits, field);
            let nanos = i64::from_ne_bytes(place[..8].try_into().expect("eight bytes"));
            let last = i64::from(i32::MAX) * 1_000_000_000;
            put(place, &(nanos.rem_euclid(last) + 1).to_ne_bytes());
        }
    }
}

/// How long the lists are.
fn count<M: Sample>(bits: &mut [u8]) -> usize {
    for field in M::FIELDS {
        if let Rule::Count { room } = field.rule {
            let place = place(bits, field);
            let count = usize::from(place[0]) % (room + 1);
            put(place, &(count as u32).to_ne_bytes());
            return count;
        }
    }
    0
}

/// Makes any bits a sample that keeps the rules. One in four has NaN and
/// infinity wherever they stand for something.
fn make_valid<M: Sample>(bits: &mut [u8]) {
    let unknown = bits[0].is_multiple_of(4);
    stamp::<M>(bits);
    let count = count::<M>(bits);
    for field in M::FIELDS {
        let place = place(bits, field);
        match field.rule {
            Rule::Number {
                or_nan,
                or_infinite,
            } => match (unknown, or_nan, or_infinite) {
                (true, true, _) => put(place, &f64::NAN.to_ne_bytes()),
                (true, _, true) => put(place, &f64::INFINITY.to_ne_bytes()),
                _ => make_finite(place),
            },
            Rule::Numbers => {
                place[8 * count..].fill(0);
                place[..8 * count].chunks_mut(8).for_each(make_finite);
            }
            Rule::Text { whole } => {
                make_text(place);
                if whole && place[0] == 0 {
                    place[0] = b'x';
                }
            }
            Rule::Texts { room } => {
                let length = place.len() / room;
                place[length * count..].fill(0);
                place.chunks_mut(length).for_each(make_text);
            }
            Rule::Flag => place[0] %= 2,
            Rule::Codes(codes) => place[0] = codes[usize::from(place[0]) % codes.len()],
            Rule::Local => place.fill(0),
            Rule::Stamp | Rule::Count { .. } | Rule::Anything => {}
        }
    }
}

fn make_finite(place: &mut [u8]) {
    let number = f64::from_ne_bytes(place[..8].try_into().expect("eight bytes"));
    if !number.is_finite() {
        put(place, &1.5_f64.to_ne_bytes());
    }
}

/// Text as the bits have it, else letters.
fn make_text(place: &mut [u8]) {
    let text = match place[0] % 2 {
        0 => String::from_utf8_lossy(place).into_owned(),
        _ => place
            .iter()
            .map(|byte| char::from(b'a' + byte % 26))
            .collect(),
    };
    let mut end = text.find('\0').unwrap_or(text.len()).min(place.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    place.fill(0);
    put(place, &text.as_bytes()[..end]);
}

/// The sample with that field broken in every way that its rule knows is refused.
fn refused<M: Message>(bits: &[u8], field: &Field) -> Result<(), TestCaseError> {
    let with = |value: &[u8]| -> M {
        let mut bits = bits.to_vec();
        put(place(&mut bits, field), value);
        from_bytes(&bits)
    };
    let not_finite = |number: f64| {
        let error = with(&number.to_ne_bytes()).check();
        let named = matches!(&error, Err(InvalidMessage::NotFinite { field: own, .. }) if *own == field.name);
        prop_assert!(named, "{number} in {}: {error:?}", field.name);
        Ok(())
    };
    let unknown = |result: Result<(), InvalidMessage>| {
        let named = matches!(&result, Err(InvalidMessage::Unknown { field: own, .. }) if *own == field.name);
        prop_assert!(named, "{}: {result:?}", field.name);
        Ok(())
    };
    match field.rule {
        Rule::Stamp => {
            prop_assert_eq!(with(&[0; 8]).check(), Err(InvalidMessage::ZeroStamp));
            let late = with(&i64::MAX.to_ne_bytes()).check();
            prop_assert!(
                matches!(late, Err(InvalidMessage::LateStamp { .. })),
                "{late:?}"
            );
        }
        Rule::Number {
            or_nan,
            or_infinite,
        } => {
            not_finite(f64::NEG_INFINITY)?;
            if !or_infinite {
                not_finite(f64::INFINITY)?;
            }
            if !or_nan {
                not_finite(f64::NAN)?;
            }
        }
        Rule::Numbers => {
            let mut bits = bits.to_vec();
            if count_of::<M>(&mut bits) > 0 {
                not_finite(f64::NAN)?;
            }
        }
        Rule::Flag => unknown(with(&[2]).check())?,
        Rule::Codes(codes) => {
            let code = (0..=u8::MAX)
                .rev()
                .find(|code| !codes.contains(code))
                .expect("not all of 256 codes have names");
            let sample = with(&[code]);
            unknown(sample.check())?;
            unknown(M::from_ros(&sample.to_ros()).map(drop))?;
        }
        Rule::Text { whole: true } => unknown(with(&vec![0; field.size]).check())?,
        Rule::Count { room } => {
            let error = with(&(room as u32 + 1).to_ne_bytes()).check();
            prop_assert!(
                matches!(error, Err(InvalidMessage::WrongLength { .. })),
                "{error:?}"
            );
        }
        Rule::Text { whole: false } | Rule::Texts { .. } | Rule::Anything | Rule::Local => {}
    }
    Ok(())
}

/// How long the lists of a valid sample are.
fn count_of<M: Sample>(bits: &mut [u8]) -> u32 {
    let counts = |field: &&Field| matches!(field.rule, Rule::Count { .. });
    M::FIELDS.iter().find(counts).map_or(0, |field| {
        u32::from_ne_bytes(place(bits, field)[..4].try_into().expect("four bytes"))
    })
}
