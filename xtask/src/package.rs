//! The npm package: built, packed and tested, not published.

use anyhow::Result;

use crate::bundle::{self, Bundle, Declarations, Purpose};
use crate::node;
use crate::project::Project;

/// The bundles in the package: all but the lesson's.
const BUNDLES: [Bundle; 4] = [Bundle::Core, Bundle::Points, Bundle::Webgpu, Bundle::Webgl];

/// Packs the package with the site's bundles into `target/package`, and runs its tests in Node,
/// which pack and install it themselves.
pub(crate) fn package(project: &Project) -> Result<()> {
    node::prepare(project)?;
    bundle::build(project, &BUNDLES, Purpose::Site, Declarations::Hold)?;
    node::script(project, "package: files and tarball", "package", &[])?;
    node::script(project, "package: tests in Node", "package:test", &[])?;
    println!("  packed target/package/marching-particles.tgz");
    Ok(())
}
