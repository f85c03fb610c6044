//! From a [`crate::frame::Frame`] to pixels, in a window or without one.
//!
//! ```text
//!   Frame ─▶ GeometryBuilder ─┬▶ shadow map, heights ─▶ floor light ─┐
//!                             └▶ bodies (4 samples per pixel) ───────┼▶ compose with floor and
//!   Camera, View ─▶ FrameUniforms (read by all passes)               │  background ─▶ legend,
//!                                                                    ┘  caption ─▶ target
//! ```
//!
//! [`Renderer`] draws into a rectangle of any texture; [`OffScreen`] owns one and reads it back.
//! Lighting is computed in linear colour; the finished bytes are sRGB, the same in both cases.
//!
//! [`look_inside`] makes a frame with its bodies cut open and with stress crosses of one that has an interior.
//!
//! [`paint`] draws diagrams, flat and without a GPU.
//!
//! [`Renderer::render_again`] is for windows: it keeps what hangs on the frame alone while only the camera moves, and
//! draws less finely if so told ([`Quality`]); [`Renderer::prepare`] builds the triangles of a frame to come meanwhile.
//!
//! The GPU half of `x_pass.rs` is `shaders/x_pass.wgsl`.
//!
//! ```no_run
//! use hammerfall::frame::Frame;
//! use hammerfall::render::{Framing, Ground, Gpu, NamedView, OffScreen, View};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let frames: Vec<Frame> = Vec::new();
//! let size_px = [960, 540];
//! let mut framing = Framing::default();
//! frames.iter().for_each(|frame| framing.include(frame));
//! let camera = framing.camera(NamedView::ThreeQuarter, 960.0 / 540.0);
//! let view = View {
//!     ground: framing.floor().map_or(Ground::Hidden, Ground::At),
//!     ..View::for_size(size_px)
//! };
//! let mut screen = OffScreen::new(&Gpu::headless()?)?;
//! for frame in &frames {
//!     let picture = screen.render(size_px, frame, &camera, &view)?;
//! }
//! # Ok(())
//! # }
//! ```

mod bindings;
mod camera;
mod canvas;
mod color_map;
mod compose_pass;
mod crosses;
mod depth_pass;
mod enlarge_pass;
mod fits;
mod floor_blur_pass;
mod floor_light_pass;
mod frame_uniforms;
mod framing;
mod geometry;
mod gpu;
mod light;
mod light_maps;
mod off_screen;
mod overlay;
mod prepared;
mod quality;
mod range;
mod renderer;
mod section;
mod surface_pass;
mod target;
mod theme;
mod triangles;
mod units;
mod view;

pub use camera::{Camera, NamedView, Ray, UnknownView};
pub use canvas::paint;
pub use color_map::{ColorMap, body_srgb};
pub use crosses::{cross_room_m, cross_scale_pa, has_visible_lines, look_inside};
pub use framing::{Floor, Framing};
pub use gpu::{ADAPTER_VARIABLE, AdapterChoice, Gpu, GpuError, new_instance};
pub use off_screen::{OffScreen, Picture};
pub use quality::Quality;
pub use range::Range;
pub use renderer::Renderer;
pub use section::Cut;
pub use target::Target;
pub use units::{parse_with_unit, short, si_prefix, what_to_type, with_unit};
pub use view::{Background, Caption, Ground, View};

#[cfg(test)]
mod tests {
    use super::*;

    /// Every shader, as the device gets it.
    fn shaders() -> [(&'static str, String); 6] {
        let (with_prelude, with_full_screen) = (frame_uniforms::with_prelude, bindings::with_full_screen);
        [
            ("depth_pass", depth_pass::WGSL.to_owned()),
            ("enlarge_pass", with_full_screen(enlarge_pass::WGSL)),
            ("floor_blur_pass", with_full_screen(floor_blur_pass::WGSL)),
            ("floor_light_pass", with_prelude(&with_full_screen(floor_light_pass::WGSL))),
            ("surface_pass", with_prelude(surface_pass::WGSL)),
            ("compose_pass", with_prelude(&with_full_screen(compose_pass::WGSL))),
        ]
    }

    #[test]
    fn every_shader_is_valid_wgsl() {
        use naga::valid::{Capabilities, ValidationFlags, Validator};
        for (name, wgsl) in shaders() {
            let module = naga::front::wgsl::parse_str(&wgsl)
                .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&wgsl)));
            Validator::new(ValidationFlags::all(), Capabilities::empty())
                .validate(&module)
                .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&wgsl)));
        }
    }

    #[test]
    fn no_shader_file_is_forgotten() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders");
        let files = std::fs::read_dir(folder).expect("shaders/ is there");
        let checked = shaders().map(|(name, _)| name);
        for file in files {
            let path = file.expect("shaders/ can be read").path();
            let name = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
            // Those that stand in front of others are validated with them.
            let known = checked.contains(&name) || ["frame_uniforms", "full_screen"].contains(&name);
            assert!(known, "{name}.wgsl is not validated");
        }
    }
}
