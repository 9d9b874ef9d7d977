//! Expansion of requests within bounds on memory and processor time.

use std::time::Duration;

use drillsweep_api::{LIMITS, SweepRequest};
use serde::de::DeserializeOwned;

use crate::answer::error::Result;
use crate::answer::extract;
use crate::app::App;
use crate::app::expansions::{Memory, Work};
use crate::guard::caller::Caller;

/// Memory of an expanded point until it is stored \[bytes\].
const MEMORY_OF_POINT: usize = 700;

/// Processor time of expanding a point: twice that of the slowest presets, whose meshes follow from the scenario.
const TIME_OF_POINT: Duration = Duration::from_micros(300);

/// Takes memory and processor time for all points of a request, in addition to the memory for parsing it \[bytes\].
///
/// # Errors
/// The needed memory \[bytes\], if it is not free.
pub(super) fn make_room(
    work: &mut Work,
    of_reading: usize,
    request: &SweepRequest,
) -> std::result::Result<(), usize> {
    let points = request.point_count().unwrap_or(usize::MAX).min(LIMITS.points_per_sweep);
    let needed = of_reading + points * MEMORY_OF_POINT;
    if !work.grow(needed) {
        return Err(needed);
    }
    work.allow(TIME_OF_POINT * points as u32);
    Ok(())
}

/// Parses a body and expands its request in a place for expansions. If the request needs more memory than the place has, `expand` returns
/// the needed memory, and both are repeated in a place of that size.
pub(super) async fn expand_body<R: DeserializeOwned, T: Send + 'static>(
    app: &App,
    caller: &Caller,
    body: &extract::Body,
    expand: impl Fn(R, &mut Work, usize) -> Result<std::result::Result<T, usize>> + Clone + Send + 'static,
) -> Result<(T, Memory)> {
    let of_reading = extract::memory_of_reading(body.bytes.len());
    let mut memory = of_reading;
    loop {
        let place = app.expansions.enter(caller.budget(), memory).await?;
        let (bytes, expand) = (body.bytes.clone(), expand.clone());
        let expanded = place.run(move |work| expand(extract::read_json(&bytes)?, work, of_reading)).await?;
        match expanded {
            (Ok(expanded), memory) => return Ok((expanded, memory)),
            (Err(needed), _) => memory = needed,
        }
    }
}
