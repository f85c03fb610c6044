//! `hammerfall verify`: how far each answer is from the truth.

use super::args::CommonArgs;
use super::console::Console;
use super::failure::Failure;
use super::{interrupt, report_pictures};
use crate::export::{create_folder, write_whole};
use crate::verify::report::{self, CaseReport};
use crate::verify::{CASES, Case, CaseError, Effort, Turn, find, sweep_runs};
use clap::Args;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::mpsc;
use std::time::Instant;

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Cases to run, all by default but those that begin with `sweep-`, which take long
    #[arg(value_name = "CASE")]
    pub cases: Vec<String>,
    /// Fewer and smaller cases, in less than half a minute
    #[arg(long)]
    pub quick: bool,
    /// Of each `sweep-`, only the runs with this in their name, such as `tensile x 0.1`
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// Print JSON instead of tables
    #[arg(long, conflicts_with = "markdown")]
    pub json: bool,
    /// Print one Markdown table
    #[arg(long)]
    pub markdown: bool,
    /// Write report.html with its plots and pictures, and the same as CSV, into a folder
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
}

/// Runs the cases and prints what they found.
///
/// # Errors
/// [`Failure::BadInput`] for a case that does not exist, [`Failure::Run`] when something falls short.
pub fn run(args: &VerifyArgs, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    if let Some(first) = common.overrides.first() {
        return Err(Failure::BadInput(format!(
            "the cases of `verify` are what they are, so there is nothing for `--set {first}` to override"
        )));
    }
    let cases = chosen(args)?;
    check_only(args, &cases)?;
    if let Some(folder) = &args.report {
        create_folder(folder).map_err(|error| Failure::from(error).before_the_run())?;
    }
    interrupt::listen()?;
    let started = Instant::now();
    let is_table = !(args.json || args.markdown);
    let reports = measure(&cases, (args, console), |report| {
        if is_table { console.result(report::table(report)) } else { Ok(()) }
    })?;
    if args.json {
        console.result(format_args!("{:#}", report::to_json(&reports, args.quick)))?;
    } else if args.markdown {
        console.result(report::markdown(&reports).trim_end())?;
    }
    if let Some(folder) = &args.report {
        // What was measured is kept, whatever becomes of the pictures.
        let (pictures, drawn) = match report_pictures::draw(&reports, console) {
            Ok(pictures) => (pictures, Ok(())),
            Err(failure) => (report::Pictures::default(), Err(failure)),
        };
        for (name, content) in report::files(&reports, args.quick, &pictures) {
            write_whole(&folder.join(name), content.as_bytes())?;
        }
        console.note(format_args!("`{}` is written", folder.join(report::PAGE_FILE).display()));
        drawn?;
    }
    let [pass, short, shown] = report::counts(&reports);
    console.note(format_args!(
        "{} cases, {pass} quantities pass, {short} fall short, {shown} are shown; {:.1} s",
        reports.len(),
        started.elapsed().as_secs_f64()
    ));
    verdict(&reports, short)
}

fn verdict(reports: &[CaseReport], short: usize) -> Result<(), Failure> {
    if short == 0 {
        return Ok(());
    }
    let names: Vec<&str> =
        reports.iter().filter(|report| !report.passes()).map(|report| report.case.id).collect();
    let falls = if short == 1 { "one quantity falls".to_owned() } else { format!("{short} quantities fall") };
    Err(Failure::Run(format!("{falls} short, in {}", names.join(", "))))
}

/// The cases asked for, in the order of the list.
fn chosen(args: &VerifyArgs) -> Result<Vec<&'static Case>, Failure> {
    let unknown: Vec<String> =
        args.cases.iter().filter(|id| find(id).is_none()).map(|id| format!("`{id}`")).collect();
    if !unknown.is_empty() {
        return Err(Failure::BadInput(format!(
            "there is no case {}; the cases are {}",
            unknown.join(", "),
            report::known_cases()
        )));
    }
    let wanted = |case: &&Case| {
        if args.cases.is_empty() {
            case.turn == Turn::Quick || (case.turn == Turn::Full && !args.quick)
        } else {
            args.cases.iter().any(|id| id == case.id)
        }
    };
    Ok(CASES.iter().filter(wanted).collect())
}

/// Whether what `--only` names is there.
fn check_only(args: &VerifyArgs, cases: &[&Case]) -> Result<(), Failure> {
    let Some(only) = &args.only else { return Ok(()) };
    if cases.iter().all(|case| case.turn != Turn::Asked) {
        return Err(Failure::BadInput(format!(
            "`--only {only}` chooses among the runs of a case that begins with `sweep-`, and none is asked for"
        )));
    }
    let runs = sweep_runs(args.quick);
    if runs.iter().any(|run| run.contains(only)) {
        return Ok(());
    }
    Err(Failure::BadInput(format!(
        "no run has `{only}` in its name (`--only`); the runs are {}",
        runs.join(", ")
    )))
}

/// Measures the cases side by side and hands each report to `each` in their order, as soon as it is its turn.
fn measure(
    cases: &[&'static Case],
    (args, console): (&VerifyArgs, &Console),
    mut each: impl FnMut(&CaseReport) -> Result<(), Failure>,
) -> Result<Vec<CaseReport>, Failure> {
    let tell = |line: &str| console.note(line);
    let only = args.only.as_deref();
    let effort = Effort { quick: args.quick, only, stop: &interrupt::requested, tell: &tell };
    let (sender, receiver) = mpsc::channel();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            cases.par_iter().enumerate().with_max_len(1).for_each_with(sender, |sender, (index, case)| {
                // Nobody listens any more once an end was asked for.
                let _ = sender.send((index, case.run(&effort)));
            });
        });
        let mut waiting: Vec<Option<Result<_, CaseError>>> = cases.iter().map(|_| None).collect();
        let mut reports = Vec::new();
        for (index, outcome) in receiver {
            waiting[index] = Some(outcome);
            while let Some(outcome) = waiting.get_mut(reports.len()).and_then(Option::take) {
                let outcome = match outcome {
                    Err(CaseError::Stopped) => return Err(stopped(reports.len())),
                    other => other.map_err(|error| error.to_string()),
                };
                let report = CaseReport { case: cases[reports.len()], outcome };
                each(&report)?;
                reports.push(report);
            }
        }
        Ok(reports)
    })
}

fn stopped(done: usize) -> Failure {
    let cases = if done == 1 { "case" } else { "cases" };
    Failure::Interrupted(format!("stopped after {done} {cases}"))
}
