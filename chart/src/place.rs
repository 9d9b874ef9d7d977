//! Positions of nodes in the well, in words.

use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Name, Quantity, UnitChoice};

use crate::words::words;

/// Position of a node, for the notes on its columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Place {
    /// The place in names of columns: `49`, `57_7m`, `12_5m_above_bit`.
    pub name: String,
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// Angle of the low side, from u towards v \[rad\]; none if the hole is vertical.
    pub low_side: Option<f64>,
    /// Name of the component; empty if its section has none.
    pub component: String,
}

/// Description of a column; of a node that is among the `places`, with its position, its component and its direction of motion.
pub(crate) fn at_place(name: &str, places: &[Place], choice: &UnitChoice) -> String {
    let Some((parsed, of_name)) = Name::parse(name).and_then(|name| Some((name, name.place?))) else {
        return words(name);
    };
    let elsewhere = Name { place: None, window: None, ..parsed };
    let window = parsed.window.map(|window| format!(", window {window}")).unwrap_or_default();
    let known = places.iter().find(|place| place.name == of_name.in_names());
    let component = known.map_or("", |place| &place.component);
    let component = if component.is_empty() { String::new() } else { format!(", {component}") };
    if let Some(height) = of_name.height() {
        let height = grouped(choice.depth().of(height));
        return format!("{elsewhere} {height} {} above the bit{component}{window}", choice.depth().symbol);
    }
    let Some(depth) = of_name.depth().or(known.map(|place| place.measured_depth)) else {
        return words(name);
    };
    let depth = at_depth(depth, choice);
    let direction = known.map(|place| direction(parsed.quantity, place.low_side)).unwrap_or_default();
    format!("{elsewhere} at {depth}{component}{direction}{window}")
}

/// Sign of a lateral displacement or speed, seen down the hole: u points to e1 and v to e2 (docs/model/well.md), and with
/// e1 on the low side e2 is on the left.
fn direction(quantity: &Quantity, low_side: Option<f64>) -> String {
    /// Directions this near to one that has a name bear it \[deg\].
    const NEAR: f64 = 1.0;
    let own = match quantity {
        quantity if quantity == &U || quantity == &U_RATE => 0.0,
        quantity if quantity == &V || quantity == &V_RATE => 90.0,
        quantity if quantity == &W || quantity == &W_RATE => return ", axial, downhole".to_owned(),
        _ => return String::new(),
    };
    let Some(low_side) = low_side else {
        return format!(", lateral, along {}", if own == 0.0 { "e1" } else { "e2" });
    };
    // From the low side to the left, within half a turn either way.
    let angle = (own - low_side.to_degrees() + 180.0).rem_euclid(360.0) - 180.0;
    let towards = match angle.abs() {
        off if off < NEAR => "to the low side".to_owned(),
        off if off > 180.0 - NEAR => "to the high side".to_owned(),
        off => {
            let side = if angle > 0.0 { "left" } else { "right" };
            if (off - 90.0).abs() < NEAR {
                format!("to the {side}")
            } else {
                format!("{off:.0}° {side} of the low side")
            }
        }
    };
    format!(", lateral, {towards}")
}

/// A measured depth in words: `57.7 m MD`.
pub(crate) fn at_depth(depth: f64, choice: &UnitChoice) -> String {
    let unit = choice.depth();
    format!("{} {} MD", grouped(unit.of(depth)), unit.symbol)
}

/// A depth to a tenth, whole ones from 1000 on with their thousands apart.
fn grouped(depth: f64) -> String {
    let whole = depth.round() as i64;
    if whole >= 1000 { format!("{} {:03}", whole / 1000, whole % 1000) } else { format!("{depth:.1}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legends_show_the_place_of_a_node_and_its_direction() {
        let place = |low_side: Option<f64>| {
            [Place { name: "10".to_owned(), measured_depth: 3412.3, low_side, ..Place::default() }]
        };
        let label = |name, low_side: Option<f64>| {
            at_place(name, &place(low_side.map(f64::to_radians)), &UnitChoice::default())
        };
        // Seen down the hole with the low side down, a turn from u to v is clockwise: from down to the left.
        for (name, low_side, words) in [
            ("u_10", Some(0.0), "u at 3 412 m MD, lateral, to the low side"),
            ("u_10", Some(180.0), "u at 3 412 m MD, lateral, to the high side"),
            ("v_10", Some(0.0), "v at 3 412 m MD, lateral, to the left"),
            ("v_10", Some(90.0), "v at 3 412 m MD, lateral, to the low side"),
            ("u_10", Some(90.0), "u at 3 412 m MD, lateral, to the right"),
            ("v_10", Some(-120.0), "v at 3 412 m MD, lateral, 150° right of the low side"),
            ("u_10", None, "u at 3 412 m MD, lateral, along e1"),
            ("w_10", Some(0.0), "w at 3 412 m MD, axial, downhole"),
            ("u_11", Some(0.0), "u, node 11"),
            ("spread_orbit_radius_rms_10", Some(0.0), "spread of lateral vibration at 3 412 m MD"),
            ("line_amplitude_10_w2", None, "amplitude of the highest line at 3 412 m MD, window 2"),
            (
                "line_amplitude_12_5m_above_bit_w2",
                None,
                "amplitude of the highest line 12.5 m above the bit, window 2",
            ),
            ("line_amplitude_57_7m_w2", None, "amplitude of the highest line at 57.7 m MD, window 2"),
        ] {
            assert_eq!(label(name, low_side), words);
        }
        let field = UnitChoice::parse("field").unwrap();
        assert_eq!(at_place("u_10", &place(None), &field), "u at 11 195 ft MD, lateral, along e1");
        let [mut of_node, mut of_height] = [place(Some(0.0)), place(None)].map(|[place]| place);
        of_node.component = "MWD".to_owned();
        (of_height.name, of_height.component) = ("8_2m_above_bit".to_owned(), "6.75 in collar".to_owned());
        let places = [of_node, of_height];
        for (name, words) in [
            ("u_10", "u at 3 412 m MD, MWD, lateral, to the low side"),
            ("orbit_radius_rms_8_2m_above_bit", "lateral vibration 8.2 m above the bit, 6.75 in collar"),
            ("line_amplitude_10_w2", "amplitude of the highest line at 3 412 m MD, MWD, window 2"),
        ] {
            assert_eq!(at_place(name, &places, &UnitChoice::default()), words);
        }
        assert_eq!([57.73, 999.97, 12_003.0].map(grouped), ["57.7", "1 000", "12 003"]);
    }
}
