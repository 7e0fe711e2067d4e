//! Meaning of the samples: colours, alpha, no-data value, scale and offset.

use super::geokeys::{FOOT_M, US_FOOT_M};
use super::ifd::{Container, Ifd, tag};
use super::layout::Layout;
use crate::raster::{Alpha, Photometric, RasterInfo};
use belvedere_core::{Warning, WarningKind};

/// Fills colours, alpha, no data and scaling of `info`; returns warnings.
pub(super) fn meaning(
    container: &Container,
    ifd: &Ifd,
    layout: &Layout,
    info: &mut RasterInfo,
) -> Result<Vec<Warning>, String> {
    let mut warnings = Vec::new();
    let extra = container.uints(ifd, tag::EXTRA_SAMPLES)?.unwrap_or_default();
    let first_extra = info.bands.saturating_sub(extra.len());
    info.alpha = extra
        .iter()
        .enumerate()
        .find_map(|(i, &kind)| match kind {
            1 => Some(Alpha::Premultiplied(first_extra + i)),
            2 => Some(Alpha::Straight(first_extra + i)),
            _ => None,
        })
        .unwrap_or_default();
    info.photometric = match layout.photometric {
        0 => Photometric::GrayInverted,
        2 | 6 if info.bands >= 3 => Photometric::Rgb([0, 1, 2]),
        2 | 6 => {
            let text = format!("is said to be RGB but has {} bands; shown as grey", info.bands);
            warnings.push(Warning::new(WarningKind::Repaired, text).with("bands", info.bands as f64));
            Photometric::Gray
        }
        3 => Photometric::Palette(palette(container, ifd, layout)?),
        _ => Photometric::Gray,
    };
    if let Some(text) = container.text(ifd, tag::GDAL_NODATA)? {
        match text.trim().parse::<f64>() {
            Ok(value) => info.nodata = Some(value),
            Err(_) if text.trim().is_empty() => {}
            Err(_) => {
                let text = format!("no-data value \"{}\" is not a number; it is ignored", text.trim());
                warnings.push(Warning::new(WarningKind::Ignored, text));
            }
        }
    }
    if let Some(xml) = container.text(ifd, tag::GDAL_METADATA)? {
        gdal_metadata(&xml, info, &mut warnings);
    }
    Ok(warnings)
}

fn palette(container: &Container, ifd: &Ifd, layout: &Layout) -> Result<Vec<[u8; 3]>, String> {
    let map = container.uints(ifd, tag::COLOR_MAP)?.ok_or("is paletted but has no colour map")?;
    let colors = 1usize << layout.stored.bits().min(16);
    if map.len() < 3 * colors {
        return Err(format!("its colour map has {} values, {} are needed", map.len(), 3 * colors));
    }
    // Colours have 16 bits by the specification, but some writers store 8.
    let shift = if map.iter().all(|&v| v < 256) { 0 } else { 8 };
    let (red, rest) = map.split_at(colors);
    let (green, blue) = rest.split_at(colors);
    let byte = |v: u64| (v >> shift) as u8;
    Ok(red.iter().zip(green).zip(blue).map(|((&r, &g), &b)| [byte(r), byte(g), byte(b)]).collect())
}

/// Scale, offset, unit and colours as GDAL writes them.
fn gdal_metadata(xml: &str, info: &mut RasterInfo, warnings: &mut Vec<Warning>) {
    let mut scaling = vec![[1.0, 0.0]; info.bands];
    let mut colors = [None; 3];
    for item in xml.split("<Item ").skip(1) {
        let Some((head, rest)) = item.split_once('>') else { continue };
        let Some((text, _)) = rest.split_once("</Item>") else { continue };
        let band = attribute(head, "sample").and_then(|v| v.parse::<usize>().ok()).unwrap_or(0);
        let text = text.trim();
        match attribute(head, "role") {
            Some(role @ ("scale" | "offset")) => {
                let slot_index = usize::from(role == "offset");
                if let (Some(slot), Ok(value)) = (scaling.get_mut(band), text.parse::<f64>())
                    && value.is_finite()
                {
                    slot[slot_index] = value;
                }
            }
            Some("unittype") if band == 0 => match text.to_ascii_lowercase().as_str() {
                "ft" | "foot" | "feet" => (info.vertical_unit_m, info.vertical_unit_said) = (FOOT_M, true),
                "us-ft" | "ft_us" | "us survey foot" => {
                    (info.vertical_unit_m, info.vertical_unit_said) = (US_FOOT_M, true);
                }
                "" => {}
                "m" | "metre" | "meter" | "metres" | "meters" => info.vertical_unit_said = true,
                other => {
                    let text = format!("unit of the values is \"{other}\"; metres are assumed");
                    warnings.push(Warning::new(WarningKind::Assumed, text));
                }
            },
            Some("colorinterp") => {
                if let Some(k) = ["Red", "Green", "Blue"].iter().position(|&name| name == text) {
                    colors[k] = Some(band);
                }
            }
            _ => {}
        }
    }
    if scaling.iter().any(|s| *s != [1.0, 0.0]) {
        info.scaling = scaling;
    }
    if let [Some(r), Some(g), Some(b)] = colors
        && [r, g, b].iter().all(|&band| band < info.bands)
        && !matches!(info.photometric, Photometric::Palette(_))
    {
        info.photometric = Photometric::Rgb([r, g, b]);
    }
}

fn attribute<'a>(head: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = head.split_once(&format!("{name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}
