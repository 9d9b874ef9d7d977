//! Three hundred scenes drawn over wide ranges: each ends with a finite result whose ledger closes within its bound, or as a typed
//! failure. More of them, and other seeds: `drillsweep soak`.

use drillsweep_sim::control::Control;
use drillsweep_sim::soak::{SceneEnd, run, scene};

/// Runs fifty scenes of a seed; at least `finite` of them must have a result.
fn fifty(seed: u64, finite: usize) {
    let mut results = 0;
    for index in 0..50 {
        let scenario = scene(seed, index);
        match run(&scenario, &Control::new()) {
            SceneEnd::Finite { ledger } => {
                results += 1;
                assert!((0.0..=1.0).contains(&ledger), "scene {index} of seed {seed}");
            }
            SceneEnd::Failed { cause, reason } => {
                assert!(!cause.is_empty() && !reason.is_empty());
            }
            SceneEnd::Broken { reason } => {
                panic!("scene {index} of seed {seed}: {reason}\n{}", scenario.to_toml());
            }
            SceneEnd::Cancelled => panic!("nobody cancelled scene {index} of seed {seed}"),
        }
    }
    assert!(results >= finite, "{results} of 50 scenes of seed {seed} have a result");
}

#[test]
fn scenes_of_seed_1() {
    fifty(1, 30);
}

#[test]
fn scenes_of_seed_2() {
    fifty(2, 30);
}

#[test]
fn scenes_of_seed_3() {
    fifty(3, 30);
}

#[test]
fn scenes_of_seed_4() {
    fifty(4, 30);
}

#[test]
fn scenes_of_seed_5() {
    fifty(5, 30);
}

#[test]
fn scenes_of_seed_6() {
    fifty(6, 30);
}

#[test]
fn scene_is_always_the_same_and_no_two_are() {
    assert_eq!(scene(3, 14), scene(3, 14));
    assert_ne!(scene(3, 14).well, scene(3, 15).well);
    assert_ne!(scene(3, 14).well, scene(4, 14).well);
}
