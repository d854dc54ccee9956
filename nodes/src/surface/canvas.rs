//! How a picture lies on the plaque, for every node that makes heights of one.
//!
//! The pitch is the canvas over the number of *pixels*, the smaller of both ways so that the picture
//! fits and keeps its proportions: p = min(canvas width / columns, canvas height / rows). The surface
//! spans one pitch less than the canvas, from the middle of the first pixel to the middle of the
//! last. The picture's top row is the far edge (greatest y).

use crate::values::GrayImage;
use carvegraph_core::{Context, NodeError, Params};
use carvegraph_geometry::HeightField;
use rayon::prelude::*;

/// The room that a picture may take.
#[derive(Clone, Copy, Debug, Params)]
pub(crate) struct Canvas {
    /// Width that the picture may take (x).
    #[param(unit = "mm", default = 203.0, range = 0.1..=10_000.0)]
    pub(crate) canvas_width: f64,
    /// Height that the picture may take (y).
    #[param(unit = "mm", default = 203.0, range = 0.1..=10_000.0)]
    pub(crate) canvas_height: f64,
}

impl Canvas {
    /// The surface over `image`; `height_of` gives the height in mm of the pixel with that number
    /// and brightness.
    pub(super) fn surface(
        self,
        image: &GrayImage,
        height_of: impl Fn(usize, f64) -> f64 + Sync,
        cx: &Context<'_>,
    ) -> Result<HeightField, NodeError> {
        let (columns, rows) = (image.width, image.height);
        if columns < 2 || rows < 2 {
            return Err(NodeError::Failed(format!(
                "a picture of {columns} × {rows} px makes no surface: it needs 2 × 2 px at least"
            )));
        }
        let ticker = cx.ticker(rows);
        let mut heights = vec![0.0; image.values.len()];
        heights
            .par_chunks_exact_mut(columns)
            .zip(image.values.par_chunks_exact(columns).enumerate().rev())
            .try_for_each(|(row, (y, source))| {
                for (x, (height, value)) in row.iter_mut().zip(source).enumerate() {
                    *height = height_of(y * columns + x, f64::from(*value)) as f32;
                }
                ticker.tick(1).then_some(())
            })
            .ok_or(NodeError::Cancelled)?;
        let pitch = (self.canvas_width / columns as f64).min(self.canvas_height / rows as f64);
        HeightField::new(columns, rows, pitch, heights).map_err(NodeError::failed)
    }
}

/// From one brightness to another, the darkest of some pixels and the brightest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) dark: f64,
    pub(super) bright: f64,
}

impl Span {
    /// That of the pixels whose number `counts`; empty, with its ends the wrong way round, if none
    /// does.
    pub(super) fn of(image: &GrayImage, counts: impl Fn(usize) -> bool + Sync) -> Self {
        let counted = image.values.par_iter().enumerate().filter(|(at, _)| counts(*at));
        let (dark, bright) = counted
            .map(|(_, value)| (*value, *value))
            .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        Self { dark: f64::from(dark), bright: f64::from(bright) }
    }

    /// Whether it holds one gray only.
    pub(super) fn is_even(self) -> bool {
        self.dark == self.bright
    }

    /// How many mm a step of brightness from 0 to 1 makes, if the span is `low` to `high`; 0 for one
    /// gray, so that it lies at `low`.
    pub(super) fn scale(self, low: f64, high: f64) -> f64 {
        if self.bright > self.dark { (high - low) / (self.bright - self.dark) } else { 0.0 }
    }
}
