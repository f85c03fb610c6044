//! Taking it home: pictures, animations, the scene, the fragments. All of it is done by threads of their own, so that a slow
//! disk never stops the window.

use super::closer::Seeing;
use super::look::Look;
use super::pacing::FRAME_S;
use super::recording::frame_bytes;
use crate::export::gif::GifWriter;
use crate::export::png::write_png;
use crate::export::surface_mesh::{write_obj, write_ply};
use crate::export::{ExportError, write_whole};
use crate::frame::Frame;
use crate::math::{to_digits, to_digits_of};
use crate::render::{Camera, Cut, Gpu, OffScreen, Picture, View, cross_scale_pa};
use crate::scene::description::Recording;
use crate::scene::{Scene, SceneDescription, Shape};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Pictures from all over an animation from which its colours are learnt.
const SAMPLES: usize = 5;
/// Most pictures of an animation.
pub const MOST_PICTURES: usize = 1000;
/// Pictures a second of animations.
pub const GIF_FPS: f64 = 25.0;

/// From where and how pictures are taken.
#[derive(Clone, Debug)]
pub struct Shot {
    /// From where.
    pub camera: Camera,
    /// How.
    pub view: View,
    /// What is done to the frames of an animation before.
    pub seeing: Seeing,
    /// Width and height, pixels.
    pub size_px: [u32; 2],
}

/// What is to be saved.
pub enum Job {
    /// The moment shown, as PNG.
    Picture(Arc<Frame>, Box<Shot>),
    /// Moments, as GIF.
    Animation(Vec<Arc<Frame>>, Box<Shot>),
    /// A scene's text.
    Scene(String),
    /// The fragments, as OBJ.
    Obj(Arc<Frame>),
    /// The same as PLY.
    Ply(Arc<Frame>),
}

impl Job {
    /// Of its file.
    pub(super) fn ending(&self) -> &'static str {
        match self {
            Self::Picture(..) => "png",
            Self::Animation(..) => "gif",
            Self::Scene(_) => "toml",
            Self::Obj(_) => "obj",
            Self::Ply(_) => "ply",
        }
    }

    /// So many things are drawn or written for it.
    pub(super) fn steps(&self) -> usize {
        match self {
            Self::Animation(frames, _) => frames.len(),
            _ => 1,
        }
    }
}

/// How a job came out.
pub type Outcome = Result<String, String>;

/// The device for saving, opened with the first picture.
#[derive(Clone, Default)]
pub(super) struct Studio(Arc<Mutex<Option<Gpu>>>);

impl Studio {
    fn open(&self) -> Result<OffScreen, String> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let gpu = match known.take() {
            Some(gpu) => gpu,
            None => Gpu::headless().map_err(|error| error.to_string())?,
        };
        let screen = OffScreen::new(&gpu).map_err(|error| error.to_string())?;
        // A device that was lost is not kept, and the next picture opens a new one; so with `forget`.
        *known = Some(gpu);
        Ok(screen)
    }

    /// After a picture that could not be drawn.
    fn forget(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

/// What a job tells on its way, is told, and draws with.
pub(super) struct Progress {
    /// Steps that are done.
    pub done: Arc<AtomicUsize>,
    /// Whether it should end.
    pub wants_end: Arc<AtomicBool>,
    /// Draws its pictures.
    pub studio: Studio,
}

/// The first name that is not taken: nothing is ever written over.
pub(super) fn free_path(folder: &Path, stem: &str, ending: &str) -> PathBuf {
    let folder = match folder.to_str().and_then(|text| text.strip_prefix("~/")) {
        Some(rest) => std::env::home_dir().map_or_else(|| folder.to_owned(), |home| home.join(rest)),
        None => folder.to_owned(),
    };
    let names = std::iter::once(format!("{stem}.{ending}"));
    let mut names = names.chain((2_u32..).map(|number| format!("{stem}-{number}.{ending}")));
    names.find(|name| !folder.join(name).exists()).map_or_else(|| folder.join(stem), |name| folder.join(name))
}

/// Does a job.
pub(super) fn save(job: &Job, path: &Path, progress: &Progress) -> Outcome {
    let words = |error: ExportError| error.to_string();
    let shown = path.display();
    match job {
        Job::Picture(frame, shot) => {
            let mut screen = progress.studio.open()?;
            let picture = screen.render(shot.size_px, frame, &shot.camera, &shot.view);
            let picture = picture.map_err(|error| {
                progress.studio.forget();
                error.to_string()
            })?;
            write_png(path, &picture).map_err(words)?;
        }
        Job::Animation(frames, shot) => return animation(frames, shot, path, progress),
        Job::Scene(text) => write_whole(path, text.as_bytes()).map_err(words)?,
        Job::Obj(frame) => write_obj(path, frame).map_err(words)?,
        Job::Ply(frame) => write_ply(path, frame).map_err(words)?,
    }
    Ok(format!("saved {shown}"))
}

fn animation(frames: &[Arc<Frame>], shot: &Shot, path: &Path, progress: &Progress) -> Outcome {
    let mut screen = progress.studio.open()?;
    if frames.is_empty() {
        return Err("nothing is recorded yet".to_owned());
    }
    let film = Film::new(frames, shot, &progress.wants_end);
    let mut draw = |index: usize| {
        let picture = screen.render(shot.size_px, &film.seen(index), &shot.camera, &film.view);
        picture.map_err(|error| {
            progress.studio.forget();
            error.to_string()
        })
    };
    let samples = (0..frames.len()).step_by(frames.len().div_ceil(SAMPLES).max(1)).map(&mut draw);
    let samples: Vec<Picture> = samples.collect::<Result<_, _>>()?;
    let words = |error: ExportError| error.to_string();
    let samples: Vec<&Picture> = samples.iter().collect();
    let mut writer = GifWriter::create(path, shot.size_px, GIF_FPS, &samples).map_err(words)?;
    for index in 0..frames.len() {
        if progress.wants_end.load(Ordering::Relaxed) {
            writer.finish().map_err(words)?;
            if index == 0 {
                return Ok("stopped before the first picture".to_owned());
            }
            return Ok(format!("stopped: {} keeps the first {index} pictures", path.display()));
        }
        let kept = |error: String| match index {
            0 => {
                // An empty file is no animation.
                let _ = std::fs::remove_file(path);
                error
            }
            _ => format!("{error}; the first {index} pictures are in {}", path.display()),
        };
        let picture = draw(index).map_err(kept)?;
        writer.push(&picture).map_err(words).map_err(kept)?;
        progress.done.store(index + 1, Ordering::Relaxed);
    }
    writer.finish().map_err(words)?;
    let lacks = shot.seeing.lacks(frames.iter().map(|frame| &**frame));
    let lacks = lacks.map(|lacks| format!(", {lacks}")).unwrap_or_default();
    Ok(format!("saved {} with {} pictures{lacks}", path.display(), frames.len()))
}

/// Memory for frames that were looked into for the measure of their stress crosses, bytes. What goes beyond it is looked into
/// once more when it is drawn.
const MOST_KEPT_BYTES: usize = 256 << 20;

/// The frames of an animation as they are drawn, and their view: stress crosses are measured by all of them.
struct Film<'a> {
    frames: &'a [Arc<Frame>],
    seeing: Seeing,
    view: View,
    /// The first of the frames as they are drawn, as far as they had to be made.
    kept: Vec<Arc<Frame>>,
}

impl<'a> Film<'a> {
    /// Looks into the frames until somebody wants that to end.
    fn new(frames: &'a [Arc<Frame>], shot: &Shot, wants_end: &AtomicBool) -> Self {
        let mut film = Self { frames, seeing: shot.seeing, view: shot.view.clone(), kept: Vec::new() };
        let (mut bytes, mut scale_pa) = (0, film.view.cross_scale_pa);
        let is_measured = |_: &usize| shot.seeing.with_crosses && !wants_end.load(Ordering::Relaxed);
        for index in (0..frames.len()).take_while(is_measured) {
            let seen = film.seen(index);
            scale_pa = scale_pa.into_iter().chain(cross_scale_pa([&*seen])).reduce(f32::max);
            bytes += frame_bytes(&seen, film.kept.last().map(|before| &**before));
            if film.kept.len() == index && bytes < MOST_KEPT_BYTES {
                film.kept.push(seen);
            }
        }
        film.view.cross_scale_pa = scale_pa;
        film
    }

    /// A frame as it is drawn.
    fn seen(&self, index: usize) -> Arc<Frame> {
        if self.seeing.is_plain() {
            return self.frames[index].clone();
        }
        let kept = self.kept.get(index);
        kept.cloned().unwrap_or_else(|| Arc::new(self.seeing.of(&self.frames[index])))
    }
}

/// The text of a scene that gives again what is seen: bodies thrown in and taken out, `late_text` with what else was
/// done on the way, camera, speed and colours. It lasts at least until `seen_s`.
///
/// # Errors
/// What does not go into a scene.
pub fn scene_text(
    scene: &Scene,
    (late_text, seen_s): (&str, f64),
    look: &Look,
    speed: f64,
) -> Result<String, String> {
    let taken = |name: &String| scene.description.cameras.iter().any(|camera| camera.name == *name);
    let mut names = std::iter::once("saved".to_owned()).chain((2..).map(|n| format!("saved-{n}")));
    let name = names.find(|name| !taken(name)).unwrap_or_default();
    let camera = look.camera;
    let [x, y, z] = camera.target_m.to_array();
    let degrees = |angle_rad: f32| to_digits_of(f64::from(angle_rad).to_degrees(), 1.0, 5);
    let text = format!(
        "[cameras.{name}]\ntarget = [{x:?}, {y:?}, {z:?}]\nyaw = {:?}\npitch = {:?}\ndistance = {:?}\nfield_of_view = {:?}\n",
        degrees(camera.yaw_rad),
        degrees(camera.pitch_rad).clamp(-89.0, 89.0),
        camera.distance_m,
        degrees(camera.fov_y_rad),
    );
    let scene = scene.with_text(&format!("{late_text}{text}")).map_err(|error| error.to_string())?;
    let mut overrides = vec![
        format!("recording.camera={name:?}"),
        format!("recording.slow_motion={:?}", to_digits(1.0 / speed.clamp(1e-9, 1.0), 12)),
        format!("recording.color_by={}", look.color_by.name()),
    ];
    overrides.extend(closer_look(&scene.description.recording, look));
    let end_s = last_needed_s(&scene.description, seen_s, speed);
    if end_s > scene.description.duration_s {
        overrides.push(format!("time.duration={end_s:?}"));
    }
    overrides.extend(whole_paths(&scene));
    let scene = scene.with_overrides(&overrides).map_err(|error| error.to_string())?;
    Ok(scene.to_toml())
}

/// The time that a scene has to reach, s: that of the moment seen, and a little more where something was done in it, which
/// would not come before the end.
fn last_needed_s(scene: &SceneDescription, seen_s: f64, speed: f64) -> f64 {
    let end_s = seen_s.max(scene.duration_s);
    let entrances = scene.bodies.iter().filter_map(|body| body.enters_s);
    let removals = scene.removals.iter().map(|removal| removal.at_s);
    let contact_changes = scene.contact_changes.iter().map(|change| change.at_s);
    let mut done_s = entrances.chain(removals).chain(contact_changes);
    match done_s.any(|at_s| at_s == end_s && at_s <= seen_s) {
        true => (end_s + FRAME_S * speed.min(1.0)).max(end_s.next_up()),
        false => end_s,
    }
}

/// The cut, the crosses and the range of the colours, where they are not what the scene says.
fn closer_look(recording: &Recording, look: &Look) -> Vec<String> {
    let mut overrides = Vec::new();
    if look.closer.with_crosses != recording.crosses {
        overrides.push(format!("recording.crosses={}", look.closer.with_crosses));
    }
    match look.closer.cut() {
        Some(Cut { normal, position_m }) => {
            let [x, y, z] = normal.to_array().map(|part| part + 0.0);
            overrides
                .push(format!("recording.cut={{ across = [{x:?}, {y:?}, {z:?}], at = {position_m:?} }}"));
        }
        None if recording.cut.is_some() => overrides.push("recording.cut=none".to_owned()),
        None => {}
    }
    let is_sound = look.typed_range.range(look.color_by).is_ok_and(|range| range.is_some());
    match look.typed_range.ends(look.color_by) {
        Ok(ends) if is_sound && ends == recording.color_range => {}
        Ok(Some([low, high])) if is_sound => {
            overrides.push(format!("recording.color_range=[{low:?}, {high:?}]"));
        }
        _ if recording.color_range.is_some() => overrides.push("recording.color_range=found".to_owned()),
        _ => {}
    }
    overrides
}

/// Mesh files are found again wherever the scene is saved.
fn whole_paths(scene: &Scene) -> Vec<String> {
    let bodies = scene.description.bodies.iter().enumerate();
    let files = bodies.filter_map(|(index, body)| {
        let Shape::File(file) = &body.shape else { return None };
        let path = std::path::absolute(scene.folder().join(&file.file)).ok()?;
        Some(format!("bodies[{index}].mesh.file={:?}", path.to_string_lossy()))
    });
    files.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_saved_scene_has_camera_and_colours_of_the_window() {
        for name in ["brick-pile", "hammer-table", "rods-collision"] {
            let scene = Scene::load(name, &[]).unwrap();
            let mut look = Look::default();
            look.color_by = crate::frame::ColorBy::VonMises;
            look.camera.distance_m = 7.5;
            look.closer.toggle_cut(&Frame::default(), &look.camera);
            (look.closer.position_m, look.closer.is_flipped, look.closer.with_crosses) = (0.125, true, true);
            let typed = &mut look.typed_range;
            (typed.is_on, typed.low, typed.high) = (true, "-2 kPa".into(), "3 MPa".into());
            let late = "[[contact_changes]]\nat = 0.1\nfriction = 0.77\n\n";
            let text = scene_text(&scene, (late, 77.0), &look, 0.01).unwrap();
            let saved = Scene::from_text("saved", &text, scene.folder(), &[]).unwrap();
            assert_eq!(saved.setup.contact, scene.setup.contact, "{name}");
            assert_eq!(saved.setup.changes.len(), 1);
            assert_eq!(saved.description.duration_s, 77.0);
            assert_eq!(saved.setup.bodies, scene.setup.bodies);
            assert_eq!(saved.description.recording.color_by, look.color_by);
            // What was done in the moment that is seen last comes before the end.
            let late = "[[contact_changes]]\nat = 77.0\nfriction = 0.77\n\n";
            let text = scene_text(&scene, (late, 77.0), &look, 0.01).unwrap();
            let saved_late = Scene::from_text("saved", &text, scene.folder(), &[]).unwrap();
            assert!((77.0..77.1).contains(&saved_late.description.duration_s));
            assert_eq!(saved_late.warnings, scene.warnings);
            let camera = saved.description.cameras.iter().find(|camera| camera.name == "saved").unwrap();
            let framing = crate::render::Framing::default();
            let camera = super::super::scene_camera(camera, &framing, 1.5);
            assert!(
                (camera.distance_m - 7.5).abs() < 1e-5 && (camera.yaw_rad - look.camera.yaw_rad).abs() < 1e-5
            );
            // What is looked at comes back with it.
            let snapshot = |scene: Scene| super::super::snapshot::Snapshot {
                scene: Some(Arc::new(scene)),
                ..Default::default()
            };
            let mut again = Look::default();
            again.open(&snapshot(saved.clone()));
            assert_eq!(again.seeing(), look.seeing());
            assert_eq!(again.view(1.0).range, look.view(1.0).range);
            // And once more from there, with nothing of it.
            look.closer.toggle_cut(&Frame::default(), &look.camera);
            (look.closer.with_crosses, look.typed_range.is_on) = (false, false);
            let text = scene_text(&saved, ("", 1.0), &look, 0.01).unwrap();
            again.open(&snapshot(Scene::from_text("saved", &text, scene.folder(), &[]).unwrap()));
            assert!(again.seeing().is_plain() && !again.typed_range.is_on);
        }
    }

    /// The pictures of one animation have one measure of stress crosses, that of the largest stress among them.
    #[test]
    fn stress_crosses_of_an_animation_have_one_measure() {
        let mut world = crate::sim::World::new(Scene::load("bar-torn", &[]).unwrap().setup).unwrap();
        let mut frames = Vec::new();
        for _ in 0..3 {
            for _ in 0..40 {
                world.step(1.0).unwrap();
            }
            frames.push(Arc::new(world.publish_with_interior()));
        }
        let mut look = Look::default();
        look.closer.with_crosses = true;
        look.make_room_for_crosses(&frames[0]);
        let shot =
            Shot { camera: look.camera, view: look.view(1.0), seeing: look.seeing(), size_px: [32, 32] };
        let own = frames.iter().map(|frame| cross_scale_pa([&shot.seeing.of(frame)]).unwrap());
        let own: Vec<f32> = own.collect();
        let most_pa = own.iter().copied().reduce(f32::max);
        assert!(own.iter().any(|scale_pa| Some(*scale_pa) != most_pa), "{own:?}");
        let film = Film::new(&frames, &shot, &AtomicBool::default());
        assert_eq!(film.view.cross_scale_pa, most_pa);
        // Each was looked into once, for measure and picture.
        assert_eq!(film.kept.len(), frames.len());
        assert!((0..3).all(|index| Arc::ptr_eq(&film.seen(index), &film.kept[index])));
        // One that was recorded without what is inside is told of.
        frames[1] = Arc::new(Frame { bodies: world.publish().bodies, ..Frame::default() });
        let folder = tempfile::tempdir().unwrap();
        let progress =
            Progress { done: Arc::default(), wants_end: Arc::default(), studio: Studio::default() };
        let job = Job::Animation(frames.clone(), Box::new(shot.clone()));
        let told = save(&job, &folder.path().join("mine.gif"), &progress).unwrap();
        assert!(told.contains("with 3 pictures, 1 of them without stress crosses"), "{told}");
        frames.remove(1);
        let rooms = frames.iter().map(|frame| shot.seeing.of(frame).crosses[0].room_m);
        assert!(rooms.into_iter().all(|room_m| Some(room_m) == shot.seeing.cross_room_m));
    }

    #[test]
    fn saving_never_writes_over_a_file_and_tells_what_the_disk_says() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().to_str().unwrap();
        let mut saver = super::super::saver::Saver::default();
        let mut save = |folder: &str| {
            saver.start(Job::Scene("title = \"x\"".to_owned()), folder, "mine").unwrap();
            loop {
                if let Some(finished) = saver.finished() {
                    return finished.outcome;
                }
                std::thread::sleep(std::time::Duration::from_millis(2));
            }
        };
        assert!(save(place).unwrap().ends_with("mine.toml"));
        assert!(save(place).unwrap().ends_with("mine-2.toml"));
        let nowhere = format!("{place}/nowhere");
        assert!(save(&nowhere).unwrap_err().contains("does not exist"), "no folder");
        #[cfg(target_os = "linux")]
        assert!(save("/dev/full").is_err() && save("/proc").is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told_for_every_kind_of_file_and_nothing_is_left_of_it() {
        let frame = Arc::new(Frame::default());
        let look = Look::default();
        let shot =
            Shot { camera: look.camera, view: look.view(1.0), seeing: look.seeing(), size_px: [32, 32] };
        let folder = tempfile::tempdir().unwrap();
        let jobs = [
            Job::Picture(frame.clone(), Box::new(shot.clone())),
            Job::Animation(vec![frame.clone(); 3], Box::new(shot)),
            Job::Scene("title = \"x\"".to_owned()),
            Job::Obj(frame.clone()),
            Job::Ply(frame),
        ];
        for job in jobs {
            let path = folder.path().join(format!("mine.{}", job.ending()));
            let is_animation = matches!(job, Job::Animation(..));
            // What is written goes to a device that is always full: an animation straight, all else by a file beside.
            let full = if is_animation { path.clone() } else { crate::export::partial_name(&path) };
            if !is_animation {
                std::fs::write(&path, "old").unwrap();
            }
            std::os::unix::fs::symlink("/dev/full", &full).unwrap();
            let progress =
                Progress { done: Arc::default(), wants_end: Arc::default(), studio: Studio::default() };
            let told = save(&job, &path, &progress).unwrap_err();
            assert!(told.contains("the disk is full"), "{}: {told}", job.ending());
            assert!(full.symlink_metadata().is_err(), "{} is left", full.display());
            assert!(is_animation || std::fs::read(&path).unwrap() == b"old");
        }
    }
}
