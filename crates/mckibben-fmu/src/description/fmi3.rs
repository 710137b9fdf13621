//! The description by FMI 3.0. Source: FMI 3.0.2, section 2.4.

use super::{Xml, begin, numbers, sentence, units};
use crate::MODEL_IDENTIFIER;
use crate::model::Model;
use crate::options::Interfaces;
use crate::variables::{Causality, Slot, Variable};

/// The description of a unit.
pub(super) fn description(model: &Model, name: &str, interfaces: Interfaces) -> String {
    let mut xml = Xml::new();
    let version = env!("CARGO_PKG_VERSION");
    let (tool, sentence) = (format!("mckibben {version}"), sentence(model));
    let attributes = [
        ("fmiVersion", "3.0"),
        ("modelName", name),
        ("instantiationToken", model.token()),
        ("description", sentence.as_str()),
        ("version", version),
        ("license", "MIT OR Apache-2.0"),
        ("generationTool", tool.as_str()),
        ("variableNamingConvention", "flat"),
    ];
    xml.within("fmiModelDescription", &attributes, |xml| {
        let common = [
            ("modelIdentifier", MODEL_IDENTIFIER),
            ("canGetAndSetFMUState", "true"),
            ("canSerializeFMUState", "true"),
            ("providesDirectionalDerivatives", "true"),
        ];
        if interfaces.has_model_exchange() {
            xml.element("ModelExchange", &[&common[..], &[("needsCompletedIntegratorStep", "false")]].concat());
        }
        if interfaces.has_co_simulation() {
            let own = [
                ("canHandleVariableCommunicationStepSize", "true"),
                ("mightReturnEarlyFromDoStep", "true"),
                ("hasEventMode", "true"),
            ];
            xml.element("CoSimulation", &[&common[..3], &own].concat());
        }
        begin(xml, model);
        let shown: Vec<&Variable> =
            model.variables().all.iter().filter(|its| interfaces.has_model_exchange() || !is_inner(its)).collect();
        xml.within("ModelVariables", &[], |xml| shown.iter().for_each(|its| variable(xml, its)));
        xml.within("ModelStructure", &[], |xml| structure(xml, &shown));
    });
    xml.text
}

/// Whether a variable is for model exchange alone.
fn is_inner(variable: &Variable) -> bool {
    matches!(variable.slot, Slot::State(_) | Slot::Derivative(_) | Slot::Indicator(_))
}

fn variable(xml: &mut Xml, its: &Variable) {
    let (reference, start) = (its.reference.to_string(), numbers(&its.start));
    let (min, max) = (its.min.map(|min| format!("{min:?}")), its.max.map(|max| format!("{max:?}")));
    let state = match its.slot {
        Slot::Derivative(index) => Some(Slot::State(index).reference().to_string()),
        _ => None,
    };
    let (causality, variability, initial) = match its.causality {
        Causality::Independent => ("independent", "continuous", None),
        Causality::Input { is_discrete: true } => ("input", "discrete", None),
        Causality::Input { is_discrete: false } => ("input", "continuous", None),
        Causality::Output => ("output", "continuous", Some("calculated")),
        Causality::Parameter { is_tunable: false } => ("parameter", "fixed", Some("exact")),
        Causality::Parameter { is_tunable: true } => ("parameter", "tunable", Some("exact")),
        Causality::Local => ("local", "continuous", Some("calculated")),
    };
    let mut attributes = vec![
        ("name", its.name.as_str()),
        ("valueReference", &reference),
        ("description", &its.description),
        ("causality", causality),
        ("variability", variability),
    ];
    let display = units::display(its.unit);
    attributes.extend(initial.map(|initial| ("initial", initial)));
    attributes.extend(Some(its.unit).filter(|unit| !unit.is_empty()).map(|unit| ("unit", unit)));
    attributes.extend(display.as_deref().map(|name| ("displayUnit", name)));
    for (key, value) in [("min", &min), ("max", &max), ("derivative", &state)] {
        attributes.extend(value.as_ref().map(|value| (key, value.as_str())));
    }
    if !its.start.is_empty() {
        attributes.push(("start", &start));
    }
    match its.dimension {
        Some(count) => {
            xml.within("Float64", &attributes, |xml| xml.element("Dimension", &[("start", &count.to_string())]));
        }
        None => xml.element("Float64", &attributes),
    }
}

fn structure(xml: &mut Xml, shown: &[&Variable]) {
    let mut list = |element: &str, wanted: &dyn Fn(&Variable) -> bool| {
        for its in shown.iter().filter(|its| wanted(its)) {
            xml.element(element, &[("valueReference", &its.reference.to_string())]);
        }
    };
    let is_output = |its: &Variable| its.causality == Causality::Output;
    list("Output", &is_output);
    list("ContinuousStateDerivative", &|its| matches!(its.slot, Slot::Derivative(_)));
    list("InitialUnknown", &|its| is_output(its) || matches!(its.slot, Slot::State(_) | Slot::Derivative(_)));
    list("EventIndicator", &|its| matches!(its.slot, Slot::Indicator(_)));
}
