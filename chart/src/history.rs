//! The picture of motion over time.

use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Name, Quantity, Unit, UnitChoice, Variant, units};
use drillsweep_table::{Column, Table};

use crate::error::ChartError;
use crate::picture::{Drawing, Line, LinePlot};
use crate::place::{Place, at_depth, at_place};
use crate::shown::{Shown, node_of, numbers, with_unit};

/// The columns of a history that its picture shows, out of its `layout`: the time, and u and v, and rotation speed and torque of the lowest
/// node, or the `fields` that are given.
///
/// # Errors
/// A problem that names the columns there are, if a field is none of them.
pub fn shown_of_history(layout: &Table, fields: Option<&[String]>) -> Result<Table, ChartError> {
    let rotation =
        ROTATION.iter().filter(|_| fields.is_none()).filter_map(|quantity| lowest(layout, quantity));
    let lines = lines_of_history(layout, fields).into_iter().chain(rotation);
    let mut names: Vec<String> = lines.map(str::to_owned).collect();
    names.push(TIME.name.to_owned());
    layout.select(&names).map_err(|missing| ChartError::no_such_column(layout, &missing))
}

/// Lowest node of a string, with its rotation in snapshots.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bit {
    /// Number of the node.
    pub node: u32,
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// `time`, `rotation_speed` and `torque` of this node alone, out of the snapshots; none if there are no snapshots of torsion.
    pub snapshots: Option<Table>,
}

/// Columns of a history over time: u and v, or the `fields` that are given. If nothing is requested and the string twists, rotation
/// speed and torque at the `bit` follow below: of its history, or else of the snapshots. If neither has the bit, or none is given, they are
/// those of the lowest node that has them; in place of the bit, the picture says so. The legend says of each line where its node lies
/// and which way the motion goes, for nodes that are among the `places`.
///
/// # Errors
/// A problem that names the columns there are, if a field is none of them.
pub fn history(
    table: &Table,
    fields: Option<&[String]>,
    places: &[Place],
    bit: Option<&Bit>,
    title: &str,
    choice: &UnitChoice,
) -> Result<Drawing, ChartError> {
    let names = lines_of_history(table, fields);
    let shown = Shown::of(table, &names, choice)?;
    let y_label = shown.label(places, choice);
    let rotation = match fields {
        Some(_) => Rotation::default(),
        None => Rotation::of(table, places, bit, choice),
    };
    let own = node_of(table, choice);
    let subtitle = if rotation.panels.is_empty() && own.is_empty() { &rotation.remark } else { &own };
    let line_name = |name: &str| at_place(name, places, choice);
    let mut drawing = over_time(table, shown, &y_label, &line_name, [title, subtitle])?;
    for (number, Panel { quantity, table, column, line }) in rotation.panels.iter().enumerate() {
        let unit = match quantity.units {
            Some(units) if *units == units::ANGULAR_SPEED => Some(rotation_unit(column, choice)),
            _ => choice.shown(column),
        };
        let shown = Shown::within(table, &[column], unit)?;
        let y_label = match unit {
            Some(unit) => format!("{} [{}]", quantity.label, unit.symbol),
            None => quantity.label.to_owned(),
        };
        let remark = if number == 0 { &rotation.remark } else { "" };
        drawing = drawing.above(over_time(table, shown, &y_label, &|_| line.clone(), ["", remark])?);
    }
    Ok(drawing)
}

/// Unit of a rotation speed, which drillers read in rpm in any system.
fn rotation_unit(column: &str, choice: &UnitChoice) -> Unit {
    choice.named(column).unwrap_or(units::ANGULAR_SPEED.field)
}

/// Rotation speed of a node over time \[rpm\], as drillers read it in any system.
///
/// # Errors
/// A problem that names the columns there are, if `column` is none of them.
pub fn rotation(table: &Table, column: &str, title: &str) -> Result<Drawing, ChartError> {
    let shown = Shown::within(table, &[column], Some(units::ANGULAR_SPEED.field))?;
    let y_label = shown.label(&[], &UnitChoice::default());
    over_time(table, shown, &y_label, &|_| String::new(), [title, ""])
}

/// Quantities shown below the lateral motion of a string that twists.
const ROTATION: [&Quantity; 2] = [&ROTATION_SPEED, &TORQUE];

/// Rotation speed and torque of one node, as far as they vary.
#[derive(Default)]
struct Rotation<'t> {
    panels: Vec<Panel<'t>>,
    /// Note on a quantity that differs from what its name suggests.
    remark: String,
}

/// One of them over time.
struct Panel<'t> {
    quantity: &'static Quantity,
    table: &'t Table,
    column: &'t str,
    /// Name of the line.
    line: String,
}

impl<'t> Rotation<'t> {
    /// Label of the bit, or else of the lowest node of the history.
    fn of(history: &'t Table, places: &[Place], bit: Option<&'t Bit>, choice: &UnitChoice) -> Self {
        let lowest = ROTATION.map(|quantity| lowest(history, quantity));
        let node = lowest.into_iter().flatten().find_map(|name| Name::parse(name)?.place?.node());
        let at_node = |_: &Quantity, name: &str| at_place(name, places, choice);
        let Some(bit) = bit else { return Self::from_columns(history, lowest, at_node) };
        let depth = at_depth(bit.measured_depth, choice);
        let at_bit = |quantity: &Quantity, _: &str| format!("{} at the bit, {depth}", quantity.label);
        match (&bit.snapshots, node) {
            (_, Some(node)) if node == bit.node as usize => Self::from_columns(history, lowest, at_bit),
            (Some(snapshots), _) => {
                Self::from_columns(snapshots, ROTATION.map(|quantity| Some(quantity.name)), at_bit)
            }
            (None, Some(_)) => {
                let remark =
                    format!("Rotation at the bit, at {depth}, was not recorded (recording.snapshots).");
                Rotation { remark, ..Self::from_columns(history, lowest, at_node) }
            }
            (None, None) => Rotation::default(),
        }
    }

    fn from_columns(
        table: &'t Table,
        columns: [Option<&'t str>; 2],
        line: impl Fn(&Quantity, &str) -> String,
    ) -> Self {
        let panel = |(quantity, column): (&'static Quantity, Option<&'t str>)| {
            let column = column.filter(|name| varies(table, name))?;
            Some(Panel { quantity, table, column, line: line(quantity, column) })
        };
        Rotation {
            panels: ROTATION.into_iter().zip(columns).filter_map(panel).collect(),
            remark: String::new(),
        }
    }
}

fn over_time(
    table: &Table,
    shown: Shown,
    y_label: &str,
    line_name: &dyn Fn(&str) -> String,
    [title, subtitle]: [&str; 2],
) -> Result<Drawing, ChartError> {
    let time = numbers(table, TIME.name)?;
    let line = |(name, values): (&str, Vec<f64>)| Line {
        name: line_name(name),
        points: time.iter().zip(values).map(|(time, value)| [*time, value]).collect(),
        is_marked: false,
    };
    let plot = LinePlot {
        title: title.to_owned(),
        subtitle: subtitle.to_owned(),
        x_label: with_unit(TIME.name, &UnitChoice::default()),
        y_label: y_label.to_owned(),
        lines: shown.columns.into_iter().map(line).collect(),
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

/// The column of a quantity of the lowest node that has one.
fn lowest<'t>(table: &'t Table, quantity: &Quantity) -> Option<&'t str> {
    let columns = table.columns.keys().filter_map(|name| {
        let parsed = Name::parse(name)?;
        (parsed.quantity == quantity && parsed.variant == Variant::Value)
            .then_some((parsed.place?.node()?, name))
    });
    columns.max_by_key(|(node, _)| *node).map(|(_, name)| name.as_str())
}

/// True if the numbers of a column are not all the same.
fn varies(table: &Table, name: &str) -> bool {
    let values = table.columns.get(name).and_then(Column::numbers);
    values.is_some_and(|values| values.iter().any(|value| *value != values[0]))
}

fn lines_of_history<'t>(table: &'t Table, fields: Option<&'t [String]>) -> Vec<&'t str> {
    let is_lateral =
        |name: &&str| Name::parse(name).is_some_and(|name| name.quantity == &U || name.quantity == &V);
    match fields {
        Some(fields) => fields.iter().map(String::as_str).collect(),
        None => table.columns.keys().map(String::as_str).filter(is_lateral).collect(),
    }
}

#[cfg(test)]
mod tests {

    use super::*;

    fn column(values: &[f64]) -> Column {
        Column::Number(values.to_vec())
    }

    /// A history of node 10, which turns as the drive does, and of node 49.
    fn twisting(speed: f64, torque: f64) -> Table {
        Table::default()
            .with("time", column(&[0.0, 1.0]))
            .with("u_10", column(&[0.0, 1e-3]))
            .with("rotation_speed_10", column(&[12.0, 12.0]))
            .with("torque_10", column(&[5.0, 6.0]))
            .with("rotation_speed_49", column(&[0.0, speed]))
            .with("torque_49", column(&[-1e3, torque]))
    }

    /// Once around a second is 60 rpm.
    const ONCE_A_SECOND: f64 = std::f64::consts::TAU;

    #[test]
    fn history_of_a_twisting_string_shows_rotation_speed_and_torque_of_the_bit() {
        let places = [Place { name: "49".to_owned(), measured_depth: 200.0, ..Place::default() }];
        let picture =
            |table: &Table| history(table, None, &places, None, "", &UnitChoice::default()).unwrap();
        let still = picture(&twisting(0.0, -1e3));
        let torque_alone = picture(&twisting(0.0, -4e3));
        let twisted = picture(&twisting(ONCE_A_SECOND, -4e3));
        assert!(!still.svg().contains("torque") && !still.svg().contains("speed"));
        assert!(torque_alone.svg().contains(">torque [kN m]<") && !torque_alone.svg().contains("speed"));
        assert!(torque_alone.height() > 1.8 * still.height() && twisted.height() > 2.7 * still.height());
        let svg = twisted.svg();
        assert!(
            svg.contains("rotation speed at 200.0 m MD") && svg.contains(">rotation speed [rpm]<"),
            "{svg}"
        );
        assert!(svg.contains(">60<") && svg.contains(">−4<") && twisted.png(400).is_ok(), "{svg}");
        let field = UnitChoice::parse("field").unwrap();
        let table = twisting(ONCE_A_SECOND, -4e3);
        let field = history(&table, None, &places, None, "", &field).unwrap().svg();
        for words in ["rotation speed at 656.2 ft MD", ">rotation speed [rpm]<", ">torque [ft lbf]<", "[in]<"]
        {
            assert!(field.contains(words), "{words} in {field}");
        }
        let layout = twisting(1.0, 1.0);
        let shown = shown_of_history(&layout, None).unwrap();
        let names: Vec<_> = shown.columns.keys().map(String::as_str).collect();
        assert_eq!(names, ["u_10", "rotation_speed_49", "torque_49", "time"]);
        let chosen =
            history(&layout, Some(&["u_10".to_owned()]), &places, None, "", &UnitChoice::default()).unwrap();
        assert!(!chosen.svg().contains("torque"));
    }

    #[test]
    fn rotation_of_the_bit_is_shown_or_its_absence_noted() {
        let picture = |node, snapshots, table: &Table| {
            let bit = Bit { node, measured_depth: 201.5, snapshots };
            history(table, None, &[], Some(&bit), "", &UnitChoice::default()).unwrap()
        };
        let table = twisting(ONCE_A_SECOND, -4e3);
        // Twice around a second, under other torques.
        let snapshots = Table::default()
            .with("time", column(&[0.0, 0.5, 1.0]))
            .with("rotation_speed", column(&[0.0, 2.0 * ONCE_A_SECOND, 0.0]))
            .with("torque", column(&[-7e3, -9e3, -7e3]));
        let (of_history, of_snapshots) = ([">60<", ">−4<"], [">100<", ">−9.0<"]);
        let at_bit = "rotation speed at the bit, 201.5 m MD";
        let untold = "Rotation at the bit, at 201.5 m MD, was not recorded";
        for (drawing, shown, others, says, says_not) in [
            (picture(49, None, &table), of_history, of_snapshots, at_bit, untold),
            (picture(49, Some(snapshots.clone()), &table), of_history, of_snapshots, at_bit, untold),
            (picture(297, Some(snapshots.clone()), &table), of_snapshots, of_history, at_bit, untold),
            (picture(297, None, &table), of_history, of_snapshots, untold, at_bit),
        ] {
            let svg = drawing.svg();
            assert!(shown.iter().all(|tick| svg.contains(tick)), "{shown:?} in {svg}");
            assert!(!others.iter().all(|tick| svg.contains(tick)), "{others:?} in {svg}");
            assert!(svg.contains(says) && !svg.contains(says_not), "{svg}");
        }
        // A fixed node has no motion of the bit, and a string that does not twist has no rotation.
        let held = picture(297, None, &twisting(0.0, -1e3)).svg();
        assert!(held.contains(untold) && !held.contains("rpm"), "{held}");
        let lateral = Table::default().with("time", column(&[0.0, 1.0])).with("u_10", column(&[0.0, 1e-3]));
        assert!(!picture(297, None, &lateral).svg().contains("bit"));
    }
}
