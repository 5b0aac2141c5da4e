//! JSON in which no object has two entries of one name.
//!
//! The parser's maps keep the last of two entries in silence; a marker that is labelled twice must not pass.

use serde::de::{Deserialize, DeserializeOwned, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt;

/// Reads JSON, and refuses it if a name stands twice in an object.
pub(crate) fn from_str<T: DeserializeOwned>(text: &str) -> serde_json::Result<T> {
    // What is malformed is told by the reading that knows what is expected.
    let value = serde_json::from_str(text)?;
    serde_json::from_str::<Distinct>(text)?;
    Ok(value)
}

/// Any JSON value; nothing of it is kept.
struct Distinct;

impl<'de> Deserialize<'de> for Distinct {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Walk)
    }
}

/// A name, borrowed where the text has no escapes in it.
#[derive(PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(transparent)]
struct Name<'a>(#[serde(borrow)] Cow<'a, str>);

struct Walk;

impl<'de> Visitor<'de> for Walk {
    type Value = Distinct;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Distinct, A::Error> {
        let mut names = HashSet::new();
        while let Some(name) = map.next_key::<Name>()? {
            map.next_value::<Distinct>()?;
            if names.contains(&name) {
                return Err(A::Error::custom(format_args!("{} stands twice in one object", name.0)));
            }
            names.insert(name);
        }
        Ok(Distinct)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Distinct, A::Error> {
        while items.next_element::<Distinct>()?.is_some() {}
        Ok(Distinct)
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<Distinct, E> {
        Ok(Distinct)
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<Distinct, E> {
        Ok(Distinct)
    }

    fn visit_u64<E: Error>(self, _: u64) -> Result<Distinct, E> {
        Ok(Distinct)
    }

    fn visit_f64<E: Error>(self, _: f64) -> Result<Distinct, E> {
        Ok(Distinct)
    }

    fn visit_str<E: Error>(self, _: &str) -> Result<Distinct, E> {
        Ok(Distinct)
    }

    fn visit_unit<E: Error>(self) -> Result<Distinct, E> {
        Ok(Distinct)
    }
}

#[cfg(test)]
mod tests {
    use super::from_str;
    use serde_json::Value;

    #[test]
    fn a_name_stands_once_in_an_object() {
        for fine in [r#"{"a":1,"b":{"a":[true,null,-1.5,"x"]}}"#, "[]", r#"[{"a":1},{"a":2}]"#] {
            assert!(from_str::<Value>(fine).is_ok(), "{fine}");
        }
        for twice in [r#"{"a":1,"a":1}"#, r#"[{"b":{"a":1,"c":2,"a":3}}]"#, r#"{"a":1,"\u0061":2}"#] {
            let error = from_str::<Value>(twice).expect_err(twice).to_string();
            assert!(error.starts_with("a stands twice in one object at line 1"), "{error}");
        }
    }
}
