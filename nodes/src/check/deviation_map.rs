//! The deviation as a picture.

use crate::output::{draw_deviation, save_png};
use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Params};
use carvegraph_geometry::{Deviation, FIRST_ORDER_MM};

/// Draws where the machined surface lies above the one that was meant and where below, with a scale in mm. Nothing is
/// drawn where nothing was compared.
#[derive(Clone, Debug, Params)]
pub(crate) struct DeviationMap {
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}-deviation")]
    pub(crate) name: OutputName,
    /// The deviation at which the colours end. 0 takes what 99 % of the nodes stay within.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1000.0)]
    pub(crate) range: f64,
    /// The longer side of the picture.
    #[param(unit = "px", default = 1000, range = 64..=4096)]
    pub(crate) size: u32,
}

#[derive(Inputs)]
pub(crate) struct Compared<'a> {
    /// How far each node is off.
    deviation: &'a Deviation,
}

impl Node for DeviationMap {
    const KIND: &'static str = "deviation_map";
    const USES_PREFIX: bool = true;
    type Inputs<'a> = Compared<'a>;
    type Outputs = ();

    fn run(&self, inputs: Compared<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let deviation = inputs.deviation;
        if deviation.extent.nodes == 0 {
            return Ok(());
        }
        let range = self.range(deviation);
        save_png(&self.name, &draw_deviation(deviation, range, self.size), cx)
    }
}

impl DeviationMap {
    /// Where the colours end, in mm.
    fn range(&self, deviation: &Deviation) -> f64 {
        if self.range > 0.0 {
            return self.range;
        }
        let extent = &deviation.extent;
        // Rounded up, so that the scale has room for whole figures.
        let within = extent.p99_excess_mm.max(extent.p99_gouge_mm).max(10.0 * FIRST_ORDER_MM);
        let unit = 10_f64.powf(within.log10().floor());
        (within / unit).ceil() * unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_geometry::Extent;

    fn range(given: f64, p99_excess_mm: f64, p99_gouge_mm: f64) -> f64 {
        let name = OutputName::new("map").unwrap();
        let map = DeviationMap { name, range: given, size: 200 };
        let extent = Extent { p99_excess_mm, p99_gouge_mm, ..Extent::default() };
        map.range(&Deviation { extent, ..Deviation::nowhere() })
    }

    #[test]
    fn colours_end_at_a_round_figure() {
        assert!((range(0.0, 0.23, 0.1) - 0.3).abs() < 1e-12);
        assert!((range(0.0, 0.02, 0.071) - 0.08).abs() < 1e-12);
        assert!((range(0.0, 0.0, 0.0) - 0.01).abs() < 1e-12);
        assert_eq!(range(0.5, 0.23, 0.1), 0.5);
    }
}
