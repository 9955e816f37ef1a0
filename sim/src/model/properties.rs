//! What is known of a model on a body without a state: its constants, and its parameters as data.

use crate::body::Body;
use crate::element::Dimension;
use crate::material::Material;

/// What is known of a model on a body without a state.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Properties {
    /// The name of the model; empty if it has none.
    pub kind: &'static str,
    /// Elastic constant `k` (N/m), that of the stiffest element.
    pub stiffness: f64,
    /// Damping constant `D` (N s/m), that of the stiffest element; 0 without damping.
    pub damping: f64,
    /// The greatest stiffness (N/m) by which an element or spring acts on a node; `k` but for models with more than one constant.
    pub stiffest: f64,
    /// Memory stride per breakable spring, or per element of a model without springs; its last number is 1 once broken. Strides begin at
    /// the start of the memory. `None` if nothing breaks.
    pub breakable: Option<usize>,
    /// Whether the last number of the memory counts the rotations that needed a slower, global method.
    pub counts_fallbacks: bool,
    /// The parameters. With a material, `young` and `poisson` are there in place of `stiffness`. The `damping_of` of a model is the
    /// velocity that its damping acts on: `relative-motion`, which also brakes the rotation of a rigid body, or `deformation`.
    pub parameters: Vec<Parameter>,
    /// What would be a parameter in another model, and is fixed in this one.
    pub fixed: Vec<Parameter>,
}

/// A parameter of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name, such as `breaks_at`.
    pub name: &'static str,
    /// Its value.
    pub value: Setting,
}

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Setting {
    /// A quantity with its unit, which is empty for a plain number.
    Number(f64, &'static str),
    /// A number of times.
    Count(u32),
    /// One of several methods, by its name.
    Choice(&'static str),
}

impl Properties {
    /// Of an undamped model with this elastic constant (N/m), in which nothing breaks. It is the first parameter.
    pub fn new(kind: &'static str, stiffness: f64) -> Self {
        let parameters = vec![Parameter { name: "stiffness", value: Setting::Number(stiffness, "N/m") }];
        let (damping, stiffest, breakable, counts_fallbacks, fixed) = (0.0, stiffness, None, false, Vec::new());
        Self { kind, stiffness, damping, stiffest, breakable, counts_fallbacks, parameters, fixed }
    }

    /// The same of a material that was given in place of the elastic constant, if it was.
    #[must_use]
    pub fn of_material(mut self, given: Option<Material>, dimension: Dimension) -> Self {
        if let Some(Material { young, poisson }) = given {
            self.parameters.clear();
            let unit = if dimension == Dimension::Plane { "N/m" } else { "Pa" };
            self = self.with("young", Setting::Number(young, unit)).with("poisson", Setting::Number(poisson, ""));
        }
        self
    }

    /// The same with a damping constant (N s/m).
    #[must_use]
    pub fn damped(mut self, damping: f64) -> Self {
        self.damping = damping;
        self.with("damping", Setting::Number(damping, "N s/m"))
    }

    /// The same with one more parameter.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: Setting) -> Self {
        self.parameters.push(Parameter { name, value });
        self
    }

    /// The same with one more setting that is fixed in this model.
    #[must_use]
    pub fn fixed(mut self, name: &'static str, value: Setting) -> Self {
        self.fixed.push(Parameter { name, value });
        self
    }

    /// The same parameters with all stiffnesses (N/m, Pa) and all damping constants (N s/m) multiplied.
    #[must_use]
    pub fn scaled(mut self, stiffness: f64, damping: f64) -> Self {
        for Parameter { value, .. } in &mut self.parameters {
            match value {
                Setting::Number(number, "N/m" | "Pa") => *number *= stiffness,
                Setting::Number(number, "N s/m") => *number *= damping,
                _ => {}
            }
        }
        let own = (self.stiffness * stiffness, self.stiffest * stiffness, self.damping * damping);
        (self.stiffness, self.stiffest, self.damping) = own;
        self
    }

    /// A parameter or a fixed setting by its name; `None` if the model does not have it.
    pub fn get(&self, name: &str) -> Option<Setting> {
        let mut all = self.parameters.iter().chain(&self.fixed);
        all.find(|parameter| parameter.name == name).map(|parameter| parameter.value)
    }

    /// The material that was given in place of an elastic constant.
    pub fn given_material(&self) -> Option<Material> {
        let number = |name| match self.get(name) {
            Some(Setting::Number(number, _)) => Some(number),
            _ => None,
        };
        Some(Material { young: number("young")?, poisson: number("poisson")? })
    }

    /// The shortest period (s) of a node of the body: `T = 2π√(m/k)` with its [lightest](Body::lightest) node and the
    /// [greatest stiffness](Self::stiffest) of its [materials](Body::modulus). Time steps can be given as fractions of it.
    pub fn shortest_period(&self, body: &Body) -> f64 {
        let modulus = body.modulus().and_then(|moduli| moduli.iter().copied().reduce(f64::max)).unwrap_or(1.0);
        std::f64::consts::TAU * (body.lightest() / (self.stiffest * modulus)).sqrt()
    }
}
