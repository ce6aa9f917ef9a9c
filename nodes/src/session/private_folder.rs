//! Folders that nobody but this user can look into or change.

use std::{
    fs::{self, DirBuilder, Metadata},
    io,
    os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt},
    path::{Path, PathBuf},
};

/// Why a folder is not trusted with a session's file.
#[derive(Debug, thiserror::Error)]
pub enum PrivateFolderError {
    /// It cannot be made, or looked at.
    #[error("cannot make {}: {source}", path.display())]
    Make {
        /// The folder.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// Something else has its name: a link, which may lead anywhere, or a file.
    #[error(
        "{} is not a folder but {found}, which somebody else may have put there: remove it, or set XDG_RUNTIME_DIR to a folder of your own",
        path.display()
    )]
    NotAFolder {
        /// The folder.
        path: PathBuf,
        /// What it is.
        found: &'static str,
    },
    /// It belongs to another user.
    #[error(
        "{} belongs to another user (number {owner}, you are {user}), who could give the nodes another session: have it removed, or set XDG_RUNTIME_DIR to a folder of your own",
        path.display()
    )]
    Owner {
        /// The folder.
        path: PathBuf,
        /// Number of its owner.
        owner: u32,
        /// Number of this user.
        user: u32,
    },
    /// Others may write into it.
    #[error(
        "others may write into {} (mode {mode:o}), and could give the nodes another session: remove it, or `chmod go-w` it if nothing in it is foreign",
        path.display()
    )]
    Writable {
        /// The folder.
        path: PathBuf,
        /// Its permissions.
        mode: u32,
    },
}

/// Number of the user that this process works for.
pub fn user() -> u32 {
    // SAFETY: geteuid cannot fail.
    unsafe { libc::geteuid() }
}

/// Makes the folder `path` for this user alone, with mode 0700. One that is
/// there must be this user's and closed to the writing of others; it is closed
/// to their reading too.
///
/// # Errors
///
/// [`PrivateFolderError`]; nothing was changed.
pub fn make(path: &Path) -> Result<(), PrivateFolderError> {
    let failed = |source: io::Error| PrivateFolderError::Make {
        path: path.to_owned(),
        source,
    };
    match DirBuilder::new().mode(0o700).create(path) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        made => return made.map_err(failed),
    }
    // Not of what a link leads to, but of the link itself.
    let found = fs::symlink_metadata(path).map_err(failed)?;
    judge(path, &found, user())?;
    match found.mode() & 0o077 {
        0 => Ok(()),
        // It is this user's: nobody else can put something in its place.
        _ => fs::set_permissions(path, fs::Permissions::from_mode(0o700)).map_err(failed),
    }
}

/// Whether what was found at `path` is a folder that only `user` can change.
fn judge(path: &Path, found: &Metadata, user: u32) -> Result<(), PrivateFolderError> {
    let path = path.to_owned();
    if found.is_symlink() {
        let found = "a symbolic link";
        return Err(PrivateFolderError::NotAFolder { path, found });
    }
    if !found.is_dir() {
        let found = "a file";
        return Err(PrivateFolderError::NotAFolder { path, found });
    }
    let owner = found.uid();
    if owner != user {
        return Err(PrivateFolderError::Owner { path, owner, user });
    }
    match found.mode() & 0o7777 {
        mode if mode & 0o022 != 0 => Err(PrivateFolderError::Writable { path, mode }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().mode() & 0o777
    }

    #[test]
    fn a_new_folder_is_for_its_user_alone_and_an_old_one_is_closed() {
        let scratch = tempfile::tempdir().unwrap();
        let folder = scratch.path().join("ferntast-1");
        make(&folder).unwrap();
        assert_eq!(mode(&folder), 0o700);
        fs::set_permissions(&folder, fs::Permissions::from_mode(0o755)).unwrap();
        make(&folder).unwrap();
        assert_eq!(mode(&folder), 0o700);
    }

    #[test]
    fn what_others_may_have_put_there_is_refused_in_words() {
        let scratch = tempfile::tempdir().unwrap();
        let folder = scratch.path().join("real");
        fs::create_dir(&folder).unwrap();
        let link = scratch.path().join("link");
        symlink(&folder, &link).unwrap();
        let refused = |path: &Path| make(path).unwrap_err().to_string();
        assert!(refused(&link).contains("a symbolic link"));

        let file = scratch.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(refused(&file).contains("a file"));

        fs::set_permissions(&folder, fs::Permissions::from_mode(0o777)).unwrap();
        assert!(refused(&folder).contains("others may write"));
        assert_eq!(mode(&folder), 0o777, "what is refused stays as it is");

        fs::set_permissions(&folder, fs::Permissions::from_mode(0o700)).unwrap();
        let found = fs::symlink_metadata(&folder).unwrap();
        let foreign = judge(&folder, &found, user() + 1).unwrap_err().to_string();
        assert!(foreign.contains("belongs to another user"), "{foreign}");
    }
}
