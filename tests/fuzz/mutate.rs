//! Random damage to files.

/// Text that readers may stumble over.
const TOKENS: [&[u8]; 24] = [
    b"0",
    b"-1",
    b"1e999",
    b"nan",
    b"inf",
    b"4294967296",
    b"9223372036854775807",
    b"18446744073709551616",
    b"1e-320",
    b"\n",
    b"\0",
    b",",
    b"=",
    b"*",
    b"**",
    b"$",
    b"[",
    b"]",
    b"{",
    b"\"",
    b"\xff",
    b"\xef\xbb\xbf",
    b" ",
    b"*END STEP\n",
];
/// Bytes that readers may stumble over.
const BYTES: [u8; 6] = [0, 1, 0x7f, 0x80, 0xff, b'9'];
/// Mutations of one input at most.
const MOST: u64 = 4;

/// Gives one damaged file after the other.
pub struct Mutator {
    state: u64,
    seeds: Vec<Vec<u8>>,
}

impl Mutator {
    pub fn new(state: u64, seeds: Vec<Vec<u8>>) -> Mutator {
        Mutator { state, seeds }
    }

    /// A number below `n`. SplitMix64: Steele, Lea and Flood, OOPSLA 2014.
    fn below(&mut self, n: usize) -> usize {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }

    /// A damaged file.
    pub fn next(&mut self) -> Vec<u8> {
        let seed = self.below(self.seeds.len());
        let mut bytes = self.seeds[seed].clone();
        for _ in 0..=self.below(MOST as usize) {
            self.mutate(&mut bytes);
        }
        bytes
    }

    fn mutate(&mut self, bytes: &mut Vec<u8>) {
        if bytes.is_empty() {
            return;
        }
        let at = self.below(bytes.len());
        let longest = if self.below(4) == 0 { 4096 } else { 16 };
        let length = 1 + self.below(longest);
        let end = (at + length).min(bytes.len());
        match self.below(9) {
            0 => bytes[at] ^= 1 << self.below(8),
            1 => bytes[at] = BYTES[self.below(BYTES.len())],
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let copy = bytes[at..end].to_vec();
                let to = self.below(bytes.len());
                drop(bytes.splice(to..to, copy));
            }
            5 => {
                let token = TOKENS[self.below(TOKENS.len())];
                drop(bytes.splice(at..at, token.iter().copied()));
            }
            6 => self.replace_number(bytes, at),
            7 => {
                let other = self.below(self.seeds.len());
                let from = self.below(self.seeds[other].len());
                let piece = &self.seeds[other][from..(from + length).min(self.seeds[other].len())];
                drop(bytes.splice(at..end, piece.iter().copied()));
            }
            // A number of four bytes in either order.
            _ => {
                let number = [0, u32::MAX, 1 << 31, 0x7fff_ffff, 1 << 20][self.below(5)].to_be_bytes();
                bytes.iter_mut().skip(at).zip(number).for_each(|(byte, new)| *byte = new);
            }
        }
    }

    /// Puts a token in the place of the number at or after a place.
    fn replace_number(&mut self, bytes: &mut Vec<u8>, at: usize) {
        let is_digit = |byte: &u8| byte.is_ascii_digit();
        let Some(first) = bytes[at..].iter().position(is_digit).map(|i| at + i) else { return };
        let n_digits = bytes[first..].iter().take_while(|byte| is_digit(byte)).count();
        let token = TOKENS[self.below(9)];
        drop(bytes.splice(first..first + n_digits, token.iter().copied()));
    }
}
