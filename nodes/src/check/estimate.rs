//! How long a job takes on a machine: the value that `estimate_time` gives.

use carvegraph_core::Facts;
use carvegraph_geometry::Times;
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

/// How long a job takes, tool by tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// What each tool does, in the order in which they are put in.
    pub runs: Vec<RunTimes>,
    /// Changing tools, in s.
    pub changing_s: f64,
    /// On what kind of machine: goes on after "41 minutes ...".
    pub machine: String,
}

/// How long one tool takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunTimes {
    /// The cutter, in words.
    pub cutter: String,
    /// Its moves.
    pub times: Times,
    /// Waits that the program asks for, in s.
    pub dwell_s: f64,
}

impl RunTimes {
    /// Moves and waits, in s.
    #[must_use]
    pub fn total_s(&self) -> f64 {
        self.times.total_s() + self.dwell_s
    }
}

impl Estimate {
    /// All of it, in s.
    #[must_use]
    pub fn total_s(&self) -> f64 {
        self.sum(RunTimes::total_s) + self.changing_s
    }

    /// A quantity of all runs together.
    pub fn sum(&self, of: impl Fn(&RunTimes) -> f64) -> f64 {
        // A sum of nothing would be -0.
        self.runs.iter().map(of).fold(0.0, |sum, each| sum + each)
    }

    /// The greatest number of lines a second that a tool's moves use up.
    #[must_use]
    pub fn most_lines_per_s(&self) -> f64 {
        self.runs.iter().map(|run| run.times.most_lines_per_s).fold(0.0, f64::max)
    }

    pub(crate) fn facts(&self) -> Facts {
        let times = |of: fn(&Times) -> f64| json!(self.sum(|run| of(&run.times)));
        let each = |of: fn(&RunTimes) -> Json| json!(self.runs.iter().map(of).collect::<Vec<_>>());
        let shortest = self.runs.iter().filter(|run| run.times.blocks > 0);
        let shortest = shortest.map(|run| run.times.shortest_mm).reduce(f64::min);
        let cutting_s = self.sum(|run| run.times.cutting_s);
        let fed_mm = self.sum(|run| run.times.feed_length_mm);
        let mean_feed = (cutting_s > 0.0).then(|| fed_mm / cutting_s * 60.0);
        [
            ("time_s", json!(self.total_s())),
            ("cutting_s", json!(cutting_s)),
            ("plunge_s", times(|times| times.plunge_s)),
            ("rapid_s", times(|times| times.rapid_s)),
            ("waiting_s", times(|times| times.waiting_s)),
            ("dwell_s", json!(self.sum(|run| run.dwell_s))),
            ("tool_change_s", json!(self.changing_s)),
            ("time_at_full_speed_s", times(|times| times.asked_s)),
            ("slow_axes_s", times(|times| times.slow_axes_s)),
            ("accelerating_s", times(|times| times.accelerating_s)),
            ("feed_length_mm", json!(fed_mm)),
            ("rapid_length_mm", times(|times| times.rapid_length_mm)),
            ("mean_feed_mm_per_min", json!(mean_feed)),
            ("shortest_move_mm", json!(shortest)),
            ("most_lines_per_s", json!(self.most_lines_per_s())),
            ("machine", json!(self.machine)),
            ("cutters", each(|run| json!(run.cutter))),
            ("cutter_times_s", each(|run| json!(run.total_s()))),
        ]
        .into_iter()
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(cutter: &str, cutting_s: f64, dwell_s: f64) -> RunTimes {
        let times = Times { cutting_s, rapid_s: 2.0, feed_length_mm: 50.0, ..Times::default() };
        RunTimes { cutter: cutter.into(), times, dwell_s }
    }

    #[test]
    fn the_whole_is_the_sum_of_tools_and_changes() {
        let runs = vec![run("flat", 10.0, 3.0), run("ball", 20.0, 0.0)];
        let estimate = Estimate { runs, changing_s: 60.0, machine: "on mill".into() };
        assert_eq!(estimate.total_s(), 97.0);
        let facts = estimate.facts();
        assert_eq!(facts["time_s"], 97.0);
        assert_eq!((&facts["cutting_s"], &facts["rapid_s"]), (&json!(30.0), &json!(4.0)));
        assert_eq!(facts["mean_feed_mm_per_min"], 200.0);
        assert_eq!(facts["cutter_times_s"], json!([15.0, 22.0]));
        assert_eq!(facts["shortest_move_mm"], Json::Null);
    }

    #[test]
    fn no_moves_take_no_time() {
        let estimate = Estimate { runs: vec![], changing_s: 0.0, machine: String::new() };
        assert_eq!(estimate.facts()["time_s"], json!(0.0));
        assert_eq!(estimate.facts()["mean_feed_mm_per_min"], Json::Null);
    }
}
