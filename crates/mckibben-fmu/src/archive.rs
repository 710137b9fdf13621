//! A ZIP file of deflated entries, which every reader takes.
//!
//! Source: PKWARE, APPNOTE.TXT 6.3.10, sections 4.3.7, 4.3.12 and 4.3.16; RFC 1951 by the crate `flate2`.

use flate2::Compression;
use flate2::write::DeflateEncoder;
use std::io::Write as _;

/// The version that a reader needs: 2.0, for folders.
const NEEDED: u16 = 20;
/// Written on Unix by that version, so that permissions are read.
const MADE_BY: u16 = (3 << 8) | NEEDED;
/// Names are UTF-8.
const FLAGS: u16 = 1 << 11;
/// Entries are deflated.
const METHOD: u16 = 8;
/// The first of January 1980: archives of equal files are equal.
const DATE: u16 = (1 << 5) | 1;
/// Permissions of a plain file that all may read and run, in Unix's attributes.
const MODE: u32 = 0o100_755 << 16;

/// An archive under way.
#[derive(Clone, Debug, Default)]
pub struct Archive {
    bytes: Vec<u8>,
    directory: Vec<u8>,
    count: u16,
}

impl Archive {
    /// Adds a file; `name` has slashes between folders.
    ///
    /// # Errors
    /// Says why when a file, or all of them together, are beyond 4 GiB or 65535 files.
    pub fn add(&mut self, name: &str, content: &[u8]) -> Result<(), &'static str> {
        let too_large = "a unit of more than 4 GiB cannot be written";
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
        let packed = encoder.write_all(content).and_then(|()| encoder.finish()).map_err(|_| too_large)?;
        let [size, packed_size, offset] =
            [content.len(), packed.len(), self.bytes.len()].map(|count| u32::try_from(count).ok());
        let (Some(size), Some(packed_size), Some(offset), Ok(length)) =
            (size, packed_size, offset, u16::try_from(name.len()))
        else {
            return Err(too_large);
        };
        let sum = crc32fast::hash(content);
        let mut common = Vec::new();
        let mut short = |numbers: &[u16]| numbers.iter().for_each(|number| common.extend(number.to_le_bytes()));
        short(&[NEEDED, FLAGS, METHOD, 0, DATE]);
        for number in [sum, packed_size, size] {
            common.extend(number.to_le_bytes());
        }
        common.extend(length.to_le_bytes());
        common.extend(0_u16.to_le_bytes());
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&common);
        self.bytes.extend(name.as_bytes());
        self.bytes.extend(&packed);
        self.directory.extend(b"PK\x01\x02");
        self.directory.extend(MADE_BY.to_le_bytes());
        self.directory.extend(&common);
        // No comment, the first disk, binary.
        self.directory.extend([0; 6]);
        self.directory.extend(MODE.to_le_bytes());
        self.directory.extend(offset.to_le_bytes());
        self.directory.extend(name.as_bytes());
        self.count = self.count.checked_add(1).ok_or(too_large)?;
        Ok(())
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// Says why when it is beyond 4 GiB.
    pub fn finish(mut self) -> Result<Vec<u8>, &'static str> {
        let too_large = "a unit of more than 4 GiB cannot be written";
        let offset = u32::try_from(self.bytes.len()).map_err(|_| too_large)?;
        let size = u32::try_from(self.directory.len()).map_err(|_| too_large)?;
        self.bytes.extend(&self.directory);
        self.bytes.extend(b"PK\x05\x06\0\0\0\0");
        for number in [self.count, self.count] {
            self.bytes.extend(number.to_le_bytes());
        }
        for number in [size, offset] {
            self.bytes.extend(number.to_le_bytes());
        }
        self.bytes.extend([0; 2]);
        Ok(self.bytes)
    }
}
