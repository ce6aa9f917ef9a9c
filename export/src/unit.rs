//! Units of numbers in messages: those that ROS gives to its common types, and those
//! that stand in brackets in the comment of a field.

use ferntast_lab::message_path::Step;

/// Fields of common types whose unit their definition says in words (REP 103).
const COMMON: [(&str, &str, &str); 21] = [
    ("sensor_msgs/JointState", "position", "rad"),
    ("sensor_msgs/JointState", "velocity", "rad/s"),
    ("sensor_msgs/JointState", "effort", "Nm"),
    ("sensor_msgs/Temperature", "temperature", "degC"),
    ("sensor_msgs/Imu", "angular_velocity", "rad/s"),
    ("sensor_msgs/Imu", "linear_acceleration", "m/s2"),
    ("sensor_msgs/BatteryState", "voltage", "V"),
    ("sensor_msgs/BatteryState", "current", "A"),
    ("sensor_msgs/FluidPressure", "fluid_pressure", "Pa"),
    ("sensor_msgs/MagneticField", "magnetic_field", "T"),
    ("sensor_msgs/Range", "range", "m"),
    ("geometry_msgs/Wrench", "force", "N"),
    ("geometry_msgs/Wrench", "torque", "Nm"),
    ("geometry_msgs/Pose", "position", "m"),
    ("geometry_msgs/PointStamped", "point", "m"),
    ("geometry_msgs/Transform", "translation", "m"),
    ("geometry_msgs/Twist", "linear", "m/s"),
    ("geometry_msgs/Twist", "angular", "rad/s"),
    ("geometry_msgs/Accel", "linear", "m/s2"),
    ("geometry_msgs/Accel", "angular", "rad/s2"),
    ("builtin_interfaces/Time", "sec", "s"),
];

/// The unit of the number at `steps` in messages of the type `name` with that schema
/// (`ros2msg`): its own, else that of what it is a part of.
pub fn unit_at(name: &str, schema: &str, steps: &[Step]) -> Option<String> {
    let mut kind = bare(name);
    let mut section = Some(schema.split("\n===").next().unwrap_or_default());
    let mut unit = None;
    for step in steps {
        let Step::Field(field) = step else {
            continue;
        };
        let line = section.and_then(|text| line_of(text, field));
        let common = COMMON
            .iter()
            .find(|(of, name, _)| *of == kind && name == field)
            .map(|(_, _, unit)| (*unit).to_owned());
        unit = common.or_else(|| line.and_then(in_comment)).or(unit);
        let declared = line.and_then(|line| line.split_whitespace().next());
        kind = whole(declared.unwrap_or_default(), &kind);
        section = section_of(schema, &kind);
    }
    unit
}

/// `package/Type`, without `msg` between and without what makes it an array.
fn bare(name: &str) -> String {
    let name = name.split('[').next().unwrap_or_default();
    name.replace("/msg/", "/")
}

/// The type `name` as `user`, a type that has it within, names it: of its own package where
/// it names none.
fn whole(name: &str, user: &str) -> String {
    let name = bare(name);
    match (name.contains('/'), user.split_once('/')) {
        (false, Some((package, _))) => format!("{package}/{name}"),
        _ => name,
    }
}

/// The line that declares `field`.
fn line_of<'a>(section: &'a str, field: &str) -> Option<&'a str> {
    section.lines().find(|line| {
        let mut words = line
            .split('#')
            .next()
            .unwrap_or_default()
            .split_whitespace();
        words.next().is_some() && words.next() == Some(field)
    })
}

/// What stands in brackets in a line's comment; nothing for what has no unit.
fn in_comment(line: &str) -> Option<String> {
    let (_, comment) = line.split_once('#')?;
    let (_, rest) = comment.split_once('[')?;
    let (unit, _) = rest.split_once(']')?;
    let is_unit = !unit.is_empty() && unit != "-" && unit.len() <= 12 && !unit.contains(',');
    is_unit.then(|| unit.to_owned())
}

/// What the schema says of a type that others have within.
fn section_of<'a>(schema: &'a str, kind: &str) -> Option<&'a str> {
    schema.split("\n===").skip(1).find_map(|section| {
        let (_, text) = section.split_once("MSG: ")?;
        let (name, body) = text.split_once('\n')?;
        let name = bare(name.trim());
        (name == kind).then_some(body)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_lab::message_path::MessagePath;

    const WRENCH: &str = "std_msgs/Header header\nWrench wrench\n\
        float64 gap # [mm] to the surface\nfloat64 share # [-] of it\n\
        ================================================================================\n\
        MSG: geometry_msgs/Wrench\nVector3 force\nVector3 torque\n\
        ================================================================================\n\
        MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

    #[test]
    fn units_come_from_common_types_and_from_comments() {
        for (path, unit) in [
            ("/t.wrench.force.x", Some("N")),
            ("/t.wrench.torque.z", Some("Nm")),
            ("/t.gap", Some("mm")),
            ("/t.share", None),
            ("/t.nothing", None),
        ] {
            let steps = MessagePath::parse(path).unwrap().steps;
            let found = unit_at("geometry_msgs/msg/WrenchStamped", WRENCH, &steps);
            assert_eq!(found.as_deref(), unit, "{path}");
        }
        let steps = MessagePath::parse("/t.velocity[1]").unwrap().steps;
        let found = unit_at("sensor_msgs/msg/JointState", "float64[] velocity\n", &steps);
        assert_eq!(found.as_deref(), Some("rad/s"));
    }
}
