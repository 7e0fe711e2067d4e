//! Skyline, ridges and routes of the straight picture, drawn faintly over the bent one.

use belvedere_composite::canvas::Canvas;
use belvedere_scene::{Color, Frame, Scene};

/// Relative second difference of `1 / depth` beyond which a pixel is a ridge: it is 0 on planes.
const RIDGE: f32 = 0.02;
const INK: Color = Color { r: 24, g: 26, b: 84, a: 120 };

/// Draws skyline, ridges and visible routes of `straight` over `bent`, pictures of one size.
pub fn draw(bent: &mut Frame, straight: &Frame, scene: &Scene) {
    let (width, height) = (straight.width, straight.height);
    if bent.width != width || bent.height != height {
        return;
    }
    let ridges = ridges(straight);
    let colors: Vec<Option<Color>> = std::iter::once(None)
        .chain(scene.layers.iter().map(|l| l.kind.lines().map(|line| line.color.with_alpha(90))))
        .collect();
    let mut canvas = Canvas::new(&mut bent.color, width);
    for y in 0..height as i64 {
        for x in 0..width as i64 {
            let i = y as usize * width + x as usize;
            if let Some(Some(color)) = colors.get(straight.id[i] as usize) {
                canvas.blend(x, y, *color, 1.0);
            }
            // A soft line: neighbours get a third of the ink.
            let at = |dx: i64, dy: i64| {
                let (x, y) = (x + dx, y + dy);
                let inside = x >= 0 && y >= 0 && x < width as i64 && y < height as i64;
                if inside { ridges[y as usize * width + x as usize] } else { 0.0 }
            };
            let beside = at(-1, 0).max(at(1, 0)).max(at(0, -1)).max(at(0, 1));
            canvas.blend(x, y, INK, at(0, 0).max(0.35 * beside));
        }
    }
}

/// Strength with which every pixel lies on the near side of a jump in depth, 0..=1.
fn ridges(frame: &Frame) -> Vec<f32> {
    let (width, height) = (frame.width, frame.height);
    let near = |x: usize, y: usize| 1.0 / frame.depth[y * width + x];
    let mut out = vec![0.0; width * height];
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let q = near(x, y);
            let bend = (2.0 * q - near(x - 1, y) - near(x + 1, y)).max(2.0 * q - near(x, y - 1) - near(x, y + 1));
            out[y * width + x] = ((bend / q.max(1e-30) - RIDGE) / RIDGE).clamp(0.0, 1.0);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::FrameStats;

    /// Ground that falls away evenly towards a skyline at row 20, with a wall in front of it.
    fn frame() -> Frame {
        let depth = |x: usize, y: usize| match (x, y) {
            (30..50, 30..) => 40.0,
            (_, 20..) => 2000.0 / (y as f32 - 18.0),
            _ => f32::INFINITY,
        };
        let depth = (0..80 * 60).map(|i| depth(i % 80, i / 80)).collect();
        let n = 80 * 60;
        Frame {
            width: 80,
            height: 60,
            color: vec![[255; 3]; n],
            depth,
            id: vec![0; n],
            world: None,
            stats: FrameStats::default(),
        }
    }

    #[test]
    fn skylines_and_edges_are_ridges_and_slopes_are_not() {
        let found = ridges(&frame());
        for x in [5, 20, 70] {
            assert_eq!(found[20 * 80 + x], 1.0, "skyline at {x}");
            assert!((24..58).all(|y| found[y * 80 + x] == 0.0), "the slope at {x} has no ridge");
        }
        assert!((32..48).all(|x| found[30 * 80 + x] > 0.9), "top of the wall");
        assert!(found[45 * 80 + 40] == 0.0, "face of the wall");
        let mut bent = frame();
        draw(&mut bent, &frame(), &Scene::default());
        assert!(bent.color[20 * 80 + 5][0] < 200 && bent.color[50 * 80 + 5] == [255; 3]);
    }
}
