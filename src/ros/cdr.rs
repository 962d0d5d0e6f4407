//! The encoding of ROS 2 messages: CDR in little endian (OMG, Common Object Request Broker Architecture, 9.3), after a header of four
//! bytes. A value of n bytes begins at a multiple of n after the header.

/// The header of little endian, and that of big endian.
const LITTLE: [u8; 4] = [0, 1, 0, 0];
const BIG: [u8; 4] = [0, 0, 0, 0];

/// The length of the header, bytes.
const HEADER: usize = LITTLE.len();

/// The bytes of a message.
#[derive(Clone, Debug)]
pub struct Writer(Vec<u8>);

impl Default for Writer {
    fn default() -> Self {
        Self(LITTLE.to_vec())
    }
}

impl Writer {
    /// The bytes.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    fn push<const N: usize>(&mut self, bytes: [u8; N]) {
        let length = (self.0.len() - HEADER).next_multiple_of(N) + HEADER;
        self.0.resize(length, 0);
        self.0.extend(bytes);
    }

    /// An unsigned integer of 8 bits.
    pub fn u8(&mut self, value: u8) {
        self.push([value]);
    }

    /// An unsigned integer of 32 bits.
    pub fn u32(&mut self, value: u32) {
        self.push(value.to_le_bytes());
    }

    /// A signed integer of 32 bits.
    pub fn i32(&mut self, value: i32) {
        self.push(value.to_le_bytes());
    }

    /// A number of 64 bits.
    pub fn f64(&mut self, value: f64) {
        self.push(value.to_le_bytes());
    }

    /// The length of a sequence.
    pub fn length(&mut self, length: usize) {
        // No trace has 2^32 joints or bytes in a name.
        self.u32(u32::try_from(length).unwrap_or(u32::MAX));
    }

    /// A text, with a NUL at its end.
    pub fn text(&mut self, text: &str) {
        self.length(text.len() + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    /// A sequence of numbers.
    pub fn numbers(&mut self, values: &[f64]) {
        self.length(values.len());
        values.iter().for_each(|value| self.f64(*value));
    }
}

/// What is left of the bytes of a message.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    is_big: bool,
}

impl<'a> Reader<'a> {
    /// The values of a message; `None` if it does not begin with a header of plain CDR.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let header = bytes.get(..HEADER)?;
        // The last two bytes are options, which plain CDR has no use for.
        let is_big = match header.get(..2)? {
            kind if kind == &LITTLE[..2] => false,
            kind if kind == &BIG[..2] => true,
            _ => return None,
        };
        Some(Self { bytes: bytes.get(HEADER..)?, at: 0, is_big })
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let from = self.at.checked_next_multiple_of(N)?;
        let bytes: [u8; N] = self.bytes.get(from..from.checked_add(N)?)?.try_into().ok()?;
        self.at = from + N;
        Some(bytes)
    }

    /// An unsigned integer of 32 bits; `None` after the end.
    pub fn u32(&mut self) -> Option<u32> {
        let bytes = self.take()?;
        Some(if self.is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// A signed integer of 32 bits; `None` after the end.
    pub fn i32(&mut self) -> Option<i32> {
        let bytes = self.take()?;
        Some(if self.is_big { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) })
    }

    /// A number of 64 bits; `None` after the end.
    pub fn f64(&mut self) -> Option<f64> {
        let bytes = self.take()?;
        Some(if self.is_big { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) })
    }

    /// A text without the NUL at its end, not decoded; `None` after the end.
    pub fn text(&mut self) -> Option<&'a [u8]> {
        let length = usize::try_from(self.u32()?).ok()?;
        let text = self.bytes.get(self.at..self.at.checked_add(length)?)?;
        self.at += length;
        Some(text.strip_suffix(&[0]).unwrap_or(text))
    }
}
