// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>

#include "relume/rig.h"
#include "rig/canonical.h"
#include "rig/problem.h"
#include "rig/value_text.h"

namespace relume {

namespace {

const Parameter& row_of(std::span<const Parameter> table, std::string_view name) {
    if (const Parameter* row = rigfile::find_row(table, name)) return *row;
    throw std::logic_error("no parameter '" + std::string(name) + "' in the table");
}

[[noreturn]] void wrong_kind(std::string_view name) {
    throw std::logic_error("parameter '" + std::string(name) + "' was asked for as something that it is not");
}

}  // namespace

void ParameterValues::set(std::span<const Parameter> table, std::string_view name, const Value& value,
                          std::string_view what) {
    const Parameter& row = rigfile::require_row(table, name, what);
    const auto* keys = std::get_if<Keys>(&value);
    values_.insert_or_assign(std::string(name), keys != nullptr ? rigfile::canonical_keys(row, *keys, what)
                                                                : rigfile::canonical(row, value, what));
}

void ParameterValues::unset(std::string_view name) {
    if (const auto found = values_.find(name); found != values_.end()) values_.erase(found);
}

bool ParameterValues::given(std::string_view name) const { return values_.find(name) != values_.end(); }

const Value* ParameterValues::find(std::string_view name) const {
    const auto found = values_.find(name);
    return found == values_.end() ? nullptr : &found->second;
}

double ParameterValues::number(std::span<const Parameter> table, std::string_view name) const {
    const Parameter& row = row_of(table, name);
    const Value* value = find(name);
    if (value == nullptr) return row.value[0];
    if (const auto* d = std::get_if<double>(value)) return *d;
    if (const auto* i = std::get_if<std::int64_t>(value)) return static_cast<double>(*i);
    if (const auto* b = std::get_if<bool>(value)) return *b ? 1 : 0;
    if (const auto* keys = std::get_if<Keys>(value)) return keys->values.front()[0];
    wrong_kind(name);
}

std::array<double, 3> ParameterValues::triple(std::span<const Parameter> table, std::string_view name) const {
    const Parameter& row = row_of(table, name);
    const Value* value = find(name);
    if (value == nullptr) return row.value;
    if (const auto* t = std::get_if<std::array<double, 3>>(value)) return *t;
    if (const auto* keys = std::get_if<Keys>(value)) return keys->values.front();
    wrong_kind(name);
}

bool ParameterValues::boolean(std::span<const Parameter> table, std::string_view name) const {
    const Parameter& row = row_of(table, name);
    const Value* value = find(name);
    if (value == nullptr) return row.value[0] != 0;
    if (const auto* b = std::get_if<bool>(value)) return *b;
    wrong_kind(name);
}

int ParameterValues::choice(std::span<const Parameter> table, std::string_view name) const {
    const Parameter& row = row_of(table, name);
    const Value* value = find(name);
    if (value == nullptr) return static_cast<int>(row.value[0]);
    const auto* word = std::get_if<std::string>(value);
    if (word == nullptr) wrong_kind(name);
    const auto choices = rigfile::split_choices(row.choices);
    const auto found = std::find(choices.begin(), choices.end(), *word);
    if (found == choices.end()) wrong_kind(name);
    return static_cast<int>(found - choices.begin());
}

std::string ParameterValues::text(std::span<const Parameter> table, std::string_view name) const {
    const Parameter& row = row_of(table, name);
    const Value* value = find(name);
    if (value != nullptr) {
        if (const auto* s = std::get_if<std::string>(value)) return *s;
        wrong_kind(name);
    }
    if (row.type != ParameterType::choice) return std::string(row.text);
    const auto choices = rigfile::split_choices(row.choices);
    return choices.empty() ? std::string{} : std::string(choices.at(static_cast<std::size_t>(row.value[0])));
}

std::vector<std::string> ParameterValues::texts(std::span<const Parameter> table, std::string_view name) const {
    const Parameter& row = row_of(table, name);
    const Value* value = find(name);
    if (value == nullptr) {
        const auto parts = rigfile::split_choices(row.text);
        return {parts.begin(), parts.end()};
    }
    if (const auto* list = std::get_if<std::vector<std::string>>(value)) return *list;
    wrong_kind(name);
}

std::vector<double> ParameterValues::numbers(std::span<const Parameter> table, std::string_view name) const {
    const Parameter& row = row_of(table, name);
    const Value* value = find(name);
    if (value == nullptr) {
        const auto count =
            row.has_default ? std::min<std::size_t>(static_cast<std::size_t>(row.count), row.value.size()) : 0;
        return {row.value.begin(), row.value.begin() + static_cast<std::ptrdiff_t>(count)};
    }
    if (const auto* list = std::get_if<std::vector<double>>(value)) return *list;
    wrong_kind(name);
}

}  // namespace relume
