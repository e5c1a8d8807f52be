//! Messages of whatever serde can serialise, in one byte format (postcard's).

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::Comm;

fn to_bytes<T: Serialize + ?Sized>(value: &T) -> Vec<u8> {
    postcard::to_stdvec(value).expect("plain data, of known length")
}

fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> T {
    postcard::from_bytes(bytes).expect("all ranks run the same program")
}

impl Comm {
    /// The value of one rank, on every rank; what the others pass is not looked at.
    pub fn broadcast_value<T: Serialize + DeserializeOwned>(&self, from: usize, value: T) -> T {
        if self.size() == 1 {
            return value;
        }
        let is_own = self.rank() == from;
        let bytes = self.broadcast(from, if is_own { to_bytes(&value) } else { Vec::new() });
        if is_own { value } else { from_bytes(&bytes) }
    }

    /// The values of all ranks in their order, on every rank.
    pub fn join_values<T: Serialize + DeserializeOwned>(&self, value: T) -> Vec<T> {
        if self.size() == 1 {
            return vec![value];
        }
        let bytes = to_bytes(&value);
        let lengths = self.lengths(bytes.len());
        let all = self.join(&bytes);
        let mut rest = all.as_slice();
        let take = |length: usize| from_bytes(rest.split_off(..length).expect("as many bytes as all ranks have"));
        lengths.into_iter().map(take).collect()
    }

    /// The values of all ranks in their order, on the root; nothing on the others.
    pub fn gather_values<T: Serialize + DeserializeOwned>(&self, value: T) -> Vec<T> {
        if !self.is_root() {
            self.send_value(&value, 0);
            return Vec::new();
        }
        let others = (1..self.size()).map(|rank| self.receive_value(rank));
        std::iter::once(value).chain(others).collect()
    }

    /// Sends a value to a rank, which must be receiving it. Not collective.
    pub fn send_value<T: Serialize + ?Sized>(&self, value: &T, to: usize) {
        self.send(&to_bytes(value), to);
    }

    /// The value that a rank sends. Not collective.
    pub fn receive_value<T: DeserializeOwned>(&self, from: usize) -> T {
        from_bytes(&self.receive::<u8>(from))
    }
}
