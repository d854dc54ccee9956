//! A level surface to compose a relief on.

use super::check_size;
use carvegraph_core::{Context, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{Bounds, HeightField};

/// Makes a level plate, to be written on, stamped or framed.
#[derive(Clone, Debug, Params)]
pub(crate) struct Plate {
    /// Its width (x).
    #[param(unit = "mm", default = 100.0, range = 0.01..=10_000.0)]
    pub(crate) width: f64,
    /// Its height (y).
    #[param(unit = "mm", default = 50.0, range = 0.01..=10_000.0)]
    pub(crate) height: f64,
    /// Distance of its nodes. Width and height become whole pitches, to the nearest.
    #[param(unit = "mm", default = 0.1, range = 0.001..=100.0)]
    pub(crate) pitch: f64,
    /// Where it lies.
    #[param(unit = "mm", default = 0.0, range = -1000.0..=1000.0)]
    pub(crate) z: f64,
}

#[derive(Outputs)]
pub(crate) struct Level {
    /// The plate; its near left corner is the origin.
    surface: HeightField,
    /// The box that holds it.
    bounds: Bounds,
}

impl Node for Plate {
    const KIND: &'static str = "plate";
    type Inputs<'a> = ();
    type Outputs = Level;

    fn run(&self, (): (), _: &Context<'_>) -> Result<Level, NodeError> {
        let pitches = |length: f64| (length / self.pitch).round().max(1.0) as usize + 1;
        let [columns, rows] = [pitches(self.width), pitches(self.height)];
        check_size([columns, rows], "pitch")?;
        let heights = vec![self.z as f32; columns * rows];
        let surface = HeightField::new(columns, rows, self.pitch, heights);
        let surface = surface.map_err(NodeError::failed)?;
        let bounds = surface.bounds();
        Ok(Level { surface, bounds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    fn made(width: f64, height: f64, pitch: f64) -> Result<HeightField, String> {
        let plate = Plate { width, height, pitch, z: -1.5 };
        run(|cx| plate.run((), cx)).map(|l| l.surface).map_err(|fault| fault.to_string())
    }

    #[test]
    fn it_is_level_and_of_its_size() {
        let plate = made(3.0, 2.04, 0.1).unwrap();
        assert_eq!((plate.columns(), plate.rows()), (31, 21));
        assert!(plate.heights().iter().all(|z| *z == -1.5));
        let least = made(0.01, 0.01, 1.0).unwrap();
        assert_eq!((least.columns(), least.rows()), (2, 2));
    }

    #[test]
    fn a_pitch_too_fine_for_any_computer_is_refused() {
        let told = made(1000.0, 1000.0, 0.001).unwrap_err();
        assert!(told.contains("1000001 × 1000001 nodes; the limit is 400000000"), "{told}");
    }
}
