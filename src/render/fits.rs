//! Where the lights' maps lie in one picture, and the uniforms of its passes.

use crate::render::camera::Camera;
use crate::render::frame_uniforms::FrameUniforms;
use crate::render::framing::Floor;
use crate::render::light::{FloorFit, KEY_LIGHT_SPREAD, ShadowFit, TOWARDS_KEY_LIGHT};
use crate::render::light_maps::{LightDetail, LightMaps};
use crate::render::overlay::map_of;
use crate::render::surface_pass::map_row;
use crate::render::target::Target;
use crate::render::theme::Theme;
use crate::render::triangles::Triangles;
use crate::render::view::View;
use glam::{Vec2, Vec3};

/// Bodies dim the ambient light on the floor up to this height, in body radii.
const FLOOR_REACH_RADII: f32 = 0.7;
/// How far around what the camera looks at a quarter of the floor has become background, in distances of the camera. It
/// hangs on the camera alone, so that the background keeps still while bodies move.
const FLOOR_RADIUS: f32 = 1.0;

/// The lights' maps for one picture.
pub(crate) struct Fits {
    light: LightDetail,
    shadow: ShadowFit,
    pub floor: Option<FloorFit>,
    /// Whether something reaches below the floor.
    pub is_cut_by_floor: bool,
}

impl Fits {
    pub fn new(triangles: &Triangles, floor: Option<Floor>, light: LightDetail) -> Self {
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

    pub fn write_matrices(&self, queue: &wgpu::Queue, maps: &LightMaps) {
        maps.shadow.set_matrix(queue, self.shadow.shadow_from_world);
        if let Some(floor) = &self.floor {
            maps.height.set_matrix(queue, floor.heights_from_world());
        }
    }
}

/// What the passes of the light need.
pub(crate) fn light_uniforms(fits: &Fits) -> FrameUniforms {
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

pub(crate) fn uniforms(
    target: Target<'_>,
    camera: &Camera,
    view: &View,
    fits: &Fits,
    theme: &Theme,
) -> FrameUniforms {
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
