//! `hammerfall render`

use super::args::{CommonArgs, Size, parse_duration, parse_factor, parse_size, parse_time};
use super::console::Console;
use super::failure::Failure;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Built-in scene or scene file
    pub scene: String,
    /// What to write: a .png (one moment), a .gif, or a folder of numbered PNGs
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<Size>,
    #[arg(long, value_name = "N", value_parser = parse_factor)]
    pub fps: Option<f64>,
    #[arg(long, value_name = "S", value_parser = parse_duration)]
    pub duration: Option<f64>,
    #[arg(long, value_name = "S", value_parser = parse_time)]
    pub at: Option<f64>,
}

pub fn run(_args: &RenderArgs, _common: &CommonArgs, _console: &Console) -> Result<(), Failure> {
    Ok(())
}
