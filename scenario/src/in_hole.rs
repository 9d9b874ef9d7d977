//! The part of the string that is in the hole.

use std::borrow::Cow;

use drillsweep_quantity::Place;

use crate::{DrillString, Gauge, NodeChoice, Scenario, Section, SectionOrder, UnbalanceMass};

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
    /// gauges, unbalance masses and excitations; with the torque of the bit in place of its aggressiveness. `bit_depth` remains only if the first piece is partly above.
    ///
    /// A bit depth that is not on the string, which validation refuses, leaves the whole string.
    pub fn in_hole(&self) -> Cow<'_, Self> {
        let string = &self.string;
        let mut heights = string.gauges.iter().map(|gauge| gauge.above_bit);
        let mut of_masses = string.unbalance.iter().map(|mass| mass.above_bit);
        if string.order == SectionOrder::FromTop
            && string.bit_depth.is_none()
            && heights.all(|above| above.is_none())
            && of_masses.all(|above| above.is_none())
            && self.bit.aggressiveness.is_none()
            && self.excitation.iter().all(|force| force.above_bit.is_none())
        {
            return Cow::Borrowed(self);
        }
        let mut scenario = self.clone();
        (scenario.operation.torque_on_bit, scenario.bit.aggressiveness) = (self.torque_on_bit(), None);
        let string = &mut scenario.string;
        if string.order == SectionOrder::FromBit {
            string.sections.reverse();
            string.order = SectionOrder::FromTop;
        }
        string.leave_out_above_hole();
        let bit = string.depth_of_bit();
        for gauge in string.gauges.iter_mut().filter(|gauge| gauge.above_bit.is_some()) {
            (gauge.measured_depth, gauge.above_bit) = (Some(gauge.depth(bit)), None);
        }
        for mass in string.unbalance.iter_mut().filter(|mass| mass.above_bit.is_some()) {
            (mass.measured_depth, mass.above_bit) = (Some(mass.depth(bit)), None);
        }
        for force in scenario.excitation.iter_mut().filter(|force| force.above_bit.is_some()) {
            (force.measured_depth, force.above_bit) = (Some(force.depth(bit)), None);
        }
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

impl Gauge {
    /// Gauge at a measured depth \[m\] with a clearance \[m\].
    pub fn at(measured_depth: f64, clearance: f64) -> Self {
        Self { measured_depth: Some(measured_depth), above_bit: None, clearance }
    }

    /// Measured depth \[m\] with the bit at a depth \[m\]; NaN without a place, which validation refuses.
    pub fn depth(&self, bit: f64) -> f64 {
        depth(self.measured_depth, self.above_bit, bit)
    }
}

impl UnbalanceMass {
    /// Measured depth \[m\] with the bit at a depth \[m\]; NaN without a place, which validation refuses.
    pub fn depth(&self, bit: f64) -> f64 {
        depth(self.measured_depth, self.above_bit, bit)
    }
}

pub(crate) fn depth(measured_depth: Option<f64>, above_bit: Option<f64>, bit: f64) -> f64 {
    measured_depth.or(above_bit.map(|above| above_the(bit, above))).unwrap_or(f64::NAN)
}

/// Measured depth \[m\] at a distance above a bit, to a nanometre: lengths of sections add up to 3437.9999999999995 m, and a place must have one depth however it is written.
fn above_the(bit: f64, above: f64) -> f64 {
    ((bit - above) * 1e9).round() / 1e9
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
        scenario.string.gauges = vec![Gauge { above_bit: Some(34.5), measured_depth: None, clearance: 1e-3 }];
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
