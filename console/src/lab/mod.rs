//! The lab over HTTP: recordings and experiments of one folder, worked on by
//! the same code as `ferntast lab`.
//!
//! Paths in requests are relative to the folder and never lead out of it; what
//! an experiment file there names may lie elsewhere. Work that takes long
//! answers in lines of JSON: `{"progress": 0.3}` …, then `{"result": …}` or
//! `{"error": "…"}`. Work goes on one piece at a time.

mod arm;
mod drawing;
mod files;
mod mapping;
mod upload;
mod view;
mod work;

use std::{
    path::{Component, Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
    time::SystemTime,
};

use axum::{
    Json, Router,
    extract::{DefaultBodyLimit, Query, State},
    http::StatusCode,
    response::{IntoResponse, Response},
    routing::{get, post},
};
use ferntast_lab::{
    table::ENDINGS,
    work::{Opened, OpenedArm, WorkError},
};
use serde::Deserialize;
use tokio::sync::Semaphore;

use crate::{ServerError, bodies::UPLOAD};

/// Why a request to the lab fails.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// The path leads out of the folder.
    #[error("{0}: not a path within the lab's folder")]
    Outside(String),
    /// The file is not there.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// An upload has a name that recordings do not have.
    #[error("{0}: drop an .mcap file or a table: {list}", list = tables())]
    Kind(String),
    /// There is a file of that name.
    #[error("{0} exists already in the lab's folder: rename yours")]
    Exists(String),
    /// A new experiment would lie over another one.
    #[error("{0} exists already: choose another name, or open it and map its signals again")]
    Taken(String),
    /// What the lab said.
    #[error("{0}")]
    Told(String),
    /// An upload was cut off.
    #[error("the file did not arrive whole: {0}")]
    CutOff(String),
    /// An upload is too large.
    #[error(
        "a recording of more than {} GiB is not taken here: copy it into the lab's folder, or cut it into parts",
        most >> 30
    )]
    TooLarge {
        /// The largest that is taken \[bytes\].
        most: u64,
    },
    /// Others are being uploaded.
    #[error("other recordings are on their way here: try again when they have arrived")]
    Busy,
    /// There are fewer joints.
    #[error("{path} has no joint {number}")]
    Joint {
        /// The recording.
        path: String,
        /// The number asked for, from 0.
        number: usize,
    },
    /// An experiment about something else.
    #[error("{0} is not about a whole arm")]
    NoArm(String),
    /// The report cannot be made.
    #[error(transparent)]
    Render(#[from] ferntast_lab::report::RenderError),
    /// The work cannot be done.
    #[error(transparent)]
    Work(#[from] WorkError),
    /// The experiment's chain cannot be read.
    #[error(transparent)]
    Experiment(#[from] ferntast_lab::experiment::ExperimentError),
    /// The work was broken off.
    #[error("the work broke off; the server's terminal says why")]
    Broken,
}

/// The endings of tables.
fn tables() -> String {
    let endings = ENDINGS.iter().map(|(ending, _)| format!(".{ending}"));
    endings.collect::<Vec<String>>().join(", ")
}

impl IntoResponse for LabError {
    fn into_response(self) -> Response {
        let body = Json(serde_json::json!({ "error": self.to_string() }));
        let status = match self {
            LabError::TooLarge { .. } => StatusCode::PAYLOAD_TOO_LARGE,
            LabError::Busy => StatusCode::SERVICE_UNAVAILABLE,
            _ => StatusCode::UNPROCESSABLE_ENTITY,
        };
        (status, body).into_response()
    }
}

/// What was opened last, so that the next step need not read it again.
struct Kept {
    path: PathBuf,
    changed: Option<SystemTime>,
    contents: Arc<Contents>,
}

/// What a file holds.
struct Contents {
    /// One experiment, or one a joint.
    joints: Vec<Opened>,
    /// The arm that they are of, where it is about a whole one.
    arm: Option<OpenedArm>,
}

/// The lab of one folder.
pub struct Lab {
    root: PathBuf,
    kept: Mutex<Option<Kept>>,
    turn: Arc<Semaphore>,
    uploads: Semaphore,
}

impl Lab {
    /// The lab of `folder`.
    ///
    /// # Errors
    ///
    /// [`ServerError::Folder`].
    pub fn new(folder: &Path) -> Result<Lab, ServerError> {
        let folder = match folder == Path::new("") {
            true => Path::new("."),
            false => folder,
        };
        let root = folder
            .canonicalize()
            .map_err(|source| ServerError::Folder {
                path: folder.to_owned(),
                source,
            })?;
        Ok(Lab {
            root,
            kept: Mutex::new(None),
            turn: Arc::new(Semaphore::new(1)),
            uploads: Semaphore::new(upload::AT_ONCE),
        })
    }

    /// A file in the folder that is there.
    fn there(&self, path: &str) -> Result<PathBuf, LabError> {
        let wanted = self.inside(path)?;
        let found = wanted.canonicalize().map_err(|source| LabError::File {
            path: path.to_owned(),
            source,
        })?;
        match found.starts_with(&self.root) {
            true => Ok(wanted),
            false => Err(LabError::Outside(path.to_owned())),
        }
    }

    /// A path in the folder, whether there is something or not.
    fn inside(&self, path: &str) -> Result<PathBuf, LabError> {
        let relative = Path::new(path);
        let plain = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
        if path.is_empty() || path.contains('\0') || !relative.components().all(plain) {
            return Err(LabError::Outside(path.to_owned()));
        }
        Ok(self.root.join(relative))
    }

    /// A new file in the folder; its parent must be in there too.
    fn new_file(&self, path: &str) -> Result<PathBuf, LabError> {
        let wanted = self.inside(path)?;
        let parent = wanted
            .parent()
            .and_then(|parent| parent.canonicalize().ok());
        match parent {
            Some(parent) if parent.starts_with(&self.root) => Ok(wanted),
            _ => Err(LabError::Outside(path.to_owned())),
        }
    }

    /// How a path in the folder is called in answers.
    fn name(&self, path: &Path) -> String {
        path.strip_prefix(&self.root)
            .unwrap_or(path)
            .display()
            .to_string()
    }

    /// Experiments of a file, read once as long as the file stays as it is.
    fn open(&self, path: &str) -> Result<Arc<Contents>, LabError> {
        let path = self.there(path)?;
        let changed = path.metadata().and_then(|data| data.modified()).ok();
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = kept.as_ref()
            && kept.path == path
            && kept.changed == changed
        {
            return Ok(kept.contents.clone());
        }
        let arm = ferntast_lab::work::open_arm(&path)?;
        let joints = match &arm {
            Some(arm) => arm.joints()?,
            None => ferntast_lab::work::open(&path)?,
        };
        let contents = Arc::new(Contents { joints, arm });
        *kept = Some(Kept {
            path,
            changed,
            contents: contents.clone(),
        });
        Ok(contents)
    }
}

/// Has all else on the computer come before this thread: a fit can wait, and
/// the server's threads that hear a stop cannot.
fn step_back() {
    const NICE: libc::c_int = 10;
    // SAFETY: takes no pointers; 0 means the calling thread. Where it is refused,
    // which it is not, the work goes on all the same.
    unsafe { libc::setpriority(libc::PRIO_PROCESS, 0, NICE) };
}

/// Does `work` beside the server's own, so that it answers others meanwhile.
async fn aside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, LabError> + Send + 'static,
) -> Result<Json<T>, LabError> {
    let done = tokio::task::spawn_blocking(|| {
        step_back();
        work()
    });
    done.await.unwrap_or(Err(LabError::Broken)).map(Json)
}

/// A file in the folder.
#[derive(Debug, Deserialize)]
pub struct At {
    path: String,
}

/// A joint of an experiment file or recording.
#[derive(Clone, Debug, Deserialize)]
pub struct Joint {
    path: String,
    /// Which joint of an arm, or of a recording of ferntast's own, from 0.
    #[serde(default)]
    joint: usize,
}

impl Joint {
    /// There are fewer.
    fn missing(&self) -> LabError {
        LabError::Joint {
            path: self.path.clone(),
            number: self.joint,
        }
    }
}

/// The lab's addresses.
pub fn routes(lab: Arc<Lab>) -> Router {
    Router::new()
        .route("/api/lab/files", get(list))
        .route("/api/lab/offered", get(offered))
        .route(
            "/api/lab/effects",
            get(|| async { Json(ferntast_identification::catalogue()) }),
        )
        .route("/api/lab/open", get(view::open))
        .route("/api/lab/units", get(mapping::units))
        .route("/api/lab/look", post(mapping::look))
        .route("/api/lab/mapping", get(mapping::current))
        .route("/api/lab/trial", post(mapping::trial))
        .route("/api/lab/start", post(mapping::start))
        .route("/api/lab/compare", post(work::compare))
        .route("/api/lab/diagnose", post(work::diagnose))
        .route("/api/lab/compare_arm", post(arm::compare))
        .route("/api/lab/diagnose_arm", post(arm::diagnose))
        .route("/api/lab/discover", post(work::discover))
        .route("/api/lab/add", post(work::add))
        .route("/api/lab/report", post(work::report))
        .route(
            UPLOAD,
            post(upload::take).layer(DefaultBodyLimit::disable()),
        )
        .with_state(lab)
}

async fn list(State(lab): State<Arc<Lab>>) -> Result<Json<files::Listing>, LabError> {
    aside(move || Ok(files::list(&lab.root))).await
}

async fn offered(
    State(lab): State<Arc<Lab>>,
    Query(at): Query<At>,
) -> Result<Json<ferntast_lab::work::Offered>, LabError> {
    aside(move || Ok(ferntast_lab::work::offered(&lab.there(&at.path)?)?)).await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_path_leads_out_of_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("lab");
        std::fs::create_dir_all(root.join("sub")).unwrap();
        std::fs::write(folder.path().join("secret.csv"), "t_s\n0\n").unwrap();
        std::fs::write(root.join("sub/own.csv"), "t_s\n0\n").unwrap();
        std::os::unix::fs::symlink(folder.path(), root.join("way_out")).unwrap();
        let lab = Lab::new(&root).unwrap();
        assert!(lab.there("sub/own.csv").is_ok());
        assert!(lab.new_file("sub/new.toml").is_ok());
        for path in [
            "../secret.csv",
            "/etc/passwd",
            "sub/../../secret.csv",
            "way_out/secret.csv",
            "",
            "sub/\0",
        ] {
            assert!(lab.there(path).is_err(), "{path}");
            assert!(lab.new_file(path).is_err(), "{path}");
        }
    }
}
