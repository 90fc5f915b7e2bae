//! A link to the other end: one TCP connection, over which messages of any length go in order, and signs
//! of life between their pieces.
//!
//! Bytes go in records, each a piece of a message, its last one, or a sign of life.
//!
//! Three threads work on a link: the one that owns it sends and takes messages, a reader takes records
//! from the network, and a monitor sends signs of life and declares the link lost when none has come.

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

/// From one sign of life to the next.
const INTERVAL: Duration = Duration::from_millis(100);
/// Messages that came before the connection was closed are still read for so long.
const LAST_WORDS: Duration = Duration::from_millis(300);
/// Records that are sealed before they are written.
const BATCH: usize = 4;
/// Messages that have come and are not taken yet, before the other end is held back.
const WAITING: usize = 64;
/// The longest message before there are fields [byte].
pub(crate) const SHORT: usize = 256 << 20;

/// Reason why nothing more goes over a link.
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

/// Hears what the other end says of the participant there.
pub(crate) trait LivenessSink: Send {
    /// Its heart has beaten.
    fn beat(&mut self);
    /// It has said how far it is.
    fn progress(&mut self, report: ProgressReport);
}

/// State that the threads of a link share.
struct Shared {
    noise: StatelessTransportState,
    stream: TcpStream,
    /// Held from the first to the last piece of a message.
    turn: Mutex<()>,
    /// The number of the next record to send.
    next: Mutex<u64>,
    sent: Mutex<Instant>,
    heard: Mutex<Instant>,
    /// The longest message that is put together [byte].
    most: AtomicUsize,
    sink: Mutex<Option<Box<dyn LivenessSink>>>,
    bell: Mutex<Option<Box<dyn Fn() + Send>>>,
    /// Exit code and words of an end that has told its end.
    told: Mutex<Option<(u8, String)>>,
    /// Why the reader has ended.
    ended: Mutex<Option<String>>,
    lost: Mutex<Option<String>>,
    closes: AtomicBool,
}

impl Shared {
    /// Sends the pieces of a message, the last one marked.
    fn send_message(&self, head: &[u8], rest: &[u8]) -> Result<(), Fault> {
        // The first piece has the head, which is short; others are sealed from where they lie.
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

    /// Sends a sign, which overtakes the pieces of messages.
    fn send_sign(&self, frame: &Frame<'_>, next: &mut u64) -> Result<(), Fault> {
        let (head, rest) = frame.write();
        let (sign, mut records) = ([&head, rest].concat(), Vec::new());
        seal(&self.noise, *next, Kind::Sign, &sign[..sign.len().min(PIECE)], &mut records);
        *next += 1;
        self.write(&records)
    }

    /// Writes records. After a failure nobody knows how much of them has gone: the link is over.
    fn write(&self, records: &[u8]) -> Result<(), Fault> {
        let written = (&self.stream).write_all(records);
        *lock(&self.sent) = Instant::now();
        written.map_err(|error| {
            let why = match error.kind() {
                io::ErrorKind::WouldBlock => "the other end does not take what is sent".to_owned(),
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

    /// Nothing more is sent or received.
    fn shut(&self) {
        let _ = self.stream.shutdown(Shutdown::Both);
    }

    fn fault(&self, why: &str) -> Fault {
        Fault::Lost(lock(&self.lost).as_deref().unwrap_or(why).to_owned())
    }
}

/// Sends; any thread may.
#[derive(Clone)]
pub(crate) struct Sending(Arc<Shared>);

impl Sending {
    /// Sends a message.
    pub(crate) fn send(&self, frame: &Frame<'_>) -> Result<(), Fault> {
        let (head, rest) = frame.write();
        let _turn = lock(&self.0.turn);
        self.0.send_message(&head, rest)
    }

    /// Sends a sign of life, or whatever must not wait for a long message.
    pub(crate) fn sign(&self, frame: &Frame<'_>) -> Result<(), Fault> {
        let mut next = lock(&self.0.next);
        self.0.send_sign(frame, &mut next)
    }
}

/// End of the other end, or of the link to it.
pub(crate) enum End {
    /// The link is lost.
    Lost(String),
    /// The other end has said why, with an exit code.
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
    /// Begins to listen and to give signs of life. Without any of the other end for `silence` the link
    /// is lost; `at_end` is called once, on a thread of its own, unless the link is closed before.
    pub(crate) fn open(
        sealed: Sealed,
        silence: Duration,
        at_end: impl FnOnce(End) + Send + 'static,
    ) -> io::Result<Self> {
        let Sealed { stream, noise } = sealed;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(None)?;
        // Who stops reading is lost like one who is silent.
        stream.set_write_timeout(Some(silence))?;
        let reading = stream.try_clone()?;
        let now = Instant::now();
        let is_client = noise.is_initiator();
        let shared = Arc::new(Shared {
            noise,
            stream,
            turn: Mutex::new(()),
            // The client's first record was its proof.
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

    /// The next message, if it is there.
    pub(crate) fn poll(&self) -> Result<Option<Vec<u8>>, Fault> {
        match self.messages.try_recv() {
            Ok(message) => Ok(Some(message)),
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) => Err(self.end()),
        }
    }

    /// The next message, if it is there before so much time has passed.
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

    /// Longer messages than these bytes end the link.
    pub(crate) fn allow(&self, most: usize) {
        self.shared.most.store(most, Ordering::Relaxed);
    }

    /// Who hears of the participant at the other end from now on.
    pub(crate) fn listen(&self, sink: Option<Box<dyn LivenessSink>>) {
        *lock(&self.shared.sink) = sink;
    }

    /// Rings when something arrives.
    pub(crate) fn ring(&self, bell: Option<Box<dyn Fn() + Send>>) {
        *lock(&self.shared.bell) = bell;
    }

    /// Why the link is lost, if it is.
    pub(crate) fn lost(&self) -> Option<String> {
        lock(&self.shared.lost).clone()
    }

    /// The other end has left, or the link is lost.
    pub(crate) fn is_over(&self) -> bool {
        self.lost().is_some() || lock(&self.shared.ended).is_some()
    }

    /// Leaves, as was to be expected; the other end closes the connection when it has read so.
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
        // A full queue would hold the reader.
        while self.messages.recv_timeout(INTERVAL) != Err(RecvTimeoutError::Disconnected) {}
        if let Some(reader) = self.reader.take() {
            let _ = reader.join();
        }
    }
}

/// Takes records until there are no more; why.
fn read(shared: &Shared, stream: TcpStream, messages: &SyncSender<Vec<u8>>, number: u64) -> String {
    let mut records = Records::new(stream, number);
    let (mut message, mut sign, mut longest) = (Vec::new(), Vec::new(), 0);
    loop {
        // A sign comes between the pieces of a message: what came of it goes there.
        let before = message.len();
        let kind = match records.open(&shared.noise, &mut message) {
            Ok(kind) => kind,
            Err(NoRecord::Network(error)) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return "the other end is gone, or its connection was closed".to_owned();
            }
            Err(NoRecord::Network(error)) => return error.to_string(),
            Err(NoRecord::Wrong) => return "what came was not sealed by the other end".to_owned(),
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
                // Another one may be as long; memory that is not written to is not taken.
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

/// Gives signs of life until the link is closed, or ends.
fn watch(shared: &Shared, silence: Duration) -> Option<End> {
    let mut gone = None::<Instant>;
    while !shared.closes.load(Ordering::SeqCst) {
        let quiet = lock(&shared.sent).elapsed() >= INTERVAL;
        // Whoever holds it is sending, which is a sign too.
        if quiet && let Ok(mut next) = shared.next.try_lock() {
            // A failure ends the reader.
            let _ = shared.send_sign(&Frame::Alive, &mut next);
        }
        std::thread::park_timeout(INTERVAL / 2);
        if let Some((code, words)) = lock(&shared.told).take() {
            // Who waits for a message has these words too, and what came before them.
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

    /// Both ends of a connection: the client's first.
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

    /// The state of a participant is as long as it likes.
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
        assert_eq!(fault, "what came was not sealed by the other end");
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
