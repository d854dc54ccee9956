//! Points saved as XYZ or PLY.
//!
//! XYZ: a line a point, three lengths in mm. PLY (Turk, *The PLY Polygon File Format*, 1994):
//! binary, little-endian, three `double` a vertex.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, OutputName, Params};
use carvegraph_geometry::{DVec3, PointCloud};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::Write;

/// Points that are written between two looks at the cancel token.
const BATCH: usize = 1 << 16;

/// Points that one thread encodes at a time.
const CHUNK: usize = 1 << 12;

/// Saves points.
#[derive(Clone, Debug, Params)]
pub(crate) struct SavePoints {
    /// How they are written.
    #[param(default = Format::Xyz)]
    pub(crate) format: Format,
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}")]
    pub(crate) name: OutputName,
}

/// How points are written.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Format {
    /// As text, a line a point.
    Xyz,
    /// As binary PLY.
    Ply,
    /// Not at all.
    None,
}

#[derive(Inputs)]
pub(crate) struct Cloud<'a> {
    /// The points.
    points: &'a PointCloud,
}

impl Node for SavePoints {
    const KIND: &'static str = "save_points";
    type Inputs<'a> = Cloud<'a>;
    type Outputs = ();

    fn idle(&self) -> Option<&'static str> {
        (self.format == Format::None).then_some("no points are to be saved (format: none)")
    }

    fn run(&self, inputs: Cloud<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let points = &inputs.points.points;
        let (extension, head) = match self.format {
            Format::Ply => ("ply", ply_head(points.len())),
            Format::Xyz | Format::None => ("xyz", String::new()),
        };
        let encode = if self.format == Format::Ply { encode_ply } else { encode_xyz };
        let mut file = cx.create(&self.name, extension)?;
        let ticker = cx.ticker(points.len());
        file.write_all(head.as_bytes()).map_err(|fault| file.error(fault))?;
        for batch in points.chunks(BATCH) {
            let encoded: Vec<Vec<u8>> = batch.par_chunks(CHUNK).map(encode).collect();
            for bytes in encoded {
                file.write_all(&bytes).map_err(|fault| file.error(fault))?;
            }
            if !ticker.tick(batch.len()) {
                return Err(NodeError::Cancelled);
            }
        }
        file.finish()?;
        Ok(())
    }
}

fn ply_head(count: usize) -> String {
    format!(
        "ply\nformat binary_little_endian 1.0\ncomment Carvegraph, mm\nelement vertex {count}\n\
         property double x\nproperty double y\nproperty double z\nend_header\n"
    )
}

fn encode_ply(points: &[DVec3]) -> Vec<u8> {
    points.iter().flat_map(|point| point.to_array()).flat_map(f64::to_le_bytes).collect()
}

fn encode_xyz(points: &[DVec3]) -> Vec<u8> {
    let mut text = String::with_capacity(points.len() * 32);
    for point in points {
        // Six digits are a nanometre; writing to a string cannot fail.
        let _ = writeln!(text, "{:.6} {:.6} {:.6}", point.x, point.y, point.z);
    }
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [DVec3; 2] = [DVec3::ZERO, DVec3::new(1.5, -2.0, 0.000_001)];

    #[test]
    fn xyz_has_a_line_a_point() {
        let text = String::from_utf8(encode_xyz(&POINTS)).unwrap();
        assert_eq!(text, "0.000000 0.000000 0.000000\n1.500000 -2.000000 0.000001\n");
    }

    #[test]
    fn ply_has_24_bytes_a_point_after_its_head() {
        let bytes = encode_ply(&POINTS);
        assert_eq!(bytes.len(), 48);
        assert_eq!(bytes[24..32], 1.5f64.to_le_bytes());
        assert!(
            ply_head(2).contains("element vertex 2\n") && ply_head(2).ends_with("end_header\n")
        );
    }
}
