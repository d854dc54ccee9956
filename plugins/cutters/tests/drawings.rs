//! Form tools from drawings: heights against closed forms, and what is refused in which words.

#![allow(clippy::unwrap_used, reason = "a failing helper fails its test")]

use carvegraph_cutters::standard;
use carvegraph_sdk::{CutterError, Dimensions, Profile, Segment};

/// How far a line chain may lie from the curve drawn, below it and above: chords and tangents, and
/// noise. Where the curve is steep its height differs by more.
const BELOW_MM: f64 = 1e-3;
const ABOVE_MM: f64 = 2e-6;

fn read(text: &str) -> Result<Profile, CutterError> {
    let form = standard().into_iter().find(|s| s.name() == "form").unwrap();
    form.profile(&Dimensions::new(&[], &[]).unwrap().with_drawing(text))
}

/// A drawing in mm.
fn sheet(content: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='50mm' viewBox='0 0 100 50'>\
         {content}</svg>"
    )
}

fn drawn(d: &str) -> Profile {
    read(&sheet(&format!("<path d='{d}'/>"))).unwrap()
}

fn refusal(content: &str) -> String {
    read(&sheet(content)).unwrap_err().to_string()
}

fn refused(d: &str) -> String {
    refusal(&format!("<path d='{d}'/>"))
}

fn arcs(profile: &Profile) -> usize {
    profile.segments().iter().filter(|s| matches!(s, Segment::Arc { .. })).count()
}

/// The profile lies beside the curve of the given heights: above what is `below` it, and below what
/// is a little above it.
fn check_heights(profile: &Profile, below: f64, heights: impl Fn(f64) -> f64) {
    let radius = profile.radius_mm();
    for k in 1..2000 {
        let r = radius * f64::from(k) / 2000.0;
        let found = profile.height(r);
        let least = heights((r - below).max(0.0)) - below;
        let most = heights((r + ABOVE_MM).min(radius)) + ABOVE_MM;
        assert!((least..=most).contains(&found), "{found} at r {r}, not {least} to {most}");
    }
}

/// Equal but for rounding.
fn assert_same(a: &Profile, b: &Profile) {
    assert_eq!(a.segments().len(), b.segments().len());
    for (a, b) in a.segments().iter().zip(b.segments()) {
        let (a, b) = (a.to(), b.to());
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{a:?} {b:?}");
    }
}

#[test]
fn a_round_over_bit_is_below_its_arc_by_less_than_a_micrometre() {
    let bit = read(include_str!("drawings/round_over.svg")).unwrap();
    assert_eq!(bit.radius_mm(), 7.0);
    check_heights(&bit, BELOW_MM, |r| match r {
        r if r <= 2.0 => 0.0,
        r if r <= 6.0 => 0.5 + (16.0 - (6.0 - r) * (6.0 - r)).sqrt(),
        _ => 4.5,
    });
    assert!(bit.segments().len() < 100, "{}", bit.segments().len());
}

#[test]
fn an_ogee_bit_keeps_its_cove_as_an_arc() {
    let bit = read(include_str!("drawings/ogee.svg")).unwrap();
    let eighth = 3.0 * std::f64::consts::FRAC_1_SQRT_2;
    assert!((bit.radius_mm() - (1.0 + 2.0 * eighth)).abs() < 1e-9);
    assert_eq!(arcs(&bit), 1);
    // The round's circle has its centre 3 mm right below the rim.
    let round = |r: f64| 3.0 - 2.0 * eighth + (9.0 - (r - bit.radius_mm()).powi(2)).sqrt();
    check_heights(&bit, BELOW_MM, |r| match r {
        r if r <= 1.0 => 0.0,
        r if r <= 1.0 + eighth => 3.0 - (9.0 - (r - 1.0) * (r - 1.0)).sqrt(),
        r => round(r),
    });
}

#[test]
fn a_drawn_ball_is_a_ball() {
    let ball = Profile::ball(3.0).unwrap();
    assert_eq!(drawn("M 10 40 a 3 3 0 0 0 3 -3"), ball);
    assert_eq!(drawn("M 13 37 A 3 3 0 0 1 10 40"), ball);
}

#[test]
fn lines_are_kept_as_drawn() {
    let line = |r, h| Segment::Line { to: [r, h] };
    let steps = Profile::new(vec![line(1.0, 0.0), line(2.0, 1.0), line(2.0, 3.0), line(4.0, 3.0)]);
    let steps = steps.unwrap();
    assert_eq!(drawn("M 5 20 H 6 l 1 -1 v -2 h 2"), steps);
    assert_eq!(read(&sheet("<polyline points='5,20 6,20 7,19 7,17 9,17'/>")).unwrap(), steps);
    assert_eq!(read(&sheet("<polyline points='9,17 7,17 7,19 6,20 5,20'/>")).unwrap(), steps);
    let cone = Profile::new(vec![line(3.0, 6.0)]).unwrap();
    assert_eq!(read(&sheet("<line x1='1' y1='10' x2='4' y2='4'/>")).unwrap(), cone);
}

#[test]
fn lengths_and_view_box_give_the_scale() {
    let ball = |attributes: &str| {
        let svg = "http://www.w3.org/2000/svg";
        let d = "M 10 40 a 3 3 0 0 0 3 -3";
        read(&format!("<svg xmlns='{svg}' {attributes}><path d='{d}'/></svg>")).unwrap().radius_mm()
    };
    let px = 25.4 / 96.0;
    for (attributes, mm_a_unit) in [
        ("width='100mm' height='100mm' viewBox='0 0 100 100'", 1.0),
        ("width='10cm' height='10cm' viewBox='7 7 50 50'", 2.0),
        ("width='1in' height='1in' viewBox='0 0 50 50'", 0.508),
        ("width='72pt' viewBox='0 0 50 50'", 0.508),
        ("height='6pc' viewBox='0 0 50 50'", 0.508),
        ("width='96' height='96px' viewBox='0 0 50 50'", 0.508),
        ("width='100mm' height='200mm' viewBox='0 0 50 50'", 2.0),
        (
            "width='100mm' height='200mm' viewBox='0 0 50 50' preserveAspectRatio='xMinYMin slice'",
            4.0,
        ),
        ("width='100%' height='100%' viewBox='0 0 50 50'", px),
        ("viewBox='0 0 50 50'", px),
        ("width='100mm'", px),
        ("", px),
    ] {
        let radius = ball(attributes);
        assert!((radius - 3.0 * mm_a_unit).abs() < 1e-9, "{attributes}: {radius}");
    }
}

#[test]
fn transforms_of_groups_are_honoured() {
    let straight = drawn("M 10 40 h 1 a 3 3 0 0 0 3 -3 l 1 -2");
    for content in [
        "<g transform='translate(-7 3) scale(0.5)'><path d='M 20 80 h 2 a 6 6 0 0 0 6 -6 l 2 -4'/></g>",
        "<g transform='matrix(0 -1 1 0 0 50)'><path d='M 10 40 v 1 a 3 3 0 0 0 3 3 l 2 1'/></g>",
        "<g transform='translate(20)'><g transform='scale(-1 1)'>\
         <path transform='translate(3 -4)' d='M -4 40 h -1 a 3 3 0 0 1 -3 -3 l -1 -2'/></g></g>",
        "<path transform='scale(1 0.5)' d='M 10 40 h 1 a 3 6 0 0 0 3 -6 l 1 -4'/>",
    ] {
        let profile = read(&sheet(content)).unwrap();
        assert_same(&profile, &straight);
        assert_eq!(arcs(&profile), 1, "{content}");
    }
}

#[test]
fn an_elliptic_arc_is_met_from_below() {
    // Semi-axes 5 and 2, curving upward: tangents.
    let dish = drawn("M 0 40 A 5 2 0 0 0 5 38");
    check_heights(&dish, BELOW_MM, |r| 2.0 - 2.0 * (1.0 - r * r / 25.0).sqrt());
    assert_eq!(arcs(&dish), 0);
    // Curving downward: chords.
    let round = drawn("M 0 40 A 5 2 0 0 1 5 38");
    check_heights(&round, BELOW_MM, |r| 2.0 * (1.0 - (1.0 - r / 5.0).powi(2)).sqrt());
}

#[test]
fn bezier_curves_are_met_from_below() {
    // Quadratics that are parabolas h = r²/4 and h = 2·√r.
    check_heights(&drawn("M 0 40 Q 2 40 4 36"), BELOW_MM, |r| r * r / 4.0);
    check_heights(&drawn("M 0 40 Q 0 38 4 36"), BELOW_MM, |r| 2.0 * r.sqrt());
    // Cubics: h = r³/16, and one with an inflection, h = 9t² - 6t³ at r = 3t.
    check_heights(
        &drawn("M 0 40 C 1.3333333333333333 40 2.6666666666666667 40 4 36"),
        BELOW_MM,
        |r| r * r * r / 16.0,
    );
    check_heights(&drawn("M 0 40 C 1 40 2 37 3 37"), BELOW_MM, |r| {
        let t = r / 3.0;
        3.0 * (3.0 * t * t - 2.0 * t * t * t)
    });
    // Smooth commands mirror the control point before.
    let smooth = drawn("M 0 40 C 1 40 2 37 3 37 S 5 34 6 34");
    assert_same(&smooth, &drawn("M 0 40 C 1 40 2 37 3 37 C 4 37 5 34 6 34"));
    assert_same(&drawn("M 0 40 q 1 0 2 -1 t 2 -3"), &drawn("M 0 40 q 1 0 2 -1 q 1 -1 2 -3"));
}

#[test]
fn a_bezier_that_is_straight_is_a_line() {
    assert_eq!(drawn("M 0 40 C 1 39 2 38 3 37").segments().len(), 1);
    assert_eq!(drawn("M 0 40 C 0 40 3 37 3 37").segments().len(), 1);
}

#[test]
fn noise_is_straightened() {
    let clean = drawn("M 10 40 h 2 a 3 3 0 0 0 3 -3 v -1 h 1");
    let noisy = drawn("M 10 40 L 12 40.0000004 A 3 3 0 0 0 15.0000003 37.0000002 L 15 36 h 1");
    assert_eq!(noisy.segments().len(), clean.segments().len());
    for k in 0..=600 {
        let r = f64::from(k) * 0.01;
        assert!((noisy.height(r) - clean.height(r)).abs() < 1e-5 || (r - 5.0).abs() < 1e-9, "{r}");
    }
}

#[test]
fn an_arc_a_little_past_upright_is_kept() {
    // Its numbers are rounded, so the circle's centre is a little off.
    let ball = drawn("M 10 40 A 3.1747 3.1747 0 0 0 13.175 36.825");
    assert_eq!(arcs(&ball), 1);
    check_heights(&ball, 1e-3, |r| 3.175 - (3.175 * 3.175 - r * r).max(0.0).sqrt());
}

#[test]
fn undercuts_are_refused_with_their_place() {
    assert_eq!(
        refused("M 10 40 h 3 l -1 -2"),
        "the profile goes inward from r 3 mm, h 0 mm to r 2 mm, h 2 mm (r from the axis, h above the \
         tip); a cutter with an undercut can't be used, so draw it running outward and upward only"
    );
    assert!(
        refused("M 10 40 l 3 -2 l 1 1 l 1 -4").contains("goes down from r 3 mm, h 2 mm to r 4 mm")
    );
    // A lollipop: its ball goes in again above its equator.
    assert!(
        refused("M 10 40 a 3 3 0 0 0 2.4 -4.8").contains("inward from r 3 mm, h 3 mm to r 2.4 mm")
    );
    // A Bézier that bulges outward.
    assert!(refused("M 10 40 C 18 40 18 35 12 35").contains("goes inward"));
}

#[test]
fn only_one_open_right_half_is_taken() {
    let path = "<path d='M 10 40 h 3 v -2'/>";
    assert_eq!(
        refusal(&format!("{path}<g>{path}</g>")),
        "the drawing shows 2 shapes; leave only the profile, or give the profile the id \"profile\""
    );
    assert!(read(&sheet(&format!("{path}<path id='profile' d='M 0 9 h 2'/>"))).is_ok());
    assert!(
        read(&sheet(&format!("{path}<g display='none'>{path}</g><defs>{path}</defs>"))).is_ok()
    );
    assert!(refusal("<g/>").contains("no path, polyline or line"));
    assert!(refusal("<circle id='profile' r='3'/>").contains("drawn as a <circle>"));
    assert!(refused("M 10 40 h 3 v -2 z").contains("closed path"));
    assert!(refused("M 10 40 h 3 m 1 0 h 3").contains("several pieces"));
    assert_eq!(drawn("M 10 40 h -3"), Profile::flat(3.0).unwrap());
    assert!(refused("M 10 40 l -3 -3").contains("draw the right half"));
    assert!(refusal(&format!("<svg>{path}</svg>")).contains("<svg> within the <svg>"));
    assert!(
        refusal(&format!("<g style='transform:scale(2)'>{path}</g>")).contains("as an attribute")
    );
}

#[test]
fn sizes_that_are_no_cutter_are_refused() {
    assert_eq!(
        refused("M 0 40 h 150"),
        "the drawing makes a cutter of 300 mm in diameter; it must be 0.01 to 200 mm. Check the \
         drawing's width, height and viewBox, which give its scale"
    );
    assert!(refused("M 10 40 v -3").contains("a cutter of 0 mm in diameter"));
    assert!(refused("M 10 40 h 1e9").contains("more than 1000 mm"));
    assert!(refused("M 10 40 h 1e300 h 1e308 h 1e308").contains("more than 1000 mm"));
}

#[test]
fn texts_beyond_the_limits_are_refused() {
    let long = sheet(&" ".repeat(300_000));
    assert!(read(&long).unwrap_err().to_string().contains("at most 262144 are read"));
    let many = format!("M 0 40 {}", "h 0.001 ".repeat(2_001));
    assert!(refused(&many).contains("more than 2000 path commands"));
    let curves = format!("M 0 40 {}", "c .9 0 1 -.1 1 -1 ".repeat(90));
    assert!(refused(&curves).contains("more than 2000 lines and arcs"));
}

#[test]
fn what_cannot_be_read_is_quoted() {
    assert!(
        refused("M 10 40 h three")
            .contains("the drawing's path \"M 10 40 h three\" cannot be read")
    );
    assert!(refusal("<path transform='turn(3)' d='M 0 9 h 2'/>").contains("transform \"turn(3)\""));
    assert!(read("<svg").unwrap_err().to_string().contains("not SVG that can be read"));
    assert!(read("<html/>").unwrap_err().to_string().contains("a <html> document"));
}

#[test]
fn bombs_do_not_go_off() {
    let deep = sheet(&format!("{}{}", "<g>".repeat(30_000), "</g>".repeat(30_000)));
    assert!(read(&deep).is_err());
    let entity = format!("<!ENTITY a \"{}\">", "0 ".repeat(60_000));
    let laughs =
        format!("<!DOCTYPE svg [{entity}]><svg><path d='{}'/></svg>", "&a;".repeat(30_000));
    assert!(read(&laughs).unwrap_err().to_string().contains("defines entities"));
    let nested: String = (0..200).map(|k| format!("<g xmlns:a{k}='u{k}'>")).collect();
    let names = sheet(&format!("{nested}{}", "</g>".repeat(200)));
    assert!(read(&names).unwrap_err().to_string().contains("more than 100 XML namespaces"));
}

#[test]
fn a_drawing_may_name_a_dtd() {
    let dtd = "<!DOCTYPE svg PUBLIC '-//W3C//DTD SVG 1.1//EN' 'http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd'>";
    let text = format!("<?xml version='1.0'?>{dtd}{}", sheet("<path d='M 0 9 h 2'/>"));
    assert_eq!(read(&text).unwrap(), Profile::flat(2.0).unwrap());
}
