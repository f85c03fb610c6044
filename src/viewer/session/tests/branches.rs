//! Taking back what was done, doing it again, and doing something else.

use super::*;

#[test]
fn what_playing_on_from_an_earlier_moment_drops_is_told_and_can_be_done_again() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 20);
    let early_s = session.time_s();
    play(&mut session, 10);
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    play(&mut session, 10);
    session.execute(Command::Throw(dropped(ThrowKind::Cube)));
    play(&mut session, 10);
    let (then, end_s) = (session.snapshot().frame, session.time_s());

    session.execute(Command::PlayOnFrom { time_s: early_s, play: true });
    let notice = session.snapshot().notice.unwrap();
    assert!(notice.is_passing && notice.text.contains("2 later changes"), "{}", notice.text);
    assert!(notice.text.contains("Ball thrown in, Cube thrown in") && notice.text.contains("Ctrl Y"));
    assert!(notice.text.contains(&crate::render::with_unit(end_s, "s")) && notice.text.contains("Ctrl Z"));
    play(&mut session, 3);
    // Both again, at their times, and the same comes of it; the way there is recorded.
    session.execute(Command::Redo);
    session.execute(Command::Redo);
    arrive(&mut session);
    assert!(session.snapshot().redo.is_none());
    assert!(session.simulate_to(end_s));
    let now = session.snapshot().frame;
    assert_eq!(now.bodies.len(), then.bodies.len());
    for (now, then) in now.bodies.iter().zip(&then.bodies) {
        // Up to the rounding of free flight, whose steps end where moments are recorded.
        let is_same = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-5);
        assert!(now.positions_m.iter().zip(&then.positions_m).all(is_same), "{}", now.name);
    }
    let times: Vec<f64> = session.course.recording.moments().iter().map(|moment| moment.time_s).collect();
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] < 3.0 * FRAME_S), "{times:?}");

    // Nothing left, nothing told.
    let mut quiet = opened("bounce", &[]);
    play(&mut quiet, 10);
    quiet.execute(Command::PlayOnFrom { time_s: quiet.time_s(), play: true });
    assert!(quiet.snapshot().notice.is_none() && quiet.snapshot().undo.is_none());
}

/// Time of a recorded moment, edits before it, places of all bodies.
type Picture = (f64, usize, Vec<Vec<[f32; 3]>>);

fn recorded(session: &mut Session) -> Vec<Picture> {
    let recording = session.snapshot().recording;
    let places = |frame: &Frame| frame.bodies.iter().map(|body| body.positions_m.clone()).collect();
    recording.moments().iter().map(|m| (m.time_s, m.edits, places(&m.frame))).collect()
}

/// Everything that was there before somebody went back.
fn standing(session: &mut Session) -> (String, Vec<super::super::Row>, Option<String>, usize) {
    let seen = session.snapshot();
    (state(session), seen.history.rows().to_vec(), seen.undo, seen.frame.bodies.len())
}

/// A throw at a moment looked back at dropped the later time, and undo did not bring it back.
#[test]
fn the_later_time_comes_back_as_it_was_when_what_was_done_in_the_past_is_taken_back() {
    let mut session = opened("bounce", &[]);
    session.course.keyframe_every = 6;
    play(&mut session, 20);
    let early_s = session.time_s();
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    play(&mut session, 30);
    let (before, pictures) = (standing(&mut session), recorded(&mut session));
    let built = session.snapshot().built;

    // At the moment before the ball, and somewhere after it.
    for (time_s, then) in [(0.5 * early_s, 8), (early_s + 0.01, 3)] {
        session.execute(Command::PlayOnFrom { time_s, play: false });
        session.execute(Command::Throw(dropped(ThrowKind::Hammer)));
        assert!(session.snapshot().undo.unwrap().contains("Hammer"));
        // What was left is told besides what the hammer does.
        let told = session.snapshot().notice.unwrap().text;
        assert!(told.contains("waits above") && told.contains("the time up to"), "{told}");
        session.execute(Command::Play);
        play(&mut session, then);
        let branch = standing(&mut session);
        session.execute(Command::Undo);
        let told = session.snapshot().notice.unwrap().text;
        assert!(told.contains("Hammer") && told.contains("is back") && !told.contains("set aside"), "{told}");
        assert_eq!((standing(&mut session), recorded(&mut session)), (before.clone(), pictures.clone()));
        assert_eq!(session.snapshot().built, built, "it is the same run");
        // And the branch, where it stood.
        assert!(session.snapshot().redo.unwrap().contains("Hammer"));
        session.execute(Command::Redo);
        assert_eq!(standing(&mut session), branch);
        session.execute(Command::Undo);
        assert_eq!(standing(&mut session), before);
    }
    // Every moment can be gone back to as before.
    let moment = recorded(&mut session)[40].clone();
    session.execute(Command::PlayOnFrom { time_s: moment.0, play: false });
    assert_eq!(recorded(&mut session).last(), Some(&moment));
    session.execute(Command::Undo);
    // What was done before is taken back as ever, and something new leaves nothing to do again.
    session.execute(Command::Undo);
    assert_eq!(session.time_s(), early_s);
    assert!(session.snapshot().undo.is_none());
}

#[test]
fn playing_on_is_taken_back_after_what_was_done_since_and_outlives_a_reset() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 20);
    let (before, early_s) = (standing(&mut session), session.course.recording.moments()[5].time_s);
    session.execute(Command::PlayOnFrom { time_s: early_s, play: true });
    play(&mut session, 4);
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    session.execute(Command::Undo);
    assert!(session.snapshot().undo.unwrap().contains("going on from"));
    session.execute(Command::Reset { overrides: Vec::new(), keep: false });
    session.execute(Command::Undo);
    session.execute(Command::Undo);
    assert_eq!(standing(&mut session), before);
    // Once something else is done, there is nothing to come back to.
    session.execute(Command::Throw(dropped(ThrowKind::Cube)));
    assert!(session.snapshot().redo.is_none());
}

/// A session whose recording is limited to twice the least memory.
fn short_of_memory() -> Session {
    let mut session = opened("brick-pile", &["recording.start=0", "recording.slow_motion=8000"]);
    session.execute(Command::SetMemoryLimit(2 * super::super::super::recording::LEAST_LIMIT_BYTES));
    session.execute(Command::SetInterior(true));
    session
}

fn moments(session: &Session) -> usize {
    session.course.recording.moments().len()
}

fn play_until(session: &mut Session, count: usize) {
    while moments(session) < count {
        play(session, 1);
    }
}

#[test]
fn a_later_time_that_does_not_fit_into_memory_is_thinned_out_and_that_is_told() {
    let mut session = short_of_memory();
    while session.course.recording.one_of() == 1 {
        play(&mut session, 1);
    }
    let (most, thinned) = (2 * moments(&session), moments(&session));
    // More than what is left may have, which is half of the memory.
    play_until(&mut session, thinned + thinned / 2);
    let (state_then, recorded) = (state(&session), moments(&session));
    session.execute(Command::PlayOnFrom { time_s: 0.0, play: true });
    let told = session.snapshot().notice.unwrap().text;
    play(&mut session, 10);
    session.execute(Command::Undo);
    assert_eq!(state(&session), state_then, "the end of it is always kept");
    assert!(moments(&session) < recorded, "all of it is kept");
    assert!(told.contains("Memory is short"), "{told}");

    // One that fits comes back whole, though it does not fit twice.
    let mut session = short_of_memory();
    play_until(&mut session, most * 78 / 100);
    let (recorded, early_s) = (moments(&session), session.course.recording.moments()[most * 31 / 100].time_s);
    session.execute(Command::PlayOnFrom { time_s: early_s, play: true });
    assert!(!session.snapshot().notice.unwrap().text.contains("Memory is short"));
    session.execute(Command::Undo);
    assert_eq!(moments(&session), recorded);
}

/// Whether the saved scene has the same bodies in the same places, up to the rounding of free flight.
fn assert_saved_with_all(session: &mut Session) {
    let mut again = saved(session);
    let world = &mut again.course.run.as_mut().unwrap().world;
    while world.time_s() < session.time_s() {
        world.step(session.time_s()).unwrap();
    }
    world.catch_up().unwrap();
    let (now, then) = (world.publish(), session.snapshot().frame);
    assert_eq!(now.bodies.len(), then.bodies.len());
    for (now, then) in now.bodies.iter().zip(&then.bodies) {
        let is_same = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-5);
        assert!(
            now.name == then.name && now.positions_m.iter().zip(&then.positions_m).all(is_same),
            "{}",
            now.name
        );
    }
}

/// The session with two bodies thrown in, back before both, and the number of bodies at the start.
fn dropped_ball_and_cube() -> (Session, usize) {
    let mut session = opened("bounce", &[]);
    let bodies = session.snapshot().frame.bodies.len();
    play(&mut session, 10);
    let early_s = session.time_s();
    play(&mut session, 10);
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    play(&mut session, 10);
    session.execute(Command::Throw(dropped(ThrowKind::Cube)));
    play(&mut session, 5);
    session.execute(Command::PlayOnFrom { time_s: early_s, play: true });
    play(&mut session, 1);
    (session, bodies)
}

fn redo_words(session: &mut Session) -> [Option<String>; 2] {
    let snapshot = session.snapshot();
    [snapshot.redo, snapshot.redo_other]
}

#[test]
fn what_is_done_again_follows_what_it_followed_and_nothing_else() {
    let (mut session, bodies) = dropped_ball_and_cube();
    session.execute(Command::Throw(dropped(ThrowKind::Hammer)));
    play(&mut session, 5);
    session.execute(Command::Undo);
    let hammer_and_ball = redo_words(&mut session);
    assert_eq!(hammer_and_ball, ["Hammer thrown in", "Ball thrown in"].map(|text| Some(text.to_owned())));
    // Only the hammer: the ball was thrown into a scene without it.
    session.execute(Command::Redo);
    session.execute(Command::Redo);
    arrive(&mut session);
    assert_eq!(redo_words(&mut session), [None, None]);
    assert_eq!(session.snapshot().frame.bodies.len(), bodies + 1);
    assert_saved_with_all(&mut session);
    // The ball and the cube instead.
    session.execute(Command::Undo);
    session.execute(Command::RedoOther);
    session.execute(Command::Redo);
    arrive(&mut session);
    let seen = session.snapshot();
    assert_eq!((seen.frame.bodies.len(), seen.redo), (bodies + 2, None));
    assert_saved_with_all(&mut session);
    // And the hammer is not lost for it.
    session.execute(Command::Undo);
    session.execute(Command::Undo);
    assert_eq!(
        redo_words(&mut session),
        ["Ball thrown in", "Hammer thrown in"].map(|text| Some(text.to_owned()))
    );
}

#[test]
fn nothing_that_was_taken_back_is_lost_when_another_thing_is() {
    let (mut session, _) = dropped_ball_and_cube();
    session.execute(Command::Throw(dropped(ThrowKind::Hammer)));
    session.execute(Command::Throw(dropped(ThrowKind::Cube)));
    session.execute(Command::Undo);
    session.execute(Command::Undo);
    session.execute(Command::Redo);
    assert_eq!(redo_words(&mut session), [Some("Cube thrown in".to_owned()), None]);
}

#[test]
fn contact_or_a_grab_in_vain_leave_what_was_dropped_within_reach() {
    let (mut session, bodies) = dropped_ball_and_cube();
    let slide = |session: &mut Session, friction_coefficient: f64| {
        let contact = session.snapshot().contact.unwrap();
        session.execute(Command::SetContact(ContactParameters { friction_coefficient, ..contact }));
    };
    let before = session.snapshot().contact.unwrap().friction_coefficient;
    slide(&mut session, 0.7);
    slide(&mut session, 0.8);
    let name = session.snapshot().body_names.last().unwrap().clone();
    grab(&mut session, &name);
    session.execute(Command::LetGo);
    assert_eq!(redo_words(&mut session)[0].as_deref(), Some("Ball thrown in"));
    session.execute(Command::Redo);
    arrive(&mut session);
    let seen = session.snapshot();
    assert_eq!((seen.frame.bodies.len(), seen.contact.unwrap().friction_coefficient), (bodies + 1, 0.8));
    assert_saved_with_all(&mut session);
    // The slider is taken back and done again in one go.
    session.execute(Command::Undo);
    session.execute(Command::Undo);
    let friction = |session: &mut Session| session.snapshot().contact.unwrap().friction_coefficient;
    assert_eq!(friction(&mut session), before);
    assert!(session.snapshot().undo.unwrap().contains("going on from") && session.course.contact.is_none());
    session.execute(Command::Redo);
    assert_eq!(friction(&mut session), 0.8);
}

#[test]
fn the_way_to_what_is_done_again_can_be_paused_and_taken_up() {
    let (mut session, bodies) = dropped_ball_and_cube();
    session.execute(Command::Pause);
    let early_s = session.time_s();
    session.execute(Command::Redo);
    assert_eq!(session.time_s(), early_s, "the way is not gone while commands wait");
    assert!(!session.advance(0.0, || true));
    let seen = session.snapshot();
    assert!(seen.is_playing && seen.redoing.is_some_and(|what| what.contains("Ball")));
    assert!(session.time_s() > early_s);
    session.execute(Command::Pause);
    let seen = session.snapshot();
    assert!(!seen.is_playing && seen.redoing.is_none());
    assert_eq!((seen.frame.bodies.len(), seen.redo.as_deref()), (bodies, Some("Ball thrown in")));
    session.execute(Command::Redo);
    arrive(&mut session);
    let seen = session.snapshot();
    assert_eq!((seen.frame.bodies.len(), seen.is_playing), (bodies + 1, false));
    // A run that fails on the way keeps what was to be done again.
    session.execute(Command::Redo);
    session.fail("blown up".to_owned());
    session.advance(0.0, || true);
    assert_eq!(redo_words(&mut session)[0].as_deref(), Some("Cube thrown in"));
}

#[test]
fn extreme_slow_motion_does_not_keep_a_moment_out_of_reach() {
    let mut session = opened("bounce", &["recording.slow_motion=1e9"]);
    assert!(session.simulate_to(0.05) && is_reached(session.time_s(), 0.05));
}

#[test]
fn nobody_of_a_wrong_number_is_taken_out() {
    let mut session = opened("bounce", &[]);
    let leave = super::edit_tree::Done::Leave(session.snapshot().scene.unwrap(), 99, String::new());
    assert!(session.course.run.as_mut().unwrap().make(&leave).is_err());
}

/// One throw into the past, taken back, was offered twice in the same words.
#[test]
fn what_leads_to_the_same_is_offered_once_and_the_rest_is_told_apart() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 10);
    let early_s = session.time_s();
    play(&mut session, 10);
    let throw = |session: &mut Session, kind: ThrowKind| {
        session.execute(Command::PlayOnFrom { time_s: early_s, play: false });
        session.execute(Command::Throw(dropped(kind)));
        session.execute(Command::Undo);
    };
    throw(&mut session, ThrowKind::Hammer);
    assert_eq!(redo_words(&mut session), [Some("Hammer thrown in".to_owned()), None]);
    throw(&mut session, ThrowKind::Hammer);
    let words = ["Hammer thrown in", "Hammer thrown in, the earlier one"];
    assert_eq!(redo_words(&mut session), words.map(|words| Some(words.to_owned())));
    // The other one is made, and not what redo makes.
    let first = session.course.edits.next_number();
    session.execute(Command::RedoOther);
    arrive(&mut session);
    assert_eq!((session.time_s(), session.course.edits.path().len()), (early_s, 1));
    assert_ne!(session.course.edits.path().first().copied(), first);
}
