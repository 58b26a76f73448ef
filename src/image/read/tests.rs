//! Readers, on the small files of `fuzz/seeds/image`, which numpy and the formats' own rules made.

use super::{ImageFormat, ImageReadError, MAX_IMAGE_BYTES, RawVoxels};
use crate::image::{Image, ImageChoice, ImageError, VoxelType};
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
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
    image.voxel(image.order.sorted(index.to_array().map(|i| i as usize)))
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
fn sizes_and_spacings_of_an_array_are_along_its_axes_in_either_order() {
    for name in ["npy-c", "npy-fortran"] {
        let image = read(seed(name)).expect("an image").with_spacing([1.0, 2.0, 3.0]).expect("spacings");
        assert_eq!((image.size(), image.placement().spacing()), ([4, 3, 3], [1.0, 2.0, 3.0]), "{name}");
        for index in [DVec3::ZERO, dvec3(3.0, 2.0, 2.0), dvec3(2.0, 1.0, 1.0)] {
            let place = index * dvec3(1.0, 2.0, 3.0);
            assert_eq!(image.placement().point(index), place, "{name}");
            assert_eq!(image.placement().index(place).round(), index, "{name}");
        }
        assert_eq!(value(&image, dvec3(2.0, 2.0, 3.0)), 100.0, "{name}");
        // What is made of it has the same axes.
        let field = image.surface(&ImageChoice { is_closed: true, ..ImageChoice::default() }, None);
        let field = field.expect("a surface");
        assert_eq!(field.image().size(), [4, 3, 3], "{name}");
        assert_eq!(field.field().image().placement().spacing(), [1.0, 2.0, 3.0], "{name}");
    }
    let not_finite = [&seed("npy-c")[..seed("npy-c").len() - 16], &[255; 8], &[0; 8]].concat();
    let error = read(not_finite).expect_err("refused");
    let first = [3, 2, 1];
    assert!(
        matches!(error, ImageReadError::Image(ImageError::NotFinite { count: 1, first: f }) if f == first),
        "{error}"
    );
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
        (b"II*\0 and so on".to_vec(), "cut off"),
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
    let garbled = b"ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_SHORT\nElementDataFile = a\0b.raw\n";
    let refused = Image::read("scan.mhd", garbled.to_vec(), |name| panic!("{name} is asked for"));
    let message = refused.expect_err("a name with a control character").to_string();
    assert!(message.contains("control characters") && !message.contains('\0'), "{message}");
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

/// A stack of TIFF pages with one strip each, whose bytes are given as they are in the file.
fn tiff(is_big: bool, entries: &[(u16, u16, u32)], description: &str, strips: &[Vec<u8>]) -> Vec<u8> {
    let mut out = if is_big { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
    let short = |n: u16| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let long = |n: u32| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let text_at = 16;
    let mut at = text_at + description.len() as u32 + 1;
    out.extend(long(at));
    // A half, as the resolution.
    out.extend([long(1), long(2)].concat());
    out.extend(description.bytes().chain([0]));
    for (k, strip) in strips.iter().enumerate() {
        let mut all = entries.to_vec();
        all.extend([(270, 2, 0), (273, 4, 0), (279, 4, strip.len() as u32), (282, 5, 0), (283, 5, 0)]);
        all.sort_unstable();
        let data_at = at + 2 + 12 * all.len() as u32 + 4;
        out.extend(short(all.len() as u16));
        for (tag, kind, value) in all {
            let (count, value) = match tag {
                270 => (description.len() as u32 + 1, text_at),
                273 => (1, data_at),
                282 | 283 => (1, 8),
                _ => (1, value),
            };
            out.extend([short(tag), short(kind)].concat());
            out.extend(long(count));
            match kind {
                3 => out.extend([short(value as u16), [0; 2]].concat()),
                _ => out.extend(long(value)),
            }
        }
        at = data_at + strip.len() as u32;
        out.extend(long(if k + 1 < strips.len() { at } else { 0 }));
        out.extend(strip);
    }
    out
}

/// A byte as a code of LZW each, with a clear code before more codes than nine bits have.
fn literal_lzw(bytes: &[u8]) -> Vec<u8> {
    let codes =
        bytes.chunks(200).flat_map(|chunk| [256].into_iter().chain(chunk.iter().map(|&b| u32::from(b))));
    packed_codes(&codes.chain([257]).map(|code| (code, 9)).collect::<Vec<_>>())
}

/// Codes of so many bits, the highest first.
fn packed_codes(codes: &[(u32, u32)]) -> Vec<u8> {
    let bits: Vec<u32> =
        codes.iter().flat_map(|&(code, n)| (0..n).rev().map(move |k| code >> k & 1)).collect();
    let byte = |bits: &[u32]| bits.iter().enumerate().fold(0, |sum, (k, bit)| sum | (*bit as u8) << (7 - k));
    bits.chunks(8).map(byte).collect()
}

#[test]
fn stacks_of_tiff_pictures_are_read_however_they_are_packed() {
    let (width, height) = (5_u32, 4_u32);
    let value = |i: u32, j: u32, k: u32| (1000 * k + 37 * j + 3 * i + 7) as u16;
    for (is_big, compression, predictor) in [
        (false, 1, 1),
        (true, 1, 1),
        (false, 5, 1),
        (true, 5, 2),
        (false, 8, 2),
        (false, 32773, 1),
        (true, 32773, 2),
    ] {
        let strips: Vec<Vec<u8>> = (0..3)
            .map(|k| {
                let rows = (0..height).map(|j| {
                    let row: Vec<u16> = (0..width).map(|i| value(i, j, k)).collect();
                    let before = |i: usize| if predictor == 2 && i > 0 { row[i - 1] } else { 0 };
                    (0..row.len()).map(|i| row[i].wrapping_sub(before(i))).collect::<Vec<u16>>()
                });
                let write = |n: u16| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
                let bytes: Vec<u8> = rows.flatten().flat_map(write).collect();
                match compression {
                    1 => bytes,
                    5 => literal_lzw(&bytes),
                    8 => {
                        let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
                        packed.write_all(&bytes).expect("written");
                        packed.finish().expect("packed")
                    }
                    // Two bytes as they are, two as one that is repeated, and a byte of no meaning.
                    _ => bytes
                        .chunks(2)
                        .flat_map(|pair| match *pair {
                            [a, b] if a == b => vec![255, a, 128],
                            [a, b] => vec![1, a, b],
                            _ => vec![0, pair[0]],
                        })
                        .collect(),
                }
            })
            .collect();
        let entries =
            [(256, 3, width), (257, 3, height), (258, 3, 16), (259, 3, compression), (317, 3, predictor)];
        let text = "ImageJ=1.53t\nimages=3\nslices=3\nspacing=0.75\n";
        let image = read(tiff(is_big, &entries, text, &strips)).expect("an image");
        assert_eq!((image.size(), image.voxel_type()), ([5, 4, 3], VoxelType::U16));
        assert_eq!(image.placement().spacing(), [2.0, 2.0, 0.75]);
        for (i, j, k) in (0..60).map(|at| (at % 5, at / 5 % 4, at / 20)) {
            let found = image.voxel([i, j, k].map(|n| n as usize));
            assert_eq!(found, f64::from(value(i, j, k)), "{is_big} {compression} {predictor}: {i} {j} {k}");
        }
    }
}

#[test]
fn codes_of_lzw_that_stand_for_texts_are_unpacked() {
    // The example of section 13 of TIFF 6.0: 7 7 7 8 8 7 7 6 6.
    let codes = [256, 7, 258, 8, 8, 258, 6, 6, 257].map(|code| (code, 9));
    let pixels = [7, 7, 7, 8, 8, 7, 7, 6, 6];
    let entries = [(256, 3, 3), (257, 3, 3), (258, 3, 8), (259, 3, 5)];
    let strips = vec![packed_codes(&codes); 2];
    let image = read(tiff(false, &entries, "", &strips)).expect("an image");
    for (at, wanted) in pixels.into_iter().enumerate() {
        assert_eq!(image.voxel([at % 3, at / 3, 1]), f64::from(wanted), "{at}");
    }
    // Codes become longer: two bytes by turns, each pair of which makes a code that is not used.
    let count = 1200;
    let mut codes = vec![(256, 9)];
    for k in 0..count {
        // After the code k the table has 258 + k − 1 texts.
        let made: u32 = 258 + k;
        codes.push((k % 2, (32 - made.leading_zeros()).max(9)));
    }
    let entries = [(256, 3, count), (257, 3, 1), (258, 3, 8), (259, 3, 5)];
    let strips = vec![packed_codes(&codes); 2];
    let error = read(tiff(false, &entries, "", &strips)).expect_err("one row");
    assert!(matches!(error, ImageReadError::Image(ImageError::Flat { size: [1200, 1, 2] })), "{error}");
}

#[test]
fn a_tiff_file_that_cannot_be_read_says_why() {
    let strip = vec![vec![3; 16]; 2];
    let with = |tag: u16, value: u32| {
        let usual = [(256, 4), (257, 4), (258, 8), (259, 1), (277, 1)];
        let entries = usual.into_iter().filter(|(own, _)| *own != tag).chain([(tag, value)]);
        entries.map(|(tag, value)| (tag, 3, value)).collect::<Vec<_>>()
    };
    for (tag, value, words) in [
        (258, 12, "12 bits"),
        (259, 7, "compression 7"),
        (257, 5, "20 bytes of voxels, and 16 follow"),
        (257, 0, "ImageLength"),
        (317, 3, "predictor 3"),
        (322, 16, "tiles"),
    ] {
        let error = read(tiff(false, &with(tag, value), "", &strip)).expect_err("refused").to_string();
        assert!(error.contains(words), "{error} does not name {words}");
    }
    let whole = tiff(false, &with(259, 1), "", &[vec![1; 16], vec![2; 16]]);
    assert!(read(whole.clone()).is_ok());
    for length in 5..whole.len() {
        assert!(!read(whole[..length].to_vec()).expect_err("cut off").to_string().is_empty());
    }
    // Pages in a circle.
    let mut circle = whole;
    let end = circle.len() - 16 - 4;
    circle.copy_within(4..8, end);
    assert!(read(circle).is_ok_and(|image| image.size()[2] == 1 << 16));
}

#[test]
fn voxels_without_a_header_are_read_as_they_are_said_to_be() {
    let numbers: Vec<u16> = (0..60).map(|k| 1000 + 7 * k).collect();
    let bytes: Vec<u8> = [9; 3].into_iter().chain(numbers.iter().flat_map(|n| n.to_be_bytes())).collect();
    let raw = RawVoxels { size: [5, 4, 3], voxel_type: VoxelType::U16, is_big_endian: true, skip: 3 };
    let image = Image::read_raw(bytes.clone(), &raw).expect("an image");
    for (at, wanted) in numbers.into_iter().enumerate() {
        assert_eq!(image.voxel([at % 5, at / 5 % 4, at / 20]), f64::from(wanted));
    }
    let error = Image::read_raw(bytes, &RawVoxels { skip: 4, ..raw }).expect_err("refused");
    assert!(matches!(error, ImageReadError::CutOff { needed: 120, found: 119, .. }), "{error}");
}
