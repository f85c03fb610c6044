//! `cargo bench`: how long the inner loops take, and a table of all of it at the end. One file per topic;
//! `cargo bench -- elastic` runs one of them.
//!
//! `cargo bench -- --table` prints the table of what was measured last; `cargo bench -- --update-table` commits its figures
//! to `assets/bench.json`, with which later tables are compared.

mod contact_step;
mod drawing;
mod elastic_step;
mod fracture_step;
mod machine;
mod table;

use criterion::{Criterion, criterion_group};

criterion_group!(
    benches,
    machine::arithmetic,
    machine::memory,
    elastic_step::elastic_step,
    contact_step::contact_step,
    contact_step::world_step,
    fracture_step::fracture_step,
    drawing::publish,
    drawing::draw
);

fn main() {
    let is_asked = |word: &str| std::env::args().any(|argument| argument == word);
    let update = is_asked("--update-table");
    let is_asked_for_table = update || is_asked("--table");
    if !is_asked_for_table {
        benches();
        Criterion::default().configure_from_args().final_summary();
    }
    if is_asked("--list") {
        return;
    }
    if let Err(reason) = table::print(update) {
        eprintln!("no table: {reason}");
        // A part can be measured without one.
        std::process::exit(i32::from(is_asked_for_table));
    }
}
