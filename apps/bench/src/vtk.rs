//! The straight scenes drawn by VTK, in a Python that has it.

use anyhow::{Context, Result, bail, ensure};
use belvedere::Session;
use belvedere::core::{Pinhole, Projection};
use belvedere::export::{ExportOptions, export};
use belvedere::scene::{Color, Volume, VolumeLayer, VolumeModel, VoxelValues};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// Draws what it is told on standard input and prints its times.
const SCRIPT: &str = include_str!("vtk_straight.py");

/// Version of VTK.
///
/// # Errors
/// A Python that does not run or has no VTK.
pub(crate) fn version(python: &Path) -> Result<String> {
    let answer = run(python, &json!({ "kind": "version" }))?;
    Ok(answer["version"].as_str().context("VTK tells no version")?.to_owned())
}

/// Median processor time of a straight picture, milliseconds.
///
/// # Errors
/// A scene that cannot be written for VTK, a script that fails.
pub(crate) fn straight_ms(python: &Path, session: &Session, (image, frames): ([u32; 2], usize)) -> Result<f64> {
    let folder = tempfile::tempdir()?;
    let volume = session.scene().layers.iter().find_map(|layer| layer.kind.volume());
    let pinhole = session.view().pinhole();
    let mut order = match volume {
        Some(layer) => of_volume(layer, pinhole, folder.path())?,
        None => {
            let file = folder.path().join("scene.glb");
            std::fs::write(&file, export(session, &ExportOptions { straight: true, ..ExportOptions::default() })?.glb)?;
            json!({ "kind": "glb", "file": file })
        }
    };
    (order["image"], order["frames"]) = (json!(image), json!(frames));
    let answer = run(python, &order)?;
    answer["cpu_ms"].as_f64().context("VTK tells no time")
}

/// Voxels in a file of raw numbers, and how they are drawn.
fn of_volume(layer: &VolumeLayer, pinhole: &Pinhole, folder: &Path) -> Result<Value> {
    let volume: &Volume = &layer.volume;
    let (bytes, kind) = match volume.values() {
        VoxelValues::U8(values) => (values.clone(), "uint8"),
        VoxelValues::U16(values) => (values.iter().flat_map(|v| v.to_le_bytes()).collect(), "uint16"),
        VoxelValues::I16(values) => (values.iter().flat_map(|v| v.to_le_bytes()).collect(), "int16"),
        VoxelValues::F32(values) => (values.iter().flat_map(|v| v.to_le_bytes()).collect(), "float32"),
    };
    let file = folder.join("voxels.raw");
    std::fs::write(&file, bytes)?;
    let Projection::Perspective { fov_y } = pinhole.projection else { bail!("a volume in parallel projection") };
    let transfer = &layer.transfer;
    let spacing = [0, 1, 2].map(|axis| volume.axes().col(axis).length());
    let shares = |c: Color| [c.r, c.g, c.b].map(|v| f64::from(v) / 255.0);
    let points = transfer.points().iter().map(|p| {
        let [r, g, b] = shares(p.color);
        json!([p.value, r, g, b, p.opacity])
    });
    Ok(json!({
        "kind": "volume",
        "file": file,
        "dtype": kind,
        "dims": volume.dims(),
        "spacing": spacing,
        "origin": volume.origin().to_array(),
        "transfer": points.collect::<Vec<_>>(),
        "reference": layer.reference_length(),
        "step": layer.step_length(),
        "shaded": layer.model == VolumeModel::Shaded,
        "eye": pinhole.eye.to_array(),
        "target": (pinhole.eye + pinhole.forward).to_array(),
        "up": (-pinhole.down).to_array(),
        "fov_y_deg": fov_y.to_degrees(),
    }))
}

fn run(python: &Path, order: &Value) -> Result<Value> {
    let about = || format!("{} with the package vtk", python.display());
    let mut child = Command::new(python)
        .args(["-c", SCRIPT])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(about)?;
    child.stdin.take().context("standard input")?.write_all(order.to_string().as_bytes())?;
    let output = child.wait_with_output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{}: {}", about(), said.trim().lines().last().unwrap_or("it failed"));
    let text = String::from_utf8_lossy(&output.stdout);
    serde_json::from_str(text.trim().lines().last().unwrap_or_default()).with_context(about)
}
