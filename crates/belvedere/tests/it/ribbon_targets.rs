//! Residues drawn as ribbons: what decides whether rays bend, or a fallback is taken, is what the picture shows.

use belvedere::construct::rays::BendReport;
use belvedere::core::View;
use belvedere::cpu::CpuRenderer;
use belvedere::request::Reveal;
use belvedere::scene::molecule::Selection;
use belvedere::scene::{Frame, Light, Progress, RenderJob, RenderOptions, Renderer, Scene};
use belvedere::verbs::reveal::{Found, RevealAnswer, Setting, reveal};
use std::fmt::Write;
use std::path::Path;

/// Seven parallel helices of 20 residues, one in the middle of the others: enough residues to be drawn as ribbons.
fn bundle() -> String {
    let (mut text, mut serial) = (String::new(), 0);
    for (k, chain) in "ABCDEFG".chars().enumerate() {
        let (sin, cos) = (k as f64 * std::f64::consts::TAU / 6.0).sin_cos();
        let axis = if k == 0 { [0.0, 0.0] } else { [8.0 * cos, 8.0 * sin] };
        for i in 0..20 {
            let (sin, cos) = (f64::from(i) * 100f64.to_radians() + 0.9 * k as f64).sin_cos();
            for (name, radius) in [("CA", 2.3), ("CB", 3.6)] {
                serial += 1;
                let [x, y, z] = [axis[0] + radius * cos, axis[1] + radius * sin, 1.5 * f64::from(i)];
                let _ = writeln!(
                    text,
                    "ATOM  {serial:>5}  {name:<3} ALA {chain}{:>4}    {x:>8.3}{y:>8.3}{z:>8.3}  1.00  0.00           C",
                    i + 1
                );
            }
        }
    }
    text
}

fn revealed(file: &Path, see: &str, fallback: &[&str]) -> RevealAnswer {
    let asked = Reveal {
        data: file.display().to_string(),
        see: Some(see.into()),
        size: Some([320, 180]),
        samples: Some(1),
        fallback: fallback.iter().map(|rule| (*rule).to_owned()).collect(),
        ..Reveal::default()
    };
    reveal(&asked, &Setting::default()).expect("revealed")
}

fn report(found: &RevealAnswer) -> BendReport {
    let Found::Target { report, .. } = &found.found else { panic!("no target") };
    *report
}

/// The ribbon of a selection alone.
fn alone(scene: &Scene, see: &str) -> Scene {
    let mut scene = scene.clone();
    let Some(molecule) = scene.layers[0].kind.molecule_mut() else { panic!("no molecule") };
    let own = molecule.mask_of(&Selection::parse(see).expect("a selection"));
    let mesh = &molecule.surface.mesh;
    molecule.surface.mesh = mesh.only(&|t| mesh.part(t).is_some_and(|part| own[part as usize]));
    scene
}

fn draw(scene: &Scene, view: &View) -> Frame {
    let (light, progress) = (Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    CpuRenderer::default()
        .render(&RenderJob { scene, view, light: &light, options: &options, progress: &progress })
        .expect("drawn")
}

/// Share of the pixels of a target that a picture shows at them or right beside them: its rim shares pixels with what is behind. And the
/// number of these pixels.
fn share(whole: &Frame, alone: &Frame) -> (f64, usize) {
    let own = |i: usize| alone.id[i] == 1;
    let same =
        |i: usize| own(i) && whole.id[i] == 1 && (whole.depth[i] - alone.depth[i]).abs() <= 2e-4 * alone.depth[i];
    let seen = |i: usize| [i, i - 1, i + 1, i - alone.width, i + alone.width].into_iter().any(same);
    let inner = alone.width..alone.id.len() - alone.width;
    let all = inner.clone().filter(|i| own(*i)).count();
    (inner.filter(|i| own(*i) && seen(*i)).count() as f64 / all.max(1) as f64, all)
}

#[test]
fn a_residue_drawn_as_a_ribbon_is_judged_bent_and_cut_free_by_its_pixels() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("bundle.pdb");
    std::fs::write(&file, bundle()).expect("written");
    let mut hidden = 0;
    for see in ["chain A and resi 10", "chain A and resi 3", "chain D and resi 12", "chain F and resi 7", "chain A"] {
        let found = revealed(&file, see, &[]);
        let scene = found.session.scene();
        let bent = found.session.view();
        let [straight, shown] = [&bent.straightened(), bent].map(|view| {
            let (share, pixels) = share(&draw(scene, view), &draw(&alone(scene, see), view));
            assert!(pixels > 30, "{see}: {pixels} pixels");
            share
        });
        let report = report(&found);
        let off =
            [straight * report.in_frame_straight - report.visible_straight, shown * report.in_frame - report.visible];
        assert!(off.iter().all(|off| off.abs() < 0.02), "{see}: {straight} and {shown} in the picture, {report:?}");
        assert!((report.light_straight - straight).abs() < 0.15, "{see}: {straight}, {report:?}");
        // Where something is hidden bends are tried; where all is seen nothing is bent, and no bend is taken that shows less.
        assert!(report.tried > 0 || straight >= 1.0 - 1e-9, "{see}: {straight}, {report:?}");
        assert!(shown >= straight && (shown > straight) == bent.is_bent(), "{see}: {straight} and {shown}");
        assert_eq!(found.missed().is_empty(), report.visible >= 0.99, "{see}: {report:?}");
        hidden += usize::from(report.visible < 0.99);
        // What no bend shows a fallback does, and only that.
        let cut = revealed(&file, see, &["cutaway"]);
        let record = cut.picture.sidecar.fallback.as_ref();
        assert_eq!(record.is_some(), cut.shares.visible_bent < 0.99, "{see}: {:?}", cut.shares);
        let view = cut.session.view();
        let (open, _) = share(&cut.picture.frame, &draw(&alone(cut.session.scene(), see), view));
        assert!(open >= 0.99 && cut.missed().is_empty(), "{see}: {open}, {record:?}");
        assert!(record.is_none_or(|r| (r.visible - open).abs() < 0.02 && r.visible_before < 0.99), "{see}: {record:?}");
    }
    assert!(hidden > 0, "no residue needs a fallback");
}
