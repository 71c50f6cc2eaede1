//! The attributes of a stream, which describe it to processes that list or open it.

use super::Frames;
use crate::Error;
use crate::StreamSpec;
use iceoryx2::{
    prelude::AttributeSpecifier,
    service::{
        attribute::{AttributeKey, AttributeSet, AttributeValue},
        port_factory::PortFactory as _,
    },
};

pub(super) const KIND: &str = "kind";
pub(super) const ENCODING: &str = "encoding";
pub(super) const RATE: &str = "rate_hz";
pub(super) const FRAME_ID: &str = "frame_id";
pub(super) const LAYERS: &str = "layers";

/// Returns the attributes of a stream with this specification.
pub(super) fn attributes(spec: &StreamSpec) -> Result<AttributeSpecifier, Error> {
    let pairs = [
        Some((KIND, spec.kind.to_string())),
        Some((ENCODING, spec.encoding.to_string())),
        spec.rate_hz.map(|rate| (RATE, rate.to_string())),
        spec.layers.map(|layers| (LAYERS, layers.to_string())),
        (!spec.frame_id.is_empty()).then(|| (FRAME_ID, spec.frame_id.clone())),
    ];
    let mut attributes = AttributeSpecifier::new();
    for (key, value) in pairs.into_iter().flatten() {
        let failed = |error| Error::transport(format!("describing {}", spec.topic), error);
        let key = AttributeKey::try_from(key).map_err(|error| failed(format!("{error:?}")))?;
        let value = AttributeValue::try_from(value.as_str()).map_err(|error| failed(format!("{error:?}")))?;
        attributes = attributes.define(&key, &value).map_err(|error| failed(format!("{error:?}")))?;
    }
    Ok(attributes)
}

/// Returns the attribute with this key, if the stream has it.
pub(super) fn attribute(attributes: &AttributeSet, key: &str) -> Option<String> {
    let key = AttributeKey::try_from(key).ok()?;
    attributes.key_value(&key, 0).map(ToString::to_string)
}

/// Returns the kind that the stream's creator declared, even if this version does not know it.
pub(super) fn declared_kind(frames: &Frames) -> Option<String> {
    attribute(frames.attributes(), KIND)
}
