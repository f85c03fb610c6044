//! Where the key light's shadow map and the floor's light map lie.

use glam::{Mat3, Mat4, Vec2, Vec3};

/// Towards the key light, world coordinates: from the upper left of the three-quarter view.
pub const TOWARDS_KEY_LIGHT: Vec3 = Vec3::new(-0.38, -0.52, 0.765);

/// Tangent of the key light's angular radius: the half width of a penumbra per distance.
pub const KEY_LIGHT_SPREAD: f32 = 0.085;

/// The key light's shadow map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowFit {
    /// Clip coordinates of the shadow map (x, y from -1 to 1; depth 0 nearest to the light)
    /// from world ones.
    pub shadow_from_world: Mat4,
    /// Side of the square that the map covers, metres.
    pub side_m: f32,
    /// Depth that the map covers, metres.
    pub depth_m: f32,
}

/// The rectangle of the floor that the floor's light map covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorFit {
    /// Smallest x and y, metres.
    pub low_m: Vec2,
    /// Side of the square, metres.
    pub side_m: f32,
    /// World z of the floor, metres.
    pub height_m: f32,
    /// Height above the floor up to which bodies dim the ambient light, metres.
    pub reach_m: f32,
}

impl ShadowFit {
    /// A map that covers the box of everything that casts a shadow.
    ///
    /// Its size goes in steps and its corner lies on whole texels, so that shadow edges do not
    /// crawl while the scene changes smoothly.
    #[must_use]
    pub fn around((low_m, high_m): (Vec3, Vec3), texels: u32) -> Self {
        let light_from_world = light_axes().transpose();
        let center = light_from_world * (0.5 * (low_m + high_m));
        let half = 0.5 * (high_m - low_m).max(Vec3::splat(1e-4));
        let reach = (light_from_world.abs()) * half;
        // Two texels of rim for the filter.
        let rim = 1.0 + 4.0 / texels as f32;
        let side_m = stepped(2.0 * reach.x.max(reach.y) * rim);
        let texel_m = side_m / texels as f32;
        let snapped = (center.truncate() / texel_m).round() * texel_m;
        let depth_m = stepped(2.0 * reach.z);
        let near_m = center.z + 0.5 * depth_m;
        let scale = Vec3::new(2.0 / side_m, 2.0 / side_m, -1.0 / depth_m);
        let shift = Vec3::new(-snapped.x * scale.x, -snapped.y * scale.y, near_m / depth_m);
        let clip_from_light = Mat4::from_translation(shift) * Mat4::from_scale(scale);
        Self { shadow_from_world: clip_from_light * Mat4::from_mat3(light_from_world), side_m, depth_m }
    }
}

impl FloorFit {
    /// A map that covers the shadows of the box on the floor, soft edges included.
    #[must_use]
    pub fn around((low_m, high_m): (Vec3, Vec3), height_m: f32, reach_m: f32) -> Self {
        let light = TOWARDS_KEY_LIGHT.normalize();
        let fall = |z: f32| (z - height_m).max(0.0);
        let slide = |z: f32| -light.truncate() * fall(z) / light.z;
        let penumbra = Vec2::splat(KEY_LIGHT_SPREAD * fall(high_m.z) / light.z + 1.5 * reach_m);
        let (bottom, top) = (slide(low_m.z), slide(high_m.z));
        let low = low_m.truncate() + bottom.min(top).min(Vec2::ZERO) - penumbra;
        let high = high_m.truncate() + bottom.max(top).max(Vec2::ZERO) + penumbra;
        let side_m = stepped((high - low).max_element().max(1e-4));
        Self { low_m: 0.5 * (low + high) - 0.5 * side_m, side_m, height_m, reach_m }
    }

    /// Clip coordinates of the map of heights above the floor (depth 0 a little below the
    /// floor, 1 at `reach_m` above it) from world ones.
    #[must_use]
    pub fn heights_from_world(&self) -> Mat4 {
        let scale = Vec3::new(2.0 / self.side_m, 2.0 / self.side_m, 1.0 / (1.1 * self.reach_m));
        let center = (self.low_m + 0.5 * self.side_m).extend(self.height_m - 0.1 * self.reach_m);
        Mat4::from_scale(scale) * Mat4::from_translation(-center)
    }
}

/// Columns: right, up, and towards the light, in world coordinates.
fn light_axes() -> Mat3 {
    let towards = TOWARDS_KEY_LIGHT.normalize();
    let right = Vec3::Z.cross(towards).normalize();
    Mat3::from_cols(right, towards.cross(right), towards)
}

/// The next of a series of lengths, each a quarter octave above the one before.
fn stepped(length_m: f32) -> f32 {
    (4.0 * length_m.log2()).ceil().mul_add(0.25, 0.0).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX_M: (Vec3, Vec3) = (Vec3::new(-0.3, 0.2, 0.1), Vec3::new(0.9, 0.4, 1.0));

    fn corners() -> impl Iterator<Item = Vec3> {
        (0..8).map(|i| {
            let pick = |bit: usize, axis: usize| {
                if i & bit == 0 { BOX_M.0[axis] } else { BOX_M.1[axis] }
            };
            Vec3::new(pick(1, 0), pick(2, 1), pick(4, 2))
        })
    }

    #[test]
    fn shadow_map_covers_all_casters() {
        let fit = ShadowFit::around(BOX_M, 512);
        for corner in corners() {
            let p = fit.shadow_from_world.project_point3(corner);
            assert!(p.truncate().abs().max_element() <= 1.0, "{p}");
            assert!((-1e-4..=1.0001).contains(&p.z), "{p}");
        }
    }

    #[test]
    fn nearer_to_the_light_is_smaller_depth() {
        let fit = ShadowFit::around(BOX_M, 512);
        let depth = |p: Vec3| fit.shadow_from_world.project_point3(p).z;
        assert!(depth(TOWARDS_KEY_LIGHT * 0.5) < depth(Vec3::ZERO));
    }

    #[test]
    fn small_moves_shift_the_map_by_whole_texels() {
        let texels = 512;
        let moved = (BOX_M.0 + 0.0137, BOX_M.1 + 0.0137);
        let place = |bounds| {
            let fit = ShadowFit::around(bounds, texels);
            let origin = fit.shadow_from_world.project_point3(Vec3::ZERO).truncate();
            origin * 0.5 * texels as f32
        };
        let shift = place(BOX_M) - place(moved);
        assert!((shift - shift.round()).length() < 0.02, "{shift}");
    }

    #[test]
    fn floor_map_covers_the_shadows() {
        let floor = FloorFit::around(BOX_M, 0.0, 0.1);
        let light = TOWARDS_KEY_LIGHT.normalize();
        for corner in corners() {
            let shadow = (corner - light * (corner.z / light.z)).truncate();
            let uv = (shadow - floor.low_m) / floor.side_m;
            assert!(uv.min_element() > 0.0 && uv.max_element() < 1.0, "{uv}");
        }
    }
}
