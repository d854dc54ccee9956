//! Cutting a part out of a surface of heights, along its nodes; see [`Crop`](carvegraph_geometry::Crop).
//!
//! The part has the nodes that lie in the box, so it may be up to a pitch smaller on each side. A height
//! field begins at 0, 0: so does the part, and a note tells where that was.

use super::cropping::{Sides, check, crop};
use carvegraph_core::{Conflict, Context, Inputs, Node, NodeError, Outputs, Params, Yielding};
use carvegraph_geometry::{Bounds, HeightField, HeightFieldError, Polygon};

/// Keeps what of a surface lies within a rectangle and, if one is connected, within an outline.
#[derive(Clone, Debug, Params)]
pub(crate) struct CropField {
    /// What lies left of that is cut away. Left alone, nothing is.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1e6)]
    pub(crate) x_min: Yielding<f64>,
    /// What lies right of that is cut away, if it is set.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1e6)]
    pub(crate) x_max: Yielding<f64>,
    /// What lies nearer than that is cut away, if it is set.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1e6)]
    pub(crate) y_min: Yielding<f64>,
    /// What lies farther than that is cut away, if it is set.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1e6)]
    pub(crate) y_max: Yielding<f64>,
    /// Height beside the outline. Left alone, it is that of the lowest node inside.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) floor: Yielding<f64>,
}

#[derive(Inputs)]
pub(crate) struct Before<'a> {
    /// The surface.
    surface: &'a HeightField,
    /// What of it is kept; what lies beside it, in its rectangle, is lowered to the floor.
    polygon: Option<&'a Polygon>,
}

#[derive(Outputs)]
pub(crate) struct After {
    /// What is left of the surface; its near left corner is the origin.
    surface: HeightField,
    /// The box that holds it.
    bounds: Bounds,
}

impl Node for CropField {
    const KIND: &'static str = "crop_field";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn check(&self) -> Result<(), Conflict> {
        check(&self.sides())
    }

    fn run(&self, inputs: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let whole = inputs.surface;
        let floor = self.floor.is_set().then(|| self.floor.or(None) as f32);
        let cut = crop(&self.sides(), inputs.polygon)?.field(whole, floor);
        let (surface, [column, row]) = cut.map_err(|fault| match fault {
            HeightFieldError::TooSmall { columns, rows } => NodeError::failed(format!(
                "{columns} × {rows} nodes are left of the surface of {} × {}, {} mm apart; it needs 2 × 2",
                whole.columns(),
                whole.rows(),
                whole.pitch_mm()
            )),
            fault => NodeError::failed(fault),
        })?;
        if (column, row) != (0, 0) {
            let place = [column, row].map(|k| k as f64 * whole.pitch_mm());
            let [x, y] = place;
            cx.note(format!("the surface begins at 0, 0; in the whole that was {x:.4}, {y:.4} mm"));
        }
        let bounds = surface.bounds();
        Ok(After { surface, bounds })
    }
}

impl CropField {
    fn sides(&self) -> [Sides; 2] {
        [
            Sides::new("x_max", &self.x_min, &self.x_max),
            Sides::new("y_max", &self.y_min, &self.y_max),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec2;

    fn neutral() -> CropField {
        const OPEN: Yielding<f64> = Yielding::left(0.0);
        CropField { x_min: OPEN, x_max: OPEN, y_min: OPEN, y_max: OPEN, floor: OPEN }
    }

    /// Of a surface of 10 × 8 nodes, a millimetre apart, whose heights are 10 · row + column.
    fn cropped(node: &CropField, polygon: Option<&Polygon>) -> Result<HeightField, String> {
        let heights = (0..80).map(|k| k as f32).collect();
        let surface = HeightField::new(10, 8, 1.0, heights).unwrap();
        let after = run(|cx| node.run(Before { surface: &surface, polygon }, cx));
        after.map(|after| after.surface).map_err(|fault| fault.to_string())
    }

    #[test]
    fn the_nodes_in_the_rectangle_are_kept() {
        assert_eq!(cropped(&neutral(), None).unwrap().rows(), 8);
        let node = CropField {
            x_min: Yielding::given(1.5),
            x_max: Yielding::given(4.0),
            y_min: Yielding::given(6.0),
            ..neutral()
        };
        let field = cropped(&node, None).unwrap();
        assert_eq!((field.columns(), field.rows(), field.row(0)), (3, 2, &[62.0, 63.0, 64.0][..]));
    }

    #[test]
    fn beside_an_outline_there_is_the_floor() {
        let corners = [(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)].map(|(x, y)| DVec2::new(x, y));
        let outline = Polygon::new(vec![corners.to_vec()]).unwrap();
        let node = CropField { floor: Yielding::given(-2.0), ..neutral() };
        let field = cropped(&node, Some(&outline)).unwrap();
        assert_eq!((field.columns(), field.height(4, 4), field.height(1, 1)), (5, -2.0, 11.0));
        assert_eq!(cropped(&neutral(), Some(&outline)).unwrap().height(4, 4), 0.0);
    }

    #[test]
    fn a_rectangle_between_the_nodes_is_told() {
        let node =
            CropField { x_min: Yielding::given(3.2), x_max: Yielding::given(4.7), ..neutral() };
        let told = "1 × 8 nodes are left of the surface of 10 × 8, 1 mm apart; it needs 2 × 2";
        assert_eq!(cropped(&node, None).unwrap_err(), told);
        let bad = CropField { x_max: Yielding::given(3.0), ..node };
        assert_eq!(bad.check().unwrap_err().param, "x_max");
    }
}
