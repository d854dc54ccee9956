//! Typed ports and the values that pass through them.

use crate::CacheError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::{Any, TypeId};
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;

/// A value on its way from one node to the next.
pub type Value = Arc<dyn Any + Send + Sync>;

/// What the report says of a value: names and JSON values, in the order of the names.
pub type Facts = BTreeMap<&'static str, serde_json::Value>;

/// One port of a node.
#[derive(Clone, Copy, Debug)]
pub struct PortSpec {
    /// Its name in recipes.
    pub name: &'static str,
    /// What passes through it, for a user.
    pub about: &'static str,
    /// The Rust type of its values.
    pub type_id: TypeId,
    /// That type's name, for messages to developers.
    pub rust_type: &'static str,
    /// Whether an input may be left open.
    pub optional: bool,
}

impl PortSpec {
    /// A port for values of type `T`.
    #[must_use]
    pub fn of<T: Any>(name: &'static str, about: &'static str, optional: bool) -> Self {
        let (type_id, rust_type) = (TypeId::of::<T>(), std::any::type_name::<T>());
        Self { name, about, type_id, rust_type, optional }
    }
}

/// The values at a node's input ports, by name.
#[derive(Default)]
pub struct InputValues(BTreeMap<&'static str, Value>);

impl InputValues {
    /// Connects a port.
    pub fn insert(&mut self, port: &'static str, value: Value) {
        self.0.insert(port, value);
    }

    /// The value at a port that must be connected.
    ///
    /// # Panics
    /// If it is not, or holds another type; checking a recipe rules out both.
    #[must_use]
    pub fn required<T: Any>(&self, port: &str) -> &T {
        self.optional(port).unwrap_or_else(|| unreachable!("{port} was checked to be connected"))
    }

    /// The value at a port, if it is connected.
    #[must_use]
    pub fn optional<T: Any>(&self, port: &str) -> Option<&T> {
        self.0.get(port)?.downcast_ref()
    }
}

/// A struct that holds the inputs of a node; derive it.
pub trait Inputs<'a>: Sized {
    /// The input ports, in the order of the fields.
    fn ports() -> Vec<PortSpec>;
    /// The struct made of checked values.
    fn take(values: &'a InputValues) -> Self;
}

/// For nodes that begin a graph.
impl Inputs<'_> for () {
    fn ports() -> Vec<PortSpec> {
        Vec::new()
    }

    fn take(_: &InputValues) {}
}

/// A struct that holds the outputs of a node; derive it.
pub trait Outputs: Sized {
    /// The output ports, in the order of the fields.
    fn ports() -> Vec<PortSpec>;
    /// The values, in the same order.
    fn into_values(self) -> Vec<Value>;
}

/// For nodes that only write files.
impl Outputs for () {
    fn ports() -> Vec<PortSpec> {
        Vec::new()
    }

    fn into_values(self) -> Vec<Value> {
        Vec::new()
    }
}

type FactsOf = dyn Fn(&Value) -> Facts + Send + Sync;
type BytesOf = dyn Fn(&Value) -> usize + Send + Sync;
type Encode = dyn Fn(&Value, &mut dyn Write) -> Result<(), CacheError> + Send + Sync;
type Decode = dyn Fn(&[u8]) -> Result<Value, CacheError> + Send + Sync;

/// A type of value that ports may carry: its name, what the report says of one, its size and how
/// the cache keeps it.
#[derive(Clone)]
pub struct PortType {
    /// Its name for users and reports.
    pub name: &'static str,
    /// What it is, for a user.
    pub about: &'static str,
    pub(crate) type_id: TypeId,
    facts: Arc<FactsOf>,
    bytes: Arc<BytesOf>,
    encode: Arc<Encode>,
    decode: Arc<Decode>,
}

impl PortType {
    /// Describes `T`: `facts` go to the report, `bytes` is about what one takes in memory.
    #[must_use]
    pub fn of<T: Any + Send + Sync + Serialize + DeserializeOwned>(
        name: &'static str,
        about: &'static str,
        facts: fn(&T) -> Facts,
        bytes: fn(&T) -> usize,
    ) -> Self {
        let of = move |value: &Value| value.downcast_ref::<T>().map(facts).unwrap_or_default();
        let size = move |value: &Value| value.downcast_ref::<T>().map_or(0, bytes);
        let encode = |value: &Value, to: &mut dyn Write| match value.downcast_ref::<T>() {
            Some(value) => postcard::to_io(value, to).map(drop).map_err(CacheError::Encode),
            None => Err(CacheError::WrongType(std::any::type_name::<T>())),
        };
        let decode = |bytes: &[u8]| match postcard::from_bytes::<T>(bytes) {
            Ok(value) => Ok(Arc::new(value) as Value),
            Err(fault) => Err(CacheError::Encode(fault)),
        };
        Self {
            name,
            about,
            type_id: TypeId::of::<T>(),
            facts: Arc::new(of),
            bytes: Arc::new(size),
            encode: Arc::new(encode),
            decode: Arc::new(decode),
        }
    }

    pub(crate) fn facts(&self, value: &Value) -> Facts {
        (self.facts)(value)
    }

    pub(crate) fn bytes(&self, value: &Value) -> usize {
        (self.bytes)(value)
    }

    pub(crate) fn encode(&self, value: &Value, to: &mut dyn Write) -> Result<(), CacheError> {
        (self.encode)(value, to)
    }

    pub(crate) fn decode(&self, bytes: &[u8]) -> Result<Value, CacheError> {
        (self.decode)(bytes)
    }
}
