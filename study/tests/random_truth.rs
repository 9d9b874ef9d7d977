//! Ten random scenarios with stick-slip at reduced size, compared with an independent method: none is wrong without reporting it. More and longer
//! ones:
//! `cargo bench -p drillsweep-study --bench random_truth`.

use random_truths::{Judgement, judge, long_scenario};

mod random_truths;

#[test]
fn no_random_scenario_is_wrong_without_saying_so() {
    let (mut known, mut stated_ones) = (0, 0);
    for index in 0..150 {
        let scenario = long_scenario(7, index, 9.0, 6.0);
        let judgement = judge(&scenario, 2e5);
        assert!(!judgement.is_silently_wrong(), "scenario {index}: {judgement:?}\n{}", scenario.to_toml());
        if let Judgement::Known { stated, .. } = judgement {
            known += 1;
            stated_ones += usize::from(stated.is_some());
        }
        if known == 10 {
            break;
        }
    }
    assert!(
        known == 10 && stated_ones >= 3,
        "{known} scenarios have stick-slip, {stated_ones} state an error"
    );
}
