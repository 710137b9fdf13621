//! A checksum over all bytes of a file, in the file.
//!
//! A Parquet file has checksums for some pages, if for any, and none for its footer. Here the footer holds, as the
//! value of [`CHECKSUM`], the CRC-32 of the whole file in eight hexadecimal digits, counted with zeros in their place.
//! It finds every error within 32 bits on end, so every byte that is damaged, and of any other damage all but a part of
//! 2⁻³².
//!
//! The footer is written last, so it is kept in memory until the checksum of what stands before it is known.
//!
//! Checked by the program's `tests/sweep_folder.rs`, which damages parts byte by byte.

use crc32fast::Hasher;
use std::fs::File;
use std::io::{Error, ErrorKind, Read as _, Result, Seek as _, SeekFrom, Write};

/// Key of a part's metadata: the checksum of its file.
pub const CHECKSUM: &str = "mckibben.crc32";
/// What stands in the place of the digits while they are not known.
pub(super) const UNKNOWN: &str = "00000000";
/// Bytes that are read at a time.
const PIECE: usize = 1 << 16;
/// What a Parquet file ends with, behind four bytes for the length of its footer.
const MAGIC: &[u8] = b"PAR1";

/// How a file and its checksum agree.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Seal {
    /// They agree.
    Whole,
    /// The file is not what was written.
    Damaged,
    /// It has none: it was written by an earlier version.
    Missing,
}

/// Bytes on their way to a sink.
pub(super) struct Sealed<W: Write> {
    sink: W,
    hasher: Hasher,
    /// The end of the file, once it has begun.
    end: Option<Vec<u8>>,
}

impl<W: Write> Sealed<W> {
    pub(super) fn new(sink: W) -> Self {
        Self { sink, hasher: Hasher::new(), end: None }
    }

    /// Keeps what follows, in which the place of the digits is.
    pub(super) fn begin_end(&mut self) {
        self.end.get_or_insert_default();
    }

    /// Puts the digits into their place, where the end has begun; the sink with all bytes.
    pub(super) fn finish(mut self) -> Result<W> {
        if let Some(mut end) = self.end.take() {
            self.hasher.update(&end);
            let at = place(&end).ok_or_else(|| Error::other("its checksum has no place"))?;
            end[at..][..UNKNOWN.len()].copy_from_slice(digits(self.hasher).as_bytes());
            self.sink.write_all(&end)?;
        }
        Ok(self.sink)
    }
}

impl<W: Write> Write for Sealed<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        match &mut self.end {
            Some(end) => end.write(bytes),
            None => {
                let written = self.sink.write(bytes)?;
                self.hasher.update(&bytes[..written]);
                Ok(written)
            }
        }
    }

    fn flush(&mut self) -> Result<()> {
        self.sink.flush()
    }
}

/// Holds a file to its checksum.
///
/// # Errors
/// When it cannot be read.
pub fn seal(file: &mut File) -> Result<Seal> {
    let length = file.metadata()?.len();
    let Some((begins, end)) = end_of(file, length)? else { return Ok(Seal::Damaged) };
    let Some(at) = place(&end) else { return Ok(Seal::Missing) };
    let at = begins + at as u64;
    file.seek(SeekFrom::Start(0))?;
    let (mut hasher, mut stated) = (Hasher::new(), Vec::new());
    update(&mut hasher, &mut (&*file).take(at))?;
    (&*file).take(UNKNOWN.len() as u64).read_to_end(&mut stated)?;
    hasher.update(UNKNOWN.as_bytes());
    update(&mut hasher, file)?;
    Ok(if stated == digits(hasher).as_bytes() { Seal::Whole } else { Seal::Damaged })
}

fn update(hasher: &mut Hasher, from: &mut impl std::io::Read) -> Result<()> {
    let mut piece = vec![0; PIECE];
    loop {
        match from.read(&mut piece) {
            Ok(0) => return Ok(()),
            Ok(read) => hasher.update(&piece[..read]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// The footer of a Parquet file, and where it begins; `None` where the file does not end as one does.
fn end_of(file: &mut File, length: u64) -> Result<Option<(u64, Vec<u8>)>> {
    let mut tail = [0; 8];
    let Some(tail_at) = length.checked_sub(tail.len() as u64) else { return Ok(None) };
    file.seek(SeekFrom::Start(tail_at))?;
    file.read_exact(&mut tail)?;
    let [a, b, c, d, magic @ ..] = tail;
    let size = u64::from(u32::from_le_bytes([a, b, c, d]));
    let Some(begins) = tail_at.checked_sub(size).filter(|_| magic == MAGIC) else { return Ok(None) };
    file.seek(SeekFrom::Start(begins))?;
    let mut end = Vec::new();
    file.take(size).read_to_end(&mut end)?;
    if end.len() as u64 == size { Ok(Some((begins, end))) } else { Err(Error::from(ErrorKind::UnexpectedEof)) }
}

/// Where the digits stand: behind the last key, the type and the length of a value of eight bytes.
fn place(end: &[u8]) -> Option<usize> {
    let key = [CHECKSUM.as_bytes(), &[0x18, UNKNOWN.len() as u8]].concat();
    let at = end.windows(key.len() + UNKNOWN.len()).rposition(|bytes| bytes.starts_with(&key))?;
    Some(at + key.len())
}

fn digits(hasher: Hasher) -> String {
    format!("{:08x}", hasher.finalize())
}
