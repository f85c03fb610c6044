//! Where pictures go: rectangles of textures, and sizes that cannot be.

use crate::compare::{gpu, screen};
use crate::shapes::{block, frame, ground};
use glam::Vec3;
use hammerfall::frame::Frame;
use hammerfall::render::{
    Camera, Framing, Gpu, GpuError, NamedView, OffScreen, Picture, Quality, Renderer, Target, View,
};
use std::sync::Arc;

const SIZE: [u32; 2] = [64, 36];

/// Reads a texture of 64 pixels' width (256 bytes, which needs no padding).
fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Picture {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(256 * texture.height()),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(256), rows_per_image: None },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("mapped"));
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("finished");
    let rgba = buffer.get_mapped_range(..).expect("mapped").to_vec();
    Picture { width: texture.width(), height: texture.height(), rgba }
}

fn texture(gpu: &Gpu, [width, height]: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

fn scene() -> (hammerfall::frame::Frame, Camera, View) {
    let cube = block(Vec3::new(-0.5, -0.5, 0.1), Vec3::new(0.5, 0.5, 1.1), [2; 3]);
    let frame = frame(vec![ground(), cube]);
    let camera = Framing::of(&frame).camera(NamedView::ThreeQuarter, 64.0 / 36.0);
    (frame, camera, View::for_size(SIZE))
}

fn largest_difference(a: &[u8], b: &[u8]) -> u8 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn window_formats_get_the_same_bytes_as_files() {
    let Some(gpu) = gpu() else { return };
    let (frame, camera, view) = scene();
    let mut screen = OffScreen::new(&gpu).unwrap();
    let file = screen.render(SIZE, &frame, &camera, &view).unwrap();
    for format in [
        wgpu::TextureFormat::Bgra8Unorm,
        wgpu::TextureFormat::Rgba8UnormSrgb,
        wgpu::TextureFormat::Bgra8UnormSrgb,
    ] {
        let texture = texture(&gpu, SIZE, format);
        let target = texture.create_view(&Default::default());
        Renderer::new(&gpu, format).render(Target::whole(&target), &frame, &camera, &view).unwrap();
        let mut window = read(&gpu, &texture);
        if matches!(format.remove_srgb_suffix(), wgpu::TextureFormat::Bgra8Unorm) {
            window.rgba.chunks_exact_mut(4).for_each(|p| p.swap(0, 2));
        }
        assert!(largest_difference(&window.rgba, &file.rgba) <= 1, "{format:?}");
    }
}

#[test]
fn rectangle_of_a_target_is_all_that_changes() {
    let Some(gpu) = gpu() else { return };
    let (frame, camera, view) = scene();
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let texture = texture(&gpu, [64, 64], format);
    let view_of = texture.create_view(&Default::default());
    let mut renderer = Renderer::new(&gpu, format);
    let part = Target::part(&view_of, [8, 20], [40, 30]);
    renderer.render(part, &frame, &camera, &view).unwrap();
    let picture = read(&gpu, &texture);
    for y in 0..64 {
        for x in 0..64 {
            let inside = (8..48).contains(&x) && (20..50).contains(&y);
            let drawn = picture.rgb_at(x, y) != [0; 3];
            assert_eq!(inside, drawn, "{x}, {y}");
        }
    }
    let mut screen = OffScreen::new(&gpu).unwrap();
    let alone = screen.render([40, 30], &frame, &camera, &view).unwrap();
    assert_eq!(picture.rgb_at(8 + 20, 20 + 15), alone.rgb_at(20, 15));
    // Sticking out is cut, and nothing at all is no error.
    let outside = Target::part(&view_of, [60, 70], [40, 30]);
    assert_eq!(outside.size_px, [4, 0]);
    renderer.render(outside, &frame, &camera, &view).unwrap();
}

#[test]
fn pictures_of_prepared_frames_are_those_of_any() {
    let Some(gpu) = gpu() else { return };
    let (first, camera, view) = scene();
    let moved = block(Vec3::new(-0.3, -0.5, 0.4), Vec3::new(0.7, 0.5, 1.6), [3; 3]);
    let frames = [first.into(), Arc::new(frame(vec![ground(), moved]))];
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let target = texture(&gpu, SIZE, format);
    let view_of = target.create_view(&Default::default());
    let workers = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let drawn = |renderer: &mut Renderer, frame: &Arc<Frame>, quality: Quality| {
        renderer.render_again(Target::whole(&view_of), frame, (&camera, &view), quality).unwrap();
        read(&gpu, &target).rgba
    };
    for quality in [Quality::FULL, Quality::draft([1, 1]), Quality::draft([1, 2])] {
        let (mut plain, mut preparing) = (Renderer::new(&gpu, format), Renderer::new(&gpu, format));
        for turn in 0..4 {
            let [shown, coming] = [turn % 2, (turn + 1) % 2].map(|place| &frames[place]);
            let before = drawn(&mut preparing, shown, quality);
            assert!(before == drawn(&mut plain, shown, quality), "{quality:?}, {turn}");
            let mut calls = 0;
            while !preparing.prepare(coming, &view, (quality, &workers)) {
                calls += 1;
                // Meanwhile the other one is seen as it was.
                assert!(before == drawn(&mut preparing, shown, quality), "{quality:?}, {turn}, {calls}");
            }
            assert!(calls > 0 || !quality.is_draft, "{quality:?}: light comes piece by piece");
        }
    }
}

#[test]
fn a_picture_refined_piece_by_piece_is_the_fine_one() {
    let Some(gpu) = gpu() else { return };
    let (first, camera, view) = scene();
    let frame = Arc::new(first);
    let format = wgpu::TextureFormat::Rgba8Unorm;
    // A height that the pieces do not divide, and one with fewer rows than pieces.
    for height in [37, 5] {
        let target = texture(&gpu, [64, height], format);
        let view_of = target.create_view(&Default::default());
        let mut renderer = Renderer::new(&gpu, format);
        let whole = Target::whole(&view_of);
        renderer.render_again(whole, &frame, (&camera, &view), Quality::FULL).unwrap();
        let fine = read(&gpu, &target).rgba;
        renderer.render_again(whole, &frame, (&camera, &view), Quality::draft([1, 2])).unwrap();
        let draft = read(&gpu, &target).rgba;
        assert!(draft != fine);
        let mut pieces = 0;
        while !renderer.refine(whole, &frame, (&camera, &view)).unwrap() {
            assert!(read(&gpu, &target).rgba == draft, "the draft is seen until it is done");
            pieces += 1;
            if pieces == 4 {
                // Another picture in between; what was done is lost, and nothing else.
                renderer.render_again(whole, &frame, (&camera, &view), Quality::draft([1, 2])).unwrap();
            }
        }
        assert!(read(&gpu, &target).rgba == fine, "{height}");
        assert!(pieces > 8, "{pieces}");
    }
}

#[test]
fn impossible_sizes_are_refused_with_the_limit() {
    let Some(mut screen) = screen() else { return };
    let (frame, camera, view) = scene();
    for size in [[0, 10], [10, 0], [1 << 20, 10]] {
        let error = screen.render(size, &frame, &camera, &view).unwrap_err();
        assert!(matches!(error, GpuError::BadSize { .. }), "{error}");
        assert!(error.to_string().contains("from 1 to"), "{error}");
    }
    // And the screen still works.
    screen.render([5, 3], &frame, &camera, &view).unwrap();
}

#[test]
fn unknown_adapter_is_named_with_those_there_are() {
    if gpu().is_none() {
        return;
    }
    let wish = hammerfall::render::AdapterChoice::Named("voodoo 2".into());
    let error = Gpu::headless_with(&wish).unwrap_err().to_string();
    assert!(error.contains("'voodoo 2'") && error.contains("there is:"), "{error}");
}
