//! A random permutation of 0 .. n whose value at one index costs the same whatever n is.
//!
//! A Feistel network on pairs of digits in base a = ⌈√n⌉ permutes 0 .. a², with a keyed random function in each round;
//! an image at or above n is permuted again until it falls below ("cycle walking"). Source: J. Black and P. Rogaway,
//! "Ciphers with arbitrary finite domains", CT-RSA 2002. As a² < n + 2√n + 1, a second walk is rare. The crates that
//! permute so bring ciphers with them.
//!
//! Checked by the tests below: one to one for every n, and no place preferred.

use super::random::Stream;

/// Rounds of the network; small domains need more than the four that suffice for large ones.
const ROUNDS: usize = 8;

/// A permutation of the numbers below a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Permutation {
    length: u64,
    base: u64,
    rounds: [Stream; ROUNDS],
}

impl Permutation {
    /// A permutation of 0 .. `length`, which is at least 1.
    pub(super) fn new(length: u64, key: Stream) -> Self {
        let root = length.isqrt();
        let mut rounds = [key; ROUNDS];
        rounds.iter_mut().zip(0..).for_each(|(round, number)| *round = key.split(number));
        Self { length, base: root + u64::from(root * root < length), rounds }
    }

    /// Where `index`, which is below the length, goes.
    pub(super) fn at(&self, index: u64) -> u64 {
        let mut image = self.walked(index);
        while image >= self.length {
            image = self.walked(image);
        }
        image
    }

    fn walked(&self, index: u64) -> u64 {
        let (mut left, mut right) = (index / self.base, index % self.base);
        for round in self.rounds {
            // The high half of the product is a digit, as a remainder would be, without a division.
            let added = (u128::from(round.bits(right)) * u128::from(self.base)) >> 64;
            let sum = left + added as u64;
            (left, right) = (right, if sum < self.base { sum } else { sum - self.base });
        }
        left * self.base + right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_one_to_one() {
        for length in (1..200).chain([1000, 4096, 65_537]) {
            let permutation = Permutation::new(length, Stream::new(3, "load.mass"));
            let mut seen = vec![false; length as usize];
            for index in 0..length {
                let image = permutation.at(index) as usize;
                assert!(!std::mem::replace(&mut seen[image], true), "{length}: {image} twice");
            }
        }
    }

    /// Over many seeds each index goes to each place equally often: chi-square with 36 degrees of freedom, of which one
    /// in a million exceeds 96.
    #[test]
    fn prefers_no_place() {
        let (length, seeds) = (7_u64, 7000);
        let mut counts = [[0.0; 7]; 7];
        for seed in 0..seeds {
            let permutation = Permutation::new(length, Stream::new(seed, ""));
            for index in 0..length {
                counts[index as usize][permutation.at(index) as usize] += 1.0;
            }
        }
        let expected = seeds as f64 / length as f64;
        let chi_square: f64 =
            counts.iter().flatten().map(|count| (count - expected) * (count - expected) / expected).sum();
        assert!(chi_square < 96.0, "{chi_square}");
    }
}
