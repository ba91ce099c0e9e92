// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relume/shader.h"
#include "relume/shader_abi.h"

namespace relume {

/// f·NdotL (1/sr) of a model on arrays, by the same code that shades pixels, in float or double.
/// `evaluation.params` holds one array per float slot (ShaderAbi::float_slots) and `options` one int per option slot;
/// see default_params() for the defaults. `tables` holds one view per table slot. n, v, l must be unit.
void evaluate_shader(const ShaderInfo& shader, ShaderEvaluation<float>& evaluation);
void evaluate_shader(const ShaderInfo& shader, ShaderEvaluation<double>& evaluation);

/// The tables' defaults by slot.
std::vector<double> default_params(const ShaderInfo& shader);
std::vector<std::int32_t> default_options(const ShaderInfo& shader);
std::vector<TableView> default_tables(const ShaderInfo& shader);  ///< the built-in ones, which live on

/// The kernel of the active ISA, else the best one below it that the shader has.
ShadeFunction kernel_of(const ShaderInfo& shader);

}  // namespace relume
