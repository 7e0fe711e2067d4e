//! Sizes of paper.

/// Shortest and longest side of a sheet, millimetres.
pub const SIDE_MM: [f64; 2] = [10.0, 10_000.0];
/// Sheets of ISO 216, width and height upright, millimetres.
const SHEETS: [[f64; 2]; 7] =
    [[841.0, 1189.0], [594.0, 841.0], [420.0, 594.0], [297.0, 420.0], [210.0, 297.0], [148.0, 210.0], [105.0, 148.0]];

/// Width and height of a sheet in millimetres: `A3`, `A3-portrait`, `A3-landscape`, or `WxHmm`.
///
/// * `shape`: of the picture; a sheet without a direction lies where that is wider than high.
///
/// # Errors
/// What papers there are.
pub fn parse_paper(text: &str, shape: [u32; 2]) -> Result<[f64; 2], String> {
    let lower = text.trim().to_ascii_lowercase();
    if let Some((w, h)) = lower.strip_suffix("mm").and_then(|sides| sides.split_once('x')) {
        let sides = [w, h].map(|side| side.trim().parse::<f64>().ok());
        let [least, most] = SIDE_MM;
        return match sides {
            [Some(w), Some(h)] if [w, h].iter().all(|side| (least..=most).contains(side)) => Ok([w, h]),
            [Some(_), Some(_)] => Err(format!("each side of a paper must be in {least}..={most} mm, found {text:?}")),
            _ => Err(format!("{text:?} is not a paper; give width and height such as 420x297mm")),
        };
    }
    let (name, direction) = lower.split_once('-').map_or((lower.as_str(), None), |(name, way)| (name, Some(way)));
    let number = name.strip_prefix('a').and_then(|digit| digit.parse::<usize>().ok()).filter(|_| name.len() == 2);
    let sheet = number.and_then(|number| SHEETS.get(number));
    let lies = match direction {
        None => Some(shape[0] >= shape[1]),
        Some("landscape") => Some(true),
        Some("portrait") => Some(false),
        Some(_) => None,
    };
    match (sheet, lies) {
        (Some([w, h]), Some(lies)) => Ok(if lies { [*h, *w] } else { [*w, *h] }),
        _ => Err(format!(
            "{text:?} is not a paper; give A0 to A6, A3-portrait, A3-landscape, or a size such as 420x297mm"
        )),
    }
}
