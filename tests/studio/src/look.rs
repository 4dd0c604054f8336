//! A contact sheet of a result: photograph, shape and colours side by side, seen by the same camera.

mod texture;

use crate::picture::Picture;
use glam::{DVec2, DVec3};
use pcmvs_core::Camera;
use pcmvs_scene::{Disk, Scene};
use std::{error::Error, path::Path};
use texture::Texture;

const BACKGROUND: DVec3 = DVec3::ONE;
/// Colour of the shaded surface.
const CLAY: DVec3 = DVec3::new(0.75, 0.82, 0.95);
/// Margin around the subject in pixels.
const MARGIN: u32 = 10;

/// A coloured mesh, read from a GLB.
#[derive(Debug, Clone, Default)]
pub struct ColouredMesh {
    /// In the frame and unit of the scene.
    pub positions: Vec<DVec3>,
    /// Unit normals, one per vertex.
    pub normals: Vec<DVec3>,
    /// Linear light in 0..1, one per vertex. Empty if there is a texture.
    pub colours: Vec<DVec3>,
    /// Places in the texture in 0..1 from its upper left corner on, one per vertex. Empty if there is none.
    pub uvs: Vec<DVec2>,
    /// Its picture.
    pub texture: Option<Texture>,
    /// Counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl ColouredMesh {
    /// Reads a GLB whose only mesh has normals, and colours of its vertices or a texture. Rotations of nodes are left out.
    ///
    /// # Errors
    /// The file cannot be read, or normals or colours are missing.
    pub fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&std::fs::read(path)?)?;
        let primitive = document.meshes().next().and_then(|m| m.primitives().next()).ok_or("there is no mesh")?;
        let reader = primitive.reader(|_| blob.as_deref());
        let vectors = |list: Vec<[f32; 3]>| list.into_iter().map(|v| DVec3::from(v.map(f64::from))).collect::<Vec<_>>();
        let texture = Texture::of(&primitive, blob.as_deref().unwrap_or_default())?;
        let uvs =
            reader.read_tex_coords(0).map(|uvs| uvs.into_f32().map(|uv| DVec2::from(uv.map(f64::from))).collect());
        if texture.is_some() && uvs.is_none() {
            return Err("there are no texture coordinates".into());
        }
        let colours = match reader.read_colors(0) {
            Some(colours) => vectors(colours.into_rgb_f32().collect()),
            None if texture.is_some() => Vec::new(),
            None => return Err("there are no colours".into()),
        };
        let indices: Vec<u32> = reader.read_indices().ok_or("there are no faces")?.into_u32().collect();
        Ok(Self {
            positions: vectors(reader.read_positions().ok_or("there are no positions")?.collect()),
            normals: vectors(reader.read_normals().ok_or("there are no normals")?.collect()),
            colours,
            uvs: uvs.unwrap_or_default(),
            texture,
            faces: indices.as_chunks().0.to_vec(),
        })
    }

    /// Linear light at a place of a face, and at the places of the pixels to the right and below.
    fn colour(&self, corners: [usize; 3], shares: [[f64; 3]; 3]) -> DVec3 {
        let Some(texture) = &self.texture else {
            return (0..3).map(|k| self.colours[corners[k]] * shares[0][k]).sum();
        };
        let [here, right, below] = shares.map(|share| (0..3).map(|k| self.uvs[corners[k]] * share[k]).sum::<DVec2>());
        texture.sample(here, [right - here, below - here])
    }
}

/// A mesh as a camera sees it, on a white background.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// Shaded with light from the camera and from above.
    pub shape: Picture,
    /// In its own colours, which are interpolated in linear light, as glTF requires. Textures likewise.
    pub colours: Picture,
    /// Whether the mesh covers each pixel.
    pub covered: Vec<bool>,
}

/// Draws the mesh as a camera sees it, with one sample at the centre of each pixel.
pub fn draw(mesh: &ColouredMesh, camera: &Camera) -> Drawing {
    let (w, h) = (camera.width as usize, camera.height as usize);
    let centre = camera.centre();
    let up = -DVec3::from_array(camera.r[1]);
    let shade = |i: usize| {
        let light = ((centre - mesh.positions[i]).normalize() + 0.6 * up).normalize();
        CLAY * (0.15 + 0.85 * mesh.normals[i].dot(light).max(0.0))
    };
    let shades: Vec<DVec3> = (0..mesh.positions.len()).map(shade).collect();
    let pixels: Vec<Option<(DVec2, f64)>> = mesh.positions.iter().map(|&p| camera.project(p)).collect();
    let mut nearest = vec![f64::INFINITY; w * h];
    let mut layers = [vec![BACKGROUND; w * h], vec![BACKGROUND; w * h]];
    for face in &mesh.faces {
        let corners = face.map(|i| i as usize);
        let [Some((a, za)), Some((b, zb)), Some((c, zc))] = corners.map(|i| pixels[i]) else { continue };
        let area = (b - a).perp_dot(c - a);
        // With y down a face that is counter-clockwise seen from the camera has negative area.
        if area >= 0.0 {
            continue;
        }
        let (low, high) = (a.min(b).min(c).ceil(), a.max(b).max(c).floor());
        let span = |low: f64, high: f64, n: usize| low.max(0.0) as usize..(high + 1.0).clamp(0.0, n as f64) as usize;
        for y in span(low.y, high.y, h) {
            for x in span(low.x, high.x, w) {
                let p = DVec2::new(x as f64, y as f64);
                // Barycentric coordinates, first in the image, then (by inverse depth) on the surface.
                let flat = |p: DVec2| {
                    [(c - b).perp_dot(p - b) / area, (a - c).perp_dot(p - c) / area, (b - a).perp_dot(p - a) / area]
                };
                let surface = |p: DVec2| {
                    let [a, b, c] = flat(p);
                    let share = [a / za, b / zb, c / zc];
                    let depth = 1.0 / (share[0] + share[1] + share[2]);
                    (share.map(|s| s * depth), depth)
                };
                if flat(p).iter().any(|&s| s < 0.0) {
                    continue;
                }
                let (share, depth) = surface(p);
                if depth < nearest[y * w + x] {
                    nearest[y * w + x] = depth;
                    layers[0][y * w + x] = (0..3).map(|k| shades[corners[k]] * share[k]).sum();
                    layers[1][y * w + x] =
                        mesh.colour(corners, [share, surface(p + DVec2::X).0, surface(p + DVec2::Y).0]);
                }
            }
        }
    }
    let picture = |layer: &[DVec3], code: fn(f64) -> f64| Picture {
        width: camera.width,
        height: camera.height,
        rgb: layer.iter().flat_map(|c| c.to_array().map(|v| (code(v.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)).collect(),
    };
    Drawing {
        shape: picture(&layers[0], |v| v),
        colours: picture(&layers[1], srgb),
        covered: nearest.iter().map(|depth| depth.is_finite()).collect(),
    }
}

/// IEC 61966-2-1: linear light to sRGB, both in 0..1.
fn srgb(v: f64) -> f64 {
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055 }
}

/// The contact sheet of a frame: photograph, shape and colours for each camera, cropped around the mesh.
///
/// # Errors
/// A file cannot be read, or there is no such frame or camera.
pub fn sheet(scene: &Path, frame: u32, mesh: &ColouredMesh, cameras: &[usize]) -> Result<Picture, Box<dyn Error>> {
    let scene = Scene::load(&Disk, scene).map_err(|e| e.to_string())?;
    let entry = scene.frames.iter().find(|f| f.index == frame).ok_or("there is no such frame")?;
    let mut panels = Vec::new();
    for &i in cameras {
        let camera = scene.cameras.get(i).ok_or("there is no such camera")?.camera()?;
        let path = entry.image(i).ok_or("this camera has no picture in this frame")?;
        let photograph = image::open(scene.resolve(path))?.into_rgb8();
        let (width, height) = photograph.dimensions();
        let drawn = draw(mesh, &camera);
        let part = part_with_mesh(&drawn, &camera);
        let photograph = Picture { width, height, rgb: photograph.into_raw() };
        panels.extend([&photograph, &drawn.shape, &drawn.colours].map(|picture| cut(picture, part)));
    }
    Ok(side_by_side(&panels))
}

/// Left, top, right and bottom (exclusive) of the mesh, with a margin.
fn part_with_mesh(drawing: &Drawing, camera: &Camera) -> [u32; 4] {
    let (w, h) = (camera.width, camera.height);
    let mut part = [w, h, 0, 0];
    for (i, &covered) in drawing.covered.iter().enumerate() {
        let (x, y) = (i as u32 % w, i as u32 / w);
        if covered {
            part = [part[0].min(x), part[1].min(y), part[2].max(x + 1), part[3].max(y + 1)];
        }
    }
    if part[0] >= part[2] {
        return [0, 0, w, h];
    }
    let [left, top, right, bottom] = part;
    [left.saturating_sub(MARGIN), top.saturating_sub(MARGIN), (right + MARGIN).min(w), (bottom + MARGIN).min(h)]
}

fn cut(picture: &Picture, [left, top, right, bottom]: [u32; 4]) -> Picture {
    let row = |y: u32| {
        let at = |x: u32| (y * picture.width + x) as usize * 3;
        picture.rgb[at(left)..at(right)].iter().copied()
    };
    Picture { width: right - left, height: bottom - top, rgb: (top..bottom).flat_map(row).collect() }
}

fn side_by_side(panels: &[Picture]) -> Picture {
    let height = panels.iter().map(|p| p.height).max().unwrap_or(0);
    let width = panels.iter().map(|p| p.width).sum();
    let mut rgb = Vec::with_capacity((width * height) as usize * 3);
    for y in 0..height {
        for p in panels {
            let row = p.width as usize * 3;
            match p.rgb.chunks_exact(row).nth(y as usize) {
                Some(pixels) => rgb.extend(pixels),
                None => rgb.extend(std::iter::repeat_n(255, row)),
            }
        }
    }
    Picture { width, height, rgb }
}
