use drillsweep_scenario::{HoleSection, Hydraulics, Mud, PressureLosses, Scenario, preset};

use super::*;
use crate::solve::model::Model;
use crate::solve::statics::Equilibrium;

fn solved(scenario: &Scenario) -> (Model, Equilibrium, Circuit) {
    let model = Model::new(scenario).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    let circuit = Circuit::new(&model, &equilibrium).unwrap();
    (model, equilibrium, circuit)
}

fn column(circuit: &Circuit, losses: PressureLosses, rotates: bool) -> &CircuitColumn {
    circuit.columns.iter().find(|column| column.losses == losses && column.rotates == rotates).unwrap()
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value / expected - 1.0).abs() < tolerance, "{value}, not {expected}");
}

#[test]
fn the_column_of_the_scenario_has_the_pressures_of_its_equilibrium() {
    let hydraulics = |losses| Hydraulics {
        losses,
        nozzles: vec![0.0127; 3],
        tool_pressure_drop: 4e5,
        ..Hydraulics::default()
    };
    let mut displacement = Vec::new();
    for losses in PressureLosses::ALL {
        let scenario = Scenario { hydraulics: hydraulics(losses), ..preset("paper-200m").unwrap() };
        let (model, equilibrium, circuit) = solved(&scenario);
        let pressures = equilibrium.pressures.as_ref().unwrap();
        let column = column(&circuit, losses, false);
        assert_near(column.standpipe_pressure, pressures.bore[0], 1e-12);
        let bottom = *pressures.annulus.last().unwrap();
        assert_near(column.bit_loss + column.tool_loss, pressures.bore.last().unwrap() - bottom, 1e-9);
        let depth = model.frames.last().unwrap().position.z;
        let density = bottom / (crate::solve::model::GRAVITY * depth);
        assert_near(column.equivalent_circulating_density.unwrap(), density, 1e-12);
        // Motion, drag and C_f are those of the mud whatever the formulas.
        let of_mud = equilibrium.flows.iter().map(|flow| flow.friction_coefficient.to_bits());
        displacement.push((equilibrium.displacement.clone(), of_mud.collect::<Vec<_>>(), equilibrium.drag));
    }
    assert!(displacement.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn parts_and_depths_add_up_to_the_whole() {
    let mut scenario = preset("paper-200m").unwrap();
    let section = |name: &str, from, hole_diameter| HoleSection {
        name: name.to_owned(),
        from,
        hole_diameter,
        static_friction: None,
        dynamic_friction: None,
    };
    scenario.well.section = vec![section("casing", 0.0, Some(0.23)), section("open hole", 60.0, None)];
    let (model, _, circuit) = solved(&scenario);
    for (i, column) in circuit.columns.iter().enumerate() {
        for (conduit, whole) in [(Conduit::Bore, column.bore_loss), (Conduit::Annulus, column.annulus_loss)] {
            let parts = circuit.parts.iter().filter(|part| part.conduit == conduit);
            let (lengths, losses): (Vec<f64>, Vec<f64>) =
                parts.map(|part| (part.length, part.losses[i])).unzip();
            assert_near(lengths.iter().sum(), model.mesh.length(), 1e-12);
            assert_near(losses.iter().sum(), whole, 1e-12);
        }
        let bit = circuit.depths.last().unwrap();
        assert_near(bit.annulus_losses[i], column.annulus_loss, 1e-12);
        let densities = bit.equivalent_circulating_densities.as_ref().unwrap();
        assert_eq!(Some(densities[i]), column.equivalent_circulating_density);
    }
    let shoe = circuit.depths.iter().find(|place| place.end_of_section.is_some()).unwrap();
    assert_eq!((shoe.measured_depth, shoe.end_of_section.as_deref()), (60.0, Some("casing")));
    assert!(circuit.depths[0].equivalent_circulating_densities.is_none(), "no depth, no density");
    let kinds: Vec<&str> = circuit.parts.iter().map(|part| part.kind).collect();
    assert!(kinds.contains(&"tool joint") && kinds.contains(&"drillpipe"), "{kinds:?}");
}

#[test]
fn a_string_at_rest_has_a_column_of_each_formulas_and_a_turning_one_thinner_mud_as_well() {
    let mut scenario = preset("paper-200m").unwrap();
    let (_, _, circuit) = solved(&scenario);
    assert_eq!(circuit.columns.len(), 5);
    for losses in [PressureLosses::Eccentric, PressureLosses::Concentric] {
        let [rest, turning] = [false, true].map(|rotates| column(&circuit, losses, rotates).annulus_loss);
        assert!(turning < rest && turning > 0.85 * rest, "{turning} of {rest}");
    }
    (scenario.operation.rotation_speed_rpm, scenario.operation.torque_on_bit) = (0.0, 0.0);
    scenario.string.unbalance.clear();
    assert_eq!(solved(&scenario).2.columns.len(), 3);
    scenario.mud = None;
    let model = Model::new(&scenario).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    assert_eq!(Circuit::new(&model, &equilibrium), Err(CircuitError::NoMud));
}

#[test]
fn still_mud_weighs_and_loses_nothing() {
    let mut scenario = preset("paper-200m").unwrap();
    scenario.mud = Some(Mud { flow_rate: 0.0, back_pressure: 1e5, ..scenario.mud.unwrap() });
    scenario.hydraulics =
        Hydraulics { nozzle_area: Some(4e-4), surface_case: Some(2), ..Hydraulics::default() };
    let (_, _, circuit) = solved(&scenario);
    for column in &circuit.columns {
        assert_eq!(column.standpipe_pressure, 1e5, "{column:?}");
        assert_eq!(column.equivalent_circulating_density, Some(circuit.mud_density));
    }
}
