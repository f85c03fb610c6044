//! What the simulation thread does, without the thread: commands in, steps, snapshots out.

use super::drop_body::{DropKind, body_to_drop};
use super::history::{History, Row};
use super::pacing::{FRAME_S, Pace, SpeedMeter};
use crate::frame::Frame;
use crate::scene::Scene;
use crate::sim::{ContactParameters, PairFriction, SimError, StepReport, World};
use std::sync::Arc;

/// Steps in a row that may leave time standing before the run counts as stuck.
const STANDING_STEPS: u32 = 1000;

/// What the window asks of the simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Opens a built-in scene or a file with overrides (`path=value`).
    Open {
        /// Name or path.
        scene: String,
        /// Overrides.
        overrides: Vec<String>,
        /// Whether it plays at once.
        play: bool,
    },
    /// Closes the scene.
    Close,
    /// Lets time run.
    Play,
    /// Stops time.
    Pause,
    /// Takes one step and stops.
    Step,
    /// Back to the start, with these overrides on top of the scene as it was opened.
    Reset {
        /// Overrides.
        overrides: Vec<String>,
    },
    /// Simulated seconds a second.
    SetSpeed(f64),
    /// Changes contact from the next step on, and after resets.
    SetContact(ContactParameters),
    /// Drops a body into the scene.
    Drop(DropKind),
}

/// Something the user has to be told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Counts the notices, so that a dismissed one is not shown again.
    pub number: u64,
    /// What happened and what to do.
    pub text: String,
}

/// Everything the window shows of one moment.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Commands carried out so far.
    pub commands_done: u64,
    /// Counts the scenes opened; a new one gets a new camera.
    pub opened: u64,
    /// Counts the worlds built.
    pub built: u64,
    /// The scene as it was opened; `None` when there is none.
    pub base: Option<Arc<Scene>>,
    /// The scene as it runs: with the overrides of the last reset.
    pub scene: Option<Arc<Scene>>,
    /// Contact as it acts now.
    pub contact: Option<ContactParameters>,
    /// Bodies by name, in the order of [`PairFriction::bodies`].
    pub body_names: Arc<[String]>,
    /// The last good frame.
    pub frame: Arc<Frame>,
    /// Balances over time.
    pub history: Arc<History>,
    /// Whether time runs.
    pub is_playing: bool,
    /// Simulated seconds a second asked for.
    pub speed: f64,
    /// Simulated seconds a second reached; `None` when paused or too early to tell.
    pub real_time_factor: Option<f64>,
    /// Elastic step of the slowest body, s; infinite when nothing deforms.
    pub stable_step_s: f64,
    /// Why the run cannot go on, if so.
    pub run_error: Option<String>,
    /// The last thing that went wrong besides.
    pub notice: Option<Notice>,
}

/// A running scene.
struct Run {
    base: Arc<Scene>,
    scene: Arc<Scene>,
    world: World,
    body_names: Arc<[String]>,
}

/// The state of the simulation thread.
pub struct Session {
    run: Option<Run>,
    /// Contact set by the user, to be kept over resets.
    contact: Option<ContactParameters>,
    speed: f64,
    /// Time up to which playing hurries, s: where the scene's recording starts.
    run_up_end_s: f64,
    is_playing: bool,
    pace: Option<Pace>,
    meter: SpeedMeter,
    frame: Arc<Frame>,
    history: Arc<History>,
    /// Impulse and time since the last row of the history.
    pressed_n_s: f64,
    pressed_s: f64,
    standing_steps: u32,
    dropped: usize,
    commands_done: u64,
    opened: u64,
    built: u64,
    run_error: Option<String>,
    notice: Option<Notice>,
    notices: u64,
}

impl Snapshot {
    /// Duration of the scene in s, when it is over and nothing plays.
    #[must_use]
    pub fn over_after_s(&self) -> Option<f64> {
        let duration_s = self.scene.as_ref()?.description.duration_s;
        (!self.is_playing && is_reached(self.frame.time_s, duration_s)).then_some(duration_s)
    }
}

impl Default for Session {
    fn default() -> Self {
        Self {
            run: None,
            contact: None,
            speed: 1.0,
            run_up_end_s: 0.0,
            is_playing: false,
            pace: None,
            meter: SpeedMeter::default(),
            frame: Arc::default(),
            history: Arc::default(),
            pressed_n_s: 0.0,
            pressed_s: 0.0,
            standing_steps: 0,
            dropped: 0,
            commands_done: 0,
            opened: 0,
            built: 0,
            run_error: None,
            notice: None,
            notices: 0,
        }
    }
}

impl Session {
    /// Carries out a command.
    pub fn execute(&mut self, command: Command) {
        match command {
            Command::Open { scene, overrides, play } => self.open(&scene, &overrides, play),
            Command::Close => self.close(),
            Command::Play => self.set_playing(true),
            Command::Pause => self.set_playing(false),
            Command::Step => self.single_step(),
            Command::Reset { overrides } => self.reset(&overrides),
            Command::SetSpeed(speed) => self.set_speed(speed),
            Command::SetContact(contact) => self.set_contact(contact),
            Command::Drop(kind) => self.drop_body(kind),
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
        if self.run.is_none() || !self.is_playing {
            return true;
        }
        let mut time_s = self.time_s();
        let speed = self.speed_now();
        let pace = *self.pace.get_or_insert_with(|| Pace::new(speed, time_s, wall_s));
        let end_s = self.end_ahead_s();
        let run_up_end_s = if time_s < self.run_up_end_s { self.run_up_end_s } else { f64::INFINITY };
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
            self.note_balances();
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

    /// The end of the scene, where playing pauses; infinite once it is reached: then playing goes on beyond.
    fn end_ahead_s(&self) -> f64 {
        let end_s = self.run.as_ref().map_or(f64::INFINITY, |run| run.scene.description.duration_s);
        if is_reached(self.time_s(), end_s) { f64::INFINITY } else { end_s }
    }

    /// Simulated seconds a second: up to what the scene's recording shows at least real time, unless the user has chosen.
    fn speed_now(&self) -> f64 {
        if self.time_s() < self.run_up_end_s { self.speed.max(1.0) } else { self.speed }
    }

    /// What the window should show.
    pub fn snapshot(&mut self) -> Snapshot {
        if let Some(run) = self.run.as_ref().filter(|_| self.run_error.is_none()) {
            self.frame = Arc::new(run.world.publish());
        }
        let run = self.run.as_ref();
        Snapshot {
            commands_done: self.commands_done,
            opened: self.opened,
            built: self.built,
            base: run.map(|run| run.base.clone()),
            scene: run.map(|run| run.scene.clone()),
            contact: run.map(|run| run.world.setup().contact.clone()),
            body_names: run.map(|run| run.body_names.clone()).unwrap_or_default(),
            frame: self.frame.clone(),
            history: self.history.clone(),
            is_playing: self.is_playing,
            speed: self.speed,
            real_time_factor: self.meter.factor().filter(|_| self.is_playing),
            stable_step_s: run.map_or(f64::INFINITY, |run| stable_step_s(&run.world)),
            run_error: self.run_error.clone(),
            notice: self.notice.clone(),
        }
    }

    /// Stops the run for a reason; a reset makes it run again.
    pub fn fail(&mut self, reason: String) {
        self.run_error = Some(reason);
        self.set_playing(false);
    }

    /// Tells the user something.
    pub fn tell(&mut self, text: String) {
        self.notices += 1;
        self.notice = Some(Notice { number: self.notices, text });
    }

    fn time_s(&self) -> f64 {
        self.run.as_ref().map_or(0.0, |run| run.world.time_s())
    }

    fn open(&mut self, name: &str, overrides: &[String], play: bool) {
        let scene = match Scene::load(name, overrides) {
            Ok(scene) => Arc::new(scene),
            Err(error) => return self.tell(format!("{name}: {error}")),
        };
        let world = match World::new(scene.setup.clone()) {
            Ok(world) => world,
            Err(error) => return self.tell(format!("{name}: {error}")),
        };
        self.opened += 1;
        self.contact = None;
        self.speed = 1.0 / scene.description.recording.slow_motion.max(1.0);
        self.notice = None;
        self.start(scene.clone(), scene.clone(), world);
        self.set_playing(play);
        if !scene.warnings.is_empty() {
            self.tell(scene.warnings.join("\n"));
        }
    }

    fn close(&mut self) {
        let (opened, built, notices) = (self.opened, self.built, self.notices);
        let commands_done = self.commands_done;
        *self = Self { opened, built, notices, commands_done, ..Self::default() };
    }

    fn reset(&mut self, overrides: &[String]) {
        let Some(run) = &self.run else { return };
        let base = run.base.clone();
        let scene = match overrides {
            [] => Ok(base.clone()),
            _ => base.with_overrides(overrides).map(Arc::new).map_err(|error| error.to_string()),
        };
        let built = scene.and_then(|scene| {
            let world = World::new(scene.setup.clone()).map_err(|error| error.to_string())?;
            Ok((scene, world))
        });
        match built {
            Ok((scene, world)) => self.start(base, scene, world),
            Err(reason) => self.tell(format!("the scene could not be reset: {reason}")),
        }
        if let Some(contact) = self.contact.clone() {
            self.set_contact(contact);
        }
    }

    /// Begins at the start of a newly built world.
    fn start(&mut self, base: Arc<Scene>, scene: Arc<Scene>, world: World) {
        self.built += 1;
        self.run_error = None;
        self.history = Arc::default();
        (self.pressed_n_s, self.pressed_s) = (0.0, 0.0);
        self.standing_steps = 0;
        self.dropped = 0;
        self.run_up_end_s = scene.description.recording.start_s;
        self.restart_clock();
        let body_names = names_of(&world);
        self.run = Some(Run { base, scene, world, body_names });
        self.note_balances();
    }

    fn set_playing(&mut self, is_playing: bool) {
        self.is_playing = is_playing && self.run.is_some() && self.run_error.is_none();
        self.restart_clock();
    }

    fn set_speed(&mut self, speed: f64) {
        if speed.is_finite() && speed > 0.0 {
            self.speed = speed;
            self.run_up_end_s = 0.0;
            self.restart_clock();
        }
    }

    fn restart_clock(&mut self) {
        self.pace = None;
        self.meter.clear();
    }

    fn set_contact(&mut self, mut contact: ContactParameters) {
        let Some(run) = &mut self.run else { return };
        // Exceptions of dropped bodies do not outlive these.
        let bodies = run.world.body_count();
        contact.pair_friction.retain(|pair| pair.bodies.iter().all(|body| *body < bodies));
        match run.world.set_contact_parameters(contact.clone()) {
            Ok(()) => self.contact = Some(contact),
            Err(error) => self.tell(format!("contact stays as it is: {error}")),
        }
    }

    fn drop_body(&mut self, kind: DropKind) {
        let (Some(run), None) = (&mut self.run, &self.run_error) else { return };
        let number = self.dropped + 1;
        match add_dropped(run, kind, number) {
            Ok(()) => self.dropped = number,
            Err(reason) => return self.tell(format!("nothing was dropped: {reason}")),
        }
        if run.scene.description.gravity_m_s2.length() < 1e-6 {
            self.tell("There is no gravity in this scene: what is dropped stays where it is.".to_owned());
        }
    }

    fn single_step(&mut self) {
        self.set_playing(false);
        let Some(run) = self.run.as_ref().filter(|_| self.run_error.is_none()) else { return };
        let limit_s = run.world.time_s() + run.world.setup().time.free_interval_s;
        if self.take_step(limit_s) {
            self.note_balances();
        }
    }

    /// Takes a step of the world; `false` when the run cannot go on.
    fn take_step(&mut self, limit_s: f64) -> bool {
        let Some(run) = &mut self.run else { return false };
        let before_s = run.world.time_s();
        match run.world.step(limit_s) {
            Ok(report) => {
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
        self.pressed_n_s += report.contact_force_n * report.step_s;
        self.pressed_s += report.step_s;
        self.standing_steps = if has_moved { 0 } else { self.standing_steps + 1 };
        if self.standing_steps < STANDING_STEPS {
            return true;
        }
        self.fail(format!(
            "Time stands still: {STANDING_STEPS} steps did not move it. Bodies may be wedged into each other; reset \
             the scene, or try a smaller time.cfl."
        ));
        false
    }

    /// Adds a row to the history.
    fn note_balances(&mut self) {
        let Some(run) = &self.run else { return };
        let force_n = if self.pressed_s > 0.0 { self.pressed_n_s / self.pressed_s } else { 0.0 };
        (self.pressed_n_s, self.pressed_s) = (0.0, 0.0);
        let row = Row::of(&run.world.sample(), run.world.time_s(), force_n);
        Arc::make_mut(&mut self.history).offer(row);
    }
}

fn add_dropped(run: &mut Run, kind: DropKind, number: usize) -> Result<(), String> {
    let body = body_to_drop(kind, number, &run.world).map_err(|error| error.to_string())?;
    let index = run.world.add_body(body).map_err(|error| error.to_string())?;
    run.body_names = names_of(&run.world);
    // The ground's own friction is meant for every body.
    let ground = run.scene.description.ground.as_ref().and_then(|ground| ground.friction_coefficient);
    let Some(friction_coefficient) = ground else { return Ok(()) };
    let mut contact = run.world.setup().contact.clone();
    let now = contact.pair_friction.iter().find(|pair| pair.bodies.contains(&GROUND_BODY));
    let friction_coefficient = now.map_or(friction_coefficient, |pair| pair.friction_coefficient);
    contact.pair_friction.push(PairFriction { bodies: [GROUND_BODY, index], friction_coefficient });
    run.world.set_contact_parameters(contact).map_err(|error| error.to_string())
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
fn is_reached(time_s: f64, moment_s: f64) -> bool {
    const ROUNDING: f64 = 1e-12;
    time_s >= moment_s * (1.0 - ROUNDING)
}

/// Longest stretch of steps between looks at the commands, s of wall time.
pub const SLICE_S: f64 = 0.5 * FRAME_S;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::csv::HistoryWriter;

    fn opened(scene: &str, overrides: &[&str]) -> Session {
        let mut session = Session::default();
        let overrides = overrides.iter().map(|text| (*text).to_owned()).collect();
        session.execute(Command::Open { scene: scene.to_owned(), overrides, play: true });
        session
    }

    /// Plays so many moments, as on a machine that is always in time.
    fn play(session: &mut Session, moments: u32) {
        for moment in 0..moments {
            assert!(session.advance(f64::from(moment) * FRAME_S, || false));
        }
    }

    #[test]
    fn a_scene_plays_at_its_own_slow_motion() {
        let mut session = opened("bounce", &[]);
        play(&mut session, 30);
        let snapshot = session.snapshot();
        let slow_motion = snapshot.scene.unwrap().description.recording.slow_motion;
        assert!((snapshot.frame.time_s - 30.0 * FRAME_S / slow_motion).abs() < 1e-9);
        assert_eq!(snapshot.history.rows().len(), 31);
        assert!(snapshot.stable_step_s.is_finite() && snapshot.is_playing);
    }

    #[test]
    fn what_is_seen_does_not_depend_on_the_clock() {
        let (mut punctual, mut late) = (opened("bounce", &[]), opened("bounce", &[]));
        play(&mut punctual, 80);
        let mut moments = 0;
        while moments < 80 {
            // Interrupted after every step, and far behind.
            moments += u32::from(late.advance(f64::from(moments) * 9.0, || true));
        }
        assert_eq!(punctual.history, late.history);
    }

    #[test]
    fn elastic_steps_do_not_depend_on_the_speed() {
        let elastic_steps_at = |speed: f64| {
            let mut session = opened("rods-collision", &[]);
            session.execute(Command::SetSpeed(speed));
            let mut free_steps = 0;
            while session.time_s() < 1e-4 {
                session.advance(0.0, || false);
                let world = &session.run.as_ref().unwrap().world;
                if !world.is_deforming() {
                    free_steps = world.steps();
                }
            }
            let world = &session.run.as_ref().unwrap().world;
            (world.steps() - free_steps, world.sample().balance_j())
        };
        assert_eq!(elastic_steps_at(1.0 / 2e4), elastic_steps_at(1.0 / 3e5));
    }

    #[test]
    fn playing_hurries_to_what_the_recording_shows_unless_a_speed_was_chosen() {
        let scene = ["recording.start=0.0405", "recording.slow_motion=1000"];
        let mut session = opened("bounce", &scene);
        play(&mut session, 3);
        assert!((session.time_s() - 0.0405).abs() < 1e-3, "{}", session.time_s());
        play(&mut session, 3);
        assert!(session.time_s() < 0.041, "{}", session.time_s());
        let mut chosen = opened("bounce", &scene);
        chosen.execute(Command::SetSpeed(1e-3));
        play(&mut chosen, 3);
        assert!(chosen.time_s() < 1e-3, "{}", chosen.time_s());
    }

    #[test]
    fn playing_pauses_at_the_end_and_goes_on_beyond_when_asked_again() {
        let mut session = opened("bounce", &["time.duration=0.0405"]);
        play(&mut session, 300);
        let snapshot = session.snapshot();
        assert!(!snapshot.is_playing && is_reached(snapshot.frame.time_s, 0.0405));
        assert!(snapshot.frame.time_s < 0.041, "{}", snapshot.frame.time_s);
        assert_eq!(snapshot.over_after_s(), Some(0.0405));
        session.execute(Command::Play);
        play(&mut session, 30);
        let beyond = session.snapshot();
        assert!(beyond.is_playing && beyond.frame.time_s > snapshot.frame.time_s);
        assert_eq!(beyond.over_after_s(), None);
        session.execute(Command::Reset { overrides: Vec::new() });
        assert_eq!(session.snapshot().over_after_s(), None);
    }

    #[test]
    fn pause_step_and_reset_do_what_they_say() {
        let mut session = opened("bounce", &[]);
        play(&mut session, 5);
        session.execute(Command::Pause);
        let paused_s = session.time_s();
        assert_eq!(session.wait_s(0.0), None);
        session.advance(10.0, || false);
        assert_eq!(session.time_s(), paused_s);
        session.execute(Command::Step);
        assert!(session.time_s() > paused_s && !session.is_playing());
        session.execute(Command::Reset { overrides: Vec::new() });
        let snapshot = session.snapshot();
        assert_eq!((snapshot.frame.time_s, snapshot.history.rows().len()), (0.0, 1));
    }

    /// history.csv of the session's world from where it stands to `until_s`, a row for every step.
    fn history_csv(session: &mut Session, until_s: f64) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut history = HistoryWriter::create(&path).unwrap();
        let world = &mut session.run.as_mut().unwrap().world;
        while !is_reached(world.time_s(), until_s) {
            world.step(until_s).unwrap();
            history.write(&world.sample()).unwrap();
        }
        drop(history);
        std::fs::read_to_string(path).unwrap()
    }

    #[test]
    fn every_reset_gives_the_same_bytes_on_one_and_two_threads() {
        // Two bodies of several thousand elements, in contact from 30 us on.
        const UNTIL_S: f64 = 4e-5;
        let runs = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut session = opened("rods-collision-fine", &[]);
                let first = history_csv(&mut session, UNTIL_S);
                session.execute(Command::Reset { overrides: Vec::new() });
                [first, history_csv(&mut session, UNTIL_S)]
            })
        });
        let first = &runs[0][0];
        assert!(first.contains("collision") && first.lines().count() > 50, "{first}");
        assert!(runs.iter().flatten().all(|history| history == first));
    }

    #[test]
    fn overrides_act_at_the_reset_and_on_the_scene_as_opened() {
        let mut session = opened("hammer-ground", &[]);
        let modulus = |session: &mut Session| {
            let scene = session.snapshot().scene.unwrap();
            scene.description.materials.iter().find(|m| m.name == "head").unwrap().youngs_modulus_pa
        };
        let before = modulus(&mut session);
        session.execute(Command::Reset { overrides: vec!["materials.head.youngs_modulus=2e6".to_owned()] });
        assert_eq!(modulus(&mut session), 2e6);
        session.execute(Command::Reset { overrides: vec!["materials.head.youngs_modulus=-1".to_owned()] });
        assert_eq!(modulus(&mut session), 2e6);
        assert!(session.snapshot().notice.unwrap().text.contains("youngs_modulus"));
        session.execute(Command::Reset { overrides: Vec::new() });
        assert_eq!(modulus(&mut session), before);
    }

    #[test]
    fn contact_acts_at_once_and_outlives_a_reset() {
        let mut session = opened("bounce", &[]);
        let contact = ContactParameters { friction_coefficient: 0.9, ..session.snapshot().contact.unwrap() };
        session.execute(Command::SetContact(contact.clone()));
        assert_eq!(session.snapshot().contact.as_ref(), Some(&contact));
        session.execute(Command::Reset { overrides: Vec::new() });
        assert_eq!(session.snapshot().contact, Some(contact.clone()));
        session.execute(Command::SetContact(ContactParameters {
            friction_coefficient: -1.0,
            ..contact.clone()
        }));
        assert_eq!(session.snapshot().contact, Some(contact));
        assert!(session.snapshot().notice.is_some());
    }

    #[test]
    fn dropped_bodies_start_clear_of_all_others_and_fall() {
        let mut session = opened("hammer-ground", &[]);
        for kind in [DropKind::Hammer, DropKind::Cube, DropKind::Ball, DropKind::Cube] {
            session.execute(Command::Drop(kind));
        }
        let setup = session.run.as_ref().unwrap().world.setup().clone();
        assert_eq!(setup.bodies.len(), 6);
        for second in 1..setup.bodies.len() {
            for first in 0..second {
                let [a, b] = [first, second].map(|body| &setup.bodies[body].mesh);
                assert_eq!(crate::scene::overlap(a, b), None, "{first} {second}");
            }
        }
        let kinetic = |session: &Session| session.history.rows().last().unwrap().kinetic_j;
        let before = kinetic(&session);
        play(&mut session, 60);
        assert!(kinetic(&session) > before && session.run_error.is_none());
        assert_eq!(session.snapshot().frame.bodies.len(), 6);
    }

    #[test]
    fn a_broken_scene_is_told_and_the_old_one_stays() {
        let mut session = opened("bounce", &[]);
        let open = |scene: &str| Command::Open { scene: scene.to_owned(), overrides: vec![], play: true };
        session.execute(open("no-such-scene"));
        let snapshot = session.snapshot();
        assert!(snapshot.notice.unwrap().text.contains("no-such-scene"));
        assert_eq!(snapshot.scene.unwrap().name, "bounce");
    }

    #[test]
    fn a_failed_run_keeps_its_last_frame_until_the_reset() {
        let mut session = opened("bounce", &[]);
        play(&mut session, 5);
        let time_s = session.snapshot().frame.time_s;
        session.fail("blown up".to_owned());
        session.execute(Command::Play);
        session.execute(Command::Step);
        session.execute(Command::Drop(DropKind::Ball));
        let snapshot = session.snapshot();
        assert!(!snapshot.is_playing && snapshot.run_error.is_some());
        assert_eq!(snapshot.frame.time_s, time_s);
        session.execute(Command::Reset { overrides: Vec::new() });
        session.execute(Command::Play);
        assert!(session.is_playing() && session.snapshot().run_error.is_none());
    }
}
