//! The parameters of the nodes that crop things, stated once for meshes and points.

/// A node's struct with the sides of a box, and the way to what the kernel is told.
macro_rules! crop_params {
    ($(#[$about:meta])* $name:ident) => {
        $(#[$about])*
        #[derive(Clone, Debug, carvegraph_core::Params)]
        pub(crate) struct $name {
            /// What lies left of that is cut away. Left alone, nothing is.
            #[param(unit = "mm", default = 0.0, range = -1e9..=1e9)]
            pub(crate) x_min: carvegraph_core::Yielding<f64>,
            /// What lies right of that is cut away, if it is set.
            #[param(unit = "mm", default = 0.0, range = -1e9..=1e9)]
            pub(crate) x_max: carvegraph_core::Yielding<f64>,
            /// What lies nearer than that is cut away, if it is set.
            #[param(unit = "mm", default = 0.0, range = -1e9..=1e9)]
            pub(crate) y_min: carvegraph_core::Yielding<f64>,
            /// What lies farther than that is cut away, if it is set.
            #[param(unit = "mm", default = 0.0, range = -1e9..=1e9)]
            pub(crate) y_max: carvegraph_core::Yielding<f64>,
            /// What lies below that is cut away, if it is set.
            #[param(unit = "mm", default = 0.0, range = -1e9..=1e9)]
            pub(crate) z_min: carvegraph_core::Yielding<f64>,
            /// What lies above that is cut away, if it is set.
            #[param(unit = "mm", default = 0.0, range = -1e9..=1e9)]
            pub(crate) z_max: carvegraph_core::Yielding<f64>,
        }

        impl $name {
            fn sides(&self) -> [crate::surface::cropping::Sides; 3] {
                use crate::surface::cropping::Sides;
                [
                    Sides::new("x_max", &self.x_min, &self.x_max),
                    Sides::new("y_max", &self.y_min, &self.y_max),
                    Sides::new("z_max", &self.z_min, &self.z_max),
                ]
            }
        }

        #[cfg(test)]
        impl $name {
            /// One that cuts nothing away.
            fn neutral() -> Self {
                const OPEN: carvegraph_core::Yielding<f64> = carvegraph_core::Yielding::left(0.0);
                Self { x_min: OPEN, x_max: OPEN, y_min: OPEN, y_max: OPEN, z_min: OPEN, z_max: OPEN }
            }
        }
    };
}

pub(super) use crop_params;

use carvegraph_core::{Conflict, NodeError, Yielding};
use carvegraph_geometry::{Bounds, Crop, DVec3, Polygon};

/// The sides of a box along an axis, in mm; infinite where it is open.
#[derive(Clone, Copy)]
pub(super) struct Sides {
    /// The parameter that is the upper one.
    high_name: &'static str,
    low_mm: f64,
    high_mm: f64,
}

impl Sides {
    /// Sides that are open unless they were set.
    pub(super) fn new(high_name: &'static str, low: &Yielding<f64>, high: &Yielding<f64>) -> Self {
        let (low_mm, high_mm) = (low.or(Some(f64::NEG_INFINITY)), high.or(Some(f64::INFINITY)));
        Self { high_name, low_mm, high_mm }
    }
}

/// Complains of a box without inside.
pub(super) fn check(sides: &[Sides]) -> Result<(), Conflict> {
    for Sides { high_name, low_mm, high_mm } in sides {
        if low_mm >= high_mm {
            let message = format!(
                "{high_name} ({high_mm} mm) must be more than its lower side ({low_mm} mm)"
            );
            return Err(Conflict { param: high_name, message });
        }
    }
    Ok(())
}

/// What the kernel is told; an axis without sides is open.
pub(super) fn crop(sides: &[Sides], outline: Option<&Polygon>) -> Result<Crop, NodeError> {
    let mut bounds = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    for (axis, side) in sides.iter().enumerate() {
        (bounds.min[axis], bounds.max[axis]) = (side.low_mm, side.high_mm);
    }
    Crop::new(bounds, outline).ok_or_else(|| NodeError::failed("the box to be kept has no inside"))
}

/// The words where everything lies outside of the box or the outline.
pub(super) fn nothing_left(what: &str, bounds: Option<Bounds>) -> NodeError {
    let Some(Bounds { min, max }) = bounds else {
        return NodeError::failed(format!("there are no {what}"));
    };
    let place = |p: DVec3| format!("{:.3}, {:.3}, {:.3}", p.x, p.y, p.z);
    NodeError::failed(format!(
        "nothing is left: the {what} lie between {} and {} mm",
        place(min),
        place(max)
    ))
}
