use super::*;

#[test]
fn an_affine_map_and_its_inverse() {
    let map = Affine([17.0, 5.0, 100.0, 10.0, -8.0, 200.0]);
    let back = map.inverse().unwrap();
    let [x, y] = map.apply(3.0, -4.0);
    let [c, r] = back.apply(x, y);
    assert!((c - 3.0).abs() < 1e-12 && (r + 4.0).abs() < 1e-12);
    assert_eq!(map.after_scale_and_shift(2.0, 3.0, 0.5, 7.0).apply(1.0, 1.0), map.apply(2.5, 10.0));
    assert_eq!(Affine([1.0, 2.0, 0.0, 2.0, 4.0, 0.0]).inverse(), None);
    assert_eq!(Affine([f64::NAN; 6]).inverse(), None);
}

#[test]
fn absent_samples() {
    let mut info = RasterInfo::new("x", 3, 1, SampleType::U8);
    (info.bands, info.alpha, info.nodata) = (2, Alpha::Straight(1), Some(7.0));
    let samples = Samples::U8(vec![7, 255, 8, 0, 9, 1]);
    let mut raster = Raster { info, samples, mask: None };
    let values = |r: &Raster| [0, 1, 2, 3].map(|c| r.sample_f64(0, c, 0));
    assert_eq!(values(&raster), [None, None, Some(9.0), None]);
    assert_eq!(raster.sample_f64(1, 1, 0), Some(0.0), "alpha itself is there");
    raster.info.scaling = vec![[2.0, 0.5], [1.0, 0.0]];
    assert_eq!(values(&raster)[2], Some(18.5));
    raster.mask = Some(vec![true, true, false]);
    assert_eq!(values(&raster), [None; 4]);
}

#[test]
fn colours_multiplied_by_alpha_are_restored() {
    let mut info = RasterInfo::new("x", 2, 1, SampleType::U8);
    (info.bands, info.alpha) = (4, Alpha::Premultiplied(3));
    info.photometric = Photometric::Rgb([0, 1, 2]);
    let samples = Samples::U8(vec![100, 50, 0, 128, 9, 9, 9, 0]);
    let raster = Raster { info, samples, mask: None };
    assert_eq!(raster.to_rgba().unwrap(), [[199, 100, 0, 128], [9, 9, 9, 0]]);
}

#[test]
fn an_inverted_grey_is_the_negative() {
    let mut info = RasterInfo::new("x", 3, 1, SampleType::U8);
    info.photometric = Photometric::GrayInverted;
    let raster = Raster { info, samples: Samples::U8(vec![0, 100, 255]), mask: None };
    assert_eq!(raster.to_rgba().unwrap(), [[255, 255, 255, 255], [155, 155, 155, 255], [0, 0, 0, 255]]);
}
