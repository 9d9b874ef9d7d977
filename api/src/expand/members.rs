//! Members of a request other than its scenario and axes: name, owner, priority, tags, verification.

use std::collections::BTreeSet;

use drillsweep_scenario::json_number;

use super::problems::Found;
use crate::problem::ProblemDetails;
use crate::request::{SweepPatch, SweepRequest};
use crate::service::LIMITS;
use crate::verify::verify_problem;

/// Checks the members of a change of a sweep.
///
/// # Errors
/// Everything that is wrong with them, with JSON Pointers into the body.
pub fn check_patch(patch: &SweepPatch) -> Result<(), Box<ProblemDetails>> {
    let mut problems = Found::default();
    let name = patch.name.as_ref().and_then(Option::as_ref);
    check_text("/name", name, LIMITS.name_length, &mut problems);
    if let Some(priority) = patch.priority {
        check_priority(priority, &mut problems);
    }
    if let Some(tags) = &patch.tags {
        check_tags(tags, &mut problems);
    }
    match problems.is_empty() {
        true => Ok(()),
        false => Err(problems.into_refusal()),
    }
}

pub(super) fn check_members(request: &SweepRequest, problems: &mut Found) {
    check_text("/name", request.name.as_ref(), LIMITS.name_length, problems);
    check_text("/owner", request.owner.as_ref(), LIMITS.owner_length, problems);
    check_priority(request.priority, problems);
    check_tags(&request.tags, problems);
    if let Some((verify, detail)) = request.verify.and_then(|verify| Some((verify, verify_problem(verify)?)))
    {
        problems.push("/verify", Some(json_number(verify)), detail);
    }
}

fn check_text(pointer: &str, text: Option<&String>, limit: usize, problems: &mut Found) {
    let is_valid =
        |text: &str| (1..=limit).contains(&text.chars().count()) && !text.chars().any(char::is_control);
    if let Some(text) = text.filter(|text| !is_valid(text)) {
        let detail = format!("must have 1 to {limit} characters, none of them a control character");
        problems.push(pointer, Some(text.as_str().into()), detail);
    }
}

fn check_priority(priority: i32, problems: &mut Found) {
    let (lowest, highest) = (LIMITS.lowest_priority, LIMITS.highest_priority);
    if !(lowest..=highest).contains(&priority) {
        let detail = format!("must be between {lowest} and {highest}");
        problems.push("/priority", Some(priority.into()), detail);
    }
}

fn check_tags(tags: &BTreeSet<String>, problems: &mut Found) {
    let (most, length) = (LIMITS.tags_per_sweep, LIMITS.tag_length);
    if tags.len() > most {
        problems.push("/tags", Some(tags.len().into()), format!("a sweep has at most {most} tags"));
    }
    for (index, tag) in tags.iter().enumerate() {
        check_text(&format!("/tags/{index}"), Some(tag), length, problems);
    }
}
