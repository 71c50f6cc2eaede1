//! The mapping between topics and iceoryx2 services.

use iceoryx2::prelude::ServiceName;

use crate::Error;

/// The prefix of every service name.
const SERVICE_ROOT: &str = "belvedere/";

/// Returns the service name of a canonical topic.
pub(crate) fn service_name(topic: &str) -> Result<ServiceName, Error> {
    ServiceName::new(&format!("{SERVICE_ROOT}{topic}"))
        .map_err(|error| Error::transport(format!("naming {topic}"), error))
}

/// Returns the topic of a service, if it is one of Belvedere's.
pub(crate) fn topic_of_service(service: &str) -> Option<&str> {
    service.strip_prefix(SERVICE_ROOT)
}
