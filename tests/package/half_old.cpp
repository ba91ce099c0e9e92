// SPDX-License-Identifier: Apache-2.0
// A plugin of two shaders, the second of another version: relume must take neither.
#include <relume/shader_abi.h>

extern "C" __attribute__((visibility("default"))) const relume::ShaderAbi* const* relume_shader_plugin_v1(
    std::int32_t* count) {
    static const relume::ShaderAbi good{.version = relume::kShaderAbiVersion,
                                        .size = sizeof(relume::ShaderAbi),
                                        .name = "half_good",
                                        .label = "",
                                        .help = "",
                                        .parameter_size = sizeof(relume::Parameter)};
    static const relume::ShaderAbi old{.version = 1, .size = sizeof(relume::ShaderAbi), .name = "old"};
    static const relume::ShaderAbi* const shaders[] = {&good, &old};
    *count = 2;
    return shaders;
}
