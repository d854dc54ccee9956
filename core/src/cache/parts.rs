//! What the values of a node depend on.

use super::{Key, Parts};
use crate::cancel::CancelToken;
use crate::files::{FileError, FileHashes};
use crate::graph::{Graph, GraphNode};
use crate::param::{ParamKind, ParamValue};

/// All that is known of what the nodes of a graph depend on.
pub(crate) struct Dependencies {
    /// By node number.
    pub(crate) nodes: Vec<(Key, Parts)>,
    /// What each file contained.
    pub(crate) files: FileHashes,
}

impl Dependencies {
    /// Looks at all files; one that several nodes read is hashed once.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub(crate) fn of(graph: &Graph, cancel: &CancelToken) -> Result<Self, FileError> {
        let mut files = FileHashes::new();
        for file in graph.nodes.iter().flat_map(GraphNode::files) {
            if !files.contains_key(file) {
                files.insert(file.clone(), graph.files.hash(file, cancel)?);
            }
        }
        let mut nodes = vec![(Key::of(&Parts::new()), Parts::new()); graph.nodes.len()];
        // In this order the keys of a node's sources are there before its own.
        for at in graph.in_order() {
            let mut parts = own_parts(graph, &graph.nodes[at], &files);
            let node = &graph.nodes[at];
            for (spec, wire) in graph.kind(node).inputs.iter().zip(&node.inputs) {
                let state = match wire {
                    Some(wire) => format!("{} output {}", nodes[wire.node].0.as_str(), wire.port),
                    None => "open".to_owned(),
                };
                parts.insert(input_part(spec.name), state);
            }
            nodes[at] = (Key::of(&parts), parts);
        }
        Ok(Self { nodes, files })
    }
}

/// The part that an input port contributes.
pub(crate) fn input_part(port: &str) -> String {
    format!("input {port}")
}

/// What a node depends on besides its inputs.
fn own_parts(graph: &Graph, node: &GraphNode, files: &FileHashes) -> Parts {
    let kind = graph.kind(node);
    let mut parts = Parts::new();
    parts.insert("node kind".into(), format!("{} version {}", kind.name, kind.version));
    if let Some(origin) = &kind.origin {
        parts.insert("origin of the node kind".into(), origin.clone());
    }
    parts.insert("program".into(), env!("CARGO_PKG_VERSION").into());
    if graph.uses_prefix(node) {
        parts.insert("name of the output".into(), node.prefix.clone());
    }
    for (name, value) in node.values.iter() {
        match value {
            ParamValue::File(file) => {
                let hash = files.get(file).map(ToString::to_string).unwrap_or_default();
                parts.insert(format!("contents of {name}"), hash);
            }
            value => {
                parts.insert(format!("parameter {name}"), value.to_string());
            }
        }
        let Some(spec) = graph.param(node, name) else { continue };
        if spec.yields {
            parts.insert(format!("whether {name} is set"), node.values.is_set(name).to_string());
        }
        if let ParamKind::Catalog { catalog, .. } = spec.kind {
            let entry = graph.catalogs().entry(catalog, value.text());
            let version = entry.map(|entry| entry.version.clone()).unwrap_or_default();
            parts.insert(format!("version of {catalog} {}", value.text()), version);
        }
    }
    parts
}
