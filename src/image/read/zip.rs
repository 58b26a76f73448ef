//! The bytes of a file that may be compressed, unpacked up to a limit.

use super::ImageReadError;
use crate::slices::pause;
use flate2::bufread::{MultiGzDecoder, ZlibDecoder};
use std::io::{Cursor, Read};

/// Bytes that a slice of work unpacks.
pub(super) const UNPACKED_AT_ONCE: u64 = 1 << 14;
const GZIP: &[u8] = b"\x1f\x8b";
/// The largest number of bytes to which one byte of deflate can expand: 258 by two bits (P.
/// Deutsch, RFC 1951, 1996).
const MOST_FROM_A_BYTE: u64 = 1032;

/// A file, whose unpacked start is kept.
pub(super) struct Unpacked {
    bytes: Vec<u8>,
    /// The remaining compressed bytes.
    rest: Option<Box<dyn Read + Send>>,
    /// Upper limit on the size of the unpacked file, in bytes.
    most: u64,
}

impl Unpacked {
    /// A file, which is unpacked if it begins like a gzip file.
    pub(super) fn new(bytes: Vec<u8>) -> Self {
        if bytes.starts_with(GZIP) { Self::packed(bytes) } else { Self { bytes, rest: None, most: 0 } }
    }

    /// Data compressed by gzip or zlib.
    pub(super) fn packed(bytes: Vec<u8>) -> Self {
        let is_gzip = bytes.starts_with(GZIP);
        let most = MOST_FROM_A_BYTE.saturating_mul(bytes.len() as u64);
        let bytes = Cursor::new(bytes);
        let rest: Box<dyn Read + Send> =
            if is_gzip { Box::new(MultiGzDecoder::new(bytes)) } else { Box::new(ZlibDecoder::new(bytes)) };
        Self { bytes: Vec::new(), rest: Some(rest), most }
    }

    /// Unpacks until `count` bytes are available, or the end is reached, in slices of work.
    async fn unpack(&mut self, count: u64) -> Result<(), ImageReadError> {
        let Some(rest) = &mut self.rest else { return Ok(()) };
        let wanted = count.saturating_sub(self.bytes.len() as u64);
        // A vector that grows by doubling takes up to twice the memory.
        let _ = self.bytes.try_reserve_exact(wanted.min(self.most) as usize);
        while (self.bytes.len() as u64) < count {
            let a_slice = (count - self.bytes.len() as u64).min(UNPACKED_AT_ONCE);
            match rest.take(a_slice).read_to_end(&mut self.bytes) {
                Ok(0) => break,
                Ok(_) => pause().await,
                Err(error) => {
                    let unpacked = self.bytes.len() as u64;
                    return Err(ImageReadError::Damaged { unpacked, message: error.to_string() });
                }
            }
        }
        Ok(())
    }

    /// The first `count` bytes of the file, or all if it is shorter.
    pub(super) async fn start(&mut self, count: usize) -> Result<Vec<u8>, ImageReadError> {
        self.unpack(count as u64).await?;
        Ok(self.bytes[..count.min(self.bytes.len())].to_vec())
    }

    /// All bytes; if compressed, at most about `limit`.
    pub(super) async fn all(mut self, limit: u64) -> Result<Vec<u8>, ImageReadError> {
        self.unpack(limit).await?;
        Ok(self.bytes)
    }
}
