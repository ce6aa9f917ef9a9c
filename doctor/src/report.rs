//! What the doctor found.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

/// How a check came out; the later, the worse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// All a session needs.
    Ok,
    /// A session runs, with less than it could have.
    Warn,
    /// A session cannot run, or cannot record.
    Fail,
}

/// One thing that was examined.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Its name for programs: `real_time_priority`.
    pub id: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// How it came out.
    pub status: Status,
    /// What was found, in one or more lines.
    pub found: String,
    /// How to mend or better it; always there unless the status is ok.
    pub mend: Option<String>,
    /// What was found, for programs; units are in the keys.
    pub values: BTreeMap<&'static str, Value>,
}

impl Check {
    pub(super) fn ok(id: &'static str, title: &'static str, found: impl Into<String>) -> Check {
        Check {
            id,
            title,
            status: Status::Ok,
            found: found.into(),
            mend: None,
            values: BTreeMap::new(),
        }
    }

    pub(super) fn with(mut self, key: &'static str, value: impl Into<Value>) -> Check {
        self.values.insert(key, value.into());
        self
    }

    /// Adds a finding and how to correct it; the worst finding gives the status.
    pub(super) fn add(&mut self, status: Status, found: &str, mend: impl AsRef<str>) {
        self.status = self.status.max(status);
        append(&mut self.found, found);
        append(self.mend.get_or_insert_default(), mend.as_ref());
    }

    /// Adds what is as it should be.
    pub(super) fn add_found(&mut self, found: &str) {
        append(&mut self.found, found);
    }

    pub(super) fn warn(mut self, found: &str, mend: impl AsRef<str>) -> Check {
        self.add(Status::Warn, found, mend);
        self
    }

    pub(super) fn fail(mut self, found: &str, mend: impl AsRef<str>) -> Check {
        self.add(Status::Fail, found, mend);
        self
    }
}

fn append(text: &mut String, line: &str) {
    if !text.is_empty() && !line.is_empty() {
        text.push('\n');
    }
    text.push_str(line);
}

/// All that was examined.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// In the order in which a person should read them.
    pub checks: Vec<Check>,
}

impl Report {
    /// The worst status; ok when nothing was examined.
    pub fn status(&self) -> Status {
        let worst = self.checks.iter().map(|check| check.status).max();
        worst.unwrap_or(Status::Ok)
    }

    /// How many checks came out as `status`.
    pub fn count(&self, status: Status) -> usize {
        let same = self.checks.iter().filter(|check| check.status == status);
        same.count()
    }

    /// 0 when no check failed, 1 otherwise. Warnings do not count.
    pub fn exit_code(&self) -> u8 {
        u8::from(self.status() == Status::Fail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_failure_makes_the_exit_code() {
        let good = Check::ok("a", "A", "good");
        let warned = Check::ok("b", "B", "").warn("less", "more");
        let failed = Check::ok("c", "C", "this")
            .fail("bad", "repair")
            .warn("odd", "even");
        let report = |checks| Report { checks };
        assert_eq!(report(vec![]).exit_code(), 0);
        assert_eq!(report(vec![good.clone(), warned.clone()]).exit_code(), 0);
        let all = report(vec![failed.clone(), good, warned]);
        assert_eq!(all.exit_code(), 1);
        assert_eq!(all.count(Status::Warn), 1);
        assert_eq!(failed.found, "this\nbad\nodd");
        assert_eq!(failed.mend.as_deref(), Some("repair\neven"));
    }

    #[test]
    fn json_has_what_programs_ask_for() {
        let check = Check::ok("disk", "Disk", "")
            .fail("full", "delete")
            .with("free_bytes", 7u64)
            .with("folder", "/x");
        let json = serde_json::to_value(Report {
            checks: vec![check],
        })
        .expect("serializes");
        assert_eq!(
            json,
            serde_json::json!({"checks": [{
                "id": "disk", "title": "Disk", "status": "fail", "found": "full",
                "mend": "delete", "values": {"free_bytes": 7, "folder": "/x"},
            }]})
        );
    }
}
