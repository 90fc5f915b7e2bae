//! Handshake at the start of a connection, in which both ends prove that they hold the key.
//!
//! Each end sends its versions unencrypted, [`HELLO`] bytes. Both then perform the handshake NNpsk0
//! of the Noise protocol framework (revision 34, noiseprotocol.org) over X25519, AES-256-GCM and
//! SHA-256. The key is the pre-shared key, and the client's versions are the prologue. The
//! ephemeral keys give forward secrecy: recorded traffic stays secret even if the key is stolen
//! later.
//!
//! Before a caller has proven the key, the server reads only [`GREETING`] bytes and one short
//! record, and allocates no further memory.

use crate::key::Key;
use crate::record::{Sealed, Unproven, read_by};
use contract::PROTOCOL_VERSION;
use snow::{Builder, HandshakeState, StatelessTransportState};
use std::io::{self, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Version of the messages of the relay.
const VERSION: u32 = 4;
const MARK: &[u8; 4] = b"cosR";
const PATTERN: &str = "Noise_NNpsk0_25519_AESGCM_SHA256";
/// Bytes of the versions of an end, including the mark.
const HELLO: usize = 12;
/// Bytes of a handshake message: an ephemeral key and a tag.
const MESSAGE: usize = 48;
/// Bytes of the first message of a caller.
const GREETING: usize = HELLO + MESSAGE;
/// Interval between attempts to connect.
const RETRY: Duration = Duration::from_millis(100);

/// Answer of the server to a greeting, sent after its versions.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
enum Answer {
    Welcome = 0,
    Refused = 1,
}

/// Reason why no link was established.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NoLink {
    #[error(
        "no server reached at {address} within {seconds:.0} s ({error}); start \
         `coordinator relay --listen` there, and see that the port is open"
    )]
    Unreached { address: String, seconds: f64, error: io::Error },
    #[error("the server does not answer within {0:.0} s")]
    NoAnswer(f64),
    #[error("the {0} has another key; give both ends the same key file")]
    OtherKey(&'static str),
    #[error(
        "the other end speaks relay version {}, protocol {}; this end {VERSION} and \
         {PROTOCOL_VERSION}; install the same version at both ends", .0.relay, .0.contract
    )]
    OtherVersion(Versions),
    #[error("the other end is not a relay")]
    NoRelay,
    #[error("the connection ended during the handshake: {0}")]
    Lost(#[from] io::Error),
}

/// Versions of the relay and of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Versions {
    relay: u32,
    contract: u32,
}

impl Versions {
    const OURS: Self = Self { relay: VERSION, contract: PROTOCOL_VERSION };

    fn write(self) -> [u8; HELLO] {
        let mut hello = [0; HELLO];
        hello[..4].copy_from_slice(MARK);
        hello[4..8].copy_from_slice(&self.relay.to_le_bytes());
        hello[8..].copy_from_slice(&self.contract.to_le_bytes());
        hello
    }

    fn read(hello: [u8; HELLO]) -> Option<Self> {
        let (numbers, _) = hello.strip_prefix(MARK)?.as_chunks();
        let [relay, contract] = numbers else { return None };
        Some(Self { relay: u32::from_le_bytes(*relay), contract: u32::from_le_bytes(*contract) })
    }
}

fn noise(key: &Key, is_client: bool) -> HandshakeState {
    let psk = key.pre_shared();
    let prologue = Versions::OURS.write();
    let builder = Builder::new(PATTERN.parse().expect("the pattern is one of Noise's"));
    let builder = builder.psk(0, &psk).and_then(|builder| builder.prologue(&prologue));
    let built = builder.and_then(|builder| match is_client {
        true => builder.build_initiator(),
        false => builder.build_responder(),
    });
    built.expect("the pattern asks for no more than these")
}

fn sealed(noise: HandshakeState) -> StatelessTransportState {
    noise.into_stateless_transport_mode().expect("both messages are through")
}

/// Connects to a server and proves the key.
pub(crate) fn connect(address: &str, key: &Key, patience: Duration) -> Result<Sealed, NoLink> {
    let until = Instant::now() + patience;
    let stream = reach(address, until).map_err(|error| {
        let (address, seconds) = (address.to_owned(), patience.as_secs_f64());
        NoLink::Unreached { address, seconds, error }
    })?;
    let late = |error: io::Error| match error.kind() {
        io::ErrorKind::TimedOut => NoLink::NoAnswer(patience.as_secs_f64()),
        _ => NoLink::Lost(error),
    };
    let (mut noise, mut greeting) = (noise(key, true), [0; GREETING]);
    greeting[..HELLO].copy_from_slice(&Versions::OURS.write());
    noise.write_message(&[], &mut greeting[HELLO..]).expect("it has the length of the pattern");
    (&stream).write_all(&greeting).map_err(late)?;
    let (mut hello, mut answer, mut message) = ([0; HELLO], [0; 1], [0; MESSAGE]);
    read_by(&stream, &mut hello, until).map_err(late)?;
    let versions = Versions::read(hello).ok_or(NoLink::NoRelay)?;
    if versions != Versions::OURS {
        return Err(NoLink::OtherVersion(versions));
    }
    read_by(&stream, &mut answer, until).map_err(late)?;
    if answer[0] != Answer::Welcome as u8 {
        return Err(NoLink::OtherKey("server"));
    }
    read_by(&stream, &mut message, until).map_err(late)?;
    noise.read_message(&message, &mut []).map_err(|_| NoLink::OtherKey("server"))?;
    let sealed = Sealed::new(stream, sealed(noise));
    // Proves that this end holds the key now. A greeting alone could be a replay.
    sealed.prove().map_err(late)?;
    Ok(sealed)
}

/// Connects, retrying until a server listens.
fn reach(address: &str, until: Instant) -> io::Result<TcpStream> {
    loop {
        let left = until.saturating_duration_since(Instant::now()).max(Duration::from_millis(1));
        let tried = address.to_socket_addrs().and_then(|mut known| {
            let first = known.next().ok_or(io::ErrorKind::AddrNotAvailable)?;
            // A name may have several addresses; the error of the last one is returned.
            known.fold(TcpStream::connect_timeout(&first, left), |tried, next| {
                tried.or_else(|_| TcpStream::connect_timeout(&next, left))
            })
        });
        match tried {
            Ok(stream) => return Ok(stream),
            Err(error) if Instant::now() + RETRY >= until => return Err(error),
            Err(error) if error.kind() == io::ErrorKind::InvalidInput => return Err(error),
            Err(_) => std::thread::sleep(RETRY),
        }
    }
}

/// Accepts a caller, who must prove the key before `until`.
pub(crate) fn accept(stream: TcpStream, key: &Key, until: Instant) -> Result<Sealed, NoLink> {
    let (mut noise, mut hello, mut message) = (noise(key, false), [0; HELLO], [0; MESSAGE]);
    let refuse = |why: NoLink| {
        let _ = (&stream).write_all(&Versions::OURS.write());
        let _ = (&stream).write_all(&[Answer::Refused as u8]);
        Err(why)
    };
    read_by(&stream, &mut hello, until)?;
    let Some(versions) = Versions::read(hello) else { return Err(NoLink::NoRelay) };
    if versions != Versions::OURS {
        return refuse(NoLink::OtherVersion(versions));
    }
    read_by(&stream, &mut message, until)?;
    if noise.read_message(&message, &mut []).is_err() {
        return refuse(NoLink::OtherKey("client"));
    }
    let mut answer = [0; HELLO + 1 + MESSAGE];
    answer[..HELLO].copy_from_slice(&Versions::OURS.write());
    answer[HELLO] = Answer::Welcome as u8;
    noise.write_message(&[], &mut answer[HELLO + 1..]).expect("it has the length of the pattern");
    (&stream).write_all(&answer)?;
    let sealed = Sealed::new(stream, sealed(noise));
    match sealed.proven(until) {
        Ok(()) => Ok(sealed),
        Err(Unproven::Late(error)) => Err(NoLink::Lost(error)),
        Err(Unproven::Wrong) => Err(NoLink::OtherKey("client")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    const SOON: Duration = Duration::from_secs(20);

    /// Performs a handshake and returns the result of both ends.
    fn meet(client: &Key, server: Key) -> (Result<Sealed, NoLink>, Result<Sealed, NoLink>) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let answered = std::thread::spawn(move || {
            accept(listener.accept().unwrap().0, &server, Instant::now() + SOON)
        });
        (connect(&address, client, SOON), answered.join().unwrap())
    }

    /// Returns the error of a server that receives these bytes and waits at most `patience`.
    fn call(bytes: &[u8], patience: Duration) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut caller = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        caller.write_all(bytes).unwrap();
        let stream = listener.accept().unwrap().0;
        let answered = accept(stream, &Key::of(&[7; 32]), Instant::now() + patience);
        answered.map(|_| ()).unwrap_err().to_string()
    }

    #[test]
    fn two_with_one_key_meet_and_others_do_not() {
        let (client, server) = meet(&Key::of(&[7; 32]), Key::of(&[7; 32]));
        assert!(client.is_ok() && server.is_ok());
        let (client, server) = meet(&Key::of(&[7; 32]), Key::of(&[8; 32]));
        let told = |met: Result<Sealed, NoLink>| met.map(|_| ()).unwrap_err().to_string();
        assert!(told(client).starts_with("the server has another key"));
        assert!(told(server).starts_with("the client has another key"));
    }

    #[test]
    fn callers_without_the_key_are_refused_and_late_ones_too() {
        let short = Duration::from_millis(50);
        assert_eq!(call(b"GET / HTTP/1.1\r\n\r\n", SOON), "the other end is not a relay");
        let other = Versions { relay: 1, ..Versions::OURS };
        assert!(call(&other.write(), SOON).contains("speaks relay version 1"));
        let random = [&Versions::OURS.write()[..], &[9; MESSAGE]].concat();
        assert!(call(&random, SOON).starts_with("the client has another key"));
        for silent in [&random[..0], &random[..HELLO], &random[..GREETING - 1]] {
            assert!(call(silent, short).contains("the connection ended"));
        }
    }

    /// A replayed greeting proves nothing.
    #[test]
    fn a_replayed_greeting_is_not_taken() {
        let mut greeting = Versions::OURS.write().to_vec();
        greeting.resize(GREETING, 0);
        let mut noise = noise(&Key::of(&[7; 32]), true);
        noise.write_message(&[], &mut greeting[HELLO..]).unwrap();
        assert!(call(&greeting, Duration::from_millis(50)).contains("the connection ended"));
        let made_up = [&greeting[..], &16_u16.to_le_bytes(), &[2], &[5; 16]].concat();
        assert!(call(&made_up, SOON).starts_with("the client has another key"));
    }
}
