//! The keyboard.

use super::Action;
use crate::render::NamedView;
use crate::viewer::app::{App, SaveKind};
use egui::{Context, Key, Modifiers, Popup};

/// The keys with what they do, for the help.
pub const KEYS: [(&str, &str); 19] = [
    ("Space", "play or pause"),
    (".", "one step"),
    ("R", "reset: back to the start, without what was thrown, pulled and changed"),
    ("Shift R", "rerun: back to the start, and all of that comes again at its time"),
    ("F", "show everything but what flew or fell far off"),
    ("1 … 9", "look from: three-quarter, front, right, back, left, top, rear, low, high"),
    ("Left, Right", "the recorded moment before, after"),
    ("End", "back to the present"),
    ("T", "throw with the mouse, or turn the camera again"),
    ("Ctrl Z", "take the last throw, removal, pull, change of contact, reset or way back in time back"),
    ("Ctrl Y, Ctrl Shift Z", "do it again"),
    ("Ctrl Shift Y", "do again what had been done there before that"),
    ("Ctrl S", "save the scene"),
    ("W", "edges of the elements"),
    ("C", "cut the bodies open, or close them again"),
    ("X", "stress crosses"),
    ("G", "the scenes, or back from them"),
    ("F1", "this help"),
    ("Esc", "close a list, help, the message or the scenes, stop throwing"),
];

const DIGITS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

/// Reads the keys of this frame; while somebody is typing, F1 alone.
pub fn read(context: &Context, app: &App, actions: &mut Vec<Action>) {
    let is_gallery = app.is_gallery;
    // No field takes it for a letter.
    if context.input_mut(|input| input.consume_key(Modifiers::NONE, Key::F1)) {
        actions.push(Action::ToggleHelp);
    }
    if context.egui_wants_keyboard_input() {
        return;
    }
    let mut on_with = |modifiers: Modifiers, key: Key, action: Action| {
        if context.input_mut(|input| input.consume_key(modifiers, key)) {
            actions.push(action);
        }
    };
    if !is_gallery {
        // The one with more keys first: the other would take it for its own.
        on_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z, Action::Redo);
        on_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::Y, Action::RedoOther);
        on_with(Modifiers::COMMAND, Key::Z, Action::Undo);
        on_with(Modifiers::COMMAND, Key::Y, Action::Redo);
        on_with(Modifiers::SHIFT, Key::R, Action::Again);
        on_with(Modifiers::COMMAND, Key::S, Action::Save(SaveKind::Scene));
    }
    let mut on = |key: Key, action: Action| on_with(Modifiers::NONE, key, action);
    // An open list closes by itself, and nothing else does then. The other keys are for its entries.
    let is_list_open = Popup::is_any_open(context);
    if !is_list_open {
        let escape = match () {
            () if app.panels.help => Action::ToggleHelp,
            () if app.aim.is_armed && !is_gallery => Action::StopAiming,
            // What went wrong is read first; what only says what was done goes by itself.
            () if is_gallery && (app.notice().is_none() || app.is_notice_passing()) => {
                Action::ShowGallery(false)
            }
            () => Action::DismissNotice,
        };
        on(Key::Escape, escape);
    }
    on(Key::G, Action::ShowGallery(!is_gallery));
    if is_gallery || is_list_open {
        return;
    }
    on(Key::Space, Action::TogglePlay);
    on(Key::Period, Action::Step);
    on(Key::ArrowLeft, Action::StepRecorded(-1));
    on(Key::ArrowRight, Action::StepRecorded(1));
    on(Key::End, Action::ShowNow);
    on(Key::T, Action::ToggleAim);
    on(Key::R, Action::Reset);
    on(Key::F, Action::FrameAll);
    on(Key::W, Action::ToggleWireframe);
    on(Key::C, Action::ToggleCut);
    on(Key::X, Action::ToggleCrosses);
    for (key, view) in DIGITS.into_iter().zip(NamedView::ALL) {
        on(key, Action::LookFrom(view));
    }
}
