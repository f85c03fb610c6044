//! Triangles of a frame to come, built by other threads while pictures of the one before are drawn.

use crate::frame::Frame;
use crate::render::framing::{Floor, Framing};
use crate::render::geometry::{Coloring, GeometryBuilder};
use crate::render::range::Range;
use crate::render::view::{Ground, View};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// What of a view has to be worked out from the frame that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Look {
    pub floor: Option<Floor>,
    pub range: Option<Range>,
    pub cross_scale_pa: Option<f32>,
    pub coloring: Coloring,
}

impl Look {
    pub fn of(frame: &Frame, view: &View) -> Self {
        let range = view.range_for(frame);
        let cross_scale_pa = view.cross_scale_for(frame);
        let range_or_any = range.unwrap_or(Range { low: 0.0, high: 1.0 });
        Self {
            floor: match view.ground {
                Ground::Auto => Framing::of(frame).floor(),
                Ground::At(floor) => Some(floor),
                Ground::Hidden => None,
            },
            range,
            cross_scale_pa,
            coloring: Coloring { color_by: view.color_by, range: range_or_any, cross_scale_pa },
        }
    }

    /// Body that the floor stands for, an index into the frame's bodies.
    pub fn hidden(&self) -> Option<usize> {
        self.floor.and_then(|floor| floor.replaces)
    }
}

/// A frame as seen in a view, and what came of it.
#[derive(Debug)]
pub(crate) struct Prepared {
    frame: Arc<Frame>,
    view: View,
    state: State,
}

#[derive(Debug)]
enum State {
    Building(Receiver<Box<(GeometryBuilder, Look)>>),
    Done(Box<(GeometryBuilder, Look)>),
    /// Building broke off: whoever needs the triangles builds them.
    Failed,
}

impl Prepared {
    /// Has `workers` build; `builder` knows the topologies of the frames before.
    pub fn start(
        frame: &Arc<Frame>,
        view: &View,
        mut builder: GeometryBuilder,
        workers: &rayon::ThreadPool,
    ) -> Self {
        let (of, seen_in) = (frame.clone(), view.clone());
        let (sender, receiver) = channel();
        workers.spawn(move || {
            let build = AssertUnwindSafe(move || {
                let look = Look::of(&of, &seen_in);
                builder.build(&of, look.hidden(), look.coloring);
                (builder, look)
            });
            // The hook has told about a panic. Nobody may be waiting any more.
            let _ = catch_unwind(build).map(|built| sender.send(Box::new(built)).is_ok());
        });
        Self { frame: frame.clone(), view: view.clone(), state: State::Building(receiver) }
    }

    pub fn is_of(&self, frame: &Arc<Frame>, view: &View) -> bool {
        Arc::ptr_eq(frame, &self.frame) && *view == self.view
    }

    /// Whether nothing is to be waited for.
    pub fn is_ready(&mut self) -> bool {
        if let State::Building(receiver) = &self.state {
            self.state = match receiver.try_recv() {
                Ok(built) => State::Done(built),
                Err(TryRecvError::Empty) => return false,
                Err(TryRecvError::Disconnected) => State::Failed,
            };
        }
        true
    }

    /// What was built; `None` as long as it is not ready, and where that failed.
    pub fn built(&self) -> Option<(&GeometryBuilder, Look)> {
        if let State::Done(built) = &self.state { Some((&built.0, built.1)) } else { None }
    }

    /// The builder, for the next frame.
    pub fn into_builder(self) -> GeometryBuilder {
        if let State::Done(built) = self.state { built.0 } else { GeometryBuilder::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_another_thread_built_is_what_this_one_would_have() {
        let mut frame = Frame::default();
        let triangle = crate::frame::SurfaceTopology { triangles: vec![[0, 1, 2]], ..Default::default() };
        frame.bodies.push(crate::frame::BodyFrame {
            surface: Arc::new(triangle),
            positions_m: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]],
            ..Default::default()
        });
        let (frame, view) = (Arc::new(frame), View::default());
        let mut here = GeometryBuilder::default();
        let look = Look::of(&frame, &view);
        here.build(&frame, look.hidden(), look.coloring);
        let workers = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let mut prepared = Prepared::start(&frame, &view, GeometryBuilder::default(), &workers);
        assert!(prepared.is_of(&frame, &view) && !prepared.is_of(&Arc::new(Frame::default()), &view));
        while !prepared.is_ready() {
            std::thread::yield_now();
        }
        let (there, its_look) = prepared.built().unwrap();
        assert_eq!((&there.geometry().vertices, its_look), (&here.geometry().vertices, look));
        assert_eq!(prepared.into_builder().geometry().vertices.len(), 3);
    }
}
