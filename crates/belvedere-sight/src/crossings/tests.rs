use super::*;
use belvedere_scene::{Heightfield, NodeState};

fn field(cols: usize, rows: usize, void: &[usize]) -> Field {
    let heights = (0..cols * rows).map(|i| ((i * 7919) % 101) as f32).collect();
    let mut states = vec![NodeState::Measured; cols * rows];
    void.iter().for_each(|&i| states[i] = NodeState::Void);
    let hf = Heightfield::new(DVec2::new(0.0, 0.0), DVec2::new(10.0, 20.0), cols, rows, heights, states).unwrap();
    Field::new(&hf, |_| 0.0).unwrap()
}

fn samples(field: &Field, from: [f64; 2], eye: [f64; 2], diagonals: bool) -> Vec<SightSample> {
    sight_samples(field, DVec2::from(from), DVec2::from(eye), diagonals)
}

/// Number of crossings of one axis, by counting integers strictly between.
fn between(a: f64, b: f64) -> usize {
    (0..40).filter(|&k| (f64::from(k) - a) * (f64::from(k) - b) < 0.0).count()
}

#[test]
fn every_grid_line_is_crossed_once_in_order_and_heights_are_those_of_the_edges() {
    let field = field(20, 17, &[]);
    for (from, eye) in [([1.3, 2.7], [17.9, 14.2]), ([17.9, 14.2], [1.3, 2.7]), ([3.5, 15.2], [18.1, 0.4])] {
        let (p, v) = (DVec2::from(from), DVec2::from(eye));
        let plain = samples(&field, from, eye, false);
        assert_eq!(plain.len(), between(p.x, v.x) + between(p.y, v.y));
        let fine = samples(&field, from, eye, true);
        let more = (-40..40).filter(|&k| (f64::from(k) - p.x + p.y) * (f64::from(k) - v.x + v.y) < 0.0).count();
        assert_eq!(fine.len(), plain.len() + more);
        for s in &fine {
            let g = p + s.tau * (v - p);
            assert!((field.surface_at(g).unwrap() - s.of(field.heights())).abs() < 1e-9, "{s:?}");
            assert!((s.rho - ((v - g) * field.spacing()).length()).abs() < 1e-9);
        }
        assert!(fine.windows(2).all(|w| w[0].tau < w[1].tau));
    }
}

#[test]
fn along_a_grid_line_and_through_nodes_each_node_comes_once() {
    let field = field(9, 9, &[]);
    let along = samples(&field, [1.5, 3.0], [6.5, 3.0], true);
    let nodes: Vec<u32> = along.iter().map(|s| s.nodes[0]).collect();
    assert_eq!(nodes, [29, 30, 31, 32, 33]);
    assert!(along.iter().all(|s| s.nodes[0] == s.nodes[1] && s.weight == 0.0));
    let column = samples(&field, [4.0, 7.5], [4.0, 0.0], true);
    assert_eq!(column.iter().map(|s| s.nodes[0]).collect::<Vec<_>>(), [67, 58, 49, 40, 31, 22, 13]);
    // Down the diagonal of the cells, from a node to a node: ends excluded.
    let diagonal = samples(&field, [1.0, 1.0], [6.0, 6.0], true);
    assert_eq!(diagonal.iter().map(|s| s.nodes).collect::<Vec<_>>(), [[20; 2], [30; 2], [40; 2], [50; 2]]);
    // Through nodes with a slope of 1 : 3, which f64 cannot hold.
    let third = samples(&field, [1.0, 2.0], [7.0, 4.0], false);
    let at_nodes: Vec<u32> = third.iter().filter(|s| s.weight == 0.0).map(|s| s.nodes[0]).collect();
    assert_eq!((third.len(), at_nodes), (5, vec![31]));
}

#[test]
fn beside_the_grid_nothing_is_crossed_and_the_rim_is() {
    let field = field(6, 5, &[]);
    let outside = samples(&field, [2.5, 2.5], [2.5, 40.0], true);
    assert_eq!(outside.len(), 3, "two rows and a diagonal in the middle of a cell");
    assert_eq!(outside.last().unwrap().nodes, [26, 27], "the southern rim");
    assert!((outside.last().unwrap().tau - 1.5 / 37.5).abs() < 1e-12);
    assert_eq!(samples(&field, [2.5, 2.5], [-3e6, 2.25], true).last().unwrap().nodes, [12, 18]);
    assert!(samples(&field, [-2.0, 2.0], [-1.0, 4.0], true).is_empty());
    assert!(samples(&field, [2.5, 2.5], [2.5, 2.5], true).is_empty(), "under the eye");
    assert!(samples(&field, [2.5, f64::NAN], [1.0, 2.0], true).is_empty());
    assert_eq!(samples(&field, [0.0, 0.5], [0.0, 4.0], true).len(), 3, "along the western rim");
    assert_eq!(samples(&field, [5.0, 0.5], [5.0, 9.0], true).len(), 4, "along the eastern rim and over the corner");
    // A point on the rim, looking along the south-eastern corner's diagonal.
    assert_eq!(samples(&field, [5.0, 4.0], [1.0, 0.0], true).len(), 3);
}

#[test]
fn an_edge_without_both_ends_is_no_ground() {
    let (solid, holed) = (field(6, 6, &[]), field(6, 6, &[14]));
    let all = samples(&solid, [0.5, 2.2], [4.6, 2.4], true);
    let left = samples(&holed, [0.5, 2.2], [4.6, 2.4], true);
    assert_eq!(all.iter().copied().filter(|s| !s.nodes.contains(&14)).collect::<Vec<_>>(), left);
    assert_eq!(all.len() - left.len(), 2, "the southern and the diagonal edge of the node");
}

#[test]
fn both_directions_see_the_same_edges() {
    let field = field(20, 17, &[]);
    let (a, b) = ([2.0, 3.0], [15.0, 11.25]);
    let forth = samples(&field, a, b, true);
    let mut back = samples(&field, b, a, true);
    back.reverse();
    assert_eq!(forth.iter().map(|s| s.nodes).collect::<Vec<_>>(), back.iter().map(|s| s.nodes).collect::<Vec<_>>());
    assert!(forth.iter().zip(&back).all(|(f, b)| (f.tau + b.tau - 1.0).abs() < 1e-12));
}

#[test]
fn the_guard_is_measured_in_cells() {
    let (p, v) = (DVec2::new(1.0, 2.0), DVec2::new(4.0, 6.0));
    assert!((guard_tau(p, v, 1.5) - 0.3).abs() < 1e-15);
    assert_eq!(guard_tau(p, p, 1.5), 1.0);
}
