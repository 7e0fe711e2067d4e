//! Positions that have latitude before longitude.

use glam::DVec2;

/// Share of the size of a stated extent by which positions may lie outside.
const OUTSIDE: f64 = 1e-3;

/// Why positions have latitude first, if only so they fit: where none of the second of their numbers is a latitude and the first may be, or
/// where the extent that the file states holds them only the other way round.
///
/// * `stated`: least and greatest x and y of the file, which may have the other order.
/// * `are_degrees`: whether the system has longitude and latitude.
pub(crate) fn reason(
    positions: impl Iterator<Item = DVec2>,
    stated: Option<[DVec2; 2]>,
    are_degrees: bool,
) -> Option<String> {
    let ends = positions
        .fold(None, |ends: Option<[DVec2; 2]>, p| Some(ends.map_or([p; 2], |[low, high]| [low.min(p), high.max(p)])));
    let [low, high] = ends?;
    // A single position beyond the pole is a fault of its own.
    let beyond = if low.y > 0.0 { low.y } else { high.y };
    let is_swapped = |p: DVec2| p.x.abs() <= 90.0 && p.y.abs() <= 180.0;
    if are_degrees && beyond.abs() > 90.0 && is_swapped(low) && is_swapped(high) {
        return Some(format!("its second numbers are {beyond} and beyond, and no latitude is beyond 90 degrees"));
    }
    let [from, to] = stated.filter(|[from, to]| from.is_finite() && to.is_finite() && from.cmple(*to).all())?;
    let margin = OUTSIDE * (to - from);
    let holds = |low: DVec2, high: DVec2| low.cmpge(from - margin).all() && high.cmple(to + margin).all();
    let says =
        format!("the extent that it states, {} {} to {} {}, holds its positions only so", from.x, from.y, to.x, to.y);
    (!holds(low, high) && holds(DVec2::new(low.y, low.x), DVec2::new(high.y, high.x))).then_some(says)
}

/// What is said of positions that were exchanged.
pub(crate) fn said(reason: &str) -> String {
    format!("its positions have latitude before longitude, and are exchanged: {reason}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_fits_no_other_way_is_exchanged() {
        let of = |points: &[[f64; 2]], stated: Option<[f64; 4]>, are_degrees: bool| {
            let stated = stated.map(|[a, b, c, d]| [DVec2::new(a, b), DVec2::new(c, d)]);
            reason(points.iter().map(|p| DVec2::from(*p)), stated, are_degrees).is_some()
        };
        let japan = [[36.1, 138.2], [36.2, 138.3]];
        assert!(of(&japan, None, true) && !of(&japan, None, false));
        assert!(!of(&[[14.4, 50.1], [14.0, 95.0]], None, true));
        assert!(
            !of(&[[138.2, 36.1]], None, true) && !of(&[[136.0, 138.0]], None, true) && !of(&[[1.0, 300.0]], None, true)
        );
        let alps = [[46.1, 8.2], [46.2, 8.4]];
        assert!(of(&alps, Some([8.0, 46.0, 9.0, 47.0]), true) && of(&alps, Some([8.0, 46.0, 9.0, 47.0]), false));
        assert!(!of(&alps, None, true) && !of(&alps, Some([46.0, 8.0, 47.0, 9.0]), true));
        assert!(!of(&alps, Some([0.0, 0.0, 1.0, 1.0]), true) && !of(&[], None, true));
    }
}
