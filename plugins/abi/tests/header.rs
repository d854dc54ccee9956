//! `carvegraph.h` says the same as the Rust structs: a C compiler checks every size and offset.

use carvegraph_abi::{LAYOUT, MAGIC, MAJOR, MINOR, capability};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// `CutterInfo` in Rust is `cg_cutter_info` in C.
fn in_c(name: &str) -> String {
    let mut c = String::from("cg");
    for letter in name.chars() {
        if letter.is_ascii_uppercase() {
            c.push('_');
        }
        c.push(letter.to_ascii_lowercase());
    }
    c
}

fn checks() -> String {
    let mut c = String::from("#include \"carvegraph.h\"\n");
    for (name, size, fields) in LAYOUT {
        let name = in_c(name);
        let _ = writeln!(c, "_Static_assert(sizeof({name}) == {size}, \"size of {name}\");");
        for (field, at) in *fields {
            let _ = writeln!(
                c,
                "_Static_assert(offsetof({name}, {field}) == {at}, \"{name}.{field}\");"
            );
        }
    }
    let _ = writeln!(c, "_Static_assert(CG_MAGIC == {MAGIC}ULL, \"magic\");");
    let _ = writeln!(c, "_Static_assert(CG_ABI_MAJOR == {MAJOR}, \"major\");");
    let _ = writeln!(c, "_Static_assert(CG_ABI_MINOR == {MINOR}, \"minor\");");
    c
}

#[test]
#[cfg(all(unix, target_pointer_width = "64"))]
fn a_c_compiler_finds_every_struct_and_field_where_rust_has_it() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let source = folder.join("header.c");
    std::fs::write(&source, checks()).unwrap();
    // `cc` is what Rust links with, so it is there wherever this test was built.
    let output = Command::new("cc")
        .args(["-std=c11", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only", "-I"])
        .arg(env!("CARGO_MANIFEST_DIR"))
        .arg(&source)
        .output()
        .expect("cc is what Rust links with");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_header_has_every_struct_and_capability() {
    let header = include_str!("../carvegraph.h");
    let structs = header.matches("typedef struct cg_").count();
    // cg_run is opaque.
    assert_eq!(structs - 1, LAYOUT.len());
    use capability::{ABOUT, CUTTER, DIALECT, NODE};
    for id in [ABOUT, CUTTER, DIALECT, NODE] {
        assert!(header.contains(&format!("\"{id}\"")), "{id}");
    }
}
