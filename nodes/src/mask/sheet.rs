//! What masks are drawn on: a picture or a surface, with its millimetres.
//!
//! Drawings have their origin in the sheet's middle, x to the right and y up, in mm. The middle of a
//! pixel is a node of the surface. A picture is as wide as is said, which for 100 mm makes a
//! millimetre a hundredth of its width.

use crate::values::{GrayImage, Mask};
use carvegraph_core::{Context, Inputs, NodeError, Outputs, Params};
use carvegraph_geometry::{DVec2, Filling, HeightField, Polygon};
use kurbo::{Affine, BezPath, PathEl, Point};

/// How far a curve may be from its chords, in pixels: shares are off by a hundredth at most.
const WITHIN_PX: f64 = 0.01;

#[derive(Inputs)]
pub(crate) struct Ground<'a> {
    /// The surface that the mask is for, with a pixel for each node.
    surface: Option<&'a HeightField>,
    /// The picture that the mask is for, if it is for none; only its size counts.
    image: Option<&'a GrayImage>,
}

#[derive(Outputs)]
pub(crate) struct Drawn {
    /// What is covered; pixels on an edge by their share.
    pub(super) mask: Mask,
}

/// Pixels, and how large they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sheet {
    width: usize,
    height: usize,
    pixel_mm: f64,
    /// Of a surface from its first node to its last, of a picture from border to border.
    pub(super) size_mm: DVec2,
}

impl Ground<'_> {
    /// The sheet that is wired.
    ///
    /// # Errors
    /// If none is, or both are.
    pub(super) fn sheet(&self, picture_width_mm: f64) -> Result<Sheet, NodeError> {
        match (self.surface, self.image) {
            (Some(surface), None) => Ok(Sheet {
                width: surface.columns(),
                height: surface.rows(),
                pixel_mm: surface.pitch_mm(),
                size_mm: surface.bounds().size().truncate(),
            }),
            (None, Some(image)) => {
                let (width, height) = (image.width, image.height);
                let pixel_mm = picture_width_mm / width as f64;
                let size_mm = DVec2::new(picture_width_mm, height as f64 * pixel_mm);
                Ok(Sheet { width, height, pixel_mm, size_mm })
            }
            (None, None) => Err(NodeError::failed(
                "it is not said what the mask is for: wire a surface or an image",
            )),
            (Some(_), Some(_)) => Err(NodeError::failed(
                "the mask is either for the surface or for the image: wire one of them",
            )),
        }
    }
}

impl Sheet {
    /// From mm about the middle to pixels from the upper left corner.
    pub(super) fn to_pixels(self) -> Affine {
        let middle = (self.width as f64 / 2.0, self.height as f64 / 2.0);
        Affine::translate(middle)
            * Affine::scale_non_uniform(1.0 / self.pixel_mm, -1.0 / self.pixel_mm)
    }

    /// What a path in pixels leaves inside; `None` if nothing.
    pub(super) fn inside(path: &BezPath, filling: Filling) -> Result<Option<Polygon>, NodeError> {
        let loops = loops(path);
        if loops.is_empty() {
            return Ok(None);
        }
        Polygon::filled(loops, filling)
            .map_err(|fault| NodeError::Failed(format!("the outline is too much: {fault}")))
    }

    /// A mask that selects nothing.
    pub(super) fn blank(self) -> Mask {
        let Self { width, height, .. } = self;
        Mask { width, height, values: vec![0.0; width * height] }
    }

    /// The mask of an outline in pixels. Warns of what lies beyond the sheet, and if nothing is
    /// covered.
    pub(super) fn cover(
        self,
        outline: Option<&Polygon>,
        cx: &Context<'_>,
    ) -> Result<Mask, NodeError> {
        let Self { width, height, pixel_mm, .. } = self;
        let ticker = cx.ticker(height);
        let covered =
            outline.map(|outline| outline.coverage(width, height, &|rows| ticker.tick(rows)));
        let values = match covered {
            Some(covered) => cx.completed(covered)?,
            None => vec![0.0; width * height],
        };
        let end = DVec2::new(width as f64, height as f64);
        let out = |p: &DVec2| (-*p).max(*p - end).max_element();
        let corners = outline.iter().flat_map(|outline| outline.loops()).flatten();
        let beyond_mm = corners.map(out).fold(0.0, f64::max) * pixel_mm;
        if values.iter().all(|value| *value == 0.0) {
            cx.warn("nothing of it lies on the picture or surface: the mask selects nothing");
        } else if beyond_mm > pixel_mm {
            cx.warn(format!("it reaches {beyond_mm:.2} mm beyond the border, where it is cut off"));
        }
        Ok(Mask { width, height, values })
    }
}

/// Where what is drawn lies on its sheet.
#[derive(Clone, Debug, Params)]
pub(crate) struct Place {
    /// Where its middle lies, to the right of the middle of the picture or surface.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) x: f64,
    /// Where its middle lies, above that of the picture or surface.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) y: f64,
    /// How far it is turned about that place, counter-clockwise.
    #[param(unit = "deg", default = 0.0, range = -360.0..=360.0)]
    pub(crate) turn: f64,
    /// What a picture's width counts as; a surface has its own.
    #[param(unit = "mm", default = 100.0, range = 0.001..=100_000.0)]
    pub(crate) picture_width: f64,
}

/// Unturned, in the middle.
#[cfg(test)]
pub(super) const MIDDLE: Place = Place { x: 0.0, y: 0.0, turn: 0.0, picture_width: 100.0 };

impl Place {
    /// Turns about the origin, then moves.
    pub(super) fn to_sheet(&self) -> Affine {
        Affine::translate((self.x, self.y)) * Affine::rotate(self.turn.to_radians())
    }
}

/// The closed loops of a path, its curves as chords.
fn loops(path: &BezPath) -> Vec<Vec<DVec2>> {
    let mut loops: Vec<Vec<DVec2>> = Vec::new();
    let corner = |p: Point| DVec2::new(p.x, p.y);
    kurbo::flatten(path, WITHIN_PX, |element| match (element, loops.last_mut()) {
        (PathEl::MoveTo(to), _) => loops.push(vec![corner(to)]),
        (PathEl::LineTo(to), Some(corners)) => corners.push(corner(to)),
        _ => {}
    });
    loops.retain(|corners| corners.len() > 2);
    loops
}

#[cfg(test)]
pub(super) mod testing {
    use super::{Drawn, GrayImage, Ground, HeightField, Mask};
    use crate::testing::run;
    use carvegraph_core::Node;

    /// What a node draws on a surface of so many nodes, a pitch apart.
    pub(in crate::mask) fn on_surface<N>(
        node: &N,
        [columns, rows]: [usize; 2],
        pitch_mm: f64,
    ) -> Result<Mask, String>
    where
        N: for<'a> Node<Inputs<'a> = Ground<'a>, Outputs = Drawn>,
    {
        let surface = HeightField::new(columns, rows, pitch_mm, vec![0.0; columns * rows]).unwrap();
        let drawn = run(|cx| node.run(Ground { surface: Some(&surface), image: None }, cx));
        drawn.map(|drawn| drawn.mask).map_err(|fault| fault.to_string())
    }

    /// What a node draws on a picture.
    pub(in crate::mask) fn on_image<N>(
        node: &N,
        [width, height]: [usize; 2],
    ) -> Result<Mask, String>
    where
        N: for<'a> Node<Inputs<'a> = Ground<'a>, Outputs = Drawn>,
    {
        let image = GrayImage { width, height, values: vec![0.0; width * height] };
        let drawn = run(|cx| node.run(Ground { surface: None, image: Some(&image) }, cx));
        drawn.map(|drawn| drawn.mask).map_err(|fault| fault.to_string())
    }

    /// The least and greatest x and y, in pixels, of what a mask selects.
    pub(in crate::mask) fn extent(mask: &Mask) -> [f64; 4] {
        let start = [f64::INFINITY, f64::INFINITY, 0.0, 0.0];
        let selected = (0..mask.values.len()).filter(|at| mask.values[*at] > 0.0);
        selected.fold(start, |[left, top, right, bottom], at| {
            let (x, y) = ((at % mask.width) as f64, (at / mask.width) as f64);
            [left.min(x), top.min(y), right.max(x + 1.0), bottom.max(y + 1.0)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(ground: &Ground<'_>) -> String {
        ground.sheet(100.0).unwrap_err().to_string()
    }

    #[test]
    fn a_mask_is_for_one_thing() {
        let image = GrayImage { width: 2, height: 2, values: vec![0.0; 4] };
        let surface = HeightField::new(2, 2, 1.0, vec![0.0; 4]).unwrap();
        assert_eq!(
            told(&Ground { surface: None, image: None }),
            "it is not said what the mask is for: wire a surface or an image"
        );
        assert_eq!(
            told(&Ground { surface: Some(&surface), image: Some(&image) }),
            "the mask is either for the surface or for the image: wire one of them"
        );
    }

    #[test]
    fn the_middle_of_a_pixel_is_a_node() {
        let surface = HeightField::new(5, 3, 0.5, vec![0.0; 15]).unwrap();
        let sheet = Ground { surface: Some(&surface), image: None }.sheet(100.0).unwrap();
        assert_eq!(sheet.size_mm, DVec2::new(2.0, 1.0));
        // The near left node is the last row's first pixel.
        assert_eq!(sheet.to_pixels() * Point::new(-1.0, -0.5), Point::new(0.5, 2.5));
        let image = GrayImage { width: 50, height: 20, values: vec![0.0; 1000] };
        let sheet = Ground { surface: None, image: Some(&image) }.sheet(100.0).unwrap();
        assert_eq!(sheet.to_pixels() * Point::new(-50.0, 20.0), Point::new(0.0, 0.0));
    }
}
