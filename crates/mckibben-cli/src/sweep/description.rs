//! Stand-in for the `[sweep]` reader of the scenario crate with its interface: grids only; to be deleted with it.
#![allow(missing_docs)]

use mckibben_scenario::keys::{Kind, key_at};
use mckibben_scenario::{Document, Scenario, quantity};

#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Quantity {
    Length,
    Velocity,
    Pressure,
    AirMass,
    Temperature,
    Tension,
    MassFlow,
    Air,
}
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Statistic {
    Final,
    Mean,
    Min,
    Max,
    Ripple,
    SettlingTime,
    Overshoot,
    Peak,
    Used,
}
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Reduction {
    pub quantity: Quantity,
    pub statistic: Statistic,
}
const Q: [(&str, &str, &str, Quantity); 8] = [
    ("length", "m", "m", Quantity::Length),
    ("velocity", "m/s", "m_s", Quantity::Velocity),
    ("pressure", "Pa", "pa", Quantity::Pressure),
    ("air_mass", "kg", "kg", Quantity::AirMass),
    ("temperature", "K", "k", Quantity::Temperature),
    ("tension", "N", "n", Quantity::Tension),
    ("mass_flow", "kg/s", "kg_s", Quantity::MassFlow),
    ("air", "kg", "kg", Quantity::Air),
];
const S: [(&str, Statistic); 9] = [
    ("final", Statistic::Final),
    ("mean", Statistic::Mean),
    ("min", Statistic::Min),
    ("max", Statistic::Max),
    ("ripple", Statistic::Ripple),
    ("settling_time", Statistic::SettlingTime),
    ("overshoot", Statistic::Overshoot),
    ("peak", Statistic::Peak),
    ("used", Statistic::Used),
];
impl Reduction {
    fn parse(text: &str) -> Self {
        let (q, s) = text.split_once('.').unwrap();
        Self { quantity: Q.iter().find(|x| x.0 == q).unwrap().3, statistic: S.iter().find(|x| x.0 == s).unwrap().1 }
    }
    fn q(&self) -> (&'static str, &'static str, &'static str) {
        let x = Q.iter().find(|x| x.3 == self.quantity).unwrap();
        (x.0, x.1, x.2)
    }
    pub fn name(&self) -> String {
        format!("{}.{}", self.q().0, S.iter().find(|x| x.1 == self.statistic).unwrap().0)
    }
    pub fn unit(&self) -> &'static str {
        match self.statistic {
            Statistic::SettlingTime => "s",
            Statistic::Overshoot => "",
            _ => self.q().1,
        }
    }
    pub fn column(&self) -> String {
        let suffix = match self.statistic {
            Statistic::SettlingTime => "_s".to_owned(),
            Statistic::Overshoot => String::new(),
            _ => format!("_{}", self.q().2),
        };
        format!("{}{suffix}", self.name().replace('.', "_"))
    }
}
#[derive(Clone, Debug)]
pub enum AxisKind {
    Quantity { unit: String, column: String },
    Word { column: String },
}
#[derive(Clone, Debug)]
pub struct Axis {
    pub path: String,
    pub kind: AxisKind,
    texts: Vec<String>,
    numbers: Vec<f64>,
}
#[derive(Clone, Copy, Debug)]
pub enum AxisValue<'a> {
    Number(f64),
    Word(&'a str),
}
#[derive(Clone, Debug)]
pub enum Record {
    Reductions(Vec<Reduction>),
    Samples(Vec<f64>),
    Trajectories,
}
#[derive(Clone, Debug)]
pub struct Sweep {
    axes: Vec<Axis>,
    record: Record,
    part_rows: u64,
    document: Document,
    rows: u64,
}
impl Sweep {
    pub fn of(document: &Document) -> Option<Self> {
        let table: toml::Table = document.source().text().parse().unwrap();
        let sweep = table.get("sweep")?.as_table()?;
        let texts = |v: Option<&toml::Value>| -> Vec<String> {
            v.and_then(|v| v.as_array())
                .map(|a| a.iter().map(|v| v.as_str().map_or(v.to_string(), str::to_owned)).collect())
                .unwrap_or_default()
        };
        let mut axes = Vec::new();
        for (path, value) in sweep["vary"].as_table()? {
            let texts = texts(Some(value));
            let (kind, numbers) = match key_at(path)?.kind {
                Kind::Quantity(p) => (
                    AxisKind::Quantity {
                        unit: p.unit.to_owned(),
                        column: format!(
                            "{}{}",
                            path.replace('.', "_"),
                            if p.unit.is_empty() {
                                String::new()
                            } else {
                                format!("_{}", p.unit.to_lowercase().replace(['*', '/', '^'], "_"))
                            }
                        ),
                    },
                    texts
                        .iter()
                        .map(|t| quantity::parse(t).map(|q| q.value).unwrap_or_else(|_| t.parse().unwrap()))
                        .collect(),
                ),
                _ => (AxisKind::Word { column: path.replace('.', "_") }, Vec::new()),
            };
            axes.push(Axis { path: path.clone(), kind, texts, numbers });
        }
        let rows = axes.iter().map(|a| a.texts.len() as u64).product();
        let record = match sweep.get("record").and_then(|v| v.as_str()) {
            Some("samples") => Record::Samples(
                texts(sweep.get("sample_times")).iter().map(|t| quantity::parse(t).unwrap().value).collect(),
            ),
            Some("trajectories") => Record::Trajectories,
            _ => Record::Reductions(texts(sweep.get("reductions")).iter().map(|t| Reduction::parse(t)).collect()),
        };
        let part_rows = sweep.get("part_rows").and_then(|v| v.as_integer()).unwrap_or(4096) as u64;
        let mut document = document.clone();
        document.remove("sweep");
        Some(Self { axes, record, part_rows, document, rows })
    }
    pub fn rows(&self) -> u64 {
        self.rows
    }
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }
    fn at(&self, axis: usize, row: u64) -> usize {
        let after: u64 = self.axes[axis + 1..].iter().map(|a| a.texts.len() as u64).product();
        (row / after % self.axes[axis].texts.len() as u64) as usize
    }
    pub fn value(&self, axis: usize, row: u64) -> AxisValue<'_> {
        let at = self.at(axis, row);
        self.axes[axis].numbers.get(at).map_or(AxisValue::Word(&self.axes[axis].texts[at]), |n| AxisValue::Number(*n))
    }
    pub fn record(&self) -> &Record {
        &self.record
    }
    pub fn part_rows(&self) -> u64 {
        self.part_rows
    }
    pub fn seed(&self) -> u64 {
        0
    }
    pub fn scenario(&self, row: u64) -> Result<Scenario, mckibben_scenario::Diagnostics> {
        let mut document = self.document.clone();
        for (i, axis) in self.axes.iter().enumerate() {
            let text = &axis.texts[self.at(i, row)];
            if text.parse::<f64>().is_ok() {
                document.set_text(&axis.path, text)?
            } else {
                document.set_text(&axis.path, &format!("{text:?}"))?
            };
        }
        document.scenario()
    }
    pub fn fingerprint_text(&self) -> String {
        self.document.source().text().to_owned()
    }
}
