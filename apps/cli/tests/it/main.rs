//! The command line as a user meets it: the built program, its exit codes, its one line about failures.

mod animate;
mod answers;
mod areas;
mod bad_scenes;
mod beyond_the_data;
mod broken_off;
mod cities;
mod city_targets;
mod constructors;
mod curve_inset;
mod curved_earth;
mod data_alone;
mod figures;
mod furniture;
mod generalise;
mod geopackage;
mod ground_moves;
mod layers;
mod light_and_tints;
mod marks;
#[cfg(target_os = "linux")]
mod memory;
mod meshes;
mod molecules;
mod numbers;
mod odd_files;
mod outputs;
mod packed;
mod panorama;
mod pick;
mod pictures;
mod places;
mod presets;
mod print;
mod privacy;
mod reveal;
mod reveal_looks;
mod rigid;
mod rivers;
mod scenes;
mod schema_check;
mod see_through;
mod shell;
mod speed;
mod strip;
mod stylisation;
mod terrain;
mod time_limit;
mod town_heights;
mod trusted;
mod tube;
mod typed_warnings;
mod volume_targets;
mod volumes;
#[cfg(target_os = "linux")]
mod window;
mod wrong_usages;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own, and the program run in it.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, text).expect("file is written");
        path
    }

    /// The program in this folder, with settings of its own.
    fn command(&self, args: &[&str]) -> Command {
        let settings =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join("settings").join(self.0.path().file_name().expect("name"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_belvedere"));
        command.current_dir(self.0.path()).args(args).env_remove("BELVEDERE_NO_TRUST");
        for name in ["HOME", "XDG_CONFIG_HOME", "APPDATA"] {
            command.env(name, &settings);
        }
        command
    }

    fn run(&self, args: &[&str]) -> Output {
        self.command(args).output().expect("the program starts")
    }

    /// Runs, expects success, returns standard output.
    fn ok(&self, args: &[&str]) -> String {
        let out = self.run(args);
        let text = String::from_utf8(out.stdout).expect("UTF-8");
        assert_eq!(out.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&out.stderr));
        text
    }

    /// Runs, expects failure with exactly one line on standard error, returns it.
    fn fails(&self, args: &[&str]) -> String {
        let out = self.run(args);
        let text = String::from_utf8(out.stderr).expect("UTF-8");
        assert_eq!(out.status.code(), Some(2), "{args:?}: {text}");
        assert_eq!(text.lines().count(), 1, "{args:?}: {text}");
        assert!(text.starts_with("belvedere: "), "{text}");
        text.trim_end().to_owned()
    }

    /// Runs with `input` as standard input; standard output, standard error, and the code.
    fn piped(&self, args: &[&str], input: &[u8]) -> (String, String, Option<i32>) {
        use std::io::Write;
        use std::process::Stdio;
        let mut command = self.command(args);
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        // A program that does not read its input may end before it is written.
        let _ = child.stdin.take().expect("a pipe").write_all(input);
        let out = child.wait_with_output().expect("it ends");
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        (text(out.stdout), text(out.stderr), out.status.code())
    }

    fn json(&self, args: &[&str]) -> serde_json::Value {
        serde_json::from_str(&self.ok(args)).expect("JSON on standard output")
    }
}

/// A scene of nothing but a camera.
const BARE: &str = "format = 1\n[camera]\neye = [0.0, 0.0, 0.0]\nlook_at = [0.0, 1.0, 0.0]\n";

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}
