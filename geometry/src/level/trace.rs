//! Marching squares: between which nodes an outline passes.

use super::ground::Ground;
use std::collections::HashMap;

/// Where an outline passes between two nodes that are neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Crossing {
    /// The node that is free.
    pub(super) free: [usize; 2],
    /// The node that is not; `None` where it would lie beyond the border of the area.
    pub(super) blocked: Option<[usize; 2]>,
}

/// A side of a square, by the node at its lower left end and whether it stands upright. Nodes are
/// counted from 1, so that there is a row of them around the area.
type Side = ([usize; 2], bool);

/// The corners of a square counter-clockwise from the lower left one; side k goes from corner k on.
const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// The outlines of what is free at the height z, each a list of crossings with the free side to the
/// left, closed. Beyond the area nothing is free.
pub(super) fn trace(ground: &Ground<'_>, z: f64) -> Vec<Vec<Crossing>> {
    let [columns, rows] = ground.nodes();
    let inside = |[i, j]: [usize; 2]| {
        let within = (1..=columns).contains(&i) && (1..=rows).contains(&j);
        within.then(|| [i - 1, j - 1])
    };
    let free = |node: [usize; 2]| inside(node).is_some_and(|node| ground.is_free(node, z));
    let mut follows: HashMap<Side, Side> = HashMap::new();
    // The order in which they are found does not depend on the map.
    let mut starts = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            let corners = CORNERS.map(|[di, dj]| free([i + di, j + dj]));
            if corners == [corners[0]; 4] {
                continue;
            }
            for k in (0..4).filter(|k| corners[*k] && !corners[(k + 1) % 4]) {
                // Back over the free corners before this one.
                let mut first = k;
                while corners[(first + 3) % 4] {
                    first = (first + 3) % 4;
                }
                let (from, to) = (side([i, j], k), side([i, j], (first + 3) % 4));
                follows.insert(from, to);
                starts.push(from);
            }
        }
    }
    let crossing = |([i, j], upright): Side| {
        let other = if upright { [i, j + 1] } else { [i + 1, j] };
        let (node, other) = if free([i, j]) { ([i, j], other) } else { (other, [i, j]) };
        inside(node).map(|free| Crossing { free, blocked: inside(other) })
    };
    let outline = |start: Side| {
        let mut at = follows.remove(&start)?;
        let mut outline = vec![crossing(start)?];
        while at != start {
            outline.push(crossing(at)?);
            at = follows.remove(&at)?;
        }
        Some(outline)
    };
    starts.into_iter().filter_map(outline).collect()
}

fn side([i, j]: [usize; 2], k: usize) -> Side {
    match k {
        0 => ([i, j], false),
        1 => ([i + 1, j], true),
        2 => ([i, j + 1], false),
        _ => ([i, j], true),
    }
}
