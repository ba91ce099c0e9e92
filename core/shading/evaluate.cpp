// SPDX-License-Identifier: Apache-2.0
#include "shading/evaluate.h"

#include <algorithm>
#include <string_view>

#include "relume/isa.h"
#include "relume/lookup_table.h"
#include "shading/builtin_table.h"

namespace relume {

void evaluate_shader(const ShaderInfo& shader, ShaderEvaluation<float>& evaluation) {
    evaluation.size = sizeof evaluation;
    shader.abi->evaluate_float(&evaluation);
}

void evaluate_shader(const ShaderInfo& shader, ShaderEvaluation<double>& evaluation) {
    evaluation.size = sizeof evaluation;
    shader.abi->evaluate_double(&evaluation);
}

std::vector<double> default_params(const ShaderInfo& shader) {
    std::vector<double> values(static_cast<std::size_t>(shader.abi->float_slots));
    for (const Parameter& p : shader.parameters) {
        if (!p.is_number()) continue;
        for (int k = 0; k < p.components(); ++k)
            values[static_cast<std::size_t>(p.slot + k)] = p.value[static_cast<std::size_t>(k)];
    }
    return values;
}

std::vector<std::int32_t> default_options(const ShaderInfo& shader) {
    std::vector<std::int32_t> values(static_cast<std::size_t>(shader.abi->option_slots));
    for (const Parameter& p : shader.parameters)
        if (p.is_option()) values[static_cast<std::size_t>(p.slot)] = static_cast<std::int32_t>(p.value[0]);
    return values;
}

std::vector<TableView> default_tables(const ShaderInfo& shader) {
    std::vector<TableView> views(static_cast<std::size_t>(shader.abi->table_slots));
    for (const Parameter& p : shader.parameters)
        if (p.type == ParameterType::table)
            views[static_cast<std::size_t>(p.slot)] = view_of(*builtin_table(shader, p.name));
    return views;
}

ShadeFunction kernel_of(const ShaderInfo& shader) {
    const auto isas = available_isas();
    const auto active = std::find(isas.begin(), isas.end(), active_isa());
    ShadeFunction best = nullptr;
    for (auto isa = isas.begin(); isa <= active; ++isa)
        for (int k = 0; k < shader.abi->kernel_count; ++k)
            if (*isa == shader.abi->kernels[k].isa) best = shader.abi->kernels[k].shade;
    return best;
}

}  // namespace relume
