//! Which column is which signal, by its name.

use super::unit_in_name;

/// Words by which a signal is called, in small letters, the best ones first; and
/// what such a name says of its unit.
type Words = &'static [(&'static str, Option<&'static str>)];

/// What a signal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// When.
    Time,
    /// q.
    Position,
    /// τ_m, or what goes into the drive.
    MotorTorque,
    /// τ.
    JointTorque,
    /// Temperature.
    Temperature,
}

impl Role {
    /// The signal's key in an experiment file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Role::Time => "time",
            Role::Position => "position",
            Role::MotorTorque => "motor_torque",
            Role::JointTorque => "joint_torque",
            Role::Temperature => "temperature",
        }
    }

    const fn words(self) -> Words {
        match self {
            Role::Time => &[
                ("t", None),
                ("time", None),
                ("timestamp", None),
                ("zeit", None),
                ("stamp", None),
            ],
            Role::Position => &[
                ("q", None),
                ("position", None),
                ("pos", None),
                ("angle", None),
                ("theta", None),
                ("phi", None),
                ("qm", None),
                ("x", Some("m")),
            ],
            Role::MotorTorque => &[
                ("motor_torque", None),
                ("tau_m", None),
                ("taum", None),
                ("torque", None),
                ("tau", None),
                ("effort", None),
                ("force", Some("N")),
                ("current", Some("A")),
                ("i", Some("A")),
                ("iq", Some("A")),
                ("i_q", Some("A")),
                ("voltage", Some("V")),
                ("u", Some("V")),
                ("volts", Some("V")),
                ("applied", None),
            ],
            Role::JointTorque => &[
                ("joint_torque", None),
                ("tau_j", None),
                ("sensor_torque", None),
                ("load_torque", None),
            ],
            Role::Temperature => &[("temperature", None), ("temp", None)],
        }
    }
}

/// How well a name fits; the greater the better.
fn fit(role: Role, name: &str) -> Option<(u32, Option<&'static str>)> {
    // Of a message path what is below the topic, without its index.
    let plain = match name.starts_with('/') {
        true => name.rsplit(['.', '/']).next().unwrap_or(name),
        false => unit_in_name(name).0,
    };
    let plain = plain.split('[').next().unwrap_or(plain);
    let plain = plain.trim().to_lowercase().replace([' ', '-', '.'], "_");
    let mut best = None;
    for (rank, (word, unit)) in role.words().iter().enumerate() {
        let score = match plain == *word {
            true => 1000 - rank as u32,
            // `motor_current`, `position_measured`.
            false if word.len() > 2 && plain.split('_').any(|part| part == *word) => {
                500 - rank as u32
            }
            false => continue,
        };
        if best.is_none_or(|(known, _)| known < score) {
            best = Some((score, *unit));
        }
    }
    best
}

/// Of `names` those that can be called after the role: the best ones, which fit
/// equally well; with what such a name says of its unit.
#[must_use]
pub fn by_name<'a>(role: Role, names: &[&'a str]) -> Vec<(&'a str, Option<&'static str>)> {
    let rated: Vec<(u32, &str, Option<&str>)> = names
        .iter()
        .filter_map(|name| fit(role, name).map(|(score, unit)| (score, *name, unit)))
        .collect();
    let best = rated.iter().map(|(score, ..)| *score).max();
    let best = rated.into_iter().filter(|(score, ..)| Some(*score) == best);
    best.map(|(_, name, unit)| (name, unit)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_are_known_by_their_names() {
        let names = [
            "t_ms",
            "q_deg",
            "q_cmd",
            "motor_current (A)",
            "temp_C",
            "qd",
        ];
        let one = |role| by_name(role, &names).first().copied();
        assert_eq!(one(Role::Time), Some(("t_ms", None)));
        assert_eq!(one(Role::Position), Some(("q_deg", None)));
        assert_eq!(
            one(Role::MotorTorque),
            Some(("motor_current (A)", Some("A")))
        );
        assert_eq!(one(Role::Temperature), Some(("temp_C", None)));
        assert_eq!(one(Role::JointTorque), None);
        let paths = ["/js.position[0]", "/js.position[1]", "/js.effort[0]"];
        assert_eq!(by_name(Role::Position, &paths).len(), 2);
        assert_eq!(
            by_name(Role::MotorTorque, &paths),
            [("/js.effort[0]", None)]
        );
    }
}
