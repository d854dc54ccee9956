use super::samples::*;
use super::*;

#[test]
fn every_format_gives_the_same_points() {
    for (format, bytes) in all_points() {
        let read = points(&bytes).unwrap_or_else(|fault| panic!("{format} {fault}"));
        let far = if format.starts_with("LA") {
            DVec3::new(500_000.0, 4_649_776.0, 0.0)
        } else {
            DVec3::ZERO
        };
        let expected: Vec<DVec3> = vertices().into_iter().map(|vertex| vertex + far).collect();
        assert_eq!((read.format, read.points, read.missed), (format, expected, 0));
    }
}

#[track_caller]
fn assert_table(text: &str) {
    let expected = [DVec3::new(1.5, -2.0, 3.0), DVec3::new(4.0, 5.25, 6e-3)];
    assert_eq!(
        points(text.as_bytes()).map(|read| read.points).as_deref(),
        Ok(&expected[..]),
        "{text}"
    );
}

#[test]
fn tables_come_in_many_forms() {
    assert_table("1.5 -2 3\n4 5.25 6e-3");
    assert_table("1.5\t-2\t3\r\n\r\n4\t5.25\t6e-3\r\n");
    assert_table("  1.5, -2, 3, 255\n  4,5.25,6e-3,\n");
    assert_table("1.5;-2;3\n4;5.25;6e-3\n");
    assert_table("1,5;-2,0;3\n4;5,25;6e-3\n");
    assert_table("1,5 -2,0 3,0\n4 5,25 6e-3\n");
    assert_table("# a scan\n2\n// by hand\n1.5 -2 3 10 20 30\n% more\n4 5.25 6e-3 10 20 30\n");
    assert_table("\u{feff}\"id\",\"Z\",\"X\",\"Y\"\n7,3,1.5,-2\n8,6e-3,4,5.25\n");
    assert_table("//X Y Z Intensity\n1.5 -2 3 x\n4 5.25 6e-3 y\n".replace(" x\n", " 1\n").as_str());
    assert_table("x[mm];y[mm];z[mm]\n1.5;-2;3\n4;5.25;6e-3\n");
}

#[test]
fn a_gap_or_a_word_after_the_first_point_is_a_fault() {
    let fault = |text: &str| points(text.as_bytes()).unwrap_err();
    assert_eq!(
        fault("1 2 3\n4 5\n"),
        "is no sound point text file: line 2: a point needs 3 columns, as the first one has"
    );
    assert_eq!(
        fault("h\n1,2,3\n4,,6\n"),
        "is no sound point text file: line 3: \"\" in column 2 is no number"
    );
    assert_eq!(
        fault("no numbers\n"),
        "is no sound point text file: line 2: no line has three numbers: x, y and z"
    );
    assert!(
        fault(&"words\n".repeat(200)).contains("none of the first 100 lines begins with three")
    );
}

#[test]
fn a_fault_in_a_later_piece_has_its_line() {
    let mut text = "1.25 2.5 3.75\n".repeat(200_000);
    text += "1 2 three\n";
    let message = points(text.as_bytes()).unwrap_err();
    assert!(message.ends_with("line 200001: \"three\" in column 3 is no number"), "{message}");
    let whole = points(text.replace("three", "3").as_bytes()).unwrap();
    assert_eq!(whole.points.len(), 200_001);
}

#[test]
fn what_the_scanner_missed_is_left_out_and_counted() {
    let read = points(b"1 2 3\nnan nan nan\n4 5 inf\n7 8 9\n").unwrap();
    assert_eq!((read.points.len(), read.missed), (2, 2));
    let text = ascii_pcd().replacen("3.25", "nan", 1);
    assert_eq!(points(text.as_bytes()).unwrap().missed, 1);
    assert!(points(b"nan nan nan\n").unwrap_err().starts_with("holds no points"));
}

#[test]
fn pcd_takes_numbers_of_all_types() {
    let fields = "FIELDS x y z\nSIZE 2 8 1\nTYPE I F U\nCOUNT 1 1 1\n";
    let mut bytes = pcd_head(fields, "binary").into_bytes();
    for i in 0..4u8 {
        bytes.extend((-300 * i16::from(i)).to_le_bytes());
        bytes.extend((0.1 * f64::from(i)).to_le_bytes());
        bytes.push(200 + i);
    }
    let read = points(&bytes).unwrap();
    assert_eq!(read.points[3], DVec3::new(-900.0, 0.1 * 3.0, 203.0));
}

#[test]
fn counts_beyond_the_bytes_allocate_nothing() {
    let huge = |text: Vec<u8>, from: &str, to: &str| {
        let at = text.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        [&text[..at], to.as_bytes(), &text[at + from.len()..]].concat()
    };
    for bytes in [ascii_pcd().into_bytes(), binary_pcd(), compressed_pcd()] {
        let message = points(&huge(bytes.clone(), "POINTS 4", "POINTS 90000000")).unwrap_err();
        assert!(message.contains("90000000"), "{message}");
        let message = points(&huge(bytes, "POINTS 4", "POINTS 99999999999999")).unwrap_err();
        assert!(message.contains("the limit is 100000000"), "{message}");
    }
    for bytes in [ascii_ply().into_bytes(), binary_ply(false)] {
        for count in ["90000000", "18446744073709551615"] {
            let more = huge(bytes.clone(), "vertex 4", &format!("vertex {count}"));
            assert!(points(&more).is_err() && mesh(&more).is_err());
            let more = huge(bytes.clone(), "face 4", &format!("face {count}"));
            assert!(mesh(&more).unwrap_err().contains("too few: the file was cut short"));
        }
    }
    for is_packed in [false, true] {
        let mut bytes = las(is_packed);
        bytes[107..111].copy_from_slice(&99_999_999u32.to_le_bytes());
        let message = points(&bytes).unwrap_err();
        assert!(message.contains("cut short"), "{message}");
    }
}

#[test]
fn words_and_pictures_are_no_points() {
    let message = points(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").unwrap_err();
    assert_eq!(message, "is no point file that can be read: XYZ, CSV, PLY, PCD, LAS and LAZ can");
}
