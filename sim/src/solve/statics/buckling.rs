//! Compression of a string against its buckling load.

use crate::solve::model::{Model, StringElement};

/// Factor of Lubinski's critical load of a string in a vertical hole, in (E I w^2)^(1/3) (Lubinski 1950, first order).
const VERTICAL: f64 = 1.94;

/// Compression of every element, of effective tension `tension` \[N\], over the load from which it buckles sinusoidally in its hole; 0 in tension, from sqrt(2) on helical.
///
/// The load is 2 sqrt(E I f / r) with the side load f of the element pressed against the wall, by its weight and by its compression in a curved hole, and the
/// radial clearance r of its body (Dawson and Paslay 1984; in curved holes He and Kyllingstad 1995); at least that of a vertical hole. An element without
/// weight, or without clearance, has no such load: 0.
pub fn buckling_ratios(model: &Model, tension: &[f64]) -> Vec<f64> {
    let ratio = |(element, tension): (&StringElement, &f64)| {
        let section = element.beam.section();
        let clearance = 0.5 * (element.flow_geometry.hole_diameter - section.outer_diameter);
        let [x, y] = [0, 1].map(|axis| element.lateral_load[axis] + tension * element.curvature[axis]);
        let inclined = 2.0 * (section.bending_stiffness() * x.hypot(y) / clearance).sqrt();
        let [weight_x, weight_y] = element.lateral_load;
        let weight = weight_x.hypot(weight_y).hypot(element.axial_weight / element.beam.length());
        let vertical = VERTICAL * (section.bending_stiffness() * weight * weight).cbrt();
        let load = inclined.max(vertical);
        if load > 0.0 && load.is_finite() { (-tension / load).max(0.0) } else { 0.0 }
    };
    model.elements.iter().zip(tension).map(ratio).collect()
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;
    use crate::solve::statics::Equilibrium;

    #[test]
    fn presets_near_and_beyond_buckling_are_where_their_loads_put_them() {
        let largest = |name: &str| {
            let model = Model::new(&preset(name).unwrap()).unwrap();
            let equilibrium = Equilibrium::find(&model).unwrap();
            buckling_ratios(&model, &equilibrium.tension).into_iter().fold(0.0, f64::max)
        };
        // Chosen at 0.7 of the sinusoidal load.
        let near = largest("hard/near-buckling");
        assert!((near - 0.7).abs() < 0.02, "{near}");
        // Chosen well beyond the helical load, sqrt(2) of the sinusoidal one.
        let beyond = largest("hard/beyond-buckling");
        assert!(beyond > 2_f64.sqrt(), "{beyond}");
    }
}
