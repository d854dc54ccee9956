//! A cache in a folder.
//!
//! Each entry is one file named after its key: a magic word, what is known of the node as JSON and
//! the hash of that, then the encoded values and the hash of the whole. Files are written aside and
//! renamed, so a half-written one is never seen; one that does not match its hash is deleted and
//! its node runs again. When the folder grows over its limit, the entries go whose values are
//! largest for the time it took to make them.

use super::{Cache, CacheError, Entry, Key, Parts};
use crate::port::{PortType, Value};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// First bytes of an entry; the digit changes when the layout does.
const MAGIC: &[u8; 8] = b"CARVECA1";

/// The longest description that is believed; a real one has a few kilobytes.
const MAX_HEAD_BYTES: u64 = 16 << 20;

const HASH_BYTES: usize = blake3::OUT_LEN;

/// A temporary file this old belongs to a run that was killed.
const STALE: Duration = Duration::from_secs(24 * 3600);

/// Values in a folder, up to a number of bytes.
pub struct DiskCache {
    folder: PathBuf,
    max_bytes: u64,
}

impl DiskCache {
    /// Room for some hundred runs of the standard recipes.
    pub const DEFAULT_MAX_BYTES: u64 = 8 << 30;

    /// Uses `folder`, which is made if need be, for up to `max_bytes`.
    ///
    /// # Errors
    /// If the folder cannot be made.
    pub fn open(folder: &Path, max_bytes: u64) -> Result<Self, CacheError> {
        fs::create_dir_all(folder).map_err(|source| {
            CacheError::Folder { folder: folder.display().to_string(), source }
        })?;
        Ok(Self { folder: folder.to_owned(), max_bytes })
    }

    fn entry_path(&self, key: &Key) -> PathBuf {
        self.folder.join(format!("{}.entry", key.as_str()))
    }

    fn run_path(&self, recipe: &str) -> PathBuf {
        let name = blake3::hash(recipe.as_bytes()).to_hex();
        self.folder.join(format!("{name}.run"))
    }

    /// Writes a file aside and puts it into place.
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut aside = tempfile::Builder::new()
            .prefix(".carve-")
            .suffix(".part")
            .tempfile_in(&self.folder)?;
        aside.write_all(bytes)?;
        aside.persist(path).map_err(|fault| fault.error)?;
        Ok(())
    }

    /// Deletes entries until `coming` more bytes fit.
    fn make_room(&self, coming: u64) {
        let mut entries = self.entries();
        let mut total: u64 = entries.iter().map(|entry| entry.bytes).sum();
        entries.sort_by(|a, b| a.worth.total_cmp(&b.worth).then_with(|| a.path.cmp(&b.path)));
        for entry in entries {
            if total + coming <= self.max_bytes {
                return;
            }
            if fs::remove_file(&entry.path).is_ok() {
                total -= entry.bytes;
            }
        }
    }

    fn entries(&self) -> Vec<OnDisk> {
        let Ok(folder) = fs::read_dir(&self.folder) else { return Vec::new() };
        folder.flatten().filter_map(|file| OnDisk::of(&file.path())).collect()
    }
}

/// An entry as eviction sees it.
struct OnDisk {
    path: PathBuf,
    bytes: u64,
    /// Seconds saved per byte.
    worth: f64,
}

impl OnDisk {
    fn of(path: &Path) -> Option<Self> {
        let about = fs::metadata(path).ok()?;
        let bytes = about.len();
        let worth = match path.extension()?.to_str()? {
            "entry" => match read_head(path) {
                Some((entry, _)) => entry.wall_s.max(1e-6) / bytes.max(1) as f64,
                None => 0.0,
            },
            "part" => {
                let age = SystemTime::now().duration_since(about.modified().ok()?).ok()?;
                if age < STALE {
                    return None;
                }
                0.0
            }
            _ => return None,
        };
        Some(Self { path: path.to_owned(), bytes, worth })
    }
}

/// Reads what is known of an entry, and where its values begin.
fn read_head(path: &Path) -> Option<(Entry, u64)> {
    let mut file = File::open(path).ok()?;
    let mut start = [0; 16];
    file.read_exact(&mut start).ok()?;
    let (magic, length) = start.split_at(8);
    let length = u64::from_le_bytes(length.try_into().ok()?);
    if magic != MAGIC || length > MAX_HEAD_BYTES {
        return None;
    }
    let mut head = vec![0; usize::try_from(length).ok()?];
    let mut hash = [0; HASH_BYTES];
    file.read_exact(&mut head).ok()?;
    file.read_exact(&mut hash).ok()?;
    if blake3::hash(&head) != hash {
        return None;
    }
    Some((serde_json::from_slice(&head).ok()?, 16 + length + HASH_BYTES as u64))
}

fn encode(entry: &Entry, values: &[(&PortType, Value)]) -> Option<Vec<u8>> {
    let head = serde_json::to_vec(entry).ok()?;
    let mut bytes = MAGIC.to_vec();
    bytes.extend((head.len() as u64).to_le_bytes());
    bytes.extend(&head);
    bytes.extend(blake3::hash(&head).as_bytes());
    for (port, value) in values {
        let value = port.encode(value).ok()?;
        bytes.extend((value.len() as u64).to_le_bytes());
        bytes.extend(value);
    }
    bytes.extend(blake3::hash(&bytes).as_bytes());
    Some(bytes)
}

/// The values of an entry, if all of it is as it was written.
fn decode(path: &Path, types: &[&PortType]) -> Option<Vec<Value>> {
    let (_, start) = read_head(path)?;
    let bytes = fs::read(path).ok()?;
    let (body, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH_BYTES)?)?;
    if blake3::hash(body) != *<&[u8; HASH_BYTES]>::try_from(hash).ok()? {
        return None;
    }
    let mut left = body.get(usize::try_from(start).ok()?..)?;
    let mut values = Vec::with_capacity(types.len());
    for port in types {
        let (length, rest) = left.split_at_checked(8)?;
        let length = usize::try_from(u64::from_le_bytes(length.try_into().ok()?)).ok()?;
        let (value, rest) = rest.split_at_checked(length)?;
        values.push(port.decode(value).ok()?);
        left = rest;
    }
    left.is_empty().then_some(values)
}

impl Cache for DiskCache {
    fn look(&self, key: &Key) -> Option<Entry> {
        Some(read_head(&self.entry_path(key))?.0)
    }

    fn load(&self, key: &Key, types: &[&PortType]) -> Option<Vec<Value>> {
        let path = self.entry_path(key);
        let values = decode(&path, types);
        if values.is_none() {
            // Whatever is there is of no use; the node that runs now writes it anew.
            let _ = fs::remove_file(path);
        }
        values
    }

    fn store(&self, key: &Key, entry: Entry, values: &[(&PortType, Value)]) {
        let estimate: usize = values.iter().map(|(port, value)| port.bytes(value)).sum();
        if estimate as u64 > self.max_bytes / 2 {
            return;
        }
        let Some(bytes) = encode(&entry, values) else { return };
        self.make_room(bytes.len() as u64);
        // A full disk must not spoil the run: the value is simply not kept.
        let _ = self.write(&self.entry_path(key), &bytes);
    }

    fn last_run(&self, recipe: &str) -> Option<BTreeMap<String, Parts>> {
        serde_json::from_slice(&fs::read(self.run_path(recipe)).ok()?).ok()
    }

    fn remember_run(&self, recipe: &str, nodes: &BTreeMap<String, Parts>) {
        if let Ok(bytes) = serde_json::to_vec(nodes) {
            // Only `carve plan --explain` reads this; without it, it says so.
            let _ = self.write(&self.run_path(recipe), &bytes);
        }
    }
}
