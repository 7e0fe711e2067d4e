//! Pictures without a background: drawn before white and before black, whose difference is what shows through.

use super::options::PictureOptions;
use crate::scene_file::LightDoc;
use crate::{Advice, BelvedereError, Session};
use belvedere_scene::{Color, Frame, Light, Sky};

/// The session before white and before black, where its sky is transparent.
///
/// # Errors
/// [`BelvedereError::Argument`] for a pair of pictures.
pub(super) fn backgrounds(session: &Session, request: &PictureOptions) -> Result<Option<[Session; 2]>, BelvedereError> {
    if session.light().sky != Sky::Transparent {
        return Ok(None);
    }
    if request.compare {
        let sky = format!(" or the sky \"{}\"", LightDoc::TRANSPARENT);
        let advice =
            Advice::new("{}: a pair of pictures has a background; leave out {}", &["sky", "compare"]).then(sky);
        return Err(BelvedereError::Argument(advice));
    }
    Ok(Some([255, 0].map(|shade| {
        let light = Light { sky: Sky::Plain(Color::rgb(shade, shade, shade)), ..*session.light() };
        session.clone().with_light(light)
    })))
}

/// Makes a picture before white that of what covers it, and gives the alpha of every pixel.
pub(super) fn uncover(white: &mut Frame, black: &Frame) -> Vec<u8> {
    let mut alpha = Vec::with_capacity(white.color.len());
    for (color, dark) in white.color.iter_mut().zip(&black.color) {
        let through = [0, 1, 2].map(|k| u32::from(color[k].saturating_sub(dark[k])));
        let cover = 255 - through.iter().sum::<u32>().div_euclid(3).min(255);
        *color = dark.map(|v| (u32::from(v) * 255 + cover / 2).checked_div(cover).unwrap_or(0).min(255) as u8);
        alpha.push(cover as u8);
    }
    alpha
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_over_any_background_are_those_that_were_drawn() {
        // Wholly covered, half, and not at all.
        let over = |color: [u8; 3], alpha: f64, back: f64| {
            color.map(|v| (f64::from(v) * alpha + back * (1.0 - alpha)).round() as u8)
        };
        let kinds = [([10, 200, 90], 1.0), ([10, 200, 90], 0.5), ([0, 0, 0], 0.0)];
        let before = |back: f64| Frame { color: kinds.map(|(c, a)| over(c, a, back)).to_vec(), ..Frame::default() };
        let mut white = before(255.0);
        let alpha = uncover(&mut white, &before(0.0));
        assert_eq!([alpha[0], alpha[2]], [255, 0]);
        for (i, (color, share)) in kinds.into_iter().enumerate() {
            let wanted = over(color, share, 60.0);
            let found = over(white.color[i], f64::from(alpha[i]) / 255.0, 60.0);
            assert!((0..3).all(|k| found[k].abs_diff(wanted[k]) <= 1), "{found:?} for {wanted:?}");
        }
    }
}
