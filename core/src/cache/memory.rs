//! A cache in memory, for programs that run a recipe again and again, such as an editor.

use super::{Cache, Entry, Key, Parts};
use crate::port::{PortType, Value};
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

struct Kept {
    entry: Entry,
    values: Vec<Value>,
    bytes: usize,
    used: u64,
}

#[derive(Default)]
struct Contents {
    kept: BTreeMap<Key, Kept>,
    runs: BTreeMap<String, BTreeMap<String, Parts>>,
    bytes: usize,
    clock: u64,
}

/// Values in memory, up to a number of bytes. What is largest for the time it took to make goes
/// first, and of equals what was not used for longest.
pub struct MemoryCache {
    max_bytes: usize,
    contents: Mutex<Contents>,
}

impl MemoryCache {
    /// A cache that holds values of up to `max_bytes` altogether.
    #[must_use]
    pub fn new(max_bytes: usize) -> Self {
        Self { max_bytes, contents: Mutex::default() }
    }

    /// What its values take, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.lock().bytes
    }

    fn lock(&self) -> MutexGuard<'_, Contents> {
        self.contents.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Contents {
    fn remove(&mut self, key: &Key) {
        if let Some(kept) = self.kept.remove(key) {
            self.bytes -= kept.bytes;
        }
    }

    /// The entry whose loss costs least for the room it gives.
    fn cheapest(&self) -> Option<Key> {
        let cost = |kept: &Kept| kept.entry.wall_s.max(1e-6) / (kept.bytes.max(1) as f64);
        let least = self.kept.iter().min_by(|(_, a), (_, b)| {
            cost(a).total_cmp(&cost(b)).then_with(|| a.used.cmp(&b.used))
        });
        least.map(|(key, _)| key.clone())
    }
}

impl Cache for MemoryCache {
    fn look(&self, key: &Key) -> Option<Entry> {
        Some(self.lock().kept.get(key)?.entry.clone())
    }

    fn load(&self, key: &Key, _: &[&PortType]) -> Option<Vec<Value>> {
        let mut contents = self.lock();
        contents.clock += 1;
        let now = contents.clock;
        let kept = contents.kept.get_mut(key)?;
        kept.used = now;
        Some(kept.values.clone())
    }

    fn store(&self, key: &Key, entry: Entry, values: &[(&PortType, Value)]) {
        let bytes = values.iter().map(|(port, value)| port.bytes(value)).sum();
        if bytes > self.max_bytes {
            return;
        }
        let values = values.iter().map(|(_, value)| value.clone()).collect();
        let mut contents = self.lock();
        contents.remove(key);
        while contents.bytes + bytes > self.max_bytes {
            let Some(victim) = contents.cheapest() else { break };
            contents.remove(&victim);
        }
        contents.clock += 1;
        contents.bytes += bytes;
        let used = contents.clock;
        contents.kept.insert(key.clone(), Kept { entry, values, bytes, used });
    }

    fn last_run(&self, recipe: &str) -> Option<BTreeMap<String, Parts>> {
        self.lock().runs.get(recipe).cloned()
    }

    fn remember_run(&self, recipe: &str, nodes: &BTreeMap<String, Parts>) {
        self.lock().runs.insert(recipe.to_owned(), nodes.clone());
    }
}
