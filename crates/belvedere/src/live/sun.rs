//! The sun of moving pictures.

use crate::scene_file::LightDoc;
use belvedere_scene::Light;

/// Angle by which the sun of a moving picture may be off, radians: 1 degree, which is 80 to 110 km on the map.
const HELD: f64 = std::f64::consts::PI / 180.0;

/// The sun at a time stands elsewhere at each position of the eye, and another sun casts all shadows of the ground anew. While something
/// moves it stays where it was until it is off by [`HELD`]; a picture at rest has the exact one.
#[derive(Debug, Default)]
pub(super) struct HeldSun(Option<(LightDoc, Light)>);

impl HeldSun {
    /// Notes the light of a picture at rest.
    pub(super) fn rest(&mut self, stated: Option<&LightDoc>, light: Light) {
        self.0 = stated.filter(|doc| doc.time.is_some()).map(|doc| (doc.clone(), light));
    }

    /// The light of a moving picture.
    ///
    /// * `stated`: by the document. `light`: the exact one.
    pub(super) fn moving(&mut self, stated: Option<&LightDoc>, light: Light) -> Light {
        let is_near = |held: &Light| {
            held.shadows == light.shadows
                && (held.altitude > 0.0) == (light.altitude > 0.0)
                && held.direction().angle_between(light.direction()) <= HELD
        };
        match &self.0 {
            Some((doc, held)) if Some(doc) == stated && is_near(held) => *held,
            _ => {
                self.rest(stated, light);
                light
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_at_a_time_stays_until_it_is_off_by_a_degree_and_a_stated_direction_is_exact() {
        let doc = |time: Option<&str>| LightDoc {
            time: time.map(str::to_owned),
            azimuth_deg: None,
            altitude_deg: None,
            shadows: true,
            ..LightDoc::default()
        };
        let sun =
            |degrees: f64| Light { azimuth: degrees.to_radians(), altitude: 0.3, shadows: true, ..Light::default() };
        let timed = doc(Some("2026-08-20T16:20:00Z"));
        let mut held = HeldSun::default();
        held.rest(Some(&timed), sun(250.0));
        assert_eq!(held.moving(Some(&timed), sun(250.6)), sun(250.0));
        assert_eq!(held.moving(Some(&timed), sun(251.4)), sun(251.4), "too far off");
        assert_eq!(held.moving(Some(&timed), sun(250.9)), sun(251.4), "the new one is held");
        let later = doc(Some("2026-08-20T16:25:00Z"));
        assert_eq!(held.moving(Some(&later), sun(251.0)), sun(251.0), "another time");
        let shadowless = Light { shadows: false, ..sun(251.0) };
        assert_eq!(held.moving(Some(&later), shadowless), shadowless);
        let set = [Light { altitude: 0.001, ..sun(280.0) }, Light { altitude: -0.001, ..sun(280.0) }];
        held.rest(Some(&later), set[0]);
        assert_eq!(held.moving(Some(&later), set[1]), set[1], "the sun has set");
        let stated = doc(None);
        held.rest(Some(&stated), sun(10.0));
        assert_eq!(held.moving(Some(&stated), sun(10.1)), sun(10.1), "a direction that the user drags");
    }
}
