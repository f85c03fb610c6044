//! Contact, time, cameras and recording.

use super::super::description::{Camera, Contact, CutPlane, Eye, Recording};
use super::super::quantity::Quantity;
use super::super::reader::{Kind, Table};
use super::{check_name, read_friction};
use crate::frame::ColorBy;
use crate::sim::{ContactMethod, ContactParameters, TimeParameters};
use glam::DVec3;

pub(super) fn read_contact(mut table: Table) -> Contact {
    let defaults = ContactParameters::default();
    let friction = read_friction(&mut table);
    let pairs = table.tables("pairs").into_iter().filter_map(read_pair);
    Contact {
        pairs: pairs.collect(),
        friction_coefficient: friction.unwrap_or(defaults.friction_coefficient),
        self_collision: table.flag("self_collision").unwrap_or(defaults.self_collision),
        rest_speed_m_s: table.number("rest_speed", Quantity::not_negative("m/s")),
        method: read_method(&mut table),
    }
}

pub(super) fn read_method(table: &mut Table) -> ContactMethod {
    let penalty = table.choice("method", &[("lagrange", false), ("penalty", true)]).unwrap_or(false);
    if penalty {
        table.require("penalty_stiffness", "a number (N/m), for the method \"penalty\"");
    }
    let stiffness_n_m = table.number("penalty_stiffness", Quantity::positive("N/m"));
    let passes = table.integer("passes", 1, 10_000);
    let tolerance = table.number("tolerance", Quantity::positive("").up_to(1.0));
    let elastic = table.choice("impact", &[("elastic", true), ("plastic", false)]);
    if penalty {
        ContactMethod::Penalty { stiffness_n_m: stiffness_n_m.unwrap_or(1.0) }
    } else {
        ContactMethod::Lagrange {
            passes: passes.unwrap_or(3),
            tolerance: tolerance.unwrap_or(1e-4),
            conserve_impact_energy: elastic.unwrap_or(true),
        }
    }
}

pub(super) fn read_pair(mut table: Table) -> Option<([String; 2], f64)> {
    table.require("bodies", "the names of the two bodies, as in `bodies = [\"a\", \"b\"]`");
    let bodies = table.texts("bodies", 2, 2);
    let friction = read_friction(&mut table);
    if friction.is_none() && !table.has("friction_angle") {
        table.require("friction", "a number (coefficient), or `friction_angle` (degrees)");
    }
    let bodies = <[String; 2]>::try_from(bodies?).ok()?;
    Some((bodies, friction.unwrap_or(0.0)))
}

/// Duration and intervals.
pub(super) fn read_time(mut table: Table) -> (f64, TimeParameters) {
    let defaults = TimeParameters::default();
    let seconds = Quantity::positive("s");
    let share = Quantity::positive("").up_to(1.0);
    let duration_s = table.required_number("duration", seconds);
    let free_interval = table.number("free_interval", seconds);
    let vibration = table.number("vibration_tolerance", Quantity::not_negative("").up_to(1.0));
    let time = TimeParameters {
        cfl: table.number("cfl", share).unwrap_or(defaults.cfl),
        free_interval_s: free_interval.unwrap_or(defaults.free_interval_s),
        free_travel: table.flag("free_travel").unwrap_or(defaults.free_travel),
        vibration_tolerance: vibration.unwrap_or(defaults.vibration_tolerance),
        sleeping: table.flag("sleeping").unwrap_or(defaults.sleeping),
        max_step_s: table.number("max_step", seconds).unwrap_or(f64::INFINITY),
    };
    (duration_s, time)
}

pub(super) fn read_camera((name, mut table): (String, Table)) -> Camera {
    check_name(&table, &name);
    let target_m = table.vector("target", "m");
    let position = table.vector("position", "m");
    let yaw = table.number("yaw", Quantity::any("degrees"));
    let pitch = table.number("pitch", Quantity::strictly_between(-90.0, 90.0, "degrees"));
    let distance_m = table.number("distance", Quantity::positive("m"));
    let wide = Quantity::strictly_between(1.0, 150.0, "degrees");
    let field_of_view_deg = table.number("field_of_view", wide).unwrap_or(35.0);
    let angles = ["yaw", "pitch", "distance"];
    if table.has("position") && angles.iter().any(|key| table.has(key)) {
        let message = format!(
            "`{}` already says where the eye is; leave out `yaw`, `pitch` and `distance`",
            table.name_of("position")
        );
        table.problem("position", message);
    }
    if position.is_some() && position == target_m {
        let message = format!("`{}` must not be the target itself", table.name_of("position"));
        table.problem("position", message);
    }
    let around = Eye::Around { yaw_deg: yaw.unwrap_or(30.0), pitch_deg: pitch.unwrap_or(20.0), distance_m };
    Camera { name, target_m, eye: position.map_or(around, Eye::At), field_of_view_deg }
}

/// Without a stated interval the history gets some 500 rows.
pub(super) fn read_recording(mut table: Table, duration_s: f64) -> Recording {
    let fps = Quantity::positive("1/s").up_to(1000.0);
    let seconds = Quantity::not_negative("s");
    let history_every = table.number("history_every", seconds);
    let slow_motion = table.number("slow_motion", Quantity::positive("").up_to(1e9));
    let size = table.numbers("size", 2, 2, Quantity::positive("pixels").up_to(8192.0));
    let color_range = read_color_range(&mut table);
    let cut = read_cut(&mut table);
    Recording {
        color_range,
        cut,
        crosses: table.flag("crosses").unwrap_or(false),
        fps: table.number("fps", fps).unwrap_or(30.0),
        slow_motion: slow_motion.unwrap_or(1.0),
        start_s: table.number("start", seconds).unwrap_or(0.0),
        size_px: size.map_or([960, 540], |size| [size[0] as u32, size[1] as u32].map(|n| n.max(1))),
        color_by: table
            .choice("color_by", &ColorBy::ALL.map(|choice| (choice.name(), choice)))
            .unwrap_or_default(),
        camera: table.text("camera"),
        history_every_s: history_every.unwrap_or(duration_s / 500.0),
    }
}

fn read_color_range(table: &mut Table) -> Option<[f64; 2]> {
    if table.kind_of("color_range")? == Kind::Text {
        return table.choice("color_range", &[("found", None)])?;
    }
    let [low, high] = table.numbers("color_range", 2, 2, Quantity::drawable(""))?[..] else { return None };
    let name = table.name_of("color_range");
    if low >= high {
        table.problem("color_range", format!("the first of `{name}` must be below the second"));
    } else if low as f32 >= high as f32 {
        let message = format!("the ends of `{name}` must be further apart: colours have seven digits");
        table.problem("color_range", message);
    }
    Some([low, high])
}

fn read_cut(table: &mut Table) -> Option<CutPlane> {
    if table.kind_of("cut")? == Kind::Text {
        return table.choice("cut", &[("none", None)])?;
    }
    let mut cut = table.table("cut")?;
    cut.require("across", "the direction in which bodies are left out, as in `across = [0, 1, 0]`");
    // Both are read before either is judged: what was asked for is no unknown key.
    let (across, at_m) = (cut.vector("across", ""), cut.number("at", Quantity::drawable("m")));
    let plane = CutPlane { across: across?, at_m };
    if plane.normal().is_none() {
        let message = match plane.across == DVec3::ZERO {
            true => format!("`{}` must have a direction; three zeros have none", cut.name_of("across")),
            false => format!("`{}` names no direction: its numbers are too large", cut.name_of("across")),
        };
        cut.problem("across", message);
        return None;
    }
    Some(plane)
}
