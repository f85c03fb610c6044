//! The corpus of the fuzz targets and seeded mutations of it, through the same entries, so that every test run fuzzes a
//! little. `HAMMERFALL_FUZZ_ROUNDS=100000` fuzzes for longer.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Feeds `entry` with every file of a corpus and with `rounds` mutations of them.
pub fn run(corpus: &str, rounds: u64, entry: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(corpus);
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().path()).collect();
    paths.sort();
    let files: Vec<Vec<u8>> = paths.iter().map(|path| std::fs::read(path).unwrap()).collect();
    assert!(files.len() > 5, "a corpus of {} files", files.len());
    for (path, data) in paths.iter().zip(&files) {
        feed(entry, data, &path.display().to_string());
    }
    let asked = std::env::var("HAMMERFALL_FUZZ_ROUNDS")
        .ok()
        .map(|text| text.parse().expect("HAMMERFALL_FUZZ_ROUNDS is a whole number"));
    for round in 0..asked.unwrap_or(rounds) {
        let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ (round + 1).wrapping_mul(0xd129_0d3f_58f1_e1a5));
        feed(entry, &mutated(&files, &mut random), &format!("round {round} of {corpus}"));
    }
}

/// What makes the entry panic is kept as a file, to be looked at and added to the corpus.
fn feed(entry: fn(&[u8]), data: &[u8], name: &str) {
    if let Err(panic) = catch_unwind(AssertUnwindSafe(|| entry(data))) {
        let kept =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzzed-{}", name.replace(['/', ' '], "-")));
        std::fs::write(&kept, data).unwrap();
        eprintln!("{name} panics; its bytes are in {}", kept.display());
        std::panic::resume_unwind(panic);
    }
}

/// Xorshift: the same sequence on every machine. The seed must not be zero.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 16) % limit.max(1) as u64) as usize
    }

    fn range(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        start..start + self.below((length - start).min(64) + 1)
    }
}

/// Numbers that break counts, indices and arithmetic.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1",
    "3",
    "255",
    "65536",
    "2147483647",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "1e308",
    "-1e-320",
    "nan",
    "inf",
];

/// One of the files with one to four things changed.
fn mutated(files: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut data = files[random.below(files.len())].clone();
    for _ in 0..=random.below(4) {
        change(&mut data, &files[random.below(files.len())], random);
    }
    data
}

fn change(data: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    match random.below(9) {
        0 => data.truncate(random.below(data.len() + 1)),
        1 if !data.is_empty() => {
            let at = random.below(data.len());
            data[at] ^= 1 << random.below(8);
        }
        2 => drop(data.drain(random.range(data.len()))),
        3 => {
            let copied = data[random.range(data.len())].to_vec();
            let at = random.below(data.len() + 1);
            data.splice(at..at, copied);
        }
        4 => {
            let copied = other[random.range(other.len())].to_vec();
            let at = random.below(data.len() + 1);
            data.splice(at..at, copied);
        }
        5 => binary_number(data, random),
        6 => double_line(data, random),
        _ => text_number(data, random),
    }
}

/// Puts a number in the place of four or eight bytes.
fn binary_number(data: &mut [u8], random: &mut Random) {
    let number = [0, 1, -1, i64::MAX, i64::MIN, 1 << 31, 1 << 40, 7][random.below(8)];
    let bytes = if random.below(2) == 0 { number.to_le_bytes() } else { number.to_be_bytes() };
    let length = [4, 8][random.below(2)];
    if data.len() >= length {
        let at = random.below(data.len() - length + 1);
        data[at..at + length].copy_from_slice(&bytes[..length]);
    }
}

/// Puts a number in the place of one that is written as text.
fn text_number(data: &mut Vec<u8>, random: &mut Random) {
    let is_part = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-');
    let starts: Vec<usize> = (0..data.len())
        .filter(|at| data[*at].is_ascii_digit() && (*at == 0 || !is_part(data[*at - 1])))
        .collect();
    if starts.is_empty() {
        return;
    }
    let start = starts[random.below(starts.len())];
    let length = data[start..].iter().position(|byte| !is_part(*byte)).unwrap_or(data.len() - start);
    let number = NUMBERS[random.below(NUMBERS.len())];
    data.splice(start..start + length, number.bytes());
}

/// Says a line twice, or moves it to another place.
fn double_line(data: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<&[u8]> = data.split_inclusive(|byte| *byte == b'\n').collect();
    if lines.is_empty() {
        return;
    }
    let from = random.below(lines.len());
    let line = if random.below(2) == 0 { lines[from] } else { lines.remove(from) };
    lines.insert(random.below(lines.len() + 1), line);
    *data = lines.concat();
}
