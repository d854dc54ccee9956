//! A plugin's safe traits behind the C layout of [`carvegraph_abi`].
//!
//! [`export!`](crate::export!) makes the constant that a library exports; [`plugin!`](crate::plugin!)
//! makes the same without exporting it, for a plugin that is linked. Every call is guarded: a panic
//! becomes a status and a message, and what panicked is not called again.

#![allow(unsafe_code, reason = "this is the boundary; authors of plugins write none")]

mod borrow;
mod cutters;
mod dialects;
mod guard;
mod nodes;
mod shelf;
#[doc(hidden)]
pub mod wire;

use crate::node::Node;
use crate::{CutterShape, Dialect};
use borrow::{lent, read};
use carvegraph_abi::{self as abi, Status, capability, status};
use guard::Fault;
use shelf::Constant;
pub use shelf::Shelf;
use std::ffi::c_void;
use std::marker::PhantomData;
use std::mem::size_of;
use std::ptr;
use std::sync::OnceLock;

/// The cutters, dialects and nodes of a plugin.
#[derive(Default)]
pub struct Offers {
    cutters: Vec<Box<dyn CutterShape>>,
    dialects: Vec<Box<dyn Dialect>>,
    nodes: Vec<Box<dyn Node>>,
}

impl Offers {
    /// None yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a cutter shape.
    #[must_use]
    pub fn cutter(self, shape: impl CutterShape + 'static) -> Self {
        self.cutters([Box::new(shape) as Box<dyn CutterShape>])
    }

    /// Adds cutter shapes.
    #[must_use]
    pub fn cutters(mut self, shapes: impl IntoIterator<Item = Box<dyn CutterShape>>) -> Self {
        self.cutters.extend(shapes);
        self
    }

    /// Adds a dialect.
    #[must_use]
    pub fn dialect(self, dialect: impl Dialect + 'static) -> Self {
        self.dialects([Box::new(dialect) as Box<dyn Dialect>])
    }

    /// Adds dialects.
    #[must_use]
    pub fn dialects(mut self, dialects: impl IntoIterator<Item = Box<dyn Dialect>>) -> Self {
        self.dialects.extend(dialects);
        self
    }

    /// Adds a kind of node.
    #[must_use]
    pub fn node(mut self, node: impl Node + 'static) -> Self {
        self.nodes.push(Box::new(node));
        self
    }
}

/// A plugin as [`plugin!`](crate::plugin!) makes it.
pub trait Offer: 'static {
    /// Its name.
    const ID: &'static str;
    /// Its version.
    const VERSION: &'static str;
    /// Makes what it offers; called once.
    fn offers() -> Offers;
    /// Where that is kept.
    fn shelf() -> &'static OnceLock<Shelf>;
}

/// Makes a type that stands for a plugin, to be linked into a program: `plugin!(Standard, Offers::new()
/// .cutter(Ball))`. Its entry is [`entry`]`::<Standard>()`.
#[macro_export]
macro_rules! plugin {
    ($(#[$meta:meta])* $name:ident, $offers:expr) => {
        #[cfg(panic = "abort")]
        compile_error!("a plugin must unwind, or its panics end carve: remove panic = \"abort\"");

        $(#[$meta])*
        #[derive(Debug)]
        pub struct $name;

        impl $crate::export::Offer for $name {
            const ID: &'static str = env!("CARGO_PKG_NAME");
            const VERSION: &'static str = env!("CARGO_PKG_VERSION");

            fn offers() -> $crate::export::Offers {
                $offers
            }

            fn shelf() -> &'static ::std::sync::OnceLock<$crate::export::Shelf> {
                static SHELF: ::std::sync::OnceLock<$crate::export::Shelf> =
                    ::std::sync::OnceLock::new();
                &SHELF
            }
        }
    };
}

/// Exports a plugin from a library (`crate-type = ["cdylib"]`):
/// `export!(Offers::new().cutter(Ogee))`, or `export!(type Standard)` for one made by
/// [`plugin!`](crate::plugin!).
#[macro_export]
macro_rules! export {
    (type $plugin:ty) => {
        #[doc(hidden)]
        #[allow(non_upper_case_globals)]
        #[unsafe(no_mangle)]
        pub static carvegraph_plugin: $crate::export::Entry = $crate::export::entry::<$plugin>();
    };
    ($offers:expr) => {
        $crate::plugin!(#[doc(hidden)] ExportedPlugin, $offers);
        $crate::export!(type ExportedPlugin);
    };
}

/// What a library exports.
pub type Entry = abi::Plugin;

/// The entry of a plugin.
#[must_use]
pub const fn entry<P: Offer>() -> Entry {
    abi::Plugin {
        magic: abi::MAGIC,
        abi_major: abi::MAJOR,
        abi_minor: abi::MINOR,
        struct_size: size_of::<abi::Plugin>() as u32,
        reserved: 0,
        init: Some(init),
        get_factory: Some(get_factory::<P>),
    }
}

/// What the host does, from `init` on.
static HOST: OnceLock<Constant<abi::Host>> = OnceLock::new();

unsafe extern "C" fn init(host: *const abi::Host, fault: *const abi::Sink) -> Status {
    let fault = Fault(fault);
    guard::once(fault, || {
        guard::hush();
        // SAFETY: the host gives a struct that is valid for good.
        let host = unsafe { read(host) };
        if host.abi_major != abi::MAJOR {
            let (theirs, ours) = (host.abi_major, abi::MAJOR);
            return fault.tell(&format!("carve speaks ABI {theirs}, this plugin {ours}"));
        }
        HOST.get_or_init(|| Constant(host));
        status::OK
    })
}

struct Tables<P>(PhantomData<P>);

impl<P: Offer> Tables<P> {
    const ABOUT: &'static Constant<abi::About> = &Constant(abi::About {
        struct_size: size_of::<abi::About>() as u32,
        reserved: 0,
        id: lent(P::ID),
        version: lent(P::VERSION),
    });
    const CUTTERS: &'static abi::CutterFactory = &cutters::factory::<P>();
    const DIALECTS: &'static abi::DialectFactory = &dialects::factory::<P>();
    const NODES: &'static abi::NodeFactory = &nodes::factory::<P>();
}

unsafe extern "C" fn get_factory<P: Offer>(id: abi::Text) -> *const c_void {
    // SAFETY: the host lends the text for the call.
    match unsafe { borrow::text(id) } {
        Some(capability::ABOUT) => ptr::from_ref(Tables::<P>::ABOUT).cast(),
        Some(capability::CUTTER) => ptr::from_ref(Tables::<P>::CUTTERS).cast(),
        Some(capability::DIALECT) => ptr::from_ref(Tables::<P>::DIALECTS).cast(),
        Some(capability::NODE) => ptr::from_ref(Tables::<P>::NODES).cast(),
        _ => ptr::null(),
    }
}
