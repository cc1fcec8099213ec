//! Whether all numbers of a value are numbers: JSON has no others, and whoever reads it back would find nothing in their place.

use serde::de::value::Error;
use serde::ser::{self, Serialize, Serializer};

/// Where the first number stands that is infinite or none, as in `receipt.findings[0].margin`.
pub fn not_finite(value: &impl Serialize) -> Option<String> {
    let mut walk = Walk { place: String::new(), found: None };
    // A value that cannot be written at all has its own error, where it is written.
    let _ = value.serialize(&mut walk);
    walk.found
}

/// Whether there is none such.
pub fn is_finite(value: &impl Serialize) -> bool {
    not_finite(value).is_none()
}

/// Goes through all that would be written.
struct Walk {
    place: String,
    found: Option<String>,
}

impl Walk {
    fn look(&mut self, number: f64) -> Result<(), Error> {
        if !number.is_finite() && self.found.is_none() {
            self.found = Some(if self.place.is_empty() { "it".into() } else { self.place.clone() });
        }
        Ok(())
    }

    fn inside(&mut self, step: String, value: &(impl Serialize + ?Sized)) -> Result<(), Error> {
        let length = self.place.len();
        self.place += if self.place.is_empty() { step.trim_start_matches('.') } else { &step };
        value.serialize(&mut *self)?;
        self.place.truncate(length);
        Ok(())
    }
}

/// The elements of a list or a map, with what they are called.
struct Elements<'w> {
    walk: &'w mut Walk,
    count: usize,
    key: String,
}

impl Elements<'_> {
    fn next(&mut self, value: &(impl Serialize + ?Sized)) -> Result<(), Error> {
        self.count += 1;
        self.walk.inside(format!("[{}]", self.count - 1), value)
    }
}

macro_rules! no_number {
    ($($method:ident: $kind:ty,)*) => { $(fn $method(self, _: $kind) -> Result<(), Error> { Ok(()) })* };
}

impl<'w> Serializer for &'w mut Walk {
    type Ok = ();
    type Error = Error;
    type SerializeSeq = Elements<'w>;
    type SerializeTuple = Elements<'w>;
    type SerializeTupleStruct = Elements<'w>;
    type SerializeTupleVariant = Elements<'w>;
    type SerializeMap = Elements<'w>;
    type SerializeStruct = Elements<'w>;
    type SerializeStructVariant = Elements<'w>;

    no_number! {
        serialize_bool: bool, serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64, serialize_u8: u8,
        serialize_u16: u16, serialize_u32: u32, serialize_u64: u64, serialize_char: char, serialize_str: &str,
        serialize_bytes: &[u8], serialize_unit_struct: &'static str,
    }

    fn serialize_f32(self, v: f32) -> Result<(), Error> {
        self.look(f64::from(v))
    }

    fn serialize_f64(self, v: f64) -> Result<(), Error> {
        self.look(v)
    }

    fn serialize_none(self) -> Result<(), Error> {
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), Error> {
        value.serialize(self)
    }

    fn serialize_unit(self) -> Result<(), Error> {
        Ok(())
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, _: &'static str) -> Result<(), Error> {
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<(), Error> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        value: &T,
    ) -> Result<(), Error> {
        self.inside(format!(".{variant}"), value)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Elements<'w>, Error> {
        Ok(Elements { walk: self, count: 0, key: String::new() })
    }

    fn serialize_tuple(self, _: usize) -> Result<Elements<'w>, Error> {
        self.serialize_seq(None)
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Elements<'w>, Error> {
        self.serialize_seq(None)
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Elements<'w>, Error> {
        self.serialize_seq(None)
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Elements<'w>, Error> {
        self.serialize_seq(None)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Elements<'w>, Error> {
        self.serialize_seq(None)
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Elements<'w>, Error> {
        self.serialize_seq(None)
    }
}

macro_rules! elements {
    ($($kind:ident: $method:ident,)*) => { $(impl ser::$kind for Elements<'_> {
        type Ok = ();
        type Error = Error;

        fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
            self.next(value)
        }

        fn end(self) -> Result<(), Error> {
            Ok(())
        }
    })* };
}

elements! {
    SerializeSeq: serialize_element,
    SerializeTuple: serialize_element,
    SerializeTupleStruct: serialize_field,
    SerializeTupleVariant: serialize_field,
}

macro_rules! fields {
    ($($kind:ident,)*) => { $(impl ser::$kind for Elements<'_> {
        type Ok = ();
        type Error = Error;

        fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), Error> {
            self.walk.inside(format!(".{key}"), value)
        }

        fn end(self) -> Result<(), Error> {
            Ok(())
        }
    })* };
}

fields! { SerializeStruct, SerializeStructVariant, }

impl ser::SerializeMap for Elements<'_> {
    type Ok = ();
    type Error = Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), Error> {
        // Keys are texts.
        let key = serde_json::to_value(key).unwrap_or_default();
        self.key = key.as_str().map_or_else(|| key.to_string(), String::from);
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
        self.walk.inside(format!(".{}", self.key), value)
    }

    fn end(self) -> Result<(), Error> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::not_finite;
    use serde::Serialize;
    use std::collections::BTreeMap;

    #[derive(Serialize)]
    enum Kind {
        Pair(f64, f64),
        Named { list: Vec<Option<f64>> },
        Nothing,
    }

    #[test]
    fn the_first_number_that_is_none_is_found_wherever_it_stands() {
        assert_eq!(not_finite(&[1.0, f64::MAX, -f64::MIN_POSITIVE]), None);
        assert_eq!(not_finite(&f64::NAN), Some("it".into()));
        assert_eq!(not_finite(&[[0.0, 1.0], [2.0, f64::INFINITY]]), Some("[1][1]".into()));
        let named = |last| Kind::Named { list: vec![None, Some(1.0), last] };
        let all = |last| BTreeMap::from([("a", vec![Kind::Nothing, Kind::Pair(0.0, 1.0)]), ("b", vec![named(last)])]);
        assert_eq!(not_finite(&all(Some(2.0))), None);
        assert_eq!(not_finite(&all(Some(f64::NEG_INFINITY))), Some("b[0].list[2]".into()));
        assert_eq!(not_finite(&(0, "text", Kind::Pair(1.0, f64::NAN))), Some("[2][1]".into()));
    }
}
