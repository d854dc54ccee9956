use crate::iso6983;
use crate::lines::Lines;
use crate::rs274::Rs274;

/// `LINELEN` in its `config.h`.
const LINE_LIMIT: u32 = 255;

/// A tool table holds numbers up to here.
const TOOL_LIMIT: u32 = 99_999;

pub(crate) fn settings() -> Rs274 {
    let iso = iso6983::settings();
    Rs274 {
        name: "linuxcnc".into(),
        about: "LinuxCNC 2.8 and later".into(),
        extension: "ngc".into(),
        tool_limit: Some(TOOL_LIMIT),
        line_limit: LINE_LIMIT,
        lines: Lines {
            header: "G17 {{ units }} G40 G80 G90 G94 G91.1".into(),
            path_tolerance: "G64 P{{ tolerance }} Q{{ tolerance }}".into(),
            tool_change: "T{{ tool }} M6\nG43".into(),
            footer: "M2".into(),
            ..iso.lines
        },
        needs_path_tolerance: true,
        rejects: "% N G49".into(),
        ..iso
    }
}
