//! Encodes frames as a film with an ffmpeg program, if there is one.

use super::manifest::frame_name;
use crate::BelvedereError;
use belvedere_io::atomic::{self, Temporary};
use belvedere_scene::{Cancelled, Progress};
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Result of encoding a film.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Film {
    /// Not asked for: the output is a folder of frames.
    Unwanted,
    /// The film was encoded.
    Made(PathBuf),
    /// The film could not be encoded; the frames exist.
    Missing {
        /// Why not.
        reason: String,
        /// The command that encodes the frames.
        command: String,
    },
}

/// Encoders in order of preference; the second is in every build of the program.
const ENCODERS: [&[&str]; 2] =
    [&["-c:v", "libx264", "-crf", "18", "-preset", "medium"], &["-c:v", "mpeg4", "-q:v", "2"]];

/// Encoders need even widths and heights.
const EVEN: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2";

/// Encodes the frames of `folder` as `out`.
pub(super) fn make(
    out: &Path,
    folder: &Path,
    frames: usize,
    fps: f64,
    progress: &Progress,
) -> Result<Film, BelvedereError> {
    let pattern = frame_name(0).replace("00000", "%05d");
    let command = by_hand(out, folder, &pattern, (frames, fps));
    let temporary = Temporary::beside(out).map_err(|e| belvedere_io::IoError::os(out, e))?;
    let film = std::path::absolute(temporary.path()).map_err(|e| belvedere_io::IoError::os(out, e))?;
    let mut complaint = String::new();
    for encoder in ENCODERS {
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg.args(["-nostdin", "-hide_banner", "-loglevel", "error", "-y", "-framerate", &fps.to_string()]);
        // In the folder of the frames: in a pattern, % and digits would stand for numbers, and a colon ends the name of a protocol.
        ffmpeg.current_dir(folder).args(["-f", "image2", "-start_number", "0", "-i", &pattern]);
        ffmpeg.args(["-frames:v", &frames.to_string()]);
        ffmpeg.args(["-vf", EVEN]).args(encoder);
        ffmpeg.args(["-pix_fmt", "yuv420p", "-movflags", "+faststart", "-map_metadata", "-1"]);
        ffmpeg.args(["-fflags", "+bitexact", "-flags:v", "+bitexact", "-f", "mp4"]).arg(as_file(&film));
        let ran = run(&mut ffmpeg, progress);
        match ran {
            Ok((true, _)) => {
                atomic::publish(temporary, true)?;
                return Ok(Film::Made(out.to_owned()));
            }
            Ok((false, said)) => complaint = said,
            Err(Failure::Absent) => {
                let (out, folder) = (out.display(), folder.display());
                let reason = format!(
                    "there is no ffmpeg program on the PATH, so {out} was not made; the frames are in {folder}"
                );
                return Ok(Film::Missing { reason, command });
            }
            Err(Failure::Cancelled) => return Err(Cancelled.into()),
            Err(Failure::Other(said)) => complaint = said,
        }
    }
    let last = complaint.lines().rfind(|l| !l.trim().is_empty()).unwrap_or("it gave no reason").trim();
    let reason = format!("ffmpeg could not make {} ({last}); the frames are in {}", out.display(), folder.display());
    Ok(Film::Missing { reason, command })
}

/// A path that ffmpeg takes for a file, whatever its name.
fn as_file(path: &Path) -> OsString {
    let mut name = OsString::from("file:");
    name.push(path);
    name
}

/// The command that encodes the frames, for the shell of the user.
fn by_hand(out: &Path, folder: &Path, pattern: &str, (count, fps): (usize, f64)) -> String {
    let frames = PathBuf::from(folder.display().to_string().replace('%', "%%")).join(pattern);
    let quoted = |path: &Path| {
        let name = as_file(path).to_string_lossy().into_owned();
        let plain = name.chars().all(|c| c.is_alphanumeric() || "/._-%:".contains(c));
        // Names with a colon are no plain files to ffmpeg.
        let short = name.strip_prefix("file:").filter(|name| !name.contains(':')).unwrap_or(&name);
        if plain { short.to_owned() } else { format!("'{}'", short.replace('\'', "'\\''")) }
    };
    let (frames, out) = (quoted(&frames), quoted(out));
    // An earlier, longer film may have left further frames in the folder.
    format!("ffmpeg -framerate {fps} -i {frames} -frames:v {count} -vf '{EVEN}' -pix_fmt yuv420p {out}")
}

enum Failure {
    Absent,
    Cancelled,
    Other(String),
}

/// Runs the program; returns whether it succeeded, and its error messages.
fn run(command: &mut Command, progress: &Progress) -> Result<(bool, String), Failure> {
    let started = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
    let mut child = started.map_err(|e| match e.kind() {
        ErrorKind::NotFound => Failure::Absent,
        _ => Failure::Other(e.to_string()),
    })?;
    let stderr = child.stderr.take();
    let reader = std::thread::spawn(move || {
        let mut said = Vec::new();
        stderr.map(|mut pipe| std::io::Read::read_to_end(&mut pipe, &mut said));
        String::from_utf8_lossy(&said).into_owned()
    });
    let status = loop {
        if progress.tick("making the film", 1.0).is_err() {
            let _ = child.kill();
            let _ = child.wait();
            return Err(Failure::Cancelled);
        }
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) => std::thread::sleep(Duration::from_millis(20)),
            Err(e) => return Err(Failure::Other(e.to_string())),
        }
    };
    Ok((status.success(), reader.join().unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_by_hand_takes_the_frames_of_this_film_alone() {
        let command = by_hand(Path::new("a b.mp4"), Path::new("f"), "frame_%05d.png", (12, 25.0));
        let wanted = "ffmpeg -framerate 25 -i f/frame_%05d.png -frames:v 12 -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -pix_fmt yuv420p 'a b.mp4'";
        assert_eq!(command, wanted);
    }
}
