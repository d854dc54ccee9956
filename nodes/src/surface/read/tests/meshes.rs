use super::samples::*;
use super::*;

#[test]
fn every_format_gives_the_same_triangles() {
    for (format, bytes) in all_meshes() {
        let read = mesh(&bytes).unwrap_or_else(|fault| panic!("{format} {fault}"));
        assert_eq!(read.format, format);
        assert_eq!(super::corners(&read), samples::corners(), "{format}");
        assert_eq!(read.vertices.len(), 4, "{format}: vertices are shared");
        assert_eq!(read.oddities, [""; 0], "{format}");
        assert_eq!(read.unit_mm, (format == "3MF").then_some(10.0));
    }
}

#[test]
fn a_binary_stl_that_begins_with_solid_is_binary() {
    let read = mesh(&binary_stl("solid made by a liar", 4)).unwrap();
    assert_eq!((read.format, read.triangles.len()), ("binary STL", 4));
    // Also with a count that is wrong besides.
    let read = mesh(&binary_stl("solid \0 liar", 0)).unwrap();
    assert_eq!((read.format, read.triangles.len()), ("binary STL", 4));
}

#[test]
fn a_count_that_was_never_filled_in_is_told_from_the_length() {
    for count in [0, u32::MAX, 3] {
        let read = mesh(&binary_stl("x", count)).unwrap();
        assert_eq!(read.triangles.len(), 4);
        let odd = format!("the header promises {count} triangles, the file holds 4");
        assert_eq!(read.oddities, [odd]);
    }
}

#[test]
fn a_count_beyond_the_files_end_is_refused() {
    let message = mesh(&binary_stl("x", 4_000_000_000)).unwrap_err();
    let expected = "is no sound binary STL file: byte 284: the header promises 4000000000 triangles, \
                    the file ends after 4: it was cut short, or its count is wrong; save it again";
    assert_eq!(message, expected);
}

#[test]
fn bytes_after_the_last_triangle_are_left_out_and_told() {
    let bytes = [binary_stl("x", 4), vec![7; 13]].concat();
    let read = mesh(&bytes).unwrap();
    assert_eq!(read.triangles.len(), 4);
    assert_eq!(read.oddities, ["13 bytes after the 4 triangles are left out"]);
}

#[test]
fn an_ascii_stl_may_have_several_solids_any_case_and_any_line_ends() {
    let text = ascii_stl().to_uppercase().replace('\n', "\r\n");
    let read = mesh(format!("\u{feff}{text}{}", ascii_stl()).as_bytes()).unwrap();
    assert_eq!((read.triangles.len(), read.vertices.len()), (8, 4));
}

#[test]
fn an_ascii_stl_names_the_line_of_a_fault() {
    let text = ascii_stl();
    let nan = mesh(text.replacen("3.25", "nan", 1).as_bytes()).unwrap_err();
    assert_eq!(nan, "is no sound ASCII STL file: line 5: \"nan\" is no finite number of a vertex");
    let four = mesh(text.replacen("endloop", "vertex 1 1 1\nendloop", 1).as_bytes()).unwrap_err();
    assert_eq!(four, "is no sound ASCII STL file: line 7: \"vertex\" stands where endloop belongs");
    let open = mesh(text.replace("endsolid a name of its own", "").as_bytes()).unwrap_err();
    assert!(open.contains("ends without endsolid"), "{open}");
}

#[test]
fn a_coordinate_that_is_no_number_has_its_place() {
    let mut bytes = binary_stl("x", 4);
    bytes[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = mesh(&bytes).unwrap_err();
    assert!(
        message.contains("byte 134: a corner of triangle 1 (from 0) is no finite"),
        "{message}"
    );
    let message = mesh(ascii_ply().replacen("3.25", "inf", 1).as_bytes()).unwrap_err();
    assert!(message.contains("line 14: a coordinate of vertex 2 (from 0)"), "{message}");
}

#[test]
fn obj_faces_may_count_back_and_have_many_corners_and_go_on_in_the_next_line() {
    let text = "v 0 0 0 1.0\r\nv 2 0 0\r\nv 2 2 0\r\nv 0 2 0\r\nvn 0 0 1\r\nf -4//1 -3//1 \\\r\n -2/5/1 -1\r\n\
                v 1 1 1\r\nf 1 2 -1 # tail\r\n";
    let read = mesh(text.as_bytes()).unwrap();
    assert_eq!(read.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 4]]);
}

#[test]
fn obj_faults_name_their_line() {
    let cases = [
        ("v 0 0 0\nf 1 2 3\n", "line 2: a face names vertex 2; 1 vertices stand before it"),
        ("v 0 0 0\nf 0 1 1\n", "line 2: a face names vertex 0; 1 vertices stand before it"),
        ("v 0 0 0\nf -2 1 1\n", "line 2: a face names vertex -2; 1 vertices stand before it"),
        ("v 0 0 0\nf 1 1\n", "line 2: a face needs 3 corners; this one has 2"),
        ("v 0 0 0\nf 1 x 1\n", "line 2: \"x\" is no corner of a face"),
        ("v 0 0\n", "line 1: \"\" is no finite number of a vertex"),
    ];
    for (text, fault) in cases {
        assert_eq!(mesh(text.as_bytes()).unwrap_err(), format!("is no sound OBJ file: {fault}"));
    }
}

#[test]
fn strips_alternate_and_end_at_negative_indices() {
    let head = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n\
                property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    let rows: String = (0..6).map(|i| format!("{} {} 0\n", i / 2, i % 2)).collect();
    let read = mesh(format!("{head}{rows}13 0 1 2 3 -1 2 3 3 4 5 -1 0 1\n").as_bytes()).unwrap();
    // The strip 2 3 3 4 5 leads on over a repeated corner.
    assert_eq!(read.triangles, [[0, 1, 2], [2, 1, 3], [3, 4, 5]]);
}

#[test]
fn ply_polygons_are_cut_and_unknown_elements_passed_over() {
    let text = "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty float f\r\nproperty list uchar float m\r\n\
                element vertex 5\r\nproperty double y\r\nproperty double x\r\nproperty double z\r\n\
                element face 1\r\nproperty uchar flag\r\nproperty list uint8 uint32 vertex_index\r\n\
                end_header\r\n3 2 1 1\r\n0 0 0\r\n0 2 0\r\n2 2 0\r\n1 1 0\r\n2 0 0\r\n9 5 0 1 2 3 4\r\n";
    let read = mesh(text.as_bytes()).unwrap();
    assert_eq!(read.vertices[1], DVec3::new(2.0, 0.0, 0.0));
    let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).z / 2.0;
    let areas: Vec<f64> = super::corners(&read).into_iter().map(area).collect();
    assert_eq!((areas.len(), areas.iter().sum::<f64>()), (3, 3.0));
    assert!(areas.iter().all(|area| *area > 0.0));
}

#[test]
fn a_ply_without_faces_says_who_reads_it() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                property float z\nend_header\n0 0 0\n";
    let message = mesh(text.as_bytes()).unwrap_err();
    assert!(message.ends_with("no element lists faces: these are points, which load_points reads"));
}

#[test]
fn components_and_items_are_placed_mirrored_and_counted() {
    let component = r#"<component objectid="1" transform="0 1 0 -1 0 0 0 0 1 10 0 0"/>"#;
    let objects = format!(
        "<object id=\"1\">{}</object><object id=\"2\"><components><component objectid=\"1\"/>{component}\
         </components></object>",
        mesh_xml()
    );
    // Twice the size, mirrored in x, and shifted by 1 in z.
    let items = r#"<item objectid="2" transform="-2 0 0 0 2 0 0 0 2 0 0 1"/>"#;
    let model = model_xml("inch", &objects, items);
    let read = mesh(&zipped(&[("3D/3dmodel.model", &model)])).unwrap();
    assert_eq!((read.triangles.len(), read.vertices.len(), read.unit_mm), (8, 8, Some(25.4)));
    // (4, 0, 0.5) stays, is mirrored: (-8, 0, 2). Turned by the component it is (10, 4, 0.5) first.
    assert_eq!(read.vertices[1], DVec3::new(-8.0, 0.0, 2.0));
    assert_eq!(read.vertices[5], DVec3::new(-20.0, 8.0, 2.0));
    // Outside stays outside.
    let volume: f64 = super::corners(&read).iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum();
    let before: f64 = samples::corners().iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum();
    assert!((volume - 16.0 * before).abs() < 1e-9 && before > 0.0);
}

#[test]
fn components_of_another_part_and_a_prefix_of_ones_own_are_read() {
    let object = format!("<object id=\"1\">{}</object>", mesh_xml());
    let other = model_xml("millimeter", &object, "<item objectid=\"1\"/>");
    let root = r#"<?xml version="1.0"?><c:model xmlns:c="core" xmlns:p="production"><c:resources>
        <c:object id="5"><c:components><c:component p:path="/3D/Objects/one.model" objectid="1"/>
        </c:components></c:object></c:resources><c:build><c:item objectid="5"/></c:build></c:model>"#;
    let parts =
        [("_rels/.rels", RELATIONS), ("3D/part.model", root), ("3D/Objects/one.model", &other)];
    let read = mesh(&zipped(&parts)).unwrap();
    assert_eq!(super::corners(&read), samples::corners());
    assert_eq!(read.unit_mm, Some(1.0));
}

#[test]
fn three_mf_faults_name_the_part() {
    let with = |objects: &str, items: &str| {
        let model = model_xml("millimeter", objects, items);
        mesh(&zipped(&[("3D/3dmodel.model", &model)])).unwrap_err()
    };
    let part = "is no sound 3MF file: part \"3D/3dmodel.model\"";
    let item = "<item objectid=\"1\"/>";
    assert_eq!(with("", item), format!("{part}: there is no object \"1\""));
    let cycle = "<object id=\"1\"><components><component objectid=\"1\"/></components></object>";
    assert_eq!(with(cycle, item), format!("{part}: object \"1\" is nested deeper than 32"));
    let vertex = "<object id=\"1\"><mesh><vertices><vertex x=\"1\" y=\"nan\" z=\"0\"/>";
    assert!(
        with(vertex, item).ends_with("y=\"nan\" is out of its range"),
        "{}",
        with(vertex, item)
    );
    let empty = "<object id=\"1\"></object>";
    assert!(with(empty, item).starts_with("holds no triangles"));
    // Two to the 31st: refused long before.
    let many: String = (1..32)
        .map(|i| {
            format!(
                "<object id=\"{i}\"><components>{0}{0}</components></object>",
                format!("<component objectid=\"{}\"/>", i + 1)
            )
        })
        .collect();
    let message = with(&(many + "<object id=\"32\"></object>"), item);
    assert!(
        message.starts_with("has 1000001 objects in its build; the limit is 1000000"),
        "{message}"
    );
    let missing = mesh(&zipped(&[("readme.txt", "x")])).unwrap_err();
    assert_eq!(missing, format!("{part}: it is named but not in the archive"));
}

#[test]
fn an_endless_tag_does_not_fill_the_memory() {
    let long = format!("<model unit=\"{}\">", "x".repeat(3 << 20));
    let message = mesh(&zipped(&[("3D/3dmodel.model", &long)])).unwrap_err();
    assert!(message.contains("a tag of more than 1048576 bytes"), "{message}");
}

#[test]
fn words_pictures_and_nothing_are_no_mesh() {
    for bytes in [
        &b"The quick brown fox"[..],
        b"",
        b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
        &[0xff; 200],
        &[b'x'; 200],
    ] {
        let message = mesh(bytes).unwrap_err();
        assert_eq!(message, "is no mesh that can be read: STL, OBJ, PLY and 3MF can");
    }
    assert!(mesh(b"solid x\nendsolid x\n").unwrap_err().starts_with("holds no triangles"));
}

#[test]
fn reading_stops_when_told_to() {
    for (format, bytes) in all_meshes() {
        // The small text files end before the first look.
        if format.contains("binary") {
            assert_eq!(read_mesh(&bytes, &|_| false), Err(ReadError::Stopped), "{format}");
        }
    }
}
