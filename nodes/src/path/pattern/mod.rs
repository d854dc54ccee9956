//! Patterns: lines over the plane, along which a cutter is dropped. One node, one file; what they
//! share stands here.

mod circles;
mod contour_parallel;
mod cross_raster;
mod hilbert;
mod offset_polygon;
mod polygon;
mod radial;
mod spiral;

pub(crate) use circles::CirclesNode;
pub(crate) use contour_parallel::ContourParallelNode;
pub(crate) use cross_raster::CrossRasterNode;
pub(crate) use hilbert::HilbertNode;
pub(crate) use offset_polygon::OffsetPolygon;
pub(crate) use polygon::{PolygonNode, read_corner, read_corners};
pub(crate) use radial::RadialNode;
pub(crate) use spiral::SpiralNode;

use carvegraph_core::{Choice, Inputs, NodeError, Outputs};
use carvegraph_geometry::{Bounds, Layout, Pace, Pattern, Polygon, Region, Start, Turn};

/// No pattern has more points: from the path of them to its program they take some 7 GB.
pub(crate) const MAX_POINTS: f64 = 5e7;

#[derive(Inputs)]
pub(crate) struct Area<'a> {
    /// The box that holds the part.
    pub(crate) area: &'a Bounds,
    /// What of it is to be cut; all of it if nothing is connected.
    pub(crate) boundary: Option<&'a Polygon>,
}

#[derive(Outputs)]
pub(crate) struct Passes {
    /// The passes as seen from above.
    pub(crate) pattern: Pattern,
}

/// Where the passes begin.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Begin {
    /// In the middle, going outwards.
    Middle,
    /// At the border, going inwards.
    Outside,
}

impl Begin {
    pub(crate) fn start(self) -> Start {
        match self {
            Self::Middle => Start::Middle,
            Self::Outside => Start::Outside,
        }
    }
}

/// Which way round passes go. With a spindle that turns clockwise (M3) it is climb milling where material
/// still stands on the right of the feed: counter-clockwise from the middle, clockwise from outside.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Direction {
    /// Against the clock, seen from above.
    CounterClockwise,
    /// With the clock.
    Clockwise,
}

impl Direction {
    pub(crate) fn turn(self) -> Turn {
        match self {
            Self::CounterClockwise => Turn::CounterClockwise,
            Self::Clockwise => Turn::Clockwise,
        }
    }
}

/// Lays passes over an area, unless they would have too many points.
pub(crate) fn laid(layout: &dyn Layout, pace: Pace, area: &Area<'_>) -> Result<Passes, NodeError> {
    let region = region(area)?;
    let count = layout.count(&region);
    if count <= MAX_POINTS {
        return Ok(Passes { pattern: layout.pattern(&region) });
    }
    let Pace { stepover_mm, feed_step_mm } = pace;
    let param = if stepover_mm <= feed_step_mm { "stepover" } else { "feed_step" };
    Err(NodeError::refused(
        param,
        format!(
            "stepover {stepover_mm} mm and feed_step {feed_step_mm} mm would make {count:.3e} \
             points; the limit is {MAX_POINTS:.0e}"
        ),
    ))
}

fn region(area: &Area<'_>) -> Result<Region, NodeError> {
    let region = Region::new(area.area)
        .ok_or_else(|| NodeError::failed("the area is no box of finite size"))?;
    let Some(boundary) = area.boundary else { return Ok(region) };
    region.within(boundary.clone()).ok_or_else(|| {
        NodeError::failed("the boundary lies beside the area: nothing is left to cut")
    })
}

/// What the nodes' tests share.
#[cfg(test)]
pub(crate) mod testing {
    use super::*;
    use carvegraph_geometry::{DVec2, DVec3};

    /// Runs a node's work on an area from 0, 0.
    pub(crate) fn over(
        (width, height): (f64, f64),
        run: impl FnOnce(Area<'_>) -> Result<Passes, NodeError>,
    ) -> Result<Pattern, NodeError> {
        let area = Bounds { min: DVec3::ZERO, max: DVec3::new(width, height, 5.0) };
        run(Area { area: &area, boundary: None }).map(|passes| passes.pattern)
    }

    /// The same, inside of a triangle whose corners are three of the area's.
    pub(crate) fn over_half(
        (width, height): (f64, f64),
        run: impl FnOnce(Area<'_>) -> Result<Passes, NodeError>,
    ) -> Pattern {
        let area = Bounds { min: DVec3::ZERO, max: DVec3::new(width, height, 5.0) };
        let corners = vec![DVec2::ZERO, DVec2::new(width, 0.0), DVec2::new(0.0, height)];
        let boundary = Polygon::new(vec![corners]).unwrap();
        let passes = run(Area { area: &area, boundary: Some(&boundary) }).unwrap();
        let inside = |p: &DVec2| p.x / width + p.y / height < 1.0 + 1e-9;
        assert!(passes.pattern.points.iter().all(inside));
        passes.pattern
    }

    /// A refusal's words.
    #[track_caller]
    pub(crate) fn refusal(made: Result<Pattern, NodeError>) -> (&'static str, String) {
        let Err(NodeError::Refused { param, message }) = made else { panic!("it must be refused") };
        (param, message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_geometry::{DVec2, DVec3};

    #[test]
    fn a_boundary_beside_the_area_is_told() {
        let area = Bounds { min: DVec3::ZERO, max: DVec3::splat(5.0) };
        let far = [(9.0, 9.0), (12.0, 9.0), (9.0, 12.0)].map(|(x, y)| DVec2::new(x, y));
        let boundary = Polygon::new(vec![far.to_vec()]).unwrap();
        let error = region(&Area { area: &area, boundary: Some(&boundary) }).unwrap_err();
        assert!(error.to_string().contains("the boundary lies beside the area"), "{error}");
    }
}
