//! Requests of services, from when they come until somebody takes them.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::answer::Answer;
use crate::guid::{Guid, SampleIdentity};
use crate::lock::lock;
use crate::reader::Received;
use crate::spdp::CYCLONE;

/// So many requests and bytes wait at most. What is older is dropped, as a topic that keeps the last samples does.
const MOST_REQUESTS: usize = 256;
const MOST_BYTES: usize = 16 << 20;

/// Requests of several services, in the order in which they arrive.
#[derive(Clone, Debug, Default)]
pub struct Requests(Arc<Queue>);

#[derive(Debug, Default)]
struct Queue {
    waiting: Mutex<VecDeque<Request>>,
    arrived: Condvar,
}

/// A request that a client of a service sent.
#[derive(Debug)]
pub struct Request {
    /// The service: [`Service::number`](crate::Service::number).
    pub service: u32,
    /// The request: CDR with its header of four bytes. It is empty if the client sent more bytes than the service takes.
    pub body: Vec<u8>,
    pub(crate) answer: Answer,
}

impl Requests {
    /// Creates an empty queue.
    pub fn new() -> Requests {
        Requests::default()
    }

    /// The oldest request that was not taken yet. Waits for one until the timeout.
    pub fn take(&self, timeout: Duration) -> Option<Request> {
        let until = Instant::now().checked_add(timeout);
        let mut waiting = lock(&self.0.waiting);
        loop {
            if let Some(request) = waiting.pop_front() {
                return Some(request);
            }
            let left =
                until.map_or(Duration::from_secs(3600), |at| at.saturating_duration_since(Instant::now()));
            if left.is_zero() {
                return None;
            }
            let waited = self.0.arrived.wait_timeout(waiting, left);
            waiting = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    pub(crate) fn push(&self, request: Request) {
        let mut waiting = lock(&self.0.waiting);
        let mut bytes: usize = waiting.iter().map(|old| old.body.len()).sum::<usize>() + request.body.len();
        while waiting.len() >= MOST_REQUESTS || bytes > MOST_BYTES {
            let Some(old) = waiting.pop_front() else { break };
            bytes -= old.body.len();
        }
        waiting.push_back(request);
        self.0.arrived.notify_one();
    }
}

impl Request {
    /// Reads a sample of a service's topic of requests; `None` if it lacks the header that it must have.
    pub(crate) fn of(service: u32, writer: Guid, vendor: [u8; 2], sample: Received) -> Option<Request> {
        let client = writer.prefix;
        // What came of a request that is too large is only good for naming it.
        let kept = |body: Vec<u8>| if sample.is_too_large { Vec::new() } else { body };
        if vendor == CYCLONE {
            let (header, body) = split_header(sample.payload)?;
            let body = kept(body);
            let answer = Answer { client, reader: None, related: None, header: Some(header) };
            return Some(Request { service, body, answer });
        }
        // rmw_fastrtps names the request by the client's reader of replies.
        let reader = sample.about.related.map(|related| related.writer).filter(|guid| guid.prefix == client);
        let related = SampleIdentity { writer: reader.unwrap_or(writer), sequence: sample.sequence };
        let answer = Answer { client, reader, related: Some(related), header: None };
        Some(Request { service, body: kept(sample.payload), answer })
    }
}

/// Takes the client's number and that of the request from before the values, and gives both in little endian.
fn split_header(payload: Vec<u8>) -> Option<([u8; 16], Vec<u8>)> {
    let little = payload.get(1)? & 1 == 1;
    let mut header: [u8; 16] = payload.get(4..20)?.try_into().ok()?;
    if !little {
        header[..8].reverse();
        header[8..].reverse();
    }
    let mut body = payload;
    body.drain(4..20);
    Some((header, body))
}

/// The bytes of a reply, with the name of the request if it stands in them.
pub(crate) fn reply(answer: Answer, mut body: Vec<u8>) -> Vec<u8> {
    if let Some(header) = answer.header {
        let at = body.len().min(4);
        body.splice(at..at, header);
    }
    body
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guid::{EntityId, Prefix};
    use crate::message::About;
    use crate::spdp::FAST_DDS;

    const WRITER: Guid = Guid { prefix: Prefix([1; 12]), entity: EntityId([0, 0, 1, 3]) };
    const READER: Guid = Guid { prefix: Prefix([1; 12]), entity: EntityId([0, 0, 1, 4]) };

    fn received(related: Option<Guid>, payload: &[u8]) -> Received {
        let related = related.map(|writer| SampleIdentity { writer, sequence: 0 });
        let about = About { related, ..About::default() };
        Received { sequence: 7, about, payload: payload.to_vec(), is_too_large: false }
    }

    #[test]
    fn a_reply_names_the_reader_that_the_request_names_or_else_the_writer() {
        for (given, named) in [(Some(READER), READER), (None, WRITER), (Some(Guid::of([9; 16])), WRITER)] {
            let request =
                Request::of(3, WRITER, FAST_DDS, received(given, &[0, 1, 0, 0, 5])).expect("a request");
            assert_eq!((request.service, &request.body[..]), (3, &[0, 1, 0, 0, 5][..]));
            assert_eq!(request.answer.client, WRITER.prefix);
            assert_eq!(request.answer.related, Some(SampleIdentity { writer: named, sequence: 7 }));
            assert_eq!(reply(request.answer, vec![0, 1, 0, 0, 8]), [0, 1, 0, 0, 8]);
        }
    }

    #[test]
    fn a_request_of_cyclone_begins_with_a_header_which_the_reply_repeats() {
        let header: Vec<u8> = (1..=16).collect();
        let payload = [&[0, 1, 0, 0], &header[..], &[5]].concat();
        let request = Request::of(3, WRITER, CYCLONE, received(None, &payload)).expect("a request");
        assert_eq!((&request.body[..], request.answer.related), (&[0, 1, 0, 0, 5][..], None));
        let answered = [&[0, 1, 0, 0], &header[..], &[8]].concat();
        assert_eq!(reply(request.answer, vec![0, 1, 0, 0, 8]), answered);
        // Those of this crate are little endian.
        let big: Vec<u8> = (1..=8).rev().chain((9..=16).rev()).collect();
        let payload = [&[0, 0, 0, 0], &big[..], &[5]].concat();
        let request = Request::of(3, WRITER, CYCLONE, received(None, &payload)).expect("a request");
        assert_eq!(reply(request.answer, vec![0, 1, 0, 0, 8]), answered);
        for length in 0..20 {
            assert!(Request::of(3, WRITER, CYCLONE, received(None, &payload[..length])).is_none());
        }
        // Of one that is too large, its beginning came, by which the reply names it.
        let large = Received { is_too_large: true, ..received(None, &payload[..20]) };
        let request = Request::of(3, WRITER, CYCLONE, large).expect("a request");
        assert!(request.body.is_empty());
        assert_eq!(reply(request.answer, vec![0, 1, 0, 0, 8]), answered);
    }

    #[test]
    fn a_flood_of_requests_is_bounded() {
        let requests = Requests::new();
        for (size, count) in [(1, 1000), (1 << 20, 20)] {
            for number in 0..count {
                let payload = u32::to_le_bytes(number).repeat(size);
                requests.push(Request::of(1, WRITER, FAST_DDS, received(None, &payload)).expect("a request"));
            }
            let mut taken = Vec::new();
            while let Some(request) = requests.take(Duration::ZERO) {
                taken.push(u32::from_le_bytes(request.body[..4].try_into().expect("four bytes")));
            }
            let kept = if size == 1 { MOST_REQUESTS } else { MOST_BYTES / (4 * size) };
            assert_eq!(taken, (count - kept as u32..count).collect::<Vec<_>>());
        }
    }
}
