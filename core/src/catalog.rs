//! Names that parameters choose from and that are not known when a node is written: cutter shapes,
//! dialects, whatever plugins bring.

use crate::param::ParamSpec;
use std::any::{Any, TypeId};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// One thing of a catalog, as far as the engine knows it.
#[derive(Clone, Debug)]
pub struct CatalogEntry {
    /// What recipes call it.
    pub name: String,
    /// The version of what it stands for: another one makes cached values stale.
    pub version: String,
    /// The parameters that a node has in addition when it chooses this one (and takes them: see
    /// [`Params`](crate::Params)).
    pub params: Vec<ParamSpec>,
}

impl CatalogEntry {
    /// An entry without parameters.
    #[must_use]
    pub fn new(name: impl Into<String>, version: impl Into<String>) -> Self {
        Self { name: name.into(), version: version.into(), params: Vec::new() }
    }

    /// Its parameter called `name`.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<&ParamSpec> {
        self.params.iter().find(|param| param.name == name)
    }
}

/// A name that is known to stand for something that is not to be had, such as a part of a plugin
/// that could not be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// The name.
    pub name: String,
    /// Why it cannot be had: the end of a message that begins with what a recipe asks for.
    pub why: String,
    /// What to do.
    pub help: String,
}

impl Missing {
    /// The one called `name`.
    pub(crate) fn find<'m>(all: &'m [Self], name: &str) -> Option<&'m Self> {
        all.iter().find(|missing| missing.name == name)
    }
}

/// Named things by kind ("dialect", "cutter"), and the services behind them.
///
/// A node asks its context for a service by type; the engine itself only knows the names, so that
/// it can check a recipe, their versions, so that it knows when a cached value is stale, and their
/// parameters.
#[derive(Clone, Default)]
pub struct Catalogs {
    /// Sorted by name.
    entries: BTreeMap<&'static str, Vec<CatalogEntry>>,
    missing: BTreeMap<&'static str, Vec<Missing>>,
    services: HashMap<TypeId, Arc<dyn Any + Send + Sync>>,
}

impl Catalogs {
    /// Adds a catalog: its name, its entries, and the service that gives the things themselves. Two
    /// entries of one name are refused when a [registry](crate::Registry) is made.
    #[must_use]
    pub fn with<T: Any + Send + Sync>(
        mut self,
        catalog: &'static str,
        entries: impl IntoIterator<Item = CatalogEntry>,
        service: T,
    ) -> Self {
        let mut entries: Vec<CatalogEntry> = entries.into_iter().collect();
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        self.entries.insert(catalog, entries);
        self.services.insert(TypeId::of::<T>(), Arc::new(service));
        self
    }

    /// Adds names that the catalog would have if something could be had that cannot. One that the
    /// catalog has after all is not missing.
    #[must_use]
    pub fn with_missing(
        mut self,
        catalog: &'static str,
        names: impl IntoIterator<Item = Missing>,
    ) -> Self {
        self.missing.entry(catalog).or_default().extend(names);
        self
    }

    /// The entries of a catalog, sorted by name.
    #[must_use]
    pub fn entries(&self, catalog: &str) -> &[CatalogEntry] {
        self.entries.get(catalog).map_or(&[], Vec::as_slice)
    }

    /// The entry of a catalog called `name`.
    #[must_use]
    pub fn entry(&self, catalog: &str, name: &str) -> Option<&CatalogEntry> {
        let entries = self.entries(catalog);
        let at = entries.binary_search_by(|entry| entry.name.as_str().cmp(name)).ok()?;
        Some(&entries[at])
    }

    /// The names in a catalog, sorted.
    pub fn names(&self, catalog: &str) -> impl Iterator<Item = &str> {
        self.entries(catalog).iter().map(|entry| entry.name.as_str())
    }

    /// Why a catalog lacks a name that is known.
    #[must_use]
    pub fn missing(&self, catalog: &str, name: &str) -> Option<&Missing> {
        Missing::find(self.missing.get(catalog)?, name)
    }

    /// The service of type `T`, if one was added.
    #[must_use]
    pub fn service<T: Any + Send + Sync>(&self) -> Option<&T> {
        self.services.get(&TypeId::of::<T>())?.downcast_ref()
    }

    /// All catalogs and their entries.
    pub(crate) fn all(&self) -> impl Iterator<Item = (&'static str, &[CatalogEntry])> {
        self.entries.iter().map(|(catalog, entries)| (*catalog, entries.as_slice()))
    }
}
