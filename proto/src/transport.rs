//! Shared-memory services of a run: the only module that knows iceoryx2.
//!
//! Per participant there is a command topic and a reply topic (fixed header, JSON bytes behind
//! it) and per field one topic (`[f64]` behind a [`FieldHeader`]). Every process has one doorbell,
//! an event service, on which messages and heartbeats ring. How far a participant is with long work
//! has a topic of its own, on which the newest report replaces one that was not read.
//!
//! Nothing else is lost silently: overflow is off, the queues are longer than anything the protocol
//! sends without an answer, and a send that does not reach the expected number of receivers is an
//! error. Nothing waits without a deadline.
//!
//! **Connecting.** iceoryx2 counts a subscriber a moment before a publisher can deliver to it. So a
//! participant opens all its field ports first, and nothing is published before all have said that
//! theirs are open; and the first message on a topic that is used before that, a command topic, is
//! sent again until it is delivered.
//!
//! **Waiting.** A waiting process first polls its queue and yields the processor between polls,
//! for at most [`POLL`], and only then sleeps on its doorbell. Waking a sleeping process on an idle
//! core costs tens of microseconds on a virtual machine, which is most of the time of a small
//! exchange; polling without yielding would take the processor from the peer that works.

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

/// The thread-safe variant: the heartbeat rings from a thread of its own.
type Ipc = ipc_threadsafe::Service;

/// How long a waiting process polls before it sleeps.
pub const POLL: Duration = Duration::from_micros(100);
/// Samples a subscriber's queue holds; the protocol never has more than two messages in flight.
const QUEUE: usize = 4;
/// Samples a subscriber may hold: the one in use and the one that replaces it.
const BORROWED: usize = 2;
/// Members of a run, and subscribers to one topic: its participants, the coordinator, and what records.
const MAX_MEMBERS: usize = MOST_PARTICIPANTS + 4;
/// Samples in a field's segment: one being written, and two that readers may hold.
pub const FIELD_SLOTS: u64 = 4;
/// Values to which a field may grow: a segment of this size fills the memory of any machine.
const MOST_VALUES: u64 = 1 << 32;
/// Least room of a field's first segment [values], one page.
const LEAST_ROOM: usize = 512;
/// A send that cannot be delivered is retried for this long.
const DELIVERY: Duration = Duration::from_secs(5);
/// Places in the table of open files: enough for several sets of participants at a time.
const OPEN_FILES: i32 = 1024;
/// Event id of a message; the heartbeats of participant `i` ring with `BEATS` ids of its own.
const MESSAGE: usize = 0;
/// Kinds of heartbeat: busy, and idle after the last of `ANSWERS` commands in turn.
const BEATS: usize = 1 + ANSWERS as usize;
/// A heartbeat names the last command that was answered by its number modulo this; two commands at
/// most are on their way to a participant.
const ANSWERS: u64 = 4;

/// A fixed header of the contract.
///
/// # Safety
/// The type is `#[repr(C)]`, self-contained, without pointers, and valid with every bit pattern; the
/// tests of [`crate::message`] pin its layout.
pub unsafe trait Header: std::fmt::Debug + Copy + Default + 'static {
    /// Name of the layout, which both sides compare.
    const LAYOUT: &'static str;
}

// SAFETY: what the trait asks for, see `message`.
unsafe impl Header for Command {
    const LAYOUT: &'static str = "cosim.Command.v1";
}
// SAFETY: as above.
unsafe impl Header for Reply {
    const LAYOUT: &'static str = "cosim.Reply.v2";
}
// SAFETY: as above.
unsafe impl Header for FieldHeader {
    const LAYOUT: &'static str = "cosim.FieldHeader.v1";
}

// SAFETY: as above.
unsafe impl Header for ProgressReport {
    const LAYOUT: &'static str = "cosim.ProgressReport.v1";
}

/// What becomes of samples that are not received in time.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Queue {
    /// Every one is kept; there is room for all that the protocol has in flight.
    Every,
    /// The newest one is kept.
    Newest,
}

/// A header in a sample: iceoryx2 asks for a trait of its own.
#[derive(Clone, Copy, Debug, Default)]
#[repr(transparent)]
struct Wire<H>(H);

// SAFETY: a transparent wrapper of what `Header` promises.
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
        /// What iceoryx2 says.
        cause: String,
    },
    /// A sample could not be loaned, sent or received.
    #[error("exchange on `{service}` failed: {cause}")]
    Exchange {
        /// Name of the service.
        service: String,
        /// What iceoryx2 says.
        cause: String,
    },
    /// A sample did not reach everybody.
    #[error("a sample of `{service}` reached {reached} of {expected} receivers")]
    NotDelivered {
        /// Name of the service.
        service: String,
        /// Receivers reached.
        reached: usize,
        /// Receivers there have to be.
        expected: usize,
    },
    /// The other side did not come in time.
    #[error("nobody joined `{service}` within {seconds:.0} s")]
    NobodyJoined {
        /// Name of the service.
        service: String,
        /// The deadline [s].
        seconds: f64,
    },
}

/// Slots of the first segment of a field that may grow. iceoryx2 loses one slot to alignment whenever it moves a field to a larger
/// segment, and ends the topic after 254 segments, so that a field without spare slots needs a segment a
/// sample. There is a spare one for every doubling up to [`MOST_VALUES`]. Memory is taken by slots that are
/// used, and the lowest free one is used first: spare slots take none.
fn growing_slots(room: usize) -> usize {
    let doublings = MOST_VALUES.ilog2().saturating_sub(room.ilog2());
    FIELD_SLOTS as usize + doublings as usize
}

impl TransportError {
    /// Advice for a field that could not be sent to `receivers`.
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

/// Prepares a process for the services of a run. Only a program's `main` calls it, before it starts
/// threads: both settings belong to the whole process.
///
/// - iceoryx2 writes nothing to standard error: whatever it has to say comes as an error.
/// - The kernel's table of open files has room for the ports of a run. To extend the table of a
///   process with threads, the kernel waits 10 to 25 ms until no thread reads the old one; ports
///   need more than the 64 places with which a table begins.
pub fn prepare_process() {
    set_log_level(LogLevel::Fatal);
    // A copy of an open file, closed at once. Where the limit of open files is lower, it does nothing.
    let _ = rustix::io::fcntl_dupfd_cloexec(std::io::stderr(), OPEN_FILES - 1);
}

/// A process's membership in the shared-memory services of a run.
///
/// Ports of fields stay open after their [`FieldReader`] or [`FieldWriter`] is dropped: opening one
/// takes as long as a small solve, and the next run of the same participants needs most of them
/// again. [`Endpoint::close_unused`] closes those that nobody uses.
#[derive(Debug)]
pub struct Endpoint {
    // Before the node, which ports belong to.
    readers: Mutex<Vec<Arc<ReaderPort>>>,
    writers: Mutex<Vec<Arc<WriterPort>>>,
    node: Node<Ipc>,
    /// Version of the contract that the run is of; an attribute of its services.
    protocol: u32,
}

impl Endpoint {
    /// Opens the run's services for this process, under the run's own root and prefix.
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

    /// Coordinator: the way to send commands to a participant.
    pub fn command_sender(&self, role: &str) -> Result<Sender<Command>, TransportError> {
        self.sender(format!("command/{role}"), Queue::Every)
    }

    /// Participant: the way to receive its commands.
    pub fn command_receiver(&self, role: &str) -> Result<Receiver<Command>, TransportError> {
        self.receiver(format!("command/{role}"), Queue::Every)
    }

    /// Participant: the way to send its replies.
    pub fn reply_sender(&self, role: &str) -> Result<Sender<Reply>, TransportError> {
        self.sender(format!("reply/{role}"), Queue::Every)
    }

    /// Coordinator: the way to receive a participant's replies.
    pub fn reply_receiver(&self, role: &str) -> Result<Receiver<Reply>, TransportError> {
        self.receiver(format!("reply/{role}"), Queue::Every)
    }

    /// Participant: the way to say how far it is.
    pub fn progress_sender(&self, role: &str) -> Result<Sender<ProgressReport>, TransportError> {
        self.sender(format!("progress/{role}"), Queue::Newest)
    }

    /// Coordinator: the way to learn how far a participant is.
    pub fn progress_receiver(
        &self,
        role: &str,
    ) -> Result<Receiver<ProgressReport>, TransportError> {
        self.receiver(format!("progress/{role}"), Queue::Newest)
    }

    /// A writer of a field's topic with room for samples of `values` doubles. A larger sample moves the field to a
    /// new segment, twice as large or more.
    pub fn field_writer(
        &self,
        service: &str,
        values: usize,
        subscribers: usize,
    ) -> Result<FieldWriter, TransportError> {
        let room = values.max(LEAST_ROOM);
        self.field_writer_with(service, (room, growing_slots(room)), subscribers)
    }

    /// A writer of a field whose samples all have `values` doubles: it reserves fewer slots.
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
            // A topic has one writer.
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

    /// A reader of a field's topic, which has nothing to read yet.
    pub fn field_reader(&self, service: &str) -> Result<FieldReader, TransportError> {
        let mut readers = lock(&self.readers);
        let is_free =
            |port: &&Arc<ReaderPort>| port.name == service && Arc::strong_count(port) == 1;
        if let Some(port) = readers.iter().find(is_free) {
            let reader = FieldReader { port: Arc::clone(port) };
            // Samples of an earlier run that nobody has taken.
            while reader.receive()?.is_some() {}
            return Ok(reader);
        }
        let topic = self.topic::<f64, FieldHeader>(service, Queue::Every)?;
        let subscriber = topic.subscriber_builder().create().map_err(|e| open_error(service, e))?;
        let port = Arc::new(ReaderPort { subscriber, _topic: topic, name: service.to_owned() });
        readers.push(Arc::clone(&port));
        Ok(FieldReader { port })
    }

    /// Closes the ports of fields that nobody has. A writer counts its readers: the ports of an
    /// earlier run are closed before the next one's are waited for.
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
            // A heart may be a process of its own.
            .max_nodes(2 * MAX_MEMBERS + 1)
            .event_id_max_value(BEATS * MAX_MEMBERS)
            .disable_deadline()
            .disable_notifier_created_event()
            .disable_notifier_dropped_event()
            .disable_notifier_dead_event()
            .open_or_create()
            .map_err(|e| open_error(name, e))
    }

    /// The doorbell of this process.
    pub fn doorbell(&self, name: &str) -> Result<Doorbell, TransportError> {
        let name = format!("bell/{name}");
        let bell = self.bell(&name)?;
        let listener = bell.listener_builder().create().map_err(|e| open_error(&name, e))?;
        Ok(Doorbell { listener, _bell: bell, name })
    }

    /// The means to ring another process's doorbell.
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
    // A run's folder is removed as a whole (`run_dir`), so nobody has to look for dead nodes.
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

/// Polls, yielding the processor in between, until `ready` or the deadline.
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

/// Sends messages: a fixed header and bytes. One sender and one receiver a topic.
#[derive(Debug)]
pub struct Sender<H: Header> {
    publisher: Publisher<Ipc, [u8], Wire<H>>,
    topic: TopicFactory<Ipc, [u8], Wire<H>>,
    name: String,
    /// A message has been delivered.
    connected: Cell<bool>,
}

impl<H: Header> Sender<H> {
    /// The receiver has joined.
    #[must_use]
    pub fn is_heard(&self) -> bool {
        self.topic.dynamic_config().number_of_subscribers() > 0
    }

    /// Sends one message; it has reached the receiver's queue when this returns. The first one is
    /// sent again while the receiver is counted but cannot be delivered to yet.
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

    /// Sends a header without bytes; whether there is a receiver that it reached.
    pub fn offer(&self, header: &H) -> Result<bool, TransportError> {
        Ok(self.try_send(header, &[])? > 0)
    }

    /// Connects to the receiver if there is one, and sends; the number of receivers reached.
    fn try_send(&self, header: &H, body: &[u8]) -> Result<usize, TransportError> {
        let mut sample = self
            .publisher
            .loan_slice_uninit(body.len())
            .map_err(|e| exchange_error(&self.name, e))?;
        *sample.user_header_mut() = Wire(*header);
        sample.write_from_slice(body).send().map_err(|e| exchange_error(&self.name, e))
    }
}

/// Receives messages in the order they were sent.
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
    /// The fixed header.
    #[must_use]
    pub fn header(&self) -> &H {
        &self.0.user_header().0
    }

    /// The bytes behind it.
    #[must_use]
    pub fn body(&self) -> &[u8] {
        self.0.payload()
    }
}

impl<H: Header> Receiver<H> {
    /// The sender has joined.
    #[must_use]
    pub fn is_served(&self) -> bool {
        self.topic.dynamic_config().number_of_publishers() > 0
    }

    /// The next message, if one has come.
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
    /// Values of a sample in its first segment, and slots there.
    room: usize,
    slots: usize,
}

/// Publishes one field.
#[derive(Debug)]
pub struct FieldWriter {
    port: Arc<WriterPort>,
    subscribers: usize,
}

/// A place in shared memory to write a field's values into.
#[derive(Debug)]
pub struct FieldLoan(SampleMut<Ipc, [f64], Wire<FieldHeader>>);

impl FieldLoan {
    /// The values; they hold old data until written.
    #[must_use]
    pub fn values(&mut self) -> &mut [f64] {
        self.0.payload_mut()
    }
}

impl FieldWriter {
    /// Waits until all that have to receive the field are there.
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

    /// A place for `values` doubles.
    pub fn loan(&self, values: usize) -> Result<FieldLoan, TransportError> {
        let sample = self
            .port
            .publisher
            .loan_slice_uninit(values)
            .map_err(|e| exchange_error(&self.port.name, e))?;
        // SAFETY: the segment is mapped memory that the kernel zeroed and only doubles were
        // written to; every bit pattern is a valid f64.
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
    /// The label.
    #[must_use]
    pub fn header(&self) -> &FieldHeader {
        &self.0.user_header().0
    }

    /// The values, component-major.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        self.0.payload()
    }
}

impl FieldReader {
    /// Connects to the writer as it is now: what it sends from here on is received even if it has
    /// left by then. [`FieldReader::receive`] does so too.
    pub fn connect(&self) -> Result<(), TransportError> {
        self.port.subscriber.update_connections().map_err(|e| exchange_error(&self.port.name, e))
    }

    /// The next sample, if one has come.
    pub fn receive(&self) -> Result<Option<FieldSample>, TransportError> {
        let sample =
            self.port.subscriber.receive().map_err(|e| exchange_error(&self.port.name, e))?;
        Ok(sample.map(FieldSample))
    }
}

/// Where a process sleeps until something comes for it.
#[derive(Debug)]
pub struct Doorbell {
    listener: Listener<Ipc>,
    _bell: EventFactory<Ipc>,
    name: String,
}

impl Doorbell {
    /// Longest sleep before `poll` is asked again whatever rings.
    pub const NAP: Duration = Duration::from_millis(20);

    /// Polls until `poll` gives a value or an error; asks it at least every [`Doorbell::NAP`].
    /// `beat` receives the index of every participant whose heart has beaten meanwhile, and what
    /// the heartbeat said. The deadline is the poller's business.
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
                // A signal that the process handles ends the nap; the poller knows what it means.
                Ok(_) | Err(ListenerWaitError::InterruptSignal) => {}
                Err(error) => return Err(E::from(exchange_error(&self.name, error))),
            }
        }
    }
}

/// What a heartbeat says of its participant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beat {
    /// It is working on a command.
    Busy,
    /// It waits for a command, and has sent every reply that it owed.
    Idle {
        /// Sequence number of the last command it has dealt with, modulo [`ANSWERS`].
        answered: u64,
    },
}

impl Beat {
    /// Idle after the command with this number.
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
    /// A message has been sent.
    pub fn ring(&self) -> Result<(), TransportError> {
        self.notify(MESSAGE)
    }

    /// The heart of participant `index` has beaten.
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

    /// The next run has the ports of the one before, and nothing of what was sent in it.
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

    /// A much smaller field does not hold the memory of a larger one, nor has a larger one too little.
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

    /// Every doubling from any room costs one slot, and as many are left as there were.
    #[test]
    fn every_doubling_has_a_spare_slot() {
        for room in [LEAST_ROOM, 5000, 1 << 20, (1 << 31) - 1, 1 << 31] {
            let doublings = (0..64).find(|n| (room as u64) << n >= MOST_VALUES).unwrap_or(0);
            assert!(growing_slots(room) >= FIELD_SLOTS as usize + doublings, "{room}");
            assert!(growing_slots(room) <= FIELD_SLOTS as usize + 23, "{room}");
        }
    }

    /// An exhausted memory is not blamed on a receiver.
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
