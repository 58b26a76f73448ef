//! Integration tests, one module per part of the library. They are one binary, because linking each
//! module by itself would take longer than running it. `cargo test --test it front::` runs one
//! module.

#[macro_use]
mod settings;

mod adaptive;
mod borders;
mod box_fit;
mod branches;
mod cases;
#[cfg(feature = "cli")]
mod cli;
#[cfg(feature = "cli")]
mod code;
mod combined;
mod components;
mod counts;
mod crease_box;
mod crease_mesh;
mod crease_quality;
mod creased;
mod curves;
mod differential;
mod docs;
mod door;
mod far;
mod faults;
mod fitted;
mod flow;
mod formula;
mod formula_forms;
mod formula_functions;
mod formula_properties;
mod front;
#[cfg(feature = "points")]
mod fuzz;
mod gallery;
mod golden;
mod graded;
mod grip;
mod holes;
mod jumps;
mod limits;
mod mesh;
mod mesh_export;
mod mesh_parity;
#[cfg(feature = "points")]
mod models;
mod near_sheets;
#[cfg(feature = "points")]
mod paper;
mod parity;
mod pasted;
mod periodic;
#[cfg(feature = "points")]
mod plain;
#[cfg(feature = "points")]
mod pointcloud;
#[cfg(feature = "points")]
mod pointcloud_formats;
#[cfg(feature = "points")]
mod pointcloud_job;
#[cfg(feature = "points")]
mod pointcloud_read;
#[cfg(feature = "points")]
mod points_border;
mod products;
mod proof;
mod quality;
#[cfg(feature = "points")]
mod random_solids;
#[cfg(feature = "points")]
mod rbf;
mod refine;
mod relax;
mod runs;
mod seams;
mod session;
mod shaders;
mod sharp;
mod sizing;
mod smooth;
mod solid_table;
mod solids;
#[cfg(feature = "cli")]
mod sweeps;
mod systems;
mod thickness;
#[cfg(feature = "cli")]
mod threads;
mod tips;
mod wrapped;
