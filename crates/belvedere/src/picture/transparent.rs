//! Pictures without a background: drawn before white and before black, whose difference is what shows through.

use super::draw::{Drawn, draw_view};
use super::options::PictureOptions;
use crate::scene_file::LightDoc;
use crate::{BelvedereError, Session};
use belvedere_scene::{Color, Light, Progress, Sky};

/// Whether the sky of a session shows what is laid behind the picture.
pub(super) fn is_asked(session: &Session) -> bool {
    session.light().sky == Sky::Transparent
}

/// The picture before white, its colours those of what covers it, and the alpha of every pixel.
pub(super) fn draw(
    session: &Session,
    request: &PictureOptions,
    progress: &Progress,
) -> Result<(Drawn, Vec<u8>), BelvedereError> {
    if request.compare {
        let (option, reason) = (
            "sky",
            format!(
                "a pair of pictures has a background; leave out --compare or the sky \"{}\"",
                LightDoc::TRANSPARENT
            ),
        );
        return Err(BelvedereError::Appearance { option, reason });
    }
    let before = |shade: u8| {
        let light = Light { sky: Sky::Plain(Color::rgb(shade, shade, shade)), ..*session.light() };
        draw_view(&session.clone().with_light(light), request, progress)
    };
    let (mut white, black) = (before(255)?, before(0)?);
    let mut alpha = Vec::with_capacity(white.frame.color.len());
    for (color, dark) in white.frame.color.iter_mut().zip(&black.frame.color) {
        let through = [0, 1, 2].map(|k| u32::from(color[k].saturating_sub(dark[k])));
        let cover = 255 - through.iter().sum::<u32>().div_euclid(3).min(255);
        *color = dark.map(|v| (u32::from(v) * 255 + cover / 2).checked_div(cover).unwrap_or(0).min(255) as u8);
        alpha.push(cover as u8);
    }
    Ok((white, alpha))
}
