//! Files that are kept in a recording.

/// A file in a recording: the robot's description, the world.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// What it is called, without a folder.
    pub name: String,
    /// Its type, as `application/xml`.
    pub media_type: String,
    /// What is in it.
    pub data: Vec<u8>,
}
