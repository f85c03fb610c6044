//! What goes to and from the simulation: commands in, snapshots out.

use super::foresight::Foreseen;
use super::history::History;
use super::inspection::Inspection;
use super::recording::{Mark, Recording};
use super::thrown::Throw;
use crate::frame::Frame;
use crate::scene::Scene;
use crate::sim::ContactParameters;
use glam::DVec3;
use std::sync::Arc;

use super::session::is_reached;

/// What the window asks of the simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Opens a built-in scene or a file with overrides (`path=value`).
    Open {
        /// Name or path.
        scene: String,
        /// Overrides.
        overrides: Vec<String>,
        /// Whether it plays at once.
        play: bool,
    },
    /// Closes the scene.
    Close,
    /// Lets time run.
    Play,
    /// Stops time.
    Pause,
    /// Takes one step and stops.
    Step,
    /// Back to the start, with these overrides on top of the scene as it was opened.
    Reset {
        /// Overrides.
        overrides: Vec<String>,
        /// Whether what was thrown, taken out, pulled and changed on the way comes again at its time.
        keep: bool,
    },
    /// Simulated seconds a second.
    SetSpeed(f64),
    /// Changes contact from the next step on, and after resets.
    SetContact(ContactParameters),
    /// Throws a body into the scene.
    Throw(Throw),
    /// Builds what a throw would bring in, without throwing it.
    Foresee {
        /// Comes back with it.
        number: u64,
        /// What would be thrown.
        throw: Throw,
        /// The recorded moment into which, s; `None`: the present.
        time_s: Option<f64>,
    },
    /// Takes a body out, by its number in the frame.
    Remove(usize),
    /// Grabs a body and pulls it after the mouse.
    Grab {
        /// Number of the body in the frame, and of the element in the body.
        element: (usize, u32),
        /// The grabbed point, m.
        point_m: DVec3,
        /// Where the mouse is, m.
        to_m: DVec3,
    },
    /// The mouse that pulls is here now, m.
    Drag(DVec3),
    /// Lets go what is pulled.
    LetGo,
    /// Takes back what was done last: the scene stands again where it was done.
    Undo,
    /// Does again what was taken back or dropped last, at its time.
    Redo,
    /// Does again what had been done at this place before that.
    RedoOther,
    /// Goes back to the recorded moment at this time, s; what came after it is left, and undo brings it back.
    PlayOnFrom {
        /// s.
        time_s: f64,
        /// Whether time runs at once.
        play: bool,
    },
    /// Looks closely at an element: number of the body in the frame, and of the element in the body.
    Inspect(Option<(usize, u32)>),
    /// Memory for the recording, bytes.
    SetMemoryLimit(usize),
    /// Whether frames hold what is inside the bodies.
    SetInterior(bool),
    /// Looks into the recorded moment at this time, s, or into none.
    LookInto(Option<f64>),
}

impl Command {
    /// Whether it goes another way than to what is about to be done again.
    #[must_use]
    pub fn is_another_way_on(&self) -> bool {
        !matches!(
            self,
            Self::Redo
                | Self::Play
                | Self::SetSpeed(_)
                | Self::Drag(_)
                | Self::Foresee { .. }
                | Self::LetGo
                | Self::Inspect(_)
                | Self::SetMemoryLimit(_)
                | Self::SetInterior(_)
                | Self::LookInto(_)
        )
    }
}

/// Something the user has to be told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Counts the notices, so that a dismissed one is not shown again.
    pub number: u64,
    /// What happened and what to do.
    pub text: String,
    /// Whether it only says what was done, and goes away by itself.
    pub is_passing: bool,
}

/// What a recorded moment that was looked into has to tell.
#[derive(Clone, Debug)]
pub struct Looked {
    /// Its time, s.
    pub time_s: f64,
    /// The frame with what is inside the bodies, if that is wanted.
    pub frame: Option<Arc<Frame>>,
    /// The element looked at closely, as it was then.
    pub inspection: Option<Inspection>,
}

/// Everything the window shows of one moment.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Commands carried out so far.
    pub commands_done: u64,
    /// Counts the scenes opened; a new one gets a new camera.
    pub opened: u64,
    /// Counts the worlds built.
    pub built: u64,
    /// The scene as it was opened; `None` when there is none.
    pub base: Option<Arc<Scene>>,
    /// The scene as it runs: with the overrides of the last reset.
    pub scene: Option<Arc<Scene>>,
    /// Contact as it acts now.
    pub contact: Option<ContactParameters>,
    /// Bodies by name, in the order of [`PairFriction::bodies`].
    pub body_names: Arc<[String]>,
    /// The last good frame.
    pub frame: Arc<Frame>,
    /// Balances over time.
    pub history: Arc<History>,
    /// Everything simulated so far, to look at again.
    pub recording: Arc<Recording>,
    /// The element looked at closely.
    pub inspection: Option<Inspection>,
    /// Whether frames hold what is inside the bodies.
    pub with_interior: bool,
    /// The recorded moment that is looked into.
    pub looked: Option<Looked>,
    /// What the scene has in store by itself: who comes in, goes out, is pulled, and when.
    pub planned: Arc<[Mark]>,
    /// What the throw under way would bring in.
    pub foreseen: Option<Arc<Foreseen>>,
    /// What undo would take back.
    pub undo: Option<String>,
    /// What redo would do again.
    pub redo: Option<String>,
    /// What had been done there before that.
    pub redo_other: Option<String>,
    /// What is done again when time gets there, while it plays on to it.
    pub redoing: Option<String>,
    /// What changes of contact and pulls add to the scene's text.
    pub late_text: Arc<str>,
    /// Whether something was done on the way that a reset could keep.
    pub can_repeat: bool,
    /// Whether time runs.
    pub is_playing: bool,
    /// Simulated seconds a second asked for.
    pub speed: f64,
    /// Simulated seconds a second reached; `None` when paused or too early to tell.
    pub real_time_factor: Option<f64>,
    /// Elastic step of the slowest body, s; infinite when nothing deforms.
    pub stable_step_s: f64,
    /// Why the run cannot go on, if so.
    pub run_error: Option<String>,
    /// The last thing that went wrong besides.
    pub notice: Option<Notice>,
}

impl Snapshot {
    /// Duration of the scene in s, when it is over and nothing plays.
    #[must_use]
    pub fn over_after_s(&self) -> Option<f64> {
        let duration_s = self.scene.as_ref()?.description.duration_s;
        (!self.is_playing && is_reached(self.frame.time_s, duration_s)).then_some(duration_s)
    }
}
