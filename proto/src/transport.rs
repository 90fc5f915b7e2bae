//! Shared-memory services of a run: the only module that uses iceoryx2.
//!
//! Each participant has a command topic and a reply topic (fixed header, followed by JSON bytes).
//! Each field has one topic (`[f64]` behind a [`FieldHeader`]). Every process has one doorbell, an
//! event service for messages and heartbeats. Progress reports of a participant have a topic of
//! their own, on which the newest report replaces an unread one.
//!
//! Nothing else is lost silently. Overflow is off, queues are longer than any sequence of messages
//! without a reply, and a send that misses a receiver is an error. Every wait has a deadline.
//!
//! **Connecting.** iceoryx2 counts a subscriber a moment before a publisher can deliver to it.
//! Therefore a participant opens all its field ports first, and nothing is published before all
//! participants have reported that theirs are open. Command topics are used before that, so their
//! first message is resent until delivered.
//!
//! **Waiting.** A waiting process first polls its queue and yields the processor between polls, for
//! at most [`POLL`]. Only then does it sleep on its doorbell. Waking a sleeping process on an idle
//! core of a virtual machine costs tens of microseconds, which dominates a small exchange. Polling
//! without yielding would take the processor from the working peer.

use crate::message::{Command, FieldHeader, MOST_PARTICIPANTS, ProgressReport, Reply};
use crate::run_dir::{RunInfo, close_to_others};
use iceoryx2::prelude::*;
use iceoryx2::service::attribute::{AttributeKey, AttributeValue};
use iceoryx2::{
    port::listener::{Listener, ListenerWaitError},
    port::{BackpressureAction, notifier::Notifier, update_connections::UpdateConnections as _},
    port::{publisher::Publisher, subscriber::Subscriber},
    sample::Sample,
    sample_mut::SampleMut,
    service::port_factory::event::PortFactory as EventFactory,
    service::port_factory::publish_subscribe::PortFactory as TopicFactory,
};
use std::cell::Cell;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Thread-safe variant: the heartbeat has a thread of its own.
type Ipc = ipc_threadsafe::Service;

/// Longest time that a waiting process polls before it sleeps.
pub const POLL: Duration = Duration::from_micros(100);
/// Capacity of a subscriber's queue [samples]; the protocol never has more than two messages in
/// flight.
const QUEUE: usize = 4;
/// Number of samples a subscriber may hold: the current one and its replacement.
const BORROWED: usize = 2;
/// Maximum number of members of a run, and of subscribers to a topic: participants, coordinator and
/// recorder.
const MAX_MEMBERS: usize = MOST_PARTICIPANTS + 4;
/// Number of samples in a field's segment: one being written, and two that readers may hold.
pub const FIELD_SLOTS: u64 = 4;
/// Maximum number of values of a growing field: a segment of this size exceeds the memory of any
/// machine.
const MOST_VALUES: u64 = 1 << 32;
/// Minimum size of a field's first segment [values]: one page.
const LEAST_ROOM: usize = 512;
/// Time after which an undeliverable send fails.
const DELIVERY: Duration = Duration::from_secs(5);
/// Size of the table of open files: enough for several sets of participants at a time.
const OPEN_FILES: i32 = 1024;
/// Event id of a message; the heartbeats of participant `i` use `BEATS` ids of their own.
const MESSAGE: usize = 0;
/// Number of heartbeat kinds: busy, and idle after a command with one of `ANSWERS` numbers.
const BEATS: usize = 1 + ANSWERS as usize;
/// A heartbeat contains the number of the last answered command modulo this value; at most two
/// commands are in flight to a participant.
const ANSWERS: u64 = 4;

/// A fixed header of the contract.
///
/// # Safety
/// The type must be `#[repr(C)]`, free of pointers, and valid for every bit pattern. The tests of
/// [`crate::message`] pin its layout.
pub unsafe trait Header: std::fmt::Debug + Copy + Default + 'static {
    /// Name of the layout, compared by both sides.
    const LAYOUT: &'static str;
}

// SAFETY: the types of `message` satisfy the requirements of the trait.
unsafe impl Header for Command {
    const LAYOUT: &'static str = "cosim.Command.v1";
}
// SAFETY: as above.
unsafe impl Header for Reply {
    const LAYOUT: &'static str = "cosim.Reply.v3";
}
// SAFETY: as above.
unsafe impl Header for FieldHeader {
    const LAYOUT: &'static str = "cosim.FieldHeader.v1";
}

// SAFETY: as above.
unsafe impl Header for ProgressReport {
    const LAYOUT: &'static str = "cosim.ProgressReport.v1";
}

/// Handling of samples that are not received in time.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Queue {
    /// All samples are kept; the queue has room for everything the protocol has in flight.
    Every,
    /// Only the newest sample is kept.
    Newest,
}

/// A header in a sample, wrapped to implement the trait that iceoryx2 requires.
#[derive(Clone, Copy, Debug, Default)]
#[repr(transparent)]
struct Wire<H>(H);

// SAFETY: a transparent wrapper of a `Header`, which makes the same promises.
unsafe impl<H: Header> ZeroCopySend for Wire<H> {
    unsafe fn type_name() -> &'static str {
        H::LAYOUT
    }
}

/// A failure of the shared-memory services.
#[derive(Debug, thiserror::Error)]
pub enum TransportError {
    /// A service or port could not be opened.
    #[error("cannot open the shared-memory service `{service}`: {cause}")]
    Open {
        /// Name of the service.
        service: String,
        /// Message of iceoryx2.
        cause: String,
    },
    /// A sample could not be loaned, sent or received.
    #[error("exchange on `{service}` failed: {cause}")]
    Exchange {
        /// Name of the service.
        service: String,
        /// Message of iceoryx2.
        cause: String,
    },
    /// A sample did not reach all receivers.
    #[error("a sample of `{service}` reached {reached} of {expected} receivers")]
    NotDelivered {
        /// Name of the service.
        service: String,
        /// Number of receivers reached.
        reached: usize,
        /// Number of receivers required.
        expected: usize,
    },
    /// No peer joined before the deadline.
    #[error("nobody joined `{service}` within {seconds:.0} s")]
    NobodyJoined {
        /// Name of the service.
        service: String,
        /// The deadline [s].
        seconds: f64,
    },
}

/// Number of slots in the first segment of a growing field. iceoryx2 loses one slot to alignment
/// whenever a field moves to a larger segment, and ends the topic after 254 segments. Without spare
/// slots, a field would need a new segment for each sample. There is one spare slot for every
/// doubling up to [`MOST_VALUES`]. Only used slots take memory, and the lowest free slot is used
/// first, so spare slots take none.
fn growing_slots(room: usize) -> usize {
    let doublings = MOST_VALUES.ilog2().saturating_sub(room.ilog2());
    FIELD_SLOTS as usize + doublings as usize
}

impl TransportError {
    /// Returns advice to the user for a field that could not be sent to `receivers`.
    #[must_use]
    pub fn advice(&self, receivers: &str) -> String {
        match self {
            Self::NotDelivered { .. } => {
                format!("see log.jsonl; {receivers} may have left inputs unread")
            }
            Self::NobodyJoined { .. } => {
                format!("see log.jsonl; {receivers} may not have started")
            }
            Self::Open { .. } | Self::Exchange { .. } => {
                "there may be too little shared memory: free some in /dev/shm, or choose coarser grids"
                    .to_owned()
            }
        }
    }
}

fn open_error(service: &str, cause: impl std::fmt::Debug) -> TransportError {
    TransportError::Open { service: service.to_owned(), cause: format!("{cause:?}") }
}

fn exchange_error(service: &str, cause: impl std::fmt::Debug) -> TransportError {
    TransportError::Exchange { service: service.to_owned(), cause: format!("{cause:?}") }
}

/// Prepares a process for the services of a run. Call it only in `main`, before threads are
/// started, because both settings affect the whole process.
///
/// - iceoryx2 writes nothing to standard error; its messages are returned as errors.
/// - The kernel's table of open files gets room for the ports of a run. An initial table has 64
///   places, fewer than the ports need. If a process with threads extends its table later, the
///   kernel waits 10 to 25 ms until no thread reads the old one.
pub fn prepare_process() {
    set_log_level(LogLevel::Fatal);
    // Duplicates a descriptor and closes it at once; without effect if the limit of open files is
    // lower.
    let _ = rustix::io::fcntl_dupfd_cloexec(std::io::stderr(), OPEN_FILES - 1);
}

/// Membership of a process in the shared-memory services of a run.
///
/// Ports of fields stay open after their [`FieldReader`] or [`FieldWriter`] is dropped. Opening a
/// port takes as long as a small solve, and the next run of the same participants needs most of
/// them again. [`Endpoint::close_unused`] closes the unused ones.
#[derive(Debug)]
pub struct Endpoint {
    // Before the node: ports must close before their node.
    readers: Mutex<Vec<Arc<ReaderPort>>>,
    writers: Mutex<Vec<Arc<WriterPort>>>,
    node: Node<Ipc>,
    /// Version of the contract in the run; an attribute of its services.
    protocol: u32,
}

impl Endpoint {
    /// Opens the run's services for this process, under the run's own root path and prefix.
    pub fn open(run: &RunInfo) -> Result<Self, TransportError> {
        let config = isolated_config(run).map_err(|e| open_error(&run.prefix, e))?;
        let node = NodeBuilder::new()
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .config(&config)
            .create::<Ipc>()
            .map_err(|e| open_error(&run.prefix, e))?;
        close_to_others(&run.prefix).map_err(|e| open_error(&run.prefix, e))?;
        let (readers, writers) = (Mutex::default(), Mutex::default());
        Ok(Self { readers, writers, node, protocol: run.protocol })
    }

    fn topic<P, H>(
        &self,
        name: &str,
        queue: Queue,
    ) -> Result<TopicFactory<Ipc, [P], Wire<H>>, TransportError>
    where
        P: std::fmt::Debug + ZeroCopySend + 'static,
        H: Header,
    {
        let service = ServiceName::new(name).map_err(|e| open_error(name, e))?;
        let (key, value) = protocol_attribute(self.protocol).map_err(|e| open_error(name, e))?;
        let version =
            AttributeVerifier::new().require(&key, &value).map_err(|e| open_error(name, e))?;
        self.node
            .service_builder(&service)
            .publish_subscribe::<[P]>()
            .user_header::<Wire<H>>()
            .payload_alignment(Alignment::ALIGN_64)
            .enable_safe_overflow(queue == Queue::Newest)
            .history_size(0)
            .subscriber_max_buffer_size(if queue == Queue::Newest { 1 } else { QUEUE })
            .subscriber_max_borrowed_samples(BORROWED)
            .max_publishers(1)
            .max_subscribers(MAX_MEMBERS)
            .max_nodes(MAX_MEMBERS + 1)
            .open_or_create_with_attributes(&version)
            .map_err(|e| open_error(name, e))
    }

    fn sender<H: Header>(&self, name: String, queue: Queue) -> Result<Sender<H>, TransportError> {
        let topic = self.topic::<u8, H>(&name, queue)?;
        let publisher = topic
            .publisher_builder()
            .initial_max_slice_len(4096)
            .allocation_strategy(AllocationStrategy::PowerOfTwo)
            .set_backpressure_handler(retry_then_fail)
            .create()
            .map_err(|e| open_error(&name, e))?;
        Ok(Sender { publisher, topic, name, connected: Cell::new(false) })
    }

    fn receiver<H: Header>(
        &self,
        name: String,
        queue: Queue,
    ) -> Result<Receiver<H>, TransportError> {
        let topic = self.topic::<u8, H>(&name, queue)?;
        let subscriber = topic.subscriber_builder().create().map_err(|e| open_error(&name, e))?;
        Ok(Receiver { subscriber, topic, name })
    }

    /// Opens the sender of commands to a participant, for the coordinator.
    pub fn command_sender(&self, role: &str) -> Result<Sender<Command>, TransportError> {
        self.sender(format!("command/{role}"), Queue::Every)
    }

    /// Opens the receiver of commands, for a participant.
    pub fn command_receiver(&self, role: &str) -> Result<Receiver<Command>, TransportError> {
        self.receiver(format!("command/{role}"), Queue::Every)
    }

    /// Opens the sender of replies, for a participant.
    pub fn reply_sender(&self, role: &str) -> Result<Sender<Reply>, TransportError> {
        self.sender(format!("reply/{role}"), Queue::Every)
    }

    /// Opens the receiver of a participant's replies, for the coordinator.
    pub fn reply_receiver(&self, role: &str) -> Result<Receiver<Reply>, TransportError> {
        self.receiver(format!("reply/{role}"), Queue::Every)
    }

    /// Opens the sender of progress reports, for a participant.
    pub fn progress_sender(&self, role: &str) -> Result<Sender<ProgressReport>, TransportError> {
        self.sender(format!("progress/{role}"), Queue::Newest)
    }

    /// Opens the receiver of a participant's progress reports, for the coordinator.
    pub fn progress_receiver(
        &self,
        role: &str,
    ) -> Result<Receiver<ProgressReport>, TransportError> {
        self.receiver(format!("progress/{role}"), Queue::Newest)
    }

    /// Opens a writer for a field, with room for samples of `values` doubles. A larger sample moves
    /// the field to a new segment of at least twice the size.
    pub fn field_writer(
        &self,
        service: &str,
        values: usize,
        subscribers: usize,
    ) -> Result<FieldWriter, TransportError> {
        let room = values.max(LEAST_ROOM);
        self.field_writer_with(service, (room, growing_slots(room)), subscribers)
    }

    /// Opens a writer for a field whose samples all have `values` doubles; reserves fewer slots.
    pub fn fixed_field_writer(
        &self,
        service: &str,
        values: usize,
        subscribers: usize,
    ) -> Result<FieldWriter, TransportError> {
        self.field_writer_with(service, (values.max(1), FIELD_SLOTS as usize), subscribers)
    }

    fn field_writer_with(
        &self,
        service: &str,
        (room, slots): (usize, usize),
        subscribers: usize,
    ) -> Result<FieldWriter, TransportError> {
        let mut writers = lock(&self.writers);
        let is_free = |port: &Arc<WriterPort>| port.name == service && Arc::strong_count(port) == 1;
        if let Some(at) = writers.iter().position(is_free) {
            let fits =
                |port: &WriterPort| (room..=2 * room).contains(&port.room) && port.slots >= slots;
            if fits(&writers[at]) {
                return Ok(FieldWriter { port: Arc::clone(&writers[at]), subscribers });
            }
            // A topic has a single writer.
            writers.remove(at);
        }
        let topic = self.topic::<f64, FieldHeader>(service, Queue::Every)?;
        let publisher = topic
            .publisher_builder()
            .initial_max_slice_len(room)
            .allocation_strategy(AllocationStrategy::PowerOfTwo)
            .max_loaned_samples(1)
            .override_sample_preallocation(move |worst| worst.min(slots))
            .set_backpressure_handler(retry_then_fail)
            .create()
            .map_err(|e| open_error(service, e))?;
        let name = service.to_owned();
        let port = Arc::new(WriterPort { publisher, topic, name, room, slots });
        writers.push(Arc::clone(&port));
        Ok(FieldWriter { port, subscribers })
    }

    /// Opens a reader for a field; its queue is empty.
    pub fn field_reader(&self, service: &str) -> Result<FieldReader, TransportError> {
        let mut readers = lock(&self.readers);
        let is_free =
            |port: &&Arc<ReaderPort>| port.name == service && Arc::strong_count(port) == 1;
        if let Some(port) = readers.iter().find(is_free) {
            let reader = FieldReader { port: Arc::clone(port) };
            // Discards unread samples of an earlier run.
            while reader.receive()?.is_some() {}
            return Ok(reader);
        }
        let topic = self.topic::<f64, FieldHeader>(service, Queue::Every)?;
        let subscriber = topic.subscriber_builder().create().map_err(|e| open_error(service, e))?;
        let port = Arc::new(ReaderPort { subscriber, _topic: topic, name: service.to_owned() });
        readers.push(Arc::clone(&port));
        Ok(FieldReader { port })
    }

    /// Closes unused ports of fields. Writers count their readers, so ports of an earlier run must
    /// be closed before the next run waits for its readers.
    pub fn close_unused(&self) {
        lock(&self.readers).retain(|port| Arc::strong_count(port) > 1);
        lock(&self.writers).retain(|port| Arc::strong_count(port) > 1);
    }

    fn bell(&self, name: &str) -> Result<EventFactory<Ipc>, TransportError> {
        let service = ServiceName::new(name).map_err(|e| open_error(name, e))?;
        self.node
            .service_builder(&service)
            .event()
            .max_listeners(1)
            .max_notifiers(2 * MAX_MEMBERS)
            // A heartbeat may come from a process of its own.
            .max_nodes(2 * MAX_MEMBERS + 1)
            .event_id_max_value(BEATS * MAX_MEMBERS)
            .disable_deadline()
            .disable_notifier_created_event()
            .disable_notifier_dropped_event()
            .disable_notifier_dead_event()
            .open_or_create()
            .map_err(|e| open_error(name, e))
    }

    /// Opens the doorbell of this process.
    pub fn doorbell(&self, name: &str) -> Result<Doorbell, TransportError> {
        let name = format!("bell/{name}");
        let bell = self.bell(&name)?;
        let listener = bell.listener_builder().create().map_err(|e| open_error(&name, e))?;
        Ok(Doorbell { listener, _bell: bell, name })
    }

    /// Opens a ringer for another process's doorbell.
    pub fn ringer(&self, name: &str) -> Result<Ringer, TransportError> {
        let name = format!("bell/{name}");
        let bell = self.bell(&name)?;
        let notifier = bell.notifier_builder().create().map_err(|e| open_error(&name, e))?;
        Ok(Ringer { bell: Arc::new((notifier, bell)), name })
    }
}

fn isolated_config(run: &RunInfo) -> Result<Config, SemanticStringError> {
    let mut config = Config::default();
    config.global.prefix = FileName::new(run.prefix.as_bytes())?;
    config.global.set_root_path(&Path::new(run.folder.as_os_str().as_encoded_bytes())?);
    // `run_dir` removes a run's folder as a whole, so no process has to look for dead nodes.
    config.global.service.cleanup_dead_nodes_on_open = false;
    config.global.node.cleanup_dead_nodes_on_creation = false;
    config.global.node.cleanup_dead_nodes_on_destruction = false;
    Ok(config)
}

fn protocol_attribute(version: u32) -> Result<(AttributeKey, AttributeValue), SemanticStringError> {
    let key = AttributeKey::new(b"cosim.protocol")?;
    let value = AttributeValue::new(version.to_string().as_bytes())?;
    Ok((key, value))
}

fn retry_then_fail(info: &iceoryx2::port::BackpressureInfo) -> BackpressureAction {
    if info.elapsed_time < DELIVERY {
        std::thread::yield_now();
        BackpressureAction::Retry
    } else {
        BackpressureAction::DiscardDataAndFail
    }
}

/// Polls until `ready` or the deadline, yielding the processor in between.
fn until(deadline: Instant, mut ready: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while !ready() {
        let now = Instant::now();
        if now >= deadline {
            return false;
        }
        if now - start < POLL {
            std::thread::yield_now();
        } else {
            std::thread::sleep(Duration::from_micros(200));
        }
    }
    true
}

/// Sends messages with a fixed header and bytes. Each topic has one sender and one receiver.
#[derive(Debug)]
pub struct Sender<H: Header> {
    publisher: Publisher<Ipc, [u8], Wire<H>>,
    topic: TopicFactory<Ipc, [u8], Wire<H>>,
    name: String,
    /// True after the first delivery.
    connected: Cell<bool>,
}

impl<H: Header> Sender<H> {
    /// Returns true if the receiver has joined.
    #[must_use]
    pub fn is_heard(&self) -> bool {
        self.topic.dynamic_config().number_of_subscribers() > 0
    }

    /// Sends a message; it is in the receiver's queue when this returns. The first message is
    /// resent while the receiver is counted but cannot be delivered to yet.
    pub fn send(&self, header: &H, body: &[u8]) -> Result<(), TransportError> {
        let deadline = Instant::now() + DELIVERY;
        let mut reached = self.try_send(header, body)?;
        while reached == 0 && !self.connected.get() && self.is_heard() && Instant::now() < deadline
        {
            std::thread::yield_now();
            reached = self.try_send(header, body)?;
        }
        if reached == 1 {
            self.connected.set(true);
            return Ok(());
        }
        Err(TransportError::NotDelivered { service: self.name.clone(), reached, expected: 1 })
    }

    /// Sends a header without bytes; returns true if it reached a receiver.
    pub fn offer(&self, header: &H) -> Result<bool, TransportError> {
        Ok(self.try_send(header, &[])? > 0)
    }

    /// Connects to the receiver if there is one, and sends; returns the number of receivers
    /// reached.
    fn try_send(&self, header: &H, body: &[u8]) -> Result<usize, TransportError> {
        let mut sample = self
            .publisher
            .loan_slice_uninit(body.len())
            .map_err(|e| exchange_error(&self.name, e))?;
        *sample.user_header_mut() = Wire(*header);
        sample.write_from_slice(body).send().map_err(|e| exchange_error(&self.name, e))
    }
}

/// Receives messages in the order of sending.
#[derive(Debug)]
pub struct Receiver<H: Header> {
    subscriber: Subscriber<Ipc, [u8], Wire<H>>,
    topic: TopicFactory<Ipc, [u8], Wire<H>>,
    name: String,
}

/// A received message; the bytes are read in place.
#[derive(Debug)]
pub struct Message<H: Header>(Sample<Ipc, [u8], Wire<H>>);

impl<H: Header> Message<H> {
    /// Returns the fixed header.
    #[must_use]
    pub fn header(&self) -> &H {
        &self.0.user_header().0
    }

    /// Returns the bytes behind the header.
    #[must_use]
    pub fn body(&self) -> &[u8] {
        self.0.payload()
    }
}

impl<H: Header> Receiver<H> {
    /// Returns true if the sender has joined.
    #[must_use]
    pub fn is_served(&self) -> bool {
        self.topic.dynamic_config().number_of_publishers() > 0
    }

    /// Returns the next message, if one has arrived.
    pub fn receive(&self) -> Result<Option<Message<H>>, TransportError> {
        let sample = self.subscriber.receive().map_err(|e| exchange_error(&self.name, e))?;
        Ok(sample.map(Message))
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An open port that publishes a field.
#[derive(Debug)]
struct WriterPort {
    publisher: Publisher<Ipc, [f64], Wire<FieldHeader>>,
    topic: TopicFactory<Ipc, [f64], Wire<FieldHeader>>,
    name: String,
    /// Size of a sample in the first segment [values], and the number of slots there.
    room: usize,
    slots: usize,
}

/// Publishes one field.
#[derive(Debug)]
pub struct FieldWriter {
    port: Arc<WriterPort>,
    subscribers: usize,
}

/// Buffer in shared memory for the values of a field.
#[derive(Debug)]
pub struct FieldLoan(SampleMut<Ipc, [f64], Wire<FieldHeader>>);

impl FieldLoan {
    /// Returns the values; they hold old data until written.
    #[must_use]
    pub fn values(&mut self) -> &mut [f64] {
        self.0.payload_mut()
    }
}

impl FieldWriter {
    /// Waits until all required subscribers have joined.
    pub fn wait_for_subscribers(&self, deadline: Instant) -> Result<(), TransportError> {
        let start = Instant::now();
        let there = || self.port.topic.dynamic_config().number_of_subscribers() >= self.subscribers;
        if until(deadline, there) {
            return self
                .port
                .publisher
                .update_connections()
                .map_err(|e| exchange_error(&self.port.name, e));
        }
        Err(TransportError::NobodyJoined {
            service: self.port.name.clone(),
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// Returns a buffer for `values` doubles.
    pub fn loan(&self, values: usize) -> Result<FieldLoan, TransportError> {
        let sample = self
            .port
            .publisher
            .loan_slice_uninit(values)
            .map_err(|e| exchange_error(&self.port.name, e))?;
        // SAFETY: the segment is mapped memory, zeroed by the kernel, to which only doubles were
        // written; every bit pattern is a valid f64.
        Ok(FieldLoan(unsafe { sample.assume_init() }))
    }

    /// Publishes a written loan.
    pub fn publish(&self, mut loan: FieldLoan, header: &FieldHeader) -> Result<(), TransportError> {
        *loan.0.user_header_mut() = Wire(*header);
        let reached = loan.0.send().map_err(|e| exchange_error(&self.port.name, e))?;
        if reached == self.subscribers {
            return Ok(());
        }
        Err(TransportError::NotDelivered {
            service: self.port.name.clone(),
            reached,
            expected: self.subscribers,
        })
    }
}

/// An open port that receives a field.
#[derive(Debug)]
struct ReaderPort {
    subscriber: Subscriber<Ipc, [f64], Wire<FieldHeader>>,
    _topic: TopicFactory<Ipc, [f64], Wire<FieldHeader>>,
    name: String,
}

/// Receives one field.
#[derive(Debug)]
pub struct FieldReader {
    port: Arc<ReaderPort>,
}

/// A received sample of a field, read in place.
#[derive(Debug)]
pub struct FieldSample(Sample<Ipc, [f64], Wire<FieldHeader>>);

impl FieldSample {
    /// Returns the label.
    #[must_use]
    pub fn header(&self) -> &FieldHeader {
        &self.0.user_header().0
    }

    /// Returns the values, component-major.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        self.0.payload()
    }
}

impl FieldReader {
    /// Connects to the current writer, so that later samples are received even if the writer has
    /// left by then. [`FieldReader::receive`] also connects.
    pub fn connect(&self) -> Result<(), TransportError> {
        self.port.subscriber.update_connections().map_err(|e| exchange_error(&self.port.name, e))
    }

    /// Returns the next sample, if one has arrived.
    pub fn receive(&self) -> Result<Option<FieldSample>, TransportError> {
        let sample =
            self.port.subscriber.receive().map_err(|e| exchange_error(&self.port.name, e))?;
        Ok(sample.map(FieldSample))
    }
}

/// Event on which a process sleeps until a message or heartbeat arrives.
#[derive(Debug)]
pub struct Doorbell {
    listener: Listener<Ipc>,
    _bell: EventFactory<Ipc>,
    name: String,
}

impl Doorbell {
    /// Longest sleep between two polls.
    pub const NAP: Duration = Duration::from_millis(20);

    /// Polls until `poll` returns a value or an error, at least every [`Doorbell::NAP`]. `beat`
    /// receives each heartbeat in the meantime, with the index of its participant. `poll` is
    /// responsible for the deadline.
    pub fn wait<T, E: From<TransportError>>(
        &self,
        mut poll: impl FnMut() -> Result<Option<T>, E>,
        mut beat: impl FnMut(usize, Beat),
    ) -> Result<T, E> {
        let start = Instant::now();
        loop {
            if let Some(value) = poll()? {
                return Ok(value);
            }
            if start.elapsed() < POLL {
                std::thread::yield_now();
                continue;
            }
            let ring = |event: EventActivation| {
                if let Some((index, what)) = Beat::of_event(event.id.as_value()) {
                    beat(index, what);
                }
            };
            match self.listener.timed_wait(ring, Self::NAP) {
                // A handled signal ends the sleep; `poll` decides what to do.
                Ok(_) | Err(ListenerWaitError::InterruptSignal) => {}
                Err(error) => return Err(E::from(exchange_error(&self.name, error))),
            }
        }
    }
}

/// Content of a heartbeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beat {
    /// The participant is working on a command.
    Busy,
    /// The participant waits for a command and has sent all due replies.
    Idle {
        /// Sequence number of the last command answered, modulo [`ANSWERS`].
        answered: u64,
    },
}

impl Beat {
    /// Returns the heartbeat of a participant that is idle after the command with this number.
    #[must_use]
    pub fn idle_after(command: u64) -> Self {
        Self::Idle { answered: command % ANSWERS }
    }

    fn event(self, index: usize) -> usize {
        let kind = match self {
            Self::Busy => 0,
            Self::Idle { answered } => 1 + (answered % ANSWERS) as usize,
        };
        MESSAGE + 1 + BEATS * index + kind
    }

    fn of_event(event: usize) -> Option<(usize, Self)> {
        let number = event.checked_sub(MESSAGE + 1)?;
        let beat = match number % BEATS {
            0 => Self::Busy,
            kind => Self::Idle { answered: kind as u64 - 1 },
        };
        Some((number / BEATS, beat))
    }
}

/// Rings another process's doorbell; may be shared between threads.
#[derive(Clone, Debug)]
pub struct Ringer {
    bell: Arc<(Notifier<Ipc>, EventFactory<Ipc>)>,
    name: String,
}

impl Ringer {
    /// Signals that a message has been sent.
    pub fn ring(&self) -> Result<(), TransportError> {
        self.notify(MESSAGE)
    }

    /// Sends a heartbeat of participant `index`.
    pub fn beat(&self, index: usize, beat: Beat) -> Result<(), TransportError> {
        self.notify(beat.event(index))
    }

    fn notify(&self, event: usize) -> Result<(), TransportError> {
        self.bell
            .0
            .notify_with_custom_event_id(EventId::new(event))
            .map_err(|e| exchange_error(&self.name, e))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run_dir::RunDir;

    fn within(run: &RunInfo, act: impl FnOnce(&Endpoint, &Endpoint)) {
        let open = || Endpoint::open(run).unwrap();
        act(&open(), &open());
    }

    fn send(writer: &FieldWriter, value: f64) -> Result<(), TransportError> {
        let mut loan = writer.loan(3)?;
        loan.values().fill(value);
        writer.publish(loan, &FieldHeader::default())
    }

    /// The next run reuses the ports of the previous run, without its unread samples.
    #[test]
    fn ports_stay_open_until_nobody_wants_them() {
        let run = RunDir::create(&["one".to_owned()]).unwrap();
        within(run.info(), |producer, consumer| {
            let open = || {
                let reader = consumer.field_reader("field/a").unwrap();
                let writer = producer.fixed_field_writer("field/a", 3, 1).unwrap();
                writer.wait_for_subscribers(Instant::now() + DELIVERY).unwrap();
                (writer, reader)
            };
            let (writer, reader) = open();
            send(&writer, 1.0).unwrap();
            send(&writer, 2.0).unwrap();
            assert_eq!(reader.receive().unwrap().unwrap().values(), [1.0; 3]);
            let ports = (Arc::as_ptr(&writer.port), Arc::as_ptr(&reader.port));
            drop((writer, reader));
            let (writer, reader) = open();
            assert_eq!(ports, (Arc::as_ptr(&writer.port), Arc::as_ptr(&reader.port)));
            assert!(reader.receive().unwrap().is_none(), "the second sample was of the run before");
            send(&writer, 3.0).unwrap();
            assert_eq!(reader.receive().unwrap().unwrap().values(), [3.0; 3]);
            drop(reader);
            consumer.close_unused();
            let lost = send(&writer, 4.0).unwrap_err().to_string();
            assert!(lost.ends_with("reached 0 of 1 receivers"), "{lost}");
        });
    }

    /// A smaller field does not keep the memory of a much larger one, and a larger field gets
    /// enough room.
    #[test]
    fn a_field_of_another_size_gets_a_segment_of_its_own() {
        let run = RunDir::create(&["one".to_owned()]).unwrap();
        within(run.info(), |producer, _| {
            let room = |values| {
                let writer = producer.fixed_field_writer("field/a", values, 1).unwrap();
                writer.loan(values).unwrap();
                writer.port.room
            };
            assert_eq!([1000, 700, 500, 499, 1000].map(room), [1000, 1000, 1000, 499, 1000]);
        });
    }

    /// Every doubling from any size costs one slot, and the original number of slots remains.
    #[test]
    fn every_doubling_has_a_spare_slot() {
        for room in [LEAST_ROOM, 5000, 1 << 20, (1 << 31) - 1, 1 << 31] {
            let doublings = (0..64).find(|n| (room as u64) << n >= MOST_VALUES).unwrap_or(0);
            assert!(growing_slots(room) >= FIELD_SLOTS as usize + doublings, "{room}");
            assert!(growing_slots(room) <= FIELD_SLOTS as usize + 23, "{room}");
        }
    }

    /// Exhausted memory is not blamed on a receiver.
    #[test]
    fn advice_names_the_receiver_only_if_a_sample_did_not_arrive() {
        let service = "field/a/b".to_owned();
        let lost =
            TransportError::NotDelivered { service: service.clone(), reached: 0, expected: 1 };
        assert_eq!(lost.advice("mech"), "see log.jsonl; mech may have left inputs unread");
        let full = TransportError::Exchange { service, cause: "OutOfMemory".to_owned() };
        assert!(!full.advice("mech").contains("mech"), "{}", full.advice("mech"));
    }
}
