//! Directional surveys.

use std::f64::consts::PI;

use drillsweep_quantity::columns::MEASURED_DEPTH;
use drillsweep_quantity::entry;
use drillsweep_scenario::SurveyStation;
use serde::Serialize;

use crate::error::ImportError;
use crate::grid::Grid;
use crate::headings::{Found, Sought, find};
use crate::measure::spelled;
use crate::number::number;
use crate::rows::{CellProblem, MOST_PROBLEMS, MOST_STATIONS, Row, Rows, UnderstoodColumn};
use crate::witsml;

/// Columns of a survey.
const COLUMNS: [Sought; 3] = [
    Sought {
        quantity: "measured_depth",
        is_required: true,
        headings: &[
            "md",
            "dept",
            "depth",
            "measureddepth",
            "measdepth",
            "depthmd",
            "mdrkb",
            "mdrt",
            "mdkb",
            "mdbrt",
            "mddepth",
            "surveydepth",
            "measureddepthmd",
        ],
    },
    Sought {
        quantity: "inclination",
        is_required: true,
        headings: &[
            "inc",
            "incl",
            "inclin",
            "inclination",
            "inca",
            "deviation",
            "devi",
            "dev",
            "angle",
            "drift",
        ],
    },
    Sought {
        quantity: "azimuth",
        is_required: true,
        headings: &[
            "azi",
            "az",
            "azim",
            "azimuth",
            "azit",
            "azimuthtrue",
            "azimuthgrid",
            "azigrid",
            "azitrue",
            "azimgrid",
            "azimtrue",
            "azmth",
            "hazi",
            "direction",
        ],
    },
];

/// Choices of the reader that a file does not make.
#[derive(Debug, Clone, Copy, Default)]
pub struct SurveyOptions<'a> {
    /// Unit of measured depth if the file gives none, such as `ft`.
    pub depth_unit: Option<&'a str>,
    /// Sheet of a workbook; the first one if absent.
    pub sheet: Option<&'a str>,
}

/// A survey that was read, with what was understood.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct Survey {
    /// Stations in the order of depth, for `well.survey`; the first one at depth 0.
    pub stations: Vec<SurveyStation>,
    /// Meaning of each column.
    pub columns: Vec<UnderstoodColumn>,
    /// Remarks on what was added or changed, in words.
    pub remarks: Vec<String>,
    /// Cells that could not be used, in the order of the file; their rows are left out.
    pub problems: Vec<CellProblem>,
}

/// The survey of a file: CSV, Excel, LAS, or a WITSML 1.4.1.1 or 2.0 trajectory.
///
/// # Errors
/// The file cannot be read, has no headings of a survey, no unit of depth, or fewer than two stations.
pub fn survey(bytes: &[u8], options: SurveyOptions<'_>) -> Result<Survey, ImportError> {
    let (rows, columns, problems) = if witsml::is_xml(bytes) {
        witsml::trajectory(bytes)?
    } else {
        of_grid(&Grid::read(bytes, options.sheet)?, options.depth_unit)?
    };
    checked(rows, columns, problems)
}

fn of_grid(grid: &Grid, depth_unit: Option<&str>) -> Result<Rows, ImportError> {
    const WANTED: &str =
        "measured depth, inclination and azimuth, such as `MD (m)`, `Inc (deg)`, `Azi (deg)`";
    let (found, first) = find(grid, &COLUMNS.each_ref()).ok_or(ImportError::NoHeadings(WANTED))?;
    let found: Vec<Found> = found.into_iter().flatten().collect();
    let mut columns = Vec::new();
    let mut scales = Vec::new();
    for (sought, found) in COLUMNS.iter().zip(&found) {
        let (unit, is_assumed, scale) = if sought.quantity == "measured_depth" {
            depth_scale(found, depth_unit)?
        } else {
            angle_scale(sought.quantity, found)?
        };
        scales.push(scale);
        columns.push(UnderstoodColumn {
            quantity: sought.quantity,
            column: found.name.clone(),
            heading: found.heading.clone(),
            unit,
            is_assumed,
        });
    }
    let (mut rows, mut problems) = (Vec::new(), Vec::new());
    for (row, cells) in grid.rows.iter().enumerate().skip(first) {
        let texts: Vec<&str> =
            found.iter().map(|found| cells.get(found.column).map_or("", String::as_str)).collect();
        if texts.iter().all(|text| text.is_empty()) || problems.len() >= MOST_PROBLEMS {
            continue;
        }
        let mut values = [0.0; 3];
        let mut is_complete = true;
        for (order, text) in texts.iter().enumerate() {
            match number(text, grid.has_decimal_comma) {
                Some(value) => values[order] = value * scales[order],
                None => {
                    is_complete = false;
                    let problem = if text.is_empty() { "the cell is empty" } else { "no number" };
                    problems.push(CellProblem::new(row, Some(&found[order].name), text, problem));
                }
            }
        }
        if is_complete {
            let [measured_depth, inclination_deg, azimuth_deg] = values;
            rows.push((row, SurveyStation { measured_depth, inclination_deg, azimuth_deg }));
        }
    }
    Ok((rows, columns, problems))
}

/// Unit of a column of depths, true if it is an assumption, and its size \[m\].
fn depth_scale(found: &Found, given: Option<&str>) -> Result<(String, bool, f64), ImportError> {
    let place = || (found.name.clone(), found.heading.clone());
    let Some(unit) = found.unit.as_deref().or(given) else {
        let (column, heading) = place();
        return Err(ImportError::NoUnit {
            column,
            heading,
            quantity: "measured depth",
            valid: "m or ft",
            option: "depth_unit",
        });
    };
    let units = MEASURED_DEPTH.units.expect("a depth has units");
    let scale = entry::read(&format!("1 {}", spelled(unit)), units).map_err(|error| {
        let (column, heading) = place();
        ImportError::Unit { column, heading, quantity: "measured_depth", valid: error.to_string() }
    })?;
    Ok((unit.to_owned(), found.unit.is_none(), scale))
}

/// Unit of a column of angles, true if it is an assumption, and its size \[deg\].
fn angle_scale(quantity: &'static str, found: &Found) -> Result<(String, bool, f64), ImportError> {
    let Some(unit) = found.unit.as_deref() else { return Ok(("deg".to_owned(), true, 1.0)) };
    let scale = match unit.to_ascii_lowercase().trim_end_matches('.') {
        "deg" | "degs" | "degree" | "degrees" | "dega" | "°" | "º" => 1.0,
        "rad" | "radian" | "radians" => 180.0 / PI,
        _ => {
            return Err(ImportError::Unit {
                column: found.name.clone(),
                heading: found.heading.clone(),
                quantity,
                valid: "deg or rad".to_owned(),
            });
        }
    };
    Ok((unit.to_owned(), false, scale))
}

/// Stations in order, with problems of order and range.
fn checked(
    rows: Vec<Row>,
    columns: Vec<UnderstoodColumn>,
    mut problems: Vec<CellProblem>,
) -> Result<Survey, ImportError> {
    let mut remarks = Vec::new();
    let mut rows = rows;
    if rows.len() > 1 && rows.windows(2).all(|pair| pair[1].1.measured_depth < pair[0].1.measured_depth) {
        rows.reverse();
        remarks.push("the file lists the deepest station first; the order was reversed".to_owned());
    }
    let mut stations: Vec<SurveyStation> = Vec::new();
    let mut turned = 0;
    for (row, mut station) in rows {
        let depth = station.measured_depth;
        let problem = match stations.last() {
            _ if depth < 0.0 => Some(format!("the measured depth {depth} m is negative")),
            _ if !(0.0..=180.0).contains(&station.inclination_deg) => {
                Some(format!("the inclination {} deg is not between 0 and 180", station.inclination_deg))
            }
            Some(last) if depth == last.measured_depth && *last == normal(station).0 => {
                remarks.push(format!("row {} repeats the station above it", row + 1));
                continue;
            }
            Some(last) if depth <= last.measured_depth => Some(format!(
                "the measured depth {depth} m does not exceed that of the station above, {} m",
                last.measured_depth
            )),
            _ => None,
        };
        if let Some(problem) = problem {
            if problems.len() < MOST_PROBLEMS {
                problems.push(CellProblem::new(row, None, "", problem));
            }
            continue;
        }
        let (north, is_turned) = normal(station);
        station = north;
        turned += usize::from(is_turned);
        if stations.len() == MOST_STATIONS {
            return Err(ImportError::TooMany { most: MOST_STATIONS, rows: "stations" });
        }
        stations.push(station);
    }
    problems.sort_by_key(|problem| problem.row);
    if stations.len() < 2 {
        return Err(ImportError::TooFew { count: stations.len(), needed: 2, rows: "stations", problems });
    }
    if turned > 0 {
        remarks.push(format!("azimuths taken modulo 360 deg: {turned}"));
    }
    let first = stations[0];
    if first.measured_depth > 0.0 {
        stations.insert(
            0,
            SurveyStation { measured_depth: 0.0, inclination_deg: 0.0, azimuth_deg: first.azimuth_deg },
        );
        remarks.push(format!(
            "the first station is at {} m: a vertical one was added at 0 m",
            first.measured_depth
        ));
    }
    Ok(Survey { stations, columns, remarks, problems })
}

/// The station with its azimuth in [0, 360), and true if that changed it.
fn normal(station: SurveyStation) -> (SurveyStation, bool) {
    let is_turned = !(0.0..=360.0).contains(&station.azimuth_deg);
    let azimuth_deg = if is_turned { station.azimuth_deg.rem_euclid(360.0) } else { station.azimuth_deg };
    (SurveyStation { azimuth_deg, ..station }, is_turned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Survey {
        survey(text.as_bytes(), SurveyOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    fn numbers(survey: &Survey) -> Vec<[f64; 3]> {
        let row =
            |station: &SurveyStation| [station.measured_depth, station.inclination_deg, station.azimuth_deg];
        survey.stations.iter().map(row).collect()
    }

    #[test]
    fn one_survey_in_seven_files_has_one_meaning() {
        let expected = [[0.0, 0.0, 0.0], [304.8, 2.5, 359.0], [609.6, 12.5, 1.5]];
        let files = [
            "MD (ft),Inc (deg),Azi (deg)\n0,0,0\n1000,2.5,359\n2000,12.5,1.5\n",
            "Well: F-12;;\nMessung vom 3.4.2020;;\nMD [m];Inc [deg];Azi [deg]\n0;0;0\n304,8;2,5;359\n609,6;12,5;1,5\n",
            "Station\tMeas. Depth\tIncl\tAzim\tTVD\n\tft\t°\t°\tft\n1\t0\t0\t0\t0\n2\t1,000.0\t2°30'\t359\t1000\n3\t2,000.0\t12°30'\t1°30'\t1990\n",
            "MD_ft INC AZ\n0 0 0\n1000 2.5 -1\n2000 12.5 361.5\n",
            "~Version\nVERS. 2.0 :\n~Curve\nDEPT.FT : depth\nGR.GAPI : gamma\nDEVI.DEG : inclination\nHAZI.DEG : azimuth\n~ASCII\n0 40 0 0\n1000 41 2.5 359\n2000 39 12.5 1.5\n",
            "<trajectorys xmlns=\"http://www.witsml.org/schemas/1series\" version=\"1.4.1.1\"><trajectory><trajectoryStation uid=\"1\"><md uom=\"ft\">0</md><incl uom=\"dega\">0</incl><azi uom=\"dega\">0</azi></trajectoryStation><trajectoryStation uid=\"2\"><md uom=\"m\">304.8</md><incl uom=\"dega\">2.5</incl><azi uom=\"dega\">359</azi></trajectoryStation><trajectoryStation uid=\"3\"><md uom=\"ft\">2000</md><incl uom=\"dega\">12.5</incl><azi uom=\"dega\">1.5</azi></trajectoryStation></trajectory></trajectorys>",
            "<Trajectory xmlns=\"http://www.energistics.org/energyml/data/witsmlv2\" schemaVersion=\"2.0\"><TrajectoryStation uid=\"1\"><Md uom=\"m\">0</Md><Incl uom=\"dega\">0</Incl><Azi uom=\"dega\">0</Azi></TrajectoryStation><TrajectoryStation uid=\"2\"><Md uom=\"m\">304.8</Md><Incl uom=\"rad\">0.04363323129985824</Incl><Azi uom=\"dega\">359</Azi></TrajectoryStation><TrajectoryStation uid=\"3\"><Md uom=\"m\">609.6</Md><Incl uom=\"dega\">12.5</Incl><Azi uom=\"dega\">1.5</Azi></TrajectoryStation></Trajectory>",
        ];
        for file in files {
            let survey = read(file);
            assert!(survey.problems.is_empty(), "{:?}", survey.problems);
            assert_eq!(survey.stations.len(), 3, "{file}");
            for (station, expected) in numbers(&survey).into_iter().zip(expected) {
                for (value, expected) in station.into_iter().zip(expected) {
                    assert!(
                        (value - expected).abs() < 1e-12 * expected.max(1.0),
                        "{value} is not {expected}: {file}"
                    );
                }
            }
        }
    }

    #[test]
    fn columns_show_what_was_understood_and_assumed() {
        let survey = read("MD (m),INC,AZI (deg)\n0,0,0\n10,1,2\n");
        let columns: Vec<_> = survey
            .columns
            .iter()
            .map(|column| (column.quantity, column.column.as_str(), column.unit.as_str(), column.is_assumed))
            .collect();
        assert_eq!(
            columns,
            [
                ("measured_depth", "A", "m", false),
                ("inclination", "B", "deg", true),
                ("azimuth", "C", "deg", false)
            ]
        );
    }

    #[test]
    fn a_depth_without_unit_is_refused_unless_it_is_given() {
        let text = b"MD,Inc,Azi\n0,0,0\n1000,1,2\n";
        let refused = survey(text, SurveyOptions::default());
        assert!(matches!(refused, Err(ImportError::NoUnit { column, .. }) if column == "A"));
        let given = survey(text, SurveyOptions { depth_unit: Some("ft"), sheet: None }).unwrap();
        assert_eq!((given.stations[1].measured_depth, given.columns[0].is_assumed), (304.8, true));
        let wrong = survey(text, SurveyOptions { depth_unit: Some("psi"), sheet: None });
        assert!(matches!(wrong, Err(ImportError::Unit { quantity: "measured_depth", .. })));
    }

    #[test]
    fn problems_name_row_and_column_and_leave_their_row_out() {
        let survey =
            read("MD (m),Inc,Azi\n0,0,0\n30,one,2\n60,1,\n50,200,2\n90,2,3\n80,2,3\n90,2,3\n120,3,4\n");
        let problems: Vec<_> = survey
            .problems
            .iter()
            .map(|problem| (problem.row, problem.column.as_deref(), problem.text.as_str()))
            .collect();
        assert_eq!(problems, [(3, Some("B"), "one"), (4, Some("C"), ""), (5, None, ""), (7, None, "")]);
        assert_eq!(numbers(&survey).iter().map(|row| row[0]).collect::<Vec<_>>(), [0.0, 90.0, 120.0]);
        assert_eq!(survey.remarks, ["row 8 repeats the station above it"]);
    }

    #[test]
    fn a_survey_that_begins_below_the_table_or_runs_upwards_is_completed() {
        let survey = read("MD (m),Inc,Azi\n90,3,10\n60,2,10\n30,1,10\n");
        assert_eq!(numbers(&survey).iter().map(|row| row[0]).collect::<Vec<_>>(), [0.0, 30.0, 60.0, 90.0]);
        assert_eq!(survey.remarks.len(), 2);
    }

    #[test]
    fn hostile_surveys_end_in_an_error_or_bounded_problems() {
        let header = "MD (m),Inc,Azi\n";
        let nonsense = format!("{header}0,0,0\n10,1,2\n{}", "x,y,z\n".repeat(20_000));
        assert_eq!(read(&nonsense).problems.len(), MOST_PROBLEMS + 2);
        let many: String = (0..20_000).map(|row| format!("{row},0,0\n")).collect();
        assert!(matches!(
            survey(format!("{header}{many}").as_bytes(), SurveyOptions::default()),
            Err(ImportError::TooMany { .. })
        ));
        for text in [
            "",
            "<",
            "<a/>",
            "<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>",
            "MD (m),Inc,Azi\n",
            "MD (m),Inc,Azi\nnan,inf,1e999\n",
        ] {
            assert!(survey(text.as_bytes(), SurveyOptions::default()).is_err(), "{text}");
        }
    }
}
