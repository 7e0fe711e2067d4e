//! The keyboard: everything that the pointer can do to the camera, and the commands of the menu.

use crate::language::later;
use crate::model::{Compare, Model};
use belvedere::core::{DVec3, Navigation};
use eframe::egui::{Context, Key, Modifiers};

/// A command of the application.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Command {
    Open,
    Save,
    SaveAs,
    Undo,
    Redo,
    Bookmark,
    ShowAll,
    Help,
}

/// Keys and what they do, for the help window.
pub(crate) const KEYS: [(&str, &str); 15] = [
    (later("Drag, arrow keys"), later("move over the ground (tool Orbit: turn)")),
    (later("Right drag, Shift + arrow keys"), later("turn and tilt")),
    (later("Wheel, pinch, + and -"), later("nearer and farther")),
    (later("Space"), later("straight or bent")),
    ("C", later("compare: one picture, split, flicker")),
    ("I", later("straight picture in a corner")),
    ("O", later("camera from above")),
    ("F", later("show all")),
    ("B", later("bookmark")),
    ("T", later("renderer and times")),
    ("P", later("panel beside the picture")),
    (later("Ctrl O, Ctrl S, Ctrl Shift S"), later("open, save, save as")),
    (later("Ctrl Z, Ctrl Shift Z or Ctrl Y"), later("undo, redo")),
    (later("Tab, Enter"), later("next control, press it")),
    ("F1", later("this help")),
];

/// Steps of the arrow keys as a share of the distance to the target; angle of a turn, radians; factor of a zoom.
const STEP: f64 = 0.06;
const TURN: f64 = 0.06;
const ZOOM: f64 = 1.15;

/// Reads the keyboard, unless something is being typed.
pub(crate) fn read(ctx: &Context, model: &mut Model) -> Option<Command> {
    let with = |modifiers: Modifiers, key: Key| ctx.input_mut(|input| input.consume_key(modifiers, key));
    let shift = Modifiers::COMMAND | Modifiers::SHIFT;
    let commands = [
        (shift, Key::Z, Command::Redo),
        (shift, Key::S, Command::SaveAs),
        (Modifiers::COMMAND, Key::Z, Command::Undo),
        (Modifiers::COMMAND, Key::Y, Command::Redo),
        (Modifiers::COMMAND, Key::S, Command::Save),
        (Modifiers::COMMAND, Key::O, Command::Open),
        (Modifiers::NONE, Key::F1, Command::Help),
    ];
    if let Some((.., command)) = commands.into_iter().find(|(modifiers, key, _)| with(*modifiers, *key)) {
        return Some(command);
    }
    // A control that has the focus uses the arrow keys and the space bar itself.
    if ctx.egui_wants_keyboard_input() || ctx.memory(|memory| memory.focused().is_some()) {
        return None;
    }
    steer(ctx, model);
    let pressed = |key: Key| with(Modifiers::NONE, key);
    let look = &mut model.look;
    if pressed(Key::Space) {
        look.bent = !look.bent;
    }
    if pressed(Key::C) {
        look.compare = match look.compare {
            Compare::Off => Compare::Split,
            Compare::Split => Compare::Flicker,
            Compare::Flicker => Compare::Off,
        };
    }
    look.inset ^= pressed(Key::I);
    look.overhead ^= pressed(Key::O);
    look.statistics ^= pressed(Key::T);
    look.panel ^= pressed(Key::P);
    if pressed(Key::F) {
        return Some(Command::ShowAll);
    }
    pressed(Key::B).then_some(Command::Bookmark)
}

fn steer(ctx: &Context, model: &mut Model) {
    let (mut moved, mut turned, mut zoom) = ([0.0f64; 2], [0.0f64; 2], 1.0);
    ctx.input(|input| {
        let arrows = [
            (Key::ArrowLeft, [-1.0, 0.0]),
            (Key::ArrowRight, [1.0, 0.0]),
            (Key::ArrowUp, [0.0, 1.0]),
            (Key::ArrowDown, [0.0, -1.0]),
        ];
        for (_, [x, y]) in arrows.into_iter().filter(|(key, _)| input.key_pressed(*key)) {
            let to = if input.modifiers.shift { &mut turned } else { &mut moved };
            (to[0], to[1]) = (to[0] + x, to[1] + y);
        }
        if input.key_pressed(Key::Plus) || input.key_pressed(Key::Equals) {
            zoom *= ZOOM;
        }
        if input.key_pressed(Key::Minus) {
            zoom /= ZOOM;
        }
    });
    if moved == [0.0; 2] && turned == [0.0; 2] && zoom == 1.0 {
        return;
    }
    model.begin_gesture();
    model.move_camera(|camera: &Navigation| {
        let reach = STEP * camera.target.distance(camera.pinhole.eye);
        let ahead = camera.pinhole.forward.truncate().extend(0.0);
        let ahead = if ahead.length() > 0.05 { ahead.normalize() } else { -camera.pinhole.down };
        let by: DVec3 = reach * (moved[0] * camera.pinhole.right + moved[1] * ahead);
        camera.moved(by)?.orbited(TURN * turned[0], TURN * turned[1])?.zoomed(camera.target + by, zoom)
    });
}
