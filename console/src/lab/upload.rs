//! Takes a recording that is dropped onto the page.

use std::{
    fmt,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use axum::{
    Json,
    body::Body,
    extract::{Query, State},
    http::{HeaderMap, header},
};
use ferntast_lab::table::Format;
use futures_util::StreamExt;
use serde::{Deserialize, Serialize};
use tokio::{fs, io::AsyncWriteExt, time::timeout};

use super::{Lab, LabError};

/// Name of the file.
#[derive(Debug, Deserialize)]
pub struct Upload {
    name: String,
}

/// Where it lies now.
#[derive(Debug, Serialize)]
pub struct Taken {
    path: String,
}

/// The largest recording that is taken \[bytes\].
const LARGEST: u64 = 2 << 30;
/// Uploads at once.
pub const AT_ONCE: usize = 2;
/// How long nothing may come.
const PATIENCE: Duration = Duration::from_secs(20);

/// Writes the body into the lab's folder. A file that is there already stays.
pub async fn take(
    State(lab): State<Arc<Lab>>,
    Query(upload): Query<Upload>,
    headers: HeaderMap,
    body: Body,
) -> Result<Json<Taken>, LabError> {
    let said = headers.get(header::CONTENT_LENGTH);
    let said = said.and_then(|value| value.to_str().ok()?.parse().ok());
    if said.is_some_and(|length: u64| length > LARGEST) {
        return Err(LabError::TooLarge { most: LARGEST });
    }
    let Ok(_turn) = lab.uploads.try_acquire() else {
        return Err(LabError::Busy);
    };
    let name = upload.name;
    let ending = Path::new(&name).extension();
    let is_mcap = ending.is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"));
    let known = is_mcap || Format::of(Path::new(&name)).is_some();
    if !known || name.contains(['/', '\\']) || name.starts_with('.') {
        return Err(LabError::Kind(name));
    }
    let path = lab.new_file(&name)?;
    let refuse = |source: std::io::Error| match source.kind() {
        std::io::ErrorKind::AlreadyExists => LabError::Exists(name.clone()),
        _ => LabError::File {
            path: name.clone(),
            source,
        },
    };
    let mut file = fs::File::create_new(&path).await.map_err(refuse)?;
    let mut part = Part(Some(path));
    write(&mut file, body).await?;
    part.0 = None;
    Ok(Json(Taken { path: name }))
}

/// A file that is not whole yet, and goes where it does not become so: when the
/// client is cut off, this is dropped in the middle.
struct Part(Option<PathBuf>);

impl Drop for Part {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            // Half a recording is none; if it cannot be removed it is seen as broken.
            let _ = std::fs::remove_file(path);
        }
    }
}

async fn write(file: &mut fs::File, body: Body) -> Result<(), LabError> {
    let cut_off = |error: &dyn fmt::Display| LabError::CutOff(error.to_string());
    let mut chunks = body.into_data_stream();
    let mut written = 0;
    loop {
        let chunk = match timeout(PATIENCE, chunks.next()).await {
            Ok(Some(chunk)) => chunk.map_err(|error| cut_off(&error))?,
            Ok(None) => break,
            Err(_) => {
                let seconds = PATIENCE.as_secs();
                return Err(cut_off(&format!("nothing came for {seconds} s")));
            }
        };
        written += chunk.len() as u64;
        if written > LARGEST {
            return Err(LabError::TooLarge { most: LARGEST });
        }
        file.write_all(&chunk)
            .await
            .map_err(|error| cut_off(&error))?;
    }
    file.flush().await.map_err(|error| cut_off(&error))
}
