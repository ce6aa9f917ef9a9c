//! Finds out what a type reads through serde: a deserializer that answers
//! every question with zero (and every sequence with one element) and writes
//! down what was asked.

use serde::{
    Deserialize,
    de::{self, DeserializeOwned, DeserializeSeed, SeqAccess, Visitor},
    forward_to_deserialize_any,
};

/// What a type reads.
#[derive(Debug, PartialEq)]
pub enum Shape {
    /// A number, truth value or text, by the word of the `.msg` format.
    Leaf(&'static str),
    /// Any number of one thing.
    Sequence(Box<Shape>),
    /// Named fields in order.
    Struct(Vec<(String, Shape)>),
}

/// What `M` reads.
pub fn shape<M: DeserializeOwned>() -> Shape {
    let mut shape = None;
    M::deserialize(Tracer(&mut shape)).expect("a message reads zeros");
    shape.expect("a message reads something")
}

struct Tracer<'a>(&'a mut Option<Shape>);

type Error = de::value::Error;

macro_rules! leaves {
    ($($method:ident $visit:ident $zero:expr => $name:literal;)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
            *self.0 = Some(Shape::Leaf($name));
            visitor.$visit($zero)
        })*
    };
}

impl<'de> de::Deserializer<'de> for Tracer<'_> {
    type Error = Error;

    leaves! {
        deserialize_bool visit_bool false => "bool";
        deserialize_i8 visit_i8 0 => "int8";
        deserialize_u8 visit_u8 0 => "uint8";
        deserialize_i16 visit_i16 0 => "int16";
        deserialize_u16 visit_u16 0 => "uint16";
        deserialize_i32 visit_i32 0 => "int32";
        deserialize_u32 visit_u32 0 => "uint32";
        deserialize_i64 visit_i64 0 => "int64";
        deserialize_u64 visit_u64 0 => "uint64";
        deserialize_f32 visit_f32 0.0 => "float32";
        deserialize_f64 visit_f64 0.0 => "float64";
        deserialize_str visit_str "" => "string";
        deserialize_string visit_str "" => "string";
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let mut elements = Vec::new();
        let value = visitor.visit_seq(Elements {
            left: 1,
            seen: &mut elements,
        })?;
        *self.0 = elements
            .pop()
            .map(|element| Shape::Sequence(Box::new(element)));
        Ok(value)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let mut elements = Vec::new();
        let value = visitor.visit_seq(Elements {
            left: fields.len(),
            seen: &mut elements,
        })?;
        let names = fields.iter().map(|name| (*name).to_owned());
        *self.0 = Some(Shape::Struct(names.zip(elements).collect()));
        Ok(value)
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(de::Error::custom("no part of the .msg format"))
    }

    forward_to_deserialize_any! {
        char bytes byte_buf option unit unit_struct newtype_struct tuple tuple_struct map enum
        identifier ignored_any
    }
}

struct Elements<'a> {
    left: usize,
    seen: &'a mut Vec<Shape>,
}

impl<'de> SeqAccess<'de> for Elements<'_> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Error> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        let mut shape = None;
        let value = seed.deserialize(Tracer(&mut shape))?;
        self.seen.extend(shape);
        Ok(Some(value))
    }
}

#[test]
fn what_is_read_is_written_down() {
    #[derive(Deserialize)]
    #[allow(dead_code)]
    struct Example {
        number: u16,
        texts: Vec<String>,
    }
    let texts = Shape::Sequence(Box::new(Shape::Leaf("string")));
    assert_eq!(
        shape::<Example>(),
        Shape::Struct(vec![
            ("number".to_owned(), Shape::Leaf("uint16")),
            ("texts".to_owned(), texts)
        ])
    );
}
