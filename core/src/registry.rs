//! The kinds of node and the types of value that an engine knows.

use crate::catalog::Catalogs;
use crate::files::Origin;
use crate::node::NodeKind;
use crate::param::{Given, ParamSpec, ParamValue};
use crate::port::{PortSpec, PortType};
use crate::recipe::RECIPE_KIND;
use std::path::PathBuf;
use std::sync::Arc;

/// Everything a recipe may refer to: kinds of node, types of value, catalogs of names.
#[derive(Clone)]
pub struct Registry {
    kinds: Arc<[NodeKind]>,
    types: Arc<[PortType]>,
    catalogs: Catalogs,
}

/// Why a list of kinds and types is no registry: a fault in the program, not in a recipe.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum RegistryError {
    /// The list is to be sorted, each name once.
    #[error("{0:?} stands out of order or twice in the list of nodes")]
    Order(&'static str),
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

impl Registry {
    /// Makes a registry of nodes sorted by name and of the types their ports carry.
    ///
    /// # Errors
    /// If the names are not in order, a port's type is missing, or a default is out of its range.
    pub fn new(
        kinds: Vec<NodeKind>,
        types: Vec<PortType>,
        catalogs: Catalogs,
    ) -> Result<Self, RegistryError> {
        if let Some(pair) = kinds.windows(2).find(|pair| pair[0].name >= pair[1].name) {
            return Err(RegistryError::Order(pair[1].name));
        }
        for kind in &kinds {
            if kind.name == RECIPE_KIND {
                return Err(RegistryError::Reserved);
            }
            for spec in &kind.params {
                check_default(spec, &catalogs).map_err(|message| {
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
        }
        Ok(Self { kinds: kinds.into(), types: types.into(), catalogs })
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
