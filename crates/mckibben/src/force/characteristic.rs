//! The static characteristic of a muscle: a braid, the law of its force, its wall, its ends and its bladder.
//!
//! ```text
//! F = F_law(L, P_g) + F_bladder(L)
//! V = the braid's volume, less the wall's and what the ends lack of a cylinder
//! ```
//!
//! The air needs a volume whatever the law, so the braid is kept in addition to it. Virtual work, `F = −P_g dV/dL`,
//! ties the two together for the ideal braid, with or without wall and taper; bladder and membrane add an elastic
//! energy. The other laws are measured forces, or fitted ones, that follow no volume: over a cycle in pressure and
//! length they take another work from the muscle than the air puts in.
//!
//! | law | parameters | gradient of `P_g V` |
//! |---|---|---|
//! | [`Law::IdealBraid`] | the braid's | yes |
//! | [`Law::TonduLopez`] | end factor; a, b, r₀ | with `k = 1` and the braid's coefficients |
//! | [`Law::Sarosi`] | six coefficients | no |
//! | [`Law::MartensBoblan`] | membrane: thickness, modulus | yes, and the membrane's energy |
//! | [`Law::ExtensibleBraid`] | stiffness of the threads | with a separate volume, which depends on pressure |
//! | [`Law::Bolen`] | largest force, pressure and contraction; shape | no |
//! | [`Law::Polynomial`] | coefficients of pressure, and passive ones | with the ideal braid's; its passive part stores energy |
//! | `Law::Map` | measured tensions | no |
//!
//! Source: each law's own file. Checked by `tests/laws.rs`.

#[cfg(feature = "alloc")]
use super::ForceMap;
use super::{
    Bladder, Bolen, ExtensibleBraid, IdealBraid, MartensBoblan, Polynomial, Sarosi, StaticForce, Statics, Taper,
    TonduLopez, Wall,
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
    /// A surface polynomial in contraction.
    Polynomial(Polynomial<S>),
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

/// A law on a braid, with a wall, a taper and a bladder if they count.
#[derive(Clone, Debug, PartialEq)]
pub struct Characteristic<S = f64> {
    /// The braid's geometry.
    pub braid: Braid<S>,
    /// What makes it more than the ideal braid: one test decides.
    beyond: Option<Beyond<S>>,
}

/// A law with a wall, a taper and a bladder of which at least one is not the ideal braid's.
#[derive(Clone, Debug, PartialEq)]
struct Beyond<S> {
    law: Law<S>,
    wall: Option<Wall<S>>,
    taper: Option<Taper<S>>,
    bladder: Option<Bladder<S>>,
}

impl Characteristic {
    /// A law on a braid without wall, taper or bladder.
    pub fn new(braid: Braid, law: Law) -> Self {
        Self::assemble(braid, Beyond { law, wall: None, taper: None, bladder: None })
    }

    fn assemble(braid: Braid, beyond: Beyond<f64>) -> Self {
        let Beyond { law, wall, taper, bladder } = &beyond;
        let is_ideal = *law == Law::IdealBraid && wall.is_none() && taper.is_none() && bladder.is_none();
        Self { braid, beyond: (!is_ideal).then_some(beyond) }
    }

    fn into_parts(self) -> (Braid, Beyond<f64>) {
        let none = Beyond { law: Law::IdealBraid, wall: None, taper: None, bladder: None };
        (self.braid, self.beyond.unwrap_or(none))
    }

    /// Adds a wall of `thickness` (m) whose bore is open up to `max_length` (m); the volume is the gas's, and so
    /// is the force of the ideal braid. None, if the thickness is zero.
    ///
    /// # Errors
    /// As [`Wall::new`]; [`Error::Inconsistent`] when the wall fills the ends of a taper.
    pub fn with_wall(self, thickness: f64, max_length: f64) -> Result<Self, Error> {
        let (braid, beyond) = self.into_parts();
        let wall = Wall::new(thickness, &braid, max_length)?;
        let wall = (thickness > 0.0).then_some(wall);
        let taper = beyond.taper.map(|taper| taper.beside(&braid, wall.as_ref())).transpose()?;
        Ok(Self::assemble(braid, Beyond { wall, taper, ..beyond }))
    }

    /// Adds ends that taper to `end_radius` (m) in cones `length_ratio` times as long as they widen, for lengths from
    /// `min_length` to `max_length` (m); the volume is the gas's, and so is the force of the ideal braid. None, if the cones have
    /// no length.
    ///
    /// # Errors
    /// As [`Taper::new`].
    pub fn with_taper(self, end_radius: f64, length_ratio: f64, lengths: [f64; 2]) -> Result<Self, Error> {
        let (braid, beyond) = self.into_parts();
        let taper = Taper::new(end_radius, length_ratio, &braid, beyond.wall.as_ref(), lengths)?;
        let taper = (length_ratio > 0.0).then_some(taper);
        Ok(Self::assemble(braid, Beyond { taper, ..beyond }))
    }

    /// Adds a bladder.
    pub fn with_bladder(self, bladder: Bladder) -> Self {
        let (braid, beyond) = self.into_parts();
        Self::assemble(braid, Beyond { bladder: Some(bladder), ..beyond })
    }
}

impl<S> From<IdealBraid<S>> for Characteristic<S> {
    fn from(ideal: IdealBraid<S>) -> Self {
        Self { braid: ideal.braid, beyond: None }
    }
}

impl<S: Scalar> Characteristic<S> {
    /// Converts the characteristic to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Characteristic<T> {
        let braid = self.braid.convert(convert);
        let beyond = self.beyond.as_ref().map(|Beyond { law, wall, taper, bladder }| {
            let law = match law {
                Law::IdealBraid => Law::IdealBraid,
                Law::TonduLopez(law) => Law::TonduLopez(law.convert(&braid, convert)),
                Law::Sarosi(law) => Law::Sarosi(law.convert(convert)),
                Law::MartensBoblan(law) => Law::MartensBoblan(law.convert(&braid, convert)),
                Law::ExtensibleBraid(law) => Law::ExtensibleBraid(law.convert(&braid, convert)),
                Law::Bolen(law) => Law::Bolen(law.convert(convert)),
                Law::Polynomial(law) => Law::Polynomial(law.convert(convert)),
                #[cfg(feature = "alloc")]
                Law::Map(map) => Law::Map(map.convert(convert)),
            };
            let wall = wall.map(|wall| wall.convert(&braid, convert));
            let taper = taper.map(|taper| taper.convert(&braid, wall.as_ref(), convert));
            Beyond { law, wall, taper, bladder: bladder.map(|bladder| bladder.convert(convert)) }
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

    /// The taper of the ends, if it counts.
    #[inline(always)]
    pub fn taper(&self) -> Option<&Taper<S>> {
        self.beyond.as_ref().and_then(|beyond| beyond.taper.as_ref())
    }

    /// The bladder, if it counts.
    pub fn bladder(&self) -> Option<&Bladder<S>> {
        self.beyond.as_ref().and_then(|beyond| beyond.bladder.as_ref())
    }

    /// What the end length is, by the key of the parameter where there is one.
    pub(crate) fn end_name(&self) -> &'static str {
        match (self.wall(), self.taper()) {
            (None, None) => parameter::THREAD_LENGTH.key,
            (Some(_), None) => "the length at which the wall closes the bore",
            (_, Some(_)) => "the length at which the bore is half as wide as in its fittings",
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

    /// Energy in J that the rubber holds at a length in m: the bladder, and the elastic energy of the law.
    pub fn stored_energy<T: Over<S>>(&self, length: T) -> T {
        let of_law = match self.law() {
            Law::MartensBoblan(law) => law.stored_energy(length),
            Law::Polynomial(law) => law.stored_energy(length),
            _ => T::zero(),
        };
        of_law + self.bladder().map_or(T::zero(), |bladder| bladder.stored_energy(length))
    }

    /// Force in N by virtual work of the gas: on the braid, or inside its wall, with ends that taper or not.
    #[inline(always)]
    fn gas_force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        let force = match self.wall() {
            None => IdealBraid { braid: self.braid }.force(length, gauge),
            Some(wall) => -gauge.0 * wall.volume_slope(&self.braid, length),
        };
        match self.taper() {
            None => force,
            Some(taper) => force + gauge.0 * taper.lost_slope(&self.braid, self.wall(), length),
        }
    }

    /// The secant of that force over length in N/m.
    #[inline(always)]
    fn gas_secant<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        let secant = match self.wall() {
            None => IdealBraid { braid: self.braid }.secant_stiffness(length, from, gauge),
            Some(wall) => -gauge.0 * wall.slope_secant(&self.braid, length, from),
        };
        match self.taper() {
            None => secant,
            Some(taper) => secant + gauge.0 * taper.slope_secant(&self.braid, self.wall(), length, from),
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
            Law::Polynomial(law) => law.force(length, gauge),
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
            Law::Polynomial(law) => law.secant_stiffness(length, from, gauge),
            #[cfg(feature = "alloc")]
            Law::Map(map) => map.secant_stiffness(length, from, gauge),
        };
        match &beyond.bladder {
            None => stiffness,
            Some(bladder) => stiffness + bladder.secant_stiffness(length, from),
        }
    }
}

/// What wall and taper leave of the braid's volume, and its slope.
struct Bore<'a, S, T> {
    braid: &'a Braid<S>,
    wall: Option<&'a Wall<S>>,
    taper: Option<&'a Taper<S>>,
    length: T,
}

impl<S: Scalar, T: Over<S>> Work for Bore<'_, S, T> {
    type Output = [T; 2];
    #[inline(always)]
    fn done(self) -> [T; 2] {
        let Self { braid, wall, taper, length } = self;
        let [volume, slope] = match wall {
            None => [braid.volume(length), braid.volume_slope(length)],
            Some(wall) => [wall.volume(braid, length), wall.volume_slope(braid, length)],
        };
        match taper {
            None => [volume, slope],
            Some(taper) => {
                [volume - taper.lost_volume(braid, wall, length), slope - taper.lost_slope(braid, wall, length)]
            }
        }
    }
}

impl<S: Scalar> Statics<S> for Characteristic<S> {
    /// The braid is straight, the wall has closed the bore, or the bore is half as wide as in fittings that it tapers to.
    #[inline(always)]
    fn end_length(&self) -> S {
        match (self.taper(), self.wall()) {
            (Some(taper), _) => taper.end_length(),
            (None, Some(wall)) => wall.closed_length(),
            (None, None) => self.braid.thread_length(),
        }
    }

    #[inline(always)]
    fn volume_and_slope<T: Over<S>>(&self, length: T) -> [T; 2] {
        match (self.wall(), self.taper()) {
            (None, None) => IdealBraid { braid: self.braid }.volume_and_slope(length),
            (wall, taper) => T::apart(Bore { braid: &self.braid, wall, taper, length }),
        }
    }
}
