//! Curves for the report: plain data.

/// How an axis is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By powers of ten; points that are not above zero are left out.
    Log,
}

/// A curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Its name in the legend and in the CSV file.
    pub name: String,
    /// Points (x, y) in the units of the axes.
    pub points: Vec<[f64; 2]>,
}

/// Some curves with common axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Name of its CSV file, without ending.
    pub id: &'static str,
    /// Title.
    pub title: &'static str,
    /// Names of the axes, with their units.
    pub labels: [&'static str; 2],
    /// How the axes are divided.
    pub scales: [Scale; 2],
    /// The curves.
    pub curves: Vec<Curve>,
}

impl Plot {
    /// A plot without curves, its axes linear.
    #[must_use]
    pub fn new(id: &'static str, title: &'static str, labels: [&'static str; 2]) -> Self {
        Self { id, title, labels, ..Self::default() }
    }

    /// With another curve.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        self.curves.push(Curve { name: name.into(), points });
        self
    }

    /// With axes divided so.
    #[must_use]
    pub fn scaled(self, scales: [Scale; 2]) -> Self {
        Self { scales, ..self }
    }
}
