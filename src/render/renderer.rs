//! The order of the passes: long-lived pipelines, and the data of one picture.

use crate::frame::Frame;
use crate::render::camera::Camera;
use crate::render::compose_pass::{ComposePass, SceneTextures};
use crate::render::enlarge_pass::{EnlargePass, SmallPicture};
use crate::render::fits::{Fits, light_uniforms, uniforms};
use crate::render::frame_uniforms::FrameBinding;
use crate::render::geometry::GeometryBuilder;
use crate::render::gpu::{Gpu, GpuError};
use crate::render::light_maps::{LightDetail, LightMaps, LightPasses, SETS};
use crate::render::overlay::{Overlay, OverlayContent, Placement};
use crate::render::prepared::{Look, Prepared};
use crate::render::quality::Quality;
use crate::render::surface_pass::SurfacePass;
use crate::render::target::{Strip, Target, begin_scene, begin_target, texture_size_px};
use crate::render::theme::Theme;
use crate::render::triangles::{TriangleBuffers, Triangles};
use crate::render::view::View;
use std::sync::Arc;

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
    refining: Option<Refining>,
}

/// Parts of the height of a picture that is refined.
const STRIPS: u32 = 8;

/// A picture that is drawn finely piece by piece, and how many of its [`STRIPS`] are done.
#[derive(Debug)]
struct Refining {
    frame: Arc<Frame>,
    camera: Camera,
    view: View,
    size_px: [u32; 2],
    strips: u32,
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
}

impl Known {
    fn is_of(&self, frame: &Arc<Frame>, view: &View) -> bool {
        Arc::ptr_eq(&self.frame, frame) && self.view == *view
    }

    fn content(&self, time_s: f64) -> OverlayContent<'_> {
        let Look { range, cross_scale_pa, .. } = self.look;
        OverlayContent { view: &self.view, time_s, range, cross_scale_pa }
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
            refining: None,
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
        self.coming = Some(Coming { known, has_shadow: false });
        self.light_what_comes(quality)
    }

    /// A piece of the light on what is to come; tells whether that is ready.
    fn light_what_comes(&mut self, quality: Quality) -> bool {
        let Some(Coming { known, has_shadow }) = &mut self.coming else { return false };
        let light = LightDetail::of(quality);
        if light == LightDetail::Fine || known.light.is_some() {
            return true;
        }
        let back = 1 - self.front;
        let fits = Fits::new(&known.triangles, known.look.floor, light);
        let maps = &self.light_maps[light.place(back)];
        let casters = self.buffers[back].casters(&known.triangles);
        fits.write_matrices(&self.gpu.queue, maps);
        self.frame.write(&self.gpu.queue, &light_uniforms(&fits));
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let is_ready = *has_shadow || fits.floor.is_none();
        if *has_shadow {
            self.light_passes.draw_floor(&mut encoder, (&self.frame, maps), &casters, quality);
        } else {
            self.light_passes.draw_shadow(&mut encoder, maps, &casters);
            *has_shadow = true;
        }
        known.light = is_ready.then_some(light);
        self.gpu.queue.submit([encoder.finish()]);
        is_ready
    }

    /// As [`Self::render_again`] in full quality, but piece by piece, one at each call, so that slow hardware can answer in
    /// between. The target changes with the last one; tells whether it was that. Pictures drawn meanwhile begin it anew.
    ///
    /// # Errors
    /// As for [`Self::render`].
    pub fn refine(
        &mut self,
        target: Target<'_>,
        frame: &Arc<Frame>,
        (camera, view): (&Camera, &View),
    ) -> Result<bool, GpuError> {
        if target.size_px.contains(&0) {
            return Ok(true);
        }
        self.gpu.check_size(target.size_px)?;
        let is_same = |it: &Refining| {
            let is_seen = Arc::ptr_eq(&it.frame, frame) && (it.camera, &it.view) == (*camera, view);
            is_seen && it.size_px == target.size_px
        };
        let mut refining = self.refining.take().filter(is_same).unwrap_or_else(|| Refining {
            frame: frame.clone(),
            camera: *camera,
            view: view.clone(),
            size_px: target.size_px,
            strips: 0,
        });
        let mut known = match self.known_of(Some(frame), view) {
            Some(known) => known,
            None => self.upload((frame, Some(frame)), view)?,
        };
        let (quality, light) = (Quality::FULL, LightDetail::Fine);
        let light_set = light.place(self.front);
        let fits = Fits::new(&known.triangles, known.look.floor, light);
        self.write_uniforms(target, (camera, view), &fits, quality);
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if known.light != Some(light) {
            self.draw_light(&mut encoder, (&known.triangles, &fits), (light_set, quality));
            known.light = Some(light);
        } else {
            self.fit_textures(target.size_px, quality);
            let strip = Strip { number: refining.strips, of: STRIPS };
            let triangles = (known.triangles.count, fits.is_cut_by_floor);
            self.draw_scene(&mut encoder, triangles, (quality, light_set), strip);
            refining.strips += 1;
        }
        let is_done = refining.strips == STRIPS;
        if is_done {
            self.draw_on_target(&mut encoder, (target, light_set), &known.content(frame.time_s));
        }
        self.submit(encoder)?;
        self.known = Some(known);
        self.refining = Some(refining).filter(|_| !is_done);
        Ok(is_done)
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
        self.refining = None;
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
            self.draw_light(&mut encoder, (&known.triangles, &fits), (light_set, quality));
        }
        let detail = (quality, light_set);
        self.draw_scene(&mut encoder, (known.triangles.count, fits.is_cut_by_floor), detail, Strip::ALL);
        self.draw_on_target(&mut encoder, (target, light_set), &known.content(frame.time_s));
        self.submit(encoder)?;
        known.light = Some(light);
        self.known = shared.map(|_| known);
        Ok(())
    }

    fn submit(&mut self, encoder: wgpu::CommandEncoder) -> Result<(), GpuError> {
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.check().inspect_err(|_| {
            // They may be what failed; the next picture gets new ones.
            self.textures = None;
        })
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

    fn draw_light(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (triangles, fits): (&Triangles, &Fits),
        (light_set, quality): (usize, Quality),
    ) {
        let maps = &self.light_maps[light_set];
        let casters = self.buffers[self.front].casters(triangles);
        fits.write_matrices(&self.gpu.queue, maps);
        self.light_passes.draw_shadow(encoder, maps, &casters);
        if fits.floor.is_some() {
            self.light_passes.draw_floor(encoder, (&self.frame, maps), &casters, quality);
        }
    }

    fn draw_scene(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (count, is_cut_by_floor): (u32, bool),
        detail: (Quality, usize),
        strip: Strip,
    ) {
        let Some(textures) = &self.textures else {
            return;
        };
        let mut pass = begin_scene(encoder, textures, strip);
        let [width, _] = textures.size_px;
        let (top, height) = strip.rows(textures.size_px[1]);
        if height == 0 {
            return;
        }
        pass.set_scissor_rect(0, top, width, height);
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
