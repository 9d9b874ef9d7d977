//! Flow regimes and their limits.

/// State of a flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Regime {
    /// No flow.
    Still,
    /// Laminar.
    Laminar,
    /// Between laminar and turbulent.
    Transitional,
    /// Fully turbulent.
    Turbulent,
}

impl Regime {
    /// The regime's name in results.
    pub fn name(self) -> &'static str {
        match self {
            Regime::Still => "still",
            Regime::Laminar => "laminar",
            Regime::Transitional => "transitional",
            Regime::Turbulent => "turbulent",
        }
    }
}

/// Reynolds numbers between which flow is transitional.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RegimeLimits {
    /// Re1: laminar up to here.
    pub(super) laminar: f64,
    /// Re2: turbulent from here on.
    pub(super) turbulent: f64,
}

/// The generalized index for the correlations, N cut to \[0.15, 1\].
///
/// The limits were fitted for 0.15 < N < 0.4, the turbulent factor for 0.36 to 1, the eccentricity factors
/// for 0.4 to 1. Below 0.15 (mud creeping little above its yield stress) the terms in 1/N take over and would
/// drive factor and limit below zero; with the cut all of them stay positive for any diameter ratio and
/// eccentricity.
pub(super) fn correlation_index(generalized_index: f64) -> f64 {
    generalized_index.clamp(0.15, 1.0)
}

/// Smallest width of the annular transition:
/// Founargiotakis, Kelessidis and Maglione (2008) on the same Reynolds number, 3250 - 1150 N to 4150 - 1150 N.
/// The limits below would meet and cross near N = 0.9.
const NARROWEST_TRANSITION: f64 = 900.0;

/// Limits of annular flow at N = `index`, kappa = D_o / D_ch and eccentricity e, as in the TUDRP code:
/// Re1 = 2100 \[N^0.331 (1 + 1.402 kappa - 0.977 kappa^2) - 0.019 e N^-0.868 kappa\],
/// Re2 = 2900 N^(-0.039 Re1^0.307).
pub(super) fn annulus_limits(index: f64, diameter_ratio: f64, eccentricity: f64) -> RegimeLimits {
    let laminar = 2100.0
        * (index.powf(0.331) * (1.0 + 1.402 * diameter_ratio - 0.977 * diameter_ratio.powi(2))
            - 0.019 * eccentricity * index.powf(-0.868) * diameter_ratio);
    let turbulent = 2900.0 * index.powf(-0.039 * laminar.powf(0.307));
    RegimeLimits { laminar, turbulent: turbulent.max(laminar + NARROWEST_TRANSITION) }
}

/// Limits of pipe flow at N = `index`: 3470 - 1370 N and 4270 - 1370 N (Dodge and Metzner 1959, API RP 13D).
pub(super) fn pipe_limits(index: f64) -> RegimeLimits {
    RegimeLimits { laminar: 3470.0 - 1370.0 * index, turbulent: 4270.0 - 1370.0 * index }
}
