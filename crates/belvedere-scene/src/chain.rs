//! Lines of a layer as one route.

use crate::LineLayer;
use belvedere_core::DVec3;

impl LineLayer {
    /// The longest line, extended at both ends by the nearest other lines, across gaps of at most `gap` in plan, scene units.
    pub fn longest_chain(&self, gap: f64) -> Vec<DVec3> {
        let lines = self.features.iter().map(|f| f.points.clone()).filter(|points| points.len() > 1);
        chain(lines.collect(), gap)
    }
}

fn chain(mut rest: Vec<Vec<DVec3>>, gap: f64) -> Vec<DVec3> {
    let distance = |a: DVec3, b: DVec3| a.truncate().distance(b.truncate());
    let length = |line: &[DVec3]| line.windows(2).map(|w| distance(w[0], w[1])).sum::<f64>();
    let Some(longest) = (0..rest.len()).max_by(|a, b| length(&rest[*a]).total_cmp(&length(&rest[*b]))) else {
        return Vec::new();
    };
    let mut chain = rest.swap_remove(longest);
    loop {
        let (head, tail) = (chain[0], chain[chain.len() - 1]);
        // Distance, index of the line, whether it is joined to the tail, whether it is reversed.
        let mut best: Option<(f64, usize, bool, bool)> = None;
        for (i, line) in rest.iter().enumerate() {
            let (a, b) = (line[0], line[line.len() - 1]);
            for (d, to_tail, turned) in [
                (distance(a, tail), true, false),
                (distance(b, tail), true, true),
                (distance(b, head), false, false),
                (distance(a, head), false, true),
            ] {
                if d <= gap && best.is_none_or(|b| d < b.0) {
                    best = Some((d, i, to_tail, turned));
                }
            }
        }
        let Some((_, i, to_tail, turned)) = best else { return chain };
        let mut line = rest.swap_remove(i);
        if turned {
            line.reverse();
        }
        let (mut first, second) = if to_tail { (chain, line) } else { (line, chain) };
        first.extend(second);
        chain = first;
    }
}
