//! The panels: functions over `&mut Ui` and the state they show. What was asked for comes back as [`Action`]s.

mod banner;
mod closer;
mod contact;
mod element;
mod fracture;
mod gallery;
mod ghost;
pub mod grab;
mod help;
mod icons;
mod inspector;
pub mod keys;
mod materials;
mod parameters;
mod plots;
mod save;
mod status;
mod stress_space;
pub mod style;
mod throw;
mod timeline;
mod toolbar;
mod viewport;
mod widgets;

#[cfg(test)]
pub use element::skin_in_sight;
pub use widgets::open_only;

use super::app::{App, SaveKind};
use super::closer::Closer;
use super::thrown::{Throw, ThrowKind};
use crate::render::NamedView;
use egui::containers::panel::PanelState;
use egui::{IdSalt, Key, Panel, Popup, Ui, UiBuilder};
use glam::DVec3;

/// Width of the panels at the sides when nobody has chosen, and the least, points.
pub const SIDE_WIDTH: f32 = 264.0;
/// Width that the panels at the sides leave to the scene, points.
const LEAST_VIEW_WIDTH: f32 = 320.0;

/// Something a button or a key asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Open a scene by name or path.
    Open(String),
    /// Show or leave the gallery.
    ShowGallery(bool),
    /// Play or pause.
    TogglePlay,
    /// One step.
    Step,
    /// Back to the start, with the values on the sliders.
    Reset,
    /// The same, and what was done on the way comes again.
    Again,
    /// Simulated seconds a second.
    SetSpeed(f64),
    /// Throw or drop a body.
    Throw(Throw),
    /// Drop such a body from above.
    Drop(ThrowKind),
    /// Find out what the throw under way would bring in.
    Foresee(Throw),
    /// Take out the body of this number.
    Remove(usize),
    /// Look closely at the element of a body.
    Inspect(usize, u32),
    /// Grab a body: number of the body in the frame and of the element in the body, the grabbed point and where the mouse
    /// is, m.
    Grab {
        /// Body and element.
        element: (usize, u32),
        /// m.
        point_m: DVec3,
        /// m.
        to_m: DVec3,
    },
    /// The mouse that pulls is here now, m.
    Drag(DVec3),
    /// Let go what is pulled.
    LetGo,
    /// Take back what was done last.
    Undo,
    /// Do again what was taken back.
    Redo,
    /// Do again what had been done there before that.
    RedoOther,
    /// Dragging throws, or turns the camera.
    ToggleAim,
    /// Dragging turns the camera again.
    StopAiming,
    /// Show the recorded moment at a time, s.
    LookAt(f64),
    /// Show recorded moments so many places on.
    StepRecorded(isize),
    /// Play the recording, or stop it.
    Replay,
    /// Show the present again.
    ShowNow,
    /// Simulate on from the moment shown.
    PlayOnFromHere,
    /// Write a file.
    Save(SaveKind),
    /// End the saving under way.
    CancelSaving,
    /// Memory for the recording, bytes.
    SetMemoryLimit(usize),
    /// Contact was changed on a slider.
    ContactEdited,
    /// Show everything.
    FrameAll,
    /// Look from a named direction.
    LookFrom(NamedView),
    /// What surfaces are coloured by was changed.
    ColorsEdited,
    /// Measure colours and stress crosses by the moment shown.
    FitToNow,
    /// Edges of the elements on or off.
    ToggleWireframe,
    /// Cut the bodies open, or close them again.
    ToggleCut,
    /// The cutting plane was moved or turned.
    CutEdited(Closer),
    /// Stress crosses on or off.
    ToggleCrosses,
    /// Light or dark.
    ToggleDark,
    /// Keys and mouse.
    ToggleHelp,
    /// Close the message.
    DismissNotice,
    /// Close what is said of saving.
    DismissSaved,
}

impl Action {
    /// Whether somebody goes on to something else with it, and does not only look around.
    #[must_use]
    pub fn is_another_deed(&self) -> bool {
        matches!(
            self,
            Self::Open(_)
                | Self::ShowGallery(true)
                | Self::TogglePlay
                | Self::Step
                | Self::Reset
                | Self::Again
                | Self::Throw(_)
                | Self::Drop(_)
                | Self::Remove(_)
                | Self::Grab { .. }
                | Self::Undo
                | Self::Redo
                | Self::RedoOther
                | Self::PlayOnFromHere
                | Self::Save(_)
                | Self::ContactEdited
        )
    }
}

/// Lays out the whole window.
pub fn show(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    // Its panel says so if it is there.
    app.save.is_in_sight = false;
    // By itself, the toolkit closes lists on clicks of the mouse only.
    let is_chosen_by_key = Popup::is_any_open(ui.ctx()) && ui.input(|input| input.key_pressed(Key::Enter));
    Panel::top("toolbar").frame(style::bar_frame()).show(ui, |ui| toolbar::show(ui, app, actions));
    if app.is_gallery {
        egui::CentralPanel::no_frame()
            .frame(style::gallery_frame())
            .show(ui, |ui| gallery::show(ui, app, actions));
        banner::show(ui.ctx(), app, actions);
    } else {
        show_scene(ui, app, actions);
    }
    help::show(ui.ctx(), &mut app.panels.help);
    if is_chosen_by_key {
        Popup::close_all(ui.ctx());
    }
}

fn show_scene(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    Panel::bottom("status").frame(style::bar_frame()).show(ui, |ui| status::show(ui, app));
    Panel::bottom("timeline").frame(style::bar_frame()).show(ui, |ui| timeline::show(ui, app, actions));
    let panels = app.panels;
    let count = f32::from(u8::from(panels.parameters) + u8::from(panels.inspector));
    let most = ((ui.available_width() - LEAST_VIEW_WIDTH) / count.max(1.0)).max(SIDE_WIDTH);
    if panels.parameters {
        let side = Side { name: "parameters", most };
        let mut width = panels.parameters_width;
        side.show(ui, Panel::left, &mut width, |ui| parameters::show(ui, app, actions));
        app.panels.parameters_width = width;
    }
    if panels.inspector {
        let side = Side { name: "inspector", most };
        let mut width = panels.inspector_width;
        side.show(ui, Panel::right, &mut width, |ui| inspector::show(ui, app, actions));
        app.panels.inspector_width = width;
    }
    egui::CentralPanel::no_frame().show(ui, |ui| viewport::show(ui, app, actions));
}

/// A panel at the side.
struct Side {
    name: &'static str,
    /// Width that the window has for it, points.
    most: f32,
}

impl Side {
    /// Shows it as wide as was chosen, or as there is room for. Only dragging its edge chooses another width: in a small
    /// window it is narrower for a while, and comes back when there is room.
    fn show(
        &self,
        ui: &mut Ui,
        at: fn(&'static str) -> Panel,
        chosen: &mut f32,
        content: impl FnOnce(&mut Ui),
    ) {
        let width = chosen.clamp(SIDE_WIDTH, self.most);
        // The toolkit would remember the width that was shown last.
        let id = ui.scope_id().with_salt(IdSalt::new(self.name));
        ui.data_mut(|data| data.remove::<PanelState>(id));
        let panel = at(self.name)
            .frame(style::side_frame())
            .resizable(true)
            .default_size(width)
            .size_range(SIDE_WIDTH..=self.most);
        let shown = panel.show(ui, |ui| filled(ui, content)).response.rect.width();
        // Edges lie on pixels.
        if (shown - width).abs() > 0.5 {
            *chosen = shown;
        }
    }
}

/// A panel keeps its width whatever is in it: an empty one would shrink for good, and one with too wide a row grow.
fn filled(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let room = ui.available_rect_before_wrap();
    let mut inside = ui.new_child(UiBuilder::new().max_rect(room));
    inside.set_clip_rect(room.expand(4.0).intersect(ui.clip_rect()));
    content(&mut inside);
    ui.advance_cursor_after_rect(room);
}
