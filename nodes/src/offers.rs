//! What recipes can choose from beside the standard nodes, wherever it comes from: linked plugins,
//! plugins in libraries, files.

use crate::plugin::{PluginNodeError, kind_of};
use crate::registry::kinds;
use carvegraph_core::{Missing, NodeKind};
use carvegraph_sdk::node::Node;
use carvegraph_sdk::{CutterShape, Dialect};

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
    #[error("it offers the {sort} {name:?}, and there is one of that name already")]
    Taken {
        /// cutter, dialect, node ...
        sort: &'static str,
        /// The name.
        name: String,
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
        check("cutter", batch.cutters.iter().map(|c| c.name()), |name| {
            self.cutters.iter().any(|known| known.thing.name() == name)
        })?;
        check("dialect", batch.dialects.iter().map(|d| d.name()), |name| {
            self.dialects.iter().any(|known| known.thing.name() == name)
        })?;
        let standard = kinds();
        check("node", nodes.iter().map(|kind| kind.name), |name| {
            standard.iter().chain(&self.nodes).any(|known| known.name == name)
        })?;
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

/// Refuses a name that is taken, or that the batch itself has twice.
fn check<'n>(
    sort: &'static str,
    names: impl Iterator<Item = &'n str>,
    taken: impl Fn(&str) -> bool,
) -> Result<(), OfferError> {
    let mut seen: Vec<&str> = Vec::new();
    for name in names {
        if taken(name) || seen.contains(&name) {
            return Err(OfferError::Taken { sort, name: name.to_owned() });
        }
        seen.push(name);
    }
    Ok(())
}
