//! Viscoelastic branches: springs in series with dashpots in addition to the static force, so that the muscle creeps and relaxes.
//!
//! ```text
//! F_b = Σ (kᵢ + wᵢ k_sec⁺) (L − zᵢ)          dzᵢ/dt = (L − zᵢ)/τᵢ
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | kᵢ | `stiffness` of a branch | N/m |
//! | wᵢ | `stiffness_ratio`, its stiffness over the secant stiffness (13) | 1 |
//! | τᵢ | `relaxation_time` | s |
//! | zᵢ | length at which the spring of a branch is relaxed: a state | m |
//! | L(0) − zᵢ(0) | `initial_stretch`, zero for a relaxed branch | m |
//! | k_sec⁺ | secant stiffness (13), not below zero | N/m |
//!
//! A generalised Maxwell model (standard linear solid for one branch). At rest zᵢ = L and the branches add nothing, so that the
//! static law is the one of long times; a quick change of length meets the stiffness of all springs in addition. A branch
//! stores `½ k (L − z)²` and dissipates `k (L − z)²/τ`, never less than nothing. Where its stiffness follows the pressure, the
//! spring is loaded or unloaded by that, by `½ k̇ (L − z)²`, which the gas does not feel: the energy audit shows how much.
//!
//! Sources: Wiechert, Ann. Phys. 286 (1893); Findley, Lai & Onaran, "Creep and Relaxation of Nonlinear Viscoelastic Materials"
//! (1976), chapter 5. The scale by (13) is this project's. Checked by `tests/viscoelastic.rs`.

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// The largest number of viscoelastic branches.
pub const MAX_BRANCHES: usize = 6;

/// Springs in series with dashpots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscoelastic<S = f64> {
    count: usize,
    stiffness: [S; MAX_BRANCHES],
    stiffness_ratio: [S; MAX_BRANCHES],
    relaxation_time: [S; MAX_BRANCHES],
    /// Their reciprocals in 1/s.
    relaxation_rate: [S; MAX_BRANCHES],
    total: BranchSums<S>,
    initial_stretch: [S; MAX_BRANCHES],
}

/// Sums over the branches of an actuator, each branch with its stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchSums<T> {
    /// `Σ kᵢ zᵢ` in N and `Σ wᵢ zᵢ` in m.
    pub relaxed: [T; 2],
    /// The sums with each branch over its relaxation time, `Σ kᵢ zᵢ/τᵢ` in N/s and `Σ wᵢ zᵢ/τᵢ` in m/s.
    pub relaxing: [T; 2],
}

impl Viscoelastic {
    /// Branches by `stiffness` (N/m) and `stiffness_ratio`, both zero or more and added up, and `relaxation_time` (s), above
    /// zero. An empty list of stiffnesses or of ratios stands for zeros.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists differ in length, are empty or hold more than [`MAX_BRANCHES`]; [`Error::OutOfRange`] for
    /// a number outside its range.
    pub fn new(stiffness: &[f64], stiffness_ratio: &[f64], relaxation_time: &[f64]) -> Result<Self, Error> {
        let rows = [&parameter::BRANCH_STIFFNESS, &parameter::BRANCH_STIFFNESS_RATIO];
        let time_row = &parameter::BRANCH_RELAXATION_TIME;
        let fault = |name, problem, entry| {
            let remedy =
                "give 1 to 6 branches, each with its relaxation time and with its stiffness or its stiffness ratio";
            Err(Error::Table { name, problem, entry, remedy })
        };
        let count = relaxation_time.len();
        if count == 0 {
            return fault(time_row.key, "it has no entry", 1);
        }
        if count > MAX_BRANCHES {
            return fault(time_row.key, "it has too many entries", MAX_BRANCHES + 1);
        }
        if stiffness.is_empty() && stiffness_ratio.is_empty() {
            return fault(rows[1].key, "it has no entry, and there are no stiffnesses", 1);
        }
        let mut parts = [[0.0; MAX_BRANCHES]; 2];
        for ((row, given), numbers) in rows.iter().zip([stiffness, stiffness_ratio]).zip(&mut parts) {
            if !given.is_empty() && given.len() != count {
                return fault(row.key, "its length is not that of `relaxation_time`", given.len().min(count) + 1);
            }
            for (number, given) in numbers.iter_mut().zip(given) {
                *number = row.check(*given)?;
            }
        }
        let mut times = [1.0; MAX_BRANCHES];
        for (time, given) in times.iter_mut().zip(relaxation_time) {
            *time = time_row.check(*given)?;
        }
        let [stiffness, stiffness_ratio] = parts;
        Ok(Self::of(count, stiffness, stiffness_ratio, times))
    }

    /// Starts runs with springs that are stretched by so much in m, one entry for each branch, positive where it adds to the
    /// tension: the remainder of the history before. Without it, or with an empty list, branches start relaxed.
    ///
    /// # Errors
    /// [`Error::Table`] unless there is one entry for each branch, or none; [`Error::OutOfRange`] for one that is not finite.
    pub fn with_initial_stretch(mut self, stretch: &[f64]) -> Result<Self, Error> {
        let row = &parameter::BRANCH_INITIAL_STRETCH;
        if !stretch.is_empty() && stretch.len() != self.count {
            return Err(Error::Table {
                name: row.key,
                problem: "its length is not that of `relaxation_time`",
                entry: stretch.len().min(self.count) + 1,
                remedy: "give one stretch for each branch, or none",
            });
        }
        for (number, given) in self.initial_stretch.iter_mut().zip(stretch) {
            *number = row.check(*given)?;
        }
        Ok(self)
    }
}

impl<S: Scalar> Viscoelastic<S> {
    fn of(
        count: usize,
        stiffness: [S; MAX_BRANCHES],
        stiffness_ratio: [S; MAX_BRANCHES],
        relaxation_time: [S; MAX_BRANCHES],
    ) -> Self {
        let zeros = [S::zero(); 2];
        let total = BranchSums { relaxed: zeros, relaxing: zeros };
        let relaxation_rate = relaxation_time.map(|time| S::one() / time);
        let initial_stretch = [S::zero(); MAX_BRANCHES];
        let mut law =
            Self { count, stiffness, stiffness_ratio, relaxation_time, relaxation_rate, total, initial_stretch };
        law.total = law.sums(&[S::one(); MAX_BRANCHES][..count]);
        law
    }

    pub(super) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Viscoelastic<T> {
        let (mut stiffness, mut ratio) = ([T::zero(); MAX_BRANCHES], [T::zero(); MAX_BRANCHES]);
        let (mut time, mut initial_stretch) = ([T::one(); MAX_BRANCHES], [T::zero(); MAX_BRANCHES]);
        for i in 0..self.count {
            stiffness[i] = convert.parameter(&parameter::BRANCH_STIFFNESS, self.stiffness[i]);
            ratio[i] = convert.parameter(&parameter::BRANCH_STIFFNESS_RATIO, self.stiffness_ratio[i]);
            time[i] = convert.parameter(&parameter::BRANCH_RELAXATION_TIME, self.relaxation_time[i]);
            initial_stretch[i] = convert.parameter(&parameter::BRANCH_INITIAL_STRETCH, self.initial_stretch[i]);
        }
        let Some(mut carry) = convert.carry() else {
            return Viscoelastic { initial_stretch, ..Viscoelastic::of(self.count, stiffness, ratio, time) };
        };
        let mut relaxation_rate = [T::one(); MAX_BRANCHES];
        for i in 0..self.count {
            relaxation_rate[i] = carry(self.relaxation_rate[i]);
        }
        let BranchSums { relaxed, relaxing } = self.total;
        let total = BranchSums { relaxed: relaxed.map(&mut carry), relaxing: relaxing.map(&mut carry) };
        let (stiffness_ratio, relaxation_time) = (ratio, time);
        let count = self.count;
        Viscoelastic { count, stiffness, stiffness_ratio, relaxation_time, relaxation_rate, total, initial_stretch }
    }

    /// How many branches there are.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Stiffness kᵢ of a branch in N/m, in addition to that by its ratio.
    pub fn stiffness(&self, branch: usize) -> S {
        self.stiffness[branch]
    }

    /// Stiffness of a branch over the secant stiffness, wᵢ.
    pub fn stiffness_ratio(&self, branch: usize) -> S {
        self.stiffness_ratio[branch]
    }

    /// Relaxation time τᵢ of a branch in s.
    #[inline(always)]
    pub fn relaxation_time(&self, branch: usize) -> S {
        self.relaxation_time[branch]
    }

    /// Stretch in m of the spring of a branch at the start of a run.
    pub fn initial_stretch(&self, branch: usize) -> S {
        self.initial_stretch[branch]
    }

    /// The reciprocal of a relaxation time in 1/s.
    #[inline(always)]
    pub fn relaxation_rate(&self, branch: usize) -> S {
        self.relaxation_rate[branch]
    }

    /// Stiffness of a branch in N/m at a secant stiffness in N/m.
    #[inline(always)]
    pub fn stiffness_at<T: Over<S>>(&self, branch: usize, secant_stiffness: T) -> T {
        T::of(self.stiffness[branch]) + T::of(self.stiffness_ratio[branch]) * secant_stiffness
    }

    /// Sums over the branches with their relaxed lengths in m.
    #[inline(always)]
    pub fn sums<T: Over<S>>(&self, relaxed_lengths: &[T]) -> BranchSums<T> {
        // No iterators over arrays of numbers: they would be compiled separately, without the instructions of a batch.
        let [mut by_stiffness, mut by_ratio, mut by_stiffness_rate, mut by_ratio_rate] = [T::zero(); 4];
        let mut i = 0;
        while i < relaxed_lengths.len() {
            let [force, width] =
                [T::of(self.stiffness[i]) * relaxed_lengths[i], T::of(self.stiffness_ratio[i]) * relaxed_lengths[i]];
            let rate = T::of(self.relaxation_rate[i]);
            by_stiffness = by_stiffness + force;
            by_ratio = by_ratio + width;
            by_stiffness_rate = by_stiffness_rate + rate * force;
            by_ratio_rate = by_ratio_rate + rate * width;
            i += 1;
        }
        BranchSums { relaxed: [by_stiffness, by_ratio], relaxing: [by_stiffness_rate, by_ratio_rate] }
    }

    /// Force of the branches at an actuator length in m: `Σ kᵢ (L − zᵢ)` in N, and `Σ wᵢ (L − zᵢ)` in m, the force over the
    /// secant stiffness.
    #[inline(always)]
    pub(crate) fn forces<T: Over<S>>(&self, length: T, sums: &BranchSums<T>) -> [T; 2] {
        let [stiffness, ratio] = self.total.relaxed;
        [T::of(stiffness) * length - sums.relaxed[0], T::of(ratio) * length - sums.relaxed[1]]
    }

    /// How fast the first two sums change at an actuator length in m.
    #[inline(always)]
    pub fn sum_rates<T: Over<S>>(&self, length: T, sums: &BranchSums<T>) -> [T; 2] {
        let [stiffness, ratio] = self.total.relaxing;
        [T::of(stiffness) * length - sums.relaxing[0], T::of(ratio) * length - sums.relaxing[1]]
    }

    /// Rate in m/s of the relaxed length of a branch at an actuator length in m.
    #[inline(always)]
    pub fn rate<T: Over<S>>(&self, branch: usize, relaxed_length: T, length: T) -> T {
        (length - relaxed_length) * T::of(self.relaxation_rate[branch])
    }
}
