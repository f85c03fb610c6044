use crate::build::{body, material, quiet_world};
use glam::{DMat3, DVec3};
use hammerfall::fracture::{Criterion, PrincipalStress, Strength, StressMeasures};
use hammerfall::mesh::shapes::{Beam, HexSplit, Meshing, Resolution, Shape};
use hammerfall::scene::Scene;
use hammerfall::sim::{BodySetup, BoundaryAction, BoundaryCondition, Material, World};

fn beam_world(beam: Beam, size: f64, split: HexSplit, force: f64, ramp_s: f64, strength: Option<f64>) -> World {
    let mesh = Shape::Beam(beam).build(&Meshing { resolution: Resolution::ElementSize(size), split }).unwrap();
    let pick = |s: f64| -> Vec<u32> { (0u32..).zip(&mesh.nodes_m).filter(|(_, x)| s * x.x > 0.5 - 1e-9).map(|p| p.0).collect() };
    let boundary = vec![
        BoundaryCondition { nodes: pick(-1.0), action: BoundaryAction::Fixed { axes: [true; 3] } },
        BoundaryCondition { nodes: pick(1.0), action: BoundaryAction::Force { total_n: DVec3::NEG_Z * force, ramp_s } },
    ];
    let fracture = strength.map(|s| Criterion::single(Strength::Tensile { tensile_strength_pa: s }).unwrap());
    let m = Material { damping_per_s: 30.0, fracture, ..material(1200.0, 2e8, 0.2) };
    World::new(quiet_world(vec![BodySetup { boundary, ..body("beam", mesh, m) }])).unwrap()
}

fn middle(world: &World, nodes: &[u32]) -> DVec3 {
    let r = world.reference_positions_m(0);
    nodes.iter().map(|n| r[*n as usize]).sum::<DVec3>() / nodes.len() as f64
}

#[test]
#[ignore]
fn beam() {
    let env = |k: &str, d: f64| std::env::var(k).ok().and_then(|v| v.parse().ok()).unwrap_or(d);
    let (nw, width, hw, h, r) = (env("NW", 0.4), env("B", 0.05), env("WEB", 0.125), env("H", 0.25), env("R", 0.1));
    for n in std::env::var("N").unwrap_or("2,4".into()).split(',').map(|s| s.parse::<f64>().unwrap()) {
        for split in [HexSplit::Five, HexSplit::Six] {
            let beam = Beam { length_m: 1.0, width_m: width, height_m: h, notch_width_m: nw, notch_depth_m: h - hw, notch_radius_m: r, ..Beam::default() };
            let arm = 0.5 + nw / 2.0 - r;
            let per_n = arm * 6.0 / (width * hw * hw);
            let strength = 2e5;
            let force = 2.0 * strength / per_n;
            let ramp = env("RAMP", 1.0); let force = 2.0 * force;
            let mut world = beam_world(beam, hw / n, split, 0.5 * force, env("RAMP", 1.0), Some(strength));
            let mut first_failed = 0.0;
            let mut next = 0.05;
            let mut s2 = String::new();
            while world.time_s() < ramp && world.sample().crack_area_m2 == 0.0 {
                world.step(ramp).unwrap();
                if world.time_s() > next {
                    next += 0.01;
                    let top = world.element_stresses(0).iter().enumerate().map(|(e, s)| (s.principal_pa.x, e)).fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
                    s2 = format!("s1/nominal {:.3} at {:.3?} ", top.0 / (world.time_s() * 0.5 * force * per_n / ramp), middle(&world, &world.tets(0)[top.1].clone()).to_array());
                    if first_failed == 0.0 && top.0 >= strength { first_failed = world.time_s() * 2.0; }
                }
            }
            let faces: Vec<_> = world.crack_faces(0).map(|f| middle(&world, &f.nodes).to_array().map(|v| (v * 1000.0).round() / 1000.0)).collect();
            println!("n {n} {split:?} tets {} r {r}: {s2} first failed {first_failed:.3} first crack {:.3}*ramp steps {:.1e} at {faces:?}", world.tets(0).len(), world.time_s() * 2.0, world.time_s() / world.stable_step_s(0));
        }
    }
}

#[test]
#[ignore]
fn pile() {
    let name = std::env::var("SCENE").unwrap_or("pile-press".into());
    let extra: Vec<String> = std::env::var("SET").unwrap_or_default().split(';').filter(|s| !s.is_empty()).map(str::to_owned).collect();
    for phi in std::env::var("PHI").unwrap_or("-1,0,10,20,30".into()).split(',').map(|s| s.parse::<f64>().unwrap()) {
        let mut sets = extra.clone();
        if phi >= 0.0 {
            sets.push(format!("materials.concrete.fracture={{criterion=\"mohr-coulomb\",cohesion=1e6,friction_angle={phi}}}"));
        } else {
            sets.push("materials.concrete.fracture={criterion=\"tensile\",tensile_strength=2e5}".into());
        }
        let scene = Scene::load(&name, &sets).unwrap_or_else(|e| panic!("{e}"));
        let b = scene.setup.bodies.iter().position(|b| b.name == "pile").unwrap();
        let criterion = scene.setup.bodies[b].materials[0].fracture.clone().unwrap();
        let end = scene.description.duration_s;
        let mut world = World::new(scene.setup).unwrap();
        let steep = |n: DVec3| n.z.abs().clamp(0.0, 1.0).acos().to_degrees();
        let (mut sum, mut count, mut first, mut broke) = (0.0, 0.0, 0.0, 0.0);
        let mut peak = 0.0f64;
        let mut next = 0.0;
        let start = std::time::Instant::now();
        let report = |label: &str, world: &World, sum: f64, count: f64| {
            let r = world.reference_positions_m(b);
            let (mut area, mut mean, mut centre) = (0.0, 0.0, DVec3::ZERO);
            let faces: Vec<[DVec3; 3]> = world.crack_faces(b).map(|f| f.nodes.map(|n| r[n as usize])).collect();
            for [p, q, s] in &faces {
                let a = (*q - *p).cross(*s - *p);
                mean += steep(a.normalize()) * a.length();
                centre += (*p + *q + *s) / 3.0 * a.length();
                area += a.length();
            }
            centre /= area;
            let mut cov = DMat3::ZERO;
            for f in &faces {
                let a = (f[1] - f[0]).cross(f[2] - f[0]).length();
                let d = (f[0] + f[1] + f[2]) / 3.0 - centre;
                cov += DMat3::from_cols(d * d.x, d * d.y, d * d.z) * a;
            }
            let p = PrincipalStress::of(&(cov * (1.0 / area)));
            println!("phi {phi} {label} t {:.4}: failed planes {:.2} ({count}); faces mean {:.1}; best fit {:.1} normal {:.2?} spread {:.3?}; area {:.4} fragments {} tets {} wall {:.1}",
                world.time_s(), sum / count, mean / area, steep(p.directions.z_axis), p.directions.z_axis.to_array(), p.values_pa.to_array().map(|v: f64| v.max(0.0).sqrt()), world.sample().crack_area_m2, world.sample().fragments, world.tets(b).len(), start.elapsed().as_secs_f64());
        };
        while world.time_s() < end {
            if world.step(end).is_err() { println!("blew up"); break; }
            if world.time_s() < next { continue; }
            next = world.time_s() + if first == 0.0 { 2e-4 } else { 1e-4 };
            if broke > 0.0 { if world.time_s() > broke + 0.01 { break } else { continue } }
            for s in world.element_stresses(b) {
                let stress = PrincipalStress::of(&s.cauchy_pa);
                peak = peak.max(-stress.values_pa.z);
                let found = criterion.assess(&StressMeasures::of(stress.values_pa)).unwrap();
                if found.fails() {
                    sum += steep(criterion.normal(found.rule, &stress, None));
                    count += 1.0;
                }
            }
            if first == 0.0 && world.sample().crack_area_m2 > 0.0 {
                first = world.time_s();
                report("first", &world, sum, count);
            }
            if broke == 0.0 && world.sample().fragments > 1 + usize::from(false) { broke = world.time_s(); report("apart", &world, sum, count); }
        }
        report("end", &world, sum, count);
        println!("   peak pressure {peak:.3e}");
    }
}
