//! What dead sessions left in shared memory: names with the sessions' prefix
//! that no process has mapped or opened.

use std::collections::{BTreeMap, BTreeSet};

use ferntast_msgs::counted;

use super::host::Host;
use super::network_table::processes;
use super::options::DoctorOptions;
use super::report::Check;
use super::text::quoted;

/// Where a session has its segments, and the folder of what manages them.
const FOLDER: &str = "/dev/shm";

/// A session of which something is there.
#[derive(Default)]
struct Session {
    /// Its folder, which has the session's name.
    folder: Option<String>,
    /// Its segments.
    segments: Vec<String>,
}

impl Session {
    fn paths(&self) -> impl Iterator<Item = &String> {
        self.folder.iter().chain(&self.segments)
    }
}

pub(super) fn check(host: &dyn Host, options: &DoctorOptions) -> Check {
    let check = Check::ok("leftovers", "Leftovers of sessions", "");
    let prefix = &options.shared_memory_prefix;
    if prefix.is_empty() {
        return Check {
            found: "not looked for".to_owned(),
            ..check
        };
    }
    let sessions = sessions(host, prefix);
    let open = if sessions.is_empty() {
        OpenFiles::default()
    } else {
        open_files(host, prefix)
    };
    let (alive, dead): (Vec<_>, Vec<_>) = sessions
        .into_iter()
        .partition(|(_, own)| own.paths().any(|path| open.holds(path)));
    let names = |of: &[(String, Session)]| -> Vec<String> {
        of.iter().map(|(session, _)| session.clone()).collect()
    };
    let (alive, dead_names) = (names(&alive), names(&dead));
    let files: Vec<&String> = dead.iter().flat_map(|(_, own)| own.paths()).collect();
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
        .map(|(session, own)| removal(prefix, session, own))
        .collect();
    let count = counted(files.len(), "file");
    check.warn(
        &format!(
            "{count} of dead sessions: {}{unseen}",
            dead_names.join(", ")
        ),
        removals.join("\n"),
    )
}

/// The sessions of which there is what a session makes: others may have files under a name that
/// begins as ours do.
fn sessions(host: &dyn Host, prefix: &str) -> BTreeMap<String, Session> {
    let mut sessions: BTreeMap<String, Session> = BTreeMap::new();
    for name in host.list(FOLDER).unwrap_or_default() {
        let Some(rest) = name.strip_prefix(prefix) else {
            continue;
        };
        let path = format!("{FOLDER}/{name}");
        let (session, segment) = match rest.split_once('.') {
            Some((session, segment)) => (session, Some(segment)),
            None => (rest, None),
        };
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if session.is_empty() || !session.chars().all(allowed) {
            continue;
        }
        match segment {
            Some(segment) if is_segment(segment) => {
                let own = sessions.entry(session.to_owned()).or_default();
                own.segments.push(path);
            }
            None if host.list(&path).is_ok() => {
                let own = sessions.entry(session.to_owned()).or_default();
                own.folder = Some(path);
            }
            _ => {}
        }
    }
    sessions
}

/// Whether a segment's name can follow: 40 hexadecimal digits and a bar, as iceoryx2 has it.
fn is_segment(name: &str) -> bool {
    let digits = name.split('_').next().unwrap_or_default();
    name.len() > digits.len() && digits.len() == 40 && digits.chars().all(|c| c.is_ascii_hexdigit())
}

/// Names only what is there: some shells refuse a pattern that matches nothing, and one that
/// matches more may be somebody else's.
fn removal(prefix: &str, session: &str, own: &Session) -> String {
    let name = format!("{FOLDER}/{}", quoted(&format!("{prefix}{session}")));
    let mut words = Vec::new();
    if own.folder.is_some() {
        words.push(name.clone());
    }
    let start = format!("{FOLDER}/{prefix}{session}.");
    let of_segments = own.segments.iter();
    let of_segments = of_segments.filter_map(|path| path.strip_prefix(&start)?.split('_').next());
    let digits: BTreeSet<&str> = of_segments.collect();
    words.extend(digits.iter().map(|digits| format!("{name}.{digits}_*")));
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
    let start = format!("{FOLDER}/{prefix}");
    let ours = |path: &str| path.starts_with(start.as_str());
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

    const HASH: &str = "0354a209029e7d094a819e2d4030ea331e6caaf0";

    fn examine(fake: &Fake) -> Check {
        check(fake, &DoctorOptions::default())
    }

    fn segment(session: &str, kind: &str) -> String {
        format!("/dev/shm/ferntast.{session}.{HASH}_1.{kind}")
    }

    fn two_sessions() -> Fake {
        Fake::good()
            .file(&segment("a", "data"), "")
            .file("/dev/shm/ferntast.a/nodes", "")
            .file(&segment("b", "data"), "")
            .file(&segment("b", "dynamic"), "")
    }

    #[test]
    fn nothing_of_a_session_is_good() {
        assert_eq!(examine(&Fake::good()).found, "none");
        assert_eq!(examine(&Fake::empty()).status, Status::Ok);
    }

    #[test]
    fn sessions_that_processes_hold_are_alive() {
        let maps = format!(
            "7f00-7f01 rw-s 00000000 00:17 4  {}\n7f02-7f03 rw-p 0 0 0\n",
            segment("b", "dynamic")
        );
        let fake = two_sessions()
            .process(5, "node", &["/dev/null", "/dev/shm/ferntast.a/nodes"])
            .file("/proc/6/maps", &maps);
        let check = examine(&fake);
        assert_eq!(
            (check.status, check.found.as_str()),
            (Status::Ok, "alive: a, b")
        );
    }

    #[test]
    fn the_others_are_dead_and_can_be_removed() {
        // Holding `ferntast.ab…` does not hold `ferntast.a…`.
        let (ab, b) = (segment("ab", "data"), segment("b", "data"));
        let fake = two_sessions()
            .file(&ab, "")
            .process(5, "node", &[ab.as_str(), b.as_str()]);
        let check = examine(&fake);
        assert_eq!(check.status, Status::Warn);
        assert_eq!(check.found, "alive: ab, b\n2 files of dead sessions: a");
        assert_eq!(check.values["dead"], serde_json::json!(["a"]));
        let mend = format!("`rm -rf -- /dev/shm/ferntast.a /dev/shm/ferntast.a.{HASH}_*`");
        assert_eq!(check.mend, Some(mend));
        let one = Fake::empty().file(&segment("a", "data"), "");
        assert_eq!(examine(&one).found, "1 file of dead sessions: a");
    }

    #[test]
    fn what_no_session_makes_is_nobodys_to_remove() {
        let fake = Fake::good()
            .file("/tmp/ferntast.old", "")
            .file("/tmp/ferntast.a/notes", "")
            .file("/dev/shm/ferntast.old", "")
            .file("/dev/shm/ferntast.a.tar.gz", "")
            .file(&format!("/dev/shm/ferntast.a.{HASH}"), "")
            .file("/dev/shm/ferntast.x';reboot;'/y", "");
        assert_eq!(examine(&fake).found, "none");
    }

    #[test]
    fn processes_of_others_are_counted() {
        let mut fake = two_sessions().file("/proc/9/maps", "");
        fake.forbidden.insert("/proc/9/maps".to_owned());
        assert!(examine(&fake).found.contains("1 in number"));
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
