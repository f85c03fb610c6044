//! Saving one thing while another is being saved.

use super::*;

#[test]
fn while_an_animation_is_saved_everything_else_can_be() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    open(&mut window, "bounce");
    wait(&mut window, "time", |app| app.snapshot.recording.moments().len() > 5);
    press(&mut window, "Pause (space)");
    window.state_mut().save.folder = folder.path().to_str().unwrap().to_owned();
    // So slow that nobody waits for all of its pictures.
    window.state_mut().press_for_test(crate::viewer::snapshot::Command::SetSpeed(1e-5));
    settle(&mut window);
    press(&mut window, "GIF");
    assert!(window.state().saver.animation().is_some());
    for (button, ending) in [("Picture", "png"), ("Scene", "toml"), ("OBJ", "obj"), ("PLY", "ply")] {
        press(&mut window, button);
        let name = format!("bounce.{ending}");
        wait(&mut window, &name, |app| app.save.lines().any(|(text, _)| text.ends_with(&name)));
        assert!(folder.path().join(&name).exists() && window.state().saver.animation().is_some());
    }
    // Nothing over the picture, nothing that waits to be closed.
    assert_eq!(window.state().notice(), None);
    press(&mut window, "Cancel");
    wait(&mut window, "the end", |app| !app.saver.is_busy());
    press(&mut window, "GIF");
    press(&mut window, "Cancel");
    wait(&mut window, "the end", |app| !app.saver.is_busy());
}

#[test]
fn fragments_are_saved_whole_and_in_their_place_however_they_are_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    open(&mut window, "brick-pile");
    press(&mut window, "Pause (space)");
    window.state_mut().save.folder = folder.path().to_str().unwrap().to_owned();
    let saved = |window: &mut Window, button: &str, name: &str| {
        press(window, button);
        wait(window, name, |app| !app.saver.is_busy());
        std::fs::read(folder.path().join(name)).unwrap()
    };
    let plain = saved(&mut window, "OBJ", "brick-pile.obj");
    press(&mut window, "Cut the bodies open");
    window.state_mut().look.explode = 1.0;
    settle(&mut window);
    assert!(!std::sync::Arc::ptr_eq(window.state().drawn(), window.state().shown()));
    assert!(saved(&mut window, "OBJ", "brick-pile-2.obj") == plain);
}
