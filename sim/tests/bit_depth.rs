//! Strings with the bit above their end: only the lowest part of the string is in the hole.

use std::f64::consts::FRAC_PI_4;

use drillsweep_scenario::{
    NodeChoice, Scenario, Section, SectionKind, SurveyStation, ToolJoint, TopCondition, preset,
};
use drillsweep_sim::control::Control;
use drillsweep_sim::key::canonical_json;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Transient};
use drillsweep_sim::solve::soft_string::{DragCase, DragMode, DragSettings, SoftString};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::string::ElementKind;
use drillsweep_sim::validation::validate;
use serde_json::json;

const GRAVITY: f64 = 9.81;

const JOINT: ToolJoint =
    ToolJoint { length: 0.3, outer_diameter: 0.1683, inner_diameter: 0.0825, material: None };

/// 200 m of jointed pipe and collars with a bit in a vertical hole of still mud, off bottom.
fn vertical() -> Scenario {
    let mut scenario = preset("paper-200m").expect("shipped preset");
    scenario.well.survey = [0.0, 200.0]
        .map(|measured_depth| SurveyStation { measured_depth, inclination_deg: 0.0, azimuth_deg: 0.0 })
        .to_vec();
    let pipe = Section {
        count: 14,
        tool_joint: Some(JOINT),
        ..Section::plain(SectionKind::Drillpipe, 9.5, 0.127, 0.1086)
    };
    let collars = Section { count: 7, ..Section::plain(SectionKind::Collar, 9.5, 0.1651, 0.0714) };
    scenario.string.sections = vec![pipe, collars, Section::plain(SectionKind::Bit, 0.5, 0.2, 0.06)];
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.recording.nodes.clear();
    scenario.mud.as_mut().expect("the preset has mud").flow_rate = 0.0;
    (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
    scenario
}

fn with_bit_at(scenario: &Scenario, depth: f64) -> Scenario {
    scenario.with("string.bit_depth", json!(depth)).expect("a field of a scenario")
}

fn at_rest(scenario: &Scenario) -> (Model, Equilibrium) {
    validate(scenario).expect("valid");
    let model = Model::new(scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("an equilibrium");
    (model, equilibrium)
}

/// Effective weight of the lowest metres of the string, from the bit up by its diameters \[N\].
fn weight_of_the_lowest(depth: f64, scenario: &Scenario) -> f64 {
    let (steel, mud) = (scenario.string.material.density, scenario.mud.expect("has mud").density);
    let line = |outer: f64, inner: f64| (steel - mud) * FRAC_PI_4 * (outer * outer - inner * inner);
    let [joint, body] = [line(0.1683, 0.0825), line(0.127, 0.1086)];
    let mut parts = vec![(0.5, line(0.2, 0.06)), (66.5, line(0.1651, 0.0714))];
    parts.extend((0..14).flat_map(|_| [(0.3, joint), (8.9, body), (0.3, joint)]));
    let mut left = depth;
    let mass: f64 = parts
        .into_iter()
        .map(|(length, line)| {
            let taken = f64::min(length, left);
            left -= taken;
            taken * line
        })
        .sum();
    GRAVITY * mass
}

#[test]
fn a_string_hangs_with_the_weight_of_its_lowest_part() {
    // A half bit, collars, a whole piece, a body, and both tool joints that meet in the cut.
    for depth in [0.25, 40.0, 76.5, 80.0, 85.8, 86.2, 199.9, 200.0] {
        let (model, equilibrium) = at_rest(&with_bit_at(&vertical(), depth));
        assert!((model.mesh.length() - depth).abs() < 1e-9);
        // The tension of an element is that of its middle.
        let first = &model.mesh.elements[0];
        let mud = model.scenario.mud.expect("has mud").density;
        let tube = first.tube;
        let displaced = mud * FRAC_PI_4 * (tube.outer_diameter.powi(2) - tube.inner_diameter.powi(2));
        let half = 0.5 * first.length * (tube.mass_per_length() - displaced);
        let (found, expected) =
            (equilibrium.tension[0] + GRAVITY * half, weight_of_the_lowest(depth, &vertical()));
        assert!((found / expected - 1.0).abs() < 1e-8, "{depth} m: {found} N, not {expected}");
    }
}

#[test]
fn tool_joints_keep_their_distance_from_the_bit() {
    let joints = |scenario: &Scenario| -> Vec<f64> {
        let mesh = Model::new(scenario).expect("valid").mesh;
        let joints = mesh.elements.iter().filter(|element| element.kind == ElementKind::ToolJoint);
        joints.map(|element| mesh.length() - (element.top + element.length)).collect()
    };
    let whole = joints(&vertical());
    let cut = joints(&with_bit_at(&vertical(), 122.0));
    assert!(!cut.is_empty());
    for (whole, cut) in whole.iter().rev().zip(cut.iter().rev()) {
        assert!((whole - cut).abs() < 1e-9, "{whole} m, not {cut}");
    }
}

#[test]
fn a_sliver_at_the_top_joins_the_part_below() {
    // 67 m of collars and bit, then a joint of 0.3 m, whose target of 0.3 m an element of 5 mm is far from.
    let with = |depth: f64| Model::new(&with_bit_at(&vertical(), depth)).expect("valid").mesh;
    let (sliver, joint) = (with(67.005), with(67.1));
    assert_eq!(sliver.elements[0].kind, ElementKind::Collar);
    assert_eq!(joint.elements[0].kind, ElementKind::ToolJoint);
    assert!((sliver.length() - 67.005).abs() < 1e-9 && sliver.nodes[0].measured_depth == 0.0);
}

#[test]
fn bits_and_keys_are_those_of_a_string_that_is_cut_by_hand() {
    let paper = preset("paper-200m").expect("shipped preset");
    let mut paper = paper.with("string.gauges", json!([])).expect("a field");
    paper.string.unbalance.clear();
    // The preset's first nodes are gone.
    paper.recording.nodes.truncate(1);
    assert_eq!(canonical_json(&with_bit_at(&paper, 200.0)), canonical_json(&paper));
    // A part of the whole sections, then five of nine pieces, then one piece of collars that is cut.
    for (depth, change) in [
        (
            158.0,
            &(|s: &mut Vec<Section>| {
                s.remove(0);
                s[0].count = 5;
            }) as &dyn Fn(&mut Vec<Section>),
        ),
        (96.0, &|s: &mut Vec<Section>| {
            s.drain(..2);
            s[0].length -= 14.5;
        }),
    ] {
        let cut = with_bit_at(&paper, depth);
        let mut by_hand = paper.clone();
        change(&mut by_hand.string.sections);
        assert!((by_hand.string.whole_length() - depth).abs() < 1e-12, "{}", by_hand.string.whole_length());
        let (found, expected) = (at_rest(&cut), at_rest(&by_hand));
        assert_eq!(found.0.mesh.nodes, expected.0.mesh.nodes);
        assert_eq!(found.1.displacement, expected.1.displacement);
        assert_eq!(found.1.tension, expected.1.tension);
    }
    let mut by_hand = paper.clone();
    by_hand.string.sections.remove(0);
    by_hand.string.sections[0].count = 5;
    assert_eq!(canonical_json(&with_bit_at(&paper, 158.0)), canonical_json(&by_hand));
    assert_ne!(canonical_json(&with_bit_at(&paper, 153.0)), canonical_json(&with_bit_at(&paper, 153.1)));
}

#[test]
fn a_stiff_string_off_bottom_weighs_as_a_soft_one_at_every_bit_depth() {
    let mut well = preset("wells/volve-f12").expect("shipped preset");
    well.string.gauges.clear();
    well.string.unbalance.clear();
    well.recording.nodes.clear();
    (well.operation.weight_on_bit, well.operation.torque_on_bit) = (0.0, 0.0);
    well.contact.static_friction = well.contact.dynamic_friction;
    well.mud.as_mut().expect("has mud").flow_rate = 0.0;
    let soft = SoftString::new(&well).expect("valid");
    for depth in [400.0, 1003.7, 2100.0] {
        let case = DragCase { mode: DragMode::Rotate, bit_depth: depth, friction: None };
        let soft = soft.forces(&case, &DragSettings::default()).expect("valid").hook_load;
        let (_, equilibrium) = at_rest(&with_bit_at(&well, depth));
        // The string lies off the axis and bends: within some parts in a thousand.
        assert!(
            (equilibrium.tension[0] / soft - 1.0).abs() < 0.02,
            "{depth} m: {} N, not {soft}",
            equilibrium.tension[0]
        );
    }
}

#[test]
fn a_soft_string_of_a_scenario_with_a_bit_depth_is_the_whole_one() {
    let whole = vertical();
    let case = DragCase { mode: DragMode::Rotate, bit_depth: 150.0, friction: None };
    let hook_load = |scenario: &Scenario| {
        let string = SoftString::new(scenario).expect("valid");
        (string.bit_depth(), string.forces(&case, &DragSettings::default()).expect("valid").hook_load)
    };
    let (depth, load) = hook_load(&with_bit_at(&whole, 80.0));
    assert_eq!((depth, load), (80.0, hook_load(&whole).1));
    // The survey bounds the bit, not the string.
    let mut long = whole.clone();
    long.string.sections[0].count = 40;
    let long = with_bit_at(&long, 180.0);
    validate(&long).expect("the bit is within the survey");
    assert_eq!(SoftString::new(&long).expect("valid").deepest(), 200.0);
}

#[test]
fn bit_depths_off_the_string_or_below_the_survey_are_refused() {
    let problem = |scenario: &Scenario, depth: f64| {
        let problems = validate(&with_bit_at(scenario, depth)).expect_err("refused").0;
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert_eq!(problems[0].path, "string.bit_depth");
        problems[0].message.clone()
    };
    for depth in [0.0, -5.0, 200.1] {
        assert!(problem(&vertical(), depth).contains("at most the length of the string, 200 m"), "{depth}");
    }
    let mut shallow = vertical();
    shallow.well.survey[1].measured_depth = 150.0;
    assert!(problem(&shallow, 160.0).contains("150 m"));
    assert!(validate(&with_bit_at(&shallow, 150.0)).is_ok());
    // Pipe above the hole meets no wall; in the hole it does.
    let mut wide = vertical();
    wide.string.sections[0].outer_diameter = 0.25;
    wide.string.sections[0].tool_joint = None;
    assert!(validate(&with_bit_at(&wide, 67.0)).is_ok());
    let problems = validate(&with_bit_at(&wide, 70.0)).expect_err("wider than the hole").0;
    assert_eq!(problems[0].path, "string.sections[0].outer_diameter");
}

#[test]
fn a_string_listed_from_the_bit_is_the_same_point() {
    let from_top = vertical();
    let mut from_bit = from_top.with("string.order", json!("from_bit")).expect("a field");
    from_bit.string.sections.reverse();
    assert_eq!(canonical_json(&from_bit), canonical_json(&from_top));
    assert_eq!(
        canonical_json(&with_bit_at(&from_bit, 88.0)),
        canonical_json(&with_bit_at(&from_top, 88.0)),
        "cut in a piece"
    );
    let (found, expected) = (at_rest(&from_bit), at_rest(&from_top));
    assert_eq!(found.1.displacement, expected.1.displacement);
    assert_eq!(SoftString::new(&from_bit).expect("valid").bit_depth(), 200.0);
    // Problems name the section as it is listed.
    from_bit.string.sections[0].outer_diameter = 0.3;
    let problems = validate(&from_bit).expect_err("the bit is wider than the hole").0;
    assert_eq!(problems[0].path, "string.sections[0].outer_diameter");
}

#[test]
fn places_above_the_bit_are_those_of_their_depths() {
    let by_depth = preset("paper-200m")
        .expect("shipped preset")
        .with("recording.nodes", json!([{ "depth": 199.0 }, { "depth": 57.7 }]))
        .expect("a field");
    let mut by_height =
        by_depth.with("recording.nodes", json!([{ "above_bit": 1.0 }, { "depth": 57.7 }])).expect("a field");
    for gauge in &mut by_height.string.gauges {
        (gauge.above_bit, gauge.measured_depth) = (gauge.measured_depth.map(|depth| 200.0 - depth), None);
    }
    for mass in &mut by_height.string.unbalance {
        (mass.above_bit, mass.measured_depth) = (mass.measured_depth.map(|depth| 200.0 - depth), None);
    }
    validate(&by_height).expect("valid");
    let [found, expected] = [&by_height, &by_depth].map(|scenario| Model::new(scenario).expect("valid"));
    let depths = |model: &Model| model.mesh.depths();
    for (found, expected) in depths(&found).iter().zip(depths(&expected)) {
        assert!((found - expected).abs() < 1e-9);
    }
    let nodes = |model: &Model| -> Vec<Option<usize>> {
        model.scenario.recording.nodes.iter().map(|node| model.mesh.chosen_node(*node)).collect()
    };
    assert_eq!(nodes(&found), nodes(&expected));
    let unbalance = |model: &Model| -> Vec<usize> {
        (0..model.node_count()).filter(|node| !model.mesh.nodes[*node].unbalance.is_empty()).collect()
    };
    assert_eq!(unbalance(&found), unbalance(&expected));
    // With the bit higher up, they stay at their distance from it.
    let moved = Model::new(&with_bit_at(&by_height, 195.0)).expect("valid");
    let bit_to_lowest = |model: &Model| {
        let gauges = model.mesh.nodes.iter().filter(|node| node.is_gauge);
        gauges.map(|node| model.mesh.length() - node.measured_depth).collect::<Vec<_>>()
    };
    for (moved, found) in bit_to_lowest(&moved).iter().zip(bit_to_lowest(&found)) {
        assert!((moved - found).abs() < 1e-9);
    }
}

#[test]
fn whole_wells_are_the_same_by_distances_from_the_bit_and_by_depths() {
    for name in ["volve-f12", "vertical-2500m", "extended-reach-5000m", "well-b-aarsnes"] {
        let mut by_height = preset(&format!("wells/{name}")).expect("shipped preset");
        let bit = by_height.string.whole_length().round();
        let mut by_depth = by_height.clone();
        let to_depth = |above_bit: &mut Option<f64>, measured_depth: &mut Option<f64>| {
            // As a table of depths has them, to the millimetre.
            *measured_depth =
                Some((1e3 * (bit - above_bit.take().expect("moves with the bit"))).round() / 1e3);
        };
        for gauge in &mut by_depth.string.gauges {
            to_depth(&mut gauge.above_bit, &mut gauge.measured_depth);
        }
        for mass in &mut by_depth.string.unbalance {
            to_depth(&mut mass.above_bit, &mut mass.measured_depth);
        }
        let [found, expected] =
            [&by_height, &by_depth].map(|scenario| Model::new(scenario).expect("valid").mesh);
        assert_eq!(found.nodes, expected.nodes, "{name}");
        for choice in &by_height.recording.nodes {
            let NodeChoice::AboveBit(above) = *choice else { continue };
            let depth = NodeChoice::Depth((1e3 * (bit - above)).round() / 1e3);
            assert_eq!(found.chosen_node(*choice), found.chosen_node(depth), "{name}, {above} m");
        }
        // Columns of recorded nodes have other names, and the result another key.
        by_height.recording.nodes.clear();
        by_depth.recording.nodes.clear();
        assert_eq!(canonical_json(&by_height), canonical_json(&by_depth), "{name}");
    }
}

/// The base case with a name for each section, and its gauges, masses and an excitation by section in place of measured depth.
fn by_section(by_depth: &Scenario) -> Scenario {
    let mut by_section = by_depth.clone();
    for (i, section) in by_section.string.sections.iter_mut().enumerate() {
        section.name = format!("component {i}");
    }
    let placed = |depth: f64| {
        let mut sections = by_depth.string.placed_sections();
        let found = sections.find(|placed| depth <= placed.bottom).expect("on the string");
        (Some(format!("component {}", found.index)), Some(found.bottom - depth))
    };
    macro_rules! put_in_sections {
        ($list:expr) => {
            for one in $list.iter_mut() {
                (one.section, one.above_end) = placed(one.measured_depth.take().expect("by measured depth"));
            }
        };
    }
    put_in_sections!(by_section.string.gauges);
    put_in_sections!(by_section.string.unbalance);
    put_in_sections!(by_section.excitation);
    by_section
}

#[test]
fn places_by_section_have_the_bits_of_their_depths() {
    let force =
        json!([{ "measured_depth": 150.0, "direction": "axial", "force": 1e4, "frequency_hz": 18.0 }]);
    let mut by_depth =
        preset("paper-200m").expect("shipped preset").with("excitation", force).expect("a field");
    by_depth.duration = 0.05;
    by_depth.recording.spectrum_windows = Some(Vec::new());
    by_depth.recording.orbit_window = None;
    let by_section = by_section(&by_depth);
    let mut named = by_depth.clone();
    for (to, from) in named.string.sections.iter_mut().zip(&by_section.string.sections) {
        to.name.clone_from(&from.name);
    }
    assert_eq!(canonical_json(&by_section), canonical_json(&named), "one key");
    let records = |scenario: &Scenario| {
        let (model, equilibrium) = at_rest(scenario);
        let run = Transient::new(&model, &equilibrium).expect("a run");
        match run.run(&Control::new()).expect("a run") {
            Outcome::Finished(records) => (equilibrium.displacement, records),
            Outcome::Cancelled | Outcome::Suspended(..) => panic!("not finished"),
        }
    };
    assert_eq!(records(&by_section), records(&by_depth));
}

#[test]
fn a_place_by_section_stays_in_it_as_components_are_inserted() {
    let scenario = by_section(&preset("paper-200m").expect("shipped preset"));
    let mass = &scenario.string.unbalance[0];
    let (name, above) = (mass.section.clone().expect("by section"), mass.above_end.expect("by section"));
    let index = scenario.string.sections.iter().position(|section| section.name == name).expect("a section");
    let mut longer = scenario.clone();
    let sub = Section { count: 1, ..Section::plain(SectionKind::Collar, 1.5, 0.1651, 0.0714) };
    longer.string.sections.insert(index + 1, sub);
    longer.well.survey.last_mut().expect("has stations").measured_depth += 1.5;
    for scenario in [&scenario, &longer] {
        let (model, _) = at_rest(scenario);
        let bottom =
            scenario.string.placed_sections().find(|placed| placed.index == index).expect("there").bottom;
        let masses = model.mesh.nodes.iter().filter(|node| !node.unbalance.is_empty());
        let mut depths = masses.map(|node| node.measured_depth);
        assert!(depths.any(|depth| (depth - (bottom - above)).abs() < 1e-9), "{bottom} m");
    }
}

#[test]
fn a_place_by_section_has_one_section_and_is_in_it() {
    let problem = |change: &dyn Fn(&mut Scenario)| -> (String, String) {
        let mut scenario = by_section(&preset("paper-200m").expect("shipped preset"));
        change(&mut scenario);
        let problems = validate(&scenario).expect_err("invalid").0;
        assert_eq!(problems.len(), 1, "{problems:?}");
        (problems[0].path.clone(), problems[0].message.clone())
    };
    let unknown = problem(&|scenario| scenario.string.unbalance[0].section = Some("mwd".to_owned()));
    assert_eq!(unknown.0, "string.unbalance[0].section");
    assert!(unknown.1.contains("no section of the string has this name"), "{unknown:?}");
    let ambiguous = problem(&|scenario| {
        scenario.string.gauges.clear();
        scenario.string.unbalance.truncate(1);
        let name = scenario.string.unbalance[0].section.clone().expect("by section");
        let other = scenario.string.sections.iter_mut().find(|section| section.name != name);
        other.expect("another section").name = name;
    });
    assert_eq!(ambiguous.0, "string.unbalance[0].section");
    assert!(ambiguous.1.contains("2 sections have this name"), "{ambiguous:?}");
    let beyond = problem(&|scenario| scenario.string.unbalance[0].above_end = Some(1e3));
    assert_eq!(beyond.0, "string.unbalance[0].above_end");
    assert!(beyond.1.contains("must be in its section, 0 to "), "{beyond:?}");
    let without = problem(&|scenario| {
        let gauge = &mut scenario.string.gauges[0];
        (gauge.measured_depth, gauge.section) = (Some(100.0), None);
    });
    assert_eq!(without, ("string.gauges[0].above_end".to_owned(), "belongs to section".to_owned()));
    let both = problem(&|scenario| scenario.string.gauges[0].above_bit = Some(1.0));
    assert_eq!(both.0, "string.gauges[0].section");
    assert!(both.1.contains("not both"), "{both:?}");
    let above = problem(&|scenario| {
        scenario.string.unbalance.truncate(1);
        scenario.string.gauges.clear();
        (scenario.string.unbalance[0].section, scenario.string.unbalance[0].above_end) =
            (Some("component 0".to_owned()), None);
        scenario.string.bit_depth = Some(150.0);
    });
    assert_eq!(above.0, "string.unbalance[0].section");
    assert!(above.1.contains("m above the hole"), "{above:?}");
}

#[test]
fn a_place_is_given_in_one_way_and_on_the_string() {
    let paths = |path: &str, value: serde_json::Value| -> Vec<(String, String)> {
        let scenario = preset("paper-200m").expect("shipped preset").with(path, value).expect("a field");
        let problems = validate(&scenario).err().map(|problems| problems.0).unwrap_or_default();
        problems.into_iter().map(|problem| (problem.path, problem.message)).collect()
    };
    let both = paths("string.gauges[0].above_bit", json!(1.0));
    assert_eq!(both.len(), 1);
    assert_eq!(both[0].0, "string.gauges[0].above_bit");
    assert!(both[0].1.contains("not both"), "{both:?}");
    let neither = paths("string.unbalance[2].measured_depth", json!(null));
    assert_eq!(neither.len(), 1);
    assert_eq!(neither[0].0, "string.unbalance[2]");
    assert!(neither[0].1.contains("either measured_depth or above_bit"), "{neither:?}");
    let above = paths("string.gauges[0]", json!({ "measured_depth": null, "above_bit": 200.5 }));
    assert_eq!(above[0].0, "string.gauges[0].above_bit");
    assert!(above[0].1.contains("0 to 200 m"), "{above:?}");
    let recorded = paths("recording.nodes[0]", json!({ "above_bit": -1.0 }));
    assert_eq!(recorded[0].0, "recording.nodes[0].above_bit");
    // By measured depth a place does not move with the bit, and may be below it.
    let scenario = with_bit_at(&preset("paper-200m").expect("shipped preset"), 180.0);
    let problems = validate(&scenario).expect_err("masses below the bit").0;
    assert!(problems.iter().any(|problem| problem.message.ends_with("above_bit moves with the bit")));
}

#[test]
fn a_string_that_continues_has_the_pipe_of_its_cut_above_it() {
    let mut scenario = vertical();
    scenario.operation.top = TopCondition::Continues;
    let whole = scenario.string.sections.len();
    let (model, _) = at_rest(&with_bit_at(&scenario, 60.0));
    assert_eq!((whole, model.scenario.string.sections.len()), (3, 2));
    assert_eq!(model.scenario.string.sections[0].kind, SectionKind::Collar);
}
