//! OpenEXR written, read back by the library's own reader.

use belvedere_io::open_exr::{Channel, write};
use exr::prelude::{AttributeValue, FlatSamples, ReadChannels, ReadLayers, Text, read};

#[test]
fn channels_come_back_with_type_and_bits() {
    let dir = tempfile::tempdir().expect("folder");
    let path = dir.path().join("buffers.exr");
    let depth: Vec<f32> = (0..35).map(|i| if i % 9 == 0 { f32::INFINITY } else { 0.1 + i as f32 * 1234.567 }).collect();
    let id: Vec<u32> = (0..35).map(|i| if i % 4 == 0 { u32::MAX - i } else { i }).collect();
    let x: Vec<f32> = (0..35).map(|i| if i == 3 { f32::NAN } else { -(i as f32) }).collect();
    let channels = vec![
        ("world.X".into(), Channel::Float(x.clone())),
        ("depth.Z".into(), Channel::Float(depth.clone())),
        ("id".into(), Channel::Uint(id.clone())),
    ];
    write(&path, false, 7, 5, channels, &[("worldOrigin", "377000 4700500 0")]).expect("written");
    let image = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let image = image.from_file(&path).expect("read back");
    let layer = &image.layer_data;
    assert_eq!((layer.size.0, layer.size.1), (7, 5));
    let found: Vec<(String, &FlatSamples)> =
        layer.channel_data.list.iter().map(|c| (c.name.to_string(), &c.sample_data)).collect();
    let names: Vec<&str> = found.iter().map(|(n, _)| n.as_str()).collect();
    assert_eq!(names, ["depth.Z", "id", "world.X"]);
    let bits = |v: &[f32]| v.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert!(matches!(found[0].1, FlatSamples::F32(v) if bits(v) == bits(&depth)));
    assert!(matches!(found[1].1, FlatSamples::U32(v) if *v == id));
    assert!(matches!(found[2].1, FlatSamples::F32(v) if bits(v) == bits(&x)));
    let origin = layer.attributes.other.get(&Text::from("worldOrigin"));
    assert_eq!(origin, Some(&AttributeValue::Text(Text::from("377000 4700500 0"))));
    let short = write(&path, true, 7, 5, vec![("id".into(), Channel::Uint(vec![1; 34]))], &[]);
    assert!(short.is_err_and(|e| e.to_string().contains("34 samples")), "a channel of the wrong size is refused");
}
