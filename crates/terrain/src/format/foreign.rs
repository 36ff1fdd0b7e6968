//! Map files of formats that are not read: recognized, so that their refusal can say what to do.

use super::FormatError;

/// How far into a file its kind is looked for.
const REACH: usize = 4096;

const CONVERT: &str = "write it as GeoTIFF, as with `gdal_translate IN OUT.tif`";

/// Beginnings of files, white space before them left out, and what they are.
const BEGINNINGS: [(&[u8], &str, &str); 18] = [
    (b"Object = IsisCube", "ISIS cube", CONVERT),
    (b"CCSD3ZF", "PDS3 file in an SFDU envelope (as ISIS 2 cubes are)", CONVERT),
    (b"LBLSIZE=", "VICAR image", CONVERT),
    (b"\x89HDF\r\n\x1a\n", "HDF5 or NetCDF file", CONVERT),
    (b"CDF\x01", "NetCDF file", CONVERT),
    (b"CDF\x02", "NetCDF file", CONVERT),
    (b"SIMPLE  =", "FITS image", CONVERT),
    (b"EHFA_HEADER_TAG", "ERDAS Imagine image", CONVERT),
    (b"UHL1", "DTED map", CONVERT),
    (b"DSAA", "Surfer grid", CONVERT),
    (b"DSBB", "Surfer grid", CONVERT),
    (b"DSRB", "Surfer grid", CONVERT),
    (b"\0\0\0\x0cjP  ", "JPEG 2000 image", CONVERT),
    (b"\xff\xd8\xff", "JPEG image", "JPEG compression changes heights; save the map as PNG or GeoTIFF"),
    (b"<VRTDataset", "GDAL VRT file", CONVERT),
    (b"LASF", "LAS point cloud", "convert it to a grid, as with `pdal` and its `writers.gdal`"),
    (b"PK\x03\x04", "ZIP archive", "unpack it and open the map inside"),
    (b"\x1f\x8b", "gzip archive", "unpack it and open the map inside"),
];

/// Returns why a file of a known format that is not read is refused; `None` for all others.
pub fn refusal(bytes: &[u8]) -> Option<FormatError> {
    let start = &bytes[..bytes.len().min(REACH)];
    let text = start.trim_ascii_start();
    let unsupported = |format, advice: &str| FormatError::Unsupported { format, problem: advice.to_owned() };
    let begins = |beginning: &[u8]| {
        start.starts_with(beginning)
            || text.get(..beginning.len()).is_some_and(|it| it.eq_ignore_ascii_case(beginning))
    };
    if let Some((_, format, advice)) = BEGINNINGS.iter().find(|(beginning, ..)| begins(beginning)) {
        return Some(unsupported(*format, advice));
    }
    let is_pds4 = [&b"<?xml"[..], b"\xef\xbb\xbf<?xml", b"<Product_"].iter().any(|it| begins(it))
        && ["pds.nasa.gov/pds4", "<Product_Observational"]
            .iter()
            .any(|word| start.windows(word.len()).any(|window| window == word.as_bytes()));
    is_pds4.then(|| {
        unsupported("PDS4 label", "write its image as GeoTIFF, as with `gdal_translate LABEL.xml OUT.tif`")
    })
}
