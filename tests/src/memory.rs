//! The memory of a session's processes.

use std::{collections::BTreeMap, fmt, fs};

use crate::Session;

/// Memory that is a process' own, not shared and not a file's \[KiB\]; `None`
/// when it is gone.
pub fn own_memory(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("RssAnon:"))?;
    line.trim().strip_suffix(" kB")?.trim().parse().ok()
}

/// What every process of a session took, time after time.
#[derive(Debug, Default)]
pub struct MemoryLog {
    /// By name of the node and process.
    processes: BTreeMap<(String, u32), Vec<u64>>,
}

impl MemoryLog {
    /// Looks at every process of the session.
    pub fn look(&mut self, session: &Session) {
        for process in session.processes() {
            let Some(memory) = own_memory(process) else {
                continue;
            };
            let name = name_of(process);
            self.processes
                .entry((name, process))
                .or_default()
                .push(memory);
        }
    }

    /// By how much each process grew \[KiB\], from the first looks to the last.
    pub fn growth(&self) -> impl Iterator<Item = (&str, i64)> {
        self.processes.iter().map(|((name, _), looks)| {
            let part = (looks.len() / 10).max(1);
            let first = median(&looks[..part]);
            let last = median(&looks[looks.len() - part..]);
            (name.as_str(), last as i64 - first as i64)
        })
    }

    /// Forgets what was seen: what counts begins now.
    pub fn begin(&mut self) {
        self.processes.clear();
    }
}

impl fmt::Display for MemoryLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:16} {:>10} {:>10} {:>10}",
            "process", "first KiB", "last KiB", "growth"
        )?;
        for ((name, _), looks) in &self.processes {
            let (first, last) = (looks.first(), looks.last());
            let (Some(&first), Some(&last)) = (first, last) else {
                continue;
            };
            let growth = last as i64 - first as i64;
            writeln!(f, "{name:16} {first:>10} {last:>10} {growth:>+10}")?;
        }
        Ok(())
    }
}

/// Name of the node that a process runs, or of the command.
fn name_of(process: u32) -> String {
    let command = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
    let mut words = command
        .split(|&byte| byte == 0)
        .map(|word| String::from_utf8_lossy(word).into_owned())
        .skip(1);
    match words.next() {
        Some(word) if word == "node" => words.next().unwrap_or(word),
        word => word.unwrap_or_default(),
    }
}

fn median(looks: &[u64]) -> u64 {
    let mut sorted = looks.to_vec();
    sorted.sort_unstable();
    sorted[sorted.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_memory_is_what_was_written_to() {
        let before = own_memory(std::process::id()).expect("this process");
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        let after = own_memory(std::process::id()).expect("this process");
        assert!(after >= before + (60 << 10), "{before} to {after}");
        drop(block);
    }

    #[test]
    fn growth_is_from_the_first_looks_to_the_last() {
        let mut log = MemoryLog::default();
        let looks = (0..20).map(|k| 1000 + k).collect();
        log.processes.insert(("servo".to_owned(), 1), looks);
        assert_eq!(log.growth().collect::<Vec<_>>(), [("servo", 18)]);
        assert!(log.to_string().contains("servo"));
    }
}
