//! Deviations along lines as a plot: how high the scallops stand, as figures 5.11 to 5.16 of Sood's thesis
//! (2015) show them.
//!
//! An SVG of its own, without fonts or files beside it, so that it can be part of a page. Each line has a
//! panel; all have one scale. Where a pixel has several nodes, the line goes from their least to their
//! greatest, so that no peak is lost.

use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, OutputName, Params};
use carvegraph_geometry::Deviation;
use std::fmt::Write as _;
use std::io::Write as _;

/// Lines that are plotted at most: a page full.
const MAX_LINES: u32 = 12;

/// Width of the picture and height of a panel, in its units.
const WIDTH: f64 = 800.0;
const PANEL: f64 = 150.0;
/// Room to the left and right of a panel, above and below.
const LEFT: f64 = 62.0;
const RIGHT: f64 = 16.0;
const ABOVE: f64 = 26.0;
const BELOW: f64 = 34.0;

/// Plots how far the machined surface is off along lines over the part.
#[derive(Clone, Debug, Params)]
pub(crate) struct ScallopPlot {
    /// The file's name without its extension; {prefix} stands for the input's name.
    #[param(default = "{prefix}-scallop")]
    pub(crate) name: OutputName,
    /// The axis along which the lines run.
    #[param(default = Along::X)]
    pub(crate) axis: Along,
    /// How many lines, evenly spread over the part.
    #[param(default = 3, range = 1..=MAX_LINES)]
    pub(crate) count: u32,
    /// Where the lines lie on the other axis, in mm, with commas between: "10, 25.5". Empty spreads them.
    #[param(default = "")]
    pub(crate) at: String,
    /// A height to draw a line at, such as the scallop that was asked for; 0 draws none.
    #[param(unit = "mm", default = 0.0, range = 0.0..=1000.0)]
    pub(crate) limit: f64,
}

/// An axis over the plane.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Along {
    /// Along x, at constant y.
    X,
    /// Along y, at constant x.
    Y,
}

#[derive(Inputs)]
pub(crate) struct Measured<'a> {
    /// How far the machined surface is off.
    deviation: &'a Deviation,
}

impl Node for ScallopPlot {
    const KIND: &'static str = "scallop_plot";
    type Inputs<'a> = Measured<'a>;
    type Outputs = ();

    fn run(&self, inputs: Measured<'_>, cx: &Context<'_>) -> Result<(), NodeError> {
        let text = self.svg(inputs.deviation)?;
        let mut file = cx.create(&self.name, "svg")?;
        file.write_all(text.as_bytes()).map_err(|fault| file.error(fault))?;
        file.finish()?;
        Ok(())
    }
}

/// Deviations along a line.
struct Profile {
    /// Where it lies on the other axis, in mm.
    at_mm: f64,
    /// In mm; NaN where nothing counts.
    values: Vec<f32>,
}

impl ScallopPlot {
    fn svg(&self, deviation: &Deviation) -> Result<String, NodeError> {
        let profiles = self.profiles(deviation)?;
        let all = profiles.iter().flat_map(|profile| &profile.values).filter(|v| !v.is_nan());
        let all: Vec<f64> = all.map(|v| f64::from(*v)).chain([0.0, self.limit]).collect();
        let (low, high) = all.iter().fold((0.0_f64, 1e-6_f64), |(a, b), v| (a.min(*v), b.max(*v)));
        let room = 0.06 * (high - low);
        let heights = (if low < 0.0 { low - room } else { 0.0 }, high + room);
        let corner = if self.axis == Along::X { deviation.corner.x } else { deviation.corner.y };
        let cells = profiles[0].values.len() - 1;
        let ways = (corner, corner + cells as f64 * deviation.grid.pitch_mm);
        let height = profiles.len() as f64 * (PANEL + ABOVE + BELOW);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" \
             font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n\
             <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>\n"
        );
        for (k, profile) in profiles.iter().enumerate() {
            let top = k as f64 * (PANEL + ABOVE + BELOW) + ABOVE;
            Panel { axis: self.axis, top, heights, ways }.draw(profile, self.limit, &mut svg);
        }
        svg.push_str("</svg>\n");
        Ok(svg)
    }

    fn profiles(&self, deviation: &Deviation) -> Result<Vec<Profile>, NodeError> {
        let grid = deviation.grid;
        let (corner, lines) = match self.axis {
            Along::X => (deviation.corner.y, grid.rows),
            Along::Y => (deviation.corner.x, grid.columns),
        };
        let length = (lines - 1) as f64 * grid.pitch_mm;
        let spread =
            (0..self.count).map(|k| corner + length * (f64::from(k) + 0.5) / f64::from(self.count));
        let places = if self.at.trim().is_empty() { spread.collect() } else { self.places()? };
        let profile = |at: f64| {
            let line = ((at - corner) / grid.pitch_mm).round();
            if !(0.0..lines as f64).contains(&line) {
                let message =
                    format!("{at} mm is beyond the part: from {corner} to {} mm", corner + length);
                return Err(NodeError::refused("at", message));
            }
            let line = line as usize;
            let values = match self.axis {
                Along::X => deviation.distances_mm[line * grid.columns..][..grid.columns].to_vec(),
                Along::Y => deviation
                    .distances_mm
                    .iter()
                    .skip(line)
                    .step_by(grid.columns)
                    .copied()
                    .collect(),
            };
            Ok(Profile { at_mm: corner + line as f64 * grid.pitch_mm, values })
        };
        places.into_iter().map(profile).collect()
    }

    /// The places that were given.
    fn places(&self) -> Result<Vec<f64>, NodeError> {
        let refused = |what: String| Err(NodeError::refused("at", what));
        let mut places = Vec::new();
        for word in self.at.split(',') {
            match word.trim().parse::<f64>() {
                Ok(place) if place.is_finite() => places.push(place),
                _ => return refused(format!("`{}` is no length in mm", word.trim())),
            }
        }
        if places.len() > MAX_LINES as usize {
            return refused(format!(
                "{} lines are too many: {MAX_LINES} can be plotted",
                places.len()
            ));
        }
        Ok(places)
    }
}

/// The frame of one line's plot.
struct Panel {
    axis: Along,
    /// Of the frame, in the picture's units.
    top: f64,
    /// Lowest and highest value, in mm.
    heights: (f64, f64),
    /// First and last place along the line, in mm.
    ways: (f64, f64),
}

impl Panel {
    fn x(&self, way: f64) -> f64 {
        let (from, to) = self.ways;
        LEFT + (way - from) / (to - from) * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, height: f64) -> f64 {
        let (low, high) = self.heights;
        self.top + (high - height) / (high - low) * PANEL
    }

    // Writing to a string cannot fail.
    fn draw(&self, profile: &Profile, limit: f64, svg: &mut String) {
        let (right, bottom) = (WIDTH - RIGHT, self.top + PANEL);
        let (along, across) = if self.axis == Along::X { ("x", "y") } else { ("y", "x") };
        let _ = writeln!(
            svg,
            "<text x=\"{LEFT}\" y=\"{:.1}\">{across} = {:.3} mm: deviation in mm over {along} in mm</text>",
            self.top - 8.0,
            profile.at_mm
        );
        for (way, label) in marks(self.ways, 10.0) {
            let x = self.x(way);
            let _ = writeln!(
                svg,
                "<path d=\"M{x:.2} {bottom}v5\" stroke=\"#222\"/><text x=\"{x:.2}\" y=\"{:.1}\" \
                 text-anchor=\"middle\">{label}</text>",
                bottom + 18.0
            );
        }
        for (height, label) in marks(self.heights, 5.0) {
            let y = self.y(height);
            let _ = writeln!(
                svg,
                "<path d=\"M{LEFT} {y:.2}H{right}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.2}\" \
                 text-anchor=\"end\">{label}</text>",
                LEFT - 6.0,
                y + 4.0
            );
        }
        if limit > 0.0 {
            let y = self.y(limit);
            let _ = writeln!(
                svg,
                "<path class=\"limit\" d=\"M{LEFT} {y:.2}H{right}\" stroke=\"#b35806\" \
                 stroke-dasharray=\"6 4\"/>"
            );
        }
        let _ = writeln!(
            svg,
            "<path class=\"zero\" d=\"M{LEFT} {:.2}H{right}\" stroke=\"#888\"/>",
            self.y(0.0)
        );
        let _ = writeln!(
            svg,
            "<path class=\"line\" d=\"{}\" fill=\"none\" stroke=\"#542788\" stroke-width=\"1.2\"/>",
            self.line(&profile.values)
        );
        let _ = writeln!(
            svg,
            "<rect x=\"{LEFT}\" y=\"{}\" width=\"{}\" height=\"{PANEL}\" fill=\"none\" stroke=\"#222\"/>",
            self.top,
            right - LEFT
        );
    }

    /// The line, interrupted where nothing counts.
    fn line(&self, values: &[f32]) -> String {
        // Two points a unit are as many as can be told apart.
        let at_once =
            (values.len() as f64 / (2.0 * (WIDTH - LEFT - RIGHT))).ceil().max(1.0) as usize;
        let cell = (self.ways.1 - self.ways.0) / (values.len() - 1) as f64;
        let (mut line, mut begun) = (String::new(), false);
        for (k, few) in values.chunks(at_once).enumerate() {
            let first = k * at_once;
            let counted = || few.iter().enumerate().filter(|(_, v)| !v.is_nan());
            let least = counted().min_by(|a, b| a.1.total_cmp(b.1));
            let greatest = counted().max_by(|a, b| a.1.total_cmp(b.1));
            let (Some(least), Some(greatest)) = (least, greatest) else {
                begun = false;
                continue;
            };
            let mut both = [least, greatest];
            both.sort_by_key(|(k, _)| *k);
            let points = if both[0].0 == both[1].0 { &both[..1] } else { &both[..] };
            for (k, value) in points {
                let x = self.x(self.ways.0 + (first + k) as f64 * cell);
                let letter = if begun { 'L' } else { 'M' };
                let _ = write!(line, "{letter}{x:.2} {:.2}", self.y(f64::from(**value)));
                begun = true;
            }
        }
        line
    }
}

/// Round values of a range with their text, some `count` of them.
fn marks((low, high): (f64, f64), count: f64) -> Vec<(f64, String)> {
    let rough = (high - low) / count;
    let unit = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * unit).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(10.0 * unit);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    // Adding 0 turns -0 into 0.
    let mark = |k: i64| (k as f64 * step, format!("{:.decimals$}", k as f64 * step + 0.0));
    (first..=last).map(mark).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use carvegraph_geometry::{DVec2, HeightField, Target, deviation};

    fn plot() -> ScallopPlot {
        let name = OutputName::new("plot").unwrap();
        ScallopPlot { name, axis: Along::X, count: 2, at: String::new(), limit: 0.0 }
    }

    /// Scallops of 0.1 mm along x, 10 mm wide, over 40 × 20 mm.
    fn scallops() -> Deviation {
        let height = |k: usize| 0.1 * ((k % 401) as f32 / 100.0 * std::f32::consts::PI).sin().abs();
        let machined =
            HeightField::new(401, 201, 0.1, (0..401 * 201).map(height).collect()).unwrap();
        let target = HeightField::new(3, 3, 20.0, vec![0.0; 9]).unwrap();
        let target = Target::Field(&target, DVec2::ZERO);
        deviation(&machined, DVec2::ZERO, target, 0.0, &|_| true).unwrap()
    }

    /// Highest point of each plotted line, in mm above its zero, by the plot's own figures.
    fn peaks(svg: &str) -> Vec<f64> {
        let number = |text: &str| text.parse::<f64>().unwrap();
        let lines = svg.lines().filter(|line| line.contains("class=\"line\""));
        let zeros = svg.lines().filter(|line| line.contains("class=\"zero\""));
        let zeros = zeros.map(|line| {
            let d = line.split("d=\"M").nth(1).unwrap();
            number(d.split(' ').nth(1).unwrap().split('H').next().unwrap())
        });
        let tops = lines.map(|line| {
            let d = line.split("d=\"").nth(1).unwrap().split('"').next().unwrap();
            let points = d.split(['M', 'L']).filter(|point| !point.is_empty());
            points.map(|p| number(p.split(' ').nth(1).unwrap())).fold(f64::INFINITY, f64::min)
        });
        // The scale goes from 0 to 6 % above the highest.
        tops.zip(zeros).map(|(top, zero)| (zero - top) / PANEL * 0.106).collect()
    }

    #[test]
    fn peaks_are_as_high_as_the_scallops() {
        let svg = plot().svg(&scallops()).unwrap();
        let peaks = peaks(&svg);
        assert_eq!(peaks.len(), 2);
        assert!(peaks.iter().all(|peak| (peak - 0.1).abs() < 1e-4), "{peaks:?}");
        assert!(svg.contains(">y = 5.000 mm: deviation in mm over x in mm</text>"));
        assert!(svg.contains(">0.10</text>") && svg.contains(">20</text>"), "{svg}");
        assert!(!svg.contains("class=\"limit\""));
    }

    #[test]
    fn lines_lie_where_they_were_asked_for() {
        let asked =
            ScallopPlot { at: "0, 5.0, 7.52".to_owned(), axis: Along::Y, limit: 0.05, ..plot() };
        let svg = asked.svg(&scallops()).unwrap();
        for place in ["x = 0.000 mm", "x = 5.000 mm", "x = 7.500 mm"] {
            assert!(svg.contains(place), "{place}");
        }
        assert_eq!(svg.matches("class=\"limit\"").count(), 3);
    }

    #[test]
    fn places_that_are_none_are_refused() {
        let refused = |at: &str| {
            let plot = ScallopPlot { at: at.to_owned(), ..plot() };
            plot.svg(&scallops()).unwrap_err().to_string()
        };
        assert_eq!(refused("5, far"), "`far` is no length in mm");
        assert_eq!(refused("21"), "21 mm is beyond the part: from 0 to 20 mm");
        assert_eq!(
            refused("1,1,1,1,1,1,1,1,1,1,1,1,1"),
            "13 lines are too many: 12 can be plotted"
        );
    }

    #[test]
    fn what_does_not_count_interrupts_the_line() {
        let mut found = scallops();
        found.distances_mm.iter_mut().enumerate().for_each(|(k, v)| {
            if (100..120).contains(&(k % 401)) {
                *v = f32::NAN;
            }
        });
        let svg = plot().svg(&found).unwrap();
        let line = svg.lines().find(|line| line.contains("class=\"line\"")).unwrap();
        let d = line.split("d=\"").nth(1).unwrap().split('"').next().unwrap();
        assert_eq!(d.matches('M').count(), 2);
        assert!(!svg.contains("NaN"));
    }
}
