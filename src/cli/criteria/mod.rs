//! `hammerfall criteria`: failure surfaces as curves, in a picture or as numbers.

mod chart;
mod choice;
mod panel;
mod sections;

use super::args::CommonArgs;
use super::console::Console;
use super::failure::Failure;
use crate::export::png::write_png;
use crate::export::write_whole;
use choice::{Entry, parse_named_number, parse_stress};
use clap::Args;
use sections::{Sections, Shape};
use std::path::{Path, PathBuf};

/// Arguments of `criteria`.
#[derive(Debug, Args)]
pub struct CriteriaArgs {
    /// Scene whose materials' criteria are drawn; without it and the next two: the five standard ones
    pub scene: Option<String>,
    /// A criterion of your own, e.g. "mohr-coulomb cohesion=5MPa friction_angle=30"; repeatable
    ///
    /// tensile tensile_strength, tresca shear_strength, von-mises shear_strength, mohr-coulomb cohesion friction_angle,
    /// drucker-prager cohesion friction_angle: stresses in Pa or with kPa, MPa, GPa, angles in degrees. Names may be left
    /// out ("tresca 5MPa"), the values of a single criterion also be given by --set, and its name alone stands for
    /// illustrative ones. A table as in a scene's `fracture` will do as well.
    #[arg(long, value_name = "CRITERION")]
    pub criterion: Vec<String>,
    /// A criterion as a formula in s1, s2, s3, I1, J2, J3: "max(s1 - 3*MPa, sqrt(J2) - 2*MPa)" fails from 0 on. Repeatable
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub formula: Vec<String>,
    /// Value of a name that formulas use, e.g. Ft=3e6; repeatable
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_named_number)]
    pub parameter: Vec<(String, f64)>,
    /// Mean stress of a section across the hydrostatic axis, e.g. 0 or -5MPa, tension positive; up to five
    #[arg(long, value_name = "STRESS", value_parser = parse_stress, allow_hyphen_values = true)]
    pub mean_stress: Vec<f64>,
    /// Where to write: something.png, or something.csv for the points
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// More sections make no picture.
const MOST_MEANS: usize = 5;

/// What the output's ending asks for.
enum OutputKind {
    Picture,
    Table,
}

/// Finds the curves and writes them.
///
/// # Errors
/// [`Failure::BadInput`] for what cannot be drawn, and when the file cannot be written.
pub fn run(args: &CriteriaArgs, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    let kind = output_kind(&args.output)?;
    if args.mean_stress.len() > MOST_MEANS {
        return Err(Failure::BadInput(format!(
            "--mean-stress is given {} times; more than {MOST_MEANS} sections do not fit a picture",
            args.mean_stress.len()
        )));
    }
    let entries = choice::entries(args, common, console)?;
    let sections = Sections::of(&entries, &args.mean_stress)?;
    let written = match kind {
        OutputKind::Picture => write_png(&args.output, &chart::draw(&entries, &sections)),
        OutputKind::Table => write_whole(&args.output, table(&entries, &sections).as_bytes()),
    };
    written.map_err(|error| Failure::from(error).before_the_run())?;
    let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    console.result(format_args!("`{}` holds: {}", args.output.display(), names.join(", ")))
}

fn output_kind(path: &Path) -> Result<OutputKind, Failure> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("png") => Ok(OutputKind::Picture),
        Some("csv") => Ok(OutputKind::Table),
        _ => Err(Failure::BadInput(format!(
            "cannot write `{}`: name the output something.png for a picture or something.csv for the points",
            path.display()
        ))),
    }
}

/// One row a point; points that are out of reach are left out.
fn table(entries: &[Entry], sections: &Sections) -> String {
    let mut text = String::from("criterion,section,mean_stress_pa,angle_deg,s1_pa,s2_pa,s3_pa\n");
    for section in &sections.list {
        let name = match section.shape {
            Shape::PlaneStress => "plane-stress",
            Shape::Deviatoric { .. } => "deviatoric",
        };
        for (entry, curve) in entries.iter().zip(&section.curves) {
            let quoted = format!("\"{}\"", entry.name.replace('"', "\"\""));
            for (angle_deg, point) in curve.points_with_angles() {
                let mean_pa = point.element_sum() / 3.0;
                let [s1, s2, s3] = point.to_array();
                text += &format!("{quoted},{name},{mean_pa},{angle_deg},{s1},{s2},{s3}\n");
            }
        }
    }
    text
}
