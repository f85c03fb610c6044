//! Triangles of a frame to come, built by another thread while pictures of the one before are drawn.

use crate::frame::Frame;
use crate::render::framing::{Floor, Framing};
use crate::render::geometry::{Coloring, GeometryBuilder};
use crate::render::range::Range;
use crate::render::view::{Ground, View};
use std::sync::Arc;
use std::thread::JoinHandle;

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
    Building(JoinHandle<(GeometryBuilder, Look)>),
    Done(GeometryBuilder, Look),
    /// The thread could not be started or broke off: whoever needs the triangles builds them.
    Failed,
}

impl Prepared {
    /// Starts building; `builder` knows the topologies of the frames before.
    pub fn start(frame: &Arc<Frame>, view: &View, mut builder: GeometryBuilder) -> Self {
        let (of, seen_in) = (frame.clone(), view.clone());
        let build = move || {
            let look = Look::of(&of, &seen_in);
            builder.build(&of, look.hidden(), look.coloring);
            (builder, look)
        };
        let thread = std::thread::Builder::new().name("triangles".to_owned()).spawn(build);
        let state = thread.map_or(State::Failed, State::Building);
        Self { frame: frame.clone(), view: view.clone(), state }
    }

    pub fn is_of(&self, frame: &Arc<Frame>, view: &View) -> bool {
        Arc::ptr_eq(frame, &self.frame) && *view == self.view
    }

    /// Whether nothing is to be waited for.
    pub fn is_ready(&self) -> bool {
        match &self.state {
            State::Building(thread) => thread.is_finished(),
            State::Done(..) | State::Failed => true,
        }
    }

    /// What was built; waits for it. `None` where that failed.
    pub fn built(&mut self) -> Option<(&GeometryBuilder, Look)> {
        if matches!(self.state, State::Building(_))
            && let State::Building(thread) = std::mem::replace(&mut self.state, State::Failed)
        {
            self.state = thread.join().map_or(State::Failed, |(builder, look)| State::Done(builder, look));
        }
        match &self.state {
            State::Done(builder, look) => Some((builder, *look)),
            State::Building(_) | State::Failed => None,
        }
    }

    /// The builder, for the next frame.
    pub fn into_builder(mut self) -> GeometryBuilder {
        let _ = self.built();
        if let State::Done(builder, _) = self.state { builder } else { GeometryBuilder::default() }
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
        let mut prepared = Prepared::start(&frame, &view, GeometryBuilder::default());
        assert!(prepared.is_of(&frame, &view) && !prepared.is_of(&Arc::new(Frame::default()), &view));
        // It may be asked for more than once.
        for _ in 0..2 {
            let (there, its_look) = prepared.built().unwrap();
            assert_eq!((&there.geometry().vertices, its_look), (&here.geometry().vertices, look));
        }
        assert!(prepared.is_ready());
        assert_eq!(prepared.into_builder().geometry().vertices.len(), 3);
    }
}
