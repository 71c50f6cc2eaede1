//! Files that are stored in a recording.

/// A file in a recording, such as a robot's description or the world.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// File name, without a folder.
    pub name: String,
    /// Media type, such as `application/xml`.
    pub media_type: String,
    /// Contents of the file.
    pub data: Vec<u8>,
}
