// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "gbuffer/camera_fit.h"
#include "gbuffer/camera_header.h"
#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/sampling.h"
#include "gbuffer/sightings.h"
#include "relume/error.h"
#include "text/number_format.h"

namespace relume::gbuffer {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNormalLens = 39.6;        ///< degrees: what is assumed of a camera of which nothing is known
constexpr std::size_t kFewSightings = 500;  ///< fewer, and it is worth looking at all of the picture
constexpr std::size_t kLeastSightings = 24;
constexpr double kLargestError = 1.5;  ///< pixels, median: more is no camera

std::string format(const char* pattern, double a, double b = 0) { return format_numbers(pattern, {a, b}); }

/// A given matrix with axes of unit length.
std::array<double, 16> checked_pose(std::array<double, 16> m) {
    for (const double v : m) {
        if (!std::isfinite(v)) throw Error(ErrorKind::value, "camera matrix: a number that is not finite");
    }
    if (std::abs(m[12]) + std::abs(m[13]) + std::abs(m[14]) + std::abs(m[15] - 1) > 1e-6) {
        throw Error(ErrorKind::value,
                    "camera matrix: its last row is not 0 0 0 1; give it row by row, for column vectors");
    }
    for (std::size_t j = 0; j < 3; ++j) {
        const double size = std::sqrt(m[j] * m[j] + m[4 + j] * m[4 + j] + m[8 + j] * m[8 + j]);
        if (!(size > 1e-12)) throw Error(ErrorKind::value, "camera matrix: one of its axes has no length");
        for (std::size_t i = 0; i < 3; ++i) m[4 * i + j] /= size;
    }
    return m;
}

struct GivenLens {
    Projection projection = Projection::perspective;
    double half_width = 0;
    std::string reason;
};

std::optional<GivenLens> given_lens(const GBufferOptions& options) {
    if (options.projection == Projection::orthographic || (options.width && !options.fov && !options.focal_length)) {
        if (!options.width || !(*options.width > 0)) {
            throw Error(ErrorKind::value,
                        "an orthographic camera needs `width`: the world units across the display window");
        }
        return GivenLens{Projection::orthographic, *options.width / 2,
                         format("an orthographic width of %.6g", *options.width)};
    }
    if (options.fov) {
        if (!(*options.fov > 0 && *options.fov < 180)) {
            throw Error(ErrorKind::value,
                        format("camera fov is %.6g degrees; it lies between 0 and 180", *options.fov));
        }
        return GivenLens{Projection::perspective, std::tan(*options.fov * kPi / 360),
                         format("a field of view of %.6g degrees", *options.fov)};
    }
    if (options.focal_length) {
        const double aperture = options.horizontal_aperture.value_or(36.0);
        if (!(*options.focal_length > 0) || !(aperture > 0)) {
            throw Error(ErrorKind::value, "camera focal_length and horizontal_aperture are lengths greater than 0");
        }
        return GivenLens{Projection::perspective, aperture / (2 * *options.focal_length),
                         format("a focal length of %.6g on an aperture of %.6g", *options.focal_length, aperture)};
    }
    return std::nullopt;
}

void take_lens(Camera& camera, const Camera& lens) {
    camera.projection = lens.projection;
    camera.x_scale = lens.x_scale;
    camera.x_offset = lens.x_offset;
    camera.y_scale = lens.y_scale;
    camera.y_offset = lens.y_offset;
}

/// Whether the camera stands at the origin with its axes along those of the space: +1 looking down −Z, −1 looking along
/// +Z (then its right-handed frame is turned), 0 otherwise.
int own_space(const Camera& camera, double size) {
    const std::array<double, 16>& m = camera.camera_to_world;
    constexpr double kAlmost = 2e-3;
    const bool at_origin = std::abs(m[3]) + std::abs(m[7]) + std::abs(m[11]) < kAlmost * size;
    if (!at_origin || camera.projection != Projection::perspective) return 0;
    if (std::abs(std::abs(m[0]) - 1) > kAlmost || std::abs(m[5] - 1) > kAlmost) return 0;
    return m[10] > 0 ? 1 : -1;
}

class CameraSetup {
public:
    CameraSetup(GBuffer::Impl& impl, const GBufferOptions& options, const CameraSample& sample, int threads)
        : impl_(impl), options_(options), sample_(sample), threads_(threads) {}

    void run() {
        const std::optional<GivenLens> lens = given_lens(options_);
        if (!impl_.in_memory()) {
            readings_ = header_cameras(impl_.files.front().header, impl_.files.front().producer.producer,
                                       impl_.display_window, aspect());
            header_lens_ = header_lens(impl_.files.front().header);
        }
        if (sample_.position >= 0) look_at_positions(lens);
        if (options_.camera_matrix) {
            from_matrix(lens);
        } else if (!from_header(lens) && !from_positions() && !from_options(lens)) {
            assume();
        }
        if (impl_.camera) {
            impl_.view_camera = *impl_.camera;
            impl_.view_source = ViewSource::camera;
            compare(lens);
        }
        // Camera space to world space, by the pose.
        const std::array<double, 16>& m = impl_.view_camera.camera_to_world;
        std::copy(m.begin(), m.begin() + 12, impl_.to_world.begin());
        if (impl_.camera && !seen_.empty() && impl_.find("depth")) judge_depth();
        if (impl_.camera) judge_normals();
    }

private:
    double aspect() const { return static_cast<double>(impl_.pixel_aspect); }

    void look_at_positions(const std::optional<GivenLens>& lens) {
        look_at_samples();
        if (seen_.size() < kLeastSightings) look_at_all();
        const Semantic& position = *impl_.find("position");
        if (position.detect_space && !is_seen_in_world_space(position, lens) && fitted()) judge_position_space();
    }

    /// Whether positions said to be in world space are, by a camera that was given or stands in the header.
    bool is_seen_in_world_space(const Semantic& position, const std::optional<GivenLens>& lens) {
        if (position.space != Space::world || seen_.size() < kLeastSightings) return false;
        const auto sees = [&](const Camera& camera) {
            return own_space(camera, scene_size()) == 0 && median_reprojection_error(camera, seen_) < kLargestError;
        };
        if (options_.camera_matrix) {
            if (!lens) return false;
            Camera camera;
            camera.projection = lens->projection;
            set_lens(camera, impl_.display_window, aspect(), lens->half_width);
            camera.camera_to_world = checked_pose(*options_.camera_matrix);
            return sees(camera);
        }
        return std::any_of(readings_.begin(), readings_.end(),
                           [&](const HeaderCamera& reading) { return reading.has_lens && sees(reading.camera); });
    }

    /// Mean distance of the seen points from the origin.
    double scene_size() const {
        double size = 0;
        for (const Sighting& s : seen_) size += length(s.point) / static_cast<double>(seen_.size());
        return size;
    }

    void look_at_samples() {
        seen_ = sightings(impl_, sample_.rows, sample_.position, planar_depth_plane(sample_.depth));
    }

    /// Little of the picture may be surface.
    void look_at_all() {
        if (impl_.data_window.empty()) return;
        std::vector<int> raws = impl_.find("position")->raws;
        const Semantic* depth = impl_.find("depth");
        if (depth) raws.push_back(depth->raws.front());
        const std::vector<SampledRow> dense = sample_rows(impl_, raws, threads_, true);
        seen_ = sightings(impl_, dense, 0, planar_depth_plane(depth ? 3 : -1));
        seen_all_ = true;
    }

    /// The camera that the positions determine: a fit takes as long as all the rest, so it waits until it is asked for.
    const std::optional<CameraFit>& fitted() {
        if (fit_asked_ || sample_.position < 0) return fit_;
        fit_asked_ = true;
        fit();
        if (!fit_ && !seen_all_ && seen_.size() < kFewSightings) {
            look_at_all();
            fit();
        }
        if (fit_ && !(fit_->median_error < kLargestError)) {
            why_ = format("the best pinhole camera misses the positions by %.3g pixels", fit_->median_error);
            fit_.reset();
        }
        return fit_;
    }

    int planar_depth_plane(int plane) const {
        const Semantic* depth = impl_.find("depth");
        return depth && !depth->far ? plane : -1;
    }

    void fit() { fit_ = fit_camera(seen_, impl_.display_window, aspect(), why_); }

    /// Positions that put the camera at the origin, straight ahead, are in camera space whatever the table says.
    void judge_position_space() {
        Semantic& position = *impl_.find("position");
        const int own = own_space(fit_->camera, scene_size());
        if (position.space == Space::camera && own == 0) {
            position.space = Space::world;
            position.sign = {1, 1, 1};
            position.info.reason += "; but the camera that they determine does not stand at their origin: world space";
            refit();
        } else if (own != 0 && (position.space == Space::world || own < 0)) {
            position.space = Space::camera;
            if (own < 0) position.sign[2] *= -1;
            position.info.reason +=
                std::string("; the camera that they determine stands at their origin and looks along ") +
                (own > 0 ? "-Z" : "+Z") + ": camera space";
            if (own < 0) refit();
        }
    }

    void refit() {
        look_at_samples();
        fit();
    }

    bool in_camera_space() const {
        const Semantic* position = impl_.find("position");
        return position && position->space == Space::camera;
    }

    bool from_header(const std::optional<GivenLens>& lens) {
        if (readings_.empty()) return false;
        const bool testable = seen_.size() >= kLeastSightings && !in_camera_space();
        const HeaderCamera* best = nullptr;
        double best_error = std::numeric_limits<double>::infinity();
        Camera camera;
        std::string lens_reason;
        for (const HeaderCamera& reading : readings_) {
            Camera candidate = reading.camera;
            std::string words;
            if (!reading.has_lens) complete(candidate, lens, words);
            const double error = testable ? median_reprojection_error(candidate, seen_) : reading.implausible;
            if (!(error < best_error)) continue;
            best = &reading;
            best_error = error;
            camera = candidate;
            lens_reason = words;
        }
        if (!best) return false;
        if (testable && !(best_error < kLargestError)) {
            impl_.notes.push_back("the camera in the header does not fit the positions in any reading (best: " +
                                  best->reason + format(", %.3g pixels off): it is not used", best_error));
            return false;
        }
        impl_.camera = camera;
        impl_.camera_reason = best->reason + lens_reason;
        if (testable) {
            impl_.camera_error = best_error;
            impl_.camera_reason += format("; the positions confirm it to %.2g px", best_error);
        } else {
            impl_.camera_reason += in_camera_space() ? "" : "; there are no positions to confirm it";
        }
        return true;
    }

    /// A pose needs a lens: the header's own, the positions', the user's, or the usual one.
    void complete(Camera& camera, const std::optional<GivenLens>& lens, std::string& words) {
        if (fitted()) {
            take_lens(camera, fit_->camera);
            words = "; the lens is recovered from the positions";
        } else if (header_lens_) {
            set_lens(camera, impl_.display_window, aspect(), header_lens_->half_width);
            words = "; " + header_lens_->reason;
        } else if (lens) {
            camera.projection = lens->projection;
            set_lens(camera, impl_.display_window, aspect(), lens->half_width);
            words = "; " + lens->reason + " was given";
        } else {
            set_lens(camera, impl_.display_window, aspect(), std::tan(kNormalLens * kPi / 360));
            words = format("; no lens is stated, a field of view of %.3g degrees is assumed", kNormalLens);
        }
    }

    bool from_positions() {
        if (!fitted()) {
            if (sample_.position >= 0) impl_.notes.push_back("no camera from the positions: " + why_);
            return false;
        }
        impl_.camera = fit_->camera;
        impl_.camera_error = fit_->median_error;
        std::string reason = "recovered from the positions of " + std::to_string(seen_.size()) + " pixels" +
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
        if (in_camera_space()) {
            // The fitted pose is the identity up to rounding.
            impl_.camera->camera_to_world = Camera{}.camera_to_world;
            impl_.notes.push_back(
                "positions are in camera space and nothing tells where the camera stands: lights are placed in camera "
                "space");
        }
        return true;
    }

    bool from_options(const std::optional<GivenLens>& lens) {
        if (!lens) return false;
        Camera camera;
        camera.projection = lens->projection;
        set_lens(camera, impl_.display_window, aspect(), lens->half_width);
        impl_.camera = camera;
        impl_.camera_reason =
            lens->reason +
            " was given; world space is taken as camera space, since nothing tells where the camera stands";
        return true;
    }

    void from_matrix(const std::optional<GivenLens>& lens) {
        Camera camera;
        camera.camera_to_world = checked_pose(*options_.camera_matrix);
        std::string words;
        if (lens) {
            camera.projection = lens->projection;
            set_lens(camera, impl_.display_window, aspect(), lens->half_width);
            words = " and " + lens->reason + " were given";
        } else {
            const auto with_lens =
                std::find_if(readings_.begin(), readings_.end(), [](const auto& r) { return r.has_lens; });
            if (with_lens != readings_.end() && !fitted()) {
                take_lens(camera, with_lens->camera);
                words = " was given; the lens is that of " + with_lens->reason;
            } else {
                complete(camera, lens, words);
                words = " was given" + words;
            }
        }
        impl_.camera = camera;
        impl_.camera_reason = "the matrix" + words;
        if (seen_.size() >= kLeastSightings && !in_camera_space()) {
            const double error = median_reprojection_error(camera, seen_);
            if (!(error < 2)) {
                impl_.notes.push_back(format(
                    "the camera that was given sees the positions %.3g pixels (median) from where they are", error));
            }
        }
    }

    /// A lens that was given but not needed, and says something else.
    void compare(const std::optional<GivenLens>& lens) {
        if (!lens || options_.camera_matrix || lens->projection != impl_.camera->projection) return;
        const double half_width = impl_.display_window.width * std::abs(impl_.camera->x_scale) / 2;
        if (std::abs(half_width / lens->half_width - 1) < 0.01) return;
        impl_.notes.push_back(
            lens->reason +
            format(" was given but not used: the camera found shows %.6g across at distance 1", 2 * half_width));
    }

    void assume() {
        const Semantic* normal = impl_.find("normal");
        impl_.camera_reason = "neither header nor positions nor options give one";
        if (normal && normal->space == Space::camera) {
            set_lens(impl_.view_camera, impl_.display_window, aspect(), std::tan(kNormalLens * kPi / 360));
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

    /// Holds the depth channel against the positions: along the axis, or along the ray, perhaps from the near plane on.
    void judge_depth() {
        Semantic& depth = *impl_.find("depth");
        if (!depth.detect_kind || depth.far) return;
        std::vector<double> planar, ray, offset;
        for (const Sighting& s : seen_) {
            if (!(s.depth > 0)) continue;
            const double along = planar_depth_in(s.point);
            const double length_of_ray = ray_factor(s.u, s.v);
            planar.push_back(std::abs(s.depth / along - 1));
            ray.push_back(std::abs(s.depth / (along * length_of_ray) - 1));
            offset.push_back(along - s.depth / length_of_ray);
        }
        if (planar.size() < kLeastSightings) return;
        const auto median = [](std::vector<double>& v) {
            const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
            std::nth_element(v.begin(), middle, v.end());
            return *middle;
        };
        const double planar_error = median(planar), ray_error = median(ray), shift = median(offset);
        std::vector<double> spread;
        for (const double o : offset) spread.push_back(std::abs(o - shift));
        const double shift_spread = median(spread);
        constexpr double kSame = 2e-3;
        if (planar_error < kSame && planar_error <= ray_error) {
            depth.kind = DepthKind::planar;
            depth.info.reason +=
                format("; the positions agree with a depth along the axis (median %.2g)", planar_error);
        } else if (ray_error < kSame && (!depth.near || depth.near_assumed)) {
            depth.near.reset();
            depth.kind = DepthKind::ray;
            depth.info.reason += format("; the positions agree with a depth along the ray (median %.2g)", ray_error);
        } else if (depth.kind == DepthKind::ray && shift > 0 && shift_spread < 0.05 * shift) {
            if (!depth.near || depth.near_assumed) depth.near = shift;
            depth.info.reason += format("; the positions put its start at a near plane at %.4g", shift);
        } else {
            impl_.notes.push_back(
                format("the depth channel agrees with the positions neither along the axis (%.2g off) nor along the "
                       "ray (%.2g off): positions are used",
                       planar_error, ray_error));
        }
    }

    double planar_depth_in(const Vector3& point) const {
        if (!in_camera_space()) return planar_depth(*impl_.camera, point);
        return -point[2];
    }

    double ray_factor(double u, double v) const {
        const Camera& c = *impl_.camera;
        if (c.projection == Projection::orthographic) return 1;
        const double x = u * c.x_scale + c.x_offset, y = v * c.y_scale + c.y_offset;
        return std::sqrt(x * x + y * y + 1);
    }

    /// Share of the sampled normals that face the camera when taken in `space` with these signs.
    double facing(const Semantic& normal, Space space, const std::array<float, 3>& sign) const {
        const Camera& c = *impl_.camera;
        const std::array<double, 16>& m = c.camera_to_world;
        const bool perspective = c.projection == Projection::perspective;
        const auto first = static_cast<std::size_t>(sample_.normal);
        std::int64_t count = 0, towards = 0;
        for (const SampledRow& row : sample_.rows) {
            const double y = perspective ? (row.y + 0.5) * c.y_scale + c.y_offset : 0;
            for (std::size_t i = 0; i < row.planes[first].size(); ++i) {
                Vector3 n{};
                for (std::size_t k = 0; k < 3; ++k) {
                    const double v = row.planes[first + k][i];
                    n[k] = static_cast<double>(sign[k]) * (normal.encoding == Encoding::zero_to_one ? 2 * v - 1 : v);
                }
                // Means over an edge face anywhere.
                if (!(std::abs(dot(n, n) - 1) < 0.1)) continue;
                const double x =
                    perspective ? (impl_.data_window.x + static_cast<double>(i) + 0.5) * c.x_scale + c.x_offset : 0;
                Vector3 back{-x, -y, 1};
                const double least = -0.05 * length(back);
                if (space == Space::world) {
                    back = {dot({m[0], m[1], m[2]}, back), dot({m[4], m[5], m[6]}, back),
                            dot({m[8], m[9], m[10]}, back)};
                }
                ++count;
                towards += dot(n, back) > least;
            }
        }
        return count > 0 ? static_cast<double>(towards) / static_cast<double>(count) : 1.0;
    }

    /// What is seen faces the camera: tells camera space from world space where the table leaves it open.
    void judge_normals() {
        Semantic& normal = *impl_.find("normal");
        if (!normal.detect_space || sample_.normal < 0) return;
        const double as_said = facing(normal, normal.space, normal.sign);
        const Space other = normal.space == Space::world ? Space::camera : Space::world;
        const double otherwise = facing(normal, other, {1, 1, 1});
        const auto name = [](Space space) {
            return std::string(space == Space::world ? "world space " : "camera space ");
        };
        const std::string shares = "; in " + name(normal.space) +
                                   format("%.3g %% of the normals face the camera, in ", 100 * as_said) + name(other) +
                                   format("%.3g %%", 100 * otherwise);
        if (otherwise > 0.98 && as_said < 0.9) {
            normal.space = other;
            normal.sign = {1, 1, 1};
            normal.info.reason += shares + ", which is therefore taken";
        } else {
            normal.info.reason += shares;
        }
    }

    GBuffer::Impl& impl_;
    const GBufferOptions& options_;
    const CameraSample& sample_;
    const int threads_;
    std::vector<Sighting> seen_;
    std::optional<CameraFit> fit_;
    std::string why_;
    bool fit_asked_ = false;
    bool seen_all_ = false;
    std::vector<HeaderCamera> readings_;
    std::optional<HeaderLens> header_lens_;
};

}  // namespace

void set_up_camera(GBuffer::Impl& impl, const GBufferOptions& options, const CameraSample& sample, int threads) {
    CameraSetup(impl, options, sample, threads).run();
}

}  // namespace relume::gbuffer
