//! Makes a profile of curves: turns them to start at the tip, straightens noise, refuses undercuts.

use super::curve::Curve;
use super::{DrawingError, MAX_REACH_MM, MAX_SEGMENTS, NOISE_MM};
use carvegraph_sdk::{DimensionSpec, Profile, Segment};
use kurbo::{Affine, Point};

/// How near, in radii, a centre must be to above the start or beside the end of its arc to be put
/// right there: rounding alone.
const TANGENT: f64 = 1e-12;

/// The profile of connected curves in mm, y down.
pub(super) fn profile(curves: &[Curve]) -> Result<Profile, DrawingError> {
    let curves = from_tip(curves)?;
    let mut chain = Chain { at: [0.0; 2], segments: Vec::new() };
    for part in curves.iter().flat_map(Curve::parts) {
        chain.add(&part)?;
    }
    Ok(Profile::new(chain.segments)?)
}

/// The curves in order from the tip, as (r, h), checked to have the size of a cutter.
fn from_tip(curves: &[Curve]) -> Result<Vec<Curve>, DrawingError> {
    let (Some(first), Some(last)) = (curves.first(), curves.last()) else {
        return Err(DrawingError::NoShape);
    };
    let (start, end) = (first.start(), last.end());
    if !curves.iter().all(|curve| curve.is_near(start, MAX_REACH_MM)) {
        return Err(DrawingError::TooFar);
    }
    let level = (start.y - end.y).abs() <= NOISE_MM;
    let forward = if level { start.x <= end.x } else { start.y > end.y };
    let (tip, rim) = if forward { (start, end) } else { (end, start) };
    check_radius(rim.x - tip.x)?;
    let map = Affine::new([1.0, 0.0, 0.0, -1.0, -tip.x, tip.y]);
    let curves = curves.iter().map(|curve| curve.transformed(map));
    Ok(if forward {
        curves.collect()
    } else {
        curves.rev().map(|curve| curve.reversed()).collect()
    })
}

fn check_radius(radius_mm: f64) -> Result<(), DrawingError> {
    let (diameter_mm, sold) = (2.0 * radius_mm, DimensionSpec::DIAMETER);
    if radius_mm < -NOISE_MM {
        Err(DrawingError::LeftHalf)
    } else if (sold.min..=sold.max).contains(&diameter_mm) {
        Ok(())
    } else {
        Err(DrawingError::Diameter { diameter_mm })
    }
}

/// The profile so far, which ends `at` (r, h).
struct Chain {
    at: [f64; 2],
    segments: Vec<Segment>,
}

impl Chain {
    /// Adds a part of a curve that goes one way along r and one way along h.
    fn add(&mut self, part: &Curve) -> Result<(), DrawingError> {
        let to = self.snapped(part.end())?;
        match part.circle_radius().filter(|_| part.sags()) {
            Some(radius) => self.arc(to, radius),
            None => part.flattened().into_iter().try_for_each(|point| {
                let to = self.snapped(point)?;
                self.line(to)
            }),
        }
    }

    /// A place, each coordinate put to where the chain is if it differs by noise. What is snapped
    /// is compared with what is drawn, so snaps don't add up.
    fn snapped(&self, place: Point) -> Result<[f64; 2], DrawingError> {
        let place = [place.x, place.y];
        let falls = |k: usize| place[k] < self.at[k] - NOISE_MM;
        let way = match (falls(0), falls(1)) {
            (false, false) => {
                let near = |k: usize| (place[k] - self.at[k]).abs() <= NOISE_MM;
                return Ok([0, 1].map(|k| if near(k) { self.at[k] } else { place[k] }));
            }
            (true, false) => "inward",
            (false, true) => "down",
            (true, true) => "inward and down",
        };
        Err(DrawingError::Falls { way, from: self.at, to: place })
    }

    fn line(&mut self, to: [f64; 2]) -> Result<(), DrawingError> {
        if to == self.at { Ok(()) } else { self.push(Segment::Line { to }) }
    }

    /// An arc of the given radius to a place outward and upward. Its start may have been snapped, so
    /// its centre is found anew from its ends, and its radius is no smaller than that of the
    /// tightest such arc that stays within a quarter turn: d²/(2·min(Δr, Δh)) for a chord of length d.
    fn arc(&mut self, to: [f64; 2], radius: f64) -> Result<(), DrawingError> {
        let from = self.at;
        let (dr, dh) = (to[0] - from[0], to[1] - from[1]);
        let chord2 = dr * dr + dh * dh;
        let tightest = chord2 / (2.0 * dr.min(dh));
        let radius = radius.max(tightest);
        let off = (radius * radius - chord2 / 4.0).max(0.0).sqrt();
        let straight = radius - off <= NOISE_MM;
        if straight || !tightest.is_finite() {
            return self.line(to);
        }
        let off = off / chord2.sqrt();
        let center = [from[0] + dr / 2.0 - dh * off, from[1] + dh / 2.0 + dr * off];
        let near = |a: f64, b: f64| if (a - b).abs() <= TANGENT * radius { b } else { a };
        let center = [near(center[0], from[0]), near(center[1], to[1])];
        self.push(Segment::Arc { to, center })
    }

    fn push(&mut self, segment: Segment) -> Result<(), DrawingError> {
        if self.segments.len() == MAX_SEGMENTS {
            return Err(DrawingError::TooManySegments);
        }
        self.at = segment.to();
        self.segments.push(segment);
        Ok(())
    }
}
