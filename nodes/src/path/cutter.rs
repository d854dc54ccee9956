//! A cutter chosen by shape and size.

use crate::registry::Cutters;
use carvegraph_core::{Context, Node, NodeError, Outputs, Params};
use carvegraph_geometry::Cutter;
use carvegraph_sdk::Dimensions;

/// Chooses the cutter. `carve cutters` lists the shapes.
#[derive(Clone, Debug, Params)]
pub(crate) struct CutterNode {
    /// The cutter's shape.
    #[param(catalog = "cutter", default = "ball")]
    pub(crate) shape: String,
    /// The cutter's diameter.
    #[param(unit = "mm", default = 6.0, range = 0.01..=200.0)]
    pub(crate) diameter: f64,
}

#[derive(Outputs)]
pub(crate) struct Chosen {
    /// The cutter.
    cutter: Cutter,
}

impl Node for CutterNode {
    const KIND: &'static str = "cutter";
    type Inputs<'a> = ();
    type Outputs = Chosen;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<Chosen, NodeError> {
        let cutters: &Cutters = cx.service()?;
        let shape = cutters.find(&self.shape).ok_or_else(|| {
            NodeError::failed(format!("there is no cutter shape {:?}", self.shape))
        })?;
        let given = [("diameter", self.diameter)];
        let dimensions = Dimensions::new(shape.dimensions(), &given).map_err(NodeError::failed)?;
        let profile = shape.profile(&dimensions).map_err(NodeError::failed)?;
        Ok(Chosen { cutter: Cutter { name: self.shape.clone(), profile } })
    }
}
