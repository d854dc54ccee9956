//! Files as people have them. They lie outside of the repository (`../shared/data`, or where
//! `CARVE_DATA` says); where one is missing, the tests say so and pass.

use super::*;
use carvegraph_geometry::{Bounds, Mesh, find_defects};
use rayon::prelude::*;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn file(name: &str) -> Option<Vec<u8>> {
    let data = std::env::var_os("CARVE_DATA").map(PathBuf::from);
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let path = data.unwrap_or(beside).join(name);
    let bytes = std::fs::read(&path).ok();
    if bytes.is_none() {
        let line = format!(
            "SKIPPED: no {}, it was not read (CARVE_DATA names its folder)\n",
            path.display()
        );
        std::io::stderr().write_all(line.as_bytes()).unwrap();
    }
    bytes
}

fn size(points: &[DVec3]) -> DVec3 {
    Bounds::of(points.par_iter().copied()).unwrap().size()
}

#[test]
fn stl_reliefs_have_the_defects_they_are_known_for() {
    for (name, triangles, open, non_manifold, duplicates) in
        [("mount_rush.stl", 15_592, 862, 1645, 407), ("spider.stl", 15_540, 108, 0, 0)]
    {
        let Some(bytes) = file(name) else { continue };
        let read = mesh(&bytes).unwrap();
        assert_eq!((read.format, read.triangles.len()), ("binary STL", triangles));
        let mesh = Mesh { vertices: Arc::new(read.vertices), triangles: read.triangles };
        let defects = find_defects(&mesh, &|_| true).unwrap();
        let found = (defects.open_edges, defects.non_manifold_edges, defects.duplicate_triangles);
        assert_eq!(found, (open, non_manifold, duplicates), "{name}: {defects:?}");
        assert_eq!(defects.repeated_vertices, 0, "{name}");
    }
}

#[test]
fn a_bust_of_strips_is_a_mesh_and_a_cloud() {
    let Some(bytes) = file("igea.ply") else { return };
    let read = mesh(&bytes).unwrap();
    assert_eq!((read.format, read.vertices.len()), ("binary PLY", 134_345));
    // A closed surface of genus 0 has twice as many triangles as vertices, less four.
    assert_eq!(read.triangles.len(), 2 * 134_345 - 4);
    let mesh = Mesh { vertices: Arc::new(read.vertices), triangles: read.triangles };
    let defects = find_defects(&mesh, &|_| true).unwrap();
    assert!(defects.is_none(), "{defects:?}");
    assert_eq!(points(&bytes).unwrap().points, *mesh.vertices);
}

#[test]
fn scans_are_read_whole() {
    if let Some(bytes) = file("face-scan.xyz") {
        let read = points(&bytes).unwrap();
        assert_eq!((read.points.len(), read.missed), (26_493, 0));
        assert!((size(&read.points) - DVec3::new(89.4, 129.1, 59.4)).abs().max_element() < 0.06);
    }
    if let Some(bytes) = file("terrain-scan.pcd") {
        let read = points(&bytes).unwrap();
        assert_eq!((read.points.len(), read.missed), (345_966, 0));
        assert!(
            (size(&read.points) - DVec3::new(1100.97, 1103.0, 646.55)).abs().max_element() < 0.01
        );
    }
}

#[test]
fn a_real_file_cut_short_is_never_taken_for_whole() {
    for name in ["mount_rush.stl", "igea.ply", "terrain-scan.pcd"] {
        let Some(bytes) = file(name) else { continue };
        for part in 1..40 {
            let cut = &bytes[..bytes.len() * part / 40];
            assert!(mesh(cut).is_err() && (points(cut).is_err() || name == "igea.ply"), "{name}");
        }
    }
}
