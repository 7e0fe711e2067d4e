//! Views of ground: it fills the picture, with its far side level under a band of sky.

use belvedere_core::quantile::{Rank, quantile};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection};
use belvedere_scene::Heightfield;

/// Nodes along the longer side of the ground by which it is framed, at most about.
const ALONG: usize = 160;
/// Rows of the picture, from its top, that the highest and the nearest ground come to, as shares of its height.
const WHOLE_ROWS: [f64; 2] = [0.14, 1.07];
const PART_ROWS: [f64; 2] = [0.36, 0.9];
/// Most sky over the highest summits of ground that does not fill the height, share of the picture's height.
const MOST_SKY: f64 = 0.17;
/// How far the upper edge of a whole ground lies below its highest summits at most, and least sky over these, shares of the picture's height.
const UNDER_SUMMITS: f64 = 0.06;
const LEAST_SKY: f64 = 0.06;
/// Share of the ground that lies below the upper row: single spikes may stand over it.
const HIGHEST: f64 = 0.998;
/// Vertical fields of view, degrees: a long lens keeps the far side of a whole ground wide, a short one shows the horizon over a part.
const WHOLE_FOV: f64 = 20.0;
const PART_FOV: f64 = 45.0;
/// Falls of the line of sight that are tried, degrees, and the one that is taken where others are no better.
const WHOLE_FALLS: [f64; 12] = [16.0, 18.0, 20.0, 22.0, 24.0, 27.0, 30.0, 34.0, 38.0, 43.0, 50.0, 60.0];
const PART_FALLS: [f64; 3] = [14.0, 16.0, 18.0];
const USUAL_FALL: f64 = 24.0;
/// What a degree away from it costs, what ground outside the picture costs against what fills it.
const PER_DEGREE: f64 = 0.004;
const LOST: f64 = 0.8;
/// Share of the ground that may lie beside the picture; else it takes up less and less of the picture's height, in so many steps at most.
const MOST_OUTSIDE: f64 = 0.25;
const NARROWED: f64 = 0.85;
const MOST_NARROWED: i32 = 20;
const MUCH_NARROWED: f64 = 0.6;
/// Strips of the picture by which it is told how far ground fills it.
const STRIPS: usize = 24;

/// A view over ground.
#[derive(Debug, Clone)]
pub struct LandView {
    /// The camera.
    pub pinhole: Pinhole,
    /// A point in the middle of the picture, as far ahead as the middle of the ground that it shows.
    pub target: DVec3,
}

/// The view to the north that a ground, or the part of it in a box, fills best.
///
/// * `part`: corners of a box on the map whose ground fills the picture, in scene units; `None` = all of it;
/// * `image`: size in pixels.
///
/// `None` for ground without nodes there.
pub fn over_land(ground: &Heightfield, part: Option<[DVec2; 2]>, image: [u32; 2]) -> Option<LandView> {
    let points = nodes(ground, part);
    let (fov, falls, rows): (_, &[f64], _) = match part {
        None => (WHOLE_FOV, &WHOLE_FALLS, (WHOLE_ROWS, UNDER_SUMMITS)),
        Some(_) => (PART_FOV, &PART_FALLS, (PART_ROWS, 1.0)),
    };
    let pinhole = northwards(&points, (fov, falls), image, rows)?;
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let target = pinhole.eye + (middle - pinhole.eye).dot(pinhole.forward) * pinhole.forward;
    Some(LandView { pinhole, target })
}

/// The best view towards the north. Ground that is much wider than the picture takes up a part of its height.
fn northwards(
    points: &[DVec3],
    (fov, falls): (f64, &[f64]),
    image: [u32; 2],
    (rows, over): ([f64; 2], f64),
) -> Option<Pinhole> {
    let mut last: Option<Pinhole> = None;
    for k in 0..MOST_NARROWED {
        let between = narrowed(rows, NARROWED.powi(k));
        let views = falls.iter().filter_map(|fall| {
            let first = framed(points, points, *fall, fov, image, between)?;
            // Corners beside the picture do not say where its lower edge lies.
            let inside: Vec<DVec3> = points.iter().copied().filter(|p| is_beside(&first, *p) == Some(false)).collect();
            let pinhole = framed(points, &inside, *fall, fov, image, between).unwrap_or(first);
            // Few high summits leave more sky than is wanted.
            let spare = skyline(points, &pinhole) - between[0] - over;
            let spare = spare.clamp(0.0, (between[0] - LEAST_SKY).max(0.0));
            let between = [between[0] - spare, between[1]];
            let pinhole = if spare > 0.0 { framed(points, &inside, *fall, fov, image, between)? } else { pinhole };
            let score = filled(points, &pinhole, rows) - PER_DEGREE * (fall - USUAL_FALL).abs();
            Some((score, pinhole))
        });
        last = views.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, pinhole)| pinhole).or(last);
        let is_whole = |pinhole: &Pinhole| outside(points, pinhole) <= MOST_OUTSIDE * points.len() as f64;
        if last.as_ref().is_some_and(is_whole) {
            break;
        }
    }
    last
}

/// Row of the upper edge of ground in the middle of the columns of a picture, share of its height.
fn skyline(points: &[DVec3], pinhole: &Pinhole) -> f64 {
    let [width, height] = pinhole.image.map(f64::from);
    let mut tops = [1.0; STRIPS];
    for p in points {
        let Ok((px, _)) = pinhole.project(*p) else { continue };
        let strip = px.x / width * STRIPS as f64;
        if (0.0..STRIPS as f64).contains(&strip) {
            let top = &mut tops[strip as usize];
            *top = (px.y / height).min(*top);
        }
    }
    quantile(&mut tops, 0.5, Rank::Nearest)
}

/// Rows of a picture nearer to each other than others: around their middle if they are much nearer, else under no more sky than is wanted.
fn narrowed([top, bottom]: [f64; 2], share: f64) -> [f64; 2] {
    let rows = share * (bottom - top);
    let middle = 0.5 * (top + bottom - rows);
    let top = if share < MUCH_NARROWED { middle } else { middle.min(top.max(MOST_SKY)) };
    [top, top + rows]
}

/// Number of points beside a picture.
fn outside(points: &[DVec3], pinhole: &Pinhole) -> f64 {
    points.iter().filter(|p| is_beside(pinhole, **p) == Some(true)).count() as f64
}

/// Nodes with data, thinned; those of the last row and column are among them.
fn nodes(ground: &Heightfield, part: Option<[DVec2; 2]>) -> Vec<DVec3> {
    let (cols, rows) = (ground.cols(), ground.rows());
    let [from, to] = part.unwrap_or([DVec2::NEG_INFINITY, DVec2::INFINITY]);
    let (nw, spacing) = (ground.north_west(), ground.spacing());
    let index = |x: f64, last: usize| (x.clamp(0.0, last as f64)) as usize;
    let [c0, c1] = [from.x, to.x].map(|x| index((x - nw.x) / spacing.x, cols - 1));
    let [r0, r1] = [to.y, from.y].map(|y| index((nw.y - y) / spacing.y, rows - 1));
    let step = ((c1 - c0).max(r1 - r0) / ALONG).max(1);
    let every = |a: usize, b: usize| (a..b).step_by(step).chain([b]);
    every(r0, r1).flat_map(|r| every(c0, c1).filter_map(move |c| ground.node(c, r))).collect()
}

/// Whether a point lies to the left or the right of a picture.
fn is_beside(pinhole: &Pinhole, p: DVec3) -> Option<bool> {
    let (px, _) = pinhole.project(p).ok()?;
    Some(px.x < 0.0 || px.x > f64::from(pinhole.image[0]))
}

/// The camera of a direction whose picture has some points between two rows, and all as far to its left as to its right.
///
/// The tangents of points over the middle of the picture, seen from an eye at offset `s` and depth `-d`, are `(y - s) / (z + d)`: that the
/// greatest be `T` and the least `-B` are two conditions linear in `s` and `d`.
fn framed(
    points: &[DVec3],
    between: &[DVec3],
    fall: f64,
    fov_deg: f64,
    image: [u32; 2],
    rows: [f64; 2],
) -> Option<Pinhole> {
    let fall = fall.to_radians();
    let ahead = DVec3::new(0.0, fall.cos(), -fall.sin());
    let lens = Projection::Perspective { fov_y: fov_deg.to_radians() };
    let origin = *points.first()?;
    let at = |eye: DVec3, near: f64| Pinhole::look_at(eye, eye + ahead, DVec3::Z, lens, image, near, None).ok();
    let p = at(DVec3::ZERO, 1.0)?;
    let half = (0.5 * fov_deg.to_radians()).tan();
    let [top, bottom] = [(1.0 - 2.0 * rows[0]) * half, (2.0 * rows[1] - 1.0) * half];
    let (mut tops, mut low) = (Vec::with_capacity(between.len()), f64::INFINITY);
    for q in between.iter().map(|q| *q - origin) {
        let (y, z) = (-q.dot(p.down), q.dot(p.forward));
        tops.push(y - top * z);
        low = low.min(y + bottom * z);
    }
    let high = quantile(&mut tops, HIGHEST, Rank::Nearest);
    let across = points.iter().map(|q| (*q - origin).dot(p.right));
    let [left, right] = across.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    let back = (high - low) / (top + bottom);
    let up = high - top * back;
    let eye = origin + 0.5 * (left + right) * p.right - up * p.down - back * p.forward;
    let nearest = points.iter().map(|q| (*q - eye).dot(p.forward)).fold(f64::INFINITY, f64::min);
    if nearest.is_nan() || nearest <= 0.0 {
        return None;
    }
    at(eye, (0.02 * nearest).clamp(1e-6, 1.0))
}

/// How far points fill the picture between two rows, 0..=1, less what lies beside it.
fn filled(points: &[DVec3], pinhole: &Pinhole, rows: [f64; 2]) -> f64 {
    let [width, height] = pinhole.image.map(f64::from);
    let mut reach = [None; STRIPS];
    for p in points {
        let Ok((px, _)) = pinhole.project(*p) else { continue };
        let strip = ((px.y / height - rows[0]) / (rows[1] - rows[0]) * STRIPS as f64).clamp(0.0, STRIPS as f64 - 1.0);
        let x = px.x.clamp(0.0, width);
        let [a, b] = reach[strip as usize].get_or_insert([x; 2]);
        (*a, *b) = (a.min(x), b.max(x));
    }
    let wide: f64 = reach.iter().flatten().map(|[a, b]| (b - a) / width).sum();
    wide / STRIPS as f64 - LOST * outside(points, pinhole) / points.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::NodeState;

    fn ground(cols: usize, rows: usize, height: impl Fn(f64, f64) -> f64) -> Heightfield {
        let of = |i: usize| height((i % cols) as f64, (i / cols) as f64) as f32;
        let heights = (0..cols * rows).map(of).collect();
        let states = vec![NodeState::Measured; cols * rows];
        Heightfield::new(DVec2::new(3e5, 5e6), DVec2::splat(50.0), cols, rows, heights, states).expect("ground")
    }

    fn hills(x: f64, y: f64) -> f64 {
        600.0 + 250.0 * (0.11 * x).sin() * (0.07 * y).cos() + 90.0 * (0.31 * x + 0.2 * y).sin()
    }

    #[test]
    fn ground_of_many_shapes_fills_the_picture_between_its_rows() {
        for (cols, rows) in [(300, 300), (300, 200), (200, 300), (400, 100), (100, 400), (40, 400), (30, 30)] {
            for image in [[1280, 720], [1000, 1000], [700, 1000]] {
                let (ground, shape) = (ground(cols, rows, hills), [cols, rows]);
                let view = over_land(&ground, None, image).expect("view");
                let aim = view.pinhole.project(view.target).expect("in front").0;
                assert!(aim.distance(view.pinhole.center_px()) < 1e-6, "the camera looks at its target: {aim}");
                let seen: Vec<DVec2> = nodes(&ground, None)
                    .into_iter()
                    .map(|p| view.pinhole.project(p).expect("in front").0 / DVec2::from(image.map(f64::from)))
                    .collect();
                let inside: Vec<&DVec2> = seen.iter().filter(|p| (0.0..=1.0).contains(&p.x)).collect();
                let [top, bottom] = inside.iter().fold([1.0, 0.0], |[a, b]: [f64; 2], p| [a.min(p.y), b.max(p.y)]);
                let fits =
                    (LEAST_SKY - 0.02..WHOLE_ROWS[0] + 0.04).contains(&top) && (bottom - WHOLE_ROWS[1]).abs() < 0.04;
                let is_wide = cols * image[1] as usize > rows * image[0] as usize;
                assert!(fits || is_wide, "{shape:?} {image:?}: rows {top} to {bottom}");
                let inside = inside.len() as f64 / seen.len() as f64;
                assert!(inside > 0.7, "{shape:?} {image:?}: {inside} inside");
                if cols.max(rows) < 2 * cols.min(rows) && image[0] > image[1] {
                    let score = filled(&nodes(&ground, None), &view.pinhole, WHOLE_ROWS);
                    assert!(score > 0.55, "{shape:?} {image:?}: {score} filled");
                }
            }
        }
    }

    #[test]
    fn a_part_of_the_ground_lies_in_the_middle_with_the_horizon_in_the_picture() {
        let ground = ground(300, 300, hills);
        let middle = DVec2::new(3e5 + 9000.0, 5e6 - 6000.0);
        let view = over_land(&ground, Some([middle - 1000.0, middle + 1000.0]), [1280, 720]).expect("view");
        let seen = view.pinhole.project(middle.extend(600.0)).expect("in front").0;
        assert!((seen.x - 640.0).abs() < 30.0 && (0.3..0.8).contains(&(seen.y / 720.0)), "{seen}");
        let level = view.pinhole.eye + view.pinhole.forward.with_z(0.0) * 1e7;
        let horizon = view.pinhole.project(level).expect("in front").0.y / 720.0;
        assert!((0.08..0.3).contains(&horizon), "horizon at {horizon} of the height");
    }
}
