//! Operations as text, for command lines and logs.

use super::{EditError, PresetChange, PresetOperation};
use crate::presets::{BendFrame, DepthUnits, Ease};
use std::str::FromStr;

/// Keys of a preset, for messages.
const KEYS: &str = "point, add-point, remove-point, corner, soften, angles, angle, tag, width, section, split, merge, range, phi, tau, \
fade, fov, mirror, duplicate, name, remove";

/// Keys of the whole document, for messages.
const DOCUMENT_KEYS: &str = "add, frame, units, ease, pin, follow";

impl FromStr for PresetOperation {
    type Err = EditError;

    /// `PRESET.KEY[.NUMBER]=VALUE`, or `KEY=VALUE` for the whole document.
    fn from_str(text: &str) -> Result<Self, EditError> {
        let fail = |reason: String| EditError::Text { text: text.to_owned(), reason };
        let (left, value) = text.split_once('=').map_or((text, None), |(l, v)| (l, Some(v.trim())));
        let left: Vec<&str> = left.split('.').map(str::trim).collect();
        let parse = Value { value };
        match left[..] {
            [key] => parse.document(key),
            [preset, key] => parse.change(key, None).map(|change| Self::Preset { preset: preset.to_owned(), change }),
            [preset, key, number] => number
                .parse()
                .map_err(|_| format!("{number:?} is no number of a point, tag or section"))
                .and_then(|n| parse.change(key, Some(n)))
                .map(|change| Self::Preset { preset: preset.to_owned(), change }),
            _ => Err("it has too many dots".into()),
        }
        .map_err(fail)
    }
}

/// The text after the equals sign.
struct Value<'a> {
    value: Option<&'a str>,
}

impl Value<'_> {
    fn text(&self) -> Result<&str, String> {
        self.value.filter(|v| !v.is_empty()).ok_or_else(|| "a value is missing, as in low.phi=25".into())
    }

    fn one<T: FromStr>(&self) -> Result<T, String> {
        let text = self.text()?;
        text.parse().map_err(|_| format!("{text:?} is not a number or choice that it takes"))
    }

    fn numbers(&self) -> Result<Vec<f64>, String> {
        let number = |t: &str| t.trim().parse::<f64>().map_err(|_| format!("{t:?} is no number"));
        self.text()?.split(',').map(number).collect()
    }

    fn pair(&self) -> Result<[f64; 2], String> {
        let numbers = self.numbers()?;
        numbers.try_into().map_err(|n: Vec<f64>| format!("two numbers are needed, there are {}", n.len()))
    }

    fn document(&self, key: &str) -> Result<PresetOperation, String> {
        let choice = |options: &[&str]| {
            let text = self.text()?;
            options
                .iter()
                .position(|o| *o == text)
                .ok_or_else(|| format!("{text:?} is not one of {}", options.join(", ")))
        };
        Ok(match key {
            "frame" => PresetOperation::Frame([BendFrame::Camera, BendFrame::Plane][choice(&["camera", "plane"])?]),
            "units" => {
                PresetOperation::Units([DepthUnits::Absolute, DepthUnits::Distance][choice(&["absolute", "distance"])?])
            }
            "ease" => PresetOperation::Ease([Ease::Linear, Ease::Smoothstep][choice(&["linear", "smoothstep"])?]),
            "pin" => PresetOperation::Pin(self.one()?),
            "follow" => PresetOperation::Follow(self.one()?),
            "add" => match self.text()?.split(',').map(str::trim).collect::<Vec<_>>()[..] {
                [from, name, phi] => PresetOperation::Add {
                    from: from.to_owned(),
                    name: name.to_owned(),
                    phi: phi.parse().map_err(|_| format!("{phi:?} is no viewing angle"))?,
                },
                _ => return Err("a built-in, a name and a viewing angle are needed".into()),
            },
            _ => {
                return Err(format!(
                    "{key:?} is no key of the document; its keys are {DOCUMENT_KEYS}, those of a preset stand behind its name, as in low.phi=25"
                ));
            }
        })
    }

    fn change(&self, key: &str, number: Option<usize>) -> Result<PresetChange, String> {
        let numbered = || number.ok_or_else(|| format!("{key} needs a number, as in PRESET.{key}.2"));
        let change = match key {
            "point" => PresetChange::MovePoint(numbered()?, self.pair()?),
            "tag" => match self.numbers()?[..] {
                [u] => PresetChange::PlaceTag(numbered()?, u),
                [u, v] => PresetChange::MoveTag(numbered()?, [u, v]),
                ref n => return Err(format!("one or two numbers are needed, there are {}", n.len())),
            },
            "angle" => PresetChange::Turn(numbered()?, self.one()?),
            "width" => PresetChange::TagWidth(numbered()?, self.one()?),
            "section" => PresetChange::Section(numbered()?, self.text()?.to_owned()),
            _ if number.is_some() => return Err(format!("{key:?} takes no number, or is no key; keys are {KEYS}")),
            "add-point" => PresetChange::AddPoint(self.one()?),
            "remove-point" => PresetChange::RemovePoint(self.one()?),
            "corner" => PresetChange::Corner(self.one()?),
            "soften" => PresetChange::Soften(self.one()?),
            "angles" => PresetChange::Angles(self.one()?),
            "split" => PresetChange::Split(self.one()?),
            "merge" => PresetChange::Merge(self.one()?),
            "range" => PresetChange::Range(self.pair()?),
            "phi" => PresetChange::Phi(self.one()?),
            "tau" => PresetChange::Tau(self.one()?),
            "fade" => PresetChange::Fade(self.pair()?),
            "fov" if self.value == Some("none") => PresetChange::FieldOfView(None),
            "fov" => PresetChange::FieldOfView(Some(self.one()?)),
            "name" => PresetChange::Rename(self.text()?.to_owned()),
            "duplicate" => {
                let (name, phi) =
                    self.text()?.rsplit_once(',').ok_or("a name and a viewing angle are needed, as in NAME,35")?;
                let phi = phi.trim().parse().map_err(|_| format!("{phi:?} is no viewing angle"))?;
                PresetChange::Duplicate { name: name.trim().to_owned(), phi }
            }
            "mirror" | "remove" if self.value.is_some() => return Err(format!("{key} takes no value")),
            "mirror" => PresetChange::Mirror,
            "remove" => PresetChange::Remove,
            _ => return Err(format!("{key:?} is no key of a preset; keys are {KEYS}")),
        };
        Ok(change)
    }
}
