//! What `render` shows: which moments, from where, in which colours.

use super::failure::Failure;
use super::looking::{CutChoice, Looking, color_range};
use super::picture_output::OutputKind;
use super::render::RenderArgs;
use crate::frame::{ColorBy, Frame};
use crate::render::{
    Background, Camera, Caption, Framing, Gpu, GpuError, Ground, NamedView, OffScreen, Picture, Range, View,
    cross_scale_pa,
};
use crate::scene::SceneDescription;
use crate::scene::description::Camera as SceneCamera;
use crate::viewer::scene_camera;

/// More pictures than this are surely a slip of the slow motion or the rate.
const MOST_FRAMES: f64 = 10_000.0;

/// Players slow down what is faster.
const MOST_GIF_FPS: f64 = 50.0;

/// Which pictures to take, and how.
pub struct Shot {
    moments: Moments,
    camera: CameraChoice,
    color_by: ColorBy,
    /// Ends of the colour map, if somebody chose them.
    range: Option<Range>,
    looking: Looking,
    wireframe: bool,
    is_dark: bool,
    caption: Option<Caption>,
    /// Width and height, pixels.
    pub size_px: [u32; 2],
    /// Pictures a second.
    pub fps: f64,
}

/// When pictures are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Moments {
    One { at_s: f64 },
    Even { start_s: f64, interval_s: f64, count: u32 },
}

impl Moments {
    fn time_s(self, index: u32) -> f64 {
        match self {
            Self::One { at_s } => at_s,
            Self::Even { start_s, interval_s, .. } => start_s + f64::from(index) * interval_s,
        }
    }

    fn count(self) -> u32 {
        match self {
            Self::One { .. } => 1,
            Self::Even { count, .. } => count,
        }
    }
}

/// Where the picture is taken from, before it is known what there is to see.
#[derive(Clone, Debug, PartialEq)]
enum CameraChoice {
    OfScene(SceneCamera),
    Named(NamedView),
}

/// Everything about a picture but the frame.
pub struct Setting {
    camera: Camera,
    view: View,
    size_px: [u32; 2],
}

impl Shot {
    /// Settles what the arguments leave open by what the scene says.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for an unknown camera, or far too many pictures.
    pub fn new(args: &RenderArgs, scene: &SceneDescription, kind: OutputKind) -> Result<Self, Failure> {
        let recording = &scene.recording;
        let slow_motion = args.slow_motion.unwrap_or(recording.slow_motion);
        let fps = args.fps.unwrap_or(recording.fps);
        if kind == OutputKind::Gif && fps > MOST_GIF_FPS {
            return Err(Failure::BadInput(format!(
                "GIF players show at most {MOST_GIF_FPS} pictures a second, not {fps}; give --fps, or \
                 write a folder of PNGs"
            )));
        }
        let end_s = args.duration.unwrap_or(scene.duration_s);
        let moments = match kind {
            OutputKind::Png => Moments::One { at_s: args.at.unwrap_or(end_s) },
            _ => even_moments(recording.start_s, end_s, 1.0 / (fps * slow_motion))?,
        };
        let caption = Caption {
            show_time: true,
            slow_motion: (kind != OutputKind::Png).then_some(slow_motion),
            text: String::new(),
        };
        let color_by = args.color_by.unwrap_or(recording.color_by);
        let range = args.color_range.as_deref().map(|text| color_range(text, color_by)).transpose()?;
        // What the scene says is meant for its own field.
        let own_range = recording.color_range.filter(|_| color_by == recording.color_by);
        let range = range.or(own_range.and_then(|[low, high]| Range::chosen(low, high).ok()));
        let range = range.filter(|_| color_by.has_values());
        let cut = args.cut.or(recording.cut.as_ref().and_then(CutChoice::of_scene));
        Ok(Self {
            moments,
            camera: choose_camera(args.camera.as_deref(), scene)?,
            color_by,
            range,
            looking: Looking::new(cut, args.crosses || recording.crosses),
            wireframe: args.wireframe,
            is_dark: args.dark,
            caption: (!args.no_caption).then_some(caption),
            size_px: args.size.map_or(recording.size_px, |size| [size.width, size.height]),
            fps,
        })
    }

    /// The moments of the pictures, s.
    pub fn moments_s(&self) -> impl Iterator<Item = f64> + use<> {
        let moments = self.moments;
        (0..moments.count()).map(move |index| moments.time_s(index))
    }

    /// Moment of the last picture, s.
    pub fn end_s(&self) -> f64 {
        self.moments.time_s(self.moments.count() - 1)
    }

    /// How the frames are looked into, from the first one on; `start` is what is there at the beginning.
    pub fn looking(&self, start: &Frame) -> Looking {
        let mut looking = self.looking.clone();
        let [width, height] = self.size_px;
        looking.begin(start, &self.camera.resolve(&Framing::of(start), width as f32 / height as f32));
        looking
    }

    /// Camera, floor and colours that serve all the frames.
    pub fn setting(&self, frames: &[Frame], framing: &Framing) -> Setting {
        let [width, height] = self.size_px;
        let own_range = || self.color_by.has_values().then(|| Range::of_frames(frames, self.color_by));
        Setting {
            camera: self.camera.resolve(framing, width as f32 / height as f32),
            view: View {
                color_by: self.color_by,
                range: self.range.or_else(own_range),
                is_range_chosen: self.range.is_some(),
                cross_scale_pa: cross_scale_pa(frames),
                wireframe: self.wireframe,
                ground: framing.floor().map_or(Ground::Hidden, Ground::At),
                caption: self.caption.clone(),
                background: if self.is_dark { Background::Dark } else { Background::Light },
                ..View::for_size(self.size_px)
            },
            size_px: self.size_px,
        }
    }
}

/// Every `interval_s` from `start_s` up to `end_s`.
fn even_moments(start_s: f64, end_s: f64, interval_s: f64) -> Result<Moments, Failure> {
    let intervals = (end_s - start_s).max(0.0) / interval_s;
    // A whole number of intervals must not be lost to a rounding.
    let count = (intervals * (1.0 + 1e-9)).floor() + 1.0;
    if count > MOST_FRAMES {
        return Err(Failure::BadInput(format!(
            "that would be {count} pictures, {interval_s:e} s apart, and {MOST_FRAMES} is the limit; \
             choose a smaller --slow-motion, --fps or --duration"
        )));
    }
    Ok(Moments::Even { start_s, interval_s, count: count as u32 })
}

fn choose_camera(asked: Option<&str>, scene: &SceneDescription) -> Result<CameraChoice, Failure> {
    let Some(name) = asked.or(scene.recording.camera.as_deref()) else {
        let first = scene.cameras.first().cloned();
        return Ok(first.map_or_else(|| CameraChoice::Named(NamedView::default()), CameraChoice::OfScene));
    };
    if let Some(camera) = scene.cameras.iter().find(|camera| camera.name == name) {
        return Ok(CameraChoice::OfScene(camera.clone()));
    }
    name.parse().map(CameraChoice::Named).map_err(|_| unknown_camera(name, scene))
}

fn unknown_camera(name: &str, scene: &SceneDescription) -> Failure {
    let own = scene.cameras.iter().map(|camera| camera.name.as_str());
    let names: Vec<&str> = own.chain(NamedView::ALL.map(NamedView::name)).collect();
    Failure::BadInput(format!("there is no camera `{name}` here; choose one of {}", names.join(", ")))
}

impl CameraChoice {
    fn resolve(&self, framing: &Framing, aspect: f32) -> Camera {
        match self {
            Self::Named(view) => framing.camera(*view, aspect),
            Self::OfScene(camera) => scene_camera(camera, framing, aspect),
        }
    }
}

/// Something to draw with.
pub struct Studio {
    screen: OffScreen,
}

impl Studio {
    /// Opens the graphics device.
    ///
    /// # Errors
    /// [`Failure::Run`] when there is none; the message names what to install.
    pub fn open() -> Result<Self, Failure> {
        let open = || OffScreen::new(&Gpu::headless()?);
        Ok(Self { screen: open().map_err(gpu_failure)? })
    }

    /// Draws a frame.
    ///
    /// # Errors
    /// [`Failure::Run`] with what went wrong on the device.
    pub fn draw(&mut self, frame: &Frame, setting: &Setting) -> Result<Picture, Failure> {
        self.screen.render(setting.size_px, frame, &setting.camera, &setting.view).map_err(gpu_failure)
    }
}

fn gpu_failure(error: GpuError) -> Failure {
    Failure::Run(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::stepping;
    use super::*;

    #[test]
    fn the_last_whole_interval_is_not_lost() {
        // 0.3 / 0.1 is a rounding below 3.
        let moments = even_moments(0.0, 0.3, 0.1).unwrap();
        assert_eq!(moments.count(), 4);
        assert!(stepping::reached(moments.time_s(3), 0.3));
        assert_eq!(even_moments(0.0, 0.35, 0.1).unwrap().count(), 4);
        assert_eq!(even_moments(2.0, 1.0, 0.1).unwrap().count(), 1);
    }

    #[test]
    fn absurd_numbers_of_pictures_are_refused() {
        let refused = even_moments(0.0, 1.0, 1e-9);
        assert!(matches!(refused, Err(Failure::BadInput(text)) if text.contains("--slow-motion")));
    }
}
