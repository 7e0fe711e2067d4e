//! Colours of ground by climate and season: meadows, forest, rock and snow at the heights where the place has them.

use belvedere_scene::{Climate, PaletteName};

/// A colour at a height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stop {
    /// Over the sea, metres.
    pub(super) height_m: f32,
    pub(super) color: [u8; 3],
    /// Strength of the texture, 0..=1.
    pub(super) rough: f32,
}

/// Colours by height, and those that steepness and snow add.
#[derive(Debug, Clone)]
pub(super) struct Look {
    /// At least two, by height.
    pub(super) stops: Vec<Stop>,
    pub(super) rock: [u8; 3],
    /// Tangents of the slopes at which rock begins and at which it covers the ground.
    pub(super) rock_slope: [f32; 2],
    /// Heights at which snow begins and at which it covers gentle slopes, metres.
    pub(super) snow_m: [f32; 2],
    /// Tangents of the slopes at which snow begins to slide off and has gone.
    pub(super) snow_slope: [f32; 2],
    /// Height that a slope of tangent 1 to the north adds for snow, metres.
    pub(super) north_m: f32,
}

/// Parts of the way from the valleys (0) over the line of trees (1) to the line of snow (2), with colours and textures. Lighter the higher.
type Bands = [(f32, [u8; 3], f32); 7];

const SUMMER: Bands = [
    (0.0, [106, 136, 100], 0.40),
    (0.4, [112, 142, 102], 0.55),
    (0.8, [124, 152, 108], 0.75),
    (1.0, [156, 172, 122], 0.50),
    (1.25, [184, 184, 140], 0.40),
    (1.6, [203, 195, 168], 0.60),
    (2.0, [214, 207, 194], 0.65),
];
const AUTUMN: Bands = [
    (0.0, [126, 126, 78], 0.40),
    (0.45, [146, 130, 76], 0.60),
    (0.85, [172, 140, 78], 0.80),
    (1.05, [186, 158, 98], 0.50),
    (1.35, [194, 174, 126], 0.40),
    (1.7, [202, 188, 160], 0.60),
    (2.1, [214, 206, 194], 0.65),
];
/// Forest shows dark through the snow, which lies on open ground.
const WINTER: Bands = [
    (0.0, [142, 150, 140], 0.45),
    (0.3, [150, 158, 150], 0.70),
    (0.85, [158, 167, 166], 0.85),
    (1.05, [204, 210, 213], 0.35),
    (1.35, [218, 223, 227], 0.20),
    (1.7, [224, 229, 233], 0.15),
    (2.1, [229, 233, 238], 0.12),
];
const DRY: Bands = [
    (0.0, [168, 120, 88], 0.70),
    (0.3, [184, 136, 98], 0.70),
    (0.6, [198, 154, 114], 0.65),
    (0.9, [206, 170, 132], 0.60),
    (1.2, [208, 180, 148], 0.65),
    (1.6, [208, 188, 164], 0.70),
    (2.1, [214, 204, 190], 0.70),
];

/// Depth of the forest below the line of trees, metres.
const FOREST_M: f32 = 1800.0;

/// The look of a palette at a place; `None` for palettes that do not depend on it.
/// * `z_range_m`: heights of the ground.
pub(super) fn look(name: PaletteName, climate: &Climate, z_range_m: [f64; 2]) -> Option<Look> {
    let [trees, snow] = [climate.tree_line_m as f32, climate.snow_line_m as f32];
    let dry = climate.dryness as f32;
    let sunny = if climate.latitude_deg < 0.0 { -1.0 } else { 1.0 };
    // Near the equator the sun shines from both sides.
    let north_m = sunny * 220.0 * (climate.latitude_deg.abs() as f32 / 30.0).min(1.0);
    let winter = climate.winter() as f32;
    let lines = [trees, snow];
    let look = match name {
        PaletteName::Auto => with_bands(&mixed(&SUMMER, &DRY, dry), lines, dry, z_range_m),
        PaletteName::Swiss => with_bands(&SUMMER, lines, 0.0, z_range_m),
        PaletteName::Autumn => {
            let fresh = snow - 350.0 * winter;
            with_bands(&mixed(&AUTUMN, &DRY, dry), [trees, fresh.max(trees + 100.0)], dry, z_range_m)
        }
        PaletteName::Winter => {
            // Open ground above the forest is white, and in dry climates what lies higher than it.
            let lowest = snow + winter * (trees - snow) + 500.0 * dry;
            let snow_m = [lowest - 350.0, lowest + 150.0];
            let usual = with_bands(&mixed(&WINTER, &DRY, 0.7 * dry), lines, dry, z_range_m);
            Look { snow_m, snow_slope: [0.65, 1.35], ..usual }
        }
        _ => return None,
    };
    let look = Look { north_m, ..look };
    Some(look)
}

/// The look of a season where the place is not known: its lines are those of the range of heights.
pub(super) fn unplaced(name: PaletteName, z_range_m: [f64; 2]) -> Look {
    let [bottom, top] = z_range_m;
    let snow_line_m = (bottom + 0.7 * (top - bottom)).max(2450.0);
    let climate = Climate { snow_line_m, tree_line_m: snow_line_m - 1050.0, dryness: 0.0, latitude_deg: 45.0 };
    look(name, &climate, z_range_m).unwrap_or_else(|| with_bands(&SUMMER, [1400.0, 2450.0], 0.0, z_range_m))
}

/// * `dry`: dryness; dry ground shows its colours over the range of its heights, humid ground over the heights of its climate.
fn with_bands(bands: &Bands, [trees, snow]: [f32; 2], dry: f32, z_range_m: [f64; 2]) -> Look {
    let [low, high] = z_range_m.map(|z| z as f32);
    let range = (high - low).max(400.0);
    let valley = low.clamp(trees - 1.6 * FOREST_M, trees - 0.4 * FOREST_M);
    let (forest, top) = if low < valley {
        // Lowland far below the line of trees.
        (low + (1.5 - 0.9 * dry) * range, low + 2.5 * range)
    } else {
        (valley + (1.5 - 0.9 * dry) * range, high + 0.05 * range)
    };
    let valley = valley.min(low);
    let forest = forest.clamp(valley + 200.0, trees.max(valley + 200.0));
    let top = top.clamp(forest + 300.0, snow.max(forest + 300.0));
    let height = |part: f32| {
        if part <= 1.0 { valley + part * (forest - valley) } else { forest + (part - 1.0) * (top - forest) }
    };
    let stops = bands.iter().map(|(part, color, rough)| Stop { height_m: height(*part), color: *color, rough: *rough });
    let mix = |humid: u8, arid: u8| (f32::from(humid) + dry * (f32::from(arid) - f32::from(humid))).round() as u8;
    Look {
        stops: stops.collect(),
        rock: [mix(156, 150), mix(150, 106), mix(140, 80)],
        rock_slope: [0.44, 1.0],
        snow_m: [snow - 80.0, snow + 320.0],
        snow_slope: [0.7, 1.3],
        north_m: 0.0,
    }
}

fn mixed(a: &Bands, b: &Bands, share: f32) -> Bands {
    std::array::from_fn(|i| {
        let ((at, x, p), (to, y, q)) = (a[i], b[i]);
        let mix = |v: f32, w: f32| v + share * (w - v);
        let color = [0, 1, 2].map(|k| mix(f32::from(x[k]), f32::from(y[k])).round() as u8);
        (mix(at, to), color, mix(p, q))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_snow_lies_in_the_grand_canyon_and_aconcagua_is_not_white_all_over() {
        let canyon = look(PaletteName::Auto, &Climate::at(-112.1, 36.1), [700.0, 2700.0]).unwrap();
        assert!(canyon.snow_m[0] - canyon.north_m.abs() > 2700.0, "{:?}", canyon.snow_m);
        let aconcagua = look(PaletteName::Auto, &Climate::at(-70.0, -32.7), [2400.0, 6961.0]).unwrap();
        assert!(aconcagua.snow_m[0] > 4500.0 && aconcagua.snow_m[1] < 6300.0, "{:?}", aconcagua.snow_m);
    }

    #[test]
    fn bands_are_in_order_and_lighter_the_higher() {
        let places = [(8.0, 46.5), (-112.1, 36.1), (86.9, 28.0), (16.0, 78.0), (5.0, 52.0), (37.4, -3.1)];
        let ranges = [[-3.0, 40.0], [0.0, 400.0], [300.0, 3200.0], [2500.0, 8600.0], [5.0, 5.0]];
        for (lon, lat) in places {
            for range in ranges {
                for name in [PaletteName::Auto, PaletteName::Swiss, PaletteName::Winter, PaletteName::Autumn] {
                    let look = look(name, &Climate::at(lon, lat), range).unwrap();
                    for (a, b) in look.stops.iter().zip(&look.stops[1..]) {
                        assert!(a.height_m < b.height_m, "{name:?} {lat} {range:?}: {a:?} {b:?}");
                        let light = |c: [u8; 3]| 0.2 * f64::from(c[0]) + 0.7 * f64::from(c[1]) + 0.1 * f64::from(c[2]);
                        assert!(light(a.color) < light(b.color) + 1.0, "{name:?} {lat}: {a:?} {b:?}");
                    }
                    assert!(look.snow_m[0] < look.snow_m[1]);
                }
            }
        }
    }

    #[test]
    fn slopes_away_from_the_sun_keep_snow_longer_on_both_halves_of_the_earth() {
        let north = |lat: f64| look(PaletteName::Auto, &Climate::at(8.0, lat), [500.0, 4000.0]).unwrap().north_m;
        assert!(north(46.0) > 100.0 && north(-46.0) < -100.0 && north(1.0).abs() < 20.0);
    }
}
