//! A gray picture becomes a surface of a given size.
//!
//! Z = (I - I_min)·(Z_max - Z_min)/(I_max - I_min) + Z_min over the whole picture (Sood 2015,
//! equation 3.3; the paper of 2018 prints I - Z_min, a misprint). The pitch is the canvas over the
//! number of *pixels*; see `canvas`.

use super::canvas::{Canvas, Span};
use crate::values::GrayImage;
use carvegraph_core::{Conflict, Context, Inputs, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, HeightField};

/// Turns brightness into height and fits the picture to a canvas.
#[derive(Clone, Debug, Params)]
pub(crate) struct ZMap {
    #[param(shared)]
    pub(crate) canvas: Canvas,
    /// Height of the darkest pixel.
    #[param(unit = "mm", default = 0.0, range = -1000.0..=1000.0)]
    pub(crate) z_min: f64,
    /// Height of the brightest pixel.
    #[param(unit = "mm", default = 5.0, range = -1000.0..=1000.0)]
    pub(crate) z_max: f64,
}

#[derive(Inputs)]
pub(crate) struct Brightness<'a> {
    /// The picture.
    image: &'a GrayImage,
}

#[derive(Outputs)]
pub(crate) struct Mapped {
    /// The surface; its near left corner is the origin.
    surface: HeightField,
    /// The box that holds it.
    bounds: Bounds,
}

impl Node for ZMap {
    const KIND: &'static str = "z_map";
    type Inputs<'a> = Brightness<'a>;
    type Outputs = Mapped;

    fn check(&self) -> Result<(), Conflict> {
        if self.z_min < self.z_max {
            return Ok(());
        }
        let message = format!("z_max ({} mm) must be above z_min ({} mm)", self.z_max, self.z_min);
        Err(Conflict { param: "z_max", message })
    }

    fn run(&self, inputs: Brightness<'_>, cx: &Context<'_>) -> Result<Mapped, NodeError> {
        let image = inputs.image;
        let span = Span::of(image, |_| true);
        let scale = span.scale(self.z_min, self.z_max);
        let height_of = |_, value: f64| (value - span.dark) * scale + self.z_min;
        let surface = self.canvas.surface(image, height_of, cx)?;
        if span.is_even() {
            cx.warn(format!(
                "the picture is one even gray: the surface is flat, at z_min = {} mm",
                self.z_min
            ));
        }
        let bounds = surface.bounds();
        Ok(Mapped { surface, bounds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn map(width: usize, values: &[f32], z_min: f64, z_max: f64) -> Result<HeightField, String> {
        let image = GrayImage { width, height: values.len() / width, values: values.to_vec() };
        let node =
            ZMap { canvas: Canvas { canvas_width: 203.0, canvas_height: 203.0 }, z_min, z_max };
        let mapped = run(|cx| node.run(Brightness { image: &image }, cx));
        mapped.map(|mapped| mapped.surface).map_err(|fault| fault.to_string())
    }

    #[test]
    fn brightness_spans_the_range_and_the_top_row_is_far() {
        let field = map(2, &[0.25, 0.375, 0.5, 0.75], -1.0, 3.0).unwrap();
        assert_eq!(field.row(1), [-1.0, 0.0]);
        assert_eq!(field.row(0), [1.0, 3.0]);
    }

    #[test]
    fn the_canvas_is_fitted_over_pixels() {
        let size = |columns: usize, rows: usize| {
            let mut values = vec![0.0; columns * rows];
            values[0] = 1.0;
            let field = map(columns, &values, 0.0, 5.0).unwrap();
            (columns as f64 * field.pitch_mm(), rows as f64 * field.pitch_mm())
        };
        // The sizes that the source prints.
        for (columns, rows, width, height) in [
            (328, 618, 107.74, 203.0),
            (600, 900, 135.33, 203.0),
            (640, 1024, 126.88, 203.0),
            (480, 640, 152.25, 203.0),
            (1392, 1104, 203.0, 161.0),
            (855, 700, 203.0, 166.2),
        ] {
            let (w, h) = size(columns, rows);
            assert!((w - width).abs() < 0.01 && (h - height).abs() < 0.01, "{columns} × {rows}");
        }
    }

    #[test]
    fn an_even_gray_is_flat_at_z_min() {
        let field = map(3, &[0.5; 6], 1.5, 5.0).unwrap();
        assert!(field.heights().iter().all(|z| *z == 1.5));
    }

    #[test]
    fn a_line_of_pixels_makes_no_surface() {
        for (width, count) in [(1, 1), (1, 9), (9, 9)] {
            let message = map(width, &vec![0.0; count], 0.0, 5.0).unwrap_err();
            assert!(message.contains("2 × 2 px at least"), "{message}");
        }
    }

    #[test]
    fn sixteen_bits_keep_sixty_thousand_heights() {
        let values: Vec<f32> = (0..=65535u16).map(|v| f32::from(v) / 65535.0).collect();
        let field = map(256, &values, 0.0, 5.0).unwrap();
        let mut heights: Vec<u32> = field.heights().iter().map(|z| z.to_bits()).collect();
        heights.sort_unstable();
        heights.dedup();
        assert_eq!(heights.len(), 65536);
    }
}
