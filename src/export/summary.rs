//! `summary.json`: what was run, how it ended, and what it cost.
//!
//! Wall times stand here and nowhere else, so that every other file of a run is the same for the
//! same scene and program.

use super::{ExportError, write_whole};
use crate::fracture::LimitsReached;
use crate::sim::{ContactEpisode, NEVER_FAILED_S, PhaseTimes, Sample, StepReport};
use serde::Serialize;
use std::path::Path;

/// Name of the file in a run's folder.
pub const SUMMARY_FILE: &str = "summary.json";
/// The value of `program`, by which a run's folder is recognised.
pub const PROGRAM: &str = "hammerfall";

/// How a run stands or ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunStatus {
    /// Under way (or killed without a chance to say so).
    Running,
    /// Went to its end.
    Done,
    /// Stopped by the user; what was written is sound.
    Interrupted,
    /// Stopped by an error, which `failure` tells.
    Failed,
}

/// Everything in `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Always [`PROGRAM`].
    pub program: &'static str,
    /// Versions of what made the data.
    pub versions: Versions,
    /// What was run.
    pub scene: SceneSummary,
    /// How it ended.
    pub status: RunStatus,
    /// Whether the user stopped it.
    pub interrupted: bool,
    /// Why it failed, if it did.
    pub failure: Option<String>,
    /// Counts.
    pub counts: Counts,
    /// Extremes over all steps, sampled or not.
    pub extremes: Extremes,
    /// Balances at the start.
    pub initial: Balances,
    /// Balances at the end.
    pub last: Balances,
    /// What took part in cracks, and when.
    pub cracks: CrackSummary,
    /// Limits of fracture that were reached.
    pub fracture_limits_reached: FractureLimitsReached,
    /// Contacts of two bodies in the order of their first touch, the first thousand of them.
    pub contacts: Vec<ContactSummary>,
    /// Change of the energy balance between start and end, J: zero when all is well.
    pub energy_balance_error_j: f64,
    /// Largest amount by which the energy balance of a row of `history.csv` differs from the first row's, J.
    pub largest_energy_balance_error_j: f64,
    /// Wall time by phase.
    pub wall_time: WallTime,
    /// Simulated seconds per second of wall time; absent before the first step.
    pub real_time_factor: Option<f64>,
}

/// Versions of what made the data.
#[derive(Clone, Debug, Serialize)]
pub struct Versions {
    /// Version of the program.
    pub hammerfall: &'static str,
    /// Version of the layout of this file and of `history.csv`.
    pub format: u32,
    /// Processor and system the program was built for; equal bytes are promised for equal builds.
    pub built_for: String,
}

impl Default for Versions {
    fn default() -> Self {
        Self {
            hammerfall: env!("CARGO_PKG_VERSION"),
            format: 1,
            built_for: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
        }
    }
}

/// What was run.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SceneSummary {
    /// Name of the scene.
    pub name: String,
    /// File it came from, or `built-in`.
    pub source: String,
    /// Overrides from the command line, in order.
    pub overrides: Vec<String>,
    /// Time asked for, s.
    pub duration_s: f64,
    /// Interval between rows, s; 0 for every step.
    pub every_s: f64,
    /// The bodies, in scene order.
    pub bodies: Vec<BodySummary>,
}

/// One body.
#[derive(Clone, Debug, Default, Serialize)]
pub struct BodySummary {
    /// Name.
    pub name: String,
    /// Tetrahedra.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Mass with what mass scaling added, kg.
    pub mass_kg: f64,
    /// Mass that mass scaling added, kg.
    pub added_mass_kg: f64,
    /// Stable elastic step, s; absent for bodies that do not deform.
    pub stable_step_s: Option<f64>,
}

/// What took part in cracks, and when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CrackSummary {
    /// Elements that took part in a crack, as the mesh is at the end.
    pub failed_elements: usize,
    /// When the first of them failed, s; absent if none has.
    pub first_failure_s: Option<f64>,
    /// When the last of them failed, s.
    pub last_failure_s: Option<f64>,
}

/// How often a limit kept a crack from going where it would.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FractureLimitsReached {
    /// Edges that cuts did not divide because a body has as many elements as it may; they ran along faces.
    pub elements: u32,
    /// Nodes at which a cut was left out because a fragment would have been too small.
    pub fragments: u32,
    /// Nodes at which a crack had to wait because it would have run faster than it may.
    pub speed: u32,
    /// Nodes at which no crack started because one close by had just relieved them.
    pub spacing: u32,
}

/// One contact of two bodies, from first touch to separation.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ContactSummary {
    /// Names of the bodies.
    pub bodies: [String; 2],
    /// Time of the first impulse, s.
    pub begin_s: f64,
    /// Time of the last impulse, s.
    pub end_s: f64,
    /// When all but a thousandth of the impulse had been passed on, s: the end of the collision proper.
    pub impulse_end_s: f64,
    /// Length of the rectangular pulse with the same spread in time, s: the collision's length of wave theory.
    pub pulse_length_s: f64,
    /// Impulse on the first body, N s.
    pub impulse_n_s: [f64; 3],
}

impl ContactSummary {
    fn new(episode: &ContactEpisode, bodies: &[BodySummary]) -> Self {
        let name = |body: usize| bodies.get(body).map_or_else(String::new, |body| body.name.clone());
        Self {
            bodies: episode.bodies.map(name),
            begin_s: episode.begin_s,
            end_s: episode.end_s,
            impulse_end_s: episode.impulse_end_s,
            pulse_length_s: episode.pulse_length_s,
            impulse_n_s: episode.impulse_n_s.to_array(),
        }
    }
}

/// Contacts listed at most; a body that rattles touches thousands of times.
const MOST_CONTACTS_LISTED: usize = 1000;

/// Counts over the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Counts {
    /// Steps taken.
    pub steps: u64,
    /// Elastic steps inside them.
    pub elastic_steps: u64,
    /// Steps in which something pressed.
    pub contact_steps: u64,
    /// Rows of `history.csv`.
    pub rows: u64,
    /// Frames for ParaView.
    pub vtu_frames: usize,
}

/// Extremes over all steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Extremes {
    /// Deepest penetration at the end of any step, m.
    pub largest_penetration_m: f64,
    /// Deepest penetration over the local element size.
    pub largest_penetration_ratio: f64,
    /// When that was, s.
    pub largest_penetration_time_s: f64,
    /// Largest sum of contact forces in a step, N.
    pub largest_contact_force_n: f64,
    /// Most contact pairs pressing in a step.
    pub most_contact_pairs: u32,
    /// Most Gauss-Seidel passes in a step.
    pub most_passes: u32,
    /// Largest last relative change of a multiplier.
    pub largest_last_change: f64,
    /// Shortest step, s; absent before the first.
    pub shortest_step_s: Option<f64>,
}

/// Counts and extremes while they grow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Counts.
    pub counts: Counts,
    /// Extremes.
    pub extremes: Extremes,
    /// Largest amount by which the energy balance of a row differs from the first row's, J.
    pub energy_error_j: f64,
}

impl Tally {
    /// Takes one row of the history into account.
    pub fn add_row(&mut self, initial: &Sample, row: &Sample) {
        let error_j = (row.balance_j() - initial.balance_j()).abs();
        self.energy_error_j = self.energy_error_j.max(error_j);
    }

    /// Takes one step into account.
    pub fn add(&mut self, step: &StepReport) {
        self.counts.steps += 1;
        self.counts.elastic_steps += u64::from(step.elastic_steps);
        self.counts.contact_steps += u64::from(step.contact_pairs > 0);
        self.extremes.add(step);
    }
}

impl Extremes {
    fn add(&mut self, step: &StepReport) {
        self.largest_penetration_m = self.largest_penetration_m.max(step.max_penetration_m);
        if step.max_penetration_ratio > self.largest_penetration_ratio {
            self.largest_penetration_ratio = step.max_penetration_ratio;
            self.largest_penetration_time_s = step.time_s;
        }
        self.largest_contact_force_n = self.largest_contact_force_n.max(step.contact_force_n);
        self.most_contact_pairs = self.most_contact_pairs.max(step.contact_pairs);
        self.most_passes = self.most_passes.max(step.settling.passes);
        self.largest_last_change = self.largest_last_change.max(step.settling.last_change);
        // A touch at the very start of a step ends it before time has passed.
        if step.step_s > 0.0 {
            let shortest_s = self.shortest_step_s.unwrap_or(f64::INFINITY);
            self.shortest_step_s = Some(shortest_s.min(step.step_s));
        }
    }
}

/// Balances at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Balances {
    /// Simulated time, s.
    pub time_s: f64,
    /// Stage of the step.
    pub stage: &'static str,
    /// Kinetic energy, J.
    pub kinetic_j: f64,
    /// Strain energy, J.
    pub strain_j: f64,
    /// Potential energy of gravity relative to the start, J.
    pub potential_j: f64,
    /// Energy dissipated, J.
    pub dissipated_j: f64,
    /// Work of applied forces and prescribed motion, J.
    pub external_work_j: f64,
    /// Linear momentum, kg m/s.
    pub linear_momentum_kg_m_s: [f64; 3],
    /// Angular momentum about the world's origin, kg m2/s.
    pub angular_momentum_kg_m2_s: [f64; 3],
    /// Tetrahedra.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Connected pieces of the deformable bodies.
    pub fragments: usize,
    /// Area of crack faces, one side counted, m2.
    pub crack_area_m2: f64,
}

impl From<&Sample> for Balances {
    fn from(sample: &Sample) -> Self {
        Self {
            time_s: sample.step.time_s,
            stage: sample.step.stage.name(),
            kinetic_j: sample.kinetic_j,
            strain_j: sample.strain_j,
            potential_j: sample.potential_j,
            dissipated_j: sample.dissipated_j,
            external_work_j: sample.external_work_j,
            linear_momentum_kg_m_s: sample.linear_momentum_kg_m_s.to_array(),
            angular_momentum_kg_m2_s: sample.angular_momentum_kg_m2_s.to_array(),
            elements: sample.elements,
            nodes: sample.nodes,
            fragments: sample.fragments,
            crack_area_m2: sample.crack_area_m2,
        }
    }
}

/// Wall time by phase, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WallTime {
    /// From the first step to the last file.
    pub total_s: f64,
    /// Elastic forces and integration.
    pub elastic_s: f64,
    /// Search for contact.
    pub detection_s: f64,
    /// Contact response.
    pub response_s: f64,
    /// Looking for failure, cutting, and building anew what was cut.
    pub fracture_s: f64,
    /// Free travel and the rest of the steps.
    pub other_s: f64,
    /// Sampling and writing.
    pub output_s: f64,
    /// Threads that were at hand.
    pub threads: usize,
}

impl WallTime {
    /// Splits the total by the world's own clock; what the steps did not use was output.
    #[must_use]
    pub fn new(total_s: f64, phases: &PhaseTimes, threads: usize) -> Self {
        let steps_s = phases.counted_s() + phases.other_s;
        Self {
            total_s,
            elastic_s: phases.elastic_s,
            detection_s: phases.detection_s,
            response_s: phases.response_s,
            fracture_s: phases.fracture_s,
            other_s: phases.other_s,
            output_s: (total_s - steps_s).max(0.0),
            threads,
        }
    }
}

impl Summary {
    /// A summary at the start of a run.
    #[must_use]
    pub fn new(scene: SceneSummary, initial: &Sample) -> Self {
        Self {
            program: PROGRAM,
            versions: Versions::default(),
            scene,
            status: RunStatus::Running,
            interrupted: false,
            failure: None,
            counts: Counts::default(),
            extremes: Extremes::default(),
            initial: initial.into(),
            last: initial.into(),
            cracks: CrackSummary::default(),
            fracture_limits_reached: FractureLimitsReached::default(),
            contacts: Vec::new(),
            energy_balance_error_j: 0.0,
            largest_energy_balance_error_j: 0.0,
            wall_time: WallTime::default(),
            real_time_factor: None,
        }
    }

    /// Sets the end of the run: balances, counts, cost.
    pub fn update(&mut self, initial: &Sample, last: &Sample, tally: &Tally, wall_time: WallTime) {
        self.last = last.into();
        self.energy_balance_error_j = last.balance_j() - initial.balance_j();
        self.largest_energy_balance_error_j = tally.energy_error_j;
        self.counts = tally.counts;
        self.extremes = tally.extremes;
        self.wall_time = wall_time;
        let simulated_s = last.step.time_s - initial.step.time_s;
        self.real_time_factor =
            (wall_time.total_s > 0.0 && tally.counts.steps > 0).then(|| simulated_s / wall_time.total_s);
    }

    /// Sets what took part in cracks from the failure times of all elements, s.
    pub fn set_cracks(&mut self, failure_times_s: impl Iterator<Item = f64>) {
        let mut cracks = CrackSummary::default();
        for time_s in failure_times_s.filter(|time_s| *time_s != NEVER_FAILED_S) {
            cracks.failed_elements += 1;
            cracks.first_failure_s =
                Some(cracks.first_failure_s.map_or(time_s, |first_s| first_s.min(time_s)));
            cracks.last_failure_s = Some(cracks.last_failure_s.map_or(time_s, |last_s| last_s.max(time_s)));
        }
        self.cracks = cracks;
    }

    /// Sets the limits of fracture that were reached.
    pub fn set_fracture_limits(&mut self, reached: LimitsReached) {
        let LimitsReached { elements, fragments, speed, spacing } = reached;
        self.fracture_limits_reached = FractureLimitsReached { elements, fragments, speed, spacing };
    }

    /// Sets the list of contacts.
    pub fn set_contacts(&mut self, episodes: &[ContactEpisode]) {
        let listed = episodes.iter().take(MOST_CONTACTS_LISTED);
        self.contacts = listed.map(|episode| ContactSummary::new(episode, &self.scene.bodies)).collect();
    }

    /// Writes `summary.json` into `folder`, replacing an older one.
    ///
    /// # Errors
    /// [`ExportError`] when it cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), ExportError> {
        let path = folder.join(SUMMARY_FILE);
        let mut json = serde_json::to_string_pretty(self)
            .map_err(|error| ExportError::Encode { path: path.clone(), reason: error.to_string() })?;
        json.push('\n');
        write_whole(&path, json.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tally_keeps_the_worst_of_all_steps() {
        let mut tally = Tally::default();
        for (time_s, ratio) in [(1.0, 0.1), (2.0, 0.3), (3.0, 0.2)] {
            tally.add(&StepReport {
                time_s,
                step_s: time_s,
                elastic_steps: 2,
                contact_pairs: u32::from(time_s > 1.0),
                max_penetration_ratio: ratio,
                ..StepReport::default()
            });
        }
        assert_eq!(tally.counts.steps, 3);
        assert_eq!(tally.counts.elastic_steps, 6);
        assert_eq!(tally.counts.contact_steps, 2);
        assert_eq!(tally.extremes.largest_penetration_time_s, 2.0);
        assert_eq!(tally.extremes.largest_penetration_ratio, 0.3);
        assert_eq!(tally.extremes.shortest_step_s, Some(1.0));
    }

    #[test]
    fn the_energy_error_is_the_change_of_the_balance() {
        let initial = Sample { kinetic_j: 5.0, ..Sample::default() };
        let last = Sample { strain_j: 4.0, external_work_j: 1.0, ..Sample::default() };
        let mut summary = Summary::new(SceneSummary::default(), &initial);
        let mut tally = Tally::default();
        for kinetic_j in [5.0, 1.5, 6.0] {
            tally.add_row(&initial, &Sample { kinetic_j, ..Sample::default() });
        }
        summary.update(&initial, &last, &tally, WallTime::default());
        assert_eq!(summary.energy_balance_error_j, -2.0);
        assert_eq!(summary.largest_energy_balance_error_j, 3.5);
    }
}
