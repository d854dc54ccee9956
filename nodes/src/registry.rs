//! The one list of nodes, and the one list of what passes between them.

use crate::check::{Estimate, RunTimes, Simulated, Verification};
use crate::job::{Job, Operation, described};
use crate::machining::Machining;
use crate::shop::{Setup, ToolSheet};
use crate::values::{Gcode, GrayImage, Image, Mask, Remark, Samples};
use crate::{check, mask, output, path, picture, relief, surface};
use carvegraph_core::{Facts, NodeKind, PortType};
use carvegraph_geometry::{
    Bounds, Cutter, Defects, Deviation, HeightField, Load, Mesh, Move, Pattern, PointCloud,
    Polygon, Reduction, SpanKind, Toolpath,
};
use serde_json::{Value as Json, json};
use std::mem::size_of;

/// Every node, sorted by name.
pub(crate) fn kinds() -> Vec<NodeKind> {
    vec![
        NodeKind::of::<relief::BasReliefNode>("relief"),
        NodeKind::of::<surface::BezierSurface>("surface"),
        NodeKind::of::<picture::BilateralFilter>("picture"),
        NodeKind::of::<relief::Border>("relief"),
        NodeKind::of::<path::CirclesNode>("path"),
        NodeKind::of::<picture::Clahe>("picture"),
        NodeKind::of::<relief::ClampField>("relief"),
        NodeKind::of::<mask::ColorMask>("mask"),
        NodeKind::of::<relief::CombineFields>("relief"),
        NodeKind::of::<mask::CombineMasks>("mask"),
        NodeKind::of::<path::ContourParallelNode>("path"),
        NodeKind::of::<surface::CropField>("surface"),
        NodeKind::of::<picture::CropImage>("picture"),
        NodeKind::of::<surface::CropMesh>("surface"),
        NodeKind::of::<surface::CropPoints>("surface"),
        NodeKind::of::<path::CrossRasterNode>("path"),
        NodeKind::of::<picture::Curves>("picture"),
        NodeKind::of::<path::CutterNode>("path"),
        NodeKind::of::<picture::DepthSmooth>("picture"),
        NodeKind::of::<check::DeviationNode>("check"),
        NodeKind::of::<check::DeviationMap>("check"),
        NodeKind::of::<relief::Dome>("relief"),
        NodeKind::of::<path::DropCutter>("path"),
        NodeKind::of::<path::DropOnMesh>("path"),
        NodeKind::of::<path::DropOnPoints>("path"),
        NodeKind::of::<picture::EdgeEmphasis>("picture"),
        NodeKind::of::<check::EstimateTime>("check"),
        NodeKind::of::<mask::FeatherMask>("mask"),
        NodeKind::of::<picture::FlipImage>("picture"),
        NodeKind::of::<picture::GaussianBlur>("picture"),
        NodeKind::of::<picture::Grayscale>("picture"),
        NodeKind::of::<mask::GrowMask>("mask"),
        NodeKind::of::<path::HilbertNode>("path"),
        NodeKind::of::<surface::InspectMesh>("surface"),
        NodeKind::of::<picture::Invert>("picture"),
        NodeKind::of::<picture::Levels>("picture"),
        NodeKind::of::<relief::LimitSlope>("relief"),
        NodeKind::of::<path::Link>("path"),
        NodeKind::of::<check::LoadGcode>("check"),
        NodeKind::of::<picture::LoadImage>("picture"),
        NodeKind::of::<mask::LoadMask>("mask"),
        NodeKind::of::<surface::LoadMesh>("surface"),
        NodeKind::of::<surface::LoadPoints>("surface"),
        NodeKind::of::<mask::MaskLift>("mask"),
        NodeKind::of::<picture::MedianBlur>("picture"),
        NodeKind::of::<surface::MeshToField>("surface"),
        NodeKind::of::<path::OffsetPolygon>("path"),
        NodeKind::of::<output::OperationNode>("output"),
        NodeKind::of::<relief::Plate>("relief"),
        NodeKind::of::<surface::PointCloudNode>("surface"),
        NodeKind::of::<path::PolygonNode>("path"),
        NodeKind::of::<mask::PolygonMask>("mask"),
        NodeKind::of::<surface::PortraitMap>("surface"),
        NodeKind::of::<output::Post>("output"),
        NodeKind::of::<output::Preview>("output"),
        NodeKind::of::<path::RadialNode>("path"),
        NodeKind::of::<path::RasterNode>("path"),
        NodeKind::of::<check::ReadGcode>("check"),
        NodeKind::of::<path::ReduceCl>("path"),
        NodeKind::of::<picture::ResizeImage>("picture"),
        NodeKind::of::<path::RestAreaNode>("path"),
        NodeKind::of::<picture::RotateImage>("picture"),
        NodeKind::of::<path::Roughing>("path"),
        NodeKind::of::<output::Save3mf>("output"),
        NodeKind::of::<output::SaveGcode>("output"),
        NodeKind::of::<mask::SaveMask>("mask"),
        NodeKind::of::<output::SavePoints>("output"),
        NodeKind::of::<output::SaveStl>("output"),
        NodeKind::of::<relief::ScaleField>("relief"),
        NodeKind::of::<path::ScallopPasses>("path"),
        NodeKind::of::<check::ScallopPlot>("check"),
        NodeKind::of::<path::SetupNode>("path"),
        NodeKind::of::<mask::ShapeMask>("mask"),
        NodeKind::of::<check::Simulate>("check"),
        NodeKind::of::<path::SpiralNode>("path"),
        NodeKind::of::<relief::Stamp>("relief"),
        NodeKind::of::<surface::Stitch>("surface"),
        NodeKind::of::<output::Summary>("output"),
        NodeKind::of::<mask::SvgMask>("mask"),
        NodeKind::of::<mask::TextMask>("mask"),
        NodeKind::of::<relief::TileField>("relief"),
        NodeKind::of::<mask::TraceMask>("mask"),
        NodeKind::of::<surface::TransformMesh>("surface"),
        NodeKind::of::<surface::TransformPoints>("surface"),
        NodeKind::of::<check::Verify>("check"),
        NodeKind::of::<picture::Vignette>("picture"),
        NodeKind::of::<path::WaterlineNode>("path"),
        NodeKind::of::<surface::ZMap>("surface"),
    ]
}

/// Every type that passes between nodes: its facts and about how many bytes one takes.
pub(crate) fn types() -> Vec<PortType> {
    vec![
        PortType::of("bounds", "The box that holds a part", bounds_facts, |_: &Bounds| {
            size_of::<Bounds>()
        }),
        PortType::of("cutter", "A cutter's shape and size", cutter_facts, |cutter: &Cutter| {
            cutter.profile.segments().len() * 48
        }),
        PortType::of("defects", "What is wrong with a mesh", defects_facts, |_: &Defects| {
            size_of::<Defects>()
        }),
        PortType::of(
            "deviation",
            "How far a machined surface is from the one that was meant",
            deviation_facts,
            |deviation: &Deviation| deviation.distances_mm.len() * 4,
        ),
        PortType::of(
            "estimate",
            "How long a job takes on a machine",
            Estimate::facts,
            |estimate: &Estimate| estimate.runs.len() * size_of::<RunTimes>(),
        ),
        PortType::of("gcode", "A machine program", gcode_facts, |code: &Gcode| code.bytes()),
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
        PortType::of("job", "Operations in the order in which they are cut", job_facts, job_bytes),
        PortType::of(
            "machining",
            "What a machine does when it runs a program",
            machining_facts,
            machining_bytes,
        ),
        PortType::of("mask", "Which pixels of a picture are meant", mask_facts, |mask: &Mask| {
            mask.values.len() * 4
        }),
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
        PortType::of("polygon", "An outline over the plane", polygon_facts, |polygon: &Polygon| {
            polygon.loops().iter().map(|corners| corners.len() * 16).sum()
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
        PortType::of(
            "simulation",
            "What was found by simulating a program",
            simulation_facts,
            |found: &Simulated| found.rapids.len() * 48 + found.loads.len() * 96,
        ),
        PortType::of("toolpath", "A path of the cutter's tip", path_facts, path_bytes),
        PortType::of(
            "verification",
            "What was verified of a program",
            verification_facts,
            |_: &Verification| size_of::<Verification>(),
        ),
    ]
}

fn simulation_facts(found: &Simulated) -> Facts {
    let each = |of: &dyn Fn(&Load) -> Option<f64>| -> Json {
        json!(found.loads.iter().map(of).collect::<Vec<_>>())
    };
    facts([
        ("resolution_mm", json!(found.resolution_mm)),
        ("rapids_through_stock", json!(found.rapids.len())),
        ("step_down_mm", each(&|load| Some(load.step_down?.depth_mm))),
        ("removal_mm3_per_min", each(&|load| Some(load.removal?.mm3_per_min))),
        ("engagement_mm2", each(&|load| Some(load.removal?.section_mm2))),
        ("removed_mm3", each(&|load| Some(load.removed_mm3))),
    ])
}

fn verification_facts(verification: &Verification) -> Facts {
    facts([
        ("passes", json!(verification.faults.is_empty() && !verification.looked_at.is_empty())),
        ("faults", json!(verification.faults)),
        ("looked_at", json!(verification.looked_at)),
        ("departure_mm", json!(verification.departure_mm)),
    ])
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

fn defects_facts(defects: &Defects) -> Facts {
    facts([
        ("open_edges", json!(defects.open_edges)),
        ("non_manifold_edges", json!(defects.non_manifold_edges)),
        ("flipped_edges", json!(defects.flipped_edges)),
        ("duplicate_triangles", json!(defects.duplicate_triangles)),
        ("degenerate_triangles", json!(defects.degenerate_triangles)),
        ("repeated_vertices", json!(defects.repeated_vertices)),
    ])
}

fn deviation_facts(deviation: &Deviation) -> Facts {
    let extent = &deviation.extent;
    facts([
        ("max_gouge_mm", json!(extent.max_gouge_mm)),
        ("max_excess_mm", json!(extent.max_excess_mm)),
        ("p99_excess_mm", json!(extent.p99_excess_mm)),
        ("p99_gouge_mm", json!(extent.p99_gouge_mm)),
        ("mean_mm", json!(extent.mean_mm)),
        ("nodes", json!(extent.nodes)),
        ("gouge_at_mm", json!(extent.gouge_at.to_array())),
        ("excess_at_mm", json!(extent.excess_at.to_array())),
    ])
}

fn gcode_facts(code: &Gcode) -> Facts {
    facts([
        ("lines", json!(code.lines())),
        ("bytes", json!(code.bytes())),
        ("dialect", json!(code.dialect)),
        ("programs", json!(code.programs.len())),
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

fn machining_facts(machining: &Machining) -> Facts {
    let moves = machining.runs.iter().map(|run| run.motion.moves.len());
    facts([
        ("moves", json!(moves.sum::<usize>())),
        ("tools", json!(machining.runs.len())),
        ("faults", json!(machining.faults.len())),
    ])
}

fn machining_bytes(machining: &Machining) -> usize {
    let moves = machining.runs.iter().map(|run| run.motion.moves.len());
    moves.sum::<usize>() * (size_of::<Move>() + size_of::<u32>())
}

fn mask_facts(mask: &Mask) -> Facts {
    facts([
        ("width", json!(mask.width)),
        ("height", json!(mask.height)),
        ("selected_px", json!(mask.selected_px())),
    ])
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

fn job_facts(job: &Job) -> Facts {
    let of = |fact: &dyn Fn(&Operation) -> Json| -> Vec<Json> {
        job.operations.iter().map(|operation| fact(operation)).collect()
    };
    let times = job.operations.iter().map(|operation| operation.toolpath.time_at_full_speed_s());
    facts([
        ("operations", json!(of(&|operation| json!(operation.name)))),
        ("cutters", json!(of(&|operation| json!(described(&operation.cutter))))),
        ("cl_points", json!(of(&|operation| json!(operation.toolpath.cl_points())))),
        ("time_s", json!(times.sum::<Option<f64>>())),
    ])
}

fn job_bytes(job: &Job) -> usize {
    job.operations.iter().map(|operation| path_bytes(&operation.toolpath)).sum()
}

fn path_bytes(path: &Toolpath) -> usize {
    path.tips.len() * (24 + 32) + path.spans.len() * 24 + path.arcs.len() * 40
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

fn polygon_facts(polygon: &Polygon) -> Facts {
    let corners: usize = polygon.loops().iter().map(Vec::len).sum();
    facts([("loops", json!(polygon.loops().len())), ("corners", json!(corners))])
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
