//! A surface with one height above each node of a square grid.

use crate::Bounds;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Why heights do not make a field.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum HeightFieldError {
    /// A surface needs two nodes each way.
    #[error("a surface needs at least 2 × 2 points; this one has {columns} × {rows}")]
    TooSmall {
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// The list of heights is not `columns · rows` long.
    #[error("{given} heights do not fill a grid of {columns} × {rows}")]
    WrongLength {
        /// Heights given.
        given: usize,
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// The grid's pitch is not a positive finite length.
    #[error("the grid's pitch must be a positive length, not {0} mm")]
    BadPitch(f64),
    /// A height is NaN or infinite.
    #[error("the height at column {column}, row {row} is {value}")]
    NotFinite {
        /// Column of the bad height.
        column: usize,
        /// Row of the bad height.
        row: usize,
        /// What stands there.
        value: f32,
    },
}

/// Heights over a square grid: node (column `i`, row `j`) stands at
/// (`i · pitch`, `j · pitch`, height) mm. Row 0 is the near edge (y = 0).
///
/// Between the nodes the surface is the one that the stitcher makes: each cell is split along the
/// diagonal from (i, j) to (i + 1, j + 1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeightField {
    columns: usize,
    rows: usize,
    pitch_mm: f64,
    heights: Vec<f32>,
    z_min: f32,
    z_max: f32,
}

impl HeightField {
    /// Makes a field from `columns · rows` heights in mm, row by row from y = 0, x fastest.
    ///
    /// # Errors
    /// If there are fewer than two columns or rows, the list has another length, the pitch is not
    /// positive, or a height is not finite.
    pub fn new(
        columns: usize,
        rows: usize,
        pitch_mm: f64,
        heights: Vec<f32>,
    ) -> Result<Self, HeightFieldError> {
        if columns < 2 || rows < 2 {
            return Err(HeightFieldError::TooSmall { columns, rows });
        }
        if columns.checked_mul(rows) != Some(heights.len()) {
            return Err(HeightFieldError::WrongLength { given: heights.len(), columns, rows });
        }
        if !(pitch_mm.is_finite() && pitch_mm > 0.0) {
            return Err(HeightFieldError::BadPitch(pitch_mm));
        }
        let mut z_min = f32::INFINITY;
        let mut z_max = f32::NEG_INFINITY;
        for (index, &value) in heights.iter().enumerate() {
            if !value.is_finite() {
                let (column, row) = (index % columns, index / columns);
                return Err(HeightFieldError::NotFinite { column, row, value });
            }
            z_min = z_min.min(value);
            z_max = z_max.max(value);
        }
        Ok(Self { columns, rows, pitch_mm, heights, z_min, z_max })
    }

    /// Nodes along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Nodes along y.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Distance between neighbouring nodes, the same along x and y, in mm.
    #[must_use]
    pub fn pitch_mm(&self) -> f64 {
        self.pitch_mm
    }

    /// All heights in mm, row by row from y = 0, x fastest.
    #[must_use]
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// The heights of row `j`, in mm.
    #[must_use]
    pub fn row(&self, j: usize) -> &[f32] {
        &self.heights[j * self.columns..][..self.columns]
    }

    /// Height of node (column `i`, row `j`), in mm.
    #[must_use]
    pub fn height(&self, i: usize, j: usize) -> f64 {
        f64::from(self.heights[j * self.columns + i])
    }

    /// Node (column `i`, row `j`) as a point in mm.
    #[must_use]
    pub fn point(&self, i: usize, j: usize) -> DVec3 {
        DVec3::new(i as f64 * self.pitch_mm, j as f64 * self.pitch_mm, self.height(i, j))
    }

    /// The box that just holds the field.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds {
            min: DVec3::new(0.0, 0.0, f64::from(self.z_min)),
            max: DVec3::new(
                (self.columns - 1) as f64 * self.pitch_mm,
                (self.rows - 1) as f64 * self.pitch_mm,
                f64::from(self.z_max),
            ),
        }
    }
}
