// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/camera_header.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gbuffer/attributes.h"
#include "gbuffer/camera_fit.h"
#include "gbuffer/dense.h"
#include "text/number_format.h"

namespace relume::gbuffer {

namespace {

constexpr double kPi = 3.14159265358979323846;

using Matrix4 = std::array<double, 16>;  // row-major, for column vectors

Matrix4 transpose(const Matrix4& m) {
    Matrix4 t{};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) t[4 * i + j] = m[4 * j + i];
    }
    return t;
}

bool zero(double a, double b, double c) { return std::abs(a) + std::abs(b) + std::abs(c) < 1e-9; }

/// OpenEXR's matrices are meant for row vectors (translation in the last row); some writers store them the other way
/// round. An affine matrix tells by its zeros, another one is taken as `turned` says.
Matrix4 for_columns(const std::vector<double>& values, bool turned) {
    Matrix4 m{};
    std::copy(values.begin(), values.end(), m.begin());
    const bool rows = zero(m[3], m[7], m[11]), columns = zero(m[12], m[13], m[14]);
    if (columns && !rows) return m;
    if (rows && !columns) return transpose(m);
    return turned ? m : transpose(m);
}

/// Inverse of a matrix whose last row is 0 0 0 1; nothing when it is singular.
std::optional<Matrix4> affine_inverse(const Matrix4& m) {
    const Vector3 a{m[0], m[1], m[2]}, b{m[4], m[5], m[6]}, c{m[8], m[9], m[10]};
    const double det = dot(a, cross(b, c));
    if (!(std::abs(det) > 1e-30) || !std::isfinite(det)) return std::nullopt;
    const Vector3 x = scaled(cross(b, c), 1 / det), y = scaled(cross(c, a), 1 / det), z = scaled(cross(a, b), 1 / det);
    Matrix4 r{};
    for (std::size_t i = 0; i < 3; ++i) {
        r[4 * i] = x[i];
        r[4 * i + 1] = y[i];
        r[4 * i + 2] = z[i];
        r[4 * i + 3] = -(x[i] * m[3] + y[i] * m[7] + z[i] * m[11]);
    }
    r[15] = 1;
    return r;
}

double determinant_of(const Matrix4& m) {
    return dot({m[0], m[1], m[2]}, cross({m[4], m[5], m[6]}, {m[8], m[9], m[10]}));
}

/// The pose without the scale that some scenes put on their cameras. Nothing when an axis vanishes.
std::optional<Matrix4> rigid(Matrix4 m) {
    for (std::size_t j = 0; j < 3; ++j) {
        const double size = std::sqrt(m[j] * m[j] + m[4 + j] * m[4 + j] + m[8 + j] * m[8 + j]);
        if (!(size > 1e-12) || !std::isfinite(size)) return std::nullopt;
        for (std::size_t i = 0; i < 3; ++i) m[4 * i + j] /= size;
    }
    return m;
}

Matrix4 with_axes(Matrix4 m, double x, double y, double z) {
    for (std::size_t i = 0; i < 3; ++i) {
        m[4 * i] *= x;
        m[4 * i + 1] *= y;
        m[4 * i + 2] *= z;
    }
    return m;
}

/// How far a camera is from what people render with: a centred lens, the pixels' own shape, a right-handed world.
double implausibility(const Camera& camera, const Window& display, double pixel_aspect) {
    const double u = -camera.x_offset / camera.x_scale, v = -camera.y_offset / camera.y_scale;
    const double off_centre = std::abs(u - display.x - display.width / 2.0) / display.width +
                              std::abs(v - display.y - display.height / 2.0) / display.height;
    const double stretch = std::abs(std::log(std::abs(camera.x_scale / camera.y_scale) / pixel_aspect));
    return off_centre + stretch + (determinant_of(camera.camera_to_world) < 0 ? 0.5 : 0.0);
}

/// Readings of a matrix that takes the world to the picture.
void add_projections(std::vector<HeaderCamera>& found, const std::vector<double>& values, std::string_view name,
                     Producer producer, const Window& display, double pixel_aspect) {
    struct Reading {
        double x_scale, x_shift, y_scale, y_shift;  ///< pixel = display origin + size·(coordinate·scale + shift)
        std::string_view words;
    };
    static constexpr std::array kReadings{
        Reading{1, 0, 1, 0, "0..1 with y down, as OpenEXR has it"},
        Reading{0.5, 0.5, -0.5, 0.5, "-1..1 with y up"},
        Reading{1, 0, -1, 1, "0..1 with y up"},
        Reading{0.5, 0.5, 0.5, 0.5, "-1..1 with y down"},
    };
    const bool turned_first = producer == Producer::pbrt;
    for (const bool turned : {turned_first, !turned_first}) {
        Matrix4 m{};
        std::copy(values.begin(), values.end(), m.begin());
        if (!turned) m = transpose(m);
        const bool parallel = zero(m[12], m[13], m[14]);
        // The matrix of parallel rays tells by its zeros which way round it is.
        if (!parallel && zero(m[3], m[7], m[11])) continue;
        for (const Reading& reading : kReadings) {
            std::array<double, 12> p{};
            for (std::size_t k = 0; k < 4; ++k) {
                const double x = m[k], y = m[4 + k], w = m[12 + k];
                p[k] = display.width * (reading.x_scale * x + reading.x_shift * w) + display.x * w;
                p[4 + k] = display.height * (reading.y_scale * y + reading.y_shift * w) + display.y * w;
                p[8 + k] = w;
            }
            const std::optional<Camera> camera = parallel ? camera_from_affine(p) : camera_from_projection(p);
            if (!camera) continue;
            // Parallel rays do not tell which way they go, but the third coordinate grows along them.
            const std::array<double, 3> forward = camera->forward();
            const bool backwards = parallel && forward[0] * m[8] + forward[1] * m[9] + forward[2] * m[10] < 0;
            const double doubt = (backwards ? 0.5 : 0.0) + implausibility(*camera, display, pixel_aspect) +
                                 (turned != turned_first ? 0.25 : 0.0);
            found.push_back({*camera, true, doubt,
                             "the header's " + std::string(name) + ", read as " + std::string(reading.words) +
                                 (turned ? ", transposed" : "")});
        }
    }
}

/// Readings of a matrix between the world and the camera.
void add_poses(std::vector<HeaderCamera>& found, const Matrix4& m, std::string_view name, Producer producer,
               bool camera_to_world_first) {
    struct Axes {
        double x, y, z;
        std::string_view words;
    };
    static constexpr std::array kAxes{
        Axes{1, 1, 1, "looking down -Z"},
        Axes{1, 1, -1, "looking along +Z"},
        Axes{-1, 1, -1, "looking along +Z with +X to the left"},
    };
    for (const bool to_world : {camera_to_world_first, !camera_to_world_first}) {
        const std::optional<Matrix4> pose = to_world ? std::optional(m) : affine_inverse(m);
        const std::optional<Matrix4> clean = pose ? rigid(*pose) : std::nullopt;
        if (!clean) continue;
        const bool left_handed = determinant_of(*clean) < 0;
        for (const Axes& axes : kAxes) {
            HeaderCamera reading;
            reading.camera.camera_to_world = with_axes(*clean, axes.x, axes.y, axes.z);
            const bool forward = producer == Producer::pbrt || producer == Producer::renderman || left_handed;
            const double habit = forward      ? (axes.z < 0 && axes.x > 0 ? 0.0 : 0.2)
                                 : axes.z > 0 ? 0.0
                                 : axes.x < 0 ? 0.2
                                              : 0.3;
            reading.implausible = 1 + habit + (to_world != camera_to_world_first ? 0.5 : 0.0);
            reading.reason = "the header's " + std::string(name) + ", read as " +
                             (to_world ? "camera to world" : "world to camera") + ", " + std::string(axes.words);
            found.push_back(std::move(reading));
        }
    }
}

void add_vray(std::vector<HeaderCamera>& found, const io::Header& header, const Matrix4& m, std::string_view name) {
    const std::optional<Matrix4> pose = rigid(m);
    if (!pose) return;
    const std::string* version = text_attribute(header, "vrayInfo/vrayversion");
    const bool maya = version && version->find("Maya") != std::string::npos;
    // In Maya V-Ray's camera frame is turned a quarter about X: up is its -Z, and it looks along its -Y.
    Matrix4 turned = *pose;
    for (std::size_t i = 0; i < 3; ++i) {
        turned[4 * i + 1] = -(*pose)[4 * i + 2];
        turned[4 * i + 2] = (*pose)[4 * i + 1];
    }
    const std::string reason = "V-Ray's " + std::string(name) + ", which is camera to world";
    HeaderCamera plain, quarter;
    plain.camera.camera_to_world = *pose;
    plain.implausible = maya ? 0.5 : 0.0;
    plain.reason = reason;
    quarter.camera.camera_to_world = turned;
    quarter.implausible = maya ? 0.0 : 0.5;
    quarter.reason = reason + ", turned a quarter about X as V-Ray for Maya has it";
    found.push_back(std::move(plain));
    found.push_back(std::move(quarter));
}

/// Unreal writes a place and three angles: X forward, Y right, Z up in a left-handed world.
void add_unreal(std::vector<HeaderCamera>& found, const io::Header& header) {
    std::array<double, 6> v{};
    constexpr std::array<std::string_view, 6> kNames{"curPos/x",     "curPos/y",   "curPos/z",
                                                     "curRot/pitch", "curRot/yaw", "curRot/roll"};
    for (std::size_t i = 0; i < v.size(); ++i) {
        const std::optional<double> value = number_attribute(header, "unreal/camera/" + std::string(kNames[i]));
        if (!value || !std::isfinite(*value)) return;
        v[i] = *value;
    }
    const double sp = std::sin(v[3] * kPi / 180), cp = std::cos(v[3] * kPi / 180);
    const double sy = std::sin(v[4] * kPi / 180), cy = std::cos(v[4] * kPi / 180);
    const double sr = std::sin(v[5] * kPi / 180), cr = std::cos(v[5] * kPi / 180);
    const Vector3 forward{cp * cy, cp * sy, sp};
    const Vector3 right{sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, -sr * cp};
    const Vector3 up{-(cr * sp * cy + sr * sy), cy * sr - cr * sp * sy, cr * cp};
    HeaderCamera reading;
    for (std::size_t i = 0; i < 3; ++i) {
        reading.camera.camera_to_world[4 * i] = right[i];
        reading.camera.camera_to_world[4 * i + 1] = up[i];
        reading.camera.camera_to_world[4 * i + 2] = -forward[i];
        reading.camera.camera_to_world[4 * i + 3] = v[i];
    }
    reading.reason = "Unreal's curPos and curRot";
    found.push_back(std::move(reading));
}

}  // namespace

void set_lens(Camera& camera, const Window& display, double pixel_aspect, double half_width) {
    // A pixel is pixel_aspect times as wide as it is high.
    camera.x_scale = 2 * half_width / display.width;
    camera.y_scale = -camera.x_scale / pixel_aspect;
    camera.x_offset = -(display.x + display.width / 2.0) * camera.x_scale;
    camera.y_offset = -(display.y + display.height / 2.0) * camera.y_scale;
}

std::optional<HeaderLens> header_lens(const io::Header& header) {
    const auto text = [](const char* pattern, double a, double b = 0) { return format_numbers(pattern, {a, b}); };
    std::vector<std::string> fields{"cameraFov", "camera/fov", "fov"};
    for (const io::Part& part : header.parts) {
        for (const io::Attribute& attribute : part.attributes) {
            // Movie Render Queue writes one for each render pass.
            if (attribute.name.starts_with("unreal/camera/") && attribute.name.ends_with("/fov"))
                fields.push_back(attribute.name);
        }
    }
    for (const std::string& field : fields) {
        const std::optional<double> fov = number_attribute(header, field);
        if (fov && *fov > 0 && *fov < 180) {
            return HeaderLens{std::tan(*fov * kPi / 360), "the header's " + field + text(" of %.6g degrees", *fov)};
        }
    }
    struct Pair {
        std::string_view focal, aperture;
    };
    for (const Pair& names :
         {Pair{"cameraFocalLength", "cameraAperture"}, Pair{"CameraFocalLength", "CameraFilmApertureHorizontal"}}) {
        const std::optional<double> focal = number_attribute(header, names.focal);
        const std::optional<double> aperture = number_attribute(header, names.aperture);
        if (focal && aperture && *focal > 0 && *aperture > 0) {
            return HeaderLens{*aperture / (2 * *focal),
                              "the header's focal length and aperture" + text(" (%.6g, %.6g)", *focal, *aperture)};
        }
    }
    return std::nullopt;
}

std::vector<HeaderCamera> header_cameras(const io::Header& header, Producer producer, const Window& display,
                                         double pixel_aspect) {
    std::vector<HeaderCamera> found;
    for (const std::string_view name : {"worldToNDC", "worldToScreen", "NP"}) {
        if (const std::vector<double>* values = numbers_attribute(header, name, 16)) {
            add_projections(found, *values, name, producer, display, pixel_aspect);
        }
    }
    const std::vector<double>* world_to_camera = numbers_attribute(header, "worldToCamera", 16);
    const std::vector<double>* transform = numbers_attribute(header, "cameraTransform", 16);
    if (transform) {
        const Matrix4 m = for_columns(*transform, true);
        add_vray(found, header, m, "cameraTransform");
        add_poses(found, m, "cameraTransform", producer, true);
    }
    if (world_to_camera) {
        const bool vray = producer == Producer::vray;
        const Matrix4 m = for_columns(*world_to_camera, vray || producer == Producer::pbrt);
        // OpenImageIO calls V-Ray's cameraTransform so, though it goes the other way.
        if (vray) add_vray(found, header, m, "worldToCamera");
        add_poses(found, m, "worldToCamera", producer, vray);
    }
    add_unreal(found, header);
    std::stable_sort(found.begin(), found.end(),
                     [](const HeaderCamera& a, const HeaderCamera& b) { return a.implausible < b.implausible; });
    return found;
}

}  // namespace relume::gbuffer
