//! How much a case may do, and how it steps its worlds.

use crate::scene::SceneError;
use crate::sim::{SimError, StepReport, World};

/// Why a case gave no values.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// Whoever asked wants an end.
    #[error("stopped")]
    Stopped,
    /// A world could not be built or stepped.
    #[error("{0}")]
    Sim(Box<SimError>),
    /// A scene could not be loaded.
    #[error("{0}")]
    Scene(Box<SceneError>),
    /// Anything else that keeps a case from being measured.
    #[error("{0}")]
    Unmeasured(String),
}

impl From<SimError> for CaseError {
    fn from(error: SimError) -> Self {
        Self::Sim(Box::new(error))
    }
}

impl From<SceneError> for CaseError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

/// How much a case may do, when it has to stop, and whom it tells how far it has come.
#[derive(Clone, Copy)]
pub struct Effort<'a> {
    /// Smaller meshes and fewer of them.
    pub quick: bool,
    /// Of a case that is many runs, those with this in their name; all by default.
    pub only: Option<&'a str>,
    /// Asked before every step; true ends the case with [`CaseError::Stopped`].
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Told what a long case has done so far, a line at a time.
    pub tell: &'a (dyn Fn(&str) + Sync),
}

/// Steps in a row that may leave time standing.
const STANDING_STEPS: u32 = 1000;

impl Effort<'_> {
    /// A small one that nobody listens to or stops.
    pub const QUICK: Effort<'static> = Effort { quick: true, only: None, stop: &|| false, tell: &|_| () };

    /// Steps a world to `end_s` and calls `each` after every step.
    ///
    /// # Errors
    /// [`CaseError`] when a step fails, time stands still, or an end is asked for.
    pub fn run(
        &self,
        world: &mut World,
        end_s: f64,
        mut each: impl FnMut(&World, &StepReport),
    ) -> Result<(), CaseError> {
        self.run_while(
            world,
            |world, report| {
                each(world, report);
                world.time_s() < end_s
            },
            end_s,
        )
    }

    /// Steps a world while `goes_on`, asked after every step, says so. No step looks beyond `end_s` for a touch.
    ///
    /// # Errors
    /// As [`Effort::run`].
    pub fn run_while(
        &self,
        world: &mut World,
        mut goes_on: impl FnMut(&World, &StepReport) -> bool,
        end_s: f64,
    ) -> Result<(), CaseError> {
        let mut standing = 0;
        loop {
            if (self.stop)() {
                return Err(CaseError::Stopped);
            }
            let before_s = world.time_s();
            let report = world.step(end_s)?;
            if !goes_on(world, &report) {
                return Ok(());
            }
            standing = if world.time_s() > before_s { 0 } else { standing + 1 };
            if standing >= STANDING_STEPS {
                return Err(CaseError::Unmeasured(format!("time stands still at {before_s} s")));
            }
        }
    }
}
