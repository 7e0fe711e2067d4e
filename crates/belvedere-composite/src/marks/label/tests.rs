use super::*;
use crate::marks::name_memory::Patience;
use crate::marks::request::Baseline;
use std::collections::HashMap;

const BLACK: Color = Color::rgb(0, 0, 0);

fn place(requests: Vec<LabelRequest>, size: DVec2, keep_clear: &[Rect]) -> Labels {
    Labels::place(
        requests,
        &Page { size, density: 1.0, fonts: &Fonts::default(), keep_clear, must_see: Occupied::new(48.0) },
        Choice::Free,
    )
}

fn summit(i: usize, at: DVec2) -> LabelRequest {
    let request = LabelRequest::new(format!("Summit {i}"), at, 13.0, BLACK);
    LabelRequest { marker: [5.0, 6.0], leader: true, ..request }
}

fn boxes(labels: &Labels) -> Vec<Rect> {
    let block = |p: &Placed| {
        let at = p.candidate.baseline;
        [at - DVec2::Y * p.lines.ascent, at + DVec2::new(p.lines.width, p.lines.descent)]
    };
    labels.placed.iter().map(block).collect()
}

fn assert_apart(labels: &Labels, size: DVec2) {
    let rects = boxes(labels);
    for (i, a) in rects.iter().enumerate() {
        assert!(a[0].min_element() >= 0.0 && a[1].cmple(size).all(), "a name leaves the picture: {a:?}");
        assert!(rects[..i].iter().all(|b| !overlap(a, b)), "name {i} lies over another");
    }
}

#[test]
fn names_do_not_overlap_and_the_first_come_first() {
    // Fifty summits in a tight row: not all names fit.
    let size = DVec2::new(400.0, 300.0);
    let labels = place((0..50).map(|i| summit(i, DVec2::new(100.0 + 4.0 * i as f64, 230.0))).collect(), size, &[]);
    let n = labels.placed.len();
    assert!((8..50).contains(&n), "{n} names of 50");
    assert_eq!(labels.placed[0].lines.lines[0].0, "Summit 0");
    assert_apart(&labels, size);
}

#[test]
fn names_stay_off_what_must_be_seen_unless_they_name_it_and_those_left_out_are_counted() {
    let size = DVec2::new(300.0, 200.0);
    // A route across the picture, over the place where the name would stand.
    let route = || {
        let mut taken = Occupied::new(16.0);
        (0..75).for_each(|i| {
            taken.take([DVec2::new(4.0 * f64::from(i), 84.0), DVec2::new(4.0 * f64::from(i + 1), 90.0)], 1)
        });
        taken
    };
    let place = |layer: u32, must_see: Occupied| {
        let request = LabelRequest { layer, ..LabelRequest::new("Hut", DVec2::new(150.0, 100.0), 13.0, BLACK) };
        Labels::place(
            vec![request],
            &Page { size, density: 1.0, fonts: &Fonts::default(), keep_clear: &[], must_see },
            Choice::Free,
        )
    };
    let boxes = |labels: &Labels| labels.placed.iter().flat_map(|p| p.candidate.boxes.clone()).collect::<Vec<_>>();
    let (own, other) = (place(1, route()), place(2, route()));
    let line = [DVec2::new(0.0, 84.0), DVec2::new(300.0, 90.0)];
    assert!(boxes(&own).iter().any(|r| overlap(r, &line)), "the name of the route itself may stand there");
    assert!(!boxes(&other).is_empty() && boxes(&other).iter().all(|r| !overlap(r, &line)));
    assert_eq!((own.left_out(), other.left_out()), (0, 0));
    let mut all = Occupied::new(16.0);
    all.take([DVec2::ZERO, size], 1);
    let none = place(2, all);
    assert_eq!((none.placed.len(), none.left_out()), (0, 1));
}

#[test]
fn names_keep_clear_of_what_is_kept_clear() {
    let size = DVec2::new(400.0, 300.0);
    let legend = [DVec2::new(150.0, 120.0), DVec2::new(400.0, 300.0)];
    let labels =
        place((0..20).map(|i| summit(i, DVec2::new(180.0, 20.0 + 14.0 * i as f64))).collect(), size, &[legend]);
    assert!(labels.placed.len() > 5);
    assert_apart(&labels, size);
    assert!(boxes(&labels).iter().all(|rect| !overlap(rect, &legend)));
}

/// Names of summits that drift to the left, the farther ones slowlier, as past a moving camera, frame by frame.
fn drifting(frames: usize, held: bool) -> Vec<HashMap<String, (belvedere_scene::NamePlace, DVec2)>> {
    let size = DVec2::new(700.0, 400.0);
    let mut memory = NameMemory::default();
    let frame = |frame: usize| {
        let requests: Vec<LabelRequest> = (0..40)
            .map(|i| {
                let (near, row) = (1.0 + f64::from(i % 5), f64::from(i * 37 % 90));
                let x = f64::from(i * 53 % 900) - 0.35 * near * frame as f64;
                let rank = f64::from(2000 + i * 71 % 1500);
                let at = DVec2::new(x, 220.0 + row);
                let skyline = (row < 40.0).then_some(225.0 + 6.0 * (0.05 * x).sin());
                LabelRequest { rank, skyline, layer: 1, ..summit(i as usize, at) }
            })
            .collect();
        let fonts = Fonts::default();
        let page = Page { size, density: 1.0, fonts: &fonts, keep_clear: &[], must_see: Occupied::new(48.0) };
        let none = NameMemory::default();
        let labels = Labels::place(requests, &page, Choice::Next(if held { &memory } else { &none }, Patience(5)));
        assert_apart(&labels, size);
        let at = labels.placed.iter().map(|p| p.candidate.baseline).collect::<Vec<_>>();
        memory = labels.into_memory();
        memory.names().into_iter().zip(at).map(|(name, at)| (name.id.text, (name.place, at))).collect()
    };
    (0..frames).map(frame).collect()
}

/// Changes of place of names that are there in two frames that follow each other, and names that come or go.
fn changes(film: &[HashMap<String, (belvedere_scene::NamePlace, DVec2)>]) -> [usize; 2] {
    film.windows(2).fold([0; 2], |[moved, went], pair| {
        let both = pair[0].iter().filter_map(|(name, (place, _))| Some((place, pair[1].get(name)?.0)));
        let (both, there): (Vec<_>, usize) = (both.collect(), pair[0].len() + pair[1].len());
        [moved + both.iter().filter(|(a, b)| **a != *b).count(), went + there - 2 * both.len()]
    })
}

#[test]
fn names_keep_their_places_while_summits_drift_past_each_other() {
    let (steady, anew) = (drifting(200, true), drifting(200, false));
    let (kept, placed) = (changes(&steady), changes(&anew));
    assert!(2 * kept[0] < placed[0], "{kept:?} and without memory {placed:?}");
    assert!(5 * kept[1] < 4 * placed[1], "{kept:?} and without memory {placed:?}");
    // No fewer names are there.
    let names = |film: &[HashMap<_, _>]| film.iter().map(HashMap::len).sum::<usize>();
    assert!(names(&steady) as f64 > 0.9 * names(&anew) as f64, "{} of {}", names(&steady), names(&anew));
    // A name that goes does not come back at once.
    for name in steady.iter().flat_map(HashMap::keys) {
        let there: Vec<bool> = steady.iter().map(|frame| frame.contains_key(name)).collect();
        let gaps = there.split(|there| *there).filter(|gap| !gap.is_empty()).count();
        assert!(gaps <= 1 || !there.windows(6).any(|w| w[0] && !w[1] && w[2..].contains(&true)), "{name}: {there:?}");
    }
}

#[test]
fn names_given_beforehand_stand_where_they_were_placed() {
    let requests = |n: usize| (0..n).map(|i| summit(i, DVec2::new(100.0 + 7.0 * i as f64, 230.0))).collect();
    let (fonts, none) = (Fonts::default(), NameMemory::default());
    let page = Page {
        size: DVec2::new(400.0, 300.0),
        density: 1.0,
        fonts: &fonts,
        keep_clear: &[],
        must_see: Occupied::new(48.0),
    };
    let first = Labels::place(requests(20), &page, Choice::Next(&none, Patience(3)));
    let free = Labels::place(requests(20), &page, Choice::Free);
    assert_eq!(first.placed, free.placed, "the first frame is that of a picture");
    let placed = first.placed.clone();
    let names = first.into_memory().names();
    let given = Labels::place(requests(20), &page, Choice::Given(&names));
    assert_eq!(given.placed, placed);
    assert!(Labels::place(requests(20), &page, Choice::Given(&names[..1])).placed.len() == 1);
}

#[test]
fn two_lines_stand_as_one_block_and_rows_stand_over_the_skyline() {
    let size = DVec2::new(600.0, 400.0);
    let ground = 250.0;
    let peaks = (0..9).map(|i| {
        let request = summit(i, DVec2::new(40.0 + 60.0 * i as f64, ground + f64::from(i as u8 % 3)));
        LabelRequest { second: format!("{} m", 2000 + i), skyline: Some(ground), ..request }
    });
    let labels = place(peaks.collect(), size, &[]);
    assert_eq!(labels.placed.len(), 9);
    assert_apart(&labels, size);
    assert!(labels.placed.iter().all(|p| p.candidate.leader.is_some() && p.lines.lines.len() == 2));
    let mut rows: Vec<i64> = labels.placed.iter().map(|p| p.candidate.baseline.y.round() as i64).collect();
    rows.sort_unstable();
    rows.dedup();
    assert!(rows.len() <= 3 && rows.iter().all(|y| (*y as f64) < ground - 10.0), "rows at {rows:?}");
}

#[test]
fn a_name_beside_its_line_does_not_stand_on_it() {
    let line: Vec<DVec2> = (0..200).map(|i| DVec2::new(100.0 + f64::from(i), 100.0 + 0.8 * f64::from(i))).collect();
    let request = LabelRequest::new("Gasse", line[100], 13.0, BLACK);
    let request = LabelRequest { line: (line.clone(), 4.0), marker: [4.0; 2], ..request };
    let labels = place(vec![request], DVec2::splat(400.0), &[]);
    let on = |rect: &Rect| line.iter().any(|p| p.cmpgt(rect[0] - 3.0).all() && p.cmplt(rect[1] + 3.0).all());
    assert!(boxes(&labels).iter().all(|rect| !on(rect)), "{:?}", labels.placed);
    assert_eq!(labels.placed.len(), 1);
    // A line that fills its surroundings leaves no room.
    let zigzag: Vec<DVec2> =
        (0..400).map(|i| DVec2::new(100.0 + 0.5 * f64::from(i), if i % 2 == 0 { 60.0 } else { 140.0 })).collect();
    let request = LabelRequest { line: (zigzag.clone(), 4.0), ..LabelRequest::new("Gasse", zigzag[200], 13.0, BLACK) };
    assert!(place(vec![request], DVec2::splat(400.0), &[]).placed.is_empty());
}

#[test]
fn segments_and_rectangles_meet_as_a_search_says() {
    let rect = [DVec2::new(10.0, 20.0), DVec2::new(50.0, 30.0)];
    for (a, b) in [
        ([0.0, 0.0], [60.0, 50.0]),
        ([0.0, 10.0], [60.0, 19.0]),
        ([30.0, 0.0], [30.0, 60.0]),
        ([12.0, 22.0], [13.0, 23.0]),
        ([0.0, 40.0], [9.0, 25.0]),
        ([51.0, 31.0], [90.0, 90.0]),
    ] {
        let (a, b) = (DVec2::from_array(a), DVec2::from_array(b));
        let searched = (0..=1000)
            .map(|i| a.lerp(b, f64::from(i) / 1000.0))
            .any(|p| p.cmpgt(rect[0]).all() && p.cmplt(rect[1]).all());
        // What is found may be too much near corners, never too little.
        assert!(!searched || crosses(a, b, &rect), "{a} {b}");
    }
    assert!(!crosses(DVec2::new(0.0, 10.0), DVec2::new(60.0, 19.0), &rect));
    assert!(!crosses(DVec2::new(51.0, 31.0), DVec2::new(90.0, 90.0), &rect));
}

#[test]
fn two_thousand_names_on_a_poster_stand_apart_and_are_placed_in_time() {
    // A0 at 300 dots per inch, letters and gaps of 300 / 96 pixels per unit.
    let (size, density) = (DVec2::new(14_043.0, 9933.0), 3.125);
    let mut seed = 11u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / f64::from(1u32 << 24)
    };
    let point = |i: usize, at: DVec2| {
        let request = LabelRequest::new(format!("Piz {i}"), at, 13.0 * density, BLACK);
        LabelRequest { second: "2814 m".into(), marker: [15.0, 20.0], leader: true, ..request }
    };
    let mut requests: Vec<LabelRequest> = (0..1500).map(|i| point(i, size * DVec2::new(random(), random()))).collect();
    let lines: Vec<(Vec<DVec2>, f64)> = (0..500)
        .map(|_| {
            let (at, turn) = (size * DVec2::new(random(), random()), 2.0 * random() - 1.0);
            let along = |i: i32| DVec2::new(f64::from(i), 60.0 * (f64::from(i) * 0.004).sin());
            ((0..900).map(|i| at + DVec2::from_angle(turn).rotate(along(i))).collect(), 6.0 + 6.0 * random())
        })
        .collect();
    let letters = |width, gap| crate::marks::baseline::Letters { width, size_px: 13.0 * density, gap };
    let started = std::time::Instant::now();
    requests.extend(lines.iter().enumerate().map(|(i, (line, half))| {
        let text = format!("Via Alpina {i}");
        let width = Fonts::default().text_size(13.0 * density, &text).width;
        let along = crate::marks::baseline::baselines(line, letters(width, half + density), None);
        let along = along.into_iter().map(|a| Baseline { points: a.points, upper: a.upper, anchor: None }).collect();
        let request = LabelRequest::new(text, line[450], 13.0 * density, BLACK);
        LabelRequest { along, line: (line.clone(), *half), marker: [*half; 2], ..request }
    }));
    let page = Page { size, density, fonts: &Fonts::default(), keep_clear: &[], must_see: Occupied::new(48.0) };
    let labels = Labels::place(requests, &page, Choice::Free);
    let taken = started.elapsed();
    assert!(taken.as_secs_f64() < 5.0, "{taken:?}");
    assert!(labels.placed.len() > 1500, "{} names", labels.placed.len());
    let curved: Vec<&Placed> = labels.placed.iter().filter(|p| !p.candidate.along.is_empty()).collect();
    assert!(curved.len() > 150, "{} names along lines", curved.len());
    let boxes: Vec<(usize, &Rect)> =
        labels.placed.iter().enumerate().flat_map(|(i, p)| p.candidate.boxes.iter().map(move |r| (i, r))).collect();
    for (k, (i, a)) in boxes.iter().enumerate() {
        assert!(a[0].min_element() >= 0.0 && a[1].cmple(size).all());
        assert!(boxes[..k].iter().all(|(j, b)| i == j || !overlap(a, b)), "names {i} lies over another");
    }
    // No name crosses the casing of its line: the ends of the strokes of its letters stay off it.
    for placed in &curved {
        let name = &placed.lines.lines[0].0;
        let number: usize = name.rsplit(' ').next().and_then(|n| n.parse().ok()).expect("a number");
        let (line, half) = &lines[number];
        for pair in placed
            .candidate
            .along
            .windows(2)
            .take_while(|pair| pair[0].distance(placed.candidate.baseline) < placed.lines.width)
        {
            let direction = (pair[1] - pair[0]).normalize_or_zero();
            let up = DVec2::new(direction.y, -direction.x);
            for share in [-0.24, 0.0, 0.4, 0.76] {
                let p = pair[0] + share * placed.size_px * up;
                let nearest = line.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
                assert!(nearest > *half, "{name}: {nearest} px from the middle of a line of {half}");
            }
        }
    }
}
