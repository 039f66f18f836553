//! Gzip in parallel, as ONE member: OVITO reads the first member of a file only.
//!
//! Chunks are compressed side by side into raw deflate blocks that end on a byte (sync flush), put
//! in a row and closed by an empty last block; the checksum is combined from those of the chunks.

use crc32fast::Hasher;
use flate2::{Compress, Compression, FlushCompress};
use rayon::prelude::*;

const LEVEL: u32 = 3;

/// Bytes that one thread compresses at a time.
const CHUNK: usize = 1 << 20;

/// Magic number, deflate, no flags, no time, no extra flags, unknown system.
const HEADER: [u8; 10] = [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255];

/// A last block without data.
const LAST_BLOCK: [u8; 2] = [3, 0];

/// The gzip member of `text`.
pub fn compress(text: &[u8]) -> Vec<u8> {
    let parts: Vec<(Vec<u8>, Hasher)> = text
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut hasher = Hasher::new();
            hasher.update(chunk);
            (deflate(chunk), hasher)
        })
        .collect();
    let mut checksum = Hasher::new();
    let mut member = HEADER.to_vec();
    for (blocks, hasher) in &parts {
        member.extend_from_slice(blocks);
        checksum.combine(hasher);
    }
    member.extend_from_slice(&LAST_BLOCK);
    member.extend_from_slice(&checksum.finalize().to_le_bytes());
    member.extend_from_slice(&(text.len() as u32).to_le_bytes());
    member
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
    fn the_first_member_is_everything_whatever_the_length() {
        for length in [0, 1, 1000, CHUNK, CHUNK + 1, 3 * CHUNK + 17] {
            let text: Vec<u8> = (0..length).map(|i| b"0123456789 .-\n"[(i * i / 7) % 14]).collect();
            let (found, rest) = first_member(&compress(&text));
            assert!(found == text && rest == 0, "length {length}");
        }
    }

    #[test]
    fn a_damaged_member_is_noticed() {
        let mut bytes = compress(b"the quick brown fox");
        let place = bytes.len() - 6;
        bytes[place] ^= 1;
        assert!(GzDecoder::new(&bytes[..]).read_to_end(&mut Vec::new()).is_err());
    }
}
