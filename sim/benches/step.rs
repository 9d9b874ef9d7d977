//! What one time step of the 200 m case costs, beside what the machine's caches and arithmetic allow, and whether sweep
//! points side by side in a vector would be cheaper than one after the other.
//! Run: `cargo bench -p drillsweep-sim --bench step`
//!
//! Every figure is the shortest of several repeats in the same process, so that ratios hold on a shared machine.

use std::hint::black_box;

use drillsweep_sim::control::Control;
use drillsweep_sim::linalg::{Block, BlockTridiagonal, Factor, Four, Lane, MatrixPair};
use drillsweep_sim::model::Model;
use drillsweep_sim::scenario::{Accuracy, AccuracyPreset, Integrator, Scenario, TimeStepping, preset};
use drillsweep_sim::statics::Equilibrium;
use drillsweep_sim::transient::{Outcome, Transient};

/// Nodes of the 200 m case.
const ROWS: usize = 297;

/// Bytes of a block of one lane.
const BLOCK: f64 = 36.0 * 8.0;

/// Blocks of a row that a stage reads: mass and damping once (3 each), the factor (3) in each of two contact sweeps.
const BLOCKS_PER_STAGE: f64 = 3.0 + 3.0 + 2.0 * 3.0;

/// Repeats of a short run; the shortest counts.
const REPEATS: usize = 9;

fn main() {
    let mut out = std::io::stdout().lock();
    let _ = report(&mut out);
}

fn report(out: &mut impl std::io::Write) -> std::io::Result<()> {
    writeln!(out, "the machine, one core")?;
    let working_set = (9.0 * BLOCK * ROWS as f64) as usize;
    let bandwidth = [1, 4].map(|lanes| stream(lanes * working_set));
    for (lanes, rate) in [1, 4].into_iter().zip(bandwidth) {
        let kilobytes = lanes * working_set / 1024;
        writeln!(
            out,
            "  reads {:6.1} GB/s from {kilobytes} KB, the matrices of {lanes} lane(s)",
            rate / 1e9
        )?;
    }
    let peak = multiply_add_rate();
    writeln!(out, "  fused multiply-adds {:.1} Gflop/s", peak / 1e9)?;

    writeln!(out, "\nkernels, us for each lane           1 lane  4 lanes")?;
    let (one, four) = (kernels::<f64>(), kernels::<Four>());
    for (name, (one, four)) in ["M a + C v", "solve", "factor"].into_iter().zip(one.into_iter().zip(four)) {
        writeln!(out, "  {name:30} {:8.2} {:8.2}", one * 1e6, four * 1e6 / 4.0)?;
    }
    let stage = |kernels: [f64; 3]| kernels[0] + 2.0 * kernels[1];
    let bytes = BLOCKS_PER_STAGE * BLOCK * ROWS as f64;
    let flops = BLOCKS_PER_STAGE * 72.0 * ROWS as f64;
    writeln!(
        out,
        "  {:30} {:8.2} {:8.2}",
        "a stage: one and two of them",
        stage(one) * 1e6,
        stage(four) * 1e6 / 4.0
    )?;
    writeln!(
        out,
        "  {:30} {:8.2} {:8.2}",
        "its limit by cache reads",
        bytes / bandwidth[0] * 1e6,
        bytes / bandwidth[1] * 1e6
    )?;
    writeln!(
        out,
        "  {:30} {:8.2} {:8.2}",
        "its limit by arithmetic",
        flops / peak * 1e6,
        flops / peak * 1e6
    )?;

    writeln!(
        out,
        "\nwhole steps, alone           us/step  CPU s/s  stages  us/stage  of the kernels' limit"
    )?;
    let limit = bytes / bandwidth[0];
    let preset = |preset| Accuracy::Preset(preset);
    let methods = [
        ("draft: generalized-alpha", preset(AccuracyPreset::Draft), 1.0, 0.5),
        ("standard: ESDIRK4", preset(AccuracyPreset::Standard), 5.0, 0.5),
        (
            "the paper's RK4, 0.05 ms",
            Accuracy::Explicit(TimeStepping::fixed(Integrator::Rk4, 5e-5)),
            4.0,
            0.05,
        ),
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
    writeln!(out, "\nmeshes, draft              elements  us/step  ns/step and element")?;
    for (lengths, duration) in [(6.0, 0.1), (1.0, 0.1), (0.2, 0.03), (0.05, 0.01)] {
        let Timed { elements, steps, time } = run(preset(AccuracyPreset::Draft), duration, lengths);
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
    scenario.recording.spectrum_windows.clear();
    scenario.recording.orbit_window = None;
    let mesh = &mut scenario.mesh;
    for length in
        [&mut mesh.drillpipe, &mut mesh.tool_joint, &mut mesh.collar, &mut mesh.stabilizer, &mut mesh.bit]
    {
        *length *= lengths;
    }
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

/// Shortest time \[s\] of `M a + C v`, a solve and a factorisation, all lanes together.
fn kernels<L: Lane>() -> [f64; 3] {
    let matrix = |seed: f64| {
        let block = |row: usize, shift: f64| {
            Block::from_fn(|i, j| {
                let entry = (seed + (row * 36 + i * 6 + j) as f64).sin();
                L::splat(if i == j { entry + shift } else { entry })
            })
        };
        BlockTridiagonal::<L> {
            lower: (0..ROWS).map(|row| block(row, 0.0)).collect(),
            diagonal: (0..ROWS).map(|row| block(row + ROWS, 30.0)).collect(),
            upper: (0..ROWS).map(|row| block(row + 2 * ROWS, 0.0)).collect(),
        }
    };
    let vector = |seed: f64| -> Vec<[L; 6]> {
        (0..ROWS).map(|row| std::array::from_fn(|i| L::splat((seed + (6 * row + i) as f64).cos()))).collect()
    };
    let (a, b, x, y, whole) = (matrix(0.1), matrix(0.4), vector(0.2), vector(0.3), vector(0.6));
    let (pair, factor) = (MatrixPair::new(&a, &b), Factor::new(&a).expect("diagonally dominant"));
    let (mut product, mut solution) = (vector(0.5), x.clone());
    // In turn, as in a stage: the three matrices compete for the cache.
    let mut shortest = [f64::INFINITY; 3];
    for _ in 0..400 {
        let times = [
            timed(|| pair.subtract_products(&whole, black_box(&x), black_box(&y), &mut product)),
            timed(|| factor.solve_in_place(black_box(&mut solution))),
        ];
        for (shortest, time) in shortest.iter_mut().zip(times) {
            *shortest = shortest.min(time);
        }
        solution.copy_from_slice(&x);
    }
    for _ in 0..20 {
        shortest[2] = shortest[2].min(timed(|| {
            black_box(Factor::new(black_box(&a)).is_ok());
        }));
    }
    shortest
}

/// Processor time of this thread \[s\]: others on the machine do not count.
fn processor_time() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn timed(work: impl FnOnce()) -> f64 {
    let started = processor_time();
    work();
    processor_time() - started
}

/// Bytes a second that one core reads from a block of memory of so many bytes, over and over.
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
