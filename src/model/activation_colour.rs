//! The colours of muscles by their activation, in recordings and reports.

/// The activation from which on a muscle has the last colour of the scale.
pub const FULL_ACTIVATION: f64 = 0.5;

/// Activations with their colours: the scale OrRd of ColorBrewer (Harrower and Brewer 2003) from quiet to red. Its steps look
/// even and become darker, so that it also reads without colours. They are finer where most activations are.
const SCALE: [(f64, [u8; 3]); 5] = [
    (0.0, [254, 240, 217]),
    (0.05, [253, 204, 138]),
    (0.15, [252, 141, 89]),
    (0.3, [227, 74, 51]),
    (FULL_ACTIVATION, [179, 0, 0]),
];

/// The colour of an activation, 0 to 1, in sRGB: linear between the steps of the scale.
#[must_use]
pub fn activation_rgb(activation: f64) -> [u8; 3] {
    let within = activation.clamp(0.0, FULL_ACTIVATION);
    let upper = SCALE.iter().position(|(end, _)| within <= *end).unwrap_or(SCALE.len() - 1).max(1);
    let [(from, quieter), (to, busier)] = [SCALE[upper - 1], SCALE[upper]];
    let share = (within - from) / (to - from);
    std::array::from_fn(|channel| {
        let [low, high] = [quieter, busier].map(|colour| f64::from(colour[channel]));
        (low + share * (high - low)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Luma by the weights of ITU-R BT.709.
    fn luma(rgb: [u8; 3]) -> f64 {
        let [r, g, b] = rgb.map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn a_busier_muscle_is_darker_and_the_scale_has_no_jumps() {
        let of = |percent: u32| activation_rgb(f64::from(percent) / 100.0);
        for percent in 0..50 {
            let change = luma(of(percent)) - luma(of(percent + 1));
            // No step falls by more than 50 in at least 5 percent; rounding of the channels adds less than 1.
            assert!(change > 0.0 && change < 11.0, "{percent} %: {change}");
        }
        assert_eq!((of(0), of(50)), (SCALE[0].1, SCALE[4].1));
        assert_eq!((activation_rgb(-1.0), of(60), of(100)), (of(0), of(50), of(50)));
    }
}
