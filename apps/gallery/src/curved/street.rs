//! A street corner: vehicles in the side streets come into sight.

use super::town::{BUS, CAR, CROSSING, LORRY, NEXT_CROSSING, TRAM, ahead_and_right, both_sides, town, town_for, turn};
use crate::easel::{Easel, bent, pixels_of, straight};
use crate::figure_set::{Facts, Figure};
use crate::sheet::Panel;
use anyhow::Result;
use belvedere::core::map::curved_rays::Model;
use belvedere::{CameraPicture, Session};

pub(super) const TILE: [u32; 2] = [480, 480];

pub(super) const TURNS: [(&str, f64, f64, &str); 3] = [
    ("To the left", CROSSING, -1.0, BUS),
    ("To the right", CROSSING, 1.0, CAR),
    ("Forward, then to the right", NEXT_CROSSING, 1.0, LORRY),
];

/// A picture whose caption counts the pixels of the vehicles that it should show; also returns their sum.
fn picture(easel: &Easel<'_>, session: &Session, title: &str, wanted: &[&str]) -> Result<(Panel, f64)> {
    let frame = easel.draw(session)?;
    let counts: Vec<usize> = wanted.iter().map(|id| pixels_of(&frame, session, id)).collect();
    let said: Vec<String> = wanted.iter().zip(&counts).map(|(id, n)| format!("{id}: {n} pixels")).collect();
    let pixels: usize = counts.iter().sum();
    let note = if pixels == 0 { "neither bus, car nor lorry in sight".into() } else { said.join(", ") };
    Ok((Panel { title: title.into(), note, frame }, pixels as f64))
}

/// Straight, to the left, to the right, forward and then to the right.
pub(super) fn corners(easel: &Easel<'_>) -> Result<Figure> {
    let town = town(easel, TILE)?;
    let (first, pixels) = picture(easel, &straight(&town), "Straight rays", &[BUS, CAR, LORRY])?;
    let (mut panels, mut seen) = (vec![first], vec![pixels]);
    for (title, crossing, side, vehicle) in TURNS {
        let session = bent(&town_for(easel, TILE, crossing)?, Model::Modified, &[turn(crossing, side)])?;
        let (panel, pixels) = picture(easel, &session, title, &[vehicle])?;
        panels.push(panel);
        seen.push(pixels);
    }
    let both = both_sides(&town)?;
    let (panel, pixels) = picture(easel, &both, "Both side streets", &[BUS, CAR])?;
    panels.push(panel);
    seen.push(pixels);
    panels.push(easel.camera(&both, CameraPicture::Overhead, "Their rays", "from above".into())?);
    Ok(Figure { panels, columns: 3, seen, ..Figure::default() })
}

/// The avenue ahead and the street to the right in one picture.
pub(super) fn ahead_and_aside(easel: &Easel<'_>) -> Result<Figure> {
    let town = town(easel, TILE)?;
    let session = ahead_and_right(&town)?;
    let (before, _) = picture(easel, &straight(&town), "Straight rays", &[TRAM])?;
    let (after, _) = picture(easel, &session, "Forward and right together", &[TRAM, CAR])?;
    let mut facts = Facts::new();
    for (name, panel, id) in [
        ("straight: tram, pixels", &before, TRAM),
        ("straight: car, pixels", &before, CAR),
        ("together: tram, pixels", &after, TRAM),
        ("together: car, pixels", &after, CAR),
    ] {
        facts.insert(name, pixels_of(&panel.frame, &session, id) as f64);
    }
    let rays = easel.camera(&session, CameraPicture::Overhead, "Their rays", "from above".into())?;
    Ok(Figure { panels: vec![before, after, rays], columns: 3, facts, ..Figure::default() })
}
