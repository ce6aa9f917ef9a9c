//! Which laws a session can run, and with which parameters.

use ferntast_control::{delay::Law, switching::Laws};
use serde_json::Value;

use super::Scenario;

/// Keys that say how hand and tip correspond: a switch of the law must not
/// change them, or the arm would be told to be elsewhere.
const SHARED: [&str; 2] = ["position_scale", "workspace_offset"];

/// A law that there is not.
#[derive(Debug, thiserror::Error)]
#[error("there is no delay law {name:?}; there are: {known}")]
pub struct UnknownLaw {
    /// What was asked for.
    pub name: String,
    /// What there is.
    pub known: String,
}

impl UnknownLaw {
    /// That there is no law `name`.
    pub fn new(name: &str) -> UnknownLaw {
        UnknownLaw {
            name: name.to_owned(),
            known: Law::NAMES.join(", "),
        }
    }
}

impl Scenario {
    /// The law of that name as this scenario has it.
    ///
    /// # Errors
    ///
    /// There is none of that name.
    pub fn law_named(&self, name: &str) -> Result<Law, UnknownLaw> {
        let mut given = std::iter::once(&self.law).chain(&self.laws);
        if let Some(law) = given.find(|law| law.name() == name) {
            return Ok(law.clone());
        }
        let law = Law::by_name(name).ok_or_else(|| UnknownLaw::new(name))?;
        Ok(with_shared(&law, &self.law))
    }

    /// Starts with the law of that name.
    ///
    /// # Errors
    ///
    /// There is none of that name.
    pub fn set_law(&mut self, name: &str) -> Result<(), UnknownLaw> {
        let law = self.law_named(name)?;
        let before = std::mem::replace(&mut self.law, law);
        if !self.laws.iter().any(|own| own.name() == before.name()) {
            self.laws.push(before);
        }
        Ok(())
    }

    /// Every law that it can run.
    pub fn laws(&self) -> Laws {
        Law::NAMES
            .iter()
            .filter_map(|name| self.law_named(name).ok())
            .fold(Laws::new(self.law.clone()), Laws::with)
    }
}

/// `law` with what it shares with `other`.
fn with_shared(law: &Law, other: &Law) -> Law {
    let (Ok(Value::Object(mut own)), Ok(Value::Object(other))) =
        (serde_json::to_value(law), serde_json::to_value(other))
    else {
        return law.clone();
    };
    for key in SHARED {
        if let (Some(place), Some(value)) = (own.get_mut(key), other.get(key)) {
            *place = value.clone();
        }
    }
    serde_json::from_value(Value::Object(own)).unwrap_or_else(|_| law.clone())
}

#[cfg(test)]
mod tests {
    use super::super::load_scenario;

    #[test]
    fn another_law_keeps_the_offset_and_the_first_law_stays_as_given() {
        let mut scenario = load_scenario("rokviss").unwrap().scenario;
        let offset = [0.3, 0.01, 0.0];
        let text = serde_json::to_value(&scenario.law).unwrap();
        let mut text = text.as_object().unwrap().clone();
        text["workspace_offset"] = serde_json::json!(offset);
        scenario.law = serde_json::from_value(text.into()).unwrap();
        let first = scenario.law.clone();
        scenario.set_law("wave").unwrap();
        assert_eq!(scenario.law.name(), "wave");
        assert_eq!(scenario.law.mapping().workspace_offset, offset);
        assert_eq!(scenario.law_named(first.name()).unwrap(), first);
        assert!(scenario.set_law("nonsense").is_err());
    }
}
