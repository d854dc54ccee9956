//! A mask of an SVG drawing.
//!
//! usvg resolves the drawing: shapes, groups, transforms, styles, units, `use`, strokes, view box.
//! Of each path the fill, by its own fill rule, and the stroke with its dashes are outlines; clip
//! paths cut them. What is transparent or hidden does not count, any other opacity counts as whole. Where
//! white is to cut out what lies beneath, outlines are put together in the order painted.
//!
//! A drawing is untrusted: entities are refused, nothing it names outside of itself is read, and its
//! size and depth are limited. Text, pictures, masks and filters are left out with a warning.

use super::sheet::{Drawn, Ground, Place, Sheet};
use carvegraph_core::{Choice, Context, InputFile, Node, NodeError, Params};
use carvegraph_geometry::{DVec2, Filling, Polygon};
use kurbo::{Affine, BezPath};
use std::thread;
use usvg::roxmltree::{self, Document, ParsingOptions};
use usvg::tiny_skia_path::{Path as Outline, PathSegment, Point, Transform};
use usvg::{ClipPath, FillRule, Group, ImageHrefResolver, Options, Paint, PaintOrder, Path, Tree};

/// The longest drawing read, in bytes. Traced pictures have a few million.
const MAX_BYTES: usize = 32 << 20;

/// Elements; each takes some hundred bytes several times over.
const MAX_ELEMENTS: u32 = 500_000;

/// XML namespaces; reading takes time by their square. Drawing programs declare a dozen.
const MAX_NAMESPACES: usize = 100;

/// usvg follows 1024 levels of groups and uses by calling itself, each with some kilobytes.
const STACK_BYTES: usize = 64 << 20;

/// SVG 2, section 8.9, and CSS: 96 px an inch.
const PX_MM: f64 = 25.4 / 96.0;

/// A line is offset as if it were drawn so many times as large: its curves are off by 1/128 of a pixel.
const STROKE_FINENESS: f64 = 32.0;

/// A colour of less luminance is dark.
const DARK: f64 = 0.5;

/// Selects what a drawing (.svg) shows: filled shapes and strokes.
#[derive(Clone, Debug, Params)]
pub(crate) struct SvgMask {
    /// The drawing's file.
    #[param()]
    pub(crate) path: InputFile,
    /// Which colours count.
    #[param(default = Select::Drawn)]
    pub(crate) select: Select,
    /// What of the drawing is placed.
    #[param(default = Frame::Drawing)]
    pub(crate) frame: Frame,
    /// How large it is placed.
    #[param(default = Placement::Fit)]
    pub(crate) placement: Placement,
    /// Room on all sides for a drawing that is fitted or stretched.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
    pub(crate) margin: f64,
    /// Size of what was placed.
    #[param(unit = "%", default = 100.0, range = 0.01..=100_000.0)]
    pub(crate) scale: f64,
    #[param(shared)]
    pub(crate) place: Place,
}

/// Which colours of a drawing count.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Select {
    /// All that is drawn, whatever its colour.
    Drawn,
    /// What is dark in the end: bright shapes take away from those beneath.
    Dark,
}

/// What of a drawing is placed.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Frame {
    /// What is drawn, without the empty page around it.
    Drawing,
    /// The page, as its view box and size say.
    Page,
}

/// How large a drawing is placed.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Placement {
    /// As large as fits, in proportion.
    Fit,
    /// Over the whole width and height.
    Stretch,
    /// At the size that it has.
    Size,
}

/// Why a file gives no mask; the message follows the file's name.
#[derive(Debug, thiserror::Error)]
enum DrawingError {
    #[error("has {0} bytes; at most {MAX_BYTES} are read: save it without pictures in it")]
    TooLong(usize),
    #[error("is no SVG drawing: it is no text")]
    NoText,
    #[error("defines entities (<!ENTITY ...>), which could blow up: save it as plain SVG")]
    Entities,
    #[error("declares more than {MAX_NAMESPACES} XML namespaces: save it as plain SVG")]
    TooManyNamespaces,
    #[error("is no SVG drawing that can be read: {0}")]
    Xml(#[from] roxmltree::Error),
    #[error("is a <{0}> document; it must be an <svg>")]
    NotSvg(String),
    #[error("nests deeper than 1024 groups or has more than a million elements with those it uses")]
    TooDeep,
    #[error("cannot be drawn: {0}")]
    Svg(usvg::Error),
    #[error("draws nothing: it has no shape with a fill or a stroke")]
    Empty,
    #[error("has {0}")]
    TooMuch(NodeError),
    #[error("cannot be read: no thread could be begun: {0}")]
    Thread(#[from] std::io::Error),
    #[error("made the reader of drawings fail")]
    Panicked,
    #[error("was not read to its end")]
    Cancelled,
}

impl Node for SvgMask {
    const KIND: &'static str = "svg_mask";
    type Inputs<'a> = Ground<'a>;
    type Outputs = Drawn;

    fn run(&self, ground: Ground<'_>, cx: &Context<'_>) -> Result<Drawn, NodeError> {
        let sheet = ground.sheet(self.place.picture_width)?;
        let (size, room) = (sheet.size_mm, sheet.size_mm - 2.0 * self.margin);
        if self.placement != Placement::Size && room.min_element() <= 0.0 {
            let message = format!("it leaves no room on {:.3} × {:.3} mm", size.x, size.y);
            return Err(NodeError::refused("margin", message));
        }
        let bytes = cx.read(&self.path)?;
        let outline = self.outline(&bytes, sheet, cx).map_err(|fault| match fault {
            _ if cx.is_cancelled() => NodeError::Cancelled,
            fault => NodeError::Failed(format!("{} {fault}", self.path)),
        })?;
        Ok(Drawn { mask: sheet.cover(outline.as_ref(), cx)? })
    }
}

impl SvgMask {
    /// What is selected, in pixels. Drawings nest deeper than the pool's stacks are.
    fn outline(
        &self,
        bytes: &[u8],
        sheet: Sheet,
        cx: &Context<'_>,
    ) -> Result<Option<Polygon>, DrawingError> {
        let work = || {
            let tree = read(bytes, cx)?;
            let place = self.place(&tree, sheet)?;
            let mut canvas = Canvas::new(self.select, cx);
            canvas.group(tree.root(), place, None)?;
            if !canvas.is_drawn {
                return Err(DrawingError::Empty);
            }
            Ok(canvas.finish())
        };
        thread::scope(|scope| {
            let reader =
                thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, work)?;
            reader.join().map_err(|_| DrawingError::Panicked)?
        })
    }

    /// From the drawing's units to pixels.
    fn place(&self, tree: &Tree, sheet: Sheet) -> Result<Affine, DrawingError> {
        let drawn = tree.root().abs_stroke_bounding_box();
        let [left, top, width, height] = match self.frame {
            Frame::Page => [0.0, 0.0, tree.size().width(), tree.size().height()],
            Frame::Drawing => [drawn.left(), drawn.top(), drawn.width(), drawn.height()],
        }
        .map(f64::from);
        let room = (sheet.size_mm - 2.0 * self.margin).max(DVec2::ZERO);
        // A straight stroke along an axis has no extent across it.
        let across = DVec2::new(width, height).max(DVec2::splat(f64::MIN_POSITIVE));
        let fit = room / across;
        let scale = match self.placement {
            Placement::Fit => DVec2::splat(fit.min_element()),
            Placement::Stretch => fit,
            Placement::Size => DVec2::splat(PX_MM),
        } * self.scale
            / 100.0;
        if !scale.is_finite() || tree.root().children().is_empty() {
            return Err(DrawingError::Empty);
        }
        let middle = (left + 0.5 * width, top + 0.5 * height);
        Ok(sheet.to_pixels()
            * self.place.to_sheet()
            * Affine::scale_non_uniform(scale.x, -scale.y)
            * Affine::translate((-middle.0, -middle.1)))
    }
}

/// Reads a drawing and warns of what of it is left out.
fn read(bytes: &[u8], cx: &Context<'_>) -> Result<Tree, DrawingError> {
    if bytes.len() > MAX_BYTES {
        return Err(DrawingError::TooLong(bytes.len()));
    }
    let text = std::str::from_utf8(bytes).map_err(|_| DrawingError::NoText)?;
    if text.contains("<!ENTITY") {
        return Err(DrawingError::Entities);
    }
    if text.matches("xmlns").count() > MAX_NAMESPACES {
        return Err(DrawingError::TooManyNamespaces);
    }
    // Illustrator and CorelDRAW name a DTD; without entities it changes nothing.
    let options =
        ParsingOptions { allow_dtd: true, nodes_limit: MAX_ELEMENTS, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)?;
    let root = document.root_element().tag_name().name();
    if root != "svg" {
        return Err(DrawingError::NotSvg(root.to_owned()));
    }
    warn_of_what_is_left_out(&document, cx);
    let options = Options {
        image_href_resolver: ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..Options::default()
    };
    Tree::from_xmltree(&document, &options).map_err(|fault| match fault {
        usvg::Error::ElementsLimitReached
        | usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached) => DrawingError::TooDeep,
        other => DrawingError::Svg(other),
    })
}

fn warn_of_what_is_left_out(document: &Document<'_>, cx: &Context<'_>) {
    for (element, advice) in [
        ("text", "convert it to paths in the drawing program, or write it with text_mask"),
        ("image", "trace it, or load it with load_mask"),
        ("mask", "cut the shapes in the drawing program"),
        ("filter", "leave only shapes"),
    ] {
        let named = |node: &roxmltree::Node<'_, '_>| node.tag_name().name() == element;
        let count = document.descendants().filter(named).count();
        if count > 0 {
            cx.warn(format!("the drawing has {count} <{element}>, which is left out: {advice}"));
        }
    }
}

/// What of a drawing is selected so far, in pixels.
struct Canvas<'a> {
    cx: &'a Context<'a>,
    select: Select,
    selected: Option<Polygon>,
    /// Painted one after the other and not yet put together: one union takes less than many.
    pending: Vec<Polygon>,
    /// Whether what is pending takes away.
    takes_away: bool,
    is_drawn: bool,
}

impl<'a> Canvas<'a> {
    fn new(select: Select, cx: &'a Context<'a>) -> Self {
        let (selected, pending) = (None, Vec::new());
        Self { cx, select, selected, pending, takes_away: false, is_drawn: false }
    }

    fn group(
        &mut self,
        group: &Group,
        place: Affine,
        clip: Option<&Clip>,
    ) -> Result<(), DrawingError> {
        if group.opacity().get() == 0.0 {
            return Ok(());
        }
        let own = match group.clip_path() {
            Some(path) => Some(self.clip(path, place * affine(group.abs_transform()), clip)?),
            None => None,
        };
        let clip = own.as_ref().or(clip);
        for node in group.children() {
            match node {
                usvg::Node::Group(inner) => self.group(inner, place, clip)?,
                usvg::Node::Path(path) if path.is_visible() => self.path(path, place, clip)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn path(
        &mut self,
        path: &Path,
        place: Affine,
        clip: Option<&Clip>,
    ) -> Result<(), DrawingError> {
        if self.cx.is_cancelled() {
            return Err(DrawingError::Cancelled);
        }
        let mut painted = [fill_of(path, place)?, stroke_of(path, place)?];
        if path.paint_order() == PaintOrder::StrokeAndFill {
            painted.reverse();
        }
        for (outline, is_dark) in painted.into_iter().flatten() {
            self.is_drawn = true;
            let clipped = match clip {
                Some(clip) => clip.0.as_ref().and_then(|clip| outline.and(clip)),
                None => Some(outline),
            };
            if let Some(outline) = clipped {
                self.paint(outline, self.select == Select::Dark && !is_dark);
            }
        }
        Ok(())
    }

    fn paint(&mut self, outline: Polygon, takes_away: bool) {
        if takes_away != self.takes_away {
            self.settle();
            self.takes_away = takes_away;
        }
        self.pending.push(outline);
    }

    fn settle(&mut self) {
        let pending = std::mem::take(&mut self.pending);
        let Some(pending) = union(pending, &|| self.cx.is_cancelled()) else { return };
        self.selected = match self.selected.take() {
            Some(selected) if self.takes_away => selected.minus(&pending),
            Some(selected) => selected.or(&pending),
            None => (!self.takes_away).then_some(pending),
        };
    }

    fn finish(mut self) -> Option<Polygon> {
        self.settle();
        self.selected
    }

    /// What a clip path lets through; `place` is that of the group that it clips.
    fn clip(
        &self,
        path: &ClipPath,
        place: Affine,
        within: Option<&Clip>,
    ) -> Result<Clip, DrawingError> {
        let mut canvas = Self::new(Select::Drawn, self.cx);
        canvas.group(path.root(), place * affine(path.transform()), within)?;
        let own = canvas.finish();
        Ok(match path.clip_path() {
            Some(also) => {
                let also = self.clip(also, place, None)?;
                Clip(own.and_then(|own| also.0.and_then(|also| own.and(&also))))
            }
            None => Clip(own),
        })
    }
}

/// What a clip path lets through; nothing if it is empty.
struct Clip(Option<Polygon>);

/// A union by halves, so that no outline is gone through more often than the logarithm of their
/// number; nothing if it is to stop.
fn union(mut outlines: Vec<Polygon>, stop: &dyn Fn() -> bool) -> Option<Polygon> {
    while outlines.len() > 1 {
        let pairs = outlines.chunks(2).map(|pair| match pair {
            [a, b] if !stop() => a.or(b),
            [_, _] => None,
            other => other.first().cloned(),
        });
        outlines = pairs.flatten().collect();
    }
    outlines.pop()
}

/// An outline, and whether it is dark.
type Painted = (Polygon, bool);

fn fill_of(path: &Path, place: Affine) -> Result<Option<Painted>, DrawingError> {
    let Some(fill) = path.fill().filter(|fill| fill.opacity().get() > 0.0) else { return Ok(None) };
    let filling = match fill.rule() {
        FillRule::NonZero => Filling::NonZero,
        FillRule::EvenOdd => Filling::EvenOdd,
    };
    let place = place * affine(path.abs_transform());
    let inside = Sheet::inside(&(place * bez_path(path.data())), filling);
    let inside = inside.map_err(DrawingError::TooMuch)?;
    Ok(inside.map(|inside| (inside, is_dark(fill.paint()))))
}

fn stroke_of(path: &Path, place: Affine) -> Result<Option<Painted>, DrawingError> {
    let visible = path.stroke().filter(|stroke| stroke.opacity().get() > 0.0);
    let Some(stroke) = visible else { return Ok(None) };
    let place = place * affine(path.abs_transform());
    let fineness = (STROKE_FINENESS * place.determinant().abs().sqrt()) as f32;
    let pen = stroke.to_tiny_skia();
    let dashed = pen.dash.as_ref().and_then(|dash| path.data().dash(dash, fineness));
    let line = dashed.as_ref().unwrap_or(path.data());
    let Some(outline) = line.stroke(&pen, fineness) else { return Ok(None) };
    let inside = Sheet::inside(&(place * bez_path(&outline)), Filling::NonZero);
    let inside = inside.map_err(DrawingError::TooMuch)?;
    Ok(inside.map(|inside| (inside, is_dark(stroke.paint()))))
}

/// Whether a paint's luminance, that of a gradient's colours in the mean, is below half.
fn is_dark(paint: &Paint) -> bool {
    let luminance = |color: usvg::Color| {
        let share = [color.red, color.green, color.blue].map(|c| f64::from(c) / 255.0);
        0.299 * share[0] + 0.587 * share[1] + 0.114 * share[2]
    };
    let mean = |stops: &[usvg::Stop]| {
        let sum: f64 = stops.iter().map(|stop| luminance(stop.color())).sum();
        sum / stops.len().max(1) as f64
    };
    let found = match paint {
        Paint::Color(color) => luminance(*color),
        Paint::LinearGradient(gradient) => mean(gradient.stops()),
        Paint::RadialGradient(gradient) => mean(gradient.stops()),
        Paint::Pattern(_) => 0.0,
    };
    found < DARK
}

fn affine(transform: Transform) -> Affine {
    let Transform { sx, kx, ky, sy, tx, ty } = transform;
    Affine::new([sx, ky, kx, sy, tx, ty].map(f64::from))
}

fn bez_path(outline: &Outline) -> BezPath {
    let at = |p: Point| (f64::from(p.x), f64::from(p.y));
    let mut path = BezPath::new();
    for segment in outline.segments() {
        match segment {
            PathSegment::MoveTo(to) => path.move_to(at(to)),
            PathSegment::LineTo(to) => path.line_to(at(to)),
            PathSegment::QuadTo(p1, to) => path.quad_to(at(p1), at(to)),
            PathSegment::CubicTo(p1, p2, to) => path.curve_to(at(p1), at(p2), at(to)),
            PathSegment::Close => path.close_path(),
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::super::sheet::MIDDLE;
    use super::super::sheet::testing::{extent, on_image};
    use super::*;
    use carvegraph_core::Origin;
    use std::f64::consts::PI;

    const SIZE: [usize; 2] = [200, 100];

    /// A node that draws `content` on a page of 200 × 100.
    fn drawing(content: &str) -> (SvgMask, tempfile::TempDir) {
        let folder = tempfile::tempdir().unwrap();
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 200 100'>\n{content}\n</svg>"
        );
        std::fs::write(folder.path().join("drawing.svg"), text).unwrap();
        let path = Origin::Folder(folder.path().to_owned()).locate("drawing.svg");
        let node = SvgMask {
            path,
            select: Select::Drawn,
            frame: Frame::Page,
            placement: Placement::Fit,
            margin: 0.0,
            scale: 100.0,
            place: MIDDLE,
        };
        (node, folder)
    }

    /// The pixels that `content` covers of a picture as large as the page.
    #[track_caller]
    fn assert_covers(content: &str, expected: f64) {
        let (node, _folder) = drawing(content);
        let found = on_image(&node, SIZE).unwrap().selected_px();
        assert!((found - expected).abs() < 1e-3 * expected, "{found} {expected}: {content}");
    }

    #[track_caller]
    fn assert_refused(content: &str, told: &str) {
        let (node, _folder) = drawing(content);
        let message = on_image(&node, SIZE).unwrap_err();
        assert!(message.ends_with(told), "{message}");
    }

    #[test]
    fn shapes_cover_their_areas() {
        assert_covers("<circle cx='100' cy='50' r='40'/>", PI * 1600.0);
        assert_covers("<ellipse cx='100' cy='50' rx='80' ry='20'/>", PI * 1600.0);
        assert_covers(
            "<rect x='10.25' y='10' width='50' height='20' rx='5'/>",
            1000.0 - (4.0 - PI) * 25.0,
        );
        assert_covers("<polygon points='0,0 100,0 0,50'/>", 2500.0);
        assert_covers("<path d='M10 10h50v50h-50z m10 10v30h30v-30z'/>", 2500.0 - 900.0);
    }

    #[test]
    fn strokes_are_as_wide_as_they_are_drawn() {
        let stroke = "fill='none' stroke='#000' stroke-width='4'";
        assert_covers(&format!("<line x1='20' y1='20' x2='120' y2='20' {stroke}/>"), 400.0);
        assert_covers(
            &format!("<circle cx='99' cy='50' r='30' {stroke}/>"),
            PI * (32.0 * 32.0 - 28.0 * 28.0),
        );
        let dashed = format!("<polyline points='20,20 120,20' stroke-dasharray='5' {stroke}/>");
        assert_covers(&dashed, 200.0);
        assert_covers(&format!("<g transform='scale(2)'><path d='M9 9h50' {stroke}/></g>"), 800.0);
    }

    #[test]
    fn fill_rules_tell_whether_what_is_twice_surrounded_is_a_hole() {
        let loops = "d='M0 0h60v60h-60z M20 20h20v20h-20z'";
        assert_covers(&format!("<path {loops}/>"), 3600.0);
        assert_covers(&format!("<path fill-rule='evenodd' {loops}/>"), 3200.0);
    }

    #[test]
    fn groups_styles_uses_and_clips_are_followed() {
        assert_covers(
            "<style>.out { display: none }</style><defs><rect id='r' width='10' height='10'/></defs>
             <g transform='translate(20 20) rotate(30)'><use href='#r' x='30'/></g>
             <use href='#r' transform='scale(2)'/><rect class='out' width='99' height='99'/>
             <g opacity='0'><rect width='99' height='99'/></g>",
            500.0,
        );
        assert_covers(
            "<clipPath id='c'><circle cx='50' cy='50' r='30'/></clipPath>
             <g clip-path='url(#c)'><rect width='50' height='100'/></g>",
            PI * 900.0 / 2.0,
        );
    }

    #[test]
    fn shapes_that_share_an_edge_show_no_seam() {
        let halves = "<path d='M0 0H77.3L50.7 100H0z'/><path d='M77.3 0H200V100H50.7z'/>";
        let (node, _folder) = drawing(halves);
        let mask = on_image(&node, SIZE).unwrap();
        assert!(mask.values.iter().all(|share| *share > 0.999));
    }

    #[test]
    fn white_on_dark_takes_away_where_dark_is_selected() {
        let content =
            "<rect width='100' height='100'/><rect fill='#fff' x='20' width='50' height='50'/>
                       <rect fill='navy' x='20' width='10' height='10'/>";
        assert_covers(content, 10_000.0);
        let (node, _folder) = drawing(content);
        let dark = SvgMask { select: Select::Dark, ..node };
        assert_eq!(on_image(&dark, SIZE).unwrap().selected_px(), 10_000.0 - 2500.0 + 100.0);
    }

    #[test]
    fn it_is_placed_as_told() {
        let (node, _folder) = drawing("<rect x='20' y='10' width='40' height='20' fill='red'/>");
        let extent = |node: &SvgMask, size| extent(&on_image(node, size).unwrap());
        assert_eq!(extent(&node, SIZE), [20.0, 10.0, 60.0, 30.0]);
        // The page keeps its proportions on a higher picture, or is stretched.
        assert_eq!(extent(&node, [200, 200]), [20.0, 60.0, 60.0, 80.0]);
        let stretched = SvgMask { placement: Placement::Stretch, ..node.clone() };
        assert_eq!(extent(&stretched, [200, 200]), [20.0, 20.0, 60.0, 60.0]);
        let filling = SvgMask { frame: Frame::Drawing, margin: 5.0, ..node.clone() };
        assert_eq!(extent(&filling, [200, 200]), [10.0, 55.0, 190.0, 145.0]);
        // 40 units are 10.58 mm; a millimetre is two pixels.
        let sized = SvgMask { placement: Placement::Size, ..filling };
        assert_eq!(extent(&sized, [200, 200]), [89.0, 94.0, 111.0, 106.0]);
        // Up to the left of the page's middle becomes down to the left of it.
        let turned = SvgMask { place: Place { x: 10.0, y: 5.0, turn: 90.0, ..MIDDLE }, ..node };
        assert_eq!(extent(&turned, [200, 200]), [80.0, 130.0, 100.0, 170.0]);
    }

    #[test]
    fn a_margin_that_leaves_no_room_is_refused() {
        let (node, _folder) = drawing("<rect width='9' height='9'/>");
        let told = on_image(&SvgMask { margin: 25.0, ..node }, SIZE).unwrap_err();
        assert_eq!(told, "it leaves no room on 100.000 × 50.000 mm");
    }

    #[test]
    fn what_is_no_drawing_is_told() {
        assert_refused("<g></g>", "draws nothing: it has no shape with a fill or a stroke");
        assert_refused(
            "<text>Hello</text>",
            "draws nothing: it has no shape with a fill or a stroke",
        );
        assert_refused(
            "<rect></g>",
            "is no SVG drawing that can be read: expected 'rect' tag, not 'g' at 2:7",
        );
        assert_refused(
            "<!ENTITY a 'b'>",
            "defines entities (<!ENTITY ...>), which could blow up: save it as plain SVG",
        );
        let deep = "<g opacity='0.5'>".repeat(1500) + "<rect/>" + &"</g>".repeat(1500);
        let told =
            "nests deeper than 1024 groups or has more than a million elements with those it uses";
        assert_refused(&deep, told);
        // Each use doubles the one before: 2³⁰ shapes.
        let doubled =
            |k: u32| format!("<g id='u{}'><use href='#u{k}'/><use href='#u{k}'/></g>", k + 1);
        let bomb: String = (0..30).map(doubled).collect();
        assert_refused(&format!("<rect id='u0' width='1' height='1'/>{bomb}"), told);
    }

    #[test]
    fn nothing_outside_of_the_drawing_is_read() {
        let picture = "<image href='/etc/hostname' width='9' height='9'/><use href='other.svg#r'/>";
        assert_refused(picture, "draws nothing: it has no shape with a fill or a stroke");
        assert_covers(&format!("{picture}<rect width='10' height='10'/>"), 100.0);
    }
}
