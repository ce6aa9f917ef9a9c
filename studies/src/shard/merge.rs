//! Parts put together.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{
    Answers, Part, PartError, Study,
    part::{no_part, text},
};

/// Why parts are no whole.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// One cannot be read.
    #[error(transparent)]
    Part(#[from] PartError),
    /// None was given.
    #[error("no part was given")]
    Nothing,
    /// Two answer different questions.
    #[error(
        "{second} is a part of something else than {first}: what was asked differs, or in how many parts; \
         run all parts with the same options"
    )]
    Different {
        /// A part.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
    /// Two were made by different programs, whose answers may differ.
    #[error(
        "{first} was made by ferntast {by_first}, {second} by {by_second}: run one of them again"
    )]
    Version {
        /// A part.
        first: PathBuf,
        /// Its program.
        by_first: String,
        /// The other.
        second: PathBuf,
        /// Its program.
        by_second: String,
    },
    /// One was given twice.
    #[error("{first} and {second} are both part {number} of {of}")]
    Twice {
        /// A part.
        first: PathBuf,
        /// The other.
        second: PathBuf,
        /// Which.
        number: u32,
        /// Of how many.
        of: u32,
    },
    /// Some are not there.
    #[error("of {of} parts these are missing: {missing}")]
    Missing {
        /// Their numbers.
        missing: String,
        /// Of how many.
        of: u32,
    },
}

/// What kind of study the part in a file is of.
///
/// # Errors
///
/// The file cannot be read, or is no part.
pub fn kind(path: &Path) -> Result<String, PartError> {
    #[derive(Deserialize)]
    struct Kind {
        kind: String,
    }
    let of: Kind = toml::from_str(&text(path)?).map_err(|error| no_part(path, &error))?;
    Ok(of.kind)
}

/// The study that the parts in these files are of, and all its answers in their order.
///
/// # Errors
///
/// A file that is no part of it, a part that is missing.
pub fn merge<S: Study>(paths: &[PathBuf]) -> Result<(S, Answers<S>), MergeError> {
    let mut parts: Vec<(&PathBuf, Part<S>)> = Vec::new();
    for path in paths {
        let part = Part::<S>::read(path)?;
        if let Some((first, known)) = parts.first() {
            if known.study != part.study || known.shard.of() != part.shard.of() {
                return Err(MergeError::Different {
                    first: (*first).clone(),
                    second: path.clone(),
                });
            }
            if known.ferntast != part.ferntast {
                return Err(MergeError::Version {
                    first: (*first).clone(),
                    by_first: known.ferntast.clone(),
                    second: path.clone(),
                    by_second: part.ferntast,
                });
            }
        }
        parts.push((path, part));
    }
    parts.sort_by_key(|(_, part)| part.shard);
    if let Some([first, second]) = parts
        .array_windows()
        .find(|[first, second]| first.1.shard == second.1.shard)
    {
        return Err(MergeError::Twice {
            first: first.0.clone(),
            second: second.0.clone(),
            number: first.1.shard.number(),
            of: first.1.shard.of(),
        });
    }
    let of = parts.first().ok_or(MergeError::Nothing)?.1.shard.of();
    let is_there = |number: &u32| parts.iter().any(|own| own.1.shard.number() == *number);
    let missing: Vec<String> = (1..=of)
        .filter(|number| !is_there(number))
        .map(|number| number.to_string())
        .collect();
    if !missing.is_empty() {
        return Err(MergeError::Missing {
            missing: missing.join(", "),
            of,
        });
    }
    let mut study = None;
    let mut answers = Vec::new();
    for (_, part) in parts {
        study.get_or_insert(part.study);
        answers.extend(part.answer);
    }
    answers.sort_by_key(|own| own.place);
    Ok((study.ok_or(MergeError::Nothing)?, answers))
}

#[cfg(test)]
mod tests {
    use super::super::{Placed, Shard};
    use super::*;

    /// Asks for square roots.
    #[derive(Clone, Debug, PartialEq, serde::Serialize, Deserialize)]
    struct Roots {
        up_to: u32,
    }

    impl Study for Roots {
        const KIND: &'static str = "roots";
        type Answer = f64;
    }

    fn part(up_to: u32, shard: &str) -> Part<Roots> {
        let shard: Shard = shard.parse().unwrap();
        let all = shard.part_of((0..up_to).collect());
        let answer = all.into_iter().map(|(place, own)| Placed {
            place,
            // Also what is no number comes back as it was.
            value: (f64::from(own) - 1.0).sqrt(),
        });
        Part::new(Roots { up_to }, shard, answer.collect())
    }

    fn written(folder: &Path, parts: &[Part<Roots>]) -> Vec<PathBuf> {
        let write = |(number, part): (usize, &Part<Roots>)| {
            let path = folder.join(format!("{number}.toml"));
            part.write(&path).unwrap();
            path
        };
        parts.iter().enumerate().map(write).collect()
    }

    #[test]
    fn parts_are_the_whole_in_any_order() {
        let folder = tempfile::tempdir().unwrap();
        let parts = [part(50, "3/3"), part(50, "1/3"), part(50, "2/3")];
        let paths = written(folder.path(), &parts);
        assert_eq!(kind(&paths[0]).unwrap(), "roots");
        let (study, answers) = merge::<Roots>(&paths).unwrap();
        let whole = part(50, "1/1").answer;
        assert_eq!(study, Roots { up_to: 50 });
        let bits = |own: &Placed<f64>| (own.place, own.value.is_nan(), own.value.abs().to_bits());
        assert_eq!(
            answers.iter().map(bits).collect::<Vec<_>>(),
            whole.iter().map(bits).collect::<Vec<_>>()
        );
    }

    #[test]
    fn what_is_no_whole_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let told = |parts: &[Part<Roots>]| {
            let paths = written(folder.path(), parts);
            merge::<Roots>(&paths).unwrap_err().to_string()
        };
        assert!(told(&[part(9, "1/4"), part(9, "3/4")]).ends_with("missing: 2, 4"));
        assert!(told(&[part(9, "1/2"), part(8, "2/2")]).contains("something else"));
        assert!(told(&[part(9, "1/2"), part(9, "2/3")]).contains("something else"));
        assert!(told(&[part(9, "1/2"), part(9, "1/2")]).contains("both part 1 of 2"));
        assert!(told(&[]).contains("no part"));
        let other = Part {
            ferntast: "0.0.1".to_owned(),
            ..part(9, "2/2")
        };
        assert!(told(&[part(9, "1/2"), other]).contains("by 0.0.1"));
        let path = folder.path().join("other.toml");
        std::fs::write(&path, "kind = 3").unwrap();
        assert!(kind(&path).is_err() && merge::<Roots>(&[path]).is_err());
    }
}
