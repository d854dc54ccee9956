//! Opening a library and looking at what it exports.

use crate::borrow::{self, Given};
use crate::cutter::LibraryCutter;
use crate::dialect::LibraryDialect;
use crate::manifest::Offered;
use crate::message::{heard, reason};
use crate::node::LibraryNode;
use crate::watch::HOST;
use carvegraph_abi::{self as abi, capability, status};
use carvegraph_sdk::node::Node;
use carvegraph_sdk::{CutterShape, Dialect};
use libloading::Library;
use std::ffi::c_void;
use std::mem::size_of;
use std::path::Path;
use std::ptr;

/// What a plugin offers.
#[derive(Default)]
pub struct Plugin {
    /// What it calls itself, and its version, if it says so.
    pub about: Option<(String, String)>,
    /// Its cutter shapes.
    pub cutters: Vec<Box<dyn CutterShape>>,
    /// Its dialects.
    pub dialects: Vec<Box<dyn Dialect>>,
    /// Its kinds of node.
    pub nodes: Vec<Box<dyn Node>>,
}

impl Plugin {
    /// The names of what it offers, sorted.
    #[must_use]
    pub fn offered(&self) -> Offered {
        let cutters = self.cutters.iter().map(|cutter| cutter.name().to_owned()).collect();
        let dialects = self.dialects.iter().map(|dialect| dialect.name().to_owned()).collect();
        let nodes = self.nodes.iter().map(|node| node.name().to_owned()).collect();
        Offered { cutters, dialects, nodes }.sorted()
    }
}

/// Why a library can't be used as a plugin.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The system can't load it.
    #[error("the system cannot load it: {0}")]
    System(String),
    /// It exports no plugin.
    #[error("it is no Carvegraph plugin: it exports no carvegraph_plugin")]
    NoSymbol,
    /// What it exports is something else.
    #[error("it is no Carvegraph plugin: its magic number is {0:#018x}, not {magic:#018x}", magic = abi::MAGIC)]
    Magic(u64),
    /// It was built for another major version of the ABI.
    #[error(
        "it was built for ABI {major}.{minor}, this carve speaks {our_major}.{our_minor}: {todo}",
        our_major = abi::MAJOR,
        our_minor = abi::MINOR,
        todo = if *.major > abi::MAJOR { "update carve" } else { "build it anew" }
    )]
    Major {
        /// Its major version.
        major: u32,
        /// Its minor version.
        minor: u32,
    },
    /// Its entry is shorter than in any version of the ABI, or lacks a function.
    #[error("its carvegraph_plugin is incomplete")]
    Incomplete,
    /// It refuses to begin.
    #[error("it refuses to begin: {0}")]
    Init(String),
    /// A table is shorter than in any version of the ABI.
    #[error("its table of {0} is incomplete")]
    Table(&'static str),
    /// A description is wrong.
    #[error("{what} {index}: {fault}")]
    Description {
        /// cutter, dialect or node.
        what: &'static str,
        /// Its place in the table, from 1.
        index: u32,
        /// What is wrong.
        fault: Given,
    },
    /// More than a plugin may offer.
    #[error("it claims to offer {count} {what}s; {MAX_OFFERS} at most are taken")]
    TooMany {
        /// cutter, dialect or node.
        what: &'static str,
        /// How many.
        count: u32,
    },
}

/// No plugin offers more of a sort.
const MAX_OFFERS: u32 = 1000;

/// Loads a library for good and takes what it offers.
///
/// A library can do anything when it is loaded, so this is to be called for those that the user put into
/// a plugin folder, after [`probe`](crate::probe()) has seen that the process survives it.
///
/// # Errors
/// If the system can't load it, or it does not keep the rules.
#[allow(clippy::missing_panics_doc, reason = "it does not")]
pub fn load(path: &Path) -> Result<Plugin, LoadError> {
    // SAFETY: the user chose to run this library's code.
    let library = unsafe { Library::new(path) };
    let library = library.map_err(|fault| LoadError::System(in_full(&fault)))?;
    // SAFETY: the symbol is only looked at as plain data, from its first field on.
    let entry = unsafe { library.get::<*const abi::Plugin>(abi::SYMBOL.to_bytes_with_nul()) };
    let entry = match entry {
        Ok(symbol) => *symbol,
        Err(_) => return Err(LoadError::NoSymbol),
    };
    // Never unloaded: what it gave may be in use, and so may its threads' destructors.
    std::mem::forget(library);
    // SAFETY: it stays loaded, and `adopt` looks before it believes.
    unsafe { adopt(entry) }
}

/// The message of the system, which some wrap.
fn in_full(fault: &dyn std::error::Error) -> String {
    match fault.source() {
        Some(source) => source.to_string(),
        None => fault.to_string(),
    }
}

/// Takes what a linked plugin offers: [`carvegraph_sdk::export::entry`].
///
/// # Errors
/// As for [`load`].
pub fn linked(entry: &'static abi::Plugin) -> Result<Plugin, LoadError> {
    // SAFETY: made by the sdk.
    unsafe { adopt(entry) }
}

/// # Safety
/// `entry` lives for good, and what calls itself a plugin keeps the rules.
unsafe fn adopt(entry: *const abi::Plugin) -> Result<Plugin, LoadError> {
    // SAFETY: the fields are read in their order, each only if those before say that it is there.
    unsafe {
        if entry.is_null() || !entry.is_aligned() {
            return Err(LoadError::NoSymbol);
        }
        let magic = (&raw const (*entry).magic).read();
        if magic != abi::MAGIC {
            return Err(LoadError::Magic(magic));
        }
        let (major, minor) = ((*entry).abi_major, (*entry).abi_minor);
        if major != abi::MAJOR {
            return Err(LoadError::Major { major, minor });
        }
        if ((*entry).struct_size as usize) < size_of::<abi::Plugin>() {
            return Err(LoadError::Incomplete);
        }
        let (Some(init), Some(get_factory)) = ((*entry).init, (*entry).get_factory) else {
            return Err(LoadError::Incomplete);
        };
        let (answer, said) = heard(|fault| init(&raw const HOST, fault));
        if answer != status::OK {
            return Err(LoadError::Init(reason(answer, said)));
        }
        offers(|id| get_factory(borrow::lent(id)))
    }
}

/// # Safety
/// The tables keep the rules of the ABI.
unsafe fn offers(factory: impl Fn(&'static str) -> *const c_void) -> Result<Plugin, LoadError> {
    // SAFETY: the caller's promise, and each table is as long as it says.
    unsafe {
        let about = table::<abi::About>(factory(capability::ABOUT), "about")?;
        let cutters = table::<abi::CutterFactory>(factory(capability::CUTTER), "cutters")?;
        let dialects = table::<abi::DialectFactory>(factory(capability::DIALECT), "dialects")?;
        let nodes = table::<abi::NodeFactory>(factory(capability::NODE), "nodes")?;
        Ok(Plugin {
            about: about.and_then(|about| {
                let id = borrow::text("id", about.id).ok()?;
                Some((id, borrow::text("version", about.version).ok()?))
            }),
            cutters: described("cutter", cutters.map(|t| (t, t.count)), |table, index| {
                Ok(Box::new(LibraryCutter::describe(table, index)?) as Box<dyn CutterShape>)
            })?,
            dialects: described("dialect", dialects.map(|t| (t, t.count)), |table, index| {
                Ok(Box::new(LibraryDialect::describe(table, index)?) as Box<dyn Dialect>)
            })?,
            nodes: described("node", nodes.map(|t| (t, t.count)), |table, index| {
                Ok(Box::new(LibraryNode::describe(table, index)?) as Box<dyn Node>)
            })?,
        })
    }
}

/// A table that begins with its own size.
///
/// # Safety
/// If it is not null, it is as long as it says and lives for good.
unsafe fn table<T>(
    table: *const c_void,
    what: &'static str,
) -> Result<Option<&'static T>, LoadError> {
    if table.is_null() {
        return Ok(None);
    }
    let table = table.cast::<T>();
    if !table.is_aligned() {
        return Err(LoadError::Table(what));
    }
    // SAFETY: the caller's promise.
    unsafe {
        let size = ptr::read(table.cast::<u32>()) as usize;
        if size < size_of::<T>() { Err(LoadError::Table(what)) } else { Ok(table.as_ref()) }
    }
}

type Count = unsafe extern "C" fn() -> u32;

/// Everything in a table.
///
/// # Safety
/// The table keeps the rules of the ABI.
unsafe fn described<T: ?Sized, F>(
    what: &'static str,
    table: Option<(&'static F, Count)>,
    describe: impl Fn(&'static F, u32) -> Result<Box<T>, Given>,
) -> Result<Vec<Box<T>>, LoadError> {
    let Some((table, count)) = table else { return Ok(Vec::new()) };
    // SAFETY: the caller's promise.
    let count = unsafe { count() };
    if count > MAX_OFFERS {
        return Err(LoadError::TooMany { what, count });
    }
    let one = |index| {
        describe(table, index).map_err(|fault| LoadError::Description {
            what,
            index: index + 1,
            fault,
        })
    };
    (0..count).map(one).collect()
}
