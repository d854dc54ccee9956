//! Tools as libraries describe them, with the speeds that they cut materials at.
//!
//! ```ron
//! Tools(
//!     format: 1,
//!     tools: {
//!         "ball_6": (
//!             about: "6 mm ball nose, 2 flutes",
//!             number: 3,                                  // in the controller's tool table
//!             shape: "ball",
//!             dimensions: { "diameter": "6mm" },
//!             materials: {
//!                 "walnut": (feed: "1800mm/min", plunge: "600mm/min", spindle: "18000rpm"),
//!             },
//!         ),
//!     },
//! )
//! ```
//!
//! Shapes may come from plugins, so that a shape and its dimensions are checked against those that there
//! are when the tool is used, or when somebody asks: see [`Tools::faults`]. A shape that is made from a
//! drawing cannot stand in a library: set it beside the tool.

use super::{NONE, file, short, version};
use crate::services::Cutters;
use carvegraph_core::ron::{Form, Item, Name, Value, parse};
use carvegraph_core::source::Source;
use carvegraph_core::units::Dimension;
use carvegraph_core::{Diagnostic, Diagnostics};
use carvegraph_sdk::{CutterShape, DimensionSpec, DimensionUnit, Dimensions};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;

/// Those that `link` takes.
const FEEDS_MM_PER_MIN: RangeInclusive<f64> = 1.0..=100_000.0;

/// Those that `post` takes.
const SPINDLES_RPM: RangeInclusive<f64> = 1.0..=200_000.0;

/// Those that `post` takes.
const NUMBERS: RangeInclusive<i64> = 1..=9999;

/// Speeds of a tool in a material; what is not known is left to the nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Speed of cutting in mm/min.
    pub feed_mm_per_min: Option<f64>,
    /// Speed of going down in mm/min.
    pub plunge_mm_per_min: Option<f64>,
    /// Speed of the spindle in rpm.
    pub spindle_rpm: Option<f64>,
}

/// A tool of a library.
#[derive(Clone, Debug)]
pub struct Tool {
    /// What recipes call it.
    pub name: String,
    /// What it is, in a line.
    pub about: String,
    /// Its place in the controller's tool table, from 1.
    pub number: Option<u32>,
    /// Its shape, and where that is said.
    pub shape: Name,
    /// Its dimensions as they are written.
    dimensions: Vec<(Name, Value)>,
    /// Materials and the speeds they are cut at, in the order written.
    pub materials: Vec<(String, Conditions)>,
    /// The name of its library: the file's without extension.
    pub library: String,
    /// Changes with the library.
    pub version: String,
}

/// What a job needs to know of a tool beside its shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolSheet {
    /// The tool's name, or [`NONE`].
    pub tool: String,
    /// Its place in the controller's tool table.
    pub number: Option<u32>,
    /// Materials and the speeds they are cut at.
    pub materials: Vec<(String, Conditions)>,
}

/// No tool of a library.
impl Default for ToolSheet {
    fn default() -> Self {
        Self { tool: NONE.into(), number: None, materials: Vec::new() }
    }
}

/// The tools that the program knows.
pub struct Tools(pub Vec<Tool>);

impl Tools {
    /// Reads a library; answers its name and its tools.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn read(source: &Arc<Source>) -> Result<(String, Vec<Tool>), Diagnostics> {
        let value = parse(source)?;
        let stem = Path::new(source.name()).file_stem().unwrap_or_default();
        let library = stem.to_string_lossy().into_owned();
        let form = Form::default();
        let read = tools(&form, form.item(&value, "the library"), source, &library);
        form.finish(read).map(|tools| (library, tools))
    }

    /// Those that are part of the program.
    #[must_use]
    pub fn built_in() -> Self {
        let text = include_str!("../../../machines/tools/hobby.ron");
        let source = Arc::new(Source::new("machines/tools/hobby.ron", text));
        let tools = Self::read(&source).map(|(_, tools)| tools);
        Self(tools.unwrap_or_else(|faults| unreachable!("a test reads it: {faults}")))
    }

    /// The tool called `name`.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Tool> {
        self.0.iter().find(|tool| tool.name == name)
    }

    /// What is wrong with shapes and dimensions, as far as these shapes are all there are.
    #[must_use]
    pub fn faults(&self, cutters: &Cutters) -> Diagnostics {
        let faults = self.0.iter().filter_map(|tool| tool.dimensions(cutters).err());
        faults.flatten().collect()
    }

    /// A row each: name, shape and size, materials, what it is.
    #[must_use]
    pub fn rows(&self, cutters: &Cutters) -> Vec<Vec<String>> {
        self.0.iter().map(|tool| tool.row(cutters)).collect()
    }
}

impl Tool {
    /// The dimensions that it gives, in mm and degrees.
    ///
    /// # Errors
    /// If there is no such shape, or the dimensions do not make one; each fault points into the library.
    pub fn dimensions(&self, cutters: &Cutters) -> Result<Vec<(&'static str, f64)>, Diagnostics> {
        let form = Form::default();
        let read = self.shape(&form, cutters).and_then(|shape| self.measured(&form, shape));
        form.finish(read)
    }

    /// What a job needs to know of it beside its shape.
    #[must_use]
    pub fn sheet(&self) -> ToolSheet {
        let (number, materials) = (self.number, self.materials.clone());
        ToolSheet { tool: self.name.clone(), number, materials }
    }

    fn shape<'c>(&self, form: &Form, cutters: &'c Cutters) -> Option<&'c dyn CutterShape> {
        let found = cutters.find(&self.shape.text);
        let fault = |message: String| Diagnostic::error(message).at(self.shape.span.clone());
        let name = &self.name;
        match found {
            None => {
                let shapes = cutters.0.iter().map(|shape| shape.name());
                let mut near = Diagnostics::new();
                let message =
                    format!("tool {name:?}: there is no cutter shape {:?}", self.shape.text);
                near.push_near(fault(message), &self.shape.text, shapes);
                near.into_iter().for_each(|fault| form.push(fault));
                None
            }
            Some(shape) if shape.drawing().is_some() => {
                let message = format!(
                    "tool {name:?}: a {} is made from a drawing, which a library cannot hold",
                    shape.name()
                );
                let help = "leave this tool out, and set cutter and drawing where it is used";
                form.push(fault(message).help(help));
                None
            }
            found => found,
        }
    }

    fn measured(&self, form: &Form, shape: &dyn CutterShape) -> Option<Vec<(&'static str, f64)>> {
        let read = |(name, value): &(Name, Value)| self.dimension(form, shape, name, value);
        let read: Vec<_> = self.dimensions.iter().map(read).collect();
        let read = read.into_iter().collect::<Option<Vec<_>>>()?;
        let made = Dimensions::new(shape.dimensions(), &read);
        if let Err(fault) = made.and_then(|dimensions| shape.profile(&dimensions)) {
            form.fault(&self.shape.span, format!("tool {:?}: {fault}", self.name));
            return None;
        }
        Some(read)
    }

    fn dimension(
        &self,
        form: &Form,
        shape: &dyn CutterShape,
        name: &Name,
        value: &Value,
    ) -> Option<(&'static str, f64)> {
        let specs = shape.dimensions();
        let Some(spec) = specs.iter().find(|spec| spec.name == name.text) else {
            let message =
                format!("tool {:?}: a {} has no {:?}", self.name, shape.name(), name.text);
            let mut near = Diagnostics::new();
            let fault = Diagnostic::error(message).at(name.span.clone());
            near.push_near(fault, &name.text, specs.iter().map(|spec| spec.name));
            near.into_iter().for_each(|fault| form.push(fault));
            return None;
        };
        let item = form.item(value, &format!("tool {:?}: {}", self.name, spec.name));
        Some((spec.name, item.number(dimension(spec), spec.min..=spec.max)?))
    }

    fn row(&self, cutters: &Cutters) -> Vec<String> {
        let size = match self.dimensions(cutters) {
            Ok(dimensions) => self.size(cutters, &dimensions),
            Err(_) => "cannot be made, see carve plugins doctor".to_owned(),
        };
        let materials: Vec<&str> = self.materials.iter().map(|(name, _)| name.as_str()).collect();
        let shape = self.shape.text.clone();
        vec![self.name.clone(), shape, size, materials.join(", "), self.about.clone()]
    }

    /// "diameter 6 mm, tip_radius 0.5 mm"
    fn size(&self, cutters: &Cutters, dimensions: &[(&'static str, f64)]) -> String {
        let specs = cutters.find(&self.shape.text).map_or(&[][..], |shape| shape.dimensions());
        let shown = |(name, value): &(&'static str, f64)| {
            let unit = specs.iter().find(|spec| spec.name == *name).map(|spec| spec.unit.symbol());
            format!("{name} {} {}", short(*value), unit.unwrap_or_default())
        };
        dimensions.iter().map(shown).collect::<Vec<_>>().join(", ")
    }
}

fn dimension(spec: &DimensionSpec) -> Dimension {
    match spec.unit {
        DimensionUnit::Mm => Dimension::Length,
        DimensionUnit::Deg => Dimension::Angle,
    }
}

fn tools(form: &Form, item: Item<'_>, source: &Source, library: &str) -> Option<Vec<Tool>> {
    let mut fields = item.fields(Some("Tools"))?;
    if !file::is_readable(form, &mut fields) {
        return None;
    }
    let entries = fields.required("tools").and_then(Item::entries);
    fields.no_more();
    let read = |(name, item): (Name, Item<'_>)| tool(form, name, item, source, library);
    Some(entries?.into_iter().filter_map(read).collect())
}

fn tool(form: &Form, name: Name, item: Item<'_>, source: &Source, library: &str) -> Option<Tool> {
    file::check_name(form, &name, "a tool");
    let mut fields = item.called(format!("tool {:?}", name.text)).fields(None)?;
    let about = file::text(fields.optional("about"));
    let number = fields.optional("number").and_then(|item| item.integer(NUMBERS));
    let shape = fields.required("shape").and_then(Item::name);
    let dimensions = fields.optional("dimensions").and_then(Item::entries).unwrap_or_default();
    let materials = fields.optional("materials").and_then(Item::entries).unwrap_or_default();
    fields.no_more();
    let material = |(name, item): (Name, Item<'_>)| {
        file::check_name(form, &name, "a material");
        Some((name.text, conditions(item)?))
    };
    Some(Tool {
        name: name.text,
        about,
        number: number.and_then(|number| u32::try_from(number).ok()),
        shape: shape?,
        dimensions: dimensions
            .into_iter()
            .map(|(name, item)| (name, item.value().clone()))
            .collect(),
        materials: materials.into_iter().filter_map(material).collect(),
        library: library.to_owned(),
        version: version(source),
    })
}

fn conditions(item: Item<'_>) -> Option<Conditions> {
    let mut fields = item.fields(None)?;
    let mut speed = |name, dimension, range: RangeInclusive<f64>| {
        fields.optional(name).and_then(|item| item.number(dimension, range))
    };
    let conditions = Conditions {
        feed_mm_per_min: speed("feed", Dimension::Feed, FEEDS_MM_PER_MIN),
        plunge_mm_per_min: speed("plunge", Dimension::Feed, FEEDS_MM_PER_MIN),
        spindle_rpm: speed("spindle", Dimension::Spindle, SPINDLES_RPM),
    };
    fields.no_more();
    Some(conditions)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use carvegraph_sdk::{CutterError, Profile};

    /// As the standard ball and cone, of which this crate knows nothing.
    pub(crate) struct Shape(pub(crate) &'static str, pub(crate) &'static [DimensionSpec]);

    impl CutterShape for Shape {
        fn name(&self) -> &str {
            self.0
        }

        fn about(&self) -> &str {
            "For tests"
        }

        fn dimensions(&self) -> &[DimensionSpec] {
            self.1
        }

        fn profile(&self, dimensions: &Dimensions<'_>) -> Result<Profile, CutterError> {
            Ok(Profile::ball(dimensions.get("diameter")? / 2.0)?)
        }
    }

    const ANGLE: DimensionSpec = DimensionSpec {
        name: "angle",
        unit: DimensionUnit::Deg,
        default: 60.0,
        min: 5.0,
        max: 170.0,
        ..DimensionSpec::DIAMETER
    };

    pub(crate) fn cutters() -> Cutters {
        Cutters(vec![
            Box::new(Shape("ball", &[DimensionSpec::DIAMETER])),
            Box::new(Shape("cone", &[DimensionSpec::DIAMETER, ANGLE])),
        ])
    }

    pub(crate) const LIBRARY: &str = r#"Tools(format: 1, tools: {
        "ball_3": (about: "Small", number: 7, shape: "ball", dimensions: {"diameter": "3mm"},
            materials: {
                "walnut": (feed: "900mm/min", plunge: 300, spindle: 20000),
                "wax": (feed: 2000),
            }),
        "cone_12": (shape: "cone", dimensions: {"diameter": 12, "angle": "90deg"}),
    })"#;

    pub(crate) fn library(text: &str) -> Result<Tools, Diagnostics> {
        let source = Arc::new(Source::new("shed/mine.ron", text));
        Tools::read(&source).map(|(_, tools)| Tools(tools))
    }

    /// Each fault in a line: place, message, help.
    fn lines(faults: &Diagnostics) -> Vec<String> {
        let line = |fault: &&Diagnostic| {
            let place = fault.span.as_ref().map(ToString::to_string).unwrap_or_default();
            let help = fault.help.as_deref().map(|help| format!("; {help}")).unwrap_or_default();
            format!("{place} {}{help}", fault.message)
        };
        faults.sorted().iter().map(line).collect()
    }

    #[test]
    fn a_library_is_read() {
        let tools = library(LIBRARY).unwrap();
        let ball = tools.find("ball_3").unwrap();
        assert_eq!((ball.number, ball.library.as_str()), (Some(7), "mine"));
        assert_eq!(ball.dimensions(&cutters()).unwrap(), [("diameter", 3.0)]);
        let walnut = Conditions {
            feed_mm_per_min: Some(900.0),
            plunge_mm_per_min: Some(300.0),
            spindle_rpm: Some(20_000.0),
        };
        let wax = Conditions { feed_mm_per_min: Some(2000.0), ..Conditions::default() };
        let materials = vec![("walnut".to_owned(), walnut), ("wax".to_owned(), wax)];
        assert_eq!(ball.sheet(), ToolSheet { tool: "ball_3".into(), number: Some(7), materials });
        assert_eq!(
            tools.rows(&cutters()),
            [
                ["ball_3", "ball", "diameter 3 mm", "walnut, wax", "Small"],
                ["cone_12", "cone", "diameter 12 mm, angle 90 deg", "", ""],
            ]
        );
    }

    #[test]
    fn all_faults_are_told_at_once() {
        let faults = library(
            r#"Tools(format: 1, tools: {
"none": (shape: "ball"),
"a": (shape: 5, number: 0, dimension: {}),
"b": (shape: "ball", materials: {"pine": (feed: "5mm", plung: 3)}),
})"#,
        );
        assert_eq!(
            lines(&faults.err().unwrap()),
            [
                r#"shed/mine.ron:2:1 "none" is no name for a tool: it stands for having none; letters, digits, _ and - do, 64 at most"#,
                "shed/mine.ron:3:14 shape must be a text in double quotes, not a whole number; write \"5\"",
                "shed/mine.ron:3:25 number must be between 1 and 9999, not 0",
                r#"shed/mine.ron:3:28 tool "a" has no field "dimension"; did you mean "dimensions"?"#,
                r#"shed/mine.ron:4:49 feed: "5mm" is a length; a feed is wanted: mm/min, mm/s, cm/min, m/min, in/min, in/s"#,
                r#"shed/mine.ron:4:56 pine has no field "plung"; did you mean "plunge"?"#,
            ]
        );
    }

    #[test]
    fn shapes_and_dimensions_that_are_none_are_shown_in_the_library() {
        let tools = library(
            r#"Tools(format: 1, tools: {
"a": (shape: "bal"),
"b": (shape: "ball", dimensions: {"diamter": 3}),
"c": (shape: "cone", dimensions: {"diameter": "500mm", "angle": "3mm"}),
"d": (shape: "cone"),
})"#,
        );
        assert_eq!(
            lines(&tools.unwrap().faults(&cutters())),
            [
                r#"shed/mine.ron:2:14 tool "a": there is no cutter shape "bal"; did you mean "ball"?"#,
                r#"shed/mine.ron:3:35 tool "b": a ball has no "diamter"; did you mean "diameter"?"#,
                r#"shed/mine.ron:4:47 tool "c": diameter must be between 0.01 and 200 mm, not 500"#,
                r#"shed/mine.ron:4:65 tool "c": angle: "3mm" is a length; an angle is wanted: deg, rad"#,
            ]
        );
    }

    #[test]
    fn the_built_in_library_is_read() {
        let tools = Tools::built_in();
        assert!(tools.0.len() > 3 && tools.0.iter().all(|tool| tool.library == "hobby"));
        assert!(tools.find("ball_6").is_some() && tools.find(NONE).is_none());
        for tool in &tools.0 {
            assert!(tool.number.is_some() && !tool.about.is_empty(), "{}", tool.name);
            for (material, conditions) in &tool.materials {
                let Conditions { feed_mm_per_min, plunge_mm_per_min, spindle_rpm } = conditions;
                let slower = plunge_mm_per_min.unwrap() < feed_mm_per_min.unwrap();
                assert!(slower && spindle_rpm.is_some(), "{} in {material}", tool.name);
            }
        }
    }
}
