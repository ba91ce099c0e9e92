// SPDX-License-Identifier: Apache-2.0
#include "ofx_host.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "io/pixel_convert.h"

namespace relume::ofx::test {

namespace {

constexpr std::byte kGuard{0xA5};
constexpr std::size_t kGuardBytes = 4096;

}  // namespace

Host* Host::current = nullptr;
thread_local Image* Host::output = nullptr;

// ---- parameters

Parameter::Parameter(Host* host, std::string type_name) : type(std::move(type_name)), properties(host) {
    declare_parameter(properties, type);
}

void Parameter::reset() {
    keys.clear();
    if (type == name::kParamString) value = properties.text(name::kPropDefault);
    else if (type == name::kParamDouble) value = std::vector{properties.number(name::kPropDefault)};
    else if (type == name::kParamDouble2D || type == name::kParamDouble3D || type == name::kParamRgb) {
        std::vector<double> numbers;
        for (int k = 0; k < (type == name::kParamDouble2D ? 2 : 3); ++k)
            numbers.push_back(properties.number(name::kPropDefault, k));
        value = numbers;
    } else if (properties.has(name::kPropDefault)) {
        value = properties.integer(name::kPropDefault);
    }
}

Parameter::Value Parameter::at(double time) const {
    if (keys.empty()) return value;
    const auto after = keys.lower_bound(time);
    if (after == keys.end()) return std::prev(after)->second;
    if (after == keys.begin() || after->first == time) return after->second;
    const auto before = std::prev(after);
    const auto* from = std::get_if<std::vector<double>>(&before->second);
    if (from == nullptr) return before->second;
    const auto& to = std::get<std::vector<double>>(after->second);
    const double share = (time - before->first) / (after->first - before->first);
    std::vector<double> mixed;
    for (std::size_t k = 0; k < from->size(); ++k) mixed.push_back((*from)[k] + share * (to[k] - (*from)[k]));
    return mixed;
}

// ---- pictures, clips and images

Picture::Picture(const OfxRectI& rect, const std::function<float(int, int, int)>& value) : bounds(rect) {
    for (int y = rect.y1; y < rect.y2; ++y)
        for (int x = rect.x1; x < rect.x2; ++x)
            for (int c = 0; c < 4; ++c) pixels.push_back(value(x, y, c));
}

float Picture::at(int x, int y, int component) const {
    if (x < bounds.x1 || x >= bounds.x2 || y < bounds.y1 || y >= bounds.y2) return 0;
    const auto row = static_cast<std::size_t>(y - bounds.y1) * static_cast<std::size_t>(bounds.x2 - bounds.x1);
    return pixels[4 * (row + static_cast<std::size_t>(x - bounds.x1)) + static_cast<std::size_t>(component)];
}

Clip::Clip(Host* owner) : host(owner), properties(owner) {}
Clip::~Clip() = default;

OfxRectD Clip::region(double time) const {
    if (region_of_definition) return *region_of_definition;
    if (!picture) return {};
    const OfxRectI b = picture(time).bounds;
    return {b.x1 * aspect, 1.0 * b.y1, b.x2 * aspect, 1.0 * b.y2};
}

int component_count_of(const std::string& components) {
    return components == name::kRgba ? 4 : components == name::kRgb ? 3 : 1;
}

Image::Image(Host* host) : properties(host), depth(name::kDepthFloat), components(name::kRgba) {
    properties.declare(name::kPropData, static_cast<void*>(nullptr));
    properties.declare(name::kPropBounds, 0, 4);
    properties.declare(name::kPropImageRegionOfDefinition, 0, 4);
    properties.declare(name::kPropRowBytes, 0);
    properties.declare(name::kPropComponents, std::string());
    properties.declare(name::kPropPixelDepth, std::string());
    properties.declare(name::kPropPremultiplication, std::string(name::kPremultiplied));
    properties.declare(name::kPropImageAspect, 1.0);
    properties.declare(name::kPropRenderScale, 1.0, 2);
}

int Image::component_count() const { return component_count_of(components); }

std::size_t Image::component_bytes() const {
    return depth == name::kDepthByte ? 1 : depth == name::kDepthFloat ? 4 : 2;
}

std::byte* Image::at(int x, int y, int component) const {
    return first + (y - bounds.y1) * row_bytes +
           static_cast<std::ptrdiff_t>(component_bytes()) * ((x - bounds.x1) * component_count() + component);
}

float Image::number(int x, int y, int component) const {
    const std::byte* from = at(x, y, component);
    if (depth == name::kDepthByte) return static_cast<float>(std::to_integer<int>(*from)) / 255.f;
    std::uint16_t bits = 0;
    if (depth != name::kDepthFloat) std::memcpy(&bits, from, 2);
    if (depth == name::kDepthShort) return static_cast<float>(bits) / 65535.f;
    if (depth == name::kDepthHalf) return io::half_to_float(bits);
    float value = 0;
    std::memcpy(&value, from, 4);
    return value;
}

void Image::put(int x, int y, int component, float value) {
    std::byte* to = at(x, y, component);
    const double clamped = std::clamp(static_cast<double>(value), 0.0, 1.0);
    if (depth == name::kDepthByte) {
        *to = static_cast<std::byte>(std::lround(clamped * 255));
    } else if (depth == name::kDepthShort) {
        const auto bits = static_cast<std::uint16_t>(std::lround(clamped * 65535));
        std::memcpy(to, &bits, 2);
    } else if (depth == name::kDepthHalf) {
        const std::uint16_t bits = io::float_to_half(value);
        std::memcpy(to, &bits, 2);
    } else {
        std::memcpy(to, &value, 4);
    }
}

void Image::allocate(int padding, bool top_down) {
    const std::ptrdiff_t row =
        static_cast<std::ptrdiff_t>(component_bytes()) * component_count() * (bounds.x2 - bounds.x1) + padding;
    const auto rows = static_cast<std::size_t>(bounds.y2 - bounds.y1);
    memory.assign(static_cast<std::size_t>(row) * rows + 2 * kGuardBytes, kGuard);
    row_bytes = top_down ? -row : row;
    first = memory.data() + kGuardBytes + (top_down && rows > 0 ? row * static_cast<std::ptrdiff_t>(rows - 1) : 0);
    properties.set<void*>(name::kPropData, 0, first);
    const int b[4] = {bounds.x1, bounds.y1, bounds.x2, bounds.y2};
    for (int k = 0; k < 4; ++k) {
        properties.set<int>(name::kPropBounds, k, b[k]);
        properties.set<int>(name::kPropImageRegionOfDefinition, k, b[k]);
    }
    properties.set<int>(name::kPropRowBytes, 0, static_cast<int>(row_bytes));
    properties.set<std::string>(name::kPropComponents, 0, components);
    properties.set<std::string>(name::kPropPixelDepth, 0, depth);
}

bool Image::margins_untouched() const {
    const auto guard = [](std::byte b) { return b == kGuard; };
    const auto size = static_cast<std::ptrdiff_t>(kGuardBytes);
    if (!std::all_of(memory.begin(), memory.begin() + size, guard) ||
        !std::all_of(memory.end() - size, memory.end(), guard))
        return false;
    // The padding of each row.
    const std::ptrdiff_t used =
        static_cast<std::ptrdiff_t>(component_bytes()) * component_count() * (bounds.x2 - bounds.x1);
    for (int y = bounds.y1; y < bounds.y2; ++y) {
        const std::byte* row = first + (y - bounds.y1) * row_bytes;
        if (!std::all_of(row + used, row + std::abs(row_bytes), guard)) return false;
    }
    return true;
}

// ---- the host

Host::Host(HostOptions options) : options_(std::move(options)) {
    properties_.declare(name::kPropName, options_.name);
    property_suite_ = property_suite();
    effect_suite_ = effect_suite();
    parameter_suite_ = parameter_suite();
    message_suite_ = message_suite();
    const auto strike = [&](const char* member, auto& pointer) {
        if (options_.null_members.contains(member)) pointer = nullptr;
    };
    strike("propGetInt", property_suite_.propGetInt);
    strike("abort", effect_suite_.abort);
    strike("clipGetPropertySet", effect_suite_.clipGetPropertySet);
    strike("clipGetRegionOfDefinition", effect_suite_.clipGetRegionOfDefinition);
    strike("clipGetImage", effect_suite_.clipGetImage);
    strike("paramGetValueAtTime", parameter_suite_.paramGetValueAtTime);
    strike("paramSetValue", parameter_suite_.paramSetValue);
    strike("paramGetPropertySet", parameter_suite_.paramGetPropertySet);
    strike("message", message_suite_.message);
    strike("setPersistentMessage", message_suite_.setPersistentMessage);
    strike("clearPersistentMessage", message_suite_.clearPersistentMessage);
    abi_.host = properties_.handle();
    abi_.fetchSuite = [](OfxPropertySetHandle, const char* name, int version) -> const void* {
        return current->suite(name, version);
    };
    current = this;
}

Host::~Host() {
    if (current == this) current = nullptr;
}

const void* Host::suite(const char* name, int version) {
    if (options_.missing_suites.contains(name) ||
        options_.missing_suites.contains(std::string(name) + " " + std::to_string(version)))
        return nullptr;
    const std::string wanted = name;
    if (const auto other = options_.suite_versions.find(wanted); other != options_.suite_versions.end()) {
        if (version != other->second) return nullptr;
        version = 1;
    }
    if (wanted == name::kMessageSuite && (version == 1 || version == 2)) return &message_suite_;
    if (version != 1) return nullptr;
    if (wanted == name::kPropertySuite) return &property_suite_;
    if (wanted == name::kImageEffectSuite) return &effect_suite_;
    if (wanted == name::kParameterSuite) return &parameter_suite_;
    return nullptr;
}

void Host::complain(const std::string& what) {
    if (!options_.complain) return;
    const std::scoped_lock lock(complaints_mutex_);
    complaints_.push_back(what);
}

std::vector<std::string> Host::complaints() const {
    const std::scoped_lock lock(complaints_mutex_);
    return complaints_;
}

}  // namespace relume::ofx::test
