//! Loading points.
//!
//! The format is told from the file's contents; see [`read`](super::read). Scans lie where the scanner
//! or the survey put them, often kilometres away from 0. Coordinates stay `f64` and lose nothing; what
//! is made of them later (height fields hold `f32`) would. So the cloud can be moved to 0 here, by
//! exactly the vector that a note tells.

use super::read::{ReadError, ReadPoints, read_points};
use super::unit::{Unit, check_reach, doubt, size_text};
use carvegraph_core::{Choice, Context, InputFile, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, DVec3, PointCloud};
use rayon::prelude::*;
use std::sync::Arc;

/// Loads points: text (XYZ, CSV), PLY, PCD, LAS or LAZ, whatever the file's name says.
#[derive(Clone, Debug, Params)]
pub(crate) struct LoadPoints {
    /// The points' file.
    #[param()]
    pub(crate) path: InputFile,
    /// Unit of the file's numbers.
    #[param(default = Unit::Mm)]
    pub(crate) unit: Unit,
    /// What is moved to x = y = z = 0, before anything is rounded.
    #[param(default = PointOrigin::Keep)]
    pub(crate) origin: PointOrigin,
}

/// What of a cloud lies at 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum PointOrigin {
    /// What lies there in the file.
    Keep,
    /// The corner of its box that is lowest, nearest and furthest left.
    Corner,
    /// The middle of the bottom of its box.
    Center,
}

#[derive(Outputs)]
pub(crate) struct Loaded {
    /// The points, in the order of the file.
    points: PointCloud,
    /// The box that holds them.
    bounds: Bounds,
}

impl Node for LoadPoints {
    const KIND: &'static str = "load_points";
    type Inputs<'a> = ();
    type Outputs = Loaded;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<Loaded, NodeError> {
        let bytes = cx.read(&self.path)?;
        let ticker = cx.ticker(bytes.len());
        let read = read_points(&bytes, &|n| ticker.tick(n)).map_err(|fault| match fault {
            ReadError::Stopped => NodeError::Cancelled,
            fault => NodeError::Failed(format!("{} {fault}", self.path)),
        })?;
        drop(bytes);
        if read.missed > 0 {
            let missed = read.missed;
            cx.warn(format!("{missed} points have a coordinate that is no number: left out"));
        }
        self.finish(read, cx)
    }
}

impl LoadPoints {
    fn finish(&self, read: ReadPoints, cx: &Context<'_>) -> Result<Loaded, NodeError> {
        let (format, mut points) = (read.format, read.points);
        let Some(bounds) = Bounds::of(points.par_iter().copied()) else {
            return Err(NodeError::Failed(format!("{} holds no points", self.path)));
        };
        let (offset, mm) = (self.offset(&bounds), self.unit.mm());
        points.par_iter_mut().for_each(|point| *point = (*point - offset) * mm);
        let bounds = Bounds { min: (bounds.min - offset) * mm, max: (bounds.max - offset) * mm };
        check_reach(&bounds)?;
        cx.note(format!("{format}: {} points, {}", points.len(), size_text(&bounds)));
        if self.origin != PointOrigin::Keep {
            let [x, y, z] = offset.to_array();
            cx.note(format!("subtracted from each point, in the file's unit: {x}, {y}, {z}"));
        }
        doubt(&bounds).into_iter().for_each(|doubt| cx.warn(doubt));
        Ok(Loaded { points: PointCloud { points: Arc::new(points), grid: None }, bounds })
    }

    /// What is subtracted from each point, in the file's unit.
    fn offset(&self, bounds: &Bounds) -> DVec3 {
        let center = bounds.center();
        match self.origin {
            PointOrigin::Keep => DVec3::ZERO,
            PointOrigin::Corner => bounds.min,
            PointOrigin::Center => DVec3::new(center.x, center.y, bounds.min.z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_core::Origin;

    fn loaded(text: &str, unit: Unit, origin: PointOrigin) -> Result<Loaded, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scan.las"), text).unwrap();
        let path = Origin::Folder(folder.path().to_owned()).locate("scan.las");
        run(|cx| LoadPoints { path, unit, origin }.run((), cx)).map_err(|fault| fault.to_string())
    }

    #[test]
    fn a_survey_far_away_comes_to_0_without_loss() {
        let text = "500000.125 4649776.25 120.5\n500000.126 4649778.25 121.5\n";
        let corner = loaded(text, Unit::M, PointOrigin::Corner).unwrap();
        assert_eq!(corner.bounds.min, DVec3::ZERO);
        assert!((corner.points.points[1] - DVec3::new(1.0, 2000.0, 1000.0)).length() < 1e-7);
        let center = loaded(text, Unit::M, PointOrigin::Center).unwrap();
        assert_eq!(center.bounds.min.y, -1000.0);
        assert_eq!(center.bounds.min.z, 0.0);
        let kept = loaded(text, Unit::M, PointOrigin::Keep).unwrap();
        assert_eq!(kept.points.points[0], DVec3::new(500_000_125.0, 4_649_776_250.0, 120_500.0));
    }

    #[test]
    fn a_fault_names_file_and_line() {
        let message = loaded("x y z\n0 0 0\n1 2\n", Unit::Mm, PointOrigin::Keep).err().unwrap();
        let end = "line 3: a point needs 3 columns, as the first one has";
        assert!(message.ends_with(end) && message.contains("scan.las is no sound"), "{message}");
    }
}
