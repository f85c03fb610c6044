//! Small pieces that several panels share.

use super::style;
use crate::math::to_digits;
use crate::render::{parse_with_unit, short, what_to_type, with_unit};
use egui::style::ScrollAnimation;
use egui::{
    Align, CollapsingHeader, Color32, Context, DragValue, Id, Response, RichText, ScrollArea, Slider,
    SliderClamping, Ui, UiBuilder,
};
use std::cell::RefCell;
use std::ops::RangeInclusive;

/// A value on a slider.
pub struct Parameter {
    /// What it is.
    pub label: &'static str,
    /// Its unit; empty for pure numbers.
    pub unit: &'static str,
    /// What it does, as a hint.
    pub hint: &'static str,
    /// Range of the slider; typing may go no further.
    pub range: RangeInclusive<f64>,
    /// Whether equal ways on the slider are equal factors.
    pub is_logarithmic: bool,
}

impl Parameter {
    /// Shows the value with its unit above a slider; returns whether it was changed.
    pub fn show(&self, ui: &mut Ui, value: &mut f64) -> bool {
        let before = *value;
        ui.scope(|ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            let row = ui.horizontal(|ui| {
                ui.label(self.label).on_hover_text(self.hint);
                let right_to_left = egui::Layout::right_to_left(egui::Align::Center);
                ui.with_layout(right_to_left, |ui| self.typed(ui, value)).inner
            });
            ui.spacing_mut().slider_width = ui.available_width();
            // A scene may have what no slider offers: only what is done here keeps to the range.
            let slider = Slider::new(value, self.range.clone()).logarithmic(self.is_logarithmic);
            let slider = slider.clamping(SliderClamping::Edits);
            let smallest = (self.range.end() * 1e-6).max(*self.range.start());
            ui.add(slider.smallest_positive(smallest).show_value(false)).on_hover_text(self.hint);
            said_of(ui, row.inner.id, *value);
        });
        // A few digits are all that a slider can tell apart.
        if *value != before {
            *value = to_digits(*value, 4);
        }
        *value != before
    }

    fn typed(&self, ui: &mut Ui, value: &mut f64) -> Response {
        let speed = if self.is_logarithmic { value.abs().max(1e-12) * 0.01 } else { 0.002 };
        let number = Number { unit: self.unit, range: self.range.clone(), speed, text: with_its_unit };
        number.show(ui, value, ui.spacing().interact_size).on_hover_text("Drag, or click and type")
    }
}

/// A value that is dragged, or clicked on and typed, with its unit.
pub struct Number {
    /// Its unit; empty for pure numbers.
    pub unit: &'static str,
    /// Dragging and typing go no further; a value that is outside stays until then.
    pub range: RangeInclusive<f64>,
    /// Change for each point that the mouse moves.
    pub speed: f64,
    /// How it is written.
    pub text: fn(f64, &str) -> String,
}

impl Number {
    /// Shows it. What was typed acts when it is all there, and [`said_of`] says what was not understood of it.
    pub fn show(&self, ui: &mut Ui, value: &mut f64, size: egui::Vec2) -> Response {
        let (before, shown) = (*value, (self.text)(*value, self.unit));
        // What was read, and what is said of it.
        let read: RefCell<Option<(f64, Option<String>)>> = RefCell::default();
        let number = DragValue::new(value)
            .range(self.range.clone())
            .clamp_existing_to_range(false)
            .update_while_editing(false)
            .speed(self.speed)
            .min_size(size)
            .custom_formatter(|value, _| (self.text)(value, self.unit))
            .custom_parser(|text| {
                // Looked at and left as it was: it keeps all of its digits.
                let (value, said) = if text == shown { (before, None) } else { self.read(text, before) };
                *read.borrow_mut() = Some((value, said));
                Some(value)
            });
        let response = ui.add(number);
        if let Some((read, said)) = read.into_inner() {
            *value = read;
            let id = response.id.with("said");
            ui.data_mut(|data| {
                data.remove::<(String, f32)>(id);
                if let Some(said) = said {
                    data.insert_temp(id, (said, read as f32));
                }
            });
        }
        response
    }

    /// The value that was typed, within the range, and what is to be said of it; the one before where it is none.
    fn read(&self, text: &str, before: f64) -> (f64, Option<String>) {
        let Some(value) = parse_with_unit(text, self.unit) else {
            let text: String = text.trim().chars().take(MOST_REPEATED).collect();
            return (before, Some(format!("`{text}` is not understood: {}", what_to_type(self.unit))));
        };
        let (least, most) = (*self.range.start(), *self.range.end());
        let said = |end: f64, word: &str| Some(format!("{} is the {word} here", (self.text)(end, self.unit)));
        match value {
            value if value < least => (least, said(least, "least")),
            value if value > most => (most, said(most, "most")),
            value => (value, None),
        }
    }
}

/// Most characters of what was typed that are repeated.
const MOST_REPEATED: usize = 24;

/// Says what was wrong with what was typed into the [`Number`] of this id, as long as its value stays.
pub fn said_of(ui: &mut Ui, id: Id, value: f64) {
    let said = ui.data(|data| data.get_temp::<(String, f32)>(id.with("said")));
    if let Some((said, _)) = said.filter(|(_, at)| *at == value as f32) {
        caution(ui, &said);
    }
}

/// Small words about something that is not as it should be.
pub fn caution(ui: &mut Ui, text: &str) {
    let (_, color) = style::warning_colors(ui.visuals().dark_mode);
    ui.label(RichText::new(text).small().color(color));
}

/// A measured value with its unit, short whatever its size: a run that blows up must not blow up the panels.
#[must_use]
pub fn measured(value: f64, unit: &str) -> String {
    let is_usual = value == 0.0 || (1e-12..1e15).contains(&value.abs());
    if is_usual { with_unit(value, unit) } else { format!("{value:.1e} {unit}") }
}

/// A mass as people say it.
#[must_use]
pub fn mass_text(mass_kg: f64) -> String {
    if mass_kg < 1.0 { measured(1e3 * mass_kg, "g") } else { with_its_unit(mass_kg, "kg") }
}

/// A value as people write it: kilograms and rates take no further prefix.
pub fn with_its_unit(value: f64, unit: &str) -> String {
    match unit {
        "" if value != 0.0 && value.abs() < 1e-3 => format!("{value:.1e}"),
        "" => short(value),
        "°" => format!("{}°", short(value)),
        _ if unit.starts_with("kg") || unit.starts_with("1/") => format!("{} {unit}", short(value)),
        _ => with_unit(value, unit),
    }
}

/// The scrolled inside of a panel at the side, or of the gallery; its bar has a margin of its own.
pub fn side_scroll() -> ScrollArea {
    let bar = egui::Margin { right: 10, ..egui::Margin::ZERO };
    ScrollArea::vertical().auto_shrink(false).content_margin(bar)
}

/// Names of the sections that are open at first; none: all.
#[derive(Clone, Copy, Default)]
struct OpenAtFirst(Option<&'static [&'static str]>);

/// Has only these sections open at first. Call it before the first layout.
pub fn open_only(context: &Context, titles: Option<&'static [&'static str]>) {
    context.data_mut(|data| data.insert_temp(Id::NULL, OpenAtFirst(titles)));
}

/// A section that can be folded.
pub fn section(ui: &mut Ui, title: &str, body: impl FnOnce(&mut Ui)) {
    let OpenAtFirst(open) = ui.data(|data| data.get_temp(Id::NULL)).unwrap_or_default();
    let is_open = open.is_none_or(|open| open.contains(&title));
    CollapsingHeader::new(RichText::new(title).strong()).default_open(is_open).show_unindented(ui, |ui| {
        ui.add_space(2.0);
        steady(ui, title, body);
        ui.add_space(8.0);
    });
}

/// What keeps the keyboard and the mouse whatever comes and goes before it: egui numbers widgets through, and one that is
/// numbered anew loses what is being typed, or the drag of its slider.
pub fn steady(ui: &mut Ui, name: &str, body: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().scope_id(Id::unique(("steady", name))), body);
}

/// When changes act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acts {
    /// From the next step on.
    AtOnce,
    /// After a reset.
    OnReset,
}

/// Says when changes act.
pub fn badge(ui: &mut Ui, acts: Acts) -> Response {
    let (text, hint) = match acts {
        Acts::AtOnce => ("acts at once", "Changes act from the next step on"),
        Acts::OnReset => ("acts on reset", "Changes act when the scene starts anew: press R"),
    };
    pill(ui, text, ui.visuals().faint_bg_color, ui.visuals().weak_text_color()).on_hover_text(hint)
}

/// Small text on a rounded background.
pub fn pill(ui: &mut Ui, text: &str, background: Color32, color: Color32) -> Response {
    let frame =
        egui::Frame::new().fill(background).corner_radius(8).inner_margin(egui::Margin::symmetric(7, 1));
    frame.show(ui, |ui| ui.label(RichText::new(text).small().color(color))).response
}

/// An entry of a list of choices. A list that opens has the chosen one in sight, wherever it was left the last time.
pub fn entry<T: PartialEq>(ui: &mut Ui, chosen: &mut T, value: T, text: &str) -> Response {
    let is_chosen = *chosen == value;
    let response = ui.selectable_value(chosen, value, text);
    // The first time it is laid out.
    if is_chosen && ui.is_sizing_pass() {
        response.scroll_to_me_animation(Some(Align::Center), ScrollAnimation::none());
    }
    response
}

/// Height up to which lists show all of their entries, points.
pub const LIST_HEIGHT: f32 = 320.0;

/// A button that asks to be pressed.
pub fn primary_button(ui: &mut Ui, text: &str) -> Response {
    let button = egui::Button::new(RichText::new(text).color(Color32::WHITE)).fill(style::accent());
    ui.add(button)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_can_be_typed_back() {
        for value in [1.5e7, 210e9, 0.6e6, 7850.0, 0.0] {
            assert_eq!(parse_with_unit(&with_unit(value, "Pa"), "Pa"), Some(value));
        }
    }

    #[test]
    fn masses_are_told_as_people_do() {
        assert_eq!([0.0125, 0.9, 1.25, 5400.0].map(mass_text), ["12.5 g", "900 g", "1.25 kg", "5400 kg"]);
    }

    #[test]
    fn measured_values_stay_short() {
        for value in [0.0, -1.2345e-5, 9.99e14, 2.3e180, -f64::MAX, 1e-300, f64::INFINITY, f64::NAN] {
            let text = measured(value, "J");
            assert!(text.chars().count() <= 12, "{text}");
        }
    }

    #[test]
    fn a_list_opens_where_the_chosen_entry_is() {
        use egui_kittest::kittest::Queryable as _;
        let mut window = egui_kittest::Harness::builder().with_accessibility_check(false).build_ui_state(
            |ui, chosen: &mut usize| {
                let list = egui::ComboBox::from_id_salt("list").height(90.0).selected_text("the list");
                list.show_ui(ui, |ui| (0..30).for_each(|k| drop(entry(ui, chosen, k, &format!("no. {k}")))));
            },
            25,
        );
        for chosen in [25, 3] {
            *window.state_mut() = chosen;
            window.get_by_value("the list").click();
            (0..4).for_each(|_| window.step());
            let button = window.get_by_value("the list").rect();
            let entry = window.get_by_label(&format!("no. {chosen}")).rect();
            let below = entry.center().y - button.bottom();
            assert!((0.0..110.0).contains(&below), "{chosen}: {entry:?} below {button:?}");
            window.key_press(egui::Key::Escape);
            (0..4).for_each(|_| window.step());
        }
    }

    /// `10 ft` into a speed was 10 m/s, and what was too much became the most without a word.
    #[test]
    fn what_is_typed_is_taken_or_told() {
        use egui_kittest::kittest::Queryable as _;
        const SPEED: Parameter =
            Parameter { label: "Speed", unit: "m/s", hint: "", range: 0.1..=500.0, is_logarithmic: true };
        let mut window = egui_kittest::Harness::builder().with_accessibility_check(false).build_ui_state(
            |ui, value: &mut f64| {
                SPEED.show(ui, value);
                drop(ui.button("beside"));
            },
            8.123_456,
        );
        let cases = [
            ("36 km/h", 10.0, None),
            ("10 ft", 10.0, Some("`10 ft` is not understood: type a number, or one with m/s, mm/s or km/h")),
            ("20 cm/s", 0.2, None),
            ("2000", 500.0, Some("500 m/s is the most here")),
            ("abc", 500.0, Some("`abc` is not understood: type a number, or one with m/s, mm/s or km/h")),
            ("0", 0.1, Some("100 mm/s is the least here")),
            ("100 mm/s", 0.1, None),
        ];
        let click = |window: &mut egui_kittest::Harness<'_, f64>| {
            window.get_by_role(egui::accesskit::Role::SpinButton).click();
            (0..3).for_each(|_| window.step());
        };
        // Looked at only.
        click(&mut window);
        window.get_by_label("beside").click();
        (0..3).for_each(|_| window.step());
        assert_eq!(*window.state(), 8.123_456);
        for (text, value, said) in cases {
            click(&mut window);
            window.event(egui::Event::Text(text.to_owned()));
            (0..2).for_each(|_| window.step());
            window.key_press(egui::Key::Enter);
            (0..3).for_each(|_| window.step());
            assert_eq!(*window.state(), value, "{text}");
            for told in ["not understood", "is the "] {
                let is_told = window.query_by_label_contains(told).is_some();
                assert_eq!(is_told, said.is_some_and(|said| said.contains(told)), "{text}: {told}");
            }
            assert!(said.is_none_or(|said| window.query_by_label(said).is_some()), "{text}");
        }
    }
}
