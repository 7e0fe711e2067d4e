//! Volumes of buildings as they are drawn and written, and what levels of abstraction keep of them.

use super::level::Level;
use super::report::{FailingCell, GeneraliseReport, LevelReport, VOLUME_OFF};
use super::solid::volume_m3;
use belvedere_scene::city::City;

/// Writes into a report the volumes that the blocks and landmarks of `levels` have, beside those of the buildings of `city`.
/// `places`: indices of the buildings that have an area.
pub(super) fn measure(report: &mut GeneraliseReport, city: &City, levels: &[Level; 2], places: &[usize]) {
    report.volume_m3 = places.iter().map(|i| volume_m3(&city.buildings[*i])).sum();
    for (level, figures) in levels.iter().zip(&mut report.levels) {
        figures.volume_m3 = level.city.buildings.iter().map(volume_m3).sum();
        figures.volume_share = figures.volume_m3 / report.volume_m3.max(f64::MIN_POSITIVE);
        figures.volume_kept = (figures.volume_share - 1.0).abs() <= VOLUME_OFF;
        measure_cells(figures, city, level);
    }
}

fn measure_cells(figures: &mut LevelReport, city: &City, level: &Level) {
    let held = |list: &[usize]| list.iter().map(|i| volume_m3(&city.buildings[*i])).sum::<f64>();
    let gaps = |f: &FailingCell| f.reason == FailingCell::GAPS || f.reason == FailingCell::SMALL;
    figures.cells_failing.retain(|f| !gaps(f));
    for ((block, shape), figure) in level.blocks.iter().zip(&level.city.buildings).zip(&mut figures.each_block) {
        figure.volume_in_m3 = held(&level.cells[block.cell].buildings);
        figure.volume_out_m3 = volume_m3(shape);
    }
    for cell in &level.cells {
        let block = figures.each_block.iter().find(|b| b.block == cell.name);
        let landmarks = held(&cell.landmarks);
        let [volume_in_m3, volume_out_m3] =
            [held(&cell.buildings), block.map_or(0.0, |b| b.volume_out_m3)].map(|v| v + landmarks);
        let failing = figures.cells_failing.iter_mut().find(|f| f.cell == cell.name);
        if let Some(failing) = failing {
            (failing.volume_in_m3, failing.volume_out_m3) = (volume_in_m3, volume_out_m3);
        } else if let Some(block) = block
            && (volume_out_m3 - volume_in_m3).abs() > VOLUME_OFF * volume_in_m3
        {
            figures.cells_failing.push(FailingCell {
                cell: cell.name.clone(),
                at: cell.at,
                reason: if volume_out_m3 > volume_in_m3 { FailingCell::GAPS } else { FailingCell::SMALL },
                buildings: cell.buildings.len() + cell.landmarks.len(),
                volume_in_m3,
                volume_out_m3,
                covered_share: block.covered_share,
            });
        }
    }
}
