//! What is seen at a moment as geometry: Wavefront OBJ and Stanford PLY, metres, z up.
//!
//! Every fragment is an object of its own (OBJ), or has its number at its triangles (PLY); crack faces are marked, so
//! that they can get a material of their own. Fixed bodies stay out.

use super::{ExportError, write_whole};
use crate::frame::{BodyFrame, BodyRole, Frame};
use std::fmt::Write as _;
use std::path::Path;

/// Writes the fragments as OBJ.
///
/// # Errors
/// [`ExportError`] when the file cannot be written.
pub fn write_obj(path: &Path, frame: &Frame) -> Result<(), ExportError> {
    write_whole(path, obj(frame).as_bytes())
}

/// Writes the fragments as PLY.
///
/// # Errors
/// [`ExportError`] when the file cannot be written.
pub fn write_ply(path: &Path, frame: &Frame) -> Result<(), ExportError> {
    write_whole(path, ply(frame).as_bytes())
}

fn moving(frame: &Frame) -> impl Iterator<Item = (usize, &BodyFrame)> {
    frame.bodies.iter().enumerate().filter(|(_, body)| body.role != BodyRole::Fixed)
}

/// Triangles of a fragment with whether they lie on a crack.
fn triangles_of(body: &BodyFrame, fragment: u32) -> impl Iterator<Item = ([u32; 3], bool)> + '_ {
    let surface = &body.surface;
    let all = surface.triangles.iter().enumerate();
    all.filter(move |(index, _)| surface.triangle_fragment.get(*index).copied().unwrap_or(0) == fragment)
        .map(|(index, triangle)| (*triangle, surface.triangle_is_crack.get(index).copied().unwrap_or(false)))
}

fn fragments_of(body: &BodyFrame) -> Vec<u32> {
    let mut fragments = body.surface.triangle_fragment.clone();
    if fragments.is_empty() {
        fragments.push(0);
    }
    fragments.sort_unstable();
    fragments.dedup();
    fragments
}

fn obj(frame: &Frame) -> String {
    let mut text = format!("# t = {} s, metres, z up; crack faces: usemtl crack\n", frame.time_s);
    let mut first = 1;
    for (_, body) in moving(frame) {
        for [x, y, z] in &body.positions_m {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        for fragment in fragments_of(body) {
            let _ = writeln!(text, "o {}-{fragment}", body.name);
            for is_crack in [false, true] {
                let mut faces =
                    triangles_of(body, fragment).filter(|(_, crack)| *crack == is_crack).peekable();
                if faces.peek().is_some() {
                    text.push_str(if is_crack { "usemtl crack\n" } else { "usemtl surface\n" });
                }
                for ([a, b, c], _) in faces {
                    let _ = writeln!(text, "f {} {} {}", first + a, first + b, first + c);
                }
            }
        }
        first += body.positions_m.len() as u32;
    }
    text
}

fn ply(frame: &Frame) -> String {
    let vertices: usize = moving(frame).map(|(_, body)| body.positions_m.len()).sum();
    let faces: usize = moving(frame).map(|(_, body)| body.surface.triangles.len()).sum();
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment t = {} s, metres, z up\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar uint vertex_indices\nproperty uint body\nproperty uint fragment\nproperty uchar crack\nend_header\n",
        frame.time_s
    );
    for (_, body) in moving(frame) {
        for [x, y, z] in &body.positions_m {
            let _ = writeln!(text, "{x} {y} {z}");
        }
    }
    let mut first = 0;
    for (index, body) in moving(frame) {
        for fragment in fragments_of(body) {
            for ([a, b, c], crack) in triangles_of(body, fragment) {
                let (a, b, c) = (first + a, first + b, first + c);
                let _ = writeln!(text, "3 {a} {b} {c} {index} {fragment} {}", u8::from(crack));
            }
        }
        first += body.positions_m.len() as u32;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::sim::World;

    fn broken() -> Frame {
        let scene = Scene::load("brick-pile", &[]).unwrap();
        let mut world = World::new(scene.setup).unwrap();
        while world.time_s() < 0.02 {
            world.step(0.02).unwrap();
        }
        world.publish()
    }

    #[test]
    fn every_fragment_is_a_closed_object() {
        let frame = broken();
        let text = obj(&frame);
        let objects: Vec<&str> = text.split("\no ").skip(1).collect();
        assert_eq!(objects.len(), frame.status.fragments);
        assert!(frame.status.fragments > 6 && text.contains("usemtl crack"));
        let vertices = text.lines().filter(|line| line.starts_with("v ")).count() as u32;
        for object in objects {
            let mut edges = std::collections::BTreeMap::new();
            for face in object.lines().filter_map(|line| line.strip_prefix("f ")) {
                let corners: Vec<u32> = face.split(' ').map(|n| n.parse().unwrap()).collect();
                assert!(corners.iter().all(|corner| (1..=vertices).contains(corner)));
                for i in 0..3 {
                    let (a, b) = (corners[i], corners[(i + 1) % 3]);
                    *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
                }
            }
            assert!(!edges.is_empty() && edges.values().all(|sum| *sum == 0), "open: {}", &object[..20]);
        }
    }

    #[test]
    fn a_ply_has_what_its_head_says() {
        let frame = broken();
        let text = ply(&frame);
        let (head, body) = text.split_once("end_header\n").unwrap();
        let count = |what: &str| -> usize {
            let at = head.lines().find_map(|line| line.strip_prefix(what)).unwrap();
            at.trim().parse().unwrap()
        };
        assert_eq!(body.lines().count(), count("element vertex") + count("element face"));
    }
}
