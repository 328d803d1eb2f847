//! The commit of a build. It is the programs' and not the library's, which need not be compiled again for each commit.

/// Twelve digits of its hash, and whether files differ from it.
pub(crate) const COMMIT: &str = git_version::git_version!(
    args = ["--always", "--abbrev=12", "--exclude=*", "--dirty=-modified"],
    fallback = "not built from a git checkout"
);
