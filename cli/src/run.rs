//! `carve run`.

use crate::arguments::RunArguments;
use crate::progress::Progress;
use crate::report::{self, Run, write_json};
use crate::{Exit, Refusal, build, complain, open_cache, say};
use carvegraph_core::report::{NodeStatus, RunReport, RunStatus};
use carvegraph_core::{
    Cache, Diagnostic, Graph, Plan, Recipe, Registry, RunOptions, Session, run as run_plan,
};
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::time::Duration;

/// How long a run may take to stop by itself after Ctrl-C. What still runs then is inside a library
/// that cannot be interrupted; its temporary files are removed and the program ends at once. The user
/// is to wait no more than a tenth of a second, and giving back a gigabyte takes half of that.
const GRACE: Duration = Duration::from_millis(40);

const INTERRUPTED: &str = "interrupted: nothing was written";

pub(crate) fn run(arguments: &RunArguments, registry: &Registry) -> Result<Exit, Refusal> {
    let session = Session::new(&arguments.out);
    stop_on_signal(session.clone())?;
    let (recipe, graph) = build(&arguments.job, registry)?;
    let cache = arguments.cache.as_deref().map(open_cache).transpose()?;
    let cache: Option<&dyn Cache> = cache.as_ref().map(|cache| cache as &dyn Cache);
    let plan = Plan::new(&graph, &arguments.only, &arguments.out, cache, &session.cancel);
    if session.cancel.is_cancelled() {
        tell_the_end(|| complain(INTERRUPTED));
        return Ok(Exit::Interrupted);
    }
    let plan = plan?;
    let progress = Progress::new(&plan, arguments.quiet);
    let threads = arguments.threads.map_or(0, usize::from);
    let report = run_plan(&plan, &session, RunOptions { threads, cache, observer: &progress });
    progress.clear();
    // First the files: they are there, whatever becomes of the reports.
    tell_the_end(|| {
        let page = write_page(arguments, &recipe, &graph, &report);
        tell(&report, page.as_deref(), arguments.quiet);
    });
    if let Some(path) = &arguments.report {
        write_json(&report, path)?;
    }
    Ok(match report.status {
        RunStatus::Done => Exit::Done,
        RunStatus::Failed => Exit::NodeFailed,
        RunStatus::Refused => Exit::Wrong,
        RunStatus::Interrupted => Exit::Interrupted,
    })
}

/// Writes the page about a run beside its files. One that wrote none leaves nothing behind; and a job is
/// none the worse without its page.
fn write_page(
    arguments: &RunArguments,
    recipe: &Recipe,
    graph: &Graph,
    report: &RunReport,
) -> Option<PathBuf> {
    if arguments.no_html || report.written.is_empty() {
        return None;
    }
    let (settings, out) = (&arguments.job.set[..], arguments.out.as_path());
    let run = Run { recipe, graph, settings, report, out };
    match report::write_page(&run, arguments.report.as_deref()) {
        Ok(path) => Some(path),
        Err(fault) => {
            complain(&format!("warning: no page about this run: {fault}"));
            None
        }
    }
}

/// Tells how the run ended, unless that is being told already: a run that stops just when the time for
/// it is over would end twice.
fn tell_the_end(tell: impl FnOnce()) {
    static TOLD: Once = Once::new();
    TOLD.call_once(tell);
}

fn stop_on_signal(session: Session) -> Result<(), Refusal> {
    let stop = move || {
        session.cancel.cancel();
        std::thread::sleep(GRACE);
        session.abandon();
        tell_the_end(|| {
            complain(INTERRUPTED);
            std::process::exit(Exit::Interrupted as i32);
        });
    };
    ctrlc::set_handler(stop).map_err(|fault| Refusal(format!("error: {fault}")))
}

fn tell(report: &RunReport, page: Option<&Path>, quiet: bool) {
    for (id, node) in &report.nodes {
        if let (NodeStatus::Failed, Some(reason)) = (node.status, &node.reason) {
            let fault = Diagnostic::error(format!("node {id:?} ({}): {reason}", node.kind));
            let fault = match &node.place {
                Some(place) => fault.at(place.clone()),
                None => fault,
            };
            complain(fault.render().trim_end());
        }
    }
    if let Some(trouble) = &report.trouble {
        complain(&format!("error: {trouble}"));
    }
    match report.status {
        RunStatus::Done => {}
        RunStatus::Failed => {
            let skipped = report.nodes.iter().filter(|(_, node)| node.starved);
            let skipped: Vec<&str> = skipped.map(|(id, _)| id.as_str()).collect();
            if !skipped.is_empty() {
                complain(&format!("not run, since they needed it: {}", skipped.join(", ")));
            }
        }
        RunStatus::Refused => complain("nothing was written"),
        RunStatus::Interrupted => complain(INTERRUPTED),
    }
    if quiet {
        return;
    }
    let mut text = String::new();
    for file in &report.files {
        text.push_str(&format!("{file}\n"));
    }
    say(&text);
    if let Some(page) = page {
        complain(&format!("all about this run: {}", page.display()));
    }
    if report.status == RunStatus::Done {
        complain(&format!("done in {:.2} s", report.wall_s));
    }
}
