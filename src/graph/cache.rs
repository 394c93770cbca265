//! Results by key within a budget of bytes; the least recently used go first.
//!
//! What a value holds may grow after it was kept (a file's grids are decoded when they are asked for), so
//! sizes are asked for anew at each insertion, and the budget holds from one insertion to the next growth.
//! The cache holds references: what an evaluation or a window still holds lives on after it was dropped
//! here, and only stops being found. A value that several nodes pass on is counted once for each. A
//! result larger than the whole budget is not kept and drives nothing out. Tested by budget and order.

use indexmap::IndexMap;

use super::eval::Outputs;
use super::key::Key;

/// Outputs of nodes.
#[derive(Debug)]
pub struct Cache {
    budget_bytes: u64,
    /// The least recently used first.
    entries: IndexMap<Key, Outputs>,
}

impl Cache {
    /// An empty cache that holds at most `budget_bytes`.
    pub fn new(budget_bytes: u64) -> Self {
        Self { budget_bytes, entries: IndexMap::new() }
    }

    /// What it holds now, in bytes.
    pub fn used_bytes(&self) -> u64 {
        self.entries.values().map(Outputs::bytes).fold(0, u64::saturating_add)
    }

    /// The outputs of this key, which are now the most recently used.
    pub fn get(&mut self, key: &Key) -> Option<Outputs> {
        let outputs = self.entries.shift_remove(key)?;
        self.entries.insert(*key, outputs.clone());
        Some(outputs)
    }

    /// Keeps the outputs and drops what is too much.
    pub fn insert(&mut self, key: Key, outputs: Outputs) {
        self.entries.shift_remove(&key);
        // Compared by subtraction, because the sum of two sizes may overflow.
        let room = self.budget_bytes.checked_sub(outputs.bytes());
        while self.used_bytes() > room.unwrap_or(self.budget_bytes) {
            self.entries.shift_remove_index(0).expect("used bytes");
        }
        if room.is_some() {
            self.entries.insert(key, outputs);
        }
    }

    /// Drops everything.
    pub fn clear(&mut self) {
        self.entries.clear();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

    use super::*;
    use crate::graph::params::Params;
    use crate::graph::spec::{Category, NodeSpec, PortType};
    use crate::graph::value::Value;

    static SPEC: NodeSpec = NodeSpec {
        id: "kind",
        version: 1,
        category: Category::Light,
        purpose: "",
        doc: "",
        inputs: &[],
        outputs: &[],
        params: &[],
    };

    fn key(id: u8) -> Key {
        Key::new(&SPEC, &Params::defaults(&[]).unwrap(), &[], &[id])
    }

    fn outputs(bytes: u64) -> Outputs {
        Outputs::new([Value::new(PortType::Light, bytes, bytes)])
    }

    #[test]
    fn least_recently_used_goes_first() {
        let mut cache = Cache::new(100);
        cache.insert(key(1), outputs(40));
        cache.insert(key(2), outputs(40));
        assert!(cache.get(&key(1)).is_some());
        cache.insert(key(3), outputs(40));
        assert!(cache.get(&key(2)).is_none());
        assert!(cache.get(&key(1)).is_some() && cache.get(&key(3)).is_some());
        assert_eq!(cache.used_bytes(), 80);
    }

    #[test]
    fn budget_is_exact_and_never_exceeded() {
        let mut cache = Cache::new(100);
        cache.insert(key(1), outputs(60));
        cache.insert(key(2), outputs(40));
        assert_eq!(cache.used_bytes(), 100);
        cache.insert(key(3), outputs(101));
        assert!(cache.get(&key(3)).is_none());
        assert_eq!(cache.used_bytes(), 100);
        cache.insert(key(4), outputs(1));
        assert_eq!(cache.used_bytes(), 41);
        cache.insert(key(4), outputs(u64::MAX));
        assert_eq!(cache.used_bytes(), 40);
        cache.clear();
        assert_eq!(cache.used_bytes(), 0);
        assert!(cache.get(&key(2)).is_none());
    }

    #[test]
    fn what_grows_is_counted_as_it_is() {
        let grown = Arc::new(AtomicU64::new(10));
        let growing = Value::measured(PortType::Volume, Arc::clone(&grown), |size| size.load(Relaxed));
        let mut cache = Cache::new(100);
        cache.insert(key(1), Outputs::new([growing]));
        cache.insert(key(2), outputs(40));
        grown.store(70, Relaxed);
        assert_eq!(cache.used_bytes(), 110);
        cache.insert(key(3), outputs(20));
        assert!(cache.get(&key(1)).is_none());
        assert_eq!(cache.used_bytes(), 60);
    }

    #[test]
    fn what_is_held_elsewhere_lives_on() {
        let mut cache = Cache::new(10);
        cache.insert(key(1), outputs(10));
        let held = cache.get(&key(1)).unwrap();
        cache.insert(key(2), outputs(10));
        assert!(cache.get(&key(1)).is_none());
        assert_eq!(*held.values()[0].get::<u64>(), 10);
    }
}
