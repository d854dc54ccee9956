//! A cache in a folder.
//!
//! Each entry is one file named after its key. Written aside and renamed, a half-written one is
//! never seen; one that does not match its hashes is deleted and its node runs again. All numbers
//! are of 64 bits, least byte first:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | magic word |
//! | 8 | length of the head |
//! | ... | head: what is known of the node, as JSON |
//! | 32 | BLAKE3 hash of the head |
//! | ... | the values, one after the other, as postcard encodes them |
//! | 8 each | their lengths |
//! | 32 | BLAKE3 hash of all before |
//!
//! Method: when the folder grows over its limit, the entries go that save least time for their size
//! and for as long as nobody wanted them (A. Blankstein, S. Sen, M. J. Freedman: Hyperbolic
//! Caching, USENIX ATC 2017, section 2), which the time of their last change tells. Only files that
//! are named as a cache names them are ever touched.
//!
//! Limits: to read a value takes its encoded size in memory beside the value. While an entry is
//! being written the folder may exceed its limit by that one.

use super::{Cache, CacheError, Entry, Key, Parts};
use crate::hashing::Hashing;
use crate::port::{PortType, Value};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime};
use tempfile::NamedTempFile;

/// First bytes of an entry; the digit changes when the layout does.
const MAGIC: &[u8; 8] = b"CARVECA2";

/// The longest description that is believed; a real one has a few kilobytes.
const MAX_HEAD_BYTES: u64 = 16 << 20;

const HASH_BYTES: usize = blake3::OUT_LEN;

/// A temporary file this old belongs to a run that was killed.
const STALE: Duration = Duration::from_secs(24 * 3600);

/// What was wanted within this time was wanted just now.
const RECENT: Duration = Duration::from_secs(60);

/// Values in a folder, up to a number of bytes.
pub struct DiskCache {
    folder: PathBuf,
    max_bytes: u64,
    /// About what the folder holds; `None` before it was looked at. Other programs may write to it
    /// too, so it is looked at again before anything is deleted.
    held: Mutex<Option<u64>>,
}

impl DiskCache {
    /// Room for some hundred runs of the standard recipes.
    pub const DEFAULT_MAX_BYTES: u64 = 8 << 30;

    /// Uses `folder`, which is made if need be, for up to `max_bytes`.
    ///
    /// # Errors
    /// If the folder cannot be made.
    pub fn open(folder: &Path, max_bytes: u64) -> Result<Self, CacheError> {
        fs::create_dir_all(folder).map_err(|source| CacheError::Folder {
            folder: folder.display().to_string(),
            source,
        })?;
        Ok(Self { folder: folder.to_owned(), max_bytes, held: Mutex::default() })
    }

    fn entry_path(&self, key: &Key) -> PathBuf {
        self.folder.join(format!("{}.entry", key.as_str()))
    }

    fn run_path(&self, recipe: &str) -> PathBuf {
        let name = blake3::hash(recipe.as_bytes()).to_hex();
        self.folder.join(format!("{name}.run"))
    }

    /// Writes a file aside and puts it into place, once there is room for it.
    fn put(&self, path: &Path, write: impl FnOnce(&mut NamedTempFile) -> Option<()>) -> Option<()> {
        let mut builder = tempfile::Builder::new();
        let mut aside = builder.prefix(PART.0).suffix(PART.1).tempfile_in(&self.folder).ok()?;
        write(&mut aside)?;
        self.make_room(aside.as_file().metadata().ok()?.len());
        aside.persist(path).ok()?;
        Some(())
    }

    /// Deletes entries if `coming` more bytes do not fit. A tenth more than needed goes, so that the
    /// folder need not be looked through for each entry that comes.
    fn make_room(&self, coming: u64) {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let fits = |held: u64| held.saturating_add(coming) <= self.max_bytes;
        let before = *held.get_or_insert_with(|| self.files().iter().map(|file| file.bytes).sum());
        if fits(before) {
            *held = Some(before + coming);
            return;
        }
        let mut files = self.files();
        let mut left: u64 = files.iter().map(|file| file.bytes).sum();
        files.sort_by(|a, b| a.worth.total_cmp(&b.worth).then_with(|| a.path.cmp(&b.path)));
        for file in files {
            if fits(left.saturating_add(self.max_bytes / 10)) {
                break;
            }
            if fs::remove_file(&file.path).is_ok() {
                left -= file.bytes;
            }
        }
        *held = Some(left + coming);
    }

    fn files(&self) -> Vec<OnDisk> {
        let Ok(folder) = fs::read_dir(&self.folder) else { return Vec::new() };
        folder.flatten().filter_map(|file| OnDisk::of(file.path())).collect()
    }
}

/// What the names of files begin and end with while they are written.
const PART: (&str, &str) = (".carve-", ".part");

/// A file of the cache as eviction sees it.
struct OnDisk {
    path: PathBuf,
    bytes: u64,
    /// Seconds saved per byte and per second since it was wanted.
    worth: f64,
}

impl OnDisk {
    /// `None` for what the cache has not written, or is writing.
    fn of(path: PathBuf) -> Option<Self> {
        let about = fs::symlink_metadata(&path).ok().filter(fs::Metadata::is_file)?;
        let age = about.modified().ok()?.elapsed().unwrap_or_default();
        let name = path.file_name()?.to_str()?;
        let is_key = |stem: &str| stem.len() == 64 && stem.bytes().all(|b| b.is_ascii_hexdigit());
        let saved_s = match name.split_once('.') {
            Some((key, "entry")) if is_key(key) => head(File::open(&path).ok()?)
                .map_or(0.0, |(entry, _)| entry.wall_s.max(super::LEAST_WALL_S)),
            Some((key, "run")) if is_key(key) => super::LEAST_WALL_S,
            _ if name.starts_with(PART.0) && name.ends_with(PART.1) && age > STALE => 0.0,
            _ => return None,
        };
        let bytes = about.len();
        let worth = saved_s / bytes.max(1) as f64 / age.max(RECENT).as_secs_f64();
        Some(Self { path, bytes, worth })
    }
}

/// Reads what is known of an entry, and where its values begin.
fn head(mut entry: impl Read) -> Option<(Entry, usize)> {
    let mut start = [0; 16];
    entry.read_exact(&mut start).ok()?;
    let (magic, length) = start.split_at(8);
    let length = u64::from_le_bytes(length.try_into().ok()?);
    if magic != MAGIC || length > MAX_HEAD_BYTES {
        return None;
    }
    let mut head = vec![0; usize::try_from(length).ok()?];
    let mut hash = [0; HASH_BYTES];
    entry.read_exact(&mut head).ok()?;
    entry.read_exact(&mut hash).ok()?;
    if blake3::hash(&head) != hash {
        return None;
    }
    Some((serde_json::from_slice(&head).ok()?, start.len() + head.len() + HASH_BYTES))
}

fn encode(file: &mut File, entry: &Entry, values: &[(&PortType, Value)]) -> Result<(), CacheError> {
    let head = serde_json::to_vec(entry).map_err(|fault| CacheError::Write(fault.into()))?;
    let mut writer = BufWriter::with_capacity(1 << 18, Hashing::new(file));
    writer.write_all(MAGIC)?;
    writer.write_all(&(head.len() as u64).to_le_bytes())?;
    writer.write_all(&head)?;
    writer.write_all(blake3::hash(&head).as_bytes())?;
    let mut ends = Vec::new();
    for (port, value) in values {
        writer.flush()?;
        let start = writer.get_ref().bytes;
        port.encode(value, &mut writer)?;
        writer.flush()?;
        ends.push(writer.get_ref().bytes - start);
    }
    for length in ends {
        writer.write_all(&length.to_le_bytes())?;
    }
    let hashing = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    let hash = hashing.hasher.finalize();
    hashing.inner.write_all(hash.as_bytes())?;
    Ok(())
}

/// The values of an entry, if all of it is as it was written.
fn decode(bytes: &[u8], key: &Key, types: &[&PortType]) -> Option<Vec<Value>> {
    let (body, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH_BYTES)?)?;
    if blake3::hash(body) != *<&[u8; HASH_BYTES]>::try_from(hash).ok()? {
        return None;
    }
    let (entry, start) = head(body)?;
    let lengths_start = body.len().checked_sub(8 * types.len())?;
    let mut left = body.get(start..lengths_start)?;
    let mut values = Vec::with_capacity(types.len());
    for (port, length) in types.iter().zip(body[lengths_start..].chunks_exact(8)) {
        let length = usize::try_from(u64::from_le_bytes(length.try_into().ok()?)).ok()?;
        let (value, rest) = left.split_at_checked(length)?;
        values.push(port.decode(value).ok()?);
        left = rest;
    }
    (left.is_empty() && Key::of(&entry.parts) == *key).then_some(values)
}

/// Notes that somebody wanted a file. If that fails it goes earlier than it would have.
fn touch(path: &Path) {
    let file = OpenOptions::new().write(true).open(path);
    let _ = file.and_then(|file| file.set_modified(SystemTime::now()));
}

impl Cache for DiskCache {
    fn look(&self, key: &Key) -> Option<Entry> {
        let path = self.entry_path(key);
        let (entry, _) = head(File::open(&path).ok()?)?;
        touch(&path);
        (Key::of(&entry.parts) == *key).then_some(entry)
    }

    fn load(&self, key: &Key, types: &[&PortType]) -> Option<Vec<Value>> {
        let path = self.entry_path(key);
        let values = fs::read(&path).ok().and_then(|bytes| decode(&bytes, key, types));
        if values.is_none() {
            // Whatever is there is of no use; the node that runs now writes it anew.
            let _ = fs::remove_file(path);
        }
        values
    }

    fn store(&self, key: &Key, entry: Entry, values: &[(&PortType, Value)]) {
        let estimate: usize = values.iter().map(|(port, value)| port.bytes(value)).sum();
        // What takes half of the room would drive out too much.
        if estimate as u64 > self.max_bytes / 2 {
            return;
        }
        // A full disk must not spoil the run: the value is simply not kept.
        let _ = self
            .put(&self.entry_path(key), |aside| encode(aside.as_file_mut(), &entry, values).ok());
    }

    fn last_run(&self, recipe: &str) -> Option<BTreeMap<String, Parts>> {
        serde_json::from_slice(&fs::read(self.run_path(recipe)).ok()?).ok()
    }

    fn remember_run(&self, recipe: &str, nodes: &BTreeMap<String, Parts>) {
        // Only `carve plan --explain` reads this; without it, it says so.
        let _ = self.put(&self.run_path(recipe), |aside| {
            let mut writer = BufWriter::new(aside);
            serde_json::to_writer(&mut writer, nodes).ok()?;
            writer.flush().ok()
        });
    }
}
