//! The services that topics are to iceoryx2.

use iceoryx2::prelude::ServiceName;

use crate::Error;

/// What every service name begins with.
const SERVICE_ROOT: &str = "belvedere/";

/// The service of a canonical topic.
pub(crate) fn service_name(topic: &str) -> Result<ServiceName, Error> {
    ServiceName::new(&format!("{SERVICE_ROOT}{topic}"))
        .map_err(|error| Error::transport(format!("naming {topic}"), error))
}

/// The topic of a service, if it is one of ours.
pub(crate) fn topic_of_service(service: &str) -> Option<&str> {
    service.strip_prefix(SERVICE_ROOT)
}
