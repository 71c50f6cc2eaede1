//! What can be wrong with a link.

/// Why a link cannot be opened, or go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// The bridge's own words.
    #[error(transparent)]
    Bridge(#[from] belvedere_bridge::Error),
    /// The other machine cannot be reached that way.
    #[error(
        "{what}: Zenoh reports {detail}; is the address one of this machine's for --listen, of the other's for --connect, and its port free?"
    )]
    Transport {
        /// What was tried.
        what: String,
        /// What came back.
        detail: String,
    },
    /// The system gives no thread.
    #[error(
        "the system gives no thread that follows a stream: {0}; end other programs, or raise `ulimit -u`"
    )]
    Thread(#[from] std::io::Error),
}
