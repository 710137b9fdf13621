//! The static characteristic of a muscle: a braid, the law of its force, its wall and its bladder.
//!
//! ```text
//! F = F_law(L, P_g) + F_bladder(L)
//! V = the braid's volume, less the wall's
//! ```
//!
//! The air needs a volume whatever the law, so the braid stands beside it. Virtual work, `F = −P_g dV/dL`, ties the two
//! together for the ideal braid, with or without a wall; bladder and membrane add an energy of their own. The other laws are
//! measured forces, or fitted ones, that follow no volume: over a cycle in pressure and length they take another work from
//! the muscle than the air puts in.
//!
//! | law | parameters | gradient of `P_g V` |
//! |---|---|---|
//! | [`Law::IdealBraid`] | the braid's | yes |
//! | [`Law::TonduLopez`] | end factor; a, b, r₀ | with `k = 1` and the braid's coefficients |
//! | [`Law::Sarosi`] | six coefficients | no |
//! | [`Law::MartensBoblan`] | membrane: thickness, modulus | yes, and the membrane's energy |
//! | [`Law::ExtensibleBraid`] | stiffness of the threads | with a volume of its own, which depends on pressure |
//! | [`Law::Bolen`] | largest force, pressure and contraction; shape | no |
//! | `Law::Map` | measured tensions | no |
//!
//! Checked by `tests/laws.rs`.

#[cfg(feature = "alloc")]
use super::ForceMap;
use super::{
    Bladder, Bolen, ExtensibleBraid, IdealBraid, MartensBoblan, Sarosi, StaticForce, Statics, TonduLopez, Wall,
};
use crate::braid::Braid;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar, Work};

/// A law of static force; rigs of one law are stepped together in a batch.
#[derive(Clone, Debug, PartialEq)]
pub enum Law<S = f64> {
    /// Virtual work of the gas on the braid.
    IdealBraid,
    /// A factor for the taper of the ends.
    TonduLopez(TonduLopez<S>),
    /// Six coefficients.
    Sarosi(Sarosi<S>),
    /// The ideal braid in a rubber membrane.
    MartensBoblan(MartensBoblan<S>),
    /// A braid whose threads stretch.
    ExtensibleBraid(ExtensibleBraid<S>),
    /// A normalized surface.
    Bolen(Bolen<S>),
    /// A measured force map.
    #[cfg(feature = "alloc")]
    Map(ForceMap<S>),
}

/// A piece of a law that is made of pieces, by length and by gauge pressure; 0 and 0 for one that is not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Piece {
    /// Along the length.
    pub length: usize,
    /// Along the gauge pressure.
    pub pressure: usize,
}

/// A law on a braid, with a wall and a bladder if they count.
#[derive(Clone, Debug, PartialEq)]
pub struct Characteristic<S = f64> {
    /// The braid's geometry.
    pub braid: Braid<S>,
    /// What makes it more than the ideal braid: one test tells.
    beyond: Option<Beyond<S>>,
}

/// A law with a wall and a bladder of which at least one is not the ideal braid's.
#[derive(Clone, Debug, PartialEq)]
struct Beyond<S> {
    law: Law<S>,
    wall: Option<Wall<S>>,
    bladder: Option<Bladder<S>>,
}

impl Characteristic {
    /// A law on a braid without wall or bladder.
    pub fn new(braid: Braid, law: Law) -> Self {
        Self::assemble(braid, law, None, None)
    }

    fn assemble(braid: Braid, law: Law, wall: Option<Wall>, bladder: Option<Bladder>) -> Self {
        let is_ideal = law == Law::IdealBraid && wall.is_none() && bladder.is_none();
        Self { braid, beyond: (!is_ideal).then_some(Beyond { law, wall, bladder }) }
    }

    /// The same with a wall of `thickness` (m) whose bore is open up to `max_length` (m); the volume is the gas's, and so
    /// is the force of the ideal braid. None, if the thickness is zero.
    ///
    /// # Errors
    /// As [`Wall::new`].
    pub fn with_wall(self, thickness: f64, max_length: f64) -> Result<Self, Error> {
        let wall = Wall::new(thickness, &self.braid, max_length)?;
        let wall = (thickness > 0.0).then_some(wall);
        Ok(Self::assemble(self.braid, self.law().clone(), wall, self.bladder().copied()))
    }

    /// The same with a bladder.
    pub fn with_bladder(self, bladder: Bladder) -> Self {
        Self::assemble(self.braid, self.law().clone(), self.wall().copied(), Some(bladder))
    }
}

impl<S> From<IdealBraid<S>> for Characteristic<S> {
    fn from(ideal: IdealBraid<S>) -> Self {
        Self { braid: ideal.braid, beyond: None }
    }
}

impl<S: Scalar> Characteristic<S> {
    /// The same over another scalar.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Characteristic<T> {
        let braid = self.braid.convert(convert);
        let beyond = self.beyond.as_ref().map(|Beyond { law, wall, bladder }| Beyond {
            law: match law {
                Law::IdealBraid => Law::IdealBraid,
                Law::TonduLopez(law) => Law::TonduLopez(law.convert(&braid, convert)),
                Law::Sarosi(law) => Law::Sarosi(law.convert(convert)),
                Law::MartensBoblan(law) => Law::MartensBoblan(law.convert(&braid, convert)),
                Law::ExtensibleBraid(law) => Law::ExtensibleBraid(law.convert(&braid, convert)),
                Law::Bolen(law) => Law::Bolen(law.convert(convert)),
                #[cfg(feature = "alloc")]
                Law::Map(map) => Law::Map(map.convert(convert)),
            },
            wall: wall.map(|wall| wall.convert(&braid, convert)),
            bladder: bladder.map(|bladder| bladder.convert(convert)),
        });
        Characteristic { braid, beyond }
    }

    /// The law.
    pub fn law(&self) -> &Law<S> {
        self.beyond.as_ref().map_or(&Law::IdealBraid, |beyond| &beyond.law)
    }

    /// The wall, if it counts.
    #[inline(always)]
    pub fn wall(&self) -> Option<&Wall<S>> {
        self.beyond.as_ref().and_then(|beyond| beyond.wall.as_ref())
    }

    /// The bladder, if it counts.
    pub fn bladder(&self) -> Option<&Bladder<S>> {
        self.beyond.as_ref().and_then(|beyond| beyond.bladder.as_ref())
    }

    /// What the end length is, by the key of the parameter where there is one.
    pub(crate) fn end_name(&self) -> &'static str {
        match self.wall() {
            None => parameter::THREAD_LENGTH.key,
            Some(_) => "the length at which the wall closes the bore",
        }
    }

    /// The ideal braid, if there is nothing else.
    pub fn ideal(&self) -> Option<IdealBraid<S>> {
        self.beyond.is_none().then_some(IdealBraid { braid: self.braid })
    }

    /// The force in N by the formula of one piece of the law, smoothly continued beyond the piece's bounds.
    #[inline(always)]
    #[cfg_attr(not(feature = "alloc"), expect(unused_variables, reason = "only a map has pieces"))]
    pub fn force_in_piece<T: Over<S>>(&self, piece: Piece, length: T, gauge: GaugePressure<T>) -> T {
        match &self.beyond {
            #[cfg(feature = "alloc")]
            Some(Beyond { law: Law::Map(map), bladder, .. }) => {
                let force = map.in_piece(piece, length, gauge);
                bladder.as_ref().map_or(force, |bladder| force + bladder.tension(length))
            }
            _ => self.force(length, gauge),
        }
    }

    /// Lengths in m between which a piece of the law holds; `None` where it has no end.
    #[cfg_attr(not(feature = "alloc"), expect(unused_variables, reason = "only a map has pieces"))]
    pub fn length_bounds(&self, piece: usize) -> (Option<S>, Option<S>) {
        match self.law() {
            #[cfg(feature = "alloc")]
            Law::Map(map) => map.length_bounds(piece),
            _ => (None, None),
        }
    }

    /// Gauge pressures in Pa between which a piece of the law holds; `None` where it has no end.
    #[cfg_attr(not(feature = "alloc"), expect(unused_variables, reason = "only a map has pieces"))]
    pub fn pressure_bounds(&self, piece: usize) -> (Option<S>, Option<S>) {
        match self.law() {
            #[cfg(feature = "alloc")]
            Law::Map(map) => map.pressure_bounds(piece),
            _ => (None, None),
        }
    }

    /// Energy in J that the rubber holds at a length in m: the bladder, and the membrane of a law that has one.
    pub fn stored_energy<T: Over<S>>(&self, length: T) -> T {
        let membrane = match self.law() {
            Law::MartensBoblan(law) => law.stored_energy(length),
            _ => T::zero(),
        };
        membrane + self.bladder().map_or(T::zero(), |bladder| bladder.stored_energy(length))
    }

    /// Force in N by virtual work of the gas: on the braid, or inside its wall.
    #[inline(always)]
    fn gas_force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        match self.wall() {
            None => IdealBraid { braid: self.braid }.force(length, gauge),
            Some(wall) => -gauge.0 * wall.volume_slope(&self.braid, length),
        }
    }

    /// The secant of that force over length in N/m.
    #[inline(always)]
    fn gas_secant<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        match self.wall() {
            None => IdealBraid { braid: self.braid }.secant_stiffness(length, from, gauge),
            Some(wall) => -gauge.0 * wall.slope_secant(&self.braid, length, from),
        }
    }
}

impl<S: Scalar> StaticForce<S> for Characteristic<S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        match &self.beyond {
            None => IdealBraid { braid: self.braid }.force(length, gauge),
            Some(beyond) => T::apart(Force { statics: self, beyond, length, gauge }),
        }
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        match &self.beyond {
            None => IdealBraid { braid: self.braid }.secant_stiffness(length, from, gauge),
            Some(beyond) => T::apart(Secant { statics: self, beyond, length, from, gauge }),
        }
    }
}

/// The force of what is more than the ideal braid.
struct Force<'a, S, T> {
    statics: &'a Characteristic<S>,
    beyond: &'a Beyond<S>,
    length: T,
    gauge: GaugePressure<T>,
}

impl<S: Scalar, T: Over<S>> Work for Force<'_, S, T> {
    type Output = T;
    #[inline(always)]
    fn done(self) -> T {
        let Self { statics, beyond, length, gauge } = self;
        let force = match &beyond.law {
            Law::IdealBraid => statics.gas_force(length, gauge),
            Law::MartensBoblan(law) => statics.gas_force(length, gauge) + law.membrane(length),
            Law::TonduLopez(law) => law.force(length, gauge),
            Law::Sarosi(law) => law.force(length, gauge),
            Law::ExtensibleBraid(law) => law.force(length, gauge),
            Law::Bolen(law) => law.force(length, gauge),
            #[cfg(feature = "alloc")]
            Law::Map(map) => map.force(length, gauge),
        };
        match &beyond.bladder {
            None => force,
            Some(bladder) => force + bladder.tension(length),
        }
    }
}

/// The secant of that force.
struct Secant<'a, S, T> {
    statics: &'a Characteristic<S>,
    beyond: &'a Beyond<S>,
    length: T,
    from: T,
    gauge: GaugePressure<T>,
}

impl<S: Scalar, T: Over<S>> Work for Secant<'_, S, T> {
    type Output = T;
    #[inline(always)]
    fn done(self) -> T {
        let Self { statics, beyond, length, from, gauge } = self;
        let stiffness = match &beyond.law {
            Law::IdealBraid => statics.gas_secant(length, from, gauge),
            Law::MartensBoblan(law) => statics.gas_secant(length, from, gauge) + law.membrane_secant(length, from),
            Law::TonduLopez(law) => law.secant_stiffness(length, from, gauge),
            Law::Sarosi(law) => law.secant_stiffness(length, from, gauge),
            Law::ExtensibleBraid(law) => law.secant_stiffness(length, from, gauge),
            Law::Bolen(law) => law.secant_stiffness(length, from, gauge),
            #[cfg(feature = "alloc")]
            Law::Map(map) => map.secant_stiffness(length, from, gauge),
        };
        match &beyond.bladder {
            None => stiffness,
            Some(bladder) => stiffness + bladder.secant_stiffness(length, from),
        }
    }
}

/// What the wall leaves of the braid's volume, and its slope.
struct Bore<'a, S, T> {
    braid: &'a Braid<S>,
    wall: &'a Wall<S>,
    length: T,
}

impl<S: Scalar, T: Over<S>> Work for Bore<'_, S, T> {
    type Output = [T; 2];
    #[inline(always)]
    fn done(self) -> [T; 2] {
        let Self { braid, wall, length } = self;
        [wall.volume(braid, length), wall.volume_slope(braid, length)]
    }
}

impl<S: Scalar> Statics<S> for Characteristic<S> {
    /// The braid is straight, or the wall has closed the bore.
    #[inline(always)]
    fn end_length(&self) -> S {
        self.wall().map_or(self.braid.thread_length(), Wall::closed_length)
    }

    #[inline(always)]
    fn volume_and_slope<T: Over<S>>(&self, length: T) -> [T; 2] {
        match self.wall() {
            None => IdealBraid { braid: self.braid }.volume_and_slope(length),
            Some(wall) => T::apart(Bore { braid: &self.braid, wall, length }),
        }
    }
}
