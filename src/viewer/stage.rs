//! What the window draws with, whatever it draws on: the scene's picture, and the panels painted over it.

use super::app::App;
use super::background;
use super::damage::{Layout, around};
use super::steering::Steering;
use super::thumbnails;
use crate::frame::Frame;
use crate::render::{Camera, Gpu, GpuError, Quality, Renderer, Target, View};
use egui::{ClippedPrimitive, Rect, pos2, vec2};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use std::sync::Arc;
use std::time::Duration;

/// A picture that egui can paint, and what it shows.
struct Picture {
    view: wgpu::TextureView,
    id: egui::TextureId,
    size_px: [u32; 2],
    shows: Option<Sight>,
    quality: Quality,
}

type Sight = (Arc<Frame>, Camera, View);

/// Triangles from which on those of a new moment are built by another thread: fewer are built sooner than handed over.
const MANY_TRIANGLES: usize = 10_000;
/// How long to wait before asking again whether they are there.
const POLL: Duration = Duration::from_millis(4);

/// What was drawn of the scene in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drawn {
    Nothing,
    /// Something moved; says whether it is a new moment.
    InMotion(bool),
    /// What stands still, finely.
    AtRest,
}

/// What the layout of one frame came to.
pub struct Output<'a> {
    /// The context of the layout.
    pub context: &'a egui::Context,
    /// Shapes and textures.
    pub full: egui::FullOutput,
}

/// egui minds textures that nobody has taken in. Where drawing fails, the next device gets all of them anew.
impl Drop for Output<'_> {
    fn drop(&mut self) {
        self.full.textures_delta.clear();
    }
}

/// Pictures and panels on one device.
pub struct Stage {
    /// The device.
    pub gpu: Gpu,
    format: wgpu::TextureFormat,
    /// Whether pictures are copied to the target. Copying is many times faster than painting on a software driver.
    can_copy: bool,
    painter: egui_wgpu::Renderer,
    renderer: Renderer,
    picture: Option<Picture>,
    /// The moment whose triangles are being built; the one before is seen until then.
    coming: Option<Sight>,
    /// Who builds them; nobody where the system refuses the threads.
    workers: Option<rayon::ThreadPool>,
    thumbnails: Vec<(usize, Picture)>,
    /// Why a picture could not be drawn, as it was told last.
    told: Option<GpuError>,
    /// How finely moving pictures are drawn; without it, as finely as still ones.
    pub steering: Option<Steering>,
    drawn: Drawn,
    /// Number of the scene that was drawn last.
    opened: u64,
    /// All that is on the window, where it can be copied to it, so that only what changes is painted.
    canvas: Option<wgpu::Texture>,
    painted: Option<Layout>,
    has_new_picture: bool,
}

impl Stage {
    /// Makes ready to draw on targets of a format, to which pictures can be copied or not.
    ///
    /// # Errors
    /// What the device reported while the pipelines were built.
    pub fn new(gpu: Gpu, format: wgpu::TextureFormat, can_copy: bool) -> Result<Self, GpuError> {
        // Dithering costs a software driver more than it shows.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let stage = Self {
            painter: egui_wgpu::Renderer::new(&gpu.device, format, options),
            renderer: Renderer::new(&gpu, format),
            gpu,
            format,
            can_copy,
            picture: None,
            coming: None,
            workers: background::workers("triangles").ok(),
            thumbnails: Vec::new(),
            told: None,
            steering: None,
            drawn: Drawn::Nothing,
            opened: 0,
            canvas: None,
            painted: None,
            has_new_picture: false,
        };
        stage.gpu.check()?;
        Ok(stage)
    }

    /// Longest side of a texture, pixels.
    #[must_use]
    pub fn max_side_px(&self) -> u32 {
        self.gpu.device.limits().max_texture_dimension_2d
    }

    /// Draws what `app` asks for into its pictures; call after the layout and before [`Self::paint`]. `now` is a time
    /// since any moment. Returns in how long there may be more to draw.
    ///
    /// # Errors
    /// [`GpuError`] of the device; that a picture is too large for it is said in the window.
    pub fn draw_pictures(
        &mut self,
        app: &mut App,
        pixels_per_point: f32,
        now: Duration,
    ) -> Result<Option<Duration>, GpuError> {
        self.drawn = Drawn::Nothing;
        let more = self.draw_scene(app, pixels_per_point, now);
        if let Err(error) = &more {
            if !matches!(error, GpuError::BadSize { .. } | GpuError::TooManyTriangles { .. }) {
                return Err(error.clone());
            }
            // The device is sound and the panels work: no reason to open it anew.
            if self.told.as_ref() != Some(error) {
                app.tell(error.to_string());
                self.told = Some(error.clone());
            }
        }
        let more = more.unwrap_or_default();
        Ok(if self.draw_thumbnail(app)? { Some(Duration::ZERO) } else { more })
    }

    /// A frame ended now and took so long, from its events to its last pixel; `None` for one that nobody saw. Returns
    /// whether the next layout has to tell of another detail.
    pub fn took(&mut self, app: &mut App, time: Option<Duration>, now: Duration) -> bool {
        if let (Drawn::InMotion(is_new), Some(steering)) = (self.drawn, &mut self.steering) {
            // The picture stands still from here on: a slow one began long ago.
            steering.moved(now);
            time.into_iter().for_each(|time| steering.took(time, now, is_new));
        }
        let detail = self.steering.as_ref().filter(|_| !app.look.is_always_fine).and_then(Steering::name);
        std::mem::replace(&mut app.detail, detail) != detail
    }

    /// Draws the scene if it looks different from what its picture shows, or can be drawn more finely by now; returns
    /// in how long there is more to draw.
    fn draw_scene(
        &mut self,
        app: &mut App,
        pixels_per_point: f32,
        now: Duration,
    ) -> Result<Option<Duration>, GpuError> {
        let size_limit = self.max_side_px();
        let Some(request) = app.picture_request(pixels_per_point) else { return Ok(None) };
        let size_px = drawn_size_px(request.size_px, size_limit);
        let mut picture = self.fitting_picture(size_px);
        let wanted = (request.frame.clone(), request.camera, request.view);
        let is_other = picture.shows.is_none() || self.opened != app.snapshot.opened;
        self.steering.iter_mut().filter(|_| is_other).for_each(Steering::begin_anew);
        self.opened = app.snapshot.opened;
        let is_steered = self.steering.is_some() && !app.look.is_always_fine;
        let (wanted, wait) = if is_steered {
            self.moment_to_show(picture.shows.as_ref(), wanted, now)
        } else {
            (wanted, None)
        };
        let steering = self.steering.as_mut().filter(|_| is_steered);
        let is_playing = app.snapshot.is_playing || app.player.is_playing();
        let plan = plan(&picture, (wanted, wait), steering, (now, is_playing));
        // The panels paint it only where it cannot be copied.
        app.picture = (!self.can_copy).then_some(picture.id);
        let mut done = Ok(plan.more);
        if let Some((sight, quality)) = plan.draw {
            let target = Target::whole(&picture.view);
            let seen_from = (&sight.1, &sight.2);
            // Where motion has to be drawn as a draft, the fine picture takes a while: it comes in pieces.
            let is_drawn = if is_steered && plan.drawn == Drawn::AtRest {
                self.renderer.refine(target, &sight.0, seen_from)
            } else {
                self.renderer.render_again(target, &sight.0, seen_from, quality).map(|()| true)
            };
            if is_drawn == Ok(false) {
                done = Ok(Some(Duration::ZERO));
            } else {
                picture.shows = is_drawn.is_ok().then_some(sight);
                picture.quality = quality;
                self.drawn = plan.drawn;
                self.has_new_picture = true;
                done = is_drawn.map(|_| plan.more);
            }
        }
        self.picture = Some(picture);
        done
    }

    /// What of the scene is to be seen now, in place of what is wanted: large scenes show each moment a while, and until the
    /// triangles of the next one are there. The camera turns meanwhile. Tells also how long to wait before asking again.
    fn moment_to_show(
        &mut self,
        shown: Option<&Sight>,
        wanted: Sight,
        now: Duration,
    ) -> (Sight, Option<Duration>) {
        let coming = self.coming.take();
        let is_new = |shown: &&Sight| !Arc::ptr_eq(&shown.0, &wanted.0) && has_same_look(shown, &wanted);
        let (Some(shown), Some(steering), Some(workers)) =
            (shown.filter(is_new), &self.steering, &self.workers)
        else {
            return (wanted, None);
        };
        let held = (shown.0.clone(), wanted.1, shown.2.clone());
        let coming = match coming.filter(|coming| has_same_look(coming, &wanted)) {
            Some(coming) => coming,
            None => {
                if let Some(wait) = steering.until_moment(now) {
                    return (held, Some(wait));
                }
                if triangles_of(&wanted.0) < MANY_TRIANGLES {
                    return (wanted, None);
                }
                wanted.clone()
            }
        };
        if self.renderer.prepare(&coming.0, &coming.2, (steering.in_motion(), workers)) {
            return ((coming.0, wanted.1, coming.2), None);
        }
        self.coming = Some(coming);
        (held, Some(POLL))
    }

    /// One thumbnail at a time, so that the gallery stays quick; returns whether there was one.
    fn draw_thumbnail(&mut self, app: &mut App) -> Result<bool, GpuError> {
        let is_dark = app.look.is_dark;
        let Some(sketch) = app.next_sketch() else { return Ok(false) };
        let scene = sketch.scene;
        let known = self.thumbnails.iter().position(|(index, _)| *index == scene);
        let at = known.unwrap_or_else(|| {
            let picture = self.new_picture(thumbnails::SIZE_PX);
            self.thumbnails.push((scene, picture));
            self.thumbnails.len() - 1
        });
        let picture = &self.thumbnails[at].1;
        let target = Target::whole(&picture.view);
        let drawn = self.renderer.render(target, &sketch.frame, &sketch.camera, &sketch.view(is_dark));
        // Shapes do not tell that another picture is in them.
        self.painted = None;
        app.thumbnails[scene] = Some(picture.id);
        drawn.map(|()| true)
    }

    /// The picture of this size: the old one, or one that takes its place.
    fn fitting_picture(&mut self, size_px: [u32; 2]) -> Picture {
        match self.picture.take() {
            Some(picture) if picture.size_px == size_px => picture,
            Some(old) => {
                let view = new_texture(&self.gpu, size_px, self.format);
                let filter = wgpu::FilterMode::Linear;
                let device = &self.gpu.device;
                self.painter.update_egui_texture_from_wgpu_texture(device, &view, filter, old.id);
                Picture { view, id: old.id, size_px, shows: None, quality: Quality::FULL }
            }
            None => self.new_picture(size_px),
        }
    }

    fn new_picture(&mut self, size_px: [u32; 2]) -> Picture {
        let view = new_texture(&self.gpu, size_px, self.format);
        let filter = wgpu::FilterMode::Linear;
        let id = self.painter.register_native_texture(&self.gpu.device, &view, filter);
        Picture { view, id, size_px, shows: None, quality: Quality::FULL }
    }

    /// The moment that the picture of the scene shows.
    #[cfg(test)]
    pub fn drawn_frame(&self) -> Option<Arc<Frame>> {
        self.picture.as_ref().and_then(|picture| picture.shows.as_ref()).map(|shown| shown.0.clone())
    }

    /// Has all of it painted in the next frame, and not only what changes.
    #[cfg(test)]
    pub fn forget_what_is_painted(&mut self) {
        self.painted = None;
    }

    /// Paints panels and pictures onto a target; without one, only takes in what changed in the textures.
    pub fn paint(&mut self, app: &App, output: &mut Output<'_>, target: Option<&wgpu::Texture>) {
        let Output { context, full } = output;
        let (delta, pixels_per_point) = (&mut full.textures_delta, full.pixels_per_point);
        for (id, images) in delta.set.drain() {
            for image in images {
                // A part that is added changes nothing that was painted before.
                self.painted = self.painted.take().filter(|_| image.pos.is_some());
                self.painter.update_texture(&self.gpu.device, &self.gpu.queue, id, &image);
            }
        }
        if let Some(target) = target {
            let layout = Layout {
                shapes: std::mem::take(&mut full.shapes),
                background: context.global_style().visuals.panel_fill,
                picture: self.picture_place(app, pixels_per_point),
                size_px: [target.width(), target.height()],
                pixels_per_point,
            };
            if self.can_copy {
                self.paint_changes(context, layout, target);
            } else {
                self.paint_parts(context, &layout, target, &[layout.whole()]);
            }
        }
        for id in delta.free.drain() {
            self.painter.free_texture(&id);
        }
    }

    /// Where the picture is copied to, pixels.
    fn picture_place(&self, app: &App, pixels_per_point: f32) -> Option<Rect> {
        let corner_px = app.picture_corner_px(pixels_per_point).filter(|_| self.can_copy)?;
        let size_px = self.picture.as_ref()?.size_px;
        let [x, y] = corner_px.map(|at| at as f32);
        let [width, height] = size_px.map(|side| side as f32);
        Some(Rect::from_min_size(pos2(x, y), vec2(width, height)))
    }

    /// Paints what looks different from the last time, and brings all of it to the target.
    fn paint_changes(&mut self, context: &egui::Context, layout: Layout, target: &wgpu::Texture) {
        let canvas = match self.canvas.take() {
            Some(canvas) if [canvas.width(), canvas.height()] == layout.size_px => canvas,
            _ => {
                self.painted = None;
                new_texture(&self.gpu, layout.size_px, self.format).texture().clone()
            }
        };
        let before = self.painted.take();
        let parts = before.map_or_else(
            || vec![layout.whole()],
            |before| layout.changes_since(&before, self.has_new_picture),
        );
        self.paint_parts(context, &layout, &canvas, &parts);
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_texture(canvas.as_image_copy(), target.as_image_copy(), canvas.size());
        self.gpu.queue.submit([encoder.finish()]);
        self.has_new_picture = false;
        self.canvas = Some(canvas);
        self.painted = Some(layout);
    }

    /// Paints parts of the window, in pixels, from the background up.
    fn paint_parts(
        &mut self,
        context: &egui::Context,
        layout: &Layout,
        target: &wgpu::Texture,
        parts: &[Rect],
    ) {
        if parts.is_empty() {
            return;
        }
        let Gpu { device, queue, .. } = &self.gpu;
        let pixels_per_point = layout.pixels_per_point;
        let screen = ScreenDescriptor { size_in_pixels: layout.size_px, pixels_per_point };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut jobs = Vec::new();
        for part in parts {
            jobs.extend(background(layout, *part));
            jobs.extend(clipped(context, layout, *part));
            if let (Some(picture), Some(place)) = (&self.picture, layout.picture) {
                copy(&mut encoder, (picture, place), target, *part);
            }
        }
        // Only paint callbacks return command buffers, and there are none here.
        self.painter.update_buffers(device, queue, &mut encoder, &jobs, &screen);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = begin_pass(&mut encoder, &view).forget_lifetime();
        self.painter.render(&mut pass, &jobs, &screen);
        drop(pass);
        queue.submit([encoder.finish()]);
    }
}

/// What to draw of the scene in this frame.
struct Plan {
    draw: Option<(Sight, Quality)>,
    drawn: Drawn,
    /// In how long there is more to draw.
    more: Option<Duration>,
}

/// What to draw of a sight that is to be seen now, while a new moment has to `wait`.
fn plan(
    picture: &Picture,
    (wanted, wait): (Sight, Option<Duration>),
    steering: Option<&mut Steering>,
    (now, is_playing): (Duration, bool),
) -> Plan {
    let Some(steering) = steering else {
        let is_shown = picture.quality == Quality::FULL
            && picture.shows.as_ref().is_some_and(|shown| is_same(shown, &wanted));
        let draw = (!is_shown).then_some((wanted, Quality::FULL));
        return Plan { draw, drawn: Drawn::AtRest, more: None };
    };
    let shown = picture.shows.as_ref();
    if shown.is_some_and(|shown| is_same(shown, &wanted)) && wait.is_none() {
        if picture.quality == Quality::FULL {
            return Plan { draw: None, drawn: Drawn::Nothing, more: None };
        }
        let more = steering.until_rest(now, is_playing);
        let draw = more.is_none().then_some((wanted, Quality::FULL));
        return Plan { draw, drawn: Drawn::AtRest, more };
    }
    steering.moved(now);
    let is_new = shown.is_none_or(|shown| !Arc::ptr_eq(&shown.0, &wanted.0));
    let is_shown = shown.is_some_and(|shown| is_same(shown, &wanted));
    Plan {
        draw: (!is_shown).then(|| (wanted, steering.in_motion())),
        drawn: Drawn::InMotion(is_new),
        more: wait.or_else(|| steering.until_rest(now, is_playing)),
    }
}

fn has_same_look(a: &Sight, b: &Sight) -> bool {
    View { range: a.2.range, ..b.2.clone() } == a.2
}

fn triangles_of(frame: &Frame) -> usize {
    frame.bodies.iter().map(|body| body.surface.triangles.len()).sum()
}

/// The background of a part of the window, but not behind the picture.
fn background(layout: &Layout, part: Rect) -> Vec<ClippedPrimitive> {
    let scale = 1.0 / layout.pixels_per_point;
    let fill = |rect: Rect| {
        let mut mesh = egui::Mesh::default();
        mesh.add_colored_rect(rect * scale, layout.background);
        ClippedPrimitive { clip_rect: rect * scale, primitive: egui::epaint::Primitive::Mesh(mesh) }
    };
    around(part, layout.picture).into_iter().map(fill).collect()
}

/// The shapes in a part of the window, cut off at its border.
fn clipped(context: &egui::Context, layout: &Layout, part: Rect) -> Vec<ClippedPrimitive> {
    let scale = layout.pixels_per_point;
    let mut primitives = context.tessellate(layout.shapes_in(part), scale);
    for primitive in &mut primitives {
        let clip = primitive.clip_rect * scale;
        let clip = Rect::from_min_max(clip.min.round(), clip.max.round()).intersect(part);
        primitive.clip_rect = clip * (1.0 / scale);
    }
    primitives.retain(|primitive| primitive.clip_rect.is_positive());
    primitives
}

fn begin_pass<'e>(encoder: &'e mut wgpu::CommandEncoder, view: &wgpu::TextureView) -> wgpu::RenderPass<'e> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("panels"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops,
        })],
        ..Default::default()
    })
}

/// Copies what of a picture lies in a part of the target.
fn copy(
    encoder: &mut wgpu::CommandEncoder,
    (picture, place): (&Picture, Rect),
    target: &wgpu::Texture,
    part: Rect,
) {
    let seen = place.intersect(part);
    if !seen.is_positive() {
        return;
    }
    let corner = |at: egui::Vec2| wgpu::Origin3d { x: at.x as u32, y: at.y as u32, z: 0 };
    let from = corner(seen.min - place.min);
    let to = corner(seen.min.to_vec2());
    let [from_px, to_px] = [picture.size_px, [target.width(), target.height()]];
    let side = |wanted: f32, from: [u32; 2], to: [u32; 2]| {
        (wanted as u32).min(from[0].saturating_sub(from[1])).min(to[0].saturating_sub(to[1]))
    };
    let width = side(seen.width(), [from_px[0], from.x], [to_px[0], to.x]);
    let height = side(seen.height(), [from_px[1], from.y], [to_px[1], to.y]);
    if width == 0 || height == 0 {
        return;
    }
    encoder.copy_texture_to_texture(
        wgpu::TexelCopyTextureInfo { origin: from, ..picture.view.texture().as_image_copy() },
        wgpu::TexelCopyTextureInfo { origin: to, ..target.as_image_copy() },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}

/// Most pixels that the scene is drawn with, twice those of a 4K screen: what is larger is enlarged. A window without a size is
/// laid out as if it were huge, and four samples of so many pixels fill any memory.
const MOST_PX: f64 = 4096.0 * 4096.0;

/// The size that a picture is drawn at which should have another one, with sides of a limited length.
fn drawn_size_px(size_px: [u32; 2], longest_side_px: u32) -> [u32; 2] {
    let size_px = size_px.map(|side| side.min(longest_side_px));
    let scale = (MOST_PX / size_px.map(f64::from).iter().product::<f64>()).sqrt();
    if scale < 1.0 { size_px.map(|side| (f64::from(side) * scale).max(1.0) as u32) } else { size_px }
}

fn new_texture(gpu: &Gpu, [width, height]: [u32; 2], format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture in the window"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn is_same(a: &(Arc<Frame>, Camera, View), b: &(Arc<Frame>, Camera, View)) -> bool {
    Arc::ptr_eq(&a.0, &b.0) && a.1 == b.1 && a.2 == b.2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_have_no_more_pixels_than_memory_has_room_for() {
        assert_eq!(drawn_size_px([3840, 2160], 16384), [3840, 2160]);
        assert_eq!(drawn_size_px([30_000, 28_000], 16384), [4096, 4096]);
        assert_eq!(drawn_size_px([0, 20_000], 8192), [0, 8192]);
    }
}
