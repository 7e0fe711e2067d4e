//! Lifts of the eye and strengths of the bends of a film along a route, planned over all frames before the first is drawn, so that every
//! frame shows the ground from above and none jumps.

use crate::camera_path::CameraPath;
use crate::film::{Adjustment, DrawnGround};
use crate::{BelvedereError, Session};
use belvedere_scene::{Frame, Progress, RenderJob, RenderOptions};

/// Width of the pictures that are judged, pixels.
const WIDTH: u32 = 96;
/// Shares of the bends that are tried, from the strongest.
const SHARES: [f64; 5] = [1.0, 0.75, 0.5, 0.25, 0.0];
/// Lifts of one frame at most, each by this share of the eye's height over the walker, or more where the clearance says so.
const LIFTS: usize = 12;
const LIFT: f64 = 0.25;
/// Rounds in which frames are smoothed and judged again.
const ROUNDS: usize = 5;
/// Frames over which changes are smoothed at least, half to either side.
const SMOOTH: usize = 12;

/// What a frame lacks.
enum Lack {
    Nothing,
    /// Height, scene units.
    Clearance(f64),
    /// Ground is seen from below, or a bend is not possible there.
    Side,
}

/// Plans the adjustments of a film along a route; other films keep their cameras.
pub(super) fn plan(
    session: &Session,
    path: &mut CameraPath,
    straight: bool,
    progress: &Progress,
) -> Result<(), BelvedereError> {
    if path.following.is_none() || session.scene().terrain().is_none() {
        return Ok(());
    }
    let mut judge = Judge { session, straight, frame: Frame::default(), progress: progress.unheard() };
    let mut least = vec![Adjustment::NONE; path.len()];
    for (frame, least) in least.iter_mut().enumerate() {
        progress.tick("keeping the eye above the ground", frame as f64 / path.len() as f64)?;
        *least = judge.settle(path, frame, Adjustment::NONE)?;
    }
    let reach = reach(path);
    for _ in 0..ROUNDS {
        if least.iter().all(|a| *a == Adjustment::NONE) {
            break;
        }
        let smoothed = smoothed(&least, reach);
        set(path, &smoothed);
        let mut again = false;
        for frame in 0..path.len() {
            progress.tick("keeping the eye above the ground", frame as f64 / path.len() as f64)?;
            let settled = judge.settle(path, frame, smoothed[frame])?;
            if settled != smoothed[frame] {
                (least[frame], again) = (settled, true);
            }
        }
        if !again {
            return Ok(());
        }
        set(path, &smoothed_over(&smoothed, &least));
    }
    Ok(())
}

fn set(path: &mut CameraPath, adjustments: &[Adjustment]) {
    if let Some(following) = &mut path.following {
        following.adjustments.copy_from_slice(adjustments);
    }
}

/// The larger lift and the smaller share of each frame.
fn smoothed_over(a: &[Adjustment], b: &[Adjustment]) -> Vec<Adjustment> {
    a.iter()
        .zip(b)
        .map(|(a, b)| Adjustment { lift: a.lift.max(b.lift), share: a.share.min(b.share), aim: 0.0 })
        .collect()
}

/// Frames to either side over which changes spread: as long as the walker takes from the eye's place to his own.
fn reach(path: &CameraPath) -> usize {
    let behind = path.animation.behind_m.unwrap_or(0.0);
    let per_frame = path.animation.speed_mps.unwrap_or(0.0) / path.fps;
    let frames = if per_frame > 0.0 { (behind / per_frame).ceil() as usize } else { 0 };
    frames.clamp(SMOOTH, SMOOTH.max(path.len() / 4))
}

/// Lifts no lower and shares no larger than the least ones, changing over `reach` frames.
fn smoothed(least: &[Adjustment], reach: usize) -> Vec<Adjustment> {
    let lifts: Vec<f64> = least.iter().map(|a| a.lift).collect();
    let weaker: Vec<f64> = least.iter().map(|a| 1.0 - a.share).collect();
    let (lifts, weaker) = (spread(&lifts, reach), spread(&weaker, reach));
    lifts
        .into_iter()
        .zip(weaker)
        .map(|(lift, w)| Adjustment { lift, share: (1.0 - w).clamp(0.0, 1.0), aim: 0.0 })
        .collect()
}

/// A sliding maximum over `reach` values to either side, then two running means of no more together: nowhere below `values`.
fn spread(values: &[f64], reach: usize) -> Vec<f64> {
    let half = reach.div_ceil(2);
    let at = |v: &[f64], i: isize| v[i.clamp(0, v.len() as isize - 1) as usize];
    let window = |i: usize, reach: usize| i as isize - reach as isize..=i as isize + reach as isize;
    let most = |v: &[f64]| -> Vec<f64> {
        (0..v.len()).map(|i| window(i, 2 * half).map(|k| at(v, k)).fold(0.0, f64::max)).collect()
    };
    let mean = |v: &[f64]| -> Vec<f64> {
        (0..v.len()).map(|i| window(i, half).map(|k| at(v, k)).sum::<f64>() / (2 * half + 1) as f64).collect()
    };
    // Sums round: a mean of equal values may fall below them.
    mean(&mean(&most(values))).into_iter().zip(values).map(|(m, v)| m.max(*v)).collect()
}

struct Judge<'a> {
    session: &'a Session,
    straight: bool,
    frame: Frame,
    progress: Progress,
}

impl Judge<'_> {
    /// The least change from `start` with which a frame shows the ground from above.
    fn settle(&mut self, path: &mut CameraPath, frame: usize, start: Adjustment) -> Result<Adjustment, BelvedereError> {
        let Some(following) = &path.following else { return Ok(start) };
        let camera = following.camera(frame);
        let step = LIFT * (camera.eye.z - camera.walker.z).abs().max(1.0);
        let mut now = start;
        for _ in 0..SHARES.len() + LIFTS {
            if let Some(following) = &mut path.following {
                following.adjustments[frame] = now;
            }
            match self.lack(path, frame, now.share)? {
                Lack::Nothing => break,
                // A bend that lifts the ground far above the eye is too strong there.
                Lack::Clearance(short) if now.lift - start.lift + short <= step || now.share <= 0.0 => {
                    now.lift += 1.05 * short + 1e-3 * step;
                }
                Lack::Clearance(_) | Lack::Side => match SHARES.into_iter().find(|s| *s < now.share - 1e-9) {
                    Some(share) => now.share = share,
                    None => now.lift += step,
                },
            }
        }
        Ok(now)
    }

    fn lack(&mut self, path: &CameraPath, frame: usize, share: f64) -> Result<Lack, BelvedereError> {
        let [w, h] = self.session.view().pinhole().image;
        let width = w.min(WIDTH);
        let image = [width, (width * h).div_ceil(w).clamp(8, 4 * WIDTH)];
        let session = match path.sketch(self.session, frame, image) {
            Ok(session) => session,
            Err(e) if e.is_cancelled() || share <= 0.0 => return Err(e),
            Err(_) => return Ok(Lack::Side),
        };
        let view = if self.straight { session.view().straightened() } else { session.view().clone() };
        let Some(ground) = DrawnGround::of(session.scene(), &view) else { return Ok(Lack::Nothing) };
        if let Some(clearance) = ground.clearance().filter(|c| *c < ground.needed()) {
            return Ok(Lack::Clearance(ground.needed() - clearance));
        }
        let options = RenderOptions { samples: 1, marks: false, ..RenderOptions::default() };
        let (scene, light, progress) = (session.scene(), session.light(), &self.progress);
        let job = RenderJob { scene, view: &view, light, options: &options, progress };
        self.session.renderer(&crate::RendererName::AUTO)?.render_into(&job, &mut self.frame)?;
        Ok(if ground.seen_from_below(&self.frame)[1] > 0 { Lack::Side } else { Lack::Nothing })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_spread_without_falling_below_what_a_frame_needs() {
        let mut needs = vec![0.0; 60];
        (needs[30], needs[31], needs[55]) = (40.0, 10.0, 5.0);
        let out = spread(&needs, 12);
        assert!(out.iter().zip(&needs).all(|(o, n)| o >= n), "{out:?}");
        assert_eq!(out[0], 0.0, "what is far away stays");
        let steepest = out.windows(2).map(|p| (p[1] - p[0]).abs()).fold(0.0, f64::max);
        assert!(steepest < 5.0, "{steepest}");
        assert_eq!(spread(&[0.0; 7], 12), [0.0; 7]);
    }
}
