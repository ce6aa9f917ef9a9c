//! What a declaration says.

use proc_macro2::TokenStream;
use syn::{
    Data, DeriveInput, Error, Fields, Ident, LitInt, Path, Result, Visibility,
    meta::ParseNestedMeta, parse::Parser,
};

use crate::comment::docs;
use crate::field::{Field, Kind};

/// A message or a sample.
pub struct Declaration {
    pub visibility: Visibility,
    pub name: Ident,
    /// Lines of the comment.
    pub docs: Vec<String>,
    /// In the order of the wire.
    pub fields: Vec<Field>,
    pub wire: Wire,
    /// Looks at several fields together.
    pub check: Option<Path>,
    /// Tells whether all that the command can do is stop something.
    pub stops: Option<Path>,
    /// Where comments begin in the `.msg` text.
    pub comment_column: Option<usize>,
}

/// What it is on the wire.
pub enum Wire {
    /// Whatever the conversions by hand make of it.
    ByHand,
    /// A message of ferntast's own, with that name.
    Own(Ident),
    /// A type of ROS 2.
    Standard(Path),
}

impl Declaration {
    /// A sample whose conversions are written by hand.
    pub fn sample(item: DeriveInput) -> Result<Declaration> {
        let Data::Struct(data) = item.data else {
            return Err(Error::new_spanned(item.ident, "a sample is a struct"));
        };
        let Fields::Named(named) = data.fields else {
            return Err(Error::new_spanned(item.ident, "fields need names"));
        };
        let fields: Result<Vec<Field>> = named.named.into_iter().map(Field::read).collect();
        Ok(Declaration {
            visibility: item.vis,
            docs: docs(&item.attrs),
            name: item.ident,
            fields: fields?,
            wire: Wire::ByHand,
            check: None,
            stops: None,
            comment_column: None,
        })
    }

    /// A message, whose attribute has those arguments.
    pub fn message(arguments: TokenStream, item: DeriveInput) -> Result<Declaration> {
        let mut declaration = Declaration::sample(item)?;
        let parser = syn::meta::parser(|meta| declaration.argument(&meta));
        parser.parse2(arguments)?;
        let stamps = |field: &&Field| matches!(field.kind, Kind::Stamp);
        if declaration.fields.iter().filter(stamps).count() != 1 {
            let text = "a message has one field `stamp: Time`";
            return Err(Error::new_spanned(&declaration.name, text));
        }
        if matches!(declaration.wire, Wire::ByHand) {
            let text = "what is it on the wire? #[message(Name)] or #[message(standard = path)]";
            return Err(Error::new_spanned(&declaration.name, text));
        }
        Ok(declaration)
    }

    fn argument(&mut self, meta: &ParseNestedMeta) -> Result<()> {
        if meta.path.is_ident("standard") {
            self.wire = Wire::Standard(meta.value()?.parse()?);
        } else if meta.path.is_ident("check") {
            self.check = Some(meta.value()?.parse()?);
        } else if meta.path.is_ident("stops") {
            self.stops = Some(meta.value()?.parse()?);
        } else if meta.path.is_ident("comment_column") {
            let column: LitInt = meta.value()?.parse()?;
            self.comment_column = Some(column.base10_parse()?);
        } else {
            let name = meta.path.get_ident().cloned();
            self.wire = Wire::Own(name.ok_or_else(|| meta.error("not the name of a message"))?);
        }
        Ok(())
    }

    /// The fields that are on the wire beside the stamp.
    pub fn on_wire(&self) -> impl Iterator<Item = &Field> {
        self.fields
            .iter()
            .filter(|field| !field.local && !matches!(field.kind, Kind::Stamp))
    }

    /// Bytes to set aside at the end, so that the size is a multiple of the largest alignment.
    pub fn reserved(&self) -> usize {
        let sizes = self.fields.iter().map(|field| field.layout().0);
        let count = if self.first_list().is_some() { 4 } else { 0 };
        match self.fields.iter().any(|field| field.layout().1 == 8) {
            true => (8 - (sizes.sum::<usize>() + count) % 8) % 8,
            false => 0,
        }
    }

    /// The first of the lists, which says how long all are.
    pub fn first_list(&self) -> Option<&Field> {
        let mut lists = self.fields.iter().filter(|own| own.kind.list().is_some());
        match self.wire {
            Wire::ByHand => None,
            _ => lists.next(),
        }
    }
}
