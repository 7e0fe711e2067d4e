//! `reveal --see --drafts`: several views of the same target on one sheet.

use super::drafts::{Draft, DraftsAnswer, MOST_DRAFTS};
use super::reveal::FinalShares;
use super::reveal_target::{Opened, TargetRequest, reveal_target};
use super::view_request::Viewpoint;
use crate::guard::guarded;
use crate::{BelvedereError, OpenOptions};
use belvedere_construct::rays::{AroundOptions, bend_around_by};
use belvedere_core::{DVec3, Projection, View};

/// Angle between the directions of two drafts at least, radians.
const APART: f64 = 0.45;
/// Views from which drafts are taken.
const CANDIDATES: usize = 48;

/// Chooses up to `count` views from different directions, and reveals the target in each. A draft's `eye`, `look` and `fov_y_deg` given to
/// [`reveal_target`] make the same picture.
///
/// # Errors
/// [`BelvedereError::Target`] unless `count` is 1 to [`MOST_DRAFTS`] and no view is given, also by a scene file; those of
/// [`reveal_target`].
pub fn target_drafts(
    request: &TargetRequest,
    count: usize,
    options: &OpenOptions,
) -> Result<DraftsAnswer, BelvedereError> {
    guarded(|| drafted(request, count, options))
}

fn drafted(request: &TargetRequest, count: usize, options: &OpenOptions) -> Result<DraftsAnswer, BelvedereError> {
    if !(1..=MOST_DRAFTS).contains(&count) {
        return Err(BelvedereError::Target(format!("{count} drafts were asked for; give 1 to {MOST_DRAFTS}")));
    }
    let opened = Opened::of(request, options)?;
    if request.viewpoint.is_some() || request.places.is_some() || opened.session.path().is_some() {
        let reason =
            "drafts choose their views themselves; leave eye and look out, and give data instead of a scene file";
        return Err(BelvedereError::Target(reason.into()));
    }
    let mut views: Vec<View> = Vec::new();
    let sight = opened.sight();
    for view in opened.views(&sight, Some(CANDIDATES))? {
        let ahead = view.pinhole().forward;
        if views.len() < count && views.iter().all(|v| v.pinhole().forward.angle_between(ahead) > APART) {
            views.push(view);
        }
    }
    let mut out = DraftsAnswer { drafts: Vec::new(), warnings: Vec::new() };
    for (k, view) in views.iter().enumerate() {
        let found = bend_around_by(&sight, view, &AroundOptions::default(), &options.progress)?;
        let moved = opened.refitted(&sight, view, found.bent.as_ref().map(|(_, sidestep)| sidestep));
        let Some((viewpoint, fov_y_deg)) =
            rounded(moved.as_ref().map_or(view, |m| &m.straight), opened.targets.search.center())
        else {
            continue;
        };
        let request = TargetRequest { viewpoint: Some(viewpoint), fov_y_deg: Some(fov_y_deg), ..request.clone() };
        let found = reveal_target(&request, options)?;
        if k == 0 {
            out.warnings = found.warnings();
        }
        let Viewpoint { eye, target: [x, y], target_height } = viewpoint;
        let (report, frame) = (&found.report, &found.picture.frame);
        let shares = FinalShares {
            technique: found.technique,
            visible_straight: report.visible_straight,
            visible_bent: report.visible,
            in_frame_straight: report.in_frame_straight,
            in_frame_bent: report.in_frame,
        };
        let look = [x, y, target_height.unwrap_or_default()];
        out.drafts.push(Draft::new((eye, look, fov_y_deg), shares, frame));
    }
    Ok(out)
}

/// The view in numbers that are short enough to be typed, exact to a ten-thousandth of the distance of the target.
fn rounded(view: &View, center: DVec3) -> Option<(Viewpoint, f64)> {
    let pinhole = view.pinhole();
    let Projection::Perspective { fov_y } = pinhole.projection else { return None };
    let distance = (center - pinhole.eye).dot(pinhole.forward).max(pinhole.near);
    let digits = (4 - distance.log10().floor() as i32).clamp(0, 12) as usize;
    let short = |v: f64| format!("{v:.digits$}").parse().unwrap_or(v);
    let eye = pinhole.eye.to_array().map(short);
    let [x, y, z] = (DVec3::from_array(eye) + distance * pinhole.forward).to_array().map(short);
    let fov_y_deg = (100.0 * fov_y.to_degrees()).round() / 100.0;
    Some((Viewpoint { eye, target: [x, y], target_height: Some(z) }, fov_y_deg))
}
