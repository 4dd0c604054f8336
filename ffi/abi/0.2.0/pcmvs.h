/*
 * libpcmvs: multi-view stereo for free-viewpoint video. From the pictures of a ring of calibrated cameras, taken at
 * one instant, to a closed, coloured triangle mesh. The same bytes on every machine.
 *
 * This file is the reference manual. It is generated: do not edit it.
 *
 * A frame, in short:
 *
 *   pcmvs_rig *rig;                                     cameras, once
 *   pcmvs_rig_new(&rig);
 *   pcmvs_rig_set_cameras(rig, cameras, camera_count);
 *   pcmvs_frame *frame;                                 used again for frame after frame
 *   pcmvs_frame_new(rig, &frame);
 *   pcmvs_frame_reconstruct(frame, views, camera_count, NULL);
 *   pcmvs_frame_export_mesh(frame, PCMVS_MESH_KIND_FINAL, NULL, write_to_file, file);
 *   pcmvs_frame_free(frame);
 *   pcmvs_rig_free(rig);
 *
 * pcmvs_frame_reconstruct is the same as pcmvs_frame_begin, pcmvs_frame_view for every camera, pcmvs_frame_hull,
 * pcmvs_frame_contours, pcmvs_frame_coarse, pcmvs_frame_detect for every camera, pcmvs_frame_merge, pcmvs_frame_mesh
 * and pcmvs_frame_colour. A stage that fails or is cancelled leaves the frame as it was before that stage: it can be
 * run again, or another frame begun.
 *
 * Status. Every call that can fail returns a pcmvs_status. On failure it has written nothing to the caller's memory.
 * What went wrong with which camera is told by pcmvs_frame_error and pcmvs_rig_error.
 *
 * Pointers. NULL is an error for every pointer that is not said to be optional. Inputs are read during the call only.
 *
 * Ownership. Handles are freed by their own function, which takes NULL too. Pointers that the library gives out stay
 * the library's; their comments say how long they are valid. Nothing else has to be freed. Rigs and frames may be
 * freed in any order.
 *
 * Structs. Those that callers fill in begin with struct_size; call their init function first and set members then.
 * Arrays of them hold elements of one size. Later versions add members at the end only, so programs built with an
 * older header run with a newer library. Reserved members are zero.
 *
 * Threads. No globals: handles do not know of each other, and any number of them may be used at once. A rig may be
 * shared by threads once it has its cameras. On a frame pcmvs_frame_view and pcmvs_frame_detect may run on several
 * threads at a time, for different cameras, and so may functions that take a const pcmvs_frame *; a call that comes
 * while another one excludes it fails with PCMVS_STATUS_BUSY. Free a handle only when no other thread uses it.
 *
 * Callbacks must not throw exceptions or jump out.
 *
 * Coordinates: the scene's frame and unit are those of the cameras' R and t. Colours are sRGB.
 */


#ifndef PCMVS_H
#define PCMVS_H

#include <stddef.h>
#include <stdint.h>

// Major version of this header.
#define PCMVS_VERSION_MAJOR 0

// Minor version of this header.
#define PCMVS_VERSION_MINOR 1

// Patch version of this header.
#define PCMVS_VERSION_PATCH 0

// Version of this header as one number that grows: major * 1000000 + minor * 1000 + patch.
#define PCMVS_VERSION 1000

// Number of stages.
#define PCMVS_STAGE_COUNT 8

// Bytes of an error's message, with its final zero.
#define PCMVS_MESSAGE_SIZE 480

// Most cameras of a rig.
#define PCMVS_MOST_CAMERAS 1024

// Result of a call. Numbers never change; new ones are only added at the end, so a caller must take a number it does
// not know for a failure.
enum pcmvs_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Done.
  PCMVS_STATUS_OK = 0,
  // A pointer that must not be NULL is.
  PCMVS_STATUS_NULL_POINTER = 1,
  // A handle is of another kind, was freed (as far as its memory has not been reused), or never was one.
  PCMVS_STATUS_INVALID_HANDLE = 2,
  // A struct's `struct_size` is less than any version's, or the part that this library does not know is not zero:
  // the caller asks for something that only a newer library can do.
  PCMVS_STATUS_INVALID_STRUCT = 3,
  // An argument is out of range.
  PCMVS_STATUS_INVALID_ARGUMENT = 4,
  // The handle is in use by a call that excludes this one: on another thread, or in whose callback this one is made.
  PCMVS_STATUS_BUSY = 5,
  // The call needs a stage that has not run yet.
  PCMVS_STATUS_WRONG_ORDER = 6,
  // The progress callback asked to stop.
  PCMVS_STATUS_CANCELLED = 7,
  // A camera's calibration cannot be used.
  PCMVS_STATUS_CAMERA = 8,
  // A picture does not fit its camera or its own description.
  PCMVS_STATUS_IMAGE = 9,
  // A silhouette cannot be used.
  PCMVS_STATUS_SILHOUETTE = 10,
  // Two cameras stand at the same place and look the same way.
  PCMVS_STATUS_DUPLICATE_CAMERA = 11,
  // Fewer cameras, or fewer silhouettes, than the method needs.
  PCMVS_STATUS_TOO_FEW_VIEWS = 12,
  // The silhouettes do not meet in space.
  PCMVS_STATUS_EMPTY_HULL = 13,
  // The points bound no surface.
  PCMVS_STATUS_NO_SURFACE = 14,
  // More memory is needed than allowed.
  PCMVS_STATUS_OUT_OF_MEMORY = 15,
  // The buffer is too small; ask for the size first.
  PCMVS_STATUS_BUFFER_TOO_SMALL = 16,
  // The write callback refused.
  PCMVS_STATUS_WRITE_FAILED = 17,
  // A bug in the library. The handle only takes `pcmvs_..._error` and `pcmvs_..._free` from now on; other handles
  // are not affected.
  PCMVS_STATUS_PANIC = 18,
  // Something that this version of the ABI has no number for; the message says what.
  PCMVS_STATUS_OTHER = 19,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_status pcmvs_status;
#else
typedef uint32_t pcmvs_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Stages of a reconstruction in the order in which they run. Numbers never change.
enum pcmvs_stage
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Undistortion and silhouettes, view by view.
  PCMVS_STAGE_VIEWS = 0,
  // Visual hull.
  PCMVS_STAGE_HULL = 1,
  // Points that the silhouettes alone give.
  PCMVS_STAGE_CONTOURS = 2,
  // Detection and meshing at half the resolution, which guide the stages after it.
  PCMVS_STAGE_COARSE = 3,
  // Stereo, view by view.
  PCMVS_STAGE_DETECT = 4,
  // All points to one cloud.
  PCMVS_STAGE_MERGE = 5,
  // The cloud to a closed mesh.
  PCMVS_STAGE_MESH = 6,
  // Colours of the mesh.
  PCMVS_STAGE_COLOUR = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_stage pcmvs_stage;
#else
typedef uint32_t pcmvs_stage;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Layout of a picture's bytes. Numbers never change.
enum pcmvs_pixel_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // One byte a pixel.
  PCMVS_PIXEL_FORMAT_GRAY8 = 0,
  // Red, green, blue.
  PCMVS_PIXEL_FORMAT_RGB8 = 1,
  // Blue, green, red.
  PCMVS_PIXEL_FORMAT_BGR8 = 2,
  // Red, green, blue, ignored.
  PCMVS_PIXEL_FORMAT_RGBA8 = 3,
  // Blue, green, red, ignored.
  PCMVS_PIXEL_FORMAT_BGRA8 = 4,
  // A plane of luma, then a half-size plane of interleaved Cb, Cr (BT.601, video range).
  PCMVS_PIXEL_FORMAT_NV12 = 5,
  // Two bytes a pixel, in the machine's order; 65535 is white.
  PCMVS_PIXEL_FORMAT_GRAY16 = 6,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_pixel_format pcmvs_pixel_format;
#else
typedef uint32_t pcmvs_pixel_format;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Sets of parameters. Numbers never change.
enum pcmvs_preset
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // What measures best.
  PCMVS_PRESET_DEFAULT = 0,
  // The method as published.
  PCMVS_PRESET_PAPER = 1,
  // The visual hull alone.
  PCMVS_PRESET_HULL = 2,
  // The fastest.
  PCMVS_PRESET_PREVIEW = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_preset pcmvs_preset;
#else
typedef uint32_t pcmvs_preset;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which of a frame's meshes. Numbers never change.
enum pcmvs_mesh_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The result: closed, manifold, with colours once `pcmvs_frame_colour` has run.
  PCMVS_MESH_KIND_FINAL = 0,
  // The visual hull, after `pcmvs_frame_hull`.
  PCMVS_MESH_KIND_HULL = 1,
  // The coarse pass' mesh, after `pcmvs_frame_coarse`; empty where the preset has none.
  PCMVS_MESH_KIND_COARSE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_mesh_kind pcmvs_mesh_kind;
#else
typedef uint32_t pcmvs_mesh_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What of a mesh is copied. Numbers never change.
enum pcmvs_attribute
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Per vertex: x, y, z in the scene's frame, three floats.
  PCMVS_ATTRIBUTE_POSITION = 0,
  // Per vertex: unit normal, outward, three floats.
  PCMVS_ATTRIBUTE_NORMAL = 1,
  // Per vertex: red, green, blue in sRGB, three bytes.
  PCMVS_ATTRIBUTE_COLOUR = 2,
  // Per triangle: its corners' vertices, counter-clockwise seen from outside, three `uint32_t`.
  PCMVS_ATTRIBUTE_TRIANGLE = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_attribute pcmvs_attribute;
#else
typedef uint32_t pcmvs_attribute;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which of a frame's clouds. Numbers never change.
enum pcmvs_cloud_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // On contour generators, after `pcmvs_frame_contours`.
  PCMVS_CLOUD_KIND_FRONTIER = 0,
  // On the hull where no camera looks, after `pcmvs_frame_contours`.
  PCMVS_CLOUD_KIND_IMPLICIT = 1,
  // One view's points, after `pcmvs_frame_merge`.
  PCMVS_CLOUD_KIND_DETECTED = 2,
  // All that reaches meshing, after `pcmvs_frame_merge`.
  PCMVS_CLOUD_KIND_MERGED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_cloud_kind pcmvs_cloud_kind;
#else
typedef uint32_t pcmvs_cloud_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What makes a point trustworthy. Numbers never change.
enum pcmvs_rank
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // On the hull where no camera looks.
  PCMVS_RANK_IMPLICIT = 0,
  // Put on the hull because stereo failed.
  PCMVS_RANK_SUBSTITUTED = 1,
  // Found by stereo.
  PCMVS_RANK_DETECTED = 2,
  // On a contour generator, certainly on the surface.
  PCMVS_RANK_FRONTIER = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum pcmvs_rank pcmvs_rank;
#else
typedef uint32_t pcmvs_rank;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Formats of files. Numbers never change.
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

// One frame on its way from pictures to a mesh, and its results. Used again for frame after frame.
typedef struct pcmvs_frame pcmvs_frame;

// A calibrated set of cameras and what follows from it. Shared between any number of frames and threads; may be freed
// before its frames.
typedef struct pcmvs_rig pcmvs_rig;

// A calibrated camera in OpenCV's convention. World to pixel is `x = K * distort(R X + t)`: x right, y down,
// z forward; the first pixel's centre is at (0, 0). Matrices are row after row.
typedef struct pcmvs_camera {
  // Set by `pcmvs_camera_init`.
  uint32_t struct_size;
  // Pixels in a row of the camera's pictures.
  uint32_t width;
  // Rows of the camera's pictures.
  uint32_t height;
  // Zero.
  uint32_t reserved;
  // Intrinsic matrix by rows; the last row is 0 0 1. Skew is allowed.
  double k[9];
  // OpenCV's k1, k2, p1, p2, k3.
  double distortion[5];
  // Rotation by rows, world to camera.
  double r[9];
  // Translation, world to camera, in the scene's unit.
  double t[3];
} pcmvs_camera;

// Why the last call on a handle that failed did so.
typedef struct pcmvs_error {
  // What the call returned, a `pcmvs_status`; `PCMVS_STATUS_OK` if none has failed yet.
  uint32_t status;
  // The stage in which it failed, a `pcmvs_stage`; -1 if none.
  int32_t stage;
  // Index of the camera that is to blame; -1 if none.
  int32_t camera;
  // Zero.
  int32_t reserved;
  // Number of the frame as in `pcmvs_options`; -1 for a rig.
  int64_t frame;
  // What is wrong and what to do, in English, UTF-8, ended by a zero.
  char message[PCMVS_MESSAGE_SIZE];
} pcmvs_error;

// A picture in the caller's memory. Read during the call only, never written.
typedef struct pcmvs_image {
  // Set by `pcmvs_image_init`.
  uint32_t struct_size;
  // A `pcmvs_pixel_format`.
  uint32_t format;
  // Pixels in a row.
  uint32_t width;
  // Rows.
  uint32_t height;
  // First byte of the topmost row.
  const void *data;
  // Bytes from a row to the one below it; negative if rows lie in memory from the bottom up. 0: no padding.
  ptrdiff_t stride;
  // NV12 only: first byte of the topmost row of the plane of Cb, Cr.
  const void *chroma;
  // NV12 only: bytes from a row of that plane to the one below it. 0: no padding.
  ptrdiff_t chroma_stride;
} pcmvs_image;

// How to tell an object from a backdrop of one colour, evenly lit or not.
typedef struct pcmvs_chroma_key {
  // Set by `pcmvs_chroma_key_init`.
  uint32_t struct_size;
  // About the backdrop's colour: red, green, blue in sRGB, then zero.
  uint8_t rgb[4];
  // A pixel is backdrop if its colour is turned from the local backdrop's by less than this share (0 to 1) of the
  // angle between the backdrop's colour and gray.
  float tolerance;
  // Shadows on the backdrop are recognised down to this share of its local brightness.
  float darkest_shadow;
  // Parts of the object smaller than this share of the picture are removed.
  float smallest_part;
  // Holes in the object smaller than this share of the picture are filled.
  float smallest_hole;
} pcmvs_chroma_key;

// A camera's picture of one frame and where its silhouette comes from. At most one of `mask`, `clean_plate` and
// `chroma_key` is given; with none of them the view carves nothing.
typedef struct pcmvs_view {
  // Set by `pcmvs_view_init`.
  uint32_t struct_size;
  // Zero.
  uint32_t reserved;
  // The picture, of the camera's calibrated size.
  const struct pcmvs_image *image;
  // A picture of the same size that is white on the object and black elsewhere, or NULL. Gray values are coverage:
  // the contour runs where it is one half.
  const struct pcmvs_image *mask;
  // The same camera's picture of the empty set, or NULL.
  const struct pcmvs_image *clean_plate;
  // The backdrop's colour, or NULL.
  const struct pcmvs_chroma_key *chroma_key;
} pcmvs_view;

// Told how far a call is: `done` of `total` in `stage`. Stages come in order and `done` never falls within one.
// Return 0 to go on, anything else to cancel: the call then ends with `PCMVS_STATUS_CANCELLED` as soon as it can, and
// the callback is not called again. Called on the thread that made the call, never on another. It must not
// throw, and calls on the same handle fail with `PCMVS_STATUS_BUSY`.
typedef int (*pcmvs_progress_fn)(void *user, pcmvs_stage stage, uint32_t done, uint32_t total);

// A piece of work that the library hands out: call it with `job` and an index.
typedef void (*pcmvs_job_fn)(void *job, uint32_t index);

// Runs pieces of work on the host's threads: calls `run(job, i)` once for every `i` below `count`, on any thread and in
// any order, and returns when all these calls have returned. Pieces left out are then run on the calling thread. The
// result does not depend on threads. It must not throw.
typedef void (*pcmvs_parallel_fn)(void *user, uint32_t count, pcmvs_job_fn run, void *job);

// How a frame is made. All zero but `struct_size` is the default.
typedef struct pcmvs_options {
  // Set by `pcmvs_options_init`.
  uint32_t struct_size;
  // A `pcmvs_preset`.
  uint32_t preset;
  // Number of the frame, for error messages only.
  uint32_t frame;
  // Distance of the final mesh's grid nodes in pixels of footprint; 0 is the preset's.
  float voxel_pixels;
  // Called as the work advances, or NULL.
  pcmvs_progress_fn progress;
  // Handed to `progress`.
  void *progress_user;
  // Runs pieces of work on the caller's threads, or NULL: everything runs on the calling thread.
  pcmvs_parallel_fn parallel;
  // Handed to `parallel`.
  void *parallel_user;
} pcmvs_options;

// A mesh in the frame's memory: packed arrays, valid until the next call on the frame that is not const.
typedef struct pcmvs_mesh {
  // Number of vertices.
  uint32_t vertex_count;
  // Number of triangles.
  uint32_t triangle_count;
  // x, y, z of each vertex; add `origin` for the scene's frame.
  const float *positions;
  // Unit normal of each vertex, outward.
  const float *normals;
  // Red, green, blue of each vertex in sRGB; NULL without colours.
  const uint8_t *colours;
  // Three vertices a triangle, counter-clockwise seen from outside.
  const uint32_t *triangles;
  // World position of the positions' origin.
  double origin[3];
} pcmvs_mesh;

// A point of a cloud.
typedef struct pcmvs_point {
  // x, y, z; add `pcmvs_rig_origin` for the scene's frame.
  float position[3];
  // Unit normal, outward.
  float normal[3];
  // How well the neighbouring views agree, from 0 to their number.
  float fidelity;
  // Weight in meshing.
  float weight;
  // Index of the camera that sees it; -1 for implicit points.
  int32_t camera;
  // A `pcmvs_rank`.
  uint32_t rank;
} pcmvs_point;

// A view's silhouette in the frame's memory, for the camera without lens distortion. Valid until the next call on the
// frame that is not const.
typedef struct pcmvs_silhouette {
  // Pixels in a row.
  uint32_t width;
  // Rows.
  uint32_t height;
  // For each pixel its distance to the contour in 1/64 pixel, positive on the object; 32767 where nothing is known.
  const int16_t *distances;
} pcmvs_silhouette;

// What a file holds.
typedef struct pcmvs_export_options {
  // Set by `pcmvs_export_options_init`.
  uint32_t struct_size;
  // A `pcmvs_file_format`.
  uint32_t format;
  // GLB only: 1 writes normals, 0 leaves them out. 1 by default.
  uint32_t normals;
  // GLB only: 1 if `up` is given, else 0.
  uint32_t has_up;
  // GLB only: the scene's upward direction, recorded for players; coordinates stay as they are.
  double up[3];
} pcmvs_export_options;

// Takes the next `size` bytes of a file. Return 0 to go on, anything else to fail with `PCMVS_STATUS_WRITE_FAILED`.
// Called on the thread that made the call, once or more often. It must not throw.
typedef int (*pcmvs_write_fn)(void *user, const void *data, size_t size);

// What a frame took and counted.
typedef struct pcmvs_report {
  // Seconds of each stage, over all threads.
  double seconds[PCMVS_STAGE_COUNT];
  // A hash of each stage's result, the same on every machine.
  uint64_t hashes[PCMVS_STAGE_COUNT];
  // Points found by stereo.
  uint32_t detected;
  // Points put on the hull because stereo failed.
  uint32_t substituted;
  // Points removed by the density constraint.
  uint32_t cleaned_density;
  // Points removed by the flatness constraint.
  uint32_t cleaned_pca;
  // Points removed by the normal constraint.
  uint32_t cleaned_normal;
  // Frontier points.
  uint32_t frontier;
  // Implicit points.
  uint32_t implicit;
  // Points dropped in merging for their normals.
  uint32_t dropped_normal;
  // Points dropped in merging for better neighbours.
  uint32_t dropped_fidelity;
  // Conflicts removed in the cameras' views.
  uint32_t conflicts_cameras;
  // Conflicts removed in virtual views.
  uint32_t conflicts_virtual;
  // Implicit points removed because they hide a valid point.
  uint32_t implicit_removed;
  // Points that reached meshing.
  uint32_t merged;
  // Stray components dropped from the mesh.
  uint32_t components_dropped;
  // Vertices of the mesh.
  uint32_t vertices;
  // Triangles of the mesh.
  uint32_t faces;
} pcmvs_report;

// All of them, each at the place of its number.
#define pcmvs_status_ALL { pcmvs_status_Ok, pcmvs_status_NullPointer, pcmvs_status_InvalidHandle, pcmvs_status_InvalidStruct, pcmvs_status_InvalidArgument, pcmvs_status_Busy, pcmvs_status_WrongOrder, pcmvs_status_Cancelled, pcmvs_status_Camera, pcmvs_status_Image, pcmvs_status_Silhouette, pcmvs_status_DuplicateCamera, pcmvs_status_TooFewViews, pcmvs_status_EmptyHull, pcmvs_status_NoSurface, pcmvs_status_OutOfMemory, pcmvs_status_BufferTooSmall, pcmvs_status_WriteFailed, pcmvs_status_Panic, pcmvs_status_Other, }

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the library that is running, composed like `PCMVS_VERSION`. May be newer than the header's.
uint32_t pcmvs_version(void);

// Version of the library that is running, as "0.1.0". Static; never freed.
const char *pcmvs_version_string(void);

// Name of a status for logs, in English, "unknown" for numbers of other versions. Static; never freed.
const char *pcmvs_status_name(uint32_t status);

// Name of a stage as in reports ("views", "hull", ...), "unknown" for numbers of other versions. Static; never freed.
const char *pcmvs_stage_name(uint32_t stage);

// Sets a camera to identity matrices without distortion. `size` is `sizeof *camera`.
pcmvs_status pcmvs_camera_init(struct pcmvs_camera *camera, size_t size);

// Makes a rig without cameras. Free it with `pcmvs_rig_free`.
pcmvs_status pcmvs_rig_new(struct pcmvs_rig **rig);

// Frees a rig. NULL does nothing.
pcmvs_status pcmvs_rig_free(struct pcmvs_rig *rig);

// Gives a rig its cameras: at least three, whose order is that of the views of every frame. Prepares all that frames
// share. On failure the rig keeps the cameras it had. Frames made before keep their cameras.
pcmvs_status pcmvs_rig_set_cameras(struct pcmvs_rig *rig,
                                   const struct pcmvs_camera *cameras,
                                   size_t count);

// Number of cameras; 0 before they are set.
pcmvs_status pcmvs_rig_camera_count(const struct pcmvs_rig *rig, uint32_t *count);

// World position (x, y, z) that is the origin of the positions in `pcmvs_mesh` and `pcmvs_point`.
pcmvs_status pcmvs_rig_origin(const struct pcmvs_rig *rig, double *xyz);

// Why the last failed call on this rig failed. `size` is `sizeof *error`.
pcmvs_status pcmvs_rig_error(const struct pcmvs_rig *rig, struct pcmvs_error *error, size_t size);

// Sets a picture to RGB without padding, its size and data to nothing. `size` is `sizeof *image`.
pcmvs_status pcmvs_image_init(struct pcmvs_image *image, size_t size);

// Sets a chroma key to the usual green. `size` is `sizeof *key`.
pcmvs_status pcmvs_chroma_key_init(struct pcmvs_chroma_key *key, size_t size);

// Sets a view to nothing. `size` is `sizeof *view`.
pcmvs_status pcmvs_view_init(struct pcmvs_view *view, size_t size);

// Sets options to their defaults. `size` is `sizeof *options`.
pcmvs_status pcmvs_options_init(struct pcmvs_options *options, size_t size);

// Makes a frame of a rig that has its cameras. Free it with `pcmvs_frame_free`.
pcmvs_status pcmvs_frame_new(const struct pcmvs_rig *rig, struct pcmvs_frame **frame);

// Frees a frame and all that points into it. NULL does nothing. Fails with `PCMVS_STATUS_BUSY` while a call is running.
pcmvs_status pcmvs_frame_free(struct pcmvs_frame *frame);

// The whole job in one call: begins a frame and runs all its stages. `views` holds `count` views, one a camera, in the
// rig's order. `options` may be NULL. On failure no result is there, and the handle can be used again.
pcmvs_status pcmvs_frame_reconstruct(struct pcmvs_frame *frame,
                                     const struct pcmvs_view *views,
                                     size_t count,
                                     const struct pcmvs_options *options);

// Begins a frame to be made stage by stage, and drops the one before. `options` may be NULL.
pcmvs_status pcmvs_frame_begin(struct pcmvs_frame *frame, const struct pcmvs_options *options);

// Reads a camera's picture and silhouette. Any number of threads may do this for views of their own.
pcmvs_status pcmvs_frame_view(struct pcmvs_frame *frame, uint32_t camera, const struct pcmvs_view *view);

// Carves the visual hull, once every camera has its view.
pcmvs_status pcmvs_frame_hull(struct pcmvs_frame *frame);

// Finds the points that the silhouettes alone give.
pcmvs_status pcmvs_frame_contours(struct pcmvs_frame *frame);

// Detects and meshes at half the resolution.
pcmvs_status pcmvs_frame_coarse(struct pcmvs_frame *frame);

// Detects the points of one view by stereo with its neighbours. Any number of threads may do this for views of their
// own; the result does not depend on threads or order.
pcmvs_status pcmvs_frame_detect(struct pcmvs_frame *frame,
                                uint32_t camera);

// Merges all points to one cloud, once every view has been detected.
pcmvs_status pcmvs_frame_merge(struct pcmvs_frame *frame);

// Makes a closed mesh of the merged cloud.
pcmvs_status pcmvs_frame_mesh(struct pcmvs_frame *frame);

// Colours the mesh.
pcmvs_status pcmvs_frame_colour(struct pcmvs_frame *frame);

// Why the last failed call on this frame failed; calls that only read results keep no detail. `size` is
// `sizeof *error`.
pcmvs_status pcmvs_frame_error(const struct pcmvs_frame *frame, struct pcmvs_error *error, size_t size);

// Looks at a mesh (`kind` is a `pcmvs_mesh_kind`) where it lies. `size` is `sizeof *mesh`.
pcmvs_status pcmvs_frame_get_mesh(const struct pcmvs_frame *frame,
                                  uint32_t kind,
                                  struct pcmvs_mesh *mesh,
                                  size_t size);

// Copies one attribute of a mesh, a `pcmvs_attribute`, to the caller's memory. `buffer` has room for `capacity`
// elements that lie `stride` bytes apart (0: no padding); what lies between them is left alone. `count`, if not NULL,
// gets the number of elements. With a NULL `buffer` and a `capacity` of 0 only the number is told.
pcmvs_status pcmvs_frame_copy_mesh(const struct pcmvs_frame *frame,
                                   uint32_t kind,
                                   uint32_t attribute,
                                   void *buffer,
                                   size_t capacity,
                                   size_t stride,
                                   size_t *count);

// Copies a cloud, a `pcmvs_cloud_kind`, to the caller's memory; `camera` chooses among the detected ones. `buffer`,
// `capacity`, `stride` and `count` as for `pcmvs_frame_copy_mesh`. Presets without a stage have no points of it.
pcmvs_status pcmvs_frame_copy_cloud(const struct pcmvs_frame *frame,
                                    uint32_t kind,
                                    uint32_t camera,
                                    struct pcmvs_point *buffer,
                                    size_t capacity,
                                    size_t stride,
                                    size_t *count);

// Looks at a view's silhouette where it lies, after `pcmvs_frame_hull`. Fails with `PCMVS_STATUS_WRONG_ORDER` for a
// view that was given none. `size` is `sizeof *silhouette`.
pcmvs_status pcmvs_frame_get_silhouette(const struct pcmvs_frame *frame,
                                        uint32_t camera,
                                        struct pcmvs_silhouette *silhouette,
                                        size_t size);

// Sets export options to their defaults: GLB with normals. `size` is `sizeof *options`.
pcmvs_status pcmvs_export_options_init(struct pcmvs_export_options *options, size_t size);

// Hands a mesh (`kind` is a `pcmvs_mesh_kind`) as a file's bytes to a callback. `options` may be NULL.
pcmvs_status pcmvs_frame_export_mesh(const struct pcmvs_frame *frame,
                                     uint32_t kind,
                                     const struct pcmvs_export_options *options,
                                     pcmvs_write_fn write,
                                     void *user);

// Writes a mesh as a file's bytes to a buffer of `capacity` bytes; `size`, if not NULL, gets their number. With a NULL
// `buffer` and a `capacity` of 0 only the number is told, which costs as much as writing: `pcmvs_frame_export_mesh`
// needs no second call. `options` may be NULL.
pcmvs_status pcmvs_frame_export_mesh_to_buffer(const struct pcmvs_frame *frame,
                                               uint32_t kind,
                                               const struct pcmvs_export_options *options,
                                               void *buffer,
                                               size_t capacity,
                                               size_t *size);

// Hands a cloud (as for `pcmvs_frame_copy_cloud`) as a PLY file's bytes to a callback.
pcmvs_status pcmvs_frame_export_cloud(const struct pcmvs_frame *frame,
                                      uint32_t kind,
                                      uint32_t camera,
                                      pcmvs_write_fn write,
                                      void *user);

// Tells what the frame took and counted, when all its stages have run. `size` is `sizeof *report`.
pcmvs_status pcmvs_frame_get_report(const struct pcmvs_frame *frame,
                                    struct pcmvs_report *report,
                                    size_t size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PCMVS_H */
