//! Which laws a session can run, and with which parameters.

use ferntast_control::{delay::Law, servo, switching::Laws};
use serde_json::Value;

use super::{Believed, Loaded, Scenario};

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
}

impl Loaded {
    /// Every law that the session can run. What a law takes for the servo's
    /// stiffness is at least that of this arm ([`servo::stiffest`]): with less, it
    /// would hold the work of the servo's spring for too small, and claim a
    /// passivity that it does not have.
    pub fn laws(&self) -> Laws {
        let scenario = &self.scenario;
        let least = match &self.arm.model {
            Believed::Planar(model) => servo::stiffest(model, &scenario.servo),
            Believed::Serial(serial) => servo::stiffest_serial(&serial.arm, &scenario.servo),
        };
        let own = |law: &Law| match least {
            Some(least) => stiff_enough(law, least),
            None => law.clone(),
        };
        Law::NAMES
            .iter()
            .filter_map(|name| scenario.law_named(name).ok())
            .fold(Laws::new(own(&scenario.law)), |laws, law| {
                laws.with(own(&law))
            })
    }
}

/// Key of the stiffness of the arm's servo at the tip \[N/m\].
const SERVO_STIFFNESS: &str = "servo_stiffness";
/// Key of the law inside of another one.
const INNER_LAW: &str = "inside";

/// `law` with a servo no softer than `least` \[N/m\] ([`servo::stiffest`]), if it asks for one.
pub fn stiff_enough(law: &Law, least: f64) -> Law {
    let Ok(mut own) = serde_json::to_value(law) else {
        return law.clone();
    };
    let stiffen = |section: Option<&mut Value>| {
        let place = section.and_then(|own| own.get_mut(SERVO_STIFFNESS));
        if let Some(place) = place.filter(|own| own.as_f64().is_some_and(|own| own < least)) {
            *place = Value::from(least);
        }
    };
    stiffen(own.get_mut(INNER_LAW));
    stiffen(Some(&mut own));
    let stiff = serde_json::from_value::<Law>(own);
    stiff
        .ok()
        .filter(|law| law.validate().is_ok())
        .unwrap_or_else(|| law.clone())
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
    use super::super::{load_model_only, load_scenario};
    use super::*;

    #[test]
    fn another_law_keeps_the_offset_and_the_first_law_stays_as_given() {
        let mut scenario = load_scenario("rokviss", load_model_only).unwrap().scenario;
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

    #[test]
    fn no_law_takes_the_servo_for_softer_than_it_is() {
        let loaded = load_scenario("rokviss", load_model_only).unwrap();
        let least =
            servo::stiffest(loaded.arm.model.planar().unwrap(), &loaded.scenario.servo).unwrap();
        // k = 1/(1/8000 + 1/4900) Nm/rad over the short lever, at the nominal point.
        assert!((120e3..135e3).contains(&least), "{least} N/m");
        let stiffness = |law: &Law| serde_json::to_value(law).unwrap()[SERVO_STIFFNESS].as_f64();
        for law in Law::all() {
            let own = stiff_enough(&law, least);
            assert_eq!(own.name(), law.name());
            assert_eq!(stiffness(&own), stiffness(&law).map(|_| least));
            // Stiffer is left as given.
            assert_eq!(stiff_enough(&own, 1.0), own);
        }
    }
}
