//! The linear model of the actuator, joint or plant that a scenario describes.

use super::joint::JointModel;
use super::plant::PlantModel;
use super::{Account, Model, Request, account, bode, export, given};
use crate::failure::Failure;
use mckibben::linearize::{Pole, StateSpace};
use mckibben_plot::Figure;
use mckibben_scenario::{Diagnostics, Document};

/// A linear model at an operating point, with what is known about it.
pub struct LinearModel(Kind);

enum Kind {
    Actuator(Box<Model>),
    Joint(Box<JointModel>),
    Plant(Box<PlantModel>),
}

impl LinearModel {
    /// The requested model, of a scenario whose file has a name.
    ///
    /// # Errors
    /// The scenario is wrong, or it has no such point.
    pub fn of(name: &str, document: &Document, request: &Request) -> Result<Self, Failure> {
        request.check()?;
        if let Some(experiment) = document.plant_experiment()? {
            let model = PlantModel::new(name, &experiment, request, document.assumed())?;
            return Self(Kind::Plant(Box::new(model))).checked();
        }
        // A linear model has no controller: its valves are held shut.
        let scenario = document.scenario()?.open_loop();
        if let Some(experiment) = document.joint_of(&scenario)? {
            let model = JointModel::new(name, &experiment, request, document.assumed())?;
            return Self(Kind::Joint(Box::new(model))).checked();
        }
        if request.angle.is_some() {
            return Err(Failure::input(
                "the scenario's load is no joint, and has no `angle`",
                "leave out `angle` and `stiffness`",
            ));
        }
        let experiment = scenario.experiment().map_err(|error| Diagnostics::from(document.diagnose(&error)))?;
        let linear = given::linearization(request, &experiment)?;
        let model = Model::new(name, linear, request, document.assumed())?;
        Self(Kind::Actuator(Box::new(model))).checked()
    }

    /// The model, if every number of its matrices and of its point is finite.
    fn checked(self) -> Result<Self, Failure> {
        let StateSpace { a, b, c, d, .. } = self.system();
        let entries = [("A", a), ("B", b), ("C", c), ("D", d)]
            .into_iter()
            .flat_map(|(name, rows)| rows.iter().flatten().map(move |value| (name.to_owned(), *value)));
        let poles = self.poles().iter();
        let poles = poles.flat_map(|pole| [pole.real, pole.imaginary].map(|part| ("a pole".to_owned(), part)));
        let fault = entries.chain(self.point()).chain(poles).find(|(_, value)| !value.is_finite());
        match fault {
            Some((name, value)) => Err(Failure::not_finite(&format!("{name} of the linear model: {value}"))),
            None => Ok(self),
        }
    }

    /// The matrices, of all states or of those that are needed, as requested.
    pub fn system(&self) -> &StateSpace {
        match &self.0 {
            Kind::Actuator(model) => &model.system,
            Kind::Joint(model) => &model.system,
            Kind::Plant(model) => &model.system,
        }
    }

    /// The poles.
    pub fn poles(&self) -> &[Pole] {
        match &self.0 {
            Kind::Actuator(model) => &model.poles,
            Kind::Joint(model) => &model.poles,
            Kind::Plant(model) => &model.poles,
        }
    }

    /// By how much later in s than each input its effect begins. The matrices leave it out.
    pub fn delays(&self) -> &[f64] {
        match &self.0 {
            Kind::Actuator(model) => &model.delays,
            Kind::Joint(model) => &model.delays,
            Kind::Plant(model) => &model.delays,
        }
    }

    /// The values at the operating point, each name with its unit at the end.
    pub fn point(&self) -> Vec<(String, f64)> {
        match &self.0 {
            Kind::Actuator(model) => export::owned(export::point(model)),
            Kind::Joint(model) => export::owned(model.point()),
            Kind::Plant(model) => model.point(),
        }
    }

    /// The model as JSON.
    pub fn json(&self) -> String {
        match &self.0 {
            Kind::Actuator(model) => export::json(model),
            Kind::Joint(model) => model.json(),
            Kind::Plant(model) => export::plant_json(model),
        }
    }

    /// The model as a script for MATLAB and Octave.
    pub fn matlab(&self) -> String {
        match &self.0 {
            Kind::Actuator(model) => export::matlab(model),
            Kind::Joint(model) => model.matlab(),
            Kind::Plant(model) => model.matlab(),
        }
    }

    /// The frequency response to one input; to the valve's where none is named.
    ///
    /// # Errors
    /// There is no such input.
    pub fn figure(&self, input: Option<&str>) -> Result<Figure, Failure> {
        match &self.0 {
            Kind::Actuator(model) => bode::figure(model, input),
            Kind::Joint(model) => bode::of_joint(model, input),
            Kind::Plant(model) => bode::of_plant(model, input),
        }
    }

    /// The model in words and tables.
    pub fn account(&self) -> Account {
        match &self.0 {
            Kind::Actuator(model) => account::of_actuator(model),
            Kind::Joint(model) => model.account(),
            Kind::Plant(model) => model.account(),
        }
    }
}
