//! Cameras in the formats of every program, by the writers of the tests. All numbers have all their digits. A lens is OpenCV's
//! k1 k2 p1 p2 k3.

use super::super::binary::Bytes;
use super::realitycapture::Shares;
use super::{
    Pinhole, anipose, bundler, by_rows, easymocap, kalibr, list, metashape, mvsnet, neus, panoptic, qualisys,
    realitycapture, realitycapture_csv, stereo, zju,
};
use glam::{DQuat, DVec2};
use pcmvs_scene::Source;
use serde_json::json;
use std::fmt::Write as _;

/// A lens without distortion.
pub const NONE: [f64; 5] = [0.0; 5];

/// Cameras in one of the forms of a format.
pub struct Written {
    pub form: &'static str,
    /// The files besides pictures.
    pub files: Vec<(String, Vec<u8>)>,
    /// The pictures of the cameras.
    pub pictures: Vec<String>,
    /// Names of the imported cameras.
    pub names: Vec<String>,
    /// What the format has of the distortion.
    pub lens: [f64; 5],
    /// Whether the world is that of the first camera.
    pub is_of_first: bool,
    /// Whether the format has no principal point, so that it is in the middle of the picture.
    pub is_centred: bool,
}

impl Written {
    fn new<C: Into<Vec<u8>>>(
        form: &'static str,
        files: impl IntoIterator<Item = (String, C)>,
        names: Vec<String>,
    ) -> Self {
        Self {
            form,
            files: files.into_iter().map(|(name, content)| (name, content.into())).collect(),
            pictures: names.iter().map(|name| format!("images/{name}.png")).collect(),
            names,
            lens: NONE,
            is_of_first: false,
            is_centred: false,
        }
    }

    fn one(form: &'static str, file: &str, content: impl Into<Vec<u8>>, names: Vec<String>) -> Self {
        Self::new(form, [(file.to_owned(), content)], names)
    }
}

/// The cameras, all with this lens, in all forms of a format. A new format needs a writer here.
pub fn all(source: Source, cameras: &[Pinhole], lens: [f64; 5]) -> Vec<Written> {
    let [k1, k2, p1, p2, _] = lens;
    let known = match source {
        Source::Middlebury | Source::Neus | Source::Mvsnet => NONE,
        Source::Bundler => [k1, k2, 0.0, 0.0, 0.0],
        Source::Kalibr => [k1, k2, p1, p2, 0.0],
        Source::Colmap
        | Source::Opencv
        | Source::Transforms
        | Source::Easymocap
        | Source::Metashape
        | Source::Anipose
        | Source::Panoptic
        | Source::Realitycapture
        | Source::Qualisys
        | Source::Zju => lens,
    };
    let all = forms(source, cameras, lens);
    all.into_iter().map(|written| Written { lens: known, ..written }).collect()
}

fn forms(source: Source, cameras: &[Pinhole], lens: [f64; 5]) -> Vec<Written> {
    let [k1, k2, p1, p2, k3] = lens;
    let names = |name: &dyn Fn(usize) -> String| -> Vec<String> { (0..cameras.len()).map(name).collect() };
    let padded = names(&|i| format!("cam{i:02}"));
    let each = |file: &dyn Fn(usize) -> String, text: &dyn Fn(&Pinhole) -> String| -> Vec<(String, String)> {
        cameras.iter().enumerate().map(|(i, camera)| (file(i), text(camera))).collect()
    };
    match source {
        Source::Middlebury => {
            let pictures = names(&|i| format!("cam{i:02}.png"));
            let written = Written::one("par.txt", "ring_par.txt", middlebury(cameras, &pictures), padded);
            vec![Written { pictures, ..written }]
        }
        Source::Colmap => colmap(cameras, lens, &padded),
        Source::Opencv => {
            let form = |form, end, write: &dyn Fn(&stereo::Matrices) -> String| {
                let files = each(&|i| format!("cam{i:02}.{end}"), &|camera| write(&opencv(camera, &lens)));
                Written::new(form, files, padded.clone())
            };
            let chain = Written {
                is_of_first: true,
                ..Written::new("stereo pairs", pairs(cameras, &lens), names(&|i| format!("cam{}", i + 1)))
            };
            vec![
                form("YAML", "yml", &stereo::yaml),
                form("XML", "xml", &stereo::xml),
                form("JSON", "json", &stereo::nested),
                chain,
            ]
        }
        Source::Transforms => {
            let pictures = names(&|i| format!("images/cam{i:02}.png"));
            // Names have the folder of the pictures.
            let names = names(&|i| format!("images_cam{i:02}"));
            let written = Written::one("JSON", "transforms.json", transforms(cameras, lens, &pictures), names);
            vec![Written { pictures, ..written }]
        }
        Source::Easymocap => {
            let [intri, extri] = easymocap::easymocap(cameras, &lens);
            let files = [(String::from("intri.yml"), intri), (String::from("extri.yml"), extri)];
            vec![Written::new("YAML", files, names(&|i| format!("0{i}")))]
        }
        Source::Bundler => {
            let [text, pictures] = bundler::bundler(cameras, [k1, k2]);
            let files = [(String::from("bundle/bundle.out"), text), (String::from("list.txt"), pictures)];
            let written = Written::new("bundle.out", files, names(&|i| format!("images_c {i}")));
            vec![Written { pictures: names(&|i| format!("images/c {i}.png")), is_centred: true, ..written }]
        }
        Source::Metashape => {
            // Tangential coefficients are in the other order.
            let bent = format!("<k1>{k1}</k1><k2>{k2}</k2><k3>{k3}</k3><p1>{p2}</p1><p2>{p1}</p2>");
            let lens = |camera: &Pinhole| {
                let size = DVec2::from_array(camera.size.map(f64::from));
                let (f, c) = (camera.focal.y, camera.principal + 0.5 - size / 2.0);
                format!("<f>{f}</f><cx>{}</cx><cy>{}</cy><b1>{}</b1>{bent}", c.x, c.y, camera.focal.x - f)
            };
            let text = metashape::metashape(cameras, "frame", lens);
            vec![Written::one("XML", "cameras.xml", text, names(&|i| format!("IMG_{i}")))]
        }
        Source::Neus => {
            let file = neus::npz(&neus::neus(cameras));
            let written = Written::one("npz", "cameras_sphere.npz", file, names(&|i| format!("{i:06}")));
            vec![Written { pictures: names(&|i| format!("image/{i:06}.png")), ..written }]
        }
        Source::Anipose => {
            let text = anipose::anipose(cameras, |i| format!("cam_{i}"), &format!("distortions = [ {} ]", list(lens)));
            vec![Written::one("TOML", "calibration.toml", text, names(&|i| format!("c{i}")))]
        }
        Source::Panoptic => {
            let text = panoptic::panoptic(cameras, &lens);
            vec![Written::one("JSON", "calibration_1.json", text, names(&|i| format!("00_0{i}")))]
        }
        Source::Mvsnet => {
            let files = each(&|i| format!("cams/{i:08}_cam.txt"), &mvsnet::mvsnet);
            vec![Written::new("cam.txt", files, names(&|i| format!("{i:08}")))]
        }
        Source::Kalibr => {
            let text = kalibr::kalibr(cameras, "radtan", &lens[..4]);
            let written = Written::one("YAML", "camchain.yaml", text, names(&|i| format!("cam{i}")));
            vec![Written { is_of_first: true, ..written }]
        }
        Source::Realitycapture => {
            let shares = |camera: &Pinhole| shares(camera, lens);
            let of_xmp = |camera: &Pinhole| realitycapture::xmp(camera, "brown3t2", &shares(camera));
            let angles = realitycapture_csv::by_angles(realitycapture_csv::HEADER, cameras, shares);
            let matrices = realitycapture_csv::by_matrices(cameras, shares);
            let (spaced, plain) = (names(&|i| format!("c {i}")), names(&|i| format!("c{i}")));
            vec![
                Written::new("XMP", each(&|i| format!("images/c{i}.xmp"), &of_xmp), plain.clone()),
                Written::one("CSV with angles", "registration.csv", angles, spaced),
                Written::one("CSV with matrices", "opencv.csv", matrices, plain),
            ]
        }
        Source::Qualisys => {
            vec![Written::one("XML", "a.qca.txt", qualisys::qualisys(cameras, lens), names(&qualisys::serial))]
        }
        Source::Zju => {
            let file = zju::annots(cameras, lens, 1, "");
            let written = Written::one("npy", "annots.npy", file, names(&|i| format!("Camera_B{}", i + 1)));
            vec![Written { pictures: names(&|i| zju::picture(i, 0)), ..written }]
        }
    }
}

/// A line per camera: the picture, K, R and t by rows.
fn middlebury(cameras: &[Pinhole], pictures: &[String]) -> String {
    let mut text = format!("{}\n", cameras.len());
    for (camera, picture) in cameras.iter().zip(pictures) {
        let numbers = camera.k().into_iter().chain(by_rows(&camera.r)).chain(camera.t.to_array());
        let _ = writeln!(text, "{picture} {}", list(numbers).replace(',', ""));
    }
    text
}

/// A text and a binary model. Quaternions have w first, and the first pixel's centre is at (0.5, 0.5).
fn colmap(cameras: &[Pinhole], [k1, k2, p1, p2, k3]: [f64; 5], names: &[String]) -> Vec<Written> {
    let (mut lenses, mut poses) = (String::new(), String::new());
    let count = cameras.len() as u64;
    let mut binary = [(); 2].map(|()| Bytes::default().u64(count));
    for (i, (camera, name)) in (1..).zip(cameras.iter().zip(names)) {
        let [width, height] = camera.size;
        let (focal, principal, q) = (camera.focal, camera.principal + 0.5, DQuat::from_mat3(&camera.r));
        let lens = [focal.x, focal.y, principal.x, principal.y, k1, k2, p1, p2, k3, 0.0, 0.0, 0.0];
        let pose = [q.w, q.x, q.y, q.z, camera.t.x, camera.t.y, camera.t.z];
        let joined = |numbers: &[f64]| list(numbers.iter().copied()).replace(',', "");
        let _ = writeln!(lenses, "{i} FULL_OPENCV {width} {height} {}", joined(&lens));
        let _ = writeln!(poses, "{i} {} {i} {name}.png\n", joined(&pose));
        // The number of the model FULL_OPENCV is 6.
        let [of_lenses, of_poses] = binary;
        let head = of_lenses.u32(i).u32(6).u64(u64::from(width)).u64(u64::from(height));
        binary = [head.f64s(&lens), of_poses.u32(i).f64s(&pose).u32(i).text(&format!("{name}.png")).u64(0)];
    }
    let files = |end: &str, [lenses, poses]: [Vec<u8>; 2]| {
        [(format!("sparse/0/cameras.{end}"), lenses), (format!("sparse/0/images.{end}"), poses)]
    };
    vec![
        Written::new("text", files("txt", [lenses.into_bytes(), poses.into_bytes()]), names.to_vec()),
        Written::new("binary", files("bin", binary.map(|bytes| bytes.0)), names.to_vec()),
    ]
}

/// A camera with its own pose.
fn opencv(camera: &Pinhole, lens: &[f64]) -> stereo::Matrices {
    let mut matrices = stereo::lens_of(camera, lens, ["camera_matrix", "distortion_coefficients"]);
    matrices.push((String::from("R"), 3, by_rows(&camera.r).into()));
    matrices.push((String::from("t"), 3, camera.t.to_array().into()));
    matrices
}

/// A file per pair of neighbours.
fn pairs(cameras: &[Pinhole], distortion: &[f64]) -> Vec<(String, String)> {
    let file = |(i, pair): (usize, &[Pinhole])| {
        let lens = |i: usize, keys| stereo::lens_of(&pair[i], distortion, keys);
        let pose = stereo::pose(["R", "T"], &pair[0], &pair[1]);
        let text = stereo::yaml(&[lens(0, ["M1", "D1"]), lens(1, ["M2", "D2"]), pose].concat());
        (format!("stereo_{}_{}.yml", i + 1, i + 2), text)
    };
    cameras.windows(2).enumerate().map(file).collect()
}

/// Camera to world, x right, y up, z backward. The first pixel's centre is at (0.5, 0.5).
fn transforms(cameras: &[Pinhole], [k1, k2, p1, p2, k3]: [f64; 5], pictures: &[String]) -> String {
    let frame = |(camera, picture): (&Pinhole, &String)| {
        let (right, up, back, centre) = (camera.r.row(0), -camera.r.row(1), -camera.r.row(2), camera.centre());
        let row = |i: usize| [right[i], up[i], back[i], centre[i]];
        json!({
            "file_path": picture, "w": camera.size[0], "h": camera.size[1],
            "fl_x": camera.focal.x, "fl_y": camera.focal.y,
            "cx": camera.principal.x + 0.5, "cy": camera.principal.y + 0.5,
            "k1": k1, "k2": k2, "p1": p1, "p2": p2, "k3": k3,
            "transform_matrix": [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]],
        })
    };
    json!({ "frames": cameras.iter().zip(pictures).map(frame).collect::<Vec<_>>() }).to_string()
}

/// RealityCapture's intrinsics. t1 is OpenCV's p2, and t2 its p1.
fn shares(camera: &Pinhole, [k1, k2, p1, p2, k3]: [f64; 5]) -> Shares {
    let size = DVec2::from_array(camera.size.map(f64::from));
    let larger = size.max_element();
    Shares {
        f: camera.focal.x / larger * 36.0,
        principal: (camera.principal + 0.5 - size / 2.0) / larger,
        k: [k1, k2, k3],
        t: [p2, p1],
    }
}
