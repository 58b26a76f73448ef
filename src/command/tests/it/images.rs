//! Surfaces in three-dimensional images.

use crate::cli::{fails, file, run, sample, stdout};
use std::fs;
use std::path::PathBuf;

/// Writes an array as NumPy would, the first axis fastest.
fn npy(name: &str, size: [usize; 3], descr: &str, voxels: &[u8]) -> PathBuf {
    npy_in_order("True", name, size, descr, voxels)
}

fn npy_in_order(is_fortran: &str, name: &str, size: [usize; 3], descr: &str, voxels: &[u8]) -> PathBuf {
    let [x, y, z] = size;
    let header = format!("{{'descr': '{descr}', 'fortran_order': {is_fortran}, 'shape': ({x}, {y}, {z}), }}");
    let mut header = header.into_bytes();
    header.resize(117, b' ');
    header.push(b'\n');
    let length = (header.len() as u16).to_le_bytes();
    let bytes = [b"\x93NUMPY\x01\x00".as_slice(), &length, &header, voxels].concat();
    let path = file(name);
    fs::write(&path, bytes).expect("written");
    path
}

/// The distance of each voxel of a cube from its middle.
fn distances(side: usize) -> impl Iterator<Item = f64> {
    let off = move |at: usize| (at % side) as f64 - 0.5 * (side - 1) as f64;
    (0..side * side * side)
        .map(move |at| (off(at).powi(2) + off(at / side).powi(2) + off(at / side / side).powi(2)).sqrt())
}

fn ball(name: &str) -> String {
    let voxels: Vec<u8> = distances(24).flat_map(|d| ((8.0 - d) * 100.0).to_le_bytes()).collect();
    npy(name, [24; 3], "<f8", &voxels).display().to_string()
}

#[test]
fn an_image_is_sampled_at_the_value_that_is_said() {
    let path = ball("ball.npy");
    let mesh = file("ball.stl").display().to_string();
    let run = sample(&["--image", &path, "--iso", "0", "--smooth", "0", "--count", "800", "--mesh", &mesh]);
    assert_eq!((&run["image"]["iso"], &run["image"]["is_otsu"]), (&0.0.into(), &false.into()));
    assert_eq!(run["search"], "proven");
    assert_eq!((&run["mesh"]["euler"], &run["mesh"]["borders"]), (&2.into(), &0.into()));
    let volume = run["mesh"]["volume"].as_f64().expect("a closed mesh");
    let exact = 4.0 / 3.0 * std::f64::consts::PI * 512.0;
    assert!((volume / exact - 1.0).abs() < 0.02, "{volume} {exact}");
}

#[test]
fn a_surface_that_the_border_cuts_is_closed_if_that_is_said() {
    let side = 20;
    let off = |at: usize| (at % side) as f64 - 9.4;
    let rod = (0..side * side * side).map(|at| 6.0 - (off(at).powi(2) + off(at / side).powi(2)).sqrt());
    let voxels: Vec<u8> = rod.flat_map(f64::to_le_bytes).collect();
    let path = npy("rod.npy", [side; 3], "<f8", &voxels).display().to_string();
    let mesh = file("rod.stl").display().to_string();
    let given = ["--image", &path, "--iso", "0", "--smooth", "0", "--count", "800", "--mesh", &mesh];
    let open = sample(&given);
    assert_eq!((&open["mesh"]["borders"], &open["image"]["is_closed"]), (&2.into(), &false.into()));
    let closed = sample(&[given.as_slice(), &["--close-border"]].concat());
    assert_eq!((&closed["mesh"]["borders"], &closed["mesh"]["euler"]), (&0.into(), &2.into()));
    // Half a voxel longer at both ends.
    let volume = closed["mesh"]["volume"].as_f64().expect("a closed mesh");
    let exact = std::f64::consts::PI * 36.0 * 20.0;
    assert!((volume / exact - 1.0).abs() < 0.03, "{volume} {exact}");
}

#[test]
fn the_report_says_how_the_value_was_chosen() {
    let path = ball("chosen.npy");
    let text = stdout(&run(&["sample", "--image", &path, "--count", "500"]));
    assert!(text.starts_with("image: chosen.npy\n24 × 24 × 24 voxels of 1 × 1 × 1, float64"), "{text}");
    assert!(text.contains("(Otsu's; --iso sets another), brighter voxels inside"), "{text}");
}

#[test]
fn labels_are_listed_and_sampled() {
    let voxels: Vec<u8> = distances(24).map(|d| u8::from(d < 8.0) * 5).collect();
    let path = npy("labels.npy", [24; 3], "|u1", &voxels).display().to_string();
    let run = sample(&["--image", &path, "--label", "5", "--count", "800"]);
    assert_eq!((&run["image"]["label"], &run["quality"]["euler"]), (&5.0.into(), &2.into()));
    let text = stdout(&crate::cli::run(&["sample", "--image", &path, "--count", "500", "--report", "none"]));
    assert!(text.contains("--label takes one: 0 (") && text.contains("5 ("), "{text}");
    let message = fails(2, &["sample", "--image", &path, "--label", "4"]);
    assert!(message.contains("those of the image are 0, 5"), "{message}");
}

#[test]
fn distances_between_voxels_are_along_x_y_and_z_in_either_order_of_the_array() {
    let size = [30, 24, 9];
    let value = |i: usize, j: usize, k: usize| {
        let [x, y, z] = [i as f64 - 14.2, j as f64 - 11.3, 3.0 * (k as f64 - 4.1)];
        8.0 - (x * x + y * y + z * z).sqrt()
    };
    let count: usize = size.iter().product();
    let fortran = (0..count).map(|at| value(at % 30, at / 30 % 24, at / 720));
    let c = (0..count).map(|at| value(at / 216, at / 9 % 24, at % 9));
    let mut middles = Vec::new();
    for (order, voxels) in [("True", fortran.collect::<Vec<f64>>()), ("False", c.collect())] {
        let bytes: Vec<u8> = voxels.into_iter().flat_map(f64::to_le_bytes).collect();
        let path = npy_in_order(order, &format!("ball-{order}.npy"), size, "<f8", &bytes);
        let (path, mesh) = (path.display().to_string(), file("spaced.stl").display().to_string());
        let given = ["--image", &path, "--iso", "0", "--smooth", "0", "--voxel-size", "1x1x3"];
        let run = sample(&[&given[..], &["--count", "800", "--mesh", &mesh]].concat());
        assert_eq!(run["image"]["size"], serde_json::json!(size), "{order}");
        assert_eq!(run["image"]["spacing"], serde_json::json!([1.0, 1.0, 3.0]), "{order}");
        // A ball, and no ellipsoid.
        let volume = run["mesh"]["volume"].as_f64().expect("a closed mesh");
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 512.0;
        assert!((volume / exact - 1.0).abs() < 0.03, "{order}: {volume} {exact}");
        middles.push(run["mesh"]["size"].clone());
    }
    for size in middles {
        let lengths: Vec<f64> = serde_json::from_value(size).expect("three lengths");
        assert!(lengths.iter().all(|length| (length - 16.0).abs() < 0.4), "{lengths:?}");
    }
}

#[test]
fn images_that_cannot_be_sampled_are_refused() {
    let path = ball("refused.npy");
    assert!(fails(2, &["sample", "--image", &path, "--iso", "1e9"]).contains("choose one between them"));
    assert!(fails(1, &["sample", "--image", "no such file"]).contains("no such file"));
    fails(2, &["sample", "--image", &path, "--formula", "x"]);
    fails(2, &["sample", "--iso", "1"]);
    let cut = file("cut.npy");
    fs::write(&cut, &fs::read(&path).expect("read")[..5_000]).expect("written");
    assert!(fails(2, &["sample", "--image", &cut.display().to_string()]).contains("cut off"));
}

#[test]
fn voxels_without_a_header_are_what_the_option_says() {
    let path = ball("with-header.npy");
    let surface = ["--iso", "0", "--count", "500", "--voxel-size", "0.5x0.5x2"];
    let digest = |args: &[&str]| sample(&[args, &surface].concat())["digest"].clone();
    let wanted = digest(&["--image", &path]);
    // The voxels alone, with their bytes in the other order, behind seven others.
    let voxels = fs::read(&path).expect("read")[128..].to_vec();
    let swapped = voxels.chunks(8).flat_map(|bytes| bytes.iter().rev()).copied();
    let raw = file("ball.raw");
    fs::write(&raw, [0; 7].into_iter().chain(swapped).collect::<Vec<u8>>()).expect("written");
    let raw = raw.display().to_string();
    assert_eq!(digest(&["--image", &raw, "--raw", "24x24x24,float64,big,skip=7"]), wanted);
    for (form, words) in [
        ("24x24,uint8", "x, y and z come first"),
        ("24x24x24,short", "one of uint8"),
        ("24x24x24,uint8,skip=x", "number of bytes"),
        ("24x24x24,uint8,middle", "neither big"),
    ] {
        assert!(fails(2, &["sample", "--image", &raw, "--raw", form]).contains(words), "{form}");
    }
    assert!(fails(2, &["sample", "--image", &raw, "--raw", "24x24x25,float64"]).contains("cut off"));
    assert!(fails(2, &["sample", "--image", &raw, "--voxel-size", "1x0x1"]).contains("above 0"));
}
