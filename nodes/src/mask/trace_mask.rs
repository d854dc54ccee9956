//! A mask becomes an outline, laid over a part.
//!
//! The middles of the mask's outermost pixels come to lie on the border of the area, its top row on the
//! far side, as `z_map` lays a picture: a mask of the size of the picture fits it to the bit, one of another
//! size to half of its pixel. Inside is what the mask selects by half or more; outlines run between pixels,
//! where the share is a half ([`trace_level`]). What is open at the mask's border is closed along it.

use super::SELECTED;
use crate::values::Mask;
use carvegraph_core::{Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{
    Bounds, DVec2, Polygon, PolygonError, TraceError, simplify_loop, trace_level,
};
use rayon::prelude::*;

/// A mask may be this much wider or narrower than the area, as a share, before that is told: half a
/// pixel on either side of 50.
const MOST_STRETCH: f64 = 0.02;

/// Traces a mask as an outline over a part, to keep passes within it.
#[derive(Clone, Debug, Params)]
pub(crate) struct TraceMask {
    /// Whether what the mask leaves out is inside instead.
    #[param(default = false)]
    pub(crate) invert: bool,
    /// How far the outline may run beside its exact place, to have fewer corners.
    #[param(unit = "px", default = 0.05, range = 0.0..=100.0)]
    pub(crate) tolerance: f64,
}

#[derive(Inputs)]
pub(crate) struct Laid<'a> {
    /// The mask.
    mask: &'a Mask,
    /// The box of the part that the mask is laid over.
    area: &'a Bounds,
}

#[derive(Outputs)]
pub(crate) struct Traced {
    /// The outline of what is selected.
    polygon: Polygon,
}

impl Node for TraceMask {
    const KIND: &'static str = "trace_mask";
    const VERSION: u32 = 2;
    type Inputs<'a> = Laid<'a>;
    type Outputs = Traced;

    fn run(&self, Laid { mask, area }: Laid<'_>, cx: &Context<'_>) -> Result<Traced, NodeError> {
        let (columns, rows) = (mask.width, mask.height);
        if columns < 2 || rows < 2 {
            return Err(NodeError::failed(format!(
                "a mask of {columns} × {rows} px has no inside: it needs 2 × 2 px at least"
            )));
        }
        let pixels = DVec2::new(columns as f64 - 1.0, rows as f64 - 1.0);
        let pitch_mm = area.size().truncate() / pixels;
        let stretch = pitch_mm.x / pitch_mm.y;
        if (stretch - 1.0).abs() > MOST_STRETCH {
            cx.warn(format!(
                "the mask of {columns} × {rows} px is laid over {:.3} × {:.3} mm: its pixels are {:.4} mm \
                 wide and {:.4} mm high",
                area.size().x, area.size().y, pitch_mm.x, pitch_mm.y
            ));
        }
        let loops = self.loops(mask, cx)?;
        let place =
            |p: &DVec2| DVec2::new(area.min.x + p.x * pitch_mm.x, area.max.y - p.y * pitch_mm.y);
        let loops = loops.iter().map(|corners| corners.iter().map(place).collect()).collect();
        Ok(Traced { polygon: self.outline(loops)? })
    }
}

impl TraceMask {
    /// Loops in pixels, as far as they have an inside.
    fn loops(&self, mask: &Mask, cx: &Context<'_>) -> Result<Vec<Vec<DVec2>>, NodeError> {
        let ticker = cx.ticker(mask.height + 1);
        let trace = |values: &[f32], level: f32| {
            trace_level(mask.width, values, level, &|rows| ticker.tick(rows))
        };
        let traced = if self.invert {
            let rest: Vec<f32> = mask.values.par_iter().map(|share| -share).collect();
            trace(&rest, -SELECTED)
        } else {
            // Inside is what lies above, and a share of just a half is to be.
            trace(&mask.values, SELECTED.next_down())
        };
        let mut loops = traced.map_err(|fault| match fault {
            TraceError::Stopped => NodeError::Cancelled,
            TraceError::TooLong => too_intricate(&fault),
        })?;
        loops = loops.par_iter().map(|corners| simplify_loop(corners, self.tolerance)).collect();
        loops.retain(|corners| corners.len() > 2);
        Ok(loops)
    }

    fn outline(&self, loops: Vec<Vec<DVec2>>) -> Result<Polygon, NodeError> {
        Polygon::new(loops).map_err(|fault| match fault {
            PolygonError::Empty if self.invert => {
                NodeError::failed("the mask leaves nothing out: take another one, or unset invert")
            }
            PolygonError::Empty => {
                NodeError::failed("the mask selects nothing: take another one, or set invert")
            }
            PolygonError::TooManyCorners { .. } => too_intricate(&fault),
            fault => NodeError::failed(fault),
        })
    }
}

fn too_intricate(fault: &dyn std::error::Error) -> NodeError {
    NodeError::failed(format!("{fault}: take a smoother mask, or raise tolerance"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::DVec3;

    const NODE: TraceMask = TraceMask { invert: false, tolerance: 0.05 };

    /// Traces a mask over an area of 100 × 50 mm from (10, 20).
    fn traced(node: &TraceMask, width: usize, values: &[f32]) -> Result<Polygon, String> {
        let mask = Mask { width, height: values.len() / width, values: values.to_vec() };
        let min = DVec3::new(10.0, 20.0, 0.0);
        let area = Bounds { min, max: min + DVec3::new(100.0, 50.0, 5.0) };
        let traced = run(|cx| node.run(Laid { mask: &mask, area: &area }, cx));
        traced.map(|traced| traced.polygon).map_err(|fault| fault.to_string())
    }

    fn extent(polygon: &Polygon) -> [[f64; 2]; 2] {
        let corners = || polygon.loops().iter().flatten().copied();
        let [low, high] = [corners().reduce(DVec2::min), corners().reduce(DVec2::max)];
        [low.unwrap().to_array(), high.unwrap().to_array()]
    }

    /// Pixels of 10 mm; the upper left quarter is selected.
    fn corner() -> Vec<f32> {
        (0..66).map(|k| if k % 11 <= 5 && k / 11 <= 2 { 1.0 } else { 0.0 }).collect()
    }

    #[test]
    fn the_top_row_is_far_and_pixels_lie_as_z_map_lays_them() {
        let polygon = traced(&NODE, 11, &corner()).unwrap();
        // Half a pixel beyond the last selected ones: 5.5 and 2.5 pixels from the far left corner.
        let wanted = [[10.0, 70.0 - 25.0], [10.0 + 55.0, 70.0]];
        let off =
            extent(&polygon).into_iter().zip(wanted).map(|(a, b)| DVec2::from(a) - DVec2::from(b));
        assert!(off.map(DVec2::length).fold(0.0, f64::max) < 1e-5, "{:?}", extent(&polygon));
    }

    #[test]
    fn the_inverse_is_the_rest() {
        let rest = traced(&TraceMask { invert: true, ..NODE }, 11, &corner()).unwrap();
        assert_eq!(extent(&rest), [[10.0, 20.0], [110.0, 70.0]]);
        let whole = traced(&NODE, 11, &[1.0; 66]).unwrap();
        assert_eq!((whole.loops().len(), whole.corners()), (1, 4));
        assert!(
            traced(&NODE, 11, &corner()).unwrap().and(&rest).is_none_or(|p| p.area_mm2() < 1e-4)
        );
        assert!((rest.area_mm2().abs() + 55.0 * 25.0 - 12.5 - 5000.0).abs() < 1e-4);
    }

    #[test]
    fn a_share_of_half_is_inside() {
        let half: Vec<f32> = corner().iter().map(|share| 0.5 * share).collect();
        let polygon = traced(&NODE, 11, &half).unwrap();
        let [low, high] = extent(&polygon);
        // The outline runs through the middles of the pixels that just reach it.
        let near = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(near(low, [10.0, 50.0]) && near(high, [60.0, 70.0]), "{low:?} {high:?}");
        let less: Vec<f32> = corner().iter().map(|share| 0.49 * share).collect();
        assert!(traced(&NODE, 11, &less).is_err());
    }

    #[test]
    fn masks_without_an_inside_or_with_too_much_outline_are_told() {
        let none = traced(&NODE, 11, &[0.0; 66]).unwrap_err();
        assert_eq!(none, "the mask selects nothing: take another one, or set invert");
        let none = traced(&TraceMask { invert: true, ..NODE }, 11, &[1.0; 66]).unwrap_err();
        assert_eq!(none, "the mask leaves nothing out: take another one, or unset invert");
        assert!(traced(&NODE, 1, &[0.0; 6]).unwrap_err().contains("2 × 2 px at least"));
        let chess: Vec<f32> = (0..501 * 501).map(|k| (k % 2) as f32).collect();
        let noise = traced(&NODE, 501, &chess).unwrap_err();
        assert!(noise.contains("corners; the limit is 100000: take a smoother mask"), "{noise}");
    }

    #[test]
    fn a_mask_of_24_megapixels_stays_below_the_limit_of_corners() {
        let (columns, rows) = (6000, 4000);
        let wave = |k: usize| {
            let (x, y) = ((k % columns) as f64 - 3000.0, (k / columns) as f64 - 2000.0);
            let angle = y.atan2(x);
            let radius = 1500.0 + 200.0 * (9.0 * angle).sin() + 9.0 * (400.0 * angle).sin();
            if x.hypot(y) < radius { 1.0 } else { 0.0 }
        };
        let values: Vec<f32> = (0..columns * rows).into_par_iter().map(wave).collect();
        let polygon = traced(&NODE, columns, &values).unwrap();
        assert_eq!(polygon.loops().len(), 1);
        assert!((5_000..100_000).contains(&polygon.corners()), "{}", polygon.corners());
    }

    /// Whether a place is surrounded by an odd number of loops.
    fn is_inside(polygon: &Polygon, at: DVec2) -> bool {
        let crosses = |a: DVec2, b: DVec2| {
            (a.x <= at.x) != (b.x <= at.x) && a.y + (at.x - a.x) / (b.x - a.x) * (b.y - a.y) > at.y
        };
        let around = |corners: &Vec<DVec2>| {
            let next = corners.iter().cycle().skip(1);
            corners.iter().zip(next).filter(|(a, b)| crosses(**a, **b)).count()
        };
        polygon.loops().iter().map(around).sum::<usize>() % 2 == 1
    }

    #[test]
    fn every_pixel_lies_on_its_side_of_the_outline() {
        let mut random = fastrand::Rng::with_seed(6);
        for (columns, rows) in [(3, 3), (21, 3), (3, 13), (17, 11)] {
            let values: Vec<f32> = (0..columns * rows).map(|_| f32::from(random.bool())).collect();
            let exact = TraceMask { tolerance: 0.0, ..NODE };
            let polygon = traced(&exact, columns, &values).unwrap();
            let pitch = DVec2::new(100.0 / (columns - 1) as f64, 50.0 / (rows - 1) as f64);
            for (x, y) in (1..rows - 1).flat_map(|y| (1..columns - 1).map(move |x| (x, y))) {
                let at = DVec2::new(10.0 + x as f64 * pitch.x, 70.0 - y as f64 * pitch.y);
                assert_eq!(is_inside(&polygon, at), values[y * columns + x] == 1.0, "{x}, {y}");
            }
        }
    }
}
