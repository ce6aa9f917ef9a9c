//! Enums whose variants have an id in files, on the command line and in JSON.

/// Makes such an enum: `Variant = "id"`; `$unknown` is the variant of
/// [`BenchError`](super::BenchError) for an id that none has.
macro_rules! named {
    ($(#[$doc:meta])* pub enum $name:ident or $unknown:ident {
        $($(#[$each:meta])* $variant:ident = $id:literal,)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $name {
            $($(#[$each])* $variant,)*
        }

        impl $name {
            /// All of them.
            pub const ALL: &'static [$name] = &[$($name::$variant,)*];
            /// Their ids in the same order.
            pub const IDS: &'static [&'static str] = &[$($id,)*];

            /// The id in files, on the command line and in JSON.
            pub const fn id(self) -> &'static str {
                match self {
                    $($name::$variant => $id,)*
                }
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str(self.id())
            }
        }

        impl std::str::FromStr for $name {
            type Err = $crate::bench::BenchError;

            fn from_str(id: &str) -> Result<Self, Self::Err> {
                let mut all = Self::ALL.iter().copied();
                all.find(|own| own.id() == id)
                    .ok_or_else(|| $crate::bench::BenchError::$unknown {
                        id: id.into(),
                        known: Self::IDS.join(", "),
                    })
            }
        }
    };
}
pub(crate) use named;
