//! `hammerfall` and `hammerfall view`: the window.

use super::args::CommonArgs;
use super::failure::Failure;
use crate::scene::Scene;
use crate::viewer::{ViewerOptions, measure, run as run_viewer};
use clap::Args;

/// Arguments of `view`.
#[derive(Debug, Default, Args)]
pub struct ViewArgs {
    /// Built-in scene or scene file; the gallery by default
    pub scene: Option<String>,
    /// For tests: resize the window twice and close it after this many frames
    #[arg(long, value_name = "N", hide = true)]
    pub quit_after_frames: Option<u64>,
    /// For tests, with `--quit-after-frames`: also squeeze and hide the window and take its graphics device away
    #[arg(long, hide = true, requires = "quit_after_frames")]
    pub rough: bool,
    /// No window: draw this many frames of one of 1280x720 while the scene runs and say how long they took
    #[arg(long, value_name = "N", requires = "scene", conflicts_with = "quit_after_frames")]
    pub measure_frames: Option<u32>,
}

/// Opens the viewer.
///
/// # Errors
/// [`Failure`] when the scene is wrong, or the window cannot be opened.
pub fn run(args: &ViewArgs, common: &CommonArgs) -> Result<(), Failure> {
    if let Some(scene) = &args.scene {
        // Bad input is refused as everywhere; scenes opened later tell about it in the window.
        Scene::load(scene, &common.overrides).map_err(|error| Failure::BadInput(error.to_string()))?;
    } else if !common.overrides.is_empty() {
        return Err(Failure::BadInput("`--set` needs a scene: hammerfall view SCENE --set ...".to_owned()));
    }
    if let Some(frames) = args.measure_frames {
        let scene = args.scene.as_deref().unwrap_or_default();
        let report = measure(scene, &common.overrides, frames).map_err(Failure::Run)?;
        println!("{report}");
        return Ok(());
    }
    let options = ViewerOptions {
        scene: args.scene.clone(),
        overrides: common.overrides.clone(),
        quit_after_frames: args.quit_after_frames,
        is_rough: args.rough,
    };
    run_viewer(options).map_err(|error| Failure::Run(error.to_string()))
}
