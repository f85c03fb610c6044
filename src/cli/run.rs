//! `hammerfall run`: a scene without pictures, as data.

use super::args::{CommonArgs, parse_duration, parse_time};
use super::console::{Console, Progress, seconds};
use super::failure::Failure;
use super::interrupt;
use super::limits;
use super::output_folder::{self, HISTORY_FILE};
use super::scene_source;
use super::stepping::{self, Arrival};
use crate::export::ExportError;
use crate::export::csv::HistoryWriter;
use crate::export::summary::{BodySummary, RunStatus, SceneSummary, Summary, Tally, WallTime};
use crate::export::vtu::VtuSeries;
use crate::scene::Scene;
use crate::sim::{Sample, StepReport, World};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `run`.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// Built-in scene or scene file
    pub scene: String,
    /// Folder for history.csv, summary.json and the ParaView files
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Write the deformed bodies with their stresses for ParaView, one frame a row
    #[arg(long)]
    pub vtu: bool,
    /// Time between rows, 0 for every step; the scene says by default
    #[arg(long, value_name = "S", value_parser = parse_time, allow_negative_numbers = true)]
    pub every: Option<f64>,
    /// Simulated time; the scene says by default
    #[arg(long, value_name = "S", value_parser = parse_duration, allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// Replace files in DIR even if hammerfall did not write them
    #[arg(long)]
    pub force: bool,
}

/// Rows at even times when frames for ParaView are written although every step has its row.
const VTU_FRAMES_WITHOUT_INTERVAL: f64 = 100.0;

/// Runs the scene and writes its data.
///
/// # Errors
/// [`Failure`] as the exit statuses say; everything written before stays readable.
pub fn run(args: &RunArgs, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    let scene = scene_source::load(&args.scene, &common.overrides, console)?;
    let plan = Plan::new(args, &scene);
    let world = World::new(scene.setup.clone())?;
    let initial = stepping::sound_sample(&world).map_err(Failure::before_the_run)?;
    // From here on there is something to keep.
    interrupt::listen()?;
    output_folder::prepare_for_run(&args.output, args.force, console)?;
    let mut recorder =
        Recorder::create(args, &scene, &plan, (world, initial)).map_err(Failure::before_the_run)?;
    let mut progress = console.progress(plan.duration_s);
    let outcome = recorder.record(&plan, &mut progress);
    drop(progress);
    recorder.finish(outcome, args, console)
}

/// When to stop and what to write.
#[derive(Clone, Copy, Debug)]
struct Plan {
    duration_s: f64,
    /// Time between rows, 0 for every step.
    every_s: f64,
    /// Time between stops.
    stop_every_s: f64,
}

impl Plan {
    fn new(args: &RunArgs, scene: &Scene) -> Self {
        let duration_s = args.duration.unwrap_or(scene.description.duration_s);
        let every_s = args.every.unwrap_or(scene.description.recording.history_every_s);
        let stop_every_s = if every_s > 0.0 {
            every_s
        } else if args.vtu {
            duration_s / VTU_FRAMES_WITHOUT_INTERVAL
        } else {
            duration_s
        };
        Self { duration_s, every_s, stop_every_s }
    }

    fn has_row_each_step(&self) -> bool {
        self.every_s == 0.0
    }
}

/// A world being run, and the files that record it.
struct Recorder {
    world: World,
    history: HistoryWriter,
    frames: Option<VtuSeries>,
    tally: Tally,
    initial: Sample,
    summary: Summary,
    started: Instant,
    /// Time of the last row, s.
    last_row_s: f64,
}

impl Recorder {
    fn create(
        args: &RunArgs,
        scene: &Scene,
        plan: &Plan,
        (world, initial): (World, Sample),
    ) -> Result<Self, Failure> {
        let summary = Summary::new(describe(args, scene, plan, &world), &initial);
        summary.write(&args.output)?;
        let mut recorder = Self {
            history: HistoryWriter::create(&args.output.join(HISTORY_FILE))?,
            frames: args.vtu.then(|| VtuSeries::create(&args.output)).transpose()?,
            tally: Tally::default(),
            last_row_s: f64::NEG_INFINITY,
            started: Instant::now(),
            world,
            initial,
            summary,
        };
        recorder.write_row()?;
        recorder.write_frame()?;
        Ok(recorder)
    }

    /// Runs to the end of the plan, or until it fails or is interrupted.
    fn record(&mut self, plan: &Plan, progress: &mut Progress) -> Result<Arrival, Failure> {
        for moment_s in stepping::moments(plan.stop_every_s, plan.duration_s) {
            if self.advance(moment_s, plan, progress)? == Arrival::Interrupted {
                return Ok(Arrival::Interrupted);
            }
            self.write_row()?;
            self.write_frame()?;
        }
        Ok(Arrival::Reached)
    }

    fn advance(&mut self, moment_s: f64, plan: &Plan, progress: &mut Progress) -> Result<Arrival, Failure> {
        let Self { world, tally, history, last_row_s, initial, .. } = self;
        stepping::advance(world, moment_s, |world, step| {
            tally.add(step);
            if plan.has_row_each_step() {
                let row = stepping::sound_sample(world)?;
                tally.add_row(initial, &row);
                history.write(&row)?;
                *last_row_s = step.time_s;
            }
            progress.at(step.time_s, || describe_step(step, tally.counts.steps));
            Ok(())
        })
    }

    /// Writes a row for the world as it stands, unless that has been done.
    fn write_row(&mut self) -> Result<(), Failure> {
        if self.world.time_s() > self.last_row_s {
            let row = stepping::sound_sample(&self.world)?;
            self.tally.add_row(&self.initial, &row);
            self.history.write(&row)?;
            self.last_row_s = self.world.time_s();
        }
        Ok(())
    }

    fn write_frame(&mut self) -> Result<(), ExportError> {
        match &mut self.frames {
            Some(frames) => frames.write(&self.world),
            None => Ok(()),
        }
    }

    /// Brings all files to their end, whatever the outcome, and tells it.
    fn finish(
        mut self,
        outcome: Result<Arrival, Failure>,
        args: &RunArgs,
        console: &Console,
    ) -> Result<(), Failure> {
        let closed = self.close(&outcome, args);
        // Why the run failed matters more than that closing failed too.
        let arrival = outcome?;
        closed?;
        let folder = args.output.display();
        let (time_s, rows) = (seconds(self.world.time_s()), self.tally.counts.rows);
        if arrival == Arrival::Interrupted {
            return Err(Failure::Interrupted(format!(
                "stopped at t = {time_s}; `{folder}` keeps {rows} rows and everything else up to there"
            )));
        }
        self.report(args, console)
    }

    fn close(&mut self, outcome: &Result<Arrival, Failure>, args: &RunArgs) -> Result<(), Failure> {
        let last_row = self.write_row();
        let listed = self.frames.as_mut().map_or(Ok(()), VtuSeries::close);
        self.tally.counts.rows = self.history.rows();
        self.tally.counts.vtu_frames = self.frames.as_ref().map_or(0, VtuSeries::frames);
        self.summarize(outcome);
        let summarized = self.summary.write(&args.output);
        last_row.and(listed.and(summarized).map_err(Failure::from))
    }

    fn summarize(&mut self, outcome: &Result<Arrival, Failure>) {
        let summary = &mut self.summary;
        summary.status = match outcome {
            Ok(Arrival::Reached) => RunStatus::Done,
            Ok(Arrival::Interrupted) => RunStatus::Interrupted,
            Err(_) => RunStatus::Failed,
        };
        summary.interrupted = summary.status == RunStatus::Interrupted;
        summary.failure = outcome.as_ref().err().map(ToString::to_string);
        let wall_time = WallTime::new(
            self.started.elapsed().as_secs_f64(),
            &self.world.phase_times(),
            rayon::current_num_threads(),
        );
        summary.set_contacts(self.world.contact_episodes());
        let bodies = 0..self.world.body_count();
        summary.set_cracks(bodies.flat_map(|body| self.world.failure_times_s(body).iter().copied()));
        summary.set_fracture_limits(self.world.fracture_limits_reached());
        summary.update(&self.initial, &self.world.sample(), &self.tally, wall_time);
    }

    /// The closing lines on stdout.
    fn report(&self, args: &RunArgs, console: &Console) -> Result<(), Failure> {
        let Summary { counts, extremes, wall_time, .. } = &self.summary;
        let folder = args.output.display();
        console.closing(format_args!(
            "{} simulated in {:.3} s: {} steps, {} of them with contact",
            seconds(self.world.time_s()),
            wall_time.total_s,
            counts.steps,
            counts.contact_steps,
        ))?;
        console.closing(format_args!(
            "largest energy balance error {:.3e} J, deepest penetration {:.3e} m",
            self.summary.largest_energy_balance_error_j, extremes.largest_penetration_m,
        ))?;
        if self.summary.last.crack_area_m2 > 0.0 {
            let (first, last) = (&self.summary.initial, &self.summary.last);
            let what = match (first.fragments, last.fragments) {
                (before, after) if after > before => format!("broke from {before} into {after} pieces"),
                _ => "cracked, but nothing came off".to_owned(),
            };
            console.closing(format_args!(
                "{what}, {:.3e} m2 of cracks; {} elements became {}",
                last.crack_area_m2, first.elements, last.elements,
            ))?;
            if let Some((body, step_s, floor_s)) = self.world.step_and_its_floor_s() {
                console.closing(format_args!(
                    "stable step of `{body}` as cut {step_s:.3e} s; no cut can bring it below {floor_s:.3e} s",
                ))?;
            }
        }
        limits::tell(self.world.fracture_limits_reached(), console)?;
        let frames = match counts.vtu_frames {
            0 => String::new(),
            count => format!(", run.pvd ({count} frames)"),
        };
        console.closing(format_args!(
            "wrote `{folder}`: history.csv ({} rows), summary.json{frames}",
            counts.rows
        ))
    }
}

fn describe(args: &RunArgs, scene: &Scene, plan: &Plan, world: &World) -> SceneSummary {
    let bodies = world.setup().bodies.iter().enumerate();
    let source = if scene_source::is_built_in(&args.scene) { "built-in" } else { &args.scene };
    SceneSummary {
        name: scene.name.clone(),
        source: source.to_owned(),
        overrides: scene.overrides().to_vec(),
        duration_s: plan.duration_s,
        every_s: plan.every_s,
        bodies: bodies
            .map(|(index, body)| BodySummary {
                name: body.name.clone(),
                elements: body.mesh.tets.len(),
                nodes: body.mesh.nodes_m.len(),
                mass_kg: world.mass_kg(index),
                added_mass_kg: world.mass_scaling(index).added_kg,
                stable_step_s: Some(world.stable_step_s(index)).filter(|step_s| step_s.is_finite()),
            })
            .collect(),
    }
}

fn describe_step(step: &StepReport, steps: u64) -> String {
    format!(
        "t = {:.4e} s, {}, {steps} steps, {} contacts",
        step.time_s,
        step.stage.name(),
        step.contact_pairs
    )
}
