//! Gzip in parallel, as ONE member: OVITO reads the first member of a file only.
//!
//! Pieces are compressed side by side into raw deflate blocks that end on a byte (sync flush), put
//! in a row and closed by an empty last block; the checksum is combined from those of the pieces.

use super::joint::Joint;
use crc32fast::Hasher;
use flate2::{Compress, Compression, FlushCompress};

const LEVEL: u32 = 3;

/// Magic number, deflate, no flags, no time, no extra flags, unknown system.
const HEADER: [u8; 10] = [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255];

/// A last block without data.
const LAST_BLOCK: [u8; 2] = [3, 0];

/// Compressed text.
pub struct Piece {
    blocks: Vec<u8>,
    checksum: Hasher,
}

impl Piece {
    /// Compresses a text.
    pub fn of(text: &[u8]) -> Self {
        let mut checksum = Hasher::new();
        checksum.update(text);
        Self { blocks: deflate(text), checksum }
    }
}

/// Writes the gzip member of a text of the first process and the pieces of all.
pub fn write(file: &mut Joint<'_>, first: &[u8], pieces: Vec<Piece>) {
    let mut own = Hasher::new();
    pieces.iter().for_each(|piece| own.combine(&piece.checksum));
    let sums = file.ranks().share(&[own.total_len() as f64, f64::from(own.finalize())]);
    let Piece { blocks, mut checksum } = Piece::of(first);
    for [length, sum] in sums.as_chunks::<2>().0 {
        checksum.combine(&Hasher::new_with_initial_len(*sum as u32, *length as u64));
    }
    file.put(&HEADER);
    file.put(&blocks);
    file.put_all(&pieces.into_iter().map(|piece| piece.blocks).collect::<Vec<_>>());
    let length = checksum.total_len() as u32;
    file.put(&LAST_BLOCK);
    file.put(&checksum.finalize().to_le_bytes());
    file.put(&length.to_le_bytes());
}

/// Raw deflate blocks that end on a byte boundary.
fn deflate(chunk: &[u8]) -> Vec<u8> {
    let mut compressor = Compress::new(Compression::new(LEVEL), false);
    let mut blocks = Vec::with_capacity(chunk.len() / 2 + 64);
    loop {
        let done = compressor.total_in() as usize;
        let room = blocks.capacity() - blocks.len();
        // The only errors of the compressor are wrong calls: a finished stream, no dictionary.
        let status = compressor.compress_vec(&chunk[done..], &mut blocks, FlushCompress::Sync);
        let all_in = compressor.total_in() as usize == chunk.len();
        if status.is_err() || (all_in && blocks.len() < blocks.capacity()) {
            return blocks;
        }
        blocks.reserve(room.max(64));
    }
}

#[cfg(test)]
mod tests {
    use super::super::lammps::tests::bytes;
    use super::*;
    use flate2::read::GzDecoder;
    use std::io::Read;

    fn first_member(bytes: &[u8]) -> (Vec<u8>, usize) {
        let mut rest = bytes;
        let mut text = Vec::new();
        let mut decoder = flate2::bufread::GzDecoder::new(&mut rest);
        decoder.read_to_end(&mut text).unwrap();
        (text, rest.len())
    }

    #[test]
    fn the_first_member_is_everything_whatever_the_lengths() {
        for lengths in [&[][..], &[0], &[1, 1000], &[1 << 20, 0, 3 << 20, 17]] {
            let letter = |i: usize| b"0123456789 .-\n"[(i * i / 7) % 14];
            let texts: Vec<Vec<u8>> =
                lengths.iter().map(|length| (0..*length).map(letter).collect()).collect();
            let pieces = texts.iter().map(|text| Piece::of(text)).collect();
            let (found, rest) = first_member(&bytes(|file| write(file, b"first", pieces)));
            assert!(found == [b"first".to_vec(), texts.concat()].concat() && rest == 0);
        }
    }

    #[test]
    fn a_damaged_member_is_noticed() {
        let mut bytes = bytes(|file| write(file, b"the quick brown fox", Vec::new()));
        let place = bytes.len() - 6;
        bytes[place] ^= 1;
        assert!(GzDecoder::new(&bytes[..]).read_to_end(&mut Vec::new()).is_err());
    }
}
