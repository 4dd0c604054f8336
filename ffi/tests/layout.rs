//! Every enum value, size, offset and version is the same in C and in Rust.

mod common;

use common::{C99, Link, build, output};
use pcmvs::{
    allocator::pcmvs_allocator,
    calibration_options::pcmvs_calibration_options,
    calibration_report::{pcmvs_calibration_report, pcmvs_camera_report, pcmvs_verdict},
    camera::{pcmvs_camera, pcmvs_lens},
    cloud::{pcmvs_cloud_kind, pcmvs_point, pcmvs_rank, pcmvs_silhouette},
    error::pcmvs_error,
    export::{pcmvs_export_options, pcmvs_file_format},
    form::{pcmvs_form_options, pcmvs_texture},
    image::pcmvs_image,
    mesh::{pcmvs_attribute, pcmvs_mesh, pcmvs_mesh_kind},
    options::{pcmvs_options, pcmvs_preset},
    pixel_format::pcmvs_pixel_format,
    report::{pcmvs_counts, pcmvs_stage_report, pcmvs_view_report},
    stage::pcmvs_stage,
    status::pcmvs_status,
    view::{pcmvs_chroma_key, pcmvs_view},
    warning::pcmvs_warning,
    ycbcr::pcmvs_ycbcr,
};
use std::{fs, mem::offset_of};

#[derive(Default)]
struct Facts {
    /// Statements in C that print the facts.
    code: String,
    /// What they must print.
    expected: String,
}

macro_rules! values {
    ($facts:expr, $prefix:literal, $($name:literal = $value:expr),* $(,)?) => {$(
        $facts.code += concat!("VALUE(", $prefix, $name, ");\n");
        $facts.expected += &format!("{} {}\n", concat!($prefix, $name), $value as u64);
    )*};
}

macro_rules! layout {
    ($facts:expr, $type:ident { $($member:ident),* $(,)? }) => {
        $facts.code += concat!("SIZE(", stringify!($type), ");\n");
        $facts.expected += &format!("sizeof {} {}\n", stringify!($type), size_of::<$type>());
        $(
            $facts.code += concat!("OFFSET(", stringify!($type), ", ", stringify!($member), ");\n");
            $facts.expected +=
                &format!("offsetof {} {} {}\n", stringify!($type), stringify!($member), offset_of!($type, $member));
        )*
        // Every member is named above.
        let _ = |v: &$type| { let $type { $($member: _),* } = v; };
    };
}

#[test]
fn c_and_rust_agree() {
    use pcmvs_status as S;
    let mut facts = Facts::default();
    values!(
        facts,
        "PCMVS_STATUS_",
        "OK" = S::Ok,
        "NULL_POINTER" = S::NullPointer,
        "INVALID_HANDLE" = S::InvalidHandle,
        "INVALID_STRUCT" = S::InvalidStruct,
        "INVALID_ARGUMENT" = S::InvalidArgument,
        "BUSY" = S::Busy,
        "WRONG_ORDER" = S::WrongOrder,
        "CANCELLED" = S::Cancelled,
        "CAMERA" = S::Camera,
        "IMAGE" = S::Image,
        "SILHOUETTE" = S::Silhouette,
        "DUPLICATE_CAMERA" = S::DuplicateCamera,
        "TOO_FEW_VIEWS" = S::TooFewViews,
        "EMPTY_HULL" = S::EmptyHull,
        "NO_SURFACE" = S::NoSurface,
        "OUT_OF_MEMORY" = S::OutOfMemory,
        "BUFFER_TOO_SMALL" = S::BufferTooSmall,
        "WRITE_FAILED" = S::WriteFailed,
        "PANIC" = S::Panic,
        "OTHER" = S::Other,
    );
    use pcmvs_stage as G;
    values!(
        facts,
        "PCMVS_STAGE_",
        "VIEWS" = G::Views,
        "HULL" = G::Hull,
        "CONTOURS" = G::Contours,
        "COARSE" = G::Coarse,
        "DETECT" = G::Detect,
        "MERGE" = G::Merge,
        "MESH" = G::Mesh,
        "COLOUR" = G::Colour,
        "FORM" = G::Form,
        "STEADY" = G::Steady,
    );
    values!(facts, "PCMVS_LENS_", "OPENCV" = pcmvs_lens::Opencv, "FISHEYE" = pcmvs_lens::Fisheye);
    use pcmvs_pixel_format as F;
    values!(
        facts,
        "PCMVS_PIXEL_FORMAT_",
        "GRAY8" = F::Gray8,
        "RGB8" = F::Rgb8,
        "BGR8" = F::Bgr8,
        "RGBA8" = F::Rgba8,
        "BGRA8" = F::Bgra8,
        "NV12" = F::Nv12,
        "GRAY16" = F::Gray16,
        "I420" = F::I420,
        "P010" = F::P010,
        "YUY2" = F::Yuy2,
    );
    use pcmvs_ycbcr as Y;
    values!(
        facts,
        "PCMVS_YCBCR_",
        "BT601_VIDEO" = Y::Bt601Video,
        "BT601_FULL" = Y::Bt601Full,
        "BT709_VIDEO" = Y::Bt709Video,
        "BT709_FULL" = Y::Bt709Full,
    );
    use pcmvs_preset as P;
    values!(
        facts,
        "PCMVS_PRESET_",
        "DEFAULT" = P::Default,
        "PAPER" = P::Paper,
        "HULL" = P::Hull,
        "PREVIEW" = P::Preview,
    );
    use pcmvs_mesh_kind as M;
    values!(facts, "PCMVS_MESH_KIND_", "FINAL" = M::Final, "HULL" = M::Hull, "COARSE" = M::Coarse, "FORM" = M::Form);
    use pcmvs_attribute as A;
    values!(
        facts,
        "PCMVS_ATTRIBUTE_",
        "POSITION" = A::Position,
        "NORMAL" = A::Normal,
        "COLOUR" = A::Colour,
        "TRIANGLE" = A::Triangle,
        "TEXTURE_COORDINATES" = A::TextureCoordinates,
    );
    use pcmvs_cloud_kind as C;
    values!(
        facts,
        "PCMVS_CLOUD_KIND_",
        "FRONTIER" = C::Frontier,
        "IMPLICIT" = C::Implicit,
        "DETECTED" = C::Detected,
        "MERGED" = C::Merged,
    );
    use pcmvs_rank as R;
    values!(
        facts,
        "PCMVS_RANK_",
        "IMPLICIT" = R::Implicit,
        "SUBSTITUTED" = R::Substituted,
        "DETECTED" = R::Detected,
        "FRONTIER" = R::Frontier,
    );
    use pcmvs_verdict as V;
    values!(facts, "PCMVS_VERDICT_", "IMPROVED" = V::Improved, "KEPT" = V::Kept, "UNDECIDED" = V::Undecided);
    values!(facts, "PCMVS_FILE_FORMAT_", "GLB" = pcmvs_file_format::Glb, "PLY" = pcmvs_file_format::Ply);
    values!(
        facts,
        "PCMVS_",
        "MESSAGE_SIZE" = pcmvs::error::PCMVS_MESSAGE_SIZE,
        "CODE_SIZE" = pcmvs::warning::PCMVS_CODE_SIZE,
        "MAX_CAMERAS" = pcmvs::rig::PCMVS_MAX_CAMERAS,
        "NO_STAGE" = pcmvs::stage::PCMVS_NO_STAGE,
        "VERSION" = pcmvs::version::PCMVS_VERSION,
    );

    layout!(facts, pcmvs_allocator { struct_size, reserved, user, allocate, reallocate, deallocate });
    layout!(facts, pcmvs_error { status, stage, camera, reserved, frame, message });
    layout!(
        facts,
        pcmvs_camera {
            struct_size,
            width,
            height,
            reserved,
            k,
            distortion,
            r,
            t,
            lens,
            reserved_lens,
            distortion_more
        }
    );
    layout!(
        facts,
        pcmvs_image {
            struct_size,
            format,
            width,
            height,
            data,
            stride,
            chroma,
            chroma_stride,
            cr,
            cr_stride,
            ycbcr,
            reserved,
        }
    );
    layout!(facts, pcmvs_chroma_key { struct_size, rgb, tolerance, darkest_shadow, smallest_part, smallest_hole });
    layout!(facts, pcmvs_view { struct_size, reserved, image, mask, clean_plate, chroma_key });
    layout!(
        facts,
        pcmvs_options {
            struct_size,
            preset,
            frame,
            voxel_pixels,
            progress,
            progress_user,
            parallel,
            parallel_user,
            max_memory
        }
    );
    layout!(
        facts,
        pcmvs_mesh {
            vertex_count,
            triangle_count,
            positions,
            normals,
            colours,
            triangles,
            origin,
            texture_coordinates
        }
    );
    layout!(facts, pcmvs_point { position, normal, fidelity, weight, camera, rank });
    layout!(facts, pcmvs_silhouette { width, height, distances });
    layout!(facts, pcmvs_form_options { struct_size, faces, texture, texture_size });
    layout!(facts, pcmvs_texture { width, height, texels });
    layout!(
        facts,
        pcmvs_export_options {
            struct_size,
            format,
            normals,
            has_up,
            up,
            upright,
            compact,
            jpeg_quality,
            reserved,
            meshopt_optimizeVertexCacheStrip,
            meshopt_optimizeVertexFetchRemap,
            meshopt_encodeVertexBufferBound,
            meshopt_encodeVertexBufferLevel,
            meshopt_encodeIndexBufferBound,
            meshopt_encodeIndexBuffer
        }
    );
    layout!(
        facts,
        pcmvs_counts {
            detected,
            substituted,
            cleaned_density,
            cleaned_pca,
            cleaned_normal,
            frontier,
            implicit,
            dropped_normal,
            dropped_fidelity,
            conflicts_cameras,
            conflicts_virtual,
            implicit_removed,
            merged,
            components_dropped,
            vertices,
            faces,
        }
    );
    layout!(facts, pcmvs_stage_report { seconds, hash });
    layout!(
        facts,
        pcmvs_view_report {
            carves,
            inside,
            detected,
            substituted,
            gains,
            reserved,
            used,
            silhouette_overlap,
            contour_px,
            epipolar_px
        }
    );
    layout!(facts, pcmvs_warning { camera, reserved, code, message });
    layout!(
        facts,
        pcmvs_calibration_options { struct_size, intrinsics, progress, progress_user, parallel, parallel_user }
    );
    layout!(
        facts,
        pcmvs_calibration_report {
            verdict,
            frames,
            points,
            epipolar_bias_px,
            refined_epipolar_bias_px,
            held_out_loss,
            refined_held_out_loss,
            exchanged,
        }
    );
    layout!(
        facts,
        pcmvs_camera_report {
            silhouette_overlap,
            gain,
            contour_px,
            refined_contour_px,
            epipolar_px,
            refined_epipolar_px,
            match_noise_px,
            matches,
            moved_px,
            sigma_px,
            direction_sigma_px,
            roll_sigma_px,
            centre_sigma_px,
        }
    );
    facts.expected += "composed 1\n";
    facts.expected += &format!("library {} {}\n", pcmvs::version::PCMVS_VERSION, env!("CARGO_PKG_VERSION"));

    // Every value of every enum of the header is checked above.
    let header = fs::read_to_string(common::root().join("include/pcmvs.h")).unwrap();
    let listed = header.lines().filter_map(|line| line.strip_prefix("  PCMVS_")?.split_once(" = "));
    for (name, _) in listed {
        assert!(facts.code.contains(&format!("VALUE(PCMVS_{name})")), "PCMVS_{name} is not checked");
    }

    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("abi.inc"), &facts.code).unwrap();
    for link in [Link::Shared, Link::Static] {
        let program = build(folder.path(), C99, "tests/c/abi.c", link);
        assert_eq!(output(&program, [""; 0]), facts.expected);
    }
}
