// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "relume/error.h"
#include "relume/rig.h"
#include "relume/shader.h"
#include "relume/shader_abi.h"
#include "shading/builtin_shaders.h"

namespace relume {

namespace {

constexpr std::string_view kPluginSuffix = ".relume.so";

ShaderInfo describe(const ShaderAbi& abi, const std::filesystem::path& file) {
    return {abi.name, abi.label, abi.help, {abi.parameters, abi.parameter_count}, file, &abi};
}

struct Registry {
    std::vector<ShaderInfo> shaders;
    std::vector<PluginReport> reports;

    Registry() {
        for (const ShaderAbi* abi : builtin_shaders()) shaders.push_back(describe(*abi, {}));
        const char* path = std::getenv("RELUME_SHADER_PATH");
        if (path == nullptr) return;
        const std::size_t builtin = shaders.size();
        std::string_view rest(path);
        while (!rest.empty()) {
            const std::size_t colon = rest.find(':');
            load_folder(std::filesystem::path(rest.substr(0, colon)));
            rest = colon == std::string_view::npos ? std::string_view{} : rest.substr(colon + 1);
        }
        std::sort(shaders.begin() + static_cast<std::ptrdiff_t>(builtin), shaders.end(),
                  [](const ShaderInfo& a, const ShaderInfo& b) { return a.name < b.name; });
    }

    void load_folder(const std::filesystem::path& folder) {
        if (folder.empty()) return;
        std::error_code error;
        std::vector<std::filesystem::path> files;
        for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
            if (it->path().filename().string().ends_with(kPluginSuffix)) files.push_back(it->path());
        if (error) {
            reports.push_back({folder, false, "the folder on RELUME_SHADER_PATH cannot be read: " + error.message()});
            return;
        }
        std::sort(files.begin(), files.end());
        for (const auto& file : files) load_plugin(file);
    }

    void load_plugin(const std::filesystem::path& file) {
        const std::size_t before = shaders.size();
        // All of a file or nothing.
        const auto refuse = [&](const std::string& why) {
            shaders.resize(before);
            reports.push_back({file, false, why});
        };
        // Local and lazy: a plugin sees librelume's ABI alone, and two plugins never each other's symbols. Never
        // closed: tables and kernels of it stay in use.
        void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (handle == nullptr) {
            const char* why = dlerror();
            return refuse(why != nullptr ? why : "dlopen failed");
        }
        const auto entry = reinterpret_cast<ShaderPluginFunction>(dlsym(handle, kShaderPluginSymbol));
        if (entry == nullptr)
            return refuse(std::string("has no symbol ") + kShaderPluginSymbol +
                          "; build it with relume_add_shader() of this version of relume");
        std::int32_t count = 0;
        const ShaderAbi* const* abis = entry(&count);
        std::string names;
        for (std::int32_t k = 0; k < count; ++k) {
            const ShaderAbi& abi = *abis[k];
            if (abi.version != kShaderAbiVersion || abi.size != sizeof(ShaderAbi) ||
                abi.parameter_size != sizeof(Parameter))
                return refuse("was built for shader ABI " + std::to_string(abi.version) + ", this relume has " +
                              std::to_string(kShaderAbiVersion) + "; rebuild it");
            if (const ShaderInfo* other = find(abi.name))
                return refuse("brings a shader '" + std::string(abi.name) + "', a name that " +
                              (other->file.empty() ? std::string("relume itself") : other->file.string()) +
                              " has already");
            shaders.push_back(describe(abi, file));
            names += (names.empty() ? "" : ", ") + std::string(abi.name);
        }
        reports.push_back({file, true, names});
    }

    const ShaderInfo* find(std::string_view name) const {
        const auto found =
            std::find_if(shaders.begin(), shaders.end(), [&](const ShaderInfo& s) { return s.name == name; });
        return found == shaders.end() ? nullptr : &*found;
    }
};

const Registry& registry() {
    static const Registry instance;
    return instance;
}

}  // namespace

std::span<const ShaderInfo> shaders() { return registry().shaders; }

std::span<const PluginReport> plugin_reports() { return registry().reports; }

const ShaderInfo* find_shader(std::string_view name) { return registry().find(name); }

const ShaderInfo& require_shader(std::string_view name) {
    if (const ShaderInfo* found = find_shader(name)) return *found;
    std::vector<std::string_view> names;
    for (const ShaderInfo& s : shaders()) names.push_back(s.name);
    const std::string nearest = nearest_name(name, names);
    throw Error(ErrorKind::parameter,
                "unknown shader '" + std::string(name) + "'" +
                    (nearest.empty() ? "; `relume shaders` lists them" : "; did you mean '" + nearest + "'?"));
}

}  // namespace relume
