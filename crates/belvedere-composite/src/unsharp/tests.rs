use super::*;

const W: usize = 120;
const H: usize = 80;

fn picture(depth: impl Fn(usize, usize) -> f32) -> Vec<f32> {
    (0..W * H).map(|i| depth(i % W, i / W)).collect()
}

fn behind(depth: &[f32], width: usize, ortho: bool) -> Vec<f32> {
    let around = Surroundings::of_picture(depth, width, ortho);
    (0..depth.len()).map(|i| around.behind([i % width, i / width], depth[i])).collect()
}

#[test]
fn small_pictures_are_read_whole_and_large_ones_in_part() {
    let grid = DepthGrid::new([33, 17]);
    assert!(grid.rows().eq(0..17) && grid.side == 2 && grid.cells.len() == 17 * 9);
    let grid = DepthGrid::new([16_384, 8192]);
    let rows: Vec<usize> = grid.rows().collect();
    assert_eq!((grid.side, &rows[..4], rows.len()), (8, &[3, 4, 11, 12][..], 2048));
    assert!(grid.cells.len() <= MOST_CELLS);
}

#[test]
fn what_lies_behind_is_shaded_and_the_sky_is_not() {
    let step = picture(|x, y| {
        if y < 10 {
            f32::INFINITY
        } else if x < 60 {
            10.0
        } else {
            80.0
        }
    });
    let off = behind(&step, W, false);
    assert!(off[40 * W + 60] < -0.2 && off[40 * W + 59] > 0.2, "{} {}", off[40 * W + 59], off[40 * W + 60]);
    assert!(off[40 * W + 100].abs() < 1e-4 && off[3 * W + 20] == 0.0);
    assert!(behind(&vec![f32::INFINITY; W * H], W, false).iter().all(|v| *v == 0.0));
    assert!(behind(&vec![5.0; W * H], W, true).iter().all(|v| v.abs() < 1e-5));
}

#[test]
fn averages_keep_what_is_even_and_have_their_width() {
    let weights = gaussian(2.0);
    let mut dot = vec![0.0; W * H];
    dot[40 * W + 60] = 1.0;
    let out = blurred(&blurred(&dot, W, &weights), H, &weights);
    assert!((out.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    let variance: f32 = (0..W * H).map(|i| out[i] * ((i % W) as f32 - 60.0).powi(2)).sum();
    assert!((variance - 4.0).abs() < 0.2, "{variance}");
}
