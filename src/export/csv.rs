//! `history.csv`: the balances over time, one row a sampled step.
//!
//! | column | meaning |
//! |---|---|
//! | `time_s`, `step_s` | simulated time and length of the last step, s |
//! | `stage` | `free`, `vibrating`, `beginning`, `collision`, `end` or `resting` |
//! | `kinetic_j` .. `external_work_j` | energies and work since the start, J |
//! | `px`, `py`, `pz` | linear momentum, kg m/s |
//! | `lx`, `ly`, `lz` | angular momentum about the world's origin, kg m2/s |
//! | `contact_force_n`, `contact_pairs` | sum of the contact forces' lengths in the last step, N, and how many pairs press |
//! | `max_penetration_m` | deepest penetration at the end of the step, m |
//! | `elements`, `nodes`, `fragments` | counts |
//! | `crack_area_m2` | area of crack faces, one side counted, m2 |
//!
//! Numbers are printed with the fewest digits that read back as the same `f64`, so that equal
//! runs give equal bytes.

use super::ExportError;
use crate::sim::Sample;
use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The columns, in order.
pub const COLUMNS: [&str; 21] = [
    "time_s",
    "step_s",
    "stage",
    "kinetic_j",
    "strain_j",
    "potential_j",
    "dissipated_j",
    "external_work_j",
    "px",
    "py",
    "pz",
    "lx",
    "ly",
    "lz",
    "contact_force_n",
    "contact_pairs",
    "max_penetration_m",
    "elements",
    "nodes",
    "fragments",
    "crack_area_m2",
];

/// Writes `history.csv` row by row.
#[derive(Debug)]
pub struct HistoryWriter {
    file: File,
    path: PathBuf,
    line: String,
    rows: u64,
}

impl HistoryWriter {
    /// Creates the file, replacing an older one, and writes the header.
    ///
    /// # Errors
    /// [`ExportError::Io`] when the file cannot be created.
    pub fn create(path: &Path) -> Result<Self, ExportError> {
        let mut writer = Self {
            file: File::create(path).map_err(ExportError::io("create", path))?,
            path: path.to_path_buf(),
            line: COLUMNS.join(","),
            rows: 0,
        };
        writer.write_line()?;
        Ok(writer)
    }

    /// Appends one row. The whole line goes to the system at once, so a reader never sees half.
    ///
    /// # Errors
    /// [`ExportError::Io`] when the row cannot be written.
    pub fn write(&mut self, sample: &Sample) -> Result<(), ExportError> {
        self.line.clear();
        format_row(&mut self.line, sample);
        self.write_line()?;
        self.rows += 1;
        Ok(())
    }

    /// Rows written, without the header.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    fn write_line(&mut self) -> Result<(), ExportError> {
        self.line.push('\n');
        self.file.write_all(self.line.as_bytes()).map_err(ExportError::io("write", &self.path))
    }
}

/// Appends the row of `sample` to `line`, without the line end.
fn format_row(line: &mut String, sample: &Sample) {
    let step = &sample.step;
    number(line, step.time_s);
    number(line, step.step_s);
    text(line, step.stage.name());
    for energy_j in
        [sample.kinetic_j, sample.strain_j, sample.potential_j, sample.dissipated_j, sample.external_work_j]
    {
        number(line, energy_j);
    }
    for momentum in [sample.linear_momentum_kg_m_s, sample.angular_momentum_kg_m2_s] {
        momentum.to_array().into_iter().for_each(|p| number(line, p));
    }
    number(line, step.contact_force_n);
    text(line, step.contact_pairs);
    number(line, step.max_penetration_m);
    text(line, sample.elements);
    text(line, sample.nodes);
    text(line, sample.fragments);
    number(line, sample.crack_area_m2);
}

/// Appends a field with the fewest digits that read back as the same number.
fn number(line: &mut String, value: f64) {
    // `Debug` of f64 is the shortest round trip and switches to exponents for tiny and huge values.
    // Adding zero turns -0.0 into 0.0.
    text(line, format_args!("{:?}", value + 0.0));
}

fn text(line: &mut String, value: impl std::fmt::Display) {
    let comma = if line.is_empty() { "" } else { "," };
    write!(line, "{comma}{value}").expect("writing to a String cannot fail");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{Stage, StepReport};
    use glam::DVec3;

    fn sample() -> Sample {
        Sample {
            step: StepReport {
                time_s: 0.1 + 0.2,
                step_s: 1.0 / 3.0e7,
                stage: Stage::Collision,
                contact_pairs: 7,
                contact_force_n: 1.0,
                max_penetration_m: 2.0,
                ..StepReport::default()
            },
            kinetic_j: 3.0,
            strain_j: 4.0,
            potential_j: 5.0,
            dissipated_j: 6.0,
            external_work_j: 7.0,
            linear_momentum_kg_m_s: DVec3::new(-0.0, 8.0, 9.0),
            angular_momentum_kg_m2_s: DVec3::new(10.0, 11.0, 12.0),
            elements: 13,
            nodes: 14,
            fragments: 15,
            crack_area_m2: 1.6e17,
        }
    }

    #[test]
    fn every_column_holds_its_own_value() {
        let mut line = String::new();
        format_row(&mut line, &sample());
        assert_eq!(
            line,
            "0.30000000000000004,3.3333333333333334e-8,collision,3.0,4.0,5.0,6.0,7.0,\
             0.0,8.0,9.0,10.0,11.0,12.0,1.0,7,2.0,13,14,15,1.6e17"
        );
        assert_eq!(line.split(',').count(), COLUMNS.len());
    }

    #[test]
    fn numbers_read_back_exactly() {
        for value in [f64::MIN_POSITIVE, 5e-324, f64::MAX, -1.0 / 3.0, 0.1] {
            let mut line = String::new();
            number(&mut line, value);
            assert_eq!(line.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    #[test]
    fn rows_are_in_the_file_before_the_writer_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut writer = HistoryWriter::create(&path).unwrap();
        writer.write(&sample()).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text.lines().count(), 2);
        assert!(text.starts_with("time_s,step_s,stage,kinetic_j,") && text.ends_with('\n'));
        assert_eq!(writer.rows(), 1);
    }
}
