//! LZF, the compression inside of PCD files (Lehmann, LibLZF, 2000): literals and copies of what
//! came up to 8 KiB before.
//!
//! Written here, since it is shorter than the checks that a crate's output would need: nothing is
//! allocated beyond what the input makes.

/// A control byte below this is followed by that many literals and one more.
const LITERALS: usize = 32;

/// Unpacks `packed`; `None` if it is damaged or gives more than `limit` bytes.
pub(super) fn unpack(packed: &[u8], limit: usize) -> Option<Vec<u8>> {
    let mut out: Vec<u8> = Vec::new();
    let mut bytes = packed.iter();
    let next = |bytes: &mut std::slice::Iter<'_, u8>| bytes.next().map(|b| usize::from(*b));
    while let Some(control) = next(&mut bytes) {
        if control < LITERALS {
            let rest = bytes.as_slice();
            out.extend_from_slice(rest.get(..=control)?);
            bytes = rest[control + 1..].iter();
        } else {
            let length = match control >> 5 {
                7 => 7 + next(&mut bytes)?,
                short => short,
            };
            let back = ((control & 31) << 8) + next(&mut bytes)? + 1;
            let from = out.len().checked_sub(back)?;
            // It may run into what it writes.
            (from..from + length + 2).for_each(|at| out.push(out[at]));
        }
        if out.len() > limit {
            return None;
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_and_copies_that_run_into_themselves() {
        // "ab", then 6 bytes from 2 back, then 11 from 1 back.
        let packed = [1, b'a', b'b', 4 << 5, 1, 7 << 5, 2, 0];
        assert_eq!(
            unpack(&packed, 100).unwrap(),
            b"abababab".iter().chain(&[b'b'; 11]).copied().collect::<Vec<u8>>()
        );
        assert_eq!(unpack(&packed, 18), None);
        assert_eq!(unpack(&[4 << 5, 1], 100), None);
        assert_eq!(unpack(&[3, b'a'], 100), None);
    }
}
