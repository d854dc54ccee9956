//! A cutter chosen by shape and size.
//!
//! Which dimensions there are depends on the shape: they are stated by it, checked like any other
//! parameter, and fields of this node. A tool of a library brings a shape and its dimensions; what is set
//! here wins over them.

use crate::services::Cutters;
use crate::shop::{NONE, Tool, ToolSheet, Tools};
use carvegraph_core::{
    Context, Diagnostics, EntryParams, InputFile, Node, NodeError, Outputs, Params, Yielding,
};
use carvegraph_geometry::Cutter;
use carvegraph_sdk::{CutterError, CutterShape, Dimensions};

/// The field of a shape that is made from a drawing: the drawing's file.
pub(crate) const DRAWING: &str = "drawing";

/// The longest drawing read. The outline of a cutter takes some hundred bytes, what a drawing
/// program puts around it some kilobytes.
const MAX_DRAWING_BYTES: usize = 4 << 20;

/// Chooses the cutter. `carve cutters` lists the shapes and their dimensions, `carve tools` the tools of
/// the libraries, which have both.
#[derive(Clone, Debug, Params)]
pub(crate) struct CutterNode {
    /// The cutter's shape.
    #[param(catalog = "cutter", default = "ball")]
    pub(crate) shape: Yielding<String>,
    /// The dimensions of that shape.
    #[param(entry_of = "shape")]
    pub(crate) dimensions: EntryParams,
    /// A tool of a library, which gives shape and dimensions where they are not set.
    #[param(catalog = "tool", default = "none")]
    pub(crate) tool: String,
}

#[derive(Outputs)]
pub(crate) struct Chosen {
    /// The cutter.
    cutter: Cutter,
    /// The tool's number, and the speeds at which it cuts materials.
    tool: ToolSheet,
}

impl Node for CutterNode {
    const KIND: &'static str = "cutter";
    const VERSION: u32 = 2;
    type Inputs<'a> = ();
    type Outputs = Chosen;

    fn run(&self, (): (), cx: &Context<'_>) -> Result<Chosen, NodeError> {
        let cutters: &Cutters = cx.service()?;
        let tool = self.tool(cx)?;
        let name = self.shape.or(tool.map(|tool| tool.shape.text.clone()));
        let brought = self.brought(tool, &name, cutters, cx)?;
        let shape = cutters
            .find(&name)
            .ok_or_else(|| NodeError::failed(format!("there is no cutter shape {name:?}")))?;
        let given = self.given(shape, &brought)?;
        let drawing = self.dimensions.file(DRAWING);
        let drawing = drawing.map(|file| drawing_text(file, cx)).transpose()?;
        let profile = profile(shape, &given, drawing.as_deref()).map_err(NodeError::failed)?;
        let tool = tool.map(Tool::sheet).unwrap_or_default();
        Ok(Chosen { cutter: Cutter { name, profile }, tool })
    }
}

impl CutterNode {
    fn tool<'c>(&self, cx: &'c Context<'_>) -> Result<Option<&'c Tool>, NodeError> {
        if self.tool == NONE {
            return Ok(None);
        }
        let tools: &Tools = cx.service()?;
        let missing = || NodeError::failed(format!("there is no tool {:?}", self.tool));
        tools.find(&self.tool).map(Some).ok_or_else(missing)
    }

    /// The dimensions that the tool brings for the shape called `name`.
    fn brought(
        &self,
        tool: Option<&Tool>,
        name: &str,
        cutters: &Cutters,
        cx: &Context<'_>,
    ) -> Result<Vec<(&'static str, f64)>, NodeError> {
        let Some(tool) = tool else { return Ok(Vec::new()) };
        let dimensions = tool.dimensions(cutters);
        if name == tool.shape.text {
            return dimensions.map_err(|faults| in_library(&faults));
        }
        cx.warn(format!("tool {:?} is a {}, but {name} is set", self.tool, tool.shape.text));
        // What both may have, such as the diameter.
        Ok(dimensions.unwrap_or_default())
    }

    /// The dimensions of `shape` that were set, and those that the tool brought where they were not.
    fn given(
        &self,
        shape: &dyn CutterShape,
        brought: &[(&'static str, f64)],
    ) -> Result<Vec<(&'static str, f64)>, NodeError> {
        let set = self.dimensions.numbers().filter(|(name, _)| self.dimensions.is_set(name));
        let mut given: Vec<(&'static str, f64)> = set.collect();
        let has = |name: &str| shape.dimensions().iter().any(|spec| spec.name == name);
        if let Some((name, _)) = given.iter().find(|(name, _)| !has(name)) {
            let message =
                format!("tool {:?} is a {}, which has no {name}", self.tool, shape.name());
            return Err(NodeError::refused(name, message));
        }
        for (name, value) in brought {
            if has(name) && given.iter().all(|(known, _)| known != name) {
                given.push((name, *value));
            }
        }
        Ok(given)
    }
}

fn profile(
    shape: &dyn CutterShape,
    given: &[(&str, f64)],
    drawing: Option<&str>,
) -> Result<carvegraph_sdk::Profile, CutterError> {
    let mut dimensions = Dimensions::new(shape.dimensions(), given)?;
    if let Some(drawing) = drawing {
        dimensions = dimensions.with_drawing(drawing);
    }
    shape.profile(&dimensions)
}

/// The faults of a tool, each with its place in the library.
fn in_library(faults: &Diagnostics) -> NodeError {
    let told = faults.sorted().into_iter().map(|fault| {
        let place = fault.span.as_ref().map(|span| format!("{span}: ")).unwrap_or_default();
        let help = fault.help.as_deref().map(|help| format!("; {help}")).unwrap_or_default();
        format!("{place}{}{help}", fault.message)
    });
    NodeError::refused("tool", told.collect::<Vec<_>>().join("; "))
}

/// The text of a drawing.
fn drawing_text(file: &InputFile, cx: &Context<'_>) -> Result<String, NodeError> {
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
        let shape = Yielding::given(shape.to_owned());
        let node = CutterNode { tool: NONE.to_owned(), shape, dimensions };
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

    /// Shape and diameter with a tool of the library that the shop's tests read.
    fn with_tool(
        tool: &str,
        library: &str,
        shape: Yielding<String>,
        dimensions: EntryParams,
    ) -> Result<(String, f64, ToolSheet), String> {
        let tools = crate::shop::tests::library(library).unwrap();
        let catalogs = Catalogs::default().with("tool", [], tools);
        let catalogs = catalogs.with("cutter", [], crate::shop::tests::cutters());
        let node = CutterNode { tool: tool.to_owned(), shape, dimensions };
        let chosen = with_context(&catalogs, |cx| node.run((), cx));
        let Chosen { cutter, tool } = chosen.map_err(|fault| fault.to_string())?;
        Ok((cutter.name, 2.0 * cutter.profile.radius_mm(), tool))
    }

    #[test]
    fn a_tool_gives_what_is_not_set() {
        use crate::shop::tests::LIBRARY;
        let left = || Yielding::left("ball".to_owned());
        let run = |tool: &str, shape, dimensions: EntryParams| {
            let (name, diameter, sheet) = with_tool(tool, LIBRARY, shape, dimensions).unwrap();
            (name, diameter, sheet.tool)
        };
        let own = |name: &str, mm: f64, tool: &str| (name.to_owned(), mm, tool.to_owned());
        assert_eq!(run("none", left(), EntryParams::default()), own("ball", 6.0, "none"));
        assert_eq!(run("ball_3", left(), EntryParams::default()), own("ball", 3.0, "ball_3"));
        assert_eq!(run("cone_12", left(), EntryParams::default()), own("cone", 12.0, "cone_12"));
        let two = || [("diameter", ParamValue::Number(2.0))].into_iter().collect();
        assert_eq!(run("cone_12", left(), two()), own("cone", 2.0, "cone_12"));
        let ball = Yielding::given("ball".to_owned());
        assert_eq!(run("cone_12", ball, EntryParams::default()), own("ball", 12.0, "cone_12"));
    }

    #[test]
    fn a_tool_that_cannot_be_made_is_shown_in_its_library() {
        let left = || Yielding::left("ball".to_owned());
        let library = r#"Tools(format: 1, tools: {"a": (shape: "bal"),
"b": (shape: "ball", dimensions: {"diameter": 900})})"#;
        let fault =
            |tool: &str| with_tool(tool, library, left(), EntryParams::default()).unwrap_err();
        assert_eq!(
            fault("a"),
            "shed/mine.ron:1:39: tool \"a\": there is no cutter shape \"bal\"; did you mean \"ball\"?"
        );
        assert_eq!(
            fault("b"),
            "shed/mine.ron:2:47: tool \"b\": diameter must be between 0.01 and 200 mm, not 900"
        );
        assert_eq!(fault("c"), "there is no tool \"c\"");
    }
}
