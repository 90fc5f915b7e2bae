//! Link to the other end: one TCP connection that carries messages of any length in order, and
//! signs of life between their pieces.
//!
//! Data is sent in records. A record is a piece of a message, the last piece, or a sign of life.
//!
//! Three threads serve a link. The owner sends and takes messages, a reader reads records from the
//! network, and a monitor sends signs of life and declares a silent link lost.

use crate::frame::{Frame, Malformed};
use crate::record::{Kind, NoRecord, PIECE, RECORD, Records, Sealed, seal};
use contract::message::ProgressReport;
use contract::text::one_line;
use snow::StatelessTransportState;
use std::io::{self, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval between signs of life.
const INTERVAL: Duration = Duration::from_millis(100);
/// Time to read messages that arrived before the connection was closed.
const LAST_WORDS: Duration = Duration::from_millis(300);
/// Number of records sealed before they are written together.
const BATCH: usize = 4;
/// Number of messages waiting to be taken, above which the reader pauses.
const WAITING: usize = 64;
/// Maximum length of a message before the grids are known [byte].
pub(crate) const SHORT: usize = 256 << 20;

/// Reason why a link has ended.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Fault {
    #[error("{0}")]
    Lost(String),
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Receiver of the heartbeat and the progress of the remote participant.
pub(crate) trait LivenessSink: Send {
    /// Called for a heartbeat.
    fn beat(&mut self);
    /// Called for a progress report.
    fn progress(&mut self, report: ProgressReport);
}

/// State shared by the threads of a link.
struct Shared {
    noise: StatelessTransportState,
    stream: TcpStream,
    /// Held from the first to the last piece of a message.
    turn: Mutex<()>,
    /// Number of the next record to send.
    next: Mutex<u64>,
    sent: Mutex<Instant>,
    heard: Mutex<Instant>,
    /// Maximum length of a message [byte].
    most: AtomicUsize,
    sink: Mutex<Option<Box<dyn LivenessSink>>>,
    bell: Mutex<Option<Box<dyn Fn() + Send>>>,
    /// Exit code and reason, sent by the other end before it ended.
    told: Mutex<Option<(u8, String)>>,
    /// Reason why the reader has ended.
    ended: Mutex<Option<String>>,
    lost: Mutex<Option<String>>,
    closes: AtomicBool,
}

impl Shared {
    /// Sends a message in pieces; the last one is marked.
    fn send_message(&self, head: &[u8], rest: &[u8]) -> Result<(), Fault> {
        // Only the first piece is copied, to prepend the head. Other pieces are sealed directly
        // from `rest`.
        let (with_head, mut rest) = rest.split_at(rest.len().min(PIECE - head.len().min(PIECE)));
        let first = [head, with_head].concat();
        let mut first = first.as_slice();
        let mut records = Vec::with_capacity(BATCH * RECORD);
        loop {
            let mut next = lock(&self.next);
            records.clear();
            let is_last = loop {
                let from = if first.is_empty() { &mut rest } else { &mut first };
                let (piece, left) = from.split_at(from.len().min(PIECE));
                *from = left;
                let is_last = first.is_empty() && rest.is_empty();
                let kind = if is_last { Kind::Last } else { Kind::More };
                seal(&self.noise, *next, kind, piece, &mut records);
                *next += 1;
                if is_last || records.len() + RECORD > BATCH * RECORD {
                    break is_last;
                }
            };
            self.write(&records)?;
            drop(next);
            if is_last {
                return Ok(());
            }
        }
    }

    /// Sends a sign of life, which overtakes pieces of messages.
    fn send_sign(&self, frame: &Frame<'_>, next: &mut u64) -> Result<(), Fault> {
        let (head, rest) = frame.write();
        let (sign, mut records) = ([&head, rest].concat(), Vec::new());
        seal(&self.noise, *next, Kind::Sign, &sign[..sign.len().min(PIECE)], &mut records);
        *next += 1;
        self.write(&records)
    }

    /// Writes records. After a failure the number of bytes sent is unknown, so that the link ends.
    fn write(&self, records: &[u8]) -> Result<(), Fault> {
        let written = (&self.stream).write_all(records);
        *lock(&self.sent) = Instant::now();
        written.map_err(|error| {
            let why = match error.kind() {
                io::ErrorKind::WouldBlock => "the other end does not read its data".to_owned(),
                _ => error.to_string(),
            };
            let why = lock(&self.ended).get_or_insert(why).clone();
            self.shut();
            self.fault(&why)
        })
    }

    fn ring(&self) {
        if let Some(ring) = &*lock(&self.bell) {
            ring();
        }
    }

    /// Closes both directions of the connection.
    fn shut(&self) {
        let _ = self.stream.shutdown(Shutdown::Both);
    }

    fn fault(&self, why: &str) -> Fault {
        Fault::Lost(lock(&self.lost).as_deref().unwrap_or(why).to_owned())
    }
}

/// Sender of a link, usable by any thread.
#[derive(Clone)]
pub(crate) struct Sending(Arc<Shared>);

impl Sending {
    /// Sends a message.
    pub(crate) fn send(&self, frame: &Frame<'_>) -> Result<(), Fault> {
        let (head, rest) = frame.write();
        let _turn = lock(&self.0.turn);
        self.0.send_message(&head, rest)
    }

    /// Sends a sign of life, or another message that must not wait for a long one.
    pub(crate) fn sign(&self, frame: &Frame<'_>) -> Result<(), Fault> {
        let mut next = lock(&self.0.next);
        self.0.send_sign(frame, &mut next)
    }
}

/// Way in which a link ended.
pub(crate) enum End {
    /// The link is lost.
    Lost(String),
    /// The other end sent an exit code and a reason.
    Told(u8, String),
}

/// One end of a link.
pub(crate) struct Link {
    pub(crate) sending: Sending,
    messages: Receiver<Vec<u8>>,
    shared: Arc<Shared>,
    reader: Option<JoinHandle<()>>,
    monitor: Option<JoinHandle<()>>,
}

impl Link {
    /// Starts reader and monitor. The link is lost after `silence` without a sign of life from the
    /// other end. `at_end` is called at most once, on the monitor's thread; it is not called if the
    /// link is closed before.
    pub(crate) fn open(
        sealed: Sealed,
        silence: Duration,
        at_end: impl FnOnce(End) + Send + 'static,
    ) -> io::Result<Self> {
        let Sealed { stream, noise } = sealed;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(None)?;
        // An end that stops reading counts as lost, like a silent one.
        stream.set_write_timeout(Some(silence))?;
        let reading = stream.try_clone()?;
        let now = Instant::now();
        let is_client = noise.is_initiator();
        let shared = Arc::new(Shared {
            noise,
            stream,
            turn: Mutex::new(()),
            // The client has used record 0 for its proof.
            next: Mutex::new(u64::from(is_client)),
            sent: Mutex::new(now),
            heard: Mutex::new(now),
            most: AtomicUsize::new(SHORT),
            sink: Mutex::default(),
            bell: Mutex::default(),
            told: Mutex::default(),
            ended: Mutex::default(),
            lost: Mutex::default(),
            closes: AtomicBool::new(false),
        });
        let (sender, messages) = sync_channel(WAITING);
        let for_reader = Arc::clone(&shared);
        let reader = std::thread::Builder::new().name("link".to_owned()).spawn(move || {
            let why = read(&for_reader, reading, &sender, u64::from(!is_client));
            lock(&for_reader.ended).get_or_insert(why);
            drop(sender);
            for_reader.ring();
        })?;
        let for_monitor = Arc::clone(&shared);
        let monitor = std::thread::Builder::new().name("monitor".to_owned()).spawn(move || {
            if let Some(end) = watch(&for_monitor, silence) {
                if let End::Lost(why) = &end {
                    *lock(&for_monitor.lost) = Some(why.clone());
                }
                for_monitor.shut();
                for_monitor.ring();
                at_end(end);
            }
        })?;
        let (reader, monitor) = (Some(reader), Some(monitor));
        Ok(Self { sending: Sending(Arc::clone(&shared)), messages, shared, reader, monitor })
    }

    /// Returns the next message if one has arrived.
    pub(crate) fn poll(&self) -> Result<Option<Vec<u8>>, Fault> {
        match self.messages.try_recv() {
            Ok(message) => Ok(Some(message)),
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) => Err(self.end()),
        }
    }

    /// Waits at most `patience` for the next message.
    pub(crate) fn within(&self, patience: Duration) -> Result<Option<Vec<u8>>, Fault> {
        match self.messages.recv_timeout(patience) {
            Ok(message) => Ok(Some(message)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(self.end()),
        }
    }

    fn end(&self) -> Fault {
        let ended = lock(&self.shared.ended).clone();
        self.shared.fault(ended.as_deref().unwrap_or("it is closed"))
    }

    /// Sets the maximum length of a message; a longer one ends the link.
    pub(crate) fn allow(&self, most: usize) {
        self.shared.most.store(most, Ordering::Relaxed);
    }

    /// Sets the receiver of the remote participant's heartbeat and progress.
    pub(crate) fn listen(&self, sink: Option<Box<dyn LivenessSink>>) {
        *lock(&self.shared.sink) = sink;
    }

    /// Sets a function to call when a message arrives or the link ends.
    pub(crate) fn ring(&self, bell: Option<Box<dyn Fn() + Send>>) {
        *lock(&self.shared.bell) = bell;
    }

    /// Returns the reason if the link is lost.
    pub(crate) fn lost(&self) -> Option<String> {
        lock(&self.shared.lost).clone()
    }

    /// True if the other end has left or the link is lost.
    pub(crate) fn is_over(&self) -> bool {
        self.lost().is_some() || lock(&self.shared.ended).is_some()
    }

    /// Closes the link in order: waits at most `patience` for the other end to close the
    /// connection.
    pub(crate) fn close(mut self, patience: Duration) {
        self.stop_monitor();
        let _ = self.sending.send(&Frame::Bye);
        let _ = self.shared.stream.shutdown(Shutdown::Write);
        let until = Instant::now() + patience;
        while lock(&self.shared.ended).is_none() && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn stop_monitor(&mut self) {
        self.shared.closes.store(true, Ordering::SeqCst);
        if let Some(monitor) = self.monitor.take() {
            monitor.thread().unpark();
            let _ = monitor.join();
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.stop_monitor();
        self.shared.shut();
        // Empties the queue, because a full one would block the reader.
        while self.messages.recv_timeout(INTERVAL) != Err(RecvTimeoutError::Disconnected) {}
        if let Some(reader) = self.reader.take() {
            let _ = reader.join();
        }
    }
}

/// Reads records until the link ends; returns the reason.
fn read(shared: &Shared, stream: TcpStream, messages: &SyncSender<Vec<u8>>, number: u64) -> String {
    let mut records = Records::new(stream, number);
    let (mut message, mut sign, mut longest) = (Vec::new(), Vec::new(), 0);
    loop {
        // A sign of life may arrive between pieces of a message; its content is removed from the
        // message.
        let before = message.len();
        let kind = match records.open(&shared.noise, &mut message) {
            Ok(kind) => kind,
            Err(NoRecord::Network(error)) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return "the other end is gone, or its connection was closed".to_owned();
            }
            Err(NoRecord::Network(error)) => return error.to_string(),
            Err(NoRecord::Wrong) => return "a record was not sealed by the other end".to_owned(),
        };
        *lock(&shared.heard) = Instant::now();
        let most = shared.most.load(Ordering::Relaxed);
        match kind {
            Kind::Sign => {
                sign.clear();
                sign.extend(message.drain(before..));
                if let Err(error) = hear(shared, &sign) {
                    return error.to_string();
                }
            }
            _ if message.len() > most => {
                return format!("the other end sends more than {most} bytes at once");
            }
            Kind::Last => {
                // The next message may be as long. Untouched capacity takes no physical memory.
                longest = message.len().max(longest);
                let next = Vec::with_capacity(longest);
                if messages.send(std::mem::replace(&mut message, next)).is_err() {
                    return "it is closed".to_owned();
                }
            }
            Kind::More => continue,
        }
        shared.ring();
    }
}

fn hear(shared: &Shared, sign: &[u8]) -> Result<(), Malformed> {
    if sign.is_empty() {
        return Ok(());
    }
    match Frame::read(sign)? {
        Frame::Beat => {
            if let Some(sink) = &mut *lock(&shared.sink) {
                sink.beat();
            }
        }
        Frame::Progress(report) => {
            if let Some(sink) = &mut *lock(&shared.sink) {
                sink.progress(report);
            }
        }
        Frame::Ended { code, words } => {
            *lock(&shared.told) = Some((code.max(1), one_line(words).into_owned()));
        }
        _ => {}
    }
    Ok(())
}

/// Sends signs of life until the link is closed. Returns the reason if the link ends before.
fn watch(shared: &Shared, silence: Duration) -> Option<End> {
    let mut gone = None::<Instant>;
    while !shared.closes.load(Ordering::SeqCst) {
        let quiet = lock(&shared.sent).elapsed() >= INTERVAL;
        // A held lock means that a record is being sent, which is a sign of life too.
        if quiet && let Ok(mut next) = shared.next.try_lock() {
            // A failure ends the reader, which reports it.
            let _ = shared.send_sign(&Frame::Alive, &mut next);
        }
        std::thread::park_timeout(INTERVAL / 2);
        if let Some((code, words)) = lock(&shared.told).take() {
            // Leaves time for the owner to take the messages that arrived before.
            std::thread::sleep(LAST_WORDS);
            return Some(End::Told(code, words));
        }
        if let Some(why) = &*lock(&shared.ended)
            && gone.get_or_insert_with(Instant::now).elapsed() > LAST_WORDS
        {
            return Some(End::Lost(why.clone()));
        }
        if lock(&shared.heard).elapsed() > silence {
            let seconds = silence.as_secs_f64();
            return Some(End::Lost(format!("nothing was received for {seconds:.1} s")));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handshake::{accept, connect};
    use crate::key::Key;
    use proptest::prelude::*;
    use std::net::TcpListener;
    use std::sync::mpsc::channel;

    const SOON: Duration = Duration::from_secs(20);

    /// Connects two ends; returns client and server.
    fn met() -> (Sealed, Sealed) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let server = std::thread::spawn(move || {
            let stream = listener.accept().unwrap().0;
            accept(stream, &Key::of(&[7; 32]), Instant::now() + SOON).ok().unwrap()
        });
        let client = connect(&address, &Key::of(&[7; 32]), SOON).ok().unwrap();
        (client, server.join().unwrap())
    }

    fn open(sealed: Sealed, silence: Duration) -> (Link, Receiver<String>) {
        let (sender, ends) = channel();
        let link = Link::open(sealed, silence, move |end| {
            let words = match end {
                End::Lost(why) => why,
                End::Told(code, words) => format!("{code}: {words}"),
            };
            let _ = sender.send(words);
        });
        (link.unwrap(), ends)
    }

    fn linked() -> (Link, Link) {
        let (client, server) = met();
        (open(client, SOON).0, open(server, SOON).0)
    }

    /// A state, for example, has arbitrary length.
    #[test]
    fn messages_of_any_length_come_in_order_both_ways() {
        let (client, server) = linked();
        for length in [0, 1, PIECE - 4, PIECE - 3, PIECE, 3 * PIECE, 5 * PIECE + 17, 3 << 20] {
            let bytes: Vec<u8> = (0..length).map(|at| at as u8).collect();
            for (from, to) in [(&client, &server), (&server, &client)] {
                let sent = Frame::State { part: 3, last: true, bytes: &bytes };
                let (sending, sent) = (from.sending.clone(), &sent);
                std::thread::scope(|scope| {
                    scope.spawn(move || sending.send(sent).unwrap());
                    let message = to.within(SOON).unwrap().unwrap();
                    assert!(Frame::read(&message).unwrap() == *sent, "{length}");
                });
            }
        }
        assert_eq!(client.poll(), Ok(None));
        client.close(SOON);
        assert_eq!(Frame::read(&server.within(SOON).unwrap().unwrap()), Ok(Frame::Bye));
        assert!(server.within(SOON).unwrap_err().to_string().contains("the other end is gone"));
    }

    struct Count(std::sync::mpsc::Sender<u64>);

    impl LivenessSink for Count {
        fn beat(&mut self) {
            let _ = self.0.send(0);
        }
        fn progress(&mut self, report: ProgressReport) {
            let _ = self.0.send(report.done);
        }
    }

    #[test]
    fn signs_arrive_beside_messages_that_nobody_takes() {
        let (client, server) = linked();
        let (sender, heard) = channel();
        client.listen(Some(Box::new(Count(sender))));
        server.sending.send(&Frame::State { part: 0, last: true, bytes: &[1; 1 << 20] }).unwrap();
        server.sending.sign(&Frame::Beat).unwrap();
        let report = ProgressReport { done: 3, ..ProgressReport::default() };
        server.sending.sign(&Frame::Progress(report)).unwrap();
        assert_eq!([heard.recv_timeout(SOON), heard.recv_timeout(SOON)], [Ok(0), Ok(3)]);
    }

    #[test]
    fn an_end_that_is_silent_is_lost_and_one_with_last_words_is_quoted() {
        let (client, server) = met();
        let (client, ends) = open(client, Duration::from_millis(300));
        assert_eq!(ends.recv_timeout(SOON).unwrap(), "nothing was received for 0.3 s");
        assert_eq!(client.lost().as_deref(), Some("nothing was received for 0.3 s"));
        assert!(client.is_over() && client.sending.send(&Frame::Bye).is_err());
        drop(server);
        let (client, server) = met();
        let ((_client, ends), (server, _)) = (open(client, SOON), open(server, SOON));
        server.sending.sign(&Frame::Ended { code: 9, words: "no \u{1b}licence" }).unwrap();
        assert_eq!(ends.recv_timeout(SOON).unwrap(), "9: no \\u{1b}licence");
    }

    #[test]
    fn a_message_without_end_and_a_changed_record_end_the_link() {
        let (client, server) = linked();
        server.allow(1000);
        client.sending.send(&Frame::State { part: 0, last: true, bytes: &[0; 2000] }).unwrap();
        let fault = server.within(SOON).unwrap_err().to_string();
        assert_eq!(fault, "the other end sends more than 1000 bytes at once");
        let (client, server) = met();
        let (server, _) = open(server, SOON);
        let mut records = Vec::new();
        seal(&client.noise, 1, Kind::Last, &[0], &mut records);
        *records.last_mut().unwrap() ^= 1;
        (&client.stream).write_all(&records).unwrap();
        let fault = server.within(SOON).unwrap_err().to_string();
        assert_eq!(fault, "a record was not sealed by the other end");
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 20, ..crate::fuzz_config() })]

        #[test]
        fn no_bytes_pass_without_the_key(bytes in proptest::collection::vec(any::<u8>(), 3..200)) {
            let (client, server) = met();
            let (server, _) = open(server, SOON);
            (&client.stream).write_all(&bytes).unwrap();
            client.stream.shutdown(Shutdown::Write).unwrap();
            prop_assert!(server.within(SOON).is_err());
        }
    }
}
