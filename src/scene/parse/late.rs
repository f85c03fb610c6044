//! What happens on the way: removals, changes of contact, pulls.

use super::super::description::{GROUND, LateContact, Removal};
use super::super::quantity::Quantity;
use super::super::reader::{Kind, Table};
use super::read_friction;
use super::settings::{read_method, read_pair};
use crate::sim::{ContactChange, PathPoint, Pull};
use glam::DVec3;

/// Time in which a pulled body follows when the scene does not say, s.
const FOLLOW_S: f64 = 0.05;
/// Keys that only mean something beside `method`.
const OF_METHOD: [&str; 4] = ["passes", "tolerance", "impact", "penalty_stiffness"];

pub(super) fn read_removal(mut table: Table) -> Removal {
    Removal {
        body: table.required_text("body"),
        at_s: table.required_number("at", Quantity::not_negative("s")),
    }
}

pub(super) fn read_contact_change(mut table: Table) -> LateContact {
    let at_s = table.required_number("at", Quantity::not_negative("s"));
    let ground = table.number("ground_friction", Quantity::not_negative(""));
    let rest_speed_m_s = match table.kind_of("rest_speed") {
        None => None,
        Some(Kind::Text) => table.choice("rest_speed", &[("derived", None)]),
        Some(_) => table.number("rest_speed", Quantity::not_negative("m/s")).map(Some),
    };
    let has_method = table.has("method");
    if !has_method && let Some(key) = OF_METHOD.into_iter().find(|key| table.has(key)) {
        table.problem(key, format!("`{}` needs `method` beside it", table.name_of(key)));
    }
    let method = read_method(&mut table);
    let change = ContactChange {
        friction_coefficient: read_friction(&mut table),
        body_friction: ground.map(|friction| (GROUND.to_owned(), friction)).into_iter().collect(),
        pairs: table.tables("pairs").into_iter().filter_map(read_pair).collect(),
        self_collision: table.flag("self_collision"),
        rest_speed_m_s,
        method: has_method.then_some(method),
    };
    LateContact { at_s, change }
}

pub(super) fn read_pull(mut table: Table) -> Pull {
    table.require("at", "the grabbed point, `[x, y, z]`, where it is when the body comes in");
    table.require("path", "where to, as in `path = [{ time = 0.1, point = [0, 0, 1] }]`");
    let path: Vec<PathPoint> = table.tables("path").into_iter().map(read_point).collect();
    if table.has("path") && path.is_empty() {
        table.problem("path", format!("`{}` needs at least one point", table.name_of("path")));
    }
    if path.windows(2).any(|pair| pair[1].time_s <= pair[0].time_s) {
        table.problem("path", format!("the times of `{}` must ascend", table.name_of("path")));
    }
    let [begins_s, ends_s] = [path.first(), path.last()].map(|point| point.map_or(0.0, |point| point.time_s));
    let until_s = table.number("until", Quantity::not_negative("s")).unwrap_or(ends_s);
    if until_s <= begins_s && !path.is_empty() {
        let message = format!(
            "the body is grabbed at {begins_s} s and let go at {until_s} s; give `{}` a second point, or a later `until`",
            table.name_of("path")
        );
        table.problem(if table.has("until") { "until" } else { "path" }, message);
    }
    Pull {
        body: table.required_text("body"),
        at_m: table.vector("at", "m").unwrap_or(DVec3::ZERO),
        follow_s: table.number("follow", Quantity::positive("s")).unwrap_or(FOLLOW_S),
        path,
        until_s,
    }
}

fn read_point(mut table: Table) -> PathPoint {
    let time_s = table.required_number("time", Quantity::not_negative("s"));
    table.require("point", "`[x, y, z]`, m");
    PathPoint { time_s, point_m: table.vector("point", "m").unwrap_or(DVec3::ZERO) }
}
