// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "gbuffer/camera_fit.h"
#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/sampling.h"
#include "relume/error.h"

namespace relume::gbuffer {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNormalLens = 39.6;  ///< degrees: what is assumed of a camera of which nothing is known
constexpr std::size_t kMostSightings = 6000;
constexpr double kLargestError = 1.5;  ///< pixels, median: more is no camera

std::string format(const char* pattern, double a, double b = 0) {
    char text[160];
    std::snprintf(text, sizeof text, pattern, a, b);
    return text;
}

struct RowPoints {
    const SampledRow& row;
    int first;
    const Semantic& position;

    Vector3 at(std::size_t i) const {
        Vector3 p{};
        for (std::size_t k = 0; k < 3; ++k) {
            double v = row.planes[static_cast<std::size_t>(first) + k][i];
            if (position.encoding == Encoding::zero_to_one) v = 2 * v - 1;
            p[k] = v * static_cast<double>(position.sign[k]);
        }
        return p;
    }
    bool valid(std::size_t i) const {
        const auto value = [&](std::size_t k) { return row.planes[static_cast<std::size_t>(first) + k][i]; };
        return (value(0) != 0 || value(1) != 0 || value(2) != 0) && std::isfinite(value(0) + value(1) + value(2));
    }
};

/// Pixels whose positions can be trusted: two neighbours on either side are surface too, and it goes on evenly there.
std::vector<Sighting> sightings(const GBuffer::Impl& impl, std::span<const SampledRow> rows, int first) {
    const Semantic& position = *impl.find("position");
    std::vector<Sighting> all;
    for (const SampledRow& row : rows) {
        const RowPoints points{row, first, position};
        const std::size_t width = row.planes[static_cast<std::size_t>(first)].size();
        for (std::size_t i = 0; i < width; ++i) {
            if (!points.valid(i)) continue;
            // Narrow images have no neighbours to ask.
            if (width >= 16) {
                if (i < 2 || i + 2 >= width) continue;
                if (!points.valid(i - 2) || !points.valid(i - 1) || !points.valid(i + 1) || !points.valid(i + 2))
                    continue;
                const Vector3 p = points.at(i);
                const double inner = std::max(length(minus(p, points.at(i - 1))), length(minus(p, points.at(i + 1))));
                const double outer = std::max(length(minus(points.at(i - 1), points.at(i - 2))),
                                              length(minus(points.at(i + 1), points.at(i + 2))));
                if (inner > 4 * outer) continue;
            }
            all.push_back({impl.data_window.x + static_cast<double>(i) + 0.5, row.y + 0.5, points.at(i)});
        }
    }
    if (all.size() <= kMostSightings) return all;
    std::vector<Sighting> some;
    some.reserve(kMostSightings);
    for (std::size_t k = 0; k < kMostSightings; ++k)
        some.push_back(all[k * all.size() / kMostSightings]);
    return some;
}

/// Lens numbers of a camera that sees the display window under a horizontal angle.
void set_lens(Camera& camera, const GBuffer::Impl& impl, double half_width) {
    const Window& w = impl.display_window;
    // A pixel is pixel_aspect times as wide as it is high.
    camera.x_scale = 2 * half_width / w.width;
    camera.y_scale = -camera.x_scale / static_cast<double>(impl.pixel_aspect);
    camera.x_offset = -(w.x + w.width / 2.0) * camera.x_scale;
    camera.y_offset = -(w.y + w.height / 2.0) * camera.y_scale;
}

std::optional<double> given_half_width(const GBufferOptions& options, std::string& what) {
    if (options.projection == Projection::orthographic || (options.width && !options.fov && !options.focal_length)) {
        if (!options.width) {
            throw Error(ErrorKind::value,
                        "an orthographic camera needs `width`: the world units across the display window");
        }
        what = format("an orthographic width of %.6g", *options.width);
        return *options.width / 2;
    }
    if (options.fov) {
        if (!(*options.fov > 0 && *options.fov < 180)) {
            throw Error(ErrorKind::value,
                        format("camera fov is %.6g degrees; it lies between 0 and 180", *options.fov));
        }
        what = format("a field of view of %.6g degrees", *options.fov);
        return std::tan(*options.fov * kPi / 360);
    }
    if (options.focal_length) {
        const double aperture = options.horizontal_aperture.value_or(36.0);
        if (!(*options.focal_length > 0) || !(aperture > 0)) {
            throw Error(ErrorKind::value, "camera focal_length and horizontal_aperture are lengths greater than 0");
        }
        what = format("a focal length of %.6g on an aperture of %.6g", *options.focal_length, aperture);
        return aperture / (2 * *options.focal_length);
    }
    return std::nullopt;
}

Projection given_projection(const GBufferOptions& options) {
    const bool width_alone = options.width && !options.fov && !options.focal_length;
    return options.projection.value_or(width_alone ? Projection::orthographic : Projection::perspective);
}

class CameraSetup {
public:
    CameraSetup(GBuffer::Impl& impl, const GBufferOptions& options, std::span<const SampledRow> rows, int first_plane)
        : impl_(impl), options_(options), rows_(rows), first_plane_(first_plane) {}

    void run() {
        std::string lens_given;
        const std::optional<double> half_width = given_half_width(options_, lens_given);
        if (first_plane_ >= 0) recover();
        if (options_.camera_matrix) {
            from_matrix(half_width, lens_given);
        } else if (fit_) {
            accept_fit();
        } else if (half_width) {
            Camera camera;
            camera.projection = given_projection(options_);
            set_lens(camera, impl_, *half_width);
            impl_.camera = camera;
            impl_.camera_reason =
                lens_given +
                " was given; world space is taken as camera space, since nothing tells where the camera stands";
        } else {
            assume();
        }
        if (impl_.camera) {
            impl_.view_camera = *impl_.camera;
            impl_.view_source = ViewSource::camera;
        }
        // Camera space to world space, by the pose.
        const std::array<double, 16>& m = impl_.view_camera.camera_to_world;
        std::copy(m.begin(), m.begin() + 12, impl_.to_world.begin());
    }

private:
    void recover() {
        std::vector<Sighting> seen = sightings(impl_, rows_, first_plane_);
        std::string why;
        fit_ = fit_camera(seen, impl_.display_window, static_cast<double>(impl_.pixel_aspect), why);
        if (!fit_ && !impl_.data_window.empty()) {
            // Little of the picture may be surface: look at all of it.
            const std::vector<SampledRow> dense = sample_rows(impl_, impl_.find("position")->raws, true);
            seen = sightings(impl_, dense, 0);
            fit_ = fit_camera(seen, impl_.display_window, static_cast<double>(impl_.pixel_aspect), why);
        }
        if (fit_ && !(fit_->median_error < kLargestError)) {
            why = format("the best pinhole camera misses the positions by %.3g pixels", fit_->median_error);
            fit_.reset();
        }
        if (!fit_) impl_.notes.push_back("no camera from the positions: " + why);
        count_ = seen.size();
    }

    void accept_fit() {
        impl_.camera = fit_->camera;
        impl_.camera_error = fit_->median_error;
        std::string reason = "recovered from the positions of " + std::to_string(count_) + " pixels" +
                             format(", median reprojection error %.2g px", fit_->median_error);
        if (fit_->camera.projection == Projection::orthographic) {
            reason += ", orthographic";
        } else {
            const double across = impl_.display_window.width * fit_->camera.x_scale;
            reason += format(", horizontal field of view %.4g degrees", 2 * std::atan(across / 2) * 180 / kPi);
        }
        if (fit_->planar) reason += "; all lie on one plane, so square pixels and a centred lens are assumed";
        if (fit_->mirrored) reason += "; the world is left-handed";
        impl_.camera_reason = std::move(reason);
        // Positions in camera space: the pose is what takes them to themselves.
        if (impl_.find("position")->space == Space::camera) {
            impl_.notes.push_back(
                "positions are in camera space and nothing tells where the camera stands: lights are placed in camera "
                "space");
        }
    }

    void from_matrix(std::optional<double> half_width, const std::string& lens_given) {
        Camera camera;
        if (half_width) {
            camera.projection = given_projection(options_);
            set_lens(camera, impl_, *half_width);
            impl_.camera_reason = "the matrix and " + lens_given + " were given";
        } else if (fit_) {
            camera = fit_->camera;
            impl_.camera_reason = "the matrix was given, the lens is recovered from the positions";
        } else {
            set_lens(camera, impl_, std::tan(kNormalLens * kPi / 360));
            impl_.camera_reason =
                format("the matrix was given; a field of view of %.3g degrees is assumed", kNormalLens);
        }
        const std::array<double, 16>& m = *options_.camera_matrix;
        for (const double v : m) {
            if (!std::isfinite(v)) throw Error(ErrorKind::value, "camera matrix: a number that is not finite");
        }
        if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1) {
            throw Error(ErrorKind::value,
                        "camera matrix: its last row is not 0 0 0 1; give it row by row, for column vectors");
        }
        camera.camera_to_world = m;
        impl_.camera = camera;
    }

    void assume() {
        const Semantic* normal = impl_.find("normal");
        impl_.camera_reason = "neither header nor positions nor options give one";
        if (normal && normal->space == Space::camera) {
            set_lens(impl_.view_camera, impl_, std::tan(kNormalLens * kPi / 360));
            impl_.view_source = ViewSource::camera;
            impl_.notes.push_back(
                format("no camera: normals are in camera space, so world space is taken as camera space, seen under "
                       "%.3g degrees; `fov` says better",
                       kNormalLens));
        } else {
            impl_.notes.push_back(
                "no camera: every surface is taken to be seen along its normal; give a camera (a matrix and a field of "
                "view) for highlights and lights at a place");
        }
    }

    GBuffer::Impl& impl_;
    const GBufferOptions& options_;
    std::span<const SampledRow> rows_;
    int first_plane_;
    std::optional<CameraFit> fit_;
    std::size_t count_ = 0;
};

}  // namespace

void set_up_camera(GBuffer::Impl& impl, const GBufferOptions& options, std::span<const SampledRow> rows,
                   int first_plane) {
    CameraSetup(impl, options, rows, first_plane).run();
}

}  // namespace relume::gbuffer
