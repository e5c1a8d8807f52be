//! Arrays as bytes: a count of eight bytes and the values in little endian, one array after the other.

/// Appends arrays.
#[derive(Default)]
pub struct Writer {
    pub bytes: Vec<u8>,
}

/// Takes arrays off the front.
pub struct Reader<'a> {
    pub bytes: &'a [u8],
}

impl Writer {
    fn count(&mut self, n: usize) {
        self.bytes.extend((n as u64).to_le_bytes());
    }

    pub fn integers(&mut self, values: &[u32]) {
        self.count(values.len());
        self.bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }

    pub fn numbers(&mut self, values: &[f64]) {
        self.count(values.len());
        self.bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }

    pub fn texts<'a>(&mut self, texts: impl ExactSizeIterator<Item = &'a String>) {
        self.count(texts.len());
        for text in texts {
            self.count(text.len());
            self.bytes.extend(text.as_bytes());
        }
    }
}

impl Reader<'_> {
    fn count(&mut self) -> usize {
        u64::from_le_bytes(self.take()) as usize
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (first, rest) = self.bytes.split_first_chunk().expect("as many bytes as were written");
        self.bytes = rest;
        *first
    }

    pub fn integers(&mut self) -> Vec<u32> {
        (0..self.count()).map(|_| u32::from_le_bytes(self.take())).collect()
    }

    pub fn numbers(&mut self) -> Vec<f64> {
        (0..self.count()).map(|_| f64::from_le_bytes(self.take())).collect()
    }

    pub fn texts(&mut self) -> Vec<String> {
        (0..self.count()).map(|_| self.text()).collect()
    }

    fn text(&mut self) -> String {
        let n = self.count();
        let (text, rest) = self.bytes.split_at(n);
        self.bytes = rest;
        String::from_utf8_lossy(text).into_owned()
    }
}
