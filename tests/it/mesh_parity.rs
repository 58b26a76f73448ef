//! Test that the same run gives the same mesh files on every platform. It compares what the native
//! core writes with the digests in `tests/golden/meshes.json`; `tests/wasm/parity.mjs` compares the
//! WebAssembly core, and a browser test what the page downloads, with the same file.
//!
//! A change that is meant to alter meshes or particles rewrites the file:
//! `UPDATE_GOLDEN=1 cargo test --test it mesh_parity::`.

use crate::golden;
use crate::runs::run;
use marching_particles::export::{MeshFormat, write_mesh};
use marching_particles::internal::session::{FieldRequest, FileRequest, Session};
use marching_particles::run::MeshAnswer;
use marching_particles::sampler::Settings;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Contents of the golden file.
#[derive(Serialize, Deserialize)]
struct Golden {
    runs: Vec<Run>,
}

/// A run with the digests of its files, by extension.
#[derive(Serialize, Deserialize)]
struct Run {
    name: String,
    field: serde_json::Value,
    settings: serde_json::Value,
    files: BTreeMap<String, String>,
}

/// A finished session and its mesh, joined with `budget` slices a call.
fn joined(case: &Run, budget: u32) -> (Session, MeshAnswer) {
    let mut session = Session::new();
    let field: FieldRequest = serde_json::from_value(case.field.clone()).expect("a field request");
    session.set_field(&field).expect("a field");
    let settings: Settings = serde_json::from_value(case.settings.clone()).expect("settings");
    run(&mut session, &settings);
    loop {
        if let Some(answer) = session.run.join(budget) {
            return (session, answer);
        }
    }
}

/// Some slices of writing the mesh of a session as a file, without a record.
fn slice(session: &mut Session, extension: &str, budget: u32) -> Option<Vec<u8>> {
    let format = extension.to_owned();
    let request = FileRequest { plain: true, format, ..FileRequest::default() };
    session
        .mesh_file(&request, |_| panic!("a plain file has no record"), budget)
        .map(|file| file.expect("a file of less than 4 GiB"))
}

/// The mesh of a session as a file, written with `budget` slices a call.
fn written(session: &mut Session, extension: &str, budget: u32) -> Vec<u8> {
    loop {
        assert_eq!(slice(session, extension, 0), None, "no slices are no work");
        if let Some(bytes) = slice(session, extension, budget) {
            return bytes;
        }
    }
}

fn golden() -> Golden {
    golden::read("meshes.json")
}

#[test]
fn mesh_files_have_the_digests_that_other_platforms_give() {
    let mut golden = golden();
    assert!(golden.runs.len() >= 2);
    let mut faults = Vec::new();
    for case in &mut golden.runs {
        let (mut session, _) = joined(case, u32::MAX);
        let files: BTreeMap<String, String> = MeshFormat::ALL
            .iter()
            .map(|&(extension, _)| {
                let bytes = written(&mut session, extension, u32::MAX);
                assert!(bytes.len() > 10_000, "{}, {extension}: {} bytes", case.name, bytes.len());
                (extension.to_owned(), golden::digest(&bytes))
            })
            .collect();
        golden::compare(&case.name, &mut case.files, files, &mut faults);
    }
    golden::finish("meshes.json", &golden, &faults, "mesh_parity");
}

#[test]
fn a_file_written_slice_by_slice_is_the_one_written_at_once() {
    let (mut session, _) = joined(&golden().runs[0], u32::MAX);
    for (extension, format) in MeshFormat::ALL {
        let whole = written(&mut session, extension, u32::MAX);
        let first = slice(&mut session, extension, 1);
        let is_whole = matches!(format, MeshFormat::Glb | MeshFormat::ThreeMf);
        assert_eq!(first.is_some(), is_whole, "{extension}: one slice is not all of it");
        assert!(written(&mut session, extension, 1) == whole, "{extension}");
        let mut direct = Vec::new();
        let (run, file) = (&session.run, format.into());
        write_mesh(&file, run.particles(), run.measured(), run.mesh().expect("a mesh"), &mut direct)
            .expect("writing to memory does not fail");
        assert!(direct == whole, "{extension}");
    }
    // Another format begins anew.
    assert!(slice(&mut session, "obj", 1).is_none());
    let ply = written(&mut session, "ply", 1);
    assert!(ply.starts_with(b"ply"));
    assert!(written(&mut session, "obj", 2).starts_with(b"# Marching Particles"));
}

#[test]
fn a_mesh_joined_slice_by_slice_is_the_one_joined_at_once() {
    for case in golden().runs {
        let ((whole, told), (sliced, same)) = (joined(&case, u32::MAX), joined(&case, 1));
        assert_eq!(told, same, "{}", case.name);
        assert_eq!(whole.run.triangles(), sliced.run.triangles(), "{}", case.name);
        assert_eq!(told.triangles, whole.run.triangles().len());
    }
}

#[test]
fn a_mesh_tells_its_topology_and_where_it_is_open() {
    let [ellipsoid, gyroid] = &golden().runs[..] else { panic!("two runs") };
    let (_, answer) = joined(ellipsoid, u32::MAX);
    let [sphere] = answer.components[..] else { panic!("{answer:?}") };
    assert_eq!((sphere.euler, sphere.open_edges, answer.unfilled, answer.left_out), (2, 0, 0, 0));
    let (_, answer) = joined(gyroid, u32::MAX);
    assert!(answer.components.iter().any(|component| component.open_edges > 100), "{answer:?}");
}

#[test]
fn a_mesh_is_dropped_when_the_particles_change() {
    let case = &golden().runs[0];
    let (mut session, _) = joined(case, u32::MAX);
    assert!(!session.run.triangles().is_empty());
    assert!(session.run.relax(1));
    assert!(session.run.triangles().is_empty());
    while session.run.step(1_000).stop_reason.is_none() {}
    assert!(session.run.join(1).is_none(), "one slice is not all of it");
    // A step comes between: the work is given up and begun anew.
    session.run.step(1);
    assert!(session.run.join(u32::MAX).is_some());
    let settings: Settings = serde_json::from_value(case.settings.clone()).expect("settings");
    session.start(&settings).expect("valid settings");
    assert!(session.run.triangles().is_empty());
    let nothing = session.run.join(u32::MAX).expect("of no particles");
    assert_eq!((nothing.triangles, nothing.components.len()), (0, 0));
}
