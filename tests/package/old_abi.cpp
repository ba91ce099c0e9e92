// SPDX-License-Identifier: Apache-2.0
// A plugin of another version: relume must refuse it and say so.
#include <relume/shader_abi.h>

extern "C" __attribute__((visibility("default"))) const relume::ShaderAbi* const* relume_shader_plugin_v1(
    std::int32_t* count) {
    static const relume::ShaderAbi old{.version = 0, .size = sizeof(relume::ShaderAbi), .name = "old"};
    static const relume::ShaderAbi* const shaders[] = {&old};
    *count = 1;
    return shaders;
}
