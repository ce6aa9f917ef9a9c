//! What a sample is made of.

use crate::{text::Text, time::Time};

/// Data that may be read from shared memory as found there.
///
/// # Safety
///
/// No pointer, no padding, and every bit pattern is a value: no `bool`, no
/// `enum`.
pub unsafe trait Plain: Copy {}

macro_rules! plain {
    ($($type:ty)*) => {
        // SAFETY: numbers have neither padding nor forbidden bit patterns.
        $(unsafe impl Plain for $type {})*
    };
}
plain!(u8 u16 u32 u64 i8 i16 i32 i64 f64);

// SAFETY: a number in a transparent type.
unsafe impl Plain for Time {}
// SAFETY: bytes in a transparent type.
unsafe impl<const N: usize> Plain for Text<N> {}
// SAFETY: an array has no padding of its own.
unsafe impl<T: Plain, const N: usize> Plain for [T; N] {}

/// A message in its sample form: `repr(C)`, fixed size, no pointers.
/// The attributes `#[message]` and `#[sample]` write it.
///
/// # Safety
///
/// All that [`Plain`] says.
pub unsafe trait Sample: Copy + std::fmt::Debug + PartialEq + Send + Sync + 'static {
    /// What the fields may hold, as declared; empty where the conversions are
    /// written by hand.
    const FIELDS: &'static [Field];
}

/// A truth value: 0 or 1. (A `bool` has forbidden bit patterns.)
pub type Flag = u8;

/// Who sent something; 0 is nobody. Hexadecimal digits on the wire.
pub type Identity = u64;

/// A field of a sample, as declared.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name on the wire.
    pub name: &'static str,
    /// Where it begins in the sample \[B\].
    pub offset: usize,
    /// How long it is \[B\].
    pub size: usize,
    /// What it may hold.
    pub rule: Rule,
}

/// What a field may hold.
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// A time that ROS 2 can hold, not zero.
    Stamp,
    /// A finite number, or else what is allowed.
    Number {
        /// NaN is allowed.
        or_nan: bool,
        /// Infinity is allowed.
        or_infinite: bool,
    },
    /// Finite numbers, as many as the lists are long.
    Numbers,
    /// A text.
    Text {
        /// It may neither be empty nor be cut.
        whole: bool,
    },
    /// Texts, as many as the lists are long.
    Texts {
        /// How many there is room for.
        room: usize,
    },
    /// Length of the lists.
    Count {
        /// How many elements there is room for.
        room: usize,
    },
    /// 0 or 1; a truth value on the wire.
    Flag,
    /// One of these codes.
    Codes(&'static [u8]),
    /// Any bits.
    Anything,
    /// Not on the wire.
    Local,
}
