//! Errors of links.

/// The reason why a link cannot be opened, or cannot continue.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// An error of the bridge.
    #[error(transparent)]
    Bridge(#[from] belvedere_bridge::Error),
    /// The other machine cannot be reached at this address.
    #[error(
        "{what}: Zenoh reports {detail}; check that the address belongs to this machine for --listen, or to the other one for --connect, and that its port is free"
    )]
    Transport {
        /// The action that failed.
        what: String,
        /// Zenoh's error.
        detail: String,
    },
    /// The system cannot start another thread.
    #[error("cannot start a thread for a stream: {0}; end other programs, or raise `ulimit -u`")]
    Thread(#[from] std::io::Error),
}
