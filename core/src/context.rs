//! What a node is given to work with besides its inputs and parameters.

use crate::cancel::CancelToken;
use crate::catalog::Catalogs;
use crate::files::{FileError, FileHashes, Files, InputFile, OutputName};
use crate::node_error::NodeError;
use crate::report::{Note, Observer, ReadFile, Weight};
use crate::staging::{OutputFile, Staging, Writer};
use std::any::Any;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The only way from a node to files, services, progress and messages.
pub struct Context<'a> {
    pub(crate) index: usize,
    pub(crate) node: &'a str,
    pub(crate) prefix: &'a str,
    /// Whether the node said that it uses it.
    pub(crate) uses_prefix: bool,
    pub(crate) files: Files,
    /// What the files contained when the run was planned, if somebody asked.
    pub(crate) hashes: Option<&'a FileHashes>,
    pub(crate) staging: &'a Staging,
    pub(crate) catalogs: &'a Catalogs,
    pub(crate) cancel: &'a CancelToken,
    pub(crate) observer: &'a dyn Observer,
    pub(crate) notes: Mutex<Vec<Note>>,
    /// What the nodes of the run have read.
    pub(crate) read: &'a Reads,
}

/// The files that a run has read so far, by path.
pub(crate) type Reads = Mutex<BTreeMap<String, ReadFile>>;

impl Context<'_> {
    /// The contents of a file.
    ///
    /// # Errors
    /// If it cannot be read, or was changed since the run was planned.
    pub fn read(&self, file: &InputFile) -> Result<Cow<'static, [u8]>, FileError> {
        let bytes = self.files.read(file, self.cancel)?;
        // What is made of the new contents must not be kept as made of the old ones.
        let (found, path) = (blake3::hash(&bytes), file.to_string());
        match self.hashes.and_then(|hashes| hashes.get(file)) {
            Some(hash) if *hash != found => Err(FileError::Changed { path }),
            _ => {
                let blake3 = found.to_hex().to_string();
                let file = ReadFile { path: path.clone(), bytes: bytes.len() as u64, blake3 };
                self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(path, file);
                Ok(bytes)
            }
        }
    }

    /// Begins a file in the output folder.
    ///
    /// # Errors
    /// If it cannot be made, or another node writes one of the same name.
    pub fn create(&self, name: &OutputName, extension: &str) -> Result<OutputFile<'_>, FileError> {
        let name = name.file_name(self.prefix, extension)?;
        let writer = Writer { node: self.index, id: self.node.to_owned() };
        self.staging.create(name, writer, self.cancel)
    }

    /// The name of the picture or part that the work began with.
    ///
    /// # Panics
    /// If the node does not set [`Node::USES_PREFIX`](crate::Node::USES_PREFIX).
    #[must_use]
    pub fn prefix(&self) -> &str {
        assert!(self.uses_prefix, "set Node::USES_PREFIX to use the prefix");
        self.prefix
    }

    /// A service that was registered with a catalog.
    ///
    /// # Errors
    /// If there is none: the program was put together wrongly.
    pub fn service<T: Any + Send + Sync>(&self) -> Result<&T, NodeError> {
        let name = std::any::type_name::<T>();
        self.catalogs.service().ok_or_else(|| NodeError::failed(format!("no service {name}")))
    }

    /// Whether the run was called off.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_cancelled()
    }

    /// What a kernel made, if it was not called off.
    ///
    /// # Errors
    /// [`NodeError::Cancelled`] for `None`.
    pub fn completed<T>(&self, result: Option<T>) -> Result<T, NodeError> {
        result.ok_or(NodeError::Cancelled)
    }

    /// Counts work against a `total` known beforehand.
    #[must_use]
    pub fn ticker(&self, total: usize) -> Ticker<'_> {
        Ticker { context: self, total: total.max(1), done: AtomicUsize::new(0) }
    }

    /// Tells the user something.
    pub fn note(&self, text: impl Into<String>) {
        self.say(Weight::Note, text.into());
    }

    /// Warns the user.
    pub fn warn(&self, text: impl Into<String>) {
        self.say(Weight::Warning, text.into());
    }

    fn say(&self, weight: Weight, text: String) {
        let note = Note { weight, text };
        self.observer.noted(self.node, &note);
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note);
    }
}

/// Calls `work` with a context of its own, as a node's test needs one. Files that it writes stay in
/// temporary files and vanish.
pub fn with_context<T>(catalogs: &Catalogs, work: impl FnOnce(&Context<'_>) -> T) -> T {
    let staging = Staging::new(std::env::temp_dir());
    let (cancel, read) = (CancelToken::default(), Reads::default());
    work(&Context {
        index: 0,
        node: "test",
        prefix: "test",
        uses_prefix: true,
        files: Files { assets: &[] },
        hashes: None,
        staging: &staging,
        catalogs,
        cancel: &cancel,
        observer: &(),
        notes: Mutex::default(),
        read: &read,
    })
}

/// Progress of one piece of work. Kernels call [`tick`](Self::tick) from any thread.
pub struct Ticker<'a> {
    context: &'a Context<'a>,
    total: usize,
    done: AtomicUsize,
}

impl Ticker<'_> {
    /// Counts `units` more as done; answers whether to go on.
    pub fn tick(&self, units: usize) -> bool {
        let before = self.done.fetch_add(units, Ordering::Relaxed);
        let percent = |done: usize| done.saturating_mul(100) / self.total;
        if percent(before + units) != percent(before) {
            let share = ((before + units) as f64 / self.total as f64).min(1.0);
            self.context.observer.progressed(self.context.node, share);
        }
        !self.context.is_cancelled()
    }
}
