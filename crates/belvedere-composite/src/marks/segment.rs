//! The part of a segment within borders.

/// Parameters `[s, t]` of the part of a segment that lies within all borders; `None` if no part of it does.
///
/// * `ends`: for each border the distances of both ends from it, negative beyond it; the distance is linear along the segment.
pub(crate) fn within(ends: impl IntoIterator<Item = (f64, f64)>) -> Option<[f64; 2]> {
    let (mut s, mut t) = (0.0f64, 1.0f64);
    for (a, b) in ends {
        match (a >= 0.0, b >= 0.0) {
            (true, true) => {}
            (false, false) => return None,
            (true, false) => t = t.min(a / (a - b)),
            (false, true) => s = s.max(a / (a - b)),
        }
    }
    (s < t).then_some([s, t])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_at_each_border() {
        assert_eq!(within([(1.0, 3.0), (2.0, 0.0)]), Some([0.0, 1.0]));
        assert_eq!(within([(-1.0, 3.0), (2.0, -2.0)]), Some([0.25, 0.5]));
        assert_eq!(within([(-1.0, 1.0), (1.0, -3.0)]), None, "behind one border before it is in front of the other");
        assert_eq!(within([(-1.0, -1.0)]), None);
    }
}
