//! What travels along a wire: one typed value, shared and never changed.
//!
//! The graph knows the kind of a value (for the wires) and its size (for the cache); only the nodes
//! know the Rust type behind it. That keeps every domain type and the GPU out of the graph. Cloning
//! copies a reference. Tested by the wrong type being a panic and by the clone sharing its data.

use std::any::{Any, type_name};
use std::fmt;
use std::sync::Arc;

use super::spec::PortType;

/// A value of a port. The data is freed with its last clone.
#[derive(Clone)]
pub struct Value {
    /// What may be wired to it.
    pub kind: PortType,
    bytes: Bytes,
    data: Arc<dyn Any + Send + Sync>,
    type_name: &'static str,
}

/// The data of [`Value::unknown`].
struct Unknown;

#[derive(Clone)]
enum Bytes {
    Fixed(u64),
    Measured(Arc<dyn Fn() -> u64 + Send + Sync>),
}

impl Value {
    /// Wraps `data`, which holds `bytes` bytes on CPU and GPU together.
    pub fn new<T: Any + Send + Sync>(kind: PortType, bytes: u64, data: T) -> Self {
        Self { kind, bytes: Bytes::Fixed(bytes), data: Arc::new(data), type_name: type_name::<T>() }
    }

    /// Wraps data that comes to hold more as it is asked for more: `measure` says what it holds now.
    pub fn measured<T: Any + Send + Sync>(kind: PortType, data: T, measure: fn(&T) -> u64) -> Self {
        let data = Arc::new(data);
        let seen = Arc::clone(&data);
        let bytes = Bytes::Measured(Arc::new(move || measure(&seen)));
        Self { kind, bytes, data, type_name: type_name::<T>() }
    }

    /// What stands for a value where a run was only foretold: it holds nothing, and nothing can be made of it.
    pub fn unknown(kind: PortType) -> Self {
        Self::new(kind, 0, Unknown)
    }

    /// Whether it is one that nothing can be made of.
    pub fn is_unknown(&self) -> bool {
        self.data.is::<Unknown>()
    }

    /// Memory it holds now on CPU and GPU together, in bytes.
    pub fn bytes(&self) -> u64 {
        match &self.bytes {
            Bytes::Fixed(bytes) => *bytes,
            Bytes::Measured(measure) => measure(),
        }
    }

    /// The data.
    ///
    /// # Panics
    /// When the value holds another type: two nodes disagree on the type behind a kind, our mistake.
    pub fn get<T: Any>(&self) -> &T {
        self.data.downcast_ref::<T>().unwrap_or_else(|| {
            panic!("a value of kind {} holds {}, asked for {}", self.kind, self.type_name, type_name::<T>())
        })
    }

    /// Whether both hold the very same data.
    pub fn shares_data_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.data, &other.data)
    }
}

impl fmt::Debug for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Value({}, {} bytes, {})", self.kind, self.bytes(), self.type_name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clone_shares_data() {
        let value = Value::new(PortType::Volume, 8, 7_u64);
        let clone = value.clone();
        assert!(value.shares_data_with(&clone));
        assert!(!value.shares_data_with(&Value::new(PortType::Volume, 8, 7_u64)));
        assert_eq!(*clone.get::<u64>(), 7);
    }

    #[test]
    #[should_panic(expected = "a value of kind image holds f32, asked for f64")]
    fn wrong_type_is_our_mistake() {
        Value::new(PortType::Image, 4, 1.0_f32).get::<f64>();
    }
}
