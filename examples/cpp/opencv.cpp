// Reconstructs pictures that OpenCV has loaded, with a calibration that OpenCV has stored.
// Usage: opencv CALIBRATION.yml IMAGES OUT.glb
//
// CALIBRATION.yml holds a sequence `cameras` of maps with image, mask (file names in the folder IMAGES), K, distortion,
// R and t. pcmvs uses OpenCV's conventions, so that nothing has to be converted.
#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <pcmvs.hpp>

namespace {

struct Shot {
    cv::Mat image, mask;
};

// Reads a matrix of any type and shape as `count` numbers.
void numbers(const cv::FileNode &node, double *to, int count) {
    cv::Mat matrix;
    node >> matrix;
    if (static_cast<int>(matrix.total()) != count) {
        throw std::runtime_error(node.name() + " has " + std::to_string(matrix.total()) + " numbers");
    }
    cv::Mat wide;
    matrix.reshape(1, 1).convertTo(wide, CV_64F);
    std::copy_n(wide.ptr<double>(), count, to);
}

// Describes a Mat, which may be a region of interest, without copying it.
pcmvs_image borrow(const cv::Mat &mat) {
    const auto format = mat.type() == CV_8UC1   ? PCMVS_PIXEL_FORMAT_GRAY8
                        : mat.type() == CV_8UC4 ? PCMVS_PIXEL_FORMAT_BGRA8
                                                : PCMVS_PIXEL_FORMAT_BGR8;
    return pcmvs::image(mat.data, static_cast<std::uint32_t>(mat.cols), static_cast<std::uint32_t>(mat.rows), format,
                        static_cast<std::ptrdiff_t>(mat.step[0]));
}

void run(const std::string &calibration, const std::string &folder, const char *path) {
    cv::FileStorage file(calibration, cv::FileStorage::READ);
    std::vector<pcmvs_camera> cameras;
    std::vector<Shot> shots;
    for (const auto &node : file["cameras"]) {
        Shot shot;
        shot.image = cv::imread(folder + "/" + static_cast<std::string>(node["image"]), cv::IMREAD_COLOR);
        shot.mask = cv::imread(folder + "/" + static_cast<std::string>(node["mask"]), cv::IMREAD_GRAYSCALE);
        if (shot.image.empty() || shot.mask.empty()) {
            throw std::runtime_error("picture or mask of camera " + std::to_string(shots.size()) + " cannot be read");
        }
        auto camera = pcmvs::make<pcmvs_camera>();
        camera.width = static_cast<std::uint32_t>(shot.image.cols);
        camera.height = static_cast<std::uint32_t>(shot.image.rows);
        numbers(node["K"], camera.k, 9);
        numbers(node["distortion"], camera.distortion, 5);
        numbers(node["R"], camera.r, 9);
        numbers(node["t"], camera.t, 3);
        cameras.push_back(camera);
        shots.push_back(shot);
    }
    std::vector<pcmvs_image> images;
    for (const auto &shot : shots) {
        images.push_back(borrow(shot.image));
        images.push_back(borrow(shot.mask));
    }
    std::vector<pcmvs_view> views(shots.size(), pcmvs::make<pcmvs_view>());
    for (std::size_t i = 0; i < views.size(); i++) {
        views[i].image = &images[2 * i];
        views[i].mask = &images[2 * i + 1];
    }

    const pcmvs::Rig rig(cameras);
    pcmvs::Frame frame(rig);
    frame.reconstruct(views);
    std::ofstream out(path, std::ios::binary);
    out.exceptions(std::ios::failbit | std::ios::badbit);
    frame.export_mesh([&](pcmvs::Span<std::byte> bytes) {
        out.write(reinterpret_cast<const char *>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    });
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 4) {
        std::cerr << "usage: opencv CALIBRATION.yml IMAGES OUT.glb\n";
        return 2;
    }
    try {
        run(argv[1], argv[2], argv[3]);
    } catch (const std::exception &error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
    return 0;
}
