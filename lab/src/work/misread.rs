//! What is said of joints of an arm that are read otherwise than the model has them.

use ferntast_identification::arm::Misread;

use crate::{
    experiment::{ArmTable, JointReading},
    report::significant,
};

/// What is said of joints that are read otherwise than the model has them, and how to mend it.
#[must_use]
pub fn tell_misread(arm: &ArmTable, misread: &[Misread]) -> Vec<String> {
    let words = |own: &Misread| in_words(own, arm.torque_unit(Some(&own.joint)));
    let mut told: Vec<String> = misread.iter().map(words).collect();
    told.extend(gains(arm, misread));
    let lines = lines(arm, misread);
    if !lines.is_empty() {
        told.push(format!(
            "if that is so, write into [arm]:  {}",
            lines.join("  ")
        ));
    }
    if misread
        .iter()
        .any(|own| own.is_read_as.is_some() || own.torque_is_read_as.is_some())
    {
        told.push(
            "if that is so, put the joints' paths or columns in the other order in [signals]"
                .to_owned(),
        );
    }
    told
}

fn in_words(own: &Misread, unit: &str) -> String {
    let mut parts = Vec::new();
    if let Some(other) = &own.is_read_as {
        parts.push(format!("position and torque are those of {other}"));
    }
    if let Some(other) = &own.torque_is_read_as {
        parts.push(format!("the torque is that of {other}"));
    }
    match (own.reversed, own.torque_reversed) {
        (true, true) => parts.push("the position counts the other way round".to_owned()),
        (true, false) => {
            parts.push("position and torque count the other way round".to_owned());
        }
        (false, true) => parts.push("the torque counts the other way round".to_owned()),
        (false, false) => {}
    }
    if own.zero != 0.0 {
        let degrees = own.zero.to_degrees();
        parts.push(format!("the position lacks {degrees:+.0} degrees"));
    }
    if let Some(gain) = own.torque_of_one {
        parts.push(format!(
            "the torque is not in {unit}: by the weight of its links 1 of it is some {} {unit}",
            significant(gain)
        ));
    }
    format!(
        "{}: {}; read so, {:.3} {unit} of its torque are left in place of {:.3}",
        own.joint,
        parts.join(", and "),
        own.error_after,
        own.error_before
    )
}

/// How torques in another unit are mended: those of the other joints may be, too.
fn gains(arm: &ArmTable, misread: &[Misread]) -> Option<String> {
    let mut is_known = false;
    let each = arm
        .joints()
        .iter()
        .zip(&arm.readings)
        .map(|(joint, reading)| {
            let own = misread.iter().find(|own| own.joint == *joint);
            let gain = own.and_then(|own| own.torque_of_one)?;
            is_known = true;
            Some(gain * reading.drive_gain.unwrap_or(1.0))
        });
    let each: Vec<String> = each
        .map(|gain| gain.map_or_else(|| "?".to_owned(), significant))
        .collect();
    is_known.then(|| {
        format!(
            "if that is so, say the torques' unit in [signals]; of currents, or torques before a gear, write into [arm] \
             what torque at each joint 1 of them makes, best from the makers' torque constants and gear ratios:  \
             drive_gain = [{}]",
            each.join(", ")
        )
    })
}

/// The keys of `[arm]` with which joints are read as the model has them.
fn lines(arm: &ArmTable, misread: &[Misread]) -> Vec<String> {
    let both = arm.joints().iter().zip(&arm.readings);
    let mended: Vec<(&String, JointReading)> = both
        .map(|(joint, reading)| {
            let own = misread.iter().find(|own| own.joint == *joint);
            (joint, own.map_or(*reading, |own| reading.then(own)))
        })
        .collect();
    // A key that was there is said again, also where it has nothing left.
    let list = |key: &str, is: fn(&JointReading) -> bool| {
        let those = mended.iter().filter(|(_, reading)| is(reading));
        let names: Vec<String> = those.map(|(joint, _)| format!("{joint:?}")).collect();
        let was = arm.readings.iter().any(is);
        (was || !names.is_empty()).then(|| format!("{key} = [{}]", names.join(", ")))
    };
    let zeros: Vec<String> = (mended.iter())
        .filter(|(_, reading)| reading.zero.abs() > 1e-9)
        .map(|(joint, reading)| format!("{joint} = {:.6}", reading.zero))
        .collect();
    let had_zeros = arm.readings.iter().any(|own| own.zero != 0.0);
    let turned = [
        list("reversed", |own| own.reversed),
        list("torque_reversed", |own| own.torque_reversed),
        (had_zeros || !zeros.is_empty()).then(|| format!("zero = {{ {} }}", zeros.join(", "))),
    ];
    let is_of_readings = |own: &Misread| own.reversed || own.torque_reversed || own.zero != 0.0;
    match misread.iter().any(is_of_readings) {
        true => turned.into_iter().flatten().collect(),
        false => Vec::new(),
    }
}
