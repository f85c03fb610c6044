//! Taking back a reset: what was done before it was lost, and nothing said so.

use super::*;

fn reset(session: &mut Session, keep: bool) {
    session.execute(Command::Reset { overrides: Vec::new(), keep });
}

/// Bytes of the state, time, moments recorded, and what undo and redo would do.
fn standing(session: &mut Session) -> (String, f64, usize, Option<String>, Option<String>) {
    let seen = session.snapshot();
    (state(session), session.time_s(), seen.recording.moments().len(), seen.undo, seen.redo)
}

/// A scene with a ball dropped in, and one taken back.
fn dropped_and_taken_back() -> Session {
    let mut session = opened("bounce", &[]);
    play(&mut session, 10);
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    play(&mut session, 10);
    session.execute(Command::Throw(dropped(ThrowKind::Cube)));
    session.execute(Command::Undo);
    session
}

#[test]
fn starting_again_is_taken_back_with_all_that_was_before_and_done_again() {
    let mut session = dropped_and_taken_back();
    let before = standing(&mut session);
    let thrown_s = session.course.edits.iter().next().unwrap().time_s;
    reset(&mut session, true);
    let told = session.snapshot().notice.unwrap();
    assert!(
        told.is_passing && told.text.contains("Ball thrown in") && told.text.contains("Ctrl Z"),
        "{told:?}"
    );
    let seen = session.snapshot();
    assert_eq!((session.time_s(), seen.undo.as_deref()), (0.0, Some(RERUN)));
    // What will come is marked before it comes, and once.
    let planned: Vec<(f64, &str)> =
        seen.planned.iter().map(|mark| (mark.time_s, mark.text.as_str())).collect();
    assert_eq!(planned, [(thrown_s, "thrown-ball-1 comes in")]);
    // Another throw on the way, which is taken back first.
    play(&mut session, 15);
    session.execute(Command::Throw(dropped(ThrowKind::Hammer)));
    play(&mut session, 2);
    let again = standing(&mut session);
    session.execute(Command::Undo);
    assert_eq!(session.snapshot().undo.as_deref(), Some(RERUN));
    let built = session.snapshot().built;
    session.execute(Command::Undo);
    let seen = session.snapshot();
    // The window has to look anew, and what was taken back before can still be done again.
    assert!(seen.built > built && seen.planned.is_empty());
    assert_eq!(seen.redo_other.as_deref(), Some("Cube thrown in"));
    let (now, time_s, moments, undo, _) = standing(&mut session);
    assert_eq!((now, time_s, moments, undo), (before.0, before.1, before.2, before.3));
    assert_eq!(seen.redo.as_deref(), Some(RERUN));
    // Edits before it are taken back and done again as ever.
    session.execute(Command::Undo);
    assert_eq!(session.snapshot().redo.as_deref(), Some("Ball thrown in"));
    session.execute(Command::Redo);
    assert_eq!(session.time_s(), thrown_s);
    assert_eq!(session.snapshot().redo.as_deref(), Some(RERUN));
    session.execute(Command::Redo);
    assert_eq!(session.snapshot().redo.as_deref(), Some("Hammer thrown in"));
    session.execute(Command::Redo);
    assert!(session.simulate_to(again.1));
    assert_eq!(session.snapshot().frame.bodies.len(), 4, "ground, ball, both thrown");
}

#[test]
fn what_was_done_before_the_reset_can_be_done_again_instead_of_it() {
    let mut session = dropped_and_taken_back();
    reset(&mut session, true);
    session.execute(Command::Undo);
    session.execute(Command::RedoOther);
    arrive(&mut session);
    assert!(session.snapshot().undo.is_some_and(|what| what.contains("Cube")));
    assert!(session.snapshot().redo.is_none(), "the reset was not done here");
}

#[test]
fn a_scene_with_plans_of_its_own_shows_them_and_none_beyond_its_end() {
    let (_folder, path) = late_slider();
    let planned = |session: &mut Session| {
        let marks = session.snapshot().planned.clone();
        marks.iter().map(|mark| mark.text.clone()).collect::<Vec<_>>()
    };
    let mut session = opened(&path, &[]);
    assert_eq!(planned(&mut session), ["late comes in", "later comes in"]);
    let mut session = opened(&path, &["bodies.later.enters=1e6"]);
    assert_eq!(planned(&mut session), ["late comes in"]);
    // What was thrown beyond the end comes again there.
    let mut session = opened("bounce", &["time.duration=0.01"]);
    assert!(session.simulate_to(0.02));
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    reset(&mut session, true);
    assert_eq!(planned(&mut session), ["thrown-ball-1 comes in"]);
}

#[test]
fn a_plain_reset_is_taken_back_too_and_one_of_nothing_is_none() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 5);
    reset(&mut session, false);
    assert!(session.snapshot().undo.is_none() && session.snapshot().notice.is_none());
    play(&mut session, 5);
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    let (thrown, thrown_s) = (state(&session), session.time_s());
    reset(&mut session, false);
    assert!(session.snapshot().notice.unwrap().text.contains("without what was done: Ball thrown in"));
    // Once more from there: the run in between had nothing of its own.
    play(&mut session, 3);
    reset(&mut session, false);
    session.execute(Command::Undo);
    assert_eq!((state(&session), session.time_s()), (thrown, thrown_s));
    // Another scene is another beginning.
    reset(&mut session, false);
    let open = Command::Open { scene: "bounce".to_owned(), overrides: Vec::new(), play: false };
    session.execute(open);
    assert!(session.snapshot().undo.is_none());
}

#[test]
fn a_run_that_failed_comes_back_as_it_stood() {
    let mut session = dropped_and_taken_back();
    session.snapshot();
    session.fail("blown up".to_owned());
    let frame = session.snapshot().frame;
    reset(&mut session, true);
    assert!(session.snapshot().run_error.is_none());
    session.execute(Command::Undo);
    let seen = session.snapshot();
    assert_eq!((seen.run_error.as_deref(), seen.frame.time_s), (Some("blown up"), frame.time_s));
}

#[test]
fn runs_before_resets_share_the_memory_of_the_recording() {
    let limit = super::super::super::recording::LEAST_LIMIT_BYTES;
    let mut session = opened("brick-pile", &["recording.start=0", "recording.slow_motion=400"]);
    session.execute(Command::SetMemoryLimit(limit));
    for _ in 0..4 {
        session.execute(Command::Throw(dropped(ThrowKind::Ball)));
        play(&mut session, 30);
        reset(&mut session, true);
    }
    let bytes = session.snapshot().recording.bytes();
    assert!(bytes > session.course.recording.own_bytes(), "they are counted");
    assert!(bytes < 2 * limit, "{bytes}");
    // However little there is, the last one can be gone back to.
    session.execute(Command::Undo);
    assert!(session.snapshot().undo.is_some_and(|what| what.contains("Ball")));
    session.execute(Command::Undo);
    assert!(session.snapshot().notice.unwrap().text.contains("Taken back: Ball"));
}
