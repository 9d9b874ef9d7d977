//! Loads of elements.

use serde::Serialize;

use super::moment::Moment;
use super::statistics::{Peak, RmsAndPeak, Span, Sums};
use crate::math::dof::{DOFS, Dofs};
use crate::math::linalg::{Four, Lane, after};
use crate::solve::model::{Model, NodalVector, StringElement};
use crate::solve::statics::Equilibrium;
use crate::string::beam::{BeamSection, ElementVector};

/// Loads of one element over the window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ElementLoads {
    /// Bending moment, the larger of its ends' \[N m\].
    pub bending_moment: RmsAndPeak,
    /// Largest bending stress, at the outer diameter \[Pa\].
    pub bending_stress: f64,
    /// Effective tension \[N\].
    pub tension: Span,
    /// Torque \[N m\], negative if it opposes clockwise rotation.
    pub torque: Span,
    /// Largest equivalent stress by von Mises \[Pa\] of bending, tension, torque and the pressures of the mud, at the outer and the inner diameter.
    pub equivalent_stress: Peak,
}

/// Quantities that are integrated.
const BENDING_SQUARED: usize = 0;
const TENSION: usize = 1;
const TORQUE: usize = 2;
const INTEGRALS: usize = 3;

/// Quantities whose largest values are kept.
const BENDING_PEAK: usize = 0;
const LOWEST_TENSION: usize = 1;
const HIGHEST_TENSION: usize = 2;
const LOWEST_TORQUE: usize = 3;
const HIGHEST_TORQUE: usize = 4;
const STRESS_PEAK: usize = 5;
const EXTREMES: usize = 6;

/// Sums of four elements.
pub(super) type ElementSums = Sums<INTEGRALS, EXTREMES>;

/// Elements of a string, and their last sample. Element e joins the nodes e and e + 1.
pub(super) struct Elements<const D: usize> {
    /// Outer bending stress by moment of each element \[1/m3\].
    fibres: Vec<f64>,
    groups: Vec<ElementGroup<D>>,
    samples: Vec<[Four; INTEGRALS]>,
}

/// Constants of four elements.
#[derive(Debug, Clone, Copy)]
struct ElementGroup<const D: usize> {
    /// Bending moments in the two planes of the chord, at the upper and the lower end \[N m\].
    bending: [[Row<D>; 2]; 2],
    /// Effective tension \[N\].
    tension: Row<D>,
    /// Torque \[N m\].
    torque: Row<D>,
    /// 1 / S \[1/m2\].
    per_area: Four,
    /// The outer and the inner diameter.
    fibres: [Fibre; 2],
}

/// Stresses at one diameter of four elements.
#[derive(Debug, Clone, Copy)]
struct Fibre {
    /// Bending stress by moment \[1/m3\].
    bending: Four,
    /// Square of the shear stress by that of the torque, times three \[1/m6\].
    torsion: Four,
    /// Square of the equivalent stress by the pressures alone \[Pa2\].
    pressure: Four,
}

/// A linear function of the values of both nodes.
#[derive(Debug, Clone, Copy)]
struct Row<const D: usize> {
    upper: [Four; D],
    lower: [Four; D],
    /// Share of what does not move.
    constant: Four,
}

impl<const D: usize> Elements<D> {
    pub(super) fn new(
        model: &Model,
        equilibrium: &Equilibrium,
        freedoms: Dofs<D>,
        rest: &NodalVector,
    ) -> Self {
        let count = model.elements.len();
        let groups: Vec<_> = (0..count)
            .step_by(Four::LANES)
            .map(|first| ElementGroup::new(model, equilibrium, freedoms, rest, first))
            .collect();
        let fibre = |element: &StringElement| element.beam.section().outer_bending_stress();
        Self {
            fibres: model.elements.iter().map(fibre).collect(),
            samples: vec![[Four::ZERO; INTEGRALS]; groups.len()],
            groups,
        }
    }

    /// Number of elements.
    pub(super) fn count(&self) -> usize {
        self.fibres.len()
    }

    /// Number of groups of four elements.
    pub(super) fn groups(&self) -> usize {
        self.groups.len()
    }

    /// Outer bending stress by moment of an element \[1/m3\].
    pub(super) fn fibre(&self, element: usize) -> f64 {
        self.fibres[element]
    }

    pub(super) fn start(&mut self, moment: &Moment<'_, D>) {
        for (number, (group, sample)) in self.groups.iter().zip(&mut self.samples).enumerate() {
            *sample = group.sample(number, moment);
        }
    }

    pub(super) fn observe(&mut self, moment: &Moment<'_, D>, h: f64, sums: &mut [ElementSums]) {
        let time = Four::splat(moment.time);
        for (number, sums) in sums.iter_mut().enumerate() {
            let group = &self.groups[number];
            let sample = group.sample(number, moment);
            let before = std::mem::replace(&mut self.samples[number], sample);
            sums.integrate(h, &before, &sample);
            let values: [Four; EXTREMES] = [
                sample[BENDING_SQUARED],
                -sample[TENSION],
                sample[TENSION],
                -sample[TORQUE],
                sample[TORQUE],
                group.equivalent_stress_squared(&sample),
            ];
            for (extreme, value) in sums.extremes.iter_mut().zip(values) {
                extreme.raise(value, time);
            }
        }
    }
}

impl<const D: usize> ElementGroup<D> {
    fn new(
        model: &Model,
        equilibrium: &Equilibrium,
        freedoms: Dofs<D>,
        rest: &NodalVector,
        first: usize,
    ) -> Self {
        let elements = &model.elements;
        let of_lane = |lane: usize| elements.get(first + lane).map(|element| (first + lane, element));
        let lanes = |value: &dyn Fn(usize, &StringElement) -> f64| {
            Four::new(std::array::from_fn(|lane| of_lane(lane).map_or(0.0, |(e, element)| value(e, element))))
        };
        let row = |of: &dyn Fn(usize, &StringElement) -> (ElementVector, f64)| {
            let rows: [_; Four::LANES] =
                std::array::from_fn(|lane| of_lane(lane).map(|(e, element)| (e, of(e, element))));
            let lanes = |value: &dyn Fn(usize, &ElementVector, f64) -> f64| {
                let of_row = |lane: usize| {
                    rows[lane].as_ref().map_or(0.0, |(e, (row, constant))| value(*e, row, *constant))
                };
                Four::new(std::array::from_fn(of_row))
            };
            let of_end = |end: usize, row: &ElementVector| std::array::from_fn(|dof| row[DOFS * end + dof]);
            let moving = |end: usize| {
                std::array::from_fn(|dof| lanes(&|_, row, _| freedoms.of(&of_end(end, row))[dof]))
            };
            let resting = |end: usize, e: usize, row: &ElementVector| {
                let still = freedoms.among(&[0.0; D], rest[e + end]);
                of_end(end, row).into_iter().zip(still).map(|(row, still)| row * still).sum::<f64>()
            };
            Row {
                upper: moving(0),
                lower: moving(1),
                constant: lanes(&|e, row, constant| constant + resting(0, e, row) + resting(1, e, row)),
            }
        };
        let bending = |plane: usize, end: usize| {
            row(&|e, element| {
                let of_chord = element.beam.bending_rows(end as f64)[plane];
                let into_hole = element.chord.tangent_rotations(&model.frames[e], &model.frames[e + 1]);
                let constant = if model.effects.well_bending { of_chord.dot(&into_hole) } else { 0.0 };
                (element.chord.vector_to_nodes(&of_chord), constant)
            })
        };
        let fibre = |radius: fn(&BeamSection) -> f64| Fibre {
            bending: lanes(&|_, element| {
                let section = element.beam.section();
                radius(section) / section.second_moment
            }),
            torsion: lanes(&|_, element| {
                let section = element.beam.section();
                3.0 * (radius(section) / section.polar_moment()).powi(2)
            }),
            pressure: lanes(&|e, element| {
                let Some(pressures) = &equilibrium.pressures else { return 0.0 };
                let section = element.beam.section();
                let middle = |values: &[f64]| 0.5 * (values[e] + values[e + 1]);
                let difference = middle(&pressures.bore) - middle(&pressures.annulus);
                3.0 * (difference * section.pressure_shear(radius(section))).powi(2)
            }),
        };
        Self {
            bending: std::array::from_fn(|plane| std::array::from_fn(|end| bending(plane, end))),
            tension: row(&|_, element| (element.tension_row, 0.0)),
            torque: row(&|_, element| (element.torque_row, 0.0)),
            per_area: lanes(&|_, element| 1.0 / element.beam.section().area),
            fibres: [
                fibre(|section| 0.5 * section.outer_diameter),
                fibre(|section| 0.5 * section.inner_diameter),
            ],
        }
    }

    #[inline(always)]
    fn sample(&self, group: usize, moment: &Moment<'_, D>) -> [Four; INTEGRALS] {
        let neighbourhood = moment.displacement.neighbourhood(group);
        let upper = neighbourhood[1];
        let lower: [Four; D] = std::array::from_fn(|dof| after(neighbourhood, dof));
        let value = |row: &Row<D>| {
            (0..D).fold(row.constant, |sum, dof| {
                row.lower[dof].mul_add(lower[dof], row.upper[dof].mul_add(upper[dof], sum))
            })
        };
        let at_end = |end: usize| {
            let [x, y] = [0, 1].map(|plane: usize| value(&self.bending[plane][end]));
            x.mul_add(x, y * y)
        };
        [at_end(0).max(at_end(1)), value(&self.tension), value(&self.torque)]
    }

    /// Square of the equivalent stress by von Mises \[Pa2\], the larger of both diameters. With the effective tension, axial stress less the mean of
    /// radial and hoop stress is T / S and bending; half the difference of these two and the shear stress count three times in the square.
    fn equivalent_stress_squared(&self, sample: &[Four; INTEGRALS]) -> Four {
        let tension = sample[TENSION].abs() * self.per_area;
        let moment = sample[BENDING_SQUARED].sqrt();
        let squared = |fibre: &Fibre| {
            let axial = moment.mul_add(fibre.bending, tension);
            let torsion = sample[TORQUE] * sample[TORQUE] * fibre.torsion;
            axial.mul_add(axial, torsion + fibre.pressure)
        };
        squared(&self.fibres[0]).max(squared(&self.fibres[1]))
    }
}

/// Loads of an element by the sums over `duration` \[s\], with its outer bending stress by moment \[1/m3\].
pub(super) fn element_loads(
    groups: &[ElementSums],
    element: usize,
    duration: f64,
    bending_stress: f64,
) -> ElementLoads {
    let (sums, lane) = (&groups[element / Four::LANES], element % Four::LANES);
    let bending_moment = sums.of_square([BENDING_SQUARED, BENDING_PEAK], lane, duration);
    let Peak { value, time } = sums.peak(STRESS_PEAK, lane);
    ElementLoads {
        bending_stress: bending_moment.peak.value * bending_stress,
        bending_moment,
        tension: sums.span(TENSION, [LOWEST_TENSION, HIGHEST_TENSION], lane, duration),
        torque: sums.span(TORQUE, [LOWEST_TORQUE, HIGHEST_TORQUE], lane, duration),
        equivalent_stress: Peak { value: value.max(0.0).sqrt(), time },
    }
}
