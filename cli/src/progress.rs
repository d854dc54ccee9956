//! What is shown while a recipe runs: bars on a terminal, plain lines in a pipe.

use carvegraph_core::report::{NodeReport, NodeStatus};
use carvegraph_core::{Note, Observer, Plan, Step, Weight};
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::HashMap;
use std::io::{self, IsTerminal};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// How often a bar whose node does not count its work shows that it is alive.
const TICK: Duration = Duration::from_millis(100);

/// Steps of a bar; nodes tell their progress as a share.
const STEPS: u64 = 1000;

/// The progress of a run.
pub(crate) struct Progress {
    quiet: bool,
    bars: MultiProgress,
    running: Mutex<HashMap<String, ProgressBar>>,
    kinds: HashMap<String, &'static str>,
}

impl Progress {
    pub(crate) fn new(plan: &Plan<'_>, quiet: bool) -> Self {
        let shown = !quiet && io::stderr().is_terminal();
        let target =
            if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let kinds = plan.in_order().filter_map(|at| {
            let node = &plan.graph.nodes[at];
            let runs = matches!(plan.steps[at], Some(Step::Run | Step::Load { .. }));
            runs.then(|| (node.id.clone(), plan.graph.kind(node).name))
        });
        let bars = MultiProgress::with_draw_target(target);
        Self { quiet, bars, running: Mutex::default(), kinds: kinds.collect() }
    }

    /// Takes the bars away.
    pub(crate) fn clear(&self) {
        // They are gone with the terminal if this fails.
        let _ = self.bars.clear();
    }

    fn line(&self, text: &str) {
        if self.quiet {
            return;
        }
        if self.bars.is_hidden() {
            crate::complain(text);
        } else {
            let _ = self.bars.println(text);
        }
    }

    fn with_bars(&self, change: impl FnOnce(&mut HashMap<String, ProgressBar>)) {
        change(&mut self.running.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Observer for Progress {
    fn started(&self, node: &str) {
        if self.quiet || self.bars.is_hidden() {
            return;
        }
        let bar = self.bars.add(ProgressBar::new(STEPS));
        let style = ProgressStyle::with_template("{spinner} {msg:<30} {bar:30} {percent:>3} %");
        if let Ok(style) = style {
            bar.set_style(style);
        }
        let kind = self.kinds.get(node).copied().unwrap_or_default();
        bar.set_message(format!("{node} ({kind})"));
        bar.enable_steady_tick(TICK);
        self.with_bars(|bars| {
            bars.insert(node.to_owned(), bar);
        });
    }

    fn progressed(&self, node: &str, share: f64) {
        self.with_bars(|bars| {
            if let Some(bar) = bars.get(node) {
                bar.set_position((share * STEPS as f64) as u64);
            }
        });
    }

    fn noted(&self, node: &str, note: &Note) {
        let weight = match note.weight {
            Weight::Note => "note",
            Weight::Warning => "warning",
        };
        self.line(&format!("{weight}: {node}: {}", note.text));
    }

    fn finished(&self, node: &str, report: &NodeReport) {
        self.with_bars(|bars| {
            if let Some(bar) = bars.remove(node) {
                bar.finish_and_clear();
            }
        });
        let what = match report.status {
            NodeStatus::Ran => "ran",
            NodeStatus::Cached => "cached",
            NodeStatus::Failed => "failed",
            NodeStatus::Skipped => "skipped",
        };
        self.line(&format!("{what:<8}{node} ({}) {:.3} s", report.kind, report.wall_s));
    }
}
