//! What is painted on drawn ground: lines of equal height lie at their heights, in bent views too, and the edge of the data fades.

use belvedere::scene::Frame;
use belvedere::{OpenOptions, Session};
use belvedere::{
    RendererName,
    picture::{AuxBuffer, PictureOptions},
};
use std::path::Path;

/// The interval, scene units.
const EVERY: f64 = 100.0;

fn session(style: &str, light: &str, stages: &str) -> Session {
    let text = format!(
        "format = 1
crs = 'local'
[camera]
eye = [0, -9000, 6000]
look_at = [0, 0, 800]
image = [320, 220]
[overlay]
mark = false
[light]
haze = false
{light}
[[layer]]
id = 'ground'
kind = 'terrain'
source = 'builtin:massif?size=129'
style = {{ relief = 'none', palette = 'plain', {style} }}
{stages}"
    );
    Session::from_text(Path::new("s.toml"), &text, &OpenOptions::default()).expect("a scene")
}

fn drawn(session: &Session, renderer: RendererName) -> Frame {
    let aux = vec![AuxBuffer::World];
    session.render(&PictureOptions { aux, renderer, ..PictureOptions::default() }).expect("a picture").frame
}

const BENT: &str = "[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n";

#[test]
fn lines_lie_at_their_heights_straight_and_bent_by_both_renderers() {
    for stages in ["", BENT] {
        for renderer in [RendererName::CPU, RendererName::EXACT] {
            let with = session(&format!("contours = {EVERY}"), "", stages);
            let (lines, bare) = (drawn(&with, renderer.clone()), drawn(&session("", "", stages), renderer.clone()));
            let ground = with.scene().terrain().expect("ground");
            let world = lines.world.as_ref().expect("places");
            let height =
                |i: usize| (lines.id[i] == 1).then(|| ground.height_at([world[i][0], world[i][1]].into())).flatten();
            let (mut dark, mut on, mut missed) = (0, 0, 0);
            for y in 1..219 {
                for x in 1..319 {
                    let i = y * 320 + x;
                    let changed = lines.color[i][1].abs_diff(bare.color[i][1]);
                    let around = [i, i - 1, i + 1, i - 320, i + 320].map(height);
                    let [Some(h), Some(w), Some(e), Some(n), Some(s)] = around else { continue };
                    let ([least, most], [across, down]) = (
                        [h, w, e, n, s]
                            .iter()
                            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]),
                        [0.5 * (e - w), 0.5 * (s - n)],
                    );
                    let change = across.hypot(down);
                    let off = (h - EVERY * (h / EVERY).round()).abs();
                    if changed > 40 {
                        dark += 1;
                        // A thick line reaches 1.4 pixels to either side.
                        let near = off <= 2.0 * (most - least).max(change);
                        assert!(near, "({x}, {y}): {off} m off at {change} m a pixel");
                    }
                    // Smooth slopes with lines at least 8 pixels apart: every place on a line is dark.
                    let smooth = (e - h - (h - w)).abs() < 0.3 * change && (s - h - (h - n)).abs() < 0.3 * change;
                    if smooth && off < 0.2 * change && EVERY / change > 8.0 {
                        on += 1;
                        missed += usize::from(changed < 20);
                    }
                }
            }
            assert!(dark > 500 && on > 60 && missed == 0, "{renderer:?}: {dark} dark, {missed} of {on} missed");
        }
    }
}

#[test]
fn the_edge_fades_into_the_background_and_the_middle_stays() {
    for light in ["sky = 'white'", "sky = '#102030'"] {
        let white = light.contains("white");
        let (soft, plain) = (session("edge = 'soft'", light, ""), session("", light, ""));
        let [a, b] = [&soft, &plain].map(|session| drawn(session, RendererName::CPU));
        let bounds = plain.scene().terrain().expect("ground").bounds();
        let size = (bounds.max - bounds.min).truncate().min_element();
        let world = b.world.as_ref().expect("places");
        let from_rim = |[x, y, _]: [f64; 3]| {
            (x - bounds.min.x).min(bounds.max.x - x).min(y - bounds.min.y).min(bounds.max.y - y) / size
        };
        // Pixels at whose rim a sample may see ground that fades are left out.
        let around =
            |i: usize| [0, 1, 319, 320, 321].into_iter().flat_map(move |k| [i.checked_sub(k), Some(i + k)]).flatten();
        let (mut faded, mut whole) = (0, 0);
        for (i, place) in world.iter().enumerate() {
            if b.id[i] != 1 || a.id[i] != 1 {
                continue;
            }
            let (rim, inside) = (from_rim(*place), |j: usize| world.get(j).is_some_and(|p| from_rim(*p) > 0.06));
            // A pixel's samples see as far inwards as its neighbours do.
            let at_rim = |j: usize| b.id.get(j) != Some(&1) || world.get(j).is_some_and(|p| from_rim(*p) < 0.01);
            if rim < 0.002 && around(i).all(at_rim) {
                let sky = if white { [255u8, 255, 255] } else { [16, 32, 48] };
                let off = (0..3).map(|k| a.color[i][k].abs_diff(sky[k])).max().unwrap_or(0);
                assert!(off < 40, "{:?} at the rim", a.color[i]);
                faded += 1;
            }
            if around(i).all(inside) {
                assert_eq!(a.color[i], b.color[i]);
                whole += 1;
            }
        }
        assert!(faded > 20 && whole > 5000, "{faded} faded, {whole} whole");
    }
}

#[test]
fn a_faded_edge_lets_a_transparent_background_through() {
    let picture = |style: &str| {
        let session = session(style, "sky = 'transparent'", "");
        let picture = session.render(&PictureOptions::default()).expect("a picture");
        picture.to_png().expect("bytes")
    };
    let folder = std::env::temp_dir().join(format!("belvedere_edges_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let partly = |style: &str| {
        let path = folder.join("p.png");
        std::fs::write(&path, picture(style)).expect("written");
        let raster = belvedere::io::png::read(&path, &belvedere::io::Limits::default()).expect("a picture");
        let belvedere::io::Samples::U8(samples) = raster.samples else { panic!("bytes") };
        samples.chunks_exact(4).filter(|p| (20..236).contains(&p[3])).count()
    };
    let (soft, plain) = (partly("edge = 'soft'"), partly(""));
    std::fs::remove_dir_all(&folder).expect("removed");
    assert!(soft > 3 * plain && soft > 300, "{soft} and {plain} pixels shine through in part");
}
