//! The viewer without a window: its state, what buttons and keys do, and the panels laid out.

mod seeing;
mod taking_home;

use super::aim::Aim;
use super::edits::Edits;
use super::foresight::{Ghost, Sight};
use super::inspection::Inspection;
use super::look::Look;
use super::player::Player;
use super::recording::Recording;
use super::saver::Saver;
use super::simulation::Simulation;
use super::snapshot::{Command, Looked, Notice, Snapshot};
use super::thumbnails::{Sketch, Sketcher};
use super::ui::{self, Action};
use crate::frame::Frame;
use crate::render::{Camera, View};
use crate::scene::BUILTIN_SCENES;
use egui::{Rect, TextureId, Ui};
use seeing::Seen;
use std::sync::Arc;
use taking_home::SaveState;
pub use taking_home::{SaveKind, in_a_sentence};

/// Title of the window without a scene.
pub const TITLE: &str = "hammerfall";
/// How long the window says what was done, s of wall time.
const PASSING_S: f64 = 8.0;
/// Longest time by which the recording goes on in one frame, s of wall time.
const LONGEST_FRAME_S: f64 = 0.1;

/// Which panels are there.
#[derive(Clone, Copy, Debug)]
pub struct Panels {
    /// Materials, contact, dropping: at the left.
    pub parameters: bool,
    /// Colours and plots: at the right.
    pub inspector: bool,
    /// Keys and mouse.
    pub help: bool,
    /// Width of the left one, points.
    pub parameters_width: f32,
    /// Width of the right one, points.
    pub inspector_width: f32,
}

impl Default for Panels {
    fn default() -> Self {
        Self {
            parameters: true,
            inspector: true,
            help: false,
            parameters_width: ui::SIDE_WIDTH,
            inspector_width: ui::SIDE_WIDTH,
        }
    }
}

/// The state of the viewer.
pub struct App {
    /// The simulation.
    simulation: Simulation,
    /// What it showed last.
    pub snapshot: Arc<Snapshot>,
    /// Values on the sliders.
    pub edits: Edits,
    /// The picture.
    pub look: Look,
    /// What the mouse would throw.
    pub aim: Aim,
    /// What it would bring in, where that would start.
    ghost: Option<Ghost>,
    /// The body that the mouse holds.
    pub hold: Option<ui::grab::Hold>,
    /// Which recorded moment is shown.
    pub player: Player,
    /// Writes files.
    pub saver: Saver,
    /// Where to, and what came of it.
    pub save: SaveState,
    /// What went wrong in the window itself.
    trouble: Option<String>,
    /// What is drawn in place of what is shown.
    seen: Option<Seen>,
    /// The recorded moment that the simulation was asked to look into, s.
    looked_into_s: Option<f64>,
    /// Which panels are there.
    pub panels: Panels,
    /// Whether the gallery covers the scene.
    pub is_gallery: bool,
    /// Number of the notice that was dismissed last.
    dismissed: u64,
    /// Time of the window, s.
    now_s: f64,
    /// What is said for now, and when that began, s.
    passing: Option<(String, f64)>,
    /// Where the picture goes, points.
    pub viewport: Option<Rect>,
    /// The picture of the scene, where the panels have to paint it.
    pub picture: Option<TextureId>,
    /// How moving pictures are drawn, where that is not as finely as still ones.
    pub detail: Option<&'static str>,
    /// Thumbnails of the built-in scenes, drawn by the window's graphics.
    pub thumbnails: Vec<Option<TextureId>>,
    sketcher: Sketcher,
    sketches: Vec<Sketch>,
    sketches_drawn: usize,
    actions: Vec<Action>,
}

/// A picture that the window's graphics should draw.
pub struct PictureRequest<'a> {
    /// The frame.
    pub frame: &'a Arc<Frame>,
    /// From where.
    pub camera: Camera,
    /// How.
    pub view: View,
    /// Width and height, pixels.
    pub size_px: [u32; 2],
}

impl App {
    /// The viewer at its gallery.
    #[must_use]
    pub fn new(simulation: Simulation, sketcher: Sketcher) -> Self {
        Self {
            simulation,
            snapshot: Arc::default(),
            edits: Edits::default(),
            look: Look::default(),
            aim: Aim::default(),
            ghost: None,
            hold: None,
            player: Player::default(),
            saver: Saver::default(),
            save: SaveState::default(),
            trouble: None,
            seen: None,
            looked_into_s: None,
            panels: Panels::default(),
            is_gallery: true,
            dismissed: 0,
            now_s: 0.0,
            passing: None,
            viewport: None,
            picture: None,
            detail: None,
            thumbnails: vec![None; BUILTIN_SCENES.len()],
            sketcher,
            sketches: Vec::new(),
            sketches_drawn: 0,
            actions: Vec::new(),
        }
    }

    /// Opens a scene by name or path.
    pub fn open(&mut self, scene: &str, overrides: &[String]) {
        self.is_gallery = false;
        let (scene, overrides) = (scene.to_owned(), overrides.to_vec());
        self.simulation.send(Command::Open { scene, overrides, play: true });
    }

    /// Title of the window.
    #[must_use]
    pub fn title(&self) -> String {
        match &self.snapshot.scene {
            Some(scene) if !self.is_gallery => format!("{} — {TITLE}", scene.description.title),
            _ => TITLE.to_owned(),
        }
    }

    /// Whether the simulation has still to carry out what it was asked for.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        self.simulation.is_behind(&self.snapshot)
    }

    /// What the simulation was asked for lately, for a test that finds out that there is no end to it.
    #[cfg(test)]
    pub fn asked_lately(&self) -> (u64, Vec<&str>) {
        self.simulation.lately()
    }

    /// The text of the notice that is shown, if any.
    #[must_use]
    pub fn notice(&self) -> Option<&str> {
        if let Some(trouble) = &self.trouble {
            return Some(trouble);
        }
        self.session_notice().map(|notice| notice.text.as_str())
    }

    /// Whether the notice only says what was done.
    #[must_use]
    pub fn is_notice_passing(&self) -> bool {
        self.trouble.is_none() && self.session_notice().is_none_or(|notice| notice.is_passing)
    }

    fn session_notice(&self) -> Option<&Notice> {
        self.snapshot.notice.as_ref().filter(|notice| notice.number > self.dismissed)
    }

    /// What was only said goes away after some seconds.
    fn let_notices_pass(&mut self, context: &egui::Context) {
        let Some(text) = self.notice().filter(|_| self.is_notice_passing()) else {
            self.passing = None;
            return;
        };
        let now_s = self.now_s;
        let began_s = match &self.passing {
            Some((said, began_s)) if said == text => *began_s,
            _ => {
                self.passing = Some((text.to_owned(), now_s));
                now_s
            }
        };
        let left_s = began_s + PASSING_S - now_s;
        if left_s > 0.0 {
            context.request_repaint_after(std::time::Duration::from_secs_f64(left_s));
        } else {
            self.dismiss_notice();
        }
    }

    fn dismiss_notice(&mut self) {
        self.passing = None;
        if self.trouble.take().is_some() {
            return;
        }
        self.dismissed = self.snapshot.notice.as_ref().map_or(0, |notice| notice.number);
    }

    /// What is shown: the recorded moment looked at, or the present.
    #[must_use]
    pub fn shown(&self) -> &Arc<Frame> {
        self.player.moment(&self.snapshot.recording).map_or(&self.snapshot.frame, |moment| &moment.frame)
    }

    /// What the throw under way would bring in, where it would start; `None` until that is known.
    #[must_use]
    pub fn ghost(&self) -> Option<&Ghost> {
        self.ghost.as_ref()
    }

    /// Finds a place for what the throw under way would bring in, once for each frame that is seen.
    pub fn place_ghost(&mut self) {
        let before = self.ghost.take();
        let foreseen = self.snapshot.foreseen.as_ref().filter(|foreseen| foreseen.number == self.aim.asks);
        let (Some([at, _]), Some(foreseen)) = (self.aim.drag, foreseen) else { return };
        let sight =
            Sight { frame: self.shown().clone(), camera: self.look.camera, aspect: self.aspect(), at };
        let is_known = before.as_ref().is_some_and(|ghost| ghost.is_of(foreseen, &sight));
        self.ghost = if is_known { before } else { Some(Ghost::new(foreseen.clone(), sight)) };
    }

    /// The recorded moment that is shown, once it was looked into.
    fn looked(&self) -> Option<&Looked> {
        let moment = self.player.moment(&self.snapshot.recording)?;
        self.snapshot.looked.as_ref().filter(|looked| looked.time_s == moment.time_s)
    }

    /// The element looked at closely at the moment shown; `None` when there is none, or not yet.
    #[must_use]
    pub fn inspection(&self) -> Option<&Inspection> {
        if self.player.is_back() {
            return self.looked().and_then(|looked| looked.inspection.as_ref());
        }
        self.snapshot.inspection.as_ref()
    }

    /// Whether the values of the element are still being found.
    #[must_use]
    pub fn is_inspection_late(&self) -> bool {
        self.player.is_back() && self.looked().is_none() && self.snapshot.inspection.is_some()
    }

    /// Lays out the whole window for one frame and does what was asked for in it.
    pub fn update(&mut self, ui: &mut Ui) {
        self.now_s = ui.ctx().input(|input| input.time);
        self.take_news();
        self.play_recording(ui.ctx());
        self.look_after_saving(ui.ctx());
        self.let_notices_pass(ui.ctx());
        let mut actions = std::mem::take(&mut self.actions);
        ui::style::choose_theme(ui.ctx(), self.look.is_dark);
        ui::keys::read(ui.ctx(), self, &mut actions);
        ui::show(ui, self, &mut actions);
        for action in actions.drain(..) {
            // Something else is done: what was said about the last thing has been read.
            if self.is_notice_passing() && action.is_another_deed() {
                self.dismiss_notice();
            }
            self.act(action);
        }
        self.actions = actions;
        self.look_closer();
        self.see();
    }

    /// What the graphics should draw into the viewport, once its place is known.
    #[must_use]
    pub fn picture_request(&self, pixels_per_point: f32) -> Option<PictureRequest<'_>> {
        let viewport = self.viewport.filter(|_| !self.is_gallery && self.snapshot.scene.is_some())?;
        let pixels = |points: f32| (points * pixels_per_point).round().max(1.0) as u32;
        Some(PictureRequest {
            frame: self.drawn(),
            camera: self.look.camera,
            view: self.look.view(pixels_per_point),
            size_px: [pixels(viewport.width()), pixels(viewport.height())],
        })
    }

    /// Upper left corner of the picture in the window, pixels; `None` when there is no picture.
    #[must_use]
    pub fn picture_corner_px(&self, pixels_per_point: f32) -> Option<[u32; 2]> {
        let viewport = self.viewport.filter(|_| !self.is_gallery && self.snapshot.scene.is_some())?;
        Some([viewport.left(), viewport.top()].map(|at| (at * pixels_per_point).round().max(0.0) as u32))
    }

    /// The next thumbnail to draw, if the gallery is open.
    pub fn next_sketch(&mut self) -> Option<&Sketch> {
        if !self.is_gallery {
            return None;
        }
        while let Some(sketch) = self.sketcher.next() {
            self.sketches.push(sketch);
        }
        let next = self.sketches.get(self.sketches_drawn)?;
        self.sketches_drawn += 1;
        Some(next)
    }

    /// Shows this instead, if the simulation stands still.
    pub fn show_still(&self, snapshot: Snapshot) {
        self.simulation.show(snapshot);
    }

    /// Asks the simulation for something, as buttons do.
    #[cfg(test)]
    pub fn press_for_test(&mut self, command: Command) {
        self.simulation.send(command);
    }

    /// Says that something went wrong in the window itself.
    pub fn tell(&mut self, text: String) {
        self.trouble = Some(text);
    }

    /// The device is another one: pictures on the old one are gone.
    pub fn forget_graphics(&mut self) {
        self.picture = None;
        self.thumbnails.fill(None);
        self.redraw_thumbnails();
    }

    /// Has the thumbnails drawn again, in other light or on another device.
    pub fn redraw_thumbnails(&mut self) {
        self.sketches_drawn = 0;
    }

    fn take_news(&mut self) {
        let Some(latest) = self.simulation.latest() else { return };
        if Arc::ptr_eq(&latest, &self.snapshot) {
            return;
        }
        let before = std::mem::replace(&mut self.snapshot, latest);
        let snapshot = self.snapshot.clone();
        if let Some(base) = snapshot.base.as_ref().filter(|_| snapshot.opened != before.opened) {
            self.edits = Edits::of(base);
            self.look.open(&snapshot);
            self.save.told.clear();
            self.aim.suit(&snapshot.frame);
            self.aim.kind = super::thrown::ThrowKind::Hammer;
            self.aim.material = super::thrown::TOOL.to_owned();
        }
        if snapshot.built != before.built {
            self.player.leave();
            self.looked_into_s = None;
            self.look.forget_range();
            self.look.forget_crosses();
        }
        if let Some(contact) = snapshot.contact.as_ref().filter(|_| !self.is_waiting()) {
            // Dropped bodies come with friction of their own.
            self.edits.contact = contact.clone();
        }
        if snapshot.scene.is_none() && !self.is_waiting() {
            self.is_gallery = true;
        }
        self.look.take_in(&snapshot.frame);
    }

    /// Lets the recording go on, at the speed of the simulation.
    fn play_recording(&mut self, context: &egui::Context) {
        if !self.player.is_playing() {
            return;
        }
        let wall_s = f64::from(context.input(|input| input.stable_dt)).min(LONGEST_FRAME_S);
        self.player.advance(&self.snapshot.recording, wall_s * self.snapshot.speed);
        let shown = self.shown().clone();
        self.look.take_in(&shown);
        context.request_repaint();
    }

    /// Shows a recorded moment; time stands meanwhile.
    fn look_back(&mut self, look: impl FnOnce(&mut Player, &Recording)) {
        if self.snapshot.is_playing {
            self.simulation.send(Command::Pause);
        }
        look(&mut self.player, &self.snapshot.recording);
        let shown = self.shown().clone();
        self.look.take_in(&shown);
    }

    fn play_on_from_here(&mut self) {
        if let Some(time_s) = self.player.moment(&self.snapshot.recording).map(|moment| moment.time_s) {
            self.simulation.send(Command::PlayOnFrom { time_s, play: true });
            self.player.leave();
        }
    }

    /// Looks closely at an element, by the numbers of its body and of itself.
    pub fn inspect(&mut self, body: usize, element: u32) {
        self.simulation.send(Command::Inspect(Some((body, element))));
    }

    fn toggle_play(&mut self) {
        if self.player.is_back() {
            return self.look_back(|player, recording| player.toggle(recording));
        }
        let command = if self.snapshot.is_playing { Command::Pause } else { Command::Play };
        self.simulation.send(command);
    }

    /// Throwing while looking back throws at the moment looked at.
    fn edit_scene(&mut self, command: Command) {
        if let Some(time_s) = self.player.moment(&self.snapshot.recording).map(|moment| moment.time_s) {
            self.simulation.send(Command::PlayOnFrom { time_s, play: false });
            self.player.leave();
        }
        self.simulation.send(command);
    }

    fn retrace(&mut self, command: Command) {
        self.player.leave();
        self.simulation.send(command);
    }

    fn aspect(&self) -> f32 {
        self.viewport.map_or(16.0 / 9.0, |rect| rect.width() / rect.height().max(1.0))
    }

    fn act(&mut self, action: Action) {
        let aspect = self.aspect();
        match action {
            Action::Open(scene) => self.open(&scene, &[]),
            Action::ShowGallery(is_shown) => self.show_gallery(is_shown),
            Action::TogglePlay => self.toggle_play(),
            Action::Step if self.player.is_back() => {
                self.look_back(|player, recording| player.step(recording, 1))
            }
            Action::Step => self.simulation.send(Command::Step),
            Action::Reset => self.reset(false),
            Action::Again => self.reset(true),
            Action::SetSpeed(speed) => self.simulation.send(Command::SetSpeed(speed)),
            Action::Throw(throw) => self.edit_scene(Command::Throw(throw)),
            Action::Drop(kind) => {
                let throw = self.aim.drop(kind, self.shown(), &self.look.camera, aspect);
                self.edit_scene(Command::Throw(throw));
            }
            Action::Foresee(throw) => {
                self.aim.asks += 1;
                let time_s = self.player.moment(&self.snapshot.recording).map(|moment| moment.time_s);
                self.simulation.send(Command::Foresee { number: self.aim.asks, throw, time_s });
            }
            Action::Remove(body) => self.edit_scene(Command::Remove(body)),
            Action::Inspect(body, element) => self.inspect(body, element),
            Action::Grab { element, point_m, to_m } => {
                self.edit_scene(Command::Grab { element, point_m, to_m });
            }
            Action::Drag(to_m) => self.simulation.send(Command::Drag(to_m)),
            Action::LetGo => self.simulation.send(Command::LetGo),
            Action::Undo => self.retrace(Command::Undo),
            Action::Redo => self.retrace(Command::Redo),
            Action::RedoOther => self.retrace(Command::RedoOther),
            Action::ToggleAim => self.aim.arm(!self.aim.is_armed),
            Action::StopAiming => self.aim.arm(false),
            Action::LookAt(time_s) => self.look_back(|player, _| player.go_to(time_s)),
            Action::StepRecorded(by) => self.look_back(|player, recording| player.step(recording, by)),
            Action::Replay => self.look_back(|player, recording| player.toggle(recording)),
            Action::ShowNow => self.player.leave(),
            Action::PlayOnFromHere => self.play_on_from_here(),
            Action::SetMemoryLimit(bytes) => self.simulation.send(Command::SetMemoryLimit(bytes)),
            Action::ContactEdited => {
                self.simulation.send(Command::SetContact(self.edits.contact.clone()));
            }
            Action::FrameAll => self.look.frame_all(&self.to_fit(), aspect),
            Action::LookFrom(view) => self.look.look_from(view, &self.to_fit(), aspect),
            Action::ColorsEdited => {
                self.look.forget_range();
                self.look.take_in(&self.shown().clone());
            }
            Action::FitToNow => {
                self.look.forget_range();
                self.look.take_in(&self.shown().clone());
                self.look.forget_crosses();
                self.seen = None;
            }
            Action::ToggleCut => {
                let shown = self.shown().clone();
                self.look.closer.toggle_cut(&shown, &self.look.camera);
            }
            Action::CutEdited(closer) => self.look.closer = closer,
            Action::ToggleCrosses => self.look.toggle_crosses(),
            Action::ToggleWireframe => self.look.wireframe = !self.look.wireframe,
            Action::ToggleDark => {
                self.look.is_dark = !self.look.is_dark;
                self.redraw_thumbnails();
            }
            Action::ToggleHelp => self.panels.help = !self.panels.help,
            Action::Save(kind) => self.save(kind),
            Action::CancelSaving => self.saver.cancel(),
            Action::DismissNotice if self.notice().is_some() => self.dismiss_notice(),
            Action::DismissNotice | Action::DismissSaved => self.save.close(),
        }
    }

    fn show_gallery(&mut self, is_shown: bool) {
        self.is_gallery = is_shown || self.snapshot.scene.is_none();
        if self.is_gallery && self.snapshot.is_playing {
            self.simulation.send(Command::Pause);
        }
    }

    fn reset(&mut self, keep: bool) {
        if let (Some(base), Some(running)) = (&self.snapshot.base, &self.snapshot.scene) {
            self.simulation.send(Command::Reset { overrides: self.edits.overrides(base, running), keep });
        }
    }
}
