//! The description by FMI 2.0: scalars, referred to by their place in the list. Source: FMI 2.0.4, section 2.2.

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
    let indicators = model.variables().indicators.to_string();
    let mut attributes = vec![
        ("fmiVersion", "2.0"),
        ("modelName", name),
        ("guid", model.token()),
        ("description", sentence.as_str()),
        ("version", version),
        ("license", "MIT OR Apache-2.0"),
        ("generationTool", tool.as_str()),
        ("variableNamingConvention", "flat"),
    ];
    if interfaces.has_model_exchange() {
        attributes.push(("numberOfEventIndicators", &indicators));
    }
    xml.within("fmiModelDescription", &attributes, |xml| {
        let common = [
            ("modelIdentifier", MODEL_IDENTIFIER),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
        ];
        if interfaces.has_model_exchange() {
            let own = [("completedIntegratorStepNotNeeded", "true"), ("providesDirectionalDerivative", "true")];
            xml.element("ModelExchange", &[&common[..], &own].concat());
        }
        if interfaces.has_co_simulation() {
            let own = [("canHandleVariableCommunicationStepSize", "true")];
            xml.element("CoSimulation", &[&common[..], &own].concat());
        }
        begin(xml, model);
        let shown = shown(model, interfaces);
        xml.within("ModelVariables", &[], |xml| shown.iter().for_each(|its| variable(xml, its, &shown)));
        xml.within("ModelStructure", &[], |xml| structure(xml, &shown));
    });
    xml.text
}

/// The variables of the description: no arrays, and what is inner for model exchange alone. Event indicators are none here.
fn shown(model: &Model, interfaces: Interfaces) -> Vec<&Variable> {
    let is_shown = |its: &&Variable| match its.slot {
        Slot::Array(_) | Slot::Indicator(_) => false,
        Slot::State(_) | Slot::Derivative(_) => interfaces.has_model_exchange(),
        _ => true,
    };
    model.variables().all.iter().filter(is_shown).collect()
}

/// The place of a slot in the list, counted from one.
fn place_of(slot: Slot, shown: &[&Variable]) -> Option<String> {
    shown.iter().position(|its| its.slot == slot).map(|place| (place + 1).to_string())
}

fn variable(xml: &mut Xml, its: &Variable, shown: &[&Variable]) {
    let (causality, variability, initial) = match its.causality {
        Causality::Independent => ("independent", "continuous", None),
        Causality::Input { is_discrete: true } => ("input", "discrete", None),
        Causality::Input { is_discrete: false } => ("input", "continuous", None),
        Causality::Output => ("output", "continuous", Some("calculated")),
        Causality::Parameter { is_tunable: false } => ("parameter", "fixed", Some("exact")),
        Causality::Parameter { is_tunable: true } => ("parameter", "tunable", Some("exact")),
        Causality::Local => ("local", "continuous", Some("calculated")),
    };
    let reference = its.reference.to_string();
    let mut attributes = vec![
        ("name", its.name.as_str()),
        ("valueReference", &reference),
        ("description", &its.description),
        ("causality", causality),
        ("variability", variability),
    ];
    attributes.extend(initial.map(|initial| ("initial", initial)));
    xml.within("ScalarVariable", &attributes, |xml| {
        let start = numbers(&its.start);
        let (min, max) = (its.min.map(|min| format!("{min:?}")), its.max.map(|max| format!("{max:?}")));
        let state = match its.slot {
            Slot::Derivative(index) => place_of(Slot::State(index), shown),
            _ => None,
        };
        let mut attributes: Vec<(&str, &str)> = Vec::new();
        if !its.unit.is_empty() {
            attributes.push(("unit", its.unit));
        }
        let display = units::display(its.unit);
        attributes.extend(display.as_deref().map(|name| ("displayUnit", name)));
        for (key, value) in [("min", &min), ("max", &max), ("derivative", &state)] {
            attributes.extend(value.as_ref().map(|value| (key, value.as_str())));
        }
        if !its.start.is_empty() {
            attributes.push(("start", &start));
        }
        xml.element("Real", &attributes);
    });
}

fn structure(xml: &mut Xml, shown: &[&Variable]) {
    let mut list = |element: &str, wanted: &dyn Fn(&Variable) -> bool| {
        let places: Vec<usize> = (0..shown.len()).filter(|place| wanted(shown[*place])).collect();
        if places.is_empty() {
            return;
        }
        xml.within(element, &[], |xml| {
            for place in places {
                xml.element("Unknown", &[("index", &(place + 1).to_string())]);
            }
        });
    };
    let is_output = |its: &Variable| its.causality == Causality::Output;
    list("Outputs", &is_output);
    list("Derivatives", &|its| matches!(its.slot, Slot::Derivative(_)));
    list("InitialUnknowns", &|its| is_output(its) || matches!(its.slot, Slot::State(_) | Slot::Derivative(_)));
}
