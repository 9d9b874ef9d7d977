//! Roots of a string of 1,000 m against published values, independent computations and finite elements.

use std::f64::consts::{PI, TAU};

use drillsweep_scenario::{Scenario, TopDrive, TopDriveKind, Tuning, preset};
use nalgebra::{Complex, DMatrix};
use serde_json::{Value, json};

use super::chain::{AxialTop, Chain, Part, Top};
use super::feedback::Feedback;
use super::grid::{StabilityError, StabilityGrid, chains, stability_map, table};
use super::roots::growing;
use super::table::Table;
use crate::solve::model::Model;
use crate::solve::modes::{Pencil, Receptance};
use crate::solve::statics::Equilibrium;

/// 850 m of 127/108 mm above 150 m of 159/71 mm, vertical, without contact, on 17 and 6 elements over `finer`.
fn string(finer: f64) -> Scenario {
    let changes = [
        (
            "well.survey",
            json!(
                [0.0, 1000.0].map(
                    |depth| json!({ "measured_depth": depth, "inclination_deg": 0.0, "azimuth_deg": 0.0 })
                )
            ),
        ),
        ("well.hole_diameter", json!(0.2159)),
        (
            "string.sections",
            json!([
                { "kind": "drillpipe", "length": 850.0, "outer_diameter": 0.127, "inner_diameter": 0.108 },
                { "kind": "collar", "length": 150.0, "outer_diameter": 0.159, "inner_diameter": 0.071 },
            ]),
        ),
        ("string.unbalance", json!([])),
        ("string.gauges", json!([])),
        ("recording.nodes", json!([])),
        ("operation.weight_on_bit", json!(-1e5)),
        ("operation.torque_on_bit", json!(-5e3)),
        ("operation.rotation_speed_rpm", json!(120.0)),
        ("damping", json!({ "mass_proportional": 0.03, "stiffness_proportional": 1e-3 })),
        ("effects", json!({ "contact": "off" })),
        (
            "mesh",
            json!({ "drillpipe": 50.0 / finer, "tool_joint": 1.0, "collar": 25.0 / finer, "stabilizer": 25.0, "bit": 25.0 }),
        ),
    ];
    changes
        .into_iter()
        .fold(preset("paper-200m").unwrap(), |scenario, (path, value)| scenario.with(path, value).unwrap())
}

/// The same with the published bit that cuts.
fn cutting(finer: f64) -> Scenario {
    let bit = json!({
        "law": "regenerative", "specific_energy": 1.2e8, "inclination": 0.6, "contact_stress": 6e7,
        "wear_length": 0.01, "friction_geometry": 0.6, "blades": 5,
    });
    let scenario = string(finer).with("bit", bit).unwrap();
    scenario.with("operation.torque_on_bit", json!(0.0)).unwrap()
}

/// Depth of cut \[m\] of the published case: 9.0648e-3 m/s at 120 rpm.
const DEPTH_OF_CUT: f64 = 9.0648e-3 / 2.0;

fn published_cut(speed: f64) -> (Scenario, Feedback) {
    let scenario = cutting(1.0);
    let radius = scenario.bit_radius();
    let weight = radius * (0.6 * 1.2e8 * DEPTH_OF_CUT + 0.01 * 6e7);
    assert!((weight - 99_998.0).abs() < 1.0);
    let cut = scenario.bit.steady_cut(radius, weight).unwrap();
    let feedback = Feedback::regenerative(&scenario.bit, radius, cut, speed);
    (scenario, feedback)
}

fn model(scenario: &Scenario) -> (Model, Equilibrium) {
    let model = Model::new(scenario).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    (model, equilibrium)
}

fn table_of(scenario: &Scenario, axial_top: AxialTop) -> Table {
    let model = Model::new(scenario).unwrap();
    table(chains(&model, &vec![0.0; model.node_count()], axial_top), 0.2).unwrap()
}

fn rpm(speed: f64) -> f64 {
    speed * PI / 30.0
}

fn near(found: &[Complex<f64>], wanted: &[(f64, f64)], tolerance: f64) {
    let mut found = found.to_vec();
    found.sort_by(|a, b| b.re.total_cmp(&a.re));
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    for (found, (growth, frequency)) in found.iter().zip(wanted) {
        assert!(
            (found - Complex::new(*growth, *frequency)).norm() < tolerance,
            "{found} {growth} {frequency}"
        );
    }
}

#[test]
fn a_cutting_bit_has_the_roots_of_an_independent_wave_solution() {
    let (scenario, feedback) = published_cut(rpm(120.0));
    let advance = growing(&table_of(&scenario, AxialTop::Advance), false, &feedback);
    // Published to five decimals.
    near(&advance.found, &[(1.90479, 43.48404), (0.06055, 116.11500)], 2e-5);
    assert!(advance.is_bounded && advance.counted == Some(4), "{advance:?}");
    let free = table_of(&scenario, AxialTop::HookLoad);
    let hook_load = growing(&free, true, &feedback);
    let wanted = [(1.05529, 39.55610), (0.83198, 115.55344), (0.77312, 48.73289)];
    near(&hook_load.found, &wanted, 2e-5);
    assert!(hook_load.is_bounded && hook_load.counted == Some(6), "{hook_load:?}");
    for speed in [180.0, 200.0, 220.0] {
        let none = growing(&free, true, &published_cut(rpm(speed)).1);
        assert!(none.is_bounded && none.counted == Some(0), "{speed} rpm: {none:?}");
    }
}

#[test]
fn a_rigid_mass_under_its_hook_load_is_stable_above_its_published_speed() {
    // A rod so short and stiff that it is rigid below 3e5 rad/s, and a shaft that does not turn.
    let (mass, blades) = (34_000.0, 6.0);
    let part = |impedance| Part { travel_time: 1e-5, impedance, damper: 0.0 };
    let chains =
        [Chain::new(Top::Free, [part(mass / 1e-5)], [0.0; 2]), Chain::new(Top::Held, [part(1e12)], [0.0; 2])];
    let table = Table::new(chains, 400.0, 0.2).unwrap();
    let of_speed = |speed: f64| {
        let feedback =
            Feedback::Regenerative { stiffness: 2.3328e7, coupling: 0.0, delay: TAU / (blades * rpm(speed)) };
        growing(&table, true, &feedback)
    };
    // 2 sqrt(2 K / m) / n.
    let critical = 2.0 * (2.0 * 2.3328e7 / mass).sqrt() / blades * 30.0 / PI;
    assert!((critical - 117.914).abs() < 5e-4, "{critical}");
    assert_eq!(of_speed(critical * 1.0001).counted, Some(0));
    assert_eq!(of_speed(critical * 0.9999).counted, Some(2));
    near(&of_speed(0.9 * critical).found, &[(1.68466, 35.5245)], 5e-5);
}

#[test]
fn a_bit_of_falling_torque_has_the_published_roots_and_critical_speeds() {
    let mut scenario = string(1.0).with("bit.law", json!("velocity_weakening")).unwrap();
    let map = |scenario: &Scenario, speeds: Vec<f64>| {
        let (model, equilibrium) = model(scenario);
        let grid = StabilityGrid { speeds, weights: vec![1e5], axial_top: AxialTop::Advance };
        stability_map::<StabilityError>(scenario, &model, &equilibrium, &grid, || Ok(())).unwrap()
    };
    let roots =
        growing(&table_of(&scenario, AxialTop::Advance), false, &Feedback::Weakening { slope: 101.741 });
    // Of the wave solution in an independent program.
    near(&roots.found, &[(0.486531, 3.300400), (0.035779, 12.663423)], 2e-6);
    // The published ones are of 17 and 6 elements, which change the second frequency by (omega h / c)^2 / 24.
    near(&roots.found, &[(0.48664, 3.30055), (0.03587, 12.6822)], 2e-2);
    let point = map(&scenario, vec![120.0]).points[0];
    assert_eq!(point.growing, Some(2), "{point:?}");
    assert!((point.growth_rate.unwrap() / 0.48664 - 1.0).abs() < 2e-3, "{point:?}");
    assert!((point.frequency_hz.unwrap() * TAU / 3.30055 - 1.0).abs() < 2e-4, "{point:?}");
    assert!((point.torque_on_bit - 5e3).abs() < 1e-9 && point.complete, "{point:?}");
    let soft = |gain, compensation| TopDrive {
        kind: TopDriveKind::SpeedControl,
        tuning: Tuning::Soft,
        gain,
        inertia_compensation: compensation,
        ..TopDrive::default()
    };
    for (drive, critical) in [
        (TopDrive::default(), 334.1),
        (soft(1.0, 0.0), 256.6),
        (soft(1.0, 0.9), 146.4),
        (soft(4.0, 0.9), 107.4),
    ] {
        scenario.top_drive = drive;
        // Half of a thousandth either way: of the last digit, and of the mesh of the published ones.
        let found = map(&scenario, vec![0.9985 * critical, 1.0015 * critical]).points;
        assert!(found[0].growing > Some(0) && found[1].growing == Some(0), "{critical}: {found:?}");
    }
}

#[test]
fn each_mode_has_its_critical_slope() {
    // 1 / Re(s H_t) where H_t is imaginary-free: 4.14 N m s/rad at 0.530 Hz, 73.89 at 2.016 Hz.
    let table = table_of(&string(1.0), AxialTop::Advance);
    let count = |slope| growing(&table, false, &Feedback::Weakening { slope }).counted;
    assert_eq!([4.13, 4.15].map(count), [Some(0), Some(2)]);
    assert_eq!([73.6, 74.2].map(count), [Some(2), Some(4)]);
    let found = growing(&table, false, &Feedback::Weakening { slope: 4.15 }).found;
    assert!((found[0].im / TAU - 0.530).abs() < 5e-4, "{found:?}");
}

#[test]
fn finite_elements_converge_to_the_waves_with_their_order() {
    let (scenario, feedback) = published_cut(rpm(120.0));
    let exact = growing(&table_of(&scenario, AxialTop::Advance), false, &feedback).found;
    for root in exact {
        let shift = |finer: f64| {
            let (model, equilibrium) = model(&string(finer));
            let pencil = Pencil::about(&model, &equilibrium);
            let function = |s: Complex<f64>| {
                let [axial, torsional] = Receptance::at(&pencil, s).unwrap().of_bit();
                let [p, q] = feedback.at(s);
                p * axial[0] + q * torsional[1] + 1.0
            };
            let (mut before, mut here) = (root, root + 1e-3);
            let mut of_before = function(before);
            for _ in 0..12 {
                let of_here = function(here);
                let change = of_here * (here - before) / (of_here - of_before);
                (before, of_before) = (here, of_here);
                here -= change;
                if change.norm() < 1e-10 {
                    break;
                }
            }
            (here - root).norm()
        };
        let [coarse, fine, finest] = [4.0, 8.0, 16.0].map(shift);
        // Linear elements are of second order in their length.
        for ratio in [coarse / fine, fine / finest] {
            assert!((3.8..4.2).contains(&ratio), "{root}: {coarse} {fine} {finest}");
        }
        assert!(finest < 0.02, "{root}: {finest}");
    }
}

/// Growing eigenvalues of rod and shaft of linear elements with the history of the bit at Chebyshev points of the delay: one matrix.
fn eigenvalues_with_history(
    elements: usize,
    length: f64,
    [rod, shaft]: [(f64, f64); 2],
    rayleigh: [f64; 2],
    feedback: &Feedback,
) -> Vec<Complex<f64>> {
    const HISTORY: usize = 24;
    let Feedback::Regenerative { stiffness, coupling, delay } = *feedback else { panic!("a delay") };
    let count = 2 * elements;
    let h = length / elements as f64;
    let [mut mass, mut elastic] = [(); 2].map(|()| DMatrix::<f64>::zeros(count, count));
    for (first, (impedance, speed)) in [(0, rod), (elements, shaft)] {
        let (inertia, spring) = (impedance / speed * h, impedance * speed / h);
        for element in 0..elements {
            let ends = [element.checked_sub(1).map(|above| first + above), Some(first + element)];
            for (i, row) in ends.iter().enumerate() {
                for (j, column) in ends.iter().enumerate() {
                    if let (Some(row), Some(column)) = (row, column) {
                        mass[(*row, *column)] += inertia / if i == j { 3.0 } else { 6.0 };
                        elastic[(*row, *column)] += if i == j { spring } else { -spring };
                    }
                }
            }
        }
    }
    let damping = &mass * rayleigh[0] + &elastic * rayleigh[1];
    let inverse = mass.try_inverse().unwrap();
    // Unknowns: motion, speeds, and y = w - (V0 / Omega) theta of the bit at the points after the present one.
    let size = 2 * count + HISTORY;
    let mut matrix = DMatrix::<f64>::zeros(size, size);
    let (of_bit, of_twist) = (elements - 1, count - 1);
    // dW = K (y - y_tau), dT = dW a / (2 zeta): with twist in another unit V0 / Omega and a / (2 zeta) are both the square root of their product.
    let share = coupling.sqrt();
    let mut of_weight = elastic.clone();
    let mut of_delay = DMatrix::<f64>::zeros(count, 1);
    for (row, load) in [(of_bit, 1.0), (of_twist, share)] {
        of_weight[(row, of_bit)] += stiffness * load;
        of_weight[(row, of_twist)] -= stiffness * load * share;
        of_delay[(row, 0)] = -stiffness * load;
    }
    let [accelerations, damped, delayed] =
        [-(&inverse * of_weight), -(&inverse * damping), -(&inverse * of_delay)];
    for i in 0..count {
        matrix[(i, count + i)] = 1.0;
        for j in 0..count {
            matrix[(count + i, j)] = accelerations[(i, j)];
            matrix[(count + i, count + j)] = damped[(i, j)];
        }
        matrix[(count + i, size - 1)] = delayed[(i, 0)];
    }
    // Differentiation over theta = cos(k pi / N) (Trefethen), from the present (k = 0) to the delay (k = N).
    let x: Vec<f64> = (0..=HISTORY).map(|k| (k as f64 * PI / HISTORY as f64).cos()).collect();
    let c = |k: usize| if k == 0 || k == HISTORY { 2.0 } else { 1.0 } * if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    for i in 1..=HISTORY {
        let mut diagonal = 0.0;
        for j in (0..=HISTORY).filter(|j| *j != i) {
            let entry = c(i) / c(j) / (x[i] - x[j]) * 2.0 / delay;
            diagonal -= entry;
            if j == 0 {
                matrix[(2 * count + i - 1, of_bit)] += entry;
                matrix[(2 * count + i - 1, of_twist)] -= entry * share;
            } else {
                matrix[(2 * count + i - 1, 2 * count + j - 1)] += entry;
            }
        }
        matrix[(2 * count + i - 1, 2 * count + i - 1)] += diagonal;
    }
    let mut found: Vec<Complex<f64>> = matrix
        .complex_eigenvalues()
        .iter()
        .filter(|value| value.re > 1e-6 && value.im >= 0.0)
        .map(|value| Complex::new(value.re, value.im))
        .collect();
    found.sort_by(|a, b| b.re.total_cmp(&a.re));
    found
}

#[test]
fn roots_are_the_eigenvalues_of_a_small_system_with_its_history() {
    // A uniform pipe of 300 m.
    let (length, rod, shaft) = (300.0, (1.4e5, 5172.0), (302.6, 3207.0));
    let rayleigh = [0.1, 2e-3];
    let part = |(impedance, speed): (f64, f64)| Part { travel_time: length / speed, impedance, damper: 0.0 };
    let chains = [rod, shaft].map(|wave| Chain::new(Top::Held, [part(wave)], rayleigh));
    let table = Table::new(chains, 1500.0, 0.3).unwrap();
    let mut total = 0;
    for (stiffness, coupling, delay) in [
        (2e7, 6e-5, 0.1),
        (2e7, 3e-4, 0.06),
        (5e6, 1e-5, 0.2),
        (1e7, 1e-3, 0.04),
        (1e6, 1e-4, 0.3),
        (4e7, 2e-6, 0.05),
    ] {
        let feedback = Feedback::Regenerative { stiffness, coupling, delay };
        let exact = growing(&table, false, &feedback);
        let [coarse, fine] = [30, 60]
            .map(|elements| eigenvalues_with_history(elements, length, [rod, shaft], rayleigh, &feedback));
        let mut waves = exact.found.clone();
        waves.sort_by(|a, b| b.re.total_cmp(&a.re));
        // Roots close to neutral may differ by the mesh.
        let clear = |roots: &[Complex<f64>]| roots.iter().filter(|root| root.re > 0.05).count();
        assert_eq!(exact.counted, Some(exact.found_with_conjugates()), "{feedback:?}: {exact:?}");
        assert_eq!(clear(&waves), clear(&fine), "{feedback:?}: {waves:?} against {fine:?}");
        for (i, wave) in waves.iter().take(clear(&waves)).enumerate() {
            // Second order: a third of the difference between both meshes remains.
            let nearest = |roots: &[Complex<f64>]| {
                roots.iter().copied().min_by(|a, b| (a - wave).norm().total_cmp(&(b - wave).norm())).unwrap()
            };
            let [coarse, fine] = [nearest(&coarse), nearest(&fine)];
            let extrapolated = fine + (fine - coarse) / 3.0;
            let left = (extrapolated - wave).norm();
            assert!(left < 0.1 * (fine - coarse).norm() + 1e-6, "{feedback:?}, {i}: {wave} {fine} {coarse}");
            total += 1;
        }
    }
    assert!(total >= 6, "{total} roots are few");
}

#[test]
fn all_roots_that_are_counted_are_found() {
    // Parts, damping and feedback at random, by a linear congruential generator.
    let mut state = 12_345_u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for _ in 0..10 {
        let rayleigh = [0.1 * draw(), 10.0_f64.powf(3.0 * draw() - 5.5)];
        let damper = if draw() < 0.5 { 0.0 } else { 10.0 * draw() };
        let parts: Vec<(f64, f64)> =
            (0..1 + (6.0 * draw()) as usize).map(|_| (20.0 + 300.0 * draw(), 1.0 + 4.0 * draw())).collect();
        let chain = |speed: f64, impedance: f64, damper: f64, top| {
            let part = |&(length, thicker): &(f64, f64)| Part {
                travel_time: length / speed,
                impedance: impedance * thicker,
                damper,
            };
            Chain::new(top, parts.iter().map(part).collect::<Vec<_>>(), rayleigh)
        };
        let is_free = draw() < 0.5;
        let top = if is_free { Top::Free } else { Top::Held };
        let chains = [chain(5172.0, 1.4e5, 0.0, top), chain(3207.0, 302.6, damper, Top::Held)];
        let table = Table::new(chains, 800.0, 0.4).unwrap();
        assert_eq!(table.own_growing, 0, "dampers take energy");
        for case in 0..12 {
            let feedback = match case % 3 {
                0 => Feedback::Weakening { slope: 200.0 * draw() },
                _ => Feedback::Regenerative {
                    stiffness: 10.0_f64.powf(6.0 + 2.0 * draw()),
                    coupling: 10.0_f64.powf(3.0 * draw() - 6.0),
                    delay: 0.02 + 0.3 * draw(),
                },
            };
            let found = growing(&table, is_free, &feedback);
            assert_eq!(found.counted, Some(found.found_with_conjugates()), "{feedback:?} {found:?}");
        }
    }
}

#[test]
fn dampers_that_excite_make_the_string_grow_by_itself() {
    // A uniform shaft with a damper at its end has the growth of artanh(d / Z) over its travel time in every mode.
    let (travel_time, impedance) = (0.1, 300.0);
    let part = |damper| Part { travel_time, impedance, damper };
    let own = |damper, highest: f64| {
        let chains =
            [Chain::new(Top::Held, [part(0.0)], [0.1, 0.0]), Chain::new(Top::Held, [part(damper)], [0.0; 2])];
        let table = Table::new(chains, highest, 0.1).unwrap();
        let neutral = Feedback::Weakening { slope: 0.0 };
        (table.highest(), growing(&table, false, &neutral))
    };
    let (highest, found) = own(-30.0, 200.0);
    // Frequencies (k + 1/2) pi / 0.1 s.
    let wanted = (highest * travel_time / PI + 0.5).floor() as i64;
    assert_eq!(found.counted, Some(2 * wanted));
    assert_eq!(found.found.len() as i64, wanted);
    for root in found.found {
        assert!((root.re - (0.1_f64).atanh() / travel_time).abs() < 1e-7, "{root}");
    }
    assert_eq!(own(30.0, 200.0).1.counted, Some(0));
}

#[test]
fn a_long_delay_lowers_the_frequencies_of_a_table_and_not_its_bound() {
    let (model, _) = model(&cutting(1.0));
    let still = vec![0.0; model.node_count()];
    for delay in [1.0, 1e2, 1e4, 1e6] {
        let table = table(chains(&model, &still, AxialTop::Advance), delay).unwrap();
        assert!(table.products.len() < 66_000, "{delay} s: {}", table.products.len());
        assert!(table.highest() * delay < 0.41 * 66_000.0, "{delay} s: {}", table.highest());
    }
}

#[test]
fn grids_out_of_range_and_bits_that_do_not_drill_are_refused() {
    let scenario = cutting(1.0);
    let (model, equilibrium) = model(&scenario);
    let refused = |scenario: &Scenario, speeds: Vec<f64>, weights: Vec<f64>| {
        let grid = StabilityGrid { speeds, weights, axial_top: AxialTop::Advance };
        stability_map::<StabilityError>(scenario, &model, &equilibrium, &grid, || Ok(())).unwrap_err()
    };
    assert_eq!(refused(&scenario, vec![], vec![1e5]), StabilityError::Empty);
    assert_eq!(refused(&scenario, vec![120.0; 101], vec![1e5; 100]), StabilityError::TooManyPoints(10_100));
    assert!(matches!(refused(&scenario, vec![f64::NAN], vec![1e5]), StabilityError::Speed { .. }));
    assert!(matches!(refused(&scenario, vec![0.5], vec![1e5]), StabilityError::Speed { .. }));
    assert_eq!(refused(&scenario, vec![120.0], vec![-1e5]), StabilityError::Weight(-1e5));
    assert!(matches!(refused(&scenario, vec![120.0], vec![6e4]), StabilityError::DoesNotDrill { .. }));
    let constant = scenario.with("bit.law", Value::from("constant")).unwrap();
    assert_eq!(refused(&constant, vec![120.0], vec![1e5]), StabilityError::ConstantTorque);
}
