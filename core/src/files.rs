//! Files that nodes read, and names of files that they may write.
//!
//! A path in a recipe starts at the recipe's own folder, one on the command line at the current
//! folder. Recipes that are built into the program find their files in the program too.

use crate::cancel::CancelToken;
use crate::diagnostic::harmless;
use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// No input is larger than this: a recipe is untrusted and must not fill the memory.
pub const MAX_INPUT_BYTES: u64 = 4 << 30;

/// How much is read between two looks at the cancel token.
const CHUNK_BYTES: usize = 1 << 20;

/// Files that are part of the program: path and contents.
pub type Assets = &'static [(&'static str, &'static [u8])];

/// Where relative paths start.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Origin {
    /// At a folder.
    Folder(PathBuf),
    /// Among the files that are part of the program.
    BuiltIn,
}

impl Origin {
    /// The file that `path` means.
    #[must_use]
    pub fn locate(&self, path: &str) -> InputFile {
        let place = match self {
            Self::BuiltIn => Place::BuiltIn(path.to_owned()),
            Self::Folder(folder) => Place::Disk(folder.join(path)),
        };
        InputFile { place }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Place {
    Disk(PathBuf),
    BuiltIn(String),
}

/// A file that a node may read, through its context only.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct InputFile {
    place: Place,
}

/// Its path, without anything a terminal would obey: a recipe may have written it.
impl fmt::Display for InputFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&harmless(&self.path().to_string_lossy()))
    }
}

impl InputFile {
    /// Its path; of a built-in file the path inside the program.
    #[must_use]
    pub fn path(&self) -> &Path {
        match &self.place {
            Place::Disk(path) => path,
            Place::BuiltIn(path) => Path::new(path),
        }
    }

    /// The file's name without folders and extension, with anything odd in it made harmless.
    #[must_use]
    pub fn stem(&self) -> String {
        harmless_stem(self.path())
    }

    /// The file on disk, if it is there, under the one path that it has without links and detours.
    pub(crate) fn canonical(&self) -> Option<PathBuf> {
        match &self.place {
            Place::Disk(path) => path.canonicalize().ok(),
            Place::BuiltIn(_) => None,
        }
    }
}

/// The stem of a path as a part of a portable file name.
pub(crate) fn harmless_stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let harmless = |letter: char| if is_portable(letter) { letter } else { '_' };
    let mut stem: String = stem.chars().map(harmless).collect();
    while stem.len() > MAX_PART_BYTES {
        stem.pop();
    }
    match stem.trim_matches([' ', '.']) {
        "" => "carve".to_owned(),
        stem if is_device(stem) => format!("{stem}_"),
        stem => stem.to_owned(),
    }
}

/// Whether every file system takes the letter in a name.
fn is_portable(letter: char) -> bool {
    letter.is_alphanumeric() || "-_+ .()".contains(letter)
}

/// Whether Windows takes a name for a device, with any extension and in any case.
fn is_device(name: &str) -> bool {
    let name = name.split('.').next().unwrap_or_default().trim_end().to_ascii_lowercase();
    let is_port = |rest: &str| rest.len() == 1 && rest.bytes().all(|byte| byte.is_ascii_digit());
    matches!(name.as_str(), "con" | "prn" | "aux" | "nul")
        || name.strip_prefix("com").or(name.strip_prefix("lpt")).is_some_and(is_port)
}

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// There is none.
    #[error("there is no file {path}")]
    NotFound {
        /// The path that was tried.
        path: String,
    },
    /// It is a folder or a device.
    #[error("{path} is not a plain file")]
    NotAFile {
        /// Its path.
        path: String,
    },
    /// It has no bytes.
    #[error("{path} is empty (0 bytes)")]
    Empty {
        /// Its path.
        path: String,
    },
    /// It is larger than [`MAX_INPUT_BYTES`].
    #[error("{path} has {bytes} bytes; the limit is {MAX_INPUT_BYTES}")]
    TooLarge {
        /// Its path.
        path: String,
        /// Its size.
        bytes: u64,
    },
    /// The system refuses.
    #[error("cannot {action} {path}: {source}")]
    Io {
        /// "read" or "write".
        action: &'static str,
        /// The path.
        path: String,
        /// What the system says.
        source: io::Error,
    },
    /// Another node has written a file of this name in the same run.
    #[error("{name} is already written by node {other:?}: give one of them another file name")]
    Taken {
        /// The name.
        name: String,
        /// The node that came first.
        other: String,
    },
    /// The file is one that the recipe reads.
    #[error(
        "{name} would take the place of a file that the recipe reads: choose another folder or file name"
    )]
    Input {
        /// The name.
        name: String,
    },
    /// A node or a plugin made a name of it that is none.
    #[error(transparent)]
    Name(#[from] OutputNameError),
    /// It was changed between two looks at it.
    #[error("{path} was changed while the recipe ran: run it again")]
    Changed {
        /// Its path.
        path: String,
    },
    /// The run was interrupted while the file was read or written.
    #[error("interrupted")]
    Cancelled,
}

/// What files contained when they were looked at.
pub(crate) type FileHashes = HashMap<InputFile, blake3::Hash>;

/// Reads input files, from disk and from the program.
#[derive(Clone, Copy)]
pub(crate) struct Files {
    pub(crate) assets: Assets,
}

/// What comes of opening a file.
enum Opened {
    Disk(File, u64),
    BuiltIn(&'static [u8]),
}

impl Files {
    /// Whether the file is there, plain, not empty and not too large.
    pub(crate) fn check(&self, file: &InputFile) -> Result<(), FileError> {
        self.open(file).map(drop)
    }

    /// The whole contents.
    pub(crate) fn read(
        &self,
        file: &InputFile,
        cancel: &CancelToken,
    ) -> Result<Cow<'static, [u8]>, FileError> {
        let (disk, bytes) = match self.open(file)? {
            Opened::BuiltIn(bytes) => return Ok(Cow::Borrowed(bytes)),
            Opened::Disk(disk, bytes) => (disk, bytes),
        };
        let mut all = Vec::with_capacity(usize::try_from(bytes).unwrap_or(0));
        each_chunk(file, disk, bytes, cancel, |chunk| all.extend_from_slice(chunk))?;
        Ok(Cow::Owned(all))
    }

    /// The BLAKE3 hash of the contents.
    pub(crate) fn hash(
        &self,
        file: &InputFile,
        cancel: &CancelToken,
    ) -> Result<blake3::Hash, FileError> {
        match self.open(file)? {
            Opened::BuiltIn(bytes) => Ok(blake3::hash(bytes)),
            Opened::Disk(disk, bytes) => {
                let mut hasher = blake3::Hasher::new();
                each_chunk(file, disk, bytes, cancel, |chunk| _ = hasher.update(chunk))?;
                Ok(hasher.finalize())
            }
        }
    }

    /// The size.
    pub(crate) fn bytes(&self, file: &InputFile) -> Result<u64, FileError> {
        Ok(match self.open(file)? {
            Opened::BuiltIn(bytes) => bytes.len() as u64,
            Opened::Disk(_, bytes) => bytes,
        })
    }

    fn open(&self, file: &InputFile) -> Result<Opened, FileError> {
        let path = file.to_string();
        let disk = match &file.place {
            Place::Disk(disk) => disk,
            Place::BuiltIn(name) => {
                let asset = self.assets.iter().find(|(known, _)| known == name);
                return match asset {
                    Some((_, bytes)) => Ok(Opened::BuiltIn(bytes)),
                    None => Err(FileError::NotFound { path }),
                };
            }
        };
        let io_error = |source: io::Error| match source.kind() {
            io::ErrorKind::NotFound => FileError::NotFound { path: path.clone() },
            _ => FileError::Io { action: "read", path: path.clone(), source },
        };
        // The kind is looked at before the file is opened: opening a pipe would wait for its writer.
        let about = std::fs::metadata(disk).map_err(io_error)?;
        match about.len() {
            _ if !about.is_file() => Err(FileError::NotAFile { path }),
            0 => Err(FileError::Empty { path }),
            bytes if bytes > MAX_INPUT_BYTES => Err(FileError::TooLarge { path, bytes }),
            bytes => Ok(Opened::Disk(File::open(disk).map_err(io_error)?, bytes)),
        }
    }
}

/// Hands over the first `bytes` bytes of a file. One that grows meanwhile is cut at the size it had.
fn each_chunk(
    file: &InputFile,
    disk: File,
    bytes: u64,
    cancel: &CancelToken,
    mut take: impl FnMut(&[u8]),
) -> Result<(), FileError> {
    let mut disk = disk.take(bytes);
    let mut buffer = vec![0; CHUNK_BYTES];
    loop {
        if cancel.is_cancelled() {
            return Err(FileError::Cancelled);
        }
        match disk.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(count) => take(&buffer[..count]),
            Err(fault) if fault.kind() == io::ErrorKind::Interrupted => {}
            Err(source) => {
                return Err(FileError::Io { action: "read", path: file.to_string(), source });
            }
        }
    }
}

/// The longest file name, prefix and extension included: file systems take 255 bytes.
const MAX_NAME_BYTES: usize = 240;

/// The longest name of an input as a part of one, and the longest pattern.
const MAX_PART_BYTES: usize = 100;

/// The place in an output name where the name of the input goes.
const PREFIX: &str = "{prefix}";

/// Why a text is no name for an output.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum OutputNameError {
    /// It has folders in it, or goes up.
    #[error(
        "{0:?} would leave the output folder; give a plain file name (--out chooses the folder)"
    )]
    Leaves(String),
    /// It is empty, too long, hidden, a device, or has signs that file systems do not take.
    #[error(
        "{0:?} is no file name; letters, digits, spaces and -_+.() do, {MAX_PART_BYTES} bytes at most"
    )]
    Unfit(String),
}

/// The name of a file to write, without its extension, in the output folder and nowhere else.
/// `{prefix}` in it stands for the name of the picture or part that the work began with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputName {
    pattern: String,
}

impl OutputName {
    /// Takes a name.
    ///
    /// # Errors
    /// If it could lead out of the output folder, or is no portable file name.
    pub fn new(pattern: &str) -> Result<Self, OutputNameError> {
        let is_up = !pattern.is_empty() && pattern.bytes().all(|byte| byte == b'.');
        if is_up || pattern.contains(['/', '\\', ':']) {
            return Err(OutputNameError::Leaves(pattern.to_owned()));
        }
        let name = pattern.replacen(PREFIX, "x", 1);
        if name.len() > MAX_PART_BYTES || !is_file_name(&name) {
            return Err(OutputNameError::Unfit(pattern.to_owned()));
        }
        Ok(Self { pattern: pattern.to_owned() })
    }

    /// As it was given.
    #[must_use]
    pub fn pattern(&self) -> &str {
        &self.pattern
    }

    /// Whether the name of the input is a part of it.
    pub(crate) fn uses_prefix(&self) -> bool {
        self.pattern.contains(PREFIX)
    }

    /// The file's name for an input called `prefix`.
    pub(crate) fn file_name(
        &self,
        prefix: &str,
        extension: &str,
    ) -> Result<String, OutputNameError> {
        let name = format!("{}.{extension}", self.pattern.replace(PREFIX, prefix));
        let is_extension = |byte: u8| byte.is_ascii_alphanumeric();
        let fits = !extension.is_empty() && extension.bytes().all(is_extension);
        if fits && name.len() <= MAX_NAME_BYTES && is_file_name(&name) {
            Ok(name)
        } else {
            Err(OutputNameError::Unfit(name))
        }
    }
}

/// Whether every file system takes the name, and for a file in plain sight.
fn is_file_name(name: &str) -> bool {
    let edges = [' ', '.'];
    !name.is_empty()
        && name.chars().all(is_portable)
        && !name.starts_with(edges)
        && !name.ends_with(edges)
        && !is_device(name)
}

impl From<&str> for OutputName {
    /// For defaults in a node's definition.
    ///
    /// # Panics
    /// If the name is not one; every default is read when the registry is made.
    fn from(pattern: &str) -> Self {
        Self::new(pattern).unwrap_or_else(|fault| unreachable!("{fault}"))
    }
}
