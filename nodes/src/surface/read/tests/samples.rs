//! A tetrahedron, and four points, in every format.

use carvegraph_geometry::DVec3;
use std::io::{Cursor, Write};

pub(super) const VERTICES: [[f32; 3]; 4] =
    [[0., 0., 0.], [4., 0., 0.5], [0., 3.25, 0.], [0., 0., 2.]];
pub(super) const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

pub(super) fn vertices() -> Vec<DVec3> {
    VERTICES.iter().map(|v| DVec3::from_array(v.map(f64::from))).collect()
}

/// The corners of its faces.
pub(super) fn corners() -> Vec<[DVec3; 3]> {
    FACES.iter().map(|face| face.map(|v| vertices()[v as usize])).collect()
}

fn le(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

pub(super) fn binary_stl(head: &str, count: u32) -> Vec<u8> {
    let mut bytes = head.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for face in FACES {
        bytes.extend(le(&[0.0; 3]));
        face.iter().for_each(|v| bytes.extend(le(&VERTICES[*v as usize])));
        bytes.extend([0, 0]);
    }
    bytes
}

pub(super) fn ascii_stl() -> String {
    let mut text = "solid a name of its own\n".to_owned();
    for face in FACES {
        text += "  facet normal nan 0 -1e0\n    outer loop\n";
        for [x, y, z] in face.map(|v| VERTICES[v as usize]) {
            text += &format!("      vertex {x:e} {y} {z}\n");
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid a name of its own\n"
}

fn numbered(begin: &str, lists: &[[u32; 3]], first: u32) -> String {
    let line = |list: &[u32; 3]| {
        let [a, b, c] = list.map(|index| index + first);
        format!("{begin} {a} {b} {c}\n")
    };
    lists.iter().map(line).collect()
}

pub(super) fn obj() -> String {
    let vertices = VERTICES.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    format!("# made by hand\nmtllib none.mtl\no part\n{vertices}{}", numbered("f", &FACES, 1))
}

pub(super) fn ply_head(format: &str, length: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nelement vertex 4\nproperty {length} x\n\
         property {length} y\nproperty {length} z\nproperty uchar red\nelement face 4\n\
         property list uchar int vertex_indices\nend_header\n"
    )
}

pub(super) fn ascii_ply() -> String {
    let vertices = VERTICES.map(|[x, y, z]| format!("{x} {y} {z} 255\n")).concat();
    ply_head("ascii", "float") + &vertices + &numbered("3", &FACES, 0)
}

pub(super) fn binary_ply(is_big: bool) -> Vec<u8> {
    let order = |mut bytes: Vec<u8>| {
        if is_big {
            bytes.reverse();
        }
        bytes
    };
    let format = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = ply_head(format, "double").into_bytes();
    for vertex in VERTICES {
        vertex.iter().for_each(|v| bytes.extend(order(f64::from(*v).to_le_bytes().to_vec())));
        bytes.push(255);
    }
    for face in FACES {
        bytes.push(3);
        face.iter().for_each(|v| bytes.extend(order(v.to_le_bytes().to_vec())));
    }
    bytes
}

/// An archive of parts.
pub(super) fn zipped(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in parts {
        let how = zip::write::SimpleFileOptions::default();
        archive.start_file(*name, how).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

pub(super) const RELATIONS: &str = r#"<?xml version="1.0"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/part.model" Id="r0"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;

/// The mesh of an object.
pub(super) fn mesh_xml() -> String {
    let vertices = VERTICES.map(|[x, y, z]| format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"));
    let triangles = FACES.map(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>"));
    let (vertices, triangles) = (vertices.concat(), triangles.concat());
    format!("<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>")
}

pub(super) fn model_xml(unit: &str, objects: &str, items: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?><model unit=\"{unit}\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>{objects}\
         </resources><build>{items}</build></model>"
    )
}

pub(super) fn three_mf() -> Vec<u8> {
    let object = format!("<object id=\"7\" type=\"model\">{}</object>", mesh_xml());
    let model = model_xml("centimeter", &object, "<item objectid=\"7\"/>");
    zipped(&[("_rels/.rels", RELATIONS), ("3D/part.model", &model)])
}

pub(super) fn pcd_head(fields: &str, encoding: &str) -> String {
    format!(
        "# .PCD v0.7\nVERSION 0.7\n{fields}WIDTH 4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\n\
         DATA {encoding}\n"
    )
}

const PLAIN_FIELDS: &str = "FIELDS rgb x y z\nSIZE 1 4 4 4\nTYPE U F F F\nCOUNT 3 1 1 1\n";

pub(super) fn ascii_pcd() -> String {
    let rows = VERTICES.map(|[x, y, z]| format!("1 2 3 {x} {y} {z}\n")).concat();
    pcd_head(PLAIN_FIELDS, "ascii") + &rows
}

pub(super) fn binary_pcd() -> Vec<u8> {
    let rows = VERTICES.iter().flat_map(|v| [vec![1, 2, 3], le(v)].concat());
    pcd_head(PLAIN_FIELDS, "binary").into_bytes().into_iter().chain(rows).collect()
}

/// Packed with literals only.
pub(super) fn compressed_pcd() -> Vec<u8> {
    let axis = |axis: usize| le(&VERTICES.map(|vertex| vertex[axis]));
    let plain = [vec![9; 12], axis(0), axis(1), axis(2)].concat();
    let packed: Vec<u8> =
        plain.chunks(32).flat_map(|run| [&[run.len() as u8 - 1], run].concat()).collect();
    let mut bytes = pcd_head(PLAIN_FIELDS, "binary_compressed").into_bytes();
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend((plain.len() as u32).to_le_bytes());
    bytes.extend(packed);
    bytes
}

/// LAS 1.2 or, packed, LAZ: points in steps of 0.25 from (500000, 4649776, 0).
pub(super) fn las(is_packed: bool) -> Vec<u8> {
    let vlr = laz::LazVlrBuilder::default().with_point_format(0, 0).unwrap().build();
    let mut record = Cursor::new(Vec::new());
    vlr.write_to(&mut record).unwrap();
    let record = record.into_inner();
    let mut points = Vec::new();
    for vertex in VERTICES {
        vertex.iter().for_each(|v| points.extend(((v * 4.0) as i32).to_le_bytes()));
        points.extend([0; 8]);
    }
    let (mut body, mut start) = (points, 227);
    let mut records = Vec::new();
    if is_packed {
        records.extend([0, 0]);
        records.extend(b"laszip encoded\0\0");
        records.extend(22204u16.to_le_bytes());
        records.extend((record.len() as u16).to_le_bytes());
        records.extend([0; 32]);
        records.extend(&record);
        start += records.len();
        // The packer notes where its table of chunks stands, counted from the file's beginning.
        let mut packed = Cursor::new(vec![0; start]);
        packed.set_position(start as u64);
        let mut packer = laz::LasZipCompressor::new(packed, vlr).unwrap();
        packer.compress_many(&body).unwrap();
        packer.done().unwrap();
        body = packer.into_inner().into_inner().split_off(start);
    }
    let mut head = vec![0; 227];
    head[..4].copy_from_slice(b"LASF");
    head[24..26].copy_from_slice(&[1, 2]);
    head[94..96].copy_from_slice(&227u16.to_le_bytes());
    head[96..100].copy_from_slice(&(start as u32).to_le_bytes());
    head[100..104].copy_from_slice(&u32::from(is_packed).to_le_bytes());
    head[104] = if is_packed { 0x80 } else { 0 };
    head[105..107].copy_from_slice(&20u16.to_le_bytes());
    head[107..111].copy_from_slice(&4u32.to_le_bytes());
    let frame = [0.25f64, 0.25, 0.25, 500_000.0, 4_649_776.0, 0.0];
    for (place, value) in frame.iter().enumerate() {
        head[131 + 8 * place..139 + 8 * place].copy_from_slice(&value.to_le_bytes());
    }
    [head, records, body].concat()
}

/// Every mesh file above.
pub(super) fn all_meshes() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("binary STL", binary_stl("made by hand", 4)),
        ("ASCII STL", ascii_stl().into_bytes()),
        ("OBJ", obj().into_bytes()),
        ("ASCII PLY", ascii_ply().into_bytes()),
        ("binary PLY", binary_ply(false)),
        ("binary PLY", binary_ply(true)),
        ("3MF", three_mf()),
    ]
}

/// Every point file above; the last two lie far away.
pub(super) fn all_points() -> Vec<(&'static str, Vec<u8>)> {
    let text = VERTICES.map(|[x, y, z]| format!("{x} {y} {z}\n")).concat();
    vec![
        ("point text", text.into_bytes()),
        ("ASCII PLY", ascii_ply().into_bytes()),
        ("binary PLY", binary_ply(true)),
        ("PCD", ascii_pcd().into_bytes()),
        ("PCD", binary_pcd()),
        ("PCD", compressed_pcd()),
        ("LAS", las(false)),
        ("LAZ", las(true)),
    ]
}
