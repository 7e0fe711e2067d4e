use super::*;

#[test]
fn borders_of_a_disc_with_a_hole_lie_on_its_circles() {
    let (middle, width, height) = (DVec2::new(31.3, 22.8), 60, 50);
    let seen = |p: DVec2| (6.2..18.4).contains(&p.distance(middle));
    let centre = |i: usize| DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
    let pixels: Vec<u32> = (0..width * height).filter(|i| seen(centre(*i))).map(|i| i as u32).collect();
    let found = rings(&pixels, [width, height], seen);
    assert_eq!(found.len(), 2);
    for ring in &found {
        assert_eq!(ring.first(), ring.last());
        for p in ring {
            let r = p.distance(middle);
            assert!((r - 6.2).abs().min((r - 18.4).abs()) < 0.03, "{r}");
        }
    }
    let sum: f64 = found.iter().map(|ring| area(ring)).sum();
    let wanted = std::f64::consts::PI * (18.4f64.powi(2) - 6.2f64.powi(2));
    assert!((sum.abs() / wanted - 1.0).abs() < 0.01, "the hole turns the other way: {sum} of {wanted}");
    // What reaches the rim of the picture ends there.
    let all: Vec<u32> = (0..12).collect();
    let whole = rings(&all, [4, 3], |_| true);
    assert_eq!(whole.len(), 1);
    assert!(whole[0].iter().all(|p| (0.0..=4.0).contains(&p.x) && (0.0..=3.0).contains(&p.y)));
}

#[test]
fn many_large_areas_are_taken_in_groups() {
    let most = PIXELS_AT_ONCE;
    assert_eq!(groups(&[1, 0, most, most / 2, most / 2, 3]), [vec![0], vec![2], vec![3, 4], vec![5]]);
    assert_eq!(groups(&[5 * most, 1]), [vec![0], vec![1]]);
    assert!(groups(&[]).is_empty() && groups(&[0, 0]).is_empty());
}

#[test]
fn polygons_contain_what_the_even_odd_rule_says() {
    let square = |r: f64| vec![DVec2::splat(-r), DVec2::new(r, -r), DVec2::splat(r), DVec2::new(-r, r)];
    let plan = Plan::new(&[square(10.0), square(4.0)]);
    for (p, wanted) in [([9.9, 0.0], true), ([0.0, 0.0], false), ([-5.0, 5.0], true), ([10.1, 0.0], false)] {
        assert_eq!(plan.contains(DVec2::from_array(p)), wanted, "{p:?}");
    }
    assert!(!Plan::new(&[]).contains(DVec2::ZERO));
}
