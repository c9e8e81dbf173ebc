//! Common Data Representation, in which ROS 2 has its messages.
//!
//! Source: OMG's DDS-XTypes 1.3, plain CDR, version 1, little-endian: every number at a multiple of its size from the end of the four
//! bytes that say so, texts and lists behind their lengths, texts with a zero byte at their end.

/// The four bytes in front: little-endian plain CDR, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// A message as it is written.
pub(super) struct Cdr {
    bytes: Vec<u8>,
}

impl Cdr {
    /// Nothing yet.
    pub(super) fn new() -> Self {
        Self { bytes: ENCAPSULATION.to_vec() }
    }

    /// The whole message.
    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        let gap = (self.bytes.len() - ENCAPSULATION.len()).next_multiple_of(N) + ENCAPSULATION.len();
        self.bytes.resize(gap, 0);
        self.bytes.extend(bytes);
    }

    pub(super) fn bool(&mut self, value: bool) {
        self.put([u8::from(value)]);
    }

    pub(super) fn i32(&mut self, value: i32) {
        self.put(value.to_le_bytes());
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.put(value.to_le_bytes());
    }

    pub(super) fn f64(&mut self, value: f64) {
        self.put(value.to_le_bytes());
    }

    /// The length of a list, which its elements follow.
    pub(super) fn count(&mut self, count: usize) {
        self.u32(count as u32);
    }

    pub(super) fn text(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.bytes.extend(text.bytes());
        self.bytes.push(0);
    }

    /// A list of as many numbers as there are.
    pub(super) fn list(&mut self, values: &[f64]) {
        self.count(values.len());
        self.array(values);
    }

    /// As many numbers as the message always has.
    pub(super) fn array(&mut self, values: &[f64]) {
        for &value in values {
            self.f64(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_at_multiples_of_their_size() {
        let mut cdr = Cdr::new();
        cdr.text("ab");
        cdr.bool(true);
        cdr.f64(1.0);
        cdr.u32(7);
        cdr.list(&[]);
        cdr.i32(-2);
        let expected: [&[u8]; 8] = [
            &[0, 1, 0, 0],
            &[3, 0, 0, 0, b'a', b'b', 0],
            &[1],
            // The text and the truth value end at 8.
            &1f64.to_le_bytes(),
            &[7, 0, 0, 0],
            &[0, 0, 0, 0],
            &[0xfe, 0xff, 0xff, 0xff],
            &[],
        ];
        assert_eq!(cdr.into_bytes(), expected.concat());
    }
}
