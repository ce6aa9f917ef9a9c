//! The X-series motors that can limit their current (emanual.robotis.com/docs/en/dxl/x).

/// A kind of motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Its maker's name, without the ending that tells its connector.
    pub name: &'static str,
    /// What it calls itself.
    pub number: u16,
    /// What it counts current in \[A\].
    pub current_unit: f64,
}

const fn model(name: &'static str, number: u16, current_unit: f64) -> Model {
    Model {
        name,
        number,
        current_unit,
    }
}

/// All that are known.
pub const MODELS: &[Model] = &[
    model("XC330-T181", 1210, 1e-3),
    model("XC330-T288", 1220, 1e-3),
    model("XC330-M181", 1230, 1e-3),
    model("XC330-M288", 1240, 1e-3),
    model("XH430-W350", 1000, 1.34e-3),
    model("XH430-W210", 1010, 1.34e-3),
    model("XH430-V350", 1040, 1.34e-3),
    model("XH430-V210", 1050, 1.34e-3),
    model("XH540-W270", 1100, 2.69e-3),
    model("XH540-W150", 1110, 2.69e-3),
    model("XH540-V270", 1140, 2.69e-3),
    model("XH540-V150", 1150, 2.69e-3),
    model("XL330-M077", 1190, 1e-3),
    model("XL330-M288", 1200, 1e-3),
    model("XM430-W350", 1020, 2.69e-3),
    model("XM430-W210", 1030, 2.69e-3),
    model("XM540-W270", 1120, 2.69e-3),
    model("XM540-W150", 1130, 2.69e-3),
    model("XW540-T260", 1170, 2.69e-3),
    model("XW540-T140", 1180, 2.69e-3),
];

/// That of `name`, with or without its last letter (`XM430-W350-T`).
pub fn by_name(name: &str) -> Option<Model> {
    let is = |model: &&Model| {
        let rest = name.strip_prefix(model.name);
        rest.is_some_and(|rest| matches!(rest, "" | "-T" | "-R"))
    };
    MODELS.iter().find(is).copied()
}

/// What a motor that calls itself `number` is.
pub fn described(number: u16) -> String {
    match MODELS.iter().find(|model| model.number == number) {
        Some(model) => model.name.to_owned(),
        None => format!("of model number {number}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motor_is_known_by_its_name_and_by_its_number() {
        assert_eq!(
            by_name("XM430-W350-T").map(|model| model.number),
            Some(1020)
        );
        assert_eq!(by_name("XL330-M288").map(|model| model.number), Some(1200));
        assert_eq!(by_name("XL430-W250"), None);
        assert_eq!(described(1130), "XM540-W150");
        for model in MODELS {
            let same = |other: &&Model| other.number == model.number || other.name == model.name;
            assert_eq!(MODELS.iter().filter(same).count(), 1, "{}", model.name);
        }
    }
}
