//! The way between two machines: the only module that knows zenoh.
//!
//! The far end listens, the home end connects, and neither looks for anybody: no multicast, no gossip. A
//! conversation has a name that its caller has drawn, and two lanes in each direction: one for what is said in
//! turn, and one for signs of life, which overtake it piece by piece.

use crate::hail::End;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use zenoh::bytes::ZBytes;
use zenoh::config::Config;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::SampleKind;
use zenoh::{Session, Wait};

/// Lanes of a direction: what is said in turn, and signs of life.
pub(crate) const LANES: usize = 2;
/// Pieces that have arrived on a lane and are not read yet, before the sender is held back.
const WAITING: usize = 64;
/// Calls that are not answered yet.
const CALLS: usize = 64;
/// The longest piece that is taken from the network [byte].
pub(crate) const LONGEST_PIECE: usize = 512 << 10;
/// Machines that are connected at the same time.
const CONNECTIONS: usize = 64;

/// Certificates for `tls/...` endpoints, each the path of a PEM file.
#[derive(Clone, Debug, Default)]
pub struct Certificates {
    /// Authorities that the other end's certificate is checked against.
    pub authority: Option<PathBuf>,
    /// The certificate of this end.
    pub certificate: Option<PathBuf>,
    /// Its private key.
    pub private_key: Option<PathBuf>,
}

/// The network cannot be used as asked.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct FabricError(String);

impl FabricError {
    fn of(what: impl fmt::Display) -> impl Fn(zenoh::Error) -> Self {
        move |error| Self(format!("{what}: {error}"))
    }
}

/// This end's part of the network.
pub(crate) struct Fabric(Session);

/// Names of conversations, with the first word of each.
pub(crate) struct Calls {
    pub(crate) arrived: Receiver<(String, Vec<u8>)>,
    _subscriber: Subscriber<()>,
}

impl Fabric {
    /// Listens on an endpoint.
    pub(crate) fn listen(endpoint: &str, tls: &Certificates) -> Result<Self, FabricError> {
        let mut config = quiet("peer")?;
        set(&mut config, "listen/endpoints", &serde_json::json!([endpoint]))?;
        let files = [
            ("listen_certificate", &tls.certificate),
            ("listen_private_key", &tls.private_key),
            ("root_ca_certificate", &tls.authority),
        ];
        certify(&mut config, &files, "enable_mtls", tls.authority.is_some())?;
        let failed = FabricError::of(format!("cannot listen on {endpoint}"));
        zenoh::open(config).wait().map(Self).map_err(failed)
    }

    /// Connects to the far end that listens on an endpoint.
    pub(crate) fn connect(
        endpoint: &str,
        tls: &Certificates,
        patience: Duration,
    ) -> Result<Self, FabricError> {
        let mut config = quiet("client")?;
        let milliseconds = u64::try_from(patience.as_millis()).unwrap_or(u64::MAX);
        set(&mut config, "connect/endpoints", &serde_json::json!([endpoint]))?;
        set(&mut config, "connect/timeout_ms", &milliseconds.into())?;
        set(&mut config, "connect/exit_on_failure", &true.into())?;
        let files = [
            ("root_ca_certificate", &tls.authority),
            ("connect_certificate", &tls.certificate),
            ("connect_private_key", &tls.private_key),
        ];
        certify(&mut config, &files, "enable_mtls", tls.certificate.is_some())?;
        zenoh::open(config).wait().map(Self).map_err(|error| {
            let seconds = patience.as_secs_f64();
            FabricError(format!(
                "no far end is reached at {endpoint} within {seconds:.0} s ({error}); start \
                 `coordinator relay --listen` there, and see that the port is open"
            ))
        })
    }

    /// Takes calls from now on.
    pub(crate) fn calls(&self) -> Result<Calls, FabricError> {
        let (sender, arrived) = sync_channel(CALLS);
        let taken = move |sample: zenoh::sample::Sample| {
            let name = sample.key_expr().as_str().rsplit('/').next().unwrap_or_default();
            if is_name(name) && sample.payload().len() <= LONGEST_PIECE {
                // More than there is room for are not answered, and end by their deadline.
                let _ =
                    sender.try_send((name.to_owned(), sample.payload().to_bytes().into_owned()));
            }
        };
        let subscriber = self.0.declare_subscriber("cosim/call/*").callback(taken).wait();
        let subscriber = subscriber.map_err(FabricError::of("cannot take calls"))?;
        Ok(Calls { arrived, _subscriber: subscriber })
    }

    /// Calls the far end under a name whose lanes are open.
    pub(crate) fn call(&self, name: &str, hello: Vec<u8>) -> Result<(), FabricError> {
        let put = self.0.put(format!("cosim/call/{name}"), hello);
        put.congestion_control(CongestionControl::Block)
            .express(true)
            .wait()
            .map_err(FabricError::of("cannot call the far end"))
    }

    /// Opens this end of a conversation.
    pub(crate) fn wire(&self, name: &str, end: End) -> Result<Wire, FabricError> {
        let failed = FabricError::of("cannot open a conversation");
        let (own, other) = match end {
            End::Home => ("home", "far"),
            End::Far => ("far", "home"),
        };
        let bell: Bell = Arc::new(Mutex::new(None));
        let gone = Arc::new(AtomicBool::new(false));
        let mut subscribers = Vec::new();
        let mut arrivals = Vec::new();
        for lane in 0..LANES {
            let (sender, arrived) = sync_channel(WAITING);
            let key = format!("cosim/wire/{name}/{other}/{lane}");
            let taken = take(sender, Arc::clone(&bell));
            let subscriber = self.0.declare_subscriber(key).callback(taken).wait();
            subscribers.push(subscriber.map_err(&failed)?);
            arrivals.push(arrived);
        }
        let left = Arc::clone(&gone);
        let ring = Arc::clone(&bell);
        let watch = self.0.liveliness().declare_subscriber(format!("cosim/wire/{name}/{other}"));
        let watch = watch.history(true).callback(move |sample| {
            if sample.kind() == SampleKind::Delete {
                left.store(true, Ordering::SeqCst);
                ring_bell(&ring);
            }
        });
        subscribers.push(watch.wait().map_err(&failed)?);
        let token = self.0.liveliness().declare_token(format!("cosim/wire/{name}/{own}")).wait();
        let mut publishers = Vec::new();
        for (lane, priority) in [Priority::Data, Priority::InteractiveHigh].into_iter().enumerate()
        {
            let publisher = self.0.declare_publisher(format!("cosim/wire/{name}/{own}/{lane}"));
            let publisher = publisher
                .congestion_control(CongestionControl::Block)
                .priority(priority)
                .express(true)
                .wait();
            publishers.push(publisher.map_err(&failed)?);
        }
        Ok(Wire {
            publishers,
            arrivals,
            gone,
            bell,
            _subscribers: subscribers,
            _token: token.map_err(&failed)?,
        })
    }
}

/// A conversation's name.
pub(crate) fn is_name(text: &str) -> bool {
    text.len() == 32 && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// Rung when something arrives.
type Bell = Arc<Mutex<Option<Box<dyn Fn() + Send>>>>;

fn ring_bell(bell: &Bell) {
    if let Some(ring) = &*bell.lock().unwrap_or_else(PoisonError::into_inner) {
        ring();
    }
}

fn take(sender: SyncSender<Vec<u8>>, bell: Bell) -> impl Fn(zenoh::sample::Sample) + Send + Sync {
    move |sample| {
        if sample.payload().len() > LONGEST_PIECE {
            return;
        }
        // A full lane holds the network back. A reader that is gone wants nothing.
        let _ = sender.send(sample.payload().to_bytes().into_owned());
        ring_bell(&bell);
    }
}

/// One end of a conversation.
pub(crate) struct Wire {
    publishers: Vec<Publisher<'static>>,
    arrivals: Vec<Receiver<Vec<u8>>>,
    gone: Arc<AtomicBool>,
    bell: Bell,
    _subscribers: Vec<Subscriber<()>>,
    _token: LivelinessToken,
}

/// Sends on one lane.
pub(crate) struct Lane(Publisher<'static>);

/// What keeps a conversation open, and knows whether the other end is still there.
pub(crate) struct Hold {
    gone: Arc<AtomicBool>,
    bell: Bell,
    _subscribers: Vec<Subscriber<()>>,
    _token: LivelinessToken,
}

impl Wire {
    /// Its parts: the lanes out, those in, and what holds it open.
    pub(crate) fn split(self) -> ([Lane; LANES], [Receiver<Vec<u8>>; LANES], Hold) {
        let Self { publishers, arrivals, gone, bell, _subscribers, _token } = self;
        let lanes: Vec<Lane> = publishers.into_iter().map(Lane).collect();
        let lanes = lanes.try_into().ok().expect("there is a publisher for each lane");
        let arrivals = arrivals.try_into().expect("there is a queue for each lane");
        (lanes, arrivals, Hold { gone, bell, _subscribers, _token })
    }
}

impl Lane {
    /// Sends a piece; it is on its way when this returns.
    pub(crate) fn send(&self, piece: Vec<u8>) -> Result<(), FabricError> {
        self.0.put(ZBytes::from(piece)).wait().map_err(FabricError::of("cannot send"))
    }
}

impl Hold {
    /// The other end has left, or its connection was closed.
    pub(crate) fn is_gone(&self) -> bool {
        self.gone.load(Ordering::SeqCst)
    }

    /// Whatever arrives from now on rings.
    pub(crate) fn ring(&self, bell: Option<Box<dyn Fn() + Send>>) {
        *self.bell.lock().unwrap_or_else(PoisonError::into_inner) = bell;
    }
}

/// Settings that both ends have: nothing is looked for, and nothing is sent that was not asked for.
fn quiet(mode: &str) -> Result<Config, FabricError> {
    let mut config = Config::default();
    let settings = [
        ("mode", serde_json::json!(mode)),
        ("scouting/multicast/enabled", false.into()),
        ("scouting/gossip/enabled", false.into()),
        ("adminspace/enabled", false.into()),
        ("transport/link/protocols", serde_json::json!(["tcp", "tls"])),
        ("transport/unicast/max_sessions", CONNECTIONS.into()),
        ("transport/link/rx/max_message_size", (2 * LONGEST_PIECE).into()),
    ];
    for (key, value) in settings {
        set(&mut config, key, &value)?;
    }
    Ok(config)
}

fn set(config: &mut Config, key: &str, value: &serde_json::Value) -> Result<(), FabricError> {
    let failed = FabricError::of(format!("{key} cannot be {value}"));
    config.insert_json5(key, &value.to_string()).map_err(failed)
}

fn certify(
    config: &mut Config,
    files: &[(&str, &Option<PathBuf>)],
    mutual: &str,
    is_mutual: bool,
) -> Result<(), FabricError> {
    for (key, path) in files {
        let Some(path) = path else { continue };
        let absolute = std::path::absolute(path).map_err(|error| unreadable(path, &error))?;
        std::fs::File::open(&absolute).map_err(|error| unreadable(path, &error))?;
        set(config, &format!("transport/link/tls/{key}"), &serde_json::json!(absolute))?;
    }
    set(config, &format!("transport/link/tls/{mutual}"), &is_mutual.into())
}

fn unreadable(path: &Path, error: &std::io::Error) -> FabricError {
    FabricError(format!("{}: {error}", path.display()))
}
