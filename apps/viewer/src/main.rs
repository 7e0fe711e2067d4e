//! The program `belvedere-view`: the application in its own window. `belvedere view` starts it.

#[cfg(not(target_family = "wasm"))]
mod native {
    use belvedere::Trust;
    use belvedere_viewer::Opening;
    use clap::Parser;
    use std::io::Write;
    use std::path::PathBuf;
    use std::process::ExitCode;

    /// The application: look, drag, tilt, author
    #[derive(Debug, Parser)]
    #[command(name = "belvedere-view", version)]
    struct Args {
        /// A scene file; or models; or an elevation model, alone or with routes, areas or points; nothing: the built-in scenes
        files: Vec<PathBuf>,
        /// Folder outside the scene's own from which its files may come; may be given several times
        #[arg(long, value_name = "DIR")]
        allow_root: Vec<PathBuf>,
        /// Do not remember which files outside their folders scenes may read, and do not use what is remembered
        #[arg(long)]
        no_remember: bool,
    }

    pub(super) fn main() -> ExitCode {
        let args = Args::parse();
        std::panic::set_hook(Box::new(|_| {}));
        // What is too large for the memory beside what is open becomes a notice.
        belvedere::io::budget::count_own();
        let opening = Opening {
            files: args.files,
            allowed: args.allow_root,
            trust: if args.no_remember { Trust::default() } else { Trust::of_user() },
            state: Opening::usual_state(),
            system_dialogs: true,
            left: None,
            language: Opening::usual_language(),
        };
        // Windows require the main thread. Documents are read on other threads.
        let failure = match std::panic::catch_unwind(|| belvedere_viewer::run(&opening)) {
            Ok(Ok(())) => return ExitCode::SUCCESS,
            Ok(Err(e)) => e.to_string(),
            Err(panic) => fault(&*panic),
        };
        let _ = writeln!(std::io::stderr(), "belvedere: {failure}");
        ExitCode::from(2)
    }

    /// An internal error as one line.
    fn fault(panic: &(dyn std::any::Any + Send)) -> String {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        let what = text.unwrap_or("no message").lines().next().unwrap_or_default();
        format!("internal error ({what}); please report this with the command line and the files")
    }
}

#[cfg(not(target_family = "wasm"))]
fn main() -> std::process::ExitCode {
    native::main()
}

/// In a browser the program is the library.
#[cfg(target_family = "wasm")]
fn main() {}
