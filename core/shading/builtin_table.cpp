// SPDX-License-Identifier: Apache-2.0
#include "shading/builtin_table.h"

#include <cmath>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "relume/error.h"
#include "relume/shader.h"

namespace relume {

namespace {

LookupTable sampled(const ShaderAbi& abi, std::int32_t slot) {
    LookupTable table{kBuiltinTableWidth, kBuiltinTableHeight, {}};
    // The outermost texels hold 0 and 1 exactly, half a texel inside the picture: so a peak there is kept.
    for (int y = 0; y < table.height; ++y)
        for (int x = 0; x < table.width; ++x)
            table.texels.push_back(static_cast<float>(abi.default_table(
                slot, static_cast<double>(x) / (table.width - 1), static_cast<double>(y) / (table.height - 1))));
    return table;
}

}  // namespace

void check_table(const LookupTable& table, std::string_view what) {
    const auto refuse = [&](const std::string& why) { throw Error(ErrorKind::value, std::string(what) + ": " + why); };
    const auto width = static_cast<std::int64_t>(table.width), height = static_cast<std::int64_t>(table.height);
    const std::string size = std::to_string(width) + " × " + std::to_string(height);
    if (width < 1 || height < 1) refuse("a table of " + size + " has no texels");
    if (width > kMostTexels || height > kMostTexels || width * height > kMostTexels)
        refuse("is " + size + "; a table has at most " + std::to_string(kMostTexels) +
               " texels: it is smooth between them, so make it smaller");
    if (static_cast<std::int64_t>(table.texels.size()) != width * height)
        refuse("has " + std::to_string(table.texels.size()) + " texels, not " + size);
    for (std::size_t i = 0; i < table.texels.size(); ++i)
        if (!std::isfinite(table.texels[i]))
            refuse("the texel in column " + std::to_string(static_cast<std::int64_t>(i) % width) + ", row " +
                   std::to_string(static_cast<std::int64_t>(i) / width) + " is not finite");
}

std::shared_ptr<const LookupTable> builtin_table(const ShaderInfo& shader, std::string_view parameter) {
    static std::mutex mutex;
    static std::map<std::pair<const ShaderAbi*, std::int32_t>, std::shared_ptr<const LookupTable>> made;
    for (const Parameter& p : shader.parameters) {
        if (p.type != ParameterType::table || p.name != parameter) continue;
        const std::lock_guard lock(mutex);
        auto& table = made[{shader.abi, p.slot}];
        if (!table) table = std::make_shared<const LookupTable>(sampled(*shader.abi, p.slot));
        return table;
    }
    throw Error(ErrorKind::parameter,
                "shader '" + std::string(shader.name) + "' has no table '" + std::string(parameter) + "'");
}

}  // namespace relume
