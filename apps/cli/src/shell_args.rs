//! Arguments of completions and manual pages.

use clap::{Args, ValueEnum};
use clap_complete::Shell;
use std::path::PathBuf;

/// Completions.
#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// Shell
    #[arg(value_enum)]
    pub(crate) shell: ShellKind,
    /// Output; standard output if left out
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

/// Shells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShellKind {
    /// Bash
    Bash,
    /// Zsh
    Zsh,
    /// Fish
    Fish,
    /// PowerShell
    #[value(name = "powershell")]
    PowerShell,
}

impl From<ShellKind> for Shell {
    fn from(kind: ShellKind) -> Self {
        match kind {
            ShellKind::Bash => Self::Bash,
            ShellKind::Zsh => Self::Zsh,
            ShellKind::Fish => Self::Fish,
            ShellKind::PowerShell => Self::PowerShell,
        }
    }
}

/// Manual pages.
#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Folder for the pages
    pub(crate) dir: PathBuf,
}
