//! The page that a run leaves beside its files.

use crate::bench::{Bench, QUICK, recipe_text};

/// Runs a recipe on hills called `picture` and reads the page `name`.
fn page_of(
    bench: &Bench,
    recipe: &str,
    (picture, name): (&str, &str),
    more: &[&str],
) -> (i32, String) {
    bench.hills(picture, (24, 20));
    let image = format!("image={picture}");
    let answer = bench.carve(&[&["run", recipe, "--set", &image], &QUICK[..], more].concat());
    let path = format!("out/{name}.html");
    let told = answer.err.contains(&format!("all about this run: {path}\n"));
    assert_eq!(told, bench.path(&path).exists(), "{}", answer.err);
    (answer.status, bench.text(&path))
}

/// The page of the recipe `relief`, or another one, for hills.png.
fn page(bench: &Bench, recipe: &str, more: &[&str]) -> (i32, String) {
    page_of(bench, recipe, ("hills.png", "hills"), more)
}

/// Every tag is closed in its turn; answers all attributes.
#[track_caller]
fn assert_well_formed(page: &str) -> Vec<String> {
    const VOID: [&str; 5] = ["!doctype", "meta", "img", "br", "hr"];
    let body = page.split_once("<style>").unwrap();
    let without_style = format!("{}{}", body.0, body.1.split_once("</style>").unwrap().1);
    let (mut open, mut attributes) = (Vec::new(), Vec::new());
    for part in without_style.split('<').skip(1) {
        let (tag, text) = part.split_once('>').expect("every tag ends");
        assert!(!text.contains('>'), "{text:?} is not escaped");
        let name = tag.split_whitespace().next().unwrap().to_lowercase();
        match name.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop().as_deref(), Some(name), "</{name}>"),
            None if VOID.contains(&&name[..]) => {}
            None => open.push(name),
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "<{tag}>");
        let odd = tag.split('"').skip(1).step_by(2);
        let names = tag.split('"').step_by(2).map(|name| name.rsplit(' ').next().unwrap());
        attributes.extend(names.zip(odd).map(|(name, value)| format!("{name}{value}")));
    }
    assert_eq!(open, Vec::<String>::new());
    attributes
}

#[test]
fn a_page_stands_beside_the_files_and_needs_nothing_else() {
    let bench = Bench::new();
    let (status, page) = page(&bench, "relief", &[]);
    assert_eq!(status, 0);
    let attributes = assert_well_formed(&page);
    let sources: Vec<_> = attributes.iter().filter(|a| a.starts_with("src=")).collect();
    assert_eq!(sources.len(), 4);
    assert!(sources.iter().all(|source| source.starts_with("src=data:image/png;base64,iVBOR")));
    assert!(attributes.iter().filter(|a| a.starts_with("href=")).all(|a| a.starts_with("href=#")));
    for foreign in ["http:", "https:", "<script", "<link", "url(", "@import", "javascript"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    for told in [
        "<h1>Relief from a picture <span class=\"faint\">hills</span></h1>",
        "<dt>Part</dt><dd>28.75 × 23.75 mm, Z 0 to 5 mm</dd>",
        "<dt>Cutter</dt><dd>ball, diameter 6 mm</dd>",
        "<dd>text: feeds, spindle, units, arcs, end, rapids through stock",
        "hills.txt</h2>",
        "<dt><code>canvas_width</code></dt><dd><code>30</code></dd>",
        "dialect grbl",
        concat!("carve ", env!("CARGO_PKG_VERSION")),
    ] {
        assert!(page.contains(told), "{told}: {page}");
    }
}

#[test]
fn files_are_told_with_size_and_hash() {
    let bench = Bench::new();
    let (_, page) = page(&bench, "relief", &[]);
    for name in ["out/hills.nc", "out/hills.stl", "hills.png"] {
        let bytes = bench.read(name);
        let hash = carvegraph_hash(&bytes);
        let size = match bytes.len() {
            few @ ..=9_999 => format!("{few} bytes"),
            many => format!("{:.0} kB", many as f64 / 1000.0),
        };
        let row = page.lines().find(|line| line.contains(&hash)).unwrap_or_default();
        assert!(row.contains(name.trim_start_matches("out/")) && row.contains(&size), "{row}");
    }
    let cached = ["--cache", "kept"];
    let (_, first) = self::page(&bench, "relief", &cached);
    let (_, again) = self::page(&bench, "relief", &cached);
    let files =
        |page: &str| page[page.find("Written").unwrap()..page.find("Nodes").unwrap()].to_owned();
    assert_eq!(files(&first), files(&again));
    assert!(again.contains("<td>cached</td>"), "{again}");
}

fn carvegraph_hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

#[test]
fn names_and_notes_are_text_and_nothing_else() {
    let bench = Bench::new();
    let hostile = r#"<b onload='x()'>&amp;\"</pre></script>"#;
    let text = recipe_text("relief")
        .replacen("Relief from a picture", hostile, 1)
        .replacen("Luminance becomes height", "<img src=x onerror=y> & <!--", 1)
        .replacen("{prefix}-path", "{prefix}+path (1)", 1);
    bench.write("mine.ron", text);
    let (status, page) = page_of(&bench, "mine.ron", ("a'b&c.png", "a_b_c"), &[]);
    assert_eq!(status, 0, "{page}");
    let attributes = assert_well_formed(&page);
    assert!(attributes.iter().all(|a| !a.starts_with("on")), "{attributes:?}");
    assert!(!page.contains("<b ") && !page.contains("<!--") && !page.contains("<img src=x"));
    assert!(
        page.contains("<h1>&lt;b onload=&#x27;x()&#x27;&gt;&amp;amp;&quot;&lt;&#x2f;pre&gt;"),
        "{page}"
    );
}

#[test]
fn a_run_that_failed_has_a_page_that_says_so_first() {
    let bench = Bench::new();
    bench.write("mine.ron", recipe_text("relief"));
    // The pictures can be drawn; the program cannot be written, grbl having no tool change.
    let (status, page) = page(&bench, "mine.ron", &["--set", "post.tool=3"]);
    assert_eq!(status, 1);
    assert_well_formed(&page);
    let (first, picture) = (page.find("This run failed").unwrap(), page.find("<img").unwrap());
    assert!(first < picture, "{page}");
    assert!(
        page.contains(
            "<p><code>post</code> (post): dialect &quot;grbl&quot;: command 0: grbl has no tool"
        ),
        "{page}"
    );
    assert!(page.contains("Not run, since they needed it: <code>save_gcode</code>"), "{page}");
}

#[test]
fn the_time_of_a_job_is_that_of_all_its_tools() {
    let bench = Bench::new();
    let (status, page) = page(&bench, "two_tool_relief", &["--report", "report.json"]);
    assert_eq!(status, 0);
    assert!(
        page.contains("<dt>Cutter</dt><dd>flat, ") && page.contains("<dt>Cutter</dt><dd>ball, ")
    );
    let report = bench.report();
    let both_s = report.number("inspection/time", "estimate", "time_s");
    assert!(both_s > report.number("rough", "job", "time_s") + 10.0, "{both_s}");
    let told = format!(
        "<dt>Machining time</dt><dd>{} min on a machine that gathers",
        (both_s / 60.0).ceil()
    );
    assert!(page.contains(&told), "{told}: {page}");
}

#[test]
fn a_page_is_written_unless_it_is_not_wanted_or_nothing_else_is() {
    let bench = Bench::new();
    bench.hills("hills.png", (24, 20));
    let run = |more: &[&str]| {
        let base = ["run", "relief", "--set", "image=hills.png"];
        bench.carve(&[&base[..], &QUICK[..], more].concat())
    };
    let is_there = |folder: &str| bench.path(&format!("{folder}/hills.html")).exists();
    assert_eq!(run(&["--no-html", "--out", "without"]).status, 0);
    assert!(bench.path("without/hills.nc").exists() && !is_there("without"));
    let quiet = run(&["--quiet", "--out", "quiet"]);
    assert_eq!((quiet.status, quiet.err.as_str(), is_there("quiet")), (0, "", true));
    // Refused only when the size of the job is known.
    let refused =
        run(&["--out", "refused", "--set", "stepover=0.0001", "--set", "feed_step=0.0001"]);
    assert_eq!((refused.status, bench.path("refused").exists()), (2, false), "{}", refused.err);
}

#[test]
fn a_page_takes_no_name_of_another_file() {
    let bench = Bench::new();
    bench.hills("hills.png", (24, 20));
    let base = ["run", "relief", "--set", "image=hills.png", "--only", "save_gcode"];
    let run = |more: &[&str]| bench.carve(&[&base[..], &QUICK[..], more].concat());
    // The report for scripts, of all names.
    assert_eq!(run(&["--report", "out/hills.html"]).status, 0);
    assert!(bench.text("out/hills.html").starts_with('{'));
    assert!(bench.text("out/hills-report.html").starts_with("<!DOCTYPE html>"));
    // A folder: the run is done nevertheless.
    std::fs::create_dir_all(bench.path("taken/hills.html")).unwrap();
    let answer = run(&["--out", "taken"]);
    assert_eq!((answer.status, answer.out.as_str()), (0, "taken/hills.nc\n"));
    let words = "warning: no page about this run: cannot write taken/hills.html: ";
    assert!(answer.err.contains(words), "{}", answer.err);
    let left: Vec<_> = bench.files("taken").into_keys().collect();
    assert_eq!(left, ["hills.nc"]);
}

#[test]
fn several_pictures_share_a_page_called_after_the_recipe() {
    let bench = Bench::new();
    bench.hills("first.png", (24, 20));
    bench.hills("second.png", (24, 20));
    let node = |id: &str| {
        format!(
            r#""{id}": (kind: "load_image", set: {{ "path": "{id}.png" }}),
            "{id}_gray": (kind: "grayscale", from: {{ "image": "{id}" }}),
            "{id}_map": (kind: "z_map", from: {{ "image": "{id}_gray" }}),
            "{id}_look": (kind: "preview", from: {{ "surface": "{id}_map" }}, set: {{ "size": 64 }}),"#
        )
    };
    let (first, second) = (node("first"), node("second"));
    let outputs = r#"outputs: ["first_look", "second_look"]"#;
    bench.write(
        "both.ron",
        format!(r#"Recipe(format: 1, title: "Both", nodes: {{ {first} {second} }}, {outputs})"#),
    );
    let answer = bench.carve(&["run", "both.ron"]);
    assert_eq!(answer.status, 0, "{}", answer.err);
    let page = bench.text("out/both.html");
    assert_well_formed(&page);
    assert!(page.contains(r#"alt="first.png""#) && page.contains(r#"alt="second.png""#));
}
