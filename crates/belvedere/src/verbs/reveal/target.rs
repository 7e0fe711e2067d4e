//! `reveal --see`: draws a picture in which one target in models or in a city is visible, by rays that bend around its occluders, or by a
//! spline where it lies on the ground.

use super::Technique;
use super::answer::{FinalShares, Found, RevealAnswer};
use super::appearance::Appearance;
use super::judge::PictureJudge;
use super::opened::Opened;
use super::request::Request;
use crate::fallback::has_volumes;
use crate::picture::{PictureOptions, TargetPlace};
use crate::scene_file::{CameraDoc, ConstructorDoc, ConstructorKind, Document, StageDoc};
use crate::verbs::found_view::spline_stage;
use crate::{Advice, BelvedereError, Session};
use belvedere_construct::Revealed;
use belvedere_construct::measure::Shares;
use belvedere_construct::rays::{BendReport, Sidestep, Target, TargetSight};
use belvedere_construct::reveal::{Choice, thresholds};
use belvedere_construct::views::RefitRecord;
use belvedere_core::{Pinhole, View};
use belvedere_resolve::rays::sidestep_stage;
use belvedere_resolve::targets;

/// Draws the target of a request.
pub(super) fn reveal(request: &Request<'_>) -> Result<RevealAnswer, BelvedereError> {
    let (opened, given) = Opened::looked_at(request)?;
    let search = Search::new(&opened, request);
    let is_free = given.is_none();
    let views = given.map_or_else(|| opened.views(&search.sight, None), |view| Ok(vec![view]))?;
    let mut chosen = search.best(views)?;
    if request.asked.technique == Some(Technique::Spline) {
        chosen.bend = None;
    }
    if is_free {
        search.refit(&mut chosen)?;
    }
    search.judge(&mut chosen)?;
    search.try_spline(&mut chosen)?;
    let session = search.session(&chosen)?;
    search.draw(session, chosen)
}

/// A bend that was found.
enum Bend {
    /// A turn behind the planes of a camera, which may look elsewhere than that of the picture.
    Rays(Sidestep, Box<Pinhole>),
    Spline(Box<Revealed>),
}

impl Bend {
    fn sidestep(&self) -> Option<&Sidestep> {
        match self {
            Self::Rays(sidestep, _) => Some(sidestep),
            Self::Spline(_) => None,
        }
    }

    fn technique(&self) -> Technique {
        match self {
            Self::Rays(..) => Technique::CurvedRays,
            Self::Spline(_) => Technique::Spline,
        }
    }
}

/// The view and bend that are best so far.
struct Chosen {
    view: View,
    bend: Option<Bend>,
    report: BendReport,
    refit: Option<RefitRecord>,
}

impl Chosen {
    /// The view with its bend.
    fn bent(&self) -> Result<View, BelvedereError> {
        Ok(match &self.bend {
            Some(Bend::Rays(sidestep, root)) => sidestep.seen_by(root, &self.view)?,
            Some(Bend::Spline(found)) => found.view.clone(),
            None => self.view.clone(),
        })
    }
}

/// The search for a view and a bend.
struct Search<'a> {
    opened: &'a Opened,
    request: &'a Request<'a>,
    /// Lines of sight to the few points by which bends are chosen.
    sight: TargetSight<'a>,
    /// To the many by which shares are judged, where these are others.
    judging: Option<TargetSight<'a>>,
    judge: PictureJudge<'a>,
}

impl<'a> Search<'a> {
    fn new(opened: &'a Opened, request: &'a Request<'a>) -> Self {
        let (scene, targets) = (opened.session.scene(), &opened.targets);
        let judging = (targets.judge != targets.search).then(|| TargetSight::new(scene, &targets.judge));
        let judge = PictureJudge::new(&opened.session, targets, (&request.picture, &request.open.progress));
        Self { opened, request, sight: opened.sight(), judging, judge }
    }

    fn judging(&self) -> &TargetSight<'a> {
        self.judging.as_ref().unwrap_or(&self.sight)
    }

    /// The view, and its bend, that show most of the target for the least motion.
    fn best(&self, views: Vec<View>) -> Result<Chosen, BelvedereError> {
        let is_city = self.opened.is_city();
        let choice = Choice {
            score: &|chosen: &Chosen| chosen.report.visible - thresholds::MOTION_PRICE * chosen.report.motion,
            least_gain: thresholds::VIEW_GAIN,
            // Where much is seen, later views, which show less without a bend, seldom show more with one.
            enough: &|chosen: &Chosen, tried| {
                let all = tried < thresholds::VIEWS_AT_LEAST || is_city;
                chosen.report.visible >= if all { thresholds::ENOUGH } else { thresholds::MUCH }
            },
        };
        let (mut tried, mut light_best) = (0, 0.0f64);
        let best = choice.best(None, views, |view| {
            let (sidestep, report) = self.judge.bend(&self.sight, &view, &self.request.open.progress)?;
            (tried, light_best) = (tried + report.tried, light_best.max(report.light_best));
            let root = Box::new(view.pinhole().clone());
            let bend = sidestep.map(|sidestep| Bend::Rays(sidestep, root));
            Ok::<_, BelvedereError>(Chosen { view, bend, report, refit: None })
        })?;
        let best = best.ok_or_else(|| BelvedereError::Target("there is no view to look from".into()))?;
        Ok(Chosen { report: BendReport { tried, light_best, ..best.report }, ..best })
    }

    /// Turns and zooms the camera so that what the bend moved lies inside.
    fn refit(&self, chosen: &mut Chosen) -> Result<(), BelvedereError> {
        let unframed = chosen.view.clone();
        if !self.frame(chosen, &unframed) || chosen.bend.is_none() {
            return Ok(());
        }
        // The refitted view may show as much without a bend, and is then framed without one.
        if !self.judge.gains(self.judging(), &chosen.view, &chosen.bent()?)? {
            chosen.bend = None;
            self.frame(chosen, &unframed);
        }
        Ok(())
    }

    /// Frames `view` with the bend that was chosen; `false` where another frame shows less of the target.
    fn frame(&self, chosen: &mut Chosen, view: &View) -> bool {
        let sidestep = chosen.bend.as_ref().and_then(Bend::sidestep);
        let Some(found) = self.opened.refitted(&self.sight, view, sidestep) else { return false };
        (chosen.view, chosen.refit) = (found.straight, Some(found.record));
        true
    }

    /// Finds the shares of the chosen view.
    fn judge(&self, chosen: &mut Chosen) -> Result<(), BelvedereError> {
        let (sight, bent) = (self.judging(), chosen.bent()?);
        // The finished pictures tell the shares of targets with a surface, unless a fallback has to be decided on before.
        chosen.report = match self.judge.is_by_pictures() && self.request.asked.fallback.is_empty() {
            true => {
                let (in_frame, in_frame_straight) = (sight.in_frame(&bent), sight.in_frame(&chosen.view));
                BendReport { in_frame, in_frame_straight, ..chosen.report }
            }
            false => self.judged(&chosen.view, &bent, chosen.report)?,
        };
        Ok(())
    }

    /// A report with the shares of a straight and of a bent view.
    fn judged(&self, straight: &View, bent: &View, report: BendReport) -> Result<BendReport, BelvedereError> {
        let sight = self.judging();
        let visible_straight = self.judge.share(sight, straight)?;
        let is_bent = bent.is_bent() || straight.is_bent();
        let visible = if is_bent { self.judge.share(sight, bent)? } else { visible_straight };
        let (in_frame, in_frame_straight) = (sight.in_frame(bent), sight.in_frame(straight));
        Ok(BendReport { visible, in_frame, visible_straight, in_frame_straight, ..report })
    }

    /// Takes a spline in place of curved rays, where features on the ground are seen better by it.
    fn try_spline(&self, chosen: &mut Chosen) -> Result<(), BelvedereError> {
        let asked = self.request.asked.technique;
        let only_spline = asked == Some(Technique::Spline);
        let is_wanted = only_spline || chosen.report.visible < thresholds::ENOUGH;
        if !self.opened.meant.is_features() || asked == Some(Technique::CurvedRays) || !is_wanted {
            return Ok(());
        }
        let Some(found) = self.opened.spline(&chosen.view, &self.request.open)? else { return Ok(()) };
        let report = self.judged(&chosen.view, &found.view, chosen.report)?;
        let gain = if only_spline { 0.0 } else { thresholds::SPLINE_GAIN };
        if report.visible > chosen.report.visible + gain {
            (chosen.report, chosen.bend, chosen.refit) = (report, Some(Bend::Spline(Box::new(found))), None);
        }
        Ok(())
    }

    /// The session with the chosen view and bend, in the appearance that is asked for.
    fn session(&self, chosen: &Chosen) -> Result<Session, BelvedereError> {
        let (request, session) = (self.request, &self.opened.session);
        let target = &self.opened.targets.search;
        let mut document = document(session, &chosen.view, chosen.bend.as_ref(), target)?;
        let fallback = &request.asked.fallback;
        if chosen.report.visible < thresholds::ENOUGH && !fallback.is_empty() {
            let Some(name) = self.opened.meant.name() else {
                let text = "{} is for buildings and models, not for features on the ground";
                return Err(BelvedereError::Argument(Advice::new(text, &["fallback"])));
            };
            let (target, fallback) = (Some(name.to_owned()), fallback.clone());
            document.constructor =
                Some(ConstructorDoc { target, fallback, ..ConstructorDoc::of(ConstructorKind::Manual) });
        }
        // Scene files say themselves whether they have shadows.
        if session.path().is_none() {
            request.appearance.shade_molecules(&mut document);
        }
        request.appearance.describe(&mut document);
        match request.appearance.is_usual() {
            true => session.with_document(document, None),
            false => Appearance::of_document(session, document),
        }
    }

    /// Draws both pictures and marks the target in them.
    fn draw(&self, session: Session, chosen: Chosen) -> Result<RevealAnswer, BelvedereError> {
        let Opened { see, targets, .. } = self.opened;
        let Chosen { bend, mut report, refit, .. } = chosen;
        let place = targets::point(see).map(|p| TargetPlace::of(self.opened.session.scene(), p));
        let progress = self.request.open.progress.clone();
        let pair = PictureOptions { compare: true, straight: false, progress, ..self.request.picture.clone() };
        let mut picture = session.render(&pair)?;
        let mut mark = "lines and points in colour, dashed where they are hidden";
        if let Some(place) = &place {
            picture.mark_target(place, &report, pair.density);
            mark = place.mark;
        } else if let Some(shares) = picture.mark_shape(&session, (&targets.shape, &targets.judge), &pair)? {
            mark = "an outline around it, of dashes where it is hidden";
            // Volumes let light through, which ids do not tell, and fallbacks have a report of their own.
            if !has_volumes(session.scene()) && picture.sidecar.fallback.is_none() {
                let [straight, bent] = shares;
                report.visible_straight = straight * report.in_frame_straight;
                report.visible = bent * report.in_frame;
            }
        }
        let technique = bend.as_ref().map(Bend::technique);
        let shares = [(report.visible_straight, report.in_frame_straight), (report.visible, report.in_frame)];
        let shares = FinalShares::of(technique, shares.map(|(visible, in_frame)| Shares { visible, in_frame }));
        let found = Found::Target { report, see: see.clone(), place, mark, refit };
        Ok(RevealAnswer { session, picture, shares, found })
    }
}

/// The document of the session with the found view.
fn document(session: &Session, view: &View, bend: Option<&Bend>, target: &Target) -> Result<Document, BelvedereError> {
    let Some(resolved) = session.resolved() else {
        return Err(BelvedereError::Target("the scene has no document".into()));
    };
    let pinhole = view.pinhole();
    let ahead = (target.center() - pinhole.eye).dot(pinhole.forward).max(pinhole.near);
    let level = pinhole.right.z.abs() < 1e-9 && pinhole.down.z < -1e-3;
    let up = if level { [0.0, 0.0, 1.0] } else { (-pinhole.down).to_array() };
    let mut document = resolved.clone();
    document.camera = CameraDoc { up, ..CameraDoc::of(pinhole, pinhole.eye + ahead * pinhole.forward) };
    document.constructor = None;
    document.stage.retain(|stage| !matches!(stage, StageDoc::CurvedRays(_)));
    match bend {
        Some(Bend::Rays(s, root)) => document.stage.push(StageDoc::CurvedRays(sidestep_stage(s, root))),
        Some(Bend::Spline(found)) => document.stage.extend(spline_stage(found)),
        None => {}
    }
    Ok(document)
}
