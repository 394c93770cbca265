//! The name of a result: a hash of all that it depends on, and nothing else.
//!
//! BLAKE3 (O'Connor et al. 2020), 256 bits, of the kind, its version, the node's own parameters, for each
//! input the keys, outputs and shares of what is wired to it in order, and the identity that the host adds
//! (size and time of files, shader text). Not the node's name, its place or the rest of the graph: a renamed
//! node and a copy of it find the same result. Not the frame either: what it chooses is a file, which the
//! identity names, or a value, which has a key of its own. Every field is preceded by its length, so that no two
//! lists of fields give the same bytes. Tested by changing one field at a time.

use std::fmt;

use super::params::{ParamValue, Params};
use super::spec::{NodeSpec, Timing};

/// Hash of all that a node's outputs depend on.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Key([u8; 32]);

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head: String = self.0[..8].iter().map(|byte| format!("{byte:02x}")).collect();
        write!(f, "Key({head}…)")
    }
}

/// A value that a node reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputKey {
    /// The giver's.
    pub key: Key,
    /// Place among the giver's outputs.
    pub output_idx: usize,
    /// Of an input that fades, what this value counts for; else 1.
    pub share: f64,
}

impl Key {
    /// The key of a node. `inputs` has for each input of the spec what is wired to it, in order.
    ///
    /// # Panics
    /// When `inputs` has not one list for each input.
    pub fn new(spec: &NodeSpec, params: &Params, inputs: &[Vec<InputKey>], identity: &[u8]) -> Self {
        assert_eq!(inputs.len(), spec.inputs.len(), "one list an input");
        let mut fields = Fields(blake3::Hasher::new());
        fields.bytes(spec.id.as_bytes());
        fields.count(spec.version as usize);
        fields.params(
            params
                .iter()
                .filter(|(name, _)| spec.param(name).is_none_or(|param| param.timing == Timing::Own)),
        );
        for (port, sources) in spec.inputs.iter().zip(inputs) {
            fields.bytes(port.name.as_bytes());
            fields.count(sources.len());
            for InputKey { key, output_idx, share } in sources {
                fields.bytes(&key.0);
                fields.count(*output_idx);
                fields.bytes(&share.to_bits().to_le_bytes());
            }
        }
        fields.bytes(identity);
        Self(*fields.0.finalize().as_bytes())
    }
}

struct Fields(blake3::Hasher);

impl Fields {
    fn count(&mut self, count: usize) {
        self.0.update(&(count as u64).to_le_bytes());
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.count(bytes.len());
        self.0.update(bytes);
    }

    fn params<'a>(&mut self, params: impl Iterator<Item = (&'static str, &'a ParamValue)>) {
        let params: Vec<_> = params.collect();
        self.count(params.len());
        for (name, value) in params {
            self.bytes(name.as_bytes());
            self.value(value);
        }
    }

    /// A tag for the form, then the value.
    fn value(&mut self, value: &ParamValue) {
        match value {
            ParamValue::Null => self.count(0),
            ParamValue::Float(x) => self.tagged(1, &x.to_bits().to_le_bytes()),
            ParamValue::Int(i) => self.tagged(2, &i.to_le_bytes()),
            ParamValue::Bool(b) => self.tagged(3, &[u8::from(*b)]),
            ParamValue::Text(text) => self.tagged(4, text.as_bytes()),
            ParamValue::Path(path) => self.tagged(5, path.as_os_str().as_encoded_bytes()),
            ParamValue::Floats(values) => {
                let bits = values.iter().flat_map(|x| x.to_bits().to_le_bytes());
                self.tagged(6, &bits.collect::<Vec<u8>>());
            }
            ParamValue::Rows(rows) => {
                self.count(8);
                self.count(rows.len());
                let bits = rows.iter().flatten().flat_map(|x| x.to_bits().to_le_bytes());
                self.bytes(&bits.collect::<Vec<u8>>());
            }
            ParamValue::Record(params) => {
                self.count(7);
                self.params(params.iter());
            }
        }
    }

    fn tagged(&mut self, tag: usize, bytes: &[u8]) {
        self.count(tag);
        self.bytes(bytes);
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use serde_json::{Value as Json, json};

    use super::*;
    use crate::graph::params::Moment;
    use crate::graph::spec::{Category, ParamSpec, PortSpec, PortType};

    const PARAMS: &[ParamSpec] = &[
        ParamSpec::float("g", 0.0),
        ParamSpec::rgb("albedo", [1.0; 3]),
        ParamSpec::text("a", ""),
        ParamSpec::text("b", ""),
        ParamSpec::path("path").or_null(),
        ParamSpec::record("emission", &[ParamSpec::bool("on", true)]),
        ParamSpec::int("frame", 0).or_null().timed(Timing::Frame),
    ];
    const INPUTS: &[PortSpec] = &[
        PortSpec::new("x", PortType::Light, "").many().optional(""),
        PortSpec::new("y", PortType::Light, "").many().optional(""),
    ];
    static SPEC: NodeSpec = spec("kind", 1);
    static NEXT_VERSION: NodeSpec = spec("kind", 2);
    static OTHER_KIND: NodeSpec = spec("dnik", 1);

    const fn spec(id: &'static str, version: u32) -> NodeSpec {
        NodeSpec {
            id,
            version,
            category: Category::Light,
            purpose: "",
            doc: "",
            inputs: INPUTS,
            outputs: &[],
            params: PARAMS,
        }
    }

    fn key_of(json: Json) -> Key {
        let params = Params::resolve(PARAMS, json.as_object().unwrap(), Path::new("here"), Moment::default());
        Key::new(&SPEC, &params.unwrap(), &[vec![], vec![]], b"")
    }

    /// Every entry differs from every other in one thing that a result depends on.
    #[test]
    fn one_change_is_another_key() {
        let params = Params::defaults(PARAMS).unwrap();
        let input =
            |(key, output_idx): &(Key, usize)| InputKey { key: *key, output_idx: *output_idx, share: 1.0 };
        let inputs = |list: &[(Key, usize)]| list.iter().map(input).collect::<Vec<_>>();
        let wired =
            |x: &[(Key, usize)], y: &[(Key, usize)]| Key::new(&SPEC, &params, &[inputs(x), inputs(y)], b"");
        let (one, two) = (Key([1; 32]), Key([2; 32]));
        let faded = vec![InputKey { key: one, output_idx: 0, share: 0.5 }];
        let none = [vec![], vec![]];
        let keys = [
            key_of(json!({})),
            key_of(json!({"g": 0.5})),
            key_of(json!({"albedo": 0.5})),
            key_of(json!({"albedo": [0.5, 0.5, 0.25]})),
            key_of(json!({"a": "xy"})),
            key_of(json!({"a": "x", "b": "y"})),
            key_of(json!({"b": "xy"})),
            key_of(json!({"path": "p"})),
            key_of(json!({"emission": {}})),
            key_of(json!({"emission": {"on": false}})),
            Key::new(&NEXT_VERSION, &params, &none, b""),
            Key::new(&OTHER_KIND, &params, &none, b""),
            Key::new(&SPEC, &params, &none, b"shader"),
            wired(&[(one, 0)], &[]),
            wired(&[(one, 1)], &[]),
            wired(&[(two, 0)], &[]),
            wired(&[], &[(one, 0)]),
            wired(&[(one, 0), (two, 0)], &[]),
            wired(&[(two, 0), (one, 0)], &[]),
            wired(&[(one, 0)], &[(two, 0)]),
            Key::new(&SPEC, &params, &[faded, vec![]], b""),
        ];
        for (i, a) in keys.iter().enumerate() {
            for (j, b) in keys.iter().enumerate() {
                assert_eq!(a == b, i == j, "keys {i} and {j}");
            }
        }
    }

    #[test]
    fn the_same_said_otherwise_is_the_same_key() {
        assert_eq!(key_of(json!({})), key_of(json!({"g": 0, "albedo": 1})));
        let a = key_of(json!({"a": "x", "b": "y"}));
        assert_eq!(a, key_of(json!({"b": "y", "a": "x"})));
        assert_eq!(key_of(json!({"emission": {}})), key_of(json!({"emission": {"on": true}})));
        // A frame chooses a file, which the identity names.
        assert_eq!(key_of(json!({})), key_of(json!({"frame": 7})));
    }
}
