//! The same world, seed and commands give the same bytes, whatever the load of the machine.

use crate::live::{belvedere, own_domain};

/// Returns the hashes that a run of half a simulated second prints at its end.
fn hashes(seed: &str, threads: &str) -> String {
    let output = belvedere()
        .args([
            "run",
            "--rate",
            "max",
            "--duration",
            "0.5",
            "--hash",
            "--seed",
            seed,
            "--domain",
            &own_domain(),
        ])
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn hash_of<'a>(hashes: &'a str, topic: &str) -> &'a str {
    let line = hashes.lines().find(|line| line.split_whitespace().nth(1) == Some(topic));
    line.unwrap_or_else(|| panic!("no hash of {topic} in:\n{hashes}"))
}

#[test]
fn one_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let first = hashes("7", "1");
    assert!(first.lines().count() >= 13 && first.contains("/image_raw  15 frames"), "{first}");
    assert_eq!(first, hashes("7", "1"));
    assert_eq!(first, hashes("7", "2"));
    assert_eq!(first, hashes("7", "3"));
}

#[test]
fn another_seed_changes_only_noise() {
    let (one, other) = (hashes("1", "2"), hashes("2", "2"));
    for noisy in ["/image_raw", "/scan", "total"] {
        assert_ne!(hash_of(&one, noisy), hash_of(&other, noisy), "{noisy}");
    }
    for exact in ["/camera_info", "/odom", "/tf", "/clock", "/joint_states"] {
        assert_eq!(hash_of(&one, exact), hash_of(&other, exact), "{exact}");
    }
}
