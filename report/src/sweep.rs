//! Report of a sweep.

use drillsweep_api::judgement::OperatingLimits;
use drillsweep_api::view::operating_window::OperatingWindow;
use drillsweep_api::view::verification::Findings;
use drillsweep_api::view::worst::WorstValues;
use drillsweep_api::{PointError, Sweep};
use drillsweep_chart::{self as chart, Drawing, SweepView};
use drillsweep_quantity::columns::{CLASS, CLASS_UNCERTAIN, ERROR_TIME};
use drillsweep_quantity::{CLASSES, UnitSystem};
use drillsweep_table::{Column, Table};
use indexmap::IndexSet;
use maud::{Markup, html};

use crate::inputs::{Varied, inputs};
use crate::page::page;
use crate::point::{PointData, accuracy_of, figure, judgement, pictures, worst};
use crate::reading::amount;
use crate::{accuracy, source, verdict};

/// Failed points that a report lists, at most.
pub const MOST_FAILURES: usize = 6;

/// A failed point.
#[derive(Debug, Clone)]
pub struct FailedPoint {
    /// Its number, from 1.
    pub ordinal: u32,
    /// Its failure.
    pub error: PointError,
}

/// Operating window of a sweep in few words and one picture, whose size does not grow with the sweep.
#[derive(Debug, Clone)]
pub struct WindowData {
    limits: OperatingLimits,
    varied: Vec<Varied>,
    picture: Option<Drawing>,
    counts: Vec<(&'static str, usize)>,
    uncertain: usize,
    worst: WorstValues,
    failures: Vec<FailedPoint>,
}

impl WindowData {
    /// The window of all points, with the first failures.
    pub fn new(
        window: OperatingWindow,
        limits: OperatingLimits,
        findings: &Findings,
        failures: Vec<FailedPoint>,
        units: UnitSystem,
    ) -> Self {
        let parameters: IndexSet<String> = window.parameters().map(str::to_owned).collect();
        let worst = window.worst().clone();
        let table = window.finish();
        let varied = Varied::of_table(&table, parameters.iter().map(String::as_str));
        let fields = [CLASS.name.to_owned()];
        let view = SweepView { units: units.into(), ..SweepView::default() };
        let picture = (!varied.is_empty())
            .then(|| chart::sweep(&table, &parameters, Some(&fields), findings, "", &view).ok())
            .flatten();
        let count = |name: &str| texts(&table, CLASS.name).filter(|class| *class == name).count();
        let counts =
            CLASSES.iter().map(|class| (class.name, count(class.name))).filter(|(_, count)| *count > 0);
        let (counts, uncertain) = (counts.collect(), texts(&table, CLASS_UNCERTAIN.name).count());
        Self { limits, varied, picture, counts, uncertain, worst, failures }
    }

    /// Number of the worst point with a result.
    pub fn worst_point(&self) -> Option<u32> {
        self.worst.point()
    }
}

fn texts<'t>(table: &'t Table, name: &str) -> impl Iterator<Item = &'t str> {
    let texts = match table.columns.get(name) {
        Some(Column::Text(texts)) => texts.as_slice(),
        _ => &[],
    };
    texts.iter().flatten().map(String::as_str)
}

/// Data of one sweep.
#[derive(Debug, Clone)]
pub struct SweepData {
    /// The sweep.
    pub sweep: Sweep,
    /// Its operating window.
    pub window: WindowData,
    /// Its verification.
    pub findings: Findings,
    /// The worst point with a result, or else the first point.
    pub point: PointData,
}

/// The report of a sweep, as HTML.
pub fn sweep(data: &SweepData, units: UnitSystem) -> String {
    let SweepData { sweep, window, findings, point } = data;
    let counts = sweep.counts;
    let body = html! {
        (source::heading(sweep, None))
        p {
            (counts.total) " points: " (counts.succeeded) " with a result, " (counts.failed) " failed, " (counts.cancelled) " cancelled, "
            (counts.queued + counts.running) " not finished."
        }
        h2 { "Operating window" }
        (classes(window, units))
        h2 { "Simulated" }
        (inputs(&point.point.scenario, &window.varied, units))
        @if point.diagnosis.is_some() {
            h2 { "Worst places of all points" }
            (verdict::worst(window.worst.loads(), None, true, units))
            h2 { "Worst point: " (point.point.row.ordinal) }
            (judgement(point, units))
            (worst(point, units))
            (pictures(point, units))
        }
        h2 { "Accuracy" }
        (accuracy::of_sweep(&point.point.scenario, window.worst.errors(), findings, units))
        @if point.diagnosis.is_some() {
            h3 { "Point " (point.point.row.ordinal) }
            (accuracy_of(point, units))
        }
        h2 { "Failures" }
        (failures(window, counts.failed, units))
        h2 { "Origin" }
        (source::origin(sweep, &point.point, false))
    };
    page(&source::title(sweep, None), &body)
}

fn classes(window: &WindowData, units: UnitSystem) -> Markup {
    html! {
        @if let Some(picture) = &window.picture { (figure(picture)) }
        div.pair {
            div {
                table {
                    thead { tr { th { "Class, the most severe first" } th.n { "points" } } }
                    tbody { @for (name, count) in &window.counts { tr { td { (verdict::class(name)) } td.n { (count) } } } }
                }
                @if window.uncertain > 0 {
                    p { "The class of " (window.uncertain) " points is uncertain: not settled, or within the error of a limit." }
                }
            }
            (verdict::limits(&window.limits, units))
        }
    }
}

fn failures(window: &WindowData, failed: u64, units: UnitSystem) -> Markup {
    html! {
        @if window.failures.is_empty() { p { "None." } }
        @else {
            table {
                thead { tr { th.n { "point" } th { "class" } th { "reason" } th.n { "at" } } }
                tbody { @for FailedPoint { ordinal, error } in &window.failures {
                    tr {
                        td.n { (ordinal) }
                        td { (error.class.as_str()) }
                        td { (error.reason) }
                        td.n { (error.time.map_or(String::new(), |time| amount(ERROR_TIME.name, time, units))) }
                    }
                } }
            }
            @if failed > window.failures.len() as u64 { p { "The first " (window.failures.len()) " of " (failed) "." } }
        }
    }
}
