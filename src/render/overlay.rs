//! Text over the picture: legend and caption, drawn with egui's fonts, without a window.

use crate::frame::ColorBy;
use crate::render::color_map::ColorMap;
use crate::render::crosses::{COMPRESSION_SRGB, TENSION_SRGB};
use crate::render::gpu::Gpu;
use crate::render::range::Range;
use crate::render::theme::Theme;
use crate::render::units::{short, si_prefix, with_unit};
use crate::render::view::{Caption, View};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, pos2, vec2};

/// Free space around the texts, points.
const MARGIN: f32 = 16.0;
const TITLE_SIZE: f32 = 14.0;
const TEXT_SIZE: f32 = 13.0;
/// Width of the colour bar, points, and its height as a share of the picture's.
const BAR_WIDTH: f32 = 12.0;
const BAR_SHARE: f32 = 0.38;
/// Length of the point at an end of the bar that stands for all values beyond, points.
const POINT_LENGTH: f32 = 9.0;
/// A picture smaller than this, points, would be all legend.
const SMALLEST_WITH_LEGEND: [f32; 2] = [200.0, 120.0];
/// Steps of the colour bar; each is drawn as a blend between two colours of the map.
const BAR_STEPS: usize = 48;

/// Where the picture lies in its target, pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub target_px: [u32; 2],
    pub origin_px: [u32; 2],
    pub size_px: [u32; 2],
}

/// What to write.
#[derive(Debug)]
pub(crate) struct OverlayContent<'a> {
    pub view: &'a View,
    pub time_s: f64,
    pub range: Option<Range>,
    /// Stress of the longest line of the stress crosses, Pa.
    pub cross_scale_pa: Option<f32>,
}

/// The egui context and its renderer; both live as long as the pictures go on.
pub(crate) struct Overlay {
    context: egui::Context,
    renderer: egui_wgpu::Renderer,
    jobs: Vec<egui::ClippedPrimitive>,
    screen: egui_wgpu::ScreenDescriptor,
}

impl Overlay {
    pub fn new(device: &wgpu::Device, target_format: wgpu::TextureFormat) -> Self {
        Self {
            context: egui::Context::default(),
            renderer: egui_wgpu::Renderer::new(
                device,
                target_format,
                // Filtering in the shader gives the same text on every driver.
                egui_wgpu::RendererOptions::PREDICTABLE,
            ),
            jobs: Vec::new(),
            screen: egui_wgpu::ScreenDescriptor { size_in_pixels: [1, 1], pixels_per_point: 1.0 },
        }
    }

    /// Lays the text out and brings it to the GPU. Call once before [`Overlay::draw`].
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        placement: Placement,
        content: &OverlayContent<'_>,
    ) {
        let pixels_per_point = content.view.pixels_per_point.clamp(0.25, 16.0);
        let points = |[x, y]: [u32; 2]| pos2(x as f32, y as f32) / pixels_per_point;
        let area = Rect::from_min_size(points(placement.origin_px), points(placement.size_px).to_vec2());
        let screen = Rect::from_min_max(Pos2::ZERO, points(placement.target_px));
        let mut output = self.context.run_pass(raw_input(screen, pixels_per_point), |context| {
            let painter = context.layer_painter(egui::LayerId::background());
            draw(&painter.with_clip_rect(area), area, content);
        });
        self.update_textures(gpu, &mut output.textures_delta);
        self.jobs = self.context.tessellate(output.shapes, pixels_per_point);
        self.screen = egui_wgpu::ScreenDescriptor { size_in_pixels: placement.target_px, pixels_per_point };
        // Only paint callbacks return command buffers, and there are none here.
        self.renderer.update_buffers(&gpu.device, &gpu.queue, encoder, &self.jobs, &self.screen);
    }

    fn update_textures(&mut self, gpu: &Gpu, delta: &mut egui::TexturesDelta) {
        for (id, images) in delta.set.drain() {
            for image in images {
                self.renderer.update_texture(&gpu.device, &gpu.queue, id, &image);
            }
        }
        for id in delta.free.drain() {
            self.renderer.free_texture(&id);
        }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'static>) {
        self.renderer.render(pass, &self.jobs, &self.screen);
    }
}

pub(crate) fn raw_input(screen: Rect, pixels_per_point: f32) -> egui::RawInput {
    let mut input = egui::RawInput {
        screen_rect: Some(screen),
        // A fixed time: nothing here is animated, and nothing may depend on the clock.
        time: Some(0.0),
        ..Default::default()
    };
    if let Some(viewport) = input.viewports.get_mut(&egui::ViewportId::ROOT) {
        viewport.native_pixels_per_point = Some(pixels_per_point);
    }
    input
}

fn draw(painter: &Painter, area: Rect, content: &OverlayContent<'_>) {
    let theme = Theme::of(content.view.background);
    let has_room = area.width() > SMALLEST_WITH_LEGEND[0] && area.height() > SMALLEST_WITH_LEGEND[1];
    if let (true, Some(range)) = (content.view.legend && has_room, content.range) {
        draw_legend(painter, area, content.view, range, &theme);
    }
    if let (true, Some(scale_pa)) = (content.view.legend && has_room, content.cross_scale_pa) {
        draw_cross_legend(painter, area, scale_pa, &theme);
    }
    if let Some(caption) = &content.view.caption {
        draw_caption(painter, area, &caption_lines(caption, content.time_s), &theme);
    }
}

/// The lines of a caption, from top to bottom.
pub(crate) fn caption_lines(caption: &Caption, time_s: f64) -> Vec<String> {
    let mut first = Vec::new();
    if caption.show_time {
        first.push(format!("t = {}", with_unit(time_s, "s")));
    }
    if let Some(factor) = caption.slow_motion.filter(|factor| *factor > 1.0) {
        first.push(format!("{}× slow motion", grouped(factor)));
    }
    let mut lines = Vec::new();
    if !first.is_empty() {
        lines.push(first.join("   "));
    }
    lines.extend(caption.text.lines().map(str::to_owned));
    lines
}

/// A count with thin spaces between thousands.
fn grouped(value: f64) -> String {
    if value < 10_000.0 {
        return short(value);
    }
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// A pale sheet behind texts, so that they are read whatever body is behind them: begun before what is on it is drawn, laid
/// once it is known how large that is.
struct Backing {
    shape: egui::layers::ShapeIdx,
    covered: Rect,
}

impl Backing {
    /// Space between the texts and the edge of the sheet, points.
    const PADDING: f32 = 5.0;

    fn begin(painter: &Painter) -> Self {
        Self { shape: painter.add(egui::Shape::Noop), covered: Rect::NOTHING }
    }

    fn cover(&mut self, drawn: Rect) {
        self.covered |= drawn;
    }

    fn lay(self, painter: &Painter, theme: &Theme) {
        if self.covered.is_positive() {
            let sheet = self.covered.expand(Self::PADDING);
            painter.set(self.shape, egui::Shape::rect_filled(sheet, Self::PADDING, backing_color(theme)));
        }
    }
}

fn backing_color(theme: &Theme) -> Color32 {
    let [r, g, b] = theme.text_backing_srgb;
    Color32::from_rgba_unmultiplied(r, g, b, theme.text_backing_opacity)
}

fn draw_caption(painter: &Painter, area: Rect, lines: &[String], theme: &Theme) {
    let mut bottom = area.bottom() - MARGIN;
    let mut backing = Backing::begin(painter);
    for (index, line) in lines.iter().enumerate().rev() {
        let color = if index == 0 { theme.text_srgb } else { theme.faint_text_srgb };
        let position = pos2(area.left() + MARGIN, bottom);
        let font = FontId::proportional(TITLE_SIZE);
        let drawn = painter.text(position, Align2::LEFT_BOTTOM, line, font, rgb(color));
        backing.cover(drawn);
        bottom = drawn.top() - 2.0;
    }
    backing.lay(painter, theme);
}

fn draw_legend(painter: &Painter, area: Rect, view: &View, range: Range, theme: &Theme) {
    let color_by = view.color_by;
    let size = f64::from(range.low.abs().max(range.high.abs()));
    // What has no unit has no prefix either: a failure index of 0.2 is not 200 thousandths.
    let (factor, unit) = match color_by.unit() {
        "" => (1.0, String::new()),
        unit => {
            let (factor, prefix) = si_prefix(size);
            (factor, format!("  [{prefix}{unit}]"))
        }
    };
    let title = format!("{}{unit}", color_by.label());
    let corner = area.right_top() + vec2(-MARGIN, MARGIN);
    let font = FontId::proportional(TITLE_SIZE);
    let mut backing = Backing::begin(painter);
    let drawn = painter.text(corner, Align2::RIGHT_TOP, title, font, rgb(theme.text_srgb));
    backing.cover(drawn);
    backing.lay(painter, theme);
    // Another one for what is below: it is narrower, and bodies are hidden as little as can be.
    let mut backing = Backing::begin(painter);
    let [is_open_below, is_open_above] = view.open_ends(range);
    let bar = Rect::from_min_size(
        pos2(corner.x - BAR_WIDTH, drawn.bottom() + 10.0 + if is_open_above { POINT_LENGTH } else { 0.0 }),
        vec2(BAR_WIDTH, (area.height() * BAR_SHARE).max(40.0)),
    );
    backing.cover(bar);
    draw_bar(painter, bar, map_of(color_by), theme);
    for (is_open, position, end) in [
        (
            is_open_below,
            0.0,
            [bar.left_bottom(), bar.right_bottom(), bar.center_bottom() + vec2(0.0, POINT_LENGTH)],
        ),
        (is_open_above, 1.0, [bar.left_top(), bar.right_top(), bar.center_top() - vec2(0.0, POINT_LENGTH)]),
    ] {
        if is_open {
            backing.cover(Rect::from_points(&end));
            let [r, g, b] = map_of(color_by).srgb(position).map(crate::render::color_map::to_byte);
            let stroke = Stroke::new(1.0, rgb(theme.faint_text_srgb).gamma_multiply(0.6));
            painter.add(egui::Shape::convex_polygon(end.to_vec(), Color32::from_rgb(r, g, b), stroke));
        }
    }
    for tick in range.ticks() {
        let y = bar.bottom() - range.position(tick) * bar.height();
        let text = short(f64::from(tick) / factor);
        backing.cover(draw_tick(painter, pos2(bar.left(), y), text, theme));
    }
    backing.lay(painter, theme);
}

/// What the lines of the stress crosses mean, in the lower right corner, from right to left.
fn draw_cross_legend(painter: &Painter, area: Rect, scale_pa: f32, theme: &Theme) {
    const SAMPLE: f32 = 16.0;
    let mut at = area.right_bottom() - vec2(MARGIN, MARGIN);
    let mut backing = Backing::begin(painter);
    let mut write = |at: &mut Pos2, text: &str| {
        let font = FontId::proportional(TEXT_SIZE);
        let drawn = painter.text(*at, Align2::RIGHT_BOTTOM, text, font, rgb(theme.text_srgb));
        // With the line that comes before it.
        backing.cover(drawn.with_min_x(drawn.left() - 5.0 - SAMPLE));
        at.x = drawn.left() - 5.0;
        drawn.center().y
    };
    write(&mut at, &format!("  longest {}", with_unit(f64::from(scale_pa), "Pa")));
    for (text, srgb) in [("compression ", COMPRESSION_SRGB), ("tension ", TENSION_SRGB)] {
        let y = write(&mut at, text);
        let [r, g, b] = srgb.map(crate::render::color_map::to_byte);
        let stroke = Stroke::new(3.0, Color32::from_rgb(r, g, b));
        painter.line_segment([pos2(at.x - SAMPLE, y), pos2(at.x, y)], stroke);
        at.x -= SAMPLE + 10.0;
    }
    backing.lay(painter, theme);
}

/// The colour map that shows a field.
pub(crate) fn map_of(color_by: ColorBy) -> ColorMap {
    if color_by.is_signed() { ColorMap::Diverging } else { ColorMap::Sequential }
}

fn draw_bar(painter: &Painter, bar: Rect, map: ColorMap, theme: &Theme) {
    let mut mesh = egui::Mesh::default();
    for step in 0..=BAR_STEPS {
        let position = step as f32 / BAR_STEPS as f32;
        let [r, g, b] = map.srgb(position).map(crate::render::color_map::to_byte);
        let color = Color32::from_rgb(r, g, b);
        let y = bar.bottom() - position * bar.height();
        mesh.colored_vertex(pos2(bar.left(), y), color);
        mesh.colored_vertex(pos2(bar.right(), y), color);
    }
    for step in 0..BAR_STEPS as u32 {
        mesh.add_triangle(2 * step, 2 * step + 1, 2 * step + 2);
        mesh.add_triangle(2 * step + 1, 2 * step + 3, 2 * step + 2);
    }
    painter.add(mesh);
    let stroke = Stroke::new(1.0, rgb(theme.faint_text_srgb).gamma_multiply(0.6));
    painter.rect_stroke(bar, 0.0, stroke, egui::StrokeKind::Outside);
}

fn draw_tick(painter: &Painter, at: Pos2, text: String, theme: &Theme) -> Rect {
    let stroke = Stroke::new(1.0, rgb(theme.faint_text_srgb));
    painter.line_segment([at - vec2(5.0, 0.0), at - vec2(1.0, 0.0)], stroke);
    painter.text(
        at - vec2(9.0, 0.0),
        Align2::RIGHT_CENTER,
        text,
        FontId::proportional(TEXT_SIZE),
        rgb(theme.text_srgb),
    )
}

fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caption_tells_time_and_slow_motion_then_the_text() {
        let caption = Caption { show_time: true, slow_motion: Some(2000.0), text: "Rankine\nglass".into() };
        let lines = caption_lines(&caption, 0.0015);
        assert_eq!(lines, ["t = 1.5 ms   2000× slow motion", "Rankine", "glass"]);
    }

    /// Contrast of two colours as the web's accessibility guidelines define it (WCAG 2.1): 4.5 is what small text needs.
    fn contrast(a: [f32; 3], b: [f32; 3]) -> f32 {
        let linear = |s: f32| if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
        let light = |[r, g, b]: [f32; 3]| 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b) + 0.05;
        let (a, b) = (light(a), light(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn texts_are_read_over_every_body() {
        let share = |color: [u8; 3]| color.map(|level| f32::from(level) / 255.0);
        for background in [crate::render::Background::Light, crate::render::Background::Dark] {
            let theme = Theme::of(background);
            let opacity = f32::from(theme.text_backing_opacity) / 255.0;
            for behind in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let sheet = share(theme.text_backing_srgb).map(|s| behind + opacity * (s - behind));
                let found = contrast(share(theme.text_srgb), sheet);
                assert!(found > 4.5, "{background:?} over {behind}: {found}");
            }
        }
    }

    #[test]
    fn real_time_is_not_called_slow() {
        let caption = Caption { slow_motion: Some(1.0), ..Default::default() };
        assert!(caption_lines(&caption, 0.0).is_empty());
        assert_eq!(grouped(1_234_567.0), "1\u{2009}234\u{2009}567");
    }
}
