//! A field of a declaration.

use proc_macro2::TokenStream;
use quote::ToTokens;
use syn::{
    Error, Expr, ExprLit, GenericArgument, Ident, Lit, LitInt, LitStr, PathArguments, PathSegment,
    Result, Type, Visibility, meta::ParseNestedMeta,
};

use crate::comment::docs;

/// A field.
pub struct Field {
    pub visibility: Visibility,
    pub name: Ident,
    pub kind: Kind,
    pub r#type: Type,
    /// Lines of the comment.
    pub docs: Vec<String>,
    /// Name on the wire.
    pub wire_name: Ident,
    /// An empty line before it in the `.msg` text, and a comment.
    pub section: Option<Option<String>>,
    pub or_nan: bool,
    pub or_infinite: bool,
    /// Neither empty nor cut; what it may be, for error texts.
    pub whole: Option<String>,
    pub local: bool,
    /// Size of a type that is not known here.
    bytes: Option<usize>,
}

/// What a field holds.
pub enum Kind {
    Stamp,
    Float,
    Integer,
    Flag,
    Text,
    Identity,
    /// Numbers, as many as that at most.
    Floats(Expr),
    /// Texts, as many as that at most.
    Texts(Expr),
    /// A code that has a name.
    Named,
}

impl Kind {
    /// Room of a list.
    pub fn list(&self) -> Option<&Expr> {
        match self {
            Kind::Floats(room) | Kind::Texts(room) => Some(room),
            _ => None,
        }
    }
}

impl Field {
    /// The field with what its attributes say.
    pub fn read(field: syn::Field) -> Result<Field> {
        let Some(name) = field.ident else {
            return Err(Error::new_spanned(field.ty, "fields need names"));
        };
        let mut read = Field {
            docs: docs(&field.attrs),
            kind: kind(&field.ty),
            wire_name: name.clone(),
            r#type: field.ty,
            visibility: field.vis,
            name,
            section: None,
            or_nan: false,
            or_infinite: false,
            whole: None,
            local: false,
            bytes: None,
        };
        for attribute in field
            .attrs
            .iter()
            .filter(|own| own.path().is_ident("field"))
        {
            attribute.parse_nested_meta(|meta| read.argument(&meta))?;
        }
        Ok(read)
    }

    fn argument(&mut self, meta: &ParseNestedMeta) -> Result<()> {
        let path = &meta.path;
        if path.is_ident("or_nan") {
            self.or_nan = true;
        } else if path.is_ident("or_infinite") {
            self.or_infinite = true;
        } else if path.is_ident("whole") {
            let known: LitStr = meta.value()?.parse()?;
            self.whole = Some(known.value());
        } else if path.is_ident("local") {
            self.local = true;
        } else if path.is_ident("bytes") {
            let bytes: LitInt = meta.value()?.parse()?;
            self.bytes = Some(bytes.base10_parse()?);
        } else if path.is_ident("name") {
            let name: LitStr = meta.value()?.parse()?;
            self.wire_name = name.parse()?;
        } else if path.is_ident("section") {
            let text = meta.value().ok().map(|value| value.parse::<LitStr>());
            self.section = Some(text.transpose()?.map(|text| text.value()));
        } else {
            let known = "or_nan, or_infinite, whole, local, bytes, name or section";
            return Err(meta.error(known));
        }
        Ok(())
    }

    /// Size, up to a multiple of 8, and alignment \[B\].
    pub fn layout(&self) -> (usize, usize) {
        match self.bytes {
            Some(bytes) if bytes % 8 == 0 => (8, 8),
            Some(bytes) => (bytes, if bytes % 4 == 0 { 4 } else { 1 }),
            None => layout(&self.r#type),
        }
    }

    /// The comment as one line of Rust documentation; there always is one.
    pub fn documentation(&self) -> TokenStream {
        let lines = match self.docs.as_slice() {
            [] => vec![format!("`{}`, as its name says.", self.name)],
            lines => lines.to_vec(),
        };
        quote::quote!(#(#[doc = #lines])*)
    }

    /// The type in the ROS 2 form.
    pub fn ros_type(&self) -> TokenStream {
        match &self.kind {
            Kind::Flag => quote::quote!(bool),
            Kind::Float | Kind::Integer => self.r#type.to_token_stream(),
            Kind::Floats(_) => quote::quote!(Vec<f64>),
            Kind::Texts(_) => quote::quote!(Vec<String>),
            Kind::Stamp => quote::quote!(crate::ros::std_msgs::Header),
            Kind::Text | Kind::Identity | Kind::Named => quote::quote!(String),
        }
    }

    /// The type in a `.msg` text.
    pub fn msg_type(&self) -> String {
        let number = || match last(&self.r#type).map(|own| own.ident.to_string()) {
            Some(name) if name.starts_with('f') => format!("float{}", &name[1..]),
            Some(name) if name.starts_with('u') => format!("uint{}", &name[1..]),
            Some(name) => format!("int{}", &name[1..]),
            None => String::new(),
        };
        match &self.kind {
            Kind::Float | Kind::Integer => number(),
            Kind::Flag => "bool".to_owned(),
            Kind::Floats(_) => "float64[]".to_owned(),
            Kind::Texts(_) => "string[]".to_owned(),
            Kind::Stamp => "std_msgs/Header".to_owned(),
            Kind::Text | Kind::Identity | Kind::Named => "string".to_owned(),
        }
    }
}

/// The last part of a type's path.
fn last(r#type: &Type) -> Option<&PathSegment> {
    match r#type {
        Type::Path(path) => path.path.segments.last(),
        _ => None,
    }
}

fn kind(r#type: &Type) -> Kind {
    if let Type::Array(array) = r#type {
        let room = array.len.clone();
        return match kind(&array.elem) {
            Kind::Text => Kind::Texts(room),
            _ => Kind::Floats(room),
        };
    }
    let name = last(r#type).map(|own| own.ident.to_string());
    match name.as_deref() {
        Some("Time") => Kind::Stamp,
        Some("f64") => Kind::Float,
        Some("u8" | "u16" | "u32" | "u64" | "i8" | "i16" | "i32" | "i64") => Kind::Integer,
        Some("Flag") => Kind::Flag,
        Some("Text") => Kind::Text,
        Some("Identity") => Kind::Identity,
        _ => Kind::Named,
    }
}

/// Size, up to a multiple of 8, and alignment \[B\].
fn layout(r#type: &Type) -> (usize, usize) {
    if let Type::Array(array) = r#type {
        let (size, align) = layout(&array.elem);
        // A number of elements that is a constant does not matter where eight bytes make one.
        return (size * whole_number(&array.len).unwrap_or(1) % 8, align);
    }
    let Some(own) = last(r#type) else {
        return (1, 1);
    };
    match own.ident.to_string().as_str() {
        "Time" | "Identity" | "f64" | "u64" | "i64" => (0, 8),
        "u32" | "i32" => (4, 4),
        "u16" | "i16" => (2, 2),
        "Text" => (text_size(own).unwrap_or(0) % 8, 1),
        _ => (1, 1),
    }
}

/// `N` of `Text<N>`.
fn text_size(own: &PathSegment) -> Option<usize> {
    match &own.arguments {
        PathArguments::AngleBracketed(arguments) => match arguments.args.first()? {
            GenericArgument::Const(size) => whole_number(size),
            _ => None,
        },
        _ => None,
    }
}

fn whole_number(expression: &Expr) -> Option<usize> {
    match expression {
        Expr::Lit(ExprLit {
            lit: Lit::Int(number),
            ..
        }) => number.base10_parse().ok(),
        _ => None,
    }
}
