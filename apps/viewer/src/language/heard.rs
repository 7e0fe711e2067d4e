//! Words that come from the engine and are no errors: names of steps, kinds of layers, what the work is at.

use super::{fill, later, translated};

/// The texts that tables may hold. `{0}` and `{1}` stand for names.
const HEARD: &[&str] = &[
    later("moved the camera"),
    later("moved the eye"),
    later("turned the camera"),
    later("changed the field of view"),
    later("changed the size of the picture"),
    later("changed the title"),
    later("changed the light"),
    later("changed the marks"),
    later("changed the fonts"),
    later("changed the stylisation"),
    later("changed the representations"),
    later("changed the animation"),
    later("changed the scene"),
    later("changed the layers"),
    later("changed the order of the layers"),
    later("bent rays by hand"),
    later("moved along the path"),
    later("looked along a path"),
    later("chose what stays in sight"),
    later("looked into what is hidden"),
    later("added ground that makes way"),
    later("removed ground that makes way"),
    later("changed the ground that makes way"),
    later("added spline"),
    later("removed spline"),
    later("changed the spline"),
    later("added strip"),
    later("removed strip"),
    later("changed the strip"),
    later("changed the relief"),
    later("changed the bend"),
    later("added curved rays"),
    later("removed curved rays"),
    later("added a turn"),
    later("removed a turn"),
    later("changed a turn"),
    later("hid {0}"),
    later("showed {0}"),
    later("renamed {0} to {1}"),
    later("added {0} layers, removed {1}"),
    later("removed {0}"),
    later("added {0}"),
    later("{0} must be seen"),
    later("{0} need not be seen"),
    later("changed the style of {0}"),
    later("terrain"),
    later("line"),
    later("area"),
    later("point"),
    later("boxes"),
    later("mesh"),
    later("city"),
    later("molecule"),
    later("volume"),
    later("repaired"),
    later("ignored"),
    later("assumed"),
    later("reduced"),
    later("inexact"),
    later("suspect"),
    later("limited"),
    later("hidden"),
    later("moved"),
    later("fallback"),
    later("the ground makes way when the view rests"),
    later("rays are bent when the view rests"),
    later("a map in front, a horizon behind"),
    later("a close view in front, a map of what lies ahead"),
    later("a map between a close view and a horizon"),
    later("a close view between two maps"),
    later("a plane seen under 80 degrees"),
    later("the ordinary perspective"),
    later("degressive, progressive, map by viewing angle, turning evenly, with levels of abstraction"),
    later("the same with a parallel projection at the steep end"),
    later("ambient occlusion"),
    later("bending the picture"),
    later("bending rays around what hides the target"),
    later("draping"),
    later("draw"),
    later("filling voids"),
    later("greedy and smooth pass"),
    later("greedy pass"),
    later("improving the best ways"),
    later("keeping the eye above the ground"),
    later("lines of sight, bent"),
    later("lines of sight, straight"),
    later("looking for ways round what hides"),
    later("looking from all around"),
    later("making the film"),
    later("placing terrain"),
    later("planning how the target stays in sight"),
    later("prepare"),
    later("preparing lines of sight"),
    later("quadratic program"),
    later("quadratic program on a finer grid"),
    later("reading"),
    later("reading cities"),
    later("reading features"),
    later("reading meshes"),
    later("reading molecules"),
    later("reading raster"),
    later("reading terrain"),
    later("reading volumes"),
    later("refining the picture"),
    later("resampling terrain"),
    later("smooth pass"),
    later("what stays hidden"),
    later("what the displaced ground hides"),
    later("writing"),
];

/// A text of the engine in the user's language, as it is where no table knows it.
pub(crate) fn heard(text: &str) -> String {
    if let Some(first) = text.strip_suffix(", and more") {
        return fill(super::tr("{0}, and more"), &[&heard(first)]);
    }
    if let Some(words) = translated(text) {
        return words.to_owned();
    }
    let of = |pattern: &&str| Some((translated(pattern)?, names(pattern, text)?));
    match HEARD.iter().find_map(of) {
        Some((pattern, [first, second])) => fill(pattern, &[&first, &second]),
        None => text.to_owned(),
    }
}

/// The names in a text that stand at the places of a pattern.
fn names<'a>(pattern: &str, text: &'a str) -> Option<[&'a str; 2]> {
    let (start, rest) = pattern.split_once("{0}")?;
    let text = text.strip_prefix(start)?;
    match rest.split_once("{1}") {
        Some((between, end)) => {
            let (first, second) = text.strip_suffix(end)?.split_once(between)?;
            Some([first, second])
        }
        None => Some([text.strip_suffix(rest)?, ""]),
    }
}
