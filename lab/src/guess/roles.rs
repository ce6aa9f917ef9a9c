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
    /// r, the place along a contour.
    Place,
    /// x of the tip of a contact.
    TipX,
    /// y of that.
    TipY,
    /// F_T, which opposes a motion to larger places.
    TangentialForce,
    /// F_N, which pushes the tip out.
    NormalForce,
}

impl Role {
    /// The signal's key in an experiment file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Role::Time => "time",
            Role::Position | Role::Place => "position",
            Role::TipX => "tip[0]",
            Role::TipY => "tip[1]",
            Role::TangentialForce => "tangential_force",
            Role::NormalForce => "normal_force",
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
            Role::Place => &[
                ("place", None),
                ("along", None),
                ("position", None),
                ("pos", None),
                ("r", None),
                ("x", None),
            ],
            Role::TipX => &[("tip_x", None), ("x_tip", None), ("x", None)],
            Role::TipY => &[("tip_y", None), ("y_tip", None), ("y", None)],
            Role::TangentialForce => &[
                ("tangential_force", None),
                ("force_tangential", None),
                ("tangential", None),
                ("f_t", None),
                ("ft", None),
                ("friction_force", None),
                ("friction", None),
            ],
            Role::NormalForce => &[
                ("normal_force", None),
                ("force_normal", None),
                ("normal", None),
                ("f_n", None),
                ("fn", None),
            ],
        }
    }

    /// Ends of message paths that are this of a contact, the best ones first: what our own
    /// recordings have, and others with poses and wrenches by those names.
    const fn paths(self) -> &'static [&'static str] {
        match self {
            Role::Place | Role::TipX => &[
                "/follower/measured_cp.pose.position.x",
                "/measured_cp.pose.position.x",
            ],
            Role::TipY => &[
                "/follower/measured_cp.pose.position.y",
                "/measured_cp.pose.position.y",
            ],
            Role::TangentialForce => &[
                "/follower/contact_cf.wrench.force.x",
                "/contact_cf.wrench.force.x",
            ],
            Role::NormalForce => &[
                "/follower/contact_cf.wrench.force.z",
                "/contact_cf.wrench.force.z",
            ],
            _ => &[],
        }
    }
}

/// A path whose values have the sign of a tangential force, for one that is the force on the tip,
/// which the tip's motion goes against; `None` for any other.
#[must_use]
pub fn opposes(path: &str) -> Option<String> {
    let ends = Role::TangentialForce.paths().iter();
    let mut ends = ends.filter(|end| path.ends_with(**end));
    ends.next().map(|_| format!("{path}.@negative"))
}

/// How well a name fits; the greater the better.
fn fit(role: Role, name: &str) -> Fit {
    let end = role.paths().iter().position(|end| name.ends_with(end));
    if let Some(rank) = end {
        return Some((2000 - rank as u32, None));
    }
    // Every message has an x.
    let is_letter = name
        .rsplit(['.', '/'])
        .next()
        .is_some_and(|own| own.len() == 1);
    if !role.paths().is_empty() && name.starts_with('/') && is_letter {
        return None;
    }
    // Of a message path what is below the topic, without its index.
    let plain = match name.starts_with('/') {
        true => name.rsplit(['.', '/']).next().unwrap_or(name),
        false => unit_in_name(name).0,
    };
    fit_plain(role, plain.split('[').next().unwrap_or(plain))
}

/// The greater the better, and what such a name says of its unit.
pub(super) type Fit = Option<(u32, Option<&'static str>)>;

/// The same of a name without its unit.
pub(super) fn fit_plain(role: Role, plain: &str) -> Fit {
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
    best(names.iter().map(|name| (*name, fit(role, name))))
}

/// Those that fit best, equally well.
pub(super) fn best<T>(rated: impl Iterator<Item = (T, Fit)>) -> Vec<(T, Option<&'static str>)> {
    let rated = rated.filter_map(|(own, fit)| fit.map(|(score, unit)| (score, own, unit)));
    let rated: Vec<(u32, T, Option<&'static str>)> = rated.collect();
    let best = rated.iter().map(|(score, ..)| *score).max();
    let best = rated.into_iter().filter(|(score, ..)| Some(*score) == best);
    best.map(|(_, own, unit)| (own, unit)).collect()
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
        let contact = ["t", "x_mm", "F_T", "F_N", "tip x [mm]", "tip y [mm]"];
        let one = |role| by_name(role, &contact).first().copied();
        assert_eq!(one(Role::Place), Some(("x_mm", None)));
        assert_eq!(one(Role::TangentialForce), Some(("F_T", None)));
        assert_eq!(one(Role::NormalForce), Some(("F_N", None)));
        assert_eq!(one(Role::TipX), Some(("tip x [mm]", None)));
        assert_eq!(one(Role::TipY), Some(("tip y [mm]", None)));
        let own = [
            "/leader/measured_cp.pose.position.x",
            "/follower/measured_cp.pose.position.x",
            "/follower/measured_cv.twist.linear.x",
            "/follower/contact_cf.wrench.force.x",
            "/follower/contact_cf.wrench.force.z",
        ];
        let all = |role| by_name(role, &own);
        assert_eq!(all(Role::Place), [(own[1], None)]);
        assert_eq!(all(Role::TangentialForce), [(own[3], None)]);
        assert_eq!(all(Role::NormalForce), [(own[4], None)]);
        assert!(all(Role::TipY).is_empty());
        let turned = format!("{}.@negative", own[3]);
        assert_eq!((opposes(own[3]), opposes(own[4])), (Some(turned), None));
        let paths = ["/js.position[0]", "/js.position[1]", "/js.effort[0]"];
        assert_eq!(by_name(Role::Position, &paths).len(), 2);
        assert_eq!(
            by_name(Role::MotorTorque, &paths),
            [("/js.effort[0]", None)]
        );
    }
}
