//! The 97.5 % quantile of Student's t distribution.

/// t₀.₉₇₅ for 1 to 10 degrees of freedom (Abramowitz and Stegun 1964, table 26.10, with more digits).
const TABLE: [f64; 10] = [
    12.706_204_736,
    4.302_652_730,
    3.182_446_305,
    2.776_445_105,
    2.570_581_836,
    2.446_911_851,
    2.364_624_252,
    2.306_004_135,
    2.262_157_163,
    2.228_138_852,
];

/// t₀.₉₇₅ for `degrees` ≥ 1 degrees of freedom: tabulated up to 10, beyond by the expansion around the normal quantile
/// (Abramowitz and Stegun 1964, 26.7.5), to better than 1e-5.
pub(super) fn t_975(degrees: usize) -> f64 {
    if let Some(t) = degrees.checked_sub(1).and_then(|i| TABLE.get(i)) {
        return *t;
    }
    let z = 1.959_963_984_540_054_f64;
    let (n, z2) = (degrees as f64, z * z);
    let g1 = z * (z2 + 1.0) / 4.0;
    let g2 = z * (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / 96.0;
    let g3 = z * (3.0 * z2 * z2 * z2 + 19.0 * z2 * z2 + 17.0 * z2 - 15.0) / 384.0;
    let g4 = z * (79.0 * z2 * z2 * z2 * z2 + 776.0 * z2 * z2 * z2 + 1482.0 * z2 * z2 - 1920.0 * z2 - 945.0) / 92_160.0;
    z + (g1 + (g2 + (g3 + g4 / n) / n) / n) / n
}

#[cfg(test)]
mod tests {
    use super::t_975;

    #[test]
    fn val_published_quantiles() {
        for (degrees, wanted) in [
            (1, 12.706_205),
            (4, 2.776_445),
            (10, 2.228_139),
            (11, 2.200_985),
            (12, 2.178_813),
            (20, 2.085_963),
            (30, 2.042_272),
            (120, 1.979_930),
        ] {
            assert!((t_975(degrees) - wanted).abs() < 2e-5, "{degrees}: {}", t_975(degrees));
        }
    }

    #[test]
    fn law_more_seeds_narrow_the_interval() {
        for degrees in 1..200 {
            assert!(t_975(degrees + 1) < t_975(degrees), "{degrees}");
        }
    }
}
