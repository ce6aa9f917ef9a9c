//! The files of a dataset.

use std::{
    fs::{self, File},
    io::{self, BufWriter},
    path::Path,
};

use serde_json::{Map, Value, json};

use super::{
    Dataset,
    episode::Episode,
    statistics::{Statistics, statistics},
};
use crate::{
    ExportError,
    parquet::{Column, Writer},
};

const STATE: &str = "observation.state";
const ACTION: &str = "action";

/// Columns that every dataset has, in their order.
const OTHERS: [&str; 5] = [
    "timestamp",
    "frame_index",
    "episode_index",
    "index",
    "task_index",
];

/// Writes all of them.
pub fn write(dataset: &Dataset, episodes: &[Episode], task: &str) -> Result<(), ExportError> {
    let at = |name: &str| dataset.folder.join(name);
    let put = |name: &str, content: &Value| {
        let path = at(name);
        let bytes = serde_json::to_vec_pretty(content).map_err(io::Error::other);
        bytes
            .and_then(|bytes| fs::write(&path, bytes))
            .map_err(ExportError::file(&path))
    };
    for folder in ["meta/episodes/chunk-000", "data/chunk-000"] {
        let path = at(folder);
        fs::create_dir_all(&path).map_err(ExportError::file(&path))?;
    }
    put("meta/info.json", &info(dataset))?;
    let all: Vec<Frames> = frames(dataset, episodes);
    put("meta/stats.json", &stats(&all))?;
    for (name, done) in [
        (
            "meta/tasks.parquet",
            tasks as fn(&Path, &str, &[Frames]) -> io::Result<()>,
        ),
        ("meta/episodes/chunk-000/file-000.parquet", about_episodes),
        ("data/chunk-000/file-000.parquet", data),
    ] {
        let path = at(name);
        done(&path, task, &all).map_err(ExportError::file(&path))?;
    }
    Ok(())
}

fn info(dataset: &Dataset) -> Value {
    let vector =
        |names: &[String]| json!({"dtype": "float32", "shape": [names.len()], "names": names});
    let mut features = Map::new();
    features.insert(STATE.to_owned(), vector(&dataset.state));
    features.insert(ACTION.to_owned(), vector(&dataset.action));
    for name in OTHERS {
        let kind = if name == "timestamp" {
            "float32"
        } else {
            "int64"
        };
        let feature = json!({"dtype": kind, "shape": [1], "names": null});
        features.insert(name.to_owned(), feature);
    }
    json!({
        "codebase_version": "v3.0",
        "fps": dataset.fps,
        "features": features,
        "total_episodes": dataset.episodes,
        "total_frames": dataset.frames,
        "total_tasks": 1,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": null,
        "robot_type": null,
        "splits": {"train": format!("0:{}", dataset.episodes)},
    })
}

/// An episode with all its columns.
struct Frames {
    /// Index of its first frame among all.
    from: i64,
    state: Vec<Vec<f32>>,
    action: Vec<Vec<f32>>,
    timestamp: Vec<f32>,
    frame: Vec<i64>,
    episode: Vec<i64>,
    index: Vec<i64>,
    task: Vec<i64>,
}

fn frames(dataset: &Dataset, episodes: &[Episode]) -> Vec<Frames> {
    let mut from = 0;
    let each = episodes.iter().enumerate().map(|(number, episode)| {
        let count = episode.frames();
        let own: Vec<i64> = (0..count as i64).collect();
        let time = |frame: &i64| (*frame as f64 / f64::from(dataset.fps)) as f32;
        let frames = Frames {
            from,
            state: episode.state.clone(),
            action: episode.action.clone(),
            timestamp: own.iter().map(time).collect(),
            episode: vec![number as i64; count],
            index: own.iter().map(|frame| from + frame).collect(),
            task: vec![0; count],
            frame: own,
        };
        from += count as i64;
        frames
    });
    each.collect()
}

impl Frames {
    /// The columns of the data, in order.
    fn columns(&self) -> Vec<Column> {
        vec![
            Column::Floats(self.state.clone()),
            Column::Floats(self.action.clone()),
            Column::Float(self.timestamp.clone()),
            Column::Long(self.frame.clone()),
            Column::Long(self.episode.clone()),
            Column::Long(self.index.clone()),
            Column::Long(self.task.clone()),
        ]
    }
}

/// Names of all features, in the order of the columns.
fn names() -> Vec<&'static str> {
    [&[STATE, ACTION][..], &OTHERS].concat()
}

/// Statistics of each feature over some episodes.
fn statistics_of(episodes: &[&Frames]) -> Vec<(&'static str, Statistics)> {
    let columns: Vec<Vec<Column>> = episodes.iter().map(|own| own.columns()).collect();
    let of = |(number, name): (usize, &'static str)| {
        let mut elements: Vec<Vec<f64>> = Vec::new();
        for column in columns.iter().filter_map(|own| own.get(number)) {
            let rows: Vec<Vec<f64>> = match column {
                Column::Floats(own) => own
                    .iter()
                    .map(|row| row.iter().map(|value| f64::from(*value)).collect())
                    .collect(),
                Column::Float(own) => own.iter().map(|value| vec![f64::from(*value)]).collect(),
                Column::Long(own) => own.iter().map(|value| vec![*value as f64]).collect(),
                _ => Vec::new(),
            };
            for row in rows {
                elements.resize(elements.len().max(row.len()), Vec::new());
                for (element, value) in elements.iter_mut().zip(row) {
                    element.push(value);
                }
            }
        }
        (name, statistics(&elements))
    };
    names().into_iter().enumerate().map(of).collect()
}

fn stats(all: &[Frames]) -> Value {
    let all: Vec<&Frames> = all.iter().collect();
    let each = statistics_of(&all).into_iter().map(|(name, own)| {
        let own = own.into_iter().map(|(key, values)| match key {
            "count" => (
                key.to_owned(),
                json!([values.first().copied().unwrap_or(0.0) as i64]),
            ),
            key => (key.to_owned(), json!(values)),
        });
        (name.to_owned(), Value::Object(own.collect()))
    });
    Value::Object(each.collect())
}

fn create(path: &Path) -> io::Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path)?))
}

/// The frames, a group of rows an episode, so that each can be read alone.
fn data(path: &Path, _task: &str, all: &[Frames]) -> io::Result<()> {
    let kinds = all.first().map(Frames::columns).unwrap_or_default();
    let schema = names().into_iter().map(str::to_owned).zip(kinds);
    let mut writer = Writer::new(create(path)?, schema.collect())?;
    for episode in all {
        writer.group(&episode.columns())?;
    }
    writer.finish(&[])
}

/// The tasks as pandas writes them, with the text as the index.
fn tasks(path: &Path, task: &str, _all: &[Frames]) -> io::Result<()> {
    let columns = [Column::Long(vec![0]), Column::Text(vec![task.to_owned()])];
    let schema = ["task_index", "task"].map(str::to_owned).into_iter();
    let mut writer = Writer::new(create(path)?, schema.zip(columns.clone()).collect())?;
    writer.group(&columns)?;
    let column = |name: &str, pandas: &str, numpy: &str| json!({"name": name, "field_name": name, "pandas_type": pandas, "numpy_type": numpy, "metadata": null});
    let pandas = json!({
        "index_columns": ["task"],
        "column_indexes": [{"name": null, "field_name": null, "pandas_type": "unicode",
            "numpy_type": "object", "metadata": {"encoding": "UTF-8"}}],
        "columns": [column("task_index", "int64", "int64"), column("task", "unicode", "object")],
        "pandas_version": "2.2.0",
    });
    writer.finish(&[("pandas", pandas.to_string())])
}

/// Where each episode is, and its statistics.
fn about_episodes(path: &Path, task: &str, all: &[Frames]) -> io::Result<()> {
    let each = |of: &dyn Fn(&Frames) -> i64| Column::Long(all.iter().map(of).collect());
    let length = |own: &Frames| own.frame.len() as i64;
    let number = |own: &Frames| own.episode.first().copied().unwrap_or(0);
    let mut columns = vec![
        ("episode_index".to_owned(), each(&number)),
        (
            "tasks".to_owned(),
            Column::Texts(vec![vec![task.to_owned()]; all.len()]),
        ),
        ("length".to_owned(), each(&length)),
        ("data/chunk_index".to_owned(), each(&|_| 0)),
        ("data/file_index".to_owned(), each(&|_| 0)),
        ("dataset_from_index".to_owned(), each(&|own| own.from)),
        (
            "dataset_to_index".to_owned(),
            each(&|own| own.from + length(own)),
        ),
    ];
    let statistics: Vec<_> = all.iter().map(|own| statistics_of(&[own])).collect();
    for (place, name) in names().into_iter().enumerate() {
        let own = || statistics.iter().filter_map(|episode| episode.get(place));
        let keys = own()
            .next()
            .map(|(_, first)| first.keys().copied().collect::<Vec<_>>());
        for key in keys.unwrap_or_default() {
            let values = own().map(|(_, own)| own.get(key).cloned().unwrap_or_default());
            columns.push((
                format!("stats/{name}/{key}"),
                Column::Doubles(values.collect()),
            ));
        }
    }
    columns.push(("meta/episodes/chunk_index".to_owned(), each(&|_| 0)));
    columns.push(("meta/episodes/file_index".to_owned(), each(&|_| 0)));
    let mut writer = Writer::new(create(path)?, columns.clone())?;
    let values: Vec<Column> = columns.into_iter().map(|(_, column)| column).collect();
    writer.group(&values)?;
    writer.finish(&[])
}
