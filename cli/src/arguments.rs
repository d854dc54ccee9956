//! What the command line takes. Scripts depend on these names.

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use std::path::PathBuf;

/// Turns pictures, scans and meshes into machine programs.
#[derive(Debug, Parser)]
#[command(name = "carve", version, about, arg_required_else_help = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Looks for plugins in this folder too; may be given many times
    #[arg(long, value_name = "DIR", global = true)]
    pub(crate) plugins: Vec<PathBuf>,
}

/// A recipe and what is changed in it.
#[derive(Args, Debug)]
pub(crate) struct Job {
    /// A built-in recipe by name (see `carve graphs`), or a recipe's file
    pub(crate) recipe: String,
    /// Sets a parameter of the recipe, or any node's as node.field; may be given many times
    #[arg(long, value_name = "NAME=VALUE", value_parser = name_and_value)]
    pub(crate) set: Vec<(String, String)>,
}

#[derive(Args, Debug)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) job: Job,
    /// Folder that the files are written to
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub(crate) out: PathBuf,
    /// Makes only what this node makes; may be given many times
    #[arg(long, value_name = "NODE")]
    pub(crate) only: Vec<String>,
    /// Number of threads; one a core if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Folder that keeps what was made, so that the next run only makes what changed
    #[arg(long, value_name = "DIR")]
    pub(crate) cache: Option<PathBuf>,
    /// Writes a report for scripts
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
    /// Writes no page about the run beside its files
    #[arg(long)]
    pub(crate) no_html: bool,
    /// Says nothing but errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Runs a recipe
    Run(RunArguments),
    /// Checks a recipe without running it
    Check {
        #[command(flatten)]
        job: Job,
    },
    /// Shows what running a recipe would do
    Plan {
        #[command(flatten)]
        job: Job,
        /// Only what this node needs; may be given many times
        #[arg(long, value_name = "NODE")]
        only: Vec<String>,
        /// Folder that the files would be written to
        #[arg(long, value_name = "DIR", default_value = "out")]
        out: PathBuf,
        /// Folder that keeps what was made
        #[arg(long, value_name = "DIR")]
        cache: Option<PathBuf>,
        /// Tells why this node would run
        #[arg(long, value_name = "NODE")]
        explain: Option<String>,
    },
    /// Lists the kinds of node, or describes one
    Nodes {
        /// The kind to describe
        kind: Option<String>,
        /// Writes JSON for programs
        #[arg(long)]
        json: bool,
    },
    /// Lists the shapes of cutter
    Cutters,
    /// Lists the dialects of G-code, or begins a new one
    Dialects {
        #[command(subcommand)]
        action: Option<DialectAction>,
    },
    /// Lists the machines
    Machines,
    /// Lists the tools
    Tools,
    /// Lists the plugins, explains what is wrong with one, or installs one
    Plugins {
        #[command(subcommand)]
        action: Option<PluginAction>,
    },
    /// Lists the built-in recipes, or describes one
    Graphs {
        /// The recipe to describe
        name: Option<String>,
        /// Writes the recipe's text, to save and change
        #[arg(long, requires = "name")]
        text: bool,
    },
    /// Writes a script that completes command lines in a shell
    Completions {
        /// The shell
        shell: Shell,
    },
}

#[derive(Debug, Subcommand)]
pub(crate) enum DialectAction {
    /// Writes a dialect file to change, with everything that can be said as comments
    New {
        /// What recipes are to call it: lower-case letters, digits and _
        name: String,
        /// The dialect that it is to be like
        #[arg(long, value_name = "DIALECT", default_value = "iso6983")]
        from: String,
    },
}

#[derive(Debug, Subcommand)]
pub(crate) enum PluginAction {
    /// Loads every plugin and tells what is wrong with those that cannot be used
    Doctor,
    /// Puts a library, or a .ron file with a dialect, a machine or tools, into your plugin folder or
    /// into that of --plugins
    Install {
        /// The library or the file
        file: PathBuf,
        /// What to call the plugin, if it does not say
        #[arg(long)]
        id: Option<String>,
    },
    /// Tries a library; called by the other commands in a process of its own
    #[command(hide = true)]
    Probe {
        /// The library
        library: PathBuf,
    },
}

fn name_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write NAME=VALUE, such as diameter=6 or image=photo.png".to_owned()),
    }
}
