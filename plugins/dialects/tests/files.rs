//! Dialects that come from a file.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

mod jobs;

use carvegraph_core::Diagnostics;
use carvegraph_core::source::Source;
use carvegraph_dialects::{DialectFile, from_file, standard, starter};
use carvegraph_sdk::conformance::dialect::{
    Arcs, Centers, Job, Reading, check, long, random, small,
};
use carvegraph_sdk::{Dialect, Units};
use std::sync::Arc;

/// Those that a file can build on.
const PARENTS: [&str; 10] = [
    "fanuc", "fluidnc", "grbl", "haas", "iso6983", "linuxcnc", "mach3", "marlin", "siemens",
    "uccnc",
];

fn file(stem: &str, text: &str) -> DialectFile {
    DialectFile {
        stem: stem.to_owned(),
        source: Arc::new(Source::new(format!("{stem}.ron"), text)),
    }
}

fn loaded(text: &str) -> Result<Box<dyn Dialect>, Diagnostics> {
    from_file(&file("mine", text), &[])
}

/// A dialect that builds on a parent and says `more`.
fn child(parent: &str, more: &str) -> String {
    format!("Dialect(\n    format: 1,\n    parent: \"{parent}\",\n    {more}\n)\n")
}

fn made(parent: &str, more: &str) -> Box<dyn Dialect> {
    loaded(&child(parent, more)).unwrap_or_else(|faults| panic!("{faults}"))
}

/// All that is wrong with a child of grbl.
fn faults(more: &str) -> String {
    match loaded(&child("grbl", more)) {
        Ok(_) => panic!("nothing is wrong with {more}"),
        Err(faults) => faults.to_string(),
    }
}

fn jobs(dialect: &dyn Dialect) -> Vec<Job> {
    let units = [Units::Mm, Units::Inch];
    let of = |units| [Job { units, ..small(dialect) }, Job { units, ..long(units) }];
    units.into_iter().flat_map(of).collect()
}

#[track_caller]
fn writes_the_same(made: &dyn Dialect, parent: &dyn Dialect) {
    for job in jobs(parent) {
        assert_eq!(job.post(made).unwrap(), job.post(parent).unwrap(), "{}", parent.name());
    }
    assert_eq!(made.capabilities(), parent.capabilities());
    assert_eq!(made.extension(), parent.extension());
}

/// A starter with all its settings uncommented.
fn uncommented(text: &str) -> String {
    let line = |line: &str| match line.trim_start().strip_prefix("//") {
        Some(setting) if !setting.starts_with(' ') && !setting.is_empty() => setting.to_owned(),
        _ => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_starter_writes_what_its_parent_writes() {
    for parent in PARENTS {
        let text = starter("mine", parent).unwrap();
        let standard = standard().into_iter().find(|d| d.name() == parent).unwrap();
        for text in [text.clone(), uncommented(&text)] {
            let made = from_file(&file("other", &text), &[]);
            let made = made.unwrap_or_else(|faults| panic!("{parent}: {faults}\n{text}"));
            writes_the_same(&*made, &*standard);
            assert_eq!(made.about(), standard.about());
        }
    }
}

#[test]
fn a_starter_says_everything() {
    let text = starter("mine", "fanuc").unwrap();
    for words in [
        "    //name: \"mine\",\n    parent: \"fanuc\",\n",
        "        // Travels.\n        //rapid: \"G0\",\n",
        "    // Changes to a tool; the spindle stands still.\n    // It also knows {{ tool }}.\n    \
         //tool_change: \"T{{ tool }} M6\",\n",
        "    //header: \"\n    //{{ units }}\n    //G17 G40 G80 G90 G94\n    //\",\n",
        "        //largest_sweep: \"180deg\",\n",
        "    //line_numbers: none,\n",
        "    //rejects: [\"G49\", \"G64\"],\n",
    ] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    assert!(text.lines().all(|line| line.len() <= 160), "{text}");
}

#[test]
fn a_starter_needs_a_name_and_a_parent() {
    let refusal = |name: &str, parent: &str| starter(name, parent).unwrap_err().to_string();
    assert!(refusal("My Router", "grbl").contains("\"My Router\" is no name for a dialect"));
    assert!(refusal("grbl", "grbl").contains("\"grbl\" is one of the standard dialects"));
    assert!(refusal("mine", "gerbl").contains("did you mean \"grbl\"?"));
    assert!(refusal("mine", "shopbot").contains("has a language of its own"));
}

#[test]
fn what_a_file_says_is_written() {
    let more = r##"
    name: "old_router", about: "My 1998 router", extension: "cnc",
    words: (rapid: "G00", feed: "G01", arc_clockwise: "G02", arc_counterclockwise: "G03"),
    numbers: (decimals_mm: 2, decimals_inch: 3, least_decimals: 2),
    arcs: (centers: "absolute", planes: "xy", helices: false, largest_sweep: "180deg"),
    comments: (open: ";", close: "", upper: true),
    line_numbers: (prefix: "N", first: 5, step: 5, last: 9999),
    header: "
        {{ units }} G17
        G90 G94

    ",
    tools: 12,
    tool_change: "{% if tool > 9 %}M1{% endif %}\nT{{ tool|pad(2) }} M6",
    spindle: (clockwise: "M3 S{{ (rpm * 255 / 24000)|round }}"),
    spin_up: "1500ms",
    footer: "M30",
    rejects: ["G43", "G64"],
    "##;
    let made = made("grbl", more);
    assert_eq!(
        [made.name(), made.about(), made.extension()],
        ["old_router", "My 1998 router", "cnc"]
    );
    let text = small(&*made).post(&*made).unwrap();
    let expected = ";CARVEGRAPH: MEDALLION: 50% DRAFT \"A\"\n;- BALL 6 MM, STEPOVER 0.3 MM\n\
                    ;- ZERO: TOP, CORNER\nN5 G21 G17\nN10 G90 G94\nN15 M5\nN20 T01 M6\n\
                    N25 M3 S128\nN30 G4 P1.5\nN35 G00 Z5.00\nN40 X10.00 Y20.00\n";
    assert!(text.starts_with(expected), "{text}");
    let arcs = Arcs {
        centers: Centers::Absolute,
        xy_only: true,
        flat_only: true,
        sweep_limit_deg: 180.0,
        tolerance_mm: 0.05,
        least_radius_mm: 0.012_7,
        ..Arcs::default()
    };
    let reading = Reading {
        decimals: [2, 3],
        feed_steps: [0.01, 0.001],
        comment: [";", ""],
        numbered: Some(('N', 5)),
        arcs,
        ..Reading::default()
    };
    // The reader counts on.
    let on = more.replace("last: 9999", "last: 99999999");
    check(&*loaded(&child("grbl", &on)).unwrap(), &reading);
}

#[test]
fn every_way_to_give_an_arc_is_read_back() {
    let arcs = |centers, sweep_limit_deg| Arcs { centers, sweep_limit_deg, ..Arcs::default() };
    let check = |more: &str, arcs: Arcs| {
        check(&*made("iso6983", more), &Reading { arcs, ..Reading::default() });
    };
    check("arcs: (centers: \"absolute\"),", arcs(Centers::Absolute, 360.0));
    // The smallest arcs, divided at 120 degrees, may turn a little farther as they are rounded.
    check("arcs: (centers: \"radius\"),", arcs(Centers::Radius, 180.0));
    check("arcs: none,", Arcs { never: true, ..Arcs::default() });
    check("arcs: (largest_sweep: 90),", arcs(Centers::Incremental, 90.0));
    assert!(!made("iso6983", "arcs: none,").capabilities().arcs);
}

#[test]
fn a_child_of_a_file_has_its_settings() {
    let base = file("base", &child("grbl", "footer: \"M5 M9\\nM30\", spin_up: none,"));
    let mine = file("mine", &child("base", "comments: none, line_limit: 100,"));
    let others = [mine.clone(), base];
    let made = from_file(&mine, &others).unwrap();
    let text = Job::at(0.0, 0.0).post(&*made).unwrap();
    assert_eq!(text, "G17 G21 G90 G94\nM3 S12000\nG0 Z5.0\nX0.0 Y0.0\nM5\nM5 M9\nM30\n");
}

#[test]
fn parents_that_are_none_are_refused() {
    let refusal = |name: &str, files: &[(&str, &str)]| {
        let files: Vec<DialectFile> =
            files.iter().map(|(stem, parent)| file(stem, &child(parent, ""))).collect();
        let mine = files.iter().find(|file| file.stem == name).unwrap();
        from_file(mine, &files).err().unwrap().to_string()
    };
    let cycle = refusal("a", &[("a", "b"), ("b", "c"), ("c", "a")]);
    let words =
        "a builds on b builds on c builds on a: a dialect cannot build on itself\n --> c.ron:3:13";
    assert!(cycle.contains(words), "{cycle}");
    assert!(refusal("a", &[("a", "a")]).contains("a builds on a: a dialect"));
    let own = refusal("a", &[("a", "heidenhain")]);
    assert!(own.contains("heidenhain cannot be a parent: it has a language of its own"), "{own}");
    let near = refusal("a", &[("a", "routr"), ("router", "grbl")]);
    assert!(near.contains("there is no dialect \"routr\" to build on"), "{near}");
    assert!(near.contains("did you mean \"router\"?"), "{near}");
    let two = refusal("a", &[("a", "b"), ("b", "grbl"), ("b", "fanuc")]);
    assert!(two.contains("there are two dialects \"b\": b.ron and b.ron"), "{two}");
    let chain: Vec<DialectFile> =
        (0..40).map(|k| file(&format!("d{k}"), &child(&format!("d{}", k + 1), ""))).collect();
    let long = from_file(&chain[0], &chain).err().unwrap().to_string();
    assert!(long.contains("more than 16 dialects build on each other"), "{long}");
    let inner = refusal("a", &[("a", "b"), ("b", "gril")]);
    assert!(inner.contains("--> b.ron:3:13"), "{inner}");
}

#[test]
fn all_faults_are_told_with_their_place() {
    let text = "Dialect(
    format: 1,
    parent: \"grbl\",
    extention: \"nc\",
    words: (rapid: \"G 0\", feeed: \"G1\"),
    numbers: (decimals_mm: 12, plus: 1),
    arcs: (centers: \"incremntal\", largest_sweep: \"10mm\"),
    comments: (open: \"G\", punctuation: \"!?\"),
    tools: -1,
    spin_up: \"nan\",
    rejects: \"M6\",
)";
    let faults = loaded(text).err().unwrap().to_string();
    for words in [
        "the dialect has no field \"extention\"\n --> mine.ron:4:5",
        "did you mean \"extension\"?",
        "\"G 0\" does not do: it must be one word such as G1",
        "words has no field \"feeed\"",
        "decimals_mm must be between 0 and 5, not 12",
        "plus must be true or false, not a whole number",
        "did you mean \"incremental\"?",
        "largest_sweep",
        "\"G\" does not do: it must be a sign such as ( or ;",
        "must be some of .,:+-*/=_'\"@&#% with - and . among them",
        "tools must be between 1 and 99999999, not -1",
        "spin_up",
        "rejects must be a list",
    ] {
        let faults = faults.replace("  -->", " -->");
        assert!(faults.contains(words), "{words} in\n{faults}");
    }
}

#[test]
fn templates_are_checked_where_they_stand() {
    let fault = faults("header: \"\n        G90\n        {{ unitz }} G17\n    \",");
    let words = "header: there is no value \"unitz\" here\n --> mine.ron:6:12\n";
    assert!(fault.replace("  -->", " -->").contains(words), "{fault}");
    assert!(fault.contains("did you mean \"unit\"?"), "{fault}");
    let cases = [
        (
            "footer: \"{% for x in name %}M30{% endfor %}\",",
            "\"for\" is nothing that a template can do",
        ),
        ("footer: \"{{ tool }}\",", "there is no value \"tool\" here"),
        ("footer: \"{{ name * 9 }}\",", "* multiplies numbers"),
        ("footer: \"M30 {% if unit %}\",", "footer:"),
        ("footer: \"M30 é\",", "cannot be written"),
        ("opening: \"{{ title }}\",", "the title may stand in a comment only"),
        ("comments: none, opening: \"({{ title }})\",", "the title may stand in a comment only"),
        ("dwell: \"G4 P{{ 1 / 0 }}\",", "dwell:"),
        ("dwell: \"\",", "dwell must not be empty"),
        ("spindle: (stop: \"\"),", "spindle.stop must not be empty"),
        ("tools: 9, rejects: [], tool_change: \"\",", "tool_change must not be empty"),
        ("footer: \"M6\",", "would write \"M6\", but its controller rejects M6"),
        ("footer: \"m06\",", "take M6 out of footer or out of rejects"),
        ("rejects: [\"M30\"],", "mine would write \"M30\", but its controller rejects M30"),
        ("rejects: [\"G2\"],", "G2 would be written, but rejects holds \"G2\""),
        ("header: \"G17 G90\",", "programs in mm and in inches would begin alike"),
        ("line_limit: 40, opening: \"(for the new router: {{ title }})\",", "line_limit is 40"),
        ("line_limit: 12,", "line_limit must be between 40 and 4096, not 12"),
        ("spin_up: \"2h\", longest_dwell: \"1h\",", "spin_up is 7200 s, but longest_dwell 3600 s"),
        ("line_numbers: (first: 10, last: 5),", "the last number, 5, is less than the first, 10"),
        ("comments: (open: \"*\", close: \"*\"),", "'*' ends a comment, so it cannot stand in one"),
        ("name: \"linuxcnc\",", "\"linuxcnc\" is one of the standard dialects"),
        ("name: \"Mine\",", "\"Mine\" is no name for a dialect"),
        ("extension: \"../x\",", "must be 1 to 8 letters and digits"),
    ];
    for (more, words) in cases {
        let fault = faults(more);
        assert!(fault.contains(words) && fault.contains("--> mine.ron:"), "{words} in\n{fault}");
    }
}

#[test]
fn newer_formats_and_long_files_are_refused() {
    let newer = loaded("Dialect(format: 2, parent: \"grbl\", what: 1)").err().unwrap().to_string();
    assert!(newer.contains("this dialect has format 2; this program reads formats up to 1"));
    assert!(newer.contains("update carve") && !newer.contains("no field"), "{newer}");
    let long = child("grbl", &format!("footer: \"{}\",", "x".repeat(70_000)));
    let long = loaded(&long).err().unwrap().to_string();
    assert!(long.contains("a dialect has at most 65536"), "{long}");
    let nothing = loaded("Dialect(format: 1)").err().unwrap().to_string();
    assert!(nothing.contains("the dialect lacks the field \"parent\""), "{nothing}");
}

#[test]
fn no_title_becomes_a_block_by_a_template() {
    let made = made("grbl", "opening: \"(job {{ title|upper }})\\n({{ name }}, {{ unit }})\",");
    let mut job = Job::at(0.0, 0.0);
    job.title = ")\nG0 Z-50 (".to_owned();
    let text = job.post(&*made).unwrap();
    assert!(text.starts_with("(job G0 Z-50)\n(CG_G0_Z_50, millimetres)\n"), "{text}");
    check(&*made, &Reading { line_limit: 79, ..Reading::default() });
}

#[test]
fn the_first_rapid_goes_across_only_where_z_was_sent_to_the_top() {
    let some = "retract: \"{% if unit == 'inches' %}G53 G0 Z0.0{% endif %}\",";
    let made = made("linuxcnc", some);
    let rapids = |units| {
        let text = Job { units, ..Job::at(1.0, 2.0) }.post(&*made).unwrap();
        let lines = text.lines().filter(|line| line.contains(['X', 'Z']));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(rapids(Units::Mm), ["G0 Z5.0", "X1.0 Y2.0"]);
    assert_eq!(rapids(Units::Inch), ["G53 G0 Z0.0", "G0 X0.0394 Y0.0787", "Z0.1969"]);
}

#[test]
fn what_no_sample_reaches_is_refused_when_it_is_written() {
    let branch = "tools: 99, tool_change: \"T{{ tool }}{% if tool == 7 %} M64{% endif %}\",";
    let made = made("grbl", &format!("{branch} rejects: [\"M64\"],"));
    let change = |number| {
        let commands = vec![carvegraph_sdk::Command::ToolChange { number }];
        Job { commands, ..Job::default() }.post(&*made)
    };
    assert!(change(8).is_ok());
    let words = "mine would write \"T7 M64\", but its controller rejects M64";
    assert_eq!(change(7).unwrap_err().to_string(), words);
}

#[test]
fn no_file_brings_carve_down() {
    let text = uncommented(&starter("mine", "siemens").unwrap());
    let pieces = [
        "none",
        "0",
        "1e300",
        "-1",
        "\"\"",
        "(",
        ")",
        "{{ tool }}",
        "{% if %}",
        "é",
        "\"",
        ",",
        "99999999999999999999",
        "true",
        "\n",
        "()",
        "[]",
        "NaN",
        "inf",
        "{{",
        "}}",
        "4294967295",
    ];
    let mut random = random(5);
    let mut good = 0;
    for _ in 0..3000 {
        let mut changed: Vec<char> = text.chars().collect();
        for _ in 0..1 + (random() * 3.0) as usize {
            let at = (random() * changed.len() as f64) as usize;
            let end = (at + (random() * 12.0) as usize).min(changed.len());
            let piece = pieces[(random() * pieces.len() as f64) as usize];
            changed.splice(at..end, piece.chars());
        }
        let changed: String = changed.into_iter().collect();
        if let Ok(made) = from_file(&file("mine", &changed), &[]) {
            good += 1;
            let _ = small(&*made).post(&*made);
        }
    }
    assert!(good > 0);
}
