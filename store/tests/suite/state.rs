//! The state machine of work, and its drawing. That a schema has the same is for the module of its engine to test.

use std::collections::BTreeSet;

use drillsweep_store::{TRANSITIONS, Transition, WorkState};

#[test]
fn every_state_is_reached_and_can_be_left() {
    for state in WorkState::ALL {
        assert!(TRANSITIONS.iter().any(|transition| transition.to == state), "{state:?}");
        assert!(TRANSITIONS.iter().any(|transition| transition.from == state), "{state:?}");
        assert!(!state.may_become(state), "{state:?}");
    }
}

#[test]
fn the_book_draws_this_machine() {
    let text = include_str!("../../../docs/store.md");
    let drawing = text.split("```mermaid\nstateDiagram-v2\n").nth(1).unwrap().split("```").next().unwrap();
    let drawn: BTreeSet<&str> =
        drawing.lines().map(str::trim).filter(|line| line.contains("-->") && !line.contains("[*]")).collect();
    let transition = |Transition { from, to, cause }: &Transition| {
        format!("{} --> {}: {cause}", from.as_str(), to.as_str())
    };
    let expected: Vec<String> = TRANSITIONS.iter().map(transition).collect();
    assert_eq!(drawn, expected.iter().map(String::as_str).collect());
}
