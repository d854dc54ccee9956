//! Names that parameters choose from and that are not known when a node is written: cutter shapes,
//! dialects, whatever plugins bring.

use std::any::{Any, TypeId};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Named things by kind ("dialect", "cutter"), and the services behind them.
///
/// A node asks its context for a service by type; the engine itself only knows the names, so that
/// it can check a recipe, and their versions, so that it knows when a cached value is stale.
#[derive(Clone, Default)]
pub struct Catalogs {
    names: BTreeMap<&'static str, BTreeMap<String, String>>,
    services: HashMap<TypeId, Arc<dyn Any + Send + Sync>>,
}

impl Catalogs {
    /// Adds a catalog: its name, the names in it each with the version of what they stand for, and
    /// the service that gives the things themselves.
    #[must_use]
    pub fn with<T: Any + Send + Sync>(
        mut self,
        catalog: &'static str,
        names: impl IntoIterator<Item = (String, String)>,
        service: T,
    ) -> Self {
        self.names.insert(catalog, names.into_iter().collect());
        self.services.insert(TypeId::of::<T>(), Arc::new(service));
        self
    }

    /// The names in a catalog, sorted.
    pub fn names(&self, catalog: &str) -> impl Iterator<Item = &str> {
        self.names.get(catalog).into_iter().flatten().map(|(name, _)| name.as_str())
    }

    /// The version of what a name stands for.
    #[must_use]
    pub fn version(&self, catalog: &str, name: &str) -> Option<&str> {
        self.names.get(catalog)?.get(name).map(String::as_str)
    }

    /// The service of type `T`, if one was added.
    #[must_use]
    pub fn service<T: Any + Send + Sync>(&self) -> Option<&T> {
        self.services.get(&TypeId::of::<T>())?.downcast_ref()
    }
}
