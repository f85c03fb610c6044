//! All results in one table, compared with the last committed ones.
//!
//! Times of a shared machine say little by themselves, so that what is committed are ratios to the calibration loop of the
//! same run: time for each element, pair or pixel over that of one multiply-add, both in their best rounds.

use crate::machine::CALIBRATION_OPS;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The committed figures.
const COMMITTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/bench.json");
/// The benchmark that all others are compared with.
const CALIBRATION: &str = "calibration";
/// Ends of names that say how many threads worked.
const ONE_THREAD: &str = "/1-threads";
const TWO_THREADS: &str = "/2-threads";

/// One benchmark by size.
type Row = BTreeMap<u64, Time>;

/// Of one round, ns.
#[derive(Clone, Copy, Debug)]
struct Time {
    whole_ns: f64,
    /// For each of the things that the benchmark counts; the whole where it counts nothing.
    each_ns: f64,
}

/// Everything that was measured.
struct Measured {
    calibration_ns: f64,
    rows: BTreeMap<String, Row>,
}

/// Prints the table of what lies below `target/criterion`; with `update`, it becomes the committed one.
pub fn print(update: bool) -> Result<(), String> {
    let measured = Measured::read(&criterion_folder())?;
    let committed = std::fs::read_to_string(COMMITTED).ok();
    let committed: Value = committed.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
    println!("{}", measured.table(&committed["ratios"]));
    if committed["profile"] != profile() {
        println!("The committed figures are of the profile {}; this is {}.", committed["profile"], profile());
    }
    if update {
        let text =
            serde_json::to_string_pretty(&measured.to_json(&committed)).map_err(|error| error.to_string())?;
        std::fs::write(COMMITTED, text + "\n").map_err(|error| format!("{COMMITTED}: {error}"))?;
        println!("{COMMITTED} has these figures now.");
    }
    Ok(())
}

fn profile() -> &'static str {
    if cfg!(debug_assertions) { "dev" } else { "bench" }
}

/// `target/criterion`, found from where this program lies: `target/PROFILE/deps/`.
fn criterion_folder() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    program.ancestors().nth(3).unwrap_or(Path::new("target")).join("criterion")
}

impl Measured {
    /// Reads the results of the last run with calibration, and of runs of single benchmarks after it.
    fn read(folder: &Path) -> Result<Self, String> {
        let mut files = Vec::new();
        find_results(folder, &mut files);
        let results: Vec<(SystemTime, Value, f64)> =
            files.iter().filter_map(|path| read_result(path)).collect();
        let calibration = results.iter().find(|(_, id, _)| id["group_id"] == CALIBRATION);
        let Some((since, _, calibration_ns)) = calibration else {
            return Err(format!(
                "no calibration loop among the results in {}; run the whole of `cargo bench` once",
                folder.display()
            ));
        };
        let mut rows: BTreeMap<String, Row> = BTreeMap::new();
        for (at, id, time_ns) in &results {
            let (Some(function), Some(size)) = (id["function_id"].as_str(), id["value_str"].as_str()) else {
                continue;
            };
            let Ok(size) = size.parse::<u64>() else { continue };
            if at < since {
                continue;
            }
            let things = id["throughput"]["Elements"].as_u64().unwrap_or(1);
            let row = rows.entry(format!("{}/{function}", id["group_id"].as_str().unwrap_or_default()));
            let time = Time { whole_ns: *time_ns, each_ns: time_ns / things as f64 };
            row.or_default().insert(size, time);
        }
        Ok(Self { calibration_ns: calibration_ns / f64::from(CALIBRATION_OPS), rows })
    }

    fn table(&self, committed: &Value) -> String {
        let mut lines = vec![
            format!("One multiply-add of the calibration loop took {:.3} ns ({} profile).\n", self.calibration_ns, profile()),
            "| benchmark | size: ns for each | a round grows as size to the power | two threads | ratio to the committed |"
                .to_owned(),
            "|---|---|---|---|---|".to_owned(),
        ];
        for (name, row) in &self.rows {
            let times = row.iter().map(|(size, time)| format!("{size}: {}", short(time.each_ns)));
            lines.push(format!(
                "| `{name}` | {} | {} | {} | {} |",
                times.collect::<Vec<_>>().join(", "),
                power(row).map_or_else(String::new, |power| format!("{power:.2}")),
                self.speed_up(name).map_or_else(String::new, |times| format!("{times:.2} times as fast")),
                self.change(name, row, committed).map_or_else(String::new, |ratio| format!("{ratio:.2}")),
            ));
        }
        lines.join("\n")
    }

    /// How much sooner two threads are done with the largest body.
    fn speed_up(&self, name: &str) -> Option<f64> {
        let one = self.rows.get(&format!("{}{ONE_THREAD}", name.strip_suffix(TWO_THREADS)?))?;
        let (size, two) = self.rows.get(name)?.last_key_value()?;
        Some(one.get(size)?.whole_ns / two.whole_ns)
    }

    /// Geometric mean over the sizes of time over calibration, now over then.
    fn change(&self, name: &str, row: &Row, committed: &Value) -> Option<f64> {
        let logs: Vec<f64> = row
            .iter()
            .filter_map(|(size, time)| {
                let before = committed[name][size.to_string()].as_f64()?;
                Some((time.each_ns / self.calibration_ns / before).ln())
            })
            .collect();
        (!logs.is_empty()).then(|| (logs.iter().sum::<f64>() / logs.len() as f64).exp())
    }

    /// What was not measured this time keeps its committed figures.
    fn to_json(&self, committed: &Value) -> Value {
        let mut ratios = committed["ratios"].as_object().cloned().unwrap_or_default();
        for (name, row) in &self.rows {
            let of_row = row.iter().map(|(size, time)| {
                // Four digits are more than such a measurement has.
                let ratio: f64 =
                    format!("{:.3e}", time.each_ns / self.calibration_ns).parse().unwrap_or(f64::NAN);
                (size.to_string(), json!(ratio))
            });
            ratios.insert(name.clone(), Value::Object(of_row.collect()));
        }
        let sorted: BTreeMap<String, Value> = ratios.into_iter().collect();
        json!({
            "what": "time for each element, pair or pixel over one multiply-add of the calibration loop, by size",
            "profile": profile(),
            "ratios": Value::Object(sorted.into_iter().collect::<Map<_, _>>()),
        })
    }
}

/// The exponent of the power law through the times of whole rounds, by least squares of the logarithms.
fn power(row: &Row) -> Option<f64> {
    let points: Vec<(f64, f64)> =
        row.iter().map(|(size, time)| ((*size as f64).ln(), time.whole_ns.ln())).collect();
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
        / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
    (points.len() > 1).then_some(slope)
}

/// Folders `.../new` with an estimate in them.
fn find_results(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    for path in folders {
        if path.file_name().is_some_and(|name| name == "new") {
            found.push(path);
        } else {
            find_results(&path, found);
        }
    }
}

/// When a benchmark was measured, its identity, and the time of its best round, ns: whatever else the machine does only adds
/// to it.
fn read_result(folder: &Path) -> Option<(SystemTime, Value, f64)> {
    let read = |name: &str| -> Option<Value> {
        serde_json::from_slice(&std::fs::read(folder.join(name)).ok()?).ok()
    };
    let at = std::fs::metadata(folder.join("sample.json")).ok()?.modified().ok()?;
    let sample = read("sample.json")?;
    let rounds = sample["times"].as_array()?.iter().zip(sample["iters"].as_array()?);
    let times_ns = rounds.filter_map(|(time, count)| Some(time.as_f64()? / count.as_f64()?));
    let best_ns = times_ns.min_by(f64::total_cmp)?;
    Some((at, read("benchmark.json")?, best_ns))
}

/// Three digits.
fn short(time_ns: f64) -> String {
    let digits = (2 - time_ns.abs().max(1e-9).log10().floor() as i32).clamp(0, 4) as usize;
    format!("{time_ns:.digits$}")
}
