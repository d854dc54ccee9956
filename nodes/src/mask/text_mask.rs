//! A mask of lines of text.
//!
//! Letters are set as the font's outlines say, filled by the non-zero rule; its advances and the
//! pairs of its `kern` table give their places. There is one glyph for each character, from left to
//! right: no ligatures, no joined scripts. The size is that of capital letters, so that a
//! text of 10 mm has an H of 10 mm in every font; lines follow each other in the font's own distance.
//! The block's middle lies halfway between the top of its first line's capitals and its last
//! baseline.

use super::sheet::{Drawn, Ground, Place, Sheet};
use carvegraph_core::{Choice, Conflict, Context, InputFile, Node, NodeError, Params};
use carvegraph_geometry::Filling;
use kurbo::{Affine, BezPath};
use std::borrow::Cow;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// More than any plaque holds.
const MAX_CHARACTERS: usize = 5_000;

/// Height of capitals over the em, for fonts that tell neither it nor have an H.
const USUAL_CAPITAL: f64 = 0.7;

/// Selects the letters of a text.
#[derive(Clone, Debug, Params)]
pub(crate) struct TextMask {
    /// What is written. A new line begins at a line break, which may be written \n.
    #[param(default = "Carvegraph")]
    pub(crate) text: String,
    /// A font that comes with the program.
    #[param(default = Font::SansBold)]
    pub(crate) font: Font,
    /// A font of your own (.ttf, .otf) in its place.
    #[param(default = None)]
    pub(crate) font_file: Option<InputFile>,
    /// Height of the capital letters.
    #[param(unit = "mm", default = 10.0, range = 0.01..=10_000.0)]
    pub(crate) size: f64,
    /// The widest that the text may be: a wider one is made smaller; 0 leaves it.
    #[param(unit = "mm", default = 0.0, range = 0.0..=100_000.0)]
    pub(crate) fit_width: f64,
    /// What lines have in common, and which of it lies at x: their beginning, middle or end.
    #[param(default = Align::Center)]
    pub(crate) align: Align,
    /// Distance of lines, of that which the font has.
    #[param(unit = "%", default = 100.0, range = 10.0..=1000.0)]
    pub(crate) line_spacing: f64,
    /// Room added between letters, of the height of capitals.
    #[param(unit = "%", default = 0.0, range = -50.0..=1000.0)]
    pub(crate) letter_spacing: f64,
    #[param(shared)]
    pub(crate) place: Place,
}

/// The fonts that come with the program: DejaVu, for Latin, Greek, Cyrillic and more.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Font {
    /// Without serifs.
    Sans,
    /// Without serifs, in broad strokes, which cutters enter best.
    SansBold,
    /// With serifs.
    Serif,
    /// With serifs, in broad strokes.
    SerifBold,
}

/// What the lines of a text have in common.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Align {
    /// They begin at the same place.
    Left,
    /// They have the same middle.
    Center,
    /// They end at the same place.
    Right,
}

impl Node for TextMask {
    const KIND: &'static str = "text_mask";
    type Inputs<'a> = Ground<'a>;
    type Outputs = Drawn;

    fn check(&self) -> Result<(), Conflict> {
        let count = self.text.chars().count();
        let message = match count {
            0 => "there is no text to write".to_owned(),
            _ if count > MAX_CHARACTERS => {
                format!("it has {count} characters; the limit is {MAX_CHARACTERS}")
            }
            _ => return Ok(()),
        };
        Err(Conflict { param: "text", message })
    }

    fn run(&self, ground: Ground<'_>, cx: &Context<'_>) -> Result<Drawn, NodeError> {
        let sheet = ground.sheet(self.place.picture_width)?;
        let bytes = match &self.font_file {
            Some(file) => cx.read(file)?,
            None => Cow::Borrowed(self.font.bytes()),
        };
        let face = Face::parse(&bytes, 0).map_err(|fault| {
            let file = self.font_file.as_ref().map(ToString::to_string).unwrap_or_default();
            NodeError::Failed(format!("{file} is no font that can be read, .ttf or .otf: {fault}"))
        })?;
        let block = self.block(&Letters::of(&face))?;
        let scale = self.scale(block.width_mm, cx);
        let place = sheet.to_pixels() * self.place.to_sheet() * Affine::scale(scale);
        let outline = Sheet::inside(&(place * block.path), Filling::NonZero)?;
        Ok(Drawn { mask: sheet.cover(outline.as_ref(), cx)? })
    }
}

/// Set lines about their place, y up, in mm at the size asked for.
struct Block {
    path: BezPath,
    /// Of the widest line.
    width_mm: f64,
}

impl TextMask {
    /// How much smaller the text is made so that it fits.
    fn scale(&self, width_mm: f64, cx: &Context<'_>) -> f64 {
        if self.fit_width == 0.0 || width_mm <= self.fit_width {
            return 1.0;
        }
        let scale = self.fit_width / width_mm;
        cx.note(format!(
            "the text is {width_mm:.2} mm wide: capitals are {:.2} mm high in place of {} mm",
            self.size * scale,
            self.size
        ));
        scale
    }

    fn block(&self, letters: &Letters<'_>) -> Result<Block, NodeError> {
        let text = self.text.replace("\\n", "\n");
        let lines: Vec<&str> = text.lines().collect();
        let mm = self.size / letters.capital;
        let spacing = self.letter_spacing / 100.0 * letters.capital;
        let leading = self.line_spacing / 100.0 * letters.leading;
        let rise = 0.5 * (leading * (lines.len() as f64 - 1.0) - letters.capital);
        let mut block = Block { path: BezPath::new(), width_mm: 0.0 };
        for (number, line) in lines.iter().enumerate() {
            let (path, width) = letters.line(line, spacing)?;
            let x = match self.align {
                Align::Left => 0.0,
                Align::Center => -0.5 * width,
                Align::Right => -width,
            };
            let place = Affine::scale(mm) * Affine::translate((x, rise - leading * number as f64));
            block.path.extend(place * path);
            block.width_mm = block.width_mm.max(mm * width);
        }
        Ok(block)
    }
}

impl Font {
    fn bytes(self) -> &'static [u8] {
        match self {
            Self::Sans => dejavu::sans::regular(),
            Self::SansBold => dejavu::sans::bold(),
            Self::Serif => dejavu::serif::regular(),
            Self::SerifBold => dejavu::serif::bold(),
        }
    }
}

/// A font's letters. Lengths are in units of the font.
struct Letters<'a> {
    face: &'a Face<'a>,
    /// Height of the capitals.
    capital: f64,
    /// From a baseline to the next.
    leading: f64,
}

impl<'a> Letters<'a> {
    fn of(face: &'a Face<'a>) -> Self {
        let h = || face.glyph_bounding_box(face.glyph_index('H')?).map(|bounds| bounds.y_max);
        let capital = face.capital_height().filter(|height| *height > 0).or_else(h);
        let usual = USUAL_CAPITAL * f64::from(face.units_per_em());
        let capital = capital.map_or(usual, f64::from);
        Self { face, capital, leading: f64::from(face.height()) + f64::from(face.line_gap()) }
    }

    /// The outlines of a line from its beginning on the baseline, and its width.
    fn line(&self, text: &str, spacing: f64) -> Result<(BezPath, f64), NodeError> {
        let (mut pen, mut width, mut before) = (Pen::default(), 0.0, None);
        for letter in text.chars() {
            let glyph = self.face.glyph_index(letter).ok_or_else(|| {
                NodeError::Failed(format!(
                    "the font has no {letter:?} (U+{:04X}): name a font_file that has it",
                    u32::from(letter)
                ))
            })?;
            let closer = before.map_or(0.0, |before| spacing + self.kerning(before, glyph));
            pen.x = width + closer;
            self.face.outline_glyph(glyph, &mut pen);
            width = pen.x + f64::from(self.face.glyph_hor_advance(glyph).unwrap_or_default());
            before = Some(glyph);
        }
        Ok((pen.path, width))
    }

    /// How much two letters are moved apart.
    fn kerning(&self, left: GlyphId, right: GlyphId) -> f64 {
        let tables = self.face.tables().kern.into_iter().flat_map(|kern| kern.subtables);
        let mut plain = tables.filter(|table| {
            table.horizontal
                && !table.variable
                && !table.has_cross_stream
                && !table.has_state_machine
        });
        plain.find_map(|table| table.glyphs_kerning(left, right)).map_or(0.0, f64::from)
    }
}

/// Draws glyphs one after the other.
#[derive(Default)]
struct Pen {
    path: BezPath,
    /// Where the glyph begins.
    x: f64,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> (f64, f64) {
        (self.x + f64::from(x), f64::from(y))
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.at(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.at(x, y));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.at(x1, y1), self.at(x, y));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.curve_to(self.at(x1, y1), self.at(x2, y2), self.at(x, y));
    }

    fn close(&mut self) {
        self.path.close_path();
    }
}

#[cfg(test)]
mod tests {
    use super::super::sheet::MIDDLE;
    use super::super::sheet::testing::{extent, on_image, on_surface};
    use super::*;

    fn written(text: &str) -> TextMask {
        TextMask {
            text: text.to_owned(),
            font: Font::Sans,
            font_file: None,
            size: 10.0,
            fit_width: 0.0,
            align: Align::Center,
            line_spacing: 100.0,
            letter_spacing: 0.0,
            place: MIDDLE,
        }
    }

    /// Left, top, right and bottom in mm from the upper left corner of 100 × 60 mm.
    fn box_of(node: &TextMask) -> [f64; 4] {
        extent(&on_image(node, [1000, 600]).unwrap()).map(|px| px / 10.0)
    }

    fn size_of(node: &TextMask) -> [f64; 2] {
        let [left, top, right, bottom] = box_of(node);
        [right - left, bottom - top]
    }

    #[test]
    fn capitals_are_as_high_as_told_and_lie_about_the_middle() {
        for font in [Font::Sans, Font::SansBold, Font::Serif, Font::SerifBold] {
            let [_, top, _, bottom] = box_of(&TextMask { font, ..written("HIE") });
            assert!((top - 25.0).abs() < 0.11 && (bottom - 35.0).abs() < 0.11, "{top} {bottom}");
        }
    }

    /// The I of DejaVu Sans is an upright bar, 202 units wide and 1493 high.
    #[test]
    fn an_i_has_the_area_of_its_bar() {
        let mask = on_image(&written("I"), [1000, 600]).unwrap();
        let expected = 10.0 * 10.0 * 202.0 / 1493.0 * 100.0;
        assert!((mask.selected_px() - expected).abs() < 0.5, "{} {expected}", mask.selected_px());
    }

    #[test]
    fn the_hole_of_an_o_is_open() {
        let mask = on_image(&written("O"), [1000, 600]).unwrap();
        assert_eq!(mask.values[300 * 1000 + 500], 0.0);
        assert!(mask.selected_px() > 1000.0);
    }

    #[test]
    fn a_box_grows_with_the_size_and_the_lines() {
        let [width, height] = size_of(&written("Carve"));
        let double = size_of(&TextMask { size: 20.0, ..written("Carve") });
        assert!((double[0] - 2.0 * width).abs() < 0.25 && (double[1] - 2.0 * height).abs() < 0.25);
        // DejaVu's lines are 2384 units apart, its capitals 1493 high.
        let [_, two] = size_of(&written("H\\nH"));
        assert!((two - 10.0 - 10.0 * 2384.0 / 1493.0).abs() < 0.25, "{two}");
        assert_eq!(size_of(&written("H\nH")), size_of(&written("H\\nH")));
        let [narrow, _] = size_of(&TextMask { fit_width: 20.0, ..written("Carvegraph") });
        assert!((narrow - 20.0).abs() < 1.0, "{narrow}");
    }

    #[test]
    fn lines_are_aligned_at_x() {
        let ends = |align| {
            let [left, _, right, _] =
                box_of(&TextMask { align, place: Place { x: 5.0, ..MIDDLE }, ..written("I\nIII") });
            (left, right)
        };
        // A bar stands 2.95/14.93 of the size from its place.
        let bearing = 10.0 * 201.0 / 1493.0;
        assert!((ends(Align::Left).0 - 55.0 - bearing).abs() < 0.11, "{:?}", ends(Align::Left));
        assert!((ends(Align::Right).1 - 55.0 + bearing).abs() < 0.11, "{:?}", ends(Align::Right));
        let (left, right) = ends(Align::Center);
        assert!((left + right - 110.0).abs() < 0.11);
    }

    #[test]
    fn pairs_are_kerned_and_letters_spaced() {
        let [apart, _] = size_of(&written("AHV"));
        let [pair, _] = size_of(&written("AV"));
        let [h, _] = size_of(&written("HH"));
        let [single, _] = size_of(&written("H"));
        assert!(pair < apart - (h - single) - 0.5, "{pair}");
        let [spaced, _] = size_of(&TextMask { letter_spacing: 30.0, ..written("HH") });
        assert!((spaced - h - 3.0).abs() < 0.11, "{spaced} {h}");
    }

    #[test]
    fn turned_by_a_quarter_it_reads_upwards() {
        let node = written("HHH");
        let ([width, height], [left, top, right, bottom]) =
            (size_of(&node), box_of(&TextMask { place: Place { turn: 90.0, ..MIDDLE }, ..node }));
        assert!((right - left - height).abs() < 0.11 && (bottom - top - width).abs() < 0.11);
    }

    #[test]
    fn on_a_surface_millimetres_are_its_own() {
        let mask = on_surface(&written("I"), [401, 201], 0.1).unwrap();
        let [_, top, _, bottom] = extent(&mask);
        assert!((bottom - top - 100.0).abs() <= 2.0, "{top} {bottom}");
    }

    #[test]
    fn what_cannot_be_written_is_told() {
        assert_eq!(written("").check().unwrap_err().message, "there is no text to write");
        let long = "x".repeat(5001);
        let told = written(&long).check().unwrap_err().message;
        assert_eq!(told, "it has 5001 characters; the limit is 5000");
        assert_eq!(
            on_image(&written("漢"), [50, 50]).unwrap_err(),
            "the font has no '漢' (U+6F22): name a font_file that has it"
        );
        assert_eq!(on_image(&written(" "), [50, 50]).unwrap().selected_px(), 0.0);
    }
}
