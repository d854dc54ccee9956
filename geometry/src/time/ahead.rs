//! The blocks that a controller sees, and the greatest speed at which the first of them may be entered so
//! that the machine can still stop at the end of the last.
//!
//! One block makes of the square x of its greatest exit speed that of its entry speed, min(J², x + 2ad).
//! Functions of this form stay of this form when put one into another:
//! min(A₁, min(A₂, x + C₂) + C₁) = min(min(A₁, A₂ + C₁), x + C₁ + C₂). So the queue is kept as two stacks, one
//! of which holds what all blocks from its top on make together: each block is looked at twice, whatever
//! the number that is seen, and no sum is longer than the queue.

use super::block::Block;

/// x → min(`most`, x + `gain`), both squares of speeds.
#[derive(Clone, Copy, Debug)]
struct Bound {
    most: f64,
    gain: f64,
}

impl Bound {
    /// Leaves everything as it is.
    const NONE: Self = Self { most: f64::INFINITY, gain: 0.0 };

    fn of(block: &Block) -> Self {
        Self { most: block.most_entry2, gain: block.gain2() }
    }

    /// This one after `behind`, which stands for the blocks behind.
    fn after(self, behind: Self) -> Self {
        Self { most: self.most.min(behind.most + self.gain), gain: self.gain + behind.gain }
    }

    fn of_speed2(self, exit2: f64) -> f64 {
        self.most.min(exit2 + self.gain)
    }
}

/// The blocks that are seen, oldest first.
#[derive(Default)]
pub(super) struct Ahead {
    /// The older ones, oldest on top, each with what it and all below it make.
    front: Vec<(Block, Bound)>,
    /// The newer ones, newest on top.
    back: Vec<Block>,
    /// What those make together.
    back_bound: Option<Bound>,
}

impl Ahead {
    pub(super) fn len(&self) -> usize {
        self.front.len() + self.back.len()
    }

    /// Takes in the newest.
    pub(super) fn push(&mut self, block: Block) {
        let before = self.back_bound.unwrap_or(Bound::NONE);
        self.back_bound = Some(before.after(Bound::of(&block)));
        self.back.push(block);
    }

    /// Gives the oldest.
    pub(super) fn pop(&mut self) -> Option<Block> {
        if self.front.is_empty() {
            let mut behind = Bound::NONE;
            while let Some(block) = self.back.pop() {
                behind = Bound::of(&block).after(behind);
                self.front.push((block, behind));
            }
            self.back_bound = None;
        }
        self.front.pop().map(|(block, _)| block)
    }

    /// The square of the greatest speed at which the oldest may be entered; 0 if there is none.
    pub(super) fn entry2(&self) -> f64 {
        let front = self.front.last().map_or(Bound::NONE, |(_, bound)| *bound);
        front.of_speed2(self.back_bound.unwrap_or(Bound::NONE).of_speed2(0.0))
    }
}
