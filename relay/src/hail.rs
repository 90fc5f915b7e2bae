//! The first words: both ends show that they have the same key, and neither says it.
//!
//! ```text
//! home → far   Hello      versions, 32 random bytes
//! far → home   Challenge  versions, 32 random bytes, HMAC of both under the key
//! home → far   Proof      HMAC of both under the key
//! ```
//!
//! HMAC-SHA-256 (RFC 2104); what the two ends sign differs, so that nothing can be sent back to its sender.
//! Whoever refuses says so, in a word that is not signed: it ends the conversation, and nothing else.

use crate::key::Key;
use crate::seal::Drawn;
use contract::PROTOCOL_VERSION;
use contract::text::one_line;
use ring::hmac;

/// Version of what the ends say to each other.
pub(crate) const VERSION: u32 = 1;
const MARK: &[u8; 4] = b"cosR";
/// The longest reason that is read [byte].
const LONGEST: usize = 1000;

/// One of the first words.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Word {
    Hello { versions: Versions, drawn: [u8; 32] },
    Challenge { versions: Versions, drawn: [u8; 32], proof: [u8; 32] },
    Proof([u8; 32]),
    Refused(String),
}

/// Of the relay and of the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Versions {
    relay: u32,
    contract: u32,
}

impl Versions {
    pub(crate) const OURS: Self = Self { relay: VERSION, contract: PROTOCOL_VERSION };

    /// Why an end with these is not talked to.
    pub(crate) fn fault(self) -> Option<String> {
        let said = |it: Self| format!("relay version {}, protocol {}", it.relay, it.contract);
        let (theirs, ours) = (said(self), said(Self::OURS));
        (self != Self::OURS).then(|| {
            format!(
                "the other end speaks {theirs}, this one {ours}; install the same version at both"
            )
        })
    }
}

/// Which end signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Home,
    Far,
}

fn signed(end: End, drawn: &Drawn) -> Vec<u8> {
    let who: &[u8] = match end {
        End::Home => b"cosim relay: home",
        End::Far => b"cosim relay: far",
    };
    [who, &VERSION.to_le_bytes(), &drawn.bytes()].concat()
}

/// What shows that this end has the key.
pub(crate) fn proof(key: &Key, end: End, drawn: &Drawn) -> [u8; 32] {
    let key = hmac::Key::new(hmac::HMAC_SHA256, key.bytes());
    let tag = hmac::sign(&key, &signed(end, drawn));
    tag.as_ref().try_into().expect("SHA-256 has 32 bytes")
}

/// The end has the same key.
pub(crate) fn is_proven(key: &Key, end: End, drawn: &Drawn, proof: &[u8; 32]) -> bool {
    let key = hmac::Key::new(hmac::HMAC_SHA256, key.bytes());
    hmac::verify(&key, &signed(end, drawn), proof).is_ok()
}

impl Word {
    pub(crate) fn write(&self) -> Vec<u8> {
        let versions = |v: &Versions| [v.relay.to_le_bytes(), v.contract.to_le_bytes()].concat();
        match self {
            Self::Hello { versions: v, drawn } => [&MARK[..], &[0], &versions(v), drawn].concat(),
            Self::Challenge { versions: v, drawn, proof } => {
                [&MARK[..], &[1], &versions(v), drawn, proof].concat()
            }
            Self::Proof(proof) => [&MARK[..], &[2], proof].concat(),
            Self::Refused(why) => [&MARK[..], &[3], why.as_bytes()].concat(),
        }
    }

    /// `None` for what is no word.
    pub(crate) fn read(bytes: &[u8]) -> Option<Self> {
        let (kind, rest) = bytes.strip_prefix(MARK)?.split_first()?;
        let versions = |rest: &[u8]| -> Option<Versions> {
            let of = |at: usize| Some(u32::from_le_bytes(rest.get(at..at + 4)?.try_into().ok()?));
            Some(Versions { relay: of(0)?, contract: of(4)? })
        };
        let field =
            |from: usize| -> Option<[u8; 32]> { rest.get(from..from + 32)?.try_into().ok() };
        // Another version may have more to say.
        match kind {
            0 => Some(Self::Hello { versions: versions(rest)?, drawn: field(8)? }),
            1 => Some(Self::Challenge {
                versions: versions(rest)?,
                drawn: field(8)?,
                proof: field(40)?,
            }),
            2 => Some(Self::Proof(field(0)?)),
            3 => {
                let why = String::from_utf8_lossy(&rest[..rest.len().min(LONGEST)]);
                Some(Self::Refused(one_line(&why).into_owned()))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_proof_is_of_one_key_one_end_and_one_conversation() {
        let drawn = Drawn { home: [1; 32], far: [2; 32] };
        let (key, other) = (Key::of(&[7; 32]), Key::of(&[8; 32]));
        let shown = proof(&key, End::Far, &drawn);
        assert!(is_proven(&key, End::Far, &drawn, &shown));
        assert!(!is_proven(&other, End::Far, &drawn, &shown));
        assert!(!is_proven(&key, End::Home, &drawn, &shown));
        let again = Drawn { home: [3; 32], ..drawn };
        assert!(!is_proven(&key, End::Far, &again, &shown));
    }

    #[test]
    fn words_read_back() {
        let versions = Versions { relay: 5, contract: 6 };
        let words = [
            Word::Hello { versions, drawn: [1; 32] },
            Word::Challenge { versions, drawn: [2; 32], proof: [3; 32] },
            Word::Proof([4; 32]),
            Word::Refused("no".to_owned()),
        ];
        for word in words {
            assert_eq!(Word::read(&word.write()), Some(word));
        }
        let fault = versions.fault().unwrap();
        assert!(fault.contains("relay version 5, protocol 6") && Versions::OURS.fault().is_none());
        let hidden = Word::read(&Word::Refused("\u{1b}[2J".repeat(1000)).write());
        let Some(Word::Refused(why)) = hidden else { panic!("{hidden:?}") };
        assert!(!why.contains('\u{1b}') && why.len() < 8 * LONGEST);
    }

    proptest! {
        #![proptest_config(crate::fuzz_config())]

        #[test]
        fn no_bytes_are_more_than_no_word(
            kind in 0..5_u8, rest in proptest::collection::vec(any::<u8>(), 0..120),
        ) {
            let _ = Word::read(&rest);
            let _ = Word::read(&[&MARK[..], &[kind], &rest].concat());
        }
    }
}
