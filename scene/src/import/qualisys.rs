//! Qualisys' calibrations (.qca.txt or XML) are recognised and refused. Programs that read them disagree about the order of
//! the rotation matrix, the unit of the distortion and the axes of the camera, and Qualisys does not publish them.

use crate::failure::Failure;
use std::path::Path;

/// The end of the files' names, in lower case. Some are .xml.
pub const END: &str = ".qca.txt";

/// Refuses a file of this format.
pub fn refuse(path: &Path, text: &str) -> Result<(), Failure> {
    if text.contains("<calibration") && text.contains("focalLengthU") {
        return Err(Failure::Input(format!(
            "{}: is a calibration of Qualisys, which is not read, because its convention is not published: convert it to \
             TOML with Pose2Sim, check its views, and import that with --from anipose",
            path.display()
        )));
    }
    Ok(())
}
