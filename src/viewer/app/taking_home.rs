//! Taking it home: what is saved, where to, and what is said of it.

use super::{App, PASSING_S};
use crate::render::{Caption, View};
use crate::viewer::saver::Finished;
use crate::viewer::saving::{self, GIF_FPS, Job, MOST_PICTURES, Outcome, Shot};

/// Width of the largest animation, pixels: larger ones get unwieldy.
const LARGEST_GIF_PX: u32 = 960;
/// How often the window looks how far saving is.
const SAVING_LOOK: std::time::Duration = std::time::Duration::from_millis(50);

/// What can be saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveKind {
    /// The moment shown, as PNG.
    Picture,
    /// A range of the timeline, as GIF.
    Animation,
    /// The scene, as TOML.
    Scene,
    /// The fragments, as OBJ.
    Obj,
    /// The fragments, as PLY.
    Ply,
}

/// Where files go, and what came of the last ones.
#[derive(Clone, Debug)]
pub struct SaveState {
    /// Folder.
    pub folder: String,
    /// Range of the animation, percent of the recording; `None`: all of it.
    pub shares: Option<[f64; 2]>,
    /// How the last ones came out, in the order in which they did.
    pub(super) told: Vec<Told>,
    /// Whether that can be read in its panel.
    pub is_in_sight: bool,
}

impl Default for SaveState {
    fn default() -> Self {
        let here = std::env::current_dir().unwrap_or_default();
        Self {
            folder: here.to_string_lossy().into_owned(),
            shares: None,
            told: Vec::new(),
            is_in_sight: false,
        }
    }
}

/// How saving something came out.
#[derive(Clone, Debug)]
pub(super) struct Told {
    /// Of what kind of file.
    ending: &'static str,
    outcome: Outcome,
    /// When, s.
    at_s: f64,
    /// Whether somebody has tried again since.
    is_answered: bool,
    /// Whether it is no longer said over the picture.
    is_closed: bool,
}

impl Told {
    fn line(&self) -> (&str, bool) {
        match &self.outcome {
            Ok(text) => (text, false),
            Err(text) => (text, true),
        }
    }
}

impl SaveState {
    /// The last outcomes, and whether each is a failure.
    pub fn lines(&self) -> impl Iterator<Item = (&str, bool)> {
        self.told.iter().map(Told::line)
    }

    /// What is said of them over the picture, a line each, and whether there is a failure among it: those that can be read in
    /// their panel only if they failed.
    #[must_use]
    pub fn notice(&self) -> Option<(String, bool)> {
        let is_said = |told: &&Told| !told.is_closed && (!self.is_in_sight || told.outcome.is_err());
        let lines: Vec<(&str, bool)> = self.told.iter().filter(is_said).map(Told::line).collect();
        let text = lines.iter().map(|(text, _)| *text).collect::<Vec<_>>().join("\n");
        (!lines.is_empty()).then(|| (text, lines.iter().any(|(_, is_failure)| *is_failure)))
    }

    /// Nothing more is said over the picture.
    pub(super) fn close(&mut self) {
        self.told.iter_mut().for_each(|told| told.is_closed = true);
    }

    /// Something is about to be saved: what has been read by now goes.
    fn begin(&mut self, ending: &str, now_s: f64) {
        self.told.retain(|told| now_s - told.at_s < PASSING_S);
        let same = self.told.iter_mut().filter(|told| told.ending == ending);
        same.for_each(|told| told.is_answered = true);
    }

    /// Something came out so. When it worked, failures before it are of no interest any more.
    fn tell(&mut self, Finished { ending, outcome }: Finished, at_s: f64) {
        if outcome.is_ok() {
            self.told.retain(|told| !(told.is_answered && told.ending == ending && told.outcome.is_err()));
        }
        let outcome = outcome.map(|text| in_a_sentence(&text)).map_err(|text| format!("Not saved: {text}"));
        self.told.push(Told { ending, outcome, at_s, is_answered: false, is_closed: false });
    }

    /// What worked is said for some seconds; how long until then, s.
    fn let_pass(&mut self, now_s: f64) -> Option<f64> {
        for told in self.told.iter_mut().filter(|told| told.outcome.is_ok()) {
            told.is_closed |= now_s - told.at_s >= PASSING_S;
        }
        let open = self.told.iter().filter(|told| told.outcome.is_ok() && !told.is_closed);
        open.map(|told| told.at_s + PASSING_S - now_s).reduce(f64::min)
    }

    /// Start and end of the animation, s, of a recording that ends at `end_s`.
    #[must_use]
    pub fn range(&self, end_s: f64) -> [f64; 2] {
        self.shares.unwrap_or([0.0, 100.0]).map(|share| 0.01 * share * end_s)
    }
}

impl App {
    /// Times of the pictures of the animation, s.
    #[must_use]
    pub fn animation_times(&self) -> Vec<f64> {
        let end_s = self.snapshot.recording.moments().last().map_or(0.0, |moment| moment.time_s);
        let [from_s, to_s] = self.save.range(end_s);
        let wall_s = (to_s - from_s) / self.snapshot.speed.max(1e-9);
        let count = ((wall_s * GIF_FPS).ceil() as usize).clamp(1, MOST_PICTURES);
        let step_s = (to_s - from_s) / count as f64;
        (0..=count).map(|index| from_s + step_s * index as f64).collect()
    }

    fn shot(&self, with_motion: bool) -> Shot {
        let mut size_px = self.viewport.map_or([960, 540], |area| {
            // Even sizes, which every player likes.
            [area.width(), area.height()].map(|side| (side / 2.0).round().max(32.0) as u32 * 2)
        });
        if with_motion && size_px[0] > LARGEST_GIF_PX {
            let scale = f64::from(LARGEST_GIF_PX) / f64::from(size_px[0]);
            size_px = size_px.map(|side| (f64::from(side) * scale / 2.0).round().max(16.0) as u32 * 2);
        }
        let slow_motion = (with_motion && self.snapshot.speed > 0.0).then(|| 1.0 / self.snapshot.speed);
        let caption = Caption { show_time: true, slow_motion, text: String::new() };
        let view = View { caption: Some(caption), ..self.look.view(1.0) };
        Shot { camera: self.look.camera, view, seeing: self.look.seeing(), size_px }
    }

    pub(super) fn save(&mut self, kind: SaveKind) {
        let Some(scene) = self.snapshot.scene.clone() else { return };
        let job = match kind {
            SaveKind::Picture => Job::Picture(self.drawn().clone(), Box::new(self.shot(false))),
            SaveKind::Animation => {
                let recording = &self.snapshot.recording;
                let at = |time_s| recording.at(time_s).map(|moment| moment.frame.clone());
                let frames = self.animation_times().into_iter().filter_map(at).collect();
                Job::Animation(frames, Box::new(self.shot(true)))
            }
            SaveKind::Scene => {
                let snapshot = &self.snapshot;
                let late = (&*snapshot.late_text, snapshot.frame.time_s);
                match saving::scene_text(&scene, late, &self.look, snapshot.speed) {
                    Ok(text) => Job::Scene(text),
                    Err(reason) => {
                        self.save.begin("toml", self.now_s);
                        return self.save.tell(Finished { ending: "toml", outcome: Err(reason) }, self.now_s);
                    }
                }
            }
            // Whole and where it is: cuts and explosions are only for the eye.
            SaveKind::Obj => Job::Obj(self.shown().clone()),
            SaveKind::Ply => Job::Ply(self.shown().clone()),
        };
        let ending = job.ending();
        self.save.begin(ending, self.now_s);
        if let Err(reason) = self.saver.start(job, &self.save.folder, &scene.name) {
            self.save.tell(Finished { ending, outcome: Err(reason) }, self.now_s);
        }
    }

    /// Tells how saving came out. A failure stays until it is closed, or it has worked.
    pub(super) fn look_after_saving(&mut self, context: &egui::Context) {
        while let Some(finished) = self.saver.finished() {
            self.save.tell(finished, self.now_s);
        }
        let passes_in = self.save.let_pass(self.now_s).map(std::time::Duration::from_secs_f64);
        passes_in.into_iter().for_each(|wait| context.request_repaint_after(wait));
        if self.saver.is_busy() {
            context.request_repaint_after(SAVING_LOOK);
        }
    }
}

/// A text with a large letter at its beginning.
pub fn in_a_sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}", letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(save: &SaveState) -> Vec<String> {
        let notice = save.notice().map(|(text, _)| text).unwrap_or_default();
        notice.lines().map(str::to_owned).collect()
    }

    /// The failure stayed over what worked after it, and of two saves only the last one was told.
    #[test]
    fn every_outcome_is_told_and_old_ones_go() {
        let mut save = SaveState::default();
        let finished = |ending, outcome: Result<&str, &str>| Finished {
            ending,
            outcome: outcome.map(str::to_owned).map_err(str::to_owned),
        };
        save.begin("png", 0.0);
        save.begin("toml", 0.1);
        save.tell(finished("png", Ok("saved a.png")), 0.2);
        save.tell(finished("toml", Err("the disk is full")), 0.3);
        assert_eq!(lines(&save), ["Saved a.png", "Not saved: the disk is full"]);
        assert!(save.notice().unwrap().1);
        // Said long enough, what worked goes; what failed does not.
        assert!(save.let_pass(1.0).is_some_and(|wait_s| wait_s > 0.0));
        assert_eq!(save.let_pass(20.0), None);
        assert_eq!(lines(&save), ["Not saved: the disk is full"]);
        // Another kind of file does not answer it, trying again does.
        let failure = save.told.last().unwrap().clone();
        save.told = vec![Told { at_s: 20.0, ..failure }];
        save.begin("obj", 20.1);
        save.tell(finished("obj", Ok("saved a.obj")), 20.2);
        assert_eq!(lines(&save).len(), 2);
        save.begin("toml", 20.3);
        save.tell(finished("toml", Ok("saved a.toml")), 20.4);
        assert_eq!(lines(&save), ["Saved a.obj", "Saved a.toml"]);
        // In sight in its panel nothing is said twice.
        save.is_in_sight = true;
        assert!(save.notice().is_none() && save.lines().count() == 2);
        save.is_in_sight = false;
        save.close();
        assert!(save.notice().is_none());
        save.begin("png", 40.0);
        assert_eq!(save.lines().count(), 0);
    }
}
