// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "relume/image.h"
#include "relume/parameter.h"

namespace relume::gbuffer {

/// Longest way to a neighbour that repairs an edge pixel.
inline constexpr int kRepairReach = 8;
/// Less than this of a pixel is no surface: dividing by it would only amplify rounding.
inline constexpr float kLeastCoverage = 1e-4f;

/// One operation on a run of pixels. Sources and results are registers: rows of floats (or integers) that hold the run.
enum class Op : std::uint8_t {
    scale,     ///< r = a·scale + offset
    divide,    ///< r = a·b·scale + offset, b = 1/coverage
    product,   ///< r = a·b
    coverage,  ///< r0 = clamped Σ sources, r1 = 1/r0 or 0
    direction,  ///< r0…2 = unit vector of a0…2 (times a4 when given) in world space, 0 where it or coverage a3 is 0; of
                ///< the pixel that a5 names where one stands in
    turn,            ///< r0…2 = a0…2, negated where it looks away from a3…5
    point,           ///< r0…2 = a0…2 (times a4 when given) in world space, repaired (by a3 when given)
    depth,           ///< r = planar depth of a0 (times a2 when given), repaired (by a1 when given)
    depth_of_point,  ///< r = planar depth of the point a0…2
    point_at_depth,  ///< r0…2 = the pixel's ray at planar depth a0
    view,            ///< r0…2 = unit vector to the camera
    repair,          ///< r = column offset, as integer, to the pixel that stands in for this one, 0 when it needs none;
                     ///< from a position a0…2 or, with `ray`, a depth a0; a3 is coverage or a3…5 the normal
    metal_base,      ///< r = (a0 + a1·a2)·a3: diffuse + metallic·glossy, divided by coverage
    identifier,      ///< r = a rounded, as integers, repaired (by a1 when given)
    matte,           ///< r = Σ coverage of the matching ranks, over layers the largest
    ones,            ///< r = 1
    variance,  ///< r = what alpha² grows by for the length of the normal a0…2: of whole pixels by coverage a3, or
               ///< of all of them where the normal is to be multiplied by a4; `scale` is the dead zone,
               ///< `near` that of pixels with a share of the background
    face,      ///< r0 = as `repair`, the pixel beside this one that shows the face which most of it shows, 0 where
               ///< it shows one alone or none is known, r1 = the variance that is left of a3; normal a0…2
    widen,     ///< r = a0 (or `offset` where there is none), as wide as `lobe_width` says, with variance a1
};

/// A Cryptomatte layer of a matte: pairs of registers, and the IDs to look for, sorted.
struct MatteLayer {
    std::vector<std::pair<int, int>> ranks;
    std::vector<std::uint32_t> ids;
};

struct Step {
    Op op = Op::scale;
    std::array<int, 6> in{-1, -1, -1, -1, -1, -1};
    std::array<int, 3> out{-1, -1, -1};
    std::vector<int> sum;            ///< coverage: all sources
    std::vector<MatteLayer> layers;  ///< matte
    float scale = 1;
    float offset = 0;
    std::array<float, 3> multiply{1, 1, 1};  ///< vectors: decoding and flips, before anything else
    std::array<float, 3> add{};
    bool transform = false;          ///< vectors: by `matrix`
    std::array<float, 12> matrix{};  ///< row-major 3×4
    bool ray = false;                ///< depth: measured along the pixel's ray
    float background = 1e-12f;       ///< direction: squared length up to which it is none
    float near = 0;                  ///< depth along the ray: where it starts
    LobeWidth lobe_width = LobeWidth::none;
    int block_rows = 0;  ///< face: rows that are always loaded together, counted from `block_top`; 0: all of them
    int block_top = 0;
};

/// The neighbour in column dx (−8…8) and row dy (−1…1), as one number that is never 0.
constexpr std::int32_t stand_in(int dx, int dy) { return (dy + 2) << 8 | (dx + 128); }
constexpr int stand_in_column(std::int32_t code) { return (code & 255) - 128; }
constexpr int stand_in_row(std::int32_t code) { return (code >> 8) - 2; }

/// Where the run stands and where the camera sees it: for pixel centres at column i (absolute), the ray in world space
/// is row_ray + i·column_ray, with a component of 1 along the view axis (perspective), or starts there (orthographic).
struct RunGeometry {
    bool perspective = true;
    std::array<double, 3> origin{};
    std::array<double, 3> forward{};
    std::array<double, 3> row_ray{};
    std::array<double, 3> column_ray{};
    std::array<double, 3> next_row{};  ///< what a row further down adds
};

/// The rows next to the loaded ones, read when they are asked for: that decodes another chunk of the file.
class NeighbourRows {
public:
    virtual ~NeighbourRows() = default;
    /// The row above (-1) or below (1) the loaded ones, of a raw register; its pixels start with the window's.
    virtual ConstPlane row(int raw_register, int direction) const = 0;
};

/// Pixels of whole rows around the run, for repairs.
struct RowPlanes {
    const ConstPlane* planes = nullptr;  ///< one per raw register
    int y = 0;                           ///< of the run, absolute
    int row = 0;                         ///< of the run, in the planes
    int rows = 0;                        ///< of the planes
    int first_column = 0;                ///< of the run, in the planes
    int width = 0;                       ///< of the planes
    bool above = false;                  ///< the window has a row above the run's
    bool below = false;
    bool above_close = false;  ///< and it stands in the same chunk, so that it costs nothing
    bool below_close = false;
    const NeighbourRows* beyond = nullptr;
};

/// Runs one step over `count` pixels, the first of which is in absolute column `x`.
void run(const Step& step, const float* const* registers, float* const* results, int count, int x,
         const RunGeometry& geometry, const RowPlanes& rows);

}  // namespace relume::gbuffer
