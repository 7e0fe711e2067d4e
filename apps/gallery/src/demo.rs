//! `demo`: the built-in scenes, straight and bent side by side, and their cameras, with a page that shows them.

use crate::html::{self, escape};
use anyhow::{Context, Result};
use belvedere::construct::measure::Visibility;
use belvedere::construct::{self, MeasureOptions, Measures};
use belvedere::picture;
use belvedere::{CameraPicture, OpenOptions, PictureOptions, Session, Sidecar, output, scene_file};
use std::path::{Path, PathBuf};

/// A scene of the demo; it needs no files.
#[derive(Debug, Clone, Copy)]
pub struct DemoScene {
    /// Start of the names of its files.
    pub name: &'static str,
    /// The scene file.
    pub text: &'static str,
    /// What a picture pair shows, in one sentence.
    sentence: &'static str,
    /// Whether its rays are bent, so that pictures of the camera are drawn too.
    bends_rays: bool,
}

/// Every technique, on generated ground.
pub const SCENES: &[DemoScene] = &[
    DemoScene {
        name: "massif",
        text: include_str!("../../../scenes/massif.toml"),
        sentence: "The far valleys tilt towards you along a smooth curve: all of the trail comes into sight, and the picture keeps a horizon.",
        bends_rays: true,
    },
    DemoScene {
        name: "massif_curved_rays",
        text: include_str!("../../../scenes/massif_curved_rays.toml"),
        sentence: "The rays of sight run straight at first and then bend down over the ridge, into the valley behind it.",
        bends_rays: true,
    },
    DemoScene {
        name: "massif_terrain",
        text: include_str!("../../../scenes/massif_terrain.toml"),
        sentence: "The rays stay straight and the ground makes way: ridges sink just as far as they must, and the road, the trail and the lake behind them are seen.",
        bends_rays: false,
    },
    DemoScene {
        name: "street",
        text: include_str!("../../../scenes/street.toml"),
        sentence: "The near streets are seen steeply from above, so that the way lies open between the towers; the far side of town stays a skyline.",
        bends_rays: true,
    },
];

impl DemoScene {
    fn cameras(&self) -> &'static [(&'static str, CameraPicture)] {
        if self.bends_rays { &CAMERAS } else { &[] }
    }
}

/// Pictures of a camera whose rays bend: ending of the name and kind of picture.
const CAMERAS: [(&str, CameraPicture); 2] =
    [("_camera", CameraPicture::Outside(None)), ("_overhead", CameraPicture::Overhead)];

/// `demo`: draws every scene of [`SCENES`] into `folder`, which is made if need be: `NAME.png` (straight beside bent) with its
/// record, `NAME.toml`, where rays bend `NAME_camera.png` (the camera from outside) and `NAME_overhead.png` with their records,
/// and `index.html`. Returns the files.
///
/// # Errors
/// A file that exists if `overwrite` is false, else as [`Session::render`].
pub fn demo(folder: &Path, options: &OpenOptions, request: &PictureOptions, overwrite: bool) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let index = folder.join("index.html");
    let progress = options.progress.clone();
    let request = PictureOptions { compare: true, straight: false, progress, ..request.clone() };
    let picture_of = |name: &str| folder.join(format!("{name}.png"));
    let scene_of = |name: &str| folder.join(format!("{name}.toml"));
    output::check(&index, &[], overwrite)?;
    for scene in SCENES {
        let name = scene.name;
        output::check(&scene_of(name), &[], overwrite)?;
        let cameras = scene.cameras().iter().map(|(ending, _)| format!("{name}{ending}"));
        let solves = scene_file::parse(&scene_of(name), scene.text)?.document.solves_terrain();
        let cameras = cameras.flat_map(|name| picture::outputs(&picture_of(&name), &request, false));
        for path in picture::outputs(&picture_of(name), &request, solves).into_iter().chain(cameras) {
            output::check(&path, &[], overwrite)?;
        }
    }
    let (mut written, mut sections) = (Vec::new(), String::new());
    for scene in SCENES {
        let DemoScene { name, text, .. } = *scene;
        output::write_text(&scene_of(name), text, overwrite)?;
        let session = Session::open(&scene_of(name), options)?;
        let picture = session.render(&request)?;
        // Measured by lines of sight alone, without a second frame.
        let measures =
            construct::measure(session.scene(), session.view(), None, &MeasureOptions::default(), &options.progress)?;
        written.extend(picture.write(&picture_of(name), overwrite)?);
        for (ending, camera) in scene.cameras() {
            let request = PictureOptions { compare: false, camera: Some(*camera), ..request.clone() };
            let picture = session.render(&request)?;
            written.extend(picture.write(&picture_of(&format!("{name}{ending}")), overwrite)?);
        }
        written.push(scene_of(name));
        sections += &section(scene, &picture.sidecar, &measures);
    }
    output::write_text(&index, &page(&sections), overwrite)?;
    written.push(index);
    Ok(written)
}

fn section(scene: &DemoScene, sidecar: &Sidecar, measures: &Measures) -> String {
    let DemoScene { name, sentence, .. } = *scene;
    let (mut straight, mut bent) = ("straight".to_owned(), "bent".to_owned());
    if let Some(line) = &measures.lines {
        let share = |s: &Visibility| match (s.visible_share, s.in_frame_share) {
            (Some(seen), Some(inside)) => format!(
                ": {:.0} % of the route is visible, {:.0} % of it lies in the picture",
                100.0 * seen,
                100.0 * inside
            ),
            _ => String::new(),
        };
        straight += &share(&line.straight);
        bent += &share(&line.bent);
    }
    let moved = sidecar.displacement.map_or(String::new(), |d| {
        format!(
            "Nothing is cut away: what you see is moved by up to {:.0} m, {:.0} pixels in the picture. ",
            d.max_m, d.max_px
        )
    });
    let title = escape(&sidecar.title);
    let cameras = if scene.bends_rays { cameras(name, &title) } else { String::new() };
    let says = format!("{title}: two pictures from the same camera. Left, {straight}. Right, {bent}.");
    let picture = html::picture(&format!("{name}.png"), &says);
    format!(
        "<section>\n<h2>{title}</h2>\n<p>{sentence}</p>\n<figure>\n{picture}\n\
         <figcaption><span>{straight}</span><span>{bent}</span></figcaption>\n</figure>\n\
         <p><code>belvedere render {name}.toml -o mine.png --compare</code></p>\n\
         {cameras}<p class=\"small\">{moved}<a href=\"{name}.toml\">Scene</a> · <a href=\"{name}.png.json\">record</a></p>\n</section>\n",
    )
}

/// The camera of a scene from outside and from above.
fn cameras(name: &str, title: &str) -> String {
    let says = format!("The camera of {title} from outside: its rays on the terrain");
    let outside = html::picture(&format!("{name}_camera.png"), &says);
    let overhead = html::picture(&format!("{name}_overhead.png"), "The same from above");
    format!(
        "<figure class=\"pair\">\n{outside}\n{overhead}\n\
         <figcaption><span>the camera that sees this, from beside</span><span>and from above</span></figcaption>\n</figure>\n"
    )
}

fn page(sections: &str) -> String {
    let body = format!(
        "<h1>Belvedere {}</h1>\n\
         <p>Left, an ordinary picture. Right, the same camera with its view bent so that what matters is no longer hidden; \
         dashes mark where the route runs behind something. Bent pictures are not to scale and not for navigation.</p>\n\
         {sections}<p class=\"small\">Change a scene and draw it again by the command under its picture. Your own data: \
         <code>belvedere reveal dem.tif route.gpx -o route.png</code></p>\n",
        belvedere::VERSION
    );
    html::page("Belvedere: straight and bent", "", &body)
}
