//! ROS 2 messages of any type as others may send them: anything, or nearly right.

use serde::{
    de::{self, DeserializeOwned, DeserializeSeed, IntoDeserializer, SeqAccess, Visitor},
    forward_to_deserialize_any,
};

/// A message by the dice of `seed`; texts are mostly some of `words`.
pub fn message<R: DeserializeOwned>(seed: u64, words: &[String]) -> R {
    let mut dice = Dice {
        state: seed,
        words,
        length: 0,
    };
    dice.length = dice.below(20);
    R::deserialize(&mut dice).expect("a message reads anything")
}

struct Dice<'a> {
    state: u64,
    words: &'a [String],
    /// How long most sequences are.
    length: usize,
}

impl Dice<'_> {
    /// The next 64 bits (SplitMix64).
    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }

    fn number(&mut self) -> f64 {
        match self.below(300) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => f64::from_bits(self.next()),
            _ => self.next() as i32 as f64 * 1e-6,
        }
    }

    fn text(&mut self) -> String {
        match self.below(8) {
            0 => (0..self.below(120))
                .filter_map(|_| char::from_u32(self.below(0x800) as u32))
                .collect(),
            _ => {
                let word = self.below(self.words.len());
                self.words[word].clone()
            }
        }
    }
}

type Error = de::value::Error;

macro_rules! integers {
    ($($method:ident $visit:ident $type:ty;)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
            visitor.$visit(self.next() as $type)
        })*
    };
}

impl<'de> de::Deserializer<'de> for &mut Dice<'_> {
    type Error = Error;

    integers! {
        deserialize_i8 visit_i8 i8;
        deserialize_u8 visit_u8 u8;
        deserialize_i16 visit_i16 i16;
        deserialize_u16 visit_u16 u16;
        deserialize_i32 visit_i32 i32;
        deserialize_u32 visit_u32 u32;
        deserialize_i64 visit_i64 i64;
        deserialize_u64 visit_u64 u64;
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_bool(self.below(2) == 1)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_f64(self.number())
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_string(self.text())
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let left = match self.below(50) {
            0 => self.below(20),
            _ => self.length,
        };
        visitor.visit_seq(Elements { dice: self, left })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let left = fields.len();
        visitor.visit_seq(Elements { dice: self, left })
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        ().into_deserializer().deserialize_any(visitor)
    }

    forward_to_deserialize_any! {
        char str bytes byte_buf option unit unit_struct newtype_struct tuple tuple_struct map enum
        identifier ignored_any f32
    }
}

struct Elements<'a, 'b> {
    dice: &'a mut Dice<'b>,
    left: usize,
}

impl<'de> SeqAccess<'de> for Elements<'_, '_> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Error> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(&mut *self.dice).map(Some)
    }
}
