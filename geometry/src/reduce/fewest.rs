//! The fewest moves along a row of points.
//!
//! Points are visited in order. Each is told which later points a move from it reaches; by then no better
//! way to itself can turn up, so what every point keeps is the best move that leads to it (dynamic
//! programming over a graph without cycles).

/// A way to one point.
#[derive(Clone, Copy)]
struct Way<M> {
    cost: u64,
    from: usize,
    by: M,
}

/// The best ways found so far from the first point to each.
pub(super) struct Fewest<M> {
    ways: Vec<Way<M>>,
}

impl<M: Copy> Fewest<M> {
    /// Ways to `points` points, of which only the first is reached yet.
    pub(super) fn new(points: usize, none: M) -> Self {
        let mut ways = vec![Way { cost: u64::MAX, from: 0, by: none }; points];
        ways[0].cost = 0;
        Self { ways }
    }

    /// Whether a move of this cost from a point that is reached would be the best way to another.
    pub(super) fn gains(&self, from: usize, to: usize, cost: u64) -> bool {
        self.ways[from].cost.saturating_add(cost) < self.ways[to].cost
    }

    /// Notes a move, if it is the best one to where it leads.
    pub(super) fn lead(&mut self, from: usize, to: usize, cost: u64, by: M) {
        if self.gains(from, to, cost) {
            self.ways[to] = Way { cost: self.ways[from].cost + cost, from, by };
        }
    }

    /// The moves to the last point, in order, each with the point that it ends at.
    pub(super) fn moves(&self) -> Vec<(usize, M)> {
        let mut moves = Vec::new();
        let mut at = self.ways.len() - 1;
        while at > 0 {
            moves.push((at, self.ways[at].by));
            at = self.ways[at].from;
        }
        moves.reverse();
        moves
    }
}
