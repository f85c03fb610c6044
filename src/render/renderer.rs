//! The order of the passes: long-lived pipelines, and the data of one picture.

use crate::frame::Frame;
use crate::render::camera::Camera;
use crate::render::compose_pass::{ComposePass, SceneTextures};
use crate::render::enlarge_pass::{EnlargePass, SmallPicture};
use crate::render::frame_uniforms::{FrameBinding, FrameUniforms};
use crate::render::framing::Floor;
use crate::render::geometry::GeometryBuilder;
use crate::render::gpu::{Gpu, GpuError};
use crate::render::light::{FloorFit, KEY_LIGHT_SPREAD, ShadowFit, TOWARDS_KEY_LIGHT};
use crate::render::light_maps::{LightDetail, LightMaps, LightPasses, SETS};
use crate::render::overlay::{Overlay, OverlayContent, Placement, map_of};
use crate::render::prepared::{Look, Prepared};
use crate::render::quality::Quality;
use crate::render::surface_pass::{SurfacePass, map_row};
use crate::render::theme::Theme;
use crate::render::triangles::{TriangleBuffers, Triangles};
use crate::render::view::View;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Bodies dim the ambient light on the floor up to this height, in body radii.
const FLOOR_REACH_RADII: f32 = 0.7;
/// Radius of the floor around what the camera looks at, in distances of the camera. It hangs on
/// the camera alone, so that the background keeps still while bodies move.
const FLOOR_RADIUS: f32 = 3.0;

/// Where a picture goes: a rectangle of a texture.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// The texture, in the format the renderer was made for.
    pub view: &'a wgpu::TextureView,
    /// Upper left corner of the rectangle, pixels.
    pub origin_px: [u32; 2],
    /// Size of the rectangle, pixels.
    pub size_px: [u32; 2],
}

impl<'a> Target<'a> {
    /// All of a texture.
    #[must_use]
    pub fn whole(view: &'a wgpu::TextureView) -> Self {
        Self { view, origin_px: [0, 0], size_px: texture_size_px(view) }
    }

    /// A rectangle of a texture, cut where it sticks out; what is outside it stays as it is.
    #[must_use]
    pub fn part(view: &'a wgpu::TextureView, origin_px: [u32; 2], size_px: [u32; 2]) -> Self {
        let all = texture_size_px(view);
        let origin_px = std::array::from_fn(|i| origin_px[i].min(all[i]));
        Self { view, origin_px, size_px: std::array::from_fn(|i| size_px[i].min(all[i] - origin_px[i])) }
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        self.size_px[0] as f32 / self.size_px[1].max(1) as f32
    }

    fn is_whole(&self) -> bool {
        self.origin_px == [0, 0] && self.size_px == texture_size_px(self.view)
    }
}

fn texture_size_px(view: &wgpu::TextureView) -> [u32; 2] {
    let texture = view.texture();
    [texture.width(), texture.height()]
}

/// Draws frames. It knows a texture, not a window: the same code serves both.
pub struct Renderer {
    gpu: Gpu,
    frame: FrameBinding,
    light_passes: LightPasses,
    /// By place among [`SETS`].
    light_maps: [LightMaps; 3],
    surface_pass: SurfacePass,
    compose_pass: ComposePass,
    enlarge_pass: EnlargePass,
    overlay: Overlay,
    geometry: GeometryBuilder,
    prepared: Option<Prepared>,
    /// Those of which pictures are drawn, and those to come; `front` is the place of the former.
    buffers: [TriangleBuffers; 2],
    front: usize,
    known: Option<Known>,
    coming: Option<Coming>,
    textures: Option<SceneTextures>,
    small: Option<SmallPicture>,
}

/// What vertices and light maps on the GPU were made of.
#[derive(Debug)]
struct Known {
    frame: Arc<Frame>,
    view: View,
    look: Look,
    triangles: Triangles,
    /// `None` as long as the maps are of something else.
    light: Option<LightDetail>,
}

/// What is being brought to the GPU while pictures of something else are drawn.
#[derive(Debug)]
struct Coming {
    known: Known,
    /// Whether only the light on the floor is left to do.
    has_shadow: bool,
    is_ready: bool,
}

impl Known {
    fn is_of(&self, frame: &Arc<Frame>, view: &View) -> bool {
        Arc::ptr_eq(&self.frame, frame) && self.view == *view
    }
}

impl Renderer {
    /// Builds the pipelines for targets of the given format. Prefer a format without `Srgb` in
    /// its name (`Rgba8Unorm`, `Bgra8Unorm`): text is blended as its designers meant it there.
    #[must_use]
    pub fn new(gpu: &Gpu, target_format: wgpu::TextureFormat) -> Self {
        let device = &gpu.device;
        let frame = FrameBinding::new(device);
        let light_passes = LightPasses::new(device, &frame);
        let light_maps = SETS.map(|detail| light_passes.new_maps(device, detail));
        let shadows = light_maps.each_ref().map(|maps| &maps.shadow);
        let floor_lights = light_maps.each_ref().map(|maps| &maps.floor.view);
        Self {
            surface_pass: SurfacePass::new((device, &gpu.queue), &frame, shadows),
            compose_pass: ComposePass::new(device, &frame, floor_lights, target_format),
            enlarge_pass: EnlargePass::new(device, target_format),
            overlay: Overlay::new(device, target_format),
            geometry: GeometryBuilder::default(),
            prepared: None,
            buffers: [TriangleBuffers::new(device), TriangleBuffers::new(device)],
            front: 0,
            known: None,
            coming: None,
            textures: None,
            small: None,
            gpu: gpu.clone(),
            frame,
            light_passes,
            light_maps,
        }
    }

    /// Draws a frame, legend and caption included, and hands it to the device's queue.
    ///
    /// A target without area is left as it is.
    ///
    /// # Errors
    /// [`GpuError::BadSize`] and [`GpuError::TooManyTriangles`] before drawing; else the first
    /// fault that the device has reported so far.
    pub fn render(
        &mut self,
        target: Target<'_>,
        frame: &Frame,
        camera: &Camera,
        view: &View,
    ) -> Result<(), GpuError> {
        self.known = None;
        self.draw(target, (frame, None), (camera, view), Quality::FULL)
    }

    /// As [`Self::render`], less finely if so told. While the same frame comes again in the same colours, its vertices
    /// and light maps are kept.
    ///
    /// # Errors
    /// As for [`Self::render`].
    pub fn render_again(
        &mut self,
        target: Target<'_>,
        frame: &Arc<Frame>,
        (camera, view): (&Camera, &View),
        quality: Quality,
    ) -> Result<(), GpuError> {
        self.draw(target, (frame, Some(frame)), (camera, view), quality)
    }

    /// Makes ready for a frame that [`Self::render_again`] is to draw next, and tells whether it is: `workers` build
    /// its triangles, which then come to the GPU and, for drafts, their light piece by piece, one at each call. Only one
    /// frame is prepared at a time.
    pub fn prepare(
        &mut self,
        frame: &Arc<Frame>,
        view: &View,
        (quality, workers): (Quality, &rayon::ThreadPool),
    ) -> bool {
        if self.coming.as_ref().is_some_and(|coming| coming.known.is_of(frame, view)) {
            return self.light_what_comes(quality);
        }
        let is_free = self.prepared.as_mut().is_none_or(Prepared::is_ready);
        if is_free && self.prepared.as_ref().is_none_or(|prepared| !prepared.is_of(frame, view)) {
            let builder = self.prepared.take().map(Prepared::into_builder).unwrap_or_default();
            self.prepared = Some(Prepared::start(frame, view, builder, workers));
        }
        let Some(prepared) = &mut self.prepared else { return false };
        if !prepared.is_of(frame, view) || !prepared.is_ready() {
            return false;
        }
        let Some((builder, look)) = prepared.built() else { return true };
        // Too many are told of by whoever draws them.
        let Ok(triangles) = self.buffers[1 - self.front].upload(&self.gpu, builder.geometry()) else {
            return true;
        };
        let known = Known { frame: frame.clone(), view: view.clone(), look, triangles, light: None };
        self.coming = Some(Coming { known, has_shadow: false, is_ready: false });
        self.light_what_comes(quality)
    }

    /// A piece of the light on what is to come; tells whether that is ready.
    fn light_what_comes(&mut self, quality: Quality) -> bool {
        let Some(Coming { known, has_shadow, is_ready }) = &mut self.coming else { return false };
        let light = LightDetail::of(quality);
        if light == LightDetail::Fine || *is_ready {
            return true;
        }
        let back = 1 - self.front;
        let fits = Fits::new(&known.triangles, known.look.floor, light);
        let maps = &self.light_maps[light.place(back)];
        let casters = self.buffers[back].casters(&known.triangles);
        fits.write_matrices(&self.gpu.queue, maps);
        self.frame.write(&self.gpu.queue, &light_uniforms(&fits));
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if !*has_shadow {
            self.light_passes.draw_shadow(&mut encoder, maps, &casters);
            *has_shadow = true;
            *is_ready = fits.floor.is_none();
        } else {
            self.light_passes.draw_floor(&mut encoder, (&self.frame, maps), &casters, quality);
            *is_ready = true;
        }
        known.light = is_ready.then_some(light);
        let is_ready = *is_ready;
        self.gpu.queue.submit([encoder.finish()]);
        is_ready
    }

    fn draw(
        &mut self,
        target: Target<'_>,
        (frame, shared): (&Frame, Option<&Arc<Frame>>),
        (camera, view): (&Camera, &View),
        quality: Quality,
    ) -> Result<(), GpuError> {
        if target.size_px.contains(&0) {
            return Ok(());
        }
        self.gpu.check_size(target.size_px)?;
        let mut known = match self.known_of(shared, view) {
            Some(known) => known,
            None => self.upload((frame, shared), view)?,
        };
        let light = known.light.filter(|light| light.serves(LightDetail::of(quality)));
        let is_lit = light.is_some();
        let light = light.unwrap_or(LightDetail::of(quality));
        let light_set = light.place(self.front);
        let fits = Fits::new(&known.triangles, known.look.floor, light);
        self.write_uniforms(target, (camera, view), &fits, quality);
        self.fit_textures(target.size_px, quality);

        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if !is_lit {
            let maps = &self.light_maps[light_set];
            let casters = self.buffers[self.front].casters(&known.triangles);
            fits.write_matrices(&self.gpu.queue, maps);
            self.light_passes.draw_shadow(&mut encoder, maps, &casters);
            if fits.floor.is_some() {
                self.light_passes.draw_floor(&mut encoder, (&self.frame, maps), &casters, quality);
            }
        }
        let detail = (quality, light_set);
        self.draw_scene(&mut encoder, (known.triangles.count, fits.is_cut_by_floor), detail);
        let Look { range, cross_scale_pa, .. } = known.look;
        let content = OverlayContent { view, time_s: frame.time_s, range, cross_scale_pa };
        self.draw_on_target(&mut encoder, (target, light_set), &content);
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.check().inspect_err(|_| {
            // They may be what failed; the next picture gets new ones.
            self.textures = None;
        })?;
        known.light = Some(light);
        self.known = shared.map(|_| known);
        Ok(())
    }

    /// What is on the GPU of a frame, if its triangles are what `view` wants.
    fn known_of(&mut self, frame: Option<&Arc<Frame>>, view: &View) -> Option<Known> {
        let (known, frame) = (self.known.take(), frame?);
        let is_coming = |coming: &mut Coming| coming.known.is_of(frame, view);
        if let Some(coming) = self.coming.take_if(is_coming) {
            self.front = 1 - self.front;
            return Some(coming.known);
        }
        let mut known = known.filter(|known| Arc::ptr_eq(&known.frame, frame))?;
        if known.view != *view {
            let look = Look::of(frame, view);
            let is_same = (known.look.coloring, known.look.floor) == (look.coloring, look.floor);
            known = Known { view: view.clone(), look, ..Some(known).filter(|_| is_same)? };
        }
        Some(known)
    }

    /// Builds the frame's triangles and brings them to the GPU; of a frame that is not `shared` nothing will be known.
    fn upload(
        &mut self,
        (frame, shared): (&Frame, Option<&Arc<Frame>>),
        view: &View,
    ) -> Result<Known, GpuError> {
        let look = Look::of(frame, view);
        let geometry = self.geometry.build(frame, look.hidden(), look.coloring);
        let triangles = self.buffers[self.front].upload(&self.gpu, geometry)?;
        let frame = shared.cloned().unwrap_or_default();
        Ok(Known { frame, view: view.clone(), look, triangles, light: None })
    }

    fn write_uniforms(
        &self,
        target: Target<'_>,
        (camera, view): (&Camera, &View),
        fits: &Fits,
        quality: Quality,
    ) {
        let queue = &self.gpu.queue;
        let theme = Theme::of(view.background);
        let mut uniforms = uniforms(target, camera, view, fits, &theme);
        if quality.drawn_px(target.size_px) != target.size_px {
            uniforms.picture_origin = [0.0; 2];
            uniforms.wire_width = (view.pixels_per_point * quality.share()).max(1.0);
        }
        self.frame.write(queue, &uniforms);
    }

    fn fit_textures(&mut self, target_px: [u32; 2], quality: Quality) {
        let (size_px, samples) = (quality.drawn_px(target_px), quality.samples());
        let is_small = size_px != target_px;
        let fits = |t: &SceneTextures| t.size_px == size_px && t.samples == samples;
        if !self.textures.as_ref().is_some_and(fits) || self.small.is_some() != is_small {
            let device = &self.gpu.device;
            self.textures = Some(self.compose_pass.new_textures(device, size_px, samples));
            self.small = is_small.then(|| self.enlarge_pass.new_picture(device, size_px));
        }
    }

    fn draw_scene(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (count, is_cut_by_floor): (u32, bool),
        detail: (Quality, usize),
    ) {
        let Some(textures) = &self.textures else {
            return;
        };
        let mut pass = begin_scene(encoder, textures);
        pass.set_bind_group(0, &self.frame.group, &[]);
        let vertices = &self.buffers[self.front].vertices;
        self.surface_pass.draw(&mut pass, (vertices, count), is_cut_by_floor, detail);
    }

    fn draw_on_target(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        (target, light_set): (Target<'_>, usize),
        content: &OverlayContent<'_>,
    ) {
        let placement = Placement {
            target_px: texture_size_px(target.view),
            origin_px: target.origin_px,
            size_px: target.size_px,
        };
        self.overlay.prepare(&self.gpu, encoder, placement, content);
        if let (Some(small), Some(textures)) = (&self.small, &self.textures) {
            let mut pass = begin_target(encoder, &Target::whole(&small.view));
            self.compose_pass.draw(&mut pass, &self.frame, (textures, light_set));
        }
        let mut pass = begin_target(encoder, &target).forget_lifetime();
        let [x, y] = target.origin_px.map(|px| px as f32);
        let [width, height] = target.size_px.map(|px| px as f32);
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        match (&self.small, &self.textures) {
            (Some(small), _) => self.enlarge_pass.draw(&mut pass, small),
            (None, Some(textures)) => self.compose_pass.draw(&mut pass, &self.frame, (textures, light_set)),
            (None, None) => {}
        }
        self.overlay.draw(&mut pass);
    }
}

/// The lights' maps for one picture.
struct Fits {
    light: LightDetail,
    shadow: ShadowFit,
    floor: Option<FloorFit>,
    /// Whether something reaches below the floor.
    is_cut_by_floor: bool,
}

impl Fits {
    fn new(triangles: &Triangles, floor: Option<Floor>, light: LightDetail) -> Self {
        let nothing = (Vec3::splat(-0.5), Vec3::splat(0.5));
        let bounds = triangles.bounds_m.unwrap_or(nothing);
        let reach_m = (FLOOR_REACH_RADII * triangles.body_radius_m).max(1e-5);
        Self {
            light,
            shadow: ShadowFit::around(bounds, light.shadow_side_px()),
            is_cut_by_floor: floor.is_some_and(|f| bounds.0.z < f.height_m - 1e-3 * reach_m),
            floor: floor.map(|floor| FloorFit::around(bounds, floor.height_m, reach_m)),
        }
    }

    fn write_matrices(&self, queue: &wgpu::Queue, maps: &LightMaps) {
        maps.shadow.set_matrix(queue, self.shadow.shadow_from_world);
        if let Some(floor) = &self.floor {
            maps.height.set_matrix(queue, floor.heights_from_world());
        }
    }
}

/// What the passes of the light need.
fn light_uniforms(fits: &Fits) -> FrameUniforms {
    let floor = fits.floor;
    FrameUniforms {
        shadow_from_world: fits.shadow.shadow_from_world.to_cols_array_2d(),
        shadow_texel: fits.shadow.side_m / fits.light.shadow_side_px() as f32,
        shadow_depth: fits.shadow.depth_m,
        light_spread: KEY_LIGHT_SPREAD,
        floor_height: floor.map_or(-1e9, |floor| floor.height_m),
        floor_map_low: floor.map_or(Vec2::ZERO, |floor| floor.low_m).to_array(),
        floor_map_side: floor.map_or(1.0, |floor| floor.side_m),
        // Without a floor nothing is near it.
        floor_reach: floor.map_or(1e-9, |floor| floor.reach_m),
        ..FrameUniforms::default()
    }
}

fn uniforms(target: Target<'_>, camera: &Camera, view: &View, fits: &Fits, theme: &Theme) -> FrameUniforms {
    let [corner, right, up] = camera.picture_rays(target.aspect());
    FrameUniforms {
        clip_from_world: camera.clip_from_world(target.aspect()).to_cols_array_2d(),
        eye: camera.eye_m().to_array(),
        wireframe: f32::from(u8::from(view.wireframe)),
        towards_light: TOWARDS_KEY_LIGHT.normalize().to_array(),
        key_light: theme.key_light.to_array(),
        wire_width: view.pixels_per_point.max(1.0),
        sky_light: theme.sky_light.to_array(),
        bounce_light: theme.bounce_light.to_array(),
        floor_radius: FLOOR_RADIUS * camera.distance_m,
        rim_light: theme.rim_light.to_array(),
        map_row: map_row(map_of(view.color_by)),
        background_low: theme.background_low.to_array(),
        background_high: theme.background_high.to_array(),
        shadow_strength: theme.shadow_strength,
        floor_color: theme.floor_color.to_array(),
        wire_color: theme.wire_color.to_array(),
        wire_opacity: theme.wire_opacity,
        floor_center: camera.target_m.truncate().to_array(),
        picture_origin: target.origin_px.map(|px| px as f32),
        ray_corner: corner.to_array(),
        ray_right: right.to_array(),
        ray_up: up.to_array(),
        ..light_uniforms(fits)
    }
}

fn begin_scene<'e>(encoder: &'e mut wgpu::CommandEncoder, textures: &SceneTextures) -> wgpu::RenderPass<'e> {
    // Samples are resolved at the end of the pass; nobody needs them, or the depth, after it.
    let (view, resolve_target, store) = match &textures.color {
        Some(samples) => (samples, Some(&textures.resolved), wgpu::StoreOp::Discard),
        None => (&textures.resolved, None, wgpu::StoreOp::Store),
    };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("scene"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &textures.depth,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

fn begin_target<'e>(encoder: &'e mut wgpu::CommandEncoder, target: &Target<'_>) -> wgpu::RenderPass<'e> {
    let load = if target.is_whole() { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("target"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    })
}
