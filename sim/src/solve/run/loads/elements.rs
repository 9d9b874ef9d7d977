//! Loads of elements.

use drillsweep_scenario::Grade;
use serde::Serialize;

use super::fatigue::{FatigueSite, SiteCycles};
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
    /// Largest axial stress by the effective tension, in magnitude \[Pa\].
    pub axial_stress: f64,
    /// Largest shear stress by the torque, at the outer diameter \[Pa\].
    pub torsional_stress: f64,
    /// Effective tension \[N\].
    pub tension: Span,
    /// Torque \[N m\], negative if it opposes clockwise rotation.
    pub torque: Span,
    /// Largest equivalent stress by von Mises \[Pa\] of bending, tension, torque and the pressures of the mud, at the outer and the inner diameter.
    pub equivalent_stress: Peak,
    /// Largest equivalent stress over the least yield strength; absent without a grade.
    pub yield_ratio: Option<f64>,
    /// Part of the life that fatigue takes in a second, of the place around the outer diameter at which it is largest \[1/s\]; absent without a grade.
    pub fatigue_rate: Option<f64>,
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
    outer_stresses: Vec<OuterStress>,
    sites: Vec<FatigueSite>,
    /// Place of theta_z in a node's values.
    twist: Option<usize>,
    groups: Vec<ElementGroup<D>>,
    samples: Vec<[Four; INTEGRALS]>,
}

/// Stresses of an element at its outer diameter by its loads.
#[derive(Debug, Clone, Copy)]
pub(super) struct OuterStress {
    /// Bending stress by moment \[1/m3\].
    bending: f64,
    /// Axial stress by tension \[1/m2\].
    axial: f64,
    /// Shear stress by torque \[1/m3\].
    torsion: f64,
    /// Least yield strength \[Pa\]; absent without a grade.
    yield_strength: Option<f64>,
}

impl OuterStress {
    fn new(section: &BeamSection, grade: Option<Grade>) -> Self {
        Self {
            bending: section.outer_bending_stress(),
            axial: 1.0 / section.area,
            torsion: section.carrying_radius() / section.polar_moment(),
            yield_strength: grade.map(Grade::yield_strength),
        }
    }
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

/// Values of the nodes at both ends of four elements.
struct Ends<const D: usize> {
    upper: [Four; D],
    lower: [Four; D],
}

impl<const D: usize> Ends<D> {
    #[inline(always)]
    fn new(group: usize, moment: &Moment<'_, D>) -> Self {
        let neighbourhood = moment.displacement.neighbourhood(group);
        Self { upper: neighbourhood[1], lower: std::array::from_fn(|dof| after(neighbourhood, dof)) }
    }

    #[inline(always)]
    fn value(&self, row: &Row<D>) -> Four {
        (0..D).fold(row.constant, |sum, dof| {
            row.lower[dof].mul_add(self.lower[dof], row.upper[dof].mul_add(self.upper[dof], sum))
        })
    }
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
        let elements = model.elements.iter().zip(&model.mesh.elements);
        Self {
            outer_stresses: elements
                .map(|(element, meshed)| OuterStress::new(element.beam.section(), meshed.tube.material.grade))
                .collect(),
            sites: FatigueSite::of(model, equilibrium),
            twist: freedoms.twist(),
            samples: vec![[Four::ZERO; INTEGRALS]; groups.len()],
            groups,
        }
    }

    /// Number of elements.
    pub(super) fn count(&self) -> usize {
        self.outer_stresses.len()
    }

    /// Number of groups of four elements.
    pub(super) fn groups(&self) -> usize {
        self.groups.len()
    }

    /// Stresses of an element at its outer diameter by its loads.
    pub(super) fn outer_stress(&self, element: usize) -> OuterStress {
        self.outer_stresses[element]
    }

    /// Elements with a grade.
    pub(super) fn sites(&self) -> &[FatigueSite] {
        &self.sites
    }

    /// Part of an element's life that fatigue takes in a second, from the cycles of all sites over `duration` \[s\]; absent without a grade.
    pub(super) fn damage(&self, element: usize, cycles: &[SiteCycles], duration: f64) -> Option<f64> {
        let place = self.sites.binary_search_by_key(&element, |site| site.element).ok()?;
        Some(self.sites[place].damage(&cycles[place]) / duration)
    }

    pub(super) fn start(&mut self, moment: &Moment<'_, D>) {
        for (number, (group, sample)) in self.groups.iter().zip(&mut self.samples).enumerate() {
            *sample = group.sample(number, moment);
        }
    }

    pub(super) fn observe(
        &mut self,
        moment: &Moment<'_, D>,
        h: f64,
        sums: &mut [ElementSums],
        cycles: &mut [SiteCycles],
    ) {
        self.integrate(moment, h, sums);
        let mut turning = None;
        for (site, cycles) in self.sites.iter().zip(cycles) {
            let (number, lane) = (site.element / Four::LANES, site.element % Four::LANES);
            let moments = match turning {
                Some((of, moments)) if of == number => moments,
                _ => self.groups[number].turning_moment(number, self.twist, moment),
            };
            turning = Some((number, moments));
            let tension = self.samples[number][TENSION].lane(lane);
            site.observe(tension, moments.map(|axis| axis.lane(lane)), cycles);
        }
    }

    fn integrate(&mut self, moment: &Moment<'_, D>, h: f64, sums: &mut [ElementSums]) {
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
            fibres: [fibre(|section| 0.5 * section.carrying[0]), fibre(|section| 0.5 * section.carrying[1])],
        }
    }

    #[inline(always)]
    fn sample(&self, group: usize, moment: &Moment<'_, D>) -> [Four; INTEGRALS] {
        let ends = Ends::new(group, moment);
        let at_end = |end: usize| {
            let [x, y] = [0, 1].map(|plane: usize| ends.value(&self.bending[plane][end]));
            x.mul_add(x, y * y)
        };
        [at_end(0).max(at_end(1)), ends.value(&self.tension), ends.value(&self.torque)]
    }

    /// Bending moment in the middle of the elements \[N m\] by the curvature along two axes that turn with the pipe; `twist` is the place of theta_z in a node's values.
    fn turning_moment(&self, group: usize, twist: Option<usize>, moment: &Moment<'_, D>) -> [Four; 2] {
        let ends = Ends::new(group, moment);
        let half = Four::splat(0.5);
        let twisted = twist.map_or(Four::ZERO, |twist| (ends.upper[twist] + ends.lower[twist]) * half);
        let (sin, cos) = (twisted + Four::splat(moment.angle)).sin_cos();
        let [x, y] = [0, 1].map(|plane: usize| {
            let [upper, lower] = [0, 1].map(|end: usize| ends.value(&self.bending[plane][end]));
            (upper + lower) * half
        });
        // The rows are those of E I u'' and -E I v''.
        [x.mul_add(cos, -(y * sin)), -(x.mul_add(sin, y * cos))]
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

/// Loads of an element by the sums over `duration` \[s\].
pub(super) fn element_loads(
    groups: &[ElementSums],
    element: usize,
    duration: f64,
    outer_stress: OuterStress,
) -> ElementLoads {
    let (sums, lane) = (&groups[element / Four::LANES], element % Four::LANES);
    let bending_moment = sums.of_square([BENDING_SQUARED, BENDING_PEAK], lane, duration);
    let Peak { value, time } = sums.peak(STRESS_PEAK, lane);
    let tension = sums.span(TENSION, [LOWEST_TENSION, HIGHEST_TENSION], lane, duration);
    let torque = sums.span(TORQUE, [LOWEST_TORQUE, HIGHEST_TORQUE], lane, duration);
    let magnitude = |span: &Span| span.least.abs().max(span.largest.abs());
    ElementLoads {
        bending_stress: bending_moment.peak.value * outer_stress.bending,
        axial_stress: magnitude(&tension) * outer_stress.axial,
        torsional_stress: magnitude(&torque) * outer_stress.torsion,
        bending_moment,
        tension,
        torque,
        yield_ratio: outer_stress.yield_strength.map(|strength| value.max(0.0).sqrt() / strength),
        fatigue_rate: None,
        equivalent_stress: Peak { value: value.max(0.0).sqrt(), time },
    }
}
