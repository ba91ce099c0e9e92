// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace relume::io {

/// A walk through a ZIP chunk that was inflated and no more. EXR stores its bytes as the even ones followed by the odd
/// ones, and of each but the first the difference to the one before (plus 128). Undoing that channel by channel touches
/// the bytes of wanted channels alone, but for one sum over the others, and a half becomes a float on the way.
class ZipRows {
public:
    /// `bytes`: `size` of them, an even number. `scalar`: by the reference instead of this machine's widest
    /// instructions.
    ZipRows(const std::byte* bytes, std::size_t size, bool scalar = false);

    /// Leaves out the next `size` bytes of pixels (an even number).
    void skip(std::size_t size);
    /// The next `size` bytes of pixels (an even number) as they were before the compression.
    void read(std::byte* out, std::size_t size);
    /// The next `count` halves as floats.
    void read_halves(std::byte* floats, std::size_t count);

private:
    const std::uint8_t* even_;
    const std::uint8_t* odd_;
    /// Sums of the stored bytes so far; a pixel's byte is the sum up to it, with its top bit turned at odd positions.
    std::uint8_t even_sum_ = 0;
    std::uint8_t odd_sum_ = 0;
    std::uint8_t even_flip_ = 0;
    std::uint8_t odd_flip_ = 0;
    bool scalar_;
};

}  // namespace relume::io
