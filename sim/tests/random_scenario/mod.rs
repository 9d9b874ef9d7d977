//! Scenarios drawn at random over wide ranges of every parameter. Scenario i of a seed is always the same one.

use drillsweep_scenario::{
    Accuracy, Adhesion, ContactLaw, DrillString, Effect, Effects, ElementLengths, Gauge, Integrator,
    Material, Mesh, Mud, NodeChoice, Operation, Outputs, RayleighDamping, Recording, RegimeChoice, Scenario,
    Section, SectionKind, SectionOrder, Statics, SurveyStation, Switch, TimeStepping, ToolJoint,
    TopCondition, UnbalanceMass, WallLaw, Well, preset,
};
use drillsweep_sim::string::StringMesh;

/// Samples of a run.
const SAMPLES: f64 = 40.0;

/// Largest number of elements, before gauges and masses add nodes of their own.
const MOST_ELEMENTS: f64 = 120.0;

/// Scenario `index` of a seed.
pub(crate) fn random_scenario(seed: u64, index: u64) -> Scenario {
    let mut draw = Draw::new(seed, index);
    let base = preset("paper-200m").expect("the preset of the paper is part of the program");
    let hole_diameter = draw.log(0.1, 0.45);
    let string = draw_string(&mut draw, hole_diameter);
    let length = total_length(&string);
    let (accuracy, rate_hz) = draw_accuracy(&mut draw);
    let mut scenario = Scenario {
        name: format!("random {seed}/{index}"),
        well: Well { hole_diameter, survey: draw_survey(&mut draw, length), section: Vec::new() },
        operation: draw_operation(&mut draw, base.operation),
        mud: draw_mud(&mut draw),
        contact: draw_contact(&mut draw),
        statics: Statics::default(),
        damping: RayleighDamping {
            mass_proportional: draw.or_zero(0.2, 1e-3, 1.0),
            stiffness_proportional: draw.or_zero(0.6, 1e-8, 1e-4),
        },
        mesh: draw_mesh(&mut draw, &string),
        duration: SAMPLES / rate_hz,
        recording: Recording {
            rate_hz,
            nodes: Vec::new(),
            spectrum_windows: Some(Vec::new()),
            orbit_window: None,
            stability: false,
            outputs: Outputs::Full,
            snapshots: None,
        },
        accuracy: Accuracy::Explicit(accuracy),
        effects: draw_effects(&mut draw),
        string,
        // The rest as in the base case: one run of one point.
        ..base
    };
    // A gauge may not be wider than the clearance of the body at its place.
    if let Ok(mesh) = StringMesh::new(&scenario) {
        for gauge in &mut scenario.string.gauges {
            let node = mesh.nearest_node(gauge.depth(mesh.length()));
            let above = node.checked_sub(1).map_or(0.0, |above| mesh.elements[above].tube.outer_diameter);
            let below = mesh.elements.get(node).map_or(0.0, |below| below.tube.outer_diameter);
            gauge.clearance = gauge.clearance.min(0.5 * (hole_diameter - above.max(below)));
        }
        let last = mesh.nodes.len() as u32;
        let mut nodes = [2, last / 2 + 1, last].to_vec();
        nodes.dedup();
        nodes.sort_unstable();
        nodes.dedup();
        scenario.recording.nodes = nodes.into_iter().map(NodeChoice::Node).collect();
    }
    scenario
}

fn total_length(string: &DrillString) -> f64 {
    string.sections.iter().map(|section| f64::from(section.count) * section.length).sum()
}

fn draw_string(draw: &mut Draw, hole: f64) -> DrillString {
    let material = match draw.below(6) {
        0 => Material { youngs_modulus: 7.1e10, density: 2790.0, poissons_ratio: 0.33, grade: None },
        1 => Material { youngs_modulus: 1.1e11, density: 4430.0, poissons_ratio: 0.31, grade: None },
        _ => Material { youngs_modulus: 2.03e11, density: 7900.0, poissons_ratio: 0.3, grade: None },
    };
    let kinds = [SectionKind::Drillpipe, SectionKind::Collar, SectionKind::Stabilizer, SectionKind::Bit];
    let sections = (0..=draw.below(4))
        .map(|_| {
            let kind = kinds[draw.below(4) as usize];
            let outer_diameter = hole * draw.between(0.25, 0.95);
            let inner_diameter = outer_diameter * draw.between(0.2, 0.92);
            let length = match kind {
                SectionKind::Drillpipe | SectionKind::Collar => draw.log(2.0, 80.0),
                SectionKind::Stabilizer | SectionKind::Bit => draw.log(0.3, 3.0),
            };
            let jointed = kind == SectionKind::Drillpipe && draw.chance(0.6);
            let tool_joint = jointed.then(|| ToolJoint {
                length: (0.3 * length).min(draw.between(0.15, 0.5)),
                outer_diameter: outer_diameter + (hole - outer_diameter) * draw.between(0.0, 0.98),
                inner_diameter: inner_diameter * draw.between(0.6, 1.0),
                material: None,
            });
            let count = if kind == SectionKind::Drillpipe { 1 + draw.below(4) as u32 } else { 1 };
            Section { count, tool_joint, ..Section::plain(kind, length, outer_diameter, inner_diameter) }
        })
        .collect();
    let mut string = DrillString {
        material,
        sections,
        order: SectionOrder::FromTop,
        bit_depth: None,
        gauges: Vec::new(),
        unbalance: Vec::new(),
    };
    let length = total_length(&string);
    for _ in 0..draw.below(5) {
        let measured_depth = if draw.chance(0.3) { length } else { length * draw.between(0.02, 1.0) };
        string.gauges.push(Gauge::at(measured_depth, draw.log(1e-5, 1e-2)));
    }
    for _ in 0..draw.below(6) {
        string.unbalance.push(UnbalanceMass {
            measured_depth: Some(length * draw.between(0.02, 1.0)),
            above_bit: None,
            section: None,
            above_end: None,
            mass: draw.log(0.05, 300.0),
            radius: 0.5 * hole * draw.between(0.05, 0.9),
            phase_deg: draw.between(0.0, 360.0),
        });
    }
    string
}

fn draw_survey(draw: &mut Draw, length: f64) -> Vec<SurveyStation> {
    let straight = |inclination_deg: f64| {
        [0.0, length].map(|measured_depth| SurveyStation {
            measured_depth,
            inclination_deg,
            azimuth_deg: 30.0,
        })
    };
    match draw.below(6) {
        0 => straight(0.0).to_vec(),
        1 => straight(90.0).to_vec(),
        2 => straight(draw.between(0.0, 150.0)).to_vec(),
        _ => {
            let mut inclination_deg = draw.between(0.0, 110.0);
            let mut azimuth_deg = draw.between(0.0, 360.0);
            let mut measured_depth = 0.0;
            let mut survey = vec![SurveyStation { measured_depth, inclination_deg, azimuth_deg }];
            let pieces = 1 + draw.below(5);
            for _ in 0..pieces {
                let piece = length / pieces as f64;
                measured_depth += piece;
                // Doglegs to 20 degrees in 30 m; below half a turn between two stations.
                let turn = (draw.between(-20.0, 20.0) * piece / 30.0).clamp(-80.0, 80.0);
                inclination_deg = (inclination_deg + turn).clamp(0.0, 170.0);
                azimuth_deg += draw.between(-20.0, 20.0) * (piece / 30.0).min(4.0);
                survey.push(SurveyStation { measured_depth, inclination_deg, azimuth_deg });
            }
            survey
        }
    }
}

/// Draws rotation and loads; other fields are those of `operation`.
fn draw_operation(draw: &mut Draw, mut operation: Operation) -> Operation {
    let speed = match draw.below(10) {
        0 => 0.0,
        1 => draw.log(1e-3, 1.0),
        _ => draw.log(1.0, 300.0),
    };
    let sense = if draw.chance(0.1) { -1.0 } else { 1.0 };
    let torque = draw.or_zero(0.2, 10.0, 3e4);
    operation.rotation_speed_rpm = sense * speed;
    operation.weight_on_bit = -draw.or_zero(0.2, 1e2, 5e5);
    operation.torque_on_bit = -sense * torque;
    operation.top = if draw.chance(0.2) { TopCondition::Pinned } else { TopCondition::Clamped };
    operation
}

fn draw_mud(draw: &mut Draw) -> Option<Mud> {
    let mud = Mud {
        density: draw.log(600.0, 2600.0),
        flow_rate: draw.or_zero(0.15, 1e-4, 0.2),
        yield_stress: draw.or_zero(0.2, 0.01, 30.0),
        consistency: draw.log(1e-3, 3.0),
        flow_index: draw.between(0.2, 1.3),
        regime: if draw.chance(0.2) { RegimeChoice::Laminar } else { RegimeChoice::Auto },
        rotation_factor: draw.chance(0.2),
        viscosity_eccentricity: draw.chance(0.2),
        bit_pressure_drop: draw.or_zero(0.5, 1e5, 1e7),
        back_pressure: draw.or_zero(0.7, 1e5, 1e7),
    };
    (!draw.chance(0.15)).then_some(mud)
}

fn draw_contact(draw: &mut Draw) -> ContactLaw {
    let static_friction = if draw.chance(0.1) { 0.0 } else { draw.between(0.02, 0.9) };
    let mut law = ContactLaw {
        law: WallLaw::PerNode,
        stiffness: draw.log(1e5, 1e10),
        damping: draw.or_zero(0.1, 10.0, 1e6),
        stiffness_per_length: None,
        damping_per_length: None,
        stiffness_sharpness: draw.log(1e4, 1e9),
        damping_sharpness: draw.log(1e3, 1e7),
        adhesion: if draw.chance(0.3) { Adhesion::None } else { Adhesion::Allowed },
        static_friction,
        dynamic_friction: static_friction * draw.between(0.0, 1.0),
        friction_reference_speed: draw.log(1e-3, 0.3),
    };
    if draw.chance(0.3) {
        // Values of a node belong to this length.
        let length = draw.log(0.1, 10.0);
        law.law = WallLaw::PerLength;
        (law.stiffness_per_length, law.damping_per_length) =
            (Some(law.stiffness / length), Some(law.damping / length));
    }
    law
}

fn draw_mesh(draw: &mut Draw, string: &DrillString) -> Mesh {
    let finest = total_length(string) / MOST_ELEMENTS;
    let mut target = || finest * draw.log(2.0, 300.0);
    Mesh::Lengths(ElementLengths {
        drillpipe: target(),
        tool_joint: target(),
        collar: target(),
        stabilizer: target(),
        bit: target(),
    })
}

/// Integrator and step, with a recording rate whose interval holds whole steps.
fn draw_accuracy(draw: &mut Draw) -> (TimeStepping, f64) {
    let integrator = match draw.below(8) {
        0 => Integrator::Rk4,
        1..=3 => Integrator::GeneralizedAlpha,
        _ => Integrator::Esdirk4,
    };
    if integrator == Integrator::Rk4 {
        let step = draw.log(2e-6, 5e-5);
        let tolerance = draw.chance(0.5).then(|| draw.log(1e-9, 1e-4));
        return (TimeStepping { tolerance, ..TimeStepping::fixed(integrator, step) }, 1.0 / (4.0 * step));
    }
    let step = draw.log(2e-5, 5e-3);
    let contact_sweeps = if draw.chance(0.2) { 3 + draw.below(20) as u32 } else { 2 };
    let spectral_radius =
        (integrator == Integrator::GeneralizedAlpha && draw.chance(0.5)).then(|| draw.between(0.0, 0.95));
    let steps = (1 + draw.below(4)) as f64;
    let fixed = TimeStepping { contact_sweeps, spectral_radius, ..TimeStepping::fixed(integrator, step) };
    let adapts = integrator == Integrator::Esdirk4 && draw.chance(0.5);
    let stepping = if adapts { TimeStepping::adaptive(draw.log(1e-3, 0.1)) } else { fixed };
    (stepping, 1.0 / (steps * step))
}

fn draw_effects(draw: &mut Draw) -> Effects {
    let mut effects = Effects::default();
    let some_off = draw.chance(0.5);
    // Weight makes scenarios hard: all of them have it.
    for &effect in Effect::ALL.iter().filter(|&&effect| effect != Effect::Gravity) {
        let off = draw.chance(0.1) && some_off;
        if off && effect != Effect::Transient {
            effects.set(effect, Switch::Off);
        }
    }
    effects
}

/// Numbers without pattern from a seed: SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Draw(u64);

impl Draw {
    pub(crate) fn new(seed: u64, index: u64) -> Self {
        let mut draw = Self(seed);
        let start = draw.next() ^ index.wrapping_mul(0xd134_2543_de82_ef95);
        Self(start)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in \[0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in \[low, high), uniform.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number in \[low, high), uniform in its logarithm.
    pub(crate) fn log(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Zero with a probability, otherwise uniform in its logarithm.
    pub(crate) fn or_zero(&mut self, zero: f64, low: f64, high: f64) -> f64 {
        let value = self.log(low, high);
        if self.chance(zero) { 0.0 } else { value }
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A whole number below `count`.
    pub(crate) fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }
}
