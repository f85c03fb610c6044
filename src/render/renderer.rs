//! The order of the passes: long-lived pipelines, and the data of one picture.

use crate::frame::Frame;
use crate::render::camera::Camera;
use crate::render::compose_pass::{ComposePass, SceneTextures};
use crate::render::depth_pass::Casters;
use crate::render::enlarge_pass::{EnlargePass, SmallPicture};
use crate::render::frame_uniforms::{FrameBinding, FrameUniforms};
use crate::render::framing::Floor;
use crate::render::geometry::{Geometry, GeometryBuilder, SurfaceVertex};
use crate::render::gpu::{Gpu, GpuError};
use crate::render::light::{FloorFit, KEY_LIGHT_SPREAD, ShadowFit, TOWARDS_KEY_LIGHT};
use crate::render::light_maps::{LightDetail, LightMaps, LightPasses};
use crate::render::overlay::{Overlay, OverlayContent, Placement, map_of};
use crate::render::prepared::{Look, Prepared};
use crate::render::quality::Quality;
use crate::render::surface_pass::{SurfacePass, map_row};
use crate::render::theme::Theme;
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
    /// By [`LightDetail`].
    light_maps: [LightMaps; 2],
    surface_pass: SurfacePass,
    compose_pass: ComposePass,
    enlarge_pass: EnlargePass,
    overlay: Overlay,
    geometry: GeometryBuilder,
    prepared: Option<Prepared>,
    vertices: wgpu::Buffer,
    caster_positions: wgpu::Buffer,
    caster_corners: wgpu::Buffer,
    textures: Option<SceneTextures>,
    small: Option<SmallPicture>,
    known: Option<Known>,
}

/// What vertices and light maps on the GPU were made of.
#[derive(Debug)]
struct Known {
    frame: Arc<Frame>,
    view: View,
    look: Look,
    light: LightDetail,
    triangles: Triangles,
}

/// The vertices on the GPU.
#[derive(Clone, Copy, Debug)]
struct Triangles {
    count: u32,
    /// Corners of the triangles that cast shadows.
    of_casters: u32,
    /// See [`Geometry`].
    bounds_m: Option<(Vec3, Vec3)>,
    body_radius_m: f32,
}

impl From<&Geometry> for Triangles {
    fn from(geometry: &Geometry) -> Self {
        Self {
            count: geometry.vertices.len() as u32,
            of_casters: 3 * geometry.caster_triangles.len() as u32,
            bounds_m: geometry.bounds_m,
            body_radius_m: geometry.body_radius_m,
        }
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
        let light_maps = LightDetail::ALL.map(|detail| light_passes.new_maps(device, detail));
        let shadows = light_maps.each_ref().map(|maps| &maps.shadow);
        let floor_lights = light_maps.each_ref().map(|maps| &maps.floor.view);
        Self {
            surface_pass: SurfacePass::new((device, &gpu.queue), &frame, shadows),
            compose_pass: ComposePass::new(device, &frame, floor_lights, target_format),
            enlarge_pass: EnlargePass::new(device, target_format),
            overlay: Overlay::new(device, target_format),
            geometry: GeometryBuilder::default(),
            prepared: None,
            vertices: new_buffer(device, wgpu::BufferUsages::VERTEX, 1 << 16),
            caster_positions: new_buffer(device, wgpu::BufferUsages::VERTEX, 1 << 14),
            caster_corners: new_buffer(device, wgpu::BufferUsages::INDEX, 1 << 14),
            textures: None,
            small: None,
            known: None,
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

    /// Has another thread build the triangles of a frame that [`Self::render_again`] is to draw next, and tells whether
    /// it need not wait for them: ask again until then. Only one frame is prepared at a time.
    pub fn prepare(&mut self, frame: &Arc<Frame>, view: &View) -> bool {
        let is_free = self.prepared.as_ref().is_none_or(Prepared::is_ready);
        if is_free && self.prepared.as_ref().is_none_or(|prepared| !prepared.is_of(frame, view)) {
            let builder = self.prepared.take().map(Prepared::into_builder).unwrap_or_default();
            self.prepared = Some(Prepared::start(frame, view, builder));
        }
        self.prepared.as_ref().is_some_and(|prepared| prepared.is_of(frame, view) && prepared.is_ready())
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
        let before =
            self.known.take().filter(|known| shared.is_some_and(|frame| Arc::ptr_eq(frame, &known.frame)));
        let known_look = before.as_ref().filter(|known| known.view == *view).map(|known| known.look);
        let prepared_look = shared.and_then(|frame| self.built(frame, view)).map(|(_, look)| look);
        let look = known_look.or(prepared_look).unwrap_or_else(|| Look::of(frame, view));
        let before =
            before.filter(|known| (known.look.coloring, known.look.floor) == (look.coloring, look.floor));
        let triangles = match &before {
            Some(known) => known.triangles,
            None => self.upload((frame, shared), view, look)?,
        };
        let wanted = LightDetail::of(quality);
        let lit = before.map(|known| known.light).filter(|light| light.serves(wanted));
        let light = lit.unwrap_or(wanted);
        let fits = Fits::new(&triangles, look.floor, light);
        self.write_uniforms(target, (camera, view), &fits, quality);
        self.fit_textures(target.size_px, quality);

        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if lit.is_none() {
            let casters = Casters {
                positions: &self.caster_positions,
                corners: &self.caster_corners,
                count: triangles.of_casters,
            };
            let maps = (&self.frame, &self.light_maps[light.place()]);
            self.light_passes.draw(&mut encoder, maps, &casters, (fits.floor.is_some(), quality));
        }
        self.draw_scene(&mut encoder, &fits, triangles.count, quality);
        let Look { range, cross_scale_pa, .. } = look;
        let content = OverlayContent { view, time_s: frame.time_s, range, cross_scale_pa };
        self.draw_on_target(&mut encoder, (target, light), &content);
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.check().inspect_err(|_| {
            // They may be what failed; the next picture gets new ones.
            self.textures = None;
        })?;
        self.known =
            shared.map(|frame| Known { frame: frame.clone(), view: view.clone(), look, light, triangles });
        Ok(())
    }

    /// What was built in advance of a frame in a view.
    fn built(&mut self, frame: &Arc<Frame>, view: &View) -> Option<(&GeometryBuilder, Look)> {
        self.prepared.as_mut().filter(|prepared| prepared.is_of(frame, view))?.built()
    }

    /// Brings the frame's triangles to the GPU.
    fn upload(
        &mut self,
        (frame, shared): (&Frame, Option<&Arc<Frame>>),
        view: &View,
        look: Look,
    ) -> Result<Triangles, GpuError> {
        // Taken out of `self` for a while, which is written to.
        let mut prepared = self.prepared.take();
        let is_of = |prepared: &&mut Prepared| shared.is_some_and(|frame| prepared.is_of(frame, view));
        let built = prepared.as_mut().filter(is_of).and_then(Prepared::built);
        let uploaded = match built {
            Some((builder, _)) => self.upload_vertices(builder.geometry()),
            None => {
                let mut builder = std::mem::take(&mut self.geometry);
                builder.build(frame, look.hidden(), look.coloring);
                let uploaded = self.upload_vertices(builder.geometry());
                self.geometry = builder;
                uploaded
            }
        };
        self.prepared = prepared;
        uploaded
    }

    fn upload_vertices(&mut self, geometry: &Geometry) -> Result<Triangles, GpuError> {
        let vertices = &geometry.vertices;
        let bytes: &[u8] = bytemuck::cast_slice(vertices);
        let needed = bytes.len() as u64;
        let limit = self.gpu.device.limits().max_buffer_size.min(1 << 31);
        if needed > limit {
            return Err(GpuError::TooManyTriangles {
                triangles: vertices.len() / 3,
                limit: limit as usize / size_of::<[SurfaceVertex; 3]>(),
                adapter: self.gpu.info.name.clone(),
            });
        }
        // Of the rest there is less: vertices are shared.
        self.gpu.fill(&mut self.vertices, bytes);
        self.gpu.fill(&mut self.caster_positions, bytemuck::cast_slice(&geometry.casters_m));
        self.gpu.fill(&mut self.caster_corners, bytemuck::cast_slice(&geometry.caster_triangles));
        Ok(Triangles::from(geometry))
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
        let maps = &self.light_maps[fits.light.place()];
        maps.shadow.set_matrix(queue, fits.shadow.shadow_from_world);
        if let Some(floor) = &fits.floor {
            maps.height.set_matrix(queue, floor.heights_from_world());
        }
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

    fn draw_scene(&self, encoder: &mut wgpu::CommandEncoder, fits: &Fits, count: u32, quality: Quality) {
        let Some(textures) = &self.textures else {
            return;
        };
        let mut pass = begin_scene(encoder, textures);
        pass.set_bind_group(0, &self.frame.group, &[]);
        let detail = (quality, fits.light);
        self.surface_pass.draw(&mut pass, (&self.vertices, count), fits.is_cut_by_floor, detail);
    }

    fn draw_on_target(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        (target, light): (Target<'_>, LightDetail),
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
            self.compose_pass.draw(&mut pass, &self.frame, (textures, light));
        }
        let mut pass = begin_target(encoder, &target).forget_lifetime();
        let [x, y] = target.origin_px.map(|px| px as f32);
        let [width, height] = target.size_px.map(|px| px as f32);
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        match (&self.small, &self.textures) {
            (Some(small), _) => self.enlarge_pass.draw(&mut pass, small),
            (None, Some(textures)) => self.compose_pass.draw(&mut pass, &self.frame, (textures, light)),
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
}

fn uniforms(target: Target<'_>, camera: &Camera, view: &View, fits: &Fits, theme: &Theme) -> FrameUniforms {
    let floor = fits.floor;
    let [corner, right, up] = camera.picture_rays(target.aspect());
    FrameUniforms {
        clip_from_world: camera.clip_from_world(target.aspect()).to_cols_array_2d(),
        shadow_from_world: fits.shadow.shadow_from_world.to_cols_array_2d(),
        eye: camera.eye_m().to_array(),
        wireframe: f32::from(u8::from(view.wireframe)),
        towards_light: TOWARDS_KEY_LIGHT.normalize().to_array(),
        shadow_texel: fits.shadow.side_m / fits.light.shadow_side_px() as f32,
        key_light: theme.key_light.to_array(),
        wire_width: view.pixels_per_point.max(1.0),
        sky_light: theme.sky_light.to_array(),
        floor_height: floor.map_or(-1e9, |floor| floor.height_m),
        bounce_light: theme.bounce_light.to_array(),
        floor_radius: FLOOR_RADIUS * camera.distance_m,
        rim_light: theme.rim_light.to_array(),
        map_row: map_row(map_of(view.color_by)),
        background_low: theme.background_low.to_array(),
        shadow_depth: fits.shadow.depth_m,
        background_high: theme.background_high.to_array(),
        shadow_strength: theme.shadow_strength,
        floor_color: theme.floor_color.to_array(),
        light_spread: KEY_LIGHT_SPREAD,
        wire_color: theme.wire_color.to_array(),
        wire_opacity: theme.wire_opacity,
        floor_center: camera.target_m.truncate().to_array(),
        floor_map_low: floor.map_or(Vec2::ZERO, |floor| floor.low_m).to_array(),
        floor_map_side: floor.map_or(1.0, |floor| floor.side_m),
        // Without a floor nothing is near it.
        floor_reach: floor.map_or(1e-9, |floor| floor.reach_m),
        picture_origin: target.origin_px.map(|px| px as f32),
        ray_corner: corner.to_array(),
        ray_right: right.to_array(),
        ray_up: up.to_array(),
        ..FrameUniforms::default()
    }
}

impl Gpu {
    /// Fills a buffer from its start, in place of a larger one where it is too small.
    fn fill(&self, buffer: &mut wgpu::Buffer, bytes: &[u8]) {
        let needed = bytes.len() as u64;
        if needed > buffer.size() {
            // Some room to grow, so that a breaking body does not reallocate every frame.
            let size = (needed + needed / 2).min(self.device.limits().max_buffer_size.max(needed));
            *buffer = new_buffer(&self.device, buffer.usage(), size);
        }
        self.queue.write_buffer(buffer, 0, bytes);
    }
}

fn new_buffer(device: &wgpu::Device, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("surface"),
        size: size.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
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
