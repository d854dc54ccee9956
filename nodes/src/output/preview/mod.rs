//! A picture of the work: the carved plaque, or the path of the cutter.

mod color;
mod deviation_map;
mod horizon;
mod legend;
mod marks;
mod path;
mod render;
mod resample;
mod strokes;
mod wood;

pub(crate) use deviation_map::draw_deviation;

use carvegraph_core::{Context, Inputs, Node, NodeError, OutputName, Params};
use carvegraph_geometry::{HeightField, Toolpath};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, RgbImage};

/// Arcs are drawn as chords so close to them, in mm: less than a pixel of a part of some metres.
const ARC_TOLERANCE_MM: f64 = 0.01;

/// Draws the surface as a carved plaque or, if a path is connected, the path above it.
#[derive(Clone, Debug, Params)]
pub(crate) struct Preview {
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}")]
    pub(crate) name: OutputName,
    /// The longer side of the picture.
    #[param(unit = "px", default = 1200, range = 16..=8192)]
    pub(crate) size: u32,
}

#[derive(Inputs)]
pub(crate) struct Scene<'a> {
    /// The surface.
    surface: Option<&'a HeightField>,
    /// The path to draw instead, above the surface if there is one.
    toolpath: Option<&'a Toolpath>,
}

impl Node for Preview {
    const KIND: &'static str = "preview";
    type Inputs<'a> = Scene<'a>;
    type Outputs = ();

    fn run(&self, inputs: Scene<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let ticker = cx.ticker(match inputs.toolpath {
            Some(_) => path::PATH_WORK,
            None => render::SURFACE_WORK,
        });
        let tick = |units| ticker.tick(units);
        let picture = match (inputs.surface, inputs.toolpath) {
            (surface, Some(path)) => {
                path::render_path(surface, &path.flattened(ARC_TOLERANCE_MM), self.size, &tick)
            }
            (Some(surface), None) => render::render_surface(surface, self.size, &tick),
            (None, None) => {
                let message = "there is nothing to draw: connect a surface or a toolpath";
                return Err(NodeError::failed(message));
            }
        };
        save_png(&self.name, &cx.completed(picture)?, cx)
    }
}

/// Saves a picture.
pub(crate) fn save_png(
    name: &OutputName,
    picture: &RgbImage,
    cx: &Context<'_>,
) -> Result<(), NodeError> {
    let mut file = cx.create(name, "png")?;
    PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive)
        .write_image(picture, picture.width(), picture.height(), ExtendedColorType::Rgb8)
        .map_err(|fault| match cx.is_cancelled() {
            true => NodeError::Cancelled,
            false => NodeError::failed(fault),
        })?;
    file.finish()?;
    Ok(())
}
