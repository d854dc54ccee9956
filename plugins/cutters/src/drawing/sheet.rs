//! Finds the profile's shape in a drawing, and the scale it is drawn in.

use super::curve::Curve;
use super::{DrawingError, MAX_NAMESPACES, outline};
use kurbo::Affine;
use roxmltree::{Document, Node, ParsingOptions};
use std::str::FromStr;
use svgtypes::{Align, AspectRatio, Length, LengthUnit, Transform, ViewBox};

/// SVG 2, section 8.9, and CSS: 96 px an inch.
const PX_MM: f64 = 25.4 / 96.0;

/// Elements that draw something of their own.
const SHAPES: [&str; 7] = ["path", "polyline", "line", "polygon", "rect", "circle", "ellipse"];

/// Elements whose children are shown elsewhere, or not at all.
const DEFINITIONS: [&str; 7] =
    ["defs", "clipPath", "mask", "marker", "pattern", "symbol", "metadata"];

const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// The curves of the profile's shape in the order drawn; mm, y down.
pub(super) fn profile_curves(text: &str) -> Result<Vec<Curve>, DrawingError> {
    if text.contains("<!ENTITY") {
        return Err(DrawingError::Entities);
    }
    if text.matches("xmlns").count() > MAX_NAMESPACES {
        return Err(DrawingError::TooManyNamespaces);
    }
    // Illustrator and CorelDRAW name a DTD; without entities it changes nothing.
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(DrawingError::NotSvg(root.tag_name().name().to_owned()));
    }
    let shape = profile_shape(root)?;
    let to_mm = to_mm(root, shape)?;
    let curves = curves_of(shape)?;
    Ok(curves.into_iter().map(|curve| curve.transformed(to_mm)).collect())
}

/// The only shape, or the one that is called `profile`.
fn profile_shape<'a>(root: Node<'a, 'a>) -> Result<Node<'a, 'a>, DrawingError> {
    let shapes = shapes_shown(root);
    let named: Vec<_> = shapes.iter().filter(|shape| is_called_profile(shape)).collect();
    match (&named[..], &shapes[..]) {
        ([shape], _) => Ok(**shape),
        ([], [shape]) => Ok(*shape),
        ([], []) => Err(DrawingError::NoShape),
        ([], several) => Err(DrawingError::Several(several.len())),
        (several, _) => Err(DrawingError::SeveralProfiles(several.len())),
    }
}

fn is_called_profile(shape: &Node) -> bool {
    [shape.attribute("id"), shape.attribute((INKSCAPE, "label"))].contains(&Some("profile"))
}

/// All shapes that are drawn where they stand and not hidden.
fn shapes_shown<'a>(root: Node<'a, 'a>) -> Vec<Node<'a, 'a>> {
    let mut shapes = Vec::new();
    let mut open = vec![root];
    while let Some(node) = open.pop() {
        let name = node.tag_name().name();
        if !node.is_element() || DEFINITIONS.contains(&name) || is_hidden(node) {
            continue;
        }
        if SHAPES.contains(&name) {
            shapes.push(node);
        }
        open.extend(node.children());
    }
    shapes
}

fn is_hidden(node: Node) -> bool {
    node.attribute("display") == Some("none") || style_of(node, "display") == Some("none")
}

/// The value of a property in an element's `style`.
fn style_of<'a>(node: Node<'a, '_>, property: &str) -> Option<&'a str> {
    let declarations = node.attribute("style")?.split(';').filter_map(|d| d.split_once(':'));
    let mut values = declarations.filter(|(name, _)| name.trim() == property);
    values.next().map(|(_, value)| value.trim())
}

fn curves_of(shape: Node) -> Result<Vec<Curve>, DrawingError> {
    match shape.tag_name().name() {
        "path" => outline::path(shape.attribute("d").unwrap_or_default()),
        // Its points are written as those of a path are.
        "polyline" => outline::path(&match shape.attribute("points") {
            Some(points) => format!("M{points}"),
            None => String::new(),
        }),
        "line" => {
            let at = |name| coordinate(shape, name);
            Ok(vec![Curve::line((at("x1")?, at("y1")?), (at("x2")?, at("y2")?))])
        }
        closed => Err(DrawingError::NotOpen(closed.to_owned())),
    }
}

/// A coordinate of a `<line>`, in units of the drawing; 0 if it is not written.
fn coordinate(line: Node, name: &'static str) -> Result<f64, DrawingError> {
    let text = line.attribute(name).unwrap_or("0");
    text.trim().parse().map_err(|_| unreadable(name, text, "it must be a number without a unit"))
}

/// From the shape's units to mm.
fn to_mm(root: Node, shape: Node) -> Result<Affine, DrawingError> {
    let mut total = Affine::IDENTITY;
    for node in shape.ancestors().filter(Node::is_element) {
        if style_of(node, "transform").is_some_and(|value| value != "none") {
            return Err(DrawingError::StyleTransform);
        }
        if node == root {
            total = scale(root)? * total;
        } else if node.tag_name().name() == "svg" {
            return Err(DrawingError::Nested);
        }
        total = transform(node)? * total;
    }
    Ok(total)
}

fn transform(node: Node) -> Result<Affine, DrawingError> {
    let Some(text) = node.attribute("transform") else { return Ok(Affine::IDENTITY) };
    let t: Transform = read("transform", text)?;
    Ok(Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]))
}

/// mm a unit of the drawing, along x and y.
fn scale(root: Node) -> Result<Affine, DrawingError> {
    let Some(view) = root.attribute("viewBox") else { return Ok(Affine::scale(PX_MM)) };
    let view: ViewBox = read("viewBox", view)?;
    let (x, y) = (length_mm(root, "width")?, length_mm(root, "height")?);
    let aspect = root.attribute("preserveAspectRatio");
    let aspect: Option<AspectRatio> = aspect.map(|a| read("preserveAspectRatio", a)).transpose()?;
    Ok(match (x.map(|x| x / view.w), y.map(|y| y / view.h)) {
        (Some(x), Some(y)) => match aspect {
            Some(AspectRatio { align: Align::None, .. }) => Affine::scale_non_uniform(x, y),
            Some(AspectRatio { slice: true, .. }) => Affine::scale(x.max(y)),
            _ => Affine::scale(x.min(y)),
        },
        (Some(one), None) | (None, Some(one)) => Affine::scale(one),
        (None, None) => Affine::scale(PX_MM),
    })
}

/// A length of the drawing; `None` if it is not written, or relative to where it is shown.
fn length_mm(root: Node, name: &'static str) -> Result<Option<f64>, DrawingError> {
    let Some(text) = root.attribute(name).filter(|text| text.trim() != "auto") else {
        return Ok(None);
    };
    let length: Length = read(name, text)?;
    let unit = match length.unit {
        LengthUnit::None | LengthUnit::Px => PX_MM,
        LengthUnit::Mm => 1.0,
        LengthUnit::Cm => 10.0,
        LengthUnit::In => 25.4,
        LengthUnit::Pt => 25.4 / 72.0,
        LengthUnit::Pc => 25.4 / 6.0,
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => return Ok(None),
    };
    Ok(Some(length.number * unit))
}

fn read<T: FromStr<Err: ToString>>(what: &'static str, text: &str) -> Result<T, DrawingError> {
    text.parse().map_err(|e: T::Err| unreadable(what, text, &e.to_string()))
}

/// An error that quotes no more of the text than a message can hold.
pub(super) fn unreadable(what: &'static str, text: &str, why: &str) -> DrawingError {
    const QUOTED: usize = 40;
    let text = text.chars().take(QUOTED).collect();
    DrawingError::Unreadable { what, text, why: why.to_owned() }
}
