//! Where a program's zero lies on the part, for the nodes that write and read programs.

use carvegraph_core::{Choice, Params};
use carvegraph_geometry::{Bounds, DVec3};

/// Where the user sets the machine to zero.
#[derive(Clone, Copy, Debug, PartialEq, Params)]
pub(crate) struct Zero {
    /// Where Z is 0: at the top of the part or at its bottom.
    #[param(default = ZZero::Top)]
    pub(crate) z_zero: ZZero,
    /// Where X and Y are 0: at the near left corner of the part or above its middle.
    #[param(default = XyZero::Corner)]
    pub(crate) xy_zero: XyZero,
}

/// Where Z is 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum ZZero {
    /// The part's highest point.
    Top,
    /// The part's own frame.
    Bottom,
}

/// Where X and Y are 0.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum XyZero {
    /// The near left corner of the part.
    Corner,
    /// The middle of the part.
    Center,
}

impl Zero {
    /// The point of the part's frame that is the program's zero.
    pub(crate) fn of(self, part: &Bounds) -> DVec3 {
        let xy = match self.xy_zero {
            XyZero::Corner => DVec3::ZERO,
            XyZero::Center => part.center(),
        };
        let z = match self.z_zero {
            ZZero::Top => part.max.z,
            ZZero::Bottom => 0.0,
        };
        xy.with_z(z)
    }
}
