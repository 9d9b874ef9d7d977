//! Rules of the well.

use std::ops::RangeInclusive;

use drillsweep_scenario::Scenario;

use super::loads;
use super::report::Report;
use crate::string::well::{WellError, WellPath};

/// Dogleg \[deg / 30 m\] above which a hole is hardly drilled: the survey is probably wrong.
const SHARPEST_DOGLEG: f64 = 30.0;

/// Diameters of holes \[m\] from those of mineral exploration to those of hole openers for conductors, 48 in.
const USUAL_DIAMETERS: RangeInclusive<f64> = 0.05..=1.2;

/// Largest diameter of a hole \[m\]: wider ones are shafts, which no string of pipe drills.
const WIDEST_HOLE: f64 = 5.0;

pub(super) fn check(report: &mut Report, scenario: &Scenario) {
    let well = &scenario.well;
    diameter(report, well.hole_diameter, "well.hole_diameter");
    sections(report, scenario);

    let survey = &well.survey;
    report.require(
        survey.len() >= 2,
        "well.survey",
        format!("{} stations", survey.len()),
        "must have at least 2 stations",
    );
    for (i, station) in survey.iter().enumerate() {
        let field = |name: &str| format!("well.survey[{i}].{name}");
        let depth = field("measured_depth");
        match i.checked_sub(1).map(|above| survey[above].measured_depth) {
            None => report.number(
                station.measured_depth,
                depth,
                |depth| depth == 0.0,
                "must be 0: measured depths count from the top of the string, which hangs from the first station",
            ),
            Some(above) if above.is_finite() => report.number(
                station.measured_depth,
                depth,
                |depth| depth > above,
                format!("must be greater than {above}, the depth of the station before"),
            ),
            Some(_) => {}
        }
        report.number(
            station.inclination_deg,
            field("inclination_deg"),
            |inclination| (0.0..=180.0).contains(&inclination),
            "must be 0 to 180 degrees from the vertical",
        );
    }

    match WellPath::new(well) {
        Err(WellError::Reversal { station, dogleg_deg }) => report.require(
            false,
            format!("well.survey[{station}]"),
            format!("a dogleg of {dogleg_deg:.1} deg"),
            "the hole must turn by less than 180 degrees between two stations",
        ),
        // The others are reported above, field by field.
        Err(_) => {}
        Ok(path) => {
            for (i, station) in survey.iter().enumerate().skip(1) {
                // In the interval above the station, whose curvature is the same everywhere.
                let middle = 0.5 * (survey[i - 1].measured_depth + station.measured_depth);
                let severity = path.curvature(middle).norm().to_degrees() * 30.0;
                report.warn(
                    severity > SHARPEST_DOGLEG,
                    format!("well.survey[{i}]"),
                    format!("the hole turns by {severity:.1} deg / 30 m from the station before"),
                );
            }
        }
    }
}

/// Diameter of the hole.
fn diameter(report: &mut Report, diameter: f64, path: &str) {
    report.positive(diameter, path);
    report.number(
        diameter,
        path,
        |diameter| diameter <= WIDEST_HOLE,
        format!("must be at most {WIDEST_HOLE} m (12 1/4 in are 0.311 m)"),
    );
    report.usual(diameter, path, &USUAL_DIAMETERS, "m");
}

/// Sections of the hole.
fn sections(report: &mut Report, scenario: &Scenario) {
    let sections = &scenario.well.section;
    for (i, section) in sections.iter().enumerate() {
        let field = |name: &str| format!("well.section[{i}].{name}");
        report.not_negative(section.from, field("from"));
        if let Some(above) =
            i.checked_sub(1).map(|above| sections[above].from).filter(|above| above.is_finite())
        {
            report.number(
                section.from,
                field("from"),
                |from| from > above,
                format!("must be greater than {above}, the depth of the section before"),
            );
        }
        if let Some(own) = section.hole_diameter {
            diameter(report, own, &field("hole_diameter"));
        }
        let hole = scenario.hole_of(Some(i));
        if let Some(own) = section.static_friction {
            loads::static_friction(report, own, &field("static_friction"));
            report.require(
                own == 0.0 || scenario.contact.static_friction != 0.0,
                field("static_friction"),
                own,
                "contact.static_friction is 0, which leaves friction out of the whole hole; give it a value, and 0 to the sections without friction",
            );
        }
        if section.static_friction.is_some() || section.dynamic_friction.is_some() {
            let given =
                if section.dynamic_friction.is_some() { "dynamic_friction" } else { "static_friction" };
            loads::dynamic_friction(report, hole.dynamic_friction, hole.static_friction, &field(given));
        }
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{HoleSection, Scenario};

    use super::super::report::testing::{problem, problems, warnings};

    #[test]
    fn hole_has_a_diameter() {
        let found = problems(|s| s.well.hole_diameter = 0.0);
        assert!(
            found.iter().any(|p| p.path == "well.hole_diameter" && p.message == "must be greater than 0")
        );
    }

    #[test]
    fn hole_of_another_unit_is_refused_or_doubted() {
        for diameter in [8.5, 215.9] {
            let found = problem("well.hole_diameter", |s| s.well.hole_diameter = diameter);
            assert!(found.message.contains("at most 5 m"), "{found}");
        }
        let found = warnings(|s| s.well.hole_diameter = 2.159);
        assert_eq!((found.len(), found[0].path.as_str()), (1, "well.hole_diameter"));
        assert_eq!(warnings(|s| s.well.hole_diameter = 1.2), []);
    }

    fn section(from: f64) -> HoleSection {
        HoleSection {
            name: String::new(),
            from,
            hole_diameter: None,
            static_friction: None,
            dynamic_friction: None,
        }
    }

    #[test]
    fn hole_sections_follow_each_other() {
        assert_eq!(warnings(|s| s.well.section = vec![section(0.0), section(150.0), section(900.0)]), []);
        problem("well.section[0].from", |s| s.well.section = vec![section(-1.0)]);
        let found = problem("well.section[1].from", |s| s.well.section = vec![section(10.0), section(10.0)]);
        assert!(found.message.starts_with("must be greater than 10"), "{found}");
    }

    #[test]
    fn a_hole_section_is_wider_than_the_string_in_it() {
        let with = |diameter: f64| {
            move |s: &mut Scenario| {
                s.well.section = vec![HoleSection { hole_diameter: Some(diameter), ..section(150.0) }]
            }
        };
        let found = problem("string.sections[7].outer_diameter", |s| {
            with(0.15)(s);
            s.well.section[0].from = 199.6;
        });
        assert!(found.message.contains("0.15 m"), "{found}");
        problem("well.section[0].hole_diameter", with(5.1));
        let tight = problem("string.gauges[1].clearance", |s| {
            with(0.16)(s);
            s.string.gauges[1].clearance = 1e-3;
        });
        assert!(tight.message.contains("the clearance of the body there"), "{tight}");
    }

    #[test]
    fn friction_of_a_hole_section_obeys_the_rules_of_contact() {
        let with = |static_friction: Option<f64>, dynamic_friction: Option<f64>| {
            move |s: &mut Scenario| {
                s.well.section = vec![HoleSection { static_friction, dynamic_friction, ..section(50.0) }]
            }
        };
        assert_eq!(warnings(with(Some(0.25), Some(0.25))), []);
        assert_eq!(warnings(with(Some(0.0), Some(0.0))), []);
        problem("well.section[0].static_friction", with(Some(11.0), None));
        // mu_d of the rest, 0.2, is larger than this mu_s.
        let found = problem("well.section[0].static_friction", with(Some(0.15), None));
        assert!(found.message.contains("0.15"), "{found}");
        problem("well.section[0].dynamic_friction", with(None, Some(0.31)));
        let found = problem("well.section[0].static_friction", |s| {
            (s.contact.static_friction, s.contact.dynamic_friction) = (0.0, 0.0);
            with(Some(0.3), Some(0.2))(s);
        });
        assert!(found.message.starts_with("contact.static_friction is 0"), "{found}");
    }

    #[test]
    fn survey_has_two_stations() {
        let found = problems(|s| s.well.survey.truncate(1));
        assert!(found.iter().any(|p| p.path == "well.survey" && p.got == "1 stations"), "{found:?}");
    }

    #[test]
    fn survey_starts_at_the_top_of_the_string() {
        let found = problem("well.survey[0].measured_depth", |s| s.well.survey[0].measured_depth = 10.0);
        assert!(found.message.starts_with("must be 0"));
    }

    #[test]
    fn survey_depths_increase() {
        let found = problem("well.survey[2].measured_depth", |s| s.well.survey[2].measured_depth = 50.0);
        assert!(found.message.contains("greater than 50"), "{found}");
    }

    #[test]
    fn inclination_is_0_to_180() {
        for inclination in [-1.0, 180.5] {
            problem("well.survey[4].inclination_deg", |s| s.well.survey[4].inclination_deg = inclination);
        }
        let straight_up = |s: &mut Scenario| {
            for station in &mut s.well.survey {
                station.inclination_deg = 180.0;
            }
        };
        assert_eq!(warnings(straight_up), []);
    }

    #[test]
    fn hole_does_not_turn_back_on_itself() {
        let found = problem("well.survey[1]", |s| {
            (s.well.survey[0].inclination_deg, s.well.survey[1].inclination_deg) = (90.0, 90.0);
            (s.well.survey[0].azimuth_deg, s.well.survey[1].azimuth_deg) = (0.0, 180.0);
        });
        assert!(found.got.contains("180.0 deg"), "{found}");
    }

    #[test]
    fn sharp_doglegs_are_doubted() {
        let found = warnings(|s| s.well.survey[4].azimuth_deg = 95.0);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].path, "well.survey[4]");
    }
}
