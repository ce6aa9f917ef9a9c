//! Sets of codes that have names on the wire.

use crate::InvalidMessage;

/// A code that is its name on the wire.
pub trait Named: Copy {
    /// The first code.
    const INITIAL: Self;
    /// Every code.
    const CODES: &'static [u8];

    /// The name; a code without one comes out as a word that the way back refuses.
    fn wire_name(self) -> String;

    /// The code of the name that stands in `field`.
    ///
    /// # Errors
    ///
    /// There is no such name.
    fn from_wire(field: &'static str, name: &str) -> Result<Self, InvalidMessage>;

    /// Refuses a code without a name.
    ///
    /// # Errors
    ///
    /// There is no such code.
    fn check(self, field: &'static str) -> Result<(), InvalidMessage>;
}

/// Declares a set of codes: each with its constant, code and name on the wire.
/// `known` is the list of names in error texts, where it is not the names alone.
macro_rules! codes {
    (
        $(#[$doc:meta])*
        pub struct $set:ident $(known $known:literal)? {
            $($(#[$each:meta])* $constant:ident = $code:literal $name:literal,)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(transparent)]
        pub struct $set(pub u8);

        impl $set {
            $($(#[$each])* pub const $constant: $set = $set($code);)+

            /// Every code.
            pub const ALL: [$set; [$($code),+].len()] = [$($set::$constant),+];

            /// Every name, for error texts.
            pub const KNOWN: &str = $crate::sample::codes::known!([$($known)?] $($name)+);

            /// The name; `None` for a code that has none.
            pub fn name(self) -> Option<&'static str> {
                match self.0 {
                    $($code => Some($name),)+
                    _ => None,
                }
            }

            /// The code of that name.
            pub fn from_name(name: &str) -> Option<$set> {
                $set::ALL.into_iter().find(|known| known.name() == Some(name))
            }
        }

        // SAFETY: a byte, of which every value is one.
        unsafe impl $crate::sample::Plain for $set {}

        impl $crate::sample::Named for $set {
            const INITIAL: $set = $set::ALL[0];
            const CODES: &'static [u8] = &[$($code),+];

            fn wire_name(self) -> String {
                match self.name() {
                    Some(name) => name.to_owned(),
                    None => format!("unknown {}", self.0),
                }
            }

            fn from_wire(field: &'static str, name: &str) -> Result<$set, $crate::InvalidMessage> {
                $set::from_name(name)
                    .ok_or_else(|| $crate::sample::checks::unknown(field, name, $set::KNOWN))
            }

            fn check(self, field: &'static str) -> Result<(), $crate::InvalidMessage> {
                match self.name() {
                    Some(_) => Ok(()),
                    None => Err($crate::sample::checks::unknown(field, self.0, $set::KNOWN)),
                }
            }
        }
    };
}
pub(super) use codes;

/// The list of names: the one that is given, else all with commas between.
macro_rules! known {
    ([$known:literal] $($name:literal)+) => { $known };
    ([] $first:literal $($name:literal)*) => { concat!($first $(, ", ", $name)*) };
}
pub(super) use known;
