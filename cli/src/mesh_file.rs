//! The file of a frame's mesh: its format, and the form of the mesh in it.

use crate::{
    arguments::{Format, Reconstruct},
    warning::WarningReport,
};
use pcmvs_core::{
    FormParams, Frame, Progress, Result, Rig, TextureParams,
    export::{bounds, glb, ply},
};
use pcmvs_scene::{
    Failure, Scene, Threads,
    compress::{self, Meshopt},
};

/// A frame's file.
pub struct Made {
    pub bytes: Vec<u8>,
    /// Smallest and largest coordinates of its mesh in the scene's frame; `None` without a mesh.
    pub bounds: Option<[[f64; 3]; 2]>,
    pub warning: Option<WarningReport>,
}

/// How meshes are written.
#[derive(Debug, Clone)]
pub struct MeshFile {
    format: Format,
    form: FormParams,
    options: glb::Options,
    compress: bool,
}

impl MeshFile {
    /// What the arguments ask for.
    pub fn new(arguments: &Reconstruct, scene: &Scene) -> std::result::Result<Self, Failure> {
        let refused = |problem: String| Err(Failure::Input(problem));
        let asked = [
            (arguments.faces.is_some(), "--faces"),
            (arguments.texture.is_some(), "--texture"),
            (arguments.compress, "--compress"),
            (arguments.upright, "--upright"),
        ];
        if let Some((_, name)) = asked.iter().find(|(is_asked, _)| *is_asked && arguments.format == Format::Ply) {
            return refused(format!("{name} is for GLB files: leave out --format ply"));
        }
        if arguments.upright && scene.up.is_none() {
            let path = scene.path.display();
            return refused(format!(
                "{path}: `up` is missing, which --upright needs: add the upward direction, such as [0, 0, 1]"
            ));
        }
        let texture = arguments.texture.map(|size| TextureParams { size });
        let options = glb::Options {
            // The material is unlit, so that only hosts that light the mesh themselves need normals.
            normals: !arguments.compress,
            up: scene.up,
            upright: arguments.upright,
            compact: arguments.compress,
            ..glb::Options::default()
        };
        Ok(Self {
            format: arguments.format,
            form: FormParams { faces: arguments.faces, texture },
            options,
            compress: arguments.compress,
        })
    }

    /// The ending of the file's name.
    pub fn extension(&self) -> &'static str {
        self.format.extension()
    }

    /// The upward direction in the files' frame.
    pub fn up(&self) -> Option<[f64; 3]> {
        self.options.up_in_file()
    }

    /// The rotation that turns the scene's frame to that of the files.
    pub fn rotation(&self) -> Option<[f64; 4]> {
        self.options.rotation()
    }

    /// The file of a finished frame.
    pub fn make(&self, frame: &Frame<&Rig>, index: u32, threads: &Threads, progress: &dyn Progress) -> Result<Made> {
        let origin = frame.rig().origin();
        let is_plain = self.form == FormParams::default() && !self.compress;
        if self.format == Format::Ply || is_plain {
            let bytes = match self.format {
                Format::Ply => ply::write_mesh(frame.mesh(), origin),
                Format::Glb => glb::write(frame.mesh(), origin, &self.options),
            };
            return Ok(Made { bytes, bounds: bounds(frame.mesh(), origin), warning: None });
        }
        let mut form = frame.form(&self.form, threads, progress)?;
        if self.compress {
            form = compress::sort(form);
        }
        let compress = self.compress.then_some(&Meshopt as &dyn glb::Compress);
        Ok(Made {
            bytes: glb::write_form(&form, origin, &self.options, compress),
            bounds: bounds(&form.mesh, origin),
            warning: self.too_many_faces(index, form.mesh.triangles.len()),
        })
    }

    fn too_many_faces(&self, index: u32, made: usize) -> Option<WarningReport> {
        let asked = self.form.faces.filter(|&asked| made > asked as usize)?;
        Some(WarningReport {
            code: "too-many-faces".to_owned(),
            frame: Some(index),
            camera: None,
            message: format!(
                "frame {index}: {made} triangles remain instead of {asked}, because fewer would change the surface visibly: \
                 ask for more, or take this file as it is"
            ),
        })
    }
}
