//! Which column is whose, of the joints of an arm.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    Role,
    roles::{best, fit_plain},
    unit_in_name,
};

/// Names that can be one joint's, with what such a name says of its unit.
type Found<'a> = Vec<(&'a str, Option<&'static str>)>;

/// The path of one joint's value in an array of messages, which says by names of which joints.
#[must_use]
pub fn array_by_name(array: &str, joint: &str) -> String {
    let (array, functions) = match array.find(".@") {
        Some(at) => array.split_at(at),
        None => (array, ""),
    };
    format!("{array}[:]{{name=={joint:?}}}{functions}")
}

/// For each of `joints`, those of `names` that can be called after the role of this joint: the
/// best ones, which fit equally well. A name says of which joint it is by the joint's name
/// (`q_elbow`, also without what all joints have in common, as in `elbow_joint`) or, where that
/// tells more of them, by a number (`q1`).
#[must_use]
pub fn by_joint<'a>(role: Role, joints: &[&str], names: &[&'a str]) -> Vec<Found<'a>> {
    let by_name = |called: &[&str]| -> Vec<Found<'a>> {
        let each = called.iter().map(|joint| {
            let rest = names.iter().map(|name| (*name, without(name, joint)));
            best(rest.map(|(name, rest)| (name, rest.and_then(|rest| fit_plain(role, &rest)))))
        });
        each.collect()
    };
    let ways = [
        by_name(joints),
        by_name(&in_short(joints)),
        by_number(role, joints, names),
    ];
    // One way for all joints: `joint1` may be the first one of some columns, and the second
    // one, counted from 0, of others.
    let known = |found: &Vec<Found<'a>>| found.iter().filter(|own| !own.is_empty()).count();
    let most = ways.iter().map(known).max();
    let mut ways = ways.into_iter();
    let found = ways.find(|own| Some(known(own)) == most);
    found.unwrap_or_else(|| vec![Vec::new(); joints.len()])
}

/// What is left of a name that has the joint's in it as a word of its own, without its unit.
fn without(name: &str, joint: &str) -> Option<String> {
    if name.starts_with('/') {
        let path = name.strip_suffix(&format!("[:]{{name=={joint:?}}}"))?;
        return path.rsplit(['.', '/']).next().map(str::to_owned);
    }
    if joint.is_empty() {
        return None;
    }
    let plain = unit_in_name(name).0;
    let (small, joint) = (plain.to_lowercase(), joint.to_lowercase());
    let is_word = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    let mut places = small.match_indices(&joint).filter_map(|(at, _)| {
        let (before, after) = (small.get(..at)?, small.get(at + joint.len()..)?);
        let apart = !is_word(before.chars().next_back()) && !is_word(after.chars().next());
        let rest = [before, after].map(|part| part.trim_matches(is_separator));
        apart.then(|| rest.join("_").trim_matches('_').to_owned())
    });
    // `elbow_joint_position` of a joint that is called `elbow` in short.
    let rest = places.next()?;
    let rest = rest.strip_prefix("joint_").unwrap_or(&rest);
    Some(rest.strip_suffix("_joint").unwrap_or(rest).to_owned())
}

fn is_separator(c: char) -> bool {
    matches!(c, '_' | '-' | '.' | ' ' | '/' | '[' | ']' | '(' | ')' | ':')
}

/// The joints' names without the words that all of them begin or end with.
fn in_short<'a>(joints: &[&'a str]) -> Vec<&'a str> {
    let mut short = joints.to_vec();
    loop {
        let heads = common(short.iter().map(|own| own.split_once('_')), |(head, _)| {
            head
        });
        let tails = common(short.iter().map(|own| own.rsplit_once('_')), |(_, tail)| {
            tail
        });
        short = match (heads, tails) {
            (Some(parts), _) => parts.into_iter().map(|(_, rest)| rest).collect(),
            (None, Some(parts)) => parts.into_iter().map(|(rest, _)| rest).collect(),
            (None, None) => return short,
        };
    }
}

/// All of the pairs, if there are several and all have the same word.
fn common<'a>(
    pairs: impl Iterator<Item = Option<(&'a str, &'a str)>>,
    word: fn((&'a str, &'a str)) -> &'a str,
) -> Option<Vec<(&'a str, &'a str)>> {
    let pairs: Vec<(&str, &str)> = pairs.collect::<Option<_>>()?;
    let words: BTreeSet<&str> = pairs.iter().map(|own| word(*own)).collect();
    (pairs.len() > 1 && words.len() == 1).then_some(pairs)
}

/// By the numbers in the names, those in the joints' own names or counted from the base on.
fn by_number<'a>(role: Role, joints: &[&str], names: &[&'a str]) -> Vec<Found<'a>> {
    let own: Option<Vec<u32>> = joints
        .iter()
        .map(|joint| Some(numbered(joint)?.1))
        .collect();
    let own = own.filter(|own| own.iter().collect::<BTreeSet<_>>().len() == joints.len());
    let mut groups: BTreeMap<String, BTreeMap<u32, &'a str>> = BTreeMap::new();
    // The order of an array in messages may be another than the arm's.
    for name in names.iter().filter(|name| !name.starts_with('/')) {
        if let Some((base, number)) = numbered(unit_in_name(name).0) {
            groups.entry(base).or_default().insert(number, name);
        }
    }
    let count = joints.len() as u32;
    let whole = groups.into_iter().filter_map(|(base, group)| {
        let all = |numbers: &[u32]| -> Option<Vec<&'a str>> {
            let each = numbers.iter().map(|number| group.get(number).copied());
            each.collect()
        };
        let counted = [0, 1].map(|from| (from..from + count).collect::<Vec<u32>>());
        let counted = counted.iter().filter(|_| group.len() == joints.len());
        let columns = own.as_deref().and_then(all);
        let columns = columns.or_else(|| counted.filter_map(|numbers| all(numbers)).next())?;
        Some((columns, fit_plain(role, &base)))
    });
    let groups = best(whole);
    let of_joint = |at: usize| {
        let each = groups.iter();
        let names = each.filter_map(|(columns, unit)| Some((*columns.get(at)?, *unit)));
        names.collect()
    };
    (0..joints.len()).map(of_joint).collect()
}

/// A name without its last number and the word `joint`, and that number.
fn numbered(name: &str) -> Option<(String, u32)> {
    let is_digit = |c: char| c.is_ascii_digit();
    let end = name.rfind(is_digit)? + 1;
    let (head, tail) = name.split_at_checked(end)?;
    let start = head.trim_end_matches(is_digit).len();
    let number = head.get(start..)?.parse().ok()?;
    let head = head.get(..start)?.to_lowercase();
    let tail = tail.to_lowercase();
    let parts = [head.as_str(), tail.as_str()].map(|part| part.trim_matches(is_separator));
    let words = parts.iter().flat_map(|part| part.split(is_separator));
    let words = words.filter(|word| !word.is_empty() && *word != "joint");
    Some((words.collect::<Vec<&str>>().join("_"), number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one<'a>(joints: &[&str], names: &[&'a str]) -> [Vec<Option<&'a str>>; 2] {
        [Role::Position, Role::MotorTorque].map(|role| {
            let found = by_joint(role, joints, names).into_iter();
            let only = found.map(|own| match own.as_slice() {
                [(name, _)] => Some(*name),
                _ => None,
            });
            only.collect()
        })
    }

    #[test]
    fn joints_are_known_by_their_names_or_numbers() {
        let arms = [
            (
                ["shoulder", "elbow"],
                vec![
                    "t",
                    "q_shoulder",
                    "q_elbow",
                    "qd_elbow",
                    "tau_shoulder",
                    "tau_elbow",
                ],
                [["q_shoulder", "q_elbow"], ["tau_shoulder", "tau_elbow"]],
            ),
            (
                ["left_shoulder_joint", "left_elbow_joint"],
                vec![
                    "Elbow pos [deg]",
                    "Shoulder pos [deg]",
                    "Elbow torque",
                    "Shoulder torque",
                ],
                [
                    ["Shoulder pos [deg]", "Elbow pos [deg]"],
                    ["Shoulder torque", "Elbow torque"],
                ],
            ),
            (
                ["panda_joint1", "panda_joint2"],
                vec![
                    "q1", "q2", "dq1", "dq2", "tau_J_1", "tau_J_2", "tau_1", "tau_2",
                ],
                [["q1", "q2"], ["tau_1", "tau_2"]],
            ),
            (
                ["panda_joint1", "panda_joint2"],
                vec!["q0_deg", "q1_deg", "joint0_effort", "joint1_effort"],
                [["q0_deg", "q1_deg"], ["joint0_effort", "joint1_effort"]],
            ),
            (
                ["joint1", "joint10"],
                vec![
                    "joint1_position",
                    "joint10_position",
                    "joint1_effort",
                    "joint10_effort",
                ],
                [
                    ["joint1_position", "joint10_position"],
                    ["joint1_effort", "joint10_effort"],
                ],
            ),
        ];
        for (joints, names, expected) in arms {
            let expected = expected.map(|own| own.map(Some).to_vec());
            assert_eq!(one(&joints, &names), expected, "{joints:?}");
        }
        let by_name = ["shoulder", "elbow"].map(|own| array_by_name("/js.effort.@abs", own));
        assert_eq!(by_name[1], "/js.effort[:]{name==\"elbow\"}.@abs");
        let paths = ["position", "velocity", "effort"].map(|array| {
            ["shoulder", "elbow"].map(|own| array_by_name(&format!("/js.{array}"), own))
        });
        let mut names: Vec<&str> = paths.iter().flatten().map(String::as_str).collect();
        names.extend(["/js.position[0]", "/js.position[1]"]);
        let found = one(&["shoulder", "elbow"], &names);
        assert_eq!(found[0], paths[0].each_ref().map(|own| Some(own.as_str())));
        assert_eq!(found[1], paths[2].each_ref().map(|own| Some(own.as_str())));
    }

    #[test]
    fn what_can_be_two_things_is_not_chosen() {
        let names = ["q_elbow", "q-elbow", "q_shoulder", "tau_shoulder"];
        let [position, torque] = one(&["shoulder", "elbow"], &names);
        assert_eq!(position, [Some("q_shoulder"), None]);
        assert_eq!(torque, [Some("tau_shoulder"), None]);
        // Three columns with numbers are not those of two joints.
        let [position, _] = one(&["a", "b"], &["q1", "q2", "q3"]);
        assert_eq!(position, [None, None]);
    }
}
