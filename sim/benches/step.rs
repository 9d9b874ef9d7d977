//! Cost of one time step of the 200 m string, next to the limits of the machine's caches and arithmetic.
//! Run: `cargo bench -p drillsweep-sim --bench step`
//!
//! Every figure is the shortest of several repeats in the same process, so that ratios hold on a shared machine.

use std::hint::black_box;

use drillsweep_scenario::{Accuracy, Integrator, Scenario, TimeStepping, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::math::linalg::{BlockTridiagonal, Factor, Four, Lane, MatrixPair, NodalField, Symmetric};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;

/// Bytes of a block.
const BLOCK: usize = 36 * 8;

/// Velocity of a stage per displacement \[1/s\], as of ESDIRK4 with 1 ms.
const VELOCITY_PER_DISPLACEMENT: f64 = 4e3;

/// Repeats of a short run; the shortest counts.
const REPEATS: usize = 9;

fn main() {
    let mut out = std::io::stdout().lock();
    let _ = report(&mut out);
}

fn report(out: &mut impl std::io::Write) -> std::io::Result<()> {
    let matrices = Matrices::of_the_base_case();
    let kernels = matrices.kernels();

    writeln!(out, "the machine, one core")?;
    let rate = stream(kernels.working_set);
    let kilobytes = kernels.working_set / 1024;
    writeln!(out, "  reads {:6.1} GB/s from {kilobytes} KB, the size of the matrices", rate / 1e9)?;
    let peak = multiply_add_rate();
    writeln!(out, "  fused multiply-adds {:.1} Gflop/s", peak / 1e9)?;

    writeln!(out, "\nkernels, us")?;
    let limit = kernels.bytes_per_stage as f64 / rate;
    let mut row = |name: &str, value: f64| writeln!(out, "  {name:30} {:8.2}", value * 1e6);
    row("M a + C v", kernels.products)?;
    row("solve", kernels.solve)?;
    row("factor", kernels.factor)?;
    row("a stage: one and two of them", kernels.products + 2.0 * kernels.solve)?;
    row("its limit by cache reads", limit)?;
    row("its limit by arithmetic", kernels.flops_per_stage as f64 / peak)?;

    writeln!(
        out,
        "\nwhole steps, alone           us/step  CPU s/s  stages  us/stage  of the kernels' limit"
    )?;
    let fixed = |integrator, step| Accuracy::Explicit(TimeStepping::fixed(integrator, step));
    let methods = [
        ("generalized-alpha, 0.5 ms", fixed(Integrator::GeneralizedAlpha, 5e-4), 1.0, 0.5),
        ("ESDIRK4, 1 ms", fixed(Integrator::Esdirk4, 1e-3), 5.0, 0.5),
        ("the paper's RK4, 0.05 ms", fixed(Integrator::Rk4, 5e-5), 4.0, 0.05),
    ];
    for (name, accuracy, stages, duration) in methods {
        let Timed { steps, time, .. } = run(accuracy, duration, 1.0);
        let step = time / steps as f64;
        let share = if name.contains("RK4,") {
            String::new()
        } else {
            format!("{:5.0} %", 100.0 * stages * limit / step)
        };
        writeln!(
            out,
            "  {name:26} {:8.1} {:8.3} {stages:7} {:9.2}  {share}",
            step * 1e6,
            time / duration,
            step / stages * 1e6
        )?;
    }
    writeln!(out, "\nmeshes, generalized-alpha  elements  us/step  ns/step and element")?;
    for (lengths, duration) in [(6.0, 0.1), (1.0, 0.1), (0.2, 0.03), (0.05, 0.01)] {
        let Timed { elements, steps, time } =
            run(fixed(Integrator::GeneralizedAlpha, 5e-4), duration, lengths);
        let step = time / steps as f64;
        writeln!(
            out,
            "  lengths x {lengths:<14} {elements:10} {:8.1} {:12.0}",
            step * 1e6,
            step / elements as f64 * 1e9
        )?;
    }
    Ok(())
}

/// A run without its start.
struct Timed {
    elements: usize,
    steps: u64,
    /// Shortest processor time \[s\].
    time: f64,
}

/// Runs the base case, the lengths of its elements multiplied.
fn run(accuracy: Accuracy, duration: f64, lengths: f64) -> Timed {
    let mut scenario: Scenario = preset("paper-200m").expect("it ships with the program");
    scenario.duration = duration;
    scenario.accuracy = accuracy;
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = None;
    scenario.scale_mesh(lengths);
    let model = Model::new(&scenario).expect("the preset has a model");
    let equilibrium = Equilibrium::find(&model).expect("the preset has an equilibrium");
    let mut timed = Timed { elements: model.elements.len(), steps: 0, time: f64::INFINITY };
    for _ in 0..REPEATS {
        let run = Transient::new(&model, &equilibrium).expect("the preset can be run");
        let started = processor_time();
        let Ok(Outcome::Finished(records)) = run.run(&Control::new()) else {
            unreachable!("nothing stops it")
        };
        timed.time = timed.time.min(processor_time() - started);
        timed.steps = records.effort.steps;
    }
    timed
}

/// Cost of the matrices' part of a stage: `M a + C v` once, a solve in each of two contact iterations.
struct Kernels {
    /// Shortest times \[s\].
    products: f64,
    solve: f64,
    factor: f64,
    /// Bytes of the matrices.
    working_set: usize,
    bytes_per_stage: usize,
    flops_per_stage: usize,
}

/// Matrices of the base case and its stages.
struct Matrices {
    mass: BlockTridiagonal,
    damping: BlockTridiagonal,
    stage: BlockTridiagonal,
    load: Vec<[f64; 6]>,
}

impl Matrices {
    fn of_the_base_case() -> Self {
        let scenario = preset("paper-200m").expect("it ships with the program");
        let model = Model::new(&scenario).expect("the preset has a model");
        let equilibrium = Equilibrium::find(&model).expect("the preset has an equilibrium");
        let system = model.dynamic_system(&equilibrium);
        let c = VELOCITY_PER_DISPLACEMENT;
        let mut stage =
            BlockTridiagonal::combine(c * c, &system.mass, c, &system.damping, 1.0, &system.stiffness);
        for (block, held) in stage.diagonal.iter_mut().zip(&system.held) {
            for dof in (0..6).filter(|&dof| held[dof]) {
                block[(dof, dof)] = 1.0;
            }
        }
        Self { stage, mass: system.mass, damping: system.damping, load: system.load }
    }

    fn rows(&self) -> usize {
        self.mass.rows()
    }

    /// Measures the kernels as a run uses them.
    fn kernels(&self) -> Kernels {
        let pair = MatrixPair::<Symmetric>::new(&self.mass, &self.damping);
        let load = NodalField::from_nodes(&self.load);
        let (x, y, mut product) = (load.clone(), load.clone(), load.clone());
        let factor_size = 3 * BLOCK * self.rows();
        // The mass' half that is kept is multiplied twice, but for its blocks on the diagonal.
        let flops = 2 * (pair.size() / 8) + 2 * BLOCK / 8 * self.rows() + 2 * 2 * factor_size / 8;
        let factor = Factor::new(&self.stage).expect("it is what a run solves");
        let (mut between, mut solution) = (self.load.clone(), load.clone());
        let products = || pair.subtract_products(&load, black_box(&x), black_box(&y), &mut product);
        let solve = || factor.solve_field(black_box(&load), &mut between, &mut solution);
        let [products, solve, factor] = shortest(products, solve, &self.stage);
        Kernels {
            products,
            solve,
            factor,
            working_set: pair.size() + factor_size,
            bytes_per_stage: pair.size() + 2 * factor_size,
            flops_per_stage: flops,
        }
    }
}

/// Shortest times \[s\] of the products, a solve and a factorisation.
fn shortest(mut products: impl FnMut(), mut solve: impl FnMut(), matrix: &BlockTridiagonal) -> [f64; 3] {
    let mut shortest = [f64::INFINITY; 3];
    // In turn, as in a stage: the matrices compete for the cache.
    for _ in 0..400 {
        let times = [timed(&mut products), timed(&mut solve)];
        for (shortest, time) in shortest.iter_mut().zip(times) {
            *shortest = shortest.min(time);
        }
    }
    for _ in 0..20 {
        shortest[2] = shortest[2].min(timed(|| {
            black_box(Factor::new(black_box(matrix)).is_ok());
        }));
    }
    shortest
}

fn processor_time() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn timed(work: impl FnOnce()) -> f64 {
    let started = processor_time();
    work();
    processor_time() - started
}

/// Bytes a second that one core reads from a block of memory of `bytes` bytes, repeatedly.
fn stream(bytes: usize) -> f64 {
    let values: Vec<[Four; 8]> = vec![[Four::splat(1.0); 8]; bytes / 256];
    let time = (0..50).map(|_| {
        timed(|| {
            let mut sums = [Four::splat(0.0); 8];
            for chunk in black_box(&values) {
                for (sum, value) in sums.iter_mut().zip(chunk) {
                    *sum = *sum + *value;
                }
            }
            black_box(sums);
        })
    });
    (values.len() * 256) as f64 / time.fold(f64::INFINITY, f64::min)
}

/// Floating-point operations a second of fused multiply-adds on registers.
fn multiply_add_rate() -> f64 {
    const ROUNDS: usize = 20_000;
    let factor = black_box(Four::splat(0.999));
    let time = (0..50).map(|_| {
        timed(|| {
            let mut sums = [Four::splat(1.0); 12];
            for _ in 0..ROUNDS {
                for sum in &mut sums {
                    *sum = sum.mul_add(factor, factor);
                }
            }
            black_box(sums);
        })
    });
    (ROUNDS * 12 * 8) as f64 / time.fold(f64::INFINITY, f64::min)
}
