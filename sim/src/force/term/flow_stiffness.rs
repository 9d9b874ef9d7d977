//! Flow stiffness of both flows with its end term, and their centrifugal load on the curved centre line: without it the
//! mud's momentum has no effect.

use super::context::{LateralWave, has_flow};
use super::contribution::Term;
use super::element::{ElementAtRest, RestTerms};

pub(crate) const TERM: Term =
    Term { frequency_change: Some(frequency_change), at_rest: Some(at_rest), ..Term::new(has_flow) };

/// To first order the flows' centrifugal stiffness S changes w by S k^2 / (2 m w^2).
fn frequency_change(wave: &LateralWave) -> f64 {
    wave.flow.map_or(f64::INFINITY, |flow| {
        flow.lateral_flux() * wave.wave_number.powi(2) / (2.0 * wave.mass * wave.frequency.powi(2))
    })
}

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    let Some((_, momentum)) = element.mud else { return };
    let curvature = element.chord.components(&element.curvature);
    for (load, kappa) in terms.distributed.iter_mut().zip(curvature).take(2) {
        *load -= (momentum.bore_flux - momentum.annulus_flux) * kappa;
    }
    let flux = momentum.lateral_flux();
    let mut matrix = element.beam.tension_stiffening() * -flux;
    if element.ends_at_bit {
        matrix += element.beam.flow_end() * flux;
    }
    terms.stiffness = Some(matrix);
}
