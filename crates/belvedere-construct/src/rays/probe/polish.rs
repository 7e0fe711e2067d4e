//! Improves a chain of turns by changing one coordinate at a time.

use super::chain::Chain;
use super::judge::Judge;
use super::voxels::Voxels;
use super::{SEARCH_STRIDE, price_of};
use belvedere_core::View;
use belvedere_core::map::curved_rays::Sharpness;
use belvedere_scene::{Cancelled, Progress};
use rayon::prelude::*;

/// Steps by which points are moved, cells, one for each round.
const MOVES: [f64; 4] = [3.0, 3.0, 1.5, 0.75];
/// Distances of the viewpoints and lengths of the transitions are multiplied by these.
const FACTORS: [f64; 2] = [1.35, 1.0 / 1.35];
/// Range of the length of transitions, shares of the usual.
const LENGTHS: [f64; 2] = [0.05, 1.6];
/// Sharpness that is tried.
const SHARPNESS: [Sharpness; 3] = [Sharpness::Bend, Sharpness::Value(0.8), Sharpness::Value(1.5)];

/// The chain after some rounds of changing one coordinate of a point, one distance, one length or the sharpness where that improves
/// the picture; with its score, and the number of cameras that were tried.
pub(super) fn polished(
    chain: Chain,
    score: f64,
    base: &View,
    voxels: &Voxels,
    judge: &Judge<'_>,
    progress: &Progress,
) -> Result<(f64, Chain, usize), Cancelled> {
    let eye = base.pinhole().eye;
    let (mut best, mut tried) = ((score, chain), 0);
    for step in MOVES {
        let before = best.0;
        for coordinate in 0..3 * best.1.points.len() + 3 {
            progress.tick("improving the best ways", 0.8)?;
            let next = changes(&best.1, coordinate, step * voxels.cell(), base);
            let free: Vec<Chain> = next.into_iter().filter(|c| c.is_free(eye, voxels) && c.turns(eye) > 0).collect();
            tried += free.len();
            let judged = free.into_par_iter().filter_map(|chain| {
                let view = chain.view(base, f64::INFINITY)?;
                Some((judge.verdict(&view, SEARCH_STRIDE).score - price_of(&chain, eye), chain))
            });
            for next in judged.collect::<Vec<_>>() {
                if next.0 > best.0 {
                    best = next;
                }
            }
        }
        if best.0 <= before && step < MOVES[0] {
            break;
        }
    }
    Ok((best.0, best.1, tried))
}

/// The chain with one coordinate changed to either side.
fn changes(chain: &Chain, coordinate: usize, step: f64, base: &View) -> Vec<Chain> {
    let with = |change: &dyn Fn(&mut Chain)| {
        let mut next = chain.clone();
        change(&mut next);
        next
    };
    let places = 3 * chain.points.len();
    let pinhole = base.pinhole();
    match coordinate {
        i if i < places => {
            let axis = [pinhole.right, pinhole.down, pinhole.forward][i % 3];
            [step, -step].map(|by| with(&|c| c.points[i / 3] += by * axis)).into()
        }
        i if i == places => FACTORS.map(|f| with(&|c| c.shape.behind *= f)).into(),
        i if i == places + 1 => {
            FACTORS.map(|f| with(&|c| c.shape.length = (f * c.shape.length).clamp(LENGTHS[0], LENGTHS[1]))).into()
        }
        _ => SHARPNESS.map(|m| with(&|c| c.shape.m = m)).into(),
    }
}
