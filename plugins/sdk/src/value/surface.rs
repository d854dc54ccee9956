//! Surfaces: height fields, meshes, points.

use super::fields::Fields;
use super::{PortValue, Raw, ValueError};
use std::borrow::Cow;

/// Heights over a square grid: node (column i, row j) stands at (i · pitch, j · pitch, height) mm.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField<'a> {
    /// Nodes along x, at least 2.
    pub columns: usize,
    /// Nodes along y, at least 2.
    pub rows: usize,
    /// Distance between neighbouring nodes, in mm, above 0.
    pub pitch_mm: f64,
    /// Heights in mm, row by row from y = 0, x fastest.
    pub heights: Cow<'a, [f32]>,
}

impl HeightField<'_> {
    /// The heights of row `j`, in mm.
    ///
    /// # Panics
    /// If there is no such row.
    #[must_use]
    pub fn row(&self, j: usize) -> &[f32] {
        &self.heights[j * self.columns..][..self.columns]
    }

    /// Other heights over the same grid.
    #[must_use]
    pub fn with_heights(&self, heights: Vec<f32>) -> HeightField<'static> {
        let (columns, rows, pitch_mm) = (self.columns, self.rows, self.pitch_mm);
        HeightField { columns, rows, pitch_mm, heights: heights.into() }
    }
}

impl<'a> PortValue<'a> for HeightField<'a> {
    const TYPE: &'static str = "height_field";

    fn into_raw(self) -> Raw<'a> {
        Raw::new(Self::TYPE)
            .with_count("columns", self.columns)
            .with_count("rows", self.rows)
            .with("pitch_mm", vec![self.pitch_mm])
            .with("heights", self.heights)
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let (columns, rows) = (fields.count("columns")?, fields.count("rows")?);
        let pitch_mm = fields.one("pitch_mm")?;
        let heights = fields.array("heights")?;
        let fits = columns.checked_mul(rows) == Some(heights.len());
        fields.check_length("heights", heights.len(), fits, &format_args!("{columns} × {rows}"))?;
        fields.end()?;
        Ok(Self { columns, rows, pitch_mm, heights })
    }
}

/// Triangles over shared vertices, counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh<'a> {
    /// Vertices x, y, z in mm.
    pub vertices: Cow<'a, [[f64; 3]]>,
    /// Three indices into `vertices` a triangle.
    pub triangles: Cow<'a, [[u32; 3]]>,
}

impl<'a> PortValue<'a> for Mesh<'a> {
    const TYPE: &'static str = "mesh";

    fn into_raw(self) -> Raw<'a> {
        Raw::new(Self::TYPE)
            .with_tuples("vertices", self.vertices)
            .with_tuples("triangles", self.triangles)
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let vertices = fields.tuples("vertices")?;
        let triangles = fields.tuples::<u32, 3>("triangles")?;
        let limit = vertices.len() as u64;
        let mut corners = triangles.as_flattened().iter().map(|corner| u64::from(*corner));
        if let Some(place) = corners.clone().position(|corner| corner >= limit) {
            let given = corners.nth(place).unwrap_or_default();
            return Err(fields.too_large("triangles", place, given, limit));
        }
        fields.end()?;
        Ok(Self { vertices, triangles })
    }
}

/// Points in space.
#[derive(Clone, Debug, PartialEq)]
pub struct PointCloud<'a> {
    /// Points x, y, z in mm.
    pub points: Cow<'a, [[f64; 3]]>,
    /// Columns and rows of an ordered cloud, which lists the nodes of a grid row by row, x fastest.
    pub grid: Option<(usize, usize)>,
}

impl<'a> PortValue<'a> for PointCloud<'a> {
    const TYPE: &'static str = "point_cloud";

    fn into_raw(self) -> Raw<'a> {
        let grid = self.grid.map_or(vec![], |(columns, rows)| vec![columns as u64, rows as u64]);
        Raw::new(Self::TYPE).with_tuples("points", self.points).with("grid", grid)
    }

    fn read(raw: Raw<'a>) -> Result<Self, ValueError> {
        let mut fields = Fields::open(raw, Self::TYPE)?;
        let points: Cow<'_, [[f64; 3]]> = fields.tuples("points")?;
        let grid = fields.none_or::<u64, 2>("grid")?;
        if let Some([columns, rows]) = grid {
            let fits = columns.checked_mul(rows) == Some(points.len() as u64);
            let wanted = format_args!("3 × {columns} × {rows}, as the grid says");
            fields.check_length("points", 3 * points.len(), fits, &wanted)?;
        }
        fields.end()?;
        // Both are at most the number of points, or one of them is 0.
        let fit = |count: u64| usize::try_from(count).unwrap_or(usize::MAX);
        Ok(Self { points, grid: grid.map(|[columns, rows]| (fit(columns), fit(rows))) })
    }
}
