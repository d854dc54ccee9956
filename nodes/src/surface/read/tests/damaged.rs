//! Whatever the bytes: an error or a result, never a panic, and no result of a file cut short that
//! passes for the whole.

use super::samples::*;
use super::*;

/// Both readers, one after the other.
fn read_both(bytes: &[u8]) -> (Result<ReadMesh, String>, Result<ReadPoints, String>) {
    (mesh(bytes), points(bytes))
}

#[test]
fn a_file_cut_anywhere_is_refused_or_clearly_shorter() {
    for (format, whole) in all_meshes() {
        for kept in 0..whole.len() {
            if let Ok(read) = mesh(&whole[..kept]) {
                // Lines may be missing from the end of an OBJ file, which has no mark there. Of
                // others nothing but a last line end or a name can be.
                let is_whole = super::corners(&read) == samples::corners();
                assert!(is_whole || format == "OBJ", "{format}: {kept} of {}", whole.len());
            }
        }
    }
    for (format, whole) in all_points() {
        for kept in 0..whole.len() {
            let may_be_shorter =
                ["point text", "ASCII PLY", "PCD", "LAZ", "binary PLY"].contains(&format);
            if let Ok(read) = points(&whole[..kept]) {
                assert!(may_be_shorter && read.points.len() <= VERTICES.len(), "{format}: {kept}");
            }
        }
    }
}

#[test]
fn changed_bytes_never_panic() {
    let mut random = fastrand::Rng::with_seed(1);
    let rounds = if cfg!(debug_assertions) { 3000 } else { 30_000 };
    for (_, whole) in all_meshes().into_iter().chain(all_points()) {
        for _ in 0..rounds {
            let mut bytes = whole.clone();
            for _ in 0..random.usize(1..6) {
                let at = random.usize(..bytes.len());
                match random.u8(..4) {
                    0 => bytes[at] = random.u8(..),
                    1 => {
                        bytes[at] =
                            [0, 0xff, 0x7f, 0x80, b' ', b'9', b'-', b'\n'][random.usize(..8)]
                    }
                    2 => _ = bytes.remove(at),
                    _ => bytes.insert(at, random.u8(..)),
                }
                if bytes.is_empty() {
                    break;
                }
            }
            let (mesh, points) = read_both(&bytes);
            if let Ok(mesh) = mesh {
                let count = mesh.vertices.len() as u32;
                assert!(mesh.triangles.iter().flatten().all(|index| *index < count));
                assert!(mesh.vertices.iter().all(|vertex| vertex.is_finite()));
            }
            if let Ok(points) = points {
                assert!(points.points.iter().all(|point| point.is_finite()));
            }
        }
    }
}

#[test]
fn noise_never_panics() {
    let mut random = fastrand::Rng::with_seed(2);
    let begins: [&[u8]; 8] =
        [b"", b"ply\n", b"PK\x03\x04", b"LASF", b"# .PCD", b"solid ", b"v 1 2 3\n", b"VERSION"];
    for begin in begins {
        for _ in 0..300 {
            let mut bytes = begin.to_vec();
            bytes.extend((0..random.usize(..600)).map(|_| random.u8(..)));
            drop(read_both(&bytes));
            let text = bytes.iter().map(|byte| b"0123456789 .-e\nvfx,;#"[*byte as usize % 21]);
            drop(read_both(&begin.iter().copied().chain(text).collect::<Vec<u8>>()));
        }
    }
}
