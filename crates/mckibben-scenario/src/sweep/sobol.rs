//! The Sobol' sequence, any point at once, with nested uniform scrambling.
//!
//! In each dimension the n-th point is the exclusive or of the direction vectors that the bits of the Gray code of n pick
//! (Antonov & Saleev, 1979), which is the order of the usual programs. The vectors follow from a few numbers by the
//! recurrence of the dimension's primitive polynomial (Bratley & Fox, "Algorithm 659", ACM TOMS 14, 1988); those are in
//! [`super::directions`].
//!
//! Scrambling is Owen's ("Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995): each binary digit is flipped or not
//! by a random bit that depends on the digits before it. Every point is then uniform over the unit interval, and every
//! stratum that held one point holds one still. The random bits are a function of the digits, so nothing is stored.
//!
//! Checked by the tests below: the unscrambled points are those of SciPy, and every power of two of points, scrambled or
//! not, has one point in each of as many intervals.

use super::directions::JOE_KUO;
use super::random::{BITS, Stream, unit};

/// How many dimensions there are.
pub(super) const DIMENSIONS: usize = JOE_KUO.len() + 1;

/// One dimension of the sequence.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dimension {
    vectors: [u64; BITS as usize],
    flips: Stream,
}

impl Dimension {
    /// A dimension counted from 0; `None` where the table of direction numbers ends.
    pub(super) fn new(dimension: usize, flips: Stream) -> Option<Self> {
        let mut vectors = [0; BITS as usize];
        let Some(before) = dimension.checked_sub(1) else {
            vectors.iter_mut().zip(1..).for_each(|(vector, digit)| *vector = 1 << (BITS - digit));
            return Some(Self { vectors, flips });
        };
        let (coefficients, first) = JOE_KUO.get(before)?;
        let degree = first.len();
        for i in 0..vectors.len() {
            vectors[i] = match first.get(i) {
                Some(number) => number << (BITS as usize - 1 - i),
                None => (1..degree).fold(vectors[i - degree] ^ (vectors[i - degree] >> degree), |vector, k| {
                    let taken = (coefficients >> (degree - 1 - k)) & 1;
                    vector ^ (taken * vectors[i - k])
                }),
            };
        }
        Some(Self { vectors, flips })
    }

    /// The number above 0 and below 1 of a point.
    pub(super) fn at(&self, point: u64) -> f64 {
        unit(self.scrambled(self.digits(point)))
    }

    /// The binary digits of the sequence's own number, the first of them highest.
    fn digits(&self, point: u64) -> u64 {
        let gray = point ^ (point >> 1);
        self.vectors
            .iter()
            .enumerate()
            .filter(|(bit, _)| (gray >> bit) & 1 == 1)
            .fold(0, |sum, (_, vector)| sum ^ vector)
    }

    fn scrambled(&self, digits: u64) -> u64 {
        (0..BITS).fold(digits, |scrambled, place| {
            let shift = BITS - 1 - place;
            // The digits before this one, after a one that distinguishes 01 from 001.
            let before = (digits >> shift >> 1) | (1 << place);
            scrambled ^ ((self.flips.bits(before) >> 63) << shift)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOST: usize = DIMENSIONS;

    fn dimension(of: usize) -> Dimension {
        Dimension::new(of, Stream::new(7, "")).expect("a dimension")
    }

    /// `scipy.stats.qmc.Sobol(d=96, scramble=False).random(1024)` of SciPy 1.17.1, in units of 2^-30.
    #[test]
    fn unscrambled_points_are_those_of_scipy() {
        let rows: &[(u64, [u64; 7])] = &[
            (0, [0, 0, 0, 0, 0, 0, 0]),
            (1, [536870912, 536870912, 536870912, 536870912, 536870912, 536870912, 536870912]),
            (2, [805306368, 268435456, 268435456, 268435456, 268435456, 805306368, 268435456]),
            (3, [268435456, 805306368, 805306368, 805306368, 805306368, 268435456, 805306368]),
            (4, [402653184, 402653184, 671088640, 134217728, 939524096, 134217728, 134217728]),
            (5, [939524096, 939524096, 134217728, 671088640, 402653184, 671088640, 671088640]),
            (100, [444596224, 276824064, 830472192, 360710144, 763363328, 696254464, 713031680]),
            (511, [2097152, 538968064, 438304768, 140509184, 664797184, 538968064, 446693376]),
            (777, [743440384, 1005584384, 175112192, 808452096, 774897664, 458227712, 170917888]),
            (1023, [1048576, 808452096, 657457152, 342884352, 678428672, 42991616, 24117248]),
        ];
        for (point, expected) in rows {
            for (of, expected) in [0, 1, 2, 19, 40, 63, 95].into_iter().zip(expected) {
                assert_eq!(dimension(of).digits(*point), expected << (BITS - 30), "point {point}, dimension {of}");
            }
        }
    }

    #[test]
    fn the_last_dimension_is_the_last() {
        assert!(Dimension::new(MOST - 1, Stream::new(7, "")).is_some());
        assert!(Dimension::new(MOST, Stream::new(7, "")).is_none());
    }

    /// Each of 2^m intervals holds one of each 2^m points that begin at a multiple of 2^m.
    #[test]
    fn every_dimension_is_stratified_scrambled_or_not() {
        for of in 0..MOST {
            let dimension = dimension(of);
            for (first, m) in [(0, 1), (0, 5), (0, 10), (3072, 10)] {
                let mut seen = vec![[false; 2]; 1 << m];
                for point in first..first + (1 << m) {
                    let digits = dimension.digits(point);
                    for (which, digits) in [digits, dimension.scrambled(digits)].into_iter().enumerate() {
                        let place = (digits >> (BITS - m)) as usize;
                        assert!(!std::mem::replace(&mut seen[place][which], true), "dimension {of}, 2^{m} points");
                    }
                }
            }
        }
    }

    /// The first two dimensions are a (0, m, 2)-net: each elementary rectangle of area 2^-m holds one point.
    #[test]
    fn the_first_two_dimensions_are_a_net() {
        let (x, y) = (dimension(0), Dimension::new(1, Stream::new(8, "")).expect("a dimension"));
        let m = 8;
        for wide in 0..=m {
            let mut seen = vec![false; 1 << m];
            for point in 0..1 << m {
                let cell = |of: &Dimension, bits: u32| of.scrambled(of.digits(point)) >> (BITS - bits);
                let place = ((cell(&x, wide) << (m - wide)) | cell(&y, m - wide)) as usize;
                assert!(!std::mem::replace(&mut seen[place], true), "{wide}");
            }
        }
    }
}
