//! Random numbers that are a function of where they stand: no state, so any row can be drawn first, or alone.
//!
//! The generator is SplitMix64 (Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014), read
//! as what it is: a counter times an odd constant, then a mixing function. Its i-th output is computed directly. A crate
//! was not taken for these ten lines: generators with a stable output and a free choice of position (`rand_chacha`) cost
//! more per number than the rest of a row.
//!
//! Each stream is keyed by the seed and a name, so that a key of the scenario draws the same values whatever else varies.
//! Checked by the tests below and by the published outputs of SplitMix64.

/// The odd constant of SplitMix64, 2^64 divided by the golden ratio.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Bits of a number in the unit interval: with half a step added, every number is exact and neither 0 nor 1.
pub(super) const BITS: u32 = 52;

/// A sequence of random numbers with free choice of position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stream(u64);

impl Stream {
    /// The stream of a name.
    pub(super) fn new(seed: u64, name: &str) -> Self {
        name.bytes().fold(Self(mixed(seed.wrapping_add(GAMMA))), |stream, byte| stream.split(u64::from(byte)))
    }

    /// A separate random stream for a number.
    pub(super) fn split(self, number: u64) -> Self {
        Self(self.bits(number))
    }

    /// 64 random bits at a position.
    pub(super) fn bits(self, position: u64) -> u64 {
        mixed(self.0.wrapping_add(position.wrapping_add(1).wrapping_mul(GAMMA)))
    }

    /// A number above 0 and below 1.
    pub(super) fn unit(self, position: u64) -> f64 {
        unit(self.bits(position) >> (64 - BITS))
    }
}

/// The middle of a step of the unit interval, which has 2^52 of them.
pub(super) fn unit(step: u64) -> f64 {
    (step as f64 + 0.5) / (1_u64 << BITS) as f64
}

/// The mixing function of SplitMix64, one to one.
fn mixed(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The outputs that the authors' reference program prints for the seed 1234567.
    #[test]
    fn agrees_with_the_published_generator() {
        let stream = Stream(1_234_567);
        let published = [6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431];
        assert_eq!([0, 1, 2, 3].map(|position| stream.bits(position)), published);
    }

    #[test]
    fn the_unit_interval_is_open() {
        assert!(unit(0) > 0.0);
        assert!(unit((1 << BITS) - 1) < 1.0);
        assert_eq!(unit((1 << BITS) - 1) + unit(0), 1.0);
    }

    /// Mean and variance of the uniform distribution, each within five standard errors, and no correlation of streams.
    #[test]
    fn streams_are_uniform_and_apart() {
        let (a, b) = (Stream::new(1, "load.mass"), Stream::new(1, "load.gravity"));
        let count = 100_000_u32;
        let pairs: Vec<(f64, f64)> = (0..u64::from(count)).map(|i| (a.unit(i) - 0.5, b.unit(i) - 0.5)).collect();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / f64::from(count);
        let error = 5.0 / f64::from(count).sqrt();
        assert!(mean(&|pair| pair.0).abs() < error / 12_f64.sqrt());
        assert!((mean(&|pair| pair.0 * pair.0) - 1.0 / 12.0).abs() < error / 180_f64.sqrt());
        assert!(mean(&|pair| pair.0 * pair.1).abs() < error / 12.0);
    }
}
