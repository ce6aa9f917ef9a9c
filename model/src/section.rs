//! A section of parameters, declared once: [`parameters!`](crate::parameters).
//!
//! The declaration is that of a struct, with what has to hold of a field in
//! square brackets behind its type and its default, if it has one, behind `=`:
//!
//! ```
//! ferntast_model::parameters! {
//!     /// How a joint is held.
//!     #[derive(Copy)]
//!     pub struct Hold {
//!         /// Stiffness \[Nm/rad\].
//!         pub stiffness: [f64; 2] [0.0..=1e6, "Nm/rad"] = [1000.0, 800.0],
//!         /// Force from which on there is contact \[N\].
//!         pub contact_on: f64 [0.0..=1e3, "N"] = 1.0,
//!         /// Force below which contact ends \[N\].
//!         pub contact_off: f64 [0.0..=*contact_on, "N"] = 0.5,
//!         /// Whether it is held at all: nothing to check.
//!         pub enabled: bool = true,
//!     }
//! }
//! let hold: Hold = toml::from_str("stiffness = [1000.0, -1.0]").unwrap();
//! assert_eq!(
//!     hold.validate().unwrap_err().to_string(),
//!     "stiffness[1] = -1 Nm/rad is outside 0 … 1000000 Nm/rad; set it within these bounds"
//! );
//! ```
//!
//! * `[bounds, "unit"]`: a [`Bounded`] value (a number, an array or a list of
//!   them, or an optional one); all have to be within the bounds. The bounds may
//!   name the struct's fields, as references. Where the key in files is not the
//!   field's name, it follows: `[bounds, "unit", "key"]`.
//! * `[section]`: a [`Section`] of its own, or an array, a list or an option of
//!   such. Its keys come behind the field's name.
//! * `check PATH;` behind the struct: `fn(&Self) -> Result<(), ParameterError>`
//!   for what concerns several fields; called after the fields are within bounds.
//!
//! The struct gets `Clone`, `Debug`, `PartialEq`, serde with unknown keys
//! refused, [`Section`] and a method `validate`. If every field has a default it
//! gets `Default` too, and in files every key may be left out.

use std::ops::RangeInclusive;

use crate::{ParameterError, check};

/// What can be checked as a whole.
pub trait Section {
    /// Checks every value against its bounds; keys start with `key`.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, with key, value, bounds, unit.
    fn validate_at(&self, key: &str) -> Result<(), ParameterError>;
}

impl<T: Section> Section for Option<T> {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        self.as_ref().map_or(Ok(()), |own| own.validate_at(key))
    }
}

impl<T: Section> Section for [T] {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        let mut each = self.iter().enumerate();
        each.try_for_each(|(index, own)| own.validate_at(&format!("{key}[{index}]")))
    }
}

impl<T: Section, const N: usize> Section for [T; N] {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        self.as_slice().validate_at(key)
    }
}

impl<T: Section> Section for Vec<T> {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        self.as_slice().validate_at(key)
    }
}

/// What can be held against bounds.
pub trait Bounded {
    /// Checks that every number is finite and within `bounds`.
    ///
    /// # Errors
    ///
    /// [`ParameterError::OutOfBounds`] naming `key`, value, bounds and `unit`.
    fn check_bounds(
        &self,
        key: &str,
        bounds: &RangeInclusive<f64>,
        unit: &'static str,
    ) -> Result<(), ParameterError>;
}

/// Numbers, as the nearest `f64`.
macro_rules! bounded_numbers {
    ($($number:ty)*) => {$(
        impl Bounded for $number {
            fn check_bounds(
                &self,
                key: &str,
                bounds: &RangeInclusive<f64>,
                unit: &'static str,
            ) -> Result<(), ParameterError> {
                check(key, *self as f64, *bounds.start(), *bounds.end(), unit)
            }
        }
    )*};
}
bounded_numbers!(f64 u32 u64 usize i64);

impl<T: Bounded> Bounded for Option<T> {
    fn check_bounds(
        &self,
        key: &str,
        bounds: &RangeInclusive<f64>,
        unit: &'static str,
    ) -> Result<(), ParameterError> {
        let check = |own: &T| own.check_bounds(key, bounds, unit);
        self.as_ref().map_or(Ok(()), check)
    }
}

impl<T: Bounded> Bounded for [T] {
    fn check_bounds(
        &self,
        key: &str,
        bounds: &RangeInclusive<f64>,
        unit: &'static str,
    ) -> Result<(), ParameterError> {
        let mut each = self.iter().enumerate();
        each.try_for_each(|(index, own)| own.check_bounds(&format!("{key}[{index}]"), bounds, unit))
    }
}

impl<T: Bounded, const N: usize> Bounded for [T; N] {
    fn check_bounds(
        &self,
        key: &str,
        bounds: &RangeInclusive<f64>,
        unit: &'static str,
    ) -> Result<(), ParameterError> {
        self.as_slice().check_bounds(key, bounds, unit)
    }
}

impl<T: Bounded> Bounded for Vec<T> {
    fn check_bounds(
        &self,
        key: &str,
        bounds: &RangeInclusive<f64>,
        unit: &'static str,
    ) -> Result<(), ParameterError> {
        self.as_slice().check_bounds(key, bounds, unit)
    }
}

/// Declares a section of parameters; see the [module](crate::section).
#[macro_export]
macro_rules! parameters {
    (@field $field:ident [section]) => {
        $crate::Section::validate_at($field, stringify!($field))?
    };
    (@field $field:ident [$bounds:expr, $unit:literal]) => {
        $crate::parameters!(@field $field [$bounds, $unit, stringify!($field)])
    };
    (@field $field:ident [$bounds:expr, $unit:literal, $key:expr]) => {
        $crate::Bounded::check_bounds($field, $key, &($bounds), $unit)?
    };

    // Every field has a default.
    (
        $(#[$attribute:meta])*
        pub struct $name:ident {
            $(
                $(#[$field_attribute:meta])*
                pub $field:ident: $type:ty $([$($rule:tt)+])? = $default:expr,
            )+
        }
        $(check $check:path;)?
    ) => {
        $crate::parameters! {
            $(#[$attribute])*
            #[serde(default)]
            pub struct $name {
                $(
                    $(#[$field_attribute])*
                    pub $field: $type $([$($rule)+])?,
                )+
            }
            $(check $check;)?
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)+ }
            }
        }
    };

    // No field has one, unless by attributes of serde.
    (
        $(#[$attribute:meta])*
        pub struct $name:ident {
            $(
                $(#[$field_attribute:meta])*
                pub $field:ident: $type:ty $([$($rule:tt)+])?,
            )+
        }
        $(check $check:path;)?
    ) => {
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        $(#[$attribute])*
        pub struct $name {
            $(
                $(#[$field_attribute])*
                pub $field: $type,
            )+
        }

        impl $name {
            /// Checks every value against its bounds.
            ///
            /// # Errors
            ///
            /// The first value that is out of bounds, with key, value, bounds, unit.
            #[allow(unused_variables)]
            pub fn validate(&self) -> Result<(), $crate::ParameterError> {
                let Self { $($field,)+ } = self;
                $($($crate::parameters!(@field $field [$($rule)+]);)?)+
                $($check(self)?;)?
                Ok(())
            }
        }

        impl $crate::Section for $name {
            fn validate_at(&self, key: &str) -> Result<(), $crate::ParameterError> {
                self.validate().map_err(|error| error.within(key))
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    parameters! {
        /// One of several.
        #[derive(Copy)]
        pub struct Part {
            /// \[kg\]
            #[serde(rename = "M")]
            pub mass: f64 [0.1..=10.0, "kg", "M"],
        }
    }

    parameters! {
        /// All there is.
        pub struct Whole {
            /// \[m\]
            pub place: Option<[f64; 2]> [-1.0..=1.0, "m"] = None,
            /// \[-\]
            pub least: u32 [0.0..=100.0, "-"] = 1,
            /// \[-\]
            pub most: f64 [f64::from(*least)..=100.0, "-"] = 2.0,
            /// Parts.
            pub part: Vec<Part> [section] = vec![Part { mass: 1.0 }],
            /// Not checked.
            pub note: String = String::new(),
        }
        check Whole::is_named;
    }

    impl Whole {
        fn is_named(&self) -> Result<(), ParameterError> {
            let named = self.part.is_empty() || self.note != "none";
            named.then_some(()).ok_or(ParameterError::Inconsistent {
                key: "note".into(),
                reason: "parts need one".into(),
            })
        }
    }

    fn error(text: &str) -> Option<String> {
        let whole: Whole = toml::from_str(text).unwrap();
        whole.validate().err().map(|error| error.to_string())
    }

    #[test]
    fn errors_name_the_path_of_the_key() {
        assert_eq!(error(""), None);
        let wrong = [
            ("place = [0.0, 1.5]", "place[1] = 1.5 m is outside -1 … 1 m"),
            ("least = 101", "least = 101 is outside 0 … 100;"),
            ("least = 3", "most = 2 is outside 3 … 100;"),
            (
                "part = [{ M = 1.0 }, { M = nan }]",
                "part[1].M = NaN kg is outside 0.1 … 10 kg",
            ),
            ("note = \"none\"", "note: parts need one"),
        ];
        for (text, expected) in wrong {
            let found = error(text).unwrap();
            assert!(found.starts_with(expected), "{found}");
        }
    }

    #[test]
    fn unknown_and_missing_keys_are_refused() {
        assert!(toml::from_str::<Whole>("mots = 3.0").is_err());
        assert!(toml::from_str::<Part>("").is_err());
    }
}
