//! The part of the string that is in the hole.

use std::borrow::Cow;

use drillsweep_quantity::Place;

use crate::named_section::{NamedSection, NamedSections};
use crate::{
    BitLaw, DrillString, ExcitingForce, Gauge, NodeChoice, Scenario, Section, SectionOrder, UnbalanceMass,
};

/// Difference of depths that rounding makes \[m\].
pub(crate) const SAME_DEPTH: f64 = 1e-6;

/// A section of the string at its place in the hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedSection<'s> {
    /// Its index in `string.sections`.
    pub index: usize,
    /// The section, with all of its pieces.
    pub section: &'s Section,
    /// Measured depth of its upper end \[m\]; negative above the top of the hole.
    pub top: f64,
    /// Measured depth of its lower end \[m\].
    pub bottom: f64,
}

impl PlacedSection<'_> {
    /// Length above the hole \[m\].
    pub fn above_hole(&self) -> f64 {
        if self.top < 0.0 { (-self.top).min(self.bottom - self.top) } else { 0.0 }
    }

    /// Length in the hole \[m\].
    pub fn length_in_hole(&self) -> f64 {
        if self.top < 0.0 { self.bottom.max(0.0) } else { self.section.whole_length() }
    }
}

impl Scenario {
    /// The same scenario written with the string that is in the hole: from the top, without the sections and pieces above it, and with the measured depths of
    /// gauges, unbalance masses and excitations (of those by a section only if one section has its name); with the torque of the bit in place of its aggressiveness,
    /// or the torque of its cut. `bit_depth` remains only if the first piece is partly above.
    ///
    /// A bit depth that is not on the string, which validation refuses, leaves the whole string.
    pub fn in_hole(&self) -> Cow<'_, Self> {
        let string = &self.string;
        let places = || {
            let gauges = string.gauges.iter().map(Gauge::place);
            let masses = string.unbalance.iter().map(UnbalanceMass::place);
            gauges.chain(masses).chain(self.excitation.iter().map(ExcitingForce::place))
        };
        if string.order == SectionOrder::FromTop
            && string.bit_depth.is_none()
            && self.bit.aggressiveness.is_none()
            && self.bit.law != BitLaw::Regenerative
            && places().all(|place| place.above_bit.is_none() && place.section.is_none())
        {
            return Cow::Borrowed(self);
        }
        let named = if places().any(|place| place.section.is_some()) {
            string.named_sections()
        } else {
            NamedSections::default()
        };
        let mut scenario = self.clone();
        (scenario.operation.torque_on_bit, scenario.bit.aggressiveness) = (self.torque_on_bit(), None);
        let string = &mut scenario.string;
        if string.order == SectionOrder::FromBit {
            string.sections.reverse();
            string.order = SectionOrder::FromTop;
        }
        string.leave_out_above_hole();
        let bit = string.depth_of_bit();
        macro_rules! put_at_depths {
            ($placed:expr) => {
                for placed in $placed.iter_mut() {
                    if let Some(depth) = placed.place().moving_depth(bit, &named) {
                        placed.measured_depth = Some(depth);
                        (placed.above_bit, placed.section, placed.above_end) = (None, None, None);
                    }
                }
            };
        }
        put_at_depths!(string.gauges);
        put_at_depths!(string.unbalance);
        put_at_depths!(scenario.excitation);
        Cow::Owned(scenario)
    }
}

impl DrillString {
    /// Length of all sections \[m\].
    pub fn whole_length(&self) -> f64 {
        self.top_down().map(|(_, section)| section.whole_length()).sum()
    }

    /// Measured depth of the bit \[m\].
    pub fn depth_of_bit(&self) -> f64 {
        let whole = self.whole_length();
        self.bit_depth.filter(|depth| (SAME_DEPTH..whole - SAME_DEPTH).contains(depth)).unwrap_or(whole)
    }

    /// The sections from the top down at their measured depths.
    pub fn placed_sections(&self) -> impl Iterator<Item = PlacedSection<'_>> {
        let top = self.depth_of_bit() - self.whole_length();
        self.top_down().scan(top, |depth, (index, section)| {
            let top = *depth;
            *depth += section.whole_length();
            Some(PlacedSection { index, section, top, bottom: *depth })
        })
    }

    /// Sections by their names.
    pub fn named_sections(&self) -> NamedSections<'_> {
        NamedSections::new(self.placed_sections().map(|PlacedSection { index, section, bottom, .. }| {
            (section.name.as_str(), NamedSection { index, bottom, length: section.whole_length() })
        }))
    }

    /// Sections from the top down, with their indices.
    fn top_down(&self) -> impl Iterator<Item = (usize, &Section)> {
        let count = self.sections.len();
        (0..count).map(move |place| {
            let index = match self.order {
                SectionOrder::FromTop => place,
                SectionOrder::FromBit => count - 1 - place,
            };
            (index, &self.sections[index])
        })
    }

    /// Mass in air of the part of a section that is in the hole \[kg\].
    pub fn mass_in_hole(&self, placed: &PlacedSection<'_>) -> f64 {
        let section = placed.section;
        let above = placed.above_hole();
        if above == 0.0 {
            return self.mass(section);
        }
        let pieces = (above / section.length).floor();
        let joint =
            section.tool_joint.map(|joint| (joint.length, self.joint(section, &joint).mass_per_length()));
        let (joint_length, joint) = joint.unwrap_or_default();
        let rest = above - pieces * section.length;
        let in_body = (rest - joint_length).min(section.length - 2.0 * joint_length).max(0.0);
        let of_rest = in_body * self.body(section).mass_per_length() + (rest - in_body) * joint;
        self.mass(section) * (1.0 - pieces / f64::from(section.count)) - of_rest
    }

    fn leave_out_above_hole(&mut self) {
        let mut above = self.whole_length() - self.depth_of_bit();
        let is_above = |section: &Section, above: &mut f64| {
            let length = section.whole_length();
            let is_above = length <= *above + SAME_DEPTH;
            *above -= if is_above { length } else { 0.0 };
            is_above
        };
        let left_out = self.sections.iter().take_while(|section| is_above(section, &mut above)).count();
        self.sections.drain(..left_out);
        if let Some(first) = self.sections.first_mut() {
            let pieces = ((above + SAME_DEPTH) / first.length).floor().clamp(0.0, f64::from(first.count));
            first.count -= pieces as u32;
            above -= pieces * first.length;
        }
        if above.is_nan() || above <= SAME_DEPTH {
            self.bit_depth = None;
        }
    }
}

/// Fields by which a place on the string is given: `measured_depth`, `above_bit`, or `section` with `above_end`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrittenPlace<'p> {
    /// Measured depth \[m\].
    pub measured_depth: Option<f64>,
    /// Distance above the lower end of the bit \[m\].
    pub above_bit: Option<f64>,
    /// Name of a section.
    pub section: Option<&'p str>,
    /// Distance above the lower end of that section \[m\].
    pub above_end: Option<f64>,
}

impl WrittenPlace<'_> {
    /// Measured depth \[m\] with the bit at a depth \[m\]; NaN of a place by its section, and without a place, which validation refuses.
    fn depth(&self, bit: f64) -> f64 {
        self.measured_depth.or(self.above_bit.map(|above| above_the(bit, above))).unwrap_or(f64::NAN)
    }

    /// Measured depth \[m\] of a place by its section, negative above the hole; absent if no section has the name, or several have it.
    pub fn depth_by_section(&self, sections: &NamedSections<'_>) -> Option<f64> {
        let section = sections.only(self.section?)?;
        Some(above_the(section.bottom, self.above_end.unwrap_or(0.0)))
    }

    /// Measured depth \[m\] of a place that moves with the bit or with a section; absent by measured depth, and of a section that is not found.
    fn moving_depth(&self, bit: f64, sections: &NamedSections<'_>) -> Option<f64> {
        match (self.measured_depth, self.above_bit) {
            (_, Some(_)) => Some(self.depth(bit)),
            (Some(_), None) => None,
            (None, None) => self.depth_by_section(sections),
        }
    }
}

macro_rules! placed_on_string {
    ($($type:ident),*) => {$(
        impl $type {
            /// Fields by which its place is given.
            pub fn place(&self) -> WrittenPlace<'_> {
                WrittenPlace {
                    measured_depth: self.measured_depth,
                    above_bit: self.above_bit,
                    section: self.section.as_deref(),
                    above_end: self.above_end,
                }
            }

            /// Measured depth \[m\] with the bit at a depth \[m\]; NaN of a place by its section, which [`Scenario::in_hole`] resolves, and without a
            /// place, which validation refuses.
            pub fn depth(&self, bit: f64) -> f64 {
                self.place().depth(bit)
            }
        }
    )*};
}

placed_on_string!(Gauge, UnbalanceMass, ExcitingForce);

impl Gauge {
    /// Gauge at a measured depth \[m\] with a clearance \[m\].
    pub fn at(measured_depth: f64, clearance: f64) -> Self {
        Self {
            measured_depth: Some(measured_depth),
            above_bit: None,
            section: None,
            above_end: None,
            clearance,
        }
    }

    /// Gauge at a distance above the bit \[m\] with a clearance \[m\].
    pub fn above_bit(above_bit: f64, clearance: f64) -> Self {
        Self { measured_depth: None, above_bit: Some(above_bit), section: None, above_end: None, clearance }
    }
}

/// Measured depth \[m\] at a distance above another one, to a nanometre: lengths of sections add up to 3437.9999999999995 m, and a place must have one depth however it is written.
fn above_the(end: f64, above: f64) -> f64 {
    ((end - above) * 1e9).round() / 1e9
}

impl NodeChoice {
    /// Measured depth \[m\] with the bit at a depth \[m\]; absent for a number.
    pub fn depth(self, bit: f64) -> Option<f64> {
        match self {
            NodeChoice::Node(_) => None,
            NodeChoice::Depth(depth) => Some(depth),
            NodeChoice::AboveBit(above) => Some(above_the(bit, above)),
        }
    }

    /// The node in names of columns: `49`, `57_7m`, `12_5m_above_bit`.
    pub fn in_names(self) -> String {
        match self {
            NodeChoice::Node(node) => node.to_string(),
            NodeChoice::Depth(depth) => Place::of_depth(depth),
            NodeChoice::AboveBit(above) => Place::of_height(above),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    /// The base case: 4 m, nine jointed pieces of 9.5 m, 110.5 m below.
    fn with_bit_at(depth: f64) -> Scenario {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.string.bit_depth = Some(depth);
        scenario
    }

    #[test]
    fn sections_and_pieces_above_the_hole_are_left_out() {
        let whole = preset("paper-200m").unwrap();
        let pieces = |depth: f64| {
            let scenario = with_bit_at(depth).in_hole().into_owned();
            assert_eq!(*scenario.in_hole(), scenario, "once is enough");
            let first = &scenario.string.sections[0];
            (scenario.string.sections.len(), first.count, scenario.string.bit_depth)
        };
        assert_eq!(*with_bit_at(200.0).in_hole(), whole);
        assert_eq!(pieces(196.0), (7, 9, None));
        assert_eq!(pieces(195.9), (7, 9, Some(195.9)));
        assert_eq!(pieces(158.0 + 1e-9), (7, 5, None));
        assert_eq!(pieces(157.0), (7, 5, Some(157.0)));
        assert_eq!(pieces(110.5), (6, 1, None));
        assert_eq!(pieces(0.1), (1, 1, Some(0.1)));
        for refused in [0.0, -1.0, 200.1, f64::NAN] {
            assert_eq!(*with_bit_at(refused).in_hole(), whole, "{refused} m");
        }
    }

    #[test]
    fn places_above_the_bit_move_with_it() {
        let mut scenario = with_bit_at(120.0);
        scenario.string.gauges = vec![Gauge::above_bit(34.5, 1e-3)];
        scenario.string.unbalance.truncate(1);
        (scenario.string.unbalance[0].measured_depth, scenario.string.unbalance[0].above_bit) =
            (None, Some(0.0));
        let found = scenario.in_hole();
        assert_eq!(found.string.gauges, [Gauge::at(85.5, 1e-3)]);
        assert_eq!(found.string.unbalance[0].measured_depth, Some(120.0));
        scenario.string.bit_depth = None;
        assert_eq!(scenario.in_hole().string.gauges, [Gauge::at(165.5, 1e-3)]);
    }

    #[test]
    fn places_by_section_move_with_it_and_not_with_others() {
        let mut scenario = with_bit_at(120.0);
        scenario.string.gauges.clear();
        scenario.string.unbalance.truncate(1);
        let mass = &mut scenario.string.unbalance[0];
        (mass.measured_depth, mass.section, mass.above_end) = (None, Some("collars".to_owned()), Some(1.5));
        let sections = &mut scenario.string.sections;
        sections[2].name = "collars".to_owned();
        let below: f64 = sections[3..].iter().map(Section::whole_length).sum();
        let depth = |scenario: &Scenario| scenario.in_hole().string.unbalance[0].measured_depth;
        let expected = ((120.0 - below - 1.5) * 1e9).round() / 1e9;
        assert_eq!(depth(&scenario), Some(expected));
        let mut longer = scenario.clone();
        let sub =
            Section { name: "sub".to_owned(), count: 1, length: 2.0, ..longer.string.sections[2].clone() };
        longer.string.sections.insert(3, sub);
        assert!((depth(&longer).unwrap() - (expected - 2.0)).abs() < 1e-9, "two metres further from the bit");
        let mut from_bit = scenario.clone();
        from_bit.string.sections.reverse();
        from_bit.string.order = SectionOrder::FromBit;
        assert_eq!(depth(&from_bit), Some(expected));
        scenario.string.bit_depth = Some(below - 1.0);
        assert_eq!(depth(&scenario), Some(-2.5), "above the hole");
        scenario.string.sections[3].name = "collars".to_owned();
        assert_eq!(depth(&scenario), None, "of two sections");
    }

    #[test]
    fn sections_end_at_their_distance_from_the_bit() {
        let ends = |depth: f64| -> Vec<f64> {
            let string = with_bit_at(depth).string;
            string.placed_sections().map(|placed| depth - placed.bottom).collect()
        };
        for (whole, cut) in ends(200.0).iter().zip(ends(77.0)) {
            assert!((whole - cut).abs() < 1e-9, "{whole} m, not {cut}");
        }
    }

    #[test]
    fn both_orders_are_one_string() {
        for depth in [200.0, 77.0] {
            let from_top = with_bit_at(depth);
            let mut from_bit = from_top.clone();
            from_bit.string.sections.reverse();
            from_bit.string.order = SectionOrder::FromBit;
            assert_eq!(from_bit.in_hole(), from_top.in_hole());
            let ends = |string: &DrillString| -> Vec<f64> {
                string.placed_sections().map(|placed| placed.bottom).collect()
            };
            assert_eq!(ends(&from_bit.string), ends(&from_top.string));
            let last = from_bit.string.placed_sections().last().unwrap();
            assert_eq!(
                (last.index, last.section),
                (0, &from_bit.string.sections[0]),
                "the bit is listed first"
            );
            assert_eq!(from_bit.gauges(), from_top.gauges());
        }
    }

    #[test]
    fn mass_in_the_hole_is_that_of_pieces_bodies_and_joints() {
        let string = |depth: f64| with_bit_at(depth).string;
        let of_pipe = |depth: f64| {
            let string = string(depth);
            let pipe = string.placed_sections().nth(1).unwrap();
            assert!((pipe.length_in_hole() - (depth - 110.5).clamp(0.0, 85.5)).abs() < 1e-9);
            string.mass_in_hole(&pipe)
        };
        let section = &string(200.0).sections[1];
        let joint = section.tool_joint.unwrap();
        let lines = [
            string(200.0).joint(section, &joint).mass_per_length(),
            string(200.0).body(section).mass_per_length(),
        ];
        let one = string(200.0).mass(section) / 9.0;
        for (depth, expected) in [
            (196.0, 9.0 * one),
            (110.5, 0.0),
            (110.5 + 0.1, 0.1 * lines[0]),
            (110.5 + joint.length + 2.0, joint.length * lines[0] + 2.0 * lines[1]),
            (120.0 + 9.5 - 0.1, 2.0 * one - 0.1 * lines[0]),
        ] {
            assert!((of_pipe(depth) - expected).abs() < 1e-9 * one, "{depth} m: {} kg", of_pipe(depth));
        }
    }

    #[test]
    fn blades_and_components_go_with_the_bit() {
        let mut scenario = with_bit_at(120.0);
        scenario.string.gauges.clear();
        scenario.string.sections[1].name = "pipe".to_owned();
        scenario.string.sections[1].blade_diameter = Some(0.2);
        scenario.string.sections[1].blade_above_end = Some(1.0);
        let depths: Vec<f64> = scenario.gauges().iter().map(|gauge| gauge.depth(120.0)).collect();
        assert_eq!(depths, [8.5], "blades above the hole are left out");
        assert_eq!((scenario.string.component_at(0.0), scenario.string.component_at(9.6)), ("pipe", ""));
    }
}
