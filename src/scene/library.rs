//! The scenes inside the program.

/// A scene inside the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltinScene {
    /// Name on the command line.
    pub name: &'static str,
    /// One line on what it shows.
    pub summary: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! scenes {
    ($($name:literal: $summary:literal,)*) => {
        &[$(BuiltinScene {
            name: $name,
            summary: $summary,
            text: include_str!(concat!("../../assets/scenes/", $name, ".toml")),
        }),*]
    };
}

/// All scenes inside the program.
pub const BUILTIN_SCENES: &[BuiltinScene] = scenes! {
    "hammer-ground": "an elastic hammer falls obliquely on hard ground and shakes",
    "hammer-ground-fine": "the same, finer",
    "hammer-table": "a hammer drops on a flexible table, and both give way",
    "hammer-table-fine": "the same, finer",
    "hammer-lamp": "a flying hammer knocks over a lamp that stands on a table",
    "hammer-lamp-fine": "the same, finer",
    "cup-wall": "an elastic cup hits a rigid wall obliquely and dents where it hits",
    "cup-wall-fine": "the same, finer",
    "rods-collision": "two steel rods collide head-on: impact against wave theory",
    "rods-collision-fine": "the same, finer",
    "beam-notch": "a notched beam is bent until it breaks at its notch",
    "beam-notch-fine": "the same, finer",
    "pile-press": "a pile is pressed until it slides apart",
    "pile-press-fine": "a pile slides along one band",
    "pile-split": "a pile bursts along its axis under a load on its middle",
    "cube-wall": "a cube breaks on a wall, and its pieces fall to the ground",
    "cube-wall-fine": "the same, finer",
    "plate-tensile": "a cube falls on a plate that breaks by tension",
    "plate-tensile-fine": "the same, finer",
    "plate-mohr-coulomb": "the same, by sliding with friction",
    "plate-mohr-coulomb-fine": "the same, finer",
    "plate-tresca": "the same, by shear",
    "plate-tresca-fine": "the same, finer",
    "plates-compared": "the same plate breaks under five criteria, side by side",
    "pane-shot": "a ball goes through a pane of 20,000 elements",
    "glass-shot": "a ball is shot through a plate of glass",
    "mug-drop": "a mug falls on the floor and breaks",
    "brick-pile": "a hammer smashes a pile of bricks",
    "bar-torn": "a notched bar is torn apart",
    "incline": "a block on a slope sticks or slides, by the angle of friction",
    "bounce": "a rubber ball bounces on the ground",
    "stack": "ten cubes stand on each other and stay",
    "rain": "a dozen bodies of all kinds fall on each other",
};

/// The scene with this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static BuiltinScene> {
    BUILTIN_SCENES.iter().find(|scene| scene.name == name)
}
