//! Path data of SVG as rings of vertices.

use glam::DVec2;
use std::f64::consts::{PI, TAU};

/// Pieces that a curve becomes.
const PIECES: u32 = 16;

/// Numbers parted by blanks, commas or their signs.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let mut rest = Scanner { text };
    let mut out = Vec::new();
    while !rest.is_done() {
        out.push(rest.number()?);
    }
    Ok(out)
}

struct Scanner<'a> {
    text: &'a str,
}

impl Scanner<'_> {
    fn skip(&mut self) {
        self.text = self.text.trim_start_matches(|c: char| c.is_ascii_whitespace() || c == ',');
    }

    fn is_done(&mut self) -> bool {
        self.skip();
        self.text.is_empty()
    }

    fn command(&mut self) -> Option<char> {
        self.skip();
        let first = self.text.chars().next().filter(|c| c.is_alphabetic())?;
        self.text = &self.text[first.len_utf8()..];
        Some(first)
    }

    fn number(&mut self) -> Result<f64, String> {
        self.skip();
        let (mut end, mut dot, mut power) = (0, false, false);
        for (i, c) in self.text.char_indices() {
            let before = self.text[..i].chars().next_back();
            let fits = match c {
                '0'..='9' => true,
                '+' | '-' => i == 0 || matches!(before, Some('e' | 'E')),
                '.' if !dot && !power => {
                    dot = true;
                    true
                }
                'e' | 'E' if !power && i > 0 => {
                    power = true;
                    true
                }
                _ => false,
            };
            if !fits {
                break;
            }
            end = i + c.len_utf8();
        }
        let (number, rest) = self.text.split_at(end);
        let value: Option<f64> = number.parse().ok().filter(|value: &f64| value.is_finite());
        let shown: String = self.text.chars().take(12).collect();
        self.text = rest;
        value.ok_or_else(|| format!("a number is wanted before \"{shown}\"; write the path anew"))
    }

    fn flag(&mut self) -> Result<bool, String> {
        self.skip();
        // Flags may stand without blanks between them.
        match self.text.as_bytes().first() {
            Some(flag @ (b'0' | b'1')) => {
                self.text = &self.text[1..];
                Ok(*flag == b'1')
            }
            _ => Err("the flags of an arc are 0 or 1; write the path anew".into()),
        }
    }

    fn point(&mut self, from: DVec2) -> Result<DVec2, String> {
        Ok(from + DVec2::new(self.number()?, self.number()?))
    }
}

/// The rings of path data, each closed implicitly.
pub(super) fn rings(data: &str) -> Result<Vec<Vec<DVec2>>, String> {
    let mut pen = Pen { rest: Scanner { text: data }, at: DVec2::ZERO, handles: [None; 2] };
    let mut out: Vec<Vec<DVec2>> = Vec::new();
    let (mut start, mut command) = (DVec2::ZERO, None);
    while !pen.rest.is_done() {
        command = match pen.rest.command() {
            Some(given) => Some(given),
            // Further pairs of a move are lines.
            None => command.map(|c| match c {
                'M' => 'L',
                'm' => 'l',
                c => c,
            }),
        };
        let Some(c) = command.filter(|c| out.last().is_some() || matches!(c, 'M' | 'm')) else {
            return Err("the path does not begin with M; write it anew".into());
        };
        let line = pen.drawn(c, start)?;
        match c {
            'M' | 'm' => start = pen.at,
            // What follows without a move begins where the ring began.
            'Z' | 'z' => command = None,
            _ => {
                out.last_mut().into_iter().for_each(|ring| ring.extend(&line));
                continue;
            }
        }
        out.push(line);
    }
    // Moves that nothing follows.
    out.retain(|ring| ring.len() >= 2);
    Ok(out)
}

/// Path data as it is read.
struct Pen<'a> {
    rest: Scanner<'a>,
    at: DVec2,
    /// Handle of the curve before, which smooth curves mirror: of cubic and of quadratic ones.
    handles: [Option<DVec2>; 2],
}

impl Pen<'_> {
    /// What a command adds, which ends where the pen is after it.
    ///
    /// * `start`: of the ring.
    fn drawn(&mut self, command: char, start: DVec2) -> Result<Vec<DVec2>, String> {
        let (at, rest) = (self.at, &mut self.rest);
        let from = if command.is_ascii_lowercase() { at } else { DVec2::ZERO };
        let mirrored = self.handles.map(|handle| handle.map_or(at, |handle| 2.0 * at - handle));
        self.handles = [None; 2];
        let line: Vec<DVec2> = match command.to_ascii_uppercase() {
            'M' | 'L' => vec![rest.point(from)?],
            'Z' => vec![start],
            'H' => vec![DVec2::new(from.x + rest.number()?, at.y)],
            'V' => vec![DVec2::new(at.x, from.y + rest.number()?)],
            c @ ('C' | 'S') => {
                let a = if c == 'C' { rest.point(from)? } else { mirrored[0] };
                let (b, end) = (rest.point(from)?, rest.point(from)?);
                self.handles[0] = Some(b);
                let at_share = |t: f64| {
                    let u = 1.0 - t;
                    u * u * u * at + 3.0 * u * u * t * a + 3.0 * u * t * t * b + t * t * t * end
                };
                pieces().map(at_share).collect()
            }
            c @ ('Q' | 'T') => {
                let a = if c == 'Q' { rest.point(from)? } else { mirrored[1] };
                let end = rest.point(from)?;
                self.handles[1] = Some(a);
                let at_share = |t: f64| (1.0 - t) * (1.0 - t) * at + 2.0 * (1.0 - t) * t * a + t * t * end;
                pieces().map(at_share).collect()
            }
            'A' => {
                let radii = DVec2::new(rest.number()?, rest.number()?);
                let turn = rest.number()?.to_radians();
                let flags = [rest.flag()?, rest.flag()?];
                arc(at, rest.point(from)?, radii.abs(), turn, flags)
            }
            other => return Err(format!("the command {other} of a path is not known; write the path anew")),
        };
        self.at = line.last().copied().unwrap_or(at);
        Ok(line)
    }
}

fn pieces() -> impl Iterator<Item = f64> {
    (1..=PIECES).map(|i| f64::from(i) / f64::from(PIECES))
}

/// An elliptic arc by its ends (SVG 1.1, F.6.5), in steps of at most 5 degrees.
fn arc(from: DVec2, to: DVec2, radii: DVec2, turn: f64, [large, sweep]: [bool; 2]) -> Vec<DVec2> {
    if !(radii.min_element() > 0.0) || from == to {
        return vec![to];
    }
    let axis = DVec2::from_angle(turn);
    // In the frame of the ellipse, radii 1 if it is large enough.
    let half = DVec2::from_angle(-turn).rotate(0.5 * (from - to));
    let radii = radii * (half / radii).length().max(1.0);
    let unit = half / radii;
    let off = (1.0 / unit.length_squared() - 1.0).max(0.0).sqrt() * if large == sweep { -1.0 } else { 1.0 };
    let middle = off * DVec2::new(unit.y, -unit.x);
    let [a, b] = [unit - middle, -unit - middle].map(DVec2::to_angle);
    let mut swept = (b - a).rem_euclid(TAU);
    if !sweep {
        swept -= TAU;
    }
    let steps = (swept.abs() / PI * 36.0).ceil().clamp(1.0, 72.0) as u32;
    let at = |i: u32| {
        let on = middle + DVec2::from_angle(a + swept * f64::from(i) / f64::from(steps));
        0.5 * (from + to) + axis.rotate(radii * on)
    };
    (1..steps).map(at).chain([to]).collect()
}

/// A rectangle with rounded corners.
pub(super) fn rectangle([x, y]: [f64; 2], [w, h]: [f64; 2], radii: [f64; 2]) -> Vec<Vec<DVec2>> {
    let r = DVec2::new(radii[0].clamp(0.0, 0.5 * w.max(0.0)), radii[1].clamp(0.0, 0.5 * h.max(0.0)));
    let corner = |at: [f64; 2], from: f64| {
        let steps = if r.min_element() > 0.0 { 9 } else { 0 };
        let middle = DVec2::new(at[0], at[1]);
        (0..=steps)
            .map(move |i| middle + r * DVec2::from_angle((from + f64::from(i) / f64::from(steps.max(1)) / 4.0) * TAU))
    };
    if r.min_element() <= 0.0 {
        return vec![[[x, y], [x + w, y], [x + w, y + h], [x, y + h]].map(DVec2::from_array).to_vec()];
    }
    let (left, right, top, bottom) = (x + r.x, x + w - r.x, y + r.y, y + h - r.y);
    let corners = [([right, top], 0.75), ([right, bottom], 0.0), ([left, bottom], 0.25), ([left, top], 0.5)];
    vec![corners.into_iter().flat_map(|(at, from)| corner(at, from)).collect()]
}

/// Rings of which those inside an odd number of others run against them, so that they are holes.
pub(super) fn oriented(rings: Vec<Vec<DVec2>>) -> Vec<Vec<DVec2>> {
    let area =
        |ring: &[DVec2]| -> f64 { ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum() };
    let holds = |ring: &[DVec2], p: DVec2| {
        let crossed = ring
            .iter()
            .zip(ring.iter().cycle().skip(1))
            .filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y));
        crossed.count() % 2 == 1
    };
    let depth = |i: usize| {
        let p = rings[i].first().copied().unwrap_or_default();
        rings.iter().enumerate().filter(|(k, ring)| *k != i && holds(ring, p)).count()
    };
    let is_hole: Vec<bool> = (0..rings.len()).map(|i| depth(i) % 2 == 1).collect();
    let turned = |(mut ring, hole): (Vec<DVec2>, bool)| {
        if (area(&ring) > 0.0) == hole {
            ring.reverse();
        }
        ring
    };
    rings.into_iter().zip(is_hole).map(turned).collect()
}
