//! A relief repeated side by side.
//!
//! Tiles lie a pitch apart, so n of c columns make n·c. Mirrored, every other one is turned over and
//! shares its border with its neighbours, so that heights meet without a seam: n·(c - 1) + 1.

use super::{After, Before, check_size, size};
use carvegraph_core::{Context, Node, NodeError, Params};

/// Repeats a relief in columns and rows.
#[derive(Clone, Debug, Params)]
pub(crate) struct TileField {
    /// Tiles along x.
    #[param(default = 2, range = 1..=1000)]
    pub(crate) columns: u32,
    /// Tiles along y.
    #[param(default = 2, range = 1..=1000)]
    pub(crate) rows: u32,
    /// Whether every other tile is turned over, so that no seam shows.
    #[param(default = true)]
    pub(crate) mirror: bool,
}

impl Node for TileField {
    const KIND: &'static str = "tile_field";
    type Inputs<'a> = Before<'a>;
    type Outputs = After;

    fn run(&self, Before { surface }: Before<'_>, cx: &Context<'_>) -> Result<After, NodeError> {
        let counts = size(surface);
        let tiles = [self.columns as usize, self.rows as usize];
        let whole = [0, 1].map(|axis| {
            if self.mirror {
                tiles[axis] * (counts[axis] - 1) + 1
            } else {
                tiles[axis] * counts[axis]
            }
        });
        check_size(whole, if whole[0] >= whole[1] { "columns" } else { "rows" })?;
        let height = |i, j| surface.height(self.of_tile(i, counts[0]), self.of_tile(j, counts[1]));
        After::by_nodes(whole, surface, cx, height)
    }
}

impl TileField {
    /// The node of a tile of `count` that stands at place `k`.
    fn of_tile(&self, k: usize, count: usize) -> usize {
        if !self.mirror {
            return k % count;
        }
        let period = 2 * (count - 1);
        let k = k % period;
        k.min(period - k)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{field, shaped};
    use super::*;

    #[test]
    fn tiles_repeat() {
        let tile = field(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        let found = shaped(&TileField { columns: 2, rows: 2, mirror: false }, &tile).unwrap();
        assert_eq!((found.columns(), found.rows()), (6, 4));
        assert_eq!(found.row(3), [4.0, 5.0, 6.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn mirrored_tiles_share_their_borders() {
        let tile = field(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        let found = shaped(&TileField { columns: 3, rows: 2, mirror: true }, &tile).unwrap();
        assert_eq!((found.columns(), found.rows()), (7, 3));
        assert_eq!(found.row(0), [1.0, 2.0, 3.0, 2.0, 1.0, 2.0, 3.0]);
        assert_eq!(found.row(2), found.row(0));
    }

    #[test]
    fn one_tile_is_the_relief_and_too_many_are_refused() {
        let tile = field(&[[1.0; 30]; 30]);
        for mirror in [false, true] {
            assert_eq!(shaped(&TileField { columns: 1, rows: 1, mirror }, &tile).unwrap(), tile);
        }
        let told =
            shaped(&TileField { columns: 900, rows: 1000, mirror: false }, &tile).unwrap_err();
        assert!(told.contains("27000 × 30000 nodes; the limit is 400000000"), "{told}");
    }
}
