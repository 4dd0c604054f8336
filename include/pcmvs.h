/*
 * libpcmvs: multi-view stereo for free-viewpoint video.
 *
 * The library takes the pictures that a ring of calibrated cameras took at one instant and reconstructs a closed,
 * coloured triangle mesh. The result is the same, byte for byte, on every machine.
 *
 * This file is the reference manual. It is generated from the sources: do not edit it.
 *
 * Example:
 *
 *   pcmvs_rig *rig;                                     one rig for the cameras
 *   pcmvs_rig_new(&rig);
 *   pcmvs_rig_set_cameras(rig, cameras, camera_count);
 *   pcmvs_frame *frame;                                 one frame handle, used for frame after frame
 *   pcmvs_frame_new(rig, &frame);
 *   pcmvs_frame_reconstruct(frame, views, camera_count, NULL);
 *   pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FINAL, NULL, write_to_file, file);
 *   pcmvs_frame_free(frame);
 *   pcmvs_rig_free(rig);
 *
 * Stages. A reconstruction runs in stages; pcmvs_stage_count and pcmvs_stage_at list them in the order in which they
 * run. pcmvs_frame_reconstruct runs all of them. A host that wants to run them itself calls pcmvs_frame_begin,
 * pcmvs_frame_view for every camera, pcmvs_frame_hull, pcmvs_frame_contours, pcmvs_frame_coarse, pcmvs_frame_detect for
 * every camera, pcmvs_frame_merge, pcmvs_frame_mesh and pcmvs_frame_colour; the result is the same. Apart from
 * pcmvs_frame_view and pcmvs_frame_detect, which do the work of one camera, each of these functions first runs the
 * stages before its own that have not run yet. Therefore such a host keeps working when a later version inserts a
 * stage, and it may leave out functions: after the views, pcmvs_frame_colour alone runs everything. pcmvs_frame_step
 * runs any stage by its number. If a stage fails or is cancelled, the frame is as it was before that stage. The stage
 * can be run again, or another frame begun.
 *
 * Errors. Every function that can fail returns a pcmvs_status. A function that fails writes nothing to the caller's
 * memory. After a failed call on a handle, pcmvs_frame_error, pcmvs_rig_error or pcmvs_calibration_error describes the
 * failure: the frame, stage and camera where they are known, and what to do. This holds for functions that only read
 * results, too. The description stays until another call on the handle fails. If several threads use the handle, it is
 * that of the last failure on any of them. Calls without a valid handle (a NULL handle, pcmvs_..._init) return a
 * status and nothing else.
 *
 * Warnings. pcmvs_frame_warning_count and pcmvs_frame_get_warning list what may make a result worse although no call
 * failed.
 *
 * Calibration. A pcmvs_calibration checks by the pictures of a few frames whether the cameras still stand as they were
 * calibrated, and refines them. It is not part of a reconstruction: run it once for a take, and make a new rig of the
 * cameras that it returns.
 *
 * Pointers. A pointer must not be NULL unless its function or member says so. Inputs are read only during the call.
 *
 * Ownership. The caller owns handles and frees each with its own function, in any order. Pointers that the library
 * returns point to memory of the library; their descriptions say how long they stay valid. Nothing else needs freeing.
 *
 * Memory. Results can be written to memory of the caller: pcmvs_frame_copy_... and ..._to_buffer fill its buffers, and
 * ..._export_... pass a file's bytes to its callback. Working memory comes from the C library's malloc, calloc, realloc,
 * posix_memalign and free, or from the functions given to pcmvs_set_allocator. A frame reuses the memory of the frame
 * before it on the same handle. The option max_memory makes a frame fail before it allocates more than that.
 *
 * Failed allocations. If a function given to pcmvs_set_allocator returns NULL, the library takes the block from malloc
 * instead, and all calls that are running and report progress end with PCMVS_STATUS_OUT_OF_MEMORY at their next step. A
 * call that has no further step completes. The handle can be used again. Blocks from malloc are freed like any others;
 * there are at most 4096 at a time. The process is aborted if there are more, if malloc returns NULL, or if it does so
 * without pcmvs_set_allocator, at whatever size, because most of Rust's containers cannot report it.
 *
 * Structs. A struct that the caller fills in begins with struct_size. Call its init function first, then set members.
 * In an array of such structs, all elements have the same struct_size. Other structs are written by functions that take
 * their size. Later versions of the library add members only at the end of a struct, so that a program that was built
 * with an older header of the same ABI version keeps working. Members called reserved are zero. A reserved member of a
 * struct that the caller fills in must stay zero.
 *
 * Versions. The ABI version is 0.y before version 1.0 and the major version afterwards. Within an ABI version functions
 * and the values of enums are only added, and numbers never change. Enums are passed as uint32_t, because a newer library
 * may use values that an older header does not list.
 *
 * Threads. Handles are independent of each other, and any number of them may be used at once. Threads may share a rig
 * once its cameras are set. On one frame, pcmvs_frame_view and pcmvs_frame_detect may run on several threads at once
 * for different cameras, and so may all functions that take a const pcmvs_frame * or a const pcmvs_calibration *. Any
 * other call needs the frame or calibration for itself. A call that cannot run because of another one fails with
 * PCMVS_STATUS_BUSY instead of waiting. Free a handle only when no other thread uses it. The library never starts a
 * thread. Its only global state is the allocator, and the lists of handles and of the jobs that a parallel callback runs.
 *
 * Handles are numbers, not addresses. Every function compares them with the list of handles and reads nothing through
 * them, so that a handle that has been freed, is of another kind or never was one gives PCMVS_STATUS_INVALID_HANDLE. All
 * other pointers are believed: the library cannot know whether they point to as many bytes as their descriptions say.
 *
 * Limits. Numbers out of reason are refused before memory is taken. A rig has 3 to PCMVS_MAX_CAMERAS cameras. Sides of
 * pictures have up to 32768 pixels, a picture 2^28 and the pictures of a rig together 2^34. Focal lengths are 0.01 to 1000
 * times the longer side of the picture, and the two differ by less than 10 times. The principal point is within 10 sides
 * of the picture's middle, and the skew is at most the focal length. A lens does not fold the picture before its nearest
 * edge, its map takes at most 64 MiB, and at least a twentieth of the undistorted picture shows something. Coordinates of t go up to
 * 1e15. Most cameras stand 1e-6 to 1e9 units from where they look, and no camera 100 times nearer or farther than they
 * do, nor 20 times farther if the others look at one place; the scene is at most 1e8 times that distance from its zero. pcmvs_rig_set_cameras fails with PCMVS_STATUS_CAMERA
 * otherwise, and names the camera if it is one.
 *
 * Time. docs/c.md estimates the time of a frame from the size of its pictures, and the time until a progress callback is
 * asked.
 *
 * Callbacks must not throw exceptions and must not jump out.
 *
 * Panics. A bug in the library is caught before it reaches the caller, and the call returns PCMVS_STATUS_PANIC. Only
 * that handle becomes unusable. Rust prints a few lines about the place of the bug to stderr; the library prints nothing
 * else. To suppress those lines it would have to change state that it shares with all Rust code in the process.
 *
 * Coordinates. The scene's frame and unit are those of the cameras' R and t. Colours are sRGB.
 */


#ifndef PCMVS_H
#define PCMVS_H

#include <stddef.h>
#include <stdint.h>

// Major version of this header.
#define PCMVS_VERSION_MAJOR 0

// Minor version of this header.
#define PCMVS_VERSION_MINOR 2

// Patch version of this header.
#define PCMVS_VERSION_PATCH 0

// Version of this header as one number: major * 1000000 + minor * 1000 + patch.
#define PCMVS_VERSION 2000

// Returned by `pcmvs_stage_at` beyond the last stage.
#define PCMVS_NO_STAGE 4294967295

// Size of an error's or warning's message in bytes, with its final zero.
#define PCMVS_MESSAGE_SIZE 480

// Maximum number of cameras of a rig.
#define PCMVS_MAX_CAMERAS 1024

// Size of a warning's code in bytes, with its final zero.
#define PCMVS_CODE_SIZE 32

// Result of a call. Numbers never change, and new ones are added at the end only. Treat a number that you do not know
// as a failure.
enum pcmvs_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Success.
  PCMVS_STATUS_OK = 0,
  // A pointer that must not be NULL is NULL.
  PCMVS_STATUS_NULL_POINTER = 1,
  // The handle is of another kind, has been freed, or never was a handle.
  PCMVS_STATUS_INVALID_HANDLE = 2,
  // The `struct_size` or `size` of a struct is smaller than in every version, or a member that this library does not
  // know is not zero, which means that the caller asks for something only a newer library can do.
  PCMVS_STATUS_INVALID_STRUCT = 3,
  // An argument is out of range.
  PCMVS_STATUS_INVALID_ARGUMENT = 4,
  // The frame or calibration is in use by a call that excludes this one. That call runs on another thread, or this call
  // was made from one of its callbacks.
  PCMVS_STATUS_BUSY = 5,
  // The call needs a stage or a calibration that has not run yet, or it comes too late.
  PCMVS_STATUS_WRONG_ORDER = 6,
  // The progress callback asked to stop.
  PCMVS_STATUS_CANCELLED = 7,
  // A camera's calibration cannot be used, or the cameras as a whole cannot: their axes or poses contradict each other.
  PCMVS_STATUS_CAMERA = 8,
  // A picture does not fit its camera or its own description.
  PCMVS_STATUS_IMAGE = 9,
  // A silhouette cannot be used, or all masks are inverted.
  PCMVS_STATUS_SILHOUETTE = 10,
  // Two cameras have the same position and direction. No longer returned: cameras at the same place are a warning.
  PCMVS_STATUS_DUPLICATE_CAMERA = 11,
  // There are fewer cameras, or fewer silhouettes, than the method needs.
  PCMVS_STATUS_TOO_FEW_VIEWS = 12,
  // The silhouettes have no common volume.
  PCMVS_STATUS_EMPTY_HULL = 13,
  // The points do not bound a surface.
  PCMVS_STATUS_NO_SURFACE = 14,
  // The frame needs more memory than `pcmvs_options.max_memory` allows, or an allocator of the caller returned NULL.
  PCMVS_STATUS_OUT_OF_MEMORY = 15,
  // The buffer is too small. Ask for the size first.
  PCMVS_STATUS_BUFFER_TOO_SMALL = 16,
  // The write callback returned an error.
  PCMVS_STATUS_WRITE_FAILED = 17,
  // A bug in the library. From now on the handle accepts only `pcmvs_..._error` and `pcmvs_..._free`; other handles
  // are not affected.
  PCMVS_STATUS_PANIC = 18,
  // A failure that this version of the ABI has no number for. The message describes it.
  PCMVS_STATUS_OTHER = 19,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_status pcmvs_status;
#else
typedef uint32_t pcmvs_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Stages of a reconstruction. A stage keeps its number for ever, and the number does not say when the stage runs: ask
// `pcmvs_stage_count` and `pcmvs_stage_at` for the order. A newer library may have stages that are not listed here.
enum pcmvs_stage
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Undistorts the pictures and finds the silhouettes, view by view.
  PCMVS_STAGE_VIEWS = 0,
  // Carves the visual hull.
  PCMVS_STAGE_HULL = 1,
  // Finds the points that follow from the silhouettes alone.
  PCMVS_STAGE_CONTOURS = 2,
  // Detects and meshes at reduced resolution to guide the stages after it.
  PCMVS_STAGE_COARSE = 3,
  // Detects points by stereo, view by view.
  PCMVS_STAGE_DETECT = 4,
  // Merges all points into one cloud.
  PCMVS_STAGE_MERGE = 5,
  // Turns the cloud into a closed mesh.
  PCMVS_STAGE_MESH = 6,
  // Colours the mesh.
  PCMVS_STAGE_COLOUR = 7,
  // Makes a form of the finished mesh, see `pcmvs_frame_form`. It belongs to progress and errors only: it is not in the
  // order, and `pcmvs_frame_step` does not know it.
  PCMVS_STAGE_FORM = 8,
  // Averages the finished mesh with those of neighbouring frames, see `pcmvs_frame_steady`. As `PCMVS_STAGE_FORM`, it belongs
  // to progress and errors only.
  PCMVS_STAGE_STEADY = 9,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_stage pcmvs_stage;
#else
typedef uint32_t pcmvs_stage;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Models of a lens. Numbers never change.
enum pcmvs_lens
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // OpenCV's k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4.
  PCMVS_LENS_OPENCV = 0,
  // OpenCV's fisheye, which is equidistant: k1, k2, k3, k4.
  PCMVS_LENS_FISHEYE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_lens pcmvs_lens;
#else
typedef uint32_t pcmvs_lens;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Pixel formats. Numbers never change.
enum pcmvs_pixel_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // One byte per pixel.
  PCMVS_PIXEL_FORMAT_GRAY8 = 0,
  // Red, green, blue: three bytes per pixel.
  PCMVS_PIXEL_FORMAT_RGB8 = 1,
  // Blue, green, red: three bytes per pixel.
  PCMVS_PIXEL_FORMAT_BGR8 = 2,
  // Red, green, blue and a byte that is ignored.
  PCMVS_PIXEL_FORMAT_RGBA8 = 3,
  // Blue, green, red and a byte that is ignored.
  PCMVS_PIXEL_FORMAT_BGRA8 = 4,
  // A plane of luma and a plane of interleaved Cb, Cr at half the width and height, rounded up. `ycbcr` says how they code
  // colours, as in the other formats with luma.
  PCMVS_PIXEL_FORMAT_NV12 = 5,
  // Two bytes per pixel in the machine's byte order. 65535 is white.
  PCMVS_PIXEL_FORMAT_GRAY16 = 6,
  // A plane of luma, a plane of Cb and a plane of Cr, the latter two at half the width and height, rounded up.
  PCMVS_PIXEL_FORMAT_I420 = 7,
  // As NV12, but two bytes per value in the machine's byte order, of which the upper 10 bits count.
  PCMVS_PIXEL_FORMAT_P010 = 8,
  // Luma, Cb, luma, Cr: four bytes for two neighbouring pixels. A row of odd width ends with such four bytes, too.
  PCMVS_PIXEL_FORMAT_YUY2 = 9,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_pixel_format pcmvs_pixel_format;
#else
typedef uint32_t pcmvs_pixel_format;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How luma and colour differences code red, green and blue. Numbers never change.
enum pcmvs_ycbcr
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // ITU-R BT.601 (standard definition, and most webcams), video range: luma from 16 to 235.
  PCMVS_YCBCR_BT601_VIDEO = 0,
  // ITU-R BT.601, full range: luma from 0 to 255, as JPEG has it.
  PCMVS_YCBCR_BT601_FULL = 1,
  // ITU-R BT.709 (high definition), video range.
  PCMVS_YCBCR_BT709_VIDEO = 2,
  // ITU-R BT.709, full range.
  PCMVS_YCBCR_BT709_FULL = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_ycbcr pcmvs_ycbcr;
#else
typedef uint32_t pcmvs_ycbcr;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Sets of parameters. Numbers never change.
enum pcmvs_preset
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The parameters with the best measured results.
  PCMVS_PRESET_DEFAULT = 0,
  // The method as published.
  PCMVS_PRESET_PAPER = 1,
  // The visual hull without stereo.
  PCMVS_PRESET_HULL = 2,
  // The fastest preset.
  PCMVS_PRESET_PREVIEW = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_preset pcmvs_preset;
#else
typedef uint32_t pcmvs_preset;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The meshes of a frame. Numbers never change.
enum pcmvs_mesh_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The result: closed and manifold, from `pcmvs_frame_mesh`. It has colours after `pcmvs_frame_colour`.
  PCMVS_MESH_KIND_FINAL = 0,
  // The visual hull, from `pcmvs_frame_hull`.
  PCMVS_MESH_KIND_HULL = 1,
  // The mesh of the coarse pass, from `pcmvs_frame_coarse`. Empty if the preset has no coarse pass.
  PCMVS_MESH_KIND_COARSE = 2,
  // The form of the result that `pcmvs_frame_form` made last. With a texture, a vertex at a border of charts is there once
  // per chart, at the same position.
  PCMVS_MESH_KIND_FORM = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_mesh_kind pcmvs_mesh_kind;
#else
typedef uint32_t pcmvs_mesh_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Attributes of a mesh that can be copied. Numbers never change. Later versions may add attributes; a library that does not
// know an attribute fails with `PCMVS_STATUS_INVALID_ARGUMENT`.
enum pcmvs_attribute
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Per vertex: x, y, z in the scene's frame. Three floats.
  PCMVS_ATTRIBUTE_POSITION = 0,
  // Per vertex: unit normal, pointing outwards. Three floats.
  PCMVS_ATTRIBUTE_NORMAL = 1,
  // Per vertex: red, green, blue in sRGB. Three bytes.
  PCMVS_ATTRIBUTE_COLOUR = 2,
  // Per triangle: its three vertices, counter-clockwise seen from outside. Three `uint32_t`.
  PCMVS_ATTRIBUTE_TRIANGLE = 3,
  // Per vertex of a form with a texture: texture coordinates. (0, 0) is the upper left corner of the picture and (1, 1) the
  // lower right one. Two floats.
  PCMVS_ATTRIBUTE_TEXTURE_COORDINATES = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_attribute pcmvs_attribute;
#else
typedef uint32_t pcmvs_attribute;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The point clouds of a frame. Numbers never change.
enum pcmvs_cloud_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Frontier points, from `pcmvs_frame_contours`.
  PCMVS_CLOUD_KIND_FRONTIER = 0,
  // Implicit points: points of the hull that no camera sees, from `pcmvs_frame_contours`.
  PCMVS_CLOUD_KIND_IMPLICIT = 1,
  // The points of one view, from detection. Available after `pcmvs_frame_merge`.
  PCMVS_CLOUD_KIND_DETECTED = 2,
  // The merged cloud, which becomes the mesh, from `pcmvs_frame_merge`.
  PCMVS_CLOUD_KIND_MERGED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_cloud_kind pcmvs_cloud_kind;
#else
typedef uint32_t pcmvs_cloud_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Kinds of points, from the least to the most trustworthy. Numbers never change.
enum pcmvs_rank
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // On the hull, seen by no camera.
  PCMVS_RANK_IMPLICIT = 0,
  // Placed on the hull where stereo failed.
  PCMVS_RANK_SUBSTITUTED = 1,
  // Found by stereo.
  PCMVS_RANK_DETECTED = 2,
  // A frontier point, which is certainly on the surface.
  PCMVS_RANK_FRONTIER = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_rank pcmvs_rank;
#else
typedef uint32_t pcmvs_rank;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// File formats. Numbers never change.
enum pcmvs_file_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Binary glTF 2.0 with linear vertex colours and an unlit material.
  PCMVS_FILE_FORMAT_GLB = 0,
  // Binary little-endian PLY with sRGB vertex colours.
  PCMVS_FILE_FORMAT_PLY = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_file_format pcmvs_file_format;
#else
typedef uint32_t pcmvs_file_format;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What became of a refinement. Numbers never change.
enum pcmvs_verdict
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The refined cameras agree better with a part of the evidence that was held out.
  PCMVS_VERDICT_IMPROVED = 0,
  // The refined cameras agree no better with it, so that the given ones are kept.
  PCMVS_VERDICT_KEPT = 1,
  // There are too few matches and contours to judge by, so that the given cameras are kept.
  PCMVS_VERDICT_UNDECIDED = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_verdict pcmvs_verdict;
#else
typedef uint32_t pcmvs_verdict;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Checks the cameras of a rig by some frames of a take, and refines them. A rig does not move during a take, so that a few
// frames in which the person stands differently say more than one. Create it, add frames, run it, and read what was found:
// `pcmvs_calibration_get_report` for the whole, `pcmvs_calibration_get_camera_report` for each camera,
// `pcmvs_calibration_get_warning` for what is wrong, and `pcmvs_calibration_get_camera` for the refined cameras, of which a
// new rig can be made.
typedef struct pcmvs_calibration pcmvs_calibration;

// A frame: it takes one picture per camera and turns them into a mesh stage by stage. The handle holds the results and
// can be used for any number of frames, one after the other.
typedef struct pcmvs_frame pcmvs_frame;

// A set of calibrated cameras and the data computed from it. A rig may be shared by any number of frames and threads, and
// may be freed before its frames.
typedef struct pcmvs_rig pcmvs_rig;

// A picture in the caller's memory. It is read only during the call and never written.
typedef struct pcmvs_image {
  // Set by `pcmvs_image_init`.
  uint32_t struct_size;
  // A `pcmvs_pixel_format`.
  uint32_t format;
  // Width in pixels.
  uint32_t width;
  // Height in pixels.
  uint32_t height;
  // First byte of the top row.
  const void *data;
  // Bytes from one row to the row below it. Negative if the rows are stored from the bottom up. 0 means packed rows.
  ptrdiff_t stride;
  // NV12 and P010: first byte of the top row of the Cb, Cr plane. I420: that of the Cb plane.
  const void *chroma;
  // Bytes from one row of that plane to the row below it, as for `stride`.
  ptrdiff_t chroma_stride;
  // I420 only: first byte of the top row of the Cr plane.
  const void *cr;
  // I420 only: bytes from one row of the Cr plane to the row below it, as for `stride`.
  ptrdiff_t cr_stride;
  // A `pcmvs_ycbcr`, for formats with luma.
  uint32_t ycbcr;
  // Zero.
  uint32_t reserved;
} pcmvs_image;

// Parameters that separate the object from a backdrop of one colour. The backdrop need not be evenly lit.
typedef struct pcmvs_chroma_key {
  // Set by `pcmvs_chroma_key_init`.
  uint32_t struct_size;
  // Approximate colour of the backdrop: red, green, blue in sRGB. The fourth byte is zero.
  uint8_t rgb[4];
  // Tolerance in hue, 0 to 1. A pixel belongs to the backdrop if the angle between its colour and the local backdrop's is
  // smaller than this share of the angle between the backdrop's colour and grey.
  float tolerance;
  // Darkest shadow on the backdrop that is recognised, as a share of the local brightness.
  float darkest_shadow;
  // Parts of the object that cover less than this share of the picture are removed.
  float smallest_part;
  // Holes in the object that cover less than this share of the picture are filled.
  float smallest_hole;
} pcmvs_chroma_key;

// One camera's picture and the source of its silhouette. At most one of `mask`, `clean_plate` and `chroma_key` may be set.
// If none is set, the view has no silhouette and does not carve the hull. If `image` is not set either, the camera has no
// picture in this frame: the view contributes nothing, which is a warning of the frame.
typedef struct pcmvs_view {
  // Set by `pcmvs_view_init`.
  uint32_t struct_size;
  // Zero.
  uint32_t reserved;
  // The picture. It has the size for which the camera was calibrated. NULL if the camera has none in this frame.
  const struct pcmvs_image *image;
  // A mask of the same size, white on the object and black elsewhere. Grey values are coverage; the contour is where the
  // coverage is one half. May be NULL.
  const struct pcmvs_image *mask;
  // A picture that the same camera took without the object. May be NULL.
  const struct pcmvs_image *clean_plate;
  // Parameters of a backdrop of one colour. May be NULL.
  const struct pcmvs_chroma_key *chroma_key;
} pcmvs_view;

// Allocates `size` bytes, at least 1, at an address that is a multiple of `alignment`, a power of two. Returns NULL if it
// cannot. The library then takes this block from the C library, and calls that report progress end with
// `PCMVS_STATUS_OUT_OF_MEMORY` at their next step.
typedef void *(*pcmvs_allocate_fn)(void *user, size_t size, size_t alignment);

// Resizes the block at `memory` from `old_size` to `size` bytes, at the same alignment, and returns its new address. The
// contents are kept up to the smaller of the two sizes. Returns NULL if it cannot; the block then stays as it is.
typedef void *(*pcmvs_reallocate_fn)(void *user, void *memory, size_t old_size, size_t size, size_t alignment);

// Frees the block at `memory`. `size` and `alignment` are those of its last allocation or reallocation.
typedef void (*pcmvs_deallocate_fn)(void *user, void *memory, size_t size, size_t alignment);

// Functions that provide the library's memory. They are called on every thread that calls the library, possibly on several
// at once. They must not call the library.
typedef struct pcmvs_allocator {
  // Set by `pcmvs_allocator_init`.
  uint32_t struct_size;
  // Zero.
  uint32_t reserved;
  // Passed to the functions.
  void *user;
  // Allocates memory.
  pcmvs_allocate_fn allocate;
  // Resizes memory. If it is NULL, the library allocates a new block and copies.
  pcmvs_reallocate_fn reallocate;
  // Frees memory.
  pcmvs_deallocate_fn deallocate;
} pcmvs_allocator;

// A calibrated camera in OpenCV's convention. A point X of the scene projects to the pixel `K * distort(R X + t)`. In the
// camera's frame x points right, y down and z forward. The centre of the first pixel is (0, 0). Matrices are stored row
// by row.
typedef struct pcmvs_camera {
  // Set by `pcmvs_camera_init`.
  uint32_t struct_size;
  // Width of the camera's pictures in pixels.
  uint32_t width;
  // Height of the camera's pictures in pixels.
  uint32_t height;
  // Zero.
  uint32_t reserved;
  // Intrinsic matrix K in pixels. The last row is 0 0 1. Skew is allowed.
  double k[9];
  // Distortion coefficients as in OpenCV: k1, k2, p1, p2, k3. Of a fisheye k1, k2, k3, k4, and then 0.
  double distortion[5];
  // Rotation R from the scene's to the camera's frame.
  double r[9];
  // Translation t from the scene's to the camera's frame, in the scene's unit.
  double t[3];
  // A `pcmvs_lens`: the model that the distortion coefficients belong to.
  uint32_t lens;
  // Zero.
  uint32_t reserved_lens;
  // `PCMVS_LENS_OPENCV`: further distortion coefficients k4, k5, k6, s1, s2, s3, s4 of the rational model and the thin
  // prism. Otherwise zero.
  double distortion_more[7];
} pcmvs_camera;

// Describes the last failed call on a handle.
typedef struct pcmvs_error {
  // What the call returned, a `pcmvs_status`. `PCMVS_STATUS_OK` if no call has failed yet.
  uint32_t status;
  // The stage that failed or whose result was asked for, a `pcmvs_stage`. -1 if the failure belongs to no stage.
  int32_t stage;
  // Index of the camera to blame. -1 if it is not known or there is none.
  int32_t camera;
  // Zero.
  int32_t reserved;
  // Number of the frame, as given in `pcmvs_options`. For a calibration, the number of frames that were added before the
  // one at fault. -1 for a rig, and if the failure belongs to no frame.
  int64_t frame;
  // What is wrong and what to do about it, in English. UTF-8 with a final zero.
  char message[PCMVS_MESSAGE_SIZE];
} pcmvs_error;

// Receives progress: `done` of `total` steps of `stage`, a `pcmvs_stage`, are complete. Stages come in their order and
// `done` never decreases within a stage. Return 0 to continue. Any other value cancels: the call then returns
// `PCMVS_STATUS_CANCELLED` as soon as it can and does not call back again.
//
// Called only on the thread that made the call. It must not throw. Of the functions that take the frame or calibration, it
// may call `pcmvs_frame_error` and `pcmvs_calibration_error`; others fail with `PCMVS_STATUS_BUSY` if the running call
// excludes them.
typedef int (*pcmvs_progress_fn)(void *user, uint32_t stage, uint32_t done, uint32_t total);

// Runs one of the library's jobs. Call it with `job` and the job's index.
typedef void (*pcmvs_job_fn)(void *job, uint32_t index);

// Runs jobs on the caller's threads. It calls `run(job, i)` once for every `i` from 0 to `count - 1`, on any threads and
// in any order, and returns when all of these calls have returned. The library runs jobs that were left out on the
// calling thread. If the function returns earlier, the library waits for the jobs that have started; a call of `run` that
// comes later does nothing. Results do not depend on the threads. It must not throw.
typedef void (*pcmvs_parallel_fn)(void *user, uint32_t count, pcmvs_job_fn run, void *job);

// Options for a frame. If every member but `struct_size` is zero, these are the defaults.
typedef struct pcmvs_options {
  // Set by `pcmvs_options_init`.
  uint32_t struct_size;
  // A `pcmvs_preset`.
  uint32_t preset;
  // Number of the frame. It appears in errors and has no other effect.
  uint32_t frame;
  // Spacing of the grid on which the final mesh is computed, in pixels of footprint: 0.25 to 100, or 0 for the
  // preset's own. A footprint is the size of a pixel at the object.
  float voxel_pixels;
  // Called as the work advances. May be NULL.
  pcmvs_progress_fn progress;
  // Passed to `progress`.
  void *progress_user;
  // Runs jobs on the caller's threads. If it is NULL, all work runs on the calling thread.
  pcmvs_parallel_fn parallel;
  // Passed to `parallel`.
  void *parallel_user;
  // Largest amount of memory that the frame may need on one thread, in bytes, not counting the caller's pictures. Copies
  // of them count: of pictures that are stored from the bottom up or have 16 bits.
  // 0 means no limit. A frame that needs more fails with `PCMVS_STATUS_OUT_OF_MEMORY` before it allocates the memory,
  // and the message says how much it needs. With a limit, working memory is freed after each stage. Without one it is
  // kept for the next frame, which is faster but can take up to twice as much.
  uint64_t max_memory;
} pcmvs_options;

// A mesh in the frame's memory. The arrays are packed and stay valid until the next call on the frame that takes a
// non-const `pcmvs_frame *`. Later versions may add members at the end.
typedef struct pcmvs_mesh {
  // Number of vertices.
  uint32_t vertex_count;
  // Number of triangles.
  uint32_t triangle_count;
  // x, y, z per vertex, relative to `origin`.
  const float *positions;
  // Unit normal per vertex, pointing outwards.
  const float *normals;
  // Red, green, blue per vertex in sRGB. NULL if the mesh has no colours.
  const uint8_t *colours;
  // Three vertices per triangle, counter-clockwise seen from outside.
  const uint32_t *triangles;
  // The origin of `positions` in the scene's frame.
  double origin[3];
  // Texture coordinates per vertex, two floats each. NULL if the mesh has none. See `pcmvs_frame_get_texture`.
  const float *texture_coordinates;
} pcmvs_mesh;

// A point of a cloud.
typedef struct pcmvs_point {
  // x, y, z relative to `pcmvs_rig_origin`.
  float position[3];
  // Unit normal, pointing outwards.
  float normal[3];
  // How well the neighbouring views agree, from 0 to the number of neighbours.
  float fidelity;
  // Weight in meshing.
  float weight;
  // Index of the camera that sees the point. -1 for implicit points.
  int32_t camera;
  // A `pcmvs_rank`.
  uint32_t rank;
} pcmvs_point;

// A view's silhouette in the frame's memory, undistorted. Stays valid until the next call on the frame that takes a
// non-const `pcmvs_frame *`.
typedef struct pcmvs_silhouette {
  // Width in pixels.
  uint32_t width;
  // Height in pixels.
  uint32_t height;
  // Signed distance of each pixel to the contour, positive inside the object, in packed rows from the top down. From
  // -16384 to 16384 it is in 1/64 pixel. Each step beyond that is 4 pixels, rounded towards the contour: a larger d stands
  // for 256 + 4 (d - 16384) pixels. 32767 where undistortion has no source pixel.
  const int16_t *distances;
} pcmvs_silhouette;

// Which form of the finished mesh to make.
typedef struct pcmvs_form_options {
  // Set by `pcmvs_form_options_init`.
  uint32_t struct_size;
  // Largest number of triangles. More remain if fewer would change the surface visibly. 0, the default, keeps them all.
  uint32_t faces;
  // 1 to make a texture, which replaces the colours of vertices. The default is 0.
  uint32_t texture;
  // Texels along a side of the texture, 64 to 16384. 0, the default, chooses the smallest power of two that keeps the detail
  // of the photographs, at most 8192.
  uint32_t texture_size;
} pcmvs_form_options;

// The texture of a form, in the frame's memory. The picture stays valid until the next call on the frame that takes a
// non-const `pcmvs_frame *`.
typedef struct pcmvs_texture {
  // Width in texels.
  uint32_t width;
  // Height in texels.
  uint32_t height;
  // Red, green and blue of each texel in sRGB, in packed rows from the top down.
  const uint8_t *texels;
} pcmvs_texture;

// Options for exporting a mesh.
//
// GLB files can be compressed by meshoptimizer (EXT_meshopt_compression), which the library does not contain. To compress,
// link meshoptimizer 1.0 or later and set each of the members `meshopt_...` to its function of the same name. By default
// they are NULL, and files are not compressed. If some are NULL and others not, exporting fails with
// `PCMVS_STATUS_NULL_POINTER`, and if one gives a result that meshoptimizer does not give, with
// `PCMVS_STATUS_INVALID_ARGUMENT`. They are called on the thread that made the call. With `compact` = 1 and `normals` = 0 the
// file is that of the command line's `--compress`. Its vertices and triangles are in another order than those that
// `pcmvs_frame_get_mesh` gives.
typedef struct pcmvs_export_options {
  // Set by `pcmvs_export_options_init`.
  uint32_t struct_size;
  // A `pcmvs_file_format`.
  uint32_t format;
  // 1, the default, to write normals, 0 to leave them out. PLY files always have them: 0 is refused.
  uint32_t normals;
  // 1 if `up` is set, otherwise 0. The default is 0.
  uint32_t has_up;
  // The scene's upward direction, which GLB files record for players. Coordinates are not changed. PLY files have no place
  // for it.
  double up[3];
  // GLB only: 1 to turn the mesh's node so that `up` becomes glTF's +y, which players show upright. Needs `has_up`.
  // Otherwise 0, the default: the file is in the scene's frame. PLY files are always in that frame: 1 is refused.
  uint32_t upright;
  // GLB only: 1 to write integers of few bits instead of single-precision numbers (KHR_mesh_quantization). The default is 0.
  // For PLY files 1 is refused.
  uint32_t compact;
  // Quality of a texture's JPEG picture, 1 to 100. The default is 90. It changes nothing in files without a texture.
  uint32_t jpeg_quality;
  // Zero.
  uint32_t reserved;
  // Sorts triangles so that neighbours follow each other.
  void (*meshopt_optimizeVertexCacheStrip)(unsigned int *destination,
                                           const unsigned int *indices,
                                           size_t index_count,
                                           size_t vertex_count);
  // Puts vertices in the order in which triangles use them.
  size_t (*meshopt_optimizeVertexFetchRemap)(unsigned int *destination,
                                             const unsigned int *indices,
                                             size_t index_count,
                                             size_t vertex_count);
  // Largest size of encoded vertices, in bytes.
  size_t (*meshopt_encodeVertexBufferBound)(size_t vertex_count, size_t vertex_size);
  // Encodes vertices.
  size_t (*meshopt_encodeVertexBufferLevel)(unsigned char *buffer,
                                            size_t buffer_size,
                                            const void *vertices,
                                            size_t vertex_count,
                                            size_t vertex_size,
                                            int level,
                                            int version);
  // Largest size of encoded triangles, in bytes.
  size_t (*meshopt_encodeIndexBufferBound)(size_t index_count, size_t vertex_count);
  // Encodes triangles.
  size_t (*meshopt_encodeIndexBuffer)(unsigned char *buffer,
                                      size_t buffer_size,
                                      const unsigned int *indices,
                                      size_t index_count);
} pcmvs_export_options;

// Receives the next `size` bytes of a file. Return 0 to continue, or any other value to make the export fail with
// `PCMVS_STATUS_WRITE_FAILED`. Called one or more times, on the thread that made the call. It must not throw. It may call
// functions that take a `const pcmvs_frame *`; others fail with `PCMVS_STATUS_BUSY`.
typedef int (*pcmvs_write_fn)(void *user, const void *data, size_t size);

// What the stages of a frame counted.
typedef struct pcmvs_counts {
  // Points found by stereo.
  uint32_t detected;
  // Points placed on the hull where stereo failed.
  uint32_t substituted;
  // Points removed by the density constraint.
  uint32_t cleaned_density;
  // Points removed by the PCA constraint, which asks for a locally flat surface.
  uint32_t cleaned_pca;
  // Points removed by the normal constraint.
  uint32_t cleaned_normal;
  // Frontier points.
  uint32_t frontier;
  // Implicit points.
  uint32_t implicit;
  // Points dropped in merging because of their normals.
  uint32_t dropped_normal;
  // Points dropped in merging in favour of a neighbour with higher fidelity.
  uint32_t dropped_fidelity;
  // Points removed because they conflict with another point in a camera's view.
  uint32_t conflicts_cameras;
  // Points removed because they conflict with another point in a virtual view.
  uint32_t conflicts_virtual;
  // Implicit points removed because they occlude a valid point.
  uint32_t implicit_removed;
  // Points of the merged cloud.
  uint32_t merged;
  // Small components removed from the mesh.
  uint32_t components_dropped;
  // Vertices of the final mesh.
  uint32_t vertices;
  // Triangles of the final mesh.
  uint32_t faces;
} pcmvs_counts;

// What one stage took and made.
typedef struct pcmvs_stage_report {
  // Wall-clock seconds of all calls that did the stage's work, added up. 0 if the preset leaves the stage out.
  double seconds;
  // A hash of the stage's result. It is the same on every machine and with any number of threads.
  uint64_t hash;
} pcmvs_stage_report;

// Diagnostics of one camera's view. Members of stages that have not run are zero. Later versions may add members at the
// end.
typedef struct pcmvs_view_report {
  // 1 if the view has a silhouette and therefore carves the hull, otherwise 0. A view that is not used does not carve, and
  // neither does a silhouette that is set aside.
  uint32_t carves;
  // Share of the picture that is inside the silhouette, 0 to 1. 0 without a silhouette.
  float inside;
  // Points of the view that stereo found and cleaning kept.
  uint32_t detected;
  // Points of the view that were placed on the hull where stereo failed, and that cleaning kept.
  uint32_t substituted;
  // Factors applied to the picture's red, green and blue when the mesh was coloured.
  float gains[3];
  // Zero.
  uint32_t reserved;
  // 1 if the view takes part in the frame, otherwise 0: it has no picture, its silhouette is empty or inverted, the
  // object lies beside it, or it contradicts the other views. A warning of the frame tells which.
  uint32_t used;
  // Intersection over union of the silhouette and the visual hull's picture, 0 to 1. -1 if it could not be measured: no
  // silhouette, or one that fills the picture.
  float silhouette_overlap;
  // Median distance of the hull's outline in the picture from the silhouette's contour, in pixels. -1 if it could not be
  // measured: no silhouette, or one that fills the picture.
  float contour_px;
  // Median distance of a few matches with other views from their epipolar lines, in pixels: how far off the calibration
  // is. 0 before `pcmvs_frame_merge`, and -1 if it could not be measured: no stereo, or too few matches.
  float epipolar_px;
} pcmvs_view_report;

// Something in a frame that may make its result worse although no call failed, or something wrong with a calibration.
typedef struct pcmvs_warning {
  // Index of the camera that the warning is about, of the later one if it is about two. -1 if it is not about one or
  // two cameras.
  int32_t camera;
  // Zero.
  uint32_t reserved;
  // The kind of warning, such as "no-silhouette" or "no-stereo-points". A code never changes; later versions may add
  // codes. ASCII with a final zero.
  char code[PCMVS_CODE_SIZE];
  // What is wrong and what to do about it, in English. UTF-8 with a final zero.
  char message[PCMVS_MESSAGE_SIZE];
} pcmvs_warning;

// Options for a calibration. If every member but `struct_size` is zero, these are the defaults.
typedef struct pcmvs_calibration_options {
  // Set by `pcmvs_calibration_options_init`.
  uint32_t struct_size;
  // 1 to refine focal lengths and principal points too, 0 to keep them. Rings of few cameras determine them weakly.
  uint32_t intrinsics;
  // Called as the work advances, with `PCMVS_STAGE_VIEWS` while views are read and `PCMVS_STAGE_DETECT` while the cameras
  // are refined. May be NULL.
  pcmvs_progress_fn progress;
  // Passed to `progress`.
  void *progress_user;
  // Runs jobs on the caller's threads. If it is NULL, all work runs on the calling thread.
  pcmvs_parallel_fn parallel;
  // Passed to `parallel`.
  void *parallel_user;
} pcmvs_calibration_options;

// What a calibration found about the cameras as a whole. Figures that could not be measured are -1. Later versions may add
// members at the end.
typedef struct pcmvs_calibration_report {
  // A `pcmvs_verdict`.
  uint32_t verdict;
  // Number of frames that were used.
  uint32_t frames;
  // Number of points that were matched in two or more views.
  uint32_t points;
  // Distance of matches from their epipolar lines with the given cameras, in pixels: the mean over all pairs of
  // neighbouring cameras of the median, so that the noise of single matches does not count.
  float epipolar_bias_px;
  // The same with the refined cameras.
  float refined_epipolar_bias_px;
  // Mean loss over the evidence that was held out, with the given cameras. Smaller is better; it has no unit.
  float held_out_loss;
  // The same with the refined cameras.
  float refined_held_out_loss;
  // Indices of two cameras whose pictures seem to be exchanged, in ascending order. -1 if there are none.
  int32_t exchanged[2];
} pcmvs_calibration_report;

// What a calibration found about one camera. Figures that could not be measured are -1. Figures of the refined camera are
// there even if the given one is kept. Later versions may add members at the end.
typedef struct pcmvs_camera_report {
  // Intersection over union of the camera's silhouette and the visual hull of all cameras as given, 0 to 1: the mean over
  // the frames.
  float silhouette_overlap;
  // Brightness of its pictures over the mean of all cameras.
  float gain;
  // Median distance by which the tangents from other silhouettes miss this camera's silhouette, in pixels, with the given
  // cameras.
  float contour_px;
  // The same with the refined cameras.
  float refined_contour_px;
  // Median distance of this camera's matches from their epipolar lines, in pixels, with the given cameras.
  float epipolar_px;
  // The same with the refined cameras.
  float refined_epipolar_px;
  // How precise single matches are whatever the calibration is: robust standard deviation in pixels.
  float match_noise_px;
  // Number of matches of this camera with others.
  uint32_t matches;
  // How far the refinement moves the object in this camera's picture, as the root of the mean square, in pixels.
  float moved_px;
  // Standard deviation of where the refined camera sees the object, in pixels.
  float sigma_px;
  // Standard deviation of the refined camera's direction, in pixels.
  float direction_sigma_px;
  // Standard deviation of its roll, in pixels at a quarter of the picture's width from the middle.
  float roll_sigma_px;
  // Standard deviation of its centre across the line of sight, in pixels of footprint. It is correlated with that of the
  // direction, because a turn and a shift look nearly alike: `sigma_px` is what counts.
  float centre_sigma_px;
} pcmvs_camera_report;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Returns the version of the running library in the form of `PCMVS_VERSION`. It may be newer than the header.
uint32_t pcmvs_version(void);

// Returns the version of the running library as text, such as "0.2.0". The string is static.
const char *pcmvs_version_string(void);

// Finds out whether a finished frame may have lost a part, such as an arm, that the frames before and after it have, because
// many or all of its masks lack it. Writes 1 to `may_have` if so, otherwise 0. `before` and `after` are other handles of
// finished frames, of rigs with the same cameras. Their meshes as they were before `pcmvs_frame_steady` count. If the answer
// is 1, make the frame again on another handle, with `pcmvs_frame_view_between` for every camera. This function reads no
// pictures, and its answer is nearly always 0. Fails with `PCMVS_STATUS_WRONG_ORDER` unless all frames are complete.
pcmvs_status pcmvs_frame_may_have_lost_part(const struct pcmvs_frame *frame,
                                            const struct pcmvs_frame *before,
                                            const struct pcmvs_frame *after,
                                            uint32_t *may_have);

// `pcmvs_frame_view` with the same camera's views of the frames before and after. Parts that the silhouette lacks and those of
// both other frames have are added to it, if the picture shows them: in the part's colours, and different from the background
// that the other frames show there. Writes the number of pixels that were added to `restored`, which may be NULL. If it is 0
// for all cameras, the frame has lost nothing. If one of the three views has no picture, nothing is added. May be called on
// several threads at once, for different cameras.
pcmvs_status pcmvs_frame_view_between(struct pcmvs_frame *frame,
                                      uint32_t camera,
                                      const struct pcmvs_view *view,
                                      const struct pcmvs_view *before,
                                      const struct pcmvs_view *after,
                                      uint32_t *restored);

// Returns the English name of a status for logs, or "unknown" for a number of another version. The string is static.
const char *pcmvs_status_name(uint32_t status);

// Averages a finished mesh with those of neighbouring frames, such as the one before and the one after it, along surfaces that
// move with the subject, so that surfaces and colours are steady in time. `neighbours` are at most 16 other handles of finished
// frames, of rigs with the same cameras. The mesh of each as it was before this function counts, so that the order in which
// frames are averaged does not matter. `PCMVS_MESH_KIND_FINAL`, forms and files then have the mean; a later call replaces it,
// and without neighbours the frame has its own mesh again. Discards the form. The command line averages each frame with one
// before and one after it. The neighbours are in use only at the beginning of the call. Fails with `PCMVS_STATUS_WRONG_ORDER`
// unless all frames are complete. On failure nothing but the form changes.
pcmvs_status pcmvs_frame_steady(struct pcmvs_frame *frame,
                                const struct pcmvs_frame *const *neighbours,
                                size_t count);

// Returns the number of stages that this library runs for a frame.
uint32_t pcmvs_stage_count(void);

// Returns the stage that runs at a place of the order, from 0 to `pcmvs_stage_count() - 1`, and `PCMVS_NO_STAGE`
// beyond that.
uint32_t pcmvs_stage_at(uint32_t index);

// Returns the name of a stage as in reports ("views", "hull" and so on), or "unknown" for a number that this library
// does not know. The string is static.
const char *pcmvs_stage_name(uint32_t stage);

// Initialises an allocator without functions. `size` is `sizeof *allocator`.
pcmvs_status pcmvs_allocator_init(struct pcmvs_allocator *allocator, size_t size);

// Makes the library take all of its memory from the caller's functions, in the whole process and until it ends. Call it
// before every function other than `pcmvs_..._init`, `pcmvs_version...`, `pcmvs_status_name` and `pcmvs_stage_...`: once
// the library has allocated memory or has an allocator, it fails with `PCMVS_STATUS_WRONG_ORDER`. Any other call, and any
// call that fails, may allocate. `allocator` is read only during the call; `user` must stay valid while the process uses
// the library.
pcmvs_status pcmvs_set_allocator(const struct pcmvs_allocator *allocator);

// Initialises a camera with identity matrices and no distortion. `size` is `sizeof *camera`.
pcmvs_status pcmvs_camera_init(struct pcmvs_camera *camera, size_t size);

// Creates a rig without cameras. Free it with `pcmvs_rig_free`.
pcmvs_status pcmvs_rig_new(struct pcmvs_rig **rig);

// Frees a rig. NULL is ignored.
pcmvs_status pcmvs_rig_free(struct pcmvs_rig *rig);

// Sets the cameras of a rig, 3 to `PCMVS_MAX_CAMERAS`, and computes everything that its frames share. The views of every
// frame are numbered in the order of `cameras`. On failure the rig keeps the cameras it had. Existing frames keep the
// cameras with which they were created.
pcmvs_status pcmvs_rig_set_cameras(struct pcmvs_rig *rig,
                                   const struct pcmvs_camera *cameras,
                                   size_t count);

// Fixes the gains of a rig's cameras: the factors applied to red, green and blue when a mesh is coloured. `gains` holds
// three floats per camera, `count` is the number of cameras. Without fixed gains every frame estimates its own, and
// colours may vary slightly from frame to frame. `pcmvs_frame_copy_gains` returns the gains of a frame.
// `pcmvs_rig_set_cameras` removes fixed gains. Existing frames keep the gains that the rig had when they were created.
pcmvs_status pcmvs_rig_set_gains(struct pcmvs_rig *rig,
                                 const float *gains,
                                 size_t count);

// Returns the number of cameras, which is 0 before they are set.
pcmvs_status pcmvs_rig_camera_count(const struct pcmvs_rig *rig, uint32_t *count);

// Returns the origin of the positions in `pcmvs_mesh` and `pcmvs_point`: x, y, z in the scene's frame. `xyz` has room for
// three doubles.
pcmvs_status pcmvs_rig_origin(const struct pcmvs_rig *rig,
                              double *xyz);

// Describes the last failed call on a rig, including `pcmvs_frame_new`. If this function itself fails, the description
// stays as it is. `size` is `sizeof *error`.
pcmvs_status pcmvs_rig_error(const struct pcmvs_rig *rig,
                             struct pcmvs_error *error,
                             size_t size);

// Initialises a picture: RGB, packed rows, no size and no data. `size` is `sizeof *image`.
pcmvs_status pcmvs_image_init(struct pcmvs_image *image, size_t size);

// Initialises a chroma key for a green backdrop. `size` is `sizeof *key`.
pcmvs_status pcmvs_chroma_key_init(struct pcmvs_chroma_key *key, size_t size);

// Initialises a view without a picture. `size` is `sizeof *view`.
pcmvs_status pcmvs_view_init(struct pcmvs_view *view, size_t size);

// Initialises options with their defaults. `size` is `sizeof *options`.
pcmvs_status pcmvs_options_init(struct pcmvs_options *options, size_t size);

// Creates a frame for a rig whose cameras have been set. Free it with `pcmvs_frame_free`. If this fails,
// `pcmvs_rig_error` says why.
pcmvs_status pcmvs_frame_new(const struct pcmvs_rig *rig, struct pcmvs_frame **frame);

// Frees a frame and everything that pointers obtained from it point to. NULL is ignored. Fails with `PCMVS_STATUS_BUSY`
// while a call on the frame is running.
pcmvs_status pcmvs_frame_free(struct pcmvs_frame *frame);

// Begins a frame and runs all of its stages. `views` holds one view per camera, in the order in which the cameras were
// given to `pcmvs_rig_set_cameras`, and `count` must be the number of cameras. `options` may be NULL. On failure the
// frame has no results, not even those of the frame before; the handle can be used again. Only if the call could not begin
// (`PCMVS_STATUS_BUSY`) nothing changes.
pcmvs_status pcmvs_frame_reconstruct(struct pcmvs_frame *frame,
                                     const struct pcmvs_view *views,
                                     size_t count,
                                     const struct pcmvs_options *options);

// Begins a frame that is to be made stage by stage, and discards the results of the one before. `options` may be NULL. On
// failure nothing changes.
pcmvs_status pcmvs_frame_begin(struct pcmvs_frame *frame,
                               const struct pcmvs_options *options);

// Reads the picture and silhouette of one camera, or takes note that it has none in this frame. A second call for the
// same camera replaces them, until the stage `PCMVS_STAGE_VIEWS` is complete. May be called on several threads at once,
// for different cameras.
pcmvs_status pcmvs_frame_view(struct pcmvs_frame *frame,
                              uint32_t camera,
                              const struct pcmvs_view *view);

// Runs one stage, a `pcmvs_stage`. The stages before it that have not run yet run first; detection then covers the views
// for which `pcmvs_frame_detect` has not been called. Only the views must be there: every camera needs its
// `pcmvs_frame_view`. Running a stage again discards the results of the stages after it.
pcmvs_status pcmvs_frame_step(struct pcmvs_frame *frame,
                              uint32_t stage);

// Carves the visual hull. The same as `pcmvs_frame_step` with `PCMVS_STAGE_HULL`.
pcmvs_status pcmvs_frame_hull(struct pcmvs_frame *frame);

// Finds the points that follow from the silhouettes alone. The same as `pcmvs_frame_step` with `PCMVS_STAGE_CONTOURS`.
pcmvs_status pcmvs_frame_contours(struct pcmvs_frame *frame);

// Detects and meshes at reduced resolution, then runs every further stage that comes before detection. After it,
// `pcmvs_frame_detect` can be called.
pcmvs_status pcmvs_frame_coarse(struct pcmvs_frame *frame);

// Detects the points of one camera's view by stereo with its neighbours. Fails with `PCMVS_STATUS_WRONG_ORDER` until all
// stages before detection are complete, which `pcmvs_frame_coarse` ensures. May be called on several threads at once,
// for different cameras; the result does not depend on threads or order.
pcmvs_status pcmvs_frame_detect(struct pcmvs_frame *frame,
                                uint32_t camera);

// Merges all points into one cloud. The same as `pcmvs_frame_step` with `PCMVS_STAGE_MERGE`.
pcmvs_status pcmvs_frame_merge(struct pcmvs_frame *frame);

// Turns the merged cloud into a closed mesh. The same as `pcmvs_frame_step` with `PCMVS_STAGE_MESH`.
pcmvs_status pcmvs_frame_mesh(struct pcmvs_frame *frame);

// Colours the mesh, then runs every stage after that. After it the frame is complete.
pcmvs_status pcmvs_frame_colour(struct pcmvs_frame *frame);

// Describes the last failed call on a frame, including calls that only read results. If this function itself fails,
// the description stays as it is. `size` is `sizeof *error`.
pcmvs_status pcmvs_frame_error(const struct pcmvs_frame *frame,
                               struct pcmvs_error *error,
                               size_t size);

// Returns pointers to a mesh in the frame's memory, without copying it. `kind` is a `pcmvs_mesh_kind`. `size` is
// `sizeof *mesh`.
pcmvs_status pcmvs_frame_get_mesh(const struct pcmvs_frame *frame,
                                  uint32_t kind,
                                  struct pcmvs_mesh *mesh,
                                  size_t size);

// Copies one attribute of a mesh to the caller's memory. `kind` is a `pcmvs_mesh_kind`, `attribute` a `pcmvs_attribute`.
// `buffer` has room for `capacity` elements, which start `stride` bytes apart; a `stride` of 0 means that they are packed.
// The bytes between elements are not written. `count` receives the number of elements and may be NULL. With a NULL
// `buffer` and a `capacity` of 0 the function only writes `count`.
pcmvs_status pcmvs_frame_copy_mesh(const struct pcmvs_frame *frame,
                                   uint32_t kind,
                                   uint32_t attribute,
                                   void *buffer,
                                   size_t capacity,
                                   size_t stride,
                                   size_t *count);

// Copies a cloud to the caller's memory. `kind` is a `pcmvs_cloud_kind`; `camera` selects one of the detected clouds and
// is ignored otherwise. `buffer`, `capacity`, `stride` and `count` are as in `pcmvs_frame_copy_mesh`. A cloud whose stage
// the preset leaves out is empty.
pcmvs_status pcmvs_frame_copy_cloud(const struct pcmvs_frame *frame,
                                    uint32_t kind,
                                    uint32_t camera,
                                    struct pcmvs_point *buffer,
                                    size_t capacity,
                                    size_t stride,
                                    size_t *count);

// Returns a pointer to a view's silhouette in the frame's memory, once `PCMVS_STAGE_VIEWS` is complete. Fails with
// `PCMVS_STATUS_WRONG_ORDER` if the view has no silhouette. `size` is `sizeof *silhouette`. It is smaller than the picture,
// by a power of two, where the picture was read at a lower resolution: with the preset `preview`, or because it is blurred.
pcmvs_status pcmvs_frame_get_silhouette(const struct pcmvs_frame *frame,
                                        uint32_t camera,
                                        struct pcmvs_silhouette *silhouette,
                                        size_t size);

// Initialises form options with their defaults: the mesh as it is. `size` is `sizeof *options`.
pcmvs_status pcmvs_form_options_init(struct pcmvs_form_options *options, size_t size);

// Makes a form of the finished mesh, in the place of the last one. Read it as `PCMVS_MESH_KIND_FORM`, its texture with
// `pcmvs_frame_get_texture`, and write it with `pcmvs_frame_export_mesh`. Any number of forms can be made one after the other;
// the finished mesh stays as it is. Fails with `PCMVS_STATUS_WRONG_ORDER` until the frame is complete. On failure there is no
// form. The next frame, and running a stage again, discard it.
pcmvs_status pcmvs_frame_form(struct pcmvs_frame *frame,
                              const struct pcmvs_form_options *options);

// Returns the texture of the form that was made last, without copying it. Fails with `PCMVS_STATUS_WRONG_ORDER` if there is
// none. `size` is `sizeof *texture`.
pcmvs_status pcmvs_frame_get_texture(const struct pcmvs_frame *frame,
                                     struct pcmvs_texture *texture,
                                     size_t size);

// Initialises export options with their defaults: GLB with normals. `size` is `sizeof *options`.
pcmvs_status pcmvs_export_options_init(struct pcmvs_export_options *options, size_t size);

// Writes a mesh as a file to a callback. `kind` is a `pcmvs_mesh_kind`. `options` may be NULL. `user` is passed to `write`.
pcmvs_status pcmvs_frame_export_mesh(const struct pcmvs_frame *frame,
                                     uint32_t kind,
                                     const struct pcmvs_export_options *options,
                                     pcmvs_write_fn write,
                                     void *user);

// Writes a mesh as a file to a buffer of `capacity` bytes. `size` receives the file's size in bytes and may be NULL. With
// a NULL `buffer` and a `capacity` of 0 the function only writes `size`. That takes as long as writing the file;
// `pcmvs_frame_export_mesh` needs one call only. `options` may be NULL.
pcmvs_status pcmvs_frame_export_mesh_to_buffer(const struct pcmvs_frame *frame,
                                               uint32_t kind,
                                               const struct pcmvs_export_options *options,
                                               void *buffer,
                                               size_t capacity,
                                               size_t *size);

// Writes a cloud as a PLY file to a callback. `kind` and `camera` are as in `pcmvs_frame_copy_cloud`. `user` is passed to
// `write`.
pcmvs_status pcmvs_frame_export_cloud(const struct pcmvs_frame *frame,
                                      uint32_t kind,
                                      uint32_t camera,
                                      pcmvs_write_fn write,
                                      void *user);

// Returns what the stages of a frame counted, once `pcmvs_frame_colour` has run. `size` is `sizeof *counts`.
pcmvs_status pcmvs_frame_get_counts(const struct pcmvs_frame *frame,
                                    struct pcmvs_counts *counts,
                                    size_t size);

// Returns what a stage, a `pcmvs_stage`, took and made. Fails with `PCMVS_STATUS_WRONG_ORDER` if the stage is not
// complete. `size` is `sizeof *report`.
pcmvs_status pcmvs_frame_get_stage_report(const struct pcmvs_frame *frame,
                                          uint32_t stage,
                                          struct pcmvs_stage_report *report,
                                          size_t size);

// Returns diagnostics of one camera's view, once `PCMVS_STAGE_VIEWS` is complete. `size` is `sizeof *report`.
pcmvs_status pcmvs_frame_get_view_report(const struct pcmvs_frame *frame,
                                         uint32_t camera,
                                         struct pcmvs_view_report *report,
                                         size_t size);

// Copies the gains with which a frame was coloured, once `pcmvs_frame_colour` has run: three floats per camera, as in
// `pcmvs_rig_set_gains`. `capacity` and `count` are in cameras; `buffer`, `capacity`, `stride` and `count` are as in
// `pcmvs_frame_copy_mesh`.
pcmvs_status pcmvs_frame_copy_gains(const struct pcmvs_frame *frame,
                                    float *buffer,
                                    size_t capacity,
                                    size_t stride,
                                    size_t *count);

// Returns the number of warnings about the cameras and about the stages that are complete. After a stage has failed, the
// warnings about the views remain.
pcmvs_status pcmvs_frame_warning_count(const struct pcmvs_frame *frame,
                                       uint32_t *count);

// Returns a warning. `index` is less than `pcmvs_frame_warning_count`; warnings about the cameras come first, then those of
// the stages in their order, and for each stage those of the cameras in theirs. `size` is `sizeof *warning`.
pcmvs_status pcmvs_frame_get_warning(const struct pcmvs_frame *frame,
                                     uint32_t index,
                                     struct pcmvs_warning *warning,
                                     size_t size);

// Initialises options with their defaults. `size` is `sizeof *options`.
pcmvs_status pcmvs_calibration_options_init(struct pcmvs_calibration_options *options, size_t size);

// Creates a calibration without frames for a rig whose cameras have been set. Free it with `pcmvs_calibration_free`. It
// keeps the cameras that the rig has now, and the rig may be freed before it. If this fails, `pcmvs_rig_error` says why.
pcmvs_status pcmvs_calibration_new(const struct pcmvs_rig *rig,
                                   struct pcmvs_calibration **calibration);

// Frees a calibration. NULL is ignored. Fails with `PCMVS_STATUS_BUSY` while a call on the calibration is running.
pcmvs_status pcmvs_calibration_free(struct pcmvs_calibration *calibration);

// Adds a frame of the take: reads its pictures and silhouettes, which the caller may change or free afterwards. `views` holds
// one view per camera, in the order in which the cameras were given to `pcmvs_rig_set_cameras`, and `count` must be the
// number of cameras. A camera without picture in this frame contributes nothing to it. Matching works inside the
// silhouettes, so that a view without one contributes little. `options` may be NULL; only its threads and its progress are
// used. The calibration keeps about three bytes per pixel of every view. Results from before are discarded. On failure
// nothing is added.
pcmvs_status pcmvs_calibration_add_frame(struct pcmvs_calibration *calibration,
                                         const struct pcmvs_view *views,
                                         size_t count,
                                         const struct pcmvs_calibration_options *options);

// Checks and refines the cameras by all frames that have been added. `options` may be NULL. More frames can be added
// afterwards, and the call can be repeated. On failure the calibration keeps its frames and has no results.
//
// If two cameras' pictures are exchanged, the warning "cameras-swapped" and `pcmvs_calibration_report` name them. Their
// views were read with each other's lens, so that no refinement can make up for it: exchange their pictures and masks, and
// add the frames to a new calibration.
pcmvs_status pcmvs_calibration_run(struct pcmvs_calibration *calibration,
                                   const struct pcmvs_calibration_options *options);

// Describes the last failed call on a calibration, including calls that only read results. If this function itself fails,
// the description stays as it is. `size` is `sizeof *error`.
pcmvs_status pcmvs_calibration_error(const struct pcmvs_calibration *calibration,
                                     struct pcmvs_error *error,
                                     size_t size);

// Returns what a calibration found about the cameras as a whole, once `pcmvs_calibration_run` has succeeded. `size` is
// `sizeof *report`.
pcmvs_status pcmvs_calibration_get_report(const struct pcmvs_calibration *calibration,
                                          struct pcmvs_calibration_report *report,
                                          size_t size);

// Returns what a calibration found about one camera, once `pcmvs_calibration_run` has succeeded. `size` is
// `sizeof *report`.
pcmvs_status pcmvs_calibration_get_camera_report(const struct pcmvs_calibration *calibration,
                                                 uint32_t camera,
                                                 struct pcmvs_camera_report *report,
                                                 size_t size);

// Returns a camera to go on with, once `pcmvs_calibration_run` has succeeded: the refined one if the verdict is
// `PCMVS_VERDICT_IMPROVED`, else the given one. `index` counts the cameras as they were given to `pcmvs_rig_set_cameras`,
// which takes the result. `size` is `sizeof *camera`, and the camera need not be initialised.
pcmvs_status pcmvs_calibration_get_camera(const struct pcmvs_calibration *calibration,
                                          uint32_t index,
                                          struct pcmvs_camera *camera,
                                          size_t size);

// Returns the number of warnings: what is wrong with the given cameras, once `pcmvs_calibration_run` has succeeded.
pcmvs_status pcmvs_calibration_warning_count(const struct pcmvs_calibration *calibration,
                                             uint32_t *count);

// Returns a warning. `index` is less than `pcmvs_calibration_warning_count`. Its code is "camera-bumped",
// "focal-length-wrong", "distortion-wrong", "cameras-swapped", "camera-contradicts", "silhouette-set-aside",
// "calibration-inconsistent", "contours-beside-edges", "contours-across-edges", "contour-beside-edge",
// "contour-across-edge", "contour-without-edge" or "picture-blurred"; later versions may add codes. `size` is `sizeof *warning`.
pcmvs_status pcmvs_calibration_get_warning(const struct pcmvs_calibration *calibration,
                                           uint32_t index,
                                           struct pcmvs_warning *warning,
                                           size_t size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PCMVS_H */
