//! `cargo bench`: how long the inner loops take. One file per topic; `cargo bench -- elastic` runs one of them.

mod elastic_step;

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

/// A fixed piece of arithmetic, one million dependent multiply-adds. Dividing by it makes runs on a busy
/// or another machine comparable.
fn calibration(criterion: &mut Criterion) {
    criterion.bench_function("calibration", |bencher| {
        bencher.iter(|| (0..1_000_000).fold(black_box(1.0), |x: f64, _| x * 0.999_999 + 1e-6));
    });
}

criterion_group!(benches, calibration, elastic_step::elastic_step);
criterion_main!(benches);
