//! C interface of the bridge.
