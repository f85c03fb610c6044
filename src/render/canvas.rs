//! Lines and text on a flat ground, without a GPU: egui lays them out and makes triangles of them, which are
//! filled here. The same bytes on every machine.

use crate::render::off_screen::Picture;
use egui::epaint::{ColorImage, ImageData, Mesh, Primitive, Vertex};
use egui::{Color32, Painter, Pos2, Rect, TextureId, Vec2, pos2};

/// Draws on a fresh picture of the given size in points and returns it. `draw` gets the painter and is called once.
#[must_use]
pub fn paint(
    size_points: [f32; 2],
    pixels_per_point: f32,
    ground: Color32,
    mut draw: impl FnMut(&Painter),
) -> Picture {
    let context = egui::Context::default();
    let screen = Rect::from_min_size(Pos2::ZERO, Vec2::from(size_points));
    let mut output = context.run_pass(super::overlay::raw_input(screen, pixels_per_point), |context| {
        draw(&context.layer_painter(egui::LayerId::background()));
    });
    let mut canvas = Canvas::new(size_points.map(|side| (side * pixels_per_point).round() as usize), ground);
    let texts = output.textures_delta.set.get(&TextureId::default());
    for image in texts.into_iter().flatten() {
        canvas.take_texture(&image.image, image.pos);
    }
    output.textures_delta.clear();
    for clipped in context.tessellate(output.shapes, pixels_per_point) {
        if let Primitive::Mesh(mesh) = clipped.primitive {
            canvas.fill_mesh(&mesh, clipped.clip_rect, pixels_per_point);
        }
    }
    canvas.into_picture()
}

struct Canvas {
    size_px: [usize; 2],
    /// Row by row from the top.
    pixels: Vec<Color32>,
    /// Letters, and a white texel at the origin for everything else.
    texture: ColorImage,
}

impl Canvas {
    fn new(size_px: [usize; 2], ground: Color32) -> Self {
        let texture = ColorImage::filled([1, 1], Color32::WHITE);
        Self { size_px, pixels: vec![ground; size_px[0] * size_px[1]], texture }
    }

    fn take_texture(&mut self, image: &ImageData, at: Option<[usize; 2]>) {
        let ImageData::Color(image) = image;
        let Some([left, top]) = at else {
            self.texture = ColorImage::clone(image);
            return;
        };
        let [width, height] = image.size;
        let stride = self.texture.size[0];
        for row in 0..height {
            let to = (top + row) * stride + left;
            self.texture.pixels[to..to + width]
                .copy_from_slice(&image.pixels[row * width..(row + 1) * width]);
        }
    }

    fn fill_mesh(&mut self, mesh: &Mesh, clip: Rect, pixels_per_point: f32) {
        let clip = Rect::from_min_max(
            (clip.min * pixels_per_point).max(Pos2::ZERO),
            (clip.max * pixels_per_point).min(pos2(self.size_px[0] as f32, self.size_px[1] as f32)),
        );
        for corners in mesh.indices.chunks_exact(3) {
            let corners = [corners[0], corners[1], corners[2]].map(|index| {
                let vertex = mesh.vertices[index as usize];
                Vertex { pos: vertex.pos * pixels_per_point, ..vertex }
            });
            self.fill_triangle(corners, clip);
        }
    }

    /// Fills the pixels whose middles lie inside; on an edge that two triangles share, in one of them.
    fn fill_triangle(&mut self, mut corners: [Vertex; 3], clip: Rect) {
        let [a, b, c] = corners.map(|corner| corner.pos);
        let twice_area = cross(a, b, c);
        if twice_area == 0.0 || !twice_area.is_finite() {
            return;
        }
        if twice_area < 0.0 {
            corners.swap(1, 2);
        }
        let box_px = Rect::from_points(&[a, b, c]).intersect(clip);
        let [first_column, last_column] = pixel_span(box_px.left(), box_px.right());
        let [first_row, last_row] = pixel_span(box_px.top(), box_px.bottom());
        for row in first_row..last_row {
            for column in first_column..last_column {
                if let Some(weights) = weights(&corners, pos2(column as f32 + 0.5, row as f32 + 0.5)) {
                    let on_top = self.color(&corners, weights);
                    let pixel = &mut self.pixels[row * self.size_px[0] + column];
                    *pixel = pixel.blend(on_top);
                }
            }
        }
    }

    fn color(&self, corners: &[Vertex; 3], weights: [f32; 3]) -> Color32 {
        let mix = |of: &dyn Fn(&Vertex) -> f32| -> f32 {
            corners.iter().zip(weights).map(|(v, w)| w * of(v)).sum()
        };
        let [width, height] = self.texture.size;
        // Letters are laid out on whole pixels: the texel under the pixel's middle is the one meant.
        let texel = |share: f32, count: usize| ((share * count as f32).max(0.0) as usize).min(count - 1);
        let column = texel(mix(&|v| v.uv.x), width);
        let row = texel(mix(&|v| v.uv.y), height);
        let texel = self.texture.pixels[row * width + column].to_array();
        let [r, g, b, a] = std::array::from_fn(|i| {
            let tint = mix(&|v| f32::from(v.color.to_array()[i]));
            (tint * f32::from(texel[i]) / 255.0).round() as u8
        });
        Color32::from_rgba_premultiplied(r, g, b, a)
    }

    fn into_picture(self) -> Picture {
        Picture {
            width: self.size_px[0] as u32,
            height: self.size_px[1] as u32,
            rgba: self.pixels.iter().flat_map(Color32::to_array).collect(),
        }
    }
}

/// The pixels whose middles lie from `low` to `high`: first, and one past the last.
fn pixel_span(low: f32, high: f32) -> [usize; 2] {
    [(low - 0.5).ceil(), (high - 0.5).floor() + 1.0].map(|edge| edge.max(0.0) as usize)
}

/// Twice the area of a triangle, positive where `a, b, c` turn as x does to y.
fn cross(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Shares of the three corners at a point inside; `None` outside.
fn weights(corners: &[Vertex; 3], at: Pos2) -> Option<[f32; 3]> {
    let [a, b, c] = corners.each_ref().map(|corner| corner.pos);
    let edges = [(b, c), (c, a), (a, b)];
    let parts = edges.map(|(from, to)| cross(from, to, at));
    let is_inside = edges.iter().zip(parts).all(|(&(from, to), part)| {
        // Of two triangles at an edge, which they run through in opposite senses, one owns it.
        let owns_edge = to.y < from.y || (to.y == from.y && to.x > from.x);
        part > 0.0 || (part == 0.0 && owns_edge)
    });
    let sum: f32 = parts.iter().sum();
    is_inside.then(|| parts.map(|part| part / sum))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Align2, FontId};

    #[test]
    fn halves_of_a_see_through_square_meet_without_a_seam() {
        let square = Rect::from_min_max(pos2(2.0, 2.0), pos2(8.0, 8.0));
        let picture = paint([10.0, 10.0], 2.0, Color32::WHITE, |painter| {
            let mut mesh = Mesh::default();
            mesh.add_colored_rect(square, Color32::from_black_alpha(128));
            painter.add(mesh);
        });
        assert_eq!((picture.width, picture.height), (20, 20));
        for (index, pixel) in picture.rgba.chunks_exact(4).enumerate() {
            let [x, y] = [index % 20, index / 20];
            let inside = (4..16).contains(&x) && (4..16).contains(&y);
            assert_eq!(pixel[0], if inside { 127 } else { 255 }, "{x} {y}");
        }
    }

    #[test]
    fn text_is_drawn() {
        let picture = paint([60.0, 20.0], 1.0, Color32::WHITE, |painter| {
            painter.text(pos2(2.0, 2.0), Align2::LEFT_TOP, "MPa", FontId::proportional(13.0), Color32::BLACK);
        });
        let dark = picture.rgba.chunks_exact(4).filter(|pixel| pixel[0] < 100).count();
        assert!((20..400).contains(&dark), "{dark}");
    }
}
