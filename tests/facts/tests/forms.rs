//! Forms of a finished frame: the same surface, with a texture that shows what the photographs show.

use facts::Shot;
use glam::Vec3;
use pcmvs_core::{
    Error, ErrorCode, Form, FormParams, Frame, Memory, Mesh, Params, Preset, Progress, Rig, Serial, Silent, Stage,
    TextureParams, View,
};
use std::{
    collections::BTreeMap,
    sync::atomic::{AtomicU32, Ordering},
};
use studio::{Subject, topology};

fn finished<'a>(rig: &'a Rig, shot: &Shot) -> Frame<&'a Rig> {
    let mut frame = Frame::new(rig, Params::preset(Preset::Hull), Memory::default());
    frame.run_all(&shot.inputs(), &Serial, &Silent).expect("the capture is sound");
    frame
}

fn textured(size: Option<u32>) -> FormParams {
    FormParams { texture: Some(TextureParams { size }), ..FormParams::default() }
}

/// The mesh with vertices at the same position taken as one.
fn welded(mesh: &Mesh) -> Mesh {
    let mut places = BTreeMap::new();
    let mut out = Mesh::default();
    let mut of = Vec::new();
    for (p, &normal) in mesh.positions.iter().zip(&mesh.normals) {
        of.push(*places.entry(p.to_array().map(f32::to_bits)).or_insert_with(|| {
            out.positions.push(*p);
            out.normals.push(normal);
            out.positions.len() as u32 - 1
        }));
    }
    out.triangles = mesh.triangles.iter().map(|t| t.map(|v: u32| of[v as usize])).collect();
    out
}

/// The texture's colour at a corner of a triangle or in its middle.
fn colour(form: &Form, triangle: [u32; 3], weights: [f32; 3]) -> Vec3 {
    let texture = form.texture.as_ref().expect("a texture");
    let uv = |k: usize| glam::Vec2::from(texture.uvs[triangle[k] as usize]);
    let at = (uv(0) * weights[0] + uv(1) * weights[1] + uv(2) * weights[2]) * texture.size as f32 - 0.5;
    let texel = |x: u32, y: u32| {
        let i = ((y * texture.size + x) * 3) as usize;
        Vec3::from_array([0, 1, 2].map(|k| f32::from(texture.texels[i + k])))
    };
    let (x, y) = (at.x as u32, at.y as u32);
    let (fx, fy) = (at.x - x as f32, at.y - y as f32);
    texel(x, y).lerp(texel(x + 1, y), fx).lerp(texel(x, y + 1).lerp(texel(x + 1, y + 1), fx), fy)
}

#[test]
fn a_texture_keeps_the_surface_and_shows_the_photographs() {
    let shot = Shot::small(Subject::Sphere, 12);
    let rig = shot.rig();
    let frame = finished(&rig, &shot);
    let form = frame.form(&textured(None), &Serial, &Silent).expect("a texture");
    let texture = form.texture.as_ref().expect("it was asked for");

    let surface = welded(&form.mesh);
    topology::assert_manifold(&surface, "the textured mesh");
    assert_eq!(surface.positions.len(), frame.mesh().positions.len());
    assert_eq!(surface.triangles.len(), frame.mesh().triangles.len());
    assert_eq!((form.mesh.positions.len(), form.mesh.colours.len()), (texture.uvs.len(), 0));
    assert_eq!(texture.texels.len(), (texture.size * texture.size * 3) as usize);

    // Between vertices the photograph that faces the surface is closer to the texture than to the colours of the vertices.
    // Nothing occludes a ball.
    let (mut by_texture, mut by_vertices) = (0.0, 0.0);
    let given = frame.mesh();
    let key = |p: Vec3| p.to_array().map(f32::to_bits);
    let colours: BTreeMap<_, _> = given.positions.iter().map(|&p| key(p)).zip(&given.colours).collect();
    for &triangle in &form.mesh.triangles {
        let corner = |k: usize| form.mesh.positions[triangle[k] as usize];
        let middle = (corner(0) + corner(1) + corner(2)) / 3.0;
        let normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalize();
        let facing = |view: &&View| normal.dot((view.camera.centre - middle).normalize());
        let view = frame.views().iter().max_by(|a, b| facing(a).total_cmp(&facing(b))).expect("there are views");
        let pixel = view.camera.project(middle);
        let at = (pixel.y.round() as usize * view.camera.width as usize + pixel.x.round() as usize) * 3;
        let seen = Vec3::from_array([0, 1, 2].map(|k| f32::from(view.rgb[at + k])));
        let vertices: Vec3 = (0..3).map(|k| Vec3::from_array(colours[&key(corner(k))].map(f32::from)) / 3.0).sum();
        by_texture += colour(&form, triangle, [1.0 / 3.0; 3]).distance_squared(seen);
        by_vertices += vertices.distance_squared(seen);
    }
    assert!(by_texture < 0.95 * by_vertices, "texture {by_texture}, vertices {by_vertices}");
}

#[test]
fn forms_do_not_change_the_frame_and_are_the_same_every_time() {
    let shot = Shot::small(Subject::Torus, 12);
    let rig = shot.rig();
    let frame = finished(&rig, &shot);
    let before = frame.mesh().clone();
    let first = frame.form(&textured(Some(256)), &Serial, &Silent).expect("a texture");
    let second = frame.form(&textured(Some(256)), &facts::threads(3), &Silent).expect("a texture");
    assert_eq!(first, second);
    assert_eq!(*frame.mesh(), before);
    let plain = frame.form(&FormParams::default(), &Serial, &Silent).expect("the mesh as it is");
    assert_eq!((plain.mesh, plain.texture), (before, None));
}

#[test]
fn forms_of_a_finished_mesh_need_only_the_views_and_the_hull() {
    let shot = Shot::small(Subject::Torus, 12);
    let rig = shot.rig();
    let frame = finished(&rig, &shot);
    let params = FormParams { faces: Some(1000), ..textured(Some(256)) };
    let expected = frame.form(&params, &Serial, &Silent).expect("a texture");
    let mut carved = Frame::new(&rig, *frame.params(), Memory::default());
    carved.keep_views(false);
    for (camera, input) in shot.inputs().iter().enumerate() {
        carved.view(camera, input, &Silent).expect("the picture is sound");
    }
    let code = |result: Result<Form, Error>| result.map(|_| ()).map_err(|e| e.code());
    let form_of = |carved: &Frame<&Rig>, gains| carved.form_of(frame.mesh(), gains, &params, &Serial, &Silent);
    assert_eq!(code(form_of(&carved, frame.gains())), Err(ErrorCode::WrongOrder));
    carved.carve(&Serial, &Silent).expect("the capture is sound");
    assert_eq!(carved.hashes(), &frame.hashes()[..2]);
    assert_eq!(form_of(&carved, frame.gains()).expect("a texture"), expected);
    assert_eq!(code(form_of(&carved, &[])), Err(ErrorCode::InvalidArgument));
    assert_eq!(code(carved.form(&params, &Serial, &Silent)), Err(ErrorCode::WrongOrder));

    let fewer = FormParams { faces: Some(1000), texture: None };
    let expected = frame.form(&fewer, &Serial, &Silent).expect("fewer triangles");
    let footprint = frame.hull().expect("it has been carved").footprint();
    assert_eq!(Form::untextured(frame.mesh(), fewer.faces, footprint, &Silent).expect("fewer triangles"), expected);
}

#[test]
fn what_cannot_be_made_is_refused() {
    let shot = Shot::small(Subject::Torus, 12);
    let rig = shot.rig();
    let code = |result: Result<Form, Error>| result.map(|_| ()).map_err(|e| e.code());
    let fresh = Frame::new(&rig, Params::preset(Preset::Hull), Memory::default());
    assert_eq!(code(fresh.form(&textured(None), &Serial, &Silent)), Err(ErrorCode::WrongOrder));
    let frame = finished(&rig, &shot);
    for size in [0, 63, 16_385, u32::MAX] {
        assert_eq!(
            code(frame.form(&textured(Some(size)), &Serial, &Silent)),
            Err(ErrorCode::InvalidArgument),
            "{size}"
        );
    }
}

#[test]
fn a_form_reports_its_progress_and_can_be_cancelled() {
    struct After(AtomicU32, u32);
    impl Progress for After {
        fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
            assert!(stage == Stage::Form && done <= total);
            self.0.fetch_add(1, Ordering::Relaxed) < self.1
        }
    }
    let shot = Shot::small(Subject::Torus, 12);
    let rig = shot.rig();
    let frame = finished(&rig, &shot);
    let all = After(AtomicU32::new(0), u32::MAX);
    frame.form(&textured(Some(256)), &Serial, &all).expect("nothing cancels it");
    let steps = all.0.into_inner();
    assert!(steps >= 16, "{steps}");
    for at in 0..steps {
        let result = frame.form(&textured(Some(256)), &Serial, &After(AtomicU32::new(0), at));
        assert!(matches!(result, Err(Error::Cancelled)), "{at}");
    }
}
