//! What the operating system says about files, in plain words.

use std::io;

/// The reason in plain words, with what to do where that is clear.
#[must_use]
pub fn io_reason(error: &io::Error) -> String {
    use io::ErrorKind as Kind;
    let known = match error.kind() {
        Kind::NotFound => "there is no such file or folder",
        Kind::PermissionDenied => "permission denied; choose a place you may use",
        Kind::AlreadyExists => "a file of that name is in the way",
        Kind::StorageFull => "the disk is full; free some space or choose another place",
        Kind::QuotaExceeded => "your disk quota is used up; free some space",
        Kind::ReadOnlyFilesystem => "the file system is read-only; choose another place",
        Kind::NotADirectory => "a part of this path is a file, not a folder",
        Kind::IsADirectory => "this is a folder, not a file",
        Kind::InvalidData => "its content is not text (UTF-8)",
        _ => return error.to_string(),
    };
    known.to_owned()
}
