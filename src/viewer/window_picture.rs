//! The window as a picture, without a screen: the same panels over the same scene, and no clock.

use super::app::App;
use super::pacing::FRAME_S;
use super::session::Session;
use super::simulation::Simulation;
use super::snapshot::Command;
use super::thumbnails::Sketcher;
use super::ui::style;
use crate::render::{Gpu, GpuError, OffScreen, Picture};
use egui::{ColorImage, Context, FullOutput, RawInput, Rect, TextureOptions, pos2};
use egui_wgpu::{RendererOptions, ScreenDescriptor};

/// Layouts after which everything has found its place.
const LAYOUTS: u32 = 4;

/// Plays a scene up to a time, s, at least, and draws the window of that size then.
///
/// # Errors
/// Why the scene does not open or run, or nothing can be drawn.
pub fn window_picture(
    scene: &str,
    overrides: &[String],
    at_s: f64,
    size_px: [u32; 2],
) -> Result<Picture, String> {
    let mut session = Session::default();
    let (scene, overrides) = (scene.to_owned(), overrides.to_vec());
    session.execute(Command::Open { scene, overrides, play: true });
    play_to(&mut session, at_s)?;
    let mut app = App::new(Simulation::still(session.snapshot()), Sketcher::idle());
    app.is_gallery = false;
    draw(&mut app, size_px).map_err(|error| error.to_string())
}

/// As on a machine that is always in time.
fn play_to(session: &mut Session, at_s: f64) -> Result<(), String> {
    let mut wall_s = 0.0;
    loop {
        let snapshot = session.snapshot();
        if let Some(error) = snapshot.run_error {
            return Err(error);
        }
        if snapshot.scene.is_none() {
            return Err(snapshot.notice.map_or_else(String::new, |notice| notice.text));
        }
        if snapshot.frame.time_s >= at_s {
            session.execute(Command::Pause);
            return Ok(());
        }
        // Beyond the scene's end it pauses by itself.
        if !session.is_playing() {
            session.execute(Command::Play);
        }
        session.advance(wall_s, || false);
        wall_s += FRAME_S;
    }
}

fn draw(app: &mut App, size_px: [u32; 2]) -> Result<Picture, GpuError> {
    let gpu = Gpu::headless()?;
    let mut screen = OffScreen::new(&gpu)?;
    let context = Context::default();
    style::install(&context);
    let mut deltas = Vec::new();
    let mut layout = |app: &mut App| {
        let mut output = context.run_ui(input(size_px), |ui| app.update(ui));
        deltas.push(std::mem::take(&mut output.textures_delta));
        output
    };
    (0..LAYOUTS).for_each(|_| drop(layout(app)));
    let request = app.picture_request(1.0);
    let scene = match &request {
        Some(wanted) => Some(screen.render(wanted.size_px, wanted.frame, &wanted.camera, &wanted.view)?),
        None => None,
    };
    let texture = scene.map(|scene| {
        let size = [scene.width as usize, scene.height as usize];
        let image = ColorImage::from_rgba_unmultiplied(size, &scene.rgba);
        context.load_texture("scene", image, TextureOptions::LINEAR)
    });
    app.picture = texture.as_ref().map(egui::TextureHandle::id);
    let output = layout(app);
    let background = context.global_style().visuals.panel_fill;
    screen.draw_by(size_px, |view, format| {
        let mut painter = egui_wgpu::Renderer::new(&gpu.device, format, RendererOptions::PREDICTABLE);
        for (id, images) in deltas.iter_mut().flat_map(|delta| delta.set.drain().collect::<Vec<_>>()) {
            for image in images {
                painter.update_texture(&gpu.device, &gpu.queue, id, &image);
            }
        }
        paint(&gpu, &mut painter, (view, size_px), (&context, output, background));
    })
}

fn input([width, height]: [u32; 2]) -> RawInput {
    RawInput {
        screen_rect: Some(Rect::from_min_max(pos2(0.0, 0.0), pos2(width as f32, height as f32))),
        // Nothing here may depend on the clock.
        time: Some(0.0),
        ..RawInput::default()
    }
}

fn paint(
    gpu: &Gpu,
    painter: &mut egui_wgpu::Renderer,
    (view, size_in_pixels): (&wgpu::TextureView, [u32; 2]),
    (context, output, background): (&Context, FullOutput, egui::Color32),
) {
    let jobs = context.tessellate(output.shapes, 1.0);
    let screen = ScreenDescriptor { size_in_pixels, pixels_per_point: 1.0 };
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    // Only paint callbacks return command buffers, and there are none here.
    painter.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &jobs, &screen);
    let clear = wgpu::LoadOp::Clear(super::graphics::clear_color(background));
    let mut pass = super::graphics::begin_pass(&mut encoder, view, clear).forget_lifetime();
    painter.render(&mut pass, &jobs, &screen);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
}
