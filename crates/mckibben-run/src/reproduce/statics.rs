//! Fig. 3: force and stiffness of the ideal actuator, and how good (6) is.
//!
//! (6) takes the pressure as constant with the valve shut. How good that is, is the ratio of the stiffness with the
//! first term of (5) to that without, at the operating point of Fig. 8; and the rise of the pressure over the whole
//! range.

use super::files;
use super::units::{INCH, LBF, LBF_PER_INCH, PSI, assumed, in_unit};
use crate::failure::Failure;
use crate::report::{Data, Finding, Plate, Section, Table, Verdict, number};
use mckibben::{AbsolutePressure, Actuator, GaugePressure};
use mckibben_plot::{Axis, Colour, Figure, Panel, Series};

/// Nominal gauge pressures in psi.
const PRESSURES: [f64; 7] = [35.0, 45.0, 55.0, 65.0, 75.0, 85.0, 95.0];
/// Points on a curve.
const POINTS: usize = 121;

/// The section on Fig. 3.
pub(super) fn section() -> Result<Section, Failure> {
    let name = "fig-03.toml";
    let actuator = files::experiment(name)?.rig.actuator().clone();
    let plate = plate(&actuator);
    let (range, range_findings) = constant_pressure()?;
    let mut findings = findings(&actuator);
    findings.extend(range_findings);
    Ok(Section {
        id: "fig-3",
        label: "Fig. 3",
        title: "Force and stiffness of the ideal actuator",
        paragraphs: vec![
            "Equations (3) and (7) between full contraction and full stretch, without friction and at constant \
             pressure, for 35 to 95 psi."
                .into(),
            "The paper neglects the change of pressure with length, (6), when the volume outside the actuator is \
             “roughly the same or more than the maximum internal actuator volume”. The table shows what that leaves \
             out at the operating point of Fig. 8, 60 psi and 6 lb: the stiffness with the valve shut, with both \
             terms of (5), over that of (7)."
                .into(),
        ],
        plates: vec![plate],
        tables: vec![range],
        findings,
        files: vec![files::shown(name)?],
    })
}

fn plate(actuator: &Actuator) -> Plate {
    let limits = actuator.limits();
    let (shortest, longest) = (limits.min_length(), limits.max_length());
    let lengths: Vec<f64> =
        (0..POINTS).map(|i| shortest + (longest - shortest) * i as f64 / (POINTS - 1) as f64).collect();
    let mut force = Panel::new(Axis::new("force", "lbf").starting_at(0.0)).height_mm(48.0);
    let mut stiffness = Panel::new(Axis::new("stiffness (7)", "lbf/in").starting_at(0.0)).height_mm(48.0);
    let mut data = Data::new(&["gauge_pressure_pa", "length_m", "force_n", "stiffness_n_m"]);
    for (place, psi) in PRESSURES.into_iter().enumerate() {
        let pressure = absolute(actuator, psi * PSI);
        let forces: Vec<f64> = lengths.iter().map(|length| actuator.static_force(*length, pressure.0)).collect();
        let slopes: Vec<f64> = lengths.iter().map(|length| actuator.stiffness(*length, pressure)).collect();
        for ((length, force), slope) in lengths.iter().zip(&forces).zip(&slopes) {
            data.rows.push(vec![psi * PSI, *length, *force, *slope]);
        }
        let colour = Colour::Ramp(place as f64 / (PRESSURES.len() - 1) as f64);
        let x = in_unit(lengths.iter().copied(), INCH);
        let curve = |y: Vec<f64>| Series::line(format!("{psi} psi"), x.clone(), y).colour(colour);
        force = force.series(curve(in_unit(forces, LBF)));
        stiffness = stiffness.series(curve(in_unit(slopes, LBF_PER_INCH)));
    }
    let figure = Figure::new(Axis::new("length", "in"))
        .caption(assumed(&["b", "n", "Eff"]))
        .size_mm(120.0, 48.0)
        .panel(force)
        .panel(stiffness);
    let caption = "Fig. 3 of the paper: theoretical force (3) and stiffness (7) over length, at gauge pressures from \
                   35 to 95 psi.";
    Plate { stem: "fig-03", caption: caption.into(), figure, data }
}

fn findings(actuator: &Actuator) -> Vec<Finding> {
    let limits = actuator.limits();
    let (shortest, longest) = (limits.min_length(), limits.max_length());
    let at = |psi: f64| absolute(actuator, psi * PSI);
    let end: f64 = actuator.static_force(shortest, at(95.0).0);
    let full: f64 = actuator.static_force(longest, at(60.0).0);
    // What is proportional to P_g L has one quotient everywhere.
    let quotients: Vec<f64> = PRESSURES
        .into_iter()
        .flat_map(|psi| [shortest, 0.5 * (shortest + longest), longest].map(|length| (psi, length)))
        .map(|(psi, length)| actuator.stiffness(length, at(psi)) / (psi * PSI * length))
        .collect();
    let (least, most) = quotients.iter().fold((f64::MAX, f64::MIN), |(l, m), q| (l.min(*q), m.max(*q)));
    // The quotient is 3/(2πn²), of which no digit may be claimed: n is assumed.
    vec![
        Finding::new("Force at full contraction, 95 psi, over that at full stretch", end / full, 3, "").against(
            "“tending to zero at maximum contraction”",
            Verdict::Agrees("zero where L = b/√3, to the rounding of the assumed L_min".into()),
        ),
        Finding::new("Departure of stiffness from a multiple of P_g L", 100.0 * (most / least - 1.0), 3, "%").against(
            "“a linearly increasing function of length and pressure”",
            Verdict::Agrees("(7) as it stands; holds for any b and n".into()),
        ),
        Finding::new("Force at full stretch, 60 psi", full / LBF, 1, "lbf")
            .against("", Verdict::NotComparable("rests on the assumed b and n".into())),
    ]
}

/// How good (6) is with several volumes outside the actuator.
fn constant_pressure() -> Result<(Table, Vec<Finding>), Failure> {
    let file = "fig-08.toml";
    let mut scenario = files::document(file)?.scenario()?;
    let rig = scenario.rig().map_err(files::stopped)?;
    let braid = rig.actuator().law().law.braid;
    let largest = braid.volume(rig.actuator().limits().min_length());
    let given = scenario.actuator.external_volume;
    let nominal = absolute(rig.actuator(), 60.0 * PSI);
    let length = rig.equilibrium(nominal).map_err(files::stopped)?;
    let mut table = Table {
        caption:
            "How good (6) is: sealed stiffness (5) over stiffness at constant pressure (7), at 60 psi and 6 lb, and \
                  the rise of the absolute pressure from full contraction to full stretch."
                .into(),
        head: ["Volume outside", "Stiffness (5)/(7)", "Rise, isentropic", "Rise, isothermal"]
            .map(String::from)
            .to_vec(),
        rows: Vec::new(),
    };
    let mut findings = Vec::new();
    let cases = [
        ("as assumed for the experiments", given),
        ("the largest volume inside", largest),
        ("ten times the largest inside", 10.0 * largest),
    ];
    for (words, external) in cases {
        scenario.actuator.external_volume = external;
        let rig = scenario.rig().map_err(files::stopped)?;
        let actuator = rig.actuator();
        let ratio = actuator.sealed_stiffness(length, nominal) / actuator.stiffness(length, nominal);
        let limits = actuator.limits();
        let squeeze: f64 = actuator.volume(limits.min_length()) / actuator.volume(limits.max_length());
        let rise = |index: f64| 100.0 * (squeeze.powf(index) - 1.0);
        let percent = |value: f64| format!("{} %", number(value, 1));
        table.rows.push(vec![
            format!("{} cm³, {words}", number(external * 1e6, 2)),
            number(ratio, 3),
            percent(rise(actuator.air().heat_capacity_ratio())),
            percent(rise(1.0)),
        ]);
        if external <= largest {
            let name = if external == given { "V_ext = 3 cm³" } else { "V_ext = largest inside" };
            let words = "(6) is an approximation; this is what it leaves out";
            findings.push(
                Finding::new(format!("Sealed stiffness (5) over (7), 60 psi, 6 lb, {name}"), ratio, 3, "")
                    .against("1 by (6)", Verdict::NotComparable(words.into())),
            );
        }
        if external == largest {
            let stated = "“the pressure change [remains] minimal through the actuator’s range of motion”";
            let inside = largest / braid.volume(limits.max_length());
            let words = format!(
                "with a volume inside that shrinks by the factor {}, which rests on the assumed b; isentropic {} %",
                number(inside, 2),
                number(rise(actuator.air().heat_capacity_ratio()), 0)
            );
            let name = "Rise of pressure over the range, isothermal, V_ext = largest inside";
            findings.push(Finding::new(name, rise(1.0), 0, "%").against(stated, Verdict::Differs(words)));
        }
    }
    Ok((table, findings))
}

fn absolute(actuator: &Actuator, gauge: f64) -> AbsolutePressure {
    GaugePressure(gauge).absolute(actuator.air().atmosphere())
}
