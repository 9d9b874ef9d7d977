//! Histories as recorded, over a window and thinned by stride.

/// At which stride the rows of a window are kept so that at most `max_points` of its `samples` stay: the smallest one; 1 where that is
/// not asked for.
///
/// Equal intervals of time survive, extremes between the rows that stay do not: an orbit is thinned by its extremes instead
/// ([`super::orbit`]).
pub fn stride(samples: usize, max_points: Option<usize>) -> usize {
    max_points.map_or(1, |max_points| samples.div_ceil(max_points.max(1)).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stride_is_the_smallest_that_fits() {
        for (max_points, rows) in [(1000, 1000), (999, 500), (500, 500), (300, 250), (1, 1)] {
            assert_eq!((0..1000).step_by(stride(1000, Some(max_points))).len(), rows, "at most {max_points}");
        }
        assert_eq!((stride(1000, None), stride(0, Some(10))), (1, 1));
    }
}
