//! The pipe above the top of a string that is a part of a longer one.
//!
//! A uniform pipe that goes on upwards opposes the motion of the top with its impedances, Z_t = I_p sqrt(rho G) for rotation and Z_a = A sqrt(rho E)
//! along the axis: torsional and axial waves leave through the top. If the length L of that pipe is given, they return from a drive that
//! imposes the speed of its upper end. With the part p of the speed that goes up and the part q that comes down, the speed of the top is p + q, the
//! force on the string Z (q - p), and q(t) = -p(t - 2 L / c) with c = sqrt(G / rho) or sqrt(E / rho) (d'Alembert; docs/model/motion.md, Top).

use std::sync::Arc;

use drillsweep_scenario::TopCondition;

use crate::force::nodal::{At, Dependence, ForceContext, NodalForce, NodeCompliance, Place};
use crate::force::term::Account;
use crate::math::dof::{DOFS, THETA_Z, W};
use crate::string::beam::BeamSection;

/// Energy that waves carry out of the top, less what they bring back.
pub(crate) const RADIATED: Account = Account::taken("radiated_top", |booked| -booked.by_force(ENTRY));

/// Entry of the ledger for the work of the pipe above on the string.
pub(crate) const ENTRY: &str = "work_top";

/// The force of the pipe above a scenario's string, if the string goes on there.
pub(super) fn force(context: &ForceContext<'_>) -> Option<Arc<dyn NodalForce>> {
    let (string, operation) = (&context.scenario.string, &context.scenario.operation);
    let section = string.sections.first().filter(|_| operation.top == TopCondition::Continues)?;
    let pipe = BeamSection::of(&string.body(section));
    let line = |dof, impedance, speed: f64| Line {
        dof,
        impedance,
        delay: operation.length_above.map(|length| 2.0 * length / speed),
    };
    let lines = [
        line(W, pipe.axial_impedance(), pipe.axial_wave_speed()),
        line(THETA_Z, pipe.torsional_impedance(), pipe.torsional_wave_speed()),
    ];
    Some(Arc::new(PipeAbove { top: [0], lines }))
}

/// The pipe above for one kind of waves.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// Degree of freedom of the top.
    dof: usize,
    /// Z_a \[N s/m\] or Z_t \[N m s\].
    impedance: f64,
    /// Time of a wave to the drive and back \[s\]; absent without a drive.
    delay: Option<f64>,
}

/// Number of kinds of waves.
const LINES: usize = 2;

/// Length of an entry of the memory: a time \[s\], and the speed that goes up at it of each kind of waves \[m/s, rad/s\].
const ENTRY_LENGTH: usize = 1 + LINES;

#[derive(Debug)]
struct PipeAbove {
    top: [usize; 1],
    lines: [Line; LINES],
}

impl PipeAbove {
    /// Speed that comes down \[m/s, rad/s\].
    fn downwards(&self, line: usize, time: f64, memory: &[f64]) -> f64 {
        self.lines[line].delay.map_or(0.0, |delay| -upwards(line, time - delay, memory))
    }

    /// Longest delay \[s\]; absent without a drive.
    fn longest_delay(&self) -> Option<f64> {
        self.lines.iter().filter_map(|line| line.delay).reduce(f64::max)
    }
}

/// Speed that went up at a time, linear between the entries of the memory; zero before them, in equilibrium.
fn upwards(line: usize, time: f64, memory: &[f64]) -> f64 {
    let entries = memory.as_chunks::<ENTRY_LENGTH>().0;
    let later = entries.partition_point(|entry| entry[0] <= time);
    let Some(earlier) = later.checked_sub(1).map(|place| entries[place]) else { return 0.0 };
    let Some(next) = entries.get(later) else { return earlier[1 + line] };
    let share = (time - earlier[0]) / (next[0] - earlier[0]);
    earlier[1 + line] + share * (next[1 + line] - earlier[1 + line])
}

impl NodalForce for PipeAbove {
    fn nodes(&self) -> &[usize] {
        &self.top
    }

    fn dependence(&self) -> Dependence {
        Dependence::Motion
    }

    fn entry(&self) -> Option<&'static str> {
        Some(ENTRY)
    }

    fn forces(&self, at: &At<'_>, out: &mut [[f64; DOFS]]) {
        let velocity = (at.motion)(self.top[0]).velocity;
        for (place, line) in self.lines.iter().enumerate() {
            let down = self.downwards(place, at.time, at.memory);
            out[0][line.dof] = line.impedance * (2.0 * down - velocity[line.dof]);
        }
    }

    fn implicit_forces(&self, at: &At<'_>, compliance: &[NodeCompliance], out: &mut [[f64; DOFS]]) {
        let velocity = (at.motion)(self.top[0]).velocity;
        let NodeCompliance { displacement, speed } = compliance[0];
        for (place, line) in self.lines.iter().enumerate() {
            let response = speed * displacement[line.dof][line.dof];
            let without = velocity[line.dof] - response * out[0][line.dof];
            let down = self.downwards(place, at.time, at.memory);
            out[0][line.dof] = line.impedance * (2.0 * down - without) / (1.0 + line.impedance * response);
        }
    }

    fn tangent(&self, _: &At<'_>, add: &mut dyn FnMut([Place; 2], [f64; 2])) {
        for line in &self.lines {
            add([(self.top[0], line.dof); 2], [0.0, line.impedance]);
        }
    }

    fn longest_step(&self) -> f64 {
        self.lines.iter().filter_map(|line| line.delay).fold(f64::INFINITY, f64::min)
    }

    fn memory(&self) -> Vec<f64> {
        // Equilibrium at the start.
        self.longest_delay().map_or(Vec::new(), |_| vec![0.0; ENTRY_LENGTH])
    }

    fn commit(&self, at: &At<'_>, memory: &mut Vec<f64>) {
        let Some(longest) = self.longest_delay() else { return };
        let velocity = (at.motion)(self.top[0]).velocity;
        let up = |place: usize| velocity[self.lines[place].dof] - self.downwards(place, at.time, memory);
        let entry = [at.time, up(0), up(1)];
        memory.extend(entry);
        let entries = memory.as_chunks::<ENTRY_LENGTH>().0;
        let past = entries.partition_point(|entry| entry[0] <= at.time - longest).saturating_sub(1);
        // Entries are removed once they are half of all, so that each is moved about once.
        if past > entries.len() / 2 {
            memory.drain(..past * ENTRY_LENGTH);
        }
    }
}
