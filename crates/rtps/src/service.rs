//! Services: their requests come in one queue, and their replies go to the clients that asked.

use std::sync::Arc;

use crate::guid::EntityId;
use crate::mailbox::{Inbox, Order, WriterState};
use crate::participant::{Participant, Qos, Shared, TopicError, check, endpoint};
use crate::requests::{self, Request, Requests};
use crate::ros;
use crate::writer::Sample;

/// The profile of services in ROS 2, but for the depth: a burst of replies is sent whole.
const DEPTH: usize = 64;

/// A service with its type.
#[derive(Clone, Copy, Debug)]
pub struct ServiceType<'a> {
    /// Its name in ROS, such as `/belvedere/get_parameters`.
    pub name: &'a str,
    /// Its type in ROS, such as `rcl_interfaces/srv/GetParameters`.
    pub service: &'a str,
    /// The hash of its type, `RIHS01_` and 64 digits, or nothing.
    pub hash: &'a str,
}

/// Answers requests of a service. Clients no longer find the service once this is dropped.
#[derive(Debug)]
pub struct Service {
    shared: Arc<Shared>,
    number: u32,
}

impl Participant {
    /// Offers a service, whose requests have at most `limit` bytes and come in this queue.
    ///
    /// # Errors
    /// If the service's name, type or hash is none.
    pub fn service(
        &self,
        requests: &Requests,
        of: ServiceType<'_>,
        limit: usize,
    ) -> Result<Service, TopicError> {
        check(of.name, of.hash)?;
        let types =
            ros::service_types(of.service).ok_or_else(|| TopicError::ServiceType(of.service.to_owned()))?;
        let ([requested, replied], [request, reply]) = (ros::service_topics(of.name), types);
        let shared = Arc::clone(&self.shared);
        let service = Service { number: shared.number(), shared };
        let (shared, qos) = (&service.shared, Qos::volatile(DEPTH));
        let [reader, writer] = service.entities().map(|entity| shared.guid(entity));
        let user_data = ros::user_data(of.hash);
        // Replies first: whoever finds the requests of a service asks.
        let replies = endpoint(writer, replied, reply, qos, user_data.clone());
        shared.mailbox.post(Order::AddWriter(replies, Arc::new(WriterState::default())));
        let asked = endpoint(reader, requested, request, qos, user_data);
        let inbox = Inbox::Requests(requests.clone(), service.number, limit);
        shared.mailbox.post(Order::AddReader(asked, inbox));
        shared.change_graph(|graph| {
            graph.readers.push(reader);
            graph.writers.push(writer);
        });
        Ok(service)
    }
}

impl Service {
    /// The number by which its requests are known.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Its reader of requests, and its writer of replies.
    fn entities(&self) -> [EntityId; 2] {
        [EntityId::user_reader(self.number), EntityId::user_writer(self.number)]
    }

    /// Answers a request: CDR with its header of four bytes. It returns at once.
    pub fn reply(&self, to: &Request, body: Vec<u8>) {
        let payload = Arc::new(ros::padded(requests::reply(to.answer, body)));
        let [_, writer] = self.entities();
        let sample = Sample { answer: Some(to.answer), ..Sample::plain(payload, Shared::now()) };
        self.shared.mailbox.post(Order::Reply(writer, sample));
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        for entity in self.entities() {
            self.shared.remove(entity);
        }
    }
}
