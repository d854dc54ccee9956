//! The kinds of node and the types of value that an engine knows.

use crate::catalog::{CatalogEntry, Catalogs, Missing};
use crate::files::Origin;
use crate::node::NodeKind;
use crate::param::{Given, ParamSpec, ParamValue};
use crate::port::{PortSpec, PortType};
use crate::recipe::RECIPE_KIND;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Everything a recipe may refer to: kinds of node, types of value, catalogs of names.
#[derive(Clone)]
pub struct Registry {
    kinds: Arc<[NodeKind]>,
    types: Arc<[PortType]>,
    catalogs: Catalogs,
    missing: Vec<Missing>,
}

/// Why a list of kinds and types is no registry: a fault in the program or a plugin, not in a
/// recipe.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum RegistryError {
    /// The list is to be sorted.
    #[error("{0:?} stands out of order in the list of nodes")]
    Order(&'static str),
    /// Two kinds of node have the same name.
    #[error("two nodes are called {kind:?}: one from {}, one from {}", from(.first), from(.second))]
    Twice {
        /// The name.
        kind: &'static str,
        /// The origin of the one; `None` for the program itself.
        first: Option<String>,
        /// The origin of the other.
        second: Option<String>,
    },
    /// A node has two parameters, two inputs or two outputs of one name.
    #[error("the node {kind:?} has {name:?} twice")]
    Field {
        /// The node.
        kind: &'static str,
        /// The name.
        name: &'static str,
    },
    /// Two entries of a catalog have the same name.
    #[error("two {catalog}s are called {entry:?}")]
    Entry {
        /// The catalog.
        catalog: &'static str,
        /// The name.
        entry: String,
    },
    /// A parameter of an entry does not do.
    #[error("the {catalog} {entry:?} cannot have the parameter {param:?}: {message}")]
    EntryParam {
        /// The catalog.
        catalog: &'static str,
        /// The entry.
        entry: String,
        /// Its parameter.
        param: &'static str,
        /// What is wrong.
        message: String,
    },
    /// Recipes call each other by this name.
    #[error("no node may be called {RECIPE_KIND:?}")]
    Reserved,
    /// A default is none of the values that the parameter takes.
    #[error("the default of {param:?} of {kind:?} does not do: {message}")]
    Default {
        /// The node.
        kind: &'static str,
        /// Its parameter.
        param: &'static str,
        /// What is wrong.
        message: String,
    },
    /// A port carries a type that is not described.
    #[error(
        "port {port:?} of {kind:?} carries {rust_type}, which is not on the list of port types"
    )]
    UnknownType {
        /// The node.
        kind: &'static str,
        /// Its port.
        port: &'static str,
        /// The type.
        rust_type: &'static str,
    },
}

/// An origin for a message.
fn from(origin: &Option<String>) -> &str {
    origin.as_deref().unwrap_or("the program")
}

impl Registry {
    /// Makes a registry of nodes sorted by name and of the types their ports carry.
    ///
    /// # Errors
    /// If names are out of order or stand for two things, a port's type is missing, or a default is
    /// out of its range.
    pub fn new(
        kinds: Vec<NodeKind>,
        types: Vec<PortType>,
        catalogs: Catalogs,
    ) -> Result<Self, RegistryError> {
        check_order(&kinds)?;
        for (catalog, entries) in catalogs.all() {
            check_entries(catalog, entries, &catalogs)?;
        }
        for kind in &kinds {
            check_kind(kind, &types, &catalogs)?;
        }
        Ok(Self { kinds: kinds.into(), types: types.into(), catalogs, missing: Vec::new() })
    }

    /// Adds kinds of node that are known but cannot be had. One that is there after all is not
    /// missing.
    #[must_use]
    pub fn with_missing_kinds(mut self, kinds: impl IntoIterator<Item = Missing>) -> Self {
        self.missing.extend(kinds);
        self
    }

    /// Adds names of a catalog that are known but cannot be had; see [`Catalogs::with_missing`].
    #[must_use]
    pub fn with_missing_entries(
        mut self,
        catalog: &'static str,
        names: impl IntoIterator<Item = Missing>,
    ) -> Self {
        self.catalogs = self.catalogs.with_missing(catalog, names);
        self
    }

    /// All kinds of node, sorted by name.
    #[must_use]
    pub fn kinds(&self) -> &[NodeKind] {
        &self.kinds
    }

    /// The kind of node called `name`.
    #[must_use]
    pub fn kind(&self, name: &str) -> Option<&NodeKind> {
        let at = self.kinds.binary_search_by(|kind| kind.name.cmp(name)).ok()?;
        Some(&self.kinds[at])
    }

    /// Why there is no kind of node of a name that is known.
    #[must_use]
    pub fn missing_kind(&self, name: &str) -> Option<&Missing> {
        Missing::find(&self.missing, name)
    }

    /// All types that ports carry.
    #[must_use]
    pub fn types(&self) -> &[PortType] {
        &self.types
    }

    /// The type that a port of a registered node carries.
    ///
    /// # Panics
    /// If the port belongs to no registered node.
    #[must_use]
    pub fn type_of(&self, port: &PortSpec) -> &PortType {
        let mut types = self.types.iter();
        types
            .find(|known| known.type_id == port.type_id)
            .unwrap_or_else(|| unreachable!("{} was checked when the registry was made", port.name))
    }

    /// The catalogs of names and their services.
    #[must_use]
    pub fn catalogs(&self) -> &Catalogs {
        &self.catalogs
    }
}

fn check_order(kinds: &[NodeKind]) -> Result<(), RegistryError> {
    for pair in kinds.windows(2) {
        let [first, second] = pair else { continue };
        if first.name == second.name {
            let (kind, origin) = (first.name, |kind: &NodeKind| kind.origin.clone());
            return Err(RegistryError::Twice {
                kind,
                first: origin(first),
                second: origin(second),
            });
        }
        if first.name > second.name {
            return Err(RegistryError::Order(second.name));
        }
    }
    Ok(())
}

fn check_kind(
    kind: &NodeKind,
    types: &[PortType],
    catalogs: &Catalogs,
) -> Result<(), RegistryError> {
    if kind.name == RECIPE_KIND {
        return Err(RegistryError::Reserved);
    }
    let params: Vec<&'static str> = kind.params.iter().map(|spec| spec.name).collect();
    let ports = |ports: &[PortSpec]| ports.iter().map(|port| port.name).collect::<Vec<_>>();
    for names in [params, ports(&kind.inputs), ports(&kind.outputs)] {
        if let Some(name) = repeated(&names) {
            return Err(RegistryError::Field { kind: kind.name, name });
        }
    }
    for spec in &kind.params {
        check_default(spec, catalogs).map_err(|message| {
            let (kind, param) = (kind.name, spec.name);
            RegistryError::Default { kind, param, message }
        })?;
    }
    for port in kind.inputs.iter().chain(&kind.outputs) {
        if !types.iter().any(|known| known.type_id == port.type_id) {
            let (kind, port, rust_type) = (kind.name, port.name, port.rust_type);
            return Err(RegistryError::UnknownType { kind, port, rust_type });
        }
    }
    check_taken(kind, catalogs)
}

fn repeated(names: &[&'static str]) -> Option<&'static str> {
    let is_repeated = |(at, name): &(usize, &&'static str)| names[..*at].contains(name);
    names.iter().enumerate().find(is_repeated).map(|(_, name)| *name)
}

/// A field of a node must mean one thing: no entry that it may choose has a parameter that is called
/// like one of its own, or like one of another catalog's entries that it takes too.
fn check_taken(kind: &NodeKind, catalogs: &Catalogs) -> Result<(), RegistryError> {
    // Each field, and the parameter that brings it if it is not the node's own.
    let own = kind.params.iter().map(|spec| (spec.name, None));
    let mut taken: HashMap<&str, Option<&str>> = own.collect();
    for (chooser, catalog) in kind.choosers() {
        for entry in catalogs.entries(catalog) {
            for param in &entry.params {
                if *taken.entry(param.name).or_insert(Some(chooser)) != Some(chooser) {
                    let message = format!("the node {:?} has a field of that name", kind.name);
                    return Err(entry_fault(catalog, entry, param, message));
                }
            }
        }
    }
    Ok(())
}

fn check_entries(
    catalog: &'static str,
    entries: &[CatalogEntry],
    catalogs: &Catalogs,
) -> Result<(), RegistryError> {
    if let Some(pair) = entries.windows(2).find(|pair| pair[0].name == pair[1].name) {
        return Err(RegistryError::Entry { catalog, entry: pair[0].name.clone() });
    }
    for entry in entries {
        let names: Vec<&'static str> = entry.params.iter().map(|spec| spec.name).collect();
        for param in &entry.params {
            check_default(param, catalogs)
                .map_err(|message| entry_fault(catalog, entry, param, message))?;
            if repeated(&names) == Some(param.name) {
                return Err(entry_fault(catalog, entry, param, "it has it twice".to_owned()));
            }
        }
    }
    Ok(())
}

fn entry_fault(
    catalog: &'static str,
    entry: &CatalogEntry,
    param: &ParamSpec,
    message: String,
) -> RegistryError {
    let (entry, param) = (entry.name.clone(), param.name);
    RegistryError::EntryParam { catalog, entry, param, message }
}

/// Whether a recipe could set a parameter to its default.
fn check_default(spec: &ParamSpec, catalogs: &Catalogs) -> Result<(), String> {
    let Some(default) = &spec.default else { return Ok(()) };
    let locate = |path: &str| Origin::Folder(PathBuf::new()).locate(path);
    let word = default.to_string();
    match spec.read(Given::Word(&word), catalogs, &locate) {
        Ok(read) if read == *default || matches!(read, ParamValue::File(_)) => Ok(()),
        Ok(read) => Err(format!("{word} would be read as {read}")),
        Err(fault) => Err(fault.message),
    }
}
