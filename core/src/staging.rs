//! Output files that appear whole or not at all, and all together.
//!
//! A node writes to a temporary file beside the place where the file is to be. When the run is over,
//! the files of the nodes that finished are renamed into place; everything else vanishes. So a
//! program never stands beside the picture of another one, and no half file is ever seen.
//!
//! Limit: should the system refuse a renaming halfway, the files renamed before it stay; that they
//! can be put in place is looked at beforehand. Each file costs one wait for the disk, in the node
//! that writes it and so beside the work of the others.

use crate::cancel::CancelToken;
use crate::files::FileError;
use crate::hashing::Hashing;
use std::collections::{BTreeMap, BTreeSet};
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

/// A node as one that writes files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Writer {
    /// Its number, which decides when two nodes want one name.
    pub(crate) node: usize,
    pub(crate) id: String,
}

struct Staged {
    node: usize,
    temporary: NamedTempFile,
    file: WrittenFile,
}

/// The files of one run on their way to the output folder.
pub(crate) struct Staging {
    folder: PathBuf,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// The folders that were made for this run, innermost first.
    made: Vec<PathBuf>,
    /// Files that the run reads; nothing is put in their place.
    inputs: BTreeSet<PathBuf>,
    /// File names in lower case and the nodes that write them: names that differ in case only are
    /// one file on Windows and macOS.
    taken: BTreeMap<String, Writer>,
    /// Nodes that want a name which belongs to another one, and the name.
    ousted: BTreeMap<usize, String>,
    staged: Vec<Staged>,
    temporaries: BTreeSet<PathBuf>,
    abandoned: bool,
}

/// What became of the files of a run.
pub(crate) struct Published {
    /// The files in place, in the order of the nodes.
    pub(crate) files: Vec<(usize, WrittenFile)>,
    /// Why others are not.
    pub(crate) fault: Option<FileError>,
}

fn cannot_write(path: &Path, source: io::Error) -> FileError {
    FileError::Io { action: "write", path: path.display().to_string(), source }
}

impl Staging {
    pub(crate) fn new(folder: PathBuf) -> Self {
        Self { folder, state: Mutex::default() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // A node that panics leaves the state whole: nothing panics while it is locked.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps files from being replaced.
    pub(crate) fn protect(&self, inputs: impl IntoIterator<Item = PathBuf>) {
        self.state().inputs.extend(inputs);
    }

    /// Takes a name for a node: two cannot write one file. Of two that try, the one that stands
    /// first in the recipe has it, whichever came first.
    pub(crate) fn take_name(&self, name: &str, writer: &Writer) -> Result<(), FileError> {
        let state = &mut *self.state();
        let key = name.to_lowercase();
        if let Some(other) = state.taken.get(&key).cloned() {
            if other.node <= writer.node {
                state.ousted.insert(writer.node, name.to_owned());
                return Err(FileError::Taken { name: name.to_owned(), other: other.id });
            }
            state.ousted.insert(other.node, name.to_owned());
        }
        state.taken.insert(key, writer.clone());
        Ok(())
    }

    /// Why a node fails at last, even if it got to its end before the node came whose name it used.
    pub(crate) fn ousted(&self, node: usize) -> Option<FileError> {
        let state = self.state();
        let name = state.ousted.get(&node)?;
        let owner = state.taken.get(&name.to_lowercase())?;
        Some(FileError::Taken { name: name.clone(), other: owner.id.clone() })
    }

    /// Begins a file.
    pub(crate) fn create<'a>(
        &'a self,
        name: String,
        writer: Writer,
        cancel: &'a CancelToken,
    ) -> Result<OutputFile<'a>, FileError> {
        self.take_name(&name, &writer)?;
        let target = self.folder.join(&name);
        let mut state = self.state();
        if target.canonicalize().is_ok_and(|target| state.inputs.contains(&target)) {
            return Err(FileError::Input { name: target.display().to_string() });
        }
        if state.abandoned {
            return Err(FileError::Cancelled);
        }
        state.make(&self.folder).map_err(|source| cannot_write(&self.folder, source))?;
        let temporary = temporary_file()
            .tempfile_in(&self.folder)
            .map_err(|source| cannot_write(&target, source))?;
        state.temporaries.insert(temporary.path().to_owned());
        let file = BufWriter::with_capacity(BUFFER_BYTES, Hashing::new(temporary));
        Ok(OutputFile { staging: self, writer, name, cancel, file })
    }

    /// Puts the files of the nodes that `finished` into place; `None` if the run was abandoned.
    pub(crate) fn publish(&self, finished: impl Fn(usize) -> bool) -> Option<Published> {
        // Locked to the end: a program that is told to stop now still gets all files or none.
        let state = &mut *self.state();
        if state.abandoned {
            return None;
        }
        state.staged.retain(|staged| finished(staged.node));
        state.staged.sort_by(|a, b| (a.node, &a.file.name).cmp(&(b.node, &b.file.name)));
        let mut published = Published { files: Vec::new(), fault: None };
        let mut targets = state.staged.iter().map(|staged| self.folder.join(&staged.file.name));
        if let Some(folder) = targets.find(|target| target.is_dir()) {
            let fault = io::Error::other("there is a folder of this name");
            published.fault = Some(cannot_write(&folder, fault));
            state.staged.clear();
        }
        for Staged { node, temporary, file } in std::mem::take(&mut state.staged) {
            let target = self.folder.join(&file.name);
            if let Err(fault) = temporary.persist(&target) {
                published.fault = Some(cannot_write(&target, fault.error));
                break;
            }
            published.files.push((node, file));
        }
        state.remove_made();
        Some(published)
    }

    /// The files that node number `node` has finished.
    pub(crate) fn written_by(&self, node: usize) -> Vec<WrittenFile> {
        let state = self.state();
        let own = state.staged.iter().filter(|staged| staged.node == node);
        own.map(|staged| staged.file.clone()).collect()
    }

    /// Removes all that is not in place yet, and lets nothing more be begun; for a run that is
    /// broken off.
    pub(crate) fn abandon(&self) {
        let mut state = self.state();
        state.abandoned = true;
        state.staged.clear();
        for path in std::mem::take(&mut state.temporaries) {
            // It may have gone its way already; there is nobody left to tell if it has not.
            let _ = fs::remove_file(path);
        }
        state.remove_made();
    }
}

impl State {
    fn make(&mut self, folder: &Path) -> io::Result<()> {
        let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        let missing = folder.ancestors().take_while(is_missing).map(Path::to_owned);
        let missing: Vec<PathBuf> = missing.collect();
        if !missing.is_empty() {
            fs::create_dir_all(folder)?;
            self.made = missing;
        }
        Ok(())
    }

    /// Removes the folders that were made for files that never came.
    fn remove_made(&mut self) {
        for folder in std::mem::take(&mut self.made) {
            // Fails where the folder is not empty, which is just what is wanted.
            let _ = fs::remove_dir(folder);
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
    writer: Writer,
    name: String,
    cancel: &'a CancelToken,
    file: BufWriter<Hashing<NamedTempFile>>,
}

impl OutputFile<'_> {
    /// Says that the file is complete.
    ///
    /// # Errors
    /// If the last bytes do not reach the disk.
    pub fn finish(self) -> Result<WrittenFile, FileError> {
        let Self { staging, writer, name, cancel, file } = self;
        let hashed = file.into_inner().map_err(io::IntoInnerError::into_error);
        let hashed = hashed.and_then(|hashed| {
            hashed.inner.as_file().sync_all()?;
            Ok(hashed)
        });
        let Hashing { inner: temporary, hasher, bytes } =
            hashed.map_err(|source| staging.error(&name, cancel, source))?;
        let file = WrittenFile { name, bytes, blake3: hasher.finalize().to_hex().to_string() };
        let mut state = staging.state();
        if state.abandoned {
            return Err(FileError::Cancelled);
        }
        state.staged.push(Staged { node: writer.node, temporary, file: file.clone() });
        Ok(file)
    }

    /// What an error of writing to this file means for the node.
    #[must_use]
    pub fn error(&self, source: io::Error) -> FileError {
        self.staging.error(&self.name, self.cancel, source)
    }
}

impl Staging {
    fn error(&self, name: &str, cancel: &CancelToken, source: io::Error) -> FileError {
        if cancel.is_cancelled() {
            return FileError::Cancelled;
        }
        cannot_write(&self.folder.join(name), source)
    }
}

impl Write for OutputFile<'_> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        if self.cancel.is_cancelled() {
            return Err(io::Error::other("interrupted"));
        }
        self.file.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn writer(node: usize) -> Writer {
        Writer { node, id: format!("n{node}") }
    }

    /// Writes a file as a node.
    fn write(staging: &Staging, node: usize, name: &str) -> Result<WrittenFile, FileError> {
        let cancel = CancelToken::default();
        let mut file = staging.create(name.to_owned(), writer(node), &cancel)?;
        file.write_all(name.as_bytes()).map_err(|fault| file.error(fault))?;
        file.finish()
    }

    #[test]
    fn written_files_know_their_size_and_hash() {
        let folder = tempfile::tempdir().unwrap();
        let staging = Staging::new(folder.path().to_owned());
        let file = write(&staging, 0, "a.txt").unwrap();
        let blake3 = blake3::hash(b"a.txt").to_hex().to_string();
        assert_eq!(file, WrittenFile { name: "a.txt".to_owned(), bytes: 5, blake3 });
        assert_eq!(staging.written_by(0), [file]);
        assert_eq!(staging.written_by(1), []);
    }

    #[test]
    fn nothing_comes_after_abandoning() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let (staging, cancel) = (Staging::new(out.clone()), CancelToken::default());
        write(&staging, 0, "a.txt").unwrap();
        let mut begun = staging.create("b.txt".to_owned(), writer(1), &cancel).unwrap();
        begun.write_all(b"b").unwrap();
        staging.abandon();
        assert!(!out.exists());
        assert!(matches!(begun.finish(), Err(FileError::Cancelled)));
        assert!(matches!(write(&staging, 2, "c.txt"), Err(FileError::Cancelled)));
        assert!(staging.publish(|_| true).is_none());
        assert!(!out.exists());
    }

    #[test]
    fn a_name_belongs_to_the_first_node_in_the_recipe() {
        let folder = tempfile::tempdir().unwrap();
        let staging = Staging::new(folder.path().to_owned());
        for node in [2, 1, 3] {
            let taken = write(&staging, node, "Part.txt");
            assert_eq!(taken.is_ok(), node < 3, "{node}");
        }
        let told = |node| staging.ousted(node).map(|fault| fault.to_string());
        assert_eq!(told(1), None);
        for node in [2, 3] {
            assert!(told(node).unwrap().contains("already written by node \"n1\""), "{node}");
        }
    }

    #[test]
    fn what_is_cancelled_is_no_fault_of_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        let (staging, cancel) = (Staging::new(folder.path().to_owned()), CancelToken::default());
        let mut file = staging.create("a.txt".to_owned(), writer(0), &cancel).unwrap();
        cancel.cancel();
        let fault = file.write_all(b"a").unwrap_err();
        assert!(matches!(file.error(fault), FileError::Cancelled));
    }
}
