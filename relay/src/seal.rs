//! Sealing what travels: both ends derive a key for each direction from the shared key and what they have drawn
//! for this very conversation, so that nothing of another one is taken, and nothing that was changed.
//!
//! Each piece is sealed by AES-256-GCM (NIST SP 800-38D); its nonce is the lane and the number of the piece in
//! it, which never comes twice under one key. Keys come from HKDF (RFC 5869) over SHA-256.

use crate::key::Key;
use ring::aead::{AES_256_GCM, Aad, LessSafeKey, NONCE_LEN, Nonce, UnboundKey};
use ring::hkdf::{HKDF_SHA256, Salt};

/// Bytes by which a sealed piece is longer.
pub(crate) const TAG: usize = 16;

/// What each end has drawn for a conversation: first the one that has called.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drawn {
    pub(crate) home: [u8; 32],
    pub(crate) far: [u8; 32],
}

impl Drawn {
    pub(crate) fn bytes(&self) -> [u8; 64] {
        let mut bytes = [0; 64];
        bytes[..32].copy_from_slice(&self.home);
        bytes[32..].copy_from_slice(&self.far);
        bytes
    }
}

/// Seals one direction.
#[derive(Debug)]
pub(crate) struct Seal(LessSafeKey);

impl Seal {
    /// The seals of what goes from home to the far end, and of what comes back.
    pub(crate) fn both(key: &Key, drawn: &Drawn) -> (Self, Self) {
        let derived = Salt::new(HKDF_SHA256, &drawn.bytes()).extract(key.bytes());
        let of = |direction: &[u8]| {
            let info = [direction];
            let okm = derived.expand(&info, &AES_256_GCM).expect("32 bytes are not too many");
            Self(LessSafeKey::new(UnboundKey::from(okm)))
        };
        (of(b"cosim relay: from home"), of(b"cosim relay: to home"))
    }

    /// Seals a piece in its place.
    pub(crate) fn close(&self, lane: u8, number: u64, piece: &mut Vec<u8>, from: usize) {
        let tag = self.0.seal_in_place_separate_tag(
            nonce(lane, number),
            Aad::empty(),
            &mut piece[from..],
        );
        piece.extend_from_slice(tag.expect("a piece is far below the limit").as_ref());
    }

    /// What a piece has; `None` unless the other end has sealed it under this number.
    pub(crate) fn open<'a>(
        &self,
        lane: u8,
        number: u64,
        piece: &'a mut [u8],
    ) -> Option<&'a mut [u8]> {
        self.0.open_in_place(nonce(lane, number), Aad::empty(), piece).ok()
    }
}

fn nonce(lane: u8, number: u64) -> Nonce {
    let mut bytes = [0; NONCE_LEN];
    bytes[0] = lane;
    bytes[4..].copy_from_slice(&number.to_le_bytes());
    Nonce::assume_unique_for_key(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_sealed_here_and_now_opens() {
        let (key, other) = (Key::of(&[1; 32]), Key::of(&[2; 32]));
        let drawn = Drawn { home: [3; 32], far: [4; 32] };
        let (there, back) = Seal::both(&key, &drawn);
        let sealed = {
            let mut piece = vec![9, 9, 1, 2, 3];
            there.close(0, 7, &mut piece, 2);
            assert_eq!((piece.len(), &piece[..2]), (5 + TAG, &[9, 9][..]));
            piece.split_off(2)
        };
        let opens = |seal: &Seal, lane, number, sealed: &[u8]| {
            seal.open(lane, number, &mut sealed.to_vec()).map(|piece| piece.to_vec())
        };
        assert_eq!(opens(&there, 0, 7, &sealed), Some(vec![1, 2, 3]));
        assert_eq!(opens(&there, 1, 7, &sealed), None);
        assert_eq!(opens(&there, 0, 8, &sealed), None);
        assert_eq!(opens(&back, 0, 7, &sealed), None);
        assert_eq!(opens(&Seal::both(&other, &drawn).0, 0, 7, &sealed), None);
        let later = Drawn { far: [5; 32], ..drawn };
        assert_eq!(opens(&Seal::both(&key, &later).0, 0, 7, &sealed), None);
        for at in 0..sealed.len() {
            let mut changed = sealed.clone();
            changed[at] ^= 1;
            assert_eq!(opens(&there, 0, 7, &changed), None, "{at}");
        }
        assert_eq!(opens(&there, 0, 7, &[]), None);
    }
}
