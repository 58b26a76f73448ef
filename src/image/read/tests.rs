//! Readers, on the small files of `fuzz/seeds/image`, which numpy and the formats' own rules made.

use super::{ImageFormat, ImageReadError, MAX_IMAGE_BYTES};
use crate::image::{Image, ImageError, VoxelType};
use flate2::Compression;
use flate2::write::GzEncoder;
use glam::{DVec3, dvec3};
use std::fs;
use std::io::Write;
use std::path::Path;

fn seed(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/image").join(name);
    fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn read(bytes: Vec<u8>) -> Result<Image, ImageReadError> {
    Image::read("scan.hdr", bytes, |name| Err(format!("there is no {name}")))
}

/// The value at the indices of the array that the files were made from, whatever the order of axes.
fn value(image: &Image, place: DVec3) -> f64 {
    let index = image.placement().index(place).round();
    image.voxel(index.to_array().map(|i| i as usize))
}

#[test]
fn every_format_gives_the_voxels_and_their_places() {
    // The array is 0 but for (1, 1, 1) and (2, 1, 1), 100, (0, 0, 0), 7, and (3, 2, 2), −5.
    let affine = |i: DVec3| dvec3(1.0 - 0.5 * i.x, 2.0 + 0.5 * i.y + 0.1 * i.z, 3.0 + 2.0 * i.z);
    let nrrd = |i: DVec3| dvec3(1.0 + 0.5 * i.x, 2.0 + 0.5 * i.y + 0.1 * i.z, 3.0 + 2.0 * i.z);
    let spaced = |i: DVec3| i * dvec3(1.0, 1.0, 2.0);
    let meta = |i: DVec3| dvec3(1.0 + 0.5 * i.x, 2.0 - 1.5 * i.z, 3.0 + 0.5 * i.y);
    let cube = |i: DVec3| i * 0.5 - 1.0;
    let indices = |i: DVec3| i;
    type Map<'a> = &'a dyn Fn(DVec3) -> DVec3;
    let files: [(&str, VoxelType, Map, [f64; 3]); 12] = [
        ("nifti-1-little", VoxelType::I16, &affine, [190.0, 4.0, -20.0]),
        ("nifti-1-big", VoxelType::I16, &affine, [190.0, 4.0, -20.0]),
        ("nifti-gzip", VoxelType::I16, &affine, [190.0, 4.0, -20.0]),
        ("nrrd-raw", VoxelType::I16, &nrrd, [100.0, 7.0, -5.0]),
        ("nrrd-gzip", VoxelType::I16, &nrrd, [100.0, 7.0, -5.0]),
        ("nrrd-vector", VoxelType::I16, &spaced, [100.0, 7.0, -5.0]),
        ("npy-c", VoxelType::F64, &indices, [100.0, 7.0, -5.0]),
        ("npy-fortran", VoxelType::U16, &indices, [100.0, 7.0, 65531.0]),
        ("npy-channels", VoxelType::I16, &indices, [100.0, 7.0, -5.0]),
        ("mha", VoxelType::I16, &meta, [100.0, 7.0, -5.0]),
        ("mha-zlib", VoxelType::I16, &meta, [100.0, 7.0, -5.0]),
        ("cube", VoxelType::F32, &cube, [100.0, 7.0, -5.0]),
    ];
    for (name, voxel_type, map, [middle, first, last]) in files {
        let image = read(seed(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(image.voxel_type(), voxel_type, "{name}");
        let mut size = image.size();
        size.sort_unstable();
        assert_eq!(size, [3, 3, 4], "{name}");
        for (at, wanted) in [
            (dvec3(1.0, 1.0, 1.0), middle),
            (dvec3(2.0, 1.0, 1.0), middle),
            (DVec3::ZERO, first),
            (dvec3(3.0, 2.0, 2.0), last),
        ] {
            let place = map(at);
            let index = image.placement().index(place);
            assert!((index - index.round()).abs().max_element() < 1e-5, "{name}: {at} is at {index}");
            assert_eq!(value(&image, place), wanted, "{name}: {at}");
        }
        let has_note = matches!(name, "nrrd-vector" | "npy-channels");
        assert_eq!(!image.notes().is_empty(), has_note, "{name}: {:?}", image.notes());
    }
}

#[test]
fn the_quaternion_of_a_nifti_header_turns_and_flips() {
    // Half the angle has the sine 0.1, and the first number of pixdim turns the third axis.
    let image = read(seed("nifti-2")).expect("an image");
    let angle = 2.0 * libm::asin(0.1_f32.into());
    let [x, y, z] = image.placement().directions();
    assert!((x - dvec3(libm::cos(angle), libm::sin(angle), 0.0)).length() < 1e-7, "{x}");
    assert!((y - dvec3(-libm::sin(angle), libm::cos(angle), 0.0)).length() < 1e-7, "{y}");
    assert!((z + DVec3::Z).length() < 1e-7, "{z}");
    assert_eq!(image.placement().origin(), dvec3(1.0, 2.0, 3.0));
    assert!((DVec3::from_array(image.placement().spacing()) - dvec3(0.5, 0.5, 2.0)).length() < 1e-12);
}

#[test]
fn a_file_that_is_cut_off_is_refused() {
    for name in
        ["nifti-1-big", "nifti-2", "nifti-gzip", "nrrd-raw", "nrrd-gzip", "npy-c", "mha", "mha-zlib", "cube"]
    {
        let bytes = seed(name);
        // The last line feed of a text is not missed, nor are the digits of its last number, and
        // the end mark and the check sum of compressed data.
        let spared = match name {
            // The last number may have lost digits.
            "cube" => {
                1 + bytes.trim_ascii_end().rsplit(u8::is_ascii_whitespace).next().map_or(0, <[u8]>::len)
            }
            "nifti-gzip" | "nrrd-gzip" | "mha-zlib" => 12,
            _ => 0,
        };
        for length in 0..bytes.len() - spared {
            let error = read(bytes[..length].to_vec()).expect_err(&format!("{name} cut at {length}"));
            assert!(!error.to_string().is_empty());
        }
    }
}

/// A seed with a text in its header replaced.
fn changed(name: &str, from: &str, to: &str) -> Vec<u8> {
    let bytes = seed(name);
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect("the text");
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

#[test]
fn what_is_wrong_is_named() {
    let message = |bytes: Vec<u8>| read(bytes).expect_err("refused").to_string();
    for (bytes, words) in [
        (Vec::new(), "empty"),
        (b"hello, world".to_vec(), "no known kind"),
        (b"II*\0 and so on".to_vec(), "TIFF"),
        (changed("nrrd-raw", "int16", "int99"), "type"),
        (changed("nrrd-raw", "encoding: raw", "encoding: hex"), "`hex`"),
        (changed("nrrd-raw", "sizes: 4 3 3", "sizes: 4 3 300"), "cut off"),
        (changed("nrrd-raw", "sizes: 4 3 3", "sizes: 40000000 3000000 3000000"), "MB"),
        (changed("nrrd-raw", "(0.5,0,0)", "(0,0.5,0)"), "lie in a plane"),
        (changed("nrrd-raw", "sizes: 4 3 3", "sizes: 4 3 0"), "two or more"),
        (changed("mha", "DimSize = 4 3 3", "DimSize = 4 9"), "2 axes"),
        (changed("mha", "MET_SHORT", "MET_OTHER"), "line 10, ElementType"),
        (changed("mha", "= LOCAL", "= a.raw"), "there is no a.raw"),
        (changed("npy-c", "'<f8'", "'<c8'"), "astype"),
        (changed("cube", "1.00000E+02", "1.00000X+02"), "1.00000X+02"),
    ] {
        let found = message(bytes);
        assert!(found.contains(words), "{found} does not name {words}");
    }
    let nan = [&seed("npy-c")[..seed("npy-c").len() - 8], &f64::NAN.to_le_bytes()].concat();
    let error = read(nan).expect_err("refused");
    assert!(matches!(error, ImageReadError::Image(ImageError::NotFinite { count: 1, .. })), "{error}");
}

#[test]
fn a_gzip_bomb_is_not_unpacked() {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(&seed("nifti-1-little")).expect("written");
    // A gigabyte behind the 36 voxels.
    let zeros = vec![0; 1 << 20];
    (0..1 << 10).for_each(|_| packed.write_all(&zeros).expect("written"));
    let image = read(packed.finish().expect("packed")).expect("an image");
    assert!(image.bytes() < 1 << 20, "{}", image.bytes());
}

#[test]
fn a_header_names_the_file_beside_it() {
    let mut bytes = seed("nifti-1-little");
    let voxels = bytes.split_off(352);
    bytes[344..347].copy_from_slice(b"ni1");
    // The voxels begin with the file beside.
    bytes[108..112].copy_from_slice(&0.0_f32.to_le_bytes());
    let image = Image::read("scan.hdr", bytes.clone(), |name| {
        if name == "scan.img" { Ok(voxels.clone()) } else { Err("no".to_owned()) }
    });
    assert_eq!(image.expect("an image").range(), [-20.0, 190.0]);
    let missing = read(bytes).expect_err("refused");
    assert!(matches!(missing, ImageReadError::Beside { format: ImageFormat::Nifti, .. }), "{missing}");
}

#[test]
fn what_is_too_large_is_refused_before_memory_is_taken() {
    let mut bytes = seed("nifti-1-little");
    for axis in 1..=3 {
        bytes[40 + 2 * axis..42 + 2 * axis].copy_from_slice(&i16::MAX.to_le_bytes());
    }
    let error = read(bytes).expect_err("refused");
    assert!(matches!(error, ImageReadError::TooLarge { bytes } if bytes > MAX_IMAGE_BYTES), "{error}");
}
