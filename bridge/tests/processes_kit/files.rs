//! The files of a domain.

use std::{
    collections::BTreeSet,
    fs,
    ops::Deref,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Node};

/// Returns the directory of the nodes of a domain.
pub fn nodes(domain: &Domain) -> PathBuf {
    domain.directory().join("nodes")
}

/// The domain of one test. Dropping it removes what a failed test left.
pub struct TestDomain {
    domain: Domain,
    /// Every node that [`TestDomain::usage`] has seen: its directory does not contain the domain's name.
    nodes: BTreeSet<String>,
}

/// The number of files and directories of a domain, and its bytes of shared memory. (Other files hold numbers as text,
/// whose length varies by a digit.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    pub files: usize,
    pub bytes: u64,
}

impl TestDomain {
    pub fn new(test: &str) -> Self {
        Self { domain: super::domain(test), nodes: BTreeSet::new() }
    }

    /// Returns the data segments of a domain of another owner.
    pub fn pools_of(domain: &Domain) -> Vec<PathBuf> {
        let mut files = files(domain);
        files.retain(|path| path.extension().is_some_and(|extension| extension == "data"));
        files
    }

    /// Returns every file whose name begins with the domain's prefix.
    pub fn files(&self) -> Vec<PathBuf> {
        files(&self.domain)
    }

    /// Returns the domain's data segments.
    pub fn pools(&self) -> Vec<PathBuf> {
        Self::pools_of(&self.domain)
    }

    /// Returns the identifiers of its nodes, dead or alive.
    pub fn node_ids(&self) -> Vec<String> {
        let prefix = self.domain.prefix();
        names(&nodes(&self.domain))
            .filter_map(|name| Some(name.strip_prefix(&prefix)?.split('.').next()?.to_owned()))
            .collect::<BTreeSet<_>>()
            .into_iter()
            .collect()
    }

    /// Returns the current usage.
    pub fn usage(&mut self) -> Usage {
        self.nodes.extend(self.node_ids());
        let files = self.files();
        let directories = self.nodes.iter().filter(|id| nodes(&self.domain).join(id).exists()).count();
        let shared = files.iter().filter(|path| path.starts_with("/dev/shm"));
        let bytes = shared.filter_map(|path| Some(fs::metadata(path).ok()?.len())).sum();
        Usage { files: files.len() + directories, bytes }
    }

    /// Waits until the domain has the expected usage. Returns the actual usage if it does not.
    pub fn comes_to(&mut self, expected: Usage, timeout: Duration) -> Result<(), Usage> {
        let deadline = Instant::now() + timeout;
        loop {
            let usage = self.usage();
            if usage == expected {
                return Ok(());
            }
            if Instant::now() >= deadline {
                return Err(usage);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Fails unless, after kills, the next process of the domain leaves nothing. The files of a process that was killed
    /// early count as remnants only one second after their creation.
    pub fn assert_nothing_left_after_the_next_start(&mut self) {
        let deadline = Instant::now() + super::PATIENCE;
        loop {
            self.usage();
            drop(Node::open(&self.domain, "last").unwrap());
            if self.usage().files == 0 || Instant::now() > deadline {
                return self.assert_nothing_left();
            }
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Fails if any file is left, including the nodes' directories.
    pub fn assert_nothing_left(&mut self) {
        let usage = self.usage();
        assert_eq!(usage, Usage { files: 0, bytes: 0 }, "{:#?}", self.files());
    }
}

impl Deref for TestDomain {
    type Target = Domain;

    fn deref(&self) -> &Domain {
        &self.domain
    }
}

impl Drop for TestDomain {
    fn drop(&mut self) {
        self.nodes.extend(self.node_ids());
        for path in self.files() {
            let _ = fs::remove_file(path);
        }
        for id in &self.nodes {
            let _ = fs::remove_dir(nodes(&self.domain).join(id));
        }
    }
}

fn files(domain: &Domain) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for root in [PathBuf::from("/dev/shm"), domain.directory()] {
        walk(&root, &domain.prefix(), &mut found);
    }
    found.sort();
    found
}

fn walk(directory: &Path, prefix: &str, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(prefix) {
            found.push(entry.path());
        }
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            walk(&entry.path(), prefix, found);
        }
    }
}

fn names(directory: &Path) -> impl Iterator<Item = String> {
    fs::read_dir(directory)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
}
