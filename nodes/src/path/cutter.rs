//! A cutter chosen by shape and size.
//!
//! Which dimensions there are depends on the shape: they are stated by it, checked like any other
//! parameter, and fields of this node.

use crate::registry::Cutters;
use carvegraph_core::{Context, EntryParams, InputFile, Node, NodeError, Outputs, Params};
use carvegraph_geometry::Cutter;
use carvegraph_sdk::{CutterError, CutterShape, Dimensions};

/// The field of a shape that is made from a drawing: the drawing's file.
pub(crate) const DRAWING: &str = "drawing";

/// The longest drawing read. The outline of a cutter takes some hundred bytes, what a drawing
/// program puts around it some kilobytes.
const MAX_DRAWING_BYTES: usize = 4 << 20;

/// Chooses the cutter. `carve cutters` lists the shapes and their dimensions.
#[derive(Clone, Debug, Params)]
pub(crate) struct CutterNode {
    /// The cutter's shape.
    #[param(catalog = "cutter", default = "ball")]
    pub(crate) shape: String,
    /// The dimensions of that shape.
    #[param(entry_of = "shape")]
    pub(crate) dimensions: EntryParams,
}

#[derive(Outputs)]
pub(crate) struct Chosen {
    /// The cutter.
    cutter: Cutter,
}

impl Node for CutterNode {
    const KIND: &'static str = "cutter";
    type Inputs<'a> = ();
    type Outputs = Chosen;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<Chosen, NodeError> {
        let cutters: &Cutters = cx.service()?;
        let shape = cutters.find(&self.shape).ok_or_else(|| {
            NodeError::failed(format!("there is no cutter shape {:?}", self.shape))
        })?;
        let drawing = self.dimensions.file(DRAWING).map(|file| drawing(file, cx)).transpose()?;
        let cutter = self.cutter(shape, drawing.as_deref()).map_err(NodeError::failed)?;
        Ok(Chosen { cutter })
    }
}

impl CutterNode {
    fn cutter(
        &self,
        shape: &dyn CutterShape,
        drawing: Option<&str>,
    ) -> Result<Cutter, CutterError> {
        let given: Vec<(&str, f64)> = self.dimensions.numbers().collect();
        let mut dimensions = Dimensions::new(shape.dimensions(), &given)?;
        if let Some(drawing) = drawing {
            dimensions = dimensions.with_drawing(drawing);
        }
        let profile = shape.profile(&dimensions)?;
        Ok(Cutter { name: self.shape.clone(), profile })
    }
}

/// The text of a drawing.
fn drawing(file: &InputFile, cx: &Context<'_>) -> Result<String, NodeError> {
    let bytes = cx.read(file)?.into_owned();
    let fail = |what: String| NodeError::failed(format!("{file} is no drawing: {what}"));
    if bytes.len() > MAX_DRAWING_BYTES {
        let count = bytes.len();
        return Err(fail(format!("it has {count} bytes; the limit is {MAX_DRAWING_BYTES}")));
    }
    String::from_utf8(bytes)
        .map_err(|fault| fail(format!("byte {} is no UTF-8", fault.utf8_error().valid_up_to())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_core::{Catalogs, Origin, ParamValue, with_context};
    use carvegraph_sdk::{DimensionSpec, Profile};

    /// As wide as its drawing has letters, or as its diameter says.
    struct Drawn;

    impl CutterShape for Drawn {
        fn name(&self) -> &str {
            "drawn"
        }

        fn about(&self) -> &str {
            "For tests"
        }

        fn dimensions(&self) -> &[DimensionSpec] {
            &[DimensionSpec::DIAMETER]
        }

        fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
            let letters = dimensions.drawing().map(str::len);
            let diameter = letters.map_or(dimensions.get("diameter"), |count| Ok(count as f64))?;
            Ok(Profile::flat(diameter / 2.0)?)
        }
    }

    fn run(shape: &str, dimensions: EntryParams) -> Result<f64, String> {
        let catalogs = Catalogs::default().with("cutter", [], Cutters(vec![Box::new(Drawn)]));
        let node = CutterNode { shape: shape.to_owned(), dimensions };
        let chosen = with_context(&catalogs, |cx| node.run((), cx));
        let chosen = chosen.map_err(|fault| fault.to_string())?;
        Ok(2.0 * chosen.cutter.profile.radius_mm())
    }

    fn drawn(path: &str) -> Result<f64, String> {
        let here = Origin::Folder(env!("CARGO_MANIFEST_DIR").into());
        run("drawn", [(DRAWING, ParamValue::File(here.locate(path)))].into_iter().collect())
    }

    #[test]
    fn the_shape_gets_the_dimensions_that_were_set() {
        let diameter = |mm| [("diameter", ParamValue::Number(mm))].into_iter().collect();
        assert_eq!(run("drawn", diameter(3.0)), Ok(3.0));
        assert_eq!(run("drawn", EntryParams::default()), Ok(6.0));
        assert!(run("drawn", diameter(500.0)).is_err());
        assert_eq!(
            run("drown", diameter(3.0)),
            Err("there is no cutter shape \"drown\"".to_owned())
        );
    }

    #[test]
    fn the_shape_gets_the_text_of_its_drawing() {
        assert_eq!(drawn("Cargo.toml"), Ok(include_str!("../../Cargo.toml").len() as f64));
        let fault = drawn("../graphs/samples/medallion.png").unwrap_err();
        assert!(fault.ends_with("medallion.png is no drawing: byte 0 is no UTF-8"), "{fault}");
        assert!(drawn("nothing.svg").unwrap_err().starts_with("there is no file"));
    }
}
