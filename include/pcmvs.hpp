// libpcmvs for C++17: owning classes, spans and exceptions on top of pcmvs.h. Header-only.
//
// Every function that can fail exists twice: `f` throws pcmvs::Error, and `try_f` returns a pcmvs_status and does not
// throw. If exceptions are disabled (-fno-exceptions), only the latter exist. What pcmvs.h says about threads, lifetimes
// and the order of calls applies here too. An object that has been moved from holds no handle: its functions fail with
// PCMVS_STATUS_NULL_POINTER.
#ifndef PCMVS_HPP
#define PCMVS_HPP

#include "pcmvs.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#if defined(__cpp_exceptions)
#include <exception>
#include <stdexcept>
#endif

namespace pcmvs {

/// A view of elements that something else owns.
template <typename T> class Span {
public:
    constexpr Span() noexcept = default;
    constexpr Span(const T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    Span(const std::vector<T> &elements) noexcept : data_(elements.data()), size_(elements.size()) {}
    constexpr const T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr const T *begin() const noexcept { return data_; }
    constexpr const T *end() const noexcept { return data_ + size_; }
    constexpr const T &operator[](std::size_t i) const noexcept { return data_[i]; }

private:
    const T *data_ = nullptr;
    std::size_t size_ = 0;
};

/// Returns a struct of pcmvs.h with its defaults: `auto camera = pcmvs::make<pcmvs_camera>();`
template <typename T> T make() noexcept {
    T value;
    if constexpr (std::is_same_v<T, pcmvs_camera>) {
        pcmvs_camera_init(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, pcmvs_image>) {
        pcmvs_image_init(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, pcmvs_chroma_key>) {
        pcmvs_chroma_key_init(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, pcmvs_view>) {
        pcmvs_view_init(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, pcmvs_options>) {
        pcmvs_options_init(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, pcmvs_calibration_options>) {
        pcmvs_calibration_options_init(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, pcmvs_form_options>) {
        pcmvs_form_options_init(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, pcmvs_allocator>) {
        pcmvs_allocator_init(&value, sizeof value);
    } else {
        static_assert(std::is_same_v<T, pcmvs_export_options>, "this struct has no defaults");
        pcmvs_export_options_init(&value, sizeof value);
    }
    return value;
}

#if defined(MESHOPTIMIZER_VERSION)
/// Makes files compressed by meshoptimizer, as those of the command line's `--compress`. Include meshoptimizer.h before this
/// header, and link meshoptimizer 1.0 or later.
inline void compress(pcmvs_export_options &options) noexcept {
    options.normals = 0;
    options.compact = 1;
    options.meshopt_optimizeVertexCacheStrip = meshopt_optimizeVertexCacheStrip;
    options.meshopt_optimizeVertexFetchRemap = meshopt_optimizeVertexFetchRemap;
    options.meshopt_encodeVertexBufferBound = meshopt_encodeVertexBufferBound;
    options.meshopt_encodeVertexBufferLevel = meshopt_encodeVertexBufferLevel;
    options.meshopt_encodeIndexBufferBound = meshopt_encodeIndexBufferBound;
    options.meshopt_encodeIndexBuffer = meshopt_encodeIndexBuffer;
}
#endif

/// Describes a picture in the caller's memory. A stride of 0 means packed rows.
inline pcmvs_image image(const void *data, std::uint32_t width, std::uint32_t height, pcmvs_pixel_format format,
                         std::ptrdiff_t stride = 0) noexcept {
    auto image = make<pcmvs_image>();
    image.data = data;
    image.width = width;
    image.height = height;
    image.format = format;
    image.stride = stride;
    return image;
}

#if defined(__cpp_exceptions)
/// A failed call; what() is the library's message.
class Error : public std::runtime_error {
public:
    explicit Error(const pcmvs_error &detail)
        : std::runtime_error(detail.message[0] != '\0' ? detail.message : pcmvs_status_name(detail.status)),
          detail_(std::make_shared<pcmvs_error>(detail)) {}
    pcmvs_status status() const noexcept { return static_cast<pcmvs_status>(detail_->status); }
    /// Index of the camera to blame. -1 if it is not known or there is none.
    std::int32_t camera() const noexcept { return detail_->camera; }
    /// The stage that failed or whose result was asked for. -1 if the failure belongs to no stage.
    std::int32_t stage() const noexcept { return detail_->stage; }
    /// Number of the frame. -1 if the failure belongs to none.
    std::int64_t frame() const noexcept { return detail_->frame; }

private:
    std::shared_ptr<pcmvs_error> detail_;
};
#endif

namespace detail {

#if defined(__cpp_exceptions)
/// Throws a failure when only the status is known.
inline void check(pcmvs_status status) {
    if (status != PCMVS_STATUS_OK) {
        pcmvs_error error{};
        error.status = status;
        error.stage = error.camera = -1;
        error.frame = -1;
        throw Error(error);
    }
}

/// Throws a failure that the handle describes.
template <typename Handle, typename Get> void check(pcmvs_status status, const Handle *handle, Get get) {
    if (status != PCMVS_STATUS_OK) {
        pcmvs_error error{};
        if (get(handle, &error, sizeof error) == PCMVS_STATUS_OK && error.status == status) {
            throw Error(error);
        }
        check(status);
    }
}
#endif

struct FreeRig {
    void operator()(pcmvs_rig *rig) const noexcept { pcmvs_rig_free(rig); }
};

struct FreeFrame {
    void operator()(pcmvs_frame *frame) const noexcept { pcmvs_frame_free(frame); }
};

struct FreeCalibration {
    void operator()(pcmvs_calibration *calibration) const noexcept { pcmvs_calibration_free(calibration); }
};

/// Wraps a callback so that its exception does not pass through C and is kept.
template <typename F> struct Guarded {
    F &call;
#if defined(__cpp_exceptions)
    std::exception_ptr thrown{};
    void rethrow() const {
        if (thrown) {
            std::rethrow_exception(thrown);
        }
    }
#endif

    static int write(void *self, const void *data, std::size_t size) noexcept {
        auto &guarded = *static_cast<Guarded *>(self);
#if defined(__cpp_exceptions)
        try {
            guarded.call(Span<std::byte>(static_cast<const std::byte *>(data), size));
            return 0;
        } catch (...) {
            guarded.thrown = std::current_exception();
            return 1;
        }
#else
        guarded.call(Span<std::byte>(static_cast<const std::byte *>(data), size));
        return 0;
#endif
    }
};

} // namespace detail

/// A mesh in a frame's memory; see pcmvs_mesh.
struct Mesh {
    Span<float> positions;         ///< x, y, z per vertex, relative to `origin`
    Span<float> normals;           ///< unit normal per vertex
    Span<std::uint8_t> colours;    ///< red, green, blue per vertex; empty before colouring
    Span<std::uint32_t> triangles; ///< three vertices per triangle
    double origin[3] = {0, 0, 0};  ///< origin of the positions in the scene's frame
    Span<float> texture_coordinates; ///< two per vertex; empty without a texture
};

/// The texture of a form in a frame's memory; see pcmvs_texture.
struct Texture {
    std::uint32_t width = 0, height = 0;
    Span<std::uint8_t> texels; ///< red, green, blue per texel
};

/// Calibrated cameras; see pcmvs_rig.
class Rig {
public:
    /// Creates a rig without cameras.
    Rig() noexcept {
        pcmvs_rig *made = nullptr;
        pcmvs_rig_new(&made);
        rig_.reset(made);
    }

    pcmvs_status try_set_cameras(Span<pcmvs_camera> cameras) noexcept {
        return pcmvs_rig_set_cameras(rig_.get(), cameras.data(), cameras.size());
    }

    /// Fixes the gains: three floats per camera.
    pcmvs_status try_set_gains(Span<float> gains) noexcept {
        return pcmvs_rig_set_gains(rig_.get(), gains.data(), gains.size() / 3);
    }

    std::uint32_t camera_count() const noexcept {
        std::uint32_t count = 0;
        pcmvs_rig_camera_count(rig_.get(), &count);
        return count;
    }

    /// Describes the last failed call.
    pcmvs_error error() const noexcept {
        pcmvs_error error{};
        pcmvs_rig_error(rig_.get(), &error, sizeof error);
        return error;
    }

    pcmvs_rig *get() noexcept { return rig_.get(); }
    const pcmvs_rig *get() const noexcept { return rig_.get(); }

#if defined(__cpp_exceptions)
    explicit Rig(Span<pcmvs_camera> cameras) : Rig() { set_cameras(cameras); }

    void set_gains(Span<float> gains) { detail::check(try_set_gains(gains), get(), pcmvs_rig_error); }
    void set_cameras(Span<pcmvs_camera> cameras) { detail::check(try_set_cameras(cameras), get(), pcmvs_rig_error); }
#endif

private:
    std::unique_ptr<pcmvs_rig, detail::FreeRig> rig_;
};

/// A handle for frame after frame; see pcmvs_frame.
class Frame {
public:
    Frame() noexcept = default;

    /// Creates a frame for a rig.
    static pcmvs_status try_make(const Rig &rig, Frame &frame) noexcept {
        pcmvs_frame *made = nullptr;
        const pcmvs_status status = pcmvs_frame_new(rig.get(), &made);
        if (status == PCMVS_STATUS_OK) {
            frame.frame_.reset(made);
        }
        return status;
    }

    pcmvs_status try_reconstruct(Span<pcmvs_view> views, const pcmvs_options *options = nullptr) noexcept {
        return pcmvs_frame_reconstruct(get(), views.data(), views.size(), options);
    }
    pcmvs_status try_begin(const pcmvs_options *options = nullptr) noexcept { return pcmvs_frame_begin(get(), options); }
    pcmvs_status try_view(std::uint32_t camera, const pcmvs_view &view) noexcept {
        return pcmvs_frame_view(get(), camera, &view);
    }
    pcmvs_status try_view_between(std::uint32_t camera, const pcmvs_view &view, const pcmvs_view &before,
                                  const pcmvs_view &after, std::uint32_t &restored) noexcept {
        return pcmvs_frame_view_between(get(), camera, &view, &before, &after, &restored);
    }
    pcmvs_status try_step(std::uint32_t stage) noexcept { return pcmvs_frame_step(get(), stage); }
    pcmvs_status try_hull() noexcept { return pcmvs_frame_hull(get()); }
    pcmvs_status try_contours() noexcept { return pcmvs_frame_contours(get()); }
    pcmvs_status try_coarse() noexcept { return pcmvs_frame_coarse(get()); }
    pcmvs_status try_detect(std::uint32_t camera) noexcept { return pcmvs_frame_detect(get(), camera); }
    pcmvs_status try_merge() noexcept { return pcmvs_frame_merge(get()); }
    pcmvs_status try_mesh() noexcept { return pcmvs_frame_mesh(get()); }
    pcmvs_status try_colour() noexcept { return pcmvs_frame_colour(get()); }

    pcmvs_status try_form(const pcmvs_form_options &options) noexcept { return pcmvs_frame_form(get(), &options); }

    pcmvs_status try_may_have_lost_part(const Frame &before, const Frame &after, bool &may_have) const noexcept {
        std::uint32_t found = 0;
        const pcmvs_status status = pcmvs_frame_may_have_lost_part(get(), before.get(), after.get(), &found);
        if (status == PCMVS_STATUS_OK) {
            may_have = found != 0;
        }
        return status;
    }

    pcmvs_status try_steady(std::initializer_list<std::reference_wrapper<const Frame>> neighbours) noexcept {
        std::array<const pcmvs_frame *, 16> handles{};
        if (neighbours.size() > handles.size()) {
            return PCMVS_STATUS_INVALID_ARGUMENT;
        }
        std::size_t count = 0;
        for (const Frame &neighbour : neighbours) {
            handles[count++] = neighbour.get();
        }
        return pcmvs_frame_steady(get(), handles.data(), count);
    }

    pcmvs_status try_get_texture(Texture &texture) const noexcept {
        pcmvs_texture c;
        const pcmvs_status status = pcmvs_frame_get_texture(get(), &c, sizeof c);
        if (status == PCMVS_STATUS_OK) {
            texture = {c.width, c.height, {c.texels, std::size_t{3} * c.width * c.height}};
        }
        return status;
    }

    pcmvs_status try_get_mesh(Mesh &mesh, pcmvs_mesh_kind kind = PCMVS_MESH_KIND_FINAL) const noexcept {
        pcmvs_mesh c;
        const pcmvs_status status = pcmvs_frame_get_mesh(get(), kind, &c, sizeof c);
        if (status == PCMVS_STATUS_OK) {
            const std::size_t numbers = std::size_t{3} * c.vertex_count;
            mesh.positions = {c.positions, numbers};
            mesh.normals = {c.normals, numbers};
            mesh.colours = {c.colours, c.colours != nullptr ? numbers : 0};
            mesh.triangles = {c.triangles, std::size_t{3} * c.triangle_count};
            mesh.origin[0] = c.origin[0];
            mesh.origin[1] = c.origin[1];
            mesh.origin[2] = c.origin[2];
            const std::size_t pairs = c.texture_coordinates != nullptr ? std::size_t{2} * c.vertex_count : 0;
            mesh.texture_coordinates = {c.texture_coordinates, pairs};
        }
        return status;
    }

    pcmvs_status try_get_counts(pcmvs_counts &counts) const noexcept {
        return pcmvs_frame_get_counts(get(), &counts, sizeof counts);
    }
    pcmvs_status try_get_stage_report(std::uint32_t stage, pcmvs_stage_report &report) const noexcept {
        return pcmvs_frame_get_stage_report(get(), stage, &report, sizeof report);
    }
    pcmvs_status try_get_view_report(std::uint32_t camera, pcmvs_view_report &report) const noexcept {
        return pcmvs_frame_get_view_report(get(), camera, &report, sizeof report);
    }
    pcmvs_status try_warning_count(std::uint32_t &count) const noexcept {
        return pcmvs_frame_warning_count(get(), &count);
    }
    pcmvs_status try_get_warning(std::uint32_t index, pcmvs_warning &warning) const noexcept {
        return pcmvs_frame_get_warning(get(), index, &warning, sizeof warning);
    }

    /// Copies the gains, three floats per camera, to memory for `capacity` cameras.
    pcmvs_status try_copy_gains(float *gains, std::size_t capacity, std::size_t *count = nullptr) const noexcept {
        return pcmvs_frame_copy_gains(get(), gains, capacity, 0, count);
    }

    /// Passes the mesh as a file's bytes to `write(Span<std::byte>)`. If that throws, the call fails with
    /// PCMVS_STATUS_WRITE_FAILED.
    template <typename F>
    pcmvs_status try_export_mesh(F &&write, const pcmvs_export_options *options = nullptr,
                                 pcmvs_mesh_kind kind = PCMVS_MESH_KIND_FINAL) const noexcept {
        detail::Guarded<std::remove_reference_t<F>> guarded{write};
        return pcmvs_frame_export_mesh(get(), kind, options, guarded.write, &guarded);
    }

    /// Describes the last failed call.
    pcmvs_error error() const noexcept {
        pcmvs_error error{};
        pcmvs_frame_error(get(), &error, sizeof error);
        return error;
    }

    pcmvs_frame *get() noexcept { return frame_.get(); }
    const pcmvs_frame *get() const noexcept { return frame_.get(); }

#if defined(__cpp_exceptions)
    explicit Frame(const Rig &rig) { detail::check(try_make(rig, *this), rig.get(), pcmvs_rig_error); }

    void reconstruct(Span<pcmvs_view> views, const pcmvs_options *options = nullptr) {
        check(try_reconstruct(views, options));
    }
    void begin(const pcmvs_options *options = nullptr) { check(try_begin(options)); }
    void view(std::uint32_t camera, const pcmvs_view &view) { check(try_view(camera, view)); }
    /// Reads a view with those of the frames before and after, and returns the number of pixels that its silhouette lacked; see
    /// pcmvs_frame_view_between.
    std::uint32_t view_between(std::uint32_t camera, const pcmvs_view &view, const pcmvs_view &before,
                               const pcmvs_view &after) {
        std::uint32_t restored = 0;
        check(try_view_between(camera, view, before, after, restored));
        return restored;
    }
    void step(std::uint32_t stage) { check(try_step(stage)); }
    void hull() { check(try_hull()); }
    void contours() { check(try_contours()); }
    void coarse() { check(try_coarse()); }
    void detect(std::uint32_t camera) { check(try_detect(camera)); }
    void merge() { check(try_merge()); }
    void mesh() { check(try_mesh()); }
    void colour() { check(try_colour()); }

    /// Makes a form of the finished mesh; see pcmvs_frame_form.
    void form(const pcmvs_form_options &options) { check(try_form(options)); }

    /// Whether the frame may have lost a part that its neighbours have; see pcmvs_frame_may_have_lost_part.
    bool may_have_lost_part(const Frame &before, const Frame &after) const {
        bool may_have = false;
        check(try_may_have_lost_part(before, after, may_have));
        return may_have;
    }

    /// Averages the finished mesh with those of neighbouring frames; see pcmvs_frame_steady.
    void steady(std::initializer_list<std::reference_wrapper<const Frame>> neighbours) { check(try_steady(neighbours)); }

    Texture get_texture() const {
        Texture texture;
        check(try_get_texture(texture));
        return texture;
    }

    Mesh get_mesh(pcmvs_mesh_kind kind = PCMVS_MESH_KIND_FINAL) const {
        Mesh mesh;
        check(try_get_mesh(mesh, kind));
        return mesh;
    }

    pcmvs_counts get_counts() const {
        pcmvs_counts counts;
        check(try_get_counts(counts));
        return counts;
    }

    pcmvs_stage_report get_stage_report(std::uint32_t stage) const {
        pcmvs_stage_report report;
        check(try_get_stage_report(stage, report));
        return report;
    }

    pcmvs_view_report get_view_report(std::uint32_t camera) const {
        pcmvs_view_report report;
        check(try_get_view_report(camera, report));
        return report;
    }

    std::vector<pcmvs_warning> get_warnings() const {
        std::uint32_t count = 0;
        check(try_warning_count(count));
        std::vector<pcmvs_warning> warnings(count);
        for (std::uint32_t i = 0; i < count; i++) {
            check(try_get_warning(i, warnings[i]));
        }
        return warnings;
    }

    /// Returns the gains: three floats per camera.
    std::vector<float> get_gains() const {
        std::size_t count = 0;
        check(try_copy_gains(nullptr, 0, &count));
        std::vector<float> gains(3 * count);
        check(try_copy_gains(gains.data(), count));
        return gains;
    }

    /// As try_export_mesh, but rethrows what `write` throws.
    template <typename F>
    void export_mesh(F &&write, const pcmvs_export_options *options = nullptr,
                     pcmvs_mesh_kind kind = PCMVS_MESH_KIND_FINAL) const {
        detail::Guarded<std::remove_reference_t<F>> guarded{write};
        const pcmvs_status status = pcmvs_frame_export_mesh(get(), kind, options, guarded.write, &guarded);
        guarded.rethrow();
        check(status);
    }
#endif

private:
#if defined(__cpp_exceptions)
    void check(pcmvs_status status) const { detail::check(status, get(), pcmvs_frame_error); }
#endif

    std::unique_ptr<pcmvs_frame, detail::FreeFrame> frame_;
};

/// Checks and refines the cameras of a rig; see pcmvs_calibration.
class Calibration {
public:
    Calibration() noexcept = default;

    /// Creates a calibration for a rig.
    static pcmvs_status try_make(const Rig &rig, Calibration &calibration) noexcept {
        pcmvs_calibration *made = nullptr;
        const pcmvs_status status = pcmvs_calibration_new(rig.get(), &made);
        if (status == PCMVS_STATUS_OK) {
            calibration.calibration_.reset(made);
        }
        return status;
    }

    pcmvs_status try_add_frame(Span<pcmvs_view> views, const pcmvs_calibration_options *options = nullptr) noexcept {
        return pcmvs_calibration_add_frame(get(), views.data(), views.size(), options);
    }
    pcmvs_status try_run(const pcmvs_calibration_options *options = nullptr) noexcept {
        return pcmvs_calibration_run(get(), options);
    }

    pcmvs_status try_get_report(pcmvs_calibration_report &report) const noexcept {
        return pcmvs_calibration_get_report(get(), &report, sizeof report);
    }
    pcmvs_status try_get_camera_report(std::uint32_t camera, pcmvs_camera_report &report) const noexcept {
        return pcmvs_calibration_get_camera_report(get(), camera, &report, sizeof report);
    }
    pcmvs_status try_get_camera(std::uint32_t index, pcmvs_camera &camera) const noexcept {
        return pcmvs_calibration_get_camera(get(), index, &camera, sizeof camera);
    }
    pcmvs_status try_warning_count(std::uint32_t &count) const noexcept {
        return pcmvs_calibration_warning_count(get(), &count);
    }
    pcmvs_status try_get_warning(std::uint32_t index, pcmvs_warning &warning) const noexcept {
        return pcmvs_calibration_get_warning(get(), index, &warning, sizeof warning);
    }

    /// Describes the last failed call.
    pcmvs_error error() const noexcept {
        pcmvs_error error{};
        pcmvs_calibration_error(get(), &error, sizeof error);
        return error;
    }

    pcmvs_calibration *get() noexcept { return calibration_.get(); }
    const pcmvs_calibration *get() const noexcept { return calibration_.get(); }

#if defined(__cpp_exceptions)
    explicit Calibration(const Rig &rig) { detail::check(try_make(rig, *this), rig.get(), pcmvs_rig_error); }

    void add_frame(Span<pcmvs_view> views, const pcmvs_calibration_options *options = nullptr) {
        check(try_add_frame(views, options));
    }
    void run(const pcmvs_calibration_options *options = nullptr) { check(try_run(options)); }

    pcmvs_calibration_report get_report() const {
        pcmvs_calibration_report report;
        check(try_get_report(report));
        return report;
    }

    pcmvs_camera_report get_camera_report(std::uint32_t camera) const {
        pcmvs_camera_report report;
        check(try_get_camera_report(camera, report));
        return report;
    }

    pcmvs_camera get_camera(std::uint32_t index) const {
        pcmvs_camera camera;
        check(try_get_camera(index, camera));
        return camera;
    }

    std::vector<pcmvs_warning> get_warnings() const {
        std::uint32_t count = 0;
        check(try_warning_count(count));
        std::vector<pcmvs_warning> warnings(count);
        for (std::uint32_t i = 0; i < count; i++) {
            check(try_get_warning(i, warnings[i]));
        }
        return warnings;
    }
#endif

private:
#if defined(__cpp_exceptions)
    void check(pcmvs_status status) const { detail::check(status, get(), pcmvs_calibration_error); }
#endif

    std::unique_ptr<pcmvs_calibration, detail::FreeCalibration> calibration_;
};

} // namespace pcmvs

#endif
