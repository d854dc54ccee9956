//! The recipes that are part of the program.

use carvegraph_core::Library;

/// The standard recipes, sorted by name, and the samples that they carve where nothing else is said.
pub const LIBRARY: Library = Library {
    recipes: &[
        ("bas_relief", include_str!("../../graphs/bas_relief.ron")),
        ("depth_map", include_str!("../../graphs/depth_map.ron")),
        ("drawing", include_str!("../../graphs/drawing.ron")),
        ("inspection", include_str!("../../graphs/inspection.ron")),
        ("lithophane", include_str!("../../graphs/lithophane.ron")),
        ("mesh_finish", include_str!("../../graphs/mesh_finish.ron")),
        ("patterns", include_str!("../../graphs/patterns.ron")),
        ("photo", include_str!("../../graphs/photo.ron")),
        ("plaque", include_str!("../../graphs/plaque.ron")),
        ("points_finish", include_str!("../../graphs/points_finish.ron")),
        ("portrait", include_str!("../../graphs/portrait.ron")),
        ("portrait_masks", include_str!("../../graphs/portrait_masks.ron")),
        ("relief", include_str!("../../graphs/relief.ron")),
        ("rest_finish", include_str!("../../graphs/rest_finish.ron")),
        ("scallop", include_str!("../../graphs/scallop.ron")),
        ("text_plaque", include_str!("../../graphs/text_plaque.ron")),
        ("two_tool_mesh", include_str!("../../graphs/two_tool_mesh.ron")),
        ("two_tool_relief", include_str!("../../graphs/two_tool_relief.ron")),
        ("verify", include_str!("../../graphs/verify.ron")),
        ("waterline", include_str!("../../graphs/waterline.ron")),
    ],
    assets: &[
        ("samples/compass.svg", include_bytes!("../../graphs/samples/compass.svg")),
        ("samples/medallion.png", include_bytes!("../../graphs/samples/medallion.png")),
        ("samples/portrait-facial.png", include_bytes!("../../graphs/samples/portrait-facial.png")),
        ("samples/portrait-hair.png", include_bytes!("../../graphs/samples/portrait-hair.png")),
        ("samples/portrait-mask.png", include_bytes!("../../graphs/samples/portrait-mask.png")),
        ("samples/portrait.png", include_bytes!("../../graphs/samples/portrait.png")),
        ("samples/shell.nc", include_bytes!("../../graphs/samples/shell.nc")),
        ("samples/shell.obj", include_bytes!("../../graphs/samples/shell.obj")),
        ("samples/shell.xyz", include_bytes!("../../graphs/samples/shell.xyz")),
        ("samples/sun_mask.png", include_bytes!("../../graphs/samples/sun_mask.png")),
    ],
};
