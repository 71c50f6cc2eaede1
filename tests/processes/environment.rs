//! Options that environment variables may give.

use crate::live::{belvedere, own_domain};
use std::io::Write as _;
use std::os::unix::fs::OpenOptionsExt as _;

/// Returns the standard error of a command with these variables.
fn refused(variables: &[(&str, &str)], arguments: &[&str]) -> String {
    let done = belvedere().envs(variables.iter().copied()).args(arguments).output().unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2), "{arguments:?}: {said}");
    said
}

#[test]
fn an_option_that_a_variable_gives_is_not_shown_as_required() {
    let variables =
        [("BELVEDERE_DOMAIN", "lab"), ("BELVEDERE_VIEW_TOKEN", "abcdefgh12"), ("ROS_DOMAIN_ID", "7")];
    for arguments in [
        &["hz"][..],
        &["snapshot"],
        &["info"],
        &["replay"],
        &["control", "spawn"],
        &["record"],
        &["dataset"],
        &["run", "--port", "0"],
        &["run", "--jpeg-quality", "90"],
        &["ros2", "--foo"],
        &["list", "--foo"],
        &["view", "--token", "abcdefgh12", "--token-file", "none"],
    ] {
        assert_eq!(refused(&variables, arguments), refused(&[], arguments), "{arguments:?}");
    }
    // A wrong value is told wherever it comes from.
    let said = refused(&[("BELVEDERE_DOMAIN", "a b")], &["hz", "/scan"]);
    assert!(said.contains("'a b'") && said.contains("--domain"), "{said}");
}

#[test]
fn an_option_that_is_typed_goes_before_the_variable_of_another_one() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("token");
    let mut written = std::fs::File::options().write(true).create_new(true).mode(0o600).open(&file).unwrap();
    written.write_all(b"fileabcdefgh").unwrap();
    let domain = own_domain();
    let done = belvedere()
        .envs([("BELVEDERE_VIEW_TOKEN", "variable1234"), ("BELVEDERE_DOMAIN", &domain)])
        .args([
            "run",
            "--view",
            "--no-browser",
            "--port",
            "0",
            "--duration",
            "0.1",
            "--rate",
            "max",
            "--token-file",
        ])
        .arg(&file)
        .output()
        .unwrap();
    let said = [done.stdout, done.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert!(done.status.success(), "{said}");
    assert!(said.contains("fileabcdefgh") && !said.contains("variable1234"), "{said}");
    assert!(said.contains(&domain) || !said.contains("domain default"), "{said}");
}
