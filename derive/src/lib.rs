//! The attributes `#[message]` and `#[sample]` of `ferntast-msgs`.
//!
//! A message is declared once, as the struct of its sample; fields stand in
//! the order of the wire, their comments are those of the `.msg` text:
//!
//! ```text
//! /// What the recorder does.
//! #[message(RecorderStatus)]
//! pub struct RecorderStatusSample {
//!     /// when it was said
//!     pub stamp: Time,
//!     /// it writes
//!     pub recording: Flag,
//!     /// where to, or where to it wrote last
//!     pub folder: Text<96>,
//! }
//! ```
//!
//! `#[message(Name)]` is a message of ferntast's own, `ferntast_msgs/msg/Name`;
//! `#[message(standard = path::Type)]` one that ROS 2 has, whose fields have
//! the same names. Further arguments: `check = function` looks at several
//! fields together; `stops = function` tells of a command whether all it can do is stop
//! something, which anybody may; `comment_column = N` is where comments begin in the `.msg`
//! text. `#[sample]` is the layout alone, for samples whose conversions are
//! written by hand.
//!
//! | type of a field | on the wire | refused |
//! |---|---|---|
//! | `Time`, always named `stamp` | `std_msgs/Header header` | zero, later than ROS 2 can hold |
//! | `f64` | `float64` | NaN, infinity |
//! | `u8` … `i64` | `uint8` … `int64` | |
//! | `Flag` | `bool` | other than 0 and 1 |
//! | `Text<N>` | `string`, cut to N bytes | |
//! | `Identity` | `string`, hexadecimal | other digits |
//! | `[f64; N]`, `[Text<M>; N]` | lists, all of one length `count` ≤ N | another length, NaN, infinity |
//! | any other | `string`: the name of a code | a code without a name |
//!
//! `#[field(…)]` says more of a field: `or_nan`, `or_infinite` allow that
//! number; `whole = "what it may be"` refuses a text that is empty or would have
//! to be cut; `name = "…"` is another name on the wire; `local` keeps it off the wire;
//! `section`, `section = "…"` set an empty line, and a comment, before it in
//! the `.msg` text; `bytes = N` is the size of a type that is not in the table
//! and has more than one byte.
//!
//! Fields are laid out by falling alignment, with one explicit `reserved` at
//! the end, so that no padding crosses shared memory unset; it is a compile
//! error where that does not come out.

mod comment;
mod declaration;
mod expand;
mod field;
mod text;

use proc_macro::TokenStream;
use syn::{DeriveInput, parse_macro_input};

use declaration::Declaration;

/// Declares a message; see the crate's page.
#[proc_macro_attribute]
pub fn message(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let item = parse_macro_input!(item as DeriveInput);
    let declaration = Declaration::message(arguments.into(), item);
    written(declaration.and_then(|declaration| expand::message(&declaration)))
}

/// Declares a sample whose conversions are written by hand; see the crate's page.
#[proc_macro_attribute]
pub fn sample(_: TokenStream, item: TokenStream) -> TokenStream {
    let item = parse_macro_input!(item as DeriveInput);
    written(Declaration::sample(item).map(|declaration| expand::sample(&declaration)))
}

fn written(result: syn::Result<proc_macro2::TokenStream>) -> TokenStream {
    result.unwrap_or_else(syn::Error::into_compile_error).into()
}
