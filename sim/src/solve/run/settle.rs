//! Settling of a run, and the window of its statistics.

use std::fmt;
use std::ops::Range;

use drillsweep_scenario::{AccuracyPreset, Outputs, Promise, Scenario, TimeWindow};
use serde::{Deserialize, Serialize};

use super::histories::NodeHistory;
use super::recorded::{additional_bit, recorded_nodes};
use crate::math::signal::{Allowed, Batches, Course, LONGEST_WINDOW, Window, halves, sample_range};
use crate::solve::model::Model;
use crate::solve::modes::{TorsionalMode, growing_torsion};
use crate::solve::statics::Equilibrium;
use crate::solve::step::adaptive::smallest_motion;

/// Least rate of the samples by which settling is judged \[Hz\], if the recording rate allows: statistics do not depend on it, and lines are
/// resolved up to half of it.
const COURSE_RATE_HZ: f64 = 200.0;

/// Time from one judgement to the next \[s\]: a few periods of the slowest torsion of long strings, and half of the shortest window.
const BLOCK: f64 = 10.0;

/// Highest frequency of a growing mode that is watched \[Hz\]: whirl and stick-slip lie below it.
/// [`UndampedTorsion`](crate::solve::modes::UndampedTorsion) reports torsion that grows above it.
const HIGHEST_WATCHED_HZ: f64 = 30.0;

/// Part of a mode's linear growth from which it has not saturated: the base case at 180 rpm in mud of 1500 kg/m3 grows with a third of its linear
/// growth for half a minute before it begins to stick.
const UNSATURATED: f64 = 0.25;

/// Logarithm of an amplitude's growth over the windows that counts as none: beats change amplitudes of settled motion by as much.
const NO_GROWTH: f64 = 0.02;

/// Standard deviation of the rotation speed below which it is not compared with itself, relative to the speed at the top.
const SMALLEST_ROTATION: f64 = 0.1;

/// Kind and steadiness of a run's motion over the window of its statistics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settling {
    /// Kind of motion.
    pub regime: MotionRegime,
    /// Time from which on the statistics describe the motion \[s\]: the start of the first of three windows that agree, or of the
    /// batches. Absent if the motion has not settled, or the window is fixed.
    pub settled_at: Option<f64>,
    /// Window of the statistics \[s\].
    pub window: TimeWindow,
    /// Weights of its samples.
    pub weighting: Window,
    /// Base frequencies of regular motion \[Hz\], ascending, two at most.
    pub base_frequencies_hz: Vec<f64>,
    /// Intervals of the statistics of irregular motion, by recorded node; empty for other motion.
    pub intervals: Vec<OrbitInterval>,
    /// Largest relative difference between orbit sizes of the windows that agree; of regular motion only.
    #[serde(default)]
    pub windows_differ: Option<f64>,
    /// Largest relative difference between orbit sizes, or radius deviations, of the first and the second half of a window over which
    /// the motion was not shown to have settled; absent for others.
    pub halves_differ: Option<f64>,
    /// The torsional mode of the equilibrium that still grows; absent if none does.
    pub growing_mode: Option<TorsionalMode>,
}

/// Kind of motion over the window of a run's statistics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum MotionRegime {
    /// Settled: statistics of consecutive windows agree.
    Regular,
    /// Settled, with statistics that scatter: they have confidence intervals.
    Irregular,
    /// Neither regular nor irregular by the end of the longest run.
    NotSettled,
    /// Not judged: the window was fixed beforehand.
    Fixed,
}

impl MotionRegime {
    /// The name in requests and responses.
    pub fn name(self) -> &'static str {
        match self {
            MotionRegime::Regular => "regular",
            MotionRegime::Irregular => "irregular",
            MotionRegime::NotSettled => "not_settled",
            MotionRegime::Fixed => "fixed",
        }
    }
}

/// Half widths of the confidence intervals of 95 % of a node's statistics \[m\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OrbitInterval {
    /// Half width for the orbit size.
    pub orbit_radius_rms: f64,
    /// Half width for the standard deviation of the radius.
    pub radius_deviation: f64,
}

impl Settling {
    /// The end of the window, at most as long as the longest that is compared: histories are kept over it at full rate, and spectra
    /// are over it unless they have windows of their own.
    pub fn kept_window(&self) -> TimeWindow {
        let TimeWindow { from, to } = self.window;
        TimeWindow { from: from.max(to - LONGEST_WINDOW), to }
    }
}

impl fmt::Display for Settling {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.regime, self.settled_at) {
            (MotionRegime::Regular, Some(since)) => {
                write!(formatter, "settled at {since:.1} s to regular motion")?;
                if !self.base_frequencies_hz.is_empty() {
                    let found: Vec<_> =
                        self.base_frequencies_hz.iter().map(|hz| format!("{hz:.3}")).collect();
                    write!(formatter, ", base frequencies {} Hz", found.join(" and "))?;
                }
            }
            (MotionRegime::Irregular, Some(since)) => write!(
                formatter,
                "settled at {since:.1} s to irregular motion: statistics scatter, and their intervals are of 95 %"
            )?,
            (MotionRegime::Regular | MotionRegime::Irregular | MotionRegime::NotSettled, _) => {
                write!(
                    formatter,
                    "NOT SETTLED by the end of the longest run: statistics may be those of its start"
                )?;
            }
            (MotionRegime::Fixed, _) => {
                write!(formatter, "fixed window: the motion was not tested for having settled")?
            }
        }
        if let Some(differ) = self.halves_differ {
            write!(formatter, "; its halves differ by {:.1} %", 1e2 * differ)?;
        }
        if let Some(TorsionalMode { frequency_hz, growth_rate }) = self.growing_mode {
            write!(
                formatter,
                "; torsion at {frequency_hz:.3} Hz STILL GROWS (while small with {growth_rate:.3} 1/s): stick-slip may come later"
            )?;
        }
        Ok(())
    }
}

/// The shortest duration of a scenario's run \[s\].
pub fn shortest_run(scenario: &Scenario) -> f64 {
    if !scenario.settles() {
        return scenario.duration;
    }
    scenario.duration.min(latest_end(scenario).max(4.0 * BLOCK))
}

/// Simulated time \[s\] over which the twin of a run of `duration` \[s\] with statistics over `window` is compared with the run: at most a third of
/// it.
pub fn twin_time(window: TimeWindow, duration: f64) -> f64 {
    (window.to - window.from).clamp(0.0, duration / 3.0)
}

/// The longest window of a scenario's orbit statistics.
pub fn orbit_window_at_most(scenario: &Scenario) -> TimeWindow {
    scenario.orbit_window().unwrap_or_else(|| {
        let duration = scenario.duration;
        TimeWindow { from: (duration - LONGEST_WINDOW.max(0.5 * duration)).max(0.0), to: duration }
    })
}

/// The longest window over which a scenario's histories are kept at full rate, which is also that of spectra without windows of their own.
pub fn kept_window_at_most(scenario: &Scenario) -> TimeWindow {
    scenario.orbit_window().unwrap_or_else(|| {
        let duration = scenario.duration;
        TimeWindow { from: (duration - LONGEST_WINDOW).max(0.0), to: duration }
    })
}

/// The longest windows of a scenario's spectra.
pub fn spectrum_windows_at_most(scenario: &Scenario) -> Vec<TimeWindow> {
    scenario.spectrum_windows().unwrap_or_else(|| vec![kept_window_at_most(scenario)])
}

/// Samples of the course of the longest run of a scenario.
pub fn course_samples(scenario: &Scenario) -> u64 {
    let rate = scenario.recording.rate_hz;
    let every = course_every(rate);
    let kept = kept_by_course(scenario, (scenario.duration * rate).round() as u64);
    kept.end.div_ceil(every) - kept.start.div_ceil(every)
}

/// Recorded samples from one of the course to the next.
fn course_every(rate_hz: f64) -> u64 {
    ((rate_hz / COURSE_RATE_HZ) as u64).max(1)
}

/// Recorded samples that belong to the course, out of a number of `samples`.
fn kept_by_course(scenario: &Scenario, samples: u64) -> Range<u64> {
    scenario.orbit_window().map_or(0..samples, |window| {
        let range = sample_range(window.from, window.to, scenario.recording.rate_hz, samples as usize);
        range.start as u64..range.end as u64
    })
}

/// The latest end of the fixed windows of a scenario \[s\]: no run ends before it.
fn latest_end(scenario: &Scenario) -> f64 {
    let recording = &scenario.recording;
    let of_outputs = match &recording.outputs {
        Outputs::Orbits(part) => part.window,
        Outputs::Summary | Outputs::Spectra | Outputs::Full => None,
    };
    let of_snapshots = recording.snapshots.and_then(|snapshots| snapshots.window);
    let windows = recording.spectrum_windows.iter().flatten().copied().chain(of_outputs).chain(of_snapshots);
    windows.fold(0.0, |latest, window| latest.max(window.to))
}

/// Criteria of settling, fixed for a run.
#[derive(Debug, Clone)]
pub(super) struct Settle {
    /// The fixed window; absent if it is to be settled.
    fixed: Option<TimeWindow>,
    /// The last third of the longest run.
    last_third: TimeWindow,
    /// Recorded samples from one of the course to the next.
    every: u64,
    /// Recorded samples that belong to the course.
    kept: Range<u64>,
    /// Recorded samples from one judgement to the next.
    block: u64,
    /// Samples before which no run ends.
    earliest: u64,
    /// Errors that the accuracy allows.
    promise: Allowed,
    /// The bit, from 0 at the top, if its rotation is recorded.
    bit: Option<usize>,
    growing: Vec<TorsionalMode>,
}

impl Settle {
    /// Criteria of a run of `samples` samples whose ledger has a row every `ledger_every`.
    pub(super) fn new(model: &Model, equilibrium: &Equilibrium, samples: u64, ledger_every: u64) -> Self {
        let scenario = &model.scenario;
        let rate = scenario.recording.rate_hz;
        let fixed = scenario.orbit_window();
        let rows = (BLOCK * rate / ledger_every as f64).round().max(1.0) as u64;
        // Integrator and step given in full promise nothing, and settle by the criteria of `standard`.
        let promise = scenario.accuracy.promise().unwrap_or_else(|| AccuracyPreset::Standard.promise());
        let Promise { orbit_size, radius_deviation } = promise;
        Self {
            fixed,
            last_third: scenario.last_third(),
            every: course_every(rate),
            kept: kept_by_course(scenario, samples),
            block: rows * ledger_every,
            earliest: (latest_end(scenario) * rate).ceil() as u64,
            promise: Allowed {
                orbit_size,
                radius_deviation,
                smallest_orbit: smallest_motion(0.5 * scenario.well.hole_diameter),
                smallest_rotation: SMALLEST_ROTATION * model.rotation_speed.abs(),
            },
            bit: model.node_count().checked_sub(1).filter(|bit| {
                model.effects.torsion
                    && (additional_bit(model).is_some() || recorded_nodes(model).contains(bit))
            }),
            growing: growing_torsion(model, equilibrium, HIGHEST_WATCHED_HZ),
        }
    }

    /// The course that the run begins with.
    pub(super) fn course(&self, model: &Model) -> Course {
        let rate = model.scenario.recording.rate_hz / self.every as f64;
        let before = self.kept.start.div_ceil(self.every);
        let has_bit = self.bit.is_some();
        Course::new(
            rate,
            before as usize,
            recorded_nodes(model).len(),
            has_bit,
            course_samples(&model.scenario) as usize,
        )
    }

    /// A course of the same kind without capacity.
    pub(super) fn empty_course(&self, model: &Model) -> Course {
        let rate = model.scenario.recording.rate_hz / self.every as f64;
        Course::new(rate, 0, recorded_nodes(model).len(), self.bit.is_some(), 0)
    }

    /// Ends judgement: the run from here on is compared with another one.
    pub(super) fn close(&mut self) {
        self.fixed = Some(self.last_third);
        self.kept = 0..0;
        self.growing.clear();
    }

    /// Recorded samples from one judgement to the next.
    pub(super) fn block(&self) -> u64 {
        self.block
    }

    /// True if the run is to choose its window by settling.
    pub(super) fn is_open(&self) -> bool {
        self.fixed.is_none()
    }

    /// True if a recorded sample is at the end of a block.
    pub(super) fn is_block(&self, sample: u64) -> bool {
        sample.is_multiple_of(self.block)
    }

    /// Takes the last recorded sample into the course, if it belongs there.
    pub(super) fn take(
        &self,
        sample: u64,
        nodes: &[NodeHistory],
        bit: Option<&NodeHistory>,
        course: &mut Course,
    ) {
        if !sample.is_multiple_of(self.every) || !self.kept.contains(&sample) {
            return;
        }
        let last = |series: &[f64]| series.last().copied().unwrap_or(0.0);
        let bit = bit.or_else(|| nodes.iter().find(|history| Some(history.node) == self.bit));
        course.push(
            nodes.iter().map(|history| [last(&history.u), last(&history.v)]),
            bit.map(|bit| last(&bit.theta_z_rate)),
        );
    }

    /// True if a run that has reached a recorded sample is to be judged.
    pub(super) fn is_due(&self, sample: u64) -> bool {
        self.fixed.is_none() && sample > 0 && sample >= self.earliest && sample.is_multiple_of(self.block)
    }

    /// Verdict at a recorded sample; present if the motion has settled and the run may end there.
    pub(super) fn judge(&self, course: &Course, sample: u64) -> Option<Settling> {
        let end = self.end(course, sample);
        if let Some(settled) = self.regular(course, end) {
            return Some(settled);
        }
        let batches =
            course.batches(end, &self.promise).filter(|batches| batches.is_steady && batches.is_narrow)?;
        self.irregular(course, batches)
    }

    /// Verdict at the end of a run, a recorded sample.
    pub(super) fn conclude(&self, course: &Course, sample: u64) -> Settling {
        let Some(fixed) = self.fixed else {
            let end = self.end(course, sample);
            let settled = self.regular(course, end).or_else(|| {
                let batches = course.batches(end, &self.promise).filter(|batches| batches.is_steady)?;
                self.irregular(course, batches)
            });
            return settled
                .unwrap_or_else(|| self.unsettled(course, MotionRegime::NotSettled, self.last_third));
        };
        self.unsettled(course, MotionRegime::Fixed, fixed)
    }

    fn regular(&self, course: &Course, end: usize) -> Option<Settling> {
        let Allowed { orbit_size, radius_deviation, .. } = self.promise;
        let half = Allowed {
            orbit_size: 0.5 * orbit_size,
            radius_deviation: 0.5 * radius_deviation,
            ..self.promise
        };
        let found = course.agreement(end, &half)?;
        let length = found.window.len();
        let first = found.since..found.since + length;
        if self.growing_mode(course, &[first, found.window.clone()]).is_some() {
            return None;
        }
        Some(Settling {
            regime: MotionRegime::Regular,
            settled_at: Some(course.time(found.since)),
            window: window_of(course, &found.window),
            weighting: Window::Hann,
            base_frequencies_hz: course.base_frequencies(&(found.since..found.window.end)),
            intervals: Vec::new(),
            windows_differ: Some(found.differ),
            halves_differ: None,
            growing_mode: None,
        })
    }

    fn irregular(&self, course: &Course, batches: Batches) -> Option<Settling> {
        if self.growing_mode(course, &halves(&batches.window)?).is_some() {
            return None;
        }
        let window = window_of(course, &batches.window);
        let interval = |[orbit_radius_rms, radius_deviation]: [f64; 2]| OrbitInterval {
            orbit_radius_rms,
            radius_deviation,
        };
        Some(Settling {
            regime: MotionRegime::Irregular,
            settled_at: Some(window.from),
            window,
            weighting: Window::Rectangular,
            base_frequencies_hz: Vec::new(),
            intervals: batches.half_widths.into_iter().map(interval).collect(),
            windows_differ: None,
            halves_differ: None,
            growing_mode: None,
        })
    }

    fn unsettled(&self, course: &Course, regime: MotionRegime, window: TimeWindow) -> Settling {
        let before = course.time(0) * course.rate_hz();
        let within =
            |time: f64| ((time * course.rate_hz() - before).round().max(0.0) as usize).min(course.samples());
        let samples = within(window.from)..within(window.to);
        Settling {
            regime,
            settled_at: None,
            window,
            weighting: Window::Rectangular,
            base_frequencies_hz: Vec::new(),
            intervals: Vec::new(),
            windows_differ: None,
            halves_differ: course.halves_differ(&samples, &self.promise),
            growing_mode: halves(&samples).and_then(|halves| self.growing_mode(course, &halves)),
        }
    }

    /// The mode that has not saturated by its growth from one window to another, the fastest of several.
    fn growing_mode(&self, course: &Course, windows: &[Range<usize>; 2]) -> Option<TorsionalMode> {
        let lag = (windows[1].start as f64 - windows[0].start as f64) / course.rate_hz();
        let grows = |mode: &&TorsionalMode| {
            course
                .growth(windows.clone(), mode.frequency_hz)
                .is_some_and(|growth| growth > UNSATURATED * mode.growth_rate && growth * lag > NO_GROWTH)
        };
        self.growing.iter().filter(grows).max_by(|a, b| a.growth_rate.total_cmp(&b.growth_rate)).copied()
    }

    /// Samples of the course before a recorded sample.
    fn end(&self, course: &Course, sample: u64) -> usize {
        course.samples().min((sample / self.every) as usize)
    }
}

fn window_of(course: &Course, samples: &Range<usize>) -> TimeWindow {
    TimeWindow { from: course.time(samples.start), to: course.time(samples.end) }
}
