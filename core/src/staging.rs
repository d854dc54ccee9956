//! Output files that appear whole or not at all, and all together.
//!
//! A node writes to a temporary file beside the place where the file is to be. When the run is over,
//! the files of the nodes that finished are renamed into place; everything else vanishes. So a
//! program never stands beside the picture of another one, and no half file is ever seen.

use crate::cancel::CancelToken;
use crate::files::FileError;
use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// Buffer in front of the file; large, since programs and meshes are written in small pieces.
const BUFFER_BYTES: usize = 1 << 18;

/// A file that was written in full.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct WrittenFile {
    /// Its name in the output folder.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// The BLAKE3 hash of its contents, in hex.
    pub blake3: String,
}

struct Staged {
    node: usize,
    temporary: NamedTempFile,
    file: WrittenFile,
}

/// The files of one run on their way to the output folder.
pub(crate) struct Staging {
    folder: PathBuf,
    made_folder: Mutex<bool>,
    /// File names and the nodes that took them.
    taken: Mutex<Vec<(String, String)>>,
    staged: Mutex<Vec<Staged>>,
    temporaries: Mutex<BTreeSet<PathBuf>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panicking node leaves the lists behind these locks whole: each change is one push or insert.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn cannot_write(path: &Path, source: io::Error) -> FileError {
    FileError::Io { action: "write", path: path.display().to_string(), source }
}

impl Staging {
    pub(crate) fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            made_folder: Mutex::default(),
            taken: Mutex::default(),
            staged: Mutex::default(),
            temporaries: Mutex::default(),
        }
    }

    /// Begins a file that node number `node`, called `id`, writes.
    pub(crate) fn create<'a>(
        &'a self,
        node: usize,
        id: &str,
        name: String,
        cancel: &'a CancelToken,
    ) -> Result<OutputFile<'a>, FileError> {
        self.take_name(&name, id)?;
        self.make_folder()?;
        let temporary = temporary_file()
            .tempfile_in(&self.folder)
            .map_err(|source| cannot_write(&self.folder.join(&name), source))?;
        lock(&self.temporaries).insert(temporary.path().to_owned());
        let writer = BufWriter::with_capacity(BUFFER_BYTES, temporary);
        let hasher = blake3::Hasher::new();
        Ok(OutputFile { staging: self, node, name, cancel, writer, hasher, bytes: 0 })
    }

    fn take_name(&self, name: &str, id: &str) -> Result<(), FileError> {
        let mut taken = lock(&self.taken);
        // Names that differ in case only are one file on Windows and macOS.
        let same = |(known, _): &&(String, String)| known.to_lowercase() == name.to_lowercase();
        if let Some((_, other)) = taken.iter().find(same) {
            return Err(FileError::Taken { name: name.to_owned(), other: other.clone() });
        }
        taken.push((name.to_owned(), id.to_owned()));
        Ok(())
    }

    fn make_folder(&self) -> Result<(), FileError> {
        let mut made = lock(&self.made_folder);
        if !self.folder.exists() {
            fs::create_dir_all(&self.folder)
                .map_err(|source| cannot_write(&self.folder, source))?;
            *made = true;
        }
        Ok(())
    }

    /// Puts the files of the nodes that `finished` into place, in the order of the nodes.
    pub(crate) fn publish(
        &self,
        finished: impl Fn(usize) -> bool,
    ) -> Result<Vec<(usize, WrittenFile)>, FileError> {
        // Held to the end: a program that is told to stop now still gets all files or none.
        let mut staged = lock(&self.staged);
        staged.retain(|staged| finished(staged.node));
        staged.sort_by(|a, b| (a.node, &a.file.name).cmp(&(b.node, &b.file.name)));
        let mut published = Vec::new();
        for Staged { node, temporary, file } in staged.drain(..) {
            let target = self.folder.join(&file.name);
            temporary.persist(&target).map_err(|fault| cannot_write(&target, fault.error))?;
            published.push((node, file));
        }
        self.forget_empty_folder();
        Ok(published)
    }

    /// The files that node number `node` has finished.
    pub(crate) fn written_by(&self, node: usize) -> Vec<WrittenFile> {
        let staged = lock(&self.staged);
        staged.iter().filter(|staged| staged.node == node).map(|s| s.file.clone()).collect()
    }

    /// Removes all that is not in place yet; for a run that is broken off.
    pub(crate) fn abandon(&self) {
        lock(&self.staged).clear();
        for path in std::mem::take(&mut *lock(&self.temporaries)) {
            // It may have gone its way already; there is nobody left to tell if it has not.
            let _ = fs::remove_file(path);
        }
        self.forget_empty_folder();
    }

    fn forget_empty_folder(&self) {
        if *lock(&self.made_folder) {
            // Fails where the folder is not empty, which is just what is wanted.
            let _ = fs::remove_dir(&self.folder);
        }
    }
}

#[cfg(unix)]
fn temporary_file() -> tempfile::Builder<'static, 'static> {
    use std::os::unix::fs::PermissionsExt;
    let mut builder = tempfile::Builder::new();
    // Readable as the user's umask says: a temporary file would be the user's alone.
    builder.prefix(".carve-").suffix(".part").permissions(fs::Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn temporary_file() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".carve-").suffix(".part");
    builder
}

/// A file that a node is writing. It counts only once it is [finished](Self::finish).
pub struct OutputFile<'a> {
    staging: &'a Staging,
    node: usize,
    name: String,
    cancel: &'a CancelToken,
    writer: BufWriter<NamedTempFile>,
    hasher: blake3::Hasher,
    bytes: u64,
}

impl OutputFile<'_> {
    /// Says that the file is complete.
    ///
    /// # Errors
    /// If the last bytes do not reach the disk.
    pub fn finish(self) -> Result<WrittenFile, FileError> {
        let Self { staging, node, name, writer, hasher, bytes, .. } = self;
        let target = staging.folder.join(&name);
        let temporary = writer
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
            .and_then(|temporary| temporary.as_file().sync_all().map(|()| temporary))
            .map_err(|source| cannot_write(&target, source))?;
        let file = WrittenFile { name, bytes, blake3: hasher.finalize().to_hex().to_string() };
        lock(&staging.staged).push(Staged { node, temporary, file: file.clone() });
        Ok(file)
    }

    /// What an error of writing to this file means for the node.
    #[must_use]
    pub fn error(&self, source: io::Error) -> FileError {
        if self.cancel.is_cancelled() {
            return FileError::Cancelled;
        }
        cannot_write(&self.staging.folder.join(&self.name), source)
    }
}

impl Write for OutputFile<'_> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        if self.cancel.is_cancelled() {
            return Err(io::Error::other("interrupted"));
        }
        let count = self.writer.write(buffer)?;
        self.hasher.update(&buffer[..count]);
        self.bytes += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}
