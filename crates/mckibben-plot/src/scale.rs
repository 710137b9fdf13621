//! The colour scales of a field: equal steps of the value are equal steps of what is seen.
//!
//! Values of two signs have a scale of two hues, blue below zero and red above, that meet in a light grey at zero. Others have a
//! helix in Oklab, the colour space of B. Ottosson ("A perceptual color space for image processing", 2020): lightness
//! rises and hue turns from violet over blue and green to yellow, both in proportion to the value, at one chroma that
//! sRGB has all along the way. The distance of neighbours is then the same everywhere, and a grey copy keeps the order.
//!
//! Checked by the tests below.

use super::theme::Rgb;

/// Lightness at the ends.
const LIGHTNESS: [f64; 2] = [0.27, 0.93];
/// Hue at the ends in degrees.
const HUE: [f64; 2] = [300.0, 105.0];
/// Chroma.
const CHROMA: f64 = 0.097;

/// Lightness at the middle and at the ends of the diverging scale, chroma at its ends, and the hues of both sides in degrees.
const DIVERGING: ([f64; 2], f64, [f64; 2]) = ([0.95, 0.42], 0.115, [255.0, 35.0]);

/// The colour of a place from 0 to 255 where the values have one sign.
pub(super) fn colour(place: u8) -> Rgb {
    encoded(linear(f64::from(place) / 255.0))
}

/// The colour of a place from 0 to 255 where the values have two signs.
pub(super) fn diverging(place: u8) -> Rgb {
    encoded(linear_diverging(f64::from(place) / 255.0))
}

/// Linear sRGB at a place from 0 to 1 of the diverging scale.
fn linear_diverging(t: f64) -> [f64; 3] {
    let ([middle, end], chroma, hues) = DIVERGING;
    let (away, hue) = ((2.0 * t - 1.0).abs(), if t < 0.5 { hues[0] } else { hues[1] });
    oklab(middle + away * (end - middle), away * chroma, hue.to_radians())
}

fn encoded(light: [f64; 3]) -> Rgb {
    light.map(|light| {
        let light = light.clamp(0.0, 1.0);
        let encoded = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    })
}

/// Linear sRGB at a place from 0 to 1.
fn linear(t: f64) -> [f64; 3] {
    let between = |[from, to]: [f64; 2]| from + t * (to - from);
    let (lightness, hue) = (between(LIGHTNESS), between(HUE).to_radians());
    oklab(lightness, CHROMA, hue)
}

/// Linear sRGB of a colour in Oklab, its hue in rad.
fn oklab(lightness: f64, chroma: f64, hue: f64) -> [f64; 3] {
    let (a, b) = (chroma * hue.cos(), chroma * hue.sin());
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_has_every_colour() {
        for place in 0..=255u8 {
            let light = linear(f64::from(place) / 255.0);
            assert!(light.iter().all(|light| (-1e-3..=1.001).contains(light)), "{place}: {light:?}");
            let light = linear_diverging(f64::from(place) / 255.0);
            assert!(light.iter().all(|light| (-1e-3..=1.001).contains(light)), "{place}: {light:?}");
        }
    }

    /// CIE 1976 L*a*b* under D65, from eight-bit sRGB: another space than the one the scale is made in.
    fn lab(rgb: Rgb) -> [f64; 3] {
        let [r, g, b] = rgb.map(|c| match f64::from(c) / 255.0 {
            c if c <= 0.04045 => c / 12.92,
            c => ((c + 0.055) / 1.055).powf(2.4),
        });
        let x = (0.412_4 * r + 0.357_6 * g + 0.180_5 * b) / 0.950_47;
        let y = 0.212_6 * r + 0.715_2 * g + 0.072_2 * b;
        let z = (0.019_3 * r + 0.119_2 * g + 0.950_5 * b) / 1.088_83;
        let f = |t: f64| if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 };
        [116.0 * f(y) - 16.0, 500.0 * (f(x) - f(y)), 200.0 * (f(y) - f(z))]
    }

    #[test]
    fn lightness_rises_and_steps_are_even() {
        let seen: Vec<[f64; 3]> = (0..=15).map(|i| lab(colour(i * 17))).collect();
        assert!(seen[0][0] < 25.0 && seen[15][0] > 88.0, "{seen:?}");
        let steps: Vec<f64> = seen
            .windows(2)
            .map(|w| {
                assert!(w[1][0] > w[0][0] + 2.0, "{w:?}");
                (0..3).map(|c| (w[1][c] - w[0][c]).powi(2)).sum::<f64>().sqrt()
            })
            .collect();
        let (least, greatest) = steps.iter().fold((f64::MAX, 0.0_f64), |(l, g), s| (l.min(*s), g.max(*s)));
        assert!(greatest < 2.0 * least, "{steps:?}");
    }

    #[test]
    fn the_diverging_scale_is_lightest_in_the_middle_and_falls_alike_to_both_sides() {
        let light = |place: u8| lab(diverging(place))[0];
        assert!(light(127) > 92.0 && light(128) > 92.0);
        for step in (0..=112u8).step_by(16) {
            let (low, high) = (light(127 - step), light(128 + step));
            assert!((low - high).abs() < 6.0, "{step}: {low} {high}");
            assert!(light(127 - step - 15) < low && light(128 + step + 15) < high, "{step}");
        }
    }
}
