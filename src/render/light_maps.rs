//! The maps of what light reaches: fine ones for pictures that last, small ones for drafts.

use crate::render::depth_pass::{Casters, DepthMap, DepthPass, Seen};
use crate::render::floor_blur_pass::FloorBlurPass;
use crate::render::floor_light_pass::{FloorLightPass, FloorMap};
use crate::render::frame_uniforms::FrameBinding;
use crate::render::quality::Quality;

/// How fine maps are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LightDetail {
    /// For pictures that last.
    Fine,
    /// Half as fine, which is a quarter of the work.
    Draft,
}

/// Sets of maps: a fine one, and a draft one for the triangles seen and for those to come, see [`LightDetail::place`].
pub(crate) const SETS: [LightDetail; 3] = [LightDetail::Fine, LightDetail::Draft, LightDetail::Draft];

impl LightDetail {
    pub fn of(quality: Quality) -> Self {
        if quality.is_draft { Self::Draft } else { Self::Fine }
    }

    /// Place of the maps among [`SETS`] of what is in one of two sets of triangles.
    pub fn place(self, triangles: usize) -> usize {
        match self {
            Self::Fine => 0,
            Self::Draft => 1 + triangles,
        }
    }

    /// Whether maps of this detail serve where `wanted` ones are: a draft is content with better light.
    pub fn serves(self, wanted: Self) -> bool {
        self == Self::Fine || self == wanted
    }

    /// Side of the key light's shadow map, texels.
    pub fn shadow_side_px(self) -> u32 {
        match self {
            Self::Fine => 1024,
            Self::Draft => 512,
        }
    }

    /// Side of the map of heights above the floor, and of the floor's light map, texels.
    fn floor_side_px(self) -> u32 {
        self.shadow_side_px() / 4
    }
}

/// The maps of one detail.
#[derive(Debug)]
pub(crate) struct LightMaps {
    pub shadow: DepthMap,
    pub height: DepthMap,
    /// Light on the floor as it is found,
    rough: FloorMap,
    /// and smoothed.
    pub floor: FloorMap,
}

/// The passes that fill the maps.
#[derive(Debug)]
pub(crate) struct LightPasses {
    depth: DepthPass,
    floor_light: FloorLightPass,
    floor_blur: FloorBlurPass,
}

impl LightPasses {
    pub fn new(device: &wgpu::Device, frame: &FrameBinding) -> Self {
        Self {
            depth: DepthPass::new(device),
            floor_light: FloorLightPass::new(device, frame),
            floor_blur: FloorBlurPass::new(device),
        }
    }

    pub fn new_maps(&self, device: &wgpu::Device, detail: LightDetail) -> LightMaps {
        let shadow = self.depth.new_map(device, "shadow map", detail.shadow_side_px());
        let height = self.depth.new_map(device, "height map", detail.floor_side_px());
        let rough = self.floor_light.new_map(device, [&shadow, &height], detail.floor_side_px());
        let floor = self.floor_blur.new_map(device, &rough);
        LightMaps { shadow, height, rough, floor }
    }

    /// Fills the shadow map.
    pub fn draw_shadow(&self, encoder: &mut wgpu::CommandEncoder, maps: &LightMaps, casters: &Casters<'_>) {
        self.depth.draw(encoder, (&maps.shadow, Seen::FromAbove), casters);
    }

    /// Fills the maps of the floor, after the shadow map.
    pub fn draw_floor(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (frame, maps): (&FrameBinding, &LightMaps),
        casters: &Casters<'_>,
        quality: Quality,
    ) {
        self.depth.draw(encoder, (&maps.height, Seen::FromBelow), casters);
        self.floor_light.draw(encoder, frame, &maps.rough, quality);
        self.floor_blur.draw(encoder, &maps.floor);
    }
}
