//! CRC-64/XZ: reflected, polynomial 0x42F0E1EBA9EA3693 (ECMA-182), all ones before and after. It
//! tells a truncated or damaged file from a whole one; it is no protection against forgery.

/// The polynomial, reflected.
const POLYNOMIAL: u64 = 0xC96C_5795_D787_0F42;

/// The remainders of all bytes.
const TABLE: [u64; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut remainder = byte as u64;
        let mut bit = 0;
        while bit < 8 {
            let carry = remainder & 1;
            remainder >>= 1;
            if carry == 1 {
                remainder ^= POLYNOMIAL;
            }
            bit += 1;
        }
        table[byte] = remainder;
        byte += 1;
    }
    table
};

/// The CRC-64 of some bytes.
#[must_use]
pub fn sum(bytes: &[u8]) -> u64 {
    let step = |sum: u64, byte: &u8| TABLE[(sum as u8 ^ byte) as usize] ^ (sum >> 8);
    !bytes.iter().fold(!0, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of the catalogue of parametrised CRC algorithms.
    #[test]
    fn the_standard_check_value() {
        assert_eq!(sum(b"123456789"), 0x995D_C9BB_DF19_39FA);
        assert_eq!(sum(b""), 0);
    }
}
