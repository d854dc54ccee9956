//! Reads conversational programs as strictly as an iTNC would.

use carvegraph_sdk::conformance::dialect::Move;
use carvegraph_sdk::{Arc, Direction, Plane};

/// A line to the end of a helix that was rounded by its angle is this short.
const CORRECTION_MM: f64 = 0.01;

struct Machine {
    unit_mm: f64,
    feed_mm: f64,
    feed: f64,
    at: [f64; 3],
    center: [f64; 2],
    turning: bool,
    /// Whether the block before was a helix.
    helix: bool,
    moves: Vec<Move>,
}

/// The moves of a program; a position that is unknown is NaN.
pub(crate) fn read(text: &str) -> Vec<Move> {
    assert!(text.ends_with('\n') && text.is_ascii());
    let blocks: Vec<&str> = text
        .lines()
        .enumerate()
        .map(|(index, line)| {
            assert!(line.len() <= 128, "{line:?}");
            let (number, block) = line.split_once(' ').unwrap();
            assert_eq!(number, index.to_string(), "{line:?}");
            block
        })
        .collect();
    let (first, last) = (blocks[0], blocks[blocks.len() - 1]);
    let frame = first.strip_prefix("BEGIN PGM ").unwrap();
    assert_eq!(last.strip_prefix("END PGM "), Some(frame));
    let (name, units) = frame.split_once(' ').unwrap();
    assert!(name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') && name.len() <= 16);
    assert_eq!(blocks[blocks.len() - 2], "M30");
    let unit_mm = match units {
        "MM" => 1.0,
        "INCH" => 25.4,
        _ => panic!("{first:?}"),
    };
    let mut machine = Machine {
        unit_mm,
        feed_mm: if unit_mm == 1.0 { 1.0 } else { 2.54 },
        feed: f64::NAN,
        at: [f64::NAN; 3],
        center: [f64::NAN; 2],
        turning: false,
        helix: false,
        moves: Vec::new(),
    };
    for block in &blocks[1..blocks.len() - 2] {
        let helix = std::mem::take(&mut machine.helix);
        machine.block(block, helix);
    }
    machine.moves
}

impl Machine {
    fn block(&mut self, block: &str, after_helix: bool) {
        let words: Vec<&str> = block.split(' ').collect();
        match words[0] {
            ";" => assert!(block.starts_with("; - ") || block.starts_with("; Carvegraph: ")),
            "BLK" => {
                let corner = block.strip_prefix("BLK FORM 0.1 Z ");
                let corner = corner.or_else(|| block.strip_prefix("BLK FORM 0.2 ")).unwrap();
                assert_eq!(self.point(&corner.split(' ').collect::<Vec<_>>()).1, 3, "{block:?}");
            }
            "CYCL" => {
                let numbered = ["CYCL DEF 32.1 T", "CYCL DEF 9.1 DWELL "];
                match numbered.iter().find_map(|begin| block.strip_prefix(begin)) {
                    Some(number) => assert!(number.parse::<f64>().unwrap() >= 0.0),
                    None => assert!(
                        [
                            "CYCL DEF 32.0 TOLERANCE",
                            "CYCL DEF 32.2 HSC-MODE:0",
                            "CYCL DEF 9.0 DWELL TIME"
                        ]
                        .contains(&block),
                        "{block:?}"
                    ),
                }
            }
            "TOOL" => {
                let rest = block.strip_prefix("TOOL CALL ").unwrap();
                if let Some((number, _)) = rest.split_once(" Z") {
                    assert!(number.parse::<u32>().unwrap() > 0, "{block:?}");
                    self.at = [f64::NAN; 3];
                    self.turning = false;
                }
            }
            "M3" | "M4" => self.turning = true,
            "M5" => self.turning = false,
            "CC" => {
                let ([x, y, _], 2) = self.point(&words[1..]) else { panic!("{block:?}") };
                self.center = [x, y];
            }
            "L" => self.line(&words[1..], block, after_helix),
            "C" => {
                let (to, 2) = self.point(&words[1..3]) else { panic!("{block:?}") };
                self.arc(to, words[3], words.get(4), block);
            }
            "CP" => {
                let angle: f64 = signed(words[1].strip_prefix("IPA").unwrap());
                assert_eq!(angle > 0.0, words[3] == "DR+", "{block:?}");
                let (sin, cos) = angle.to_radians().sin_cos();
                let [x, y] = [self.at[0] - self.center[0], self.at[1] - self.center[1]];
                let (mut to, 1) = self.point(&words[2..3]) else { panic!("{block:?}") };
                to[0] = self.center[0] + x * cos - y * sin;
                to[1] = self.center[1] + x * sin + y * cos;
                self.arc(to, words[3], words.get(4), block);
                self.helix = true;
            }
            _ => panic!("{block:?}"),
        }
    }

    fn line(&mut self, words: &[&str], block: &str, after_helix: bool) {
        let axes = words.iter().take_while(|w| w.starts_with(['X', 'Y', 'Z'])).count();
        let (to, _) = self.point(&words[..axes]);
        assert!(axes > 0, "{block:?}");
        match &words[axes..] {
            ["R0", "FMAX", start @ ..] => {
                assert!(start.is_empty() || *start == ["M3"] || *start == ["M4"], "{block:?}");
                self.turning |= !start.is_empty();
                let z = words[..axes].iter().any(|w| w.starts_with('Z'));
                assert!(!z || axes == 1, "{block:?} is a diagonal rapid");
                self.moves.push(Move::Rapid { to });
            }
            feed => {
                self.feed(feed.first(), block);
                if after_helix
                    && let Some(Move::Arc(arc)) = self.moves.last_mut()
                    && (0..3).all(|k| (arc.to[k] - to[k]).abs() < CORRECTION_MM)
                {
                    arc.to = to;
                } else {
                    self.moves.push(Move::Feed { to, mm_per_min: self.feed });
                }
            }
        }
        self.at = to;
    }

    fn arc(&mut self, to: [f64; 3], direction: &str, feed: Option<&&str>, block: &str) {
        self.feed(feed, block);
        let direction = match direction {
            "DR-" => Direction::Clockwise,
            "DR+" => Direction::CounterClockwise,
            _ => panic!("{block:?}"),
        };
        let radius = |p: [f64; 3]| (p[0] - self.center[0]).hypot(p[1] - self.center[1]);
        // The control's own tolerance is 0.016 mm.
        assert!((radius(self.at) - radius(to)).abs() < 0.005, "{block:?}");
        let center = [self.center[0], self.center[1], 0.0];
        let arc = Arc { plane: Plane::Xy, direction, center, to, mm_per_min: self.feed };
        self.moves.push(Move::Arc(arc));
        self.at = to;
    }

    /// A cut's feed; it needs one, and a spindle that turns.
    fn feed(&mut self, word: Option<&&str>, block: &str) {
        if let Some(word) = word {
            let feed: f64 = word.strip_prefix('F').expect(block).parse().unwrap();
            self.feed = feed * self.feed_mm;
        }
        assert!(self.feed > 0.0 && self.turning, "{block:?}");
        assert!(self.at.iter().all(|c| c.is_finite()), "{block:?} from nowhere");
    }

    /// A point, and how many axes it gives.
    fn point(&self, words: &[&str]) -> ([f64; 3], usize) {
        let mut to = self.at;
        for word in words {
            let axis = "XYZ".find(&word[..1]).unwrap();
            to[axis] = signed(&word[1..]) * self.unit_mm;
        }
        (to, words.len())
    }
}

fn signed(text: &str) -> f64 {
    assert!(text.starts_with(['+', '-']) && text != "-0", "{text}");
    text.parse().unwrap()
}
