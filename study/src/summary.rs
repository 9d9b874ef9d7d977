//! Scalars of a point: its row of a sweep's table.

use drillsweep_scenario::{NodeChoice, StartFriction, TimeWindow};
use drillsweep_sim::force::effect::CONTACT_WORK;
use drillsweep_sim::force::mud::CircuitLosses;
use serde::Serialize;

use crate::loads::{LoadSummary, Worst, worst};
use drillsweep_sim::math::signal::{
    FullSpectrum, PeakSearch, Whirl, Window, full_spectrum, sample_range, weighted_orbit_statistics,
};
use drillsweep_sim::solve::model::{GRAVITY, Model};
use drillsweep_sim::solve::run::{ErrorEstimate, Histories, OrbitInterval, Records, Series, Settling};
use drillsweep_sim::solve::statics::{Equilibrium, buckling_ratios};

/// Band of the summary's spectra \[Hz\]: covers the rotation speeds of drilling, as in the paper.
const BAND_HZ: f64 = 20.0;

/// Frequency \[Hz\] beyond which lateral motion of a drillstring soon dies out unless it is excited continuously.
const HIGH_FREQUENCY_HZ: f64 = 100.0;

/// Number of lines reported of each spectrum.
const LINES: usize = 8;

/// The equilibrium and the mud around it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticsSummary {
    /// Nodes that touch the wall.
    pub contacts: usize,
    /// Sum of the normal forces \[N\].
    pub normal_force_total: f64,
    /// Effective tension of the uppermost element \[N\].
    pub tension_top: f64,
    /// Effective tension of the lowest element \[N\].
    pub tension_bit: f64,
    /// Torque of the uppermost element \[N m\] at the equilibrium that the run starts from.
    pub torque_top: f64,
    /// The same at break-away, friction mu_s at every node that touches; absent if that equilibrium was not found.
    pub torque_top_break_away: Option<f64>,
    /// The same of the string that rotates, friction mu at the sliding speed of each node; absent if that equilibrium was not found.
    pub torque_top_rotating: Option<f64>,
    /// Torque of the lowest element \[N m\].
    pub torque_bit: f64,
    /// Largest compression over the load from which an element buckles sinusoidally.
    pub buckling: Worst,
    /// Pressures of the mud; absent without mud.
    pub hydraulics: Option<HydraulicsSummary>,
    /// Smallest and largest C_f along the string; absent without mud.
    pub friction_coefficient_range: Option<[f64; 2]>,
    /// Smallest and largest damping k along the string \[N s/m2\]; absent without mud.
    pub rotation_damping_range: Option<[f64; 2]>,
}

/// Pressures of the mud along the string.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HydraulicsSummary {
    /// Pressure in the bore at the top, with the loss of the surface lines \[Pa\].
    pub standpipe_pressure: f64,
    /// Pressure lost to friction in the annulus \[Pa\].
    pub annulus_loss: f64,
    /// Pressure lost to friction in the bore and over tools in it \[Pa\].
    pub bore_loss: f64,
    /// Pressure lost at the bit \[Pa\].
    pub bit_loss: f64,
    /// Rise of the annulus pressure over gravity and vertical depth \[kg/m3\]; absent if the bit is not below the top, or without gravity.
    pub equivalent_circulating_density: Option<f64>,
}

/// Results of the run in time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TransientSummary {
    /// Length of the run \[s\].
    pub simulated_time: f64,
    /// Window of the orbits' statistics, and the verdict on its settling.
    pub settling: Settling,
    /// Orbits of the recorded nodes over that window.
    pub orbits: Vec<OrbitSummary>,
    /// Loads of the whole string over that window; absent if no step ended in it.
    pub loads: Option<LoadSummary>,
    /// Strongest line of the bit's rotation speed over that window, or its last 80 s; absent if the bit is not recorded, or does not swing.
    pub bit_line: Option<BitLine>,
    /// Dominant lines of the recorded nodes over the scenario's spectrum windows, or the end of that window.
    pub spectra: Vec<SpectrumSummary>,
    /// Frequency \[Hz\] up to which the longest step resolves a vibration.
    pub resolved_hz: f64,
    /// Steps of the shortest length that left more than the tolerance.
    pub unresolved_steps: u64,
    /// Contacts of all nodes together.
    pub contact_count: u64,
    /// Number of slip-to-stick transitions, summed over all nodes.
    #[serde(rename = "capture_count")]
    pub slip_to_stick_count: u64,
    /// Largest normal force of any node \[N\].
    pub largest_normal_force: f64,
    /// Estimated error of the lateral displacements.
    pub error_estimate: ErrorEstimate,
    /// Energy left over at the end \[J\]: the integration's own error.
    pub energy_residual: f64,
    /// Its size relative to the bound beyond which a run is stopped; absent if nothing moved.
    pub energy_residual_of_bound: Option<f64>,
    /// The same relative to the net work of the contacts; absent if that is less than rounding may leave, as at rest.
    pub energy_residual_ratio: Option<f64>,
}

/// Line of the bit's rotation speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BitLine {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude \[rad/s\].
    pub amplitude: f64,
}

/// The orbit of one node.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OrbitSummary {
    /// Node, from 1 at the top.
    pub node: usize,
    /// Choice by which the node is recorded: its number or a depth.
    pub recorded_as: NodeChoice,
    /// Its measured depth \[m\].
    pub measured_depth: f64,
    /// Window \[s\].
    pub window: TimeWindow,
    /// Distance of the orbit's mean position from the hole's axis \[m\].
    pub offset: f64,
    /// Mean distance from the hole's axis \[m\].
    pub mean_radius: f64,
    /// Largest distance from the hole's axis \[m\].
    pub largest_radius: f64,
    /// Orbit size: root mean square distance from the mean position \[m\].
    pub orbit_radius_rms: f64,
    /// Standard deviation of the distance from the hole's axis \[m\]: the motion towards and off the wall alone.
    pub radius_deviation: f64,
    /// Root mean square motion at frequencies above 100 Hz \[m\]: chatter of the contacts or of the method, if any. Absent if the
    /// recording rate is below 250 Hz.
    pub high_frequency_rms: Option<f64>,
    /// Half widths of the confidence intervals of 95 % of its statistics; of irregular motion only.
    pub interval: Option<OrbitInterval>,
}

/// Dominant lines of one node in one window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectrumSummary {
    /// Node, from 1 at the top.
    pub node: usize,
    /// Choice by which the node is recorded: its number or a depth.
    pub recorded_as: NodeChoice,
    /// Its measured depth \[m\].
    pub measured_depth: f64,
    /// Window \[s\].
    pub window: TimeWindow,
    /// Root mean square motion about the mean at frequencies up to 20 Hz, both senses of whirl together \[m\].
    pub band_rms: f64,
    /// The lines, strongest first; the mean is left out.
    pub lines: Vec<LineSummary>,
}

/// One spectral line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LineSummary {
    /// Frequency \[Hz\]; negative is backward whirl.
    pub frequency_hz: f64,
    /// Amplitude \[m\]: the radius of the circle that the line draws, interpolated between the bins.
    pub amplitude: f64,
    /// Sense of the whirl.
    pub whirl: Whirl,
    /// True if the steps of the run resolve the line.
    pub is_resolved: bool,
}

impl StaticsSummary {
    /// The sums of the equilibrium that a run starts from, and the torque at the top with the friction of the `other` start.
    pub fn new(
        model: &Model,
        equilibrium: &Equilibrium,
        start: StartFriction,
        other: Option<&Equilibrium>,
    ) -> Self {
        let end = |values: &[f64], last: bool| {
            if last { values.last() } else { values.first() }.copied().unwrap_or(0.0)
        };
        let torque_top = end(&equilibrium.torque, false);
        let torque_of = |friction: StartFriction| {
            if friction == start { Some(torque_top) } else { other.map(|other| end(&other.torque, false)) }
        };
        Self {
            contacts: equilibrium.normal_force.iter().filter(|&&force| force > 0.0).count(),
            normal_force_total: equilibrium.normal_force.iter().sum(),
            tension_top: end(&equilibrium.tension, false),
            tension_bit: end(&equilibrium.tension, true),
            torque_top,
            torque_top_break_away: torque_of(StartFriction::BreakAway),
            torque_top_rotating: torque_of(StartFriction::Sliding),
            torque_bit: end(&equilibrium.torque, true),
            buckling: {
                let bottom = |e: usize| model.mesh.nodes[e + 1].measured_depth;
                let ratios = buckling_ratios(model, &equilibrium.tension).into_iter().enumerate();
                worst(ratios.map(|(e, ratio)| (ratio, bottom(e))))
            },
            hydraulics: HydraulicsSummary::of(model, equilibrium),
            friction_coefficient_range: range(equilibrium.flows.iter().map(|flow| flow.friction_coefficient)),
            rotation_damping_range: range(equilibrium.flows.iter().map(|flow| flow.rotation_damping)),
        }
    }
}

impl HydraulicsSummary {
    fn of(model: &Model, equilibrium: &Equilibrium) -> Option<Self> {
        let pressures = equilibrium.pressures.as_ref()?;
        let mud = model.scenario.mud.as_ref()?;
        let hydraulics = &model.scenario.hydraulics;
        let steps = equilibrium.pressure_steps(model).ok()?;
        let circuit = CircuitLosses::new(mud, hydraulics, hydraulics.losses).ok()?;
        let (top, bottom) = (*pressures.annulus.first()?, *pressures.annulus.last()?);
        let depth = model.frames.last()?.position.z - model.frames.first()?.position.z;
        let has_density = depth > 0.0 && model.effects.gravity;
        Some(Self {
            standpipe_pressure: pressures.bore.first()? + circuit.surface,
            annulus_loss: steps.iter().map(|step| step.friction_gradient * step.length).sum(),
            bore_loss: steps.iter().map(|step| step.bore_friction_gradient * step.length).sum::<f64>()
                + circuit.tools,
            bit_loss: pressures.bore.last()? - bottom - circuit.tools,
            equivalent_circulating_density: has_density.then(|| (bottom - top) / (GRAVITY * depth)),
        })
    }
}

impl TransientSummary {
    /// Summarises a finished run, node by node: no more of its histories is in memory than two series of one node over a window.
    ///
    /// # Errors
    /// The histories cannot be read.
    pub fn new<H: Histories>(model: &Model, records: &Records<H>) -> Result<Self, H::Error> {
        let settling = &records.settling;
        let orbit_window = settling.window;
        let spectrum_windows = records.spectrum_windows(&model.scenario);
        let mut orbits = Vec::new();
        let mut spectra = Vec::new();
        let histories = &records.histories;
        let samples = histories.samples();
        for (index, node) in histories.nodes().into_iter().enumerate() {
            let is_it = |choice: &&NodeChoice| model.mesh.chosen_node(**choice) == Some(node);
            let recorded_as = model.scenario.recording.nodes.iter().find(is_it).copied();
            let (node, measured_depth) = (node + 1, model.mesh.nodes[node].measured_depth);
            let recorded_as = recorded_as.unwrap_or(NodeChoice::Node(node as u32));
            let motion = |window: TimeWindow| {
                let samples = sample_range(window.from, window.to, records.rate_hz, samples);
                let u = histories.read(index, Series::U, samples.clone())?;
                Ok((u, histories.read(index, Series::V, samples)?))
            };
            let (u, v) = motion(orbit_window)?;
            if let Some(orbit) = weighted_orbit_statistics(&u, &v, settling.weighting) {
                orbits.push(OrbitSummary {
                    node,
                    recorded_as,
                    measured_depth,
                    window: orbit_window,
                    offset: orbit.mean_u.hypot(orbit.mean_v),
                    mean_radius: orbit.mean_radius,
                    largest_radius: orbit.largest_radius,
                    orbit_radius_rms: orbit.orbit_radius_rms,
                    radius_deviation: orbit.radius_deviation,
                    high_frequency_rms: high_frequency_rms(&u, &v, records.rate_hz),
                    interval: settling.intervals.get(index).copied(),
                });
            }
            for &window in &spectrum_windows {
                let (u, v) = motion(window)?;
                let band = |shape| {
                    full_spectrum(&u, &v, records.rate_hz, shape).restricted_to(&(-BAND_HZ..=BAND_HZ))
                };
                let spectrum = band(Window::Hann);
                let search = PeakSearch { count: LINES, min_separation_hz: 0.5, exclude_mean: true };
                let lines = spectrum.peaks(&search).into_iter().map(|peak| LineSummary {
                    frequency_hz: peak.frequency_hz,
                    amplitude: peak.amplitude,
                    whirl: peak.whirl,
                    is_resolved: peak.frequency_hz.abs() <= records.effort.resolved_hz,
                });
                spectra.push(SpectrumSummary {
                    node,
                    recorded_as,
                    measured_depth,
                    window,
                    band_rms: band_rms(&band(Window::Rectangular)),
                    lines: lines.collect(),
                });
            }
        }
        let last = records.energy.last().copied().unwrap_or_default();
        Ok(Self {
            simulated_time: records.simulated_time,
            settling: settling.clone(),
            orbits,
            loads: LoadSummary::new(model, &records.loads, &histories.nodes()),
            bit_line: BitLine::of(records),
            spectra,
            resolved_hz: records.effort.resolved_hz,
            unresolved_steps: records.effort.unresolved_steps,
            slip_to_stick_count: records.contacts.iter().map(|contact| contact.slip_to_stick_count).sum(),
            contact_count: records.contacts.iter().map(|contact| contact.contact_count).sum(),
            largest_normal_force: records
                .contacts
                .iter()
                .fold(0.0, |most, contact| most.max(contact.largest_normal_force)),
            error_estimate: records.error,
            energy_residual: last.residual,
            energy_residual_of_bound: (records.energy_bound > 0.0)
                .then(|| last.residual.abs() / records.energy_bound),
            energy_residual_ratio: energy_residual_ratio(records),
        })
    }
}

impl BitLine {
    fn of<H>(records: &Records<H>) -> Option<Self> {
        let course = &records.course;
        let window = records.settling.kept_window();
        let start = course.time(0);
        let rate_hz = course.rate_hz();
        let rates = course.twist_rate();
        let samples = sample_range(window.from - start, window.to - start, rate_hz, rates.len());
        let rates = rates.get(samples).filter(|rates| !rates.is_empty())?;
        let spectrum = full_spectrum(rates, &vec![0.0; rates.len()], rate_hz, Window::Hann)
            .restricted_to(&(0.0..=BAND_HZ));
        let search = PeakSearch { count: 1, min_separation_hz: 0.5, exclude_mean: true };
        let line = *spectrum.peaks(&search).first()?;
        // A real signal has half of its amplitude at either sign.
        Some(Self { frequency_hz: line.frequency_hz, amplitude: 2.0 * line.amplitude })
    }
}

/// Energy left over at the end relative to the net work of the contacts; absent if that is less than rounding may
/// leave, as at rest.
pub(crate) fn energy_residual_ratio<H>(records: &Records<H>) -> Option<f64> {
    let last = records.energy.last().copied().unwrap_or_default();
    let contact_work = last.of(CONTACT_WORK).abs();
    (contact_work > records.energy_rounding).then(|| last.residual.abs() / contact_work)
}

/// Root of the summed squares of the amplitudes beyond [`HIGH_FREQUENCY_HZ`] (Parseval).
fn high_frequency_rms(u: &[f64], v: &[f64], rate_hz: f64) -> Option<f64> {
    if rate_hz < 2.5 * HIGH_FREQUENCY_HZ {
        return None;
    }
    let spectrum = full_spectrum(u, v, rate_hz, Window::Hann);
    let bins = spectrum.frequency_hz.iter().zip(&spectrum.amplitude);
    let high = bins.filter(|(frequency, _)| frequency.abs() > HIGH_FREQUENCY_HZ);
    // Hann's window, scaled to the amplitudes of lines, counts a mean square one and a half times.
    Some((high.map(|(_, amplitude)| amplitude * amplitude).sum::<f64>() / 1.5).sqrt())
}

/// Root of the summed squares of all amplitudes but the mean's (Parseval).
fn band_rms(spectrum: &FullSpectrum) -> f64 {
    let bins =
        spectrum.frequency_hz.iter().zip(&spectrum.amplitude).filter(|(frequency, _)| **frequency != 0.0);
    bins.map(|(_, amplitude)| amplitude * amplitude).sum::<f64>().sqrt()
}

fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.fold(None, |range, value| {
        Some(range.map_or([value, value], |[low, high]: [f64; 2]| [low.min(value), high.max(value)]))
    })
}

#[cfg(test)]
impl OrbitSummary {
    /// An orbit about the hole's axis, for tests.
    pub(super) fn of(node: usize, orbit_radius_rms: f64, radius_deviation: f64) -> Self {
        Self {
            node,
            recorded_as: NodeChoice::Node(node as u32),
            measured_depth: 0.0,
            window: TimeWindow { from: 0.0, to: 1.0 },
            offset: 0.0,
            mean_radius: 0.0,
            largest_radius: 0.0,
            orbit_radius_rms,
            radius_deviation,
            high_frequency_rms: None,
            interval: None,
        }
    }
}

#[cfg(test)]
impl TransientSummary {
    /// A run of 1 s with a fixed window and no errors, for tests.
    pub(super) fn of(orbits: Vec<OrbitSummary>) -> Self {
        Self {
            simulated_time: 1.0,
            settling: Settling {
                regime: drillsweep_sim::solve::run::MotionRegime::Fixed,
                settled_at: None,
                window: TimeWindow { from: 0.0, to: 1.0 },
                weighting: Window::Rectangular,
                base_frequencies_hz: Vec::new(),
                windows_differ: None,
                intervals: Vec::new(),
                halves_differ: None,
                growing_mode: None,
            },
            orbits,
            loads: None,
            bit_line: None,
            spectra: Vec::new(),
            resolved_hz: 0.0,
            unresolved_steps: 0,
            contact_count: 0,
            slip_to_stick_count: 0,
            largest_normal_force: 0.0,
            error_estimate: ErrorEstimate { displacement: 0.0, relative: 0.0 },
            energy_residual: 0.0,
            energy_residual_of_bound: None,
            energy_residual_ratio: None,
        }
    }
}
