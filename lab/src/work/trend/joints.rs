//! Which experiments are held beside each other: those of the same joint.

use super::{super::Opened, TrendError};

/// The experiments of each joint over the files, and what has to be known besides.
type OfEach<'a> = (Vec<Vec<&'a Opened>>, Vec<String>);

/// Of experiment files the joints by their order; of recordings of sessions, in which joints
/// that stand still are left out, by their names.
pub(super) fn of_each(files: &[Vec<Opened>]) -> Result<OfEach<'_>, TrendError> {
    let experiments = || files.iter().flatten().map(|own| &own.experiment);
    if experiments().all(|own| own.path.is_none()) {
        return by_name(files);
    }
    let count = files.first().map_or(0, Vec::len);
    if let Some(other) = files.iter().find(|file| file.len() != count) {
        return Err(TrendError::Joints(count, other.len()));
    }
    let of = |joint: usize| files.iter().filter_map(|file| file.get(joint)).collect();
    Ok(((0..count).map(of).collect(), Vec::new()))
}

fn by_name(files: &[Vec<Opened>]) -> Result<OfEach<'_>, TrendError> {
    let mut names: Vec<&str> = Vec::new();
    for own in files.iter().flatten() {
        let title = own.experiment.title.as_str();
        if !names.contains(&title) {
            names.push(title);
        }
    }
    let (mut joints, mut notes) = (Vec::new(), Vec::new());
    for name in &names {
        let of_file =
            |file: &'_ Vec<Opened>| file.iter().position(|own| own.experiment.title == *name);
        let own = files.iter().filter_map(|file| file.get(of_file(file)?));
        let own: Vec<&Opened> = own.collect();
        match own.len() == files.len() {
            true => joints.push(own),
            false => notes.push(format!(
                "{name} moves in {} of the {} recordings, so that there is no trend of it",
                own.len(),
                files.len()
            )),
        }
    }
    match joints.is_empty() {
        true => Err(TrendError::NoJoint(names.join(", "))),
        false => Ok((joints, notes)),
    }
}
