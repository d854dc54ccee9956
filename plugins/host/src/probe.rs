//! A library is first loaded by a child process, which it may end or keep waiting without harm.
//!
//! The child is this program itself; what it finds goes to its standard output, a line each.

use crate::library::{Plugin, load};
use crate::manifest::Offered;
use carvegraph_sdk::{Command as Step, CutterShape, Dialect, Dimensions, Direction, Program};
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// How long a library may take to load and to say what it offers.
const PATIENCE: Duration = Duration::from_secs(5);

/// How often the child is looked at.
const LOOK: Duration = Duration::from_millis(1);

/// The last line of a child that came to its end.
const END: &str = "end";

/// What a probe found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Probed {
    /// What the plugin calls itself, and its version, if it says so.
    pub about: Option<(String, String)>,
    /// What it offers.
    pub offered: Offered,
}

/// What the child does: loads a library, tries what it offers, and writes what it found.
///
/// # Errors
/// If that cannot be written.
pub fn examine(library: &Path, out: &mut impl Write) -> io::Result<()> {
    match load(library).map_err(|fault| fault.to_string()).and_then(tried) {
        Ok(plugin) => list(&plugin, out)?,
        Err(why) => writeln!(out, "fault\t{}", why.replace(['\n', '\r'], " "))?,
    }
    writeln!(out, "{END}")?;
    out.flush()
}

fn tried(plugin: Plugin) -> Result<Plugin, String> {
    for shape in &plugin.cutters {
        try_cutter(&**shape).map_err(|why| format!("cutter {:?}: {why}", shape.name()))?;
    }
    for dialect in &plugin.dialects {
        try_dialect(&**dialect);
    }
    Ok(plugin)
}

/// A shape must have a profile where nothing is set; one from a drawing cannot be tried.
fn try_cutter(shape: &dyn CutterShape) -> Result<(), String> {
    if shape.drawing().is_some() {
        return Ok(());
    }
    let dimensions = Dimensions::new(shape.dimensions(), &[]).map_err(|fault| fault.to_string())?;
    shape.profile(&dimensions).map_err(|fault| fault.to_string())?;
    Ok(())
}

/// Whether it can post this is its own affair; that it comes back is what matters.
fn try_dialect(dialect: &dyn Dialect) {
    let commands = [
        Step::Spindle { direction: Direction::Clockwise, rpm: 10_000.0 },
        Step::Rapid { to: [0.0, 0.0, 5.0] },
        Step::Feed { to: [0.0, 0.0, 0.0], mm_per_min: 300.0 },
        Step::Feed { to: [1.0, 0.0, 0.0], mm_per_min: 600.0 },
        Step::Rapid { to: [1.0, 0.0, 5.0] },
    ];
    let program = Program {
        title: "probe",
        path_tolerance_mm: 0.01,
        commands: &commands,
        ..Program::default()
    };
    let _ = dialect.post(&program, &mut io::sink());
}

fn list(plugin: &Plugin, out: &mut impl Write) -> io::Result<()> {
    if let Some((id, version)) = &plugin.about {
        writeln!(out, "about\t{}\t{}", one_word(id), one_word(version))?;
    }
    for (sort, names) in plugin.offered().sorts() {
        for name in names {
            writeln!(out, "{sort}\t{name}")?;
        }
    }
    Ok(())
}

fn one_word(text: &str) -> String {
    text.replace(char::is_whitespace, " ")
}

/// Lets `child` examine a library: a command that will call [`examine`] and write to standard output.
///
/// # Errors
/// What is wrong with the library, for a user.
pub fn probe(mut child: Command) -> Result<Probed, String> {
    child.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let cannot = |fault: io::Error| format!("it cannot be tried: {fault}");
    let mut child = child.spawn().map_err(cannot)?;
    let (said, complained) = (read(child.stdout.take()), read(child.stderr.take()));
    let Some(status) = wait(&mut child).map_err(cannot)? else {
        let seconds = PATIENCE.as_secs();
        return Err(format!("it was loaded and did not come back within {seconds} s"));
    };
    let said = said.join().unwrap_or_default();
    match understood(&said) {
        Some(probed) => probed,
        None => Err(crashed(status, &complained.join().unwrap_or_default())),
    }
}

/// Reads all that a child says, which would otherwise wait for a reader.
fn read(from: Option<impl Read + Send + 'static>) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut text = Vec::new();
        // What was read before a fault is all there is.
        let _ = from.map(|from| from.take(1 << 20).read_to_end(&mut text));
        String::from_utf8_lossy(&text).into_owned()
    })
}

/// How a child ended; `None` if it had to be ended.
fn wait(child: &mut Child) -> io::Result<Option<ExitStatus>> {
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if begun.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        thread::sleep(LOOK);
    }
}

/// What a child's lines mean; `None` if it did not come to its end.
fn understood(said: &str) -> Option<Result<Probed, String>> {
    let mut probed = Probed::default();
    for line in said.lines() {
        let mut words = line.split('\t');
        let (sort, name) = (words.next()?, words.next().unwrap_or_default().to_owned());
        match sort {
            "about" => probed.about = Some((name, words.next().unwrap_or_default().to_owned())),
            "cutter" => probed.offered.cutters.push(name),
            "dialect" => probed.offered.dialects.push(name),
            "node" => probed.offered.nodes.push(name),
            "fault" => return Some(Err(name)),
            END => return Some(Ok(probed)),
            // A library may write to standard output too.
            _ => {}
        }
    }
    None
}

fn crashed(status: ExitStatus, complained: &str) -> String {
    let how = ending(status);
    match complained.lines().rev().find(|line| !line.trim().is_empty()) {
        Some(last) => format!("{how} when it was tried, saying {:?}", last.trim()),
        None => format!("{how} when it was tried"),
    }
}

#[cfg(unix)]
fn ending(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt;
    let name = match status.signal() {
        Some(4) => "an illegal instruction",
        Some(6) => "abort",
        Some(7) => "a bus error, as of a file cut short",
        Some(8) => "an arithmetic error",
        Some(11) => "a memory fault or a stack overflow",
        Some(other) => return format!("it ended the process by signal {other}"),
        None => return format!("it ended the process with {status}"),
    };
    format!("it ended the process by {name}")
}

#[cfg(not(unix))]
fn ending(status: ExitStatus) -> String {
    format!("it ended the process with {status}")
}
