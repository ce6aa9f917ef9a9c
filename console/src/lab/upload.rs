//! Takes a recording that is dropped onto the page.

use std::{path::Path, sync::Arc};

use axum::{
    Json,
    body::Body,
    extract::{Query, State},
};
use futures_util::StreamExt;
use serde::{Deserialize, Serialize};
use tokio::{fs, io::AsyncWriteExt};

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

/// Writes the body into the lab's folder. A file that is there already stays.
pub async fn take(
    State(lab): State<Arc<Lab>>,
    Query(upload): Query<Upload>,
    body: Body,
) -> Result<Json<Taken>, LabError> {
    let name = upload.name;
    let ending = Path::new(&name)
        .extension()
        .map(|ending| ending.to_ascii_lowercase());
    let known = ending.is_some_and(|ending| ending == "mcap" || ending == "csv");
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
    let outcome = write(&mut file, body).await;
    if let Err(reason) = outcome {
        // Half a recording is none; if it cannot be removed it is seen as broken.
        let _ = fs::remove_file(&path).await;
        return Err(LabError::CutOff(reason));
    }
    Ok(Json(Taken { path: name }))
}

async fn write(file: &mut fs::File, body: Body) -> Result<(), String> {
    let mut chunks = body.into_data_stream();
    while let Some(chunk) = chunks.next().await {
        let chunk = chunk.map_err(|error| error.to_string())?;
        file.write_all(&chunk)
            .await
            .map_err(|error| error.to_string())?;
    }
    file.flush().await.map_err(|error| error.to_string())
}
