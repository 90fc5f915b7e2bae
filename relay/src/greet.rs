//! Both ends of the first words: out of a wire, a line.

use crate::fabric::{Fabric, FabricError, Wire};
use crate::hail::{End, Versions, Word, is_proven, proof};
use crate::key::{Key, random};
use crate::line::{Incoming, Line, Sending};
use crate::seal::{Drawn, Seal};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Why there is no conversation.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NoLine {
    #[error(transparent)]
    Network(#[from] FabricError),
    #[error("the far end does not answer within {0:.0} s")]
    NoAnswer(f64),
    #[error("{0}")]
    Refused(String),
}

/// A word of the other end, by then.
fn word(arrived: &Receiver<Vec<u8>>, until: Instant) -> Option<Word> {
    loop {
        let left = until.saturating_duration_since(Instant::now());
        let bytes = arrived.recv_timeout(left).ok()?;
        // What is no word is none of the other end's.
        if let Some(word) = Word::read(&bytes) {
            return Some(word);
        }
    }
}

/// Calls the far end.
pub(crate) fn call(fabric: &Fabric, key: &Key, patience: Duration) -> Result<Line, NoLine> {
    let until = Instant::now() + patience;
    let name: String = random::<16>().iter().map(|byte| format!("{byte:02x}")).collect();
    let (lanes, arrivals, hold) = fabric.wire(&name, End::Home)?.split();
    let home = random();
    fabric.call(&name, Word::Hello { versions: Versions::OURS, drawn: home }.write())?;
    let refuse = |why: &str, told: &str| {
        let _ = lanes[0].send(Word::Refused(told.to_owned()).write());
        Err(NoLine::Refused(why.to_owned()))
    };
    let drawn = match word(&arrivals[0], until) {
        None => return Err(NoLine::NoAnswer(patience.as_secs_f64())),
        Some(Word::Refused(why)) => {
            return Err(NoLine::Refused(format!("the far end refuses: {why}")));
        }
        Some(Word::Challenge { versions, drawn: far, proof }) => {
            if let Some(fault) = versions.fault() {
                return refuse(&fault, &fault);
            }
            let drawn = Drawn { home, far };
            if !is_proven(key, End::Far, &drawn, &proof) {
                return refuse(
                    "the far end has another key; give both ends the same key file",
                    "the home end has another key",
                );
            }
            drawn
        }
        Some(_) => return refuse("the far end does not say what it should", "out of turn"),
    };
    lanes[0].send(Word::Proof(proof(key, End::Home, &drawn)).write())?;
    let (out, back) = Seal::both(key, &drawn);
    let [messages, life] = Incoming::both(back, arrivals);
    Ok(Line { sending: Arc::new(Sending::new(out, lanes)), messages, life, hold })
}

/// Answers a call.
pub(crate) fn answer(
    wire: Wire,
    hello: &[u8],
    key: &Key,
    patience: Duration,
) -> Result<Line, NoLine> {
    let until = Instant::now() + patience;
    let (lanes, arrivals, hold) = wire.split();
    let refuse = |why: String| {
        let _ = lanes[0].send(Word::Refused(why.clone()).write());
        Err(NoLine::Refused(why))
    };
    let Some(Word::Hello { versions, drawn: home }) = Word::read(hello) else {
        return refuse("this is no call of a relay".to_owned());
    };
    if let Some(fault) = versions.fault() {
        return refuse(fault);
    }
    let drawn = Drawn { home, far: random() };
    let challenge = Word::Challenge {
        versions: Versions::OURS,
        drawn: drawn.far,
        proof: proof(key, End::Far, &drawn),
    };
    lanes[0].send(challenge.write())?;
    match word(&arrivals[0], until) {
        Some(Word::Proof(shown)) if is_proven(key, End::Home, &drawn, &shown) => {}
        Some(Word::Proof(_)) => {
            return refuse(
                "the home end has another key; give both ends the same key file".to_owned(),
            );
        }
        Some(Word::Refused(why)) => return Err(NoLine::Refused(why)),
        Some(_) => return refuse("the home end does not say what it should".to_owned()),
        None => return Err(NoLine::NoAnswer(patience.as_secs_f64())),
    }
    let (inward, out) = Seal::both(key, &drawn);
    let [messages, life] = Incoming::both(inward, arrivals);
    Ok(Line { sending: Arc::new(Sending::new(out, lanes)), messages, life, hold })
}
