//! A cache in memory, for programs that run a recipe again and again, such as an editor.
//!
//! Method: GreedyDual-Size (P. Cao, S. Irani: Cost-Aware WWW Proxy Caching Algorithms, USITS 1997,
//! section 4). A value is worth `H = L + cost / size`, with the time that it took to make as its
//! cost, and the least worth goes first. `L` is the worth of the last one that went: so whatever
//! was used since stands above what was not, and nothing stays for its cost alone.

use super::{Cache, Entry, Key, LEAST_WALL_S, Parts};
use crate::port::{PortType, Value};
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What an entry takes besides its values and parts. Without it, entries without values would never
/// have to go.
const ENTRY_BYTES: usize = 1 << 10;

struct Kept {
    entry: Entry,
    values: Vec<Value>,
    bytes: usize,
    /// `H`.
    worth: f64,
}

impl Kept {
    /// Seconds that it saves for each byte that it takes.
    fn density(&self) -> f64 {
        self.entry.wall_s.max(LEAST_WALL_S) / self.bytes as f64
    }
}

#[derive(Default)]
struct Contents {
    kept: BTreeMap<Key, Kept>,
    runs: BTreeMap<String, BTreeMap<String, Parts>>,
    bytes: usize,
    /// `L`.
    floor: f64,
}

/// Values in memory, up to a number of bytes. What was not used for long and is large for the time
/// it took to make goes first.
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
    /// An entry that somebody wants, which raises its worth.
    fn wanted(&mut self, key: &Key) -> Option<&Kept> {
        let kept = self.kept.get_mut(key)?;
        kept.worth = self.floor + kept.density();
        Some(kept)
    }

    fn remove(&mut self, key: &Key) {
        if let Some(kept) = self.kept.remove(key) {
            self.bytes -= kept.bytes;
        }
    }

    /// Removes what is worth least.
    fn remove_least(&mut self) {
        let least = self.kept.iter().min_by(|(_, a), (_, b)| a.worth.total_cmp(&b.worth));
        if let Some((key, floor)) = least.map(|(key, kept)| (key.clone(), kept.worth)) {
            self.floor = floor;
            self.remove(&key);
        }
    }
}

impl Cache for MemoryCache {
    fn look(&self, key: &Key) -> Option<Entry> {
        Some(self.lock().wanted(key)?.entry.clone())
    }

    fn load(&self, key: &Key, _: &[&PortType]) -> Option<Vec<Value>> {
        Some(self.lock().wanted(key)?.values.clone())
    }

    fn store(&self, key: &Key, entry: Entry, values: &[(&PortType, Value)]) {
        let parts: usize = entry.parts.iter().map(|(what, state)| what.len() + state.len()).sum();
        let sizes: usize = values.iter().map(|(port, value)| port.bytes(value)).sum();
        let bytes = ENTRY_BYTES + parts + sizes;
        if bytes > self.max_bytes {
            return;
        }
        let values = values.iter().map(|(_, value)| value.clone()).collect();
        let mut contents = self.lock();
        contents.remove(key);
        while contents.bytes + bytes > self.max_bytes {
            contents.remove_least();
        }
        let mut kept = Kept { entry, values, bytes, worth: 0.0 };
        kept.worth = contents.floor + kept.density();
        contents.bytes += bytes;
        contents.kept.insert(key.clone(), kept);
    }

    fn last_run(&self, recipe: &str) -> Option<BTreeMap<String, Parts>> {
        self.lock().runs.get(recipe).cloned()
    }

    fn remember_run(&self, recipe: &str, nodes: &BTreeMap<String, Parts>) {
        self.lock().runs.insert(recipe.to_owned(), nodes.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> Key {
        Key::of(&Parts::from([("name".to_owned(), name.to_owned())]))
    }

    /// Adds an entry that took `wall_s` seconds to make and takes `blocks` times 1 KiB.
    fn add(cache: &MemoryCache, name: &str, wall_s: f64, blocks: usize) {
        let parts = Parts::from([(String::new(), "x".repeat((blocks - 1) * ENTRY_BYTES))]);
        let (outputs, notes, files) = Default::default();
        cache.store(&key(name), Entry { parts, wall_s, outputs, notes, files }, &[]);
    }

    /// The names of those that are still there.
    fn left(cache: &MemoryCache) -> String {
        let kept = &cache.lock().kept;
        "abcdef".chars().filter(|name| kept.contains_key(&key(&name.to_string()))).collect()
    }

    #[test]
    fn what_costs_least_for_its_size_goes_first() {
        let cache = MemoryCache::new(10 * ENTRY_BYTES);
        add(&cache, "a", 1.0, 4);
        add(&cache, "b", 1.0, 2);
        add(&cache, "c", 9.0, 4);
        assert_eq!((left(&cache).as_str(), cache.bytes()), ("abc", 10 * ENTRY_BYTES));
        add(&cache, "d", 3.0, 1);
        assert_eq!((left(&cache).as_str(), cache.bytes()), ("bcd", 7 * ENTRY_BYTES));
        add(&cache, "e", 3.0, 4);
        assert_eq!((left(&cache).as_str(), cache.bytes()), ("cde", 9 * ENTRY_BYTES));
    }

    #[test]
    fn of_equals_what_was_not_used_goes_first() {
        let cache = MemoryCache::new(3 * ENTRY_BYTES);
        ["a", "b", "c"].into_iter().for_each(|name| add(&cache, name, 1.0, 1));
        add(&cache, "d", 1.0, 1);
        // Since then what is used stands above what is not.
        let first = left(&cache);
        let used = first.chars().next().map(|name| name.to_string()).unwrap_or_default();
        assert!(cache.look(&key(&used)).is_some());
        add(&cache, "e", 1.0, 1);
        assert!(left(&cache).contains(&used), "{used} of {first}, {}", left(&cache));
        assert!(left(&cache).contains("de"));
    }

    #[test]
    fn nothing_stays_for_its_cost_alone() {
        let cache = MemoryCache::new(2 * ENTRY_BYTES);
        add(&cache, "a", 5.0, 1);
        for round in 0..20 {
            add(&cache, if round % 2 == 0 { "b" } else { "c" }, 1.0, 1);
        }
        assert_eq!(left(&cache), "bc");
    }

    #[test]
    fn entries_without_values_take_room_too() {
        let cache = MemoryCache::new(2 * ENTRY_BYTES);
        ["a", "b", "c", "d"].into_iter().for_each(|name| add(&cache, name, 1.0, 1));
        assert_eq!(left(&cache).len(), 2);
        add(&cache, "e", 1.0, 3);
        assert_eq!(left(&cache).len(), 2);
    }

    #[test]
    fn storing_again_replaces() {
        let cache = MemoryCache::new(9 * ENTRY_BYTES);
        add(&cache, "a", 1.0, 5);
        add(&cache, "a", 1.0, 2);
        assert_eq!((left(&cache).as_str(), cache.bytes()), ("a", 2 * ENTRY_BYTES));
    }
}
