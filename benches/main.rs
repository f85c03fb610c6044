//! `cargo bench`: how long the inner loops take. One file per topic; `cargo bench -- elastic` runs one of them.

mod contact_step;
mod elastic_step;
mod fracture_step;
mod machine;

use criterion::{criterion_group, criterion_main};

criterion_group!(
    benches,
    machine::arithmetic,
    machine::memory,
    elastic_step::elastic_step,
    contact_step::contact_step,
    contact_step::world_step,
    fracture_step::fracture_step
);
criterion_main!(benches);
