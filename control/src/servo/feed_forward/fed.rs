//! One effect of what is fed forward.

use ferntast_model::friction::{FrictionState, FrictionTerm, MAX_PARAMETERS, StaticEffect};

pub(super) type Values = [f64; MAX_PARAMETERS];

/// One parameter of the friction that is fed forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FedForward {
    /// Its name in the arm's file.
    pub name: &'static str,
    /// By the arm's file; 0 where that has it not.
    pub configured: f64,
    /// In use now.
    pub value: f64,
    /// What the value is, or is on its way to.
    pub target: f64,
}

/// One effect on its way; `term` holds the coefficients in use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fed {
    pub(super) term: FrictionTerm,
    pub(super) is_configured: bool,
    pub(super) configured: Values,
    pub(super) from: Values,
    pub(super) target: Values,
}

impl Fed {
    pub(super) fn configured(term: FrictionTerm) -> Self {
        Self {
            is_configured: true,
            configured: term.values,
            from: term.values,
            target: term.values,
            term,
        }
    }

    pub(super) fn new(effect: &'static StaticEffect, shape: Values) -> Self {
        let none = [0.0; MAX_PARAMETERS];
        Self {
            is_configured: false,
            ..Self::configured(FrictionTerm {
                effect,
                shape,
                values: none,
            })
        }
    }

    /// Its torque with other coefficients \[Nm\].
    pub(super) fn torque(&self, values: Values, state: &FrictionState) -> f64 {
        FrictionTerm {
            values,
            ..self.term
        }
        .torque(state)
    }

    /// Its torque \[Nm\] with other coefficients in `state`, where those are known in
    /// `known` only: the nearest state to it that they were found in.
    pub(super) fn torque_as_known(
        &self,
        values: Values,
        state: &FrictionState,
        known: &FrictionState,
    ) -> f64 {
        if known == state {
            return self.torque(values, state);
        }
        let change = std::array::from_fn(|i| values[i] - self.configured[i]);
        self.torque(self.configured, state) + self.torque(change, known)
    }

    pub(super) fn parameters(&self) -> impl Iterator<Item = FedForward> + '_ {
        let row = &self.term.effect.row;
        let coefficients = row.coefficients.iter().enumerate();
        let coefficients = coefficients.map(|(i, own)| FedForward {
            name: own.key,
            configured: self.configured[i],
            value: self.term.values[i],
            target: self.target[i],
        });
        let shape = row.shape.iter().zip(self.term.shape);
        coefficients.chain(shape.map(|(own, value)| FedForward {
            name: own.key,
            configured: if self.is_configured { value } else { 0.0 },
            value,
            target: value,
        }))
    }
}
