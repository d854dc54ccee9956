//! A base under a relief: a dome, an arch or a tilted plane is added to it.
//!
//! The cap of a sphere over a circle of radius c, h high, is at distance r from its middle
//! √(R² - r²) - (R - h) high, with R = (c² + h²)/2h. With a and b half the width and height of the
//! surface, x and y from its middle:
//!
//! | shape | r | c |
//! |---|---|---|
//! | sphere | hypot(x, y) | hypot(a, b): the corners stay where they are |
//! | oval | c · hypot(x/a, y/b), 0 high beyond c | min(a, b): the whole border stays |
//! | arch_x | abs(x) | a: left and right stay |
//! | arch_y | abs(y) | b: near and far stay |
//!
//! An oval meets the corners that stay flat in a crease. A pillow has none: it is arch_x times arch_y
//! over h, 0 along the whole border. A tilted plane rises from 0 at one corner or side to h at the other.

use super::{After, Before, size};
use carvegraph_core::{Choice, Context, Node, NodeError, Params};
use carvegraph_geometry::DVec2;

/// Lays a relief over a dome, an arch or a slope.
#[derive(Clone, Debug, Params)]
pub(crate) struct Dome {
    /// What is added.
    #[param(default = Shape::Sphere)]
    pub(crate) shape: Shape,
    /// How high it is; negative is a dish, 0 adds nothing.
    #[param(unit = "mm", default = 0.0, range = -1000.0..=1000.0)]
    pub(crate) height: f64,
    /// Where a tilted plane rises to: 0 is to the right, 90 away.
    #[param(unit = "deg", default = 90.0, range = -360.0..=360.0)]
    pub(crate) direction: f64,
}

/// What is added to a relief.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum Shape {
    /// The cap of a sphere, 0 in the corners.
    Sphere,
    /// An oval cap, 0 in the corners beyond it, which it meets in a crease.
    Oval,
    /// Two arches across each other, 0 along the border, without a crease.
    Pillow,
    /// Part of a cylinder along y, 0 on the left and right.
    ArchX,
    /// Part of a cylinder along x, 0 on the near and far side.
    ArchY,
    /// A plane that rises across the surface.
    Tilt,
}

impl Node for Dome {
    const KIND: &'static str = "dome";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, Before { surface }: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let middle = surface.bounds().size().truncate() / 2.0;
        let foot_mm = self.foot_mm(middle);
        if self.shape != Shape::Tilt && self.height.abs() > foot_mm {
            let message = format!(
                "{} mm is more than half a ball over this surface: at most {foot_mm:.3} mm",
                self.height
            );
            return Err(NodeError::refused("height", message));
        }
        let height = |i: usize, j: usize| {
            let node = surface.point(i, j);
            node.z + self.added(node.truncate() - middle, middle)
        };
        After::by_nodes(size(surface), surface, cx, height)
    }
}

impl Dome {
    /// c of the table; 0 for a plane.
    fn foot_mm(&self, half: DVec2) -> f64 {
        match self.shape {
            Shape::Sphere => half.length(),
            Shape::Oval | Shape::Pillow => half.min_element(),
            Shape::ArchX => half.x,
            Shape::ArchY => half.y,
            Shape::Tilt => 0.0,
        }
    }

    /// What is added at a place seen from the middle, in mm; `half` is the far right corner from there.
    fn added(&self, place: DVec2, half: DVec2) -> f64 {
        let foot_mm = self.foot_mm(half);
        let away_mm = match self.shape {
            Shape::Sphere => place.length(),
            Shape::Oval => foot_mm * (place / half).length(),
            Shape::Pillow => {
                let arch = |away: f64, foot_mm| cap(away.abs(), foot_mm, self.height.abs());
                let arches = arch(place.x, half.x) * arch(place.y, half.y);
                return if self.height == 0.0 { 0.0 } else { arches / self.height };
            }
            Shape::ArchX => place.x.abs(),
            Shape::ArchY => place.y.abs(),
            Shape::Tilt => {
                let rise = DVec2::from_angle(self.direction.to_radians());
                return self.height * (0.5 + 0.5 * place.dot(rise) / half.dot(rise.abs()));
            }
        };
        self.height.signum() * cap(away_mm.min(foot_mm), foot_mm, self.height.abs())
    }
}

/// The height of a cap `height` high over a circle of radius `foot`, `away` from its middle.
fn cap(away: f64, foot: f64, height: f64) -> f64 {
    if height == 0.0 {
        return 0.0;
    }
    let radius = (foot * foot + height * height) / (2.0 * height);
    // √(R² - r²) - √(R² - c²) without the difference of two large numbers; √(R² - c²) is R - h.
    let root = (radius * radius - away * away).max(0.0).sqrt();
    (foot * foot - away * away) / (root + (radius - height)).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{field, shaped};
    use super::*;

    fn over<const N: usize>(shape: Shape, height: f64, rows: usize) -> Vec<f32> {
        let node = Dome { shape, height, direction: 90.0 };
        shaped(&node, &field(&vec![[1.0; N]; rows])).unwrap().heights().to_vec()
    }

    #[track_caller]
    fn assert_near(found: &[f32], expected: &[f64]) {
        let near = found.iter().zip(expected).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-6);
        assert!(near && found.len() == expected.len(), "{found:?} {expected:?}");
    }

    #[test]
    fn a_half_ball_is_round() {
        // 17 nodes are 8 mm: an arch 4 mm high is half a circle.
        let expected: Vec<f64> =
            (0..17).map(|i| 1.0 + (16.0 - (0.5 * f64::from(i) - 4.0).powi(2)).sqrt()).collect();
        assert_near(&over::<17>(Shape::ArchX, 4.0, 2)[..17], &expected);
        let dish: Vec<f64> = expected.iter().map(|z| 2.0 - z).collect();
        assert_near(&over::<17>(Shape::ArchX, -4.0, 2)[..17], &dish);
    }

    #[test]
    fn corners_border_or_sides_stay_and_the_middle_rises_by_the_height() {
        let (columns, rows) = (9, 7);
        for shape in [Shape::Sphere, Shape::Oval, Shape::Pillow, Shape::ArchX, Shape::ArchY] {
            let found = over::<9>(shape, 0.8, rows);
            assert!((found[3 * columns + 4] - 1.8).abs() < 1e-6, "{shape:?}");
            assert_eq!(found[0], 1.0, "{shape:?}");
            let sides = (found[3 * columns] == 1.0, found[4] == 1.0);
            let expected = match shape {
                Shape::Oval | Shape::Pillow => (true, true),
                Shape::ArchX => (true, false),
                Shape::ArchY => (false, true),
                _ => (false, false),
            };
            assert_eq!(sides, expected, "{shape:?}");
        }
    }

    #[test]
    fn a_pillow_is_one_arch_across_another() {
        let [x, y, pillow] =
            [Shape::ArchX, Shape::ArchY, Shape::Pillow].map(|shape| over::<9>(shape, -0.8, 7));
        let expected = x.iter().zip(&y).map(|(x, y)| 1.0 - f64::from((x - 1.0) * (y - 1.0)) / 0.8);
        assert_near(&pillow, &expected.collect::<Vec<_>>());
    }

    #[test]
    fn a_tilted_plane_rises_from_side_to_side_and_from_corner_to_corner() {
        assert_near(&over::<2>(Shape::Tilt, 3.0, 3), &[1.0, 1.0, 2.5, 2.5, 4.0, 4.0]);
        let node = Dome { shape: Shape::Tilt, height: 4.0, direction: 225.0 };
        let found = shaped(&node, &field(&[[0.0; 3]; 3])).unwrap();
        assert_near(found.heights(), &[4.0, 3.0, 2.0, 3.0, 2.0, 1.0, 2.0, 1.0, 0.0]);
    }

    #[test]
    fn more_than_half_a_ball_is_refused() {
        let node = Dome { shape: Shape::Oval, height: -1.5, direction: 0.0 };
        let told = shaped(&node, &field(&[[0.0; 5]; 9])).unwrap_err();
        assert_eq!(told, "-1.5 mm is more than half a ball over this surface: at most 1.000 mm");
    }
}
