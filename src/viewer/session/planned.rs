//! What a scene has in store by itself: marks for the timeline before time gets there.

use super::super::recording::{Mark, MarkKind};
use crate::scene::SceneDescription;
use std::sync::Arc;

/// Most marks: more could not be told apart.
const MOST_MARKS: usize = 400;

/// Who comes in and goes out, is pulled, and when contact changes, in the order of time. What a scene plans for after its end
/// is a slip that it was warned of; only where somebody has been there already (`is_repeated`) it will come.
pub(super) fn marks(scene: &SceneDescription, is_repeated: bool) -> Arc<[Mark]> {
    let end_s = if is_repeated { f64::MAX } else { scene.duration_s };
    let mark = |time_s: f64, text: String| Mark { time_s, kind: MarkKind::Edit, text, edits: 0 };
    let entrances = scene.bodies.iter().filter_map(|body| Some((body.enters_s?, &body.name)));
    let entrances = entrances.map(|(at_s, name)| mark(at_s, format!("{name} comes in")));
    let removals = scene.removals.iter().map(|gone| mark(gone.at_s, format!("{} is taken out", gone.body)));
    let pulls = scene.pulls.iter().map(|pull| mark(pull.begins_s(), format!("{} is pulled", pull.body)));
    let contact = scene.contact_changes.iter().map(|change| mark(change.at_s, "contact changes".to_owned()));
    let all = entrances.chain(removals).chain(pulls).chain(contact);
    let mut marks: Vec<Mark> = all.filter(|mark| mark.time_s <= end_s).take(MOST_MARKS).collect();
    marks.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    marks.into()
}
