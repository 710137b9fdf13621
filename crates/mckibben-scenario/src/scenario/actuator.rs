//! The braid, its law of force and its losses.

use crate::choice::BladderForm;

/// The braided actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuator {
    /// Length of one braid thread b in m.
    pub thread_length: f64,
    /// Number of turns n that one thread makes around the actuator.
    pub turns: f64,
    /// Length L_max in m at which the braid is taut.
    pub max_length: f64,
    /// Length L_min in m of full contraction.
    pub min_length: f64,
    /// Volume V_ext of hose and fittings in m³; a [`Hose`](super::Hose) has its volume in addition.
    pub external_volume: f64,
    /// Conductance k of a leak in m³/(s·Pa), if there is one.
    pub leakage: Option<f64>,
    /// Thickness t in m of the bladder's wall.
    pub wall_thickness: f64,
    /// The taper of the ends, if they have one.
    pub taper: Option<Taper>,
    /// The law of static force.
    pub force: Force,
    /// The bladder, where its elasticity counts.
    pub bladder: Option<Bladder>,
    /// Measured force over ideal force.
    pub effectiveness: Effectiveness,
    /// Friction between threads and bladder.
    pub friction: Friction,
    /// The taut braid.
    pub limit: Limit,
}

/// The law of static force.
#[derive(Clone, Debug, PartialEq)]
pub enum Force {
    /// Virtual work of the gas on the braid.
    IdealBraid,
    /// The law of Tondu & Lopez.
    TonduLopez {
        /// End factor k at high pressure.
        end_factor: f64,
        /// Excess of the end factor at zero gauge pressure.
        end_factor_rise: f64,
        /// Gauge pressure in Pa over which that excess falls by the factor e.
        end_factor_pressure: f64,
        /// Its coefficients, where they are not those of the braid.
        coefficients: Option<TonduLopezCoefficients>,
    },
    /// Sárosi's law: coefficients for pressures in Pa, contractions in percent and forces in N.
    Sarosi([f64; 6]),
    /// The law of Martens & Boblan.
    MartensBoblan {
        /// Thickness H in m of the rubber membrane.
        membrane_thickness: f64,
        /// Coefficients of its modulus over the length in m: in Pa, Pa/m, Pa/m², Pa/m³.
        modulus: [f64; 4],
    },
    /// The ideal braid of threads that stretch.
    ExtensibleBraid {
        /// Axial stiffness in N/m of all threads side by side.
        thread_stiffness: f64,
    },
    /// Bolen's law.
    Bolen {
        /// Force in N at the longest length and the largest pressure.
        max_force: f64,
        /// Gauge pressure in Pa at which the largest force and contraction are stated.
        max_pressure: f64,
        /// Contraction without load at that pressure.
        max_contraction: f64,
        /// Coefficients s0, s1, s2 of the surface.
        shape: [f64; 3],
    },
    /// A surface polynomial in contraction.
    Polynomial {
        /// Coefficients a_i in m^2 of rising powers of contraction, at least one.
        pressure: Vec<f64>,
        /// Coefficients b_i in N of rising powers of contraction; none for no passive part.
        passive: Vec<f64>,
    },
    /// A measured force map.
    Map {
        /// Gauge pressures in Pa, strictly increasing.
        gauge_pressure: Vec<f64>,
        /// Lengths in m, strictly increasing.
        length: Vec<f64>,
        /// Tensions in N: one for each length at the first pressure, then at the next.
        tension: Vec<f64>,
    },
}

/// Measured coefficients of the law of Tondu & Lopez.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TonduLopezCoefficients {
    /// Radius r_0 in m of the muscle at its longest.
    pub radius: f64,
    /// Factor a of the pulling term.
    pub a: f64,
    /// Factor b of the pushing term.
    pub b: f64,
}

/// Cones at the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Radius r_e in m of the braid where it is clamped.
    pub end_radius: f64,
    /// Length of a cone over the radius by which it widens.
    pub length_ratio: f64,
}

/// An elastic bladder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bladder {
    /// How its resistance grows with contraction.
    pub form: BladderForm,
    /// Its force K_0 in N.
    pub force: f64,
    /// Contraction s over which it saturates or stiffens; without effect when linear.
    pub scale: f64,
}

/// Measured force over ideal force, as a law over gauge pressure.
#[derive(Clone, Debug, PartialEq)]
pub enum Effectiveness {
    /// A ratio that is constant over pressure.
    Constant(f64),
    /// Coefficients e_k of Eff = Σ e_k Pg^k, with the gauge pressure Pg in Pa; e_k is in Pa^-k.
    Polynomial(Vec<f64>),
    /// Ratios at increasing gauge pressures.
    Table {
        /// Gauge pressures in Pa, strictly increasing.
        gauge_pressure: Vec<f64>,
        /// The ratio at each.
        value: Vec<f64>,
    },
}

/// Friction of the actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Friction {
    /// Viscous damping coefficient c in N·s/m.
    pub viscous: f64,
    /// Viscous damping in addition, over the secant stiffness, in s.
    pub structural_damping: f64,
    /// Coulomb friction Q as a length in m.
    pub coulomb_width: f64,
    /// Dry friction F_0 in N that is the same at any length and pressure.
    pub coulomb_force: f64,
    /// Dry friction A in m² for the gauge pressure.
    pub coulomb_force_per_pressure: f64,
    /// Dry friction ρ at break-away over that in motion.
    pub static_ratio: f64,
    /// Velocity v_s in m/s over which it falls from the one to the other.
    pub stribeck_velocity: f64,
    /// Hysteresis that remembers the turns of the length.
    pub hysteresis: Option<Hysteresis>,
    /// Branches that relax.
    pub viscoelastic: Option<Viscoelastic>,
}

/// Viscoelastic branches, one entry for each. An empty list stands for zeros.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Viscoelastic {
    /// Times in s in which they relax, increasing.
    pub relaxation_time: Vec<f64>,
    /// Stiffness of each in N/m that does not follow the pressure.
    pub stiffness: Vec<f64>,
    /// Stiffness of each over the actuator's secant stiffness.
    pub stiffness_ratio: Vec<f64>,
    /// Stretch of the spring of each in m at the start.
    pub initial_stretch: Vec<f64>,
}

/// Hysteresis that remembers the turns of the length.
#[derive(Clone, Debug, PartialEq)]
pub enum Hysteresis {
    /// Elastic elements that slip.
    MaxwellSlip {
        /// Deflections in m at which the elements slip.
        reach: Vec<f64>,
        /// Stiffness of each over the actuator's secant stiffness.
        stiffness_ratio: Vec<f64>,
    },
    /// A loop with rounded corners.
    BoucWen {
        /// Force in steady sliding over the secant stiffness, in m.
        width: f64,
        /// β in 1/m.
        beta: f64,
        /// γ in 1/m.
        gamma: f64,
    },
    /// Bristles whose friction falls with velocity.
    LuGre {
        /// Force in fast sliding over the secant stiffness, in m.
        width: f64,
        /// Deflection in fast sliding, in m.
        reach: f64,
        /// Force in the slowest sliding over that in fast sliding.
        static_ratio: f64,
        /// Velocity in m/s over which it falls.
        stribeck_velocity: f64,
        /// Damping over stiffness at rest, in s.
        damping_time: f64,
    },
}

/// The taut braid at full stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Stiffness K_braid in N/m.
    pub stiffness: f64,
    /// Viscous damping C_braid in N·s/m.
    pub damping: f64,
}
