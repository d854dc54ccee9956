//! A deep surface made a shallow one that keeps its detail; see [`bas_relief`] for the method.
//!
//! Made for the top of a mesh and for depth maps at their true depth: `limit` counts in slopes as
//! they are.

use super::{After, Before, size};
use carvegraph_core::{Context, Node, NodeError, Params, Yielding};
use carvegraph_geometry::{BasRelief, bas_relief};

/// No surface has more nodes: the solver takes 80 bytes for each, 2.4 GB in all.
const MAX_NODES: usize = 30_000_000;

/// Steps of the work that most surfaces need.
const USUAL_STEPS: usize = 13;

/// Compression that stands for 100 %, where the logarithm would have nothing left to compress.
const FULL: f64 = 0.999;

/// Flattens a deep model into a plaque so that detail outlives depth.
#[derive(Clone, Debug, Params)]
pub(crate) struct BasReliefNode {
    /// From the plate to the highest place.
    #[param(unit = "mm", default = 5.0, range = 0.001..=1000.0)]
    pub(crate) depth: f64,
    /// How much steep slopes are brought down to the gentle ones; 0 only scales.
    #[param(unit = "%", default = 70.0, range = 0.0..=100.0)]
    pub(crate) compression: f64,
    /// How much fine detail is brought out; 0 leaves it in proportion.
    #[param(unit = "%", default = 200.0, range = 0.0..=1000.0)]
    pub(crate) detail: f64,
    /// What is smaller counts as detail.
    #[param(unit = "mm", default = 3.0, range = 0.001..=1000.0)]
    pub(crate) detail_size: f64,
    /// Slopes steeper than that are one thing before another: the step between them goes. 90 keeps
    /// all.
    #[param(unit = "deg", default = 80.0, range = 1.0..=90.0)]
    pub(crate) limit: f64,
    /// Whether what lies lowest is a plate, which stays flat, at 0.
    #[param(default = true)]
    pub(crate) plate: bool,
    /// What lies at that height or below belongs to the plate. Left alone, only what is as low as the
    /// lowest node does.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) plate_z: Yielding<f64>,
}

impl Node for BasReliefNode {
    const KIND: &'static str = "bas_relief";
    // 2: nothing lies below the plate.
    const VERSION: u32 = 2;
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, Before { surface }: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let count = surface.heights().len();
        if count > MAX_NODES {
            return Err(NodeError::failed(format!(
                "a surface of {} × {} nodes is too large for this step; it takes {MAX_NODES}: make it \
                 with a wider pitch or of a smaller picture",
                surface.columns(),
                surface.rows()
            )));
        }
        let bounds = surface.bounds();
        if bounds.min.z == bounds.max.z {
            cx.warn("the surface is flat, and so is the relief");
        }
        let plate_mm = self.plate_z.or(Some(bounds.min.z)) as f32;
        if self.plate && f64::from(plate_mm) >= bounds.max.z && bounds.min.z < bounds.max.z {
            let message = format!(
                "{plate_mm} mm is as high as the surface, {:.3} mm: all of it would be plate",
                bounds.max.z
            );
            return Err(NodeError::refused("plate_z", message));
        }
        let wanted = BasRelief {
            depth_mm: self.depth,
            compression: (self.compression / 100.0).min(FULL),
            detail: self.detail / 100.0,
            detail_size_mm: self.detail_size,
            steepest: if self.limit < 90.0 { self.limit.to_radians().tan() } else { f64::INFINITY },
            background_mm: self.plate.then_some(plate_mm),
        };
        let ticker = cx.ticker(USUAL_STEPS);
        let heights = bas_relief(surface, &wanted, &|steps| ticker.tick(steps));
        After::of(cx.completed(heights)?, size(surface), surface)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::shaped;
    use super::*;
    use carvegraph_geometry::HeightField;

    const PLAIN: BasReliefNode = BasReliefNode {
        depth: 3.0,
        compression: 70.0,
        detail: 0.0,
        detail_size: 1.0,
        limit: 80.0,
        plate: true,
        plate_z: Yielding::left(0.0),
    };

    /// Two steps on a plate, a cone on the upper one.
    fn stepped() -> HeightField {
        let height = |at: usize| {
            let away = ((at % 31) as f32 - 15.0).hypot((at / 31) as f32 - 15.0);
            if away > 13.0 { -2.0 } else { 40.0 - away }
        };
        HeightField::new(31, 31, 1.0, (0..31 * 31).map(height).collect()).unwrap()
    }

    #[test]
    fn the_plate_is_at_0_and_the_top_at_the_depth() {
        let found = shaped(&PLAIN, &stepped()).unwrap();
        assert_eq!((found.bounds().min.z, found.bounds().max.z), (0.0, 3.0));
        assert_eq!((found.height(0, 0), found.height(30, 15)), (0.0, 0.0));
    }

    #[test]
    fn without_a_plate_the_lowest_node_is_at_0() {
        for compression in [0.0, 70.0, 100.0] {
            let node = BasReliefNode { plate: false, compression, limit: 90.0, ..PLAIN };
            let found = shaped(&node, &stepped()).unwrap();
            assert_eq!((found.bounds().min.z, found.bounds().max.z), (0.0, 3.0));
        }
    }

    #[test]
    fn a_plate_above_everything_is_refused() {
        let node = BasReliefNode { plate_z: Yielding::given(41.0), ..PLAIN };
        let told = shaped(&node, &stepped()).unwrap_err();
        assert_eq!(told, "41 mm is as high as the surface, 40.000 mm: all of it would be plate");
    }
}
