//! The run in time on the base case: agreement of methods, energy, stability limits, suspension.

use drillsweep_scenario::{
    Accuracy, AccuracyPreset, Effect, Integrator, NodeChoice, Scenario, Switch, TimeStepping, TimeWindow,
    WallLaw, preset,
};
use drillsweep_sim::control::Control;
use drillsweep_sim::math::signal::{PeakSearch, Window, full_spectrum};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{
    Checkpoint, CheckpointError, EnergyRow, Outcome, Records, Transient, TransientError,
};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_study::summary::TransientSummary;

fn base(duration: f64, integrator: Integrator, step: f64) -> Scenario {
    let mut scenario = preset("paper-200m").expect("shipped preset");
    scenario.duration = duration;
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = None;
    scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(integrator, step));
    scenario
}

fn run(scenario: &Scenario) -> Records {
    let model = Model::new(scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    match Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new()) {
        Ok(Outcome::Finished(records)) => *records,
        other => panic!("did not finish: {other:?}"),
    }
}

fn with_all_nodes(mut scenario: Scenario) -> Scenario {
    scenario.recording.nodes = (2..=297).map(NodeChoice::Node).collect();
    scenario
}

/// Relative L2 distance over all nodes' (u, v) and all samples, divided by the reference's motion away from its
/// start.
fn lateral_error(records: &Records, reference: &Records) -> f64 {
    let (mut distance, mut motion) = (0.0, 0.0);
    for (a, b) in records.histories.iter().zip(&reference.histories) {
        for (a, b) in [(&a.u, &b.u), (&a.v, &b.v)] {
            for (x, y) in a.iter().zip(b) {
                distance += (x - y).powi(2);
                motion += (y - b[0]).powi(2);
            }
        }
    }
    (distance / motion).sqrt()
}

#[test]
fn implicit_methods_and_rk4_agree_over_half_a_second_of_the_base_case() {
    let reference = run(&with_all_nodes(base(0.5, Integrator::Rk4, 5e-5)));
    // Errors that an independent program found in another well, so that they hold within a factor of two.
    let methods = [
        (Integrator::GeneralizedAlpha, [(1e-3, 9.8e-4), (5e-4, 4.1e-4), (2.5e-4, 1.7e-4)]),
        (Integrator::Esdirk4, [(1e-3, 6.2e-5), (5e-4, 2.4e-5), (2.5e-4, 1.1e-5)]),
    ];
    for (integrator, figures) in methods {
        let errors = figures.map(|(step, reported)| {
            let error = lateral_error(&run(&with_all_nodes(base(0.5, integrator, step))), &reference);
            assert!(error < 2.0 * reported, "{integrator:?} at {step}: {error:e} against {reported:e}");
            error
        });
        // The jump of the contact's damping holds every method to an order of 1 to 1.3 in the positions
        // (docs/model/motion.md, Order of convergence); a quiet stretch may show the smooth order of 2.
        let order = (errors[0] / errors[2]).log2() / 2.0;
        assert!((0.8..2.3).contains(&order), "{integrator:?}: order {order}, errors {errors:?}");
    }
}

#[test]
fn rk4_with_step_doubling_meets_the_fixed_step() {
    let fixed = run(&with_all_nodes(base(0.1, Integrator::Rk4, 2.5e-5)));
    let mut scenario = with_all_nodes(base(0.1, Integrator::Rk4, 1e-4));
    scenario.accuracy = Accuracy::Explicit(TimeStepping {
        integrator: Integrator::Rk4,
        step: 1e-4,
        contact_sweeps: 2,
        tolerance: Some(1e-8),
        ..TimeStepping::fixed(Integrator::Rk4, 5e-5)
    });
    let adaptive = run(&scenario);
    // 1e-8 of the hole's radius a pair of steps, against a motion of some 1e-4 m.
    assert!(lateral_error(&adaptive, &fixed) < 1e-3, "{}", lateral_error(&adaptive, &fixed));
}

#[test]
fn ledger_closes_and_better_steps_close_it_better() {
    let residual = |integrator, step| {
        let records = run(&base(1.0, integrator, step));
        let last = *records.energy.last().expect("booked at the end");
        assert!((last.time - 1.0).abs() < 1e-12);
        assert!(last["dissipated_structure"] > 0.0 && last["dissipated_fluid"] > 0.0);
        assert!(last["dissipated_friction"] > 0.0 && last["work_rotation"] > 0.0);
        last.residual.abs() / last["contact_work"].abs()
    };
    // With impacts, an independent program's ledgers left 12 % by generalized-alpha and 10 % by ESDIRK4 at 1 ms; this quiet phase
    // closes far better.
    let coarse = residual(Integrator::GeneralizedAlpha, 1e-3);
    let fine = residual(Integrator::GeneralizedAlpha, 2.5e-4);
    assert!(coarse < 0.12 && fine < 0.5 * coarse, "{coarse:e} {fine:e}");
    assert!(residual(Integrator::Esdirk4, 1e-3) < 0.02);
}

#[test]
fn without_any_loss_all_work_of_the_unbalance_is_kept() {
    let mut scenario = base(0.5, Integrator::Rk4, 5e-5);
    for effect in [Effect::Friction, Effect::FrictionTorque, Effect::StructuralDamping, Effect::FluidDamping]
    {
        scenario.effects.set(effect, Switch::Off);
    }
    scenario.mud = None;
    scenario.contact.damping = 0.0;
    for mass in &mut scenario.string.unbalance {
        mass.mass *= 30.0;
    }
    let last = *run(&scenario).energy.last().expect("booked at the end");
    assert!(last["work_unbalance"] > 1.0, "the string moves");
    assert_eq!((last["dissipated_structure"], last["dissipated_fluid"]), (0.0, 0.0));
    assert!(last["dissipated_friction"].abs() < 1e-9, "{}", last["dissipated_friction"]);
    let kept = last.kinetic + last.stored;
    // The torque on bit follows the string, so it may do a little work of its own.
    let given = last["work_unbalance"] + last["work_flow_and_torque"];
    assert!((kept / given - 1.0).abs() < 1e-4, "kept {kept} of {given}");
}

#[test]
fn rk4s_limit_is_the_axial_frequency_of_the_tool_joints() {
    // The highest frequency, axial in the 0.3 m tool joints, is 4.374e4 rad/s by an independent program: 2.785 / 4.374e4 = 6.37e-5 s.
    let scenario = base(0.1, Integrator::Rk4, 7e-5);
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    match Transient::new(&model, &equilibrium).map(|_| ()) {
        Err(TransientError::StepBeyondStability { limit, .. }) => {
            assert!((limit / 6.37e-5 - 1.0).abs() < 0.02, "{limit:e}");
        }
        other => panic!("7e-5 s must be refused: {other:?}"),
    }
}

#[test]
fn stiffer_contact_cuts_the_step_to_keep_two_iterations_stable() {
    let mut scenario = base(0.3, Integrator::GeneralizedAlpha, 5e-4);
    assert_eq!(run(&scenario).effort.subdivisions, 1);
    for (factor, least) in [(10.0, 2), (100.0, 4)] {
        let mut scenario = scenario.clone();
        scenario.contact.stiffness *= factor;
        scenario.contact.damping *= factor;
        let records = run(&scenario);
        assert!(records.effort.subdivisions >= least, "{factor}: {:?}", records.effort);
        let last = records.energy.last().expect("booked");
        assert!(last.residual.abs() < 0.1 * last["contact_work"].abs(), "{factor}: {last:?}");
    }
    // Steps that adapt themselves rely on implicit forces: only the forces of nodes on each other cut the longest.
    scenario.accuracy = Accuracy::Preset(AccuracyPreset::Standard);
    scenario.contact.stiffness *= 100.0;
    scenario.contact.damping *= 100.0;
    let records = run(&scenario);
    let longest = records.effort.stepping.step / f64::from(records.effort.subdivisions);
    assert!(longest >= 9e-4 && records.effort.step_range[1] >= 9e-4, "{:?}", records.effort);
    let last = records.energy.last().expect("booked");
    assert!(last.residual.abs() < 0.1 * last["contact_work"].abs(), "{last:?}");
}

#[test]
fn held_torsion_and_axial_motion_stay_at_their_static_values() {
    let mut scenario = base(0.05, Integrator::Esdirk4, 1e-3);
    scenario.effects.set(Effect::Torsion, Switch::Off);
    scenario.effects.set(Effect::AxialMotion, Switch::Off);
    let records = run(&scenario);
    for history in &records.histories {
        assert!(history.theta_z.iter().all(|&twist| twist == history.theta_z[0]));
        assert!(history.w.iter().all(|&w| w == history.w[0]));
        assert!(history.theta_z_rate.iter().chain(&history.w_rate).all(|&rate| rate == 0.0));
        assert!(history.u.iter().any(|&u| u != history.u[0]), "lateral motion goes on");
    }
}

#[test]
fn effects_that_are_off_leave_no_matrix_behind() {
    let mut scenario = base(0.1, Integrator::Esdirk4, 1e-3);
    for effect in [
        Effect::Gyroscopic,
        Effect::FluidDamping,
        Effect::FluidCoriolis,
        Effect::StructuralDamping,
        Effect::Unbalance,
    ] {
        scenario.effects.set(effect, Switch::Off);
    }
    let model = Model::new(&scenario).expect("valid");
    let system = model.dynamic_system(&Equilibrium::find(&model).expect("rests"));
    let blocks = system.damping.diagonal.iter().chain(&system.damping.upper).chain(&system.damping.lower);
    assert!(blocks.flat_map(|block| block.columns.iter().flatten()).all(|&value| value == 0.0));
}

#[test]
fn suspended_run_goes_on_to_the_same_bits() {
    for (integrator, step) in
        [(Integrator::GeneralizedAlpha, 5e-4), (Integrator::Esdirk4, 1e-3), (Integrator::Rk4, 5e-5)]
    {
        let scenario = base(0.4, integrator, step);
        let whole = run(&scenario);
        let model = Model::new(&scenario).expect("valid");
        let equilibrium = Equilibrium::find(&model).expect("rests");
        let control = Control::observed_by(|control, time| {
            if time >= 0.05 {
                control.suspend();
            }
        });
        let outcome = Transient::new(&model, &equilibrium).expect("sets up").run(&control);
        let Ok(Outcome::Suspended(checkpoint, histories)) = outcome else {
            panic!("not suspended: {outcome:?}")
        };
        assert_eq!(control.simulated_time(), 0.1, "rows of the ledger are 0.1 s apart");
        let bytes = checkpoint.to_bytes();
        let restored = Checkpoint::from_bytes(&bytes).expect("its own bytes");
        let resume = || Transient::resume(&model, &equilibrium, &restored).expect("same scenario");
        let without = resume().run(&Control::new());
        assert!(matches!(without, Err(TransientError::Histories(_))), "{without:?}");
        let resumed = resume().run_on(&Control::new(), histories);
        let Ok(Outcome::Finished(resumed)) = resumed else { panic!("not finished: {resumed:?}") };
        assert_eq!(*resumed, whole, "{integrator:?}");
    }
}

#[test]
fn checkpoint_of_another_scenario_is_refused() {
    let scenario = base(0.1, Integrator::Esdirk4, 1e-3);
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let control = Control::new();
    control.suspend();
    let Ok(Outcome::Suspended(checkpoint, _)) =
        Transient::new(&model, &equilibrium).expect("sets up").run(&control)
    else {
        panic!("not suspended")
    };
    let mut other = scenario.clone();
    other.operation.weight_on_bit = -9e4;
    let other_model = Model::new(&other).expect("valid");
    let other_equilibrium = Equilibrium::find(&other_model).expect("rests");
    let refused = Transient::resume(&other_model, &other_equilibrium, &checkpoint).map(|_| ());
    assert_eq!(refused, Err(CheckpointError::OtherScenario));
    assert!(matches!(Checkpoint::from_bytes(b"not a checkpoint"), Err(CheckpointError::Malformed(_))));
}

#[test]
fn cancelled_run_ends_without_a_result() {
    let scenario = base(10.0, Integrator::Esdirk4, 1e-3);
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let control = Control::new();
    control.cancel();
    let outcome = Transient::new(&model, &equilibrium).expect("sets up").run(&control);
    assert!(matches!(outcome, Ok(Outcome::Cancelled)));
}

#[test]
fn divergence_names_time_node_and_reason() {
    // A wall that pulls ever harder on whatever leaves it cannot hold: negative damping of the contact is refused by
    // validation, so it is reached here past it.
    let mut scenario = base(2.0, Integrator::Esdirk4, 1e-3);
    scenario.contact.damping = -3e5;
    let model = Model::new(&scenario).expect("meshes");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    match Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new()) {
        Err(TransientError::Diverged { time, node, measured_depth, .. }) => {
            assert!((0.0..2.0).contains(&time));
            assert!((1..=297).contains(&node));
            assert!((0.0..=200.0).contains(&measured_depth));
        }
        other => panic!("must diverge: {other:?}"),
    }
}

#[test]
fn a_disturbance_that_no_step_resolves_is_no_failure() {
    // A string that hangs still, disturbed by a micrometre: nothing excites it, and an L-stable method damps the part of the disturbance at
    // frequencies beyond those that the steps resolve.
    let mut scenario = preset("hard/vertical").expect("shipped preset");
    scenario.string.unbalance.clear();
    let operation = &mut scenario.operation;
    (operation.rotation_speed_rpm, operation.weight_on_bit, operation.torque_on_bit) = (0.0, 0.0, 0.0);
    (scenario.contact.static_friction, scenario.contact.dynamic_friction) = (0.0, 0.0);
    (scenario.duration, scenario.recording.orbit_window) = (1.0, None);
    scenario.recording.spectrum_windows = Some(Vec::new());
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("hangs");
    let outcome = Transient::member(&model, &equilibrium, 1).expect("sets up").run(&Control::new());
    let Ok(Outcome::Finished(records)) = outcome else { panic!("not finished: {outcome:?}") };
    let energy = |row: &EnergyRow| row.kinetic + row.stored;
    let (first, last) = (records.energy.first().expect("booked"), records.energy.last().expect("booked"));
    assert!(energy(last) < energy(first), "{last:?}");
    assert!(last.residual.abs() <= records.energy_bound, "{last:?}");
    assert!(records.contacts.iter().all(|contact| contact.largest_radius() < 2e-6));
}

/// Amplitude of a history at `frequency_hz` over [from, from + 4) s, under a Hann window with the drift taken out.
fn amplitude_at(values: &[f64], rate_hz: f64, from: f64, frequency_hz: f64) -> f64 {
    let samples = &values[(from * rate_hz) as usize..((from + 4.0) * rate_hz) as usize];
    let n = samples.len() as f64;
    let (middle, mean) = (0.5 * (n - 1.0), samples.iter().sum::<f64>() / n);
    let drift: f64 = samples.iter().enumerate().map(|(k, x)| (k as f64 - middle) * x).sum();
    let slope = drift / samples.iter().enumerate().map(|(k, _)| (k as f64 - middle).powi(2)).sum::<f64>();
    let (mut real, mut imaginary, mut weights) = (0.0, 0.0, 0.0);
    for (k, x) in samples.iter().enumerate() {
        let weight = 1.0 - (std::f64::consts::TAU * k as f64 / n).cos();
        let angle = std::f64::consts::TAU * frequency_hz * k as f64 / rate_hz;
        let value = weight * (x - mean - slope * (k as f64 - middle));
        real += value * angle.cos();
        imaginary += value * angle.sin();
        weights += weight;
    }
    2.0 * real.hypot(imaginary) / weights
}

#[test]
fn velocity_weakening_friction_excites_torsion_to_stick_slip() {
    let mut scenario = base(24.0, Integrator::GeneralizedAlpha, 5e-4);
    scenario.recording.nodes = vec![NodeChoice::Node(282)];
    let records = run(&scenario);
    let (twist, rate) = (&records.histories[0].theta_z, &records.histories[0].theta_z_rate);
    // One mode below 10 Hz, 2.16 Hz, growing with 0.09 1/s; stick-slip from about 14 s on (docs/model/contact.md, Friction curve).
    let amplitude = |from: f64| amplitude_at(twist, records.rate_hz, from, 2.16);
    let growth = (amplitude(12.0) / amplitude(4.0)).ln() / 8.0;
    assert!((growth - 0.09).abs() < 0.02, "growth {growth} 1/s");
    let neighbours =
        [amplitude_at(twist, records.rate_hz, 12.0, 1.4), amplitude_at(twist, records.rate_hz, 12.0, 2.9)];
    assert!(neighbours.iter().all(|&other| other < 0.1 * amplitude(12.0)), "{neighbours:?}");
    // Sticking: the twist's rate cancels the rotation, and never reverses the sliding by more than a small overshoot.
    let rotation_speed = 2.0 * std::f64::consts::TAU;
    let slowest =
        |from: usize, to: usize| rate[from * 1000..to * 1000].iter().fold(f64::INFINITY, |m, r| m.min(*r));
    assert!(slowest(4, 8) > -0.5 * rotation_speed, "slides all the time at first: {}", slowest(4, 8));
    assert!((slowest(20, 24) / rotation_speed + 1.0).abs() < 0.1, "sticks: {}", slowest(20, 24));
}

#[test]
fn without_friction_nothing_but_the_unbalance_moves_the_string() {
    // Friction excites self-excited motion: without it the string answers at the speed of rotation, 2 Hz, and,
    // through the wall, at its multiples.
    let mut scenario = base(30.0, Integrator::GeneralizedAlpha, 5e-4);
    scenario.effects.set(Effect::Friction, Switch::Off);
    scenario.effects.set(Effect::FrictionTorque, Switch::Off);
    scenario.recording.nodes = vec![NodeChoice::Node(49)];
    let records = run(&scenario);
    let history = &records.histories[0];
    let (u, v) = (&history.u[20_000..], &history.v[20_000..]);
    let spectrum = full_spectrum(u, v, records.rate_hz, Window::Hann).restricted_to(&(-30.0..=30.0));
    let search = PeakSearch { count: 4, min_separation_hz: 0.5, exclude_mean: true };
    let peaks = spectrum.peaks(&search);
    for peak in &peaks {
        // Bins are 0.1 Hz wide.
        assert!((peak.frequency_hz / 2.0 - (peak.frequency_hz / 2.0).round()).abs() < 0.05, "{peaks:?}");
    }
    assert!((peaks[0].frequency_hz.abs() - 2.0).abs() < 0.1 && peaks[0].amplitude > 1e-4, "{peaks:?}");
}

#[test]
fn a_string_at_rest_leans_on_the_wall_with_its_static_normal_forces_over_the_orbit_window() {
    // Nothing moves it: no unbalance, no friction.
    for (integrator, step) in
        [(Integrator::GeneralizedAlpha, 5e-4), (Integrator::Esdirk4, 1e-3), (Integrator::Rk4, 5e-5)]
    {
        let mut scenario = base(0.06, integrator, step);
        for effect in [Effect::Friction, Effect::FrictionTorque, Effect::Unbalance] {
            scenario.effects.set(effect, Switch::Off);
        }
        scenario.recording.orbit_window = Some(TimeWindow { from: 0.01, to: 0.05 }.into());
        let model = Model::new(&scenario).expect("valid");
        let at_rest: f64 = Equilibrium::find(&model).expect("rests").normal_force.iter().sum();
        let records = run(&scenario);
        let impulse: f64 = records.contacts.iter().map(|contact| contact.impulse).sum();
        // The equilibrium is Newton's, to eight digits of the forces.
        assert!(
            (impulse / 0.04 / at_rest - 1.0).abs() < 1e-6,
            "{integrator:?}: {impulse} N s of {at_rest} N"
        );
        // The last digits of the equilibrium move it, but that is no work to measure the balance by.
        let Ok(summary) = TransientSummary::new(&model, &records);
        assert_eq!(summary.energy_residual_ratio, None, "{integrator:?}: {:?}", records.energy.last());
    }
}

#[test]
fn members_of_an_ensemble_differ_by_next_to_nothing_before_they_part() {
    let scenario = base(0.2, Integrator::Esdirk4, 1e-3);
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let member =
        |number| match Transient::member(&model, &equilibrium, number).expect("sets up").run(&Control::new())
        {
            Ok(Outcome::Finished(records)) => *records,
            other => panic!("did not finish: {other:?}"),
        };
    let (first, second) = (member(0), member(1));
    assert_eq!(first, run(&scenario), "the first member is the run itself");
    assert_ne!(first.histories, second.histories);
    let largest = first
        .histories
        .iter()
        .zip(&second.histories)
        .flat_map(|(a, b)| a.u.iter().zip(&b.u).map(|(a, b)| (a - b).abs()));
    // 1e-6 m at the start; the wall's springs give back as much, not more, in a fraction of a second.
    assert!(largest.fold(0.0, f64::max) < 5e-6);
}

#[test]
fn stiffness_by_length_makes_the_wall_the_same_for_every_mesh() {
    let statics = |factor: f64, law: WallLaw| {
        let mut scenario = preset("paper-200m").expect("shipped preset");
        scenario.contact.law = law;
        scenario.scale_mesh(factor);
        let model = Model::new(&scenario).expect("valid");
        let equilibrium = Equilibrium::find(&model).expect("rests");
        // Mean penetration of the collars, which lie on the wall along most of their length.
        let nodes = model.mesh.nodes.iter().zip(&equilibrium.displacement);
        let penetrations: Vec<f64> = nodes
            .filter(|(node, _)| (95.0..120.0).contains(&node.measured_depth))
            .map(|(node, x)| x[0].hypot(x[1]) - node.clearance)
            .filter(|&penetration| penetration > 0.0)
            .collect();
        penetrations.iter().sum::<f64>() / penetrations.len() as f64
    };
    let change = |law| statics(0.5, law) / statics(1.0, law);
    // A node's stiffness: half the load on each of twice as many nodes. By length: the same penetration.
    assert!((change(WallLaw::PerNode) - 0.5).abs() < 0.05, "{}", change(WallLaw::PerNode));
    assert!((change(WallLaw::PerLength) - 1.0).abs() < 0.05, "{}", change(WallLaw::PerLength));
}

#[test]
fn velocity_weakening_friction_excites_undamped_torsion_at_some_kilohertz() {
    // Slow rotation lies on the steep part of the friction curve. At 0.0625 ms ESDIRK4 damps nothing at 3.7 kHz, the torsion of
    // single elements by the first collar, and the ledger shows it; a stiffness-proportional damping of 1e-6 s (0.3 % of critical at 1
    // kHz, 1e-5 of it at 2 Hz), or no friction torque, leaves it closed.
    let residual = |change: &dyn Fn(&mut Scenario)| {
        let mut scenario = base(0.5, Integrator::Esdirk4, 6.25e-5);
        scenario.operation.rotation_speed_rpm = 40.0;
        change(&mut scenario);
        run(&scenario).energy.last().expect("rows").residual.abs()
    };
    let driven = residual(&|_| {});
    let damped = residual(&|scenario| scenario.damping.stiffness_proportional = 1e-6);
    let without_torque = residual(&|scenario| scenario.effects.set(Effect::FrictionTorque, Switch::Off));
    assert!(driven > 1e3 * damped && driven > 1e3 * without_torque, "{driven} {damped} {without_torque}");
}

/// The implicit methods read only half of the mass matrix.
#[test]
fn mass_is_symmetric_to_rounding_with_and_without_held_motions() {
    for held in [None, Some(Effect::Torsion), Some(Effect::AxialMotion)] {
        let mut scenario = base(1.0, Integrator::Esdirk4, 1e-3);
        if let Some(effect) = held {
            scenario.effects.set(effect, Switch::Off);
        }
        let model = Model::new(&scenario).unwrap();
        let mass = model.dynamic_system(&Equilibrium::find(&model).unwrap()).mass;
        for row in 0..mass.rows() {
            for i in 0..6 {
                for j in 0..6 {
                    let mut pairs = vec![(mass.diagonal[row][(i, j)], mass.diagonal[row][(j, i)])];
                    if row + 1 < mass.rows() {
                        pairs.push((mass.upper[row][(i, j)], mass.lower[row + 1][(j, i)]));
                    }
                    for (above, below) in pairs {
                        // Rounding of sums of a few terms; the entries of a node's own mass are up to 77 kg.
                        assert!(
                            (above - below).abs() < 1e-12,
                            "{held:?}: row {row}, ({i}, {j}): {above} {below}"
                        );
                    }
                }
            }
        }
    }
}
