//! Where the energy of a run went and what became of the exergy of its air, as text: the same tables of an actuator, a joint and
//! a plant. The rows add up; those that begin with a space are parts of the row above.

use crate::summary::Page;
use mckibben::plant::{ActuatorLedger, Balance, MechanismLedger, PlantLedger};

/// Where the work of the gas went. The names are those of the actuators: of two, each has its work printed.
pub(crate) fn energy(page: &Page, ledger: &PlantLedger, names: &[&str]) {
    page.heading("Energy");
    let total = ledger.total();
    let mechanisms = |of: fn(&MechanismLedger) -> f64| -> f64 { ledger.mechanisms.iter().map(of).sum() };
    let actuators = |of: fn(&ActuatorLedger) -> f64| -> f64 { ledger.actuators.iter().map(of).sum() };
    let gas = match (names, &ledger.actuators[..]) {
        ([one, other], [its, others]) => {
            let [its, others] = [its, others].map(|of| page.quantity(of.gas_work, "J"));
            format!("by the gauge pressures: {one} {its}, {other} {others}")
        }
        ([_], _) => "by the gauge pressure".to_owned(),
        _ => "by the gauge pressures".to_owned(),
    };
    let named = [
        ("gas work", total.gas_work, gas.as_str()),
        ("to the load", total.work, "work of the actuators on what they move"),
        (" kinetic", mechanisms(|of| of.kinetic), "gained by what moves"),
        (" potential", mechanisms(|of| of.potential), "gained: weights, constant forces, springs, stops"),
        (" given motion", mechanisms(|of| of.driven), "work on motions that are given"),
        (" joints", mechanisms(|of| of.damping + of.stops), "dissipated by damping and stops"),
        (" belt", mechanisms(|of| of.belt - of.belt_work), "dissipated under the foot, less the work of the belt"),
        ("in braids", actuators(|of| of.braid_storage), "stored in taut braids"),
        ("in tendons", actuators(|of| of.tendon_storage), "stored in tendons in series"),
        ("in bladders", actuators(|of| of.bladder_storage), "stored in bladders"),
        ("in elements", actuators(|of| of.hysteresis_storage), "stored by the elements of the hysteresis"),
        ("in branches", actuators(|of| of.branch_storage), "stored by viscoelastic branches"),
        ("viscous", actuators(|of| of.viscous), "dissipated by viscous friction"),
        ("Coulomb", actuators(|of| of.coulomb), "dissipated by Coulomb friction"),
        ("slip", actuators(|of| of.slip), "dissipated by the elements of the hysteresis that slip"),
        ("relaxation", actuators(|of| of.branches), "dissipated by viscoelastic branches"),
        (
            "exchanged",
            actuators(|of| of.branch_exchange),
            "taken from viscoelastic branches by changes of the pressure",
        ),
        ("braid damping", actuators(|of| of.braid), "dissipated by taut braids"),
        ("slack", actuators(|of| of.slack), "correction of friction while a tension cannot push"),
        (
            "effectiveness",
            total.effectiveness_loss,
            "taken by an effectiveness other than 1, or a law that does not follow from virtual work",
        ),
    ];
    let work = ledger.work();
    page.energies(&named, work.turnover);
    balance(page, &work, "J");
}

/// Where the exergy of the air went, where any was turned over.
pub(crate) fn exergy(page: &Page, ledger: &PlantLedger) {
    let (total, exergy) = (ledger.total(), ledger.exergy());
    if exergy.turnover <= exergy.rounding {
        return;
    }
    page.heading("Exergy of the air");
    let mut named = vec![("drawn", total.drawn, "work potential of what sources gave")];
    if total.compressed != 0.0 {
        named.push(("compressed", total.compressed, "least work of the compressors in the file"));
    }
    named.extend([
        ("gas work", total.gas_work, "by the gauge pressures, see Energy"),
        ("left inside", total.stored, "gained by the air in actuators, hoses and reservoirs"),
        ("exhaust", total.exhaust, "let go with the air"),
        ("leaked", total.leaked, "let go with the air that leaked"),
        ("others", total.others, "of the air of the other actuators alike, as supply.actuators says"),
        ("throttled", total.throttled, "destroyed in valves, hoses and regulators"),
        ("mixing", total.mixed, "destroyed as air of two temperatures mixes"),
        ("heat", total.heat_loss, "lost with heat, also with what the process implies; negative: gained"),
    ]);
    page.energies(&named, exergy.turnover);
    balance(page, &exergy, "J");
    if let Some(efficiency) = total.efficiency() {
        let what = match total.others {
            0.0 => "work on the load over what was drawn and compressed",
            _ => "work on the loads, also of the others alike, over what was drawn and compressed",
        };
        page.value("efficiency", &page.percent(efficiency), what);
        let least = total.least_work + total.compressed;
        // Where nothing is drawn from sources it is the same.
        if total.least_work > 0.0 && least > 0.0 {
            let what = format!("over the isothermal work of compressors, {}", page.quantity(least, "J"));
            page.value("of compressor", &page.percent((total.work + total.work_of_others) / least), &what);
        }
    }
}

/// What of a sum does not close, and what share of its turnover that is, unless that is no more than rounding.
pub(crate) fn balance(page: &Page, of: &Balance, unit: &str) {
    let Balance { residual, turnover, rounding, .. } = *of;
    let _ = page.sound(turnover);
    let share = if turnover <= rounding {
        format!("within rounding, which may leave {}", page.quantity(rounding, unit))
    } else if residual == 0.0 {
        "nothing is left".to_owned()
    } else {
        format!("{:.1e} of the turnover", page.sound(residual / turnover))
    };
    page.value("residual", &page.quantity(residual, unit), &share);
}

#[cfg(test)]
mod tests {
    use super::*;
    use mckibben_run::failure::Failure;

    fn of([residual, turnover, rounding]: [f64; 3]) -> Result<String, Failure> {
        let page = Page::default();
        page.heading("NaN.toml, inf");
        balance(&page, &Balance { residual, turnover, rounding, resolution: 0.0 }, "J");
        page.finish("")
    }

    #[test]
    fn a_remainder_is_judged_against_a_turnover_that_is_more_than_rounding() {
        let text = |sums| of(sums).expect("finite numbers");
        assert!(text([2e-9, 4.0, 1e-12]).contains("5.0e-10 of the turnover"));
        // The turnover of a muscle that is held at one length: half of it does not close, and says nothing.
        let held = text([2e-17, 4e-17, 1e-12]);
        assert!(held.contains("within rounding, which may leave 1.000 pJ") && !held.contains("turnover"), "{held}");
        assert!(text([0.0, 0.0, 1e-12]).contains("within rounding"));
    }

    #[test]
    fn what_is_not_finite_is_an_error_that_names_its_line() {
        for sums in
            [[f64::NAN, 4.0, 1e-12], [f64::INFINITY, 4.0, 1e-12], [0.0, f64::NAN, 1e-12], [1.0, f64::INFINITY, 0.0]]
        {
            let failure = of(sums).expect_err("no praise for what is not finite");
            assert_eq!(failure.code(), 3);
            assert!(failure.to_string().contains("the summary's residual = "), "{failure}");
        }
    }
}
