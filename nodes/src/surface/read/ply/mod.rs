//! PLY (Turk, *The PLY Polygon File Format*, 1994): ASCII and binary of both byte orders.
//!
//! Read are the `vertex` element's x, y and z, of any type; `face` lists, of any number of corners;
//! `tristrips` lists, in which a negative index ends a strip. Whatever else the header declares is
//! passed over by its declared sizes.
//!
//! The crate for it, `ply-rs`, keeps each record as a map from names to values and knows no
//! strips of triangles; so this is our own.

mod header;
mod source;

use self::header::{Element, Header, Property};
use self::source::Source;
use super::polygon::{MAX_CORNERS, triangulate};
use super::{BATCH, MAX_POINTS, MAX_TRIANGLES, ReadError, ReadMesh, ReadPoints, go_on, limited};
use carvegraph_geometry::{DVec3, Tick};

pub(super) use self::header::is_ply;

/// Names by which files call the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads the vertices as points.
pub(super) fn read_points(bytes: &[u8], tick: Tick<'_>) -> Result<ReadPoints, ReadError> {
    let header = header::read(bytes)?;
    let mut source = Source::new(&header, bytes);
    let mut read = ReadPoints { format: header.format(), ..ReadPoints::default() };
    for element in &header.elements {
        if element.name == "vertex" {
            read_vertices(&mut source, element, tick, |vertex, _| {
                read.push(vertex);
                Ok(())
            })?;
            return Ok(read);
        }
        pass_over(&mut source, element, tick)?;
    }
    Err(source.fault("no element is called vertex"))
}

/// Reads vertices and faces.
pub(super) fn read_mesh(bytes: &[u8], tick: Tick<'_>) -> Result<ReadMesh, ReadError> {
    let header = header::read(bytes)?;
    let mut source = Source::new(&header, bytes);
    let mut mesh = ReadMesh { format: header.format(), ..ReadMesh::default() };
    if !header.elements.iter().any(|element| list_of_corners(element).is_some()) {
        let what = "no element lists faces: these are points, which load_points reads";
        return Err(source.fault(what));
    }
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut source, element, tick, |vertex, index| {
                if !vertex.is_finite() {
                    return Err(format!(
                        "a coordinate of vertex {index} (from 0) is no finite number"
                    ));
                }
                mesh.vertices.push(vertex);
                Ok(())
            })?,
            _ => match list_of_corners(element) {
                Some(list) => read_faces(&mut source, element, list, &mut mesh, tick)?,
                None => pass_over(&mut source, element, tick)?,
            },
        }
    }
    Ok(mesh)
}

/// Which property of an element lists corners of faces or strips.
fn list_of_corners(element: &Element) -> Option<usize> {
    let is_list = |property: &Property| {
        property.counted_by.is_some() && CORNERS.contains(&property.name.as_str())
    };
    matches!(element.name.as_str(), "face" | "tristrips")
        .then(|| element.properties.iter().position(is_list))
        .flatten()
}

fn read_vertices(
    source: &mut Source<'_>,
    element: &Element,
    tick: Tick<'_>,
    mut take: impl FnMut(DVec3, usize) -> Result<(), String>,
) -> Result<(), ReadError> {
    limited("vertices", element.count as u64, MAX_POINTS)?;
    let place = |name: &str| {
        let is_it = |property: &Property| property.counted_by.is_none() && property.name == name;
        element.properties.iter().position(is_it)
    };
    let (Some(x), Some(y), Some(z)) = (place("x"), place("y"), place("z")) else {
        return Err(source.fault("the vertices have no properties x, y and z"));
    };
    let mut values = vec![0.0; element.properties.len()];
    each_record(source, element, tick, |source, index| {
        for (value, property) in values.iter_mut().zip(&element.properties) {
            match property.counted_by {
                None => *value = source.value(property.of)?,
                Some(counted_by) => source.pass_list(counted_by, property.of)?,
            }
        }
        let vertex = DVec3::new(values[x], values[y], values[z]);
        take(vertex, index).map_err(|what| source.fault(what))
    })
}

fn read_faces(
    source: &mut Source<'_>,
    element: &Element,
    list: usize,
    mesh: &mut ReadMesh,
    tick: Tick<'_>,
) -> Result<(), ReadError> {
    let is_strip = element.name == "tristrips";
    let (mut given, mut corners) = (Vec::new(), Vec::new());
    each_record(source, element, tick, |source, _| {
        for (place, property) in element.properties.iter().enumerate() {
            match property.counted_by {
                Some(counted_by) if place == list => {
                    source.list(counted_by, property.of, &mut given)?;
                }
                Some(counted_by) => source.pass_list(counted_by, property.of)?,
                None => _ = source.value(property.of)?,
            }
        }
        if is_strip {
            return add_strips(&given, mesh).map_err(|what| source.fault(what));
        }
        corners.clear();
        for &index in &given {
            corners.push(vertex_index(index, mesh).map_err(|what| source.fault(what))?);
        }
        triangulate(&corners, &mesh.vertices, &mut mesh.triangles).map_err(|_| {
            let count = corners.len();
            source.fault(format!(
                "a concave face has {count} corners; the limit is {MAX_CORNERS}: split it"
            ))
        })?;
        limited("triangles", mesh.triangles.len() as u64, MAX_TRIANGLES)
    })?;
    limited("triangles", mesh.triangles.len() as u64, MAX_TRIANGLES)
}

fn vertex_index(index: f64, mesh: &ReadMesh) -> Result<u32, String> {
    let count = mesh.vertices.len();
    match index {
        _ if index >= 0.0 && index < count as f64 && index.fract() == 0.0 => Ok(index as u32),
        _ => Err(format!("a face names vertex {index} (from 0); {count} vertices stand before it")),
    }
}

/// Triangle i of a strip has the corners i, i + 1, i + 2, every second one the other way round. What
/// has two corners in one vertex only leads on and is no triangle.
fn add_strips(given: &[f64], mesh: &mut ReadMesh) -> Result<(), String> {
    for strip in given.split(|index| *index < 0.0) {
        let mut last = [0; 2];
        for (place, &index) in strip.iter().enumerate() {
            let [a, b, c] = [last[0], last[1], vertex_index(index, mesh)?];
            if place >= 2 && a != b && b != c && c != a {
                mesh.triangles.push(if place % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
            last = [b, c];
        }
        limited("triangles", mesh.triangles.len() as u64, MAX_TRIANGLES)
            .map_err(|fault| fault.to_string())?;
    }
    Ok(())
}

fn pass_over(source: &mut Source<'_>, element: &Element, tick: Tick<'_>) -> Result<(), ReadError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    each_record(source, element, tick, |source, _| {
        element.properties.iter().try_for_each(|property| match property.counted_by {
            None => source.value(property.of).map(drop),
            Some(counted_by) => source.pass_list(counted_by, property.of),
        })
    })
}

/// Calls `read` for each record of an element that the file is long enough to hold.
fn each_record(
    source: &mut Source<'_>,
    element: &Element,
    tick: Tick<'_>,
    mut read: impl FnMut(&mut Source<'_>, usize) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    source.must_hold(element)?;
    let mut told = source.at();
    for index in 0..element.count {
        read(source, index)?;
        if index % BATCH == BATCH - 1 {
            go_on(tick, source.at() - told)?;
            told = source.at();
        }
    }
    go_on(tick, source.at() - told)
}

/// The header of a file.
impl Header {
    fn format(&self) -> &'static str {
        match self.encoding {
            header::Encoding::Ascii => "ASCII PLY",
            header::Encoding::Little | header::Encoding::Big => "binary PLY",
        }
    }
}
