//! Turning, scaling, mirroring and placing of points.
//!
//! In this order: mirrored, turned about x, then y, then z, scaled, made to fit, moved to a datum,
//! shifted. Everything before the datum happens about the origin and is one linear map; quarter turns
//! are exact. The datum is found from the box of what that map makes.

use crate::Bounds;
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

/// An axis of the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// To the right.
    X,
    /// Away.
    Y,
    /// Up.
    Z,
}

/// What of a part lies at x = 0, y = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Datum {
    /// Whatever did before.
    Keep,
    /// The near left corner of its box.
    Corner,
    /// The middle of its box.
    Center,
}

/// What of a part lies at z = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeightDatum {
    /// Whatever did before.
    Keep,
    /// Its lowest point.
    Bottom,
    /// Its highest point.
    Top,
}

/// The largest box that a part may fill, in mm; infinite where it does not matter.
pub type Fit = DVec3;

/// How points are placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing {
    /// The axis whose sign is changed first.
    pub mirror: Option<Axis>,
    /// Turns about x, y and z, in degrees, counter-clockwise seen from the axis' end.
    pub turns_deg: DVec3,
    /// Factors along x, y and z after turning; positive.
    pub scale: DVec3,
    /// The box to fill as far as proportions allow, if any. All axes infinite is none.
    pub fit: Option<Fit>,
    /// What lies at x = y = 0.
    pub datum: Datum,
    /// What lies at z = 0.
    pub height_datum: HeightDatum,
    /// A shift after that, in mm.
    pub shift: DVec3,
}

/// Why points cannot be placed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlacingError {
    /// There are none.
    #[error("there is nothing to be placed")]
    Nothing,
    /// A part without size cannot fill a box.
    #[error("the part has no size along the axes that it should fit, so no scale makes it do")]
    NoSize,
    /// The numbers end.
    #[error("the part would reach beyond all numbers: scale it less")]
    TooFar,
}

impl Placing {
    /// One that changes nothing.
    pub const NONE: Self = Self {
        mirror: None,
        turns_deg: DVec3::ZERO,
        scale: DVec3::ONE,
        fit: None,
        datum: Datum::Keep,
        height_datum: HeightDatum::Keep,
        shift: DVec3::ZERO,
    };

    /// Whether it turns a surface inside out, so that its triangles must be wound the other way.
    #[must_use]
    pub fn is_mirrored(&self) -> bool {
        self.mirror.is_some()
    }

    /// The map that places `points` as wished.
    ///
    /// # Errors
    /// If there are no points, a part without size is to fill a box, or lengths overflow.
    pub fn map(
        &self,
        points: impl ParallelIterator<Item = DVec3>,
    ) -> Result<DAffine3, PlacingError> {
        let turned = self.linear();
        let bounds = Bounds::of(points.map(|point| turned * point)).ok_or(PlacingError::Nothing)?;
        let scale = self.fitting_scale(bounds.size())?;
        let shift = self.shift - self.datum_of(bounds) * scale;
        let map = DAffine3 { matrix3: turned * scale, translation: shift };
        let (low, high) = (bounds.min * scale + shift, bounds.max * scale + shift);
        let is_sound = map.is_finite() && low.is_finite() && high.is_finite();
        if is_sound { Ok(map) } else { Err(PlacingError::TooFar) }
    }

    /// Mirrors, turns and scales.
    fn linear(&self) -> DMat3 {
        let sign = |axis| if self.mirror == Some(axis) { -1.0 } else { 1.0 };
        let mirror = DVec3::new(sign(Axis::X), sign(Axis::Y), sign(Axis::Z));
        let turns = self.turns_deg;
        let turned = turn(Axis::Z, turns.z) * turn(Axis::Y, turns.y) * turn(Axis::X, turns.x);
        DMat3::from_diagonal(self.scale) * turned * DMat3::from_diagonal(mirror)
    }

    fn fitting_scale(&self, size: DVec3) -> Result<f64, PlacingError> {
        let Some(fit) = self.fit.filter(|fit| fit.min_element() < f64::INFINITY) else {
            return Ok(1.0);
        };
        // An axis without size fits whatever the scale is: the quotient is infinite or NaN.
        let scales = (fit / size).to_array();
        let scale = scales.into_iter().filter(|s| s.is_finite()).fold(f64::INFINITY, f64::min);
        if scale.is_finite() { Ok(scale) } else { Err(PlacingError::NoSize) }
    }

    /// The place that is moved to 0.
    fn datum_of(&self, bounds: Bounds) -> DVec3 {
        let flat = match self.datum {
            Datum::Keep => DVec3::ZERO,
            Datum::Corner => bounds.min,
            Datum::Center => bounds.center(),
        };
        let z = match self.height_datum {
            HeightDatum::Keep => 0.0,
            HeightDatum::Bottom => bounds.min.z,
            HeightDatum::Top => bounds.max.z,
        };
        DVec3::new(flat.x, flat.y, z)
    }
}

/// A turn about an axis; exact for quarter turns.
fn turn(axis: Axis, degrees: f64) -> DMat3 {
    let quarters = degrees.rem_euclid(360.0) / 90.0;
    let (sin, cos) = match quarters {
        0.0 => (0.0, 1.0),
        1.0 => (1.0, 0.0),
        2.0 => (0.0, -1.0),
        3.0 => (-1.0, 0.0),
        _ => degrees.to_radians().sin_cos(),
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    match axis {
        Axis::X => DMat3::from_cols(x, y * cos + z * sin, z * cos - y * sin),
        Axis::Y => DMat3::from_cols(x * cos - z * sin, y, z * cos + x * sin),
        Axis::Z => DMat3::from_cols(x * cos + y * sin, y * cos - x * sin, z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 2 × 4 × 1 mm whose low corner is at (10, 20, 30), by its corners.
    fn block() -> Vec<DVec3> {
        let at = |i: usize, axis: usize| ((i >> axis) & 1) as f64;
        let corner = |i| DVec3::new(10.0 + 2.0 * at(i, 0), 20.0 + 4.0 * at(i, 1), 30.0 + at(i, 2));
        (0..8).map(corner).collect()
    }

    fn placed(placing: Placing) -> Bounds {
        let points = block();
        let map = placing.map(points.par_iter().copied()).unwrap();
        Bounds::of(points.par_iter().map(|point| map.transform_point3(*point))).unwrap()
    }

    #[test]
    fn quarter_turns_are_exact_and_counter_clockwise() {
        for (axis, from, to) in [
            (Axis::X, DVec3::Y, DVec3::Z),
            (Axis::Y, DVec3::Z, DVec3::X),
            (Axis::Z, DVec3::X, DVec3::Y),
        ] {
            assert_eq!(turn(axis, 90.0) * from, to);
            assert_eq!(turn(axis, -270.0) * from, to);
            assert_eq!(turn(axis, 180.0) * from, -from);
            let eighth = turn(axis, 45.0) * from;
            assert!((eighth - (from + to).normalize()).length() < 1e-15);
        }
    }

    #[test]
    fn x_is_turned_before_z() {
        let turns = DVec3::new(90.0, 0.0, 90.0);
        let map = Placing { turns_deg: turns, ..Placing::NONE };
        // y goes to z and stays; x goes to y.
        assert_eq!(map.linear() * DVec3::Y, DVec3::Z);
        assert_eq!(map.linear() * DVec3::X, DVec3::Y);
    }

    #[test]
    fn data_are_places_of_the_box() {
        let size = DVec3::new(2.0, 4.0, 1.0);
        let corner =
            Placing { datum: Datum::Corner, height_datum: HeightDatum::Top, ..Placing::NONE };
        assert_eq!(placed(corner).min, DVec3::new(0.0, 0.0, -1.0));
        assert_eq!(placed(corner).size(), size);
        let center =
            Placing { datum: Datum::Center, height_datum: HeightDatum::Bottom, ..Placing::NONE };
        assert_eq!(placed(center).min, DVec3::new(-1.0, -2.0, 0.0));
        assert_eq!(placed(Placing { shift: DVec3::X, ..center }).min, DVec3::new(0.0, -2.0, 0.0));
        assert_eq!(placed(Placing::NONE).min, DVec3::new(10.0, 20.0, 30.0));
    }

    #[test]
    fn a_part_fills_its_box_in_proportion() {
        let fit = DVec3::new(100.0, 8.0, f64::INFINITY);
        let fitted = Placing { fit: Some(fit), datum: Datum::Corner, ..Placing::NONE };
        assert_eq!(placed(fitted).size(), DVec3::new(4.0, 8.0, 2.0));
        let flat = [DVec3::ZERO, DVec3::Z];
        assert_eq!(fitted.map(flat.par_iter().copied()), Err(PlacingError::NoSize));
    }

    #[test]
    fn a_mirror_changes_one_sign() {
        let mirrored = Placing { mirror: Some(Axis::X), ..Placing::NONE };
        assert_eq!(placed(mirrored).max, DVec3::new(-10.0, 24.0, 31.0));
        assert!(mirrored.is_mirrored());
    }

    #[test]
    fn nothing_and_too_much_are_told() {
        let none: [DVec3; 0] = [];
        assert_eq!(Placing::NONE.map(none.par_iter().copied()), Err(PlacingError::Nothing));
        let far = Placing { scale: DVec3::splat(1e300), ..Placing::NONE };
        let points = [DVec3::splat(1e10), DVec3::ZERO];
        assert_eq!(far.map(points.par_iter().copied()), Err(PlacingError::TooFar));
    }
}
