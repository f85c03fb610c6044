//! What the simulation thread does, without the thread: commands in, steps, snapshots out.

mod course;
mod edit_tree;
mod hand;
mod left;
mod looking;
mod planned;
mod redo;
mod scene_edits;
mod timeline;

use super::foresight::Foreseen;
use super::history::Row;
use super::inspection::Inspection;
use super::pacing::{FRAME_S, Pace, SpeedMeter};
use super::snapshot::{Command, Notice, Snapshot};
use crate::scene::{Scene, SceneError};
use crate::sim::{ContactChange, ContactParameters, SimError, StepReport, World};
use course::Course;
use edit_tree::Done;
use hand::Hand;
use left::LeftRuns;
use redo::Redoing;
use std::sync::Arc;

/// Steps in a row that may leave time standing before the run counts as stuck.
const STANDING_STEPS: u32 = 1000;

/// What was done when a scene was reset, in words.
const RESET: &str = "reset (all that was done left out)";
/// The same, when what was done comes again.
const RERUN: &str = "rerun (all that was done comes again)";

/// A running scene.
#[derive(Clone)]
struct Run {
    base: Arc<Scene>,
    scene: Arc<Scene>,
    world: World,
    body_names: Arc<[String]>,
}

/// The state of the simulation thread.
pub struct Session {
    /// What has been simulated.
    course: Course,
    /// The runs before the last resets, and the times from which somebody went back.
    left: LeftRuns,
    redoing: Option<Redoing>,
    speed: f64,
    is_playing: bool,
    pace: Option<Pace>,
    meter: SpeedMeter,
    /// The mouse, while it pulls at a body.
    hand: Option<Hand>,
    /// What the throw under way would bring in.
    foreseen: Option<Arc<Foreseen>>,
    /// Body and element looked at closely.
    inspected: Option<(usize, u32)>,
    /// Whether frames hold what is inside the bodies.
    with_interior: bool,
    looked: Option<looking::LookedRun>,
    commands_done: u64,
    opened: u64,
    built: u64,
    notice: Option<Notice>,
    notices: u64,
    /// Number of the command before which a way back was told of: what is told during it comes on top of that.
    way_back_told: Option<u64>,
}

impl Default for Session {
    fn default() -> Self {
        Self {
            course: Course::default(),
            left: LeftRuns::default(),
            redoing: None,
            speed: 1.0,
            is_playing: false,
            pace: None,
            meter: SpeedMeter::default(),
            hand: None,
            foreseen: None,
            inspected: None,
            with_interior: false,
            looked: None,
            commands_done: 0,
            opened: 0,
            built: 0,
            notice: None,
            notices: 0,
            way_back_told: None,
        }
    }
}

/// Time that playing goes on for after something was done, over the scene's duration.
const AFTERMATH: f64 = 0.5;

impl Session {
    /// Carries out a command.
    pub fn execute(&mut self, command: Command) {
        if command.is_another_way_on() {
            self.stop_redoing();
        }
        match command {
            Command::Open { scene, overrides, play } => self.open(&scene, &overrides, play),
            Command::Close => self.close(),
            Command::Play => self.play(),
            Command::Pause => self.set_playing(false),
            Command::Step => self.single_step(),
            Command::Reset { overrides, keep } => self.reset(&overrides, keep),
            Command::SetSpeed(speed) => self.set_speed(speed),
            Command::SetContact(contact) => self.set_contact(contact),
            Command::Throw(throw) => self.throw(&throw),
            Command::Foresee { number, throw, time_s } => self.foresee(number, &throw, time_s),
            Command::Remove(body) => self.remove(body),
            Command::Grab { element, point_m, to_m } => self.grab(element, point_m, to_m),
            Command::Drag(to_m) => self.drag(to_m),
            Command::LetGo => self.let_go(),
            Command::Undo => self.undo_last(),
            Command::Redo => self.redo_next(),
            Command::RedoOther => self.redo_other(),
            Command::PlayOnFrom { time_s, play } => self.play_on_from(time_s, play),
            Command::Inspect(element) => self.inspected = element,
            Command::SetMemoryLimit(bytes) => self.set_memory_limit(bytes),
            Command::SetInterior(is_wanted) => self.set_interior(is_wanted),
            Command::LookInto(time_s) => self.look_into(time_s),
        }
        self.commands_done += 1;
    }

    /// Whether time runs.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.is_playing
    }

    /// How long until there is something to do, s of wall time; `None` until a command comes.
    #[must_use]
    pub fn wait_s(&self, wall_s: f64) -> Option<f64> {
        if !self.is_playing {
            return None;
        }
        Some(self.pace.map_or(0.0, |pace| pace.wait_s(wall_s)))
    }

    /// Steps to the next moment or, with elastic steps, the first one after it; `is_enough` is asked after every
    /// step. Returns whether it was reached.
    pub fn advance(&mut self, wall_s: f64, mut is_enough: impl FnMut() -> bool) -> bool {
        if self.course.run.is_none() || !self.is_playing {
            return true;
        }
        if self.redoing.is_some() {
            return self.go_on_redoing(is_enough);
        }
        let mut time_s = self.time_s();
        let speed = self.speed_now();
        let pace = *self.pace.get_or_insert_with(|| Pace::new(speed, time_s, wall_s));
        let end_s = self.end_ahead_s();
        let run_up_end_s =
            if time_s < self.course.run_up_end_s { self.course.run_up_end_s } else { f64::INFINITY };
        let moment_s = pace.moment_s().min(end_s).min(run_up_end_s);
        let mut has_moved = false;
        while !is_reached(time_s, moment_s) {
            if !self.take_step(moment_s) {
                return true;
            }
            time_s = self.time_s();
            has_moved = true;
            if !is_reached(time_s, moment_s) && is_enough() {
                return false;
            }
        }
        // In extreme slow motion an elastic step spans several moments.
        if has_moved {
            self.note_moment();
        }
        if is_reached(time_s, end_s) {
            self.set_playing(false);
            return true;
        }
        if is_reached(time_s, run_up_end_s) {
            self.restart_clock();
        }
        self.meter.mark(wall_s, time_s);
        if let Some(pace) = &mut self.pace {
            pace.pass(wall_s);
        }
        true
    }

    /// The end of the scene, where playing pauses, or later by what was done last on the way: it is to be seen what comes of it.
    /// Infinite once it is reached, and while a body is held: then playing goes on beyond.
    fn end_ahead_s(&self) -> f64 {
        let duration_s =
            self.course.run.as_ref().map_or(f64::INFINITY, |run| run.scene.description.duration_s);
        let last_s = self.course.edits.last_step().map_or(0.0, |(_, edit)| edit.time_s);
        let end_s = duration_s.max(last_s + AFTERMATH * duration_s);
        if self.hand.is_some() || is_reached(self.time_s(), end_s) { f64::INFINITY } else { end_s }
    }

    /// Simulated seconds a second: up to what the scene's recording shows at least real time, unless the user has chosen.
    fn speed_now(&self) -> f64 {
        if self.time_s() < self.course.run_up_end_s { self.speed.max(1.0) } else { self.speed }
    }

    /// What the window should show.
    pub fn snapshot(&mut self) -> Snapshot {
        self.renew_frame();
        let looked = self.looked();
        let run = self.course.run.as_ref();
        Snapshot {
            commands_done: self.commands_done,
            opened: self.opened,
            built: self.built,
            base: run.map(|run| run.base.clone()),
            scene: run.map(|run| run.scene.clone()),
            contact: run.map(|run| run.world.setup().contact.clone()),
            body_names: run.map(|run| run.body_names.clone()).unwrap_or_default(),
            frame: self.course.frame.clone(),
            history: self.course.history.clone(),
            recording: self.course.recording.clone(),
            inspection: run
                .zip(self.inspected)
                .and_then(|(run, (body, element))| Inspection::of(&run.world, body, element)),
            with_interior: self.with_interior,
            looked,
            planned: self.course.planned.clone(),
            foreseen: self.foreseen.clone(),
            undo: self.undo_words(),
            redo: self.redo_words(),
            redo_other: self.redo_other_words(),
            redoing: self.redoing_words(),
            late_text: self.course.edits.text(self.time_s(), false).into(),
            can_repeat: self.course.edits.len() > 0 || !self.course.kept_text.is_empty(),
            is_playing: self.is_playing,
            speed: self.speed,
            real_time_factor: self.meter.factor().filter(|_| self.is_playing),
            stable_step_s: run.map_or(f64::INFINITY, |run| stable_step_s(&run.world)),
            run_error: self.course.run_error.clone(),
            notice: self.notice.clone(),
        }
    }

    /// Stops the run for a reason; a reset makes it run again.
    pub fn fail(&mut self, reason: String) {
        self.course.run_error = Some(reason);
        self.redoing = None;
        self.set_playing(false);
    }

    /// Tells the user of something that went wrong.
    pub fn tell(&mut self, text: String) {
        self.note(text, false);
    }

    /// Says what was done; it goes away by itself.
    fn mention(&mut self, text: String) {
        self.note(text, true);
    }

    fn note(&mut self, mut text: String, is_passing: bool) {
        if self.way_back_told == Some(self.commands_done)
            && let Some(before) = &self.notice
        {
            text = format!("{text}\n{}", before.text);
        }
        self.notices += 1;
        self.notice = Some(Notice { number: self.notices, text, is_passing });
    }

    fn time_s(&self) -> f64 {
        self.course.time_s()
    }

    fn open(&mut self, name: &str, overrides: &[String], play: bool) {
        let scene = match Scene::load(name, overrides) {
            Ok(scene) => Arc::new(scene),
            Err(error @ SceneError::Invalid { .. }) => return self.tell(format!("{name}: {error}")),
            // All others name it.
            Err(error) => return self.tell(error.to_string()),
        };
        let world = match World::new(scene.setup.clone()) {
            Ok(world) => world,
            Err(error) => return self.tell(format!("{name}: {error}")),
        };
        self.opened += 1;
        self.inspected = None;
        self.course.contact = None;
        self.speed = 1.0 / scene.description.recording.slow_motion.max(1.0);
        self.notice = None;
        self.course.thrown = 0;
        self.course.kept_text.clear();
        self.left = LeftRuns::default();
        // What the scene's pictures need is recorded from the first moment on.
        let recording = &scene.description.recording;
        self.set_interior(recording.cut.is_some() || recording.crosses);
        self.start(scene.clone(), scene.clone(), world, None);
        self.set_playing(play);
        if !scene.warnings.is_empty() {
            self.tell(scene.warnings.join("\n"));
        }
    }

    fn close(&mut self) {
        let (opened, built, notices) = (self.opened, self.built, self.notices);
        let commands_done = self.commands_done;
        let course = Course::with_limit(self.course.recording.limit_bytes());
        *self = Self { opened, built, notices, commands_done, course, ..Self::default() };
    }

    /// Back to the start. `keep`: what was done on the way comes again at its time.
    fn reset(&mut self, overrides: &[String], keep: bool) {
        self.let_go();
        let Some(run) = &self.course.run else { return };
        let base = run.base.clone();
        let kept = match keep {
            true => format!("{}{}", self.course.kept_text, self.course.edits.text(run.world.time_s(), true)),
            false => String::new(),
        };
        let built = with_kept(&base, overrides, &kept).and_then(|scene| {
            let world = World::new(scene.setup.clone()).map_err(|error| error.to_string())?;
            Ok((scene, world))
        });
        match built {
            Ok((scene, world)) => {
                // Changes of contact that are kept come again by themselves.
                let contact = self.course.contact.clone().filter(|_| !keep);
                let told = self.reset_text(keep);
                self.leave_run(if keep { RERUN } else { RESET }, keep);
                if !keep {
                    self.course.thrown = 0;
                }
                self.course.kept_text = kept;
                self.start(base, scene, world, contact);
                self.share_memory();
                told.into_iter().for_each(|told| self.mention(told));
            }
            Err(reason) => self.tell(format!("the scene could not be reset: {reason}")),
        }
    }

    /// Begins at the start of a newly built world, with the contact that the user had chosen before.
    fn start(
        &mut self,
        base: Arc<Scene>,
        scene: Arc<Scene>,
        world: World,
        contact: Option<ContactParameters>,
    ) {
        self.built += 1;
        (self.foreseen, self.redoing, self.hand, self.looked) = (None, None, None, None);
        self.course = self.course.anew();
        self.course.run_up_end_s = scene.description.recording.start_s;
        self.course.planned = planned::marks(&scene.description, !self.course.kept_text.is_empty());
        self.restart_clock();
        let body_names = names_of(&world);
        self.course.run = Some(Run { base, scene, world, body_names });
        contact.into_iter().for_each(|contact| self.set_contact(contact));
        self.course.edits.give();
        self.course.contact_given = self.course.contact.clone();
        self.note_moment();
    }

    fn play(&mut self) {
        match &mut self.redoing {
            Some(redoing) => redoing.then_plays = true,
            None => self.set_playing(true),
        }
    }

    fn set_playing(&mut self, is_playing: bool) {
        self.is_playing = is_playing && self.course.run.is_some() && self.course.run_error.is_none();
        self.restart_clock();
    }

    fn set_speed(&mut self, speed: f64) {
        if speed.is_finite() && speed > 0.0 {
            self.speed = speed;
            self.course.run_up_end_s = 0.0;
            self.restart_clock();
        }
    }

    fn restart_clock(&mut self) {
        self.pace = None;
        self.meter.clear();
    }

    fn set_contact(&mut self, contact: ContactParameters) {
        let Some(run) = &self.course.run else { return };
        let ground = run.scene.description.ground.as_ref().map(|_| GROUND_BODY);
        let then = &run.world.setup().contact;
        let change = ContactChange::between(then, &contact, &run.body_names, ground);
        if change.is_empty() {
            return;
        }
        self.edit(Done::Contact(change), "contact changed".to_owned());
    }

    fn single_step(&mut self) {
        self.set_playing(false);
        let Some(run) = self.course.run.as_ref().filter(|_| self.course.run_error.is_none()) else { return };
        let limit_s = run.world.time_s() + run.world.setup().time.free_interval_s;
        if self.take_step(limit_s) {
            self.note_moment();
        }
    }

    /// Takes a step of the world; `false` when the run cannot go on.
    fn take_step(&mut self, limit_s: f64) -> bool {
        self.lead_hand();
        let Some(run) = &mut self.course.run else { return false };
        let before_s = run.world.time_s();
        match run.world.step(limit_s) {
            Ok(report) => {
                run.renew_names();
                let has_moved = run.world.time_s() > before_s;
                self.note_step(&report, has_moved)
            }
            Err(error) => {
                self.fail(blow_up_text(&error));
                false
            }
        }
    }

    fn note_step(&mut self, report: &StepReport, has_moved: bool) -> bool {
        self.course.pressed_n_s += report.contact_force_n * report.step_s;
        self.course.pressed_s += report.step_s;
        self.course.standing_steps = if has_moved { 0 } else { self.course.standing_steps + 1 };
        if self.course.standing_steps < STANDING_STEPS {
            return true;
        }
        self.fail(format!(
            "Time stands still: {STANDING_STEPS} steps did not move it. Bodies may be wedged into each other; reset \
             the scene, or try a smaller time.cfl."
        ));
        false
    }

    /// A moment was reached: its balances, and what is seen of it.
    fn note_moment(&mut self) {
        self.note_balances();
        self.record();
    }

    /// Adds a row to the history.
    fn note_balances(&mut self) {
        let Some(run) = &self.course.run else { return };
        let force_n =
            if self.course.pressed_s > 0.0 { self.course.pressed_n_s / self.course.pressed_s } else { 0.0 };
        (self.course.pressed_n_s, self.course.pressed_s) = (0.0, 0.0);
        let sample = run.world.sample();
        let row = Row::of(&sample, run.world.time_s(), force_n, stable_step_s(&run.world));
        let row = row.without(&run.world.round_off());
        self.note_marks(sample.crack_area_m2);
        Arc::make_mut(&mut self.course.history).offer(row);
    }
}

/// A scene with overrides and, below, the text of what was done to it on the way.
fn with_kept(base: &Arc<Scene>, overrides: &[String], kept: &str) -> Result<Arc<Scene>, String> {
    let words = |error: crate::scene::SceneError| error.to_string();
    let scene = match overrides {
        [] => base.clone(),
        _ => Arc::new(base.with_overrides(overrides).map_err(words)?),
    };
    if kept.is_empty() { Ok(scene) } else { scene.with_text(kept).map(Arc::new).map_err(words) }
}

/// The ground is the first body of a scene that has one.
pub const GROUND_BODY: usize = 0;

fn names_of(world: &World) -> Arc<[String]> {
    world.setup().bodies.iter().map(|body| body.name.clone()).collect()
}

fn stable_step_s(world: &World) -> f64 {
    let steps = (0..world.body_count()).map(|body| world.stable_step_s(body));
    world.setup().time.cfl * steps.fold(f64::INFINITY, f64::min)
}

fn blow_up_text(error: &SimError) -> String {
    let text = error.to_string();
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

/// Whether `time_s` is `moment_s` up to rounding: a step over what is left would be too short for contact forces.
pub(super) fn is_reached(time_s: f64, moment_s: f64) -> bool {
    const ROUNDING: f64 = 1e-12;
    time_s >= moment_s * (1.0 - ROUNDING)
}

/// Longest stretch of steps between looks at the commands, s of wall time.
pub const SLICE_S: f64 = 0.5 * FRAME_S;

#[cfg(test)]
mod tests;
