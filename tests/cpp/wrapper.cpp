// Tests what pcmvs.hpp adds to pcmvs.h: ownership, exceptions, error values. Usage: wrapper FOLDER (see capture.h)
#include "capture.h"

#include <iostream>
#include <pcmvs.hpp>
#include <string>

static_assert(!std::is_copy_constructible_v<pcmvs::Rig> && std::is_nothrow_move_constructible_v<pcmvs::Rig>);
static_assert(!std::is_copy_constructible_v<pcmvs::Frame> && std::is_nothrow_move_constructible_v<pcmvs::Frame>);
static_assert(sizeof(pcmvs::Frame) == sizeof(void *));
static_assert(!std::is_copy_constructible_v<pcmvs::Calibration> &&
              std::is_nothrow_move_constructible_v<pcmvs::Calibration>);

namespace {

int failures = 0;

void check(bool holds, const char *what) {
    if (!holds) {
        std::cout << what << '\n';
        failures++;
    }
}

template <typename F> pcmvs_status status_of(F call) {
    try {
        call();
        return PCMVS_STATUS_OK;
    } catch (const pcmvs::Error &error) {
        return error.status();
    }
}

void check_calibration(const capture &capture) {
    const pcmvs::Span<pcmvs_camera> cameras(capture.cameras, capture.count);
    const pcmvs::Span<pcmvs_view> views(capture.views, capture.count);
    check(status_of([] {
              const pcmvs::Rig none;
              pcmvs::Calibration of_none(none);
          }) == PCMVS_STATUS_WRONG_ORDER, "a rig without cameras has no calibration");
    pcmvs::Calibration calibration{pcmvs::Rig(cameras)};
    const auto options = pcmvs::make<pcmvs_calibration_options>();
    try {
        calibration.run(&options);
        check(false, "a calibration needs frames");
    } catch (const pcmvs::Error &error) {
        check(error.status() == PCMVS_STATUS_WRONG_ORDER && error.frame() == -1, "the status is that of a wrong order");
        check(std::string(error.what()).find("pcmvs_calibration_add_frame") != std::string::npos, "with its reason");
    }
    calibration.add_frame(views, &options);
    check(calibration.try_get_camera(0, *capture.cameras) == PCMVS_STATUS_WRONG_ORDER, "results need a run");
    check(calibration.error().status == PCMVS_STATUS_WRONG_ORDER, "and the calibration describes it");
    calibration.run();
    check(calibration.get_report().frames == 1 && calibration.get_warnings().empty(), "the calibration is sound");
    check(calibration.get_camera_report(1).silhouette_overlap > 0.9f, "and so is each camera");
    const std::vector<pcmvs_camera> some{calibration.get_camera(0), calibration.get_camera(1), calibration.get_camera(2)};
    const pcmvs::Rig refined(some);
    check(refined.camera_count() == 3, "cameras make a new rig");
    pcmvs::Calibration moved = std::move(calibration);
    check(moved.get_report().frames == 1, "moving a calibration keeps its results");
    check(calibration.try_run() == PCMVS_STATUS_NULL_POINTER, "an object that was moved from is empty");
}

} // namespace

int main(int argc, char **argv) {
    capture capture;
    if (argc != 2 || !capture_read(argv[1], &capture)) {
        return 2;
    }
    const pcmvs::Span<pcmvs_camera> cameras(capture.cameras, capture.count);
    const pcmvs::Span<pcmvs_view> views(capture.views, capture.count);

    check(status_of([&] { pcmvs::Rig few(pcmvs::Span<pcmvs_camera>(capture.cameras, 2)); }) ==
              PCMVS_STATUS_TOO_FEW_VIEWS, "two cameras are too few");
    pcmvs::Rig rig(cameras);
    check(rig.camera_count() == capture.count, "the rig has its cameras");

    pcmvs::Frame frame(rig);
    auto options = pcmvs::make<pcmvs_options>();
    options.preset = PCMVS_PRESET_HULL;
    options.frame = 5;
    frame.begin(&options);
    try {
        frame.colour();
        check(false, "colour needs views");
    } catch (const pcmvs::Error &error) {
        check(error.status() == PCMVS_STATUS_WRONG_ORDER, "the status is that of a wrong order");
        check(error.stage() == PCMVS_STAGE_VIEWS && error.frame() == 5 && error.camera() == 0, "and so do the fields");
    }
    check(frame.try_merge() == PCMVS_STATUS_WRONG_ORDER, "try_merge returns the same status");
    check(frame.error().stage == PCMVS_STAGE_VIEWS, "and the frame describes it");

    try {
        static_cast<void>(frame.get_mesh());
        check(false, "there is no mesh yet");
    } catch (const pcmvs::Error &error) {
        check(error.stage() == PCMVS_STAGE_MESH && error.frame() == 5, "a failed read has its stage and frame");
        check(std::string(error.what()).find("`mesh`, which has not") != std::string::npos, "and its reason");
    }
    try {
        const pcmvs::Rig none;
        pcmvs::Frame of_none(none);
        check(false, "a rig without cameras has no frames");
    } catch (const pcmvs::Error &error) {
        check(std::string(error.what()).find("pcmvs_rig_set_cameras") != std::string::npos, "the rig describes it");
    }

    frame.reconstruct(views, &options);
    const pcmvs::Mesh mesh = frame.get_mesh();
    const pcmvs::Mesh hull = frame.get_mesh(PCMVS_MESH_KIND_HULL);
    check(mesh.positions.size() == hull.positions.size() && !mesh.positions.empty(), "preset hull gives the hull");
    check(mesh.colours.size() == mesh.positions.size() && hull.colours.empty(), "with colours");
    auto form = pcmvs::make<pcmvs_form_options>();
    form.texture = 1;
    form.texture_size = 256;
    frame.form(form);
    const pcmvs::Mesh textured = frame.get_mesh(PCMVS_MESH_KIND_FORM);
    check(textured.texture_coordinates.size() / 2 == textured.positions.size() / 3, "a form has texture coordinates");
    check(frame.get_texture().texels.size() == 3 * 256 * 256 && mesh.texture_coordinates.empty(), "and a texture");
    check(frame.get_counts().vertices * 3 == mesh.positions.size(), "and counts");
    check(frame.get_stage_report(PCMVS_STAGE_HULL).hash != 0, "and reports of stages");
    check(frame.get_view_report(0).carves == 1 && frame.get_warnings().empty(), "and of views, without warnings");
    auto without = capture.views[1];
    without.mask = nullptr;
    frame.begin(&options);
    for (std::uint32_t i = 0; i < capture.count; i++) {
        frame.view(i, i == 1 ? without : capture.views[i]);
    }
    frame.step(PCMVS_STAGE_HULL);
    check(frame.try_step(PCMVS_NO_STAGE) == PCMVS_STATUS_INVALID_ARGUMENT, "there is no such stage");
    const auto warnings = frame.get_warnings();
    check(warnings.size() == 1 && warnings[0].camera == 1, "a view without a silhouette causes a warning");
    check(std::string(warnings.at(0).code) == "no-silhouette", "with its code");
    frame.reconstruct(views, &options);
    const pcmvs::Mesh again = frame.get_mesh();

    std::size_t size = 0;
    frame.export_mesh([&](pcmvs::Span<std::byte> bytes) { size += bytes.size(); });
    check(size > again.positions.size() * 4, "files have bytes");
    try {
        frame.export_mesh([](pcmvs::Span<std::byte>) { throw std::out_of_range("full"); });
        check(false, "exceptions pass through");
    } catch (const std::out_of_range &) {
    }
    const auto full = [](pcmvs::Span<std::byte>) { throw std::out_of_range("full"); };
    check(frame.try_export_mesh(full) == PCMVS_STATUS_WRITE_FAILED, "or become a status");

    pcmvs::Frame moved = std::move(frame);
    check(moved.get_mesh().positions.data() == again.positions.data(), "moving a frame keeps its results in place");
    check(frame.try_hull() == PCMVS_STATUS_NULL_POINTER, "an object that was moved from is empty");
    check(status_of([&] { frame.hull(); }) == PCMVS_STATUS_NULL_POINTER, "and throws");
    rig = pcmvs::Rig();
    check(moved.try_reconstruct(views, &options) == PCMVS_STATUS_OK, "a frame outlives its rig");
    check_calibration(capture);
    capture_free(&capture);
    return failures;
}
