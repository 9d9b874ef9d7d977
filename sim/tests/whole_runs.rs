//! Statistics over the window that is read, at the end of whole runs through stick-slip, against a reference that two methods of
//! different kind reach.

use drillsweep_sim::control::Control;
use drillsweep_sim::model::Model;
use drillsweep_sim::scenario::{
    Accuracy, AccuracyPreset, Adhesion, Integrator, NodeChoice, Scenario, Section, SectionKind,
    SurveyStation, TimeStepping, TimeWindow, preset,
};
use drillsweep_sim::signal::{orbit_statistics, sample_range};
use drillsweep_sim::statics::Equilibrium;
use drillsweep_sim::transient::{ContactStatistics, Outcome, Records, Transient};

/// The paper's string without its tool joints, on a coarse mesh, with damping that closes the model. It begins to stick and slip after some
/// ten seconds; what is read is the last third of the run.
fn reduced() -> Scenario {
    let section = |kind, length, outer_diameter, inner_diameter| Section {
        kind,
        count: 1,
        length,
        outer_diameter,
        inner_diameter,
        tool_joint: None,
    };
    let mut scenario = preset("paper-200m").expect("shipped preset");
    scenario.string.sections = vec![
        section(SectionKind::Drillpipe, 93.5, 0.127, 0.108),
        section(SectionKind::Collar, 106.5, 0.159, 0.071),
    ];
    (scenario.mesh.drillpipe, scenario.mesh.collar) = (4.0, 2.2);
    scenario.damping.stiffness_proportional = 3e-5;
    scenario.duration = 30.0;
    scenario.recording.rate_hz = 500.0;
    scenario.recording.nodes = vec![NodeChoice::Depth(40.0), NodeChoice::Depth(150.0)];
    scenario.recording.spectrum_windows.clear();
    scenario.recording.orbit_window = Some(TimeWindow { from: 20.0, to: 30.0 });
    scenario
}

/// Scenes whose friction is as steep as printed or steeper, walls as printed or ten times as hard.
fn scenes() -> Vec<(&'static str, Scenario)> {
    let scene = |name: &'static str, change: &dyn Fn(&mut Scenario)| {
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
    vec![
        scene("base case", &|_| {}),
        scene("heavy mud, fast flow", &|scenario| {
            let mud = scenario.mud.as_mut().expect("mud");
            (mud.flow_rate, mud.density) = (0.04, 2100.0);
        }),
        scene("friction steeper", &|scenario| scenario.contact.friction_reference_speed = 0.02),
        scene("no adhesion", &|scenario| scenario.contact.adhesion = Adhesion::None),
        scene("hard wall", &|scenario| {
            (scenario.contact.stiffness, scenario.contact.damping) = (1e8, 1e5);
        }),
        scene("building well", &|scenario| {
            scenario.well.survey = well([[0.0, 25.0, 0.0], [100.0, 40.0, 10.0], [200.0, 60.0, 15.0]]);
        }),
    ]
}

/// What is read of a recorded node.
#[derive(Debug, Clone, Copy)]
struct Read {
    /// Orbit size, standard deviation of the radius and mean radius \[m\].
    size: f64,
    deviation: f64,
    radius: f64,
    /// Standard deviation of the torsional speed \[rad/s\].
    torsion: f64,
}

fn read(scenario: &Scenario, accuracy: Accuracy) -> (Vec<Read>, Records) {
    let scenario = Scenario { accuracy, ..scenario.clone() };
    scenario.validate().expect("valid");
    let model = Model::new(&scenario).expect("has a model");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let records = match Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new()) {
        Ok(Outcome::Finished(records)) => *records,
        other => panic!("did not finish: {other:?}"),
    };
    let read = records.histories.iter().map(|history| {
        let samples = sample_range(20.0, 30.0, records.rate_hz, history.u.len());
        let orbit =
            orbit_statistics(&history.u[samples.clone()], &history.v[samples.clone()]).expect("samples");
        let speeds = &history.theta_z_rate[samples];
        let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
        let variance = speeds.iter().map(|speed| (speed - mean).powi(2)).sum::<f64>() / speeds.len() as f64;
        Read {
            size: orbit.orbit_radius_rms,
            deviation: orbit.radius_deviation,
            radius: orbit.mean_radius,
            torsion: variance.sqrt(),
        }
    });
    (read.collect(), records)
}

/// The largest relative difference of any node: of orbit size, of the standard deviation of the radius, of mean radius, of torsional speed.
fn apart(a: &[Read], b: &[Read]) -> [f64; 4] {
    let parts = |read: &Read| [read.size, read.deviation, read.radius, read.torsion];
    a.iter().zip(b).fold([0.0; 4], |most, (a, b)| {
        let (a, b) = (parts(a), parts(b));
        std::array::from_fn(|i| most[i].max((a[i] / b[i] - 1.0).abs()))
    })
}

#[test]
fn presets_keep_their_promises_over_whole_runs() {
    let failures: Vec<String> = std::thread::scope(|scope| {
        let workers: Vec<_> = scenes()
            .into_iter()
            .map(|(name, scenario)| scope.spawn(move || check(name, &scenario)))
            .collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("runs")).collect()
    });
    assert!(failures.is_empty(), "{failures:#?}");
}

fn check(name: &str, scenario: &Scenario) -> Vec<String> {
    let explicit = Accuracy::Explicit;
    let (rk4, _) = read(scenario, explicit(TimeStepping::fixed(Integrator::Rk4, 1e-4)));
    let fine = TimeStepping { contact_sweeps: 20, ..TimeStepping::fixed(Integrator::Esdirk4, 5e-4) };
    let (fine, records) = read(scenario, explicit(fine));
    assert!(records.contacts.iter().any(|node| node.capture_count > 0), "{name}: nothing sticks");
    let mut failures = Vec::new();
    // A reference exists where two methods agree within a third of the tightest promise.
    let agreement = apart(&fine, &rk4);
    if !(agreement[0] <= 1e-3 && agreement[1] <= 1e-2 / 3.0) {
        failures.push(format!("{name}: no reference, methods are {agreement:.5?} apart"));
    }
    for (preset, size, deviation) in [
        (AccuracyPreset::Draft, 0.08, 0.15),
        (AccuracyPreset::Standard, 0.02, 0.05),
        (AccuracyPreset::Reference, 0.003, 0.01),
    ] {
        assert_eq!(preset.tolerance(), size);
        let (got, records) = read(scenario, Accuracy::Preset(preset));
        let error = apart(&got, &rk4);
        // Means and torsion are no harder than orbits.
        if !(error[0] <= size && error[1] <= deviation && error[2] <= size && error[3] <= size) {
            failures.push(format!("{name}: {preset:?} errs by {error:.5?} ({:?})", records.effort));
        }
        assert!(records.effort.unresolved_steps == 0, "{name}: {:?}", records.effort);
    }
    failures
}

/// Records are apart from steps: with steps longer than the recording interval every sample is still that of the converged motion.
#[test]
fn samples_within_a_step_are_as_good_as_those_at_its_ends() {
    let mut scenario = reduced();
    (scenario.duration, scenario.recording.orbit_window) = (2.0, None);
    let motion = |rate_hz: f64, step: f64| {
        let mut scenario = scenario.clone();
        scenario.recording.rate_hz = rate_hz;
        scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::Esdirk4, step));
        let model = Model::new(&scenario).expect("has a model");
        let equilibrium = Equilibrium::find(&model).expect("rests");
        let Ok(Outcome::Finished(records)) =
            Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new())
        else {
            panic!("did not finish")
        };
        records.histories
    };
    let (long, fine) = (motion(1000.0, 4e-3), motion(1000.0, 2.5e-4));
    for (long, fine) in long.iter().zip(&fine) {
        let largest = |which: &dyn Fn(usize) -> bool| {
            let samples = (0..fine.u.len()).filter(|k| which(*k));
            samples.map(|k| (long.u[k] - fine.u[k]).hypot(long.v[k] - fine.v[k])).fold(0.0, f64::max)
        };
        let (at_ends, between) = (largest(&|k| k % 4 == 0), largest(&|k| k % 4 != 0));
        assert!(at_ends > 0.0 && between < 1.5 * at_ends, "node {}: {between} and {at_ends}", fine.node + 1);
    }
    // Where samples are step ends they are the same numbers.
    let ends = motion(250.0, 4e-3);
    for (ends, long) in ends.iter().zip(&long) {
        assert!(ends.u.iter().enumerate().all(|(k, u)| *u == long.u[4 * k]), "node {}", ends.node + 1);
    }
}

/// What the wall did is read at the ends of steps, from the law: with steps longer than the recording interval it is still what short
/// steps find, sticking nodes and impacts included.
#[test]
fn contacts_of_long_steps_are_those_of_short_ones() {
    let mut scenario = preset("hard/stick-slip").expect("shipped preset");
    (scenario.duration, scenario.recording.orbit_window) = (3.0, None);
    let contacts = |accuracy: Accuracy| {
        let scenario = Scenario { accuracy, ..scenario.clone() };
        let model = Model::new(&scenario).expect("has a model");
        let equilibrium = Equilibrium::find(&model).expect("rests");
        match Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new()) {
            Ok(Outcome::Finished(records)) => (records.contacts, records.effort.step_range[1]),
            other => panic!("did not finish: {other:?}"),
        }
    };
    let (long, longest) = contacts(Accuracy::Preset(AccuracyPreset::Standard));
    assert_eq!(longest, 4e-3);
    let fine = TimeStepping { contact_sweeps: 20, ..TimeStepping::fixed(Integrator::Esdirk4, 2.5e-4) };
    let (short, _) = contacts(Accuracy::Explicit(fine));
    type Of = fn(&ContactStatistics) -> f64;
    let statistics: [(&str, Of); 4] = [
        ("impulse", |contact| contact.impulse),
        ("contact time", |contact| contact.contact_time),
        ("stick time", |contact| contact.stick_time),
        ("largest force", |contact| contact.largest_normal_force),
    ];
    for (name, of) in statistics {
        // Node by node, relative to the whole string's.
        let apart: f64 = long.iter().zip(&short).map(|(long, short)| (of(long) - of(short)).abs()).sum();
        let apart = apart / short.iter().map(of).sum::<f64>();
        assert!(apart < AccuracyPreset::Standard.tolerance(), "{name}: {apart}");
    }
}
