//! Pictures of small hand-made frames, compared with stored ones; and the files they go into.
//!
//! Every picture also has an assertion that needs no reference. References are drawn on a
//! software rasterizer; after a wanted change, write them anew and look at each one:
//!
//! ```sh
//! HAMMERFALL_WRITE_PICTURES=1 cargo test --test pictures
//! ```
//!
//! Without any graphics driver the tests say so and pass, except where the variable `CI` is
//! set: there a missing driver is a failure.

#[path = "pictures/compare.rs"]
mod compare;
#[path = "pictures/files.rs"]
mod files;
#[path = "pictures/inside.rs"]
mod inside;
#[path = "pictures/scenes.rs"]
mod scenes;
#[path = "pictures/shapes.rs"]
mod shapes;
#[path = "pictures/targets.rs"]
mod targets;
