//! What the machine can do at the moment: to be compared with, on a busy or on another machine.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, SamplingMode, Throughput};
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Duration;

/// Numbers that are read: far more than caches of one's own hold.
const NUMBERS: usize = 16 << 20;
/// Numbers that one task reads.
const TASK_NUMBERS: usize = 1 << 16;

/// Multiply-adds of one round of the calibration.
pub const CALIBRATION_OPS: u32 = 100_000;

/// Many short samples of as many rounds each: on a shared machine the best of them had a core to itself.
pub fn sample_shortly(group: &mut BenchmarkGroup<WallTime>) {
    group.sampling_mode(SamplingMode::Flat).sample_size(60);
    group.measurement_time(Duration::from_millis(150)).warm_up_time(Duration::from_millis(200));
}

/// A fixed piece of arithmetic, dependent multiply-adds.
pub fn arithmetic(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("calibration");
    sample_shortly(&mut group);
    group.bench_function("multiply-adds", |bencher| {
        bencher.iter(|| (0..CALIBRATION_OPS).fold(black_box(1.0), |x: f64, _| x * 0.999_999 + 1e-6));
    });
    group.finish();
}

/// Reads 128 MiB from one end to the other: the rate at which memory delivers.
pub fn memory(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("memory");
    group.sample_size(10);
    let numbers: Vec<u64> = (0..NUMBERS as u64).collect();
    group.throughput(Throughput::Bytes(8 * NUMBERS as u64));
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("threads can be started");
        let sum = |task: &[u64]| task.iter().fold(0_u64, |sum, x| sum.wrapping_add(*x));
        let read = || numbers.par_chunks(TASK_NUMBERS).map(sum).reduce(|| 0, u64::wrapping_add);
        let id = BenchmarkId::new("read", format!("{threads}-threads"));
        group.bench_function(id, |bencher| pool.install(|| bencher.iter(read)));
    }
    group.finish();
}
