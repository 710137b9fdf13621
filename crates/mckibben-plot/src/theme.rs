//! Colours: a light and a dark set, and one document that holds both.
//!
//! The seven categories on white are those of Okabe and Ito without their yellow, which white swallows, and with the
//! colour of text for their black. The dark set keeps the hues and raises the lightness until each stands out from the
//! background. The ramp runs from dark to light on white and the other way on dark, always away from the background
//! at its end, with lightness in one direction so that it survives a grey copy.

use super::scene::Ink;

/// How many colours there are before they repeat.
pub(super) const CATEGORIES: usize = 7;

/// The background that a figure is made for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// White paper.
    #[default]
    Light,
    /// A dark screen.
    Dark,
    /// Both in one SVG: the reader's `prefers-color-scheme` decides. Where that is not understood, light.
    Auto,
}

pub(super) type Rgb = [u8; 3];

/// The colour of an ink, in sRGB.
pub(super) fn colour(ink: Ink, dark: bool) -> Rgb {
    let [light, night] = match ink {
        Ink::Background => [[0xff, 0xff, 0xff], [0x14, 0x18, 0x1d]],
        Ink::Text => [[0x1c, 0x1c, 0x1e], [0xec, 0xee, 0xf0]],
        Ink::Muted => [[0x5c, 0x61, 0x66], [0xa6, 0xad, 0xb4]],
        Ink::Axis => [[0x55, 0x58, 0x5c], [0x8f, 0x96, 0x9d]],
        Ink::Grid => [[0xe2, 0xe4, 0xe6], [0x2b, 0x31, 0x38]],
        Ink::Category(index) => match index % CATEGORIES {
            0 => [[0x00, 0x72, 0xb2], [0x3f, 0xa2, 0xe6]],
            1 => [[0xd5, 0x5e, 0x00], [0xf5, 0x8a, 0x3c]],
            2 => [[0x00, 0x9e, 0x73], [0x2f, 0xc8, 0x9c]],
            3 => [[0xcc, 0x79, 0xa7], [0xe6, 0x9f, 0xc6]],
            4 => [[0xe6, 0x9f, 0x00], [0xf2, 0xd0, 0x4c]],
            5 => [[0x56, 0xb4, 0xe9], [0x9a, 0xd8, 0xf8]],
            _ => [[0x1c, 0x1c, 0x1e], [0xec, 0xee, 0xf0]],
        },
        Ink::Scale(place) => [super::scale::colour(place); 2],
        Ink::Diverging(place) => [super::scale::diverging(place); 2],
        Ink::Ramp(place) => [ramp(&RAMP_LIGHT, place), ramp(&RAMP_DARK, place)],
    };
    if dark { night } else { light }
}

/// Pale to deep on white.
const RAMP_LIGHT: [Rgb; 5] =
    [[0x8e, 0xc7, 0x3d], [0x2f, 0xa5, 0x6b], [0x1f, 0x7d, 0x8c], [0x3a, 0x4c, 0x8a], [0x3f, 0x0f, 0x52]];
/// Deep to pale on dark.
const RAMP_DARK: [Rgb; 5] =
    [[0x6d, 0x55, 0xc4], [0x3f, 0x83, 0xd1], [0x1f, 0xaa, 0xa8], [0x6c, 0xcf, 0x6a], [0xf4, 0xe6, 0x5a]];

fn ramp(keys: &[Rgb; 5], place: u8) -> Rgb {
    let t = f64::from(place) / 255.0 * 4.0;
    let (i, f) = ((t as usize).min(3), t - t.floor().min(3.0));
    let mix = |c: usize| (f64::from(keys[i][c]) * (1.0 - f) + f64::from(keys[i + 1][c]) * f).round() as u8;
    [mix(0), mix(1), mix(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance and contrast as WCAG 2 defines them.
    fn contrast(a: Rgb, b: Rgb) -> f64 {
        let luminance = |rgb: Rgb| {
            let linear = rgb.map(|c| match f64::from(c) / 255.0 {
                c if c <= 0.04045 => c / 12.92,
                c => ((c + 0.055) / 1.055).powf(2.4),
            });
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2] + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn words_stand_out_and_lines_can_be_seen() {
        for dark in [false, true] {
            let ground = colour(Ink::Background, dark);
            assert!(contrast(colour(Ink::Text, dark), ground) > 12.0);
            assert!(contrast(colour(Ink::Muted, dark), ground) > 4.5);
            for index in 0..CATEGORIES {
                let seen = contrast(colour(Ink::Category(index), dark), ground);
                assert!(seen > 2.0, "category {index}, dark {dark}: {seen}");
            }
        }
    }

    #[test]
    fn the_ramp_keeps_one_direction_of_lightness() {
        for dark in [false, true] {
            let ground = colour(Ink::Background, dark);
            let seen: Vec<f64> = (0..=255).map(|i| contrast(colour(Ink::Ramp(i), dark), ground)).collect();
            assert!(seen[0] > 1.9, "{}", seen[0]);
            assert!(seen.windows(2).all(|w| w[1] > w[0] - 0.06));
        }
    }
}
