//! A scene that was opened, and the views of what must be seen in it.

use super::Technique;
use super::appearance::check_background;
use super::request::Request;
use super::subject::{self, Meant, Targets};
use crate::picture::TargetPlace;
use crate::places::{Place, PlaceHeight};
use crate::scene_file::EarthDoc;
use crate::verbs::found_view::{IMAGE, MODELS_FOV_Y_DEG};
use crate::{Advice, BelvedereError, OpenOptions, Session};
use belvedere_construct::rays::{Sidestep, TargetSight};
use belvedere_construct::views::{self, Content, Refit};
use belvedere_construct::{ConstructError, RevealMemory, RevealOptions, Revealed};
use belvedere_core::{DVec3, Pinhole, Projection, View, Warning};
use belvedere_resolve::ground::unbent;
use belvedere_resolve::targets;
use belvedere_scene::Unit;

/// See the module.
pub(super) struct Opened {
    pub(super) session: Session,
    pub(super) meant: Meant,
    /// The target by its name; of a place its scene coordinates.
    pub(super) see: String,
    pub(super) targets: Targets,
    pub(super) up: DVec3,
    pub(super) lens: ([u32; 2], f64),
    /// Whether the field of view is that of the request.
    states_fov: bool,
}

impl Opened {
    pub(super) fn of(request: &Request<'_>) -> Result<Self, BelvedereError> {
        let fov_y = request.fov_y(MODELS_FOV_Y_DEG)?;
        let (mut session, mut meant) = subject::open(request)?;
        request.appearance.check(session.scene().crs)?;
        check_background(&session, &request.appearance)?;
        let (see, said) = written_point(&session, request.see())?;
        session.loaded.warnings.extend(said);
        if let Some(p) = targets::point(&see) {
            TargetPlace::check(session.scene(), p)?;
            meant = Meant::Named(see.clone());
        }
        let targets = meant.targets(session.scene())?;
        if request.asked.technique == Some(Technique::Spline) && !meant.is_features() {
            let text = "a spline bends the ground under routes, streets and areas; for this target give {} curved_rays";
            return Err(BelvedereError::Argument(Advice::new(text, &["technique"])));
        }
        let lens = (request.image.unwrap_or(IMAGE), fov_y);
        let up = request.asked.up.map_or(DVec3::Z, DVec3::from_array);
        let states_fov = request.fov_y_deg.is_some();
        Ok(Self { session, meant, see, targets, up, lens, states_fov })
    }

    /// With the view that the request or the scene file gives.
    pub(super) fn looked_at(request: &Request<'_>) -> Result<(Self, Option<View>), BelvedereError> {
        let mut opened = Self::of(request)?;
        let view = opened.given(request)?;
        Ok((opened, view))
    }

    /// Whether views are chosen as those of a city.
    pub(super) fn is_city(&self) -> bool {
        let scene = self.session.scene();
        let from_files = self.session.path().is_none();
        let city = || self.session.resolved().is_some_and(|d| d.layer.iter().any(|l| l.kind() == "city"));
        from_files && scene.unit == Unit::Metre && city()
    }

    /// Lines of sight to the target that is searched for. Its tree over the scene takes seconds for millions of triangles: build it once.
    pub(super) fn sight(&self) -> TargetSight<'_> {
        TargetSight::new(self.session.scene(), &self.targets.search)
    }

    /// The views that are worth a search for bends; at most `most`, or as many as are usual.
    pub(super) fn views(&self, sight: &TargetSight<'_>, most: Option<usize>) -> Result<Vec<View>, BelvedereError> {
        let target = &self.targets.search;
        let scene = (self.session.scene(), sight);
        match self.is_city() {
            true => views::around_in_city(scene, target, self.lens, most).map_err(|error| match error {
                ConstructError::NoRoom => {
                    let text = "no eye around the target is free of buildings; give {} and {}";
                    BelvedereError::Argument(Advice::new(text, &["eye", "look"]))
                }
                other => other.into(),
            }),
            false => Ok(views::around_model(scene, target, self.up, self.lens, most)?),
        }
    }

    /// The camera in the frame that holds what is drawn, as the bend moves it.
    pub(super) fn refitted(&self, sight: &TargetSight<'_>, view: &View, sidestep: Option<&Sidestep>) -> Option<Refit> {
        let (scene, target) = (self.session.scene(), &self.targets.search);
        let is_city = self.is_city();
        let points = if is_city { views::city_region(target) } else { views::outline(scene, views::MANY, &[]) };
        let content = Content { points: &points, up: self.up, may_zoom: !self.states_fov };
        views::refit(sight, view, sidestep, &content)
    }

    /// The spline that shows more of the features in a view, if there is one.
    pub(super) fn spline(&self, view: &View, options: &OpenOptions) -> Result<Option<Revealed>, BelvedereError> {
        let search = RevealOptions { image: self.lens.0, fov_y: self.lens.1, ..RevealOptions::default() };
        let (scene, progress) = (self.session.scene(), &options.progress);
        match belvedere_construct::reveal(scene, Some(view), &search, &mut RevealMemory::default(), progress) {
            Ok(found) => Ok(found.bend.is_some().then_some(found)),
            Err(e @ ConstructError::Cancelled(_)) => Err(e.into()),
            // Views for which no spline can be made keep their curved rays.
            Err(_) => Ok(None),
        }
    }

    /// The view that is given by the request or the scene file; warnings about its places go to the session.
    fn given(&mut self, request: &Request<'_>) -> Result<Option<View>, BelvedereError> {
        let session = &self.session;
        let is_scene_file = session.path().is_some();
        if let Some([eye, target]) = &request.places {
            let usual = if is_scene_file { session.view().pinhole().image } else { IMAGE };
            let ((eye, of_eye), (look, of_look)) =
                (session.find_place(eye, "eye")?, session.find_place(target, "target")?);
            let (lens, near) = (Projection::Perspective { fov_y: self.lens.1 }, 1e-3 * (look - eye).length());
            let pinhole = Pinhole::look_at(eye, look, self.up, lens, request.image.unwrap_or(usual), near, None)?;
            let mut said: Vec<Warning> = of_eye.into_iter().chain(of_look).collect();
            let earth = session.resolved().map_or(EarthDoc::Flat, |document| document.earth);
            let view = unbent(pinhole, earth, session.scene(), &mut said)?;
            self.session.loaded.warnings.extend(said);
            return Ok(Some(view));
        }
        if is_scene_file && request.asked.up.is_some() {
            let text = "a scene file states what is up in camera.up; leave {} out";
            return Err(BelvedereError::Argument(Advice::new(text, &["up"])));
        }
        Ok(is_scene_file.then(|| session.view().straightened()))
    }
}

/// A target as `x,y,z` in scene coordinates where a place with a height is written in another way, else as it is; and a warning about
/// the place.
fn written_point(session: &Session, see: &str) -> Result<(String, Option<Warning>), BelvedereError> {
    match see.parse::<Place>() {
        Ok(place) if place.has_height() => {
            let (p, said) = session.find_place(&place, "see")?;
            let is_scene = p.truncate().to_array() == place.numbers() && matches!(place.height, PlaceHeight::Metres(_));
            let text = if is_scene { see.to_owned() } else { format!("{:.3},{:.3},{:.3}", p.x, p.y, p.z) };
            Ok((text, said))
        }
        _ => Ok((see.to_owned(), None)),
    }
}
