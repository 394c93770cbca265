//! JSON in which no object says a name twice.
//!
//! serde_json keeps the last of two equal names in silence; a graph whose second "g" wins unseen is a
//! wrong picture. So the tree is built by a visitor that knows where it is and refuses the second.
//! Numbers stay as serde_json reads them: whole ones whole, others the nearest f64, and one that
//! overflows is an error. Tested in the tests of the document.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value as Json};

/// Reads one JSON value and nothing after it.
///
/// # Errors
/// With line and column: a mistake of syntax, or a name that an object gives twice.
pub fn parse_json(text: &str) -> serde_json::Result<Json> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let json = At(String::new()).deserialize(&mut deserializer)?;
    deserializer.end()?;
    Ok(json)
}

/// The place in the tree, as `nodes.medium`; empty at the root.
struct At(String);

impl At {
    fn inside(&self, name: &str) -> Self {
        match self.0.as_str() {
            "" => Self(name.to_owned()),
            place => Self(format!("{place}.{name}")),
        }
    }
}

impl<'de> DeserializeSeed<'de> for At {
    type Value = Json;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Json, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for At {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E: Error>(self, b: bool) -> Result<Json, E> {
        Ok(b.into())
    }

    fn visit_i64<E: Error>(self, i: i64) -> Result<Json, E> {
        Ok(i.into())
    }

    fn visit_u64<E: Error>(self, u: u64) -> Result<Json, E> {
        Ok(u.into())
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<Json, E> {
        let number = Number::from_f64(x).ok_or_else(|| E::custom("a number is not finite"))?;
        Ok(number.into())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Json, E> {
        Ok(text.into())
    }

    fn visit_unit<E: Error>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Json, A::Error> {
        let mut array = Vec::new();
        while let Some(item) = items.next_element_seed(self.inside(&array.len().to_string()))? {
            array.push(item);
        }
        Ok(Json::Array(array))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Json, A::Error> {
        let mut object = Map::new();
        while let Some(name) = entries.next_key::<String>()? {
            if object.contains_key(&name) {
                let place = self.inside(&name).0;
                return Err(A::Error::custom(format!("'{place}' is given twice; keep one")));
            }
            let value = entries.next_value_seed(self.inside(&name))?;
            object.insert(name, value);
        }
        Ok(Json::Object(object))
    }
}
