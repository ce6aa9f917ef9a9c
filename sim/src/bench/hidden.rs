//! Names of what a recording can hide.

use std::fmt::Display;

/// An effect that is in the truth of a recording and not in the model that the
/// experimenter believes in.
pub trait Hideable: Copy + Ord + Display + Send + Sync + 'static {
    /// All of them, the catalogue's first.
    const ALL: &'static [Self];

    /// The id in files, on the command line and in JSON.
    fn id(self) -> &'static str;

    /// Ids that count as the right answer; empty outside the catalogue.
    fn accepted(self) -> &'static [&'static str];

    /// What both effects change, where they cannot act side by side.
    fn overlap(self, _other: Self) -> Option<&'static str> {
        None
    }

    /// True for an effect that the catalogue has.
    fn in_catalogue(self) -> bool {
        !self.id().starts_with("unknown_")
    }
}

/// Makes the enum of what a bench can hide: `Variant = "id"`, those in no
/// catalogue with an id that begins with `unknown_`.
macro_rules! hidden_effects {
    ($(#[$doc:meta])* pub enum HiddenEffect {
        $($(#[$each:meta])* $variant:ident = $id:literal,)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum HiddenEffect {
            $($(#[$each])* $variant,)*
        }

        impl HiddenEffect {
            /// All of them, the catalogue's first.
            pub const ALL: &'static [HiddenEffect] = &[$(HiddenEffect::$variant,)*];
            /// Their ids in the same order.
            const IDS: &'static [&'static str] = &[$($id,)*];

            /// The id in files, on the command line and in JSON.
            pub const fn id(self) -> &'static str {
                match self {
                    $(HiddenEffect::$variant => $id,)*
                }
            }

            /// The id as a list of one; none outside the catalogue.
            fn own_id(self) -> &'static [&'static str] {
                let index = self as usize;
                match self.id().starts_with("unknown_") {
                    true => &[],
                    false => Self::IDS.get(index..=index).unwrap_or_default(),
                }
            }
        }

        impl std::fmt::Display for HiddenEffect {
            fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str(self.id())
            }
        }

        impl std::str::FromStr for HiddenEffect {
            type Err = $crate::bench::BenchError;

            fn from_str(id: &str) -> Result<Self, Self::Err> {
                let mut all = Self::ALL.iter().copied();
                all.find(|effect| effect.id() == id)
                    .ok_or_else(|| $crate::bench::BenchError::UnknownEffect {
                        id: id.into(),
                        known: Self::IDS.join(", "),
                    })
            }
        }
    };
}
pub(crate) use hidden_effects;
