//! An outline, written down corner by corner.
//!
//! Coordinates are the part's own, in mm. Inside is what an odd number of loops surround, so that a
//! loop within a loop is a hole.

use carvegraph_core::{Conflict, Context, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{DVec2, Polygon};

/// Bounds what is to be cut by the corners of one loop or more; a loop within another is a hole.
#[derive(Clone, Debug, Params)]
pub(crate) struct PolygonNode {
    /// Corners as x,y in mm with blanks between them; loops with a semicolon between them.
    #[param(default = "0,0 50,0 50,50 0,50")]
    pub(crate) corners: String,
}

#[derive(Outputs)]
pub(crate) struct Outline {
    /// The outline.
    polygon: Polygon,
}

impl Node for PolygonNode {
    const KIND: &'static str = "polygon";
    type Inputs<'a> = ();
    type Outputs = Outline;

    fn check(&self) -> Result<(), Conflict> {
        read_corners(&self.corners)
            .map(|_| ())
            .map_err(|message| Conflict { param: "corners", message })
    }

    fn run(&self, (): (), _: &Context<'_>) -> Result<Outline, NodeError> {
        Ok(Outline { polygon: read_corners(&self.corners).map_err(NodeError::failed)? })
    }
}

/// The loops written in `text`: corners as x,y with blanks between them, loops with semicolons.
pub(crate) fn read_corners(text: &str) -> Result<Polygon, String> {
    let corners =
        |text: &str| text.split_whitespace().map(read_corner).collect::<Result<Vec<_>, _>>();
    let loops = text.split(';').map(corners).collect::<Result<_, _>>()?;
    Polygon::new(loops).map_err(|fault| fault.to_string())
}

/// Two numbers with a comma between them.
pub(crate) fn read_corner(text: &str) -> Result<DVec2, String> {
    let number = |text: &str| text.parse().ok().filter(|value: &f64| value.is_finite());
    let place = text.split_once(',').and_then(|(x, y)| Some(DVec2::new(number(x)?, number(y)?)));
    place.ok_or_else(|| format!("{text:?} is no corner: write it as 12.5,30"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    #[test]
    fn loops_are_read_in_order() {
        let corners = "0,0 9,0 9,9; 1.5,2 3,2\n 2,3e0".to_owned();
        let node = PolygonNode { corners };
        node.check().unwrap();
        let polygon = run(|cx| node.run((), cx)).unwrap().polygon;
        assert_eq!(polygon.loops()[0].len(), 3);
        let hole = [DVec2::new(1.5, 2.0), DVec2::new(3.0, 2.0), DVec2::new(2.0, 3.0)];
        assert_eq!(polygon.loops()[1], hole);
    }

    #[test]
    fn what_is_no_outline_is_told() {
        let fault = |corners: &str| {
            let node = PolygonNode { corners: corners.to_owned() };
            node.check().unwrap_err().message
        };
        assert_eq!(fault("0,0 1;1 2,2"), "\"1\" is no corner: write it as 12.5,30");
        assert_eq!(fault("0,0 inf,1 2,2"), "\"inf,1\" is no corner: write it as 12.5,30");
        assert_eq!(fault("0,0 1,1"), "loop 1 has 2 corners; the least is 3");
        assert_eq!(fault(""), "loop 1 has 0 corners; the least is 3");
    }
}
