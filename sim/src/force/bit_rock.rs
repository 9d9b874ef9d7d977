//! Torque on bit that falls with the speed of the bit.
//!
//! With the nominal speed Omega and the speed omega = Omega + d theta_z/dt of the bit the torque is T_0 g(omega) / g(Omega), T_0 the torque on bit of the scenario,
//! g(omega) = s(omega / c) (1 + (rho_s - 1) exp(-|omega| / omega_w)), with s(y) = y (3 - y^2) / 2 within -1 to 1 and the sign of y beyond
//! (docs/model/drive.md).

use std::sync::Arc;

use drillsweep_scenario::{ActiveEffects, Bit, BitLaw, Scenario};

use crate::force::drive::Drive;
use crate::force::nodal::{At, Dependence, ForceContext, NodalForce, NodeCompliance, NodeMotion, Place};
use crate::force::term::{Account, Decision, EffectContext, Term, no, yes};
use crate::math::dof::{DOFS, THETA_Z};

pub(crate) const TERM: Term = Term::new(decide);

/// Work of the change of the torque on bit on the motion.
pub(crate) const WORK: Account = Account::given("work_bit", |booked| booked.by_force("work_bit"));

/// Change of the speed of the bit, over its scale, to which a stage's equation is solved.
const SOLVED: f64 = 1e-13;

/// Iterations that bisection needs for that, whatever the bracket.
const MOST_ITERATIONS: u32 = 100;

fn decide(context: &EffectContext<'_>) -> Decision {
    let operation = &context.scenario.operation;
    match (context.scenario.bit.law, operation.torque_on_bit != 0.0, context.turns()) {
        (BitLaw::Constant, ..) => no("torque on bit is constant"),
        (BitLaw::Regenerative, ..) => no("the regenerative law has stability maps only"),
        (_, false, _) => no("there is no torque on bit"),
        (_, _, false) => no("the string does not turn"),
        (BitLaw::VelocityWeakening, true, true) => yes("torque on bit falls with the speed of the bit"),
    }
}

/// The change of the torque on bit by the speed of the bit.
pub(super) fn force(context: &ForceContext<'_>) -> Option<Arc<dyn NodalForce>> {
    let bit = context.nodes.len().checked_sub(1)?;
    let torque = WeakeningTorque::of(context.scenario, context.effects)?;
    Some(Arc::new(BitTorque { bit: [bit], torque }))
}

/// Torque on bit over the speed of the bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WeakeningTorque {
    /// rho_s - 1.
    excess: f64,
    /// omega_w \[rad/s\].
    weakening_speed: f64,
    /// c \[rad/s\].
    regularisation_speed: f64,
    /// Nominal speed Omega \[rad/s\].
    nominal_speed: f64,
    /// Torque on bit at the nominal speed T_0 \[N m\].
    nominal_torque: f64,
    /// -T_0 / g(Omega) \[N m\], 0 or more.
    scale: f64,
}

impl WeakeningTorque {
    /// The law of a scenario; absent if torque on bit is constant or the string does not twist.
    pub(crate) fn of(scenario: &Scenario, effects: &ActiveEffects) -> Option<Self> {
        let takes_part = effects.bit_rock && effects.torsion && scenario.bit.law == BitLaw::VelocityWeakening;
        let nominal_speed = Drive::new(&scenario.operation).nominal_speed();
        let law = Self::new(&scenario.bit, scenario.operation.torque_on_bit, nominal_speed);
        // A string that does not turn has no scale.
        (takes_part && law.scale.is_finite() && law.scale > 0.0).then_some(law)
    }

    /// Fall of the torque by speed \[N m s\] at a speed \[rad/s\], of a bit with a torque \[N m\], opposite in sign, at the nominal speed \[rad/s\].
    pub(crate) fn fall(bit: &Bit, nominal_torque: f64, nominal_speed: f64, speed: f64) -> f64 {
        Self::new(bit, nominal_torque, nominal_speed).change(speed - nominal_speed)[1]
    }

    /// Torque \[N m\] on such a bit at a speed \[rad/s\], opposite in sign.
    pub(crate) fn torque(bit: &Bit, nominal_torque: f64, nominal_speed: f64, speed: f64) -> f64 {
        nominal_torque + Self::new(bit, nominal_torque, nominal_speed).change(speed - nominal_speed)[0]
    }

    /// Torque of a bit with a torque \[N m\] at the nominal speed \[rad/s\].
    fn new(bit: &Bit, nominal_torque: f64, nominal_speed: f64) -> Self {
        let mut law = Self {
            excess: bit.static_ratio - 1.0,
            weakening_speed: bit.weakening_speed,
            regularisation_speed: bit.regularisation_speed,
            nominal_speed,
            nominal_torque,
            scale: 1.0,
        };
        law.scale = -nominal_torque / law.shape(nominal_speed)[0];
        law
    }

    /// Torque on the string less that of the equilibrium \[N m\], and its slope \[N m s\], at a rate of twist of the bit \[rad/s\].
    pub(crate) fn change(&self, rate: f64) -> [f64; 2] {
        let [shape, slope] = self.shape(self.nominal_speed + rate);
        [-self.scale * shape - self.nominal_torque, -self.scale * slope]
    }

    /// g of the speed of the bit \[rad/s\], and its slope \[s\].
    fn shape(&self, speed: f64) -> [f64; 2] {
        let (c, run) = (self.regularisation_speed, speed.abs() / self.weakening_speed);
        let y = (speed / c).clamp(-1.0, 1.0);
        let (sign, sign_slope) = (0.5 * y * (3.0 - y * y), 1.5 * (1.0 - y * y) / c);
        let decay = self.excess * (-run).exp();
        let fall = decay * sign.abs() / self.weakening_speed;
        [sign * (1.0 + decay), sign_slope * (1.0 + decay) - fall]
    }

    /// Rate of twist of the bit \[rad/s\] with rate = `without` + `response` change(rate). Of several solutions the one is returned that the rate reaches
    /// first from `start`.
    fn rate(&self, start: f64, without: f64, response: f64) -> f64 {
        let excess = |speed: f64| {
            let rate = speed - self.nominal_speed;
            let [torque, slope] = self.change(rate);
            [rate - without - response * torque, 1.0 - response * slope]
        };
        let start = self.nominal_speed + start;
        let [first, _] = excess(start);
        if first == 0.0 {
            return start - self.nominal_speed;
        }
        // The torque is at most that of a bit about to turn, either way.
        let most = response * (self.scale * (1.0 + self.excess) + self.nominal_torque.abs());
        let end = self.nominal_speed + without - most.copysign(first);
        let mut folds = self.folds(response);
        if end < start {
            folds.reverse();
        }
        let is_between = |speed: &f64| (*speed - start) * (*speed - end) < 0.0;
        let mut from = start;
        for to in folds.into_iter().filter(is_between).chain([end]) {
            if excess(to)[0] * first <= 0.0 {
                return bracketed(excess, from, to) - self.nominal_speed;
            }
            from = to;
        }
        end - self.nominal_speed
    }

    /// Speeds between which the equation of a stage is monotone, increasing.
    fn folds(&self, response: f64) -> [f64; 4] {
        let steepest = response * self.scale * self.excess / self.weakening_speed;
        let fold = (self.weakening_speed * steepest.ln()).max(self.regularisation_speed);
        [-fold, -self.regularisation_speed, self.regularisation_speed, fold]
    }
}

/// Zero of a function with its slope between two places of opposite signs: Newton's method, and bisection if it leaves the bracket or is slow.
fn bracketed(function: impl Fn(f64) -> [f64; 2], from: f64, to: f64) -> f64 {
    let (mut low, mut high) = (from, to);
    let low_sign = function(low)[0];
    let scale = from.abs().max(to.abs());
    let mut place = 0.5 * (low + high);
    let mut before = high - low;
    for _ in 0..MOST_ITERATIONS {
        let [value, slope] = function(place);
        if value == 0.0 {
            return place;
        }
        if value * low_sign > 0.0 {
            low = place
        } else {
            high = place
        }
        let newton = place - value / slope;
        let is_inside = (newton - low) * (newton - high) < 0.0;
        let next = if is_inside && (newton - place).abs() < 0.5 * before.abs() {
            newton
        } else {
            0.5 * (low + high)
        };
        before = next - place;
        place = next;
        if before.abs() <= SOLVED * scale {
            break;
        }
    }
    place
}

/// The change of the torque on the last node.
#[derive(Debug)]
struct BitTorque {
    bit: [usize; 1],
    torque: WeakeningTorque,
}

impl BitTorque {
    fn rate(&self, at: &At<'_>) -> f64 {
        (at.motion)(self.bit[0]).velocity[THETA_Z]
    }
}

impl NodalForce for BitTorque {
    fn nodes(&self) -> &[usize] {
        &self.bit
    }

    fn dependence(&self) -> Dependence {
        Dependence::Motion
    }

    fn entry(&self) -> Option<&'static str> {
        Some(WORK.name)
    }

    fn forces(&self, at: &At<'_>, out: &mut [[f64; DOFS]]) {
        out[0][THETA_Z] = self.torque.change(self.rate(at))[0];
    }

    fn implicit_forces(&self, at: &At<'_>, compliance: &[NodeCompliance], out: &mut [[f64; DOFS]]) {
        let NodeCompliance { displacement, speed } = compliance[0];
        let response = speed * displacement[THETA_Z][THETA_Z];
        let rate = self.rate(at);
        let without = rate - response * out[0][THETA_Z];
        out[0][THETA_Z] = self.torque.change(self.torque.rate(rate, without, response))[0];
    }

    fn tangent(&self, at: &At<'_>, add: &mut dyn FnMut([Place; 2], [f64; 2])) {
        let twist = (self.bit[0], THETA_Z);
        add([twist; 2], [0.0, -self.torque.change(self.rate(at))[1]]);
    }

    fn largest_damping(&self) -> Option<(Place, f64)> {
        // Of a bit that stands.
        let slope = self.torque.change(-self.torque.nominal_speed)[1];
        Some(((self.bit[0], THETA_Z), -slope))
    }

    fn sensitivity(&self, at: &At<'_>, change: &dyn Fn(usize) -> NodeMotion) -> f64 {
        let slope = self.torque.change(self.rate(at))[1] / self.torque.nominal_torque;
        (slope * change(self.bit[0]).velocity[THETA_Z]).abs()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// 5 kN m at 120 rpm.
    fn law(bit: Bit) -> WeakeningTorque {
        WeakeningTorque::new(&bit, -5000.0, 4.0 * PI)
    }

    #[test]
    fn torque_has_its_nominal_value_and_slope_and_that_of_a_bit_about_to_turn() {
        let law = law(Bit::default());
        let [change, slope] = law.change(0.0);
        assert!(change.abs() < 1e-9, "{change}");
        // |T_0| / omega_w exp(-Omega / omega_w) / (1 + exp(-Omega / omega_w)) with Omega = 12.566 rad/s.
        assert!((slope - 101.741).abs() < 1e-3, "{slope}");
        let at = |speed: f64| law.change(speed - 4.0 * PI)[0] - 5000.0;
        let fast = 5000.0 / (1.0 + (-4.0 * PI / 7.0).exp());
        let stuck = fast * (1.0 + (-0.1_f64 / 7.0).exp());
        assert!((at(0.1) + stuck).abs() < 1e-9, "{}", at(0.1));
        assert_eq!(at(0.0), 0.0);
        assert!((at(-3.0) + at(3.0)).abs() < 1e-9, "odd in the speed");
        assert!((at(1e4) + fast).abs() < 1e-9);
        // With a static ratio of 1 it is constant as long as the bit turns.
        let constant = super::tests::law(Bit { static_ratio: 1.0, ..Bit::default() });
        for speed in [0.1, 1.0, 50.0] {
            assert!(constant.change(speed - 4.0 * PI)[0].abs() < 1e-9);
        }
    }

    #[test]
    fn slopes_are_those_of_the_torque() {
        let law = law(Bit::default());
        for speed in [-9.0, -0.11, -0.05, -0.01, 0.0, 0.03, 0.09, 0.2, 7.0, 30.0] {
            let rate = speed - law.nominal_speed;
            let h = 1e-6;
            let difference = (law.change(rate + h)[0] - law.change(rate - h)[0]) / (2.0 * h);
            let slope = law.change(rate)[1];
            assert!(
                (slope - difference).abs() < 1e-5 * (1.0 + slope.abs()),
                "{speed}: {slope}, {difference}"
            );
        }
    }

    #[test]
    fn a_stage_finds_the_solution_next_to_its_start() {
        let law = law(Bit::default());
        for response in [0.0, 1e-5, 1e-3, 3e-3, 1e-2, 0.1] {
            for start in [-20.0, -12.6, -12.5, -6.0, 0.0, 20.0] {
                for without in [-40.0, -13.0, -12.566, -5.0, 0.0, 5.0, 40.0] {
                    let found = law.rate(start, without, response);
                    let left = |rate: f64| rate - without - response * law.change(rate)[0];
                    assert!(left(found).abs() < 1e-9, "{response}, {start}, {without}: {}", left(found));
                    // Nothing solves the equation between start and solution.
                    for part in 1..1000 {
                        let between = start + f64::from(part) / 1000.0 * (found - start);
                        let is_same = left(between) * left(start) >= -1e-18;
                        assert!(is_same, "{response}, {start}, {without}: passed over {between}");
                    }
                }
            }
        }
    }
}
