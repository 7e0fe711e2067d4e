//! The keyboard: one table of commands with their keys, which the menus, the help and the keyboard itself use, and steering by keys.

use crate::language::{later, tr};
use crate::model::Model;
use belvedere::core::{DVec3, Navigation};
use eframe::egui::{Context, Event, Id, Key, KeyboardShortcut, Modifiers};

/// A command of the application.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Command {
    Open,
    Save,
    SaveAs,
    Quit,
    Undo,
    Redo,
    Find,
    ShowAll,
    Measure,
    Bookmark,
    Bookmarks,
    Bent,
    Compare,
    Inset,
    Overhead,
    Statistics,
    Panel,
    Help,
    Welcome,
}

/// A command, its words in menus and help, and its keys; the menus show the first.
struct Entry {
    command: Command,
    words: &'static str,
    keys: &'static [KeyboardShortcut],
}

const fn entry(command: Command, words: &'static str, keys: &'static [KeyboardShortcut]) -> Entry {
    Entry { command, words, keys }
}

const fn with(modifiers: Modifiers, key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(modifiers, key)
}

const fn plain(key: Key) -> KeyboardShortcut {
    with(Modifiers::NONE, key)
}

const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// All commands.
const COMMANDS: [Entry; 19] = [
    entry(Command::Open, later("Open…"), &[with(CTRL, Key::O)]),
    entry(Command::Save, later("Save"), &[with(CTRL, Key::S)]),
    entry(Command::SaveAs, later("Save as…"), &[with(CTRL_SHIFT, Key::S)]),
    entry(Command::Quit, later("Quit"), &[with(CTRL, Key::Q)]),
    entry(Command::Undo, later("Undo"), &[with(CTRL, Key::Z)]),
    entry(Command::Redo, later("Redo"), &[with(CTRL_SHIFT, Key::Z), with(CTRL, Key::Y)]),
    entry(Command::Find, later("Find…"), &[with(CTRL, Key::F)]),
    entry(Command::ShowAll, later("Show all"), &[plain(Key::F)]),
    entry(Command::Measure, later("Measure lengths"), &[plain(Key::M)]),
    entry(Command::Bookmark, later("Bookmark this view"), &[plain(Key::B)]),
    entry(Command::Bookmarks, later("Bookmarks…"), &[with(CTRL, Key::B)]),
    entry(Command::Bent, later("Straight or bent"), &[plain(Key::Space)]),
    entry(Command::Compare, later("Compare: one picture, split, flicker"), &[plain(Key::C)]),
    entry(Command::Inset, later("Straight picture in a corner"), &[plain(Key::I)]),
    entry(Command::Overhead, later("Camera from above"), &[plain(Key::O)]),
    entry(Command::Statistics, later("Renderer and times"), &[plain(Key::T)]),
    entry(Command::Panel, later("Panel beside the picture"), &[plain(Key::P)]),
    entry(Command::Help, later("Keys and pointer"), &[plain(Key::F1)]),
    entry(Command::Welcome, later("Welcome and examples"), &[]),
];

/// Keys that steer the camera, and Escape, which ends what is under way.
#[cfg(test)]
const STEERING: [KeyboardShortcut; 12] = [
    plain(Key::ArrowLeft),
    plain(Key::ArrowRight),
    plain(Key::ArrowUp),
    plain(Key::ArrowDown),
    with(Modifiers::SHIFT, Key::ArrowLeft),
    with(Modifiers::SHIFT, Key::ArrowRight),
    with(Modifiers::SHIFT, Key::ArrowUp),
    with(Modifiers::SHIFT, Key::ArrowDown),
    plain(Key::Plus),
    plain(Key::Equals),
    plain(Key::Minus),
    plain(Key::Escape),
];

/// What pointer, fingers and steering keys do.
const GESTURES: [(&str, &str); 7] = [
    (later("Drag, arrow keys"), later("move over the ground (tool Orbit: turn)")),
    (later("Right drag, Shift + arrow keys"), later("turn and tilt")),
    (later("Wheel, + and -"), later("nearer and farther")),
    (later("Two fingers"), later("nearer and farther, turn; up or down together: tilt")),
    (later("Right click, long press"), later("menu of the place")),
    (later("Escape, double click"), later("end of a measurement")),
    (later("Tab, Enter"), later("next control, press it")),
];

/// Words of a command in the user's language.
pub(crate) fn words(command: Command) -> &'static str {
    COMMANDS.iter().find(|entry| entry.command == command).map_or("", |entry| tr(entry.words))
}

/// The keys of a command as the system writes them; empty without keys.
pub(crate) fn shortcut(ctx: &Context, command: Command) -> String {
    let keys = COMMANDS.iter().find(|entry| entry.command == command).and_then(|entry| entry.keys.first());
    keys.map_or_else(String::new, |keys| ctx.format_shortcut(keys))
}

/// Rows of the help: keys, and what they do.
pub(crate) fn help(ctx: &Context) -> Vec<(String, &'static str)> {
    let gestures = GESTURES.iter().map(|(keys, what)| (tr(keys).to_owned(), tr(what)));
    let with_keys = COMMANDS.iter().filter(|entry| !entry.keys.is_empty());
    let commands = with_keys.map(|entry| {
        let keys: Vec<String> = entry.keys.iter().map(|keys| ctx.format_shortcut(keys)).collect();
        (keys.join(", "), tr(entry.words))
    });
    gestures.chain(commands).collect()
}

/// Whether a shortcut is no letter that may be meant for a control.
fn is_always_heard(keys: &KeyboardShortcut) -> bool {
    keys.modifiers.command || keys.logical_key == Key::F1
}

/// Steps of the arrow keys as a share of the distance to the target; angle of a turn, radians; factor of a zoom.
const STEP: f64 = 0.06;
const TURN: f64 = 0.06;
const ZOOM: f64 = 1.15;

/// Reads the keyboard, unless something is being typed.
pub(crate) fn read(ctx: &Context, model: &mut Model) -> Option<Command> {
    // A control that has the focus uses the arrow keys, letters and the space bar itself.
    let is_free = !ctx.egui_wants_keyboard_input() && ctx.memory(|memory| memory.focused().is_none());
    if is_free {
        steer(ctx, model);
    }
    let all = COMMANDS.iter().flat_map(|entry| entry.keys.iter().map(|keys| (keys, entry.command)));
    let mut heard: Vec<_> = all.filter(|(keys, _)| is_free || is_always_heard(keys)).collect();
    // Keys without Shift are found with it, too, so those with it come first.
    heard.sort_by_key(|(keys, _)| !keys.modifiers.shift);
    heard.into_iter().find(|(keys, _)| ctx.input_mut(|input| input.consume_shortcut(keys))).map(|(_, command)| command)
}

fn steer(ctx: &Context, model: &mut Model) {
    let (mut moved, mut turned, mut zoom) = ([0.0f64; 2], [0.0f64; 2], 1.0);
    let is_repeated = ctx.input(|input| {
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
        !input.events.iter().any(|event| matches!(event, Event::Key { pressed: true, repeat: false, .. }))
    });
    if moved == [0.0; 2] && turned == [0.0; 2] && zoom == 1.0 {
        return;
    }
    // A key that is held is one gesture.
    if !is_repeated {
        model.begin_gesture();
    }
    model.move_camera(Id::unique("keys"), |camera: &Navigation| {
        let reach = STEP * camera.target.distance(camera.pinhole.eye);
        let ahead = camera.pinhole.forward.truncate().extend(0.0);
        let ahead = if ahead.length() > 0.05 { ahead.normalize() } else { -camera.pinhole.down };
        let by: DVec3 = reach * (moved[0] * camera.pinhole.right + moved[1] * ahead);
        camera.moved(by)?.orbited(TURN * turned[0], TURN * turned[1])?.zoomed(camera.target + by, zoom)
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_has_two_meanings_and_no_command_two_rows() {
        let mut keys: Vec<KeyboardShortcut> =
            COMMANDS.iter().flat_map(|entry| entry.keys).copied().chain(STEERING).collect();
        let all = keys.len();
        keys.sort_by_key(|keys| format!("{keys:?}"));
        keys.dedup();
        assert_eq!(keys.len(), all, "a key is there twice");
        for entry in &COMMANDS {
            assert_eq!(
                COMMANDS.iter().filter(|other| other.command == entry.command).count(),
                1,
                "{:?}",
                entry.command
            );
            assert_eq!(COMMANDS.iter().filter(|other| other.words == entry.words).count(), 1, "{}", entry.words);
        }
    }
}
