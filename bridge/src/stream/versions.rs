//! The versions on both sides of an incompatible stream, for error messages.

use std::{fs::File, io::Read as _};

use iceoryx2::service::{
    Service as _,
    messaging_pattern::MessagingPattern as Pattern,
    static_config::{
        message_type_details::{TypeDetail, TypeVariant},
        messaging_pattern::MessagingPattern,
    },
};

use crate::{
    Error, FrameHeader, ICEORYX2_VERSION, Node,
    domain::{Ipc, Keeper, service_name},
};

/// Returns the error for a stream that cannot be opened because of `error`, with the versions or types that differ.
pub(crate) fn incompatible(node: &Node, topic: &str, error: impl std::fmt::Debug) -> Error {
    let detail = match other_iceoryx2(node.keeper()) {
        Some(version) => format!(
            "it was made by iceoryx2 {version}, which cannot be mixed with {ICEORYX2_VERSION}: end the process that uses {version}, or change its version"
        ),
        None => header_of(node, topic).unwrap_or_else(|| format!("{error:?}")),
    };
    Error::Incompatible { topic: topic.to_owned(), domain: node.domain().to_string(), detail }
}

/// Returns the version of iceoryx2, other than this one, that created a file of the domain.
///
/// Every file in shared memory begins with the version of its creator, 16 bits each for patch, minor and major. Only
/// these bytes are read: no file of another version is mapped.
fn other_iceoryx2(keeper: &Keeper) -> Option<String> {
    const KINDS: [&str; 5] = ["connection", "data", "dynamic", "event_mgmt", "global_mgmt"];
    keeper
        .in_shared_memory()
        .filter(|path| path.extension().is_some_and(|kind| KINDS.iter().any(|known| kind == *known)))
        .find_map(|path| {
            let mut bytes = [0; 8];
            File::open(path).ok()?.read_exact(&mut bytes).ok()?;
            let [patch, minor, major, rest] =
                [0, 2, 4, 6].map(|index| u16::from_le_bytes([bytes[index], bytes[index + 1]]));
            let version = format!("{major}.{minor}.{patch}");
            // All zeros: not complete yet. Large numbers: not a version.
            let is_one = bytes != [0; 8] && rest == 0 && major < 100;
            (is_one && version != ICEORYX2_VERSION).then_some(version)
        })
}

/// Describes the types of a stream next to this build's types.
fn header_of(node: &Node, topic: &str) -> Option<String> {
    let name = service_name(topic).ok()?;
    let found = Ipc::details(&name, node.keeper().config(), Pattern::PublishSubscribe).ok()??;
    let MessagingPattern::PublishSubscribe(stream) = found.static_details.messaging_pattern() else {
        return None;
    };
    let types = stream.message_type_details();
    let (header, payload) = (&types.user_header, &types.payload);
    let ours = TypeDetail::new::<FrameHeader>(TypeVariant::FixedSize);
    Some(format!(
        "its header is {} of {} bytes, its payload {}; this build's header is {} of {} bytes, its payload u8",
        header.type_name(),
        header.size(),
        payload.type_name(),
        ours.type_name(),
        ours.size(),
    ))
}
