//! The light of a document: a direction, or the sun at a time.

use super::color::{Complaint, color};
use super::ground::Ground;
use crate::BelvedereError;
use belvedere_core::DVec3;
use belvedere_core::{Warning, WarningKind};
use belvedere_document::sun::{check_time, days_since_j2000, nearest_day_time, sun_position_deg, written_time};
use belvedere_document::{LightDoc, SourceDocument, SwitchOrVisibility};
use belvedere_scene::{Color, Haze, Light, Sky};

/// Height of the sun from which on a picture by day is proposed, degrees.
const DAY_DEG: f64 = 5.0;

/// The light, and warnings.
pub(crate) fn resolve(
    source: &SourceDocument,
    ground: &Ground<'_>,
    eye: DVec3,
    warnings: &mut Vec<Warning>,
) -> Result<Light, BelvedereError> {
    let default = Light::default();
    let Some(doc) = &source.document.light else { return Ok(default) };
    let light = match &doc.time {
        Some(time) => from_time(source, ground, eye, doc, time, warnings)?,
        None => Light {
            azimuth: doc.azimuth_deg.map_or(default.azimuth, f64::to_radians),
            altitude: doc.altitude_deg.map_or(default.altitude, f64::to_radians),
            shadows: doc.shadows,
            ..default
        },
    };
    let altitude_deg = light.altitude.to_degrees();
    if doc.time.is_none() && !(altitude_deg > 0.0 && altitude_deg <= 90.0) {
        return Err(source
            .error(
                &["light", "altitude_deg"],
                format!("light altitude_deg is {altitude_deg}, it must lie above 0 and up to 90"),
            )
            .into());
    }
    let air = |(key, reason): Complaint| source.error(&["light", key], reason);
    Ok(Light { sky: sky(doc).map_err(air)?, haze: haze(doc).map_err(air)?, clouds: clouds(doc).map_err(air)?, ..light })
}

/// Refuses a sky, haze or clouds that do not exist.
///
/// # Errors
/// [`BelvedereError::Appearance`].
pub fn check_air(doc: &LightDoc) -> Result<(), BelvedereError> {
    let unfit = |(option, reason): Complaint| BelvedereError::Appearance { option, reason };
    sky(doc).map_err(unfit)?;
    haze(doc).map_err(unfit)?;
    clouds(doc).map(|_| ()).map_err(unfit)
}

/// Limits of the visibility, kilometres.
const VISIBILITY_KM: [f64; 2] = [1e-6, 1e6];

/// The sky of a document.
///
/// # Errors
/// The key, and a sentence with the names.
fn sky(doc: &LightDoc) -> Result<Sky, Complaint> {
    let Some(text) = doc.sky.as_deref() else { return Ok(Sky::Auto) };
    match text {
        "auto" => return Ok(Sky::Auto),
        "day" => return Ok(Sky::Day),
        "dusk" => return Ok(Sky::Dusk),
        "night" => return Ok(Sky::Night),
        "white" => return Ok(Sky::Plain(Color::rgb(255, 255, 255))),
        LightDoc::TRANSPARENT => return Ok(Sky::Transparent),
        _ => {}
    }
    let color = color("sky", text).ok().filter(|color| color.a == 255);
    color.map(Sky::Plain).ok_or_else(|| {
        let names = LightDoc::SKIES.join(", ");
        (
            "sky",
            format!(
                "the sky \"{}\" is not known; give {names}, transparent, or a colour such as #ffffff",
                text.chars().take(40).collect::<String>()
            ),
        )
    })
}

/// The haze of a document.
///
/// # Errors
/// The key, and a sentence with the limits.
fn haze(doc: &LightDoc) -> Result<Haze, Complaint> {
    match doc.haze {
        None | Some(SwitchOrVisibility::Switch(true)) => Ok(Haze::Auto),
        Some(SwitchOrVisibility::Switch(false)) => Ok(Haze::None),
        Some(SwitchOrVisibility::Kilometres(km)) => {
            let [least, most] = VISIBILITY_KM;
            let fits = (least..=most).contains(&km);
            fits.then_some(Haze::Visibility(1000.0 * km)).ok_or_else(|| {
                ("haze", format!("haze is {km}, it must be true, false, or a visibility of {least} to {most} km"))
            })
        }
    }
}

/// The clouds of a document.
///
/// # Errors
/// The key, and a sentence with the limits.
fn clouds(doc: &LightDoc) -> Result<f64, Complaint> {
    let share = doc.clouds.unwrap_or(0.0);
    if !(0.0..=1.0).contains(&share) {
        return Err(("clouds", format!("clouds is {share}, it must be a share of the sky, 0..=1")));
    }
    let is_plain = matches!(sky(doc), Ok(Sky::Plain(_) | Sky::Transparent));
    if share > 0.0 && is_plain {
        return Err(("clouds", "clouds need a sky; leave them out, or give the sky auto, day, dusk or night".into()));
    }
    Ok(share)
}

fn from_time(
    source: &SourceDocument,
    ground: &Ground<'_>,
    eye: DVec3,
    doc: &LightDoc,
    time: &str,
    warnings: &mut Vec<Warning>,
) -> Result<Light, BelvedereError> {
    let fail = |reason: String| source.error(&["light", "time"], reason);
    if doc.azimuth_deg.is_some() || doc.altitude_deg.is_some() {
        return Err(
            fail("light has a time and a direction; give either time, or azimuth_deg and altitude_deg".into()).into()
        );
    }
    check_time(time).map_err(fail)?;
    let days = days_since_j2000(time).unwrap_or_default();
    let eye = ground.lon_lat(eye.truncate()).ok_or_else(|| {
        fail("the sun at a time needs a georeferenced scene; set crs, or give azimuth_deg and altitude_deg".into())
    })?;
    let [azimuth_deg, altitude_deg] = sun_position_deg(days, eye.x, eye.y);
    let is_night = altitude_deg <= 0.0;
    if is_night {
        let day = match nearest_day_time(days, [eye.x, eye.y], DAY_DEG) {
            Some(day) => format!("at {} it stands {DAY_DEG} degrees high", written_time(day)),
            None => format!("it does not rise {DAY_DEG} degrees high within a day of that"),
        };
        let text = format!(
            "the sun stands {:.1} degrees below the horizon at {time}, so all ground lies in shadow; {day}",
            -altitude_deg
        );
        warnings.push(Warning::new(WarningKind::Suspect, text).about("light").with("altitude_deg", altitude_deg));
    }
    // Below the horizon all ground lies in the shadow of the earth, whether other shadows are wanted or not.
    let shadows = doc.shadows || is_night;
    Ok(Light { azimuth: azimuth_deg.to_radians(), altitude: altitude_deg.to_radians(), shadows, ..Light::default() })
}
