use super::*;

fn saddle(void: Option<usize>) -> Heightfield {
    let mut states = vec![NodeState::Measured; 4];
    if let Some(i) = void {
        states[i] = NodeState::Void;
    }
    // North-west and south-east low, the other two 40 m higher: bilinear and triangles differ by 20 m in the middle.
    Heightfield::new(DVec2::new(0.0, 10.0), DVec2::splat(10.0), 2, 2, vec![0.0, 40.0, 40.0, 0.0], states).unwrap()
}

#[test]
fn states_take_memory_only_where_nodes_differ() {
    let (solid, holed) = (saddle(None), saddle(Some(1)));
    assert!(solid.states().each().is_none() && holed.states().each().is_some());
    for (hf, first) in [(&solid, NodeState::Measured), (&holed, NodeState::Void)] {
        let all = hf.states();
        assert_eq!((all.len(), all[1], all.get(1), all.get(4)), (4, first, Some(&first), None));
        assert_eq!(all.iter().copied().collect::<Vec<_>>(), all.to_vec());
    }
    let (nw, step) = (solid.north_west(), solid.spacing());
    let heights = solid.heights().to_vec();
    assert_eq!(Heightfield::measured(nw, step, 2, 2, heights).unwrap(), solid);
    let short = Heightfield::measured(nw, step, 2, 2, vec![0.0; 3]);
    assert!(matches!(short, Err(HeightfieldError::Length { expected: 4, heights: 3, .. })), "{short:?}");
}

#[test]
fn surface_is_two_triangles_along_the_north_west_south_east_diagonal() {
    let hf = saddle(None);
    assert_eq!(hf.surface_at(DVec2::new(5.0, 5.0)), Some(0.0));
    assert_eq!(hf.height_at(DVec2::new(5.0, 5.0)), Some(20.0));
    assert_eq!(hf.surface_at(DVec2::new(10.0, 10.0)), Some(40.0));
    assert_eq!(hf.surface_at(DVec2::new(7.5, 7.5)), Some(20.0), "upper right triangle");
    assert_eq!(hf.surface_at(DVec2::new(2.5, 2.5)), Some(20.0), "lower left triangle");
    assert_eq!(hf.surface_at(DVec2::new(10.1, 5.0)), None);
}

#[test]
fn a_void_node_opens_only_the_triangles_it_belongs_to() {
    let hf = saddle(Some(1));
    assert_eq!(hf.surface_at(DVec2::new(7.5, 7.5)), None);
    assert_eq!(hf.surface_at(DVec2::new(2.5, 2.5)), Some(20.0));
    assert_eq!(hf.surface_at(DVec2::new(5.0, 5.0)), Some(0.0), "the diagonal belongs to the solid triangle too");
}
