//! A hose between the valve and the actuator: a second volume behind a friction loss, or a line of cells.
//!
//! ```text
//! lumped         dP₁/dt = κRT/V (ṁ_valve − ṁ)            ṁ = friction(P₁, P)         everything L/c later
//!
//! distributed    dP_i/dt = κRT/(A Δx) (w_{i−1} − w_i)                                 i = 1 … n,  w₀ = ṁ_valve
//!                dw_i/dt = A/Δx (P_i − P_{i+1} − Δp(w_i))                             P_{n+1} = P, Δx = L/n
//!
//! c = √(κRT)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | P_i, P | `pressures` of the cells, absolute; that of the actuator | Pa |
//! | w_i, ṁ | `flows` out of the cells, towards the actuator | kg/s |
//! | κ | `polytropic_index` | – |
//! | L, A, V | length, cross-section, volume | m, m², m³ |
//! | T | temperature of wall and air | K |
//! | c, L/c | `wave_speed`, `delay` | m/s, s |
//!
//! κ says how the hose's air answers to what flows in: 1 where the wall keeps its temperature, as it nearly does in a
//! narrow hose while an actuator fills; γ for quick small waves. The content that goes with it is `V P/(κRT)`; for κ = 1
//! that is the mass of the air. The density in the friction is that at the wall's temperature.
//!
//! No air flows faster than sound: the flow out of a cell stays at `κ A P_i/c` where its inertia would carry it on, by which a
//! cell never loses more air than it has. The event-located engine does so; it counts after sudden exhausts alone.
//!
//! The lumped hose puts the whole volume in front of the whole loss and lets the valve's poppets take effect L/c late. It has
//! no inertia and no waves: take it where the hose's own time constants are far below the actuator's. The distributed
//! hose has the air's inertia; its delay, waves and attenuation are those of the cells and approach the closed form of
//! [`linear`](super::linear) for small signals in laminar flow as their number grows. Convection of momentum is left
//! out (flow slow against sound), and so is the unsteady profile of the velocity, by which quick oscillations in laminar
//! flow are damped more than by the steady law.
//!
//! Source: continuity and momentum of a line, textbook; Richer & Hurmuzlu, "A high performance pneumatic force actuator
//! system", J. Dyn. Sys. Meas. Control 122 (2000), for a line as a delay and a loss between valve and chamber; "A
//! simplified lumped parameter model for pneumatic tubes", Math. Comput. Model. Dyn. Syst. 23 (2017), for κ as a choice.
//! Checked by `tests/line_hose.rs`: wave speed and attenuation in closed form, order in the number of cells.

use super::friction::Tube;
use crate::air::{Air, Chamber};
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// The largest number of cells that a simulated hose may have.
pub const MAX_CELLS: usize = 8;

/// How finely a hose is resolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoseKind {
    /// One volume, a loss without inertia, a delay.
    Lumped,
    /// A line of cells with inertia.
    Distributed {
        /// Their number.
        cells: usize,
    },
}

/// A hose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hose<S = f64> {
    /// The whole hose, or one of its cells.
    tube: Tube<S>,
    pub(crate) kind: HoseKind,
    polytropic_index: S,
    /// `κRT/V` of the tube in Pa/kg.
    stiffness: S,
    /// `√(κRT)` in m/s.
    wave_speed: S,
    /// Mass over pressure of a volume at the wall's temperature, in kg/Pa.
    density: S,
}

impl Hose {
    /// A hose of `length` and inner `diameter` (m) with the gas of `air`, of `viscosity` (Pa·s) and at `temperature` (K),
    /// that answers to inflow with `polytropic_index` κ.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn new(
        kind: HoseKind,
        [length, diameter]: [f64; 2],
        [viscosity, temperature, polytropic_index]: [f64; 3],
        air: &Air,
    ) -> Result<Self, Error> {
        let cells = match kind {
            HoseKind::Lumped => 1,
            HoseKind::Distributed { cells } => cells,
        };
        parameter::HOSE_CELLS.check(cells as f64)?;
        parameter::HOSE_LENGTH.check(length)?;
        let tube = Tube::new(length / cells as f64, diameter, viscosity, temperature, air)?;
        Ok(Self::assemble(tube, kind, parameter::HOSE_INDEX.check(polytropic_index)?))
    }
}

impl<S: Scalar> Hose<S> {
    fn assemble(tube: Tube<S>, kind: HoseKind, polytropic_index: S) -> Self {
        let squared = polytropic_index * tube.pressure_per_density();
        let density = tube.volume() / tube.pressure_per_density();
        Self { tube, kind, polytropic_index, stiffness: squared / tube.volume(), wave_speed: squared.sqrt(), density }
    }

    /// Converts the hose to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Hose<T> {
        // The parameter is the whole length, of which a cell is a part.
        let cells = self.cells() as f64;
        let mut of_hose = CellConvert { inner: convert, cells };
        let tube = self.tube.convert(&mut of_hose);
        let polytropic_index = convert.parameter(&parameter::HOSE_INDEX, self.polytropic_index);
        match convert.carry() {
            Some(mut carry) => Hose {
                tube,
                kind: self.kind,
                polytropic_index,
                stiffness: carry(self.stiffness),
                wave_speed: carry(self.wave_speed),
                density: carry(self.density),
            },
            None => Hose::assemble(tube, self.kind, polytropic_index),
        }
    }

    /// Lumped, or how many cells.
    #[inline(always)]
    pub fn kind(&self) -> HoseKind {
        self.kind
    }

    /// How many volumes it has.
    #[inline(always)]
    pub fn cells(&self) -> usize {
        match self.kind {
            HoseKind::Lumped => 1,
            HoseKind::Distributed { cells } => cells,
        }
    }

    /// The whole hose, or one of its cells.
    #[inline(always)]
    pub fn tube(&self) -> &Tube<S> {
        &self.tube
    }

    /// Whole length in m.
    pub fn length(&self) -> S {
        self.tube.length() * S::constant(self.cells() as f64)
    }

    /// Whole volume in m³.
    pub fn volume(&self) -> S {
        self.tube.volume() * S::constant(self.cells() as f64)
    }

    /// Speed c of a small wave in m/s.
    pub fn wave_speed(&self) -> S {
        self.wave_speed
    }

    /// The time in s that a small wave takes through the hose, L/c.
    pub fn delay(&self) -> S {
        self.length() / self.wave_speed
    }

    /// By how much the valve's poppets take effect late, in s: the delay of a lumped hose; a distributed one has its own.
    pub fn transport_delay(&self) -> S {
        match self.kind {
            HoseKind::Lumped => self.delay(),
            HoseKind::Distributed { .. } => S::zero(),
        }
    }

    /// `∂(dP/dt)/∂ṁ` of a volume, `κRT/V` in Pa/kg.
    #[inline(always)]
    pub fn stiffness(&self) -> S {
        self.stiffness
    }

    /// `dP/dt` in Pa/s of a volume with a net inflow in kg/s.
    #[inline(always)]
    pub fn pressure_rate<T: Over<S>>(&self, net: T) -> T {
        net * T::of(self.stiffness)
    }

    /// Content in kg of a volume at an absolute pressure in Pa.
    pub fn content<T: Over<S>>(&self, pressure: T) -> T {
        pressure / T::of(self.stiffness)
    }

    /// Mass flow in kg/s out of a lumped hose at a pressure into an actuator at another, both absolute in Pa.
    #[inline(always)]
    pub fn flow<T: Over<S>>(&self, pressure: T, actuator: T) -> T {
        self.tube.flow(pressure, actuator)
    }

    /// `dw/dt` in kg/s² of the flow out of a cell at `pressure` into what lies at the pressure `next` (Pa, absolute).
    #[inline(always)]
    pub fn flow_rate<T: Over<S>>(&self, flow: T, pressure: T, next: T) -> T {
        let mean = T::constant(0.5) * (pressure + next);
        (pressure - next - self.tube.loss(flow, mean)) * T::of(self.per_inertance())
    }

    /// A/Δx in m: by what a difference of pressure changes the flow through a cell.
    #[inline(always)]
    pub(crate) fn per_inertance(&self) -> S {
        self.tube.area() / self.tube.length()
    }

    /// The flow in kg/s of air at an absolute pressure in Pa that goes at the speed of sound, `κ A P/c`.
    #[cfg(feature = "alloc")]
    #[inline(always)]
    pub(crate) fn sonic_flow<T: Over<S>>(&self, pressure: T) -> T {
        pressure * T::of(self.polytropic_index * self.tube.area() / self.wave_speed)
    }

    /// A bound for `∂Δp/∂w` in Pa·s/kg of a cell at `pressure` before what lies at `next`, for the flow that there is and for
    /// what these pressures could keep up.
    #[cfg(feature = "alloc")]
    #[inline(always)]
    pub(crate) fn steepest_loss(&self, flow: S, pressure: S, next: S) -> S {
        self.tube.steepest_loss(flow, pressure, next)
    }

    /// The air at the valve's end at an absolute pressure in Pa, as the valve's flow law takes it.
    #[inline(always)]
    pub fn chamber<T: Over<S>>(&self, pressure: T) -> Chamber<T> {
        let volume = self.tube.volume();
        let mass = pressure * T::of(self.density);
        Chamber::new(pressure, mass, T::of(volume), T::zero())
    }
}

/// Hands out the whole length for that of a cell.
struct CellConvert<'a, C> {
    inner: &'a mut C,
    cells: f64,
}

impl<S: Scalar, T: Scalar, C: Convert<S, T>> Convert<S, T> for CellConvert<'_, C> {
    fn parameter(&mut self, parameter: &'static parameter::Parameter, value: S) -> T {
        if core::ptr::eq(parameter, &raw const parameter::HOSE_LENGTH) && self.cells > 1.0 {
            return self.inner.parameter(parameter, value * S::constant(self.cells)) / T::constant(self.cells);
        }
        self.inner.parameter(parameter, value)
    }

    fn carry(&mut self) -> Option<impl FnMut(S) -> T> {
        self.inner.carry()
    }
}
