//! Pictures for the page of `verify --report`: the scenes that the cases are about.

use super::args::Size;
use super::console::Console;
use super::failure::Failure;
use super::interrupt;
use super::picture_output::OutputKind;
use super::render::RenderArgs;
use super::shot::{Shot, Studio};
use super::stepping::{self, Arrival};
use crate::export::png::png_bytes;
use crate::frame::ColorBy;
use crate::render::Framing;
use crate::scene::Scene;
use crate::sim::World;
use crate::verify::report::{CaseReport, Picture, Pictures};

/// A scene at a moment (s), beside a case.
struct Subject {
    case: &'static str,
    scene: &'static str,
    at_s: f64,
    color_by: Option<ColorBy>,
    caption: &'static str,
}

const fn subject(case: &'static str, scene: &'static str, at_s: f64, caption: &'static str) -> Subject {
    Subject { case, scene, at_s, color_by: None, caption }
}

const SUBJECTS: [Subject; 7] = [
    Subject {
        color_by: Some(ColorBy::MinPrincipal),
        ..subject(
            "rods",
            "rods-collision",
            3e-5,
            "A third into the collision: pressure spreads from where they meet",
        )
    },
    Subject {
        color_by: Some(ColorBy::MinPrincipal),
        ..subject("rods-fine", "rods-collision-fine", 3e-5, "The same with 40 elements along")
    },
    subject("incline", "incline", 0.5, "The block on its slope"),
    subject("scenes", "bounce", 0.2, "bounce, soon after the start"),
    subject("scenes", "stack", 0.3, "stack, soon after the start"),
    subject("beam-notch", "beam-notch", 2.0, "The notched beam of the thesis's size, under its load"),
    subject("pile-press", "pile-press", 0.25, "The pressed pile of the thesis's size, half way"),
];

/// Size of a picture.
const SIZE: Size = Size { width: 720, height: 405 };

/// Draws the scenes of these cases. Where nothing can be drawn, the pictures say why.
///
/// # Errors
/// [`Failure`] when a scene cannot be simulated or the user wants an end.
pub fn draw(reports: &[CaseReport], console: &Console) -> Result<Pictures, Failure> {
    let wanted =
        || SUBJECTS.iter().filter(|subject| reports.iter().any(|report| report.case.id == subject.case));
    if wanted().next().is_none() {
        return Ok(Pictures::default());
    }
    let mut studio = match Studio::open() {
        Ok(studio) => studio,
        Err(reason) => {
            let missing = format!("The page has no pictures: {reason}");
            console.note(&missing);
            return Ok(Pictures { missing: Some(missing), ..Pictures::default() });
        }
    };
    let mut pictures = Pictures::default();
    for subject in wanted() {
        pictures.list.push(take(subject, &mut studio)?);
    }
    Ok(pictures)
}

fn take(subject: &Subject, studio: &mut Studio) -> Result<Picture, Failure> {
    let scene = Scene::load(subject.scene, &[]).map_err(|error| Failure::Run(error.to_string()))?;
    let args = RenderArgs {
        scene: subject.scene.to_owned(),
        size: Some(SIZE),
        at: Some(subject.at_s),
        color_by: subject.color_by,
        wireframe: true,
        ..RenderArgs::default()
    };
    let shot = Shot::new(&args, &scene.description, OutputKind::Png)?;
    let mut world = World::new(scene.setup)?;
    let arrival = stepping::advance(&mut world, shot.end_s(), |_, _| Ok(()))?;
    if arrival == Arrival::Interrupted || interrupt::requested() {
        return Err(Failure::Interrupted("stopped while the report's pictures were drawn".to_owned()));
    }
    let frames = [world.publish()];
    let mut framing = Framing::default();
    framing.include(&frames[0]);
    let picture = studio.draw(&frames[0], &shot.setting(&frames, &framing))?;
    let png = png_bytes(&picture).map_err(|error| Failure::Run(error.to_string()))?;
    Ok(Picture { case: subject.case, caption: subject.caption, png })
}
