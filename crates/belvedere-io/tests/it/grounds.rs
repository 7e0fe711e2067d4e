//! Several grounds as one: order, seams, lattices, and files of which tiles are left out.

use crate::atomic::Folder;
use crate::terrain::{load, write_asc};
use crate::tiff_writer::PLAIN;
use belvedere_io::TerrainRequest;
use glam::DVec2;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

#[test]
fn sources_of_one_lattice_are_blended_and_close_the_holes_of_each_other_in_any_order() {
    let folder = Folder::new("terrain-first");
    let (a, b) = (folder.0.join("a.asc"), folder.0.join("b.asc"));
    write_asc(&a, 10, 10, 5e5, 5e6, 30.0, &|c, r| if (c, r) == (5, 5) { -9999.0 } else { 1.0 });
    write_asc(&b, 10, 10, 5e5 + 90.0, 5e6, 30.0, &|_, _| 2.0);
    let request = TerrainRequest { source_crs: Some(32631), ..Default::default() };
    let (terrain, warnings) = load(&[a.clone(), b.clone()], &request).unwrap();
    let h = &terrain.heightfield;
    assert_eq!((h.cols(), h.rows()), (13, 10));
    assert_eq!(h.node(5, 5).unwrap().z, 2.0);
    assert_eq!([h.node(0, 4).unwrap().z, h.node(12, 0).unwrap().z], [1.0, 2.0]);
    // Across what both cover the height rises step by step: no border is a cliff.
    let across: Vec<f64> = (2..11).map(|c| h.node(c, 2).unwrap().z).collect();
    assert!(across.windows(2).all(|pair| (0.0..0.34).contains(&(pair[1] - pair[0]))), "{across:?}");
    assert!(warnings.iter().any(|w| w.text().contains("69 samples that they share")), "{warnings:?}");
    let turned = load(&[b, a], &request).unwrap().0;
    assert_eq!(turned.heightfield, terrain.heightfield, "the order in which files are named");
}

/// A coarse model of 300 m and a fine one of 25 m in its middle, 80 m higher, with a void.
fn coarse_and_fine(folder: &Folder) -> [PathBuf; 2] {
    // Files sort by name, the coarse one first.
    let files = ["a_far.asc", "b_near.asc"].map(|name| folder.0.join(name));
    write_asc(&files[0], 41, 41, 5e5, 5e6, 300.0, &|c, r| 500.0 + 10.0 * (c + r) as f64);
    let fine = |c: usize, r: usize| {
        let hole = (60..70).contains(&c) && (60..70).contains(&r);
        if hole { -9999.0 } else { 900.0 + 5.0 * ((c / 8 + r / 8) % 7) as f64 }
    };
    write_asc(&files[1], 161, 121, 5e5 + 4000.0, 5e6 + 4000.0, 25.0, &fine);
    files
}

#[test]
fn the_finest_ground_is_taken_in_any_order_and_its_border_is_no_cliff() {
    let folder = Folder::new("terrain-finest");
    let [far, near] = coarse_and_fine(&folder);
    let request = TerrainRequest { source_crs: Some(32631), ..Default::default() };
    let (terrain, warnings) = load(&[far.clone(), near.clone()], &request).unwrap();
    let turned = load(&[near.clone(), far.clone()], &request).unwrap().0;
    assert_eq!(turned.heightfield, terrain.heightfield, "the order in which files are named");
    assert!(warnings.iter().any(|w| w.text().contains("lies over other ground")), "{warnings:?}");
    let [alone, under] = [near, far].map(|file| load(&[file], &request).unwrap().0.heightfield);
    let h = &terrain.heightfield;
    assert!((h.spacing() - DVec2::splat(25.0)).abs().max_element() < 0.3, "{}", h.spacing());
    let (low, high) = (alone.bounds().min.truncate(), alone.bounds().max.truncate());
    let (mut inside, mut outside) = (0, 0);
    for i in 0..h.heights().len() {
        let xy = h.node_xy(i % h.cols(), i / h.cols());
        let Some(z) = h.height_at(xy) else { panic!("a hole at {xy}") };
        let from_border = (xy - low).min(high - xy).min_element();
        let from_hole = (xy - DVec2::new(505_612.5, 5_005_387.5)).abs().max_element();
        if from_border > 800.0 && from_hole > 900.0 {
            assert!((z - alone.height_at(xy).unwrap()).abs() < 0.05, "{xy}: not the fine ground");
            inside += 1;
        } else if from_border < -25.0 {
            assert!((z - under.height_at(xy).unwrap()).abs() < 0.1, "{xy}: not the coarse ground");
            outside += 1;
        }
        // The difference of up to 350 m is spread over three cells of 300 m; the fine model has steps of 30 m of its own.
        let right = h.height_at(xy + DVec2::new(25.0, 0.0)).unwrap_or(z);
        assert!((right - z).abs() < 48.0, "{xy}: a step of {} m", right - z);
    }
    assert!(inside > 500 && outside > 100_000, "{inside} {outside}");
}

#[test]
fn a_fine_model_in_a_far_larger_one_makes_the_ground_coarser_and_is_not_refused() {
    let folder = Folder::new("terrain-fine-in-wide");
    let [wide, fine] = ["wide.asc", "fine.asc"].map(|name| folder.0.join(name));
    write_asc(&wide, 41, 41, 5e5, 5e6, 300.0, &|_, _| 500.0);
    write_asc(&fine, 301, 301, 5e5 + 4000.0, 5e6 + 4000.0, 8.0, &|_, _| 900.0);
    let request = TerrainRequest { source_crs: Some(32631), max_nodes: 200_000, ..Default::default() };
    for order in [[&wide, &fine], [&fine, &wide]] {
        let (terrain, warnings) = load(&order.map(Clone::clone), &request).unwrap();
        let h = &terrain.heightfield;
        assert!((100_000..=200_000).contains(&h.heights().len()), "{} x {}", h.cols(), h.rows());
        assert!(warnings.iter().any(|w| w.text().contains("m instead of every 8.0 m")), "{warnings:?}");
        // The finer one where it has data, the coarser one beyond.
        let at = |x: f64, y: f64| h.height_at(DVec2::new(5e5 + x, 5e6 + y)).unwrap();
        assert!((at(5200.0, 5200.0) - 900.0).abs() < 1.0, "{}", at(5200.0, 5200.0));
        assert!((at(9000.0, 9000.0) - 500.0).abs() < 1.0 && (at(3900.0, 5200.0) - 500.0).abs() < 1.0);
    }
}

#[test]
fn tiles_of_two_lattices_are_joined_each_with_its_own() {
    let folder = Folder::new("terrain-lattices");
    let [far, near] = coarse_and_fine(&folder);
    // The fine model in two tiles that share a column.
    let text = fs::read_to_string(&near).expect("written");
    let header: Vec<&str> = text.lines().take_while(|line| line.starts_with(|c: char| c.is_alphabetic())).collect();
    let rows: Vec<Vec<&str>> = text.lines().skip(header.len()).map(|line| line.split_whitespace().collect()).collect();
    let request = TerrainRequest { source_crs: Some(32631), ..Default::default() };
    let tile = |name: &str, from: usize, to: usize| {
        let path = folder.0.join(name);
        let height = |c: usize, r: usize| rows[r][from + c].parse().expect("a number");
        write_asc(&path, to - from, rows.len(), 5e5 + 4000.0 + 25.0 * from as f64, 5e6 + 4000.0, 25.0, &height);
        path
    };
    let whole = load(&[far.clone(), near], &request).unwrap().0.heightfield;
    let (west, east) = (tile("west.asc", 0, 81), tile("east.asc", 80, 161));
    for order in [[&west, &far, &east], [&east, &west, &far]] {
        let tiled = load(&order.map(Clone::clone), &request).unwrap().0.heightfield;
        let off = tiled.heights().iter().zip(whole.heights()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(tiled.heights().len() == whole.heights().len() && off < 1e-3, "{off}");
    }
}

#[test]
fn tiles_that_a_file_leaves_out_cost_nothing() {
    // 60,000 x 60,000 samples of 20 m in tiles of 512, of which one holds ground.
    let (side, tile, at) = (118usize, 512usize, 37 * 118 + 91);
    let heights: Vec<u8> = (0..tile * tile).flat_map(|i| (300 + (i % tile) as i16 / 4).to_le_bytes()).collect();
    let degrees = |v: f64| v.to_bits();
    let mut entries = vec![
        (256, 4, vec![60_000]),
        (257, 4, vec![60_000]),
        (258, 3, vec![16]),
        (259, 3, vec![1]),
        (262, 3, vec![1]),
        (277, 3, vec![1]),
        (322, 4, vec![tile as u64]),
        (323, 4, vec![tile as u64]),
        (324, 4, vec![0; side * side]),
        (325, 4, vec![0; side * side]),
        (339, 3, vec![2]),
        (33550, 12, [20.0, 20.0, 0.0].map(degrees).to_vec()),
        (33922, 12, [0.0, 0.0, 0.0, 1e5, 6e6, 0.0].map(degrees).to_vec()),
        (34735, 3, vec![1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32632]),
        (42113, 2, "-32768\0".bytes().map(u64::from).collect()),
    ];
    let body = PLAIN.body_at(&entries) as u64;
    let offsets = entries.iter_mut().find(|e| e.0 == 324).expect("offsets");
    offsets.2[at] = body;
    entries.iter_mut().find(|e| e.0 == 325).expect("counts").2[at] = heights.len() as u64;
    let folder = Folder::new("terrain-sparse");
    let file = folder.0.join("sparse.tif");
    fs::write(&file, PLAIN.file(&entries, &heights, 0)).unwrap();
    let began = Instant::now();
    let (terrain, warnings) = load(&[file], &TerrainRequest::default()).unwrap();
    let h = &terrain.heightfield;
    assert!((h.cols(), h.rows()) == (512, 512) && h.spacing() == DVec2::splat(20.0), "{warnings:?}");
    let north_west = DVec2::new(1e5 + 20.0 * (91.0 * 512.0 + 0.5), 6e6 - 20.0 * (37.0 * 512.0 + 0.5));
    assert_eq!(h.node(100, 7).unwrap(), (north_west + DVec2::new(2000.0, -140.0)).extend(325.0));
    assert_eq!(terrain.void_samples, 0);
    // Reading all of it took minutes.
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
}
