//! What dead sessions left in shared memory: names with the sessions' prefix
//! that no process has mapped or opened.

use std::collections::BTreeMap;

use super::host::Host;
use super::network_table::processes;
use super::options::DoctorOptions;
use super::report::Check;
use super::text::quoted;

/// Segments, and the folders in which the middleware keeps what belongs to them.
const FOLDERS: [&str; 2] = ["/dev/shm", "/tmp"];

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let check = Check::ok("leftovers", "Leftovers of sessions", "");
    let prefix = &options.shared_memory_prefix;
    if prefix.is_empty() {
        return Check {
            found: "not looked for".to_owned(),
            ..check
        };
    }
    let mut sessions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for folder in FOLDERS {
        for name in host.list(folder).unwrap_or_default() {
            if let Some(rest) = name.strip_prefix(prefix.as_str()) {
                let session = rest.split('.').next().unwrap_or_default();
                let paths = sessions.entry(session.to_owned()).or_default();
                paths.push(format!("{folder}/{name}"));
            }
        }
    }
    let (mut alive, mut dead) = (Vec::new(), Vec::new());
    let open = if sessions.is_empty() {
        OpenFiles::default()
    } else {
        open_files(host, prefix)
    };
    for (session, paths) in sessions {
        if paths.iter().any(|path| open.holds(path)) {
            alive.push(session);
        } else {
            dead.push((session, paths));
        }
    }
    let dead_names: Vec<&str> = dead.iter().map(|(session, _)| session.as_str()).collect();
    let files: Vec<&String> = dead.iter().flat_map(|(_, paths)| paths).collect();
    let mut check = check
        .with("alive", alive.clone())
        .with("dead", dead_names.clone())
        .with(
            "files",
            files.iter().map(|path| path.as_str()).collect::<Vec<_>>(),
        );
    if !alive.is_empty() {
        check.found = format!("alive: {}", alive.join(", "));
    }
    if dead.is_empty() {
        if alive.is_empty() {
            check.found = "none".to_owned();
        }
        return check;
    }
    let unseen = match open.unseen {
        0 => String::new(),
        count => format!(
            " (other users' processes cannot be looked into, {count} in number: ask again as root to be sure)"
        ),
    };
    let removals: Vec<String> = dead
        .iter()
        .map(|(session, paths)| removal(prefix, session, paths))
        .collect();
    check.warn(
        &format!(
            "{} files of dead sessions: {}{unseen}",
            files.len(),
            dead_names.join(", ")
        ),
        removals.join("\n"),
    )
}

/// Names only what is there: some shells refuse a pattern that matches nothing.
fn removal(prefix: &str, session: &str, paths: &[String]) -> String {
    let name = quoted(&format!("{prefix}{session}"));
    let mut words = Vec::new();
    for folder in FOLDERS {
        let whole = format!("{folder}/{prefix}{session}");
        if paths.contains(&whole) {
            words.push(format!("{folder}/{name}"));
        }
        if paths.iter().any(|path| {
            path.strip_prefix(&whole)
                .is_some_and(|rest| rest.starts_with('.'))
        }) {
            words.push(format!("{folder}/{name}.*"));
        }
    }
    format!("`rm -rf -- {}`", words.join(" "))
}

/// The files with the prefix that processes have mapped or opened.
#[derive(Default)]
struct OpenFiles {
    paths: Vec<String>,
    /// Processes that this user may not look into.
    unseen: usize,
}

impl OpenFiles {
    fn holds(&self, path: &str) -> bool {
        let inside = |open: &String| {
            let rest = open.strip_prefix(path);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        self.paths.iter().any(inside)
    }
}

fn open_files(host: &dyn Host, prefix: &str) -> OpenFiles {
    let starts: Vec<String> = FOLDERS
        .iter()
        .map(|folder| format!("{folder}/{prefix}"))
        .collect();
    let ours = |path: &str| starts.iter().any(|start| path.starts_with(start.as_str()));
    let mut open = OpenFiles::default();
    for id in processes(host) {
        let maps = host.read(&format!("/proc/{id}/maps"));
        let folder = format!("/proc/{id}/fd");
        let files = host.list(&folder);
        // A process that ended meanwhile holds nothing.
        let denied = |error: &std::io::Error| error.kind() == std::io::ErrorKind::PermissionDenied;
        if maps.as_ref().is_err_and(denied) || files.as_ref().is_err_and(denied) {
            open.unseen += 1;
        }
        // Address, permissions, offset, device, inode, then the path.
        let mapped = maps.unwrap_or_default();
        let mapped = mapped
            .lines()
            .filter_map(|line| line.find('/').and_then(|at| line.get(at..)));
        open.paths
            .extend(mapped.filter(|path| ours(path)).map(str::to_owned));
        for file in files.unwrap_or_default() {
            let target = host.link_target(&format!("{folder}/{file}"));
            open.paths.extend(target.ok().filter(|path| ours(path)));
        }
    }
    open
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::super::report::Status;
    use super::*;

    fn examine(fake: &Fake) -> Check {
        check(fake, &DoctorOptions::default())
    }

    fn two_sessions() -> Fake {
        Fake::good()
            .file("/dev/shm/ferntast.a.data", "")
            .file("/tmp/ferntast.a/node", "")
            .file("/dev/shm/ferntast.b.data", "")
            .file("/dev/shm/ferntast.b.more", "")
    }

    #[test]
    fn nothing_of_a_session_is_good() {
        assert_eq!(examine(&Fake::good()).found, "none");
        assert_eq!(examine(&Fake::empty()).status, Status::Ok);
    }

    #[test]
    fn sessions_that_processes_hold_are_alive() {
        let maps =
            "7f00-7f01 rw-s 00000000 00:17 4  /dev/shm/ferntast.b.more\n7f02-7f03 rw-p 0 0 0\n";
        let fake = two_sessions()
            .process(5, "node", &["/dev/null", "/tmp/ferntast.a/node"])
            .file("/proc/6/maps", maps);
        let check = examine(&fake);
        assert_eq!(
            (check.status, check.found.as_str()),
            (Status::Ok, "alive: a, b")
        );
    }

    #[test]
    fn the_others_are_dead_and_can_be_removed() {
        // Holding `ferntast.ab…` does not hold `ferntast.a…`.
        let fake = two_sessions()
            .file("/dev/shm/ferntast.ab.data", "")
            .process(
                5,
                "node",
                &["/dev/shm/ferntast.ab.data", "/dev/shm/ferntast.b.data"],
            );
        let check = examine(&fake);
        assert_eq!(check.status, Status::Warn);
        assert_eq!(check.found, "alive: ab, b\n2 files of dead sessions: a");
        assert_eq!(check.values["dead"], serde_json::json!(["a"]));
        let mend = "`rm -rf -- /dev/shm/ferntast.a.* /tmp/ferntast.a`";
        assert_eq!(check.mend.as_deref(), Some(mend));
    }

    #[test]
    fn processes_of_others_are_counted() {
        let mut fake = two_sessions().file("/proc/9/maps", "");
        fake.forbidden.insert("/proc/9/maps".to_owned());
        assert!(examine(&fake).found.contains("1 in number"));
    }

    #[test]
    fn a_name_cannot_smuggle_a_command() {
        let fake = Fake::empty().file("/dev/shm/ferntast.x';reboot;'.y", "");
        let mend = examine(&fake).mend.unwrap_or_default();
        assert!(
            mend.contains(r"/dev/shm/'ferntast.x'\'';reboot;'\'''.*"),
            "{mend}"
        );
    }

    #[test]
    fn without_a_prefix_nothing_is_looked_for() {
        let options = DoctorOptions {
            shared_memory_prefix: String::new(),
            ..DoctorOptions::default()
        };
        assert_eq!(check(&two_sessions(), &options).found, "not looked for");
    }
}
