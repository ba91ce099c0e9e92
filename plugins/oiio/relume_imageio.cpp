// SPDX-License-Identifier: Apache-2.0
// The format plugin: a rig file (.relume) opens as an image, the relit frame and an AOV in each further subimage.
#include <OpenImageIO/imageio.h>

#include <exception>
#include <new>

#include "oiio/picture_spec.h"
#include "oiio/relit_frame.h"
#include "oiio/rig_name.h"
#include "oiio/stored_images.h"
#include "relume/error.h"
#include "relume/version.h"
#include "rig/value_text.h"

namespace {

using OIIO::ImageSpec;
using relume::oiio::RelitFrame;

constexpr OIIO::string_view kPrefix = "relume:";

/// A host's hint as the TOML of a rig's key.
std::string setting_text(const OIIO::ParamValue& hint) {
    const OIIO::TypeDesc type = hint.type();
    const int count = static_cast<int>(type.basevalues()) * hint.nvalues();
    const bool strings = type.basetype == OIIO::TypeDesc::STRING;
    if (strings && count == 1) return hint.get_string_indexed(0);
    // A colour or matrix is one element of several numbers: the numbers are wanted, one by one.
    const OIIO::TypeDesc list(static_cast<OIIO::TypeDesc::BASETYPE>(type.basetype), count);
    const OIIO::ParamValue values(hint.name(), list, 1, hint.data());
    std::string text;
    for (int k = 0; k < count; ++k) {
        const std::string value = values.get_string_indexed(k);
        text += (k > 0 ? ", " : "") + (strings ? relume::rigfile::string_text(value) : value);
    }
    return count > 1 ? '[' + text + ']' : text;
}

// The constructor runs when a host looks through its formats: there is nothing to do in it.
class RelumeInput final : public OIIO::ImageInput {
public:
    ~RelumeInput() override { RelumeInput::close(); }

    const char* format_name() const override { return "relume"; }

    int supports(OIIO::string_view feature) const override {
        return feature == "multiimage" || feature == "arbitrary_metadata";
    }

    // By the name alone: hosts ask this of any file, some with a lock held that reading a file takes.
    bool valid_file(const std::string& name) const override { return relume::oiio::parse_name(name).has_value(); }

    bool open(const std::string& name, ImageSpec& spec) override { return open(name, spec, ImageSpec()); }

    bool open(const std::string& name, ImageSpec& spec, const ImageSpec& config) override {
        const lock_guard lock(*this);
        close();
        return guarded([&] {
            auto rig = relume::oiio::parse_name(name);
            if (!rig)
                throw relume::Error(relume::ErrorKind::format, name + ": is no rig file; its name ends in .relume");
            for (const OIIO::ParamValue& hint : config.extra_attribs)
                if (OIIO::string_view hinted = hint.name();
                    hinted.size() > kPrefix.size() && hinted.substr(0, kPrefix.size()) == kPrefix)
                    rig->settings.emplace_back(std::string(hinted.substr(kPrefix.size())), setting_text(hint));
            relume::oiio::install_reader();
            frame_ = RelitFrame::get(relume::oiio::load_rig(*rig));
            select(0);
            spec = m_spec;
        });
    }

    bool close() override {
        const lock_guard lock(*this);
        frame_.reset();
        picture_ = -1;
        m_spec = ImageSpec();
        return true;
    }

    int current_subimage() const override {
        const lock_guard lock(*this);
        return picture_;
    }
    int current_miplevel() const override { return 0; }

    bool seek_subimage(int subimage, int miplevel) override {
        const lock_guard lock(*this);
        if (!frame_ || subimage < 0 || miplevel != 0 || subimage >= static_cast<int>(frame_->pictures().size()))
            return false;
        select(subimage);
        return true;
    }

    bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
        return read_native_scanlines(subimage, miplevel, y, y + 1, z, data);
    }

    bool read_native_scanlines(int subimage, int miplevel, int y, int y_end, int, void* data) override {
        const lock_guard lock(*this);
        if (!sought(subimage, miplevel)) return false;
        return read(m_spec.x, m_spec.x + m_spec.width, y, std::min(y_end, m_spec.y + m_spec.height), data,
                    static_cast<std::ptrdiff_t>(m_spec.scanline_bytes(true)));
    }

    bool read_native_tile(int subimage, int miplevel, int x, int y, int, void* data) override {
        const lock_guard lock(*this);
        if (!sought(subimage, miplevel)) return false;
        return read(x, std::min(x + m_spec.tile_width, m_spec.x + m_spec.width), y,
                    std::min(y + m_spec.tile_height, m_spec.y + m_spec.height), data,
                    static_cast<std::ptrdiff_t>(m_spec.pixel_bytes(true)) * m_spec.tile_width);
    }

    // Hosts want the rows of [x, x_end) without gaps, whether or not that is whole tiles.
    bool read_native_tiles(int subimage, int miplevel, int x, int x_end, int y, int y_end, int, int,
                           void* data) override {
        const lock_guard lock(*this);
        if (!sought(subimage, miplevel)) return false;
        return read(x, std::min(x_end, m_spec.x + m_spec.width), y, std::min(y_end, m_spec.y + m_spec.height), data,
                    static_cast<std::ptrdiff_t>(m_spec.pixel_bytes(true)) * (x_end - x));
    }

private:
    /// No exception reaches the host: it becomes the host's error text.
    template <class Work> bool guarded(Work&& work) {
        try {
            work();
            return true;
        } catch (const relume::Error& error) {
            errorfmt("{}", error.what());
        } catch (const std::bad_alloc&) {
            errorfmt("relume: out of memory");
        } catch (const std::exception& error) {
            errorfmt("relume: {}", error.what());
        } catch (...) {
            errorfmt("relume: unknown error");
        }
        return false;
    }

    void select(int picture) {
        if (picture == picture_) return;
        m_spec = relume::oiio::picture_spec(*frame_, picture);
        picture_ = picture;
    }

    bool sought(int subimage, int miplevel) {
        if (!frame_) {
            errorfmt("relume: no file is open");
            return false;
        }
        if (seek_subimage(subimage, miplevel)) return true;
        errorfmt("relume: no subimage {} (mip level {}); the rig makes {}", subimage, miplevel,
                 frame_->pictures().size());
        return false;
    }

    bool read(int x, int x_end, int y, int y_end, void* data, std::ptrdiff_t stride) {
        if (x < m_spec.x || y < m_spec.y || x >= x_end || y >= y_end) {
            errorfmt("relume: pixels {}..{}, {}..{} do not lie in the data window", x, x_end, y, y_end);
            return false;
        }
        // Who reads whole rows from the top on will want the rest: as much ahead as was read already, so that a frame
        // takes few renders and nobody pays for more than twice what was read.
        const bool whole_rows = x == m_spec.x && x_end == m_spec.x + m_spec.width;
        if (!whole_rows || y != next_row_) rows_read_ = 0;
        const int ahead = rows_read_;
        rows_read_ = whole_rows ? rows_read_ + (y_end - y) : 0;
        next_row_ = y_end;
        return guarded(
            [&] { frame_->read(picture_, x, x_end, y, y_end, static_cast<std::byte*>(data), stride, ahead); });
    }

    std::shared_ptr<RelitFrame> frame_;
    int picture_ = -1;
    int next_row_ = 0;   ///< below the rows that were read last
    int rows_read_ = 0;  ///< whole rows without a gap, up to there
};

}  // namespace

OIIO_PLUGIN_EXPORTS_BEGIN

OIIO_EXPORT int relume_imageio_version = OIIO_PLUGIN_VERSION;

OIIO_EXPORT const char* relume_imageio_library_version() {
    static const std::string text = "relume " + std::string(relume::version());
    return text.c_str();
}

OIIO_EXPORT OIIO::ImageInput* relume_input_imageio_create() { return new RelumeInput; }

OIIO_EXPORT const char* relume_input_extensions[] = {"relume", nullptr};

OIIO_PLUGIN_EXPORTS_END
