//! Reading objects as objects, names as names, whole numbers as integers, and numbers with their units as texts.
//!
//! Serde also takes a list for a struct (its entries for the fields, in their order) and `{"grid": null}` for the name `"grid"`. No schema
//! describes either, and a list comes to mean other fields as soon as one is added.

use std::fmt;

use drillsweep_quantity::{Units, entry, of};
use serde::Deserialize;
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, IgnoredAny, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;

/// Reads a type out of a format that describes itself, such as JSON or TOML: its structs out of objects only, its names out of text
/// only. A number of a quantity of the vocabulary may be a text with its unit (`"10.5 ppg"`, [`drillsweep_quantity::entry`]).
///
/// # Errors
/// The type's own problems, a list in place of a struct or an object in place of a name, and a unit that does not fit.
pub fn read_strictly<'de, T: Deserialize<'de>, D: Deserializer<'de>>(format: D) -> Result<T, D::Error> {
    T::deserialize(Strict(format, Path(None)))
}

/// A deserializer, visitor, seed or access of serde's that reads structs, names and numbers strictly, with the path of the value.
struct Strict<'p, T>(T, Path<'p>);

/// Names of the members that lead to a value, without indices of lists.
#[derive(Clone, Copy)]
struct Path<'p>(Option<&'p Member<'p>>);

struct Member<'p> {
    name: &'p str,
    above: Path<'p>,
}

impl Path<'_> {
    /// Units of the number at this path: of a field of a scenario, wherever that is in the document, or of an axis or a column of
    /// this name.
    fn units(self) -> Option<&'static Units> {
        let members = std::iter::successors(self.0, |member| member.above.0);
        let mut names: Vec<&str> = members.map(|member| member.name).collect();
        names.reverse();
        let parts =
            (0..names.len()).flat_map(|start| (start..names.len()).rev().map(move |end| (start, end)));
        // A name on the way may be that of a column without units, as `scenario` is.
        parts.map(|(start, end)| names[start..=end].join(".")).find_map(|path| of(&path)?.units)
    }
}

/// Declares methods of a deserializer that read an integer.
macro_rules! read_whole {
    ($($method:ident)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
            self.0.deserialize_any(Whole(visitor))
        }
    )*};
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<'_, D> {
    type Error = D::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.0.deserialize_any(Strict(visitor, self.1))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.0.deserialize_option(Strict(visitor, self.1))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_newtype_struct(name, Strict(visitor, self.1))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_any(Struct(visitor, self.1))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_any(Enum(visitor, self.1))
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.0.deserialize_any(Number(visitor, self.1))
    }

    fn is_human_readable(&self) -> bool {
        self.0.is_human_readable()
    }

    read_whole! {
        deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64 deserialize_i128 deserialize_u8 deserialize_u16 deserialize_u32
        deserialize_u64 deserialize_u128
    }

    forward_to_deserialize_any! {
        bool f32 char str string bytes byte_buf unit unit_struct seq tuple tuple_struct map
        identifier ignored_any
    }
}

/// Declares methods of a visitor that hand on a scalar or text.
macro_rules! hand_on {
    ($($method:ident($type:ty))*) => {$(
        fn $method<E: Error>(self, value: $type) -> Result<V::Value, E> {
            self.0.$method(value)
        }
    )*};
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Strict<'_, V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(formatter)
    }

    hand_on! {
        visit_bool(bool) visit_i64(i64) visit_i128(i128) visit_u64(u64) visit_u128(u128) visit_f64(f64) visit_char(char) visit_str(&str)
        visit_borrowed_str(&'de str) visit_string(String) visit_bytes(&[u8]) visit_borrowed_bytes(&'de [u8]) visit_byte_buf(Vec<u8>)
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_unit()
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_none()
    }

    fn visit_some<D: Deserializer<'de>>(self, format: D) -> Result<V::Value, D::Error> {
        self.0.visit_some(Strict(format, self.1))
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, format: D) -> Result<V::Value, D::Error> {
        self.0.visit_newtype_struct(Strict(format, self.1))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<V::Value, A::Error> {
        self.0.visit_seq(Strict(entries, self.1))
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(Members::new(members, self.1))
    }
}

/// The visitor of an integer, which also takes a float without a fraction: to JSON Schema 2.0 is an integer, and some clients write
/// integers so.
struct Whole<V>(V);

impl<'de, V: Visitor<'de>> Visitor<'de> for Whole<V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(formatter)
    }

    hand_on! {
        visit_bool(bool) visit_i64(i64) visit_i128(i128) visit_u64(u64) visit_u128(u128) visit_char(char) visit_str(&str)
        visit_borrowed_str(&'de str) visit_string(String) visit_bytes(&[u8]) visit_borrowed_bytes(&'de [u8]) visit_byte_buf(Vec<u8>)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<V::Value, E> {
        /// Beyond it a float does not hold every integer.
        const LARGEST: f64 = (1_u64 << 53) as f64;
        if value.fract() == 0.0 && value.abs() <= LARGEST {
            return self.0.visit_i64(value as i64);
        }
        self.0.visit_f64(value)
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_unit()
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<V::Value, A::Error> {
        self.0.visit_seq(entries)
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(members)
    }
}

/// The visitor of a struct, which takes objects. All else is refused as of a wrong type, in the visitor's own words.
struct Struct<'p, V>(V, Path<'p>);

impl<'de, V: Visitor<'de>> Visitor<'de> for Struct<'_, V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(formatter)
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(Members::new(members, self.1))
    }
}

/// The visitor of an enum, which takes the name of a variant, or an object whose one member is named so and holds the variant's content.
struct Enum<'p, V>(V, Path<'p>);

impl<'de, V: Visitor<'de>> Visitor<'de> for Enum<'_, V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(formatter)
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<V::Value, E> {
        self.0.visit_enum(StrDeserializer::new(name))
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<V::Value, A::Error> {
        self.0.visit_enum(Variants(Members::new(members, self.1)))
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Strict<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, format: D) -> Result<S::Value, D::Error> {
        self.0.deserialize(Strict(format, self.1))
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Strict<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, A::Error> {
        self.0.next_element_seed(Strict(seed, self.1))
    }

    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

/// Members of an object, each read with its name.
struct Members<'p, A> {
    members: A,
    path: Path<'p>,
    /// Name of the member whose value is read next.
    name: String,
}

impl<'p, A> Members<'p, A> {
    fn new(members: A, path: Path<'p>) -> Self {
        Members { members, path, name: String::new() }
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Members<'_, A> {
    type Error = A::Error;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, A::Error> {
        self.members.next_key_seed(Named { seed, name: &mut self.name })
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        let member = Member { name: &self.name, above: self.path };
        self.members.next_value_seed(Strict(seed, Path(Some(&member))))
    }

    fn size_hint(&self) -> Option<usize> {
        self.members.size_hint()
    }
}

/// The seed of a member's name, which keeps it.
struct Named<'n, S> {
    seed: S,
    name: &'n mut String,
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Named<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, format: D) -> Result<S::Value, D::Error> {
        *self.name = String::deserialize(format)?;
        self.seed.deserialize(StrDeserializer::new(self.name))
    }
}

/// The visitor of a number, which also takes a text with the unit of its quantity.
struct Number<'p, V>(V, Path<'p>);

impl<'de, V: Visitor<'de>> Visitor<'de> for Number<'_, V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(formatter)
    }

    hand_on! {
        visit_bool(bool) visit_i64(i64) visit_i128(i128) visit_u64(u64) visit_u128(u128) visit_f64(f64) visit_char(char)
        visit_bytes(&[u8]) visit_borrowed_bytes(&'de [u8]) visit_byte_buf(Vec<u8>)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<V::Value, E> {
        match self.1.units() {
            None => self.0.visit_str(text),
            Some(units) => match entry::read(text, units) {
                Ok(value) => self.0.visit_f64(value),
                Err(error) => Err(E::invalid_value(Unexpected::Str(text), &error.to_string().as_str())),
            },
        }
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_unit()
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<V::Value, A::Error> {
        self.0.visit_seq(entries)
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(members)
    }
}

/// An object that stands for a variant with content.
struct Variants<'p, A>(Members<'p, A>);

impl<'de, A: MapAccess<'de>> EnumAccess<'de> for Variants<'_, A> {
    type Error = A::Error;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'de>>(mut self, seed: S) -> Result<(S::Value, Self), A::Error> {
        match self.0.next_key_seed(seed)? {
            Some(variant) => Ok((variant, self)),
            None => Err(A::Error::invalid_value(Unexpected::Map, &"an object with one member")),
        }
    }
}

impl<'de, A: MapAccess<'de>> Variants<'_, A> {
    /// The content, as the only member.
    fn content<S: DeserializeSeed<'de>>(mut self, seed: S) -> Result<S::Value, A::Error> {
        let content = self.0.next_value_seed(seed)?;
        match self.0.next_key::<IgnoredAny>()? {
            None => Ok(content),
            Some(_) => Err(A::Error::invalid_value(Unexpected::Map, &"an object with one member")),
        }
    }
}

impl<'de, A: MapAccess<'de>> VariantAccess<'de> for Variants<'_, A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        Err(A::Error::invalid_type(Unexpected::Map, &"the name alone"))
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        self.content(seed)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, A::Error> {
        self.content(Any(visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.content(Object(visitor))
    }
}

/// The seed of a variant's object.
struct Object<V>(V);

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for Object<V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, format: D) -> Result<V::Value, D::Error> {
        format.deserialize_struct("", &[], self.0)
    }
}

/// The seed of any value, for a visitor.
struct Any<V>(V);

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for Any<V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, format: D) -> Result<V::Value, D::Error> {
        format.deserialize_any(self.0)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Serialize;
    use serde_json::{Value, json};

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Form {
        Plain,
        Sized(f64),
        Pair(u32, Inner),
        Cut { from: f64, parts: Vec<Inner> },
    }

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Inner {
        depth: f64,
        form: Option<Box<Form>>,
    }

    fn read(value: Value) -> Result<Form, String> {
        read_strictly(value).map_err(|error: serde_json::Error| error.to_string())
    }

    #[test]
    fn output_of_serde_is_read() {
        let inner = |form: Option<Form>| Inner { depth: 0.1, form: form.map(Box::new) };
        for form in [
            Form::Plain,
            Form::Sized(2.5),
            Form::Pair(3, inner(Some(Form::Plain))),
            Form::Cut { from: 1.0, parts: vec![inner(None), inner(Some(Form::Sized(0.3)))] },
        ] {
            let text = serde_json::to_string(&form).unwrap();
            let mut format = serde_json::Deserializer::from_str(&text);
            assert_eq!(read_strictly::<Form, _>(&mut format).unwrap(), form, "{text}");
            assert_eq!(read(serde_json::to_value(&form).unwrap()).unwrap(), form, "{text}");
            let named = BTreeMap::from([("form", form)]);
            let table = toml::Value::try_from(&named).unwrap();
            let again: BTreeMap<String, Form> = read_strictly(table).unwrap();
            assert_eq!(again["form"], named["form"], "{text}");
        }
    }

    #[test]
    fn lists_are_no_structs_and_objects_no_names_at_any_depth() {
        for (lax, wanted) in [
            (json!({"plain": null}), "the name alone"),
            (json!({"pair": [3, [0.1, null]]}), "struct Inner"),
            (json!({"pair": [3, {"depth": 0.1, "form": {"plain": null}}]}), "the name alone"),
            (json!({"cut": [1.0, []]}), "struct variant"),
            (json!({"cut": {"from": 1.0, "parts": [[0.1, null]]}}), "struct Inner"),
        ] {
            let _: Form = serde_json::from_str(&lax.to_string()).expect("serde takes it");
            let refused = read(lax.clone()).expect_err("another form");
            assert!(refused.contains(wanted), "{lax}: {refused}");
        }
    }

    #[test]
    fn floats_without_a_fraction_are_integers() {
        assert_eq!(read_strictly::<u32, _>(json!(2.0)).unwrap(), 2);
        assert_eq!(read_strictly::<Option<i64>, _>(json!(-3.0)).unwrap(), Some(-3));
        assert_eq!(read_strictly::<f64, _>(json!(2.0)).unwrap(), 2.0);
        for other in [json!(2.5), json!(-1.0), json!(1e10), json!(1e300), json!("2")] {
            assert!(read_strictly::<u32, _>(other.clone()).is_err(), "{other}");
        }
    }

    #[test]
    fn an_object_for_a_variant_has_one_member() {
        for several in [json!({}), json!({"sized": 1, "plain": null})] {
            let refused = read(several).unwrap_err();
            assert!(refused.contains("one member"), "{refused}");
        }
        assert!(read(json!({"size": 1})).unwrap_err().contains("unknown variant `size`"));
        assert!(read(json!("sized")).is_err());
    }
}
