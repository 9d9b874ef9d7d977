//! Sections of the hole, such as casing and open hole.

use serde::{Deserialize, Serialize};

use crate::{Scenario, Well};

/// A section of the hole, from its depth down to the next section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleSection {
    /// Name for people, such as `casing`; it does not enter the numbers. Empty unless given.
    #[serde(default)]
    pub name: String,
    /// Measured depth of its upper end \[m\], from 0 at the top of the string, increasing from section to section. Above the first one the hole
    /// is that of `well.hole_diameter` and `contact`. On the string it is a node; within a twentieth of the target element length of another
    /// boundary it is moved there.
    pub from: f64,
    /// Diameter of the hole \[m\], larger than every outer diameter in it and at most 5; absent means `well.hole_diameter`. In a casing it is the
    /// casing's inner diameter.
    #[serde(default)]
    pub hole_diameter: Option<f64>,
    /// Static friction coefficient mu_s, 0 to 10; absent means that of `contact`. Usual 0.15 to 0.25 in casing, 0.2 to 0.4 in open hole.
    #[serde(default)]
    pub static_friction: Option<f64>,
    /// Dynamic friction coefficient mu_d, 0 to mu_s; absent means that of `contact`.
    #[serde(default)]
    pub dynamic_friction: Option<f64>,
}

/// The hole at one depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Diameter D_ch \[m\].
    pub diameter: f64,
    /// Static friction coefficient mu_s.
    pub static_friction: f64,
    /// Dynamic friction coefficient mu_d.
    pub dynamic_friction: f64,
}

impl Scenario {
    /// The hole at a measured depth \[m\], which belongs to the section that begins there.
    pub fn hole_at(&self, measured_depth: f64) -> Hole {
        let below = self.well.section.partition_point(|section| section.from <= measured_depth);
        self.hole_of(below.checked_sub(1))
    }

    /// The hole of a section by its index, or above all sections.
    pub fn hole_of(&self, section: Option<usize>) -> Hole {
        let section = section.and_then(|index| self.well.section.get(index));
        let own =
            |value: fn(&HoleSection) -> Option<f64>, else_: f64| section.and_then(value).unwrap_or(else_);
        Hole {
            diameter: own(|section| section.hole_diameter, self.well.hole_diameter),
            static_friction: own(|section| section.static_friction, self.contact.static_friction),
            dynamic_friction: own(|section| section.dynamic_friction, self.contact.dynamic_friction),
        }
    }
}

impl Well {
    /// Diameter of the hole's widest part \[m\].
    pub fn widest_hole(&self) -> f64 {
        self.section.iter().filter_map(|section| section.hole_diameter).fold(self.hole_diameter, f64::max)
    }

    /// Diameter of the hole's narrowest part between two depths \[m\].
    pub fn narrowest_hole(&self, [top, bottom]: [f64; 2]) -> f64 {
        let ends = self.section.iter().skip(1).map(|section| section.from).chain([f64::INFINITY]);
        let above = self.section.first().is_none_or(|first| top < first.from);
        let start = if above { self.hole_diameter } else { f64::INFINITY };
        let crossed =
            self.section.iter().zip(ends).filter(|(section, end)| section.from < bottom && top < *end);
        crossed.map(|(section, _)| section.hole_diameter.unwrap_or(self.hole_diameter)).fold(start, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    #[test]
    fn a_depth_has_the_hole_of_the_section_that_begins_there_or_above() {
        let mut scenario = preset("paper-200m").unwrap();
        let plain = Hole { diameter: 0.2159, static_friction: 0.3, dynamic_friction: 0.2 };
        assert_eq!(scenario.hole_at(100.0), plain);
        let section = HoleSection {
            name: String::new(),
            from: 10.0,
            hole_diameter: Some(0.3),
            static_friction: None,
            dynamic_friction: Some(0.1),
        };
        let open = HoleSection { from: 60.0, hole_diameter: None, ..section.clone() };
        scenario.well.section = vec![section, open];
        assert_eq!(scenario.hole_at(9.9), plain);
        let cased = Hole { diameter: 0.3, dynamic_friction: 0.1, ..plain };
        assert_eq!((scenario.hole_at(10.0), scenario.hole_at(59.9)), (cased, cased));
        assert_eq!(scenario.hole_at(60.0), Hole { dynamic_friction: 0.1, ..plain });
        assert_eq!(scenario.well.widest_hole(), 0.3);
        for (between, narrowest) in
            [([0.0, 5.0], 0.2159), ([10.0, 60.0], 0.3), ([5.0, 60.0], 0.2159), ([20.0, 70.0], 0.2159)]
        {
            assert_eq!(scenario.well.narrowest_hole(between), narrowest, "{between:?}");
        }
    }
}
