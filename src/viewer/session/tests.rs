//! What commands do, without the thread.

use super::super::closer::has_interior;
use super::super::thrown::{Placing, TOOL, Throw, ThrowKind};
use super::*;
use crate::export::csv::HistoryWriter;
use crate::frame::Frame;

fn opened(scene: &str, overrides: &[&str]) -> Session {
    let mut session = Session::default();
    let overrides = overrides.iter().map(|text| (*text).to_owned()).collect();
    session.execute(Command::Open { scene: scene.to_owned(), overrides, play: true });
    session
}

/// A body that falls from above.
fn dropped(kind: ThrowKind) -> Throw {
    Throw { kind, material: TOOL.to_owned(), scale: 1.0, placing: Placing::Above { top_m: Some(1e3) } }
}

/// Plays on to what is done again, stopped after every step.
fn arrive(session: &mut Session) {
    while session.redoing.is_some() {
        session.advance(0.0, || true);
    }
}

/// Plays so many moments, as on a machine that is always in time.
fn play(session: &mut Session, moments: u32) {
    for moment in 0..moments {
        assert!(session.advance(f64::from(moment) * FRAME_S, || false));
    }
}

#[test]
fn a_scene_plays_at_its_own_slow_motion() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 30);
    let snapshot = session.snapshot();
    let slow_motion = snapshot.scene.unwrap().description.recording.slow_motion;
    assert!((snapshot.frame.time_s - 30.0 * FRAME_S / slow_motion).abs() < 1e-9);
    assert_eq!(snapshot.history.rows().len(), 31);
    assert!(snapshot.stable_step_s.is_finite() && snapshot.is_playing);
}

/// Nothing happens yet, and rounding is no energy.
/// A saved scene with stress crosses lacked them in its first moments.
#[test]
fn what_a_scene_shows_inside_is_recorded_from_the_start() {
    for (overrides, is_inside) in [(&[][..], false), (&["recording.crosses=true"][..], true)] {
        let session = opened("bounce", overrides);
        let first = session.course.recording.moments().first().unwrap();
        assert_eq!(has_interior(&first.frame), is_inside);
    }
}

#[test]
fn a_scene_at_rest_has_no_balances_made_of_round_off() {
    let mut session = opened("pile-split", &[]);
    let row = session.snapshot().history.rows()[0];
    assert_eq!((row.kinetic_j, row.strain_j, row.potential_j, row.sum_j), (0.0, 0.0, 0.0, 0.0));
    assert!(
        session.course.run.as_ref().unwrap().world.sample().strain_j != 0.0,
        "the scene has no round-off"
    );
}

#[test]
fn what_is_seen_does_not_depend_on_the_clock() {
    let (mut punctual, mut late) = (opened("bounce", &[]), opened("bounce", &[]));
    play(&mut punctual, 80);
    let mut moments = 0;
    while moments < 80 {
        // Interrupted after every step, and far behind.
        moments += u32::from(late.advance(f64::from(moments) * 9.0, || true));
    }
    assert_eq!(punctual.course.history, late.course.history);
}

#[test]
fn elastic_steps_do_not_depend_on_the_speed() {
    let elastic_steps_at = |speed: f64| {
        let mut session = opened("rods-collision", &[]);
        session.execute(Command::SetSpeed(speed));
        let mut free_steps = 0;
        while session.time_s() < 1e-4 {
            session.advance(0.0, || false);
            let world = &session.course.run.as_ref().unwrap().world;
            if !world.is_deforming() {
                free_steps = world.steps();
            }
        }
        let world = &session.course.run.as_ref().unwrap().world;
        (world.steps() - free_steps, world.sample().balance_j())
    };
    assert_eq!(elastic_steps_at(1.0 / 2e4), elastic_steps_at(1.0 / 3e5));
}

#[test]
fn playing_hurries_to_what_the_recording_shows_unless_a_speed_was_chosen() {
    let scene = ["recording.start=0.0405", "recording.slow_motion=1000"];
    let mut session = opened("bounce", &scene);
    play(&mut session, 3);
    assert!((session.time_s() - 0.0405).abs() < 1e-3, "{}", session.time_s());
    play(&mut session, 3);
    assert!(session.time_s() < 0.041, "{}", session.time_s());
    let mut chosen = opened("bounce", &scene);
    chosen.execute(Command::SetSpeed(1e-3));
    play(&mut chosen, 3);
    assert!(chosen.time_s() < 1e-3, "{}", chosen.time_s());
}

#[test]
fn playing_pauses_at_the_end_and_goes_on_beyond_when_asked_again() {
    let mut session = opened("bounce", &["time.duration=0.0405"]);
    play(&mut session, 300);
    let snapshot = session.snapshot();
    assert!(!snapshot.is_playing && is_reached(snapshot.frame.time_s, 0.0405));
    assert!(snapshot.frame.time_s < 0.041, "{}", snapshot.frame.time_s);
    assert_eq!(snapshot.over_after_s(), Some(0.0405));
    session.execute(Command::Play);
    play(&mut session, 30);
    let beyond = session.snapshot();
    assert!(beyond.is_playing && beyond.frame.time_s > snapshot.frame.time_s);
    assert_eq!(beyond.over_after_s(), None);
    session.execute(Command::Reset { overrides: Vec::new(), keep: false });
    assert_eq!(session.snapshot().over_after_s(), None);
}

/// Two hammers stood still in the air at the end of the scene.
#[test]
fn what_is_thrown_late_flies_on_beyond_the_end() {
    let mut session = opened("bounce", &["time.duration=0.04"]);
    session.execute(Command::SetSpeed(0.1));
    play(&mut session, 22);
    let thrown_s = session.time_s();
    assert!(session.is_playing() && (0.03..0.04).contains(&thrown_s), "{thrown_s}");
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    play(&mut session, 600);
    assert!(!session.is_playing() && is_reached(session.time_s(), thrown_s + 0.02), "{}", session.time_s());
    assert!(session.time_s() < thrown_s + 0.021, "{}", session.time_s());
}

#[test]
fn pause_step_and_reset_do_what_they_say() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 5);
    session.execute(Command::Pause);
    let paused_s = session.time_s();
    assert_eq!(session.wait_s(0.0), None);
    session.advance(10.0, || false);
    assert_eq!(session.time_s(), paused_s);
    session.execute(Command::Step);
    assert!(session.time_s() > paused_s && !session.is_playing());
    session.execute(Command::Reset { overrides: Vec::new(), keep: false });
    let snapshot = session.snapshot();
    assert_eq!((snapshot.frame.time_s, snapshot.history.rows().len()), (0.0, 1));
}

/// history.csv of the session's world from where it stands to `until_s`, a row for every step.
fn history_csv(session: &mut Session, until_s: f64) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    let mut history = HistoryWriter::create(&path).unwrap();
    let world = &mut session.course.run.as_mut().unwrap().world;
    while !is_reached(world.time_s(), until_s) {
        world.step(until_s).unwrap();
        history.write(&world.sample()).unwrap();
    }
    drop(history);
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn every_reset_gives_the_same_bytes_on_one_and_two_threads() {
    // Two bodies of several thousand elements, in contact from 30 us on.
    const UNTIL_S: f64 = 4e-5;
    let runs = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut session = opened("rods-collision-fine", &[]);
            let first = history_csv(&mut session, UNTIL_S);
            session.execute(Command::Reset { overrides: Vec::new(), keep: false });
            [first, history_csv(&mut session, UNTIL_S)]
        })
    });
    let first = &runs[0][0];
    assert!(first.contains("collision") && first.lines().count() > 50, "{first}");
    assert!(runs.iter().flatten().all(|history| history == first));
}

#[test]
fn overrides_act_at_the_reset_and_on_the_scene_as_opened() {
    let mut session = opened("hammer-ground", &[]);
    let modulus = |session: &mut Session| {
        let scene = session.snapshot().scene.unwrap();
        scene.description.materials.iter().find(|m| m.name == "head").unwrap().youngs_modulus_pa
    };
    let before = modulus(&mut session);
    session.execute(Command::Reset {
        overrides: vec!["materials.head.youngs_modulus=2e6".to_owned()],
        keep: false,
    });
    assert_eq!(modulus(&mut session), 2e6);
    session.execute(Command::Reset {
        overrides: vec!["materials.head.youngs_modulus=-1".to_owned()],
        keep: false,
    });
    assert_eq!(modulus(&mut session), 2e6);
    assert!(session.snapshot().notice.unwrap().text.contains("youngs_modulus"));
    session.execute(Command::Reset { overrides: Vec::new(), keep: false });
    assert_eq!(modulus(&mut session), before);
}

#[test]
fn contact_acts_at_once_and_outlives_a_reset() {
    let mut session = opened("bounce", &[]);
    let contact = ContactParameters { friction_coefficient: 0.9, ..session.snapshot().contact.unwrap() };
    session.execute(Command::SetContact(contact.clone()));
    assert_eq!(session.snapshot().contact.as_ref(), Some(&contact));
    session.execute(Command::Reset { overrides: Vec::new(), keep: false });
    assert_eq!(session.snapshot().contact, Some(contact.clone()));
    session.execute(Command::SetContact(ContactParameters { friction_coefficient: -1.0, ..contact.clone() }));
    assert_eq!(session.snapshot().contact, Some(contact));
    assert!(session.snapshot().notice.is_some());
}

#[test]
fn dropped_bodies_start_clear_of_all_others_and_fall() {
    let mut session = opened("hammer-ground", &[]);
    for kind in [ThrowKind::Hammer, ThrowKind::Cube, ThrowKind::Ball, ThrowKind::Cube] {
        session.execute(Command::Throw(dropped(kind)));
    }
    let setup = session.course.run.as_ref().unwrap().world.setup().clone();
    assert_eq!(setup.bodies.len(), 6);
    // What was thrown before does not change the size of what is thrown.
    let [one, other] = [3, 5].map(|body| setup.bodies[body].mesh.volume_m3());
    assert!((one / other - 1.0).abs() < 1e-9, "{one} {other}");
    for second in 1..setup.bodies.len() {
        for first in 0..second {
            let [a, b] = [first, second].map(|body| &setup.bodies[body].mesh);
            assert_eq!(crate::mesh::overlap(a, b), None, "{first} {second}");
        }
    }
    let kinetic = |session: &Session| session.course.history.rows().last().unwrap().kinetic_j;
    let before = kinetic(&session);
    play(&mut session, 60);
    assert!(kinetic(&session) > before && session.course.run_error.is_none());
    assert_eq!(session.snapshot().frame.bodies.len(), 6);
}

#[test]
fn a_broken_scene_is_told_and_the_old_one_stays() {
    let mut session = opened("bounce", &[]);
    let open = |scene: &str| Command::Open { scene: scene.to_owned(), overrides: vec![], play: true };
    session.execute(open("no-such-scene"));
    let snapshot = session.snapshot();
    assert!(snapshot.notice.unwrap().text.contains("no-such-scene"));
    assert_eq!(snapshot.scene.unwrap().name, "bounce");
}

#[test]
fn a_failed_run_keeps_its_last_frame_until_the_reset() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 5);
    let time_s = session.snapshot().frame.time_s;
    session.fail("blown up".to_owned());
    session.execute(Command::Play);
    session.execute(Command::Step);
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    let kept = session.course.keyframes.len();
    let contact = ContactParameters { friction_coefficient: 0.9, ..session.snapshot().contact.unwrap() };
    session.execute(Command::SetContact(contact));
    assert_eq!(session.course.keyframes.len(), kept, "nobody goes back to a world that failed");
    let snapshot = session.snapshot();
    assert!(!snapshot.is_playing && snapshot.run_error.is_some());
    assert_eq!(snapshot.frame.time_s, time_s);
    session.execute(Command::Reset { overrides: Vec::new(), keep: false });
    session.execute(Command::Play);
    assert!(session.is_playing() && session.snapshot().run_error.is_none());
}

/// Everything that sums up the state of the session's world now.
fn state(session: &Session) -> String {
    let run = session.course.run.as_ref().unwrap();
    let positions: Vec<_> = (0..run.world.body_count()).map(|b| run.world.positions_m(b).to_vec()).collect();
    format!("{:?} {:?} {positions:?}", run.world.time_s(), run.world.sample())
}

#[test]
fn playing_on_from_a_recorded_moment_gives_the_same_bytes() {
    // Breaks: cracks, contact within bodies and fragments all have to come back.
    let mut session = opened("brick-pile", &["time.duration=1", "recording.slow_motion=200"]);
    session.course.keyframe_every = 7;
    play(&mut session, 90);
    let throw = Throw {
        placing: Placing::From {
            position_m: glam::DVec3::new(0.3, 0.3, 0.6),
            velocity_m_s: glam::DVec3::new(-8.0, -7.0, -8.0),
            spin_rad_s: glam::DVec3::X,
        },
        ..dropped(ThrowKind::Ball)
    };
    session.execute(Command::Throw(throw));
    play(&mut session, 40);
    let end = session.snapshot();
    assert!(end.frame.status.fragments > 8, "nothing broke: {:?}", end.frame.status);
    assert!(session.course.keyframes.len() > 5 && end.recording.marks().len() > 2);
    let bytes = state(&session);
    let moments = end.recording.moments();
    assert_eq!(moments.len(), 131);
    // After the throw, before it, among the cracks, before the blow.
    for (from, to) in [(120, 130), (88, 90), (60, 85), (3, 40)] {
        session.execute(Command::PlayOnFrom { time_s: moments[from].time_s, play: true });
        let back = session.snapshot();
        assert_eq!(
            (back.frame.time_s, session.course.edits.len()),
            (moments[from].time_s, moments[from].edits)
        );
        assert_eq!(back.scene.unwrap().setup.changes.len(), moments[from].edits);
        assert_eq!(seen(&back.frame), seen(&moments[from].frame), "back at {from}");
        let world = &mut session.course.run.as_mut().unwrap().world;
        while world.time_s() < moments[to].time_s {
            world.step(moments[to].time_s).unwrap();
        }
        assert_eq!(seen(&world.publish()), seen(&moments[to].frame), "from {from} to {to}");
        if to == 130 {
            assert_eq!(state(&session), bytes);
        }
    }
}

/// Time, places and stresses of a frame.
fn seen(frame: &Frame) -> Vec<(f64, Vec<[f32; 3]>, Vec<f32>)> {
    let bodies = frame.bodies.iter();
    bodies.map(|b| (frame.time_s, b.positions_m.clone(), b.fields.von_mises_pa.clone())).collect()
}

#[test]
fn a_saved_scene_throws_again_what_was_thrown_and_gives_the_same_bytes() {
    let mut session = opened("brick-pile", &["time.duration=1", "recording.slow_motion=300"]);
    play(&mut session, 40);
    session.execute(Command::Throw(dropped(ThrowKind::Hammer)));
    play(&mut session, 20);
    session.execute(Command::Throw(dropped(ThrowKind::CopyOf("top".to_owned()))));
    play(&mut session, 10);
    let lower = session.snapshot().body_names.iter().position(|name| name == "lower-2").unwrap();
    session.execute(Command::Remove(lower));
    play(&mut session, 30);
    let seen = session.snapshot();
    assert!(seen.notice.is_none(), "{:?}", seen.notice);
    assert!(seen.frame.bodies[lower].positions_m.is_empty());
    let text = seen.scene.unwrap().to_toml();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, &text).unwrap();
    let mut again = opened(path.to_str().unwrap(), &[]);
    play(&mut again, 100);
    assert_eq!(state(&again), state(&session), "{text}");
    assert_eq!(again.course.history.rows().last(), session.course.history.rows().last());
}

#[test]
fn undo_brings_back_the_moment_before_the_throw() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 20);
    let (before, time_s) = (state(&session), session.time_s());
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    play(&mut session, 20);
    assert!(session.snapshot().undo.unwrap().contains("Ball"));
    session.execute(Command::Undo);
    assert_eq!((state(&session), session.time_s()), (before, time_s));
    let snapshot = session.snapshot();
    assert!(snapshot.undo.is_none() && snapshot.is_playing);
    assert!(snapshot.scene.unwrap().setup.changes.is_empty());
    assert!(snapshot.history.rows().iter().all(|row| row.time_s <= time_s));
    assert!(snapshot.recording.marks().iter().all(|mark| !mark.text.contains("thrown")), "its mark is left");
}

/// Grabs a body by the element nearest to its middle, where it is now.
fn grab(session: &mut Session, name: &str) -> (glam::DVec3, usize) {
    let run = session.course.run.as_ref().unwrap();
    let body = run.body_names.iter().position(|known| known == name).unwrap();
    let nodes = run.world.positions_m(body);
    let element = run.world.tets(body).len() as u32 / 2;
    let corners = run.world.tets(body)[element as usize].map(|node| nodes[node as usize]);
    let point_m = corners.iter().sum::<glam::DVec3>() * 0.25;
    session.execute(Command::Grab { element: (body, element), point_m, to_m: point_m });
    (point_m, body)
}

/// Loads what saving would write.
fn saved(session: &mut Session) -> Session {
    let seen = session.snapshot();
    let look = super::super::look::Look::default();
    let text = super::super::saving::scene_text(
        &seen.scene.unwrap(),
        (&seen.late_text, seen.frame.time_s),
        &look,
        seen.speed,
    )
    .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, &text).unwrap();
    let again = opened(path.to_str().unwrap(), &[]);
    assert!(again.course.run.is_some(), "{:?}\n{text}", again.notice);
    again
}

/// Whether the saved scene goes through everything that was recorded, to the byte.
fn assert_same_when_reloaded(session: &mut Session) {
    let mut again = saved(session);
    let world = &mut again.course.run.as_mut().unwrap().world;
    for moment in session.course.recording.moments() {
        while world.time_s() < moment.time_s {
            world.step(moment.time_s).unwrap();
        }
        for (now, then) in seen(&world.publish()).iter().zip(&seen(&moment.frame)) {
            assert_eq!(now, then, "at {}", moment.time_s);
        }
    }
    // What was done last, when time stood.
    world.catch_up().unwrap();
    assert_eq!(state(&again), state(session));
}

#[test]
fn a_pulled_body_follows_the_mouse_and_a_saved_scene_pulls_it_again() {
    let mut session =
        opened("hammer-ground", &["time.duration=1", "recording.start=0", "recording.slow_motion=4"]);
    play(&mut session, 10);
    let (from_m, body) = grab(&mut session, "hammer");
    let centre = |session: &Session| session.course.run.as_ref().unwrap().world.body_pose(body).1;
    let before = centre(&session);
    for moment in 1..=12 {
        session.execute(Command::Drag(from_m + glam::DVec3::new(0.01, 0.0, 0.015) * f64::from(moment)));
        play(&mut session, 2);
    }
    assert!(centre(&session).z > before.z + 0.05, "{} {before}", centre(&session));
    assert_eq!(session.snapshot().frame.pulls.len(), 1);
    // Saved in the middle of it, it gives what was seen so far.
    assert_same_when_reloaded(&mut session);
    session.execute(Command::LetGo);
    play(&mut session, 20);
    let end = session.snapshot();
    assert!(end.frame.pulls.is_empty() && end.notice.is_none(), "{:?}", end.notice);
    assert!(end.undo.unwrap().contains("hammer"));
    assert_same_when_reloaded(&mut session);
    // Back into the middle of the pull: the same moment, and nobody pulls on from there.
    let moments = end.recording.moments();
    session.execute(Command::PlayOnFrom { time_s: moments[24].time_s, play: true });
    assert_eq!(seen(&session.snapshot().frame), seen(&moments[24].frame));
    assert!(session.snapshot().frame.pulls.is_empty());
    play(&mut session, 5);
    assert_same_when_reloaded(&mut session);
    // Taken back, it can be made again as it was at first as well.
    let until_s = |session: &Session| session.course.edits.iter().last().unwrap().pull().unwrap().until_s;
    let cut_s = until_s(&session);
    session.execute(Command::Undo);
    session.execute(Command::RedoOther);
    assert!(until_s(&session) > cut_s);
    assert_eq!(session.course.edits.len(), 1);
}

#[test]
fn a_pull_is_taken_back_and_done_again_as_a_whole() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 5);
    let (before, time_s) = (state(&session), session.time_s());
    let name = session.snapshot().body_names.last().unwrap().clone();
    let (from_m, _) = grab(&mut session, &name);
    // Without time it never was.
    session.execute(Command::LetGo);
    assert!(session.snapshot().undo.is_none() && session.course.edits.len() == 0);
    grab(&mut session, &name);
    session.execute(Command::Drag(from_m + glam::DVec3::X * 0.1));
    play(&mut session, 20);
    session.execute(Command::LetGo);
    play(&mut session, 5);
    let (after, end_s) = (state(&session), session.time_s());
    session.execute(Command::Undo);
    assert_eq!((state(&session), session.time_s()), (before, time_s));
    assert!(session.snapshot().redo.unwrap().contains(&name));
    session.execute(Command::Redo);
    let world = &mut session.course.run.as_mut().unwrap().world;
    while world.time_s() < end_s {
        world.step(end_s).unwrap();
    }
    assert_eq!(state(&session), after);
}

#[test]
fn redo_throws_again_where_it_was_thrown() {
    let mut session = opened("bounce", &[]);
    play(&mut session, 10);
    let first_s = session.time_s();
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    play(&mut session, 5);
    session.execute(Command::Throw(dropped(ThrowKind::Cube)));
    let (thrown, second_s) = (state(&session), session.time_s());
    session.execute(Command::Undo);
    session.execute(Command::Undo);
    assert_eq!(session.time_s(), first_s);
    // Time may run on meanwhile.
    play(&mut session, 9);
    session.execute(Command::Redo);
    assert_eq!(session.time_s(), first_s);
    session.execute(Command::Redo);
    arrive(&mut session);
    assert_eq!((state(&session), session.time_s()), (thrown, second_s));
    assert!(session.snapshot().redo.is_none());
    session.execute(Command::Undo);
    session.execute(Command::Throw(dropped(ThrowKind::Hammer)));
    assert!(session.snapshot().redo.is_none(), "another throw takes its place");
}

#[test]
fn contact_changed_on_the_way_is_saved_with_its_times() {
    let mut session =
        opened("incline", &["contact.pairs=[{ bodies = [\"ramp\", \"block\"], friction = 0.5 }]"]);
    let slide = |session: &mut Session, friction: f64| {
        let mut contact = session.snapshot().contact.unwrap();
        contact.friction_coefficient = friction;
        contact.rest_speed_m_s = Some(friction * 0.01);
        contact.pair_friction.iter_mut().for_each(|pair| pair.friction_coefficient = 0.5 * friction);
        session.execute(Command::SetContact(contact));
    };
    play(&mut session, 10);
    for friction in [0.2, 0.3, 0.05] {
        slide(&mut session, friction);
    }
    play(&mut session, 10);
    slide(&mut session, 0.9);
    let mut contact = session.snapshot().contact.unwrap();
    contact.rest_speed_m_s = None;
    contact.self_collision = false;
    session.execute(Command::SetContact(contact));
    play(&mut session, 10);
    let mut springs = session.snapshot().contact.unwrap();
    springs.method = crate::sim::ContactMethod::Penalty { stiffness_n_m: 1e6 };
    session.execute(Command::SetContact(springs));
    play(&mut session, 5);
    assert!(session.snapshot().notice.is_none(), "{:?}", session.snapshot().notice);
    let text = session.snapshot().late_text.clone();
    assert_eq!(text.matches("[[contact_changes]]").count(), 3, "{text}");
    let mut again = saved(&mut session);
    play(&mut again, 35);
    assert_eq!(again.snapshot().contact, session.snapshot().contact);
    assert_same_when_reloaded(&mut session);
}

/// A scene into which a body comes late that slides without friction on the ground.
fn late_slider() -> (tempfile::TempDir, String) {
    let scene = Scene::load("bounce", &[]).unwrap();
    let material = scene.description.materials[0].name.clone();
    let body = |name: &str, x: f64| {
        format!(
            "[[bodies]]\nname = \"{name}\"\nshape = {{ type = \"box\", size = [0.1, 0.1, 0.1], cells = [1, 1, 1] }}\n\
             material = \"{material}\"\nposition = [{x}, 1.0, 0.06]\nvelocity = [1, 0, 0]\nenters = 0.02\n"
        )
    };
    let text = format!(
        "{}\n{}\n{}\n[[contact.pairs]]\nbodies = [\"late\", \"ground\"]\nfriction = 0.0\n",
        scene.to_toml(),
        body("late", -0.3),
        body("later", 0.3),
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("late.toml");
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap().to_owned();
    (folder, path)
}

#[test]
fn friction_of_a_late_body_stays_with_it_when_something_is_thrown_before() {
    let (_folder, path) = late_slider();
    let mut session = opened(&path, &[]);
    session.execute(Command::SetSpeed(1.0));
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    play(&mut session, 4);
    let seen = session.snapshot();
    let number = |name: &str| seen.body_names.iter().position(|known| known == name).unwrap();
    let thrown = seen.body_names.iter().find(|name| name.starts_with("thrown")).unwrap();
    assert!(number(thrown) < number("late"), "{:?}", seen.body_names);
    let pairs = seen.contact.unwrap().pair_friction;
    let friction = |name: &str| {
        let own = pairs.iter().find(|pair| pair.bodies == [GROUND_BODY, number(name)]);
        own.map(|pair| pair.friction_coefficient)
    };
    assert_eq!(friction("late"), Some(0.0));
    assert_ne!(friction(thrown), Some(0.0));
    assert_ne!(friction("later"), Some(0.0));
    // Who came in by plan can be taken out like others.
    session.execute(Command::Remove(number("later")));
    assert!(session.snapshot().undo.unwrap().contains("later"));
    assert_same_when_reloaded(&mut session);
}

#[test]
fn a_reset_drops_what_was_done_or_does_it_again() {
    let mut session = opened("brick-pile", &["time.duration=1", "recording.slow_motion=100"]);
    let bodies = session.snapshot().frame.bodies.len();
    play(&mut session, 10);
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    let (from_m, _) = grab(&mut session, "top");
    session.execute(Command::Drag(from_m + glam::DVec3::Z * 0.1));
    play(&mut session, 10);
    session.execute(Command::LetGo);
    let contact = ContactParameters { friction_coefficient: 0.9, ..session.snapshot().contact.unwrap() };
    session.execute(Command::SetContact(contact));
    play(&mut session, 10);
    let (end, end_s) = (state(&session), session.time_s());
    for _ in 0..2 {
        session.execute(Command::Reset { overrides: Vec::new(), keep: true });
        assert_eq!(session.snapshot().frame.bodies.len(), bodies, "{:?}", session.notice);
        let world = &mut session.course.run.as_mut().unwrap().world;
        while world.time_s() < end_s {
            world.step(end_s).unwrap();
        }
        assert_eq!(state(&session), end);
    }
    // With other values on the sliders the same is thrown.
    let stiffer = vec!["materials.brick.density=2500".to_owned()];
    session.execute(Command::Reset { overrides: stiffer, keep: true });
    play(&mut session, 15);
    assert_eq!(session.snapshot().frame.bodies.len(), bodies + 1);
    session.execute(Command::Throw(dropped(ThrowKind::Ball)));
    assert!(session.snapshot().notice.is_some_and(|notice| notice.is_passing), "{:?}", session.notice);
    session.execute(Command::Reset { overrides: Vec::new(), keep: false });
    play(&mut session, 30);
    let plain = session.snapshot();
    assert!(plain.frame.bodies.len() == bodies && plain.scene.unwrap().setup.changes.is_empty());
    assert!(plain.contact.unwrap().friction_coefficient == 0.9, "contact acts on");
}

mod branches;
mod resets;
