//! What a mask selects, raised out of a surface or cut into it.
//!
//! With h the height, d the distance of a node inwards from the mask's edge (finer than the grid, see
//! `mask/edge`) and β the angle of the walls, heights change by
//!
//! | profile | by |
//! |---|---|
//! | flat | h times the mask's share |
//! | bevel | h·min(1, d/w), w = abs(h)/tan β: planes that rise from the edge, level where they reach h |
//! | round | h·√(1 - (1 - min(1, d/w))²): a quarter of an ellipse |
//!
//! A bevel deeper than its strokes are wide is a V-groove; cut in with β = 90° less half of a V-bit's
//! angle, the bit fits its walls.
//!
//! A cutter fits into what is cut in, or between what is raised, where there is room for it: with r(z)
//! its radius z above its tip, e = max over z ≤ abs(h) of r(z) - z/tan β on both sides (z/tan β being
//! 0 for flat and round). What no disk of radius e within reaches is too narrow.

use super::{After, size};
use crate::mask::{check_size, from_edge};
use crate::values::Mask;
use carvegraph_core::{Choice, Context, Inputs, Node, NodeError, Params};
use carvegraph_geometry::{Cutter, HeightField, Profile, distances};

/// Heights at which a cutter's radius is looked at; profiles bend by little from one to the next.
const LOOKS: u32 = 64;

/// Less than that of the stamp, as a share, may be what every cutter leaves in corners.
const IN_CORNERS: f64 = 0.03;

/// Embosses or engraves what a mask selects.
#[derive(Clone, Debug, Params)]
pub(crate) struct Stamp {
    /// How far it is raised; negative cuts it in.
    #[param(unit = "mm", default = 1.0, range = -1000.0..=1000.0)]
    pub(crate) height: f64,
    /// How it rises from the mask's edge.
    #[param(default = Rise::Flat)]
    pub(crate) profile: Rise,
    /// How steep the walls of bevel and round are; round ones begin upright.
    #[param(unit = "deg", default = 60.0, range = 1.0..=89.0)]
    pub(crate) wall: f64,
}

/// How a stamp rises from its edge.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Rise {
    /// Upright walls, as the surface can say them: within a pitch.
    Flat,
    /// Slanted walls, which meet in a ridge or groove where there is no room for a level between.
    Bevel,
    /// Walls that bend over into the level.
    Round,
}

#[derive(Inputs)]
pub(crate) struct Stamped<'a> {
    /// The surface.
    surface: &'a HeightField,
    /// What is raised or cut in, made for this surface: a pixel for each node.
    mask: &'a Mask,
    /// The cutter to carve it with, to be told what is too narrow for it.
    cutter: Option<&'a Cutter>,
}

impl Node for Stamp {
    const KIND: &'static str = "stamp";
    type Inputs<'a> = Stamped<'a>;
    type Outputs = After;

    fn run(&self, inputs: Stamped<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let Stamped { surface, mask, cutter } = inputs;
        let (columns, rows) = (surface.columns(), surface.rows());
        check_size(mask, "the surface", (columns, rows))?;
        let ticker = cx.ticker(2 * rows);
        let mut inwards = cx.completed(from_edge(mask, || ticker.tick(1)))?;
        inwards.iter_mut().for_each(|away| *away *= surface.pitch_mm() as f32);
        if let Some(cutter) = cutter {
            self.tell_what_is_too_narrow(mask, &inwards, surface.pitch_mm(), &cutter.profile, cx)?;
        }
        let height = |i: usize, j: usize| {
            // The mask's first row is the far one.
            let at = (rows - 1 - j) * columns + i;
            surface.height(i, j) + self.rise(f64::from(inwards[at]), f64::from(mask.values[at]))
        };
        After::by_nodes(size(surface), surface, cx, height)
    }
}

impl Stamp {
    /// How much a node is raised that lies so far inwards, by the share that the mask has there.
    fn rise(&self, inwards_mm: f64, share: f64) -> f64 {
        if self.height == 0.0 {
            return 0.0;
        }
        let width_mm = self.height.abs() / self.wall.to_radians().tan();
        let part = (inwards_mm / width_mm).clamp(0.0, 1.0);
        self.height
            * match self.profile {
                Rise::Flat => share,
                Rise::Bevel => part,
                Rise::Round => (1.0 - (1.0 - part).powi(2)).sqrt(),
            }
    }

    /// Tells of places that the cutter is too thick for; see the file's head.
    fn tell_what_is_too_narrow(
        &self,
        mask: &Mask,
        inwards_mm: &[f32],
        pitch_mm: f64,
        cutter: &Profile,
        cx: &Context<'_>,
    ) -> Result<(), NodeError> {
        let room_mm = self.room_mm(cutter);
        // What is cut away: the stamp, or what lies around it.
        let inside = if self.height < 0.0 { 1.0 } else { -1.0 };
        // A pixel's middle is half of it from what it covers.
        let slack_mm = 0.5 * pitch_mm;
        let fits = |at: usize| f64::from(inside * inwards_mm[at]) >= room_mm - slack_mm;
        let reached = distances((mask.width, mask.height), fits, &|_| !cx.is_cancelled());
        let reach = ((room_mm + slack_mm) / pitch_mm) as f32;
        let cut = inwards_mm.iter().map(|inwards| inside * inwards > 0.0);
        let missed = cut.zip(cx.completed(reached)?).filter(|(cut, away)| *cut && *away > reach);
        let (missed, stamp) = (missed.count() as f64, mask.selected_px());
        if missed > 0.0 {
            let (of, area_mm2) = (100.0 * missed / stamp, missed * pitch_mm * pitch_mm);
            let what = if self.height < 0.0 { "strokes" } else { "gaps" };
            let text = format!(
                "the cutter needs {:.2} mm of room at {} mm: {what} narrower than that, {area_mm2:.1} mm² \
                 or {of:.0} % of what is stamped, stay filled",
                2.0 * room_mm,
                self.height.abs()
            );
            if missed > IN_CORNERS * stamp {
                cx.warn(format!("{text}. Take a finer cutter, less height or larger letters"));
            } else {
                cx.note(text);
            }
        }
        Ok(())
    }

    /// e of the file's head.
    fn room_mm(&self, cutter: &Profile) -> f64 {
        let lean =
            if self.profile == Rise::Bevel { 1.0 / self.wall.to_radians().tan() } else { 0.0 };
        let needed = (1..=LOOKS).map(|k| {
            let z = self.height.abs() * f64::from(k) / f64::from(LOOKS);
            radius_mm(cutter, z) - lean * z
        });
        needed.fold(0.0, f64::max)
    }
}

/// The radius of a cutter at a height above its tip, by halving.
fn radius_mm(cutter: &Profile, height_mm: f64) -> f64 {
    let (mut within, mut beyond) = (0.0, cutter.radius_mm());
    if cutter.height(beyond) <= height_mm {
        return beyond;
    }
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (within + beyond);
        if cutter.height(middle) <= height_mm { within = middle } else { beyond = middle }
    }
    within
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    const PLAIN: Stamp = Stamp { height: 2.0, profile: Rise::Flat, wall: 45.0 };

    /// A level plate of 21 × 9 nodes half a millimetre apart, a bar of 15 columns on all its rows.
    fn bar() -> (HeightField, Mask) {
        let share = |at: usize| if (3..18).contains(&(at % 21)) { 1.0 } else { 0.0 };
        let mask = Mask { width: 21, height: 9, values: (0..189).map(share).collect() };
        (HeightField::new(21, 9, 0.5, vec![1.0; 189]).unwrap(), mask)
    }

    /// Heights along a row.
    fn stamped(node: &Stamp) -> Vec<f32> {
        let (surface, mask) = bar();
        let inputs = Stamped { surface: &surface, mask: &mask, cutter: None };
        run(|cx| node.run(inputs, cx)).unwrap().surface.row(4).to_vec()
    }

    #[test]
    fn flat_is_the_height_times_the_share() {
        let raised = stamped(&PLAIN);
        assert_eq!((raised[2], raised[3], raised[17], raised[18]), (1.0, 3.0, 3.0, 1.0));
        assert_eq!(stamped(&Stamp { height: -0.25, ..PLAIN })[10], 0.75);
        assert_eq!(stamped(&Stamp { height: 0.0, ..PLAIN }), [1.0; 21]);
    }

    #[test]
    fn a_bevel_is_two_planes_and_a_level() {
        // The edge lies a quarter of a millimetre before the first node in.
        let raised = stamped(&Stamp { profile: Rise::Bevel, ..PLAIN });
        assert_eq!(raised[2..8], [1.0, 1.25, 1.75, 2.25, 2.75, 3.0]);
        let groove = stamped(&Stamp { profile: Rise::Bevel, height: -9.0, ..PLAIN });
        assert_eq!(groove[8..13], [-1.75, -2.25, -2.75, -2.25, -1.75]);
    }

    #[test]
    fn round_is_a_quarter_of_an_ellipse() {
        let raised = stamped(&Stamp { profile: Rise::Round, ..PLAIN });
        let expected = 1.0 + (4.0_f64 - 1.25 * 1.25).sqrt();
        assert!((f64::from(raised[4]) - expected).abs() < 1e-6, "{} {expected}", raised[4]);
        assert_eq!((raised[2], raised[10]), (1.0, 3.0));
    }

    #[test]
    fn the_masks_first_row_is_the_far_one() {
        let surface = HeightField::new(2, 2, 1.0, vec![0.0; 4]).unwrap();
        let mask = Mask { width: 2, height: 2, values: vec![1.0, 0.0, 0.0, 0.0] };
        let inputs = Stamped { surface: &surface, mask: &mask, cutter: None };
        let found = run(|cx| PLAIN.run(inputs, cx)).unwrap().surface;
        assert_eq!(found.heights(), [0.0, 0.0, 2.0, 0.0]);
    }

    #[test]
    fn a_mask_for_something_else_is_refused() {
        let (surface, _) = bar();
        let mask = Mask { width: 2, height: 2, values: vec![1.0; 4] };
        let inputs = Stamped { surface: &surface, mask: &mask, cutter: None };
        let told = run(|cx| PLAIN.run(inputs, cx)).err().unwrap().to_string();
        assert_eq!(
            told,
            "the mask has 2 × 2 px and the surface 21 × 9 px: make the mask for this picture, pixel by \
             pixel"
        );
    }

    #[test]
    fn room_is_that_of_the_widest_place_of_the_cutter_beside_the_wall() {
        let ball = Profile::ball(3.0).unwrap();
        assert!((radius_mm(&ball, 1.0) - 5.0_f64.sqrt()).abs() < 1e-9);
        assert_eq!(radius_mm(&ball, 7.0), 3.0);
        let node = Stamp { height: -1.0, ..PLAIN };
        assert!((node.room_mm(&ball) - 5.0_f64.sqrt()).abs() < 1e-9);
        // A ball against a wall of 45°: r(z) - z is greatest where its flank has 45°, R·(√2 - 1).
        let leaning = Stamp { profile: Rise::Bevel, height: -3.0, ..PLAIN };
        let expected = 3.0 * (2.0_f64.sqrt() - 1.0);
        assert!((leaning.room_mm(&ball) - expected).abs() < 1e-3);
        assert!(
            (Stamp { height: -3.0, ..PLAIN }.room_mm(&Profile::flat(2.0).unwrap()) - 2.0).abs()
                < 1e-9
        );
    }
}
