//! Blosc 1 chunks, the container that OpenVDB's leaves are compressed with.
//!
//! A chunk is a header of 16 bytes (version, inner version, flags, type size, size, block size, compressed size), a
//! table of block offsets, and blocks; a block is one stream, or one for each byte of the type ("split"), each with
//! its length before it. After decompression the bytes of a block are un-shuffled. Source: c-blosc
//! `README_CHUNK_FORMAT.rst` and `blosc.c` (`blosc_d`), `blosclz.c`.
//! Ours because the C library would bring C into the build, and because the header is data: offsets, lengths and sizes
//! are checked here before use. Inner codecs: blosclz, lz4, zlib, zstd. Limits: snappy and bit shuffle, which OpenVDB
//! never writes, are errors by name.
//! Tested on chunks made by c-blosc (`tests.rs`) and under damage.

use super::cursor::{Cursor, Fault};

const HEADER_SIZE: usize = 16;
const SHUFFLE: u8 = 0x01;
const STORED: u8 = 0x02;
const BIT_SHUFFLE: u8 = 0x04;
const NOT_SPLIT: u8 = 0x10;
/// Types of at most this many bytes are split, in blocks of at least `MIN_SPLIT` values.
const MAX_SPLITS: usize = 16;
const MIN_SPLIT: usize = 128;

/// Decompresses the chunk that starts at `offset` of the file into all of `out`.
pub(super) fn decompress(chunk: &[u8], offset: u64, out: &mut [u8]) -> Result<(), Fault> {
    let mut header = Cursor::new(chunk, offset);
    let [version, _, flags, type_size] = header.array()?;
    let [size, block_size, compressed_size] =
        [header.u32()?, header.u32()?, header.u32()?].map(|v| v as usize);
    if version != 2 {
        return Err(Fault::unsupported(offset, format!("blosc chunk of format {version}, known is 2")));
    }
    if size != out.len() {
        return Err(Fault::invalid(
            offset,
            format!("blosc chunk of {size} bytes where {} belong", out.len()),
        ));
    }
    if size == 0 {
        return Ok(());
    }
    if compressed_size > chunk.len() || block_size == 0 || block_size > size || type_size == 0 {
        return Err(Fault::invalid(
            offset,
            format!(
                "blosc header: {compressed_size} of {} bytes, blocks of {block_size}, type of {type_size}",
                chunk.len()
            ),
        ));
    }
    if flags & STORED != 0 {
        out.copy_from_slice(header.take(size)?);
        return Ok(());
    }
    if flags & BIT_SHUFFLE != 0 {
        return Err(Fault::unsupported(offset, "blosc bit shuffle; save the file again with OpenVDB"));
    }
    let codec = Codec::from_flags(flags, offset)?;
    let type_size = usize::from(type_size);
    let shuffled = flags & SHUFFLE != 0 && type_size > 1;
    let mut scratch = vec![0; if shuffled { block_size } else { 0 }];
    for block in out.chunks_mut(block_size) {
        let start = header.u32()? as usize;
        if start < HEADER_SIZE || start > compressed_size {
            return Err(Fault::invalid(
                header.offset(),
                format!("blosc block at {start} of {compressed_size} bytes"),
            ));
        }
        let mut source = Cursor::new(&chunk[start..compressed_size], offset + start as u64);
        let is_whole = block.len() == block_size;
        let split = flags & NOT_SPLIT == 0
            && type_size <= MAX_SPLITS
            && block_size / type_size >= MIN_SPLIT
            && is_whole;
        let n_splits = if split { type_size } else { 1 };
        if block.len() % n_splits != 0 {
            return Err(Fault::invalid(
                source.offset(),
                format!("blosc block of {} bytes in {n_splits} parts", block.len()),
            ));
        }
        let n_block = block.len();
        let target = if shuffled { &mut scratch[..n_block] } else { &mut *block };
        for part in target.chunks_mut(n_block / n_splits) {
            let n_bytes = source.u32()? as usize;
            let at = source.offset();
            let bytes = source.take(n_bytes)?;
            if n_bytes == part.len() {
                part.copy_from_slice(bytes);
            } else {
                codec.decompress(bytes, part).map_err(|what| Fault::invalid(at, what))?;
            }
        }
        if shuffled {
            unshuffle(&scratch[..n_block], type_size, block);
        }
    }
    Ok(())
}

/// The first bytes of all values stand first, then all second ones; what is no whole value stays at the end.
fn unshuffle(from: &[u8], type_size: usize, to: &mut [u8]) {
    let n_values = from.len() / type_size;
    let n_whole = n_values * type_size;
    for (i, value) in to[..n_whole].chunks_exact_mut(type_size).enumerate() {
        for (j, byte) in value.iter_mut().enumerate() {
            *byte = from[j * n_values + i];
        }
    }
    to[n_whole..].copy_from_slice(&from[n_whole..]);
}

#[derive(Clone, Copy)]
enum Codec {
    BloscLz,
    Lz4,
    Zlib,
    Zstd,
}

impl Codec {
    fn from_flags(flags: u8, offset: u64) -> Result<Self, Fault> {
        match flags >> 5 {
            0 => Ok(Self::BloscLz),
            1 => Ok(Self::Lz4),
            3 => Ok(Self::Zlib),
            4 => Ok(Self::Zstd),
            2 => Err(Fault::unsupported(offset, "blosc with snappy; save the file again with OpenVDB")),
            other => Err(Fault::unsupported(
                offset,
                format!("blosc codec {other}; known are blosclz, lz4, zlib, zstd"),
            )),
        }
    }

    fn decompress(self, bytes: &[u8], out: &mut [u8]) -> Result<(), String> {
        match self {
            Self::BloscLz => blosclz(bytes, out).ok_or_else(|| "damaged blosclz stream".into()),
            Self::Lz4 => lz4(bytes, out),
            Self::Zlib => zlib(bytes, out),
            Self::Zstd => zstd(bytes, out),
        }
    }
}

fn whole(codec: &str, n_bytes: usize, wanted: usize) -> Result<(), String> {
    if n_bytes == wanted {
        Ok(())
    } else {
        Err(format!("{codec} stream of {n_bytes} bytes where {wanted} belong"))
    }
}

fn lz4(bytes: &[u8], out: &mut [u8]) -> Result<(), String> {
    let n_bytes =
        lz4_flex::block::decompress_into(bytes, out).map_err(|err| format!("damaged lz4 stream: {err}"))?;
    whole("lz4", n_bytes, out.len())
}

/// A zlib stream (RFC 1950) that fills `out`, its checksum included.
pub(super) fn zlib(bytes: &[u8], out: &mut [u8]) -> Result<(), String> {
    let mut state = flate2::Decompress::new(true);
    let status = state
        .decompress(bytes, out, flate2::FlushDecompress::Finish)
        .map_err(|err| format!("damaged zlib stream: {err}"))?;
    whole("zlib", state.total_out() as usize, out.len())?;
    if status == flate2::Status::StreamEnd {
        Ok(())
    } else {
        Err("damaged zlib stream: it does not end".into())
    }
}

fn zstd(bytes: &[u8], out: &mut [u8]) -> Result<(), String> {
    use std::io::Read;
    check_zstd_window(bytes, out.len())
        .ok_or("zstd stream whose header asks for more memory than its content")?;
    let damaged = |err: &dyn std::fmt::Display| format!("damaged zstd stream: {err}");
    let mut decoder = ruzstd::decoding::FrameDecoder::new();
    let mut input = bytes;
    let mut at = 0;
    decoder.init(&mut input).map_err(|err| damaged(&err))?;
    while !decoder.is_finished() {
        let some = ruzstd::decoding::BlockDecodingStrategy::UptoBytes(1 << 20);
        decoder.decode_blocks(&mut input, some).map_err(|err| damaged(&err))?;
        at += decoder.read(&mut out[at..]).map_err(|err| damaged(&err))?;
        if decoder.can_collect() != 0 {
            return Err(damaged(&"it is too long"));
        }
    }
    whole("zstd", at, out.len())
}

/// The decoder allocates the window that the frame's header asks for; `None` if that is out of proportion.
/// Header (RFC 8878, 3.1.1): magic, descriptor, window unless the content is one segment, dictionary, content size.
fn check_zstd_window(bytes: &[u8], n_bytes: usize) -> Option<()> {
    let descriptor = *bytes.get(4)?;
    if descriptor & 0x20 == 0 {
        let window_log = 10 + (bytes.get(5)? >> 3);
        return (window_log <= 20 || 1_u64 << window_log <= 4 * n_bytes as u64).then_some(());
    }
    let start = 5 + [0, 1, 2, 4][usize::from(descriptor & 3)];
    let size_bytes = bytes.get(start..start + (1 << (descriptor >> 6)))?;
    let size = size_bytes.iter().rev().fold(0_u64, |size, &byte| size << 8 | u64::from(byte));
    // A field of two bytes counts from 256.
    let size = if size_bytes.len() == 2 { size + 256 } else { size };
    (size == n_bytes as u64).then_some(())
}

/// Blosc's own member of the FastLZ family; `None` if the stream is damaged or does not fill `out`.
fn blosclz(bytes: &[u8], out: &mut [u8]) -> Option<()> {
    const MAX_NEAR: usize = 8191;
    let mut input = bytes.iter().map(|&byte| usize::from(byte));
    let mut control = input.next()? & 31;
    let mut at = 0;
    loop {
        if control < 32 {
            for _ in 0..=control {
                *out.get_mut(at)? = input.next()? as u8;
                at += 1;
            }
        } else {
            let mut length = (control >> 5) + 2;
            if length == 9 {
                loop {
                    let more = input.next()?;
                    length += more;
                    if more != 255 {
                        break;
                    }
                }
            }
            let low = input.next()?;
            let high = (control & 31) << 8;
            let mut distance = high + low + 1;
            if low == 255 && high == 31 << 8 {
                distance = (input.next()? << 8) + input.next()? + MAX_NEAR + 1;
            }
            if distance > at || length > out.len() - at {
                return None;
            }
            for _ in 0..length {
                out[at] = out[at - distance];
                at += 1;
            }
        }
        match input.next() {
            Some(next) => control = next,
            None => return (at == out.len()).then_some(()),
        }
    }
}
