//! The vocabulary as the Python client has it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::collections::BTreeSet;
use std::path::Path;

use drillsweep_quantity::units;

/// `DRILLSWEEP_WRITE_QUANTITIES=1 cargo test -p drillsweep-quantity vocabulary` writes the file anew.
#[test]
fn the_python_client_has_this_vocabulary() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../api/python/src/drillsweep/quantities.json");
    let text = format!("{:#}\n", drillsweep_quantity::json());
    if std::env::var_os("DRILLSWEEP_WRITE_QUANTITIES").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(committed == text, "quantities.json is out of date; this test's comment says how to write it");
}

#[test]
fn every_name_is_there_once_and_every_unit_has_a_size() {
    let mut names = BTreeSet::new();
    for quantity in drillsweep_quantity::all() {
        assert!(names.insert(quantity.name), "{} is there twice", quantity.name);
        assert!(!quantity.label.is_empty(), "{}", quantity.name);
        assert_eq!(drillsweep_quantity::of(quantity.name), Some(quantity));
        for unit in quantity.units.iter().flat_map(|units| [units.shown, units.field]) {
            assert!(unit.size > 0.0 && unit.size.is_finite(), "{}: {unit:?}", quantity.name);
        }
        // A quantity whose name says its unit has that one.
        for (end, units) in [
            ("_hz", &units::FREQUENCY),
            ("_rpm", &units::SPEED_OF_ROTATION),
            ("_deg", &units::ANGLE_IN_DEGREES),
        ] {
            assert!(!quantity.name.ends_with(end) || quantity.units == Some(units), "{}", quantity.name);
        }
    }
}
