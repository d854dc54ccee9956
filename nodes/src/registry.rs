//! The one list of nodes, the one list of what passes between them, and the catalogs they use.

use crate::offers::Offers;
use crate::shop::{Machine, NONE, Setup, Tool, ToolSheet};
use crate::values::{Gcode, GrayImage, Image, Remark, Samples};
use crate::{output, path, picture, surface};
use carvegraph_core::units::Dimension;
use carvegraph_core::{
    CatalogEntry, Catalogs, Facts, NodeKind, ParamKind, ParamSpec, ParamValue, PortType, Registry,
    RegistryError,
};
use carvegraph_geometry::{
    Bounds, Cutter, HeightField, Mesh, Pattern, PointCloud, Reduction, SpanKind, Toolpath,
};
use carvegraph_sdk::{CutterShape, Dialect, DimensionSpec, DimensionUnit};
use serde_json::{Value as Json, json};
use std::mem::size_of;

/// The cutter shapes that the program knows.
pub struct Cutters(pub Vec<Box<dyn CutterShape>>);

/// The dialects that the program knows.
pub struct Dialects(pub Vec<Box<dyn Dialect>>);

impl Cutters {
    /// The shape called `name`.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&dyn CutterShape> {
        self.0.iter().find(|shape| shape.name() == name).map(AsRef::as_ref)
    }
}

impl Dialects {
    /// The dialect called `name`.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&dyn Dialect> {
        self.0.iter().find(|dialect| dialect.name() == name).map(AsRef::as_ref)
    }
}

/// The standard nodes, and all that is offered beside them.
///
/// # Errors
/// If something that is offered does not describe itself soundly, or the lists below are not in order,
/// which is a fault in this file.
pub fn registry(offers: Offers) -> Result<Registry, RegistryError> {
    let shapes = offers.cutters.0.iter().map(|shape| cutter_entry(&**shape, &offers));
    let shapes: Vec<CatalogEntry> = shapes.collect();
    let spoken = offers.dialects.0.iter().map(|dialect| dialect_entry(&**dialect, &offers));
    let spoken: Vec<CatalogEntry> = spoken.collect();
    let Offers { cutters, dialects, machines, tools, nodes, missing, .. } = offers;
    let catalogs = Catalogs::default();
    let catalogs = catalogs.with("cutter", shapes, cutters).with("dialect", spoken, dialects);
    let entries = machines.0.iter().map(|machine| machine_entry(machine, &catalogs));
    let entries: Vec<_> = entries.chain([nothing()]).collect();
    let catalogs = catalogs.with("machine", entries, machines);
    let entries = tools.0.iter().map(|tool| tool_entry(tool, &catalogs));
    let entries: Vec<_> = entries.chain([nothing()]).collect();
    let catalogs = catalogs.with("tool", entries, tools);
    let registry = Registry::new(merged(kinds(), nodes), types(), catalogs)?;
    Ok(missing.into_iter().fold(registry, |registry, (sort, missing)| match sort {
        "node" => registry.with_missing_kinds([missing]),
        catalog => registry.with_missing_entries(catalog, [missing]),
    }))
}

/// The entry that stands for choosing none.
fn nothing() -> CatalogEntry {
    CatalogEntry::new(NONE, "")
}

/// A machine. It may decide the dialect, so that its version is that of both.
fn machine_entry(machine: &Machine, catalogs: &Catalogs) -> CatalogEntry {
    let dialect = machine.dialect.as_deref().and_then(|name| catalogs.entry("dialect", name));
    CatalogEntry::new(machine.name.as_str(), both(&machine.version, dialect))
}

/// A tool. It may decide the shape, so that its version is that of both.
fn tool_entry(tool: &Tool, catalogs: &Catalogs) -> CatalogEntry {
    let shape = catalogs.entry("cutter", &tool.shape.text);
    CatalogEntry::new(tool.name.as_str(), both(&tool.version, shape))
}

fn both(version: &str, decided: Option<&CatalogEntry>) -> String {
    let decided = decided.map(|entry| entry.version.as_str());
    [Some(version), decided].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Adds `extra` to a list that is in order. Each goes to its place; the list is not sorted anew, or
/// a slip in its order would go unseen.
fn merged(mut kinds: Vec<NodeKind>, extra: Vec<NodeKind>) -> Vec<NodeKind> {
    for kind in extra {
        let place = kinds.partition_point(|known| known.name <= kind.name);
        kinds.insert(place, kind);
    }
    kinds
}

/// A shape, and its dimensions and drawing as parameters of the node that chooses it.
fn cutter_entry(shape: &dyn CutterShape, offers: &Offers) -> CatalogEntry {
    let dimensions = shape.dimensions().iter().map(dimension_param);
    let params = dimensions.chain(shape.drawing().map(drawing_param)).collect();
    let version = offers.origin("cutter", shape.name());
    CatalogEntry { params, ..CatalogEntry::new(shape.name(), version) }
}

fn dialect_entry(dialect: &dyn Dialect, offers: &Offers) -> CatalogEntry {
    CatalogEntry::new(dialect.name(), offers.origin("dialect", dialect.name()))
}

fn dimension_param(spec: &DimensionSpec) -> ParamSpec {
    let dimension = match spec.unit {
        DimensionUnit::Mm => Dimension::Length,
        DimensionUnit::Deg => Dimension::Angle,
    };
    ParamSpec {
        name: spec.name,
        about: sentence(spec.about).into(),
        kind: ParamKind::Number { dimension, min: spec.min, max: spec.max },
        default: Some(ParamValue::Number(spec.default)),
        // To a tool of a library.
        yields: true,
    }
}

fn drawing_param(about: &str) -> ParamSpec {
    let (name, about) = (path::DRAWING, sentence(about).into());
    ParamSpec { name, about, kind: ParamKind::InputFile, default: None, yields: false }
}

/// A line with the full stop that parameters are described with.
fn sentence(line: &str) -> String {
    if line.ends_with('.') { line.to_owned() } else { format!("{line}.") }
}

/// Every node, sorted by name.
pub(crate) fn kinds() -> Vec<NodeKind> {
    vec![
        NodeKind::of::<path::CutterNode>("path"),
        NodeKind::of::<path::DropCutter>("path"),
        NodeKind::of::<picture::GaussianBlur>("picture"),
        NodeKind::of::<picture::Grayscale>("picture"),
        NodeKind::of::<path::Link>("path"),
        NodeKind::of::<picture::LoadImage>("picture"),
        NodeKind::of::<surface::PointCloudNode>("surface"),
        NodeKind::of::<output::Post>("output"),
        NodeKind::of::<output::Preview>("output"),
        NodeKind::of::<path::RasterNode>("path"),
        NodeKind::of::<path::ReduceCl>("path"),
        NodeKind::of::<output::SaveGcode>("output"),
        NodeKind::of::<output::SavePoints>("output"),
        NodeKind::of::<output::SaveStl>("output"),
        NodeKind::of::<path::SetupNode>("path"),
        NodeKind::of::<surface::Stitch>("surface"),
        NodeKind::of::<output::Summary>("output"),
        NodeKind::of::<surface::ZMap>("surface"),
    ]
}

/// Every type that passes between nodes: its facts and about how many bytes one takes.
fn types() -> Vec<PortType> {
    vec![
        PortType::of("bounds", "The box that holds a part", bounds_facts, |_: &Bounds| {
            size_of::<Bounds>()
        }),
        PortType::of("cutter", "A cutter's shape and size", cutter_facts, |cutter: &Cutter| {
            cutter.profile.segments().len() * 48
        }),
        PortType::of("gcode", "A machine program", gcode_facts, |code: &Gcode| code.text.len()),
        PortType::of("gray_image", "A gray picture", gray_facts, |image: &GrayImage| {
            image.values.len() * 4
        }),
        PortType::of(
            "height_field",
            "A surface with one height above each node of a grid",
            field_facts,
            |field: &HeightField| field.heights().len() * 4,
        ),
        PortType::of("image", "A picture as it was loaded", image_facts, image_bytes),
        PortType::of("mesh", "A surface of triangles", mesh_facts, |mesh: &Mesh| {
            mesh.vertices.len() * 24 + mesh.triangles.len() * 12
        }),
        PortType::of(
            "pattern",
            "Lines over the plane, along which a cutter is to be dropped",
            pattern_facts,
            |pattern: &Pattern| pattern.points.len() * 16,
        ),
        PortType::of("point_cloud", "Points in space", cloud_facts, |cloud: &PointCloud| {
            cloud.points.len() * 24
        }),
        PortType::of(
            "reduction",
            "What taking points out of a path did to it",
            reduction_facts,
            |_: &Reduction| size_of::<Reduction>(),
        ),
        PortType::of(
            "remark",
            "A choice that a node made by itself",
            remark_facts,
            |r: &Remark| r.text.len(),
        ),
        PortType::of(
            "setup",
            "The machine, the tool and the material of a job",
            setup_facts,
            |_: &Setup| size_of::<Setup>(),
        ),
        PortType::of(
            "tool_sheet",
            "A tool's number, and its speeds in materials",
            sheet_facts,
            |sheet: &ToolSheet| sheet.materials.len() * 72,
        ),
        PortType::of("toolpath", "A path of the cutter's tip", path_facts, |path: &Toolpath| {
            path.tips.len() * (24 + 32) + path.spans.len() * 24
        }),
    ]
}

fn facts<const N: usize>(facts: [(&'static str, Json); N]) -> Facts {
    facts.into_iter().collect()
}

fn bounds_facts(bounds: &Bounds) -> Facts {
    let corner = |corner: carvegraph_geometry::DVec3| json!([corner.x, corner.y, corner.z]);
    facts([("min_mm", corner(bounds.min)), ("max_mm", corner(bounds.max))])
}

fn cutter_facts(cutter: &Cutter) -> Facts {
    facts([("shape", json!(cutter.name)), ("diameter_mm", json!(2.0 * cutter.profile.radius_mm()))])
}

fn gcode_facts(code: &Gcode) -> Facts {
    facts([
        ("lines", json!(code.lines())),
        ("bytes", json!(code.text.len())),
        ("dialect", json!(code.dialect)),
    ])
}

fn picture_facts(width: usize, height: usize, channels: usize, bits: u32) -> Facts {
    facts([
        ("width", json!(width)),
        ("height", json!(height)),
        ("channels", json!(channels)),
        ("bits", json!(bits)),
    ])
}

fn gray_facts(image: &GrayImage) -> Facts {
    picture_facts(image.width, image.height, 1, 32)
}

fn image_facts(image: &Image) -> Facts {
    picture_facts(image.width, image.height, image.channels.count(), image.bits())
}

fn image_bytes(image: &Image) -> usize {
    match &image.samples {
        Samples::U8(samples) => samples.len(),
        Samples::U16(samples) => samples.len() * 2,
        Samples::F32(samples) => samples.len() * 4,
    }
}

fn field_facts(field: &HeightField) -> Facts {
    let bounds = field.bounds();
    let size = bounds.size();
    facts([
        ("columns", json!(field.columns())),
        ("rows", json!(field.rows())),
        ("pitch_mm", json!(field.pitch_mm())),
        ("width_mm", json!(size.x)),
        ("height_mm", json!(size.y)),
        ("z_min", json!(bounds.min.z)),
        ("z_max", json!(bounds.max.z)),
    ])
}

fn mesh_facts(mesh: &Mesh) -> Facts {
    facts([("vertices", json!(mesh.vertices.len())), ("triangles", json!(mesh.triangles.len()))])
}

fn pattern_facts(pattern: &Pattern) -> Facts {
    let passes = pattern.spans.iter().filter(|span| !span.link);
    let points: usize = passes.clone().map(|span| span.points.len()).sum();
    facts([("points", json!(points)), ("passes", json!(passes.count()))])
}

fn cloud_facts(cloud: &PointCloud) -> Facts {
    facts([("points", json!(cloud.points.len()))])
}

fn reduction_facts(reduction: &Reduction) -> Facts {
    facts([
        ("points_in", json!(reduction.points_in)),
        ("points_out", json!(reduction.points_out)),
        ("max_deviation_mm", json!(reduction.max_deviation_mm)),
        ("max_above_mm", json!(reduction.max_above_mm)),
        ("max_below_mm", json!(reduction.max_below_mm)),
    ])
}

fn remark_facts(remark: &Remark) -> Facts {
    facts([("text", json!(remark.text))])
}

fn setup_facts(setup: &Setup) -> Facts {
    facts([
        ("machine", json!(setup.machine.name)),
        ("tool", json!(setup.tool)),
        ("material", json!(setup.material)),
    ])
}

fn sheet_facts(sheet: &ToolSheet) -> Facts {
    let materials: Vec<&str> = sheet.materials.iter().map(|(name, _)| name.as_str()).collect();
    facts([("tool", json!(sheet.tool)), ("materials", json!(materials))])
}

fn path_facts(path: &Toolpath) -> Facts {
    facts([
        ("cl_points", json!(path.cl_points())),
        ("passes", json!(path.passes())),
        ("feed_length_mm", json!(path.length_mm(|kind| kind != SpanKind::Rapid))),
        ("rapid_length_mm", json!(path.length_mm(|kind| kind == SpanKind::Rapid))),
        ("time_s", json!(path.time_at_full_speed_s())),
    ])
}
