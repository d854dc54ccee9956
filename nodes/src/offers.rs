//! What recipes can choose from beside the standard nodes, wherever it comes from: linked plugins,
//! plugins in libraries, files.

use crate::plugin::{PluginNodeError, kind_of};
use crate::registry::kinds;
use carvegraph_core::{Missing, NodeKind};
use carvegraph_sdk::node::Node;
use carvegraph_sdk::{CutterShape, Dialect};
use std::collections::BTreeMap;

/// A thing, and the version of what it stands for: another one makes cached values stale.
pub(crate) struct Versioned<T> {
    pub(crate) thing: T,
    pub(crate) version: String,
}

/// What one plugin or file brings.
#[derive(Default)]
pub struct Batch {
    /// Cutter shapes.
    pub cutters: Vec<Box<dyn CutterShape>>,
    /// Dialects.
    pub dialects: Vec<Box<dyn Dialect>>,
    /// Kinds of node.
    pub nodes: Vec<Box<dyn Node>>,
}

/// Everything that is offered.
#[derive(Default)]
pub struct Offers {
    pub(crate) cutters: Vec<Versioned<Box<dyn CutterShape>>>,
    pub(crate) dialects: Vec<Versioned<Box<dyn Dialect>>>,
    pub(crate) nodes: Vec<NodeKind>,
    pub(crate) missing: Vec<(&'static str, Missing)>,
}

/// Why something cannot be offered.
#[derive(Debug, thiserror::Error)]
pub enum OfferError {
    /// Its name is taken.
    #[error("it offers the {sort} {name:?}, which {owner} has already")]
    Taken {
        /// cutter, dialect, node ...
        sort: &'static str,
        /// The name.
        name: String,
        /// Whose it is.
        owner: String,
    },
    /// A node is defined wrongly.
    #[error(transparent)]
    Node(#[from] PluginNodeError),
}

impl Offers {
    /// Adds all of a batch, or nothing if something is wrong with it. `origin` says where it comes from
    /// and in which version.
    ///
    /// # Errors
    /// If a name is taken, or a node is defined wrongly.
    pub fn add(&mut self, batch: Batch, origin: &str) -> Result<(), OfferError> {
        let kind = |node| kind_of(node, origin.to_owned());
        let nodes = batch.nodes.into_iter().map(kind).collect::<Result<Vec<_>, _>>()?;
        let known = self.cutters.iter().map(|known| (known.thing.name(), &*known.version));
        check("cutter", origin, known, batch.cutters.iter().map(|cutter| cutter.name()))?;
        let known = self.dialects.iter().map(|known| (known.thing.name(), &*known.version));
        check("dialect", origin, known, batch.dialects.iter().map(|dialect| dialect.name()))?;
        let standard = kinds();
        let known = standard.iter().chain(&self.nodes);
        let known = known.map(|kind| (kind.name, kind.origin.as_deref().unwrap_or("carve")));
        check("node", origin, known, nodes.iter().map(|kind| kind.name))?;
        self.cutters.extend(versioned(batch.cutters, origin));
        self.dialects.extend(versioned(batch.dialects, origin));
        self.nodes.extend(nodes);
        Ok(())
    }

    /// Adds the name of something that cannot be had; see [`Missing`]. `sort` is "node", or the catalog.
    pub fn miss(&mut self, sort: &'static str, missing: Missing) {
        self.missing.push((sort, missing));
    }
}

fn versioned<T>(things: Vec<T>, version: &str) -> impl Iterator<Item = Versioned<T>> {
    things.into_iter().map(|thing| Versioned { thing, version: version.to_owned() })
}

/// Refuses a name that is known, each with whose it is, or that `origin` itself has twice.
fn check<'n>(
    sort: &'static str,
    origin: &'n str,
    known: impl Iterator<Item = (&'n str, &'n str)>,
    names: impl Iterator<Item = &'n str>,
) -> Result<(), OfferError> {
    let mut owners: BTreeMap<&str, &str> = known.collect();
    for name in names {
        if let Some(owner) = owners.insert(name, origin) {
            let (name, owner) = (name.to_owned(), owner.to_owned());
            return Err(OfferError::Taken { sort, name, owner });
        }
    }
    Ok(())
}
