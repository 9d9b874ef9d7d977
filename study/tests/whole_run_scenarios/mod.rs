//! Whole runs through stick-slip and impacts at reduced size, and their statistics.

#![allow(dead_code, unreachable_pub)]

use std::ops::Range;

use drillsweep_scenario::{
    Accuracy, Adhesion, Integrator, NodeChoice, Scenario, Section, SectionKind, SurveyStation, TimeStepping,
    TimeWindow, preset,
};
use drillsweep_sim::control::Control;
use drillsweep_sim::math::signal::{orbit_statistics, sample_range};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::UndampedTorsion;
use drillsweep_sim::solve::run::{Outcome, Records, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;
use drillsweep_study::ensemble::distances;
use drillsweep_study::errors::{OtherMember, ResultErrors, TimeError};
use drillsweep_study::mesh_estimate::MeshEstimate;
use drillsweep_study::summary::TransientSummary;

/// Window of the statistics: the last third of a run \[s\].
const WINDOW: TimeWindow = TimeWindow { from: 20.0, to: 30.0 };

/// The paper's string without its tool joints, on a coarse mesh, with damping that closes the model. It begins to stick and slip after some
/// ten seconds.
pub fn reduced() -> Scenario {
    let mut scenario = preset("paper-200m").expect("shipped preset");
    scenario.string.sections = vec![
        Section::plain(SectionKind::Drillpipe, 93.5, 0.127, 0.108),
        Section::plain(SectionKind::Collar, 106.5, 0.159, 0.071),
    ];
    let lengths = scenario.mesh.lengths_mut().expect("has target lengths");
    (lengths.drillpipe, lengths.collar) = (4.0, 2.2);
    scenario.damping.stiffness_proportional = 3e-5;
    scenario.duration = WINDOW.to;
    scenario.recording.rate_hz = 500.0;
    scenario.recording.nodes = vec![NodeChoice::Depth(40.0), NodeChoice::Depth(150.0)];
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = Some(WINDOW.into());
    scenario
}

/// Scenarios by name, the base case first.
pub fn scenarios() -> Vec<(&'static str, Scenario)> {
    let with = |name: &'static str, change: &dyn Fn(&mut Scenario)| {
        let mut scenario = reduced();
        change(&mut scenario);
        (name, scenario)
    };
    let well = |stations: [[f64; 3]; 3]| {
        stations
            .map(|[measured_depth, inclination_deg, azimuth_deg]| SurveyStation {
                measured_depth,
                inclination_deg,
                azimuth_deg,
            })
            .to_vec()
    };
    let mud = |scenario: &mut Scenario, flow_rate: f64, density: f64| {
        let mud = scenario.mud.as_mut().expect("mud");
        (mud.flow_rate, mud.density) = (flow_rate, density);
    };
    let unbalance = |scenario: &mut Scenario, factor: f64| {
        for mass in &mut scenario.string.unbalance {
            mass.mass *= factor;
        }
    };
    vec![
        with("base case", &|_| {}),
        with("heavy mud, fast flow", &|s| mud(s, 0.04, 2100.0)),
        with("0.02 m3/s, 1500 kg/m3", &|s| mud(s, 0.02, 1500.0)),
        with("0.06 m3/s, 1800 kg/m3", &|s| mud(s, 0.06, 1800.0)),
        with("friction steeper", &|s| s.contact.friction_reference_speed = 0.02),
        with("friction steeper still", &|s| s.contact.friction_reference_speed = 0.005),
        with("no adhesion", &|s| s.contact.adhesion = Adhesion::None),
        with("hard wall", &|s| (s.contact.stiffness, s.contact.damping) = (1e8, 1e5)),
        with("soft wall", &|s| (s.contact.stiffness, s.contact.damping) = (1e6, 1e3)),
        with("wall that hardly damps", &|s| s.contact.damping = 1e2),
        with("building well", &|s| {
            s.well.survey = well([[0.0, 25.0, 0.0], [100.0, 40.0, 10.0], [200.0, 60.0, 15.0]]);
        }),
        with("horizontal well", &|s| {
            s.well.survey = well([[0.0, 85.0, 0.0], [80.0, 90.0, 0.0], [200.0, 88.0, 0.0]]);
        }),
        with("nearly vertical well", &|s| {
            s.well.survey = well([[0.0, 0.0, 0.0], [100.0, 3.0, 0.0], [200.0, 8.0, 0.0]]);
        }),
        with("60 rpm", &|s| s.operation.rotation_speed_rpm = 60.0),
        with("80 rpm", &|s| s.operation.rotation_speed_rpm = 80.0),
        with("100 rpm", &|s| s.operation.rotation_speed_rpm = 100.0),
        with("180 rpm", &|s| s.operation.rotation_speed_rpm = 180.0),
        with("40 rpm, static friction 0.5", &|s| {
            s.operation.rotation_speed_rpm = 40.0;
            (s.contact.static_friction, s.contact.dynamic_friction) = (0.5, 0.1);
        }),
        with("weight on bit 150 kN", &|s| s.operation.weight_on_bit *= 1.5),
        with("damping 1e-4 s", &|s| s.damping.stiffness_proportional = 1e-4),
        with("unbalance x 30", &|s| unbalance(s, 30.0)),
        with("dry", &|s| s.mud = None),
        with("dry, unbalance x 30", &|s| {
            s.mud = None;
            unbalance(s, 30.0);
        }),
        with("dry, unbalance x 100, impacts", &|s| {
            s.mud = None;
            unbalance(s, 100.0);
        }),
    ]
}

/// Statistics of a recorded node.
#[derive(Debug, Clone, Copy)]
pub struct Read {
    /// Orbit size, standard deviation of the radius and mean radius \[m\].
    pub size: f64,
    pub deviation: f64,
    pub radius: f64,
    /// Standard deviation of the torsional speed \[rad/s\].
    pub torsion: f64,
}

/// A run and its statistics.
pub struct WholeRun {
    pub records: Records,
    pub summary: TransientSummary,
    pub read: Vec<Read>,
    torsion: Option<UndampedTorsion>,
}

impl WholeRun {
    /// A member of the scenario's ensemble, 0 for the undisturbed run.
    pub fn of(scenario: &Scenario, accuracy: Accuracy, member: u32) -> Self {
        let scenario = Scenario { accuracy, ..scenario.clone() };
        validate(&scenario).expect("valid");
        let model = Model::new(&scenario).expect("has a model");
        let equilibrium = Equilibrium::find(&model).expect("rests");
        let transient = Transient::member(&model, &equilibrium, member).expect("sets up");
        let records = match transient.run(&Control::new()) {
            Ok(Outcome::Finished(records)) => *records,
            other => panic!("did not finish: {other:?}"),
        };
        let samples = window(&records);
        let read = records.histories.iter().map(|history| {
            let orbit = orbit_statistics(&history.u[samples.clone()], &history.v[samples.clone()]);
            let orbit = orbit.expect("samples");
            let speeds = &history.theta_z_rate[samples.clone()];
            let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
            let variance =
                speeds.iter().map(|speed| (speed - mean).powi(2)).sum::<f64>() / speeds.len() as f64;
            Read {
                size: orbit.orbit_radius_rms,
                deviation: orbit.radius_deviation,
                radius: orbit.mean_radius,
                torsion: variance.sqrt(),
            }
        });
        let read = read.collect();
        let Ok(summary) = TransientSummary::new(&model, &records);
        Self { read, summary, torsion: UndampedTorsion::about(&model, &equilibrium), records }
    }

    /// A run by RK4 with steps near the limit of its stability.
    pub fn by_rk4(scenario: &Scenario) -> Self {
        let step = if scenario.contact.stiffness > 5e7 { 5e-5 } else { 1e-4 };
        Self::of(scenario, Accuracy::Explicit(TimeStepping::fixed(Integrator::Rk4, step)), 0)
    }

    /// A run by ESDIRK4 with fixed steps \[s\] and converged contact iterations.
    pub fn by_esdirk4(scenario: &Scenario, step: f64) -> Self {
        let fixed = TimeStepping::fixed(Integrator::Esdirk4, step);
        Self::of(scenario, Accuracy::Explicit(TimeStepping { contact_sweeps: 20, ..fixed }), 0)
    }

    /// The error by steps that a result would state, with other members of its ensemble.
    pub fn time_error(&self, others: &[WholeRun]) -> TimeError {
        let samples = window(&self.records);
        let others: Vec<_> = others
            .iter()
            .map(|other| {
                let Ok(distances) = distances(&self.records.histories, &other.records.histories, &samples);
                OtherMember { summary: other.summary.clone(), distances }
            })
            .collect();
        let mesh = MeshEstimate::Unknown { reason: String::new() };
        ResultErrors::new(&self.summary, &others, None, self.torsion.as_ref(), mesh, None).time
    }
}

/// The largest relative difference of any node: of orbit size, of the standard deviation of the radius, of mean radius, of torsional speed.
pub fn apart(a: &WholeRun, b: &WholeRun) -> [f64; 4] {
    let parts = |read: &Read| [read.size, read.deviation, read.radius, read.torsion];
    a.read.iter().zip(&b.read).fold([0.0; 4], |most, (a, b)| {
        let (a, b) = (parts(a), parts(b));
        std::array::from_fn(|i| most[i].max((a[i] / b[i] - 1.0).abs()))
    })
}

fn window(records: &Records) -> Range<usize> {
    sample_range(WINDOW.from, WINDOW.to, records.rate_hz, records.histories[0].u.len())
}
