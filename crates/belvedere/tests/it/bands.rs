//! Pictures in bands: the same bytes as in one piece.

use belvedere::scene::{Progress, Stylisation};
use belvedere::{BelvedereError, Needs, OpenOptions, PictureOptions, Session};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

fn scene(name: &str, image: [u32; 2]) -> Session {
    scene_with(name, image, "")
}

/// * `more`: text at the end of the scene file.
fn scene_with(name: &str, image: [u32; 2], more: &str) -> Session {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let options = OpenOptions { image: Some(image), needs: Needs::Everything, ..OpenOptions::default() };
    // Coarser ground is solved sooner.
    let text = std::fs::read_to_string(&path).expect("a scene").replace("&size=513", "&size=129") + more;
    Session::from_text(&path, &text, &options).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Files of a picture that is drawn so many rows at a time.
fn files(session: &Session, options: &PictureOptions, out: &Path, rows: usize) -> Vec<(PathBuf, Vec<u8>)> {
    let options = PictureOptions { band_rows: Some(rows), ..options.clone() };
    let (picture, written) = session.render_to(&options, out, true).expect("drawn");
    assert_eq!(picture.frame.color.is_empty(), rows > 0, "bands leave no pixels in memory");
    written.into_iter().map(|path| (path.clone(), std::fs::read(&path).expect("written"))).collect()
}

/// Whether pictures in bands of several heights, and their records, are those in one piece, byte for byte.
fn are_alike(name: &str, session: &Session, options: &PictureOptions) {
    let folder = tempfile::tempdir().expect("a folder");
    for (ending, heights) in [("png", &[16, 48, 1000][..]), ("tif", &[32]), ("jpg", &[48])] {
        let out = folder.path().join(format!("picture.{ending}"));
        let whole = files(session, options, &out, 0);
        for &rows in heights {
            let bands = files(session, options, &out, rows);
            assert_eq!(whole.len(), bands.len(), "{name}");
            for (a, b) in whole.iter().zip(&bands) {
                assert_eq!(a.0, b.0);
                let same =
                    a.1 == b.1 || a.0.extension().is_some_and(|e| e == "json") && unscored(&a.1) == unscored(&b.1);
                assert!(same, "{name}: {} in bands of {rows} rows differs", a.0.display());
            }
        }
    }
}

/// A record without the score of the look, which needs all pixels at once.
fn unscored(record: &[u8]) -> serde_json::Value {
    let mut record: serde_json::Value = serde_json::from_slice(record).expect("a record");
    record.as_object_mut().expect("an object").remove("look");
    record
}

fn all(name: &str, image: [u32; 2]) {
    let session = scene(name, image);
    let usual = PictureOptions::default();
    let drawn = Stylisation { edges: 0.8, unsharp: 4.0 };
    let options = [
        ("as it is", usual.clone()),
        ("with edges and shade", PictureOptions { stylisation: Some(drawn), ..usual.clone() }),
        ("straight, with a grid", PictureOptions { straight: true, grid: Some(None), ..usual.clone() }),
        ("denser", PictureOptions { density: 2.7, ..usual }),
    ];
    // One scene in every way, the others in two.
    let ways = if name == "massif.toml" { options.len() } else { 2 };
    for (what, options) in options.into_iter().take(ways) {
        are_alike(&format!("{name} {what}"), &session, &options);
    }
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn ground_with_a_route_and_names_is_the_same_in_bands() {
    all("massif.toml", [333, 217]);
    all("massif_panorama.toml", [401, 150]);
    all("massif_strip.toml", [301, 170]);
}

#[test]
fn ground_behind_curved_rays_or_made_way_for_is_the_same_in_bands() {
    all("massif_curved_rays.toml", [333, 217]);
    all("massif_terrain.toml", [260, 181]);
    all("massif_lake_terrain.toml", [260, 181]);
    all("massif_all_stages.toml", [240, 150]);
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn towns_and_maps_in_parallel_projection_are_the_same_in_bands() {
    all("town.toml", [333, 217]);
    all("town_rigid.toml", [333, 217]);
    all("street.toml", [333, 217]);
    all("massif_plan_oblique.toml", [305, 197]);
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn levels_of_a_town_that_are_drawn_one_by_one_are_the_same_in_bands() {
    all("town_sections.toml", [233, 157]);
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn molecules_and_what_shines_through_are_the_same_in_bands() {
    all("dna.toml", [233, 117]);
    all("church.toml", [233, 117]);
}

#[test]
fn contours_do_not_break_between_bands() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/massif_curved_rays.toml");
    let text = std::fs::read_to_string(&path).expect("a scene").replace("&size=513", "&size=129");
    let open = |text: &str| {
        let options = OpenOptions { image: Some([333, 217]), needs: Needs::Everything, ..OpenOptions::default() };
        Session::from_text(&path, text, &options).expect("a scene")
    };
    let with = text.replacen("kind = \"terrain\"", "kind = \"terrain\"\nstyle = { contours = 20 }", 1);
    let (lined, plain) = (open(&with), open(&text));
    let options = PictureOptions::default();
    let color = |session: &Session| session.render(&options).expect("drawn").frame.color;
    let changed = color(&lined).iter().zip(&color(&plain)).filter(|(a, b)| a != b).count();
    assert!(changed > 2000, "lines in {changed} pixels");
    are_alike("contours", &lined, &options);
}

#[test]
fn molecules_with_shadows_are_the_same_in_bands_and_on_any_number_of_threads() {
    let lit = |shadows: bool| scene_with("dna.toml", [233, 117], &format!("\n[light]\nshadows = {shadows}\n"));
    let session = lit(true);
    are_alike("dna.toml with shadows", &session, &PictureOptions::default());
    let drawn = |session: &Session, threads: usize| {
        let mut options = PictureOptions::default();
        options.quality.threads = threads;
        session.render(&options).expect("drawn").frame.color
    };
    let one = drawn(&session, 1);
    assert!(one == drawn(&session, 3), "threads change nothing");
    let bright = |colors: &[[u8; 3]]| colors.iter().flatten().map(|c| f64::from(*c)).sum::<f64>() / colors.len() as f64;
    let without = drawn(&lit(false), 1);
    let darker = one.iter().zip(&without).filter(|(a, b)| a[0].saturating_add(8) < b[0]).count();
    assert!(darker > one.len() / 100 && bright(&one) < bright(&without), "{darker} pixels lie in shadow");
}

#[test]
fn what_needs_one_piece_says_so_and_how_much_memory() {
    let session = scene("massif.toml", [333, 217]);
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |options: PictureOptions, name: &str| {
        let options = PictureOptions { band_rows: Some(16), ..options };
        let error = session.render_to(&options, &folder.path().join(name), true).expect_err("refused");
        assert!(matches!(error, BelvedereError::OnePiece { .. }), "{error}");
        let text = error.to_string();
        assert!(
            text.contains("333 x 217") && text.contains("MiB") && text.len() < 500 && !text.contains('\n'),
            "{text}"
        );
        text
    };
    let usual = PictureOptions::default;
    assert!(refused(PictureOptions { compare: true, ..usual() }, "a.png").contains("the pair of pictures"));
    assert!(refused(PictureOptions { heatmap: true, ..usual() }, "a.png").contains("heat map"));
    assert!(refused(usual(), "a.webp").contains("its format"));
    let mut tight = usual();
    tight.quality.max_bytes = 12 << 20;
    tight.compare = true;
    let error = session.render_to(&tight, &folder.path().join("a.png"), true).expect_err("too little memory");
    assert!(matches!(error, BelvedereError::OnePiece { limit_mib: ..=12, .. }), "{error}");
    assert!(std::fs::read_dir(folder.path()).expect("a folder").next().is_none(), "nothing is left behind");
}

#[test]
fn a_picture_that_is_cancelled_between_bands_leaves_no_file() {
    let session = scene("massif.toml", [333, 217]);
    let folder = tempfile::tempdir().expect("a folder");
    let (bands, stop) = (AtomicUsize::new(0), Arc::new(OnceLock::<Arc<AtomicBool>>::new()));
    let within = stop.clone();
    let progress = Progress::new(move |what, _| {
        if what == "draw" && bands.fetch_add(1, Relaxed) == 5 {
            within.get().expect("set").store(true, Relaxed);
        }
    });
    stop.set(progress.cancel_flag()).expect("once");
    let options = PictureOptions { band_rows: Some(16), progress, ..PictureOptions::default() };
    let error = session.render_to(&options, &folder.path().join("a.png"), true).expect_err("cancelled");
    assert!(matches!(error, BelvedereError::Cancelled(_) | BelvedereError::Render(_)), "{error}");
    assert!(std::fs::read_dir(folder.path()).expect("a folder").next().is_none(), "nothing is left behind");
}
