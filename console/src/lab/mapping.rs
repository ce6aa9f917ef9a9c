//! Recordings of one's own: looked at, mapped, tried out, written, mapped again.
//!
//! The page calls every file as the list does. One outside the folder can only be
//! called if the experiment that is mapped again names it already.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use axum::{
    Json,
    extract::{Query, State},
    response::Response,
};
use ferntast_identification::JointType;
use ferntast_lab::{
    experiment::{Join, Mapped, Mapping, data_folder, recording_at, turned, units_for},
    unit::Unit,
    work::{self, Again, Look, OfArm, Request, Trial, WorkError},
};
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{At, Lab, LabError, aside, work::in_lines};

/// Files to look at.
#[derive(Debug, Deserialize)]
pub struct Files {
    files: Vec<String>,
    /// The experiment that is mapped again, which may name files elsewhere.
    #[serde(default)]
    of: Option<String>,
    #[serde(default)]
    columns: Vec<String>,
    #[serde(default)]
    rate_hz: Option<f64>,
    #[serde(default)]
    join: Option<Join>,
    #[serde(default)]
    joint: Option<JointType>,
    /// Whether the tip's coordinates say where a contact is.
    #[serde(default)]
    by_tip: bool,
    #[serde(default)]
    arm: Option<Arm>,
}

/// The arm that files are of.
#[derive(Debug, Deserialize)]
pub struct Arm {
    urdf: String,
    /// From the base on; none: all of the URDF's arm.
    #[serde(default)]
    joints: Vec<String>,
}

/// A mapping, and where it goes.
#[derive(Debug, Deserialize)]
pub struct Plan {
    /// The experiment file.
    path: String,
    mapping: Mapping,
    /// The experiment file that is mapped again.
    #[serde(default)]
    again: Option<Seen>,
}

/// An experiment file as the page got it.
#[derive(Debug, Deserialize)]
pub struct Seen {
    path: String,
    version: String,
}

/// The mapping of an experiment file.
#[derive(Debug, Serialize)]
pub struct Current {
    #[serde(flatten)]
    mapped: Mapped,
    version: String,
}

/// What an experiment file calls a recording or its URDF, by what the page calls it.
type Names = BTreeMap<String, String>;

impl Lab {
    /// The page's names of the files of `mapping`, an experiment in `folder`.
    fn names_of(&self, mapping: &Mapping, folder: &Path) -> Names {
        let files = mapping.recordings.iter().chain(&mapping.held_out).flatten();
        let files = files.chain(mapping.arm.iter().map(|arm| &arm.urdf));
        let named = files.map(|text| {
            let path = recording_at(text, folder, &data_folder());
            let path = path.canonicalize().unwrap_or(path);
            let name = match path.strip_prefix(&self.root) {
                Ok(inside) => inside.display().to_string(),
                Err(_) => text.clone(),
            };
            (name, text.clone())
        });
        named.collect()
    }

    /// The mapping of an experiment file, with the folder that its paths count from.
    fn current(&self, path: &str) -> Result<(work::Present, Names, PathBuf), LabError> {
        let file = self.there(path)?;
        let present = work::mapping_of(&file)?;
        let folder = file.parent().unwrap_or(&self.root).to_owned();
        let names = self.names_of(&present.mapped.mapping, &folder);
        Ok((present, names, folder))
    }

    /// The plan with its files as the experiment file at the plan's path is to name them.
    fn resolved(&self, plan: &Plan) -> Result<Resolved, LabError> {
        let output = self.new_file(&plan.path)?;
        let to = output.parent().unwrap_or(&self.root).to_owned();
        let mut mapping = plan.mapping.clone();
        let (again, known) = match &plan.again {
            None => (None, None),
            Some(seen) => {
                let (_, names, folder) = self.current(&seen.path)?;
                let again = Again {
                    path: self.there(&seen.path)?,
                    version: seen.version.clone(),
                };
                (Some(again), Some((names, folder)))
            }
        };
        for file in files_of(&mut mapping) {
            let of_file = known.as_ref().and_then(|(names, from)| {
                let text = names.get(file)?;
                Some(turned(text, from, &to))
            });
            *file = match of_file {
                Some(text) => text,
                None => {
                    self.there(file)?;
                    turned(file, &self.root, &to)
                }
            };
        }
        Ok(Resolved {
            mapping,
            again,
            output,
        })
    }

    /// Messages call files as the page does.
    fn shortened(&self, text: &str) -> String {
        text.replace(&format!("{}/", self.root.display()), "")
    }
}

/// Every file that a mapping names.
fn files_of(mapping: &mut Mapping) -> impl Iterator<Item = &mut String> {
    let lists = [&mut mapping.recordings, &mut mapping.held_out];
    let urdf = mapping.arm.as_mut().map(|arm| &mut arm.urdf);
    lists.into_iter().flatten().flatten().chain(urdf)
}

struct Resolved {
    mapping: Mapping,
    again: Option<Again>,
    output: PathBuf,
}

/// Looks at files: columns, what is in them, and which signals they may be.
pub async fn look(State(lab): State<Arc<Lab>>, Json(asked): Json<Files>) -> Response {
    in_lines(&lab, move |lab, _| {
        let known = match &asked.of {
            Some(path) => Some(lab.current(path)?),
            None => None,
        };
        let found = |name: &String| {
            let elsewhere = known.as_ref().and_then(|(_, names, folder)| {
                let text = names.get(name)?;
                Some(recording_at(text, folder, &data_folder()))
            });
            elsewhere.map_or_else(|| lab.there(name), Ok)
        };
        let (mut files, mut called) = (Vec::new(), BTreeMap::new());
        for name in &asked.files {
            let path = found(name)?;
            files.push(path.clone());
            called.insert(path, name.clone());
        }
        let arm = match asked.arm {
            None => None,
            Some(Arm { urdf, joints }) => {
                let urdf = found(&urdf)?;
                Some(OfArm {
                    urdf,
                    joints,
                    drive_gain: None,
                })
            }
        };
        let request = Request {
            files,
            columns: asked.columns,
            rate_hz: asked.rate_hz,
            join: asked.join,
            joint: asked.joint,
            by_tip: asked.by_tip,
            arm,
            ..Request::default()
        };
        let mut looked = work::look(&request).map_err(|error| lab.told(&error))?;
        for file in looked.recordings.iter_mut().flatten() {
            let name = called.get(file).cloned();
            *file = name.unwrap_or_else(|| lab.name(file)).into();
        }
        Ok::<Look, LabError>(looked)
    })
}

/// The mapping of an experiment file as it is.
pub async fn current(
    State(lab): State<Arc<Lab>>,
    Query(at): Query<At>,
) -> Result<Json<Current>, LabError> {
    aside(move || {
        let (present, names, _) = lab.current(&at.path)?;
        let work::Present {
            mut mapped,
            version,
        } = present;
        for file in files_of(&mut mapped.mapping) {
            if let Some((name, _)) = names.iter().find(|(_, text)| *text == file) {
                file.clone_from(name);
            }
        }
        Ok(Current { mapped, version })
    })
    .await
}

/// Reads the recordings as a mapping says, and writes nothing.
pub async fn trial(State(lab): State<Arc<Lab>>, Json(plan): Json<Plan>) -> Response {
    in_lines(&lab, move |lab, _| {
        let plan = lab.resolved(&plan)?;
        let mut trial = work::trial(&plan.mapping, plan.again.as_ref(), &plan.output)?;
        let short = |texts: &mut Vec<String>| {
            for text in texts {
                *text = lab.shortened(text);
            }
        };
        short(&mut trial.warnings);
        short(&mut trial.troubles);
        let called = |path: &mut PathBuf| {
            let found = path.canonicalize().unwrap_or_else(|_| path.clone());
            *path = lab.name(&found).into();
        };
        trial
            .signals
            .iter_mut()
            .for_each(|own| called(&mut own.recording));
        trial
            .recordings
            .iter_mut()
            .for_each(|own| called(&mut own.file));
        Ok::<Trial, LabError>(trial)
    })
}

/// Writes the experiment file of a mapping.
pub async fn start(State(lab): State<Arc<Lab>>, Json(plan): Json<Plan>) -> Response {
    in_lines(&lab, move |lab, _| {
        let Resolved {
            mapping,
            again,
            output,
        } = lab.resolved(&plan)?;
        match work::start(&mapping, again.as_ref(), &output, false) {
            Ok(started) => Ok(json!({ "path": plan.path, "changes": started.changes })),
            Err(WorkError::Exists { .. }) => Err(LabError::Taken(plan.path)),
            Err(error) => Err(lab.told(&error)),
        }
    })
}

impl Lab {
    /// An error with files called as the page calls them.
    fn told(&self, error: &(impl std::error::Error + ?Sized)) -> LabError {
        LabError::Told(self.shortened(&error.to_string()))
    }
}

/// Units of signals, by kind of joint and signal; those of an extra signal are all that are known.
pub async fn units() -> Json<BTreeMap<&'static str, BTreeMap<&'static str, Vec<&'static str>>>> {
    let kinds = [
        ("revolute", JointType::Revolute),
        ("prismatic", JointType::Prismatic),
        ("contact", JointType::Contact),
    ];
    let keys = [
        "time",
        "position",
        "tip[0]",
        "tip[1]",
        "motor_torque",
        "joint_torque",
        "tangential_force",
        "normal_force",
        "temperature",
    ];
    let of = |joint: JointType| {
        let own = keys.map(|key| (key, units_for(key, joint))).into_iter();
        own.chain([("extra", Unit::names().collect())]).collect()
    };
    Json(kinds.map(|(name, joint)| (name, of(joint))).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(path: &str, files: &[&str], again: Option<(&str, &str)>) -> Plan {
        serde_json::from_value(json!({
            "path": path,
            "mapping": {
                "recordings": files.iter().map(|file| [file]).collect::<Vec<_>>(),
                "joint": "revolute",
                "signals": {"position": {"column": "q"}, "motor_torque": {"column": "tau"}},
                "inertia": "fit",
                "effects": [],
            },
            "again": again.map(|(path, version)| json!({"path": path, "version": version})),
        }))
        .unwrap()
    }

    #[test]
    fn files_are_named_from_where_they_go_and_none_outside_but_what_is_known() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("lab");
        std::fs::create_dir_all(root.join("sub")).unwrap();
        for file in ["out.csv", "lab/a.csv", "lab/sub/b.csv"] {
            std::fs::write(folder.path().join(file), "t,q,tau\n0,1,2\n").unwrap();
        }
        let text = "recording = [\"../out.csv\", \"sub/b.csv\"]\n[signals]\nposition = \"q\"\nmotor_torque = \"tau\"\n[model]\ninertia = 1.0\neffects = []\n";
        std::fs::write(root.join("e.toml"), text).unwrap();
        let lab = Lab::new(&root).unwrap();
        let new = lab
            .resolved(&plan("sub/new.toml", &["a.csv", "sub/b.csv"], None))
            .unwrap();
        assert_eq!(new.mapping.recordings, [["../a.csv"], ["b.csv"]]);

        let (present, names, _) = lab.current("e.toml").unwrap();
        let called: Vec<&String> = names.keys().collect();
        assert_eq!(called, ["../out.csv", "sub/b.csv"]);
        let again = Some(("e.toml", present.version.as_str()));
        let same = lab
            .resolved(&plan("e.toml", &["../out.csv", "sub/b.csv"], again))
            .unwrap();
        assert_eq!(same.mapping.recordings, [["../out.csv"], ["sub/b.csv"]]);
        let copy = lab
            .resolved(&plan("sub/c.toml", &["../out.csv"], again))
            .unwrap();
        assert_eq!(copy.mapping.recordings, [["../../out.csv"]]);

        for (path, file, again) in [
            ("new.toml", "../out.csv", None),
            ("e.toml", "../other.csv", again),
            ("../new.toml", "a.csv", None),
            ("new.toml", "/etc/passwd", None),
        ] {
            let refused = lab.resolved(&plan(path, &[file], again));
            assert!(
                matches!(refused, Err(LabError::Outside(_))),
                "{path} {file}"
            );
        }
    }
}
