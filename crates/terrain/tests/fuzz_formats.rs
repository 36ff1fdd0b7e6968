//! A bounded fuzz run of the map formats: files of each are cut, overwritten and lengthened, byte by byte. Nothing may
//! panic or ask for more memory than the file gives reason for. The seed of a failure is printed with it.

use terrain::format::{FileFormat, ImportOptions, read_raster};

const ROUNDS: u64 = 3000;

const FILES: [&[u8]; 15] = [
    include_bytes!("fixtures/pillow-rgba8.png"),
    include_bytes!("fixtures/pillow-gray16.png"),
    include_bytes!("fixtures/tifffile-int32-tiled-degrees.tiff"),
    include_bytes!("fixtures/pillow-gray8-lzw.tiff"),
    include_bytes!("fixtures/tifffile-float32-deflate-geo.tiff"),
    b"P5 3 2 255\n\x00\x10\x20\x30\x40\xff",
    b"P2\n# by hand\n2 2\n9\n0 9 4 5\n",
    b"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n1 2 3\n4 -9999 6\n",
    b"type octile\nheight 3\nwidth 4\nmap\n.G@T\nS.OW\n....\n",
    b"PDS_VERSION_ID = PDS3\r\nRECORD_BYTES = 128\r\n^IMAGE = 2\r\nLINES = 1\r\nLINE_SAMPLES = 2\r\nSAMPLE_TYPE = PC_REAL\r\nSAMPLE_BITS = 32\r\nMISSING_CONSTANT = 16#FF7FFFFB#\r\nEND\r\n12345678",
    b"PDS_VERSION_ID = PDS3\r\nRECORD_BYTES = 256\r\n^IMAGE = 2\r\nLINES = 1\r\nLINE_SAMPLES = 2\r\nSAMPLE_TYPE = MSB_INTEGER\r\nSAMPLE_BITS = 16\r\nSCALING_FACTOR = 0.5<METER>\r\nOFFSET = -1\r\nUNIT = KILOMETER\r\nMAP_RESOLUTION = 4 <PIXEL/DEGREE>\r\nA_AXIS_RADIUS = 1737.4<KM>\r\nEND\r\n      0123",
    // Heights of which 0 is white, with GDAL's metadata and a mask of one bit a cell.
    b"II*\0\x0e\0\0\0\x05\x06\0\0\x80\0\
        \x09\0\xfe\0\x04\0\x01\0\0\0\0\0\0\0\0\x01\x03\0\x01\0\0\0\x01\0\0\0\
        \x01\x01\x03\0\x01\0\0\0\x02\0\0\0\x02\x01\x03\0\x01\0\0\0\x08\0\0\0\
        \x06\x01\x03\0\x01\0\0\0\0\0\0\0\x11\x01\x04\0\x01\0\0\0\x08\0\0\0\
        \x17\x01\x04\0\x01\0\0\0\x02\0\0\0\x80\xa4\x02\0\x04\0\0\0<It\0\
        \x81\xa4\x02\0\x02\0\0\x006\0\0\0\x80\0\0\0\
        \x07\0\xfe\0\x04\0\x01\0\0\0\x04\0\0\0\0\x01\x03\0\x01\0\0\0\x01\0\0\0\
        \x01\x01\x03\0\x01\0\0\0\x02\0\0\0\x02\x01\x03\0\x01\0\0\0\x01\0\0\0\
        \x06\x01\x03\0\x01\0\0\0\x04\0\0\0\x11\x01\x04\0\x01\0\0\0\x0b\0\0\0\
        \x17\x01\x04\0\x01\0\0\0\x02\0\0\0\0\0\0\0",
    b"Object = IsisCube\n  Object = Core\n    StartByte = 65537\n",
    b"<?xml version=\"1.0\"?>\n<Product_Observational xmlns=\"http://pds.nasa.gov/pds4/pds/v1\">",
    b"",
];

/// What breaks readers of numbers and of lengths.
const PIECES: [&[u8]; 10] = [
    b"999999999",
    b"4294967295",
    b"-1",
    b"1e308",
    b"nan",
    b"\x00\x00\x00\x00",
    b"\xff\xff\xff\xff",
    b"\x7f\xff\xff\xff",
    b"16#",
    b" ",
];

fn next(state: &mut u64, limit: usize) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 16) as usize % limit.max(1)
}

fn mutated(seed: u64) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut bytes = FILES[next(&mut state, FILES.len())].to_vec();
    for _ in 0..=next(&mut state, 6) {
        // Headers are where lengths are.
        let reach = if next(&mut state, 2) == 0 { bytes.len().min(120) } else { bytes.len() };
        let at = next(&mut state, reach + 1).min(bytes.len());
        let piece = PIECES[next(&mut state, PIECES.len())];
        match next(&mut state, 5) {
            0 => bytes.truncate(at),
            1 => {
                bytes.splice(at..at, piece.iter().copied());
            }
            2 => {
                let end = (at + piece.len()).min(bytes.len());
                bytes.splice(at..end, piece.iter().copied());
            }
            3 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << next(&mut state, 8);
                }
            }
            _ => {
                let end = (at + next(&mut state, 30)).min(bytes.len());
                bytes.drain(at..end);
            }
        }
    }
    bytes
}

#[test]
fn the_files_are_what_they_are_meant_to_be() {
    let refused: Vec<usize> = (0..FILES.len())
        .filter(|&index| read_raster(FILES[index], &ImportOptions::default()).is_err())
        .collect();
    // The ISIS cube, the PDS4 label and the empty file.
    assert_eq!(refused, [12, 13, 14]);
}

#[test]
fn no_map_panics_or_grows_without_reason() {
    for seed in 1..=ROUNDS {
        let bytes = mutated(seed);
        let outcome = std::panic::catch_unwind(|| {
            let _ = FileFormat::detect(&bytes);
            read_raster(&bytes, &ImportOptions::default())
        });
        let Ok(read) = outcome else { panic!("seed {seed}: {:?}", bytes.escape_ascii().to_string()) };
        if let Ok(raster) = read {
            let size = raster.width as usize * raster.height as usize;
            assert_eq!(raster.samples.len(), size, "seed {seed}");
        }
    }
}
