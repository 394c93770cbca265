//! A reader over a piece of a file that knows where in the file it stands.
//!
//! Nothing is ever read past the end and nothing is allocated from a count in the file: whatever is
//! taken is a slice of bytes that exist. OpenVDB files are little-endian.
//! Tested through the damaged files in `tests.rs`.

/// Why a piece of a file could not be understood, before the grid's name is known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    pub kind: FaultKind,
    /// Byte offset in the file.
    pub offset: u64,
    pub what: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FaultKind {
    /// The bytes end before the thing does.
    Short,
    Invalid,
    Unsupported,
}

impl Fault {
    pub fn invalid(offset: u64, what: impl Into<String>) -> Self {
        Self { kind: FaultKind::Invalid, offset, what: what.into() }
    }

    pub fn unsupported(offset: u64, what: impl Into<String>) -> Self {
        Self { kind: FaultKind::Unsupported, offset, what: what.into() }
    }
}

pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Offset in the file of `bytes[0]`.
    base: u64,
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8], base: u64) -> Self {
        Self { bytes, at: 0, base }
    }

    /// Byte offset in the file of what is read next.
    pub fn offset(&self) -> u64 {
        self.base + self.at as u64
    }

    pub fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    pub fn take(&mut self, n_bytes: usize) -> Result<&'a [u8], Fault> {
        self.check(n_bytes as u64)?;
        let taken = &self.bytes[self.at..self.at + n_bytes];
        self.at += n_bytes;
        Ok(taken)
    }

    /// An error unless `n_bytes` more bytes are there.
    pub fn check(&self, n_bytes: u64) -> Result<(), Fault> {
        if n_bytes <= self.remaining() as u64 {
            return Ok(());
        }
        Err(Fault {
            kind: FaultKind::Short,
            offset: self.offset(),
            what: format!("{n_bytes} bytes are announced, {} are left", self.remaining()),
        })
    }

    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N)?);
        Ok(out)
    }

    pub fn u8(&mut self) -> Result<u8, Fault> {
        Ok(self.array::<1>()?[0])
    }

    pub fn u32(&mut self) -> Result<u32, Fault> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub fn i32(&mut self) -> Result<i32, Fault> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    pub fn i64(&mut self) -> Result<i64, Fault> {
        Ok(i64::from_le_bytes(self.array()?))
    }

    pub fn f64(&mut self) -> Result<f64, Fault> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    pub fn f64s<const N: usize>(&mut self) -> Result<[f64; N], Fault> {
        let mut out = [0.0; N];
        for value in &mut out {
            *value = self.f64()?;
        }
        Ok(out)
    }

    pub fn coord(&mut self) -> Result<[i32; 3], Fault> {
        Ok([self.i32()?, self.i32()?, self.i32()?])
    }

    /// A string with its length before it; what is no UTF-8 becomes U+FFFD.
    pub fn string(&mut self) -> Result<String, Fault> {
        let n_bytes = self.u32()?;
        self.check(u64::from(n_bytes))?;
        Ok(String::from_utf8_lossy(self.take(n_bytes as usize)?).into_owned())
    }
}
