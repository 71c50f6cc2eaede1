//! [`Publisher`]: the writing end of a stream.

mod loan;
mod pool;
mod queue;

use std::{
    fmt,
    sync::{
        Arc,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use iceoryx2::{
    port::{
        LoanError,
        backpressure_strategy::BackpressureStrategy,
        notifier::Notifier,
        publisher::{Publisher as Port, PublisherCreateError},
        update_connections::UpdateConnections,
    },
    sample_mut::SampleMut,
    service::port_factory::PortFactory as _,
};

use crate::{
    Consumer, Error, FrameHeader, Node, StreamSpec, clock,
    domain::Ipc,
    own::Own,
    payload::Message,
    session,
    stream::{self, Events, Frames, ports},
    topic::canonical_topic,
};
use pool::Pool;
use queue::Queue;

/// The writing end of a stream.
///
/// [`loan`](Self::loan) returns a frame whose payload *is* the shared memory that subscribers will read;
/// [`send`](LoanedFrame::send) passes its address to them. Neither copies the payload. Neither allocates, except for
/// the record of 104 bytes that iceoryx2 keeps of each loan. Neither waits, unless the stream is lossless.
pub struct Publisher(Arc<Own<Ports>>);

/// The ports of a publisher. Frames on loan keep them open.
struct Ports {
    // Fields are dropped in this order: ports, their services, the node.
    port: Port<Ipc, [u8], FrameHeader>,
    notifier: Notifier<Ipc>,
    frames: Frames,
    _events: Events,
    pool: Pool,
    node: Node,
    topic: String,
    template: FrameHeader,
    max_payload_len: usize,
    max_loaned: usize,
    next_seq: AtomicU64,
    /// The number of subscribers when connections were last made, which shows when a new one has come.
    known_subscribers: AtomicUsize,
    /// The checksum of the subscribers at the last update.
    last_present: AtomicU64,
    /// The wait for consumers, on a lossless stream.
    queue: Option<Arc<Queue>>,
}

impl Node {
    /// Creates the publisher of a stream.
    ///
    /// # Errors
    /// [`Error::DomainInUse`] if another process publishes the stream, [`Error::TooManyPublishers`] if a stream for
    /// several publishers has no slot left, [`Error::SharedMemoryTooSmall`] if its pool does not fit into `/dev/shm`,
    /// [`Error::AddressSpaceTooSmall`], [`Error::TooManyOpenFiles`], [`Error::Incompatible`] and [`Error::Permission`].
    pub fn publisher(&self, spec: &StreamSpec) -> Result<Publisher, Error> {
        Publisher::open(self, spec)
    }
}

impl Publisher {
    fn open(node: &Node, spec: &StreamSpec) -> Result<Self, Error> {
        let topic = canonical_topic(&spec.topic)?.to_owned();
        Error::check_open_files(|| format!("opening {topic} for writing"))?;
        let session = session::random();
        let template = FrameHeader { session, ..spec.header()? };
        let booking = pool::book(node, &topic, spec.pool_bytes())?;
        let (frames, events) = stream::open_or_create(node, spec)?;
        // Consumers may have kept the stream open with the larger settings of an earlier publisher.
        let config = frames.static_config();
        let made = StreamSpec {
            max_subscribers: config.max_subscribers(),
            buffer: config.subscriber_max_buffer_size(),
            borrowed: config.subscriber_max_borrowed_samples(),
            history: config.history_size(),
            ..spec.clone()
        };
        let booking = if made.pool_bytes() == spec.pool_bytes() {
            booking
        } else {
            drop(booking);
            pool::book(node, &topic, made.pool_bytes())?
        };
        pool::check_address_space(&topic, made.pool_bytes())?;
        let queue = spec.lossless.clone().map(|lossless| Arc::new(Queue::new(lossless, node.clone())));
        let when_full = match queue {
            Some(_) => BackpressureStrategy::RetryUntilDelivered,
            None => BackpressureStrategy::DiscardData,
        };
        let mut tried_again = false;
        let deadline = Instant::now() + Duration::from_secs(1);
        let port = loop {
            let mut builder = frames
                .publisher_builder()
                .initial_max_slice_len(spec.max_payload_len.max(1))
                .max_loaned_samples(spec.loaned)
                .backpressure_strategy(when_full);
            if let Some(queue) = queue.clone() {
                builder = builder.set_backpressure_handler(move |full| queue.wait(full));
            }
            match builder.create() {
                Ok(port) => break port,
                // The slot may be that of a killed publisher, which another process may be cleaning up at this moment.
                Err(PublisherCreateError::ExceedsMaxSupportedPublishers)
                    if !tried_again
                        || (Instant::now() < deadline && ports::place_of_the_dead(node, &frames)) =>
                {
                    if tried_again {
                        std::thread::sleep(Duration::from_millis(5));
                    }
                    tried_again = true;
                    node.clean_up_dead();
                }
                Err(PublisherCreateError::ExceedsMaxSupportedPublishers) => {
                    let holder = ports::publisher(node, &frames);
                    return Err(match frames.static_config().max_publishers() {
                        1 => Error::DomainInUse { topic, domain: node.domain().to_string(), holder },
                        max => Error::TooManyPublishers { topic, max, holder },
                    });
                }
                Err(error) => {
                    return Err(node.keeper().failed(format!("opening {topic} for writing"), error));
                }
            }
        };
        let pool = Pool::take(node, &made, &topic, port.id().value(), booking)?;
        let notifier = events
            .notifier_builder()
            .create()
            .map_err(|error| node.keeper().failed(format!("opening the events of {topic}"), error))?;
        node.keeper().settle();
        let publisher = Self(Arc::new(Own::new(Ports {
            port,
            notifier,
            frames,
            _events: events,
            pool,
            node: node.clone(),
            topic,
            template,
            max_payload_len: spec.max_payload_len,
            max_loaned: spec.loaned,
            next_seq: AtomicU64::new(0),
            known_subscribers: AtomicUsize::new(0),
            last_present: AtomicU64::new(0),
            queue,
        })));
        publisher.check_alignment()?;
        Ok(publisher)
    }

    /// Checks the alignment of one chunk, which stands for all: their distances are multiples of the alignment.
    fn check_alignment(&self) -> Result<(), Error> {
        let frame = self.loan(self.max_payload_len())?;
        let address = frame.payload().as_ptr().addr();
        if address.is_multiple_of(align_of::<FrameHeader>()) {
            Ok(())
        } else {
            Err(Error::transport(format!("making {}", self.topic()), format!("a payload at {address:#x}")))
        }
    }

    /// Returns the topic without a leading slash.
    #[must_use]
    pub fn topic(&self) -> &str {
        &self.0.topic
    }

    /// Returns the largest payload in bytes.
    #[must_use]
    pub fn max_payload_len(&self) -> usize {
        self.0.max_payload_len
    }

    /// Returns the number of subscribers now, with one read of shared memory. A sensor without subscribers need not be
    /// computed.
    #[must_use]
    pub fn subscribers(&self) -> usize {
        self.0.subscribers()
    }

    /// Returns the processes that subscribe to the stream now. Reads some files for each process of the domain.
    #[must_use]
    pub fn consumers(&self) -> Vec<Consumer> {
        ports::consumers(&self.0.node, &self.0.frames).into_iter().map(|(_, consumer)| consumer).collect()
    }

    /// Delivers the newest frame (the stream's history) to subscribers that have connected since it was sent, without
    /// sending anything new. Call it regularly on streams that are written once or rarely. It costs one read of shared
    /// memory if no subscriber has connected.
    ///
    /// # Errors
    /// [`Error::Transport`] if a subscriber cannot be connected; the others are.
    pub fn update(&self) -> Result<(), Error> {
        let ports = &self.0;
        ports.known_subscribers.store(ports.subscribers(), Ordering::Relaxed);
        // Even if their number is the same: one may have gone and another come, or one may have come while a frame was
        // being sent.
        ports
            .port
            .update_connections()
            .map_err(|error| Error::transport(format!("connecting subscribers of {}", ports.topic), error))?;
        let present = ports::sum_of_ports(&ports.frames);
        if ports.last_present.swap(present, Ordering::Relaxed) != present {
            ports.notify();
        }
        Ok(())
    }

    /// Loans a frame of `len` payload bytes: shared memory to write the data into. Its header has the fields of the
    /// stream. Its payload holds zeros or an old frame, so write all of it.
    ///
    /// Dropping the frame unsent returns it. It may be sent from another thread, and may outlive the publisher: the
    /// stream stays open until the frame is gone.
    ///
    /// # Errors
    /// [`Error::FrameTooLarge`], [`Error::NoFreeFrame`]; [`Error::SharedMemoryTooSmall`] if a subscriber has connected
    /// and other data have filled `/dev/shm` since the start.
    pub fn loan(&self, len: usize) -> Result<LoanedFrame, Error> {
        let ports = &self.0;
        ports.pool.take_for(ports.known_subscribers.load(Ordering::Relaxed))?;
        let mut sample = loan::loan_bytes(&ports.port, len).map_err(|error| match error {
            LoanError::ExceedsMaxLoanSize => {
                Error::FrameTooLarge { topic: ports.topic.clone(), len, max: ports.max_payload_len }
            }
            LoanError::ExceedsMaxLoans => {
                Error::NoFreeFrame { topic: ports.topic.clone(), max: ports.max_loaned }
            }
            error => Error::transport(format!("loaning a frame of {}", ports.topic), error),
        })?;
        *sample.user_header_mut() = FrameHeader { payload_len: len as u64, ..ports.template };
        Ok(LoanedFrame { sample: Own::new(sample), ports: ports.clone() })
    }

    /// Sends structs, one per row, on a stream of small fixed messages.
    ///
    /// # Errors
    /// The errors of [`loan`](Self::loan) and [`send`](LoanedFrame::send).
    pub fn send_structs<T: Message>(&self, stamp_ns: u64, structs: &[T]) -> Result<usize, Error> {
        self.loan_structs(stamp_ns, structs)?.send()
    }

    /// Loans a frame that holds structs, one per row, ready to be sent.
    ///
    /// # Errors
    /// The errors of [`loan`](Self::loan).
    pub fn loan_structs<T: Message>(&self, stamp_ns: u64, structs: &[T]) -> Result<LoanedFrame, Error> {
        let bytes: &[u8] = bytemuck::cast_slice(structs);
        let mut frame = self.loan(bytes.len())?;
        frame.payload_mut().copy_from_slice(bytes);
        let header = frame.header_mut();
        header.stamp_ns = stamp_ns;
        header.width = 1;
        header.height = structs.len() as u32;
        header.elem_stride = size_of::<T>() as u32;
        header.row_stride = header.elem_stride;
        Ok(frame)
    }
}

impl Ports {
    fn subscribers(&self) -> usize {
        self.frames.dynamic_config().number_of_subscribers()
    }

    fn notify(&self) {
        // Fails only for a listener with a full queue, which is awake, and for one that is gone.
        let _ = self.notifier.notify();
    }
}

impl fmt::Debug for Publisher {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Publisher")
            .field("topic", &self.0.topic)
            .field("domain", self.0.node.domain())
            .field("max_payload_len", &self.0.max_payload_len)
            .finish_non_exhaustive()
    }
}

/// A frame in shared memory that has not been sent yet.
pub struct LoanedFrame {
    sample: Own<SampleMut<Ipc, [u8], FrameHeader>>,
    ports: Arc<Own<Ports>>,
}

impl LoanedFrame {
    /// Returns the header.
    #[must_use]
    pub fn header(&self) -> &FrameHeader {
        self.sample.user_header()
    }

    /// Returns the header to fill in: stamp, size and strides, pose, the kind's block. The publisher sets `seq`,
    /// `session`, `publish_mono_ns` and `payload_len`.
    pub fn header_mut(&mut self) -> &mut FrameHeader {
        self.sample.user_header_mut()
    }

    /// Returns the payload.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        self.sample.payload()
    }

    /// Returns the payload to write: shared memory, aligned to 64 bytes.
    pub fn payload_mut(&mut self) -> &mut [u8] {
        self.sample.payload_mut()
    }

    /// Delivers the frame to every subscriber and wakes them. Returns the number of subscribers that received it.
    ///
    /// # Errors
    /// [`Error::HeldUp`] if the stream is [lossless](crate::Lossless) and a consumer did not make room in time; the
    /// others have the frame.
    /// [`Error::Transport`] if a subscriber could not be reached; the others were.
    pub fn send(self) -> Result<usize, Error> {
        let session = self.ports.template.session;
        let seq = self.ports.next_seq.fetch_add(1, Ordering::Relaxed);
        self.relay(session, seq)
    }

    /// Sends a frame of another publisher, for example from another machine, with its session and sequence number. From
    /// these consumers can tell how many frames were lost on the way. A publisher that relays frames must not send others.
    ///
    /// # Errors
    /// The errors of [`send`](Self::send).
    pub fn relay(self, session: u64, seq: u64) -> Result<usize, Error> {
        let Self { sample, ports } = self;
        let mut sample = sample.into_inner();
        let header = sample.user_header_mut();
        (header.session, header.seq) = (session, seq);
        header.publish_mono_ns = clock::mono_ns();
        let (header, len) = (sample.user_header(), sample.payload().len());
        debug_assert_eq!(
            header.check(len),
            Ok(()),
            "{}: a header that every subscriber refuses",
            ports.topic
        );
        if let Some(queue) = &ports.queue {
            queue.look_at(&ports.frames);
        }
        let sent = sample.send();
        let subscribers = ports.subscribers();
        ports.known_subscribers.store(subscribers, Ordering::Relaxed);
        if subscribers > 0 {
            ports.notify();
        }
        if let Some((consumer, patience)) = ports.queue.as_ref().and_then(|queue| queue.take_held_up()) {
            return Err(Error::HeldUp { topic: ports.topic.clone(), consumer, patience });
        }
        sent.map_err(|error| Error::transport(format!("sending a frame of {}", ports.topic), error))
    }
}

impl fmt::Debug for LoanedFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LoanedFrame")
            .field("topic", &self.ports.topic)
            .field("header", self.header())
            .finish_non_exhaustive()
    }
}
