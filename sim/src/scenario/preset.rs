//! Scenarios that ship with the program, kept as readable TOML.

use super::Scenario;

/// Name and one-line description of every preset.
pub const PRESETS: &[(&str, &str)] = &[
    ("paper-200m", "Base case of Tran et al. 2019: 200 m string in a curved 3D hole, with mud"),
    ("paper-200m-dry", "The same without mud, hence without buoyancy"),
];

/// The scenario of a preset, or `None` if there is none of that name.
pub fn preset(name: &str) -> Option<Scenario> {
    let text = match name {
        "paper-200m" => include_str!("../../presets/paper-200m.toml"),
        "paper-200m-dry" => include_str!("../../presets/paper-200m-dry.toml"),
        _ => return None,
    };
    Some(toml::from_str(text).expect("shipped presets are parsed by a test"))
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn base_case_matches_the_papers_totals() {
        // Table 1 gives 200 m; Table 6's masses add up to 1.769 kg m (physics.md section 7: 1.78 by eq. 38).
        let scenario = preset("paper-200m").unwrap();
        let length: f64 = scenario.string.sections.iter().map(|s| f64::from(s.count) * s.length).sum();
        assert_eq!(length, 200.0);
        let unbalance: f64 = scenario.string.unbalance.iter().map(|m| m.mass * m.radius).sum();
        assert_eq!(scenario.string.unbalance.len(), 17);
        assert!((unbalance - 1.769).abs() < 5e-4);
    }
}
