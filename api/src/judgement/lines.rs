//! Causes of spectral lines of lateral motion: rotation, torsion, rolling on the wall, modes, and combinations of them.

use drillsweep_quantity::Quantity;
use drillsweep_quantity::columns::{AMPLITUDE, FREQUENCY, FROM, MEASURED_DEPTH, NODE, TO};
use drillsweep_sim::solve::modes::{Mode, ModeKind};
use drillsweep_table::Table;
use serde::{Deserialize, Serialize};

/// Highest multiple of rotation and torsion that explains a line.
const HIGHEST_MULTIPLE: i32 = 12;

/// Highest multiples of rotation and torsion in a sum of both.
const SUM_OF_ROTATION: i32 = 2;
const SUM_OF_TORSION: i32 = 3;

/// Part of a frequency within which two frequencies count as one, next to the resolution of the window: contacts that lift off shift modes by as much.
const SAME: f64 = 0.01;

/// Uncertainty of an interpolated line's frequency in bins of its window.
const BINS: f64 = 0.5;

/// Amplitude of the bit's swing, relative to the rotation speed, from which torsion explains lines.
const SWINGS: f64 = 0.01;

/// Spectral line of a node's lateral motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Node, from 1 at the top.
    pub node: usize,
    /// Its measured depth \[m\].
    pub measured_depth: f64,
    /// Window \[s\].
    pub window: [f64; 2],
    /// Frequency \[Hz\]; negative is backward whirl.
    pub frequency_hz: f64,
    /// Amplitude \[m\].
    pub amplitude: f64,
}

/// Motions that a run and its equilibrium have, as candidates for causes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Motion {
    /// Rotation of the top \[Hz\], with its sign.
    pub rotation_hz: f64,
    /// Frequency \[Hz\] of the strongest line of the bit's rotation speed, and its amplitude relative to the mean speed; absent without one.
    pub torsion: Option<[f64; 2]>,
    /// Backward whirl \[Hz\] of each node that rolls on the wall without sliding, -Omega R / j0, by node from 0; none where a node cannot touch.
    pub rolling_hz: Vec<Option<f64>>,
    /// Modes about the equilibrium.
    pub modes: Vec<Mode>,
}

/// Spectral line with its cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct LineCause {
    /// Node, from 1 at the top.
    pub node: usize,
    /// Its measured depth \[m\].
    pub measured_depth: f64,
    /// Window of the spectrum \[s\].
    pub window: [f64; 2],
    /// Frequency \[Hz\]; negative is backward whirl.
    pub frequency_hz: f64,
    /// Amplitude \[m\]: the radius of the circle that the line draws.
    pub amplitude: f64,
    /// The cause; absent if none was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<Cause>,
    /// The cause in words.
    pub sentence: String,
}

/// Cause of a line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Cause {
    /// Kind of the cause.
    pub kind: CauseKind,
    /// Frequency that the cause would have \[Hz\].
    pub frequency_hz: f64,
    /// Multiple of the rotation in it.
    pub rotation_multiple: i32,
    /// Multiple of the torsion in it.
    pub torsion_multiple: i32,
    /// Mode of the equilibrium nearest to the line or its torsion, if there is one; its growth \[1/s\], and the depth of its largest motion \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<CauseMode>,
}

/// Mode of the equilibrium that a line belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct CauseMode {
    /// Its frequency \[Hz\].
    pub frequency_hz: f64,
    /// Growth of its amplitude \[1/s\]; negative is decay.
    pub growth_rate: f64,
    /// Its main motion.
    pub kind: ModeKind,
    /// Depth of its largest motion \[m\].
    pub measured_depth: f64,
}

/// Kind of a line's cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CauseKind {
    /// The torsion of the string, or a multiple of it.
    Torsion,
    /// The rotation, or a multiple of it: unbalance and all that turns with the string.
    Rotation,
    /// Rolling on the wall.
    Rolling,
    /// A sum or difference of multiples of rotation and torsion.
    Combination,
    /// A lateral mode of the equilibrium.
    Mode,
}

impl Line {
    /// Distance within which another frequency is that of the line \[Hz\]: the resolution of its window, or 1 % of its frequency.
    fn within(&self) -> f64 {
        let resolution = BINS / (self.window[1] - self.window[0]).max(f64::MIN_POSITIVE);
        resolution.max(SAME * self.frequency_hz.abs())
    }

    /// Lines of the table `lines` of a result; absent if it is another table.
    pub fn of_table(table: &Table) -> Option<Vec<Self>> {
        let column = |quantity: &Quantity| table.columns.get(quantity.name)?.numbers();
        let [node, depth, from, to] = [&NODE, &MEASURED_DEPTH, &FROM, &TO].map(column);
        let (node, depth, from, to) = (node?, depth?, from?, to?);
        let (frequency, amplitude) = (column(&FREQUENCY)?, column(&AMPLITUDE)?);
        let line = |row: usize| Self {
            node: node[row] as usize,
            measured_depth: depth[row],
            window: [from[row], to[row]],
            frequency_hz: frequency[row],
            amplitude: amplitude[row],
        };
        Some((0..node.len()).map(line).collect())
    }
}

/// Causes of lines. Candidates are tried in the order of [`CauseKind`]; the first that meets the line within the resolution of its window, or 1 % of its
/// frequency, is its cause, of several of a kind the nearest.
pub fn line_causes(lines: &[Line], motion: &Motion) -> Vec<LineCause> {
    lines.iter().map(|line| line_cause(line, motion)).collect()
}

/// Bands of frequencies \[Hz\], up to a highest one, in which modes can be causes of lines, rising and apart: around each line, and around the torsion.
pub fn mode_bands(lines: &[Line], torsion_hz: Option<f64>, highest_hz: f64) -> Vec<[f64; 2]> {
    let widest = lines.iter().map(Line::within).fold(0.0, f64::max);
    let of_lines = lines.iter().map(|line| (line.frequency_hz.abs(), line.within()));
    let of_torsion = torsion_hz.filter(|_| !lines.is_empty()).map(|hz| (hz, widest.max(SAME * hz)));
    let around = |(centre, within): (f64, f64)| {
        // Whole-number quotients must not lose a mode at the edge.
        let within = within * (1.0 + 1e-9);
        [(centre - within).max(0.0), (centre + within).min(highest_hz)]
    };
    let mut bands: Vec<[f64; 2]> =
        of_lines.chain(of_torsion).map(around).filter(|[from, to]| from < to).collect();
    bands.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut apart: Vec<[f64; 2]> = Vec::new();
    for band in bands {
        match apart.last_mut() {
            Some(last) if band[0] <= last[1] => last[1] = last[1].max(band[1]),
            _ => apart.push(band),
        }
    }
    apart
}

fn line_cause(line: &Line, motion: &Motion) -> LineCause {
    let Line { node, measured_depth, window, frequency_hz, amplitude } = *line;
    let within = line.within();
    let torsion = motion.torsion.filter(|[frequency, swing]| *frequency > 0.0 && *swing >= SWINGS);
    let found = of_torsion(line, motion, torsion, within)
        .or_else(|| of_rotation(line, motion, within))
        .or_else(|| of_rolling(line, motion))
        .or_else(|| of_combination(line, motion, torsion, within))
        .or_else(|| of_mode(line, motion, within));
    let (cause, sentence) = match found {
        Some((cause, words)) => (Some(cause), format!("{frequency_hz:+.2} Hz: {words}")),
        None => (None, format!("{frequency_hz:+.2} Hz: no cause found")),
    };
    LineCause { node, measured_depth, window, frequency_hz, amplitude, cause, sentence }
}

type Found = Option<(Cause, String)>;

fn of_torsion(line: &Line, motion: &Motion, torsion: Option<[f64; 2]>, within: f64) -> Found {
    let [torsion_hz, _] = torsion?;
    let multiple = (line.frequency_hz / torsion_hz).round() as i32;
    let meets = (line.frequency_hz - f64::from(multiple) * torsion_hz).abs() <= within;
    if multiple == 0 || multiple.abs() > HIGHEST_MULTIPLE || !meets {
        return None;
    }
    let mode = nearest_mode(motion, torsion_hz, within / f64::from(multiple.abs()), |mode| {
        mode.kind == ModeKind::Torsional
    });
    let swings = format!("the torsion at {torsion_hz:.3} Hz");
    let words = match (multiple.abs(), &mode) {
        (1, Some(CauseMode { frequency_hz, growth_rate, .. })) if *growth_rate > 0.0 => {
            format!("the growing torsional mode at {frequency_hz:.3} Hz ({growth_rate:+.3} 1/s)")
        }
        (1, Some(CauseMode { frequency_hz, .. })) => format!("the torsional mode at {frequency_hz:.3} Hz"),
        (1, None) => format!("{swings}, next to no mode of the equilibrium"),
        (times, _) => format!("{times} times {swings}"),
    };
    let cause = Cause {
        kind: CauseKind::Torsion,
        frequency_hz: f64::from(multiple) * torsion_hz,
        rotation_multiple: 0,
        torsion_multiple: multiple,
        mode,
    };
    Some((cause, words))
}

fn of_rotation(line: &Line, motion: &Motion, within: f64) -> Found {
    let rotation_hz = motion.rotation_hz;
    let multiple = (line.frequency_hz / rotation_hz).round();
    if !multiple.is_finite() || multiple == 0.0 || multiple.abs() > f64::from(HIGHEST_MULTIPLE) {
        return None;
    }
    if (line.frequency_hz - multiple * rotation_hz).abs() > within {
        return None;
    }
    let sense = if multiple > 0.0 { "" } else { ", backward" };
    let words = match multiple.abs() as i32 {
        1 => format!("the rotation at {:.3} Hz{sense}", rotation_hz.abs()),
        times => format!("{times} times the rotation at {:.3} Hz{sense}", rotation_hz.abs()),
    };
    let cause = Cause {
        kind: CauseKind::Rotation,
        frequency_hz: multiple * rotation_hz,
        rotation_multiple: multiple as i32,
        torsion_multiple: 0,
        mode: None,
    };
    Some((cause, words))
}

/// Rolling drives whirl below its frequency by what the contact slides: a line up to a tenth slower counts.
fn of_rolling(line: &Line, motion: &Motion) -> Found {
    const SLIDES: f64 = 0.1;
    let rolling_hz = (*motion.rolling_hz.get(line.node.checked_sub(1)?)?)?;
    let ratio = line.frequency_hz / rolling_hz;
    if !(1.0 - SLIDES..=1.0 + SAME).contains(&ratio) {
        return None;
    }
    let words = format!("backward rolling on the wall, -Omega R/j0 = {rolling_hz:.2} Hz");
    let cause = Cause {
        kind: CauseKind::Rolling,
        frequency_hz: rolling_hz,
        rotation_multiple: 0,
        torsion_multiple: 0,
        mode: None,
    };
    Some((cause, words))
}

fn of_combination(line: &Line, motion: &Motion, torsion: Option<[f64; 2]>, within: f64) -> Found {
    let [torsion_hz, _] = torsion?;
    let rotations = (-SUM_OF_ROTATION..=SUM_OF_ROTATION).filter(|times| *times != 0);
    let pairs = rotations.flat_map(|rotation| {
        let torsions = (-SUM_OF_TORSION..=SUM_OF_TORSION).filter(|times| *times != 0);
        torsions.map(move |torsion| (rotation, torsion))
    });
    let frequency = |(rotation, torsion): (i32, i32)| {
        f64::from(rotation) * motion.rotation_hz + f64::from(torsion) * torsion_hz
    };
    let off = |pair: &(i32, i32)| (frequency(*pair) - line.frequency_hz).abs();
    let simplest = |pair: &(i32, i32)| pair.0.abs() + pair.1.abs();
    let (rotation, torsion) = pairs
        .filter(|pair| off(pair) <= within)
        .min_by(|a, b| simplest(a).cmp(&simplest(b)).then(off(a).total_cmp(&off(b))))?;
    let sum = frequency((rotation, torsion));
    let words = format!("{rotation:+} times the rotation and {torsion:+} times the torsion, {sum:+.3} Hz");
    let cause = Cause {
        kind: CauseKind::Combination,
        frequency_hz: sum,
        rotation_multiple: rotation,
        torsion_multiple: torsion,
        mode: None,
    };
    Some((cause, words))
}

fn of_mode(line: &Line, motion: &Motion, within: f64) -> Found {
    let is_lateral = |mode: &Mode| {
        let [from, to] = mode.extent;
        !matches!(mode.kind, ModeKind::Torsional | ModeKind::Axial)
            && (from..=to).contains(&line.measured_depth)
    };
    let mode = nearest_mode(motion, line.frequency_hz.abs(), within, is_lateral)?;
    let CauseMode { frequency_hz, growth_rate, measured_depth, .. } = mode;
    let words = format!(
        "the lateral mode at {frequency_hz:.3} Hz ({growth_rate:+.3} 1/s), largest at {measured_depth:.1} m"
    );
    let cause = Cause {
        kind: CauseKind::Mode,
        frequency_hz: frequency_hz.copysign(line.frequency_hz),
        rotation_multiple: 0,
        torsion_multiple: 0,
        mode: Some(mode),
    };
    Some((cause, words))
}

/// The mode of a kind within a distance of a frequency \[Hz\]: of several the one that grows most or decays least.
fn nearest_mode(
    motion: &Motion,
    frequency_hz: f64,
    within: f64,
    is_of_kind: impl Fn(&Mode) -> bool,
) -> Option<CauseMode> {
    let modes = motion.modes.iter().filter(|mode| is_of_kind(mode));
    let near =
        modes.filter(|mode| (mode.frequency_hz - frequency_hz).abs() <= within.max(SAME * frequency_hz));
    near.max_by(|a, b| a.growth_rate.total_cmp(&b.growth_rate)).map(|mode| CauseMode {
        frequency_hz: mode.frequency_hz,
        growth_rate: mode.growth_rate,
        kind: mode.kind,
        measured_depth: mode.measured_depth,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(frequency_hz: f64) -> Line {
        Line { node: 1, measured_depth: 60.0, window: [20.0, 60.0], frequency_hz, amplitude: 1e-3 }
    }

    fn mode(kind: ModeKind, frequency_hz: f64, growth_rate: f64) -> Mode {
        Mode {
            frequency_hz,
            growth_rate,
            kind,
            lateral_share: 1.0,
            torsional_share: 0.0,
            axial_share: 0.0,
            whirl: 0.0,
            node: 282,
            measured_depth: 191.0,
            extent: [50.0, 200.0],
        }
    }

    fn motion() -> Motion {
        Motion {
            rotation_hz: 2.0,
            torsion: Some([2.158, 0.9]),
            rolling_hz: vec![Some(-10.0)],
            modes: vec![
                mode(ModeKind::Backward, 2.15, -0.2),
                mode(ModeKind::Torsional, 2.162, 0.09),
                mode(ModeKind::Forward, 3.40, -0.4),
                mode(ModeKind::Forward, 3.41, -0.1),
            ],
        }
    }

    fn cause(frequency_hz: f64) -> LineCause {
        line_causes(&[line(frequency_hz)], &motion()).remove(0)
    }

    #[test]
    fn bands_of_modes_hold_all_that_can_meet_a_line() {
        // Half a bin of 40 s is 0.0125 Hz, 1 % of 10 Hz 0.1 Hz.
        let near = |found: Vec<[f64; 2]>, expected: &[[f64; 2]]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
            }
        };
        let lines = [line(-10.0), line(0.5), line(10.05), line(0.01), line(60.0)];
        near(
            mode_bands(&lines, Some(2.0), 50.0),
            &[[0.0, 0.0225], [0.4875, 0.5125], [1.4, 2.6], [9.9, 10.1505]],
        );
        near(mode_bands(&lines[..1], None, 10.0), &[[9.9, 10.0]]);
        near(mode_bands(&[], Some(2.0), 50.0), &[]);
    }

    #[test]
    fn torsion_and_its_multiples_go_before_lateral_modes() {
        assert_eq!(cause(-2.157).sentence, "-2.16 Hz: the growing torsional mode at 2.162 Hz (+0.090 1/s)");
        assert_eq!(cause(4.31).sentence, "+4.31 Hz: 2 times the torsion at 2.158 Hz");
        assert_eq!(cause(6.47).sentence, "+6.47 Hz: 3 times the torsion at 2.158 Hz");
        assert_eq!(cause(6.47).cause.unwrap().torsion_multiple, 3);
    }

    #[test]
    fn rotation_is_told_from_torsion_by_the_resolution_of_the_window() {
        assert_eq!(cause(2.01).sentence, "+2.01 Hz: the rotation at 2.000 Hz");
        assert_eq!(cause(-4.0).sentence, "-4.00 Hz: 2 times the rotation at 2.000 Hz, backward");
        // In a window of 2 s both lie within the resolution, and torsion comes first.
        let short = Line { window: [58.0, 60.0], ..line(2.01) };
        assert_eq!(line_causes(&[short], &motion())[0].cause.as_ref().unwrap().kind, CauseKind::Torsion);
    }

    #[test]
    fn torsion_that_hardly_swings_explains_nothing() {
        let quiet = Motion { torsion: Some([2.158, 1e-4]), ..motion() };
        let found = &line_causes(&[line(-2.157)], &quiet)[0];
        assert_eq!(found.cause.as_ref().unwrap().kind, CauseKind::Mode);
    }

    #[test]
    fn rolling_sums_and_modes_are_found_and_the_rest_has_no_cause() {
        assert_eq!(cause(-9.5).sentence, "-9.50 Hz: backward rolling on the wall, -Omega R/j0 = -10.00 Hz");
        assert_eq!(
            cause(0.158).sentence,
            "+0.16 Hz: -1 times the rotation and +1 times the torsion, +0.158 Hz"
        );
        assert_eq!(
            cause(3.407).sentence,
            "+3.41 Hz: the lateral mode at 3.410 Hz (-0.100 1/s), largest at 191.0 m"
        );
        let none = cause(5.3);
        assert_eq!((none.cause, none.sentence.as_str()), (None, "+5.30 Hz: no cause found"));
    }

    #[test]
    fn a_string_that_does_not_rotate_has_no_lines_of_rotation() {
        let still = Motion { rotation_hz: 0.0, torsion: None, rolling_hz: vec![None], modes: Vec::new() };
        assert_eq!(line_causes(&[line(2.0)], &still)[0].cause, None);
    }
}
