//! `hammerfall render`: a scene as pictures, without a window.
//!
//! The whole scene is simulated first and drawn then: only so do camera, floor and colour map
//! fit all of it and stand still.

use super::args::{CommonArgs, Size, parse_color_by, parse_duration, parse_factor, parse_size, parse_time};
use super::console::{Console, seconds};
use super::failure::Failure;
use super::interrupt;
use super::limits;
use super::looking::{CutChoice, parse_cut};
use super::picture_output::{OutputKind, PictureSink, check_writable};
use super::scene_source;
use super::shot::{Shot, Studio};
use super::stepping::{self, Arrival};
use crate::export::png::{write_png, write_small_png};
use crate::fracture::LimitsReached;
use crate::frame::{ColorBy, Frame};
use crate::render::{Framing, UnknownView, short};
use crate::sim::World;
use crate::viewer::{WindowShot, WindowState, window_picture};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Instant;

/// What the window is busy with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PanelState {
    /// The scene between its panels
    Scene,
    /// The gallery of scenes
    Gallery,
    /// Plots of energy, force and fragments
    Plots,
    /// The element in sight that is nearest to failing
    Element,
    /// Keys and mouse
    Help,
}

impl From<PanelState> for WindowState {
    fn from(state: PanelState) -> Self {
        match state {
            PanelState::Scene => Self::Scene,
            PanelState::Gallery => Self::Gallery,
            PanelState::Plots => Self::Plots,
            PanelState::Element => Self::Element,
            PanelState::Help => Self::Help,
        }
    }
}

/// Arguments of `render`.
#[derive(Debug, Default, Args)]
pub struct RenderArgs {
    /// Built-in scene or scene file
    pub scene: String,
    /// What to write: a .png (one moment), a .gif, or a folder of numbered PNGs; what is there under that name is replaced
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<Size>,
    /// Pictures a second
    #[arg(long, value_name = "N", value_parser = parse_factor, allow_negative_numbers = true)]
    pub fps: Option<f64>,
    /// Simulated time
    #[arg(long, value_name = "S", value_parser = parse_duration, allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// The moment that a .png shows; the last one by default. The scene is simulated on for one beyond its end
    #[arg(long, value_name = "S", value_parser = parse_time, allow_negative_numbers = true)]
    #[arg(conflicts_with_all = ["duration", "fps", "slow_motion"])]
    pub at: Option<f64>,
    /// How many times slower than life
    #[arg(long, value_name = "K", value_parser = parse_factor, allow_negative_numbers = true)]
    pub slow_motion: Option<f64>,
    /// A view of the scene, or: three-quarter, front, right, back, left, top, rear-quarter, low, high
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Colour by: material, body, fragment, speed, displacement, von-mises, max-principal, min-principal, mean-stress, failure-index
    #[arg(long, value_name = "FIELD", value_parser = parse_color_by)]
    pub color_by: Option<ColorBy>,
    /// Ends of the colour map in the field's unit, for example 0..2MPa; by default all of the values
    #[arg(long, value_name = "MIN..MAX", allow_hyphen_values = true, conflicts_with = "panels")]
    pub color_range: Option<String>,
    /// Cut the bodies open and show their inside; what lies beyond the plane in this direction is left out
    ///
    /// DIRECTION is x, y, z, -x, +x and so on, or three numbers such as 1,0,2. x, y and z without a sign leave out the
    /// side that would hide the section from the camera. PLACE is metres along it from the origin, for
    /// example 0.05 or 50mm; without it the plane goes through the middle of the bodies at the first picture. Fixed
    /// bodies stay whole.
    #[arg(long, value_name = "DIRECTION[=PLACE]", value_parser = parse_cut, allow_hyphen_values = true)]
    #[arg(conflicts_with = "panels")]
    pub cut: Option<CutChoice>,
    /// Draw the principal stresses as crosses, on the surface or, with --cut, on the section
    #[arg(long, conflicts_with = "panels")]
    pub crosses: bool,
    /// Draw the edges of the elements
    #[arg(long)]
    pub wireframe: bool,
    /// Draw the viewer's window with its panels, for a .png: the scene, the gallery, plots, the worst element in sight, help
    #[arg(long, value_name = "STATE", num_args = 0..=1, require_equals = true, default_missing_value = "scene")]
    pub panels: Option<PanelState>,
    /// Scale of text and buttons of the window; with --panels
    #[arg(long, value_name = "K", value_parser = parse_factor, requires = "panels")]
    pub scale: Option<f64>,
    /// Dark surroundings
    #[arg(long)]
    pub dark: bool,
    /// At most 255 colours, for a small file; with --panels
    #[arg(long, requires = "panels")]
    pub few_colors: bool,
    /// Leave out time and slow motion in the corner
    #[arg(long)]
    pub no_caption: bool,
    /// Replace pictures in the folder OUT even if other files lie beside them
    #[arg(long)]
    pub force: bool,
}

/// Simulates the scene and draws it.
///
/// # Errors
/// [`Failure`] as the exit statuses say; pictures finished before stay readable.
pub fn run(args: &RenderArgs, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    let kind = OutputKind::of(&args.output)?;
    if args.at.is_some() && kind != OutputKind::Png {
        return Err(Failure::BadInput(
            "`--at` picks the moment of a single picture; name the output something.png".to_owned(),
        ));
    }
    let scene = scene_source::load(&args.scene, &common.overrides, console)?;
    if let Some(note) = args.at.and_then(|at_s| beyond_the_end(at_s, scene.description.duration_s)) {
        console.note(format_args!("note: {note}"));
    }
    if let Some(state) = args.panels {
        return draw_window((args, state), common, scene.description.duration_s, console);
    }
    let shot = Shot::new(args, &scene.description, kind)?;
    let mut world = World::new(scene.setup.clone())?;
    // Before the simulation, which may take long: is there something to draw with, and a place?
    let mut studio = Studio::open()?;
    let sink = PictureSink::create(&args.output, &shot, args.force, console)?;
    interrupt::listen()?;

    let started = Instant::now();
    let (film, simulated) = simulate(&mut world, &shot, console);
    let simulated_in_s = started.elapsed().as_secs_f64();
    let drawn = draw(&film, &shot, &mut studio, sink, console);
    Report {
        args,
        frames: film.frames.len(),
        time_s: world.time_s(),
        limits: world.fracture_limits_reached(),
        simulated_in_s,
        drawn_in_s: started.elapsed().as_secs_f64() - simulated_in_s,
    }
    .tell(simulated, drawn, console)
}

/// What is said before it takes its time, of a moment beyond the scene's end.
fn beyond_the_end(at_s: f64, end_s: f64) -> Option<String> {
    (at_s > end_s).then(|| {
        format!(
            "the scene ends at {}; it is simulated on to {}, {} times as far. For a moment of the scene itself give a \
             smaller `--at`",
            seconds(end_s),
            seconds(at_s),
            short(at_s / end_s)
        )
    })
}

/// Size of the window when nobody has chosen, pixels: there must be room for the panels.
const WINDOW_PX: [u32; 2] = [1280, 800];

fn draw_window(
    (args, state): (&RenderArgs, PanelState),
    common: &CommonArgs,
    duration_s: f64,
    console: &Console,
) -> Result<(), Failure> {
    if OutputKind::of(&args.output)? != OutputKind::Png {
        return Err(Failure::BadInput(
            "`--panels` draws the window at one moment; name the output something.png".to_owned(),
        ));
    }
    check_writable(&args.output, console)?;
    let size_px = args.size.map_or(WINDOW_PX, |size| [size.width, size.height]);
    let at_s = args.at.or(args.duration).unwrap_or(duration_s);
    let camera = args.camera.as_deref().map(str::parse).transpose();
    let picture = window_picture(&WindowShot {
        scene: args.scene.clone(),
        overrides: common.overrides.clone(),
        at_s,
        size_px,
        pixels_per_point: args.scale.unwrap_or(1.0) as f32,
        state: state.into(),
        is_dark: args.dark,
        wireframe: args.wireframe,
        color_by: args.color_by,
        camera: camera.map_err(|error: UnknownView| Failure::BadInput(error.to_string()))?,
    });
    let picture = picture.map_err(Failure::Run)?;
    let write = if args.few_colors { write_small_png } else { write_png };
    write(&args.output, &picture).map_err(|error| Failure::Run(error.to_string()))?;
    console.closing(format_args!("wrote `{}`", args.output.display()))
}

/// What was simulated.
#[derive(Default)]
struct Film {
    /// As they are drawn.
    frames: Vec<Frame>,
    /// Room that the bodies need, also where they are cut away.
    framing: Framing,
}

/// The frames up to the end, or to where the run failed or was interrupted.
fn simulate(world: &mut World, shot: &Shot, console: &Console) -> (Film, Result<Arrival, Failure>) {
    let mut film = Film::default();
    let mut looking = shot.looking(&world.publish());
    let mut progress = console.progress(shot.end_s());
    for moment_s in shot.moments_s() {
        let arrival = stepping::advance(world, moment_s, |_, step| {
            progress.at(step.time_s, || format!("simulating t = {:.4e} s", step.time_s));
            Ok(())
        });
        if !matches!(arrival, Ok(Arrival::Reached)) {
            return (film, arrival);
        }
        if let Err(failure) = stepping::sound_sample(world) {
            return (film, Err(failure));
        }
        let frame = if looking.needs_interior() { world.publish_with_interior() } else { world.publish() };
        film.framing.include(&frame);
        film.frames.push(looking.look(frame));
    }
    if let Some(doubt) = looking.doubt() {
        console.came_to_nothing(doubt);
    }
    (film, Ok(Arrival::Reached))
}

/// Draws the frames; gives how many were finished.
fn draw(
    film: &Film,
    shot: &Shot,
    studio: &mut Studio,
    mut sink: PictureSink,
    console: &Console,
) -> Result<usize, Failure> {
    // A wish to stop during the simulation still gets the frames that were simulated; only one
    // during drawing stops that.
    let stopped_before = interrupt::requested();
    let frames = film.frames.as_slice();
    if frames.is_empty() {
        return Ok(0);
    }
    let mut progress = console.progress(frames.len() as f64);
    let setting = shot.setting(frames, &film.framing);
    sink.begin(|| samples(frames).map(|frame| studio.draw(frame, &setting)).collect())?;
    let mut finished = 0;
    for frame in frames {
        if interrupt::requested() && !stopped_before {
            break;
        }
        sink.add(&studio.draw(frame, &setting)?)?;
        finished += 1;
        progress.at(finished as f64, || format!("drawing {finished} of {}", frames.len()));
    }
    sink.finish()?;
    Ok(finished)
}

/// Some frames from all over the animation.
fn samples(frames: &[Frame]) -> impl Iterator<Item = &Frame> {
    const SAMPLES: usize = 5;
    frames.iter().step_by(frames.len().div_ceil(SAMPLES))
}

/// What the closing message tells.
struct Report<'a> {
    args: &'a RenderArgs,
    frames: usize,
    time_s: f64,
    limits: LimitsReached,
    simulated_in_s: f64,
    drawn_in_s: f64,
}

impl Report<'_> {
    fn tell(
        &self,
        simulated: Result<Arrival, Failure>,
        drawn: Result<usize, Failure>,
        console: &Console,
    ) -> Result<(), Failure> {
        let output = self.args.output.display();
        // Why the simulation failed matters more than what came of the drawing.
        let arrival = simulated.map_err(|failure| self.with_what_is_kept(failure, &drawn))?;
        let finished = drawn?;
        let pictures = count_pictures(finished);
        if arrival == Arrival::Interrupted || finished < self.frames {
            let kept = self.kept(finished);
            return Err(Failure::Interrupted(format!("stopped at t = {}; {kept}", seconds(self.time_s))));
        }
        console.closing(format_args!(
            "{} simulated in {:.1} s, {pictures} drawn in {:.1} s",
            seconds(self.time_s),
            self.simulated_in_s,
            self.drawn_in_s,
        ))?;
        limits::tell(self.limits, console)?;
        console.closing(format_args!("wrote `{output}`"))
    }

    fn with_what_is_kept(&self, failure: Failure, drawn: &Result<usize, Failure>) -> Failure {
        match (failure, drawn) {
            (Failure::Run(reason), Ok(finished)) => {
                Failure::Run(format!("{reason}\n{}", self.kept(*finished)))
            }
            (failure, _) => failure,
        }
    }

    fn kept(&self, finished: usize) -> String {
        match finished {
            0 => "nothing was drawn yet".to_owned(),
            count => {
                format!("`{}` keeps the {} up to there", self.args.output.display(), count_pictures(count))
            }
        }
    }
}

fn count_pictures(count: usize) -> String {
    match count {
        1 => "1 picture".to_owned(),
        _ => format!("{count} pictures"),
    }
}
