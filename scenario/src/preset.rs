//! Scenarios that ship with the program, kept as readable TOML.

use crate::{Scenario, ScenarioRequest};

macro_rules! presets {
    ($($name:literal: $description:literal,)*) => {
        /// Name and one-line description of every preset.
        pub const PRESETS: &[(&str, &str)] = &[$(($name, $description),)*];

        fn text(name: &str) -> Option<&'static str> {
            match name {
                $($name => Some(include_str!(concat!("../presets/", $name, ".toml"))),)*
                _ => None,
            }
        }
    };
}

presets! {
    "paper-200m": "Base case of Tran et al. 2019: 200 m string in a curved 3D hole, with mud",
    "paper-200m-dry": "The same without mud, hence without buoyancy",
    "paper-200m-damped": "The base case with damping that grows with frequency, 3e-5 s, started in equilibrium: torsion above the lowest modes decays",
    "wells/volve-f12": "A whole well: 3,438 m along the planned path of Volve 15/9-F-12 to 53 degrees, 336 joints of drillpipe, a rotary-steerable assembly, 140 rpm",
    "wells/volve-f12-assembly": "Its lower 219 m with the assembly, below 3,219 m of drillpipe that carries waves to the drive and back",
    "wells/vertical-2500m": "A vertical well of 2,500 m with drillpipe, heavy-weight pipe and a packed assembly of collars",
    "wells/extended-reach-5000m": "An extended-reach well of 5,000 m at 78 degrees, casing to 2,400 m: torque and drag, circulating density",
    "wells/motor-12in": "A 12 1/4 in motor assembly with MWD and LWD by its published tally, below drillpipe that continues",
    "wells/geothermal-12in": "A packed 12 1/4 in assembly in hard rock and water at 2,940 m, below drillpipe that continues",
    "wells/stick-slip-1000m": "A vertical well of 1,000 m whose bit sticks and slips under an imposed speed, and turns evenly under a soft top drive",
    "wells/well-b-aarsnes": "Well B of Aarsnes and Shor, 2,500 m: stick-slip off bottom by friction of the wall",
    "closed/fast-heavy-mud": "The damped base case with 0.04 m3/s of mud of 2100 kg/m3: its largest orbits",
    "closed/building-well": "The damped base case in a well that builds from 25 to 60 degrees",
    "closed/near-horizontal": "The damped base case in a well of 85 to 90 degrees, hardly bent",
    "closed/string-1000m": "Stick-slip of a damped string of 1,000 m in a well that builds from vertical to 50 degrees",
    "hard/tight-gauge": "Gauges of 0.01 mm in a wall of 1e9 N/m: a stiff pin with hardly any clearance",
    "hard/stiff-contact-10": "Contact ten times as stiff and damped: contact iterations need shorter steps",
    "hard/stiff-contact-100": "Contact a hundred times as stiff and damped",
    "hard/sharp-friction": "Friction that reverses within 1 mm/s: nearly a jump of the force at rest",
    "hard/dry-friction-whirl": "Dry friction of 0.8 on a slender rotor: backward whirl up to the speed of rolling without slip",
    "hard/stick-slip": "Slow rotation and strongly velocity-weakening friction: the collars stick and slip",
    "hard/high-frequency-torsion": "Velocity-weakening friction and little damping: standing torsional waves at 140 to 280 Hz grow, and the steps resolve them",
    "hard/dry-unbalance-150": "No mud and 150 times the unbalance: the string is thrown from wall to wall",
    "hard/no-rotation": "No rotation: friction without direction or speed",
    "hard/slow-rotation": "0.1 rpm: all nodes slide near zero speed",
    "hard/near-buckling": "A horizontal string near the sinusoidal buckling load, at 0.7 of it",
    "hard/beyond-buckling": "A horizontal string well beyond the helical buckling load",
    "hard/torque-near-greenhill": "A slender shaft under 0.95 of the torque that buckles it",
    "hard/flow-0.2": "A flow of 0.2 m3/s, 50 m/s in the collars' bore",
    "hard/flow-flutter": "A free span of pipe under a flow beyond its critical speed",
    "hard/no-flow": "Still mud: no drag, no friction loss, no flow terms",
    "hard/light-mud": "Mud of 500 kg/m3",
    "hard/heavy-mud": "Mud of 3000 kg/m3",
    "hard/vertical": "A vertical hole: no low side to lie on",
    "hard/horizontal": "A horizontal hole: all weight on the wall",
    "hard/inverted": "A hole that climbs at 120 degrees",
    "hard/dogleg-20": "Doglegs of 20 degrees in 30 m, up and down",
    "hard/one-element": "A string of one element",
    "hard/elements-5000": "A string of 5,000 elements of 4 cm",
    "hard/length-10km": "A string of 10 km",
    "hard/wide-tool-joint": "Tool joints wider than the gauges",
    "hard/all-on-wall": "Every node on the wall at once",
    "hard/on-axis": "A start exactly on the axis of the hole",
    "hard/undamped-flow-torque": "No damping at all, with upward annular flow and torque: growth in the highest modes of the mesh",
}

/// The scenario of a preset, or `None` if there is none of that name. A preset's file is a scenario, or another preset with
/// changes.
pub fn preset(name: &str) -> Option<Scenario> {
    let request = ScenarioRequest::from_toml(text(name)?).expect("shipped presets are parsed by a test");
    let scenario = request.resolve().expect("shipped presets are resolved by a test");
    Some(Scenario { name: name.to_owned(), ..scenario })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, StartFriction};

    #[test]
    fn every_preset_parses_under_its_own_name() {
        for (name, _) in PRESETS {
            assert_eq!(preset(name).unwrap().name, *name);
        }
        assert!(preset("no-such-preset").is_none());
    }

    #[test]
    fn the_dry_case_differs_by_its_mud_alone() {
        let (wet, mut dry) = (preset("paper-200m").unwrap(), preset("paper-200m-dry").unwrap());
        assert!(wet.mud.is_some() && dry.mud.is_none());
        dry.mud = wet.mud;
        dry.name.clone_from(&wet.name);
        assert_eq!(wet, dry);
    }

    #[test]
    fn the_damped_case_differs_by_damping_wall_mesh_start_and_recording_alone() {
        let (printed, mut damped) = (preset("paper-200m").unwrap(), preset("paper-200m-damped").unwrap());
        assert_eq!(
            (printed.damping.stiffness_proportional, damped.damping.stiffness_proportional),
            (0.0, 3e-5)
        );
        assert!(damped.settles() && damped.spectrum_windows().is_none());
        assert_eq!((printed.duration, damped.duration), (60.0, 300.0));
        damped.damping = printed.damping;
        damped.statics = printed.statics;
        damped.contact.law = printed.contact.law;
        assert_eq!(damped.mesh, Mesh::AUTO);
        damped.mesh = printed.mesh;
        damped.duration = printed.duration;
        damped.recording = printed.recording.clone();
        damped.name.clone_from(&printed.name);
        assert_eq!(printed, damped);
    }

    #[test]
    fn closed_presets_have_the_damped_presets_damping_run_and_window() {
        let damped = preset("paper-200m-damped").unwrap();
        let closed: Vec<_> = PRESETS.iter().filter(|(name, _)| name.starts_with("closed/")).collect();
        assert_eq!(closed.len(), 4);
        for (name, _) in closed {
            let closed = preset(name).unwrap();
            assert_eq!(closed.damping, damped.damping, "{name}");
            // The motion of the string of 1,000 m grows slowly into stick-slip.
            let longest = if *name == "closed/string-1000m" { 600.0 } else { damped.duration };
            assert_eq!((closed.duration, closed.settles()), (longest, true), "{name}");
            assert_eq!(closed.spectrum_windows(), None, "{name}");
            assert_eq!((&closed.operation, &closed.contact), (&damped.operation, &damped.contact), "{name}");
            assert_eq!(closed.recording.nodes.len(), 3, "{name}");
        }
    }

    #[test]
    fn runs_start_in_balance_but_for_those_that_show_a_break_away() {
        for (name, _) in PRESETS {
            // Well B turns as after a connection.
            let breaks_away = name.starts_with("hard/")
                || ["paper-200m", "paper-200m-dry", "wells/well-b-aarsnes"].contains(name);
            let expected = if breaks_away { StartFriction::BreakAway } else { StartFriction::Sliding };
            assert_eq!(preset(name).unwrap().statics.friction, expected, "{name}");
        }
    }

    #[test]
    fn base_case_matches_the_papers_totals() {
        // Table 1 gives 200 m; Table 6's masses add up to 1.769 kg m, while equation (38) with its rpm gives 1.78.
        let scenario = preset("paper-200m").unwrap();
        let length: f64 = scenario.string.sections.iter().map(|s| f64::from(s.count) * s.length).sum();
        assert_eq!(length, 200.0);
        let unbalance: f64 = scenario.string.unbalance.iter().map(|m| m.mass * m.radius).sum();
        assert_eq!(scenario.string.unbalance.len(), 17);
        assert!((unbalance - 1.769).abs() < 5e-4);
    }
}
